"""Figures of other pairs than wheels of two axes: a rack, a cutter, Geneva wheels, a ratchet, ellipses; and the cams that ship."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from pair_outlines import ALPHA, Wheel, through

from camgen.geometry.arcs import bulges, fit_arcs
from camgen.geometry.outlines import Contour
from camgen.geometry.rings import Floats, Points, Ring
from camgen.judge import joints
from camgen.judge.contact import contact
from camgen.judge.contact_tips import ArmTip, Form, SlideTip
from camgen.judge.pair_events import Slide
from camgen.judge.pairs import Body, OutlinePair, pivots_apart
from camgen.parts.wheels.geneva import Geneva
from camgen.parts.wheels.involute import BasicRack
from camgen.parts.wheels.involute import Wheel as CutWheel
from camgen.parts.wheels.ratchet import RatchetWheel
from camgen.pipeline.build import build

ROOT = Path(__file__).resolve().parents[2]
KNOWN = tomllib.loads((ROOT / "tests" / "reference" / "higher_pairs.toml").read_text("utf-8"))
FIT = 1e-5  # mm, of the arcs


def circle(centre: complex, radius: float) -> Ring:
    """Four quarters."""
    return Ring(centre + radius * np.array([1, 1j, -1, -1j]), np.full(4, math.tan(math.pi / 8)))


def ring(contour: Contour) -> Ring:
    return Ring(*bulges(fit_arcs(contour, FIT)))


def rack(half_tooth: float, above: float, below: float, rounding: float) -> Ring:
    """Five teeth of module 2 that point down, a tooth's middle on Oy, half so wide on Ox, mm; counter-clockwise."""
    slope = math.tan(ALPHA)
    corner = (half_tooth - below * slope) - 1j * below
    # the rounding touches the flank and the tip's line
    middle = corner - rounding * math.tan(math.pi / 4 - ALPHA / 2) + 1j * rounding
    up = middle + rounding * complex(np.exp(-1j * ALPHA))
    right = [(half_tooth + above * slope) + 1j * above, up, middle - 1j * rounding]
    sweep = -(math.pi / 2 - ALPHA)
    points: list[complex] = []
    bulge: list[float] = []
    # from left to right along the bottom, so that the material above lies on the left
    for k in range(-2, 3):
        at = k * 2 * math.pi
        points += [at - z.conjugate() for z in right] + [at + z for z in right[::-1]]
        turn = math.tan(-sweep / 4) if rounding else 0.0
        bulge += [0.0, turn, 0.0, turn, 0.0, 0.0]
    high = above + 5.0
    points += [points[-1].real + 1j * high, points[0].real + 1j * high]
    return Ring(np.array(points), np.array([*bulge, 0.0, 0.0]))


def over_a_rack(wheel: Ring, teeth: int, bar: Ring) -> OutlinePair:
    """A wheel of module 2 whose reference circle touches Ox from below and turns clockwise; a space is upwards at 0."""

    def pose(theta: Floats, order: int) -> tuple[Points, Floats]:
        if order == 0:
            return np.full(theta.shape, -1j * teeth), -theta
        return np.zeros(theta.shape, complex), np.full(theta.shape, -float(order == 1))

    up = wheel.moved(np.exp(1j * (math.pi / 2 - math.pi / teeth)))
    return OutlinePair(Body([up]), Body([bar]), pose, Slide(1.0 + 0j))


def test_a_rack_has_the_backlash_along_its_pitch_line() -> None:
    known = KNOWN["rack"]
    bar = rack(math.pi / 2 - 0.02, 2.3, 2.0, 0.0).moved(1, 0.8j)
    pair = over_a_rack(Wheel(2, 12, 0.4).ring(), 12, bar)
    theta = np.linspace(0, math.pi / 6, 601)
    samples = pair.follow(theta, 0.0).samples
    assert samples.free.all()
    assert np.ptp(samples.play) < 5e-4
    assert np.mean(samples.play) == pytest.approx(known["play"][0], abs=1e-5)
    low = samples.low - 12 * theta
    assert [low.min(), low.max()] == pytest.approx(known["low"], abs=1e-5)


@pytest.mark.parametrize("row", KNOWN["cutter"]["rows"], ids=str)
def test_the_cutter_that_is_drawn_back_has_the_play_of_its_slope(row: list[float]) -> None:
    """The maker's trochoid is the envelope of the rounded cutter: no play is lost and none is won at the root."""
    teeth, shift, form, least, most = row
    cut = CutWheel(int(teeth), BasicRack(2.0), shift)
    if form:
        assert cut.form == pytest.approx(form, abs=2e-5)
    back = KNOWN["cutter"]["drawn_back"]
    tool = rack(math.pi / 2, 2.4, 2.5, 0.76).moved(1, 1j * (2 * shift + back))
    pair = over_a_rack(ring(cut.outline()), int(teeth), tool)
    theta = np.linspace(-math.pi / teeth, math.pi / teeth, 241)
    samples = pair.follow(theta, -math.pi).samples
    assert samples.free.all()
    off = np.concatenate([samples.high - teeth * theta, teeth * theta - samples.low])
    allowed = 2 * FIT / math.cos(ALPHA)  # the arcs' tolerance across a flank
    assert least - allowed < off.min() <= KNOWN["cutter"]["closed"] + allowed
    assert off.max() < most + allowed


@pytest.mark.parametrize(("stations", "top"), KNOWN["geneva"]["rows"])
def test_a_geneva_wheel_has_its_top_speed_in_the_middle(stations: int, top: float) -> None:
    geneva = Geneva(int(stations), 60.0, 3.0, 0.55)
    pair = OutlinePair(
        Body([circle(geneva.crank, 3.0)]), Body([ring(geneva.wheel())]), pivots_apart(60.0)
    )
    theta = np.linspace(-0.02, 0.02, 5)
    motion = pair.follow(theta, math.pi + float(geneva.motion(theta[0])))
    slopes = [motion.touch(motion.samples, side).slope[2] for side in ("low", "high")]
    sine = math.sin(math.pi / stations)
    assert np.mean(np.abs(slopes)) == pytest.approx(sine / (1 - sine), rel=1e-5)
    assert np.mean(np.abs(slopes)) == pytest.approx(top, rel=3e-5)


def test_a_pawl_drops_once_a_tooth_by_what_the_next_back_leaves_open() -> None:
    """It drops where tip, middle of its end and pivot are in line; there the end falls on the back of the next tooth."""
    pivot = 30 + 14j
    reach = 18.0
    end = 0.5
    wheel = ring(RatchetWheel(12, 20.0, 17.0).outline()).moved(mirror=True)

    def pose(theta: Floats, order: int) -> tuple[Points, Floats]:
        """Clockwise: backs, which rise from a root to a tip, lift the pawl."""
        place, angle = pivots_apart(pivot)(theta, order)
        return place, -angle

    pair = OutlinePair(Body([wheel]), Body([circle(reach, end)]), pose, rest="low")
    motion = pair.follow(np.linspace(0, math.pi / 3, 1441), float(np.angle(20.6 - pivot)) + 0.1)
    drops = motion.jumps("low")
    away = math.acos((400 + abs(pivot) ** 2 - (reach + end) ** 2) / (40 * abs(pivot)))
    at = away - float(np.angle(pivot))
    assert [drop.theta for drop in drops] == pytest.approx([at, at + math.pi / 6], abs=1e-9)
    root = 17 * np.exp(-1j * at)
    back = 20 * np.exp(1j * (math.pi / 6 - at)) - root
    normal = -1j * back / abs(back)
    # on the back's parallel at the radius of the end, from the pivot
    high = (np.conj(normal) * (root - pivot)).real + end
    after = float(np.angle(normal)) + math.acos(high / reach) - math.tau
    before = float(np.angle(20 * np.exp(-1j * at) - pivot))
    for drop in drops:
        assert np.exp(1j * drop.before) == pytest.approx(np.exp(1j * before), abs=1e-6)
        assert (
            min(
                abs(np.exp(1j * drop.after) - np.exp(1j * each))
                for each in (after, 2 * float(np.angle(normal)) - after)
            )
            < 1e-9
        )


def test_ellipses_about_their_foci_roll_as_kepler_says() -> None:
    a, b = 30.0, 24.0
    e = math.sqrt(1 - (b / a) ** 2)
    u = np.linspace(0, math.tau, 401)
    edge = a * np.cos(u) + 1j * b * np.sin(u)
    ellipse = Ring(*through(edge))
    driver = Body([ellipse.moved(1, -a * e)])
    driven = Body([ellipse.moved(1, -a * e)])
    pair = OutlinePair(driver, driven, pivots_apart(60.0), rest="low")
    # the half of the turn in which the first one's radius grows where both touch, so that it pushes
    theta = np.linspace(math.radians(10), math.radians(170), 321)
    expected = -2 * np.arctan((1 - e) / (1 + e) * np.tan(theta / 2))
    samples = pair.follow(theta, expected[0]).samples
    bounds = [bound for bound in (samples.low, samples.high) if not np.isnan(bound).any()]
    off = min(np.abs(bound - expected).max() for bound in bounds)
    assert off < 2 * KNOWN["ellipses"]["off_200"]


# ---- the table of round tips against the engine of any outline --------------------------------------------------------

Contacts = list[tuple[Ring, Form]]


@pytest.fixture(params=["disc-cam", "uniform-swing", "gallery/groove", "gallery/automaton"])
def contacts(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Contacts]:
    """What the judge read from the files of a cam and its follower."""
    read: Contacts = []

    def noted(outline: Ring, form: Form) -> object:
        read.append((outline, form))
        return contact(outline, form)

    monkeypatch.setattr(joints, "contact", noted)
    build(ROOT / "specs" / f"{request.param}.toml", tmp_path, frozenset(["dxf"]))
    yield [(outline, form) for outline, form in read if isinstance(form, SlideTip | ArmTip)]


@pytest.mark.long
def test_the_table_of_round_tips_and_the_engine_of_any_outline_agree(contacts: Contacts) -> None:
    """1e-12 of the cam's size: both are closed forms of the same arcs, by other routes."""
    theta = np.linspace(0, math.tau, 721)
    compared = 0
    for outline, form in contacts:
        if not form.tip_radius:
            continue
        start = form.start if isinstance(form, SlideTip) else form.pivot
        tip = circle(0 if isinstance(form, SlideTip) else form.arm, form.tip_radius)

        def pose(angle: Floats, order: int, start: complex = start) -> tuple[Points, Floats]:
            return pivots_apart(start)(angle, order)

        own = contact(outline, form).angle(theta)
        freedom = {"freedom": Slide(form.along)} if isinstance(form, SlideTip) else {}
        pair = OutlinePair(Body([outline]), Body([tip]), pose, **freedom)
        low = (form.leaves > 0) != form.inside
        air = 0.01 * (1 if low else -1)
        samples = pair.follow(theta, float(own[0]) + air).samples
        found = samples.low if low else samples.high
        turn = 0.0 if isinstance(form, SlideTip) else np.round((found - own) / math.tau) * math.tau
        reach = float(np.abs(outline.points).max())
        scale = reach if isinstance(form, SlideTip) else reach / abs(form.arm)
        assert np.abs(found - turn - own).max() < 1e-12 * max(scale, 1.0)
        compared += 1
    assert compared
