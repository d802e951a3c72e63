"""Families of cases: each a module of recipes, functions that draw a case by random numbers."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from attack.case import Case
from attack.families import api, commands, data, load, looks, meshes, outputs, scenes, sealed, sections, signals

Recipe = Callable[[np.random.Generator], Case]

FAMILIES: dict[str, tuple[Recipe, ...]] = {
    "sealed": (*sealed.RECIPES, *sections.RECIPES),
    "meshes": (*meshes.RECIPES, *looks.RECIPES),
    "data": data.RECIPES,
    "scenes": scenes.RECIPES,
    "commands": (*commands.RECIPES, *outputs.RECIPES),
    "api": api.RECIPES,
    "signals": signals.RECIPES,
    "load": load.RECIPES,
}
