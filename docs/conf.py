"""Sphinx configuration; the pages of the lectures are written from the lectures themselves, replayed at build time."""

from pathlib import Path

from derive import __version__
from derive.notes import write_notes
from derive.theory import LECTURES

HERE = Path(__file__).parent

project = "derive"
author = "the derive developers"
copyright = "the derive developers, Apache-2.0"
version = release = __version__
extensions = ["myst_parser"]
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_dmath_double_inline = True
myst_heading_anchors = 3
exclude_patterns = ["_build"]
html_theme = "furo"
html_title = f"derive {release}"
html_copy_source = False
html_show_sphinx = False

# The lectures' anchors are their own, in front of each display; MyST looks for headings and would complain.
suppress_warnings = ["myst.xref_missing"]


def write_lectures() -> None:
    """Write one page a lecture."""
    folder = HERE / "lectures"
    folder.mkdir(exist_ok=True)
    for key in LECTURES:
        if not write_notes([key], folder / f"{key}.md", "gfm"):
            raise RuntimeError(f"{key}: a step is not proved")


write_lectures()
