"""Volumes, images and materials that lie, are damaged, or hold what is no coefficient and no light."""

from __future__ import annotations

import functools
import io
import os
import struct
import tempfile
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenEXR

from attack import texts
from attack.case import Case, Place
from attack.physics import SOLVE_OUTPUTS, SOLVED, solve, solved
from attack.texts import Rng

VOLUME = ("--material", "v.npz", "--no-correction", *SOLVED[1:])
BLOCK = 1 << 20  # bytes of zeros that are packed at once


def using(
    rng: Rng, name: str, file: str, data: bytes | Callable[[], bytes], expect: str = "", lit: bool = False
) -> Case:
    """A solve that takes a volume as material, or an image as projector or environment."""
    if file.endswith(".npz"):
        options: tuple[str, ...] = VOLUME
    elif file.endswith(".png") or rng.integers(2):
        options = ("--no-correction", "--light", f"projector:0,0,60:0,0,-1:40:{file}:1")
    else:
        options = ("--no-correction", "--light", f"environment:{file}:{rng.uniform(0, 360):.0f}:1")

    def prepare(place: Place) -> None:
        place.bodies.put(place.folder)
        (place.folder / file).write_bytes(data() if callable(data) else data)

    command = solve("body.qgraph", *options)
    return Case(name, command, (file,), prepare, SOLVE_OUTPUTS, judge=solved(lit), expect=expect)


def npy(descr: str, shape: str, data: bytes, fortran: str = "False", version: int = 1) -> bytes:
    """An array file of any header."""
    text = f"{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}, }}".encode() + b"\n"
    size = struct.pack("<H" if version == 1 and len(text) < 65536 else "<I", len(text))
    return b"\x93NUMPY" + bytes([1 if len(size) == 2 else 2, 0]) + size + text + data


def grid(**changed: object) -> dict[str, np.ndarray]:
    """The fields of a volume around the ring."""
    fields: dict[str, object] = {"sigma_s_prime": np.full((6, 8, 8), 2.0), "sigma_a": np.full((6, 8, 8), 0.01)}
    fields |= {"spacing": 4.0, "origin": np.array([-14.0, -14.0, -10.0]), "eta": 1.4}
    fields["sigma_a_deviation"] = np.full((6, 8, 8), 0.1)
    return {name: np.asarray(value) for name, value in (fields | changed).items() if value is not None}


def zipped(
    members: dict[str, bytes], pack: int = zipfile.ZIP_DEFLATED, zeros: tuple[str, bytes, int] = ("", b"", 0)
) -> bytes:
    """Members as an archive. zeros: the name of one more, how it begins, and how many zeros follow."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", pack) as archive:
        for name, data in members.items():
            archive.writestr(name, data)
        name, begin, count = zeros
        if name:
            with archive.open(name, "w", force_zip64=True) as member:
                member.write(begin)
                for start in range(0, count, BLOCK):
                    member.write(bytes(min(BLOCK, count - start)))
    return stream.getvalue()


def volume(pack: int = zipfile.ZIP_DEFLATED, **changed: object) -> bytes:
    """A volume file."""
    members = {}
    for name, array in grid(**changed).items():
        stream = io.BytesIO()
        np.save(stream, array, allow_pickle=True)
        members[f"{name}.npy"] = stream.getvalue()
    return zipped(members, pack)


def headers(rng: Rng) -> Case:
    """A header of an array that lies about kind, order or shape."""
    good = {name: npy(f"'{a.dtype.str}'", str(a.shape), a.tobytes()) for name, a in grid().items()}
    key, ones = texts.pick(rng, ["sigma_s_prime", "sigma_a", "spacing"]), np.ones(384).tobytes()
    size = int(10 ** rng.uniform(2, 5.5))
    kinds = {
        "long descr": lambda: npy(f"'{'f' * size}'", "(6, 8, 8)", ones),
        "many axes": lambda: npy("'<f8'", f"({'1, ' * size})", ones),
        "large": lambda: npy("'<f8'", f"({10 ** int(rng.integers(2, 18))}, 8, 8)", ones),
        "negative": lambda: npy("'<f8'", "(-6, 8, 8)", ones),
        "object": lambda: npy("'|O'", "(6, 8, 8)", b"cos\nsystem\n(S'true'\ntR."),
        "structured": lambda: npy("[('a', '<f4'), ('b', '<f4')]", "(6, 8, 8)", ones),
        "text": lambda: npy("'<U1'", "(6, 8, 8)", ones),
        "short": lambda: npy("'<f8'", "(6, 8, 8)", ones[: int(rng.integers(len(ones)))]),
        "bytes": lambda: texts.random_bytes(rng, npy("'<f8'", "(6, 8, 8)", ones), 6)[:200] + ones,
    }
    kind = texts.pick(rng, list(kinds))
    good[key] = kinds[kind]()
    data = zipped({f"{name}.npy": value for name, value in good.items()})
    return using(rng, f"npz, {key}, {kind} {size}", "v.npz", data)


def archives(rng: Rng) -> Case:
    """An archive that lies about sizes, is damaged, or unpacks to much more than it is."""
    kind, size = texts.pick(rng, ["states", "zeros", "junk", "bytes", "cut", "none", "twice"]), float(rng.uniform(7, 9))

    def make() -> bytes:
        data = bytearray(volume())
        if kind == "states":
            spot = data.rindex(b"PK\x01\x02")
            data[spot + 24 : spot + 28] = struct.pack("<I", min(int(10**size), 2**32 - 1))
        elif kind in ("zeros", "junk"):
            side = int((10**size / 8) ** (1 / 3))
            head = npy("'<f8'", f"({side}, {side}, {side})", b"")
            name = "sigma_a.npy" if kind == "zeros" else "junk.npy"
            good = {f"{n}.npy": npy(f"'{a.dtype.str}'", str(a.shape), a.tobytes()) for n, a in grid().items()}
            good.pop(name, None)
            return zipped(good, zeros=(name, head, 8 * side**3))
        elif kind == "bytes":
            return texts.random_bytes(rng, bytes(data), 8)
        elif kind == "twice":
            return bytes(data) + bytes(data)
        return (
            b"\x93NUMPY" * 9
            if kind == "none"
            else bytes(data[: int(rng.random() * len(data))] if kind == "cut" else data)
        )

    return using(rng, f"npz, {kind} 1e{size:.1f}", "v.npz", make)


def values(rng: Rng) -> Case:
    """Coefficients, spacings and places that are none, or of any size."""
    keys = ["sigma_s_prime", "sigma_a", "spacing", "origin", "eta", "sigma_a_deviation"]
    key, value = texts.pick(rng, keys), texts.extreme(rng)
    fields = {name: np.array(array, float) for name, array in grid().items()}
    fields[key].reshape(-1)[int(rng.integers(fields[key].size)) if rng.integers(2) else slice(None)] = value
    return using(rng, f"npz, {key} {value:.3g}", "v.npz", volume(**fields))


def shapes(rng: Rng) -> Case:
    """Fields of other shapes and kinds, missing or too many; some are good."""
    shape = tuple(int(n) for n in rng.integers(1, 7, int(rng.integers(0, 6))))
    key = texts.pick(rng, [*grid(), "foreign"])
    kind = texts.pick(rng, ["<f4", "<f8", ">f8", "<f2", "<i4", "|b1", "<c16", "<U3"])
    value = None if rng.integers(6) == 0 else np.ones(shape).astype(kind)
    return using(
        rng, f"npz, {key} {kind} {shape if value is not None else 'left out'}", "v.npz", volume(**{key: value})
    )


def good_volume(rng: Rng) -> Case:
    """Volumes as they are written: the light that enters is in balance."""
    fields = {"sigma_s_prime": rng.uniform(0.5, 3, (6, 8, 8, 3)), "sigma_a": rng.uniform(0.001, 0.1, (6, 8, 8))}
    pack = texts.pick(rng, [zipfile.ZIP_DEFLATED, zipfile.ZIP_STORED])
    return using(rng, "npz, undamaged", "v.npz", volume(pack, **fields), "fine", lit=True)


def png(width: int, height: int, depth: int, colour: int, rows: bytes, lies: dict[str, int] | None = None) -> bytes:
    """A PNG of packed rows; lies: words of its head."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    said = {"width": width, "height": height, "depth": depth, "colour": colour, "interlace": 0} | (lies or {})
    head = struct.pack(
        ">IIBBBBB", said["width"], said["height"], said["depth"], said["colour"], 0, 0, said["interlace"]
    )
    body = chunk(b"IDAT", zlib.compress(rows))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + body + chunk(b"IEND", b"")


PNG = png(8, 8, 8, 2, b"".join(b"\0" + bytes(range(24)) for _ in range(8)))


def pngs(rng: Rng) -> Case:
    """A PNG whose head lies, or that unpacks to much, or is damaged."""
    side = 16
    rows = b"".join(b"\0" + bytes(rng.integers(0, 256, 3 * side, np.uint8)) for _ in range(side))
    kind = texts.pick(rng, ["large", "depth", "colour", "interlace", "bytes", "cut", "rows", "empty", "good"])
    large = int(10 ** rng.uniform(2, 9.3))
    if kind == "large":
        lies = texts.pick(
            rng, [{"width": large}, {"height": large}, {"width": large, "height": large, "depth": 1, "colour": 0}]
        )
        data = png(side, side, 8, 2, rows if large > 20000 else bytes(large * large // 8), lies)
    elif kind in ("depth", "colour", "interlace"):
        data = png(side, side, 8, 2, rows, {kind: int(rng.integers(256))})
    else:
        data = png(side, side, 8, 2, rows[: len(rows) // 2] if kind == "rows" else rows)
    if kind == "bytes":
        data = texts.random_bytes(rng, data, 6, 8)
    data = {"empty": b"", "cut": data[: int(rng.random() * len(data))]}.get(kind, data)
    return using(rng, f"png, {kind} {large}", "i.png", data, "fine" if kind == "good" else "")


@functools.cache
def exr(value: float = 0.5, packed: bool = True) -> bytes:
    """A small EXR of one value."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "image.exr"
        head = {
            "compression": OpenEXR.ZIP_COMPRESSION if packed else OpenEXR.NO_COMPRESSION,
            "type": OpenEXR.scanlineimage,
        }
        OpenEXR.File(head, {"RGB": np.full((8, 16, 3), value, np.float32)}).write(str(path))
        return path.read_bytes()


def exrs(rng: Rng) -> Case:
    """An EXR whose windows lie, or that is damaged, cut off or empty."""
    kind, data = texts.pick(rng, ["window", "bytes", "head", "cut", "empty", "good"]), exr(packed=bool(rng.integers(2)))
    large = int(10 ** rng.uniform(1.5, 9.3))
    if kind == "window":
        spot = data.index(b"dataWindow\0box2i\0") + 21
        box = texts.pick(
            rng, [(0, 0, large, 7), (0, 0, 15, large), (0, 0, large, large), (large, 0, 0, 7), (-large, 0, 15, 7)]
        )
        data = data[:spot] + struct.pack("<4i", *box) + data[spot + 16 :]
    elif kind == "bytes":
        data = texts.random_bytes(rng, data, 8)
    elif kind == "head":
        data = texts.random_bytes(rng, data[:300], 4, 8) + data[300:]
    data = {"empty": b"", "cut": data[: int(rng.random() * len(data))]}.get(kind, data)
    return using(rng, f"exr, {kind} {large}", "i.exr", data, "fine" if kind == "good" else "")


def hdrs(rng: Rng) -> Case:
    """A Radiance picture whose size lies, or whose runs are none."""
    kind, large = texts.pick(rng, ["size", "runs", "text", "cut", "good"]), int(10 ** rng.uniform(1.5, 10))
    texels = bytes(rng.integers(1, 136, 8 * 16 * 4, np.uint8))
    size = texts.pick(rng, [f"-Y {large} +X 16", f"-Y 8 +X {large}", "-Y -8 +X 16", f"+X {large} -Y {large}", "-Y 8"])
    if kind != "size":
        size = "-Y 8 +X 16"
    if kind == "runs":
        texels = (b"\2\2\0\x10" + bytes(rng.integers(0, 256, 70, np.uint8))) * 8
    data = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + f"{size}\n".encode() + texels
    if kind == "text":
        data = texts.random_bytes(rng, data[:60], 4) + data[60:]
    data = data[: int(rng.random() * len(data))] if kind == "cut" else data
    return using(rng, f"hdr, {kind} {large}", "i.hdr", data, "fine" if kind == "good" else "")


def texels(rng: Rng) -> Case:
    """Texels of any size, and such that are no numbers."""
    value = texts.extreme(rng)
    with np.errstate(over="ignore"):
        return using(rng, f"exr, texels of {value:.3g}", "i.exr", exr(float(np.float32(value))))


def odd_files(rng: Rng) -> Case:
    """What is no regular file, or another kind of file, where an image or a volume is wanted."""
    file = texts.pick(rng, ["i.png", "i.exr", "i.hdr", "v.npz", "i", "i.jpg"])
    kind = texts.pick(rng, ["folder", "fifo", "zero", "gone", "body", "link", "loop"])
    if file == "v.npz":
        options: tuple[str, ...] = VOLUME
    else:
        options = ("--no-correction", "--light", f"projector:0,0,60:0,0,-1:40:{file}:1")

    def prepare(place: Place) -> None:
        path = place.folder / file
        place.bodies.put(place.folder)
        if kind == "folder":
            path.mkdir()
        elif kind == "fifo":
            os.mkfifo(path)
        elif kind in ("zero", "link", "loop"):
            path.symlink_to({"zero": "/dev/zero", "link": "nowhere", "loop": file}[kind])
        elif kind == "body":
            place.bodies.put(place.folder, under=file)

    command = solve("body.qgraph", *options)
    return Case(f"{file} is {kind}", command, (file,), prepare, SOLVE_OUTPUTS, judge=solved(False), expect="refused")


def material_text(rng: Rng) -> str:
    """A material of the command line with numbers of any size; no longer than a word of a command may be, 128 kB."""
    sigma = [texts.number(rng) if rng.integers(3) == 0 else f"{10 ** rng.uniform(-12, 9):.4g}" for _ in range(6)]
    eta = texts.number(rng) if rng.integers(3) == 0 else f"{rng.uniform(1, 3):.3f}"
    forms = [
        f"sigma_s_prime={sigma[0]},sigma_a={sigma[1]},eta={eta}",
        f"sigma_s_prime={sigma[0]}/{sigma[1]}/{sigma[2]},sigma_a={sigma[3]}/{sigma[4]}/{sigma[5]}",
        f"reflectance={texts.number(rng)},mean_free_path={sigma[0]}",
        f"reflectance={rng.random():.9f}/0/1,mean_free_path={sigma[0]}/{sigma[1]}/{sigma[2]}",
        f"marble,sigma_a={sigma[0]},pattern={texts.pick(rng, ['rings', 'veins', 'checker', 'x'])},period={sigma[1]}",
        f"jade,period={texts.number(rng)},sharpness={texts.number(rng)},eta={eta}",
        f"marble,{texts.word(rng, 4)}",
        f"{'marble,eta=1.3,' * int(10 ** rng.uniform(0, 3.9))}eta={eta}",
    ]
    return texts.pick(rng, forms).replace("\0", "")


def materials(rng: Rng) -> Case:
    """Materials of the command line with numbers of any size."""
    text = material_text(rng)
    options = ("--no-correction", "--light", "directional:0.3,-0.5,-1:1", f"--material={text}")
    names = ("material", "sigma", "eta", "reflectance", "mean_free_path", "period", "sharpness", "pattern")

    def prepare(place: Place) -> None:
        place.bodies.put(place.folder)

    command = solve("body.qgraph", *options)
    return Case(f"material {text[:80]!r}", command, names, prepare, SOLVE_OUTPUTS, judge=solved())


def vdbs(rng: Rng) -> Case:
    """`volume` of what is no OpenVDB file, or without OpenVDB."""
    data = texts.random_bytes(rng, b"VDB " + struct.pack("<4xI", 224) + bytes(200), 40)

    def prepare(place: Place) -> None:
        (place.folder / "smoke.vdb").write_bytes(data)

    command = ("quadgraph", "volume", "smoke.vdb", "-o", "out.npz", "--sigma-s-prime", "density=2", "--sigma-a", "0.1")
    return Case(
        "vdb of nothing", command, ("smoke.vdb", "openvdb", "arguments"), prepare, ("out.npz",), expect="refused"
    )


RECIPES = (
    headers,
    archives,
    values,
    shapes,
    good_volume,
    pngs,
    exrs,
    hdrs,
    texels,
    odd_files,
    materials,
    vdbs,
)
