"""Parts of the pages that acquisition writes: pictures, tables, values for a display."""

from __future__ import annotations

import base64
import html
import io

import numpy as np


def table(rows: list[list[str]]) -> str:
    """A table whose first row and first column are heads."""
    head, *rest = ([html.escape(cell) for cell in row] for row in rows)
    lines = ["".join(f"<th>{cell}</th>" for cell in head)]
    for name, *cells in rest:
        lines.append(f"<th>{name}</th>" + "".join(f'<td class="number">{cell}</td>' for cell in cells))
    return "<table>" + "".join(f"<tr>{line}</tr>" for line in lines) + "</table>"


def figure(pixels: np.ndarray, what: str, name: str) -> str:
    """An embedded picture, (h, w, 3) uint8, with its caption."""
    from PIL import Image

    encoded = io.BytesIO()
    Image.fromarray(pixels).save(encoded, "PNG")
    data = base64.b64encode(encoded.getvalue()).decode()
    alt = html.escape(f"{what} of {name}", quote=True)
    caption = f"<figcaption>{html.escape(what)}</figcaption>"
    return f'<figure><img src="data:image/png;base64,{data}" alt="{alt}">{caption}</figure>'


def srgb(value: np.ndarray) -> np.ndarray:
    """Linear values as bytes for a display (IEC 61966-2-1)."""
    value = np.clip(value, 0, 1)
    encoded = np.where(value <= 0.0031308, 12.92 * value, 1.055 * value ** (1 / 2.4) - 0.055)
    return np.round(255 * encoded).astype(np.uint8)
