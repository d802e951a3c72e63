"""Damaged mesh files are read, or refused by name: nothing else is raised, and memory goes by what a file holds."""

from __future__ import annotations

import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from mesh_mutants import mutants, read, seeds

ROOM = 1 << 29  # bytes that a reader may take of a file of some hundred
COUNTS = {".ply": 1500, ".glb": 1500, ".gltf": 1000, ".stl": 500, ".obj": 500, ".off": 500}


@contextmanager
def little_memory() -> Iterator[None]:
    """Let this process take ROOM more than it has."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    before = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + ROOM, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


@pytest.mark.parametrize("suffix", COUNTS)
def test_damage_is_refused_by_name_or_does_no_harm(tmp_path, suffix):
    path = tmp_path / f"damaged{suffix}"
    good = 0
    wholes = seeds(suffix)
    with little_memory():
        for number, whole in enumerate(wholes):
            path.write_bytes(whole)
            assert read(path)
            for data in mutants(whole, COUNTS[suffix] // len(wholes), seed=number):
                path.write_bytes(data)
                good += read(path)
    assert 0 < good < COUNTS[suffix]
