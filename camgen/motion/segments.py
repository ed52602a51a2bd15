"""The `[[segment]]` tables of a spec: from kind, span, lift and law to a program, or to the list of what is wrong.

[[segment]]
kind = "rise"                                          # "rise", "dwell" or "return"; left out where `to` says it
span_deg = 90                                          # may be left out of one dwell: the rest of the turn
at_deg = 90                                            # or, of a timing chart, in all segments: the angle at which it ends
lift = 10                                              # or to = 10: the displacement at the end
task = "RU"                                            # what it joins: rest, uniform motion (G), reversal (U), motion (B)
end_velocity = 0.1                                     # of G and B; end_acceleration of U and B, end_jerk
law = "modified-sine"                                  # a name of NAMES, or "matched" (joins its neighbours in v and a)
law = { name = "modified-sine", constant_velocity = 0.2, lambda = 0.4 }
law = { name = "fourier", sines = [6.283185307179586] }
law = { name = "polynomial", conditions = [[0, 0, 0], [0, 1, 0], [1, 0, 1], [1, 1, 0]] }    # u, order, value
law = { name = "table", file = "rise.csv" }            # angle and displacement in any unit, from the first row to the last

Without a law it is the one of least acceleration.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import lru_cache
from itertools import groupby
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field

from camgen.errors import Fault, Key, SpecError
from camgen.motion.chart import MATCHED as MATCHED
from camgen.motion.chart import Chart, Move, Rates, Resolved
from camgen.motion.closed import closed_program
from camgen.motion.laws import LAWS, Law, fourier, modified_sine, polynomial_law, table_law
from camgen.motion.program import Program, Segment, matched
from camgen.motion.tables import read_points
from camgen.motion.tasks import CHOICES, REST, SYNONYMS, End, Form, law_for, least, shifted
from camgen.motion.tasks import FAMILIES as TASK_LAWS
from camgen.numerics import Floats, distinct
from camgen.reading import Reference
from camgen.spec import Record, quantity, text_of_form, unknown
from camgen.tolerances import LAW_CLOSES

# Laws with parameters: their keys, and what they are.
FAMILIES = {
    **{name: family.keys for name, family in TASK_LAWS.items()},
    "fourier": ("sines", "cosines", "lambda"),
    "polynomial": ("conditions",),
    "table": ("points", "file", "source", "rest", "tolerance"),
    **dict.fromkeys(CHOICES, ("lambda", "constant_velocity")),
}
ABOUT = {
    **{name: family.about for name, family in TASK_LAWS.items()},
    "fourier": "acceleration: sines of 2 pi u, 4 pi u, ..., cosines of pi u, 3 pi u, ...",
    "polynomial": "conditions [u, order, value], as many as coefficients; from 0 at u = 0 to 1 at u = 1",
    "table": "spline through points [angle, displacement], or a file's; rest = false: it does not start and end at rest; over 360 deg it closes",
    MATCHED: "quintic that takes velocity and acceleration from its neighbours ([[segment]] alone)",
    "least-acceleration": "the law that joins its neighbours with the least C_a; the default",
    "least-jerk": "the law that joins its neighbours with the least C_j",
    "least-torque": "the law that joins its neighbours with the least C_M, the torque of inertia",
}
# What a list shows of the laws: their title, and each at lambda 1/2; from reversals those that laws between dwells have not.
SHOWN = (
    *LAWS.items(),
    ("modified-trapezoid RU", law_for("modified-trapezoid", REST, End("U", a=None))),
    ("harmonic-combination RU", law_for("harmonic-combination", REST, End("U", a=None))),
    ("simple-harmonic UU", law_for("simple-harmonic", End("U", a=None), End("U", a=None))),
)
NAMES = tuple(dict.fromkeys((*LAWS, *ABOUT)))
_NEEDED = {
    "fourier": ("sines", "cosines"),
    "polynomial": ("conditions",),
    "table": ("points", "file"),
}  # one of them
_FULL_TURN_SLACK = 1e-9  # deg, of rounding in a sum of spans
_RADIANS = 0.05  # rad, within which spans that were typed in radians make a turn
_LEAST_SPAN = 1e-3  # deg

Terms = Annotated[tuple[Annotated[float, quantity("1")], ...], Field(max_length=50)]
Condition = tuple[
    Annotated[float, Field(ge=0, le=1)], Annotated[int, Field(ge=0, le=20)], float
]  # u, order, value


class LawChoice(Record):
    """A law with its parameters."""

    name: Annotated[str, BeforeValidator(lambda name: SYNONYMS.get(str(name), name))] = Field(
        description="name of the law, see camgen list"
    )
    constant_velocity: Annotated[float, quantity("1")] | None = Field(
        default=None, description="share of the span at constant velocity"
    )
    inflection: Annotated[float, quantity("1", gt=0, lt=1)] | None = Field(
        default=None,
        alias="lambda",
        description="place of the inflection in the span; default: 0.5, or where camgen finds it",
    )
    ramp: Annotated[float, quantity("1", gt=0, le=1)] | None = Field(
        default=None,
        description="modified-trapezoid at a reversal: share of that half in which the acceleration falls",
    )
    c_a_star: Annotated[float, quantity("1", gt=0, le=1e6)] | None = Field(
        default=None, description="greatest normal deceleration, in place of lambda"
    )
    sines: Terms | None = Field(
        default=None, description="factors of sin 2 pi u, sin 4 pi u, ... in the acceleration"
    )
    cosines: Terms | None = Field(
        default=None, description="factors of cos pi u, cos 3 pi u, ... in the acceleration"
    )
    conditions: Annotated[tuple[Condition, ...], Field(max_length=20)] | None = Field(
        default=None,
        description="polynomial: rows of u, order of the derivative, value",
        json_schema_extra={"unit": "1"},
    )
    points: Annotated[tuple[tuple[float, float], ...], Field(max_length=20_000)] | None = Field(
        default=None,
        description="table: rows of angle and displacement, in any unit",
        json_schema_extra={"unit": "1"},
    )
    file: str | None = Field(
        default=None, description="table: a file beside the spec with these two columns"
    )
    source: str | None = Field(default=None, description="table: source of the rows")
    rest: bool | None = Field(
        default=None, description="table: true if the motion starts and ends at rest"
    )
    tolerance: Annotated[float, quantity("mm or deg", gt=0, le=1e3)] | None = Field(
        default=None,
        description="table over the whole turn: how far the motion may differ from the rows; camgen makes it as smooth as this allows",
    )

    @property
    def parameters(self) -> dict[str, Any]:
        """The parameters that are given, by their keys."""
        given = {key: value for key, value in self if key != "name" and value is not None}
        return {"lambda" if key == "inflection" else key: value for key, value in given.items()}

    @property
    def form(self) -> Form:
        """What is said of a law of halves or a polynomial."""
        return Form(self.inflection, self.constant_velocity, self.ramp, self.c_a_star)


# A law's bare name stands for the table with that name alone.
NamedLaw = Annotated[
    LawChoice,
    BeforeValidator(
        lambda law: {"name": law} if isinstance(law, str) else law,
        json_schema_input_type=str | LawChoice,
    ),
]


Kind = Literal["rise", "dwell", "return"]
Share = Annotated[float, quantity("1", ge=0, lt=1)]


class Span(Record):
    """A stretch of the turn: when, what it joins, and by which law; how far is said by the tables built on it."""

    kind: Kind | None = Field(
        default=None,
        description='"rise", "dwell" or "return"; you may leave it out if the end shows which',
    )
    span_deg: Annotated[float, quantity("deg", ge=_LEAST_SPAN, le=360)] | None = Field(
        default=None,
        description="how much of the turn, or of a drive's period, the segment takes; one dwell may leave it out and takes the rest",
    )
    at_deg: Annotated[float, quantity("deg", gt=0, le=360)] | None = Field(
        default=None,
        description="angle at which the segment ends, as in a timing chart; in place of span_deg, in all "
        "segments",
    )
    law: NamedLaw | None = Field(
        default=None,
        description="law of a rise or return: a name (camgen list), or a table with parameters; default: the law with the least "
        "acceleration",
    )
    task: Annotated[str, text_of_form("two of R, G, U, B, such as RU", "^[RGUB]{2}$")] | None = (
        Field(
            default=None,
            description="motion task: what the two ends join, rest (R), constant velocity (G), reversal (U) or motion (B); default: camgen "
            "finds it",
        )
    )
    inflection: Annotated[float, quantity("1", gt=0, lt=1)] | None = Field(
        default=None, alias="lambda", description="place of the law's inflection in the span"
    )
    constant_velocity: Share | None = Field(
        default=None, description="share of the span at constant velocity"
    )
    end_velocity: Annotated[float, quantity("mm/deg or deg/deg", ge=-1e6, le=1e6)] | None = Field(
        default=None,
        description="velocity at the end of the segment, for G and B; default: the velocity of a uniform neighbour",
    )
    end_acceleration: (
        Annotated[float, quantity("mm/deg^2 or deg/deg^2", ge=-1e6, le=1e6)] | None
    ) = Field(
        default=None,
        description="acceleration at the end of the segment, for U and B; most laws give it at U",
    )
    end_jerk: Annotated[float, quantity("mm/deg^3 or deg/deg^3", ge=-1e6, le=1e6)] | None = Field(
        default=None, description="jerk at the end of the segment, for B, with a polynomial 7"
    )

    @property
    def way(self) -> tuple[float | None, float | None]:
        """How far it goes, and where it ends."""
        return None, None

    @property
    def table(self) -> SegmentTable:
        """As one in a single unit."""
        return self.going(*self.way)

    def going(self, lift: float | None, to: float | None) -> SegmentTable:
        """As one that goes so far, or up to there."""
        shared = {
            field.alias or key: getattr(self, key) for key, field in Span.model_fields.items()
        }
        return SegmentTable(**shared, lift=lift, to=to)


class SegmentTable(Span):
    """One segment of a program as a spec gives it; `lift` is how far it rises or returns, `to` where it ends."""

    lift: Annotated[float, quantity("mm or deg", ge=1e-3, le=1e6)] | None = Field(
        default=None, description="how far the follower moves; or to, the displacement at the end"
    )
    to: Annotated[float, quantity("mm or deg", ge=-1e6, le=1e6)] | None = Field(
        default=None, description="displacement at the end of the segment"
    )

    @property
    def way(self) -> tuple[float | None, float | None]:
        """Lift, and displacement at the end."""
        return self.lift, self.to


S = TypeVar("S", bound=Span)


def whole_turn(rows: tuple[S, ...]) -> tuple[S, ...]:
    """The rows with what follows from the others: spans of a chart's corners and of the one dwell without, kinds, laws that are
    chosen. What is at fault stays as it is."""
    if closes(rows):
        return rows
    rows = _with_kinds(_with_spans(rows))
    free = [k for k, row in enumerate(rows) if row.span_deg is None]
    rest = round(360 - _total(rows), 9)
    if len(free) == 1 and rows[free[0]].kind == "dwell" and rest >= _LEAST_SPAN:
        k = free[0]
        rows = (*rows[:k], _updated(rows[k], span_deg=rest), *rows[k + 1 :])
    return _with_laws(rows)


def _updated(row: S, **values: Any) -> S:
    return row.model_copy(update=values)


def _with_spans(rows: tuple[S, ...]) -> tuple[S, ...]:
    """Spans for the corners of a chart, where all segments have such, growing up to the whole turn."""
    corners = [row.at_deg for row in rows]
    if rows and corners[-1] is None and rows[-1].kind == "dwell" and rows[-1].span_deg is None:
        corners[-1] = 360.0
    known = [corner for corner in corners if corner is not None]
    mixed = len(known) < len(rows) or any(row.span_deg is not None for row in rows)
    if mixed or _chart_faults(known):
        return rows
    spans = [round(b - a, 9) for a, b in zip((0.0, *known), known, strict=False)]
    return tuple(
        _updated(row, at_deg=None, span_deg=span) for row, span in zip(rows, spans, strict=True)
    )


def _chart_faults(corners: Sequence[float]) -> list[tuple[int, str]]:
    """Corners that do not make a turn, and what would be right."""
    wrong = [
        (k, f"more than {before:g}, where the segment begins")
        for k, (before, corner) in enumerate(zip((0.0, *corners), corners, strict=False))
        if corner - before < _LEAST_SPAN
    ]
    if not corners or abs(corners[-1] - 360) > _FULL_TURN_SLACK:
        wrong.append((len(corners) - 1, "360 of the last segment, where the turn ends"))
    return wrong


def _with_kinds(rows: tuple[S, ...]) -> tuple[S, ...]:
    """Kinds, where `to` says them."""
    found = []
    level = 0.0
    for row in rows:
        lift, to = row.way
        if row.kind is None and to is not None and not lift:
            flat = "dwell" if row.task in (None, "RR") else None
            kind = "rise" if to > level else "return" if to < level else flat
            row = _updated(row, kind=kind) if kind else row
        sign = {"rise": 1, "return": -1}.get(row.kind or "", 0)
        level = to if to is not None else level + sign * (lift or 0.0)
        found.append(row)
    return tuple(found)


def _with_laws(rows: tuple[S, ...]) -> tuple[S, ...]:
    """Laws by name, where they are to be chosen and nothing is at fault."""
    open_ = [
        row.kind in ("rise", "return") and (row.law is None or row.law.name in CHOICES)
        for row in rows
    ]
    if not any(open_):
        return rows
    tables = tuple(row.table for row in rows)
    faults = _span_faults(tables, ())
    levels = _levels(tables, (), "", faults)
    chart = _chart(tables, levels, (), faults)
    if faults or chart.resolved[1]:
        return rows
    rows = tuple(
        row
        if found.end_acceleration is None
        else _updated(row, end_acceleration=found.end_acceleration)
        for row, found in zip(rows, chart.resolved[0], strict=True)
    )
    return tuple(
        _updated(row, law=LawChoice(name=found.name), task=found.task)
        if free and found.name
        else row
        for row, free, found in zip(rows, open_, chart.resolved[0], strict=True)
    )


def _total(rows: Sequence[Span]) -> float:
    """Sum of the spans that are given, deg."""
    return math.fsum(row.span_deg or 0.0 for row in rows)


WholeTurn = AfterValidator(whole_turn)  # of the segments of one program


def law_of(choice: str | LawChoice) -> Law:
    """The law between dwells that a spec names; SpecError with paths below the law's where there is none."""
    law = LawChoice(name=choice) if isinstance(choice, str) else choice
    own = _own_law(law)
    if own is not None:
        return own
    try:
        name = least(law.name, REST, REST, law.form) if law.name in CHOICES else law.name
        return law_for(name, REST, REST, law.form)
    except SpecError as error:
        raise SpecError([_of_law(fault, law) for fault in error.faults]) from None


def _of_law(fault: Fault, law: LawChoice) -> Fault:
    """A fault of a law's task, which the law between dwells has not got, as one of its name."""
    at = ("name",) if law.parameters else ()
    return replace(fault, path=at) if fault.path in (("task",), ("law",)) else fault


def _own_law(law: LawChoice) -> Law | None:
    """The law that is the same whatever it joins, or joins dwells; None for one of a family that its ends make.

    SpecError with paths below the law's.
    """
    name = law.name
    parameters = law.parameters
    if name in LAWS and not parameters:
        return LAWS[name]
    if name not in LAWS and name not in FAMILIES:
        raise SpecError([unknown(("name",) if parameters else (), name, NAMES, "law")])
    keys = FAMILIES.get(name, ())
    takes = f"no value here: '{name}' takes {', '.join(keys) or 'no parameters'}"
    faults = [Fault((key,), "", takes) for key in parameters if key not in keys]
    required = _NEEDED.get(name)
    if required and not any(key in parameters for key in required):
        faults.append(Fault((required[0],), "", f"missing: '{name}' needs {' or '.join(required)}"))
    if "points" in parameters and "file" in parameters:
        faults.append(Fault(("file",), parameters["file"], "either points or a file"))
    if faults:
        raise SpecError(faults)
    if name == "polynomial":
        return polynomial_law(parameters["conditions"])
    if name == "table":
        return _table_law(parameters)
    if name == "modified-sine" and parameters.keys() == {"constant_velocity"}:
        return modified_sine(parameters["constant_velocity"])
    if name != "fourier":
        return None
    plain = fourier(parameters.get("sines", ()), parameters.get("cosines", ()))
    return plain if law.inflection is None else shifted(plain, law.inflection)


def _table_law(parameters: dict[str, Any]) -> Law:
    """The law through a table's points."""
    if "tolerance" in parameters:
        right = "no value here: only a table over the whole turn, without kind and lift, has it"
        raise SpecError([Fault(("tolerance",), f"{parameters['tolerance']:g}", right)])
    with _told_of_source(parameters):
        points = _table_points(parameters)
        return table_law(points, _table_source(parameters), parameters.get("rest", True))


@contextmanager
def _told_of_source(parameters: dict[str, Any]) -> Iterator[None]:
    """Faults of a table's rows with the file that they were read from, where one is named: nobody typed such points."""
    try:
        yield
    except SpecError as error:
        source = parameters.get("source")
        faults = [
            replace(each, value=f"{each.value} in {source}")
            if source and each.path[:1] == ("points",)
            else each
            for each in error.faults
        ]
        raise SpecError(faults) from None


def _table_points(parameters: dict[str, Any]) -> Sequence[tuple[float, float]]:
    """Rows of angle and displacement."""
    if "points" in parameters:
        return tuple(parameters["points"])
    return read_points(Reference(("file",), "law", parameters).file(Path()))


def _table_source(parameters: dict[str, Any]) -> str:
    return str(parameters.get("source") or parameters.get("file") or "points of the spec")


def program(
    tables: Sequence[SegmentTable],
    unit: float = 1.0,
    path: Key = ("segment",),
    turn: float = math.inf,
    suffix: str = "",
) -> Program:
    """The program of these tables, the first segment beginning at theta = 0 with s = 0; SpecError with every fault.

    unit: what one of the spec's lifts is in s, such as math.radians(1) for a follower that swings; turn: lift after which all is
    as at the beginning, such as 360 of what turns on and on; suffix: of the keys `lift` and `to` in the spec, such as "_deg".
    """
    tables = whole_turn(tuple(tables))
    if closes(tables):
        return _closed(tables[0], unit, (*path, 0))
    builder = (
        _program
        if all(table.law is None or table.law.file is None for table in tables)
        else _program.__wrapped__
    )
    return builder(tables, unit, path, turn, suffix)


def closes(rows: Sequence[Span]) -> bool:
    """Whether they are one table over the whole turn: a law's that neither rises nor returns."""
    if len(rows) != 1:
        return False
    row = rows[0]
    return (
        row.kind is None
        and row.way == (None, None)
        and row.law is not None
        and row.law.name == "table"
    )


def _closed(table: SegmentTable, unit: float, path: Key) -> Program:
    """The program of a table over the whole turn; SpecError with every fault."""
    law = table.law
    assert law is not None
    others = ("task", "constant_velocity", "end_velocity", "end_acceleration", "end_jerk")
    given = {key: getattr(table, key) for key in others} | {"lambda": table.inflection}
    nothing = "no value here: a table over the whole turn joins itself"
    faults = [Fault((*path, key), str(x), nothing) for key, x in given.items() if x is not None]
    if table.span_deg not in (None, 360) or table.at_deg not in (None, 360):
        where = "span_deg" if table.span_deg else "at_deg"
        value = table.span_deg or table.at_deg or 0.0
        faults.append(
            Fault((*path, where), f"{value:g}", "360: a table without kind and lift closes")
        )
    if law.rest is not None:
        faults.append(Fault((*path, "law", "rest"), "", nothing))
    try:
        with _told_of_source(law.parameters):
            points = _table_points(law.parameters)
            found = closed_program(points, _table_source(law.parameters), unit, law.tolerance)
    except SpecError as error:
        faults += [replace(f, path=(*path, "law", *f.path)) for f in error.faults]
    if faults:
        raise SpecError(faults)
    return found


# variants of a sweep mostly share their program, and with it all that is known of it
@lru_cache(maxsize=256)
def _program(
    tables: tuple[SegmentTable, ...], unit: float, path: Key, turn: float, suffix: str
) -> Program:
    faults: list[Fault] = []
    levels = _levels(tables, path, suffix, faults)
    chart = _chart(tables, levels, path, faults)
    faults += _span_faults(tables, path)
    rounding = 1e-12 * float(np.nanmax(np.abs(levels)))
    whole = (
        turn * round(levels[-1] / turn)
        if math.isfinite(turn) and math.isfinite(levels[-1])
        else 0.0
    )
    if tables and abs(levels[-1] - whole) > rounding:
        last = (*path, len(tables) - 1)
        right = "a last segment that ends at 0, where the first begins"
        right += f", or at a multiple of {turn:g}" if math.isfinite(turn) else ""
        faults.append(Fault(last, f"ends at {levels[-1]:.12g}", right))
    if not faults:
        faults += chart.resolved[1]
    if faults:
        raise SpecError(faults)
    levels[-1] = whole
    resolved = [replace(found, scale=unit * found.scale) for found in chart.resolved[0]]
    program = Program(tuple(_segments(tables, [unit * level for level in levels], resolved)))
    faults = [
        fault
        for k, segment in enumerate(program.segments)
        if (fault := backwards(segment, (*path, k, "law")))
    ]
    if faults:
        raise SpecError(faults)
    return program


def program_faults(tables: Sequence[SegmentTable], path: Key = ("segment",)) -> Sequence[Fault]:
    """What is wrong with these tables together; for a mechanism's `faults`."""
    try:
        program(tables, path=path)
    except SpecError as error:
        return error.faults
    return ()


def _span_faults(tables: Sequence[SegmentTable], path: Key) -> list[Fault]:
    """What is wrong with spans that are left out, or with the sum of all."""
    corners = [k for k, table in enumerate(tables) if table.at_deg is not None]
    if corners:
        return _corner_faults(tables, corners, path)
    free = [k for k, table in enumerate(tables) if table.span_deg is None]
    total = _total(tables)
    if not free and not abs(total - 360) <= _FULL_TURN_SLACK:
        much = f"{abs(total - 360):g} deg too {'much' if total > 360 else 'little'}"
        right = f"span_deg of all segments to add up to 360 ({much})"
        if abs(total - math.tau) < _RADIANS:
            right = (
                "degrees that add up to 360: these add up to a turn in rad, and 1 rad is 57.296 deg"
            )
        return [Fault(path, f"the spans add up to {total:.12g} deg", right)]
    moving = [k for k in free if tables[k].kind != "dwell"]
    alone = "missing: only one dwell may leave it out, which then takes the rest of the turn"
    if moving or len(free) > 1:
        return [Fault((*path, k, "span_deg"), "", alone) for k in moving or free[1:]]
    taken = f"nothing is left of the turn: the other spans add up to {total:.12g} deg"
    return [Fault((*path, k, "span_deg"), "", taken) for k in free]


def _corner_faults(
    tables: Sequence[SegmentTable], corners: Sequence[int], path: Key
) -> list[Fault]:
    """What is wrong with a chart's corners."""
    spans = [k for k, table in enumerate(tables) if table.span_deg is not None]
    either = "either at_deg in all segments of a cam, or span_deg in all"
    if spans:
        return [Fault((*path, k, "span_deg"), f"{tables[k].span_deg:g}", either) for k in spans]
    missing = [k for k in range(len(tables)) if k not in corners]
    if missing:
        right = "missing: every segment of a timing chart says where it ends"
        return [Fault((*path, k, "at_deg"), "", right) for k in missing]
    angles = [tables[k].at_deg or 0.0 for k in corners]
    return [
        Fault((*path, k, "at_deg"), f"{angles[k]:g}", right) for k, right in _chart_faults(angles)
    ]


def _levels(
    tables: Sequence[SegmentTable], path: Key, suffix: str, faults: list[Fault]
) -> list[float]:
    """Displacement at each joint, from 0; nan where a fault leaves it open. Adds the faults of lift and to."""
    levels = [0.0]
    lift = f"lift{suffix}"
    goal = f"to{suffix}"
    for k, table in enumerate(tables):
        level = levels[-1]
        at = (*path, k)
        to = table.to
        if table.kind is None:
            levels.append(_level_of_any(table, level, at, faults))
            continue
        sign = {"rise": 1, "dwell": 0, "return": -1}[table.kind]
        end = math.nan if to is None else to
        if sign == 0:
            faults += [
                Fault((*at, key), "", "no value here: a dwell stays where it is")
                for key, value in ((lift, table.lift), ("law", table.law))
                if value is not None
            ]
            if to is not None and abs(to - level) > 0:
                faults.append(
                    Fault(
                        (*at, goal),
                        f"{to:g}",
                        f"{level:g}, where the segment before ends, or leave it out",
                    )
                )
            end = level
        elif (table.lift is None) == (to is None):
            given = "" if table.lift is None else f"{table.lift:g}"
            back = f"; {goal} = 0 goes back to where the turn begins" if sign < 0 else ""
            missing = "" if given else "missing: "
            faults.append(Fault((*at, lift), given, f"{missing}either {lift} or {goal}{back}"))
        elif table.lift is not None:
            end = level + sign * table.lift
        elif sign * (end - level) <= 0:
            faults.append(
                Fault(
                    (*at, goal),
                    f"{to:g}",
                    f"{'more' if sign > 0 else 'less'} than {level:g}, where it begins",
                )
            )
            end = math.nan
        levels.append(end)
    return levels


def _chart(
    tables: Sequence[SegmentTable], levels: Sequence[float], path: Key, faults: list[Fault]
) -> Chart:
    """The segments as a timing chart; adds the faults of their laws by themselves."""
    moves = [_move(table, levels[k : k + 2], (*path, k), faults) for k, table in enumerate(tables)]
    return Chart(tuple(moves), path)


def _level_of_any(table: SegmentTable, level: float, path: Key, faults: list[Fault]) -> float:
    """Displacement at the end of a segment that neither rises nor returns nor stands, or that does not say so."""
    if table.to == level and not table.lift:
        return level
    right = 'missing: "rise", "dwell" or "return", or where it ends'
    if table.lift is not None:
        right += f'; "rise" goes up by {table.lift:g}, "return" down'
    faults.append(Fault((*path, "kind"), "", right))
    return math.nan


def _move(table: SegmentTable, ends: Sequence[float], path: Key, faults: list[Fault]) -> Move:
    """One segment."""
    rates = Rates(table.end_velocity, table.end_acceleration, table.end_jerk)
    span = table.span_deg or math.nan
    begin, end = ends
    if table.kind == "dwell":
        faults += [
            Fault((*path, key), "", "no value here: a dwell stays where it is")
            for key, value in (
                ("lambda", table.inflection),
                ("constant_velocity", table.constant_velocity),
            )
            if value is not None
        ]
        return Move(span, begin, end, None, task=table.task, rates=rates)
    law = _stated(table, path, faults)
    try:
        own = None if law.name == MATCHED else _own_law(law)
    except SpecError as error:
        faults += [replace(f, path=_law_place(table, f.path, path)) for f in error.faults]
        return Move(span, begin, end, None, rates=rates)
    wrong = turning_rows(law)
    faults += [replace(fault, path=(*path, "law", *fault.path)) for fault in wrong]
    return Move(span, begin, end, law.name, own, law.form, table.task, rates)


def _stated(table: SegmentTable, path: Key, faults: list[Fault]) -> LawChoice:
    """A segment's law with the parameters that stand beside it."""
    law = table.law or LawChoice(name=CHOICES[0])
    beside = {"inflection": table.inflection, "constant_velocity": table.constant_velocity}
    for key, value in beside.items():
        known = getattr(law, key)
        if value is None:
            continue
        if known is not None:
            word = "lambda" if key == "inflection" else key
            right = f"either here or in law, which has {known:g}"
            faults.append(Fault((*path, word), f"{value:g}", right))
        law = law.model_copy(update={key: value})
    if law.name == MATCHED:
        faults += [
            Fault(
                _law_place(table, (key,), path),
                "",
                f"no value here: '{MATCHED}' takes no parameters",
            )
            for key in law.parameters
        ]
    return law


def _law_place(table: SegmentTable, key: Key, path: Key) -> Key:
    """Where a parameter of the law stands: in its table, or beside it."""
    beside = {"lambda": table.inflection, "constant_velocity": table.constant_velocity}
    if len(key) == 1 and beside.get(str(key[0])) is not None:
        return (*path, *key)
    return (*path, "law", *key)


def turning_rows(choice: LawChoice) -> list[Fault]:
    """The rows of a law's table at which it turns back; paths below the law's."""
    if choice.points is None:
        return []
    s = np.array([row[1] for row in choice.points])
    wrong = np.flatnonzero(np.diff(s) * (s[-1:] - s[:1]) < 0) + 1
    way = "rises" if len(s) and s[-1] > s[0] else "falls"
    return [
        Fault(
            ("points", int(k)), f"{s[k]:g}", f"a table that {way} all the way, after {s[k - 1]:g}"
        )
        for k in wrong
    ]


def _segments(
    tables: Sequence[SegmentTable], levels: Sequence[float], resolved: Sequence[Resolved]
) -> list[Segment]:
    """The segments; those without a law are matched to their neighbours."""
    spans = [math.radians(table.span_deg or 0.0) for table in tables]
    segments = [
        None
        if found.law is None
        else Segment(table.kind or "reversal", span, begin, found.scale, found.law)
        for table, found, span, begin in zip(tables, resolved, spans, levels, strict=False)
    ]
    n = len(segments)
    if not any(segments):
        return matched(spans, levels)
    first = next(k for k, segment in enumerate(segments) if segment is not None)
    order = [
        (first + k) % n for k in range(n)
    ]  # begins with a segment that has a law, so no run crosses the end
    for free, group in groupby(order, key=lambda k: segments[k] is None):
        if not free:
            continue
        ks = list(group)
        before = segments[ks[0] - 1]
        after = segments[(ks[-1] + 1) % n]
        assert before is not None and after is not None
        start = float(before.at(before.span, 1)), float(before.at(before.span, 2))
        end = float(after.at(0.0, 1)), float(after.at(0.0, 2))
        quintics = matched(
            [spans[k] for k in ks], [*(levels[k] for k in ks), levels[ks[-1] + 1]], start, end
        )
        for k, segment in zip(ks, quintics, strict=True):
            segments[k] = segment
    return [segment for segment in segments if segment is not None]


@lru_cache(maxsize=256)
def _against(law: Law, forwards: bool) -> Floats:
    """Places at which a law runs against the sense that it should have, (n,)."""
    u = distinct(np.linspace(0, 1, 2001), law.breaks)
    return np.asarray(u[law(u, 1) * (1 if forwards else -1) < -LAW_CLOSES * max(1.0, law.c_v)])


def backwards(segment: Segment, path: Key) -> Fault | None:
    """A fault at `path` where a rise falls or a return rises on its way; None where the law only goes one way."""
    if segment.kind in ("dwell", "reversal"):
        return None
    wrong = _against(segment.law, (segment.scale > 0) == (segment.kind == "rise"))
    if not len(wrong):
        return None
    where = f"{wrong[0]:.3g} to {wrong[-1]:.3g} of its span"
    return Fault(
        path,
        f"'{segment.law.name}' runs backwards within {where}",
        f"a law that only goes one way in a {segment.kind}",
    )
