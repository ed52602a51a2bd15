"""The `[[segment]]` tables of a spec: from kind, span, lift and law to a program, or to the list of what is wrong.

[[segment]]
kind = "rise"                                          # "rise", "dwell" or "return"
span_deg = 90                                          # may be left out of one dwell: the rest of the turn
lift = 10                                              # or to = 10: the displacement at the end
law = "modified-sine"                                  # a name of LAWS, or "matched" (joins its neighbours in v and a)
law = { name = "modified-sine", constant_velocity = 0.2 }
law = { name = "fourier", sines = [6.283185307179586] }
law = { name = "polynomial", conditions = [[0, 0, 0], [0, 1, 0], [1, 0, 1], [1, 1, 0]] }    # u, order, value
law = { name = "table", file = "rise.csv" }            # angle and displacement in any unit, from the first row to the last
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import groupby
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field

from camgen.errors import Fault, Key, SpecError
from camgen.motion.laws import LAWS, UNIFORM, Law, fourier, modified_sine, polynomial_law, table_law
from camgen.motion.program import Program, Segment, matched
from camgen.motion.tables import read_points
from camgen.numerics import Floats, distinct
from camgen.reading import Reference
from camgen.spec import Record, quantity, unknown
from camgen.tolerances import LAW_CLOSES

MATCHED = "matched"
# Laws with parameters: their keys, and what they are.
FAMILIES = {
    "modified-sine": ("constant_velocity",),
    "fourier": ("sines", "cosines"),
    "polynomial": ("conditions",),
    "table": ("points", "file", "source", "rest"),
}
ABOUT = {
    "modified-sine": "a share 0 to 1 of the span at constant velocity in its middle",
    "fourier": "acceleration: sines of 2 pi u, 4 pi u, ..., cosines of pi u, 3 pi u, ...",
    "polynomial": "conditions [u, order, value], as many as coefficients; from 0 at u = 0 to 1 at u = 1",
    "table": "C2 spline through points [angle, displacement], or through a file's; rest = false: not from rest to rest",
    MATCHED: "quintic that takes velocity and acceleration from its neighbours ([[segment]] alone)",
}
NAMES = tuple(dict.fromkeys((*LAWS, *ABOUT)))
_NEEDED = {
    "fourier": ("sines", "cosines"),
    "polynomial": ("conditions",),
    "table": ("points", "file"),
}  # one of them
_FULL_TURN_SLACK = 1e-9  # deg, of rounding in a sum of spans
_LEAST_SPAN = 1e-3  # deg

Terms = Annotated[tuple[Annotated[float, quantity("1")], ...], Field(max_length=50)]
Condition = tuple[
    Annotated[float, Field(ge=0, le=1)], Annotated[int, Field(ge=0, le=20)], float
]  # u, order, value


class LawChoice(Record):
    """A law with its parameters."""

    name: str = Field(description="name of the law, see camgen list")
    constant_velocity: Annotated[float, quantity("1")] | None = Field(
        default=None, description="share of the span at constant velocity"
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
    source: str | None = Field(default=None, description="table: where it is from")
    rest: bool | None = Field(default=None, description="table: whether it starts and ends at rest")

    @property
    def parameters(self) -> dict[str, Any]:
        """The parameters that are given, by their keys."""
        return {key: value for key, value in self if key != "name" and value is not None}


# A law's bare name stands for the table with that name alone.
NamedLaw = Annotated[
    LawChoice,
    BeforeValidator(
        lambda law: {"name": law} if isinstance(law, str) else law,
        json_schema_input_type=str | LawChoice,
    ),
]


class Span(Record):
    """A stretch of the turn, by what the program does in it."""

    kind: Literal["rise", "dwell", "return"] = Field(description='"rise", "dwell" or "return"')
    span_deg: Annotated[float, quantity("deg", ge=_LEAST_SPAN, le=360)] | None = Field(
        default=None,
        description="how much of the turn, or of a drive's period, it takes; one dwell may leave it "
        "out: the rest",
    )


S = TypeVar("S", bound=Span)


def whole_turn(rows: tuple[S, ...]) -> tuple[S, ...]:
    """The rows, the one dwell without a span with what the others leave of the turn; as they are where there is none such."""
    free = [k for k, row in enumerate(rows) if row.span_deg is None]
    rest = round(360 - _total(rows), 9)
    if len(free) != 1 or rows[free[0]].kind != "dwell" or rest < _LEAST_SPAN:
        return rows
    k = free[0]
    return (*rows[:k], rows[k].model_copy(update={"span_deg": rest}), *rows[k + 1 :])


def _total(rows: Sequence[Span]) -> float:
    """Sum of the spans that are given, deg."""
    return math.fsum(row.span_deg or 0.0 for row in rows)


WholeTurn = AfterValidator(whole_turn)  # of the segments of one program


class SegmentTable(Span):
    """One segment of a program as a spec gives it; `lift` is how far it rises or returns, `to` where it ends."""

    lift: Annotated[float, quantity("mm or deg", ge=1e-3, le=1e6)] | None = Field(
        default=None, description="how far the follower moves; or to, the displacement at the end"
    )
    to: Annotated[float, quantity("mm or deg", ge=-1e6, le=1e6)] | None = Field(
        default=None, description="displacement at the end of the segment"
    )
    law: NamedLaw | None = Field(
        default=None,
        description="law of a rise or return: a name (camgen list), or a table with parameters",
    )


def law_of(choice: str | LawChoice) -> Law:
    """The law that a spec names; SpecError with paths below the law's where there is none."""
    law = LawChoice(name=choice) if isinstance(choice, str) else choice
    if law.name in LAWS and law.model_fields_set == {"name"}:
        return LAWS[law.name]
    name = law.name
    parameters = law.parameters
    if name not in LAWS and name not in FAMILIES:
        raise SpecError([unknown(("name",) if parameters else (), name, NAMES)])
    keys = FAMILIES.get(name, ())
    takes = f"nothing here: '{name}' takes {', '.join(keys) or 'no parameters'}"
    faults = [Fault((key,), "", takes) for key in parameters if key not in keys]
    required = _NEEDED.get(name)
    if required and not any(key in parameters for key in required):
        faults.append(Fault((required[0],), "", f"missing: '{name}' needs {' or '.join(required)}"))
    if "points" in parameters and "file" in parameters:
        faults.append(Fault(("file",), parameters["file"], "either points or a file"))
    if faults:
        raise SpecError(faults)
    if name == "table":
        points = (
            parameters["points"]
            if "points" in parameters
            else read_points(Reference(("file",), "law", parameters).file(Path()))
        )
        return table_law(
            points,
            parameters.get("source") or parameters.get("file") or "points of the spec",
            parameters.get("rest", True),
        )
    if name == "fourier":
        return fourier(parameters.get("sines", ()), parameters.get("cosines", ()))
    if name == "polynomial":
        return polynomial_law(parameters["conditions"])
    return modified_sine(**parameters) if parameters else LAWS[name]


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
    builder = (
        _program
        if all(table.law is None or table.law.file is None for table in tables)
        else _program.__wrapped__
    )
    return builder(tuple(tables), unit, path, turn, suffix)


# variants of a sweep mostly share their program, and with it all that is known of it
@lru_cache(maxsize=256)
def _program(
    tables: tuple[SegmentTable, ...], unit: float, path: Key, turn: float, suffix: str
) -> Program:
    faults: list[Fault] = []
    levels = _levels(tables, path, suffix, faults)
    laws = [_law(table, (*path, k, "law"), faults) for k, table in enumerate(tables)]
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
    if faults:
        raise SpecError(faults)
    levels[-1] = whole
    program = Program(tuple(_segments(tables, [unit * level for level in levels], laws)))
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
    free = [k for k, table in enumerate(tables) if table.span_deg is None]
    total = _total(tables)
    if not free and not abs(total - 360) <= _FULL_TURN_SLACK:
        much = f"{abs(total - 360):g} deg too {'much' if total > 360 else 'little'}"
        right = f"span_deg of all segments that make 360 ({much})"
        return [Fault(path, f"the spans make {total:.12g} deg", right)]
    moving = [k for k in free if tables[k].kind != "dwell"]
    alone = "missing: only one dwell may leave it out; it takes the rest of the turn"
    if moving or len(free) > 1:
        return [Fault((*path, k, "span_deg"), "", alone) for k in moving or free[1:]]
    taken = f"nothing is left of the turn: the other spans make {total:.12g} deg"
    return [Fault((*path, k, "span_deg"), "", taken) for k in free]


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
        sign = {"rise": 1, "dwell": 0, "return": -1}[table.kind]
        end = math.nan if to is None else to
        if sign == 0:
            faults += [
                Fault((*at, key), "", "nothing here: a dwell stays where it is")
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
            faults.append(
                Fault(
                    (*at, lift),
                    "" if table.lift is None else f"{table.lift:g}",
                    f"either {lift} or {goal}",
                )
            )
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


def _law(table: SegmentTable, path: Key, faults: list[Fault]) -> Law | None:
    """The segment's law; None for a matched one, and where there is a fault. A dwell's is any, of lift 0."""
    if table.kind == "dwell":
        return UNIFORM
    if table.law is None:
        faults.append(Fault(path, "", f"missing: one of {', '.join(NAMES)}"))
        return None
    if table.law.name == MATCHED:
        faults += [
            Fault((*path, key), "", f"nothing here: '{MATCHED}' takes no parameters")
            for key in table.law.parameters
        ]
        return None
    try:
        law = law_of(table.law)
    except SpecError as error:
        faults += [replace(fault, path=(*path, *fault.path)) for fault in error.faults]
        return None
    wrong = turning_rows(table.law)
    faults += [replace(fault, path=(*path, *fault.path)) for fault in wrong]
    return None if wrong else law


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
    tables: Sequence[SegmentTable], levels: Sequence[float], laws: Sequence[Law | None]
) -> list[Segment]:
    """The segments; those without a law are matched to their neighbours."""
    spans = [math.radians(table.span_deg or 0.0) for table in tables]
    segments = [
        None if law is None else Segment(table.kind, span, begin, end - begin, law)
        for table, law, span, begin, end in zip(
            tables, laws, spans, levels, levels[1:], strict=False
        )
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
    if segment.kind == "dwell":
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
