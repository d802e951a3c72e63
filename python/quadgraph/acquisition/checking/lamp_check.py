"""What is to be said against lamps that photographs of the board told."""

from __future__ import annotations

from collections.abc import Mapping

from quadgraph.acquisition.checking.import_record import FoundLamp

_FEW = 3  # photographs of the board, from which on the lens's own fall-off is told from the lamp's
_POOR_OFF, _MOST_OFF = 0.03, 0.2  # of the paper's brightness, RMS
_POOR_SHARE = 0.1  # of the light on the board that is not the lamp's
_POOR_PIXELS, _MOST_PIXELS = 0.7, 3.0  # RMS distance of the board's corners, and of a camera that moved


def judge(lamps: Mapping[str, FoundLamp], said: list[str], wrong: list[str]) -> None:
    """Add what is worth a look, and what cannot be used, with its path into the capture."""
    for name, lamp in lamps.items():
        where = f"lights.{name}"
        if lamp.boards < _FEW:
            said.append(
                f"{where}: told by {lamp.boards} of the board's photographs; what the lens darkens towards the corners "
                f"is taken for the lamp's: take {_FEW} or more, from around"
            )
        if lamp.off > _POOR_OFF:
            (wrong if lamp.off > _MOST_OFF else said).append(
                f"{where}: the board is lit otherwise than by one small lamp, {lamp.off:.1%} off (RMS); is it glossy "
                "or shaded, or were other lamps on?"
            )
        if lamp.unlike:
            said.append(
                f"{where}: the board is lit as by the other kind of lamp: a bulb that shines all around is type point, "
                "an LED or a diffuser that shines forwards type rectangle; the wrong one is placed wrong, by tens of mm"
            )
        if lamp.share > _POOR_SHARE:
            said.append(
                f"{where}: {lamp.share:.0%} of the light on the board is not the lamp's; switch it off, or state it as "
                "a light of type ambient"
            )
        for what, pixels in (("the board's corners are off", lamp.worst), ("the camera moved", lamp.moved)):
            if pixels > _POOR_PIXELS:
                (wrong if pixels > _MOST_PIXELS else said).append(
                    f"{where}: {what} by {pixels:.1f} pixels in a photograph of the board; take it again"
                )
