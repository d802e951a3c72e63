"""The page of a board at its true size: rectangles, lines and words in millimetres, as PDF, SVG or PNG."""

from __future__ import annotations

import html
import io
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from quadgraph.acquisition.board.board import RULER_MM, Board
from quadgraph.base.atomic_file import replacing
from quadgraph.base.errors import InputError

PAGES = {"a4": (210.0, 297.0), "letter": (215.9, 279.4), "a3": (297.0, 420.0)}  # mm
SUFFIXES = (".pdf", ".svg", ".png")
DOTS_PER_MM = 600 / 25.4  # of a PNG
_POINTS = 72 / 25.4  # of PDF, in a mm
_EDGE = 5.0  # mm, which printers leave white
_TEXT, _LINE = 2.9, 4.2  # mm, size of words and how far lines are apart
_THIN = 0.15  # mm, of lines


@dataclass
class Drawing:
    """A page of width and height, mm, with what is on it; x to the right, y down.

    rectangles: x, y, width, height, and whether it is black; words: x, y of the base line, size, text, and whether it
    runs up the page.
    """

    width: float
    height: float
    rectangles: list[tuple[float, float, float, float, bool]] = field(default_factory=list)
    words: list[tuple[float, float, float, str, bool]] = field(default_factory=list)


def page_of(board: Board, page: str) -> Drawing:
    """The page with a board in its middle, two rulers and what to do. Raises InputError if it does not fit."""
    board.check()
    width, height = PAGES[page]
    lines = _instructions(board)
    below = 9 + _LINE * len(lines)
    wide, high = board.size
    beside = 11.0
    if wide + beside + 2 * _EDGE > width or high + below + 2 * _EDGE > height:
        room = f"{width - beside - 2 * _EDGE:.0f} x {height - below - 2 * _EDGE:.0f}"
        raise InputError(
            f"board of {wide:g} x {high:g} mm found, {page} has room for {room}; take fewer or smaller squares, or "
            f"another --page ({', '.join(PAGES)})"
        )
    drawing = Drawing(width, height)
    left = (width - wide - beside) / 2
    top = (height - high - below) / 2
    drawing.rectangles += [(left + x, top + y, w, h, black) for x, y, w, h, black in squares(board)]
    _ruler(drawing, left, top + high + 4, False)
    _ruler(drawing, left + wide + 4, top + high, True)
    for number, line in enumerate(lines):
        drawing.words.append((left, top + high + 13 + _LINE * number, _TEXT, line, False))
    return drawing


def squares(board: Board) -> Iterator[tuple[float, float, float, float, bool]]:
    """Rectangles of the board from its upper left, down: black squares and markers, then their white cells."""
    markers = board.markers()
    held = {(int(x / board.square), int(y / board.square)) for _, x, y in markers}
    for row in range(board.rows):
        for column in range(board.columns):
            if (column, row) not in held:
                yield column * board.square, row * board.square, board.square, board.square, True
    for number, x, y in markers:
        yield x, y, board.marker, board.marker, True
        bits = board.bits(number)
        cell = board.marker / len(bits)
        for row, column in zip(*bits.nonzero(), strict=True):
            yield x + column * cell, y + row * cell, cell, cell, False


def _instructions(board: Board) -> list[str]:
    hollow = f", hollow {board.hollow[0]}x{board.hollow[1]}" if board.hollow[0] else ""
    return [
        f"QuadGraph board {board.columns}x{board.rows}, square {board.square:g} mm, marker {board.marker:g} mm, "
        f"dictionary {board.dictionary}{hollow}.",
        'Print at 100% ("actual size", no fit to page), on matt paper, and glue it onto something flat.',
        f"Check: each ruler is {RULER_MM:g} mm. If yours differ, write what they measure, x first, into session.json:",
        '"board": {..., "printed": [X, Y]}. Coordinates: origin in the lower left corner of the squares, x right,',
        "y up the page, z out of the paper, mm.",
    ]


def _ruler(drawing: Drawing, x: float, y: float, upright: bool) -> None:
    """150 mm with a tick each mm, longer ones each 5 and 10, from (x, y) to the right, or up the page."""

    def tick(along: float, length: float, thickness: float) -> None:
        at = along - thickness / 2
        if upright:
            drawing.rectangles.append((x, y - at - thickness, length, thickness, True))
        else:
            drawing.rectangles.append((x + at, y, thickness, length, True))

    for mm in range(int(RULER_MM) + 1):
        tick(mm, 3.0 if mm % 10 == 0 else 2.2 if mm % 5 == 0 else 1.4, 2 * _THIN if mm % 10 == 0 else _THIN)
        if mm % 50 == 0:
            words = f"{mm}" if mm < RULER_MM else f"{mm} mm {'y' if upright else 'x'}"
            place = (x + 5.4, y - mm) if upright else (x + mm, y + 5.4)
            drawing.words.append((*place, 2.4, words, upright))


def write(path: Path, drawing: Drawing, title: str) -> None:
    """Write a page by its ending. Raises InputError for another one, or if it cannot be written."""
    makers = {".pdf": _pdf, ".svg": _svg, ".png": _png}
    maker = makers.get(path.suffix.lower())
    if maker is None:
        raise InputError(f"{path}: output must end in {', '.join(SUFFIXES)}")
    data = maker(drawing, title)
    with replacing(path) as stream:
        stream.write(data)


def _pdf(drawing: Drawing, title: str) -> bytes:
    """PDF 1.4 of one page, with Helvetica, which every reader has."""
    high = drawing.height
    parts = []
    for x, y, w, h, black in drawing.rectangles:
        corner = f"{x * _POINTS:.4f} {(high - y - h) * _POINTS:.4f} {w * _POINTS:.4f} {h * _POINTS:.4f}"
        parts.append(f"{0 if black else 1} g {corner} re f")
    parts.append("0 g")
    for x, y, size, text, upright in drawing.words:
        escaped = text.replace("\\", "\\\\").replace("(", "\\(").replace(")", "\\)")
        turn = "0 1 -1 0" if upright else "1 0 0 1"
        place = f"{x * _POINTS:.4f} {(high - y) * _POINTS:.4f}"
        parts.append(f"BT /F {size * _POINTS:.3f} Tf {turn} {place} Tm ({escaped}) Tj ET")
    content = "\n".join(parts).encode("latin-1", "replace")
    box = f"[0 0 {drawing.width * _POINTS:.4f} {high * _POINTS:.4f}]"
    objects = [
        b"<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>",
        b"<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        f"<< /Type /Page /Parent 2 0 R /MediaBox {box} /Contents 5 0 R "
        "/Resources << /Font << /F 4 0 R >> >> >>".encode(),
        b"<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>",
        b"<< /Length %d >>\nstream\n%s\nendstream" % (len(content), content),
        f"<< /Title ({title}) /Producer (QuadGraph) >>".encode("latin-1", "replace"),
    ]
    out = io.BytesIO(b"")
    out.write(b"%PDF-1.4\n%\xe2\xe3\xcf\xd3\n")
    places = []
    for number, each in enumerate(objects, 1):
        places.append(out.tell())
        out.write(b"%d 0 obj\n%s\nendobj\n" % (number, each))
    start = out.tell()
    out.write(b"xref\n0 %d\n0000000000 65535 f \n" % (len(objects) + 1))
    out.write(b"".join(b"%010d 00000 n \n" % place for place in places))
    out.write(b"trailer\n<< /Size %d /Root 1 0 R /Info 6 0 R >>\nstartxref\n%d\n%%%%EOF\n" % (len(objects) + 1, start))
    return out.getvalue()


def _svg(drawing: Drawing, title: str) -> bytes:
    """SVG in millimetres."""
    wide, high = f"{drawing.width:g}", f"{drawing.height:g}"
    size = f'width="{wide}mm" height="{high}mm" viewBox="0 0 {wide} {high}"'
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" {size}><title>{html.escape(title)}</title>']
    parts.append('<rect width="100%" height="100%" fill="#fff"/><g shape-rendering="crispEdges">')
    for x, y, w, h, black in drawing.rectangles:
        fill = "" if black else ' fill="#fff"'
        parts.append(f'<rect x="{x:.4f}" y="{y:.4f}" width="{w:.4f}" height="{h:.4f}"{fill}/>')
    parts.append('</g><g font-family="Helvetica, Arial, sans-serif">')
    for x, y, letter, text, upright in drawing.words:
        turn = f' transform="rotate(-90 {x:.3f} {y:.3f})"' if upright else ""
        parts.append(f'<text x="{x:.3f}" y="{y:.3f}" font-size="{letter:g}"{turn}>{html.escape(text)}</text>')
    return ("\n".join(parts) + "\n</g></svg>\n").encode()


def _png(drawing: Drawing, title: str) -> bytes:
    """A picture of 600 dots an inch, which says so."""
    from PIL import Image, ImageDraw, ImageFont, PngImagePlugin

    picture = Image.new("L", (round(drawing.width * DOTS_PER_MM), round(drawing.height * DOTS_PER_MM)), 255)
    pen = ImageDraw.Draw(picture)
    for x, y, w, h, black in drawing.rectangles:
        x0, y0, x1, y1 = (round(each * DOTS_PER_MM) for each in (x, y, x + w, y + h))
        pen.rectangle((x0, y0, max(x1 - 1, x0), max(y1 - 1, y0)), fill=0 if black else 255)
    for x, y, size, text, upright in drawing.words:
        letters = ImageFont.load_default(size * DOTS_PER_MM)
        if not upright:
            pen.text((x * DOTS_PER_MM, y * DOTS_PER_MM), text, fill=0, font=letters, anchor="ls")
            continue
        box = letters.getbbox(text, anchor="ls")
        across = Image.new("L", (int(box[2]) + 1, int(-box[1]) + 1), 255)
        ImageDraw.Draw(across).text((0, across.height - 1), text, fill=0, font=letters, anchor="ls")
        turned = across.rotate(90, expand=True)
        picture.paste(turned, (round(x * DOTS_PER_MM) - turned.width, round(y * DOTS_PER_MM) - turned.height))
    texts = PngImagePlugin.PngInfo()
    texts.add_text("Title", title)
    encoded = io.BytesIO()
    picture.save(encoded, "PNG", dpi=(600, 600), pnginfo=texts)
    return encoded.getvalue()
