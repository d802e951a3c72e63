"""How coefficients that differ from place to place are looked for."""

from __future__ import annotations

from dataclasses import dataclass

TOTAL_VARIATION, H1, PUBLISHED = "total-variation", "h1", "published"
SCHEMES = (TOTAL_VARIATION, H1, PUBLISHED)


@dataclass(frozen=True)
class VolumeOptions:
    """spacing: of the points where they are unknown, mm, None: as `volume_model` sees fit; scheme: of `SCHEMES`, the
    default or one of the baselines that it is held against.
    """

    spacing: float | None = None
    scheme: str = TOTAL_VARIATION
