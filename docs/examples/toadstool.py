"""A toadstool of 40 mm as a textured .glb, and its colours as a material of the body that is baked of it.

`python toadstool.py toadstool.glb` writes the mesh, finely enough for a picture.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np
import trimesh
from PIL import Image

import quadgraph

# The outline from the foot over the rim of the cap to its top: radius and height, mm.
OUTLINE = np.array(
    [
        *((0, 0), (6, 0), (7, 2), (5.2, 7), (4.2, 14), (4, 20), (5, 22), (12, 19.5)),
        *((16.5, 19), (18.4, 21), (18, 25), (15.5, 31), (11, 36), (5.5, 39.2), (0, 40)),
    ]
)
RIM = 9  # the place of the outline where cream ends and the cap's red begins
RED, CREAM, WHITE = (176, 22, 18), (226, 196, 152), (240, 234, 222)  # sRGB
SPOTS = 28


def outline(count: int) -> tuple[np.ndarray, float]:
    """Return the outline made smooth, radii and heights (count, 2) mm, and at which share of its length the rim is."""
    way = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(OUTLINE, axis=0), axis=1))])
    fine, reach = np.linspace(0, 1, 2001), 120
    kernel = np.hanning(2 * reach + 3)[1:-1]
    smooth = []
    for corners, sign in zip(OUTLINE.T, ("odd", "even"), strict=True):  # beyond the axis radii are negative
        column = np.pad(np.interp(fine, way / way[-1], corners), reach, "reflect", reflect_type=sign)
        smooth.append(np.interp(np.linspace(0, 1, count), fine, np.convolve(column, kernel / kernel.sum(), "valid")))
    return np.column_stack(smooth), float(way[RIM] / way[-1])


def texture(size: int) -> Image.Image:
    """Return a picture whose columns go around and whose rows go from the top of the cap to the foot."""
    profile, rim = outline(size)
    radius, height = profile[::-1].T[:, :, None]
    angle = np.linspace(0, 2 * np.pi, size, endpoint=False)
    places = np.stack([radius * np.cos(angle), height + 0 * angle, radius * np.sin(angle)], axis=-1)
    cap = np.linspace(1, 0, size) > rim
    pixels = np.where(cap[:, None, None], RED, CREAM).astype(float) * np.ones((size, size, 1))
    random = np.random.default_rng(4)
    for k in range(SPOTS):
        row, column = int((0.02 + 0.9 * (1 - rim) * np.sqrt((k + 0.5) / SPOTS)) * size), int(0.618 * k * size) % size
        near = np.linalg.norm(places - places[row, column], axis=-1) < random.uniform(1.0, 1.9)
        pixels[near & cap[:, None]] = WHITE
    return Image.fromarray(pixels.astype(np.uint8))


def write_glb(path: Path, around: int, along: int, size: int) -> None:
    """Write the mesh in metres, as glTF has it, with its texture: `around` times `along` squares, `size`² pixels."""
    profile, _ = outline(along + 1)
    profile[[0, -1], 0] = 0
    u, v = np.meshgrid(np.linspace(0, 1, around + 1), np.linspace(0, 1, along + 1))
    radius, height = (profile[:, k : k + 1] / 1000 for k in range(2))
    turn = 2 * np.pi * np.where(u == 1, 0, u)
    places = np.stack([radius * np.cos(turn), height + 0 * turn, radius * np.sin(turn)], axis=-1).reshape(-1, 3)
    corner = np.arange(along * (around + 1)).reshape(along, around + 1)[:, :-1].ravel()
    right, above, across = corner + 1, corner + around + 1, corner + around + 2
    faces = np.concatenate([np.column_stack([corner, above, across]), np.column_stack([corner, across, right])])
    faces = faces[np.linalg.norm(np.cross(*np.diff(places[faces], axis=1).swapaxes(0, 1)), axis=1) > 0]
    look = trimesh.visual.material.PBRMaterial(name="toadstool", baseColorTexture=texture(size), roughnessFactor=0.5)
    visual = trimesh.visual.TextureVisuals(np.column_stack([u.ravel(), v.ravel()]), material=look)
    trimesh.Trimesh(places, faces, visual=visual, process=False).export(path)


def main(mesh: Path | None = None) -> float:
    """Write the mesh; return how far the red of a coarse one's cap is from what a reflectance of that red asks for."""
    if mesh is not None:
        write_glb(mesh, 200, 180, 1024)
        return 0.0
    with tempfile.TemporaryDirectory() as folder:
        mesh, body = Path(folder) / "toadstool.glb", Path(folder) / "toadstool.qgraph"
        write_glb(mesh, 48, 44, 256)
        quadgraph.bake(mesh, body, quadgraph.BakeOptions(levels=1))
        material, _ = quadgraph.mesh_colours(mesh, body, quadgraph.ColourOptions(mean_free_path=0.5, eta=1.44))
    srgb = np.array(RED) / 255
    red = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    wanted = quadgraph.Material.from_colour(tuple(red), 0.5, 1.44)
    difference = np.abs(material.sigma_a - wanted.sigma_a).max(axis=-1) / max(wanted.sigma_a)
    return float(np.quantile(difference, 0.02))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
