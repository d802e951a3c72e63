"""The record of tools/gpu: tests, picture and benchmarks of one device in gpu.json, and a summary that is printed."""

from __future__ import annotations

import argparse
import json
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from quadgraph.base import atomic_file
from quadgraph.base.relative_error import relative_rms
from quadgraph.core import load_core

SCHEMA = "quadgraph-gpu/1"
_PARTS = ("live", "live-1024", "passes", "solvers", "scaling")
_PROCESSOR = "quadgraph cpu "  # what the drivers of processors are called
_MACHINE = ("device", "driver", "copy", "cores", "commit", "version")


def device(name: str) -> str:
    """The whole name of the device of that name, "" for the first GPU; "" if that is the processor."""
    found = load_core().copy_bandwidth(name)
    return "" if found["driver"].startswith(_PROCESSOR) else str(found["device"])


def record(folder: Path) -> dict[str, Any]:
    """All that the steps left in the folder: `tests` and `picture` by outcome, benchmarks by their flat figures."""
    parts = {name: json.loads(path.read_text()) for name in _PARTS if (path := folder / f"{name}.json").exists()}
    first: dict[str, Any] = next(iter(parts.values()), {})
    return {
        "schema": SCHEMA,
        **{key: first[key] for key in _MACHINE if key in first},
        "tests": {path.stem: _outcome(path) for path in sorted(folder.glob("tests-*.status"))},
        "picture": _pictures(folder),
        "figures": {name: part["figures"] for name, part in parts.items()},
    }


def _outcome(path: Path) -> dict[str, Any]:
    status, seconds = path.read_text().split()
    log = path.with_suffix(".log").read_text(errors="replace")
    found = re.search(r"test cases: *(\d+) \| *(\d+) passed \| *(\d+) failed", log)
    cases = dict(zip(("cases", "passed", "failed"), map(int, found.groups()), strict=True)) if found else {}
    return {"exit_status": int(status), "seconds": float(seconds)} | cases


def _pictures(folder: Path) -> dict[str, Any]:
    """Relative RMS difference of the GPU's picture to the processor's, and the most that a channel differs, of 255."""
    paths = folder / "gpu.png", folder / "cpu.png"
    if not all(path.exists() for path in paths):
        return {}
    there, here = (np.asarray(Image.open(path).convert("RGB"), np.float64).reshape(-1, 3) for path in paths)
    return {"rms": relative_rms(np.ones(len(here)), there - here, here), "most": int(np.abs(there - here).max())}


def summary(found: dict[str, Any]) -> list[str]:
    """Lines for people."""
    lines = [", ".join(f"{key}: {found[key]}" for key in ("device", "driver", "commit") if key in found)]
    if "copy" in found:
        lines.append(f"copies {found['copy']['gb_per_s']:.0f} GB/s")
    for name, test in found["tests"].items():
        lines.append(f"{name}: exit status {test['exit_status']}, {test.get('passed', 0)} of {test.get('cases', 0)}")
    if found["picture"]:
        lines.append("picture: {rms:.2%} RMS off the processor's, at most {most} of 255".format(**found["picture"]))
    for part, of_part in found["figures"].items():
        lines += [f"{part}: {line}" for line in _times(of_part)]
    return lines


def _times(of_part: dict[str, Any]) -> list[str]:
    """Frames with the sum of their passes, and solves."""
    lines = []
    for name, figure in of_part.items():
        if figure["unit"] != "ms" or "wall" in name:
            continue
        if name.startswith("frame/") and name.count("/") == 2:
            passes = [of_part[each]["value"] for each in of_part if each.startswith(name[:-2]) and each != name]
            lines.append(f"{name}: {figure['value']:.4g} ms by the clock, {sum(passes):.4g} ms of passes")
        elif name.startswith(("solvers/", "scaling/")):
            lines.append(f"{name}: {figure['value']:.4g} ms")
    return lines


def main() -> int:
    """`device NAME` prints a device's whole name; `summary FOLDER` writes gpu.json there and prints what is in it.

    Exit status 1 if there is no GPU, or if a test failed.
    """
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("device", "summary"))
    parser.add_argument("of", help="part of a device's name, or the folder")
    args = parser.parse_args()
    if args.what == "device":
        found_device = device(args.of)
        print(found_device)
        return 0 if found_device else 1
    found = record(Path(args.of))
    atomic_file.write_json(Path(args.of) / "gpu.json", found)
    print("\n".join(summary(found)))
    return int(any(test["exit_status"] for test in found["tests"].values()))


if __name__ == "__main__":
    sys.exit(main())
