"""libFuzzer (atheris) on a reader of meshes: `fuzz_meshes.py SUFFIX [ARGUMENTS OF LIBFUZZER]`, .ply, .gltf or .glb."""

from __future__ import annotations

import sys
import tempfile
import warnings
from pathlib import Path

import atheris

TESTS = Path(__file__).resolve().parents[1] / "python"
sys.path[:0] = [str(TESTS), str(TESTS / "mesh")]

with atheris.instrument_imports(include=["quadgraph.mesh", "quadgraph.base", "trimesh.exchange.gltf", "mesh_mutants"]):
    import mesh_mutants


def mutate(data: bytes, most: int, seed: int) -> bytes:
    """One mutant of libFuzzer's, or one that has other numbers in its text."""
    if seed % 2:
        return atheris.Mutate(data, most)
    return next(mesh_mutants.mutants(data, 1, seed))[:most]


def main() -> None:
    """Fuzz until libFuzzer's arguments say that it is enough."""
    suffix, *arguments = sys.argv[1:]
    warnings.simplefilter("ignore")  # of NumPy in trimesh, about numbers that are refused later
    with tempfile.TemporaryDirectory() as folder:
        path, corpus = Path(folder) / f"fuzz{suffix}", Path(folder) / "corpus"
        corpus.mkdir()
        for number, seed in enumerate(mesh_mutants.seeds(suffix)):
            (corpus / f"seed{number}").write_bytes(seed)

        def read(data: bytes) -> None:
            path.write_bytes(data)
            mesh_mutants.read(path)

        atheris.Setup([sys.argv[0], "-rss_limit_mb=1024", *arguments, str(corpus)], read, custom_mutator=mutate)
        atheris.Fuzz()


if __name__ == "__main__":
    main()
