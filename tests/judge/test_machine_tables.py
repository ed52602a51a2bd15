"""The judge of a cam's profile: eccentric discs, whose every column is a closed form, and what is off by more or less than a
limit."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from shapes import polygon

from camgen.findings import Finding
from camgen.geometry.rings import Ring
from camgen.judge.contact import contact
from camgen.judge.contact_faces import ArmFace, SlideFace
from camgen.judge.contact_tips import ArmTip, SlideTip
from camgen.judge.joints import RollingLaw
from camgen.judge.machine_tables import Profile, judge_profile

# mm: of the disc, of its centre from the shaft, of the roller
RADIUS = 20.0
OFF = 6.0
RHO = 5.0
STEP = 5.0
TOLERANCE = 1e-3
THETA = np.radians(np.arange(0, 360, STEP))
CENTRE = OFF * np.exp(1j * THETA)  # of the disc, in the ground
TABLE = Path("x-profile.csv")
FOLLOWER = "theta_deg, x_mm, y_mm and normal_deg"
FORMS = {
    "roller": SlideTip(0j, 1j, RHO, 1),
    "aside": SlideTip(3 + 0j, 1j, RHO, 1),
    "arm": ArmTip(50 + 0j, complex(-45 * np.exp(-0.4j)), RHO, -1),
    "face": SlideFace(0j, 1j, 1),
    "face on an arm": ArmFace(60 + 0j, complex(np.exp(-2.2j)), 4.0, 1),
}


def disc(count: int = 12) -> Ring:
    """Of arcs."""
    points = OFF + RADIUS * np.exp(2j * np.pi * (np.arange(count) + 0.31) / count)
    return Ring(points, np.full(count, math.tan(math.pi / 2 / count)))


def mixed() -> Ring:
    """Five arcs, and facets over the rest of the circle."""
    arcs = disc()
    first, last = np.angle(arcs.points[[0, 5]] - OFF)
    facets = OFF + RADIUS * np.exp(1j * np.linspace(last, first + math.tau, 230))[:-1]
    return Ring(np.append(arcs.points[:5], facets), np.append(arcs.bulges[:5], np.zeros(229)))


def profile(form: object) -> Profile:
    """By triangles: the disc's centre, the follower's point and its pivot or line."""
    match form:
        case SlideTip():
            across = form.start.real - CENTRE.real
            tip = form.start.real + 1j * (CENTRE.imag + np.sqrt((RADIUS + RHO) ** 2 - across**2))
            normal, way = (tip - CENTRE) / (RADIUS + RHO), np.full(len(THETA), 1j)
        case ArmTip():
            spoke = CENTRE - form.pivot
            length, arm = np.abs(spoke), abs(form.arm)
            turn = np.arccos((length**2 + arm**2 - (RADIUS + RHO) ** 2) / (2 * length * arm))
            tip = form.pivot + arm * spoke / length * np.exp(1j * form.leaves * turn)
            normal = (tip - CENTRE) / (RADIUS + RHO)
            way = form.leaves * 1j * (tip - form.pivot) / arm
        case SlideFace():
            normal = way = np.full(len(THETA), 1j)
        case ArmFace():  # the face is tangent: its line is `ahead` from the pivot, and a radius from the centre
            spoke = CENTRE - form.pivot
            normal = (
                spoke
                / np.abs(spoke)
                * np.exp(1j * form.leaves * np.arccos((form.ahead - RADIUS) / np.abs(spoke)))
            )
            foot = CENTRE + RADIUS * normal - form.pivot
            way = form.leaves * 1j * foot / np.abs(foot)
    back = np.exp(-1j * THETA)
    place, own = (CENTRE + RADIUS * normal) * back, normal * back
    pressure = np.abs(np.angle(normal * np.conj(way)))
    return Profile(
        THETA, place, np.abs(place), np.angle(place), own, np.full(len(THETA), 1 / RADIUS), pressure
    )


def judged(
    form: object, table: Profile, ring: Ring | None = None, tolerance: float = TOLERANCE
) -> list[Finding]:
    ring = disc() if ring is None else ring
    law = RollingLaw(contact(ring, form), None)  # type: ignore[arg-type]
    return judge_profile(TABLE, table, ring, law, STEP, tolerance)


def told(found: list[Finding]) -> set[str]:
    """The columns that fail."""
    return {column(f) for f in found if not f.ok}


def column(finding: Finding) -> str:
    return str(finding.where).removeprefix("x-profile.csv, ").partition(", row")[0]


@pytest.mark.parametrize("name", FORMS)
@pytest.mark.parametrize("outline", ["arcs", "polygon"])
def test_every_column_of_a_disc_follows_from_triangles(name: str, outline: str) -> None:
    """A polygon within the tolerance, too."""
    count = 400  # whose facets are 6e-4 mm from the circle
    ring = disc() if outline == "arcs" else polygon(disc(count).points)
    found = judged(FORMS[name], profile(FORMS[name]), ring)
    assert told(found) == set()
    assert len(found) == (8 if "face" in name else 7)
    assert all(
        f.measured < (1e-7 if outline == "arcs" else 0.5) for f in found
    )  # facets lean by 0.45 deg


def moved(table: Profile, by: np.ndarray) -> Profile:
    """Places further out by so much, mm, in all of their columns."""
    place = table.place + by * table.normal
    return replace(table, place=place, radius=np.abs(place), angle=np.angle(place))


@pytest.mark.parametrize("name", FORMS)
@pytest.mark.parametrize("late", [None, 0, 41])
@pytest.mark.parametrize("sign", [-1, 1])
def test_a_place_off_the_outline_is_told_by_how_much(
    name: str, late: int | None, sign: int
) -> None:
    """By more than both tolerances, the file's and the table's; a row by itself, too."""
    table = profile(FORMS[name])
    rows = np.ones(72) if late is None else (np.arange(72) == late).astype(float)
    for by, ok in ((1.8e-3, True), (2.2e-3, False)):
        (found,) = [
            f
            for f in judged(FORMS[name], moved(table, sign * by * rows))
            if column(f) == "x_mm and y_mm"
        ]
        assert (
            found.ok is ok
            and found.measured == pytest.approx(by, rel=1e-6)
            and found.limit == pytest.approx(2e-3)
        )
        if late is not None:
            assert str(found.where).endswith(f"row of {5 * late} deg")
    for by, ok in ((1e-9, True), (1e-7, False)):
        longer = replace(table, radius=table.radius + sign * by * rows)
        assert told(judged(FORMS[name], longer)) == (set() if ok else {"radius_mm and angle_deg"})
    turned = replace(table, angle=table.angle + sign * 1e-7 * rows)
    assert told(judged(FORMS[name], turned)) == {"radius_mm and angle_deg"}


@pytest.mark.parametrize("name", FORMS)
@pytest.mark.parametrize("sign", [-1, 1])
def test_angles_that_are_off_are_told(name: str, sign: int) -> None:
    table, form = profile(FORMS[name]), FORMS[name]
    assert told(judged(form, replace(table, theta=THETA + sign * 1e-10))) == {"theta_deg"}
    assert told(judged(form, replace(table, theta=THETA + sign * 1e-11))) == set()
    steeper = judged(form, replace(table, pressure_angle=table.pressure_angle + sign * 2e-7))
    assert told(steeper) == {"pressure_angle_deg"}
    assert (
        told(judged(form, replace(table, pressure_angle=table.pressure_angle + sign * 1e-9)))
        == set()
    )
    found = judged(form, replace(table, normal=table.normal * np.exp(1j * sign * 0.01)))
    assert {"normal_deg", "pressure_angle_deg"} <= told(found)
    (lean,) = [f for f in found if column(f) == "normal_deg"]
    assert lean.measured == pytest.approx(math.degrees(0.01), rel=1e-6)
    if "face" in name:
        assert "theta_deg and normal_deg" in told(found)


def test_where_facets_may_lean_arcs_may_not() -> None:
    form, ring = FORMS["roller"], mixed()
    table = profile(form)
    assert told(judged(form, table, ring)) == set()
    k = int(np.argmin(np.abs(np.angle(table.normal) - math.pi / 3)))  # on an arc
    late = replace(table, normal=table.normal * np.exp(0.01j * (np.arange(72) == k)))
    assert "normal_deg" in told(judged(form, late, ring))


def test_the_normal_of_a_facet_elsewhere_is_told() -> None:
    """All rows lean by half a radian, which is as facets lie 32 further on."""
    form, ring = FORMS["roller"], polygon(disc(400).points)
    table = profile(form)
    late = replace(table, normal=table.normal * np.exp(2j * math.pi * 32 / 400))
    assert "normal_deg" not in told(judged(form, table, ring))
    assert "normal_deg" in told(judged(form, late, ring))


@pytest.mark.parametrize("sign", [-1, 1])
def test_a_row_of_another_cam_angle_puts_the_roller_elsewhere(sign: int) -> None:
    """Places of an angle 0.01 rad late: each lies on the outline, but the roller is not there."""
    form = FORMS["roller"]
    table, late = profile(form), replace(profile(form))
    turn = np.exp(1j * sign * 0.01)
    about = OFF + (table.place - OFF) * turn  # on the disc
    late = replace(
        table, place=about, radius=np.abs(about), angle=np.angle(about), normal=table.normal * turn
    )
    found = judged(form, late)
    assert (
        FOLLOWER in told(found)
        and "x_mm and y_mm" not in told(found)
        and "normal_deg" not in told(found)
    )
    (worst,) = [f for f in found if column(f) == FOLLOWER]
    assert worst.measured == pytest.approx((RADIUS + RHO) * 2 * math.sin(0.005), rel=1e-4)


def test_a_curve_within_the_tolerance_leans_and_bends_by_no_more_than_is_granted() -> None:
    """Of all cubics that leave an arc by e at most, Chebyshev's has the greatest slope and bend at its ends: 9 and 24 times e
    over the half of the length and its square, which the judge's own rule is to grant, and not the threefold."""
    count = 12
    length = 2 * math.pi * RADIUS / count
    slope, bend = 9 * TOLERANCE / (length / 2), 24 * TOLERANCE / (length / 2) ** 2
    form = FORMS["roller"]
    table = profile(form)
    by_slope = [f for f in judged(form, table) if column(f) == "normal_deg"]
    assert (
        math.radians(by_slope[0].limit) < 3 * slope and math.radians(by_slope[0].limit) > slope / 3
    )
    (by_bend,) = [f for f in judged(form, table) if "curvature" in str(f.where)]
    assert by_bend.limit < 5 * bend


@pytest.mark.parametrize("name", FORMS)
@pytest.mark.parametrize("sign", [-1, 1])
def test_a_curvature_that_is_off_is_told(name: str, sign: int) -> None:
    table, form = profile(FORMS[name]), FORMS[name]
    wrong = table.curvature + sign * 0.004 * (np.arange(72) == 33)
    assert told(judged(form, replace(table, curvature=wrong), polygon(disc(400).points))) == {
        "curvature_per_mm"
    }
    found = judged(form, replace(table, curvature=wrong))
    assert told(found) == {"curvature_per_mm"}
    (bend,) = [f for f in found if "curvature" in str(f.where)]
    assert bend.measured == pytest.approx(0.004, rel=1e-3) and str(bend.where).endswith(
        "row of 165 deg"
    )
    assert told(judged(form, replace(table, curvature=-table.curvature))) == {"curvature_per_mm"}
    lost = np.where(np.arange(72) == 33, math.nan, table.curvature)
    assert told(judged(form, replace(table, curvature=lost))) == {"curvature_per_mm"}


def test_rows_too_few_or_too_many_are_counted() -> None:
    table = profile(FORMS["roller"])
    for rows in (slice(0, 70), slice(0, 71)):
        few = Profile(
            *(
                getattr(table, name)[rows]
                for name in (
                    "theta",
                    "place",
                    "radius",
                    "angle",
                    "normal",
                    "curvature",
                    "pressure_angle",
                )
            )
        )
        (found,) = judged(FORMS["roller"], few)
        assert (
            not found.ok
            and f"{rows.stop} rows instead of 72" in found.message
            and str(found.where) == "x-profile.csv"
        )
