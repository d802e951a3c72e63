"""Mesh files with colours for tests: a ball whose colour goes from RED at -x to GREEN at +x, in every kind of file."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from gltf_files import Builder
from quadgraph.mesh.surface import Surface

RED, GREEN = np.array([0.6, 0.15, 0.1]), np.array([0.1, 0.5, 0.2])  # linear


def srgb(linear: np.ndarray) -> np.ndarray:
    """uint8 of linear light."""
    linear = np.asarray(linear, float)
    return np.round(255 * np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)).astype(
        np.uint8
    )


def across(surface: Surface, axis: int = 0) -> np.ndarray:
    """Where vertices lie between the least and the greatest x, y or z, 0 to 1."""
    x = surface.vertices[:, axis]
    return (x - x.min()) / np.ptp(x)


def ramp(share: np.ndarray) -> np.ndarray:
    """Linear colours (n, 3) at shares of the way from RED to GREEN."""
    return RED + np.asarray(share)[:, None] * (GREEN - RED)


def ramp_pixels(width: int = 256) -> np.ndarray:
    """A picture of the ramp, from left to right."""
    return np.broadcast_to(srgb(ramp((np.arange(width) + 0.5) / width)), (4, width, 3))


def encoded(pixels: np.ndarray, kind: str = "PNG") -> bytes:
    """A picture's file."""
    stream = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels)).save(stream, kind)
    return stream.getvalue()


def coloured_glb(
    path: Path,
    surface: Surface,
    material: dict[str, Any],
    picture: bytes | None = None,
    uv: np.ndarray | None = None,
    **document: Any,
) -> Path:
    """A surface with one material and its texture, which ends at its edges, by default from the front, u along x and v
    along y; document: what else the file holds.
    """
    builder = Builder()
    attributes = {}
    if picture is not None:
        places = np.column_stack([across(surface), across(surface, 1)]) if uv is None else uv
        attributes["TEXCOORD_0"] = builder.add(places)
        view = builder.add_bytes(picture)
        builder.document |= {"samplers": [{"wrapS": 33071, "wrapT": 33071}], "textures": [{"source": 0, "sampler": 0}]}
        builder.document |= {"images": [{"bufferView": view, "mimeType": "image/png"}]}
    builder.mesh(surface, **attributes)
    builder.meshes[0]["primitives"][0]["material"] = 0
    builder.document |= {"nodes": [{"mesh": 0}], "materials": [material]} | document
    return builder.write(path)


def textured(**more: Any) -> dict[str, Any]:
    """A material with texture 0."""
    return {"name": "skin", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}} | more}


def ramp_glb(path: Path, surface: Surface) -> Path:
    """The ramp as a texture."""
    return coloured_glb(path, surface, textured(), encoded(ramp_pixels()))


def ramp_colour_0(path: Path, surface: Surface) -> Path:
    """The ramp as COLOR_0."""
    builder = Builder()
    builder.mesh(surface, COLOR_0=builder.add(ramp(across(surface))))
    builder.document = {"nodes": [{"mesh": 0}]}
    return builder.write(path)


def ramp_ply(path: Path, surface: Surface) -> Path:
    """The ramp as bytes at vertices."""
    names = [f"property float {axis}" for axis in "xyz"] + [f"property uchar {c}" for c in ("red", "green", "blue")]
    head = ["ply", "format ascii 1.0", f"element vertex {len(surface.vertices)}", *names]
    head += [f"element face {len(surface.triangles)}", "property list uchar int vertex_indices", "end_header"]
    rows = [
        " ".join([*(f"{value:.9g}" for value in place), *map(str, colour)])
        for place, colour in zip(surface.vertices, srgb(ramp(across(surface))), strict=True)
    ]
    faces = [f"3 {a} {b} {c}" for a, b, c in surface.triangles]
    path.write_text("\n".join([*head, *rows, *faces]) + "\n")
    return path


def ramp_obj(path: Path, surface: Surface, map_line: str = "map_Kd -clamp on ramp.png") -> Path:
    """The ramp as a texture of a material beside the file."""
    (path.parent / "ramp.png").write_bytes(encoded(ramp_pixels()))
    (path.parent / "ramp.mtl").write_text(f"newmtl skin\nKd 1 1 1\n{map_line}\n")
    lines = ["mtllib ramp.mtl", *("v " + " ".join(f"{value:.9g}" for value in place) for place in surface.vertices)]
    lines += [f"vt {share:.9g} 0.5" for share in across(surface)]
    lines += ["usemtl skin", *("f " + " ".join(f"{v}/{v}" for v in face + 1) for face in surface.triangles)]
    path.write_text("\n".join(lines) + "\n")
    return path
