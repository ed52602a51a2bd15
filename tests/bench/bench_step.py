"""What STEP by OpenCASCADE (OCP) would cost beside camgen's own: python tests/bench/bench_step.py [SPEC...].

Needs `pip install cadquery-ocp-novtk` in an environment of its own with camgen. Every part is made of its layers, as lines, arcs
and circles that are extruded, joined and cleaned, written with a fixed time, and read back; two more processes write the same.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from subprocess import run
from typing import Any

BEGUN = time.perf_counter()
from OCP.APIHeaderSection import APIHeaderSection_MakeHeader  # noqa: E402
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse  # noqa: E402
from OCP.BRepBuilderAPI import (  # noqa: E402
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeWire,
    BRepBuilderAPI_Transform,
)
from OCP.BRepCheck import BRepCheck_Analyzer  # noqa: E402
from OCP.BRepGProp import BRepGProp  # noqa: E402
from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism  # noqa: E402
from OCP.gp import gp_Ax1, gp_Ax2, gp_Circ, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec  # noqa: E402
from OCP.GProp import GProp_GProps  # noqa: E402
from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain  # noqa: E402
from OCP.STEPControl import (  # noqa: E402
    STEPControl_AsIs,
    STEPControl_Reader,
    STEPControl_Writer,
)
from OCP.TCollection import TCollection_HAsciiString  # noqa: E402

IMPORT = time.perf_counter() - BEGUN

from camgen.errors import DesignError  # noqa: E402
from camgen.files.step import write_step  # noqa: E402
from camgen.geometry.arcs import as_circle, fit_arcs  # noqa: E402
from camgen.geometry.outlines import Arc, Contour, end_point, start_point  # noqa: E402
from camgen.machines.sources import read_mechanism  # noqa: E402
from camgen.parts.exact import exact  # noqa: E402
from camgen.parts.part import Layer, Part  # noqa: E402

SPECS = Path(__file__).resolve().parents[2] / "specs"
STARTERS = ("disc-cam", "linkage", "uniform-swing", "eccentric-drive", "chain-stitch-looper")
UP = gp_Dir(0, 0, 1)
REACH = 1000.0  # mm, farther than any part


def wire(contour: Contour, z: float, tolerance: float) -> Any:
    """A contour as lines, arcs and circles at a height."""

    def at(place: complex) -> Any:
        return gp_Pnt(place.real, place.imag, z)

    made, disc = BRepBuilderAPI_MakeWire(), as_circle(contour)
    if disc:
        made.Add(BRepBuilderAPI_MakeEdge(gp_Circ(gp_Ax2(at(disc[0]), UP), disc[1])).Edge())
        return made.Wire()
    for piece in fit_arcs(contour.counter_clockwise(), tolerance).pieces:
        a, b = start_point(piece), end_point(piece)
        if abs(a - b) < 1e-9:
            continue
        if isinstance(piece, Arc):
            axis = gp_Ax2(at(piece.centre), UP if piece.sweep > 0 else gp_Dir(0, 0, -1))
            edge = BRepBuilderAPI_MakeEdge(gp_Circ(axis, piece.radius), at(a), at(b))
        else:
            edge = BRepBuilderAPI_MakeEdge(at(a), at(b))
        made.Add(edge.Edge())
    return made.Wire()


def prism(layer: Layer, tolerance: float) -> Any:
    """A layer, extruded."""
    face = BRepBuilderAPI_MakeFace(wire(layer.region.outer, layer.z0, tolerance), True)
    for hole in layer.region.holes:
        inner = wire(hole, layer.z0, tolerance)
        inner.Reverse()
        face.Add(inner)
    return BRepPrimAPI_MakePrism(face.Face(), gp_Vec(0, 0, layer.z1 - layer.z0)).Shape()


def body(part: Part, tolerance: float) -> Any:
    """A part as one solid, faces of one surface joined."""
    whole, *more = (prism(layer, tolerance) for layer in part.layers)
    for each in more:
        whole = BRepAlgoAPI_Fuse(whole, each).Shape()
    for engraved in part.engraved:
        whole = BRepAlgoAPI_Cut(whole, prism(engraved, tolerance)).Shape()
    if part.side_profile is not None:  # its second outline is one of x and z, along y
        upright = gp_Trsf()
        upright.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)), 1.5707963267948966)
        across = prism(Layer(part.side_profile, -REACH, REACH), tolerance)
        across = BRepBuilderAPI_Transform(across, upright, True).Shape()
        whole = BRepAlgoAPI_Common(whole, across).Shape()
    cleaned = ShapeUpgrade_UnifySameDomain(whole, True, True, False)
    cleaned.Build()
    return cleaned.Shape()


def write(path: Path, shape: Any) -> None:
    """Write it without a date."""
    writer = STEPControl_Writer()
    writer.Transfer(shape, STEPControl_AsIs)
    header = APIHeaderSection_MakeHeader(writer.Model())
    header.SetTimeStamp(TCollection_HAsciiString("1970-01-01T00:00:00"))
    header.SetName(TCollection_HAsciiString(path.stem))
    writer.Write(str(path))


def read(path: Path) -> tuple[float, bool]:
    """Volume of what a file holds, mm^3, and whether it is valid."""
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    shape, mass = reader.OneShape(), GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, mass, 1e-9)
    return mass.Mass(), BRepCheck_Analyzer(shape).IsValid()


def spent(work: Callable[[], object]) -> tuple[Any, float]:
    """What the work gives, and the milliseconds of processor time that it took."""
    begun = time.process_time()
    return work(), 1e3 * (time.process_time() - begun)


def compare(name: str, folder: Path) -> list[dict[str, Any]]:
    """Write every part of a spec both ways."""
    machine = read_mechanism(SPECS / f"{name}.toml").resolved()
    tolerance, rows = machine.accuracy.chord_tolerance, []
    for part in machine.assembly.parts:
        ours, theirs = (folder / f"{name}-{part.name}-{who}.step" for who in ("ours", "ocp"))

        def own(part: Part = part, path: Path = ours) -> None:
            solid = exact(part, tolerance)
            write_step(path, {part.name: solid}, {part.name: part.title}, part.name)

        row: dict[str, Any] = {"ocp": spent(lambda p=part, f=theirs: write(f, body(p, tolerance)))}
        row |= {"off": read(theirs)[0] / part.volume - 1, "valid": read(theirs)[1]}
        try:
            row["ours"] = spent(own)
            row |= {"ours off": read(ours)[0] / part.volume - 1, "ours valid": read(ours)[1]}
        except DesignError:
            row["ours"] = None
        sizes = (path.stat().st_size if path.exists() else 0 for path in (ours, theirs))
        rows.append(row | {"size": tuple(sizes)})
    return rows


def told(name: str, rows: list[dict[str, Any]], equal: bool) -> str:
    """A row of the table."""
    both = [row for row in rows if row["ours"]]
    cells = [
        f"{name}, {len(rows)} parts",
        f"{len(both)}",
        f"{len(rows)}",
        f"{sum(row['ours'][1] for row in both):.0f}",
        f"{sum(row['ocp'][1] for row in both):.0f}",
        f"{sum(row['size'][0] for row in both) / 1000:.0f}",
        f"{sum(row['size'][1] for row in both) / 1000:.0f}",
        f"{max((abs(row['ours off']) for row in both), default=0):.0e}",
        f"{max(abs(row['off']) for row in rows):.0e}",
        "yes" if all(row["valid"] and row.get("ours valid", True) for row in rows) else "no",
        "yes" if equal else "no",
    ]
    return f"| {' | '.join(cells)} |"


HEAD = (
    "| spec | solids, ours | OCP | ms, ours | OCP | kB, ours | OCP | volume off, ours | OCP "
    "| all valid | same bytes again |"
)

if __name__ == "__main__":
    if sys.argv[1:2] == ["--write"]:  # one of two more processes
        compare(sys.argv[2], Path(sys.argv[3]))
        sys.exit()
    lines = [HEAD, "|" + "---|" * 11]
    for spec in sys.argv[1:] or STARTERS:
        with tempfile.TemporaryDirectory() as place:
            found = compare(spec, Path(place))
            files = []
            for other in ("first", "second"):
                folder = Path(place) / other
                folder.mkdir()
                again = [sys.executable, __file__, "--write", spec, str(folder)]
                run(again, check=True, capture_output=True)
                files.append({path.name: path.read_bytes() for path in folder.iterdir()})
        lines.append(told(spec, found, files[0] == files[1]))
    print("\n".join([*lines, "", f"OCP is loaded in {IMPORT:.2f} s."]), file=sys.stderr)
