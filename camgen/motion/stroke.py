"""A program over a way that is gone through once: it begins and ends where it will, and does not close."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from camgen.errors import Fault, Key, SpecError
from camgen.motion.program import Program
from camgen.motion.segments import Kind, NamedLaw, SegmentTable, program
from camgen.numerics import Floats
from camgen.spec import Record, quantity

# shares of a turn for the segments that lead back, from rest to rest: the program of a turn is asked for
_CLOSING = (0.05, 0.15, 0.05)
_LEAST = 4e-6  # share of the way that a segment takes: of the turn 0.001 deg


class StrokeSegment(Record):
    """A stretch of a way: how long it is, what the follower does on it, and by which law."""

    kind: Kind | None = Field(
        default=None,
        description='"rise", "dwell" or "return"; you may leave it out if `to` shows which',
    )
    span: Annotated[float, quantity("mm", ge=1e-3, le=1e5)] = Field(
        description="how much of the way it takes"
    )
    lift: Annotated[float, quantity("mm or deg", ge=1e-3, le=1e6)] | None = Field(
        default=None, description="how far the follower moves; or to, the displacement at the end"
    )
    to: Annotated[float, quantity("mm or deg", ge=-1e6, le=1e6)] | None = Field(
        default=None, description="displacement at the end of the segment"
    )
    law: NamedLaw | None = Field(
        default=None,
        description="law of a rise or return: a name (camgen list), or a table with parameters; default: the law with the least "
        "acceleration",
    )


class Stroke(Program):
    """Segments one after the other over a way that is not closed; beyond both ends the displacement stays."""

    def __call__(self, theta: Any, order: int = 0) -> Floats:
        """Displacement (order 0) or its derivative, (n,), within the way; at a joint the later segment counts."""
        low = float(self.joints[0])
        high = float(self.joints[-1])
        place = np.clip(np.asarray(theta, float), low, high)
        starts = self.joints
        which = np.clip(np.searchsorted(starts, place, side="right") - 1, 0, len(self.segments) - 1)
        result = np.empty(place.shape)
        for k in np.unique(which):
            mine = which == k
            result[mine] = self.segments[k].at(place[mine] - starts[k], order)
        return result

    def backwards(self) -> Stroke:
        """The way from its end to its beginning: s(-theta)."""
        return Stroke(super().backwards().segments, -float(self.joints[-1]))

    def jumps(self, order: int) -> list[float]:
        """Step of the derivative of this order at each joint, (n,): none where the way begins."""
        return [0.0, *super().jumps(order)[1:]]


def stroke(
    rows: Sequence[StrokeSegment], unit: float, scale: float, path: Key = (), suffix: str = ""
) -> Stroke:
    """The program of these rows, from displacement 0; unit: what one of the spec's lifts is in s; scale: of a mm of the way;
    path: of the table with the segments; suffix: of their keys `lift` and `to`, such as "_deg".

    SpecError with every fault. Laws that are chosen join a follower that rests at both ends of the way.
    """
    length = math.fsum(row.span for row in rows)
    short = [
        Fault(
            (*path, "segment", k, "span"),
            f"{row.span:g}",
            f"at least {_LEAST * length:.3g} mm: {_LEAST:g} of the way",
        )
        for k, row in enumerate(rows)
        if row.span < _LEAST * length
    ]
    if short:
        raise SpecError(short)
    share = 360 * (1 - sum(_CLOSING)) / length
    tables = [
        SegmentTable(
            kind=row.kind, span_deg=share * row.span, lift=row.lift, to=row.to, law=row.law
        )
        for row in rows
    ]
    level = 0.0
    for row in rows:
        sign = {"rise": 1, "return": -1}.get(row.kind or "", 0)
        level = row.to if row.to is not None else level + sign * (row.lift or 0.0)
    rest = {"kind": "dwell"}
    back = {"law": "cycloidal", "to": 0.0} if level else rest
    tables += [
        SegmentTable.model_validate({"span_deg": 360 * part, **keys})
        for part, keys in zip(_CLOSING, (rest, back, rest), strict=True)
    ]
    try:
        closed = program(tables, unit, suffix=suffix)
    except SpecError as error:
        raise SpecError([_of_row(fault, path, len(rows)) for fault in error.faults]) from None
    return Stroke(
        tuple(
            replace(segment, span=scale * row.span)
            for segment, row in zip(closed.segments, rows, strict=False)
        )
    )


def _of_row(fault: Fault, above: Key, count: int) -> Fault:
    """A fault by the keys of a row."""
    path = fault.path
    if len(path) > 1 and path[1] in range(count, count + len(_CLOSING)):  # nobody's
        path = ("segment",)
    named = ("span" if key == "span_deg" else key for key in path)
    return replace(fault, path=(*above, *named))
