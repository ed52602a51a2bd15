"""Wheels by their outlines: radii and ratios against a prototype's, edges against each other as polygons."""

from __future__ import annotations

import cmath
import math
import tomllib
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.affinity import rotate, translate

from camgen.errors import DesignError
from camgen.geometry.arcs import fit_arcs
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Arc, Contour, Line, Piece, Smooth, end_point, start_point
from camgen.parts.wheels.cycloid import CycloidDisc
from camgen.parts.wheels.geneva import Geneva, InnerGeneva
from camgen.parts.wheels.involute import BasicRack, Ring, Wheel
from camgen.parts.wheels.mesh import Mesh, Sizes
from camgen.parts.wheels.planets import PlanetSet, seats, turns
from camgen.parts.wheels.ratchet import Pawl, RatchetWheel

REFERENCE = tomllib.loads(
    (Path(__file__).parents[1] / "reference" / "wheels.toml").read_text("utf-8")
)
RACK = BasicRack(2.0)
CHORD = 2e-4  # mm, of the polygons here


def _polygon(contour: Contour) -> Any:
    points = facet_contour(contour, CHORD)
    return shapely.Polygon(np.c_[points.real, points.imag])


def _turned(shape: Any, angle: float, x: float = 0.0) -> Any:
    return translate(rotate(shape, angle, use_radians=True, origin=(0, 0)), x, 0)


def _mesh(row: dict[str, Any]) -> Mesh:
    side = -1 if "tip" in row else 1
    return Sizes(RACK, *row.get("teeth", (12, 30)), side, 0.08).mesh(*row["shifts"])


@pytest.mark.parametrize("row", [*REFERENCE["outer"], *REFERENCE["inner"]])
def test_pairs_have_the_prototypes_numbers(row: dict[str, Any]) -> None:
    mesh = _mesh(row)
    assert mesh.distance == pytest.approx(row["distance"], abs=1e-6)
    assert math.degrees(mesh.working_angle) == pytest.approx(row["working_angle_deg"], abs=1e-5)
    assert mesh.contact_ratio == pytest.approx(row["contact_ratio"], abs=5e-5)
    assert mesh.backlash() == pytest.approx(row["backlash"], abs=1e-9)
    if "tip" in row:
        assert mesh.b.tip == pytest.approx(row["tip"], abs=5e-5)
        assert mesh.inner_margin > 0


def test_axes_further_apart_have_more_play() -> None:
    mesh = _mesh(REFERENCE["outer"][0])
    for by, backlash in zip(*REFERENCE["apart"].values(), strict=True):
        assert mesh.backlash(mesh.distance + by) == pytest.approx(backlash, abs=1e-9)


def test_flanks_end_where_the_cutter_ends_them() -> None:
    for teeth, shift, radius in REFERENCE["form"]["radii"]:
        assert Wheel(teeth, RACK, shift, 0.04).form == pytest.approx(radius, abs=5e-6)


def test_undercut_begins_at_the_closed_forms_teeth() -> None:
    sharp = BasicRack(2.0, fillet=0.25 / (1 - math.sin(RACK.pressure)))
    rate = math.sin(sharp.pressure) ** 2 / 2
    limit = REFERENCE["undercut"]["teeth_without_shift"]
    assert sharp.least_shift(0) / rate == pytest.approx(limit, abs=1e-4)
    for teeth, shift in REFERENCE["undercut"]["least_shift"]:
        assert sharp.least_shift(teeth) == pytest.approx(shift, abs=1e-6)


@dataclass(frozen=True)
class StraightRack:
    """A bar with teeth along Ox that a wheel of the same rack rolls on: its pitch line is Ox, teeth upwards, from 0 on."""

    teeth: int
    rack: BasicRack
    back: float = 0.0  # height of the bar under its roots, mm
    thinner: float = 0.0  # mm along the pitch line

    @property
    def length(self) -> float:
        """mm."""
        return math.pi * self.rack.module * self.teeth

    def outline(self) -> Contour:
        """The edge, counter-clockwise; it begins and ends in the middle of a space."""
        rack = self.rack
        m = rack.module
        slope = math.tan(rack.pressure)
        pitch = math.pi * m
        top = rack.addendum * m
        low = -(rack.addendum + rack.clearance) * m
        fillet = rack.fillet * m
        half = pitch / 4 - self.thinner / 2
        foot = half - (low + fillet) * slope + fillet / math.cos(rack.pressure)
        bend = math.pi / 2 - rack.pressure
        pieces: list[Piece] = []
        last = complex(self.length, low)
        for k in reversed(range(self.teeth)):
            middle = (k + 0.5) * pitch
            right = Arc(complex(middle + foot, low + fillet), fillet, -math.pi / 2, -bend)
            left = right.moved(-1 + 0j, 2 * middle, mirror=True).reversed()
            tips = [complex(middle + side * (half - top * slope), top) for side in (1, -1)]
            pieces += [
                Line(last, complex(middle + foot, low)),
                right,
                Line(end_point(right), tips[0]),
                Line(*tips),
                Line(tips[1], start_point(left)),
                left,
            ]
            last = complex(middle - foot, low)
        start = complex(0, low)
        under = [complex(0, low - self.back), complex(self.length, low - self.back)]
        pieces.append(Line(last, start))
        corners = [start, *under, complex(self.length, low)]
        pieces += [Line(a, b) for a, b in zip(corners[:-1], corners[1:], strict=True)]
        return Contour(tuple(pieces))


@pytest.mark.parametrize(("teeth", "shift"), [(12, 0.0), (12, 0.4), (18, 0.0), (8, 0.3)])
def test_the_cutter_rolls_along_the_wheel_that_it_made(teeth: int, shift: float) -> None:
    """The rack of the cutter's tips, drawn along the reference circle, touches wheel and roots and cuts nothing."""
    wheel = Wheel(teeth, RACK, shift)
    cutter = BasicRack(2.0, addendum=1.25, clearance=0.01, fillet=0.01)
    bar = translate(_polygon(StraightRack(9, cutter, 4.0).outline()), -9 * math.pi, 0)
    radius = RACK.fillet * 2.0
    bar = bar.buffer(-radius, quad_segs=120).buffer(radius, quad_segs=120)
    edge = _polygon(wheel.outline())
    for turn in np.linspace(0.0, wheel.pitch, 4):
        gap_up = _turned(edge, math.pi / 2 + wheel.pitch / 2 + turn)
        along = -turn * wheel.reference
        tool = translate(
            rotate(bar, 180, origin=(0, 0)), along, wheel.reference + RACK.module * shift
        )
        assert tool.intersection(gap_up).buffer(-1e-3).is_empty
        assert tool.distance(gap_up) < 1e-3
        assert not tool.intersection(translate(gap_up, 0, 0.01)).buffer(-1e-3).is_empty


@cache
def _shapes(index: int) -> tuple[Mesh, Any, Any]:
    row = [*REFERENCE["outer"], *REFERENCE["inner"]][index]
    mesh = _mesh(row)
    return mesh, _polygon(mesh.a.outline()), _polygon(mesh.b.outline())


@pytest.mark.parametrize("index", range(6))
def test_teeth_keep_apart_over_their_play_and_meet_beyond(index: int) -> None:
    """Turned at the ratio wheels stay free within half of the play to each side, and overlap outside of it."""
    mesh, first, second = _shapes(index)
    inner = isinstance(mesh.b, Ring)
    start = 0.0 if inner else math.pi + mesh.b.pitch / 2
    if inner:
        second = shapely.Point(0, 0).buffer(mesh.b.root + 5, 64) - second
    place = -mesh.distance if inner else mesh.distance
    half = mesh.backlash() / 2
    for turn in np.linspace(0, mesh.a.pitch, 4):
        one = _turned(first, turn)
        for nudge, meets in ((0.9, False), (-0.9, False), (1.15, True), (-1.15, True)):
            other = _turned(second, start + mesh.ratio * turn + nudge * half, place)
            overlap = one.intersection(other).area
            assert (overlap > 1e-4) is meets, (turn, nudge, overlap)


@pytest.mark.parametrize(("standard", "jams"), [(True, True), (False, False)])
def test_tips_of_standard_height_jam_in_a_ring(standard: bool, jams: bool) -> None:
    """12 in 30 with the ring's tips at its base circle (prototype: 0.99e-3 rad of overlap in the play's place), and cut back."""
    mesh = _mesh(REFERENCE["inner"][0])
    assert isinstance(mesh.b, Ring)
    teeth = replace(mesh.b, tip=mesh.b.base * (1 + 1e-6)) if standard else mesh.b
    first, hole = _polygon(mesh.a.outline()), _polygon(teeth.outline())
    ring = shapely.Point(0, 0).buffer(teeth.root + 5, 64) - hole
    least = []
    for turn in np.linspace(0, mesh.a.pitch, 25):
        one = _turned(first, turn)
        places = mesh.ratio * turn + mesh.backlash() / 2 * np.linspace(-1.2, 1.2, 7)
        areas = [one.intersection(_turned(ring, at, -mesh.distance)).area for at in places]
        least.append(min(areas))
    assert (max(least) > 1e-4) is jams
    assert jams or max(least) < 1e-6


@settings(max_examples=25, deadline=None)
@given(
    teeth=st.integers(7, 60),
    shift=st.floats(-0.4, 0.8),
    thinner=st.floats(0.0, 0.2),
    module=st.floats(0.5, 4.0),
)
def test_every_edge_closes_and_keeps_between_its_circles(
    teeth: int, shift: float, thinner: float, module: float
) -> None:
    try:
        wheel = Wheel(teeth, BasicRack(module), shift, thinner)
    except DesignError as error:
        assert "thickness" in error.quantity
        return
    rim = np.abs(facet_contour(wheel.outline(), 1e-3 * module))
    assert rim.max() <= wheel.tip * (1 + 1e-12)
    assert rim.min() >= wheel.root - 1e-3 * module
    assert wheel.root < wheel.form < wheel.tip
    assert wheel.form >= wheel.base * (1 - 1e-12)


@settings(max_examples=20, deadline=None)
@given(first=st.integers(9, 40), second=st.integers(9, 80), a=st.floats(0, 0.5))
def test_a_ring_and_its_wheel_of_one_shift_stand_at_the_plain_distance(
    first: int, second: int, a: float
) -> None:
    assert Sizes(RACK, first, first + second, -1).distance(a, a) == pytest.approx(second * 1.0)


@pytest.mark.parametrize(("teeth", "side"), [((12, 30), 1), ((20, 60), -1), ((17, 17), 1)])
def test_balanced_shifts_slide_alike(teeth: tuple[int, int], side: int) -> None:
    sizes = Sizes(RACK, *teeth, side)
    a, b = sizes.balanced()
    assert a + side * b == pytest.approx(0.0, abs=1e-12)
    mesh = sizes.mesh(a, b)
    assert mesh.sliding[0] == pytest.approx(mesh.sliding[1], abs=1e-6)
    assert min(mesh.sliding) > min(sizes.mesh().sliding) or teeth[0] == teeth[1]


@pytest.mark.parametrize("curve", ["flank", "root", "cycloid", "lock", "crescent"])
def test_slopes_are_those_of_the_points(curve: str) -> None:
    """First and second derivatives of the curves against differences of the ones before."""
    relieved = Sizes(RACK, 20, 41).mesh().relieved(0.02).a
    pieces = {
        "flank": [p for p in relieved.outline().pieces[:12] if isinstance(p, Smooth)],
        "root": [p for p in Wheel(12, RACK, 0.1).outline().pieces[:6] if isinstance(p, Smooth)],
        "cycloid": [CycloidDisc(11, 40, 3, 1.5, 0.02).outline().pieces[0]],
        "lock": [p for p in Geneva(4, 60, 3, 1).lock_disc().pieces if isinstance(p, Smooth)],
        "crescent": [
            p for p in InnerGeneva(4, 60, 3, 1).lock_disc().pieces if isinstance(p, Smooth)
        ],
    }[curve]
    assert pieces
    for piece in pieces:
        t = piece.t0 + (piece.t1 - piece.t0) * np.linspace(0.05, 0.95, 9)
        step = 1e-5 * abs(piece.t1 - piece.t0)
        for order in (0, 1):
            slope = (piece.at(t + step, order) - piece.at(t - step, order)) / (2 * step)
            assert np.abs(slope - piece.at(t, order + 1)).max() <= 1e-6 * np.abs(slope).max() + 1e-6


def test_relief_draws_the_tips_back_and_leaves_one_whole_pair() -> None:
    mesh = Sizes(RACK, 20, 41).mesh()
    eased = mesh.relieved(0.02)
    assert eased.a.relief is not None and eased.b.relief is not None
    plain = mesh.a.tangent(eased.a.relief.begin) - (
        mesh.line - mesh.b.tangent(eased.b.relief.begin)
    )
    assert plain == pytest.approx(mesh.base_pitch)
    lost = _polygon(mesh.a.outline()).area - _polygon(eased.a.outline()).area
    # each flank loses a third of the relief over its height there, and no more
    height = mesh.a.tip - eased.a.relief.begin
    assert lost == pytest.approx(2 * 20 * 0.02 * height / 3, rel=0.2)


def test_planets_that_go_together() -> None:
    sun, planet, ring = REFERENCE["planets"]["teeth"]
    pairs = Sizes(RACK, sun, planet).mesh(), Sizes(RACK, planet, ring, -1).mesh()
    for count in REFERENCE["planets"]["counts"]:
        planets = PlanetSet(*pairs, count)
        assert seats(planets.teeth, count) == pytest.approx(
            [math.tau * k / count for k in range(count)]
        )
        assert turns(planets.teeth, "ring", "sun")["carrier"] == pytest.approx(1 / (1 + ring / sun))
        assert turns(planets.teeth, "carrier", "sun")["ring"] == pytest.approx(-sun / ring)
    for count in REFERENCE["planets"]["crowded"]:
        with pytest.raises(DesignError, match="fewer planets"):
            PlanetSet(*pairs, count)
    with pytest.raises(DesignError, match="ring of 60 teeth"):
        PlanetSet(pairs[0], Sizes(RACK, planet, ring + 1, -1).mesh(), 3)


def test_cycloidal_discs_hold_the_prototypes_limits() -> None:
    row = REFERENCE["cycloid"]
    for eccentricity, largest in row["largest"]:
        disc = CycloidDisc(row["pins"], row["radius"], 3.0, eccentricity)
        assert disc.largest_pin == pytest.approx(largest, abs=5e-4)
    for delta, play in row["play"]:
        disc = CycloidDisc(row["pins"], row["radius"], 3.0, 1.5, delta)
        assert disc.play[0] == pytest.approx(play, rel=1e-5)
    disc = CycloidDisc(row["pins"], row["radius"], 3.0, 1.5, row["levers"][0])
    assert disc.play == pytest.approx(row["levers"][1:3], abs=5e-9)
    assert 1e3 * disc.ripple * 1.5 * disc.lobes == pytest.approx(row["levers"][3], abs=5e-3)
    with pytest.raises(DesignError, match="smaller pins"):
        CycloidDisc(11, 40, 9.0, 3.0)


@pytest.mark.parametrize(
    ("eccentricity", "offset"), [(1.5, -0.03), (1.5, 0.0), (1.5, 0.1), (3.2, 0.051)]
)
def test_a_cycloidal_disc_keeps_its_gap_from_every_pin(eccentricity: float, offset: float) -> None:
    disc = CycloidDisc(11, 40.0, 3.0, eccentricity, 0.05, offset)
    edge = _polygon(disc.outline())
    for turn in np.linspace(0, math.tau, 7):
        placed = translate(
            _turned(edge, disc.ratio * turn),
            eccentricity * math.cos(turn),
            eccentricity * math.sin(turn),
        )
        gaps = [placed.exterior.distance(shapely.Point(z.real, z.imag)) for z in disc.pin_places()]
        wanted = disc.gap(np.angle(disc.pin_places()) - turn)
        assert gaps == pytest.approx(wanted + 3.0, abs=2 * CHORD)
        assert wanted.min() >= disc.least_gap > 0


def test_the_air_of_a_lobe_is_more_where_a_smaller_circle_of_pins_leaves_it() -> None:
    """All of the offset at the top of a lobe and in a hollow; on a flank the share along its normal, which leans by asin(e n / r)."""
    disc = CycloidDisc(11, 40.0, 3.0, 1.5, 0.05, 0.02)
    assert disc.gap([0.0, math.pi]) == pytest.approx([0.07, 0.07], abs=1e-12)
    lean = math.asin(1.5 * 11 / 40)
    assert disc.least_gap == pytest.approx(0.05 + 0.02 * math.cos(lean), abs=2e-5)
    with pytest.raises(DesignError, match="clearance of a lobe.*more clearance"):
        CycloidDisc(11, 40.0, 3.0, 1.5, 0.05, -0.05)


def test_an_offset_past_the_middle_of_a_hollows_curvature_is_refused() -> None:
    """The radius there is (R - e n)^2 / (e n^2 - R): 4.8^2 / 347.2 mm."""
    assert CycloidDisc(11, 40.0, 3.0, 3.2).hollow_radius == pytest.approx(4.8**2 / 347.2, rel=1e-12)
    with pytest.raises(DesignError, match=r"offset is 0.06 mm.*limit: at most 0.051.*less offset"):
        CycloidDisc(11, 40.0, 3.0, 3.2, 0.05, 0.06)


@pytest.mark.parametrize("row", REFERENCE["geneva"]["rows"])
def test_geneva_wheels_turn_by_their_crank(row: tuple[int, float, float]) -> None:
    """Top speed and drive of the table; pin and lock keep their air, neither more at the pin, over the whole drive."""
    stations, drive, speed = row
    geneva = Geneva(int(stations), 60.0, 3.0, 0.6)
    assert math.degrees(2 * geneva.half) == pytest.approx(drive)
    assert geneva.speed == pytest.approx(speed, abs=5e-6)
    assert -float(geneva.motion(0.0, 1)) == pytest.approx(geneva.speed)
    wheel = rotate(_polygon(geneva.wheel()), 180, origin=(0, 0))
    lock = _polygon(geneva.lock_disc())
    pin = shapely.Point(geneva.crank, 0).buffer(3.0, 256)
    for t in np.linspace(-geneva.half, geneva.half, 21):
        turned = _turned(wheel, float(geneva.motion(t)), 60.0)
        assert turned.distance(_turned(pin, t)) == pytest.approx(0.05, abs=3e-4)
        assert turned.distance(_turned(lock, t)) >= 0.05 - 3e-4
    held = _turned(wheel, float(geneva.motion(geneva.half)), 60.0)
    for t in np.linspace(geneva.half, math.tau - geneva.half, 5):
        assert held.distance(_turned(lock, t)) == pytest.approx(0.05, abs=3e-4)


@pytest.mark.parametrize("row", REFERENCE["inner_geneva"]["rows"])
def test_inner_geneva_wheels_turn_with_their_crank(row: tuple[int, float, float]) -> None:
    """Top speed and drive of the table; pin and lock keep their air over a whole turn, neither more at the pin in the drive."""
    stations, drive, speed = row
    geneva = InnerGeneva(int(stations), 60.0, 3.0, 0.6)
    assert math.degrees(2 * geneva.half) == pytest.approx(drive)
    assert geneva.speed == pytest.approx(speed, abs=5e-6)
    assert float(geneva.motion(0.0, 1)) == pytest.approx(geneva.speed)
    ring = shapely.Point(0, 0).buffer(geneva.reach + 5).difference(_polygon(geneva.wheel()))
    lock = _polygon(geneva.lock_disc())
    pin = shapely.Point(geneva.crank, 0).buffer(3.0, 256)
    for t in np.linspace(-geneva.half, geneva.half, 21):
        seen = 60 + geneva.crank * np.exp(1j * t)
        assert float(geneva.motion(t)) == pytest.approx(math.atan2(seen.imag, seen.real))
        turned = _turned(ring, float(geneva.motion(t)), -60.0)
        assert turned.distance(_turned(pin, t)) == pytest.approx(0.05, abs=3e-4)
        assert turned.distance(_turned(lock, t)) >= 0.05 - 3e-4
    held = _turned(ring, float(geneva.motion(geneva.half)), -60.0)
    for t in np.linspace(geneva.half, math.tau - geneva.half, 7):
        assert held.distance(_turned(lock, t)) == pytest.approx(0.05, abs=3e-4)
        assert held.distance(_turned(pin, t)) >= 0.05 - 3e-4


@pytest.mark.parametrize("row", REFERENCE["inner_geneva"]["rows"])
def test_a_crescent_holds_its_wheel_both_ways(row: tuple[int, float, float]) -> None:
    """In the middle of a dwell a wheel turned by more than the air over the lever of the lock's ends meets it, either way."""
    geneva = InnerGeneva(int(row[0]), 60.0, 3.0, 0.6)
    ring = shapely.Point(0, 0).buffer(geneva.reach + 5).difference(_polygon(geneva.wheel()))
    lock = _turned(_polygon(geneva.lock_disc()), math.pi)
    most = 0.05 / (60.0 * math.sin(geneva.dwell))
    for way in (-1, 1):
        for share, meets in ((0.9, False), (1.2, True)):
            turned = _turned(ring, geneva.pitch / 2 + way * share * most, -60.0)
            assert turned.intersects(lock) is meets


def test_a_pawl_is_drawn_in_by_a_face_that_leans_enough() -> None:
    upright = RatchetWheel(12, 20.0, 17.0)
    leaning = RatchetWheel(12, 20.0, 17.0, math.radians(12))
    pawls = [Pawl(wheel, 18 - 30j, 0.5) for wheel in (upright, leaning)]
    assert pawls[1].draw - pawls[0].draw == pytest.approx(math.radians(12), abs=0.02)
    assert pawls[1].draw > math.atan(0.15) > Pawl(leaning, 10 - 30j, 0.5).draw
    for pawl in pawls:
        edge = _polygon(pawl.wheel.outline())
        assert edge.exterior.distance(
            shapely.Point(pawl.seat.real, pawl.seat.imag)
        ) == pytest.approx(0.5, abs=1e-9)
    with pytest.raises(DesignError, match="lean it less"):
        RatchetWheel(12, 20.0, 12.0, 0.7)


def test_edges_fit_arcs_within_the_tolerance() -> None:
    for contour in (
        Wheel(17, RACK).outline(),
        Ring(40, RACK, tip=38.3).outline(),
        Geneva(5, 60, 3, 1).lock_disc(),
    ):
        fitted = fit_arcs(contour, 2e-3)
        assert fitted.area == pytest.approx(contour.area, abs=2e-3 * contour.length)


@pytest.mark.parametrize(
    ("made", "what"),
    [
        (lambda: Wheel(8, RACK, 0.8), "thickness of a tooth's tip"),
        (lambda: Wheel(20, BasicRack(2.0, fillet=0.5)), "cutter's flat tip"),
        (lambda: Ring(30, RACK, tip=27.0), "radius of a ring's tips"),
        (lambda: Geneva(4, 60, 18.0, 1.0), "radius of the pin"),
        (lambda: InnerGeneva(4, 60, 41.5, 1.0), "radius of the pin"),
        (lambda: InnerGeneva(12, 60, 9.0, 1.0), "crescent"),
        (lambda: CycloidDisc(11, 40.0, 3.0, 4.0), "eccentricity"),
        (lambda: CycloidDisc(11, 40.0, 3.0, 0.0), "eccentricity"),
        (lambda: CycloidDisc(11, 40.0, 3.0, 0.05, 0.1), "eccentricity"),
        (lambda: RatchetWheel(12, 20.0, 21.0), "radius of the roots"),
        (lambda: Sizes(RACK, 5, 5).mesh().check(1.2), "contact ratio"),
    ],
)
def test_what_cannot_be_is_refused_by_its_quantity(made: Any, what: str) -> None:
    with pytest.raises(DesignError) as refused:
        made()
    assert what in refused.value.quantity


@pytest.mark.parametrize(("teeth", "factor"), REFERENCE["lewis"]["rows"])
def test_a_tooth_bends_as_lewis_tabulates_it(teeth: int, factor: float) -> None:
    """Y = cos(lean) / (module * bends): within what the cutters' roundings make."""
    wheel = Wheel(teeth, RACK)
    lean = math.acos(wheel.base / wheel.tip) - wheel.half_angle(wheel.tip)
    assert math.cos(lean) / RACK.module / wheel.bends == pytest.approx(factor, rel=0.04)


def test_an_undercut_tooth_bends_more_and_a_shift_mends_it() -> None:
    undercut = Wheel(10, RACK)
    assert undercut.undercut
    assert undercut.bends > Wheel(17, RACK).bends > Wheel(17, RACK, 0.3).bends
    assert Wheel(10, RACK, 0.4).bends < 0.8 * undercut.bends


@pytest.mark.parametrize("kind", [Geneva, InnerGeneva])
def test_a_slot_ends_beyond_the_pin_by_its_floor(kind: type[Geneva | InnerGeneva]) -> None:
    """The pin is deepest on the line of both axes: 60 -+ 60 sin(45 deg) from the wheel's, and 3 in radius. Its sides stay as they are."""
    deepest = 60 + kind.sense * (60 * math.sin(math.pi / 4) + 3)
    for floor in (0.1, 0.5):
        wheel = kind(4, 60.0, 3.0, 1.0, floor=floor).wheel()
        ends = [piece for piece in wheel.pieces if isinstance(piece, Arc) and piece.radius < 4]
        assert {round(each.radius, 9) for each in ends} == {3.05}
        (end,) = (each for each in ends if abs(cmath.phase(each.centre)) < 1e-6)
        middle = complex(end.at(end.t0 + (end.t1 - end.t0) / 2))
        assert kind.sense * (abs(middle) - deepest) == pytest.approx(floor)
