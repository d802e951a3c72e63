"""`quadgraph export`: a baked body with its material as glTF, for other renderers.

What is inside goes by KHR_materials_volume and the draft KHR_materials_volume_scatter, as `quadgraph colours` and
`--material own` read them; the index of refraction, roughness and coat go along.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from quadgraph.base import outputs
from quadgraph.base.errors import InputError

if TYPE_CHECKING:
    from quadgraph.api.materials import Material
    from quadgraph.core import QuadGraph
    from quadgraph.mesh.gltf_writer import WrittenPart

_METRE = 1000.0  # mm
_ROUGHNESS = 0.3  # GGX alpha, where a material says none


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Register the subcommand."""
    parser = subparsers.add_parser("export", help="a body with its material as glTF", description=__doc__)
    parser.add_argument("file", metavar="FILE", type=Path, help="a baked .qgraph")
    parser.add_argument(
        "--material", metavar="M", default="marble", help="of one material throughout, as `render` takes it"
    )
    parser.add_argument(
        "--material-of",
        metavar="BODY=M",
        action="append",
        default=[],
        help="of one of several bodies, in place of --material; several allowed",
    )
    parser.add_argument("-o", "--output", metavar="OUT.glb", type=Path, required=True, help="the file to write")


def run(args: argparse.Namespace) -> int:
    """Write it; 0 on success."""
    from quadgraph.base.version import __version__
    from quadgraph.commands.scene_options import by_body
    from quadgraph.core import load_core
    from quadgraph.mesh import gltf_writer

    if args.output.suffix.lower() != ".glb":
        raise InputError(f"{args.output}: output must end in .glb")
    outputs.check_outputs([args.output], [args.file])
    graph = load_core().load(args.file)
    others = by_body(args.material_of)
    for name in others.keys() - set(graph.bodies):
        raise InputError(f"--material-of: found '{name}', the file has {', '.join(graph.bodies) or 'one body'}")
    parts = _parts(graph, args.material, others, args.file.stem)
    gltf_writer.write(args.output, parts, f"quadgraph {__version__}")
    for part in parts:
        print(f"{args.output}: {part.name}, {len(part.triangles)} triangles")
    return 0


def _parts(graph: QuadGraph, usual: str, others: dict[str, str], stem: str) -> list[WrittenPart]:
    """The outside of each body, in m."""
    from quadgraph.mesh.gltf_writer import WrittenPart

    display = graph.display
    triangles = np.asarray(display["triangles"])
    body = np.zeros(len(triangles), int)
    if graph.bodies:
        level = graph.levels[0]
        body = np.asarray(level.tet_bodies)[np.asarray(level.face_tets)][np.asarray(display["face"])[triangles[:, 0]]]
    parts = []
    for number, name in enumerate(graph.bodies or [stem]):
        own = triangles[body == number]
        if len(own) == 0:
            raise InputError(f"{name}: lies within another body, of which glTF's volumes know nothing")
        used, renumbered = np.unique(own, return_inverse=True)
        vertices = np.asarray(display["vertices"], np.float64)[used] / _METRE
        local = renumbered.reshape(own.shape)
        material = _gltf_material(name, others.get(name, usual), _mean_chord(vertices, local))
        parts.append(WrittenPart(name, vertices, np.asarray(display["normals"])[used], local, material))
    return parts


def _gltf_material(body: str, text: str, thickness: float) -> dict:
    from quadgraph.mesh.looks import gltf_media

    found = _plain_material(body, text)
    scattering, absorption = (
        np.broadcast_to(np.asarray(value, np.float64), 3) * _METRE for value in (found.sigma_s_prime, found.sigma_a)
    )
    alpha = _ROUGHNESS if found.roughness is None else found.roughness
    surface = {"baseColorFactor": [1.0, 1.0, 1.0, 1.0], "metallicFactor": 0.0, "roughnessFactor": float(np.sqrt(alpha))}
    extensions = gltf_media.extensions_of(scattering, absorption, found.eta, thickness)
    if found.coat and found.coat_eta and found.coat_roughness:
        extensions[gltf_media.CLEAR_COAT] = gltf_media.clear_coat_of(found.coat, found.coat_eta, found.coat_roughness)
    return {"name": f"{body}: {text}"[:200], "pbrMetallicRoughness": surface, "extensions": extensions}


def _plain_material(body: str, text: str) -> Material:
    from quadgraph.api.materials import Material

    if text.partition(",")[0].lower().endswith(".npz"):
        raise InputError(f"{body}: material {text} found, allowed is one throughout: glTF's volumes are even")
    found = Material.parse(text)
    if found.pattern != "none":
        raise InputError(f"{body}: pattern {found.pattern} of {text} found, allowed is none: glTF's volumes are even")
    return found


def _mean_chord(vertices: np.ndarray, triangles: np.ndarray) -> float:
    """Four volumes over the surface."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    return float(4 * abs(np.einsum("ij,ij->", a, np.cross(b, c)) / 6) / max(area, 1e-30))
