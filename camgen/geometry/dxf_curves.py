"""Curves of a DXF of any maker: lines, arcs, polylines, circles, ellipses and splines, those in blocks too, as chains of lines and
arcs."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import Any

import numpy as np

from camgen.errors import FileError
from camgen.geometry.chains import Chain
from camgen.geometry.rings import Floats, Points
from camgen.tolerances import CURVE_CHORDS, SAME_POINT

_MOST_POINTS = 500_000
# of a drawing: those that blocks stand for, those that curves become
_MOST_ENTITIES = 50_000
_MOST_CHORDS = 2_000_000
# of a spline
_MOST_FIT_POINTS = 5_000
_MOST_DEGREE = 24
_BEYOND = 1e12  # mm, and bulge: what no drawing means
_NESTED = 16  # blocks within blocks
_UNITLESS = 0
NO_UNIT = "no unit"
# $INSUNITS of a DXF: name and mm.
_UNITS = {
    1: ("inches", 25.4),
    2: ("feet", 304.8),
    3: ("miles", 1_609_344.0),
    4: ("millimetres", 1.0),
    5: ("centimetres", 10.0),
    6: ("metres", 1e3),
    7: ("kilometres", 1e6),
    8: ("microinches", 25.4e-6),
    9: ("mils", 0.0254),
    10: ("yards", 914.4),
    13: ("micrometres", 1e-3),
    14: ("decimetres", 100.0),
}


def unit_of(path: Path, drawing: Any, content: bytes) -> tuple[str, float]:
    """Name of a drawing's unit, "no unit" where it has none, and mm in it; FileError where it is none that is known."""
    # the library makes up metres where the header says nothing
    code = int(drawing.header.get("$INSUNITS", _UNITLESS)) if b"$INSUNITS" in content else _UNITLESS
    if code != _UNITLESS and code not in _UNITS:
        raise FileError(
            path, f"is drawn in unit number {code} of $INSUNITS; millimetres (4) were expected"
        )
    return _UNITS.get(code, (NO_UNIT, 1.0))


def drawing(path: Path, content: bytes) -> Any:
    """The drawing as ezdxf reads it."""
    from ezdxf.filemanagement import readfile
    from ezdxf.lldxf.const import DXFError

    if not content.rstrip(b"\x00\x1a \t\r\n").endswith(b"EOF"):
        raise FileError(path, "not a DXF file, or cut short: it does not end in EOF")
    try:
        return readfile(str(path))
    except (
        DXFError,
        OSError,
        UnicodeDecodeError,
        ValueError,
        TypeError,
        IndexError,
        KeyError,
        AttributeError,
    ) as error:
        raise FileError(path, f"not a valid DXF file: {error}") from None


def entities(path: Path, drawing: Any, layer: str | None) -> list[Any]:
    """What the modelspace shows on a layer, or on all that are on."""
    from ezdxf.lldxf.const import DXFError

    try:
        _refuse_bomb(path, drawing)
        hidden = {
            str(each.dxf.name).lower()
            for each in drawing.layers
            if each.is_off() or each.is_frozen()
        }
        entities = []
        for entity in _exploded(drawing.modelspace()):
            name = str(entity.dxf.layer).lower()
            if name not in hidden if layer is None else name == layer.lower():
                entities.append(entity)
    except DXFError as error:
        raise FileError(path, f"not a valid DXF file: {error}") from None
    if layer is not None and not entities:
        layers = sorted({str(entity.dxf.layer) for entity in drawing.modelspace()})
        raise FileError(
            path, f"has nothing on layer {layer!r}; its layers are {', '.join(layers) or 'empty'}"
        )
    return entities


def chains(
    path: Path, entities: Sequence[Any], scale: float, tolerance: float = CURVE_CHORDS
) -> tuple[list[Chain], str]:
    """The curves among the entities, mm, splines and ellipses as chords within the tolerance, mm; and what the others are."""
    chains = []
    others = Counter[str]()
    chords = 0
    for entity in entities:
        chain = _chain(entity, tolerance / scale)
        chords += len(chain.bulges) if chain else 0
        if chords > _MOST_CHORDS:
            raise FileError(
                path, f"has curves of more than {_MOST_CHORDS} chords within {tolerance:g} mm"
            )
        if chain is None:
            others[entity.dxftype()] += 1
        elif not (
            np.all(np.abs(chain.points) * scale < _BEYOND)
            and np.all(np.abs(chain.bulges) < _BEYOND)
        ):
            what = "a coordinate that is not finite, or as good as infinite"
            raise FileError(path, f"{entity.dxftype()} #{entity.dxf.handle} has {what}")
        else:
            chains.append(Chain(chain.points * scale, chain.bulges, chain.closed))
    return chains, ", ".join(f"{count} {kind}" for kind, count in sorted(others.items()))


def _refuse_bomb(path: Path, drawing: Any) -> None:
    """FileError where blocks within blocks stand for more than _MOST_ENTITIES, or one holds itself."""
    inside: dict[str, list[tuple[str, int]]] = {}
    counts: dict[str, int] = {}
    for block in drawing.blocks:  # the modelspace is one of them
        references = [
            (str(e.dxf.name).lower(), max(e.mcount, 1)) for e in block if e.dxftype() == "INSERT"
        ]
        inside[block.name.lower()] = references
        counts[block.name.lower()] = len(block)
    try:
        for name in TopologicalSorter(
            {
                name: {other for other, _ in references_held}
                for name, references_held in inside.items()
            }
        ).static_order():
            counts[name] = counts.get(name, 0) + sum(
                times * counts[other] for other, times in inside.get(name, ())
            )
    except CycleError as error:
        raise FileError(path, f"has a block that holds itself: {error.args[1][0]}") from None
    most = max(
        counts[block.name.lower()] - len(block) for block in drawing.blocks if block.is_modelspace
    )
    if most > _MOST_ENTITIES:
        number = str(most) if most < 1e9 else f"about 1e{len(str(most)) - 1}"
        raise FileError(
            path,
            f"holds blocks that stand for {number} entities; at most {_MOST_ENTITIES} are read",
        )


def _exploded(entities: Iterable[Any], depth: int = 0) -> Iterator[Any]:
    """The entities, with block references replaced by what they show."""
    for entity in entities:
        if entity.dxftype() == "INSERT" and depth < _NESTED:
            for single in entity.multi_insert() if entity.mcount > 1 else (entity,):
                yield from _exploded(single.virtual_entities(), depth + 1)
        else:
            yield entity


def _chain(entity: Any, tolerance: float) -> Chain | None:
    """The curve of an entity in the world's xy plane, drawing units; None for what is no curve, or not in that plane."""
    kind = entity.dxftype()
    dxf = entity.dxf
    if kind == "LINE":
        return Chain(_plane([dxf.start, dxf.end]), np.zeros(1))
    if kind in ("SPLINE", "ELLIPSE"):
        try:
            points = _spline(entity, tolerance) if kind == "SPLINE" else _ellipse(entity, tolerance)
        except (ValueError, ZeroDivisionError, IndexError):
            return None
        return _open_or_closed(points, np.zeros(len(points) - 1)) if len(points) > 1 else None
    if (
        kind not in ("ARC", "CIRCLE", "LWPOLYLINE", "POLYLINE")
        or abs(abs(dxf.extrusion.z) - 1) > 1e-9
    ):
        return None
    if kind in ("ARC", "CIRCLE"):
        centre = complex(dxf.center.x, dxf.center.y)
        radius = float(dxf.radius)
        start = 0.0
        sweep = math.tau
        if kind == "ARC":
            start = math.radians(dxf.start_angle)
            sweep = math.radians((dxf.end_angle - dxf.start_angle) % 360) or math.tau
        angles = start + np.linspace(0, sweep, 3)
        points = centre + radius * np.exp(1j * angles)
        bulges = np.full(2, math.tan(sweep / 8))
    elif kind == "LWPOLYLINE":
        rows = np.array(entity.get_points("xyb"), float).reshape(-1, 3)
        points, bulges = _round(rows, entity.closed)
    else:
        if not (entity.is_2d_polyline or entity.is_3d_polyline):
            return None
        rows = np.array(
            [
                (v.dxf.location.x, v.dxf.location.y, v.dxf.get("bulge", 0.0))
                for v in entity.vertices
            ],
            float,
        )
        points, bulges = _round(rows.reshape(-1, 3), entity.is_closed)
    if len(points) < 2:
        return None
    if dxf.extrusion.z < 0:  # drawn from below: mirrored in the y axis
        points = -np.conj(points)
        bulges = -bulges
    return _open_or_closed(points, bulges)


def _open_or_closed(points: Points, bulges: Floats) -> Chain:
    return Chain(points, bulges, abs(points[0] - points[-1]) <= SAME_POINT)


def _ellipse(entity: Any, tolerance: float) -> Points:
    """Chords of an ellipse in even steps of its parameter t, of which c + a cos t + b sin t is at most |a| step^2 / 8 off."""
    dxf = entity.dxf
    centre, a, b = (complex(p.x, p.y) for p in (dxf.center, dxf.major_axis, entity.minor_axis))
    sweep = (dxf.end_param - dxf.start_param) % math.tau or math.tau
    count = max(math.ceil(sweep / math.sqrt(8 * tolerance / dxf.major_axis.magnitude)), 6)
    if count > _MOST_POINTS:
        raise OverflowError(
            f"{count} chords for ELLIPSE #{dxf.handle}; at most {_MOST_POINTS} are made"
        )
    t = dxf.start_param + np.linspace(0, sweep, count + 1)
    points = centre + a * np.cos(t) + b * np.sin(t)
    return np.append(points[:-1], points[:1]) if sweep == math.tau else points


def _spline(entity: Any, tolerance: float) -> Points:
    """Chords of a spline, which is drawn from knot p to knot n, p its degree and n the number of its control points.

    Between them lies all of a clamped one, and of a closed one whose knots are not clamped what is meant.
    """
    if not len(entity.control_points) and len(entity.fit_points) > _MOST_FIT_POINTS:
        many = len(entity.fit_points)
        raise OverflowError(
            f"{many} points to fit SPLINE #{entity.dxf.handle} to; at most {_MOST_FIT_POINTS} do"
        )
    if entity.dxf.degree > _MOST_DEGREE:
        raise OverflowError(
            f"a degree of {entity.dxf.degree} for SPLINE #{entity.dxf.handle}; at most {_MOST_DEGREE} is read"
        )
    tool = entity.construction_tool()
    knots = np.array(tool.knots(), float)
    degree = int(tool.degree)
    points = np.array([p.xyz for p in tool.control_points], float)
    weights = np.array(tool.weights(), float)
    if len(knots) != len(points) + degree + 1 or np.any(np.diff(knots) < 0):
        raise ValueError("a knot vector that does not fit")
    begin = knots[degree]
    end = knots[-1 - degree]
    if not end > begin:
        raise ValueError("a knot vector of no length")
    from scipy.interpolate import BSpline

    weights = weights if len(weights) else np.ones(len(points))
    curve = BSpline(knots, np.column_stack([points[:, :2] * weights[:, None], weights]), degree)

    def at(t: Floats) -> Points:
        x, y, w = curve(t).T
        return np.asarray((x + 1j * y) / w)

    t = np.unique(np.clip(knots, begin, end))
    t = np.unique(
        np.concatenate(
            [t[:-1] + fraction * np.diff(t) for fraction in (0, 0.25, 0.5, 0.75)] + [t[-1:]]
        )
    )
    while len(t) < _MOST_POINTS:
        z = at(t)
        step = np.diff(t)
        off = [
            np.abs(at(t[:-1] + fraction * step) - z[:-1] - fraction * np.diff(z))
            for fraction in (0.25, 0.5, 0.75)
        ]
        far = np.flatnonzero(~(np.max(off, axis=0) <= tolerance))
        if not len(far):
            return at(t)
        t = np.sort(np.concatenate([t, t[far] + step[far] / 2]))
    raise OverflowError(f"more than {_MOST_POINTS} chords for SPLINE #{entity.dxf.handle}")


def _plane(points: Iterable[Any]) -> Points:
    return np.array([complex(p.x, p.y) for p in points])


def _round(rows: Floats, closed: bool) -> tuple[Points, Floats]:
    """Points and bulges of (n, 3) rows x, y, bulge; a closed polyline ends at its first point."""
    points = rows[:, 0] + 1j * rows[:, 1]
    bulges = rows[:, 2]
    return (np.append(points, points[:1]), bulges) if closed else (points, bulges[:-1])
