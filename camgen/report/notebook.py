"""A page of its own file in a notebook, or in a browser."""

from __future__ import annotations

import sys
import webbrowser
from html import escape
from pathlib import Path
from typing import Any

from camgen.errors import FileError, file_errors

_HEIGHT = 760  # px, of the frame below a cell


def show_page(file: Path) -> None:
    """Show a page that needs no other file: below the cell of a notebook, which keeps it, else in a browser.

    FileError where it cannot be read, or no browser opens.
    """
    shell = _notebook()
    if shell is not None:
        with file_errors():
            text = file.read_text(encoding="utf-8")
        shell.display_pub.publish({"text/html": frame(text), "text/plain": str(file)})
    elif not webbrowser.open(file.resolve().as_uri()):
        raise FileError(file, "no browser opens here; open it in one by hand")


def frame(page: str) -> str:
    """A whole page as a part of another one, with its scripts and styles to itself."""
    style = f"width: 100%; height: {_HEIGHT}px; border: 1px solid #dfe4ea"
    return f'<div><iframe srcdoc="{escape(page)}" style="{style}"></iframe></div>'


def _notebook() -> Any:
    """The shell of the notebook that this runs in; None elsewhere."""
    interactive = sys.modules.get("IPython")
    shell = None if interactive is None else interactive.get_ipython()
    return shell if hasattr(shell, "kernel") else None
