"""Names that options may have, from the engine's tables: written by tools/scene_tables."""

from __future__ import annotations

from typing import Literal, TypeAlias

Method: TypeAlias = Literal["fem", "quadgraph-fv", "quadgraph-fdm", "polygrid", "polygrid-divergence", "shortest-path"]
Solver: TypeAlias = Literal["fmg-pcg", "vcycle", "dpcg", "cascade", "jacobi", "auto"]
Source: TypeAlias = Literal["buried", "diffuse"]
Model: TypeAlias = Literal["diffusion", "sp3", "auto"]
Radiance: TypeAlias = Literal["gathered", "lambertian", "single", "auto"]
PathCost: TypeAlias = Literal["transport", "extinction"]
PathSolver: TypeAlias = Literal["eikonal", "lattice"]
Filter: TypeAlias = Literal["box", "tent", "gaussian", "blackman-harris"]
Tone: TypeAlias = Literal["agx-punchy", "agx", "aces", "linear"]
