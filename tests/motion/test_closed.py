"""Tables over the whole turn: periodic splines, harmonics within a tolerance, digits that spoil the acceleration, and faults."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen.errors import SpecError
from camgen.motion.closed import closed_program
from camgen.motion.segments import SegmentTable, program

REFERENCE = tomllib.loads(
    (Path(__file__).resolve().parents[1] / "reference" / "motion_tasks.toml").read_text()
)["closed"]
PLACES = np.linspace(0, math.tau, 20_001)


def curve(t: Any, order: int = 0) -> Any:
    """s and its second derivative."""
    sign, factor = (1.0, 0.3) if order == 0 else (-1.0, 2.7)
    return sign * (np.sin(t) + factor * np.sin(3 * t + 0.5))


def rows(count: int, digits: int | None = None) -> list[tuple[float, float]]:
    degrees = np.arange(count) * 360 / count
    values = curve(np.radians(degrees))
    values = values if digits is None else np.round(values, digits)
    return list(zip(degrees.tolist(), values.tolist(), strict=True))


@pytest.mark.parametrize("count, of_s, of_a", REFERENCE["rows"])
def test_periodic_quintic(count: int, of_s: str, of_a: str) -> None:
    made = closed_program(rows(count), "test")
    error = [float(np.max(np.abs(made(PLACES, k) - curve(PLACES, k)))) for k in (0, 2)]
    assert error == [pytest.approx(float(of_s), rel=0.02), pytest.approx(float(of_a), rel=0.01)]
    assert made.discontinuities(3) == []
    closing = [*rows(count), (360.0, rows(count)[0][1])]
    np.testing.assert_array_equal(closed_program(closing, "test")(PLACES), made(PLACES))


def test_digits_spoil_the_acceleration_and_harmonics_leave_them_out() -> None:
    spoilt = closed_program(rows(360, 4), "test")
    off = float(np.max(np.abs(spoilt(PLACES, 2) - curve(PLACES, 2))))
    law = spoilt.segments[0].law
    assert law.rounding > REFERENCE["rounded"] and off > 0.25 * 3.5
    assert closed_program(rows(360), "test").segments[0].law.rounding < 1e-9
    fitted = closed_program(rows(360, 4), "test", tolerance=1e-4)
    assert fitted.segments[0].law.rounding == 0 and "3 harmonics" in fitted.segments[0].law.name
    np.testing.assert_allclose(fitted(PLACES, 2), curve(PLACES, 2), atol=1e-4)
    uneven = [row for k, row in enumerate(rows(72, 4)) if k % 5]
    by_squares = closed_program(uneven, "test", tolerance=1e-4)
    np.testing.assert_allclose(by_squares(PLACES), curve(PLACES), atol=2e-4)


def segment(**keys: Any) -> SegmentTable:
    law = {
        "name": "table",
        "points": keys.pop("points", rows(36)),
        "tolerance": keys.pop("tolerance", None),
    }
    law["points"] = tuple(tuple(row) for row in law["points"])
    return SegmentTable.model_validate({"law": law, **keys})


def test_as_a_segment() -> None:
    made = program((segment(),), 2.0)
    np.testing.assert_allclose(made(PLACES), 2 * curve(PLACES), atol=2e-6)
    back = made.backwards()
    np.testing.assert_allclose(back(PLACES), made(-PLACES), atol=1e-12)


@pytest.mark.parametrize("gap, tolerance", [(3e-15, None), (-3e-15, None), (0.004, 0.005)])
def test_ends_that_arithmetic_or_a_tolerance_leaves_apart_close(
    gap: float, tolerance: float | None
) -> None:
    """A table worked out in floating point need not end on the very number that it begins with."""
    first = rows(36)[0][1]
    points = [*rows(36), (360.0, first + gap)]
    made = program((segment(points=points, tolerance=tolerance),))
    np.testing.assert_allclose(made(PLACES), curve(PLACES), atol=2e-6 + (tolerance or 0.0))
    with pytest.raises(SpecError, match="where the table begins"):
        program((segment(points=[*rows(36), (360.0, first + 0.006)], tolerance=tolerance),))


@pytest.mark.parametrize(
    "keys, path, says",
    [
        ({"points": rows(36)[:6]}, "segment.0.law.points", "6 rows"),
        (
            {"points": [*rows(36), (360.0, 3.0)]},
            "segment.0.law.points.36",
            "where the table begins",
        ),
        ({"points": [*rows(36), (370.0, 3.0)]}, "segment.0.law.points.36", "at most 360 deg"),
        ({"points": rows(36)[:-4]}, "segment.0.law.points.31", "rows at most 30 deg apart"),
        ({"points": [*rows(36)[:5], *rows(36)[4:]]}, "segment.0.law.points.5", "greater than 40"),
        ({"span_deg": 180.0}, "segment.0.span_deg", "360"),
        ({"task": "RR"}, "segment.0.task", "joins itself"),
        (
            {"points": [*rows(72)[:-1], (355.0, 1.0)], "tolerance": 1e-6},
            "segment.0.law.tolerance",
            "tolerance of at least",
        ),
    ],
)
def test_faults(keys: dict[str, Any], path: str, says: str) -> None:
    with pytest.raises(SpecError) as error:
        program((segment(**keys),))
    assert [fault.key for fault in error.value.faults] == [path]
    assert says in str(error.value)
