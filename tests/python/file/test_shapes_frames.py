"""Frames of an animation as the shapes of a baked body, whichever axis points up in the files."""

from __future__ import annotations

import numpy as np
import pytest

from quadgraph.baking.pipeline import BakeOptions, bake
from quadgraph.base.errors import FormatError
from quadgraph.file import qgraph_file, shapes_file
from quadgraph.mesh.surface import Surface
from shapes import icosphere, write_obj


def test_frames_of_a_mesh_whose_z_points_up_are_stood_up_with_the_body(tmp_path):
    """One vertical stretch, along y and along z, moves the two bodies alike."""
    rest = icosphere(2, 10).vertices
    moved = {}
    for up, axis in (("y", 1), ("z", 2)):
        turned = rest if up == "y" else np.stack([rest[:, 0], -rest[:, 2], rest[:, 1]], axis=1)
        stretched = turned.copy()
        stretched[:, axis] *= 1.2
        paths = [tmp_path / f"{up}-{name}.obj" for name in ("rest", "high")]
        for path, vertices in zip(paths, (turned, stretched), strict=True):
            write_obj(Surface(vertices, icosphere(2, 10).triangles), path)
        body = tmp_path / f"{up}.qgraph"
        bake(paths[0], body, BakeOptions(unit="mm", up=up, levels=1, visibility_rays=0))
        moved[up] = shapes_file.from_frames(body, paths[0], paths[1:]).display
        metadata = qgraph_file.read(body).metadata
        assert metadata["options"]["up"] == up
    assert np.abs(moved["y"]).max() > 1
    assert np.allclose(moved["y"], moved["z"], atol=1e-5)


def test_an_axis_that_no_bake_writes_is_refused(tmp_path):
    mesh = write_obj(icosphere(2, 10), tmp_path / "ball.obj")
    body = tmp_path / "ball.qgraph"
    bake(mesh, body, BakeOptions(unit="mm", levels=1, visibility_rays=0))
    file = qgraph_file.read(body)
    file.metadata["options"]["up"] = "x"
    sections = {name: array for name, array in file.sections.items() if name != "metadata"}
    qgraph_file.write_sections(body, file.metadata, sections)
    with pytest.raises(FormatError, match=r"ball\.qgraph: metadata: options/up: 'x' found, allowed are y and z"):
        shapes_file.from_frames(body, mesh, [mesh])
