"""Records of charts that nobody measured, for tests of what is drawn from them."""

from __future__ import annotations

from quadgraph_validation.chart.chart_record import FORMAT

FAMILIES = ("fem, SP₃", "fem, diffusion", "quadgraph-fdm, as published", "dipole per vertex")


def point(family: str, level: int, ms: float, error: float, cycles: int = 0) -> dict:
    """One point: its unlit errors are three times the others, against transport there is .02 more."""
    settings = {"method": "fem", "model": "sp3", "source": "buried", "solver": "fmg-pcg", "level": level}
    settings |= {"inter_reflection": False, "radiance": "gathered", "cycles": cycles, "runs_on": "device"}
    settings |= {"bake": "chain", "K": None}
    return {
        "name": f"{family} · level {level} · fmg-pcg" + (f" · {cycles} cycles a frame" if cycles else ""),
        "family": family,
        "settings": settings,
        "ms": ms,
        "ms_range": [0.9 * ms, 1.2 * ms],
        "stages": {"light": 0.1 * ms, "source": 0.1 * ms, "solve": 0.5 * ms, "exitance": 0.1 * ms, "picture": 0.2 * ms},
        "passes": {"smoothing": 0.5 * ms},
        "errors": {
            "pde": {"whole": error, "unlit": 3 * error},
            "transport": {"whole": error + 0.02, "unlit": 3 * error + 0.02},
        },
    }


def record(scenes: tuple[str, ...] = ("bunny", "sphere")) -> dict:
    """Four families on three levels each, one with a budget of cycles, and one that failed."""
    points = [
        point(family, level, 40 * (k + 1) * 0.4**level, 0.01 * (k + 1) * 2**level)
        for k, family in enumerate(FAMILIES)
        for level in range(3)
    ]
    points.append(point(FAMILIES[0], 0, 25, 0.012, cycles=2))
    failed = {"name": "jacobi", "family": FAMILIES[1], "settings": points[0]["settings"], "failed": "does not converge"}
    noise = {"pde": {"sp3, buried": {"whole": 0.002, "unlit": 0.004}}, "transport": {"whole": 0.005, "unlit": 0.01}}
    levels = [{"surface_vertices": 7000 // 4**k, "tets": 30000 // 4**k, "faces": 14000 // 4**k} for k in range(3)]
    run = {"device": "a device (256 bits)", "driver": "1.0", "cores": 2, "load": 0.1, "commit": "0123456789ab"}
    run |= {"repeats": 3, "frame": {"pixels": 256, "light_turns_degrees": 5.0, "even_light_dims": 0.05}}
    return {
        "format": FORMAT,
        "scenes": [
            {
                "name": name,
                "run": run,
                "height_mm": 100,
                "eta": 1.3,
                "light": "ambient:1",
                "levels": levels,
                "bakes": [],
                "truth": noise | {"blocks": {"whole": 300, "unlit": 90}},
                "points": [*points, failed],
            }
            for name in scenes
        ],
    }
