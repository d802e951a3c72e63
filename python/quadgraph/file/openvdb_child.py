"""A program for a Python that has OpenVDB's module: grids of a .vdb as an .npz of dense arrays, and back.

Runs as a file of its own, apart from QuadGraph: `read FILE.vdb OUT.npz COUNT GRID...`, where only the first COUNT grids
must be there, and `write IN.npz FILE.vdb`. Arrays have x first; `origin` is the place of the first
cell's middle and `spacing` that from cell to cell, in the file's unit. Exits with 2 and one line that says why where a
file does not serve.
"""

import sys

import numpy as np

try:
    import openvdb
except ImportError:
    import pyopenvdb as openvdb

MOST_CELLS = 1 << 25  # of the box around all grids


def refuse(text):
    """End with a line of explanation."""
    print(text)
    sys.exit(2)


def why(error):
    """Return what the library says, whose messages quote what they found in a damaged file."""
    text = "".join(c for c in str(error)[:200] if c.isprintable()).strip(" '")
    return text or type(error).__name__


def opened(path, names, count):
    """Return the grids of those names by their numbers; those after the first `count` may be missing."""
    try:
        found = {grid.name: grid for grid in openvdb.readAllGridMetadata(path)}
    except Exception as error:
        refuse(f"no whole OpenVDB file: {why(error)}")
    for name in names[:count]:
        if name not in found:
            refuse(f"grid '{name}' not found, there are {', '.join(sorted(found)) or 'none'}")
    try:
        return {number: openvdb.read(path, name) for number, name in enumerate(names) if name in found}
    except Exception as error:
        refuse(f"cannot be read: {why(error)}")


def spacing_of(grid):
    """Return the size of a voxel along x, y and z, and the middle of voxel 0."""
    if not grid.transform.isLinear:
        refuse(f"grid '{grid.name}': its transform is no linear one")
    zero = np.array(grid.transform.indexToWorld((0, 0, 0)))
    steps = np.array([grid.transform.indexToWorld(tuple(row)) for row in np.eye(3, dtype=int).tolist()]) - zero
    spacing = np.diag(steps)
    if spacing.min() <= 0 or np.abs(steps - np.diag(spacing)).max() > 1e-6 * spacing.max():
        refuse(f"grid '{grid.name}': it is turned or mirrored, only scaled and moved ones are supported: resample it")
    return spacing, zero


def read(path, output, count, names):
    """Dense arrays over the box around what is active in any of the grids."""
    grids = opened(path, names, count)
    boxes, spacings, zeros = [], [], []
    for grid in grids.values():
        if grid.valueTypeName not in ("float", "vec3s"):
            refuse(f"grid '{grid.name}': values of type {grid.valueTypeName}, allowed are float and vec3s")
        if grid.gridClass == openvdb.GridClass.LEVEL_SET:
            refuse(f"grid '{grid.name}' is a level set: distances, no densities")
        if grid.activeVoxelCount() == 0:
            refuse(f"grid '{grid.name}' is empty")
        boxes.append(grid.evalActiveVoxelBoundingBox())
        spacing, zero = spacing_of(grid)
        spacings.append(spacing)
        zeros.append(zero)
    if not all(np.allclose(s, spacings[0], rtol=1e-6, atol=0) for s in spacings) or not all(
        np.allclose(z, zeros[0], rtol=0, atol=1e-3 * spacings[0].min()) for z in zeros
    ):
        refuse("its grids have different transforms, the same is wanted")
    low = np.min([box[0] for box in boxes], axis=0)
    cells = np.max([box[1] for box in boxes], axis=0) - low + 1
    if np.prod(cells, dtype=float) > MOST_CELLS:
        refuse(f"{cells[0]} x {cells[1]} x {cells[2]} cells found, {MOST_CELLS} allowed in all: resample it")
    found = {}
    for number, grid in grids.items():
        shape = tuple(cells.tolist()) + ((3,) if grid.valueTypeName == "vec3s" else ())
        found[f"grid{number}"] = np.zeros(shape, np.float32)
        grid.copyToArray(found[f"grid{number}"], ijk=tuple(low.tolist()))
    if "eta" in grids[0].metadata:
        found["eta"] = float(grids[0].metadata["eta"])
    np.savez(output, spacing=spacings[0], origin=zeros[0] + low * spacings[0], **found)


def write(source, path):
    """Grids of the arrays whose names begin with sigma; the corners of their box are active whatever they hold."""
    with np.load(source) as stored:
        arrays = dict(stored)
    x, y, z = arrays["spacing"].tolist()
    matrix = [[x, 0, 0, 0], [0, y, 0, 0], [0, 0, z, 0], [*arrays["origin"].tolist(), 1]]
    grids = []
    for name, values in arrays.items():
        if not name.startswith("sigma"):
            continue
        grid = openvdb.FloatGrid() if values.ndim == 3 else openvdb.Vec3SGrid()
        grid.copyFromArray(values)
        accessor = grid.getAccessor()
        for corner in ((0, 0, 0), tuple(n - 1 for n in values.shape[:3])):
            accessor.setValueOn(corner)
        grid.name = name
        grid.gridClass = openvdb.GridClass.FOG_VOLUME
        grid.transform = openvdb.createLinearTransform(matrix)
        grid.updateMetadata({"eta": float(arrays["eta"]), "unit": "mm"})
        grids.append(grid)
    openvdb.write(path, grids)


if __name__ == "__main__":
    if sys.argv[1] == "read":
        read(sys.argv[2], sys.argv[3], int(sys.argv[4]), sys.argv[5:])
    else:
        write(*sys.argv[2:])
