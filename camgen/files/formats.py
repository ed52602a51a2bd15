"""The formats that a part is written in and read back from, one module each, under the endings of their files.

Each module has `write_part(path, job)` and `read_part(path, name)`: a mesh or an exact solid and remarks, or a drawing. They are
loaded where they are used. Whoever makes or judges files takes from here which there are and what they hold.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from camgen.bounds import Bound
from camgen.tolerances import FLOAT32_ROUNDING

if TYPE_CHECKING:
    from camgen.geometry.brep import Brep
    from camgen.geometry.mesh import Mesh
    from camgen.geometry.outlines import Contour, Points, Region
    from camgen.geometry.rings import Ring
    from camgen.parts.part import Part


# As what a drawing shows contours: polylines with arcs, polylines of chords, lines and arcs end on end, or splines.
Curves = Literal["bulge", "lines", "arcs", "spline"]


@dataclass(frozen=True)
class Format:
    """A format: its module in this package, and what it holds: a drawing, a mesh, or an exact solid.

    rounding: of a length in a file, as a share of it; numbers: what rounds, for people; size: how large a file is read.
    """

    module: str
    holds: Literal["drawing", "mesh", "exact"]
    rounding: float
    numbers: str
    size: Bound

    @property
    def solid(self) -> bool:
        """Whether it holds a mesh."""
        return self.holds == "mesh"

    @property
    def code(self) -> Any:
        """The module, loaded."""
        return import_module(f"camgen.files.{self.module}")


_LARGE = 200_000_000  # bytes
_DXF = Bound(
    "a DXF file",
    _LARGE,
    most=2_000_000,
    remedy="leave out what is not the outline, or draw it with arcs",
)
_STEP = Bound("a STEP file", 60_000_000, b";,( ", "entities and values", 3_000_000)
_STL = Bound("an STL file", _LARGE)  # its triangles are counted as it is read
_GCODE = Bound("G-code", _LARGE, most=3_000_000, remedy="slice fewer parts at a time")
FORMATS = {
    "dxf": Format("dxf", "drawing", 0.0, "decimals", _DXF),
    "stl": Format("stl", "mesh", FLOAT32_ROUNDING, "float32", _STL),
    "3mf": Format("threemf", "mesh", FLOAT32_ROUNDING, "float32", Bound("a 3MF file", _LARGE)),
    "step": Format("step", "exact", 0.0, "decimals", _STEP),
}
READABLE = {
    **FORMATS,
    "gcode": Format("gcode", "mesh", 1e-5, "decimals", _GCODE),
}  # as well, what other programs make of them
_HELD = ("drawing", "mesh", "exact")
DRAWN, SOLID, EXACT = (
    tuple(kind for kind, form in FORMATS.items() if form.holds == content) for content in _HELD
)
USUAL = (*DRAWN, *SOLID)  # made where nobody asks for other ones
KINDS = (*USUAL, "report")  # what a build makes where nobody says which
RENDERED = {"picture": "png", "animation": "gif"}  # of the machine as a whole, by their endings
ANY_KIND = (*FORMATS, "report", "servo", "mjcf", "plots", *RENDERED)  # that can be asked for


@dataclass(frozen=True)
class Job:
    """A part, as a file is to hold it.

    name: of the part; title: of the file; key: what identifiers inside a file are made from.
    region, centres (complex mm): what a drawing shows, within tolerance, mm; curves: as what.
    solid: as it is sent to the printer, None where no mesh is asked for; part: itself, where an exact solid is; engraved:
    contours that the drawing shows besides.
    """

    name: str
    title: str
    key: str
    region: Region
    centres: Sequence[complex]
    tolerance: float
    curves: Curves
    solid: Mesh | None
    part: Part | None = None
    engraved: Sequence[Contour] = ()


@dataclass(frozen=True)
class DrawingFault:
    """What is wrong with one entity of the CUT layer.

    kind: "open" (size = the gap, mm), "duplicate", "entity" (not a closed polyline or circle, or not in the modelspace),
    "number" (not finite), "zero_length" (size = how many segments), "plane" (mirrored or raised off z = 0), "look"
    (invisible, with a width, in a colour of its own...), "layer" (off, frozen, locked or not plotted).
    """

    kind: str
    size: float
    message: str


@dataclass(frozen=True)
class Drawing:
    """A drawing as read: units ($INSUNITS, None when absent; 4 = mm), rings to cut, strokes of centre marks, faults.

    cut: in the file's order; marks: (n, 2) complex, mm, the ends of each LINE on the layer of centre marks; engraved: rings.
    layers: colour index and line weight, 1/100 mm, of those three: by these a program of a laser chooses its tool.
    curves: as what contours are drawn that are no closed polylines or circles, "arcs" or "spline"; else "bulge".
    """

    units: int | None
    cut: tuple[Ring, ...]
    marks: Points
    faults: tuple[DrawingFault, ...]
    engraved: tuple[Ring, ...] = ()
    layers: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    curves: Curves = "bulge"

    def repainted(self, looks: Mapping[str, tuple[int, int]]) -> list[str]:
        """What is wrong with its layers, where these are to have such colours and line weights."""
        return [
            f"layer {name} has colour {look[0]} and line weight {look[1]}, not {looks[name][0]} and {looks[name][1]}"
            for name, look in self.layers.items()
            if name in looks and look != looks[name]
        ]


def write_part(path: Path, job: Job) -> None:
    """Write a part's file in the format of its ending; an OSError means that it could not be written."""
    FORMATS[path.suffix[1:]].code.write_part(path, job)


def read_solid(path: Path, name: str) -> tuple[Mesh, list[str]]:
    """The solid of the part of this name in a file of a solid, and what is wrong with the file as such.

    FileError where it cannot be read.
    """
    mesh, remarks = FORMATS[path.suffix[1:]].code.read_part(path, name)
    return mesh, remarks


def read_exact(path: Path, name: str) -> tuple[Brep, list[str]]:
    """The exact solid of the part of this name, and what is wrong with the file as such; FileError where it cannot be read."""
    body, remarks = FORMATS[path.suffix[1:]].code.read_part(path, name)
    return body, remarks


def read_drawing(path: Path, name: str) -> Drawing:
    """The drawing of the part of this name; FileError where it cannot be read."""
    drawing: Drawing = FORMATS[path.suffix[1:]].code.read_part(path, name)
    return drawing
