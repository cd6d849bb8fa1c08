"""Numbers, tables and badges of the page as HTML."""

from __future__ import annotations

import html
from typing import Iterable, Optional, Sequence, Tuple

import numpy as np


def escaped(value: object) -> str:
    return html.escape(str(value))


def number(value: Optional[float], digits: int = 6) -> str:
    return "–" if value is None or not np.isfinite(value) else "{:.{}g}".format(value, digits).replace("-", "\u2212")


def hundredths(value: float) -> str:
    """The value as the program prints a z."""
    return "{:.2f}".format(value).replace("-", "\u2212") if np.isfinite(value) else "–"


def table(head: Sequence[str], rows: Iterable[Sequence[str]], caption: str = "") -> str:
    """A table of escaped cells; all columns but the first are numbers."""
    classes = ["" if at == 0 else ' class="number"' for at in range(len(head))]
    lines = ["<table>" + ("<caption>{}</caption>".format(escaped(caption)) if caption else "")]
    lines.append("<tr>{}</tr>".format("".join("<th{}>{}</th>".format(kind, escaped(cell)) for kind, cell in zip(classes, head))))
    lines += ["<tr>{}</tr>".format("".join("<td{}>{}</td>".format(kind, escaped(cell)) for kind, cell in zip(classes, row))) for row in rows]
    return "\n".join(lines) + "\n</table>"


def pairs(rows: Iterable[Tuple[str, object]]) -> str:
    cells = ("<tr><th>{}</th><td>{}</td></tr>".format(escaped(name), escaped(value)) for name, value in rows)
    return "<table>\n{}\n</table>".format("\n".join(cells))


def badge(text: str, kind: str) -> str:
    return '<span class="badge {}">{}</span>'.format(kind, escaped(text))


def warning(text: str) -> str:
    return '<p class="warning">{}</p>'.format(escaped(text))
