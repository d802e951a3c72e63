"""What may be wrong with photographs themselves, or with what is said of a single one: each as another assumption."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy import ndimage

from quadgraph.acquisition.causes.bank import Bank, Gathered, Otherwise, logarithms

FLIPS = {"left to right": np.s_[:, ::-1], "upside down": np.s_[::-1, :], "by half a turn": np.s_[::-1, ::-1]}
_ENCODED = 2.2  # power of light to which values for displays are raised again
_BLURS = (1.0, 2.0, 4.0)  # pixels, standard deviations
_SUM, _SHARE = 4.0, 0.002  # standard errors, and of the brightest, that the mean beside the body is at least
_BACKGROUND = 30  # values beside the body, at least
_DARK = 0.03  # of what is predicted, below which a photograph is dark
_ALIKE = 0.1  # relative differences of factors that may be the same


@dataclass(frozen=True, eq=False)
class Suspect:
    """Something that may be wrong. kind: of its like only the best is said; otherwise: what is true instead, by
    photograph; handicap: by what its cost counts more, since it has more freedom; text: what to say, or what says it
    from the factors (p, 3) of photographs under it.
    """

    kind: str
    otherwise: dict[int, Otherwise]
    handicap: float
    text: str | Callable[[np.ndarray], str]

    def sentence(self, factors: np.ndarray) -> str:
        """What to say."""
        return self.text if isinstance(self.text, str) else self.text(factors)


Scope = tuple[int, ...]


def scopes(bank: Bank) -> Iterator[Scope]:
    """Photographs that may share a mistake: each, all of a camera, all under the same lights, and all."""
    stated = [one.stated for one in bank.problem.measured]
    found: dict[Scope, None] = {(number,): None for number in range(len(stated))}
    for names in ([each.camera for each in stated], [each.lights for each in stated]):
        for name in dict.fromkeys(names):
            found[tuple(number for number, each in enumerate(names) if each == name)] = None
    found[tuple(range(len(stated)))] = None
    yield from found


def suspects(bank: Bank) -> Iterator[Suspect]:
    """Everything that may be wrong without another prediction."""
    for scope in scopes(bank):
        yield from _turned(bank, scope)
        yield from _gain(bank, scope)
        yield _encoded(bank, scope)
        yield _channels(bank, scope)
        yield from _raised(bank, scope)
        yield from _blurred(bank, scope)
    yield from _swapped(bank)
    yield from _wrong_lights(bank)


def paths(bank: Bank, scope: Sequence[int], member: str) -> str:
    """A member of photographs, as the capture has them."""
    if len(scope) == len(bank.seen) > 1:
        return f"photographs.{member}"
    return ", ".join(f"{bank.problem.measured[number].stated.path}.{member}" for number in scope)


def _fits(scope: Sequence[int]) -> str:
    return "fits" if len(scope) == 1 else "fit"


def _turned(bank: Bank, scope: Scope) -> Iterator[Suspect]:
    for name, turn in FLIPS.items():
        otherwise = {number: Otherwise(seen=_mapped(bank.seen[number], turn)) for number in scope}
        text = (
            f"{paths(bank, scope, 'file')}: {_fits(scope)} much better turned {name}: an axis of the picture or of the "
            "camera is flipped; turn the picture, or check `up` of its camera"
        )
        yield Suspect("turned", otherwise, 1.0, text)


def _mapped(seen: Gathered, index: Any) -> Gathered:
    """A photograph whose pixels or channels lie elsewhere."""
    return replace(seen, values=seen.values[index], noise=seen.noise[index], usable=seen.usable[index])


def _gain(bank: Bank, scope: Scope) -> Iterator[Suspect]:
    problem = bank.problem
    groups = problem.group[list(scope)]
    if all(group >= 0 and (problem.group == group).sum() == 1 for group in groups):
        return  # nothing is said of them
    otherwise = {number: Otherwise(gain="theirs") for number in scope}
    yield Suspect("gain", otherwise, 1.1, lambda factors: _of_gain(bank, scope, factors))


def _of_gain(bank: Bank, scope: Scope, factors: np.ndarray) -> str:
    """Whose factor is off, and by how much, against photographs of the same gain: of one photograph, or of lights."""
    stated = [bank.problem.measured[number].stated for number in scope]
    group = bank.problem.group
    others = [n for n in range(len(group)) if n not in scope and group[n] == group[scope[0]] >= 0]
    factor = factors[list(scope)] / (np.exp(np.log(factors[others]).mean(axis=0)) if others else 1.0)
    if factor.max() < _DARK:
        return (
            f"{paths(bank, scope, 'file')}: dark, at most {factor.max():.2g} of the light that is predicted: the light "
            f"was off, or it is another photograph; take it again under {' + '.join(stated[0].lights)}, or leave it out"
        )
    same = factor.max() / factor.min() < 1 + 2 * _ALIKE
    size = f"{np.exp(np.log(factor).mean()):.3g}" if same else " / ".join(f"{x:.3g}" for x in factor.mean(axis=0))
    under = {each.lights for each in stated}
    lit = [n for n, one in enumerate(bank.problem.measured) if one.stated.lights in under]
    causes = [f"{paths(bank, scope, 'exposure')} (or gain)"]
    if len(under) == 1 and lit == list(scope):
        powers = " or ".join(f"lights.{name}.{_strength(bank, name)}" for name in stated[0].lights)
        causes.insert(0 if len(scope) > 1 else 1, powers)
    return (
        f"{' or '.join(causes)}: values are {size} times what is predicted{'' if same else ' (red / green / blue)'}; "
        "state what is true, or leave the gain out, so that it is unknown"
    )


def _strength(bank: Bank, light: str) -> str:
    """What the strength of a light is called."""
    stated = bank.problem.capture.lights[light]
    return next((name for name in ("power", "irradiance", "radiance") if name in stated), "power")


def _encoded(bank: Bank, scope: Scope) -> Suspect:
    def decoded(seen: Gathered) -> Gathered:
        values = np.maximum(seen.values, 0)
        white = max(float(values.max()), 1e-300)
        relative = seen.noise / np.maximum(values, 1e-3 * white) ** 2 * _ENCODED**2
        values = white * (values / white) ** _ENCODED
        return replace(seen, values=values, noise=relative * values**2)

    otherwise = {number: Otherwise(seen=decoded(bank.seen[number]), gain=str(number)) for number in scope}
    text = (
        f"{paths(bank, scope, 'file')}: values go with the power {1 / _ENCODED:.2f} of what is predicted: they are "
        "probably encoded for displays (sRGB), or have a tone curve; develop them linearly"
    )
    return Suspect("encoded", otherwise, 1.2 + 0.05 * len(scope), text)


def _channels(bank: Bank, scope: Scope) -> Suspect:
    otherwise = {number: Otherwise(seen=_mapped(bank.seen[number], np.s_[..., ::-1])) for number in scope}
    text = (
        f"{paths(bank, scope, 'file')}: {_fits(scope)} much better with red and blue exchanged: the channels are in "
        "the order blue, green, red; write them as red, green, blue"
    )
    return Suspect("channels", otherwise, 1.0, text)


def background(seen: Gathered) -> np.ndarray | None:
    """(3,) medians of what lies beside the body, where they are certainly not 0; None where they may be."""
    beside = seen.beside & seen.usable.all(axis=2)
    if beside.sum() < _BACKGROUND:
        return None
    values = seen.values[beside]
    middle = np.median(values, axis=0)
    error = 1.25 * np.sqrt((np.median(seen.noise[beside], axis=0)) / len(values))
    least = _SHARE * np.quantile(seen.values, 0.99, axis=(0, 1))
    uneven = np.subtract(*np.quantile(values, (0.9, 0.1), axis=0))
    even = uneven < 0.5 * np.abs(middle) + 5 * error * np.sqrt(len(values))
    return middle if ((np.abs(middle) > _SUM * error + least) & even).any() else None


def _raised(bank: Bank, scope: Scope) -> Iterator[Suspect]:
    levels = {number: background(bank.seen[number]) for number in scope}
    if any(level is None for level in levels.values()):
        return
    otherwise = {}
    for number, level in levels.items():
        seen = bank.seen[number]
        otherwise[number] = Otherwise(seen=replace(seen, values=seen.values - level))
    share = np.mean([levels[n] / np.quantile(bank.seen[n].values, 0.99, axis=(0, 1)) for n in scope])
    text = (
        f"{paths(bank, scope, 'file')}: {_fits(scope)} much better less what is seen beside the body, {share:.1%} of "
        "the brightest: the black level of the camera was not subtracted, or other light is in the picture; subtract a "
        "photograph with the lights off"
    )
    yield Suspect("raised", otherwise, 1.05, text)


def _blurred(bank: Bank, scope: Scope) -> Iterator[Suspect]:
    for size in _BLURS:
        width = size / bank.side
        otherwise = {number: Otherwise(nodes=_blur(bank.nodes[number], width)) for number in scope}
        text = (
            f"{paths(bank, scope, 'file')}: {_fits(scope)} much better if what is predicted is blurred, by a standard "
            f"deviation of {size:g} pixels: out of focus, or moved; take it again"
        )
        yield Suspect("blurred", otherwise, 1.1, text)


def _blur(nodes: np.ndarray, width: float) -> np.ndarray:
    """Logarithms of pictures, blurred by a standard deviation in squares."""
    return logarithms(ndimage.gaussian_filter(np.exp(nodes), (0, width, width, 0)))


def _swapped(bank: Bank) -> Iterator[Suspect]:
    """Files of two photographs, and lights of the same camera."""
    stated = [one.stated for one in bank.problem.measured]
    for one, other in itertools.combinations(range(len(stated)), 2):
        if bank.seen[one].values.shape == bank.seen[other].values.shape:
            otherwise = {one: Otherwise(seen=bank.seen[other]), other: Otherwise(seen=bank.seen[one])}
            text = (
                f"{paths(bank, (one, other), 'file')}: each fits what is said of the other much better: the two files "
                "are swapped; swap their names"
            )
            yield Suspect("swapped", otherwise, 1.0, text)
        if stated[one].camera == stated[other].camera and stated[one].lights != stated[other].lights:
            otherwise = {one: Otherwise(nodes=bank.nodes[other]), other: Otherwise(nodes=bank.nodes[one])}
            names = [" + ".join(stated[number].lights) for number in (other, one)]
            text = (
                f"{paths(bank, (one, other), 'lights')}: fit the pictures of {names[0]}, and of {names[1]}, much "
                "better than their own: their lights are swapped; swap their names"
            )
            yield Suspect("lights", otherwise, 1.0, text)


def _wrong_lights(bank: Bank) -> Iterator[Suspect]:
    """Other lights of the same camera in one photograph, and two sets of lights that are taken for each other."""
    stated = [one.stated for one in bank.problem.measured]
    number_of = {(each.camera, each.lights): number for number, each in reversed(list(enumerate(stated)))}
    for (camera, lights), shown in number_of.items():
        for number, each in enumerate(stated):
            if each.camera == camera and each.lights != lights:
                text = (
                    f"{each.path}.lights: fits the picture of {' + '.join(lights)} much better than its own: it was "
                    "taken under that; name the light that was on"
                )
                yield Suspect("swapped", {number: Otherwise(nodes=bank.nodes[shown])}, 1.0, text)
    for one, other in itertools.combinations(dict.fromkeys(each.lights for each in stated), 2):
        exchange = {one: other, other: one}
        lit = [number for number, each in enumerate(stated) if each.lights in exchange]
        pairs = {number: number_of.get((stated[number].camera, exchange[stated[number].lights])) for number in lit}
        if len(lit) > 2 and None not in pairs.values():
            otherwise = {
                number: Otherwise(nodes=bank.nodes[pair]) for number, pair in pairs.items() if pair is not None
            }
            text = (
                f"lights: what is said of {' + '.join(one)} and of {' + '.join(other)} fits much better the other way "
                "round: the two lights are swapped; swap what is said of them, or their names in the photographs"
            )
            yield Suspect("swapped", otherwise, 1.0, text)
