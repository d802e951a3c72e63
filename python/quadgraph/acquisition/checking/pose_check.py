"""What is to be said against a body's pose that masks told."""

from __future__ import annotations

from quadgraph.acquisition.pose.pose_search import PoseByMasks

_POOR_OFF = 1.0  # pixels, RMS, of outlines from the masks' edges
_POOR_MM, _POOR_DEGREES = 0.5, 2.0  # standard deviations
_BELOW, _ABOVE = -1.0, 1.0  # mm over the board, of the lowest place


def judge(pose: PoseByMasks | None, said: list[str]) -> None:
    """Add what is worth a look."""
    if pose is None:
        return
    if pose.off > _POOR_OFF:
        said.append(
            f"pose: outlines are {pose.off:.1f} pixels off the masks (RMS): do these show all of the body and nothing "
            "else, and is the mesh its shape?"
        )
    if pose.degrees is not None and pose.mm is not None and (pose.degrees > _POOR_DEGREES or pose.mm > _POOR_MM):
        said.append(
            f"pose: told to {pose.degrees:.2g} degrees and {pose.mm:.2g} mm; masks from more sides tell it better"
        )
    said += [
        f"{path}: its mask shares {share:.0%} with the body where the others say that it is, and was left out: is a "
        "part of the body missing, as of an unlit side? Make one by hand"
        for path, share in pose.others.items()
    ]
    if pose.lowest < _BELOW:
        said.append(
            f"pose: the body reaches {-pose.lowest:.1f} mm below the board: is the mesh its shape, in its unit, and "
            "were the rulers measured?"
        )
    elif pose.lowest > _ABOVE:
        said.append(f"pose: the body hovers {pose.lowest:.1f} mm over the board: did it lie on something?")
