"""Pictures as a view of an OpenColorIO config shows them, in place of the engine's tone curves."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from quadgraph.api.values import Floats
from quadgraph.base.errors import InputError
from quadgraph.base.optional_package import optional_package

if TYPE_CHECKING:
    from quadgraph import core

# What configs call linear light of Rec.709's primaries, which pictures are of.
LINEAR_SPACES = (
    "lin_rec709_scene",
    "lin_rec709",
    "lin_srgb",
    "Linear Rec.709",
    "Utility - Linear - sRGB",
    "Linear sRGB",
    "linear_srgb",
    "Linear BT.709",
)
_ALPHA = 1e-6  # shares of a pixel below this show nothing


class ColourConfig:
    """A view of an OpenColorIO config on one of its displays, for pictures of the engine.

    config: a file (.ocio, .ocioz), "ocio://default" or another built-in one, or None for the one that $OCIO names;
    display, view: of the config, by default its own; space: the config's name for linear light of Rec.709's primaries,
    where it has none of LINEAR_SPACES. Raises InputError without the package (pip install 'quadgraph[colour]') and
    where the config cannot be read or lacks one of these.
    """

    def __init__(self, config: str | Path | None = None, *, display: str = "", view: str = "", space: str = "") -> None:
        """Read the config and make its transform."""
        ocio = optional_package("PyOpenColorIO", "colour")
        self.name = _name(config)
        try:
            found = ocio.Config.CreateFromFile(self.name)
            self.display = _chosen(self.name, "display", display or found.getDefaultDisplay(), found.getDisplays())
            usual = view or found.getDefaultView(self.display)
            self.view = _chosen(self.name, "view", usual, found.getViews(self.display))
            transform = ocio.DisplayViewTransform(_space(self.name, found, space), self.display, self.view)
            self._processor = found.getProcessor(transform).getDefaultCPUProcessor()
        except ocio.Exception as error:
            raise InputError(f"{self.name}: OpenColorIO cannot use it ({str(error).strip()[:300]})") from None

    def __repr__(self) -> str:
        """Return what it shows light with."""
        return f"ColourConfig({self.name!r}, display={self.display!r}, view={self.view!r})"

    def codes(self, linear: npt.ArrayLike) -> Floats:
        """Return what the display is sent, in [0, 1], for linear light (..., 3) of Rec.709's primaries."""
        light = np.array(linear, np.float32, order="C")
        rows = light.reshape(-1, 3)
        self._processor.applyRGB(rows)
        return np.clip(np.nan_to_num(rows, nan=0.0), 0, 1).reshape(light.shape)

    def shown(self, layers: core.Picture, json: str) -> npt.NDArray[np.uint8]:
        """Return the compiled engine's picture, (h, w, 3) uint8, or (h, w, 4) where the background is transparent.

        json: the member `picture` of a scene: its exposure, white balance and background count, its tone does not.
        Exposure "auto" is that of its tone. Raises InputError.
        """
        around = layers.shown_with(json)
        if around["false_colour"]:
            return layers.srgb(json)
        alpha = layers.alpha[..., None]
        light = np.maximum(layers.scattered, 0) + layers.specular + layers.unscattered
        body = self._seen(light / np.maximum(alpha, np.float32(_ALPHA)), around) * np.where(alpha > _ALPHA, alpha, 0)
        behind = 1 - alpha + layers.transmittance
        if around["transparent"]:
            opacity = np.clip(1 - behind.mean(axis=-1, keepdims=True), 0, 1)
            colour = _encoded(np.clip(body / np.maximum(opacity, _ALPHA), 0, 1))
            return _bytes(np.concatenate([colour, opacity], axis=-1))
        if layers.surroundings is not None:
            backdrop = self._seen(layers.surroundings, around)
        else:
            down = ((np.arange(alpha.shape[0]) + 0.5) / alpha.shape[0])[:, None, None]
            backdrop = np.multiply(around["background_top"], 1 - down) + np.multiply(around["background_bottom"], down)
        return _bytes(_encoded(np.clip(body + behind * backdrop, 0, 1)))

    def _seen(self, light: npt.ArrayLike, around: dict[str, Any]) -> Floats:
        """Linear display colour of linear radiance, so that bodies are laid over what is behind them in light."""
        codes = self.codes(np.asarray(light) @ np.asarray(around["matrix"]).T)
        return np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)


def _name(config: str | Path | None) -> str:
    name = os.environ.get("OCIO", "") if config is None else str(config)
    if not name:
        raise InputError("colour config: none is named, by itself or by the variable OCIO; ocio://default is built in")
    if not name.startswith("ocio://") and not Path(name).is_file():
        raise InputError(
            f"{name}: found no such file, allowed is an OpenColorIO config, or a built-in one, ocio://default"
        )
    return name


def _chosen(name: str, what: str, wanted: str, allowed: Any) -> str:
    if wanted not in (names := list(allowed)):
        raise InputError(f"{name}: {what} {wanted!r} found, allowed are {', '.join(names) or 'none'}")
    return wanted


def _space(name: str, config: Any, wanted: str) -> str:
    for space in (wanted,) if wanted else LINEAR_SPACES:
        if found := config.getColorSpace(space):
            return str(found.getName())
    what = f"no colour space {wanted!r}" if wanted else "no linear Rec.709 by a usual name"
    raise InputError(f"{name}: found {what}; name one: {', '.join(list(config.getColorSpaceNames())[:40])}")


def _encoded(linear: Floats) -> Floats:
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 0.0031308) ** (1 / 2.4) - 0.055)


def _bytes(codes: Floats) -> npt.NDArray[np.uint8]:
    return np.asarray(np.floor(255 * codes + 0.5), np.uint8)
