"""3MF packages, counted before they are unpacked: components within components multiply, and so do packed bytes.

    part      a file in the package, by its name
    object    what a part defines, by part and number; number BUILD stands for what the part has built
"""

from __future__ import annotations

import re
import zipfile
import zlib
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from xml.parsers import expat

from camgen.errors import FileError

MOST_COPIES = 10_000  # of objects in one assembly, those on the way to the meshes counted
MOST_BYTES = 1_000_000_000  # unpacked
BUILD, _NONE = -1, -2
_OURS = {"[content_types].xml", "_rels/.rels", "3d/3dmodel.model"}  # parts of a package as camgen writes it

Object = tuple[str, int]


def refuse_bomb(path: str | Path) -> None:
    """FileError where a 3MF places more than MOST_COPIES or unpacks to more than MOST_BYTES, or is no package.

    lib3mf walks through all copies as it reads: a billion, in a file of a kilobyte, take it half a minute.
    """
    inside: dict[Object, list[Object]] = {}
    try:
        with zipfile.ZipFile(path) as package:
            size = sum(part.file_size for part in package.infolist())
            if size > MOST_BYTES:
                raise FileError(path, f"unpacks to {size / 1e6:.0f} MB; {MOST_BYTES / 1e6:.0f} MB at most are read")
            parts = {name: package.read(name) for name in package.namelist()}
        if not any(b"component" in text for text in parts.values()):  # lib3mf reads UTF-8 alone
            return
        for name, text in parts.items():
            try:
                _count(f"/{name}".lower(), text, inside)
            except expat.ExpatError:
                if name.lower().endswith(".model"):
                    raise
        copies: dict[Object, int] = {}
        for each in TopologicalSorter(inside).static_order():
            copies[each] = 1 + sum(copies[other] for other in inside[each])
    except CycleError as error:
        raise FileError(path, f"not a valid 3MF file: object {error.args[1][0][1]} is made of itself") from None
    except (zipfile.BadZipFile, zlib.error, RuntimeError, EOFError, expat.ExpatError, ValueError) as error:
        raise FileError(path, f"not a valid 3MF file: {error}") from None
    except KeyError as error:
        raise FileError(path, f"not a valid 3MF file: there is no object {error.args[0][1]} in it") from None
    most = max(copies.values(), default=0)
    if most > MOST_COPIES:
        said = str(most) if most < 1e9 else f"some 1e{len(str(most)) - 1}"
        raise FileError(path, f"places {said} copies of its objects; {MOST_COPIES} at most are read")


def extras(path: str | Path) -> list[str]:
    """What a package holds beside meshes and what is built of them, and could be printed: sentences, none for a plain one.

    Beams, slices, volumes and the like stand in elements of extensions, modifiers of a slicer in parts of their own.
    """
    with zipfile.ZipFile(path) as package:
        names = package.namelist()
        found = sorted({tag.decode() for name in names for tag in re.findall(rb"<(\w+:\w+)", package.read(name))})
    other = [name for name in names if name.lower() not in _OURS]
    said = [f"holds elements of extensions: {', '.join(found[:5])}"] if found else []
    return said + ([f"holds parts that are not camgen's: {', '.join(other[:5])}"] if other else [])


def _count(part: str, text: bytes, inside: dict[Object, list[Object]]) -> None:
    """Add to `inside` which objects each object of a part is made of."""
    holder: list[Object] = []

    def begin(tag: str, attributes: dict[str, str]) -> None:
        nonlocal holder
        kind = tag.rpartition(" ")[2]
        if kind == "object":
            holder = inside.setdefault((part, int(attributes.get("id", _NONE))), [])
        elif kind == "build":
            holder = inside.setdefault((part, BUILD), [])
        elif kind in ("component", "item"):
            other = next((value.lower() for key, value in attributes.items() if key.endswith(" path")), part)
            holder.append((other, int(attributes.get("objectid", _NONE))))

    parser = expat.ParserCreate(namespace_separator=" ")
    parser.StartElementHandler = begin
    parser.Parse(text, True)
