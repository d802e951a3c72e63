"""Pictures by a view of an OpenColorIO config: what it shows, and configs that cannot be used."""

from __future__ import annotations

import json

import numpy as np
import pytest
from PIL import Image

import tiny
from quadgraph import ColourConfig
from quadgraph.base.errors import InputError
from quadgraph.cli import main

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")
pytest.importorskip("PyOpenColorIO", reason="the extra `colour` is not installed: run tools/setup --tests")

BUILT_IN = "ocio://cg-config-v1.0.0_aces-v1.3_ocio-v2.1"
PLAIN = {"display": "sRGB - Display", "view": "Un-tone-mapped"}
BY_HAND = """ocio_profile_version: 2
roles: {default: plain}
displays:
  Screen:
    - !<View> {name: Square, colorspace: root}
colorspaces:
  - !<ColorSpace> {name: plain, aliases: [SPACE]}
  - !<ColorSpace>
    name: root
    from_scene_reference: !<ExponentTransform> {value: [0.5, 0.5, 0.5, 1]}
"""


@pytest.fixture(scope="module")
def picture():
    """A ramp of all channels over black, with half-covered pixels at one side."""
    light = np.random.default_rng(4).uniform(0, 1.4, (24, 32, 3)).astype(np.float32)
    light[:, :4] = 0
    return core.Picture(light)


@pytest.fixture
def by_hand(tmp_path):
    def write(space: str = "lin_srgb"):
        path = tmp_path / "by_hand.ocio"
        path.write_text(BY_HAND.replace("SPACE", space))
        return path

    return write


def how(**members) -> str:
    return json.dumps({"picture": {"exposure": 0.0, "background": "0.2/0.3/0.5"} | members})


@pytest.mark.parametrize("members", [{}, {"exposure": -1.5}, {"white_balance": 3200}, {"background": "studio"}])
def test_a_view_without_a_curve_shows_what_the_linear_tone_shows(picture, members):
    shown = ColourConfig(BUILT_IN, **PLAIN).shown(picture, how(**members))
    expected = picture.srgb(how(tone="linear", **members))
    assert np.abs(shown.astype(int) - expected.astype(int)).max() <= 1  # of 255: one is dithered


# AgX as a config has it: a matrix, 16.5 stops, a curve from a file, a look, and the matrix back.
AGX = """ocio_profile_version: 2
roles: {default: lin_srgb}
displays:
  Screen:
    - !<View> {name: AgX, colorspace: agx}
colorspaces:
  - !<ColorSpace> {name: lin_srgb}
  - !<ColorSpace>
    name: agx
    from_scene_reference: !<GroupTransform>
      children:
        - !<MatrixTransform> {matrix: INSET}
        - !<AllocationTransform> {allocation: lg2, vars: [-12.47393, 4.026069]}
        - !<FileTransform> {src: curve.spi1d, interpolation: linear}
        - !<CDLTransform> {power: [POWER, POWER, POWER], sat: SATURATION, style: noclamp}
        - !<MatrixTransform> {matrix: OUTSET}
"""
INSET = [
    [0.842479062, 0.0784336, 0.0792237451],
    [0.0423282422, 0.878468636, 0.0791661275],
    [0.0423756549, 0.0784336, 0.879142974],
]


def sigmoid(x: np.ndarray) -> np.ndarray:
    """The curve of AgX [Sobotka 2022] through (0, 0), (p, 1/2) with slope 2, and (1, 1), by its own equations."""
    pivot = 10 / 16.5
    bent = np.empty_like(x)
    for power, side, sign in ((3.0, x < pivot, -1), (3.25, x >= pivot, 1)):
        run, rise = (pivot, 0.5) if sign < 0 else (1 - pivot, 0.5)
        scale = ((2 * run) ** -power * ((2 * run / rise) ** power - 1)) ** (-1 / power)
        term = 2 * sign * (x[side] - pivot) / scale
        bent[side] = sign * scale * term / (1 + term**power) ** (1 / power) + 0.5
    return bent


@pytest.mark.parametrize(("tone", "power", "saturation"), [("agx", 1, 1), ("agx-punchy", 1.35, 1.4)])
@pytest.mark.parametrize("members", [{}, {"exposure": 3.5}, {"exposure": -3.0, "background": "studio"}])
def test_agx_is_what_opencolorio_makes_of_its_parts(picture, tmp_path, members, tone, power, saturation):
    curve = "\n".join(f"{value:.9f}" for value in sigmoid(np.linspace(0, 1, 8192)))
    head = "Version 1\nFrom 0 1\nLength 8192\nComponents 1\n"
    (tmp_path / "curve.spi1d").write_text(f"{head}{{\n{curve}\n}}\n")

    def by_rows(matrix: np.ndarray) -> str:
        whole = np.eye(4)
        whole[:3, :3] = matrix
        return str(whole.ravel().tolist())

    text = AGX.replace("INSET", by_rows(np.array(INSET))).replace("OUTSET", by_rows(np.linalg.inv(INSET)))
    text = text.replace("POWER", str(power)).replace("SATURATION", str(saturation))
    (tmp_path / "agx.ocio").write_text(text)
    shown = ColourConfig(tmp_path / "agx.ocio").shown(picture, how(**members))
    expected = picture.srgb(how(tone=tone, **members))
    assert expected.max() > 40
    assert np.abs(shown.astype(int) - expected.astype(int)).max() <= 1  # of 255


def test_the_config_s_own_display_and_view_are_taken(picture):
    config = ColourConfig("ocio://default")
    assert "ACES" in config.view
    assert config.display in repr(config)
    assert config.codes([[0.18, 0.18, 0.18]]) == pytest.approx(np.full((1, 3), 0.39), abs=0.05)  # middle grey of ACES
    bright = config.codes([[50.0, 50.0, 50.0], [-1.0, 0.0, np.nan]])
    assert bright.max() <= 1
    assert bright.min() >= 0


def test_a_config_by_hand_shows_the_root_of_light(by_hand):
    config = ColourConfig(by_hand())
    light = np.array([[0.25, 0.04, 1.0]])
    assert config.codes(light) == pytest.approx(np.sqrt(light), abs=1e-4)
    with pytest.raises(InputError, match=r"by_hand.ocio: found no linear Rec.709 by a usual name; name one: plain"):
        ColourConfig(by_hand("something"))
    assert ColourConfig(by_hand("something"), space="plain").codes(light) == pytest.approx(np.sqrt(light), abs=1e-4)


def test_what_is_transparent_stays_so(picture):
    shown = ColourConfig(BUILT_IN, **PLAIN).shown(picture, how(background="transparent"))
    assert shown.shape == (24, 32, 4)
    assert (shown[:, :4, 3] == 0).all()
    assert (shown[:, 4:, 3] == 255).all()


@pytest.mark.parametrize(
    ("config", "options", "message"),
    [
        ("nowhere.ocio", {}, "nowhere.ocio: found no such file, allowed is an OpenColorIO config"),
        ("ocio://nothing", {}, "ocio://nothing: OpenColorIO cannot use it"),
        (BUILT_IN, {"view": "AgX"}, "view 'AgX' found, allowed are ACES 1.0"),
        (BUILT_IN, {"display": "Paper"}, "display 'Paper' found, allowed are sRGB"),
        (BUILT_IN, {"space": "brown"}, "found no colour space 'brown'; name one: ACES"),
    ],
)
def test_what_cannot_be_is_named_with_what_is_allowed(config, options, message):
    with pytest.raises(InputError, match=message):
        ColourConfig(config, **options)


def test_spoilt_files_are_refused(tmp_path, monkeypatch):
    for number, content in enumerate((b"", b"\x00" * 4096, b"ocio_profile_version: 9\n", b"colorspaces: [" * 2000)):
        path = tmp_path / f"{number}.ocio"
        path.write_bytes(content)
        with pytest.raises(InputError, match=rf"{number}.ocio: "):
            ColourConfig(path)
    monkeypatch.delenv("OCIO", raising=False)
    with pytest.raises(InputError, match="none is named, by itself or by the variable OCIO"):
        ColourConfig()
    monkeypatch.setenv("OCIO", BUILT_IN)
    assert ColourConfig().name == BUILT_IN


def test_the_command_shows_bodies_and_scenes_by_it(tmp_path, capsys):
    scene = tmp_path / "scene.json"
    scene.write_text(json.dumps({"quadgraph_scene": 1, "body": str(tiny.PATH), "picture": {"width": 48, "height": 32}}))
    fast = ["--no-correction", "--samples", "1"]
    for what in (str(tiny.PATH), str(scene)):
        pictures = []
        for options in (["--tone", "linear"], ["--ocio", BUILT_IN, "--ocio-view", PLAIN["view"]]):
            out = tmp_path / "picture.png"
            size = ["--size", "48x32"] if what != str(scene) else []
            assert main(["render", what, *fast, *size, "--exposure", "1", *options, "-o", str(out)]) == 0
            with Image.open(out) as image:
                pictures.append(np.asarray(image.convert("RGB")).astype(int))
                assert "material" in image.text
        assert np.abs(pictures[0] - pictures[1]).max() <= 1
    for options, message in (
        (["--ocio-view", "Raw"], "--ocio-view: only with --ocio CONFIG"),
        (["--ocio", BUILT_IN, "--tone", "agx"], "--tone: found with --ocio, whose view takes its place"),
        (["--ocio", str(tmp_path)], "found no such file"),
    ):
        capsys.readouterr()
        assert main(["render", str(tiny.PATH), *options, "-o", str(tmp_path / "not.png")]) == 1
        assert message in capsys.readouterr().err
    assert not (tmp_path / "not.png").exists()
