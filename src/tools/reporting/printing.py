"""Writes the page: as it is, or printed to a PDF by a browser without a window."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile

from stochastic_platoon.files import write_all

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
PATIENCE = 120.0  # [s] for the browser


def browser() -> str:
    """The first browser that is installed. Raises ValueError if there is none."""
    for name in BROWSERS:
        path = shutil.which(name)
        if path:
            return path
    raise ValueError("a PDF needs one of {}: install one, or write .html".format(", ".join(BROWSERS)))


def require_writable(output: str) -> None:
    """Raises ValueError if the page cannot be written there, before any work is done."""
    if os.path.splitext(output)[1] not in (".html", ".pdf"):
        raise ValueError("--output: {}: must end in .html or .pdf".format(output))
    if os.path.lexists(output):
        raise ValueError("--output: {}: exists and is never overwritten: must be another name".format(output))
    if not os.path.isdir(os.path.dirname(output) or "."):
        raise ValueError("--output: {}: no such folder to write to".format(os.path.dirname(output)))
    if output.endswith(".pdf"):
        browser()


def write(text: str, output: str) -> None:
    """Writes the page. Raises OSError, also if another file of this name exists by now."""
    if output.endswith(".html"):
        write_all({output: text.encode()})
        return
    with tempfile.TemporaryDirectory() as folder:
        source, printed = os.path.join(folder, "report.html"), os.path.join(folder, "report.pdf")
        with open(source, "w", encoding="utf-8") as file:
            file.write(text)
        try:
            done = subprocess.run([browser(), "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--no-pdf-header-footer",
                                   "--user-data-dir=" + folder, "--print-to-pdf=" + printed, "file://" + source],
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            raise OSError("{}: the browser has printed nothing for {:g} s".format(output, PATIENCE)) from None
        if not os.path.exists(printed):
            raise OSError("{}: the browser printed no PDF: {}".format(output, done.stdout.strip().splitlines()[-1:]))
        with open(printed, "rb") as page:
            write_all({output: page.read()})
