"""The numbers of docs/limits.md are those of the code, where each is stated once, or by both languages alike."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from quadgraph.api import coefficients
from quadgraph.baking import kept, pipeline
from quadgraph.baking.colours import colour_options
from quadgraph.base import child_process, json_text, message, units
from quadgraph.file import npz
from quadgraph.mesh import gltf_file, ply_header
from quadgraph.mesh.looks import mtl, texture

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/limits.md").read_text()
ROWS = dict(re.findall(r"^\| ([^|]+) \| ([^|]+) \| [^|]*\|$", PAGE, re.MULTILINE))


def constant(file: str, name: str) -> float:
    """A number of C++: `name = 1e9f` or `name = std::uint64_t{4} << 30`."""
    text = (ROOT / "engine" / file).read_text()
    found = re.search(
        rf"\b{re.escape(name)} ?= ?(?:std::\w+\{{(\d+)\}} << (\d+)|([0-9.]+(?:e-?[0-9]+)?)f?)[,;}}]", text
    )
    assert found, f"{file}: {name}"
    return float(found[3]) if found[3] else int(found[1]) << int(found[2])


def brief(value: float) -> str:
    """1e15, 1e-4."""
    return re.sub(r"e\+?(-?)0?", r"e\1", f"{value:.0e}")


POWER, LENGTH = (constant("render/light/lights.h", name) for name in ("largest_power", "largest_length"))
COEFFICIENT = constant("../shaders/material/optics.h", "COEFFICIENT_MAX")
IRRADIANCE = constant("solve/beams.cpp", "irradiance_range{.low = 0, .high")
SMALL, LARGE = map(brief, units.SIZES_MM)
MAP_CELLS = constant("scene/source_domain.cpp", "most_cells")
FRAMES = constant("scene/scene_file.h", "most_frames")
ALLOWED = {
    "power, irradiance or radiance of a light, texels of images": f"0 to {brief(POWER)}",
    "scattering and absorption": f"0 to {brief(COEFFICIENT)} 1/mm",
    "irradiance given to `set_irradiance`": f"0 to {brief(IRRADIANCE)} W/mm²",
    "layers of edits": f"at most {constant('optics/edit_layer.h', 'most_layers'):,.0f} of a scene, with names of 1 to "
    f"{constant('optics/edit_layer.h', 'longest_layer_name'):,.0f} bytes",
    "lights of a scene": f"at most {constant('render/light/lights.h', 'most_lights'):,.0f}",
    "places and edges of lights": f"at most {brief(LENGTH)} mm from 0 in each direction",
    "angle of a spot or projector": f"{constant('render/light/light_kinds.cpp', 'least_angle'):g} degrees or more",
    "longest side of a body, and how far it reaches from 0": f"{SMALL} to {LARGE} mm",
    "`--frames`, `--frame`": f"at most {FRAMES:,.0f}",
    "values that keys of tracks change": f"{brief(constant('scene/scene_file.h', 'most_key_values'))}: of each part",
    "spacing and origin of a volume": f"at most {brief(LENGTH)} mm, as places of lights",
    "cells that `VolumeMaterial.from_function` samples": f"at most {coefficients.MOST_CELLS:,}",
    "cells of `quadgraph colours`": f"{colour_options.LEAST_CELLS:,} to {coefficients.MOST_CELLS:,}, "
    f"{colour_options.ColourOptions.cells:,} unless",
    "cells of a volume that is carried onto another shape": f"at most {MAP_CELLS:,.0f}",
    "`--time-limit`, `--memory-limit`": f"at most {brief(child_process.MOST_TIME_S)} s, "
    f"{brief(child_process.MOST_MEMORY_BYTES / 1e9)} GB",
    "number in the name of a frame": "one, `%0Nd`, N at most 9",
    "`--relax-nodes`": f"at most {pipeline.MOST_STEPS:,}",
    "bodies that are kept in the cache folder": f"{kept.MOST_BYTES / 1e9:g} GB, the longest unused go first",
}
NPZ = {name: constant("scene/npz.cpp", name) for name in ("free_bytes", "most_packed", "most_axes")}
IMAGE = {
    name: constant("render/light/image_file.cpp", name) for name in ("largest_side", "free_texels", "texels_a_byte")
}
SENTENCES = (
    f"at most {json_text.DEPTH} levels of brackets in each other and {json_text.BYTES >> 20} MiB",
    f"a member may take {NPZ['free_bytes'] / 2**20:g} MiB and {NPZ['most_packed']:g} times its packed bytes; "
    f"at most {NPZ['most_axes']:g} axes",
    f"at most {NPZ['free_bytes'] / 4e6:.3g} million numbers and {NPZ['most_packed'] / 8:g} for each byte of the file",
    f"at most {IMAGE['largest_side']:g} texels a side, {IMAGE['free_texels'] / 1e6:g} million texels and "
    f"{IMAGE['texels_a_byte']:g} for each byte of the file",
    f"at most {texture.MOST_PIXELS / 1e6:g} million pixels and {texture.MOST_BYTES >> 20} MiB, which",
    f"{texture.MOST_TOGETHER / 1e6:g} million pixels in all",
    f"kept at most {constant('render/light/image_file.h', 'largest_kept'):g} texels a side",
    f"`strength` is 0 to {constant('render/display/normal_map.h', 'high'):g}",
    f"coordinates at most {brief(texture.MOST_UV)}; a `.mtl` at most {mtl.MOST_BYTES >> 20} MiB",
    f"a header has at most {ply_header.HEADER_BYTES >> 10} KiB",
    f"transforms with numbers above {brief(gltf_file.LARGEST)}, are refused",
)


def test_every_row_of_the_page_is_held_to_the_code():
    assert set(ROWS) - {"what", "---"} == set(ALLOWED)


@pytest.mark.parametrize("row", ALLOWED)
def test_a_row_says_what_the_code_allows(row):
    assert (
        ROWS[row].replace("1e+0", "1e").startswith(re.sub(r"e([+-])0", lambda e: "e" + e[1].strip("+"), ALLOWED[row]))
    )


@pytest.mark.parametrize("sentence", SENTENCES)
def test_a_sentence_says_what_the_code_allows(sentence):
    assert sentence in " ".join(PAGE.split())


def test_both_languages_have_the_same_bounds():
    assert tuple(constant("base/json_text.h", name) for name in ("json_depth", "json_bytes")) == (
        json_text.DEPTH,
        json_text.BYTES,
    )
    assert tuple(constant("file/validate_geometry.cpp", n) for n in ("least_size", "largest_size")) == units.SIZES_MM
    assert constant("base/message.h", "message_bytes") == message.MOST
    assert list(NPZ.values()) == [npz.FREE_BYTES, npz.MOST_PACKED, npz.MOST_AXES]
