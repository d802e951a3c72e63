"""Whether a capture can be used: of each photograph poses, exposure and agreement; of all what they cover."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from quadgraph.acquisition.board.board import RULER_MM
from quadgraph.acquisition.cameras.lens import PinholeView
from quadgraph.acquisition.cameras.placed_body import FLAT, PlacedBody, of_capture, view_of
from quadgraph.acquisition.capture import photographs
from quadgraph.acquisition.capture.capture import Capture
from quadgraph.acquisition.capture.photographs import Measured
from quadgraph.acquisition.checking import import_record, lamp_check, pose_check
from quadgraph.acquisition.checking.import_record import FoundLamp, Imported, Record
from quadgraph.acquisition.pose.pose_search import PoseByMasks

SAMPLES = 4000  # places of the surface
_LEAST_BODY = 16  # pixels, as acquire wants them
_POOR_SHARE, _LEAST_SHARE = 0.5, 0.05  # of the body's pixels that count
_POOR_SIGNAL, _LEAST_SIGNAL = 10.0, 2.0  # standard deviations of the median pixel
_POOR_PIXELS, _MOST_PIXELS = 0.7, 3.0  # RMS distance of the board's corners
_UNLIKE = 3.0  # medians of the other photographs, beyond which one disagrees
_LEAST_UNLIKE = 0.2  # pixels
_POOR_MOVE, _MOST_MOVE = 0.5, 3.0  # pixels between exposures of one photograph
_POOR_RATIO, _MOST_RATIO = 1.05, 1.5  # of exposures against what is stated
_BRIGHTER = 1.5  # times, beyond which a photograph disagrees with others under the same lights
_LEAST_COVERED, _POOR_COVERED = 0.02, 0.25  # of the surface, seen and lit
_FEW_WAYS = 40.0  # degrees between the widest two cameras
_COMMON = 50  # places that photographs have to have in common to be compared


@dataclass
class JudgedPhotograph:
    """One photograph. body: share of its pixels that show the body; counts: share of those that are neither masked nor
    saturated; signal: of the median one, standard deviations; brightness: times what the others under the same lights
    show of the same places, None where none can be compared; outline: (h, w), where the body ends; cosines: (n,) of
    the samples, 0 where they are not seen; lit: the same of its lights.
    """

    measured: Measured
    view: PinholeView | None
    imported: Imported | None
    body: float
    counts: float
    signal: float
    outline: np.ndarray
    cosines: np.ndarray
    lit: np.ndarray
    brightness: float | None = None
    poor: list[str] = field(default_factory=list)
    wrong: list[str] = field(default_factory=list)

    @property
    def verdict(self) -> str:
        """In one word."""
        return "unusable" if self.wrong else "look at it" if self.poor else "fine"


@dataclass
class Checked:
    """A whole capture. seen, twice, used: shares of the surface that a photograph sees, two see, and one sees lit;
    widest: degrees between two cameras; counts: (n,) of how many photographs see each sample lit.
    """

    capture: Capture
    body: PlacedBody
    record: Record | None
    judged: list[JudgedPhotograph]
    counts: np.ndarray
    seen: float
    twice: float
    used: float
    widest: float
    said: list[str]
    wrong: list[str]

    @property
    def unusable(self) -> bool:
        """Whether anything cannot be used."""
        return bool(self.wrong) or any(each.wrong for each in self.judged)

    def reasons(self) -> list[str]:
        """All that cannot be used, with its path into the capture."""
        return [*self.wrong, *(f"{each.measured.stated.path}: {text}" for each in self.judged for text in each.wrong)]

    def doubts(self) -> list[str]:
        """All that is worth a look, with its path into the capture."""
        return [*self.said, *(f"{each.measured.stated.path}: {text}" for each in self.judged for text in each.poor)]

    def lines(self) -> list[str]:
        """The summary, a line a photograph."""
        lines = []
        for each in self.judged:
            stated = each.measured.stated
            parts = [f"{stated.path} ({stated.file.name})"]
            if each.imported and each.imported.reprojection is not None:
                imported = each.imported
                parts.append(f"{len(imported.corners)} corners, {imported.reprojection:.2f} pixels off")
            parts.append(f"body {each.body:.0%} of it, of which {each.counts:.0%} counts, {each.signal:.0f} deviations")
            lines.append(f"{'; '.join(parts)}: {each.verdict}")
        lines += [f"lamp {name}: {lamp.line()}" for name, lamp in self.lamps().items()]
        lines += [f"pose: {self.pose.line()}"] if self.pose else []
        lines.append(f"scale: {self.scale()}")
        lines.append(
            f"surface: {self.seen:.0%} seen, {self.twice:.0%} twice or more, {self.used:.0%} seen and lit; cameras up "
            f"to {self.widest:.0f} degrees apart"
        )
        lines += [f"look at it: {text}" for text in self.doubts()]
        lines += [f"unusable: {text}" for text in self.reasons()]
        return lines if self.unusable else [*lines, "can be used: quadgraph acquire"]

    def lamps(self) -> Mapping[str, FoundLamp]:
        """Those that photographs of the board told, by their names."""
        return self.record.lamps if self.record else {}

    @property
    def pose(self) -> PoseByMasks | None:
        """That of the body, where masks told it."""
        return self.record.pose if self.record else None

    def scale(self) -> str:
        """What the lengths rest on."""
        if self.record is None or self.record.printed is None:
            return "as the capture states it; no board tells it"
        x, y = self.record.printed
        if x == y == RULER_MM:
            return "the board as it was drawn: both rulers 150 mm; measure them"
        return f"the board as measured: its rulers of 150 mm are {x:g} mm along x and {y:g} mm along y"

    def report(self) -> dict[str, Any]:
        """Everything but pictures, for a file."""
        each = [
            {
                "photograph": one.measured.stated.path,
                "verdict": one.verdict,
                "body": one.body,
                "counts": one.counts,
                "signal": one.signal,
                "brightness": one.brightness,
                "reprojection": one.imported.reprojection if one.imported else None,
                "said": [*one.wrong, *one.poor],
            }
            for one in self.judged
        ]
        surface = {"seen": self.seen, "twice": self.twice, "seen_and_lit": self.used}
        whole = {"unusable": self.reasons(), "look_at": self.doubts(), "scale": self.scale()}
        lamps = {name: asdict(lamp) for name, lamp in self.lamps().items()}
        pose = asdict(self.pose) if self.pose else None
        return {**whole, "lamps": lamps, "pose": pose, "surface": surface, "widest": self.widest, "photographs": each}


def record_of(path: Path) -> Path:
    """Where the record of an import is, if there is one."""
    return import_record.place_of(path)


def check(capture: Capture) -> Checked:
    """Judge a capture. Raises InputError for what acquire would refuse, too."""
    record = import_record.read(capture.path)
    body = of_capture(capture)
    places, triangles = body.samples(SAMPLES)
    judged = []
    for number, measured in enumerate(photographs.read_all(capture)):
        imported = record.photographs.get(measured.stated.camera) if record else None
        judged.append(_judged(capture, body, measured, imported, (places, triangles)))
        _judge(judged[number])
    _compare_corners(judged)
    _compare_brightness(judged, places)
    covered = np.array([(each.cosines > FLAT) & (each.lit > FLAT) for each in judged])
    seen = np.array([each.cosines > FLAT for each in judged]).sum(axis=0)
    counts = covered.sum(axis=0)
    checked = Checked(
        capture,
        body,
        record,
        judged,
        counts,
        float((seen > 0).mean()),
        float((seen > 1).mean()),
        float((counts > 0).mean()),
        _widest(body, judged),
        [],
        [],
    )
    _judge_whole(checked, places)
    lamp_check.judge(checked.lamps(), checked.said, checked.wrong)
    pose_check.judge(checked.pose, checked.said)
    return checked


def _judged(
    capture: Capture,
    body: PlacedBody,
    measured: Measured,
    imported: Imported | None,
    samples: tuple[np.ndarray, np.ndarray],
) -> JudgedPhotograph:
    stated = measured.stated
    view = view_of(capture.cameras[stated.camera], capture.sizes[stated.camera])
    height, width, _ = measured.values.shape
    places, triangles = samples
    lit = np.max([body.lit_by(places, triangles, capture.lights[name]) for name in stated.lights], axis=0)
    if view is None:
        none = np.zeros((height, width), bool)
        return JudgedPhotograph(measured, None, imported, 0.0, 0.0, 0.0, none, np.zeros(len(places)), lit)
    across, down = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    shows = body.seen_by(view, np.stack([across.ravel(), down.ravel()], axis=1)).reshape(height, width) >= 0
    inside = measured.usable & shows[..., None]
    signal = 0.0
    if inside.any():
        signal = float(np.median(measured.values[inside] / np.sqrt(measured.variance_of(measured.values)[inside])))
    count = inside.sum() / max(3 * shows.sum(), 1)
    edge = shows & ~(_shifted(shows, 1, 0) & _shifted(shows, -1, 0) & _shifted(shows, 0, 1) & _shifted(shows, 0, -1))
    cosines = body.cosine_to(places, triangles, view.eye) * _within(view, places)
    return JudgedPhotograph(measured, view, imported, float(shows.mean()), float(count), signal, edge, cosines, lit)


def _shifted(picture: np.ndarray, down: int, right: int) -> np.ndarray:
    return np.roll(picture, (down, right), (0, 1))


def _within(view: PinholeView, places: np.ndarray) -> np.ndarray:
    """(n,) which places are in the picture."""
    seen = view.pose.seen(places)
    before = seen[:, 2] > 0
    at = view.lens.places(seen[:, :2] / np.where(before, seen[:, 2], 1)[:, None])
    return np.asarray(before & (at >= 0).all(axis=1) & (at < [view.width, view.height]).all(axis=1))


def _judge(one: JudgedPhotograph) -> None:
    """What a photograph says of itself."""
    height, width, _ = one.measured.values.shape
    if one.view is None:
        one.poor.append("the camera is given by angles or orthographic: what it covers is not looked at")
        return
    if one.body * height * width < _LEAST_BODY:
        one.wrong.append("the body is not in it: check body, unit, deformation and the camera (mm)")
        return
    if one.counts < _POOR_SHARE:
        text = f"{1 - one.counts:.0%} of the body is saturated or masked; expose for less, or mask less"
        (one.wrong if one.counts < _LEAST_SHARE else one.poor).append(text)
    if one.signal < _POOR_SIGNAL and one.counts > 0:
        text = f"the median pixel of the body is {one.signal:.1f} standard deviations; expose for longer"
        (one.wrong if one.signal < _LEAST_SIGNAL else one.poor).append(text)
    if one.imported is None:
        return
    if one.imported.moved > _POOR_MOVE:
        text = f"the camera moved by {one.imported.moved:.1f} pixels between its exposures; use a tripod and a timer"
        (one.wrong if one.imported.moved > _MOST_MOVE else one.poor).append(text)
    off = max((max(each, 1 / each) for each in one.imported.ratios if each > 0), default=1.0)
    if off > _POOR_RATIO:
        text = f"two of its exposures are {off:.2f} times further apart than stated; check exposure times, or the lamp"
        (one.wrong if off > _MOST_RATIO else one.poor).append(text)


def _compare_corners(judged: Sequence[JudgedPhotograph]) -> None:
    """Photographs in which the board lies elsewhere than in the others."""
    errors = {n: each.imported.reprojection for n, each in enumerate(judged) if each.imported is not None}
    told = {n: error for n, error in errors.items() if error is not None}
    for number, error in told.items():
        others = [other for n, other in told.items() if n != number]
        usual = float(np.median(others)) if others else error
        text = f"the board's corners are {error:.2f} pixels off (RMS), {usual:.2f} in the others"
        if error > _MOST_PIXELS:
            judged[number].wrong.append(f"{text}: the pose is wrong; is the board bent, or out of focus?")
        elif error > _POOR_PIXELS or error > max(_UNLIKE * usual, _LEAST_UNLIKE):
            judged[number].poor.append(f"{text}: it disagrees with them; is it sharp, and the board flat?")


def _compare_brightness(judged: Sequence[JudgedPhotograph], places: np.ndarray) -> None:
    """Photographs of the same lights and gain that show the same places brighter or darker than the others."""
    groups: dict[tuple[Any, ...], list[int]] = {}
    for number, each in enumerate(judged):
        stated = each.measured.stated
        if each.view is not None and not each.wrong:
            groups.setdefault((stated.lights, stated.gain), []).append(number)
    for members in groups.values():
        if len(members) < 3:
            continue
        values = np.array([_radiance(judged[number], places) for number in members])
        for row, number in enumerate(members):
            others = np.delete(values, row, axis=0)
            common = np.isfinite(values[row]) & (np.isfinite(others).sum(axis=0) > 0)
            if common.sum() < _COMMON:
                continue
            off = float(np.median(values[row][common] - np.nanmedian(others[:, common], axis=0)))
            judged[number].brightness = math.exp(off)
            if abs(off) > math.log(_BRIGHTER):
                judged[number].poor.append(
                    f"it is {math.exp(off):.2f} times as bright as the others under the same lights: exposure, gain or "
                    "lights are stated wrong"
                )


def _radiance(one: JudgedPhotograph, places: np.ndarray) -> np.ndarray:
    """(n,) logarithm of what a photograph shows of places, nan where they are not seen or do not count."""
    view, stated = one.view, one.measured.stated
    assert view is not None
    seen = view.pose.seen(places)
    at = view.lens.places(seen[:, :2] / np.maximum(seen[:, 2:], 1e-9))
    columns, rows = np.clip(np.floor(at).astype(int), 0, [view.width - 1, view.height - 1]).T
    value = one.measured.values[rows, columns].mean(axis=1) / stated.exposure
    fine = (one.cosines > 2 * FLAT) & one.measured.usable[rows, columns].all(axis=1) & (value > 0)
    return np.where(fine, np.log(np.where(fine, value, 1)), np.nan)


def _widest(body: PlacedBody, judged: Sequence[JudgedPhotograph]) -> float:
    ways = np.array([each.view.eye - body.middle for each in judged if each.view is not None])
    if len(ways) < 2:
        return 0.0
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    return float(np.degrees(np.arccos(np.clip(ways @ ways.T, -1, 1))).max())


def _judge_whole(checked: Checked, places: np.ndarray) -> None:
    if all(each.view is None for each in checked.judged):
        return
    if checked.used < _LEAST_COVERED:
        checked.wrong.append(
            f"photographs: {checked.used:.0%} of the surface is seen and lit; check places of cameras and lights, mm"
        )
    elif checked.used < _POOR_COVERED:
        off = places[checked.counts == 0].mean(axis=0) - checked.body.middle
        axis = int(np.abs(off).argmax())
        side = f"{'+' if off[axis] > 0 else '-'}{'xyz'[axis]}"
        checked.said.append(
            f"photographs: {checked.used:.0%} of the surface is seen and lit; most is missing towards {side}: add "
            "photographs from there"
        )
    if checked.widest < _FEW_WAYS:
        checked.said.append(
            f"cameras: at most {checked.widest:.0f} degrees apart; photographs from more sides say more"
        )
