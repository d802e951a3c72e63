# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # First light
#
# A bunny, light, a material and a picture; then what QuadGraph is for: numbers that are known, with their error.
# Lengths are mm, coefficients 1/mm, power W, fluence and exitance W/mm². `tools/notebooks` runs this text
# (`first_light.py`) and writes the notebook with all that it shows.

# %%
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pymeshlab
from matplotlib.colors import LogNorm

import quadgraph as qg

bunny = Path(pymeshlab.__file__).parent / "tests/sample_meshes/bunny.obj"
folder = tempfile.TemporaryDirectory()
body = Path(folder.name) / "bunny.qgraph"
report = qg.bake(bunny, body, qg.BakeOptions(height_mm=80, surface_vertices=2000))

# %% [markdown]
# ## A picture
#
# Skim milk, with the coefficients that Jensen and others measured in 2001, in the light that a picture has by default:
# a warm lamp behind, a cool one from the side. The solve says where the power went and how far it is off.

# %%
engine = qg.Engine(body, device="cpu")
engine.material = "skimmilk"
solution = engine.solve()
solution

# %%
engine.render(width=280, height=280)

# %% [markdown]
# ## One colour, from wax to jelly
#
# Three materials that show the same colour where a body is thick, with mean free paths of 0.5, 1.5 and 5 mm, in the
# same light at the same exposure. Light leaves thin parts before it is absorbed: the ears lose the colour first.

# %%
colour = (0.8, 0.55, 0.3)
engine.lights = [
    qg.DirectionalLight(direction=(0.9, -0.4, -0.2), irradiance=1e-3),
    qg.AmbientLight(irradiance=2e-4),
]
shown = {}
for mean_free_path in (0.5, 1.5, 5):
    engine.material = qg.Material.from_colour(colour, mean_free_path)
    engine.solve()
    shown[mean_free_path] = engine.render(width=220, height=220, exposure=11.8).srgb()

figure, axes = plt.subplots(1, len(shown), figsize=(7.2, 2.6), layout="constrained")
for axis, (mean_free_path, pixels) in zip(axes, shown.items(), strict=True):
    axis.imshow(pixels)
    axis.set_title(f"{mean_free_path} mm", fontsize=10)
    axis.axis("off")
plt.show()

# %% [markdown]
# ## A measured curve
#
# How much of the light that enters from all around comes out again? What travels far inside is absorbed on its way;
# with a longer free path more of it leaves a body of this size before that. Bars are the estimated error of the
# exitance: with 0.25 mm the elements of this small mesh are coarse, and the solve says so.

# %%
engine.lights = [qg.AmbientLight(irradiance=1e-3)]
paths, shares, bars = [0.25, 0.5, 1, 2, 4, 8], [], []
for mean_free_path in paths:
    engine.material = qg.Material.from_colour(colour, mean_free_path)
    solution = engine.solve()
    shares.append(1 - solution.energy.absorbed / solution.energy.entered)
    bars.append(solution.error.whole * shares[-1])

figure, axis = plt.subplots(figsize=(5, 3.2), layout="constrained")
for channel, name in enumerate(("red", "green", "blue")):
    values, errors = np.array(shares)[:, channel], np.array(bars)[:, channel]
    axis.errorbar(paths, values, errors, color=f"tab:{name}", marker="o", markersize=4, capsize=3, label=name)
axis.set(xscale="log", xlabel="mean free path, mm", ylabel="share that comes out again", ylim=(0, 1))
axis.set_xticks(paths, [f"{each:g}" for each in paths])
axis.minorticks_off()
axis.legend()
plt.show()

# %% [markdown]
# ## A look inside
#
# A material as a function of position: a ball of 20 mm across that absorbs thirty times as much as what is around it.
# Then the fluence of green light on the plane through its middle, lit from the left, in the shape as it is shown.

# %%
low, high = engine.box
middle = np.array([44.0, 16.0, 40.0])


def dark_ball(points):
    """Coefficients with a dark ball in the body, for points (n, 3)."""
    inside = np.linalg.norm(points - middle, axis=1) < 10
    return 0.5, np.where(inside, 0.06, 0.002)


engine.material = qg.VolumeMaterial.from_function(dark_ball, engine.box, spacing=1)
engine.lights = [qg.DirectionalLight(direction=(1, 0, 0), irradiance=1e-3)]
solution = engine.solve()
engine.material

# %%
x, y = np.linspace(low[0], high[0], 200), np.linspace(low[1], high[1], 200)
plane = np.stack([*np.meshgrid(x, y), np.full((200, 200), middle[2])], axis=-1)
fluence = engine.fluence_at(plane)[..., 1]

figure, axis = plt.subplots(figsize=(5, 4), layout="constrained")
seen = axis.imshow(
    fluence,
    origin="lower",
    extent=(low[0], high[0], low[1], high[1]),
    norm=LogNorm(1e-3 * np.nanmax(fluence), np.nanmax(fluence)),
    cmap="magma",
)
axis.add_patch(plt.Circle(middle[:2], 10, fill=False, color="white", linestyle="--"))
axis.set(xlabel="x, mm", ylabel="y, mm")
figure.colorbar(seen, label="fluence, W/mm²")
plt.show()

# %% [markdown]
# ## The numbers, elsewhere
#
# `to_meshio` and `to_pyvista` give the tets with fluence and coefficients. The integral of absorption times fluence
# over them is the power that is absorbed, but for what is absorbed before it scatters for the first time.

# %%
mesh = engine.to_meshio()
corners = mesh.points[mesh.cells[0].data].astype(float)
volume = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
power = mesh.cell_data["sigma_a"][0] * mesh.cell_data["fluence"][0] * volume[:, None]
in_ball = np.linalg.norm(corners.mean(axis=1) - middle, axis=1) < 10
print(f"by the tets {power[:, 1].sum():.3f} W, by the solve {solution.energy.absorbed[1]:.3f} W")
of_volume, of_power = volume[in_ball].sum() / volume.sum(), power[in_ball, 1].sum() / power[:, 1].sum()
print(f"the ball has {of_volume:.1%} of the volume and takes {of_power:.0%} of that")

# %%
engine.close()
folder.cleanup()
