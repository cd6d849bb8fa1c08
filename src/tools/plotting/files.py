"""The files of a figure: PNG and SVG, or PDF."""

from __future__ import annotations

import io
import os
import warnings
from typing import List, Sequence, Tuple

from matplotlib.figure import Figure
from stochastic_platoon.files import write_all

from plotting import style

KINDS = ("png", "svg")


def target_of(output: str) -> Tuple[str, Sequence[str]]:
    """The path without extension, and the kinds of files: PDF alone if the extension asks for it."""
    stem, extension = os.path.splitext(output)
    if extension == ".pdf":
        return stem, ("pdf",)
    return (stem if extension[1:] in KINDS else output), KINDS


def require_writable(stem: str, kinds: Sequence[str] = KINDS) -> None:
    """Raises ValueError if no figure can be written there, before any work is done."""
    folder = os.path.dirname(stem) or "."
    if not os.path.isdir(folder):
        raise ValueError("{}: no such folder to write to".format(folder))
    if not os.path.basename(stem):
        raise ValueError("--output: {!r} must be a path to a file, without extension".format(stem))
    for kind in kinds:
        if os.path.isdir(stem + "." + kind):
            raise ValueError("{}.{}: is a folder, no figure can be written there".format(stem, kind))


def content(figure: Figure, kind: str) -> bytes:
    """The figure as a file. Without a date, equal inputs give equal files."""
    dateless = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    buffer = io.BytesIO()
    chosen = style.chosen_width
    with warnings.catch_warnings():
        if chosen is not None:
            warnings.filterwarnings("error", "constrained_layout not applied")
        try:
            figure.savefig(buffer, format=kind, metadata=dateless.get(kind))
        except UserWarning as error:
            raise error if chosen is None else ValueError(
                "--width: {:g}: must be larger, as the panels of this figure have no room".format(25.4 * chosen)) from None
    return buffer.getvalue()


def save(figure: Figure, stem: str, kinds: Sequence[str] = KINDS) -> List[str]:
    """Writes stem.png and stem.svg, or stem.pdf, each completely or not at all; returns their paths."""
    contents = {}
    for kind in kinds:
        contents[stem + "." + kind] = content(figure, kind)
    write_all(contents, replace=True)
    return list(contents)
