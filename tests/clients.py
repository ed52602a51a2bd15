"""Opens built STL, 3MF and DXF files in programs that people use: python tests/clients.py FOLDER...

Needs admesh, prusa-slicer, openscad, librecad (apt); what is not installed is passed over, and said so.
Exit codes of these programs mean little, so their output is read.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

ENVIRONMENT = os.environ | {"LC_ALL": "C.UTF-8", "QT_QPA_PLATFORM": "offscreen"}


def said(*command: object, limit: float = 120) -> str:
    """Everything a program prints; what it said before the time limit, if it runs into that."""
    kept = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    try:
        return subprocess.run([str(word) for word in command], env=ENVIRONMENT, timeout=limit, **kept).stdout
    except subprocess.TimeoutExpired:
        return "time limit"


def admesh(path: Path) -> bool:
    """No repair of any kind, one part."""
    text = said("admesh", path)
    facts = dict(re.findall(r"([A-Z][\w ]+?) *: +(\d+)", text))
    repairs = ("Degenerate facets", "Edges fixed", "Facets removed", "Facets added", "Facets reversed", "Normals fixed")
    clean = all(facts.get(key) == "0" for key in (*repairs, "Backwards edges", "Total disconnected facets"))
    return clean and facts.get("Number of parts") == "1"


def prusa(path: Path) -> bool:
    """Manifold, and nothing repaired on loading."""
    text = said("prusa-slicer", "--info", path)
    repaired = re.search("edges_fixed|facets_reversed|facets_removed|degenerate_facets|backwards_edges", text)
    return "manifold = yes" in text and "manifold = no" not in text and not repaired


def openscad(path: Path) -> bool:
    """One simple body for the exact kernel."""
    with tempfile.TemporaryDirectory() as folder:
        scad = Path(folder, "x.scad")
        cube = "translate([-5000, -5000, -5000]) cube(10000);"
        scad.write_text(f'intersection() {{ import("{path.resolve()}"); {cube} }}')
        text = said("openscad", "-o", scad.with_suffix(".off"), scad)
    return bool(re.search(r"Simple: +yes", text) and re.search(r"Volumes: +2\b", text)) and "ERROR" not in text


def librecad(path: Path) -> bool:
    """A PDF comes out."""
    with tempfile.TemporaryDirectory() as folder:
        said("librecad", "dxf2pdf", "-c", "-s", "5", "-t", folder, path, limit=30)
        return any(pdf.stat().st_size > 1000 for pdf in Path(folder).glob("*.pdf"))


CLIENTS: dict[str, list[tuple[str, Callable[[Path], bool]]]] = {
    ".stl": [("admesh", admesh), ("prusa-slicer", prusa), ("openscad", openscad)],
    ".3mf": [("prusa-slicer", prusa)],
    ".dxf": [("librecad", librecad)],
}


def main(folders: list[str]) -> int:
    """Print a line for each file and program; 1 if any refuses a file."""
    refused = 0
    for path in sorted(p for folder in folders for p in Path(folder).iterdir()):
        for program, accepts in CLIENTS.get(path.suffix, []):
            verdict = "not installed"
            if shutil.which(program):
                ok = accepts(path)
                verdict, refused = ("ok", refused) if ok else ("REFUSED", refused + 1)
            print(f"{path.name:40} {program:14} {verdict}")
    return 1 if refused else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
