"""What the QuadGraph paper reports: Wang, Wang, Holzschuch, Subr, Yong, Guo, "Real-time Rendering of Heterogeneous
Translucent Objects with Arbitrary Shapes", Eurographics 2010. On an NVIDIA GeForce 8800GTX, pictures of 1024² pixels
with 2 × 2 samples.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Scene:
    """A row of Table 1: nodes on the surface and inside in thousands, K, levels, MB of textures over all levels,
    minutes of preprocessing, iterations of the solver at each level, frames per second.
    """

    name: str
    surface_nodes: int
    inner_nodes: int
    grading: float
    levels: int
    megabytes: int
    minutes: int
    iterations: int
    frames_per_s: float


TABLE_1 = (
    Scene("Thai", 157, 369, 1.0, 4, 35, 24, 40, 21.8),
    Scene("Gargoyle", 62, 139, 0.5, 3, 18, 10, 50, 46.4),
    Scene("Topmod", 121, 260, 0.2, 3, 36, 15, 40, 29.4),
    Scene("Buddha", 66, 120, 0.5, 3, 17, 9, 30, 57.6),
    Scene("Fertility", 82, 182, 0.3, 3, 25, 12, 50, 34.4),
    Scene("Twirl", 82, 226, 0.1, 3, 27, 16, 60, 22.1),
    Scene("Heptoroid", 82, 178, 0.2, 2, 24, 11, 80, 21.6),
    Scene("Lucy", 150, 363, 0.2, 4, 33, 20, 40, 21.0),
)
USUAL_ITERATIONS = 50  # for bodies of which the paper tells none; Table 1 has 30 to 80

# Figure 11: K to thousands of nodes and milliseconds.
FIGURE_11 = {1.0: (141, 21), 0.5: (246, 35), 0.3: (468, 68), 0.1: (973, 122)}

# Sentences on what the paper only draws, section by section.
FIGURE_12 = (
    "For most of the models, the rendering time varies linearly with respect to the number of tetrahedra. "
    "The two outliers (Twirl and Heptoroid) have thinner features and require more iterations."
)
FIGURE_13 = "it maintains RMS error under 10 % (see figure 13) ... errors as low as 2 % at slight costs in efficiency"
FIGURE_14 = "the use of a multi-resolution solver significantly increases convergence rate"
PACKING = "this localized storage of the QuadGraph in textures results in a 30 % to 60 % speedup over random storage"


def scene(name: str) -> Scene:
    """The row of Table 1 of that name."""
    return next(row for row in TABLE_1 if row.name == name)
