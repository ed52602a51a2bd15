"""Swept interference against closed forms of circles and brute force, and seen to fail."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.files.threemf import PartCopy, write_3mf
from camgen.geometry.mesh import Mesh, placing
from camgen.geometry.outlines import Region, circle, polygon
from camgen.geometry.rings import Floats, Points, Ring
from camgen.judge.interference import Clearance, _Approach, interference, sweep_clearances
from camgen.judge.relative_motion import Motion
from camgen.judge.slabs import Body, Course, Slab, judge_plate, slabs_of
from camgen.parts.part import Layer, Part
from camgen.parts.solids import solid


def about(angle: Callable[[Floats], Floats], at: complex = 0j) -> Course:
    return lambda t: (angle(t), np.full(t.shape, at))


SPIN = about(lambda t: t)


def ring(points: Points | list[complex]) -> Ring:
    z = np.asarray(points, complex)
    return Ring(z, np.zeros(len(z)))


def disc(centre: complex, radius: float, n: int = 400) -> Ring:
    return ring(centre + radius * np.exp(2j * np.pi * np.arange(n) / n))


def box(low: complex, high: complex) -> Ring:
    return ring([low, complex(high.real, low.imag), high, complex(low.real, high.imag)])


def slabs(*rings: Ring) -> tuple[Slab, ...]:
    return (Slab(0.0, 5.0, rings),)


def only(found: list[Clearance]) -> Clearance:
    assert len(found) == 1
    return found[0]


def swing_arm(theta_amplitude: float) -> Course:
    return about(lambda t: theta_amplitude * np.sin(t), 60 + 0j)


def test_eccentric_disc_and_a_wall() -> None:
    """An eccentric reaches e + r: its gap to a wall at x is x - e - r, at theta = 0 for e on Ox."""
    gap = 0.3
    wall = Body("wall", slabs(box(25 + gap - 50j, 40 + 50j)))
    c = only(sweep_clearances([Body("cam", slabs(disc(5, 20)), SPIN), wall], {}, 0.25))
    assert c.proven <= gap <= c.gap + 1e-9 or abs(c.gap - gap) < 0.005
    assert c.proven >= 0.25 and min(c.theta, math.tau - c.theta) < 0.1
    assert interference([c], 0.25)[0].ok and not interference([c], 0.31)[0].ok


@pytest.mark.parametrize(("turns", "said"), [(1, "the whole turn"), (10, "all 10 turns")])
def test_a_finding_says_how_many_turns_were_swept(turns: int, said: str) -> None:
    (found,) = interference([Clearance("a", "b", 0.3, 0.29, 0.0, None, 1)], 0.2, turns=turns)
    assert found.ok and f"proven for {said}, not only the samples" in found.message


def test_turning_square_by_brute_force() -> None:
    square, post = box(-10 - 10j, 10 + 10j), disc(17.3 + 2j, 3)
    c = only(
        sweep_clearances(
            [Body("square", slabs(square), SPIN), Body("post", slabs(post))], {}, resolution=1e-4
        )
    )
    theta = np.linspace(0, math.tau, 100_001)
    centre = (17.3 + 2j) * np.exp(-1j * theta)
    outside = np.maximum(np.abs(centre.real) - 10, 0) + 1j * np.maximum(np.abs(centre.imag) - 10, 0)
    gap = float(np.min(np.abs(outside))) - 3
    assert c.proven <= gap + 1e-9 and c.gap == pytest.approx(gap, abs=0.3 * gap)


def test_of_sections_at_several_heights_the_widest_counts() -> None:
    """A wall whose middle stands out, an eccentric that has a hole in its upper half: the gap is that of what stands out."""
    wall = tuple(
        Slab(z, z + 2, (box(x - 50j, 40 + 50j),))
        for z, x in ((0.0, 27.0), (2.0, 25.3), (4.0, 26.0))
    )
    cam = Body(
        "cam", (Slab(0.0, 3.0, (disc(5, 20),)), Slab(3.0, 6.0, (disc(5, 20), disc(9, 2)))), SPIN
    )
    alone = only(sweep_clearances([cam, Body("wall", (wall[1],))], {}, 0.25))
    assert alone.proven <= 0.3 <= alone.gap + 0.005
    for slabs_of_wall in (wall, wall[::-1]):
        c = only(sweep_clearances([cam, Body("wall", slabs_of_wall)], {}, 0.25))
        assert (c.gap, c.proven, c.evaluations) == (alone.gap, alone.proven, alone.evaluations)


@pytest.mark.parametrize("wide", [True, False])
def test_a_piece_is_halved_across_its_longer_side(wide: bool) -> None:
    """Far from the origin either way."""
    long, flat = (0, 100, 4, 102), (0, 100, 2, 102)
    other = (2, 100, 4, 102)
    if not wide:
        long, flat, other = (100, 0, 102, 4), (100, 0, 102, 2), (100, 2, 102, 4)
    motion = Motion(about(np.zeros_like), SPIN, np.linspace(0, math.tau, 99))
    whole = _Approach(motion, shapely.box(0, 0, 1, 1), shapely.box(*long), 0.0, 0.0, 0.0, cuts=1)
    assert [part.guest.bounds for part in whole.divided()] == [flat, other]


@pytest.mark.parametrize(
    "home",
    [
        (103, 1.2, 105, 2),  # beside its way
        (103, -2, 105, -0.2),
        (90, 0, 99.8, 1),  # behind its start
        (111.2, 0, 120, 1),  # ahead of its end
    ],
)
def test_what_slides_straight_leaves_the_gap_beside_all_its_way(
    home: tuple[float, float, float, float],
) -> None:
    """A square of 1 mm, 100 to 110 mm from the origin of its body, and a bar 0.2 mm beside what it sweeps."""
    theta = np.linspace(0, math.tau, 1441)
    motion = Motion(
        about(np.zeros_like), lambda t: (np.zeros_like(t), 105 - 5 * np.cos(t) + 0j), theta
    )
    way = _Approach(motion, shapely.box(*home), shapely.box(0, 0, 1, 1), 0.0, 0.0, 0.0)
    assert way.slides_clear(0.19) and not way.slides_clear(0.21)


def test_shifted_by_a_hair() -> None:
    """A shaft with 0.1 mm of air keeps 0.05 mm; moved by 0.04 mm further than it may, it does not."""
    cam = Body("cam", slabs(disc(0, 20), disc(0, 4)), SPIN)
    fine = interference(sweep_clearances([cam, Body("shaft", slabs(disc(0, 3.9)))], {}, 0.05), 0.05)
    moved = interference(
        sweep_clearances([cam, Body("shaft", slabs(disc(0.055, 3.9)))], {}, 0.05), 0.05
    )
    assert [f.ok for f in fine + moved] == [True, False]
    assert 0.05 <= fine[0].measured <= 0.1 and moved[0].measured <= 0.045


def test_body_shifted_into_another_by_a_twentieth_of_a_millimetre() -> None:
    cam = Body("cam", slabs(disc(5, 20)), SPIN)
    touching = Body("wall", slabs(box(25.002 - 50j, 40 + 50j)))
    pushed = Body("wall", slabs(box(24.952 - 50j, 40 + 50j)))
    pair = {frozenset(("cam", "wall")): 0.01}
    assert interference(sweep_clearances([cam, touching], pair), 0.0)[0].ok
    failed = only(sweep_clearances([cam, pushed], pair))
    assert not interference([failed], 0.0)[0].ok
    assert failed.gap == pytest.approx(-0.048, abs=0.003)
    assert min(failed.theta, math.tau - failed.theta) < math.radians(1)


@pytest.mark.parametrize("allowed", [0.05, 0.4])
@pytest.mark.parametrize("round_", [True, False])
def test_an_overlap_may_be_as_deep_as_is_allowed(allowed: float, round_: bool) -> None:
    """An eccentric that reaches into a wall by a share of that, or into a post; what is deeper is told, and never as less."""
    cam = Body("cam", slabs(disc(5, 20)), SPIN)
    for share in (0.5, 0.9, 1.1, 1.5):
        depth = share * allowed
        other = slabs(disc(27 - depth, 2) if round_ else box(25 - depth - 50j, 40 + 50j))
        c = only(
            sweep_clearances([cam, Body("wall", other)], {frozenset(("cam", "wall")): allowed})
        )
        assert interference([c], 0.0)[0].ok is (share < 1)
        if share > 1:
            assert -c.gap == pytest.approx(depth, abs=0.006) and -c.proven >= depth - 1e-9


@pytest.mark.parametrize("thin", ["home", "guest", "both", "disc"])
def test_what_is_thinner_than_it_may_overlap_says_nothing(thin: str) -> None:
    """A foil of 0.1 mm, or a needle, that goes right through what it may overlap by 0.3 mm; thicker, it is seen."""
    for width, holds in ((0.1, True), (1.0, False)):
        wide = {
            "home": (width, 8.0),
            "guest": (8.0, width),
            "both": (width, width),
            "disc": (8.0, width),
        }[thin]
        home = box(complex(20, -wide[0] / 2), complex(30, wide[0] / 2))
        guest = (
            disc(25, wide[1] / 2, 720)
            if thin == "disc"
            else box(complex(20, -wide[1] / 2), complex(30, wide[1] / 2))
        )
        c = only(
            sweep_clearances(
                [Body("a", slabs(home)), Body("b", slabs(guest), SPIN)], {frozenset("ab"): 0.3}
            )
        )
        assert interference([c], 0.0)[0].ok is holds


def test_spikes_that_meet_between_two_samples() -> None:
    """Two spikes 0.05 mm wide at radius 40 meet for under 0.15 deg; off every grid of whole degrees."""
    at = np.exp(1j * math.radians(123.4567))
    turning = Body(
        "rotor", slabs(ring([30 - 10j, 40 - 0.02j, 40.1, 40 + 0.02j, 30 + 10j, 0])), SPIN
    )
    still = ring(at * np.array([60 - 10j, 60 + 10j, 40 + 0.02j, 40 - 0.02j]))
    grid = np.radians(np.arange(360))
    assert np.all(np.abs(40.05 * np.exp(1j * grid) - 40.05 * at) > 0.2), (
        "a coarse grid sees nothing"
    )
    c = only(sweep_clearances([turning, Body("stator", slabs(still))], {}))
    assert c.gap <= 0 and not interference([c], 0.0)[0].ok
    assert math.degrees(c.theta) == pytest.approx(123.4567, abs=0.1)
    clear = ring(at * np.array([60 - 10j, 60 + 10j, 40.15 + 0.02j, 40.15 - 0.02j]))
    assert interference(sweep_clearances([turning, Body("stator", slabs(clear))], {}), 0.0)[0].ok


@pytest.mark.parametrize("short, ok", [(0.0, True), (0.3, False)])
def test_pin_that_meets_the_end_of_its_slot(short: float, ok: bool) -> None:
    """An axle 40 mm from the pivot swings by +-0.26 rad in a slot with 0.2 mm of air all round, less `short` at an end."""
    edge = 0.26 + (1.7 + 1e-4) / 40 - short / 40
    angles = np.linspace(-0.26 - 1.7 / 40, edge, 200)
    slot = 60 - np.concatenate([41.7 * np.exp(1j * angles), 38.3 * np.exp(1j * angles[::-1])])
    base = Body("base", slabs(box(-40 - 60j, 80 + 60j), ring(slot)))
    axle = Body("axle", slabs(disc(0, 1.5)), swing_arm(0.26), at=-40 + 0j)
    assert interference(sweep_clearances([base, axle], {}, 0.1), 0.1)[0].ok is ok


@given(st.floats(0.1, 3), st.floats(5, 12), st.floats(0.2, 2.9))
@settings(max_examples=25)
def test_proven_gap_is_never_above_the_true_one(e: float, r: float, air: float) -> None:
    """Eccentric of radius r in a round hole: the air left is hole radius - e - r wherever it turns."""
    hole = disc(0, e + r + air, 720)
    c = only(
        sweep_clearances(
            [Body("cam", slabs(disc(e, r)), SPIN), Body("ring", slabs(disc(0, 30), hole))], {}
        )
    )
    assert c.proven <= air and c.gap >= air - 0.01 and c.proven > 0.5 * air - 0.02


def test_heights() -> None:
    stacked = [Body("a", slabs(disc(0, 5))), Body("b", slabs(disc(0, 5)), SPIN, z=5.0)]
    assert sweep_clearances(stacked, {}) == []
    stud = (Slab(0.0, 4.0, (disc(20, 1),)), Slab(4.0, 5.0, (disc(0, 1),)))
    upright = [Body("a", stud), Body("b", (Slab(0.0, 2.0, (disc(-20, 1),)),))]
    assert only(sweep_clearances(upright, {})).gap > 30
    raised = [Body("a", stud, at=-40), Body("b", (Slab(0.0, 0.5, (disc(-20, 1),)),), z=1.5)]
    assert only(sweep_clearances(raised, {})).gap < 0


def test_bodies_of_one_course_are_judged_once() -> None:
    cam, pin = (
        Body("cam", slabs(disc(0, 20), disc(8, 1.5)), SPIN),
        Body("pin", slabs(disc(8, 1.49)), SPIN),
    )
    assert only(sweep_clearances([cam, pin], {})).evaluations == 1


def test_overlap_that_is_more_than_an_area() -> None:
    """An overlap of areas and a line: the largest circle is that of the corner cut off, 1 mm wide, the line none."""
    home = Body("block", slabs(box(0, 10 + 10j)))
    hook = Body("hook", slabs(ring([9, 20, 20 + 10j, 10 + 10j, 10 + 4j, 9 + 4j])))
    assert only(sweep_clearances([home, hook], {})).gap == pytest.approx(-1.0, abs=0.01)


@pytest.mark.parametrize("oversize, ok", [(0.02, True), (0.2, False)])
def test_an_undeclared_press_fit(oversize: float, ok: bool) -> None:
    """A pin too large by 2 t overlaps its hole in a ring t wide, all round; fixed together they may do so by 0.02 mm."""
    plate = Body("plate", slabs(disc(0, 8), disc(0, 2)), SPIN)
    pin = Body("pin", slabs(disc(0, 2 + oversize / 2)), SPIN)
    c = only(sweep_clearances([plate, pin], {}, 0.08, mounted=0.02))
    assert c.at_rest and interference([c], 0.08)[0].ok is ok
    assert ok or c.gap == pytest.approx(-oversize / 2, abs=0.005)


STAR = st.lists(st.floats(2.0, 8.0), min_size=3, max_size=12)


@pytest.mark.long
@given(
    STAR,
    STAR,
    st.floats(6, 30),
    st.floats(-2, 2),
    st.integers(-3, 3),
    st.floats(0, 12),
    st.floats(0, 6.28),
)
@settings(max_examples=60, deadline=None)
def test_bound_against_brute_force(
    a: list[float],
    b: list[float],
    away: float,
    swing: float,
    turns: int,
    orbit: float,
    phase: float,
) -> None:
    """Random stars on random courses: the proven gap is not above the least of 1500 angles, the one seen not below it."""
    import shapely

    def star(radii: list[float]) -> Points:
        return np.asarray(radii) * np.exp(2j * np.pi * np.arange(len(radii)) / len(radii))

    def first(t: Floats) -> tuple[Floats, Points]:
        return swing * np.sin(t + phase), 0.5 * np.exp(2j * t)

    def second(t: Floats) -> tuple[Floats, Points]:
        return turns * t, away + 12 + orbit * np.exp(1j * (t + phase)) + 1j * np.sin(3 * t)

    theta = np.linspace(0, math.tau, 1501)
    placed = []
    for radii, course in ((a, first), (b, second)):
        angle, position = course(theta)
        z = position[:, None] + np.exp(1j * angle)[:, None] * star(radii)
        placed.append(shapely.polygons(np.stack([z.real, z.imag], axis=-1)))
    true = float(np.min(shapely.distance(*placed)))
    bodies = [Body("a", slabs(ring(star(a))), first), Body("b", slabs(ring(star(b))), second)]
    for needed, share in (
        (0.0, 0.25),
        (100.0, 0.0),
    ):  # roughly where there is room, finely where it matters
        c = only(sweep_clearances(bodies, {}, needed, resolution=0.01))
        if true == 0:
            assert c.gap <= 0
        else:
            assert c.proven <= true + 1e-9
            assert (
                true - 0.3 <= c.gap <= true / (1 - share) + 0.01 + 1e-9 or c.gap <= 0 and true < 0.3
            )  # between two angles


def test_far_ends_do_not_slow_down_a_bearing() -> None:
    """A crank 200 mm long with 0.1 mm of air round its axle: what is far from the joint is not near the axle."""
    crank = Body("crank", slabs(ring([-8 - 8j, 200 - 4j, 200 + 4j, -8 + 8j]), disc(0, 4.1)), SPIN)
    square = ring(4 * np.exp(1j * np.linspace(0, 6, 90)))  # with a flat, so no disc
    c = only(sweep_clearances([crank, Body("axle", slabs(square))], {}, 0.08))
    assert 0.08 <= c.proven <= 0.1 and c.evaluations < 1000


@pytest.mark.parametrize("size, often", [(3.0, 5), (0.5, 1)])
def test_a_course_that_jumps_is_refused(size: float, often: int) -> None:
    """Aside between the angles of the grid, wherever it is looked at there: there it is faster, up to 1 + size * often times."""
    grid = math.tau / 3600
    jumpy = about(
        lambda t: t + size * np.sin(often * t) * (np.abs(t / grid - np.round(t / grid)) > 1e-6)
    )
    with pytest.raises(ValueError, match="faster than its course"):
        sweep_clearances(
            [Body("cam", slabs(disc(5, 20)), jumpy), Body("post", slabs(disc(26, 0.5, 8)))], {}
        )


@pytest.mark.parametrize("width", [0.0, 0.02])
def test_a_turn_within_a_step_is_run_through_only_where_it_is_a_jump(width: float) -> None:
    """Half a radian at 200.25 deg, between two angles of the grid: at once, or in some hundredths of a degree."""
    theta = np.radians(np.arange(361.0))
    jump, inside = np.radians([200.25, 200.1])

    def angle(t: Floats) -> Floats:
        off = t - jump
        return 0.25 + 0.25 * (np.tanh(off / math.radians(width)) if width else np.sign(off))

    pole = 3 + 4j

    def guest(t: Floats) -> tuple[Floats, Points]:
        return angle(t), pole - np.exp(1j * angle(t)) * pole

    motion = Motion(about(lambda t: 0 * t), guest, theta)
    (turn,), (shift,) = motion.at(np.array([inside]))
    # a tenth of the way of a jump; else not begun
    assert np.angle(turn) == pytest.approx(0.0 if width else 0.05, abs=1e-6)
    assert shift + turn * pole == pytest.approx(pole)


def test_false_names_are_refused() -> None:
    with pytest.raises(ValueError, match="unknown bodies"):
        sweep_clearances([Body("cam", slabs(disc(5, 20)))], {frozenset(("cam", "post")): 0.01})
    with pytest.raises(ValueError, match="twice"):
        sweep_clearances([Body("cam", slabs(disc(5, 20))), Body("cam", slabs(disc(5, 20)))], {})


def mesh(part: Part) -> Mesh:
    return solid(part, 0.01)


def test_slabs_of_a_stepped_part_and_of_a_cone() -> None:
    stepped = Part(
        "p",
        "",
        (Layer(Region(circle(0j, 5)), 0, 2), Layer(Region(circle(0j, 3), (circle(0j, 1),)), 2, 7)),
    )
    found = slabs_of(mesh(stepped))
    assert [(s.z0, s.z1) for s in found] == [(0, 2), (2, 7)]
    assert [len(s.rings) for s in found] == [1, 2]
    assert abs(found[1].rings[0].area) + abs(found[1].rings[1].area) == pytest.approx(
        10 * math.pi, rel=0.02
    )
    corners = np.array([[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0], [10, 2, 3]], float)
    faces = np.array([[0, 2, 1], [0, 3, 2], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    leaning = slabs_of(Mesh(corners, faces))[0]
    assert abs(leaning.rings[0].area) == pytest.approx(
        4 * 4 + 4 * 6 / 2
    )  # its shadow, over the foot and out to the apex


def plate(path: Path, shift: complex, lift: float = 0.0) -> Path:
    block = solid(Part("block", "", (Layer(Region(polygon([0, 10, 10 + 10j, 10j])), 0, 3),)), 0.01)
    places = [
        PartCopy("block", "block 1", placing(0, 5 + 5j, 0, 3)),
        PartCopy("block", "block 2", placing(0, shift, lift, 3)),
    ]
    write_3mf(path, {"block": block}, places, "key")
    return path


@pytest.mark.parametrize(
    "shift, lift, verdict",
    [
        (17 + 5j, 0.0, [True, True, True]),
        (16.9 + 5j, 0.0, [True, True, False]),
        (91 + 5j, 0.0, [False, True, True]),
        (40 + 5j, 0.5, [True, False, True]),
    ],
)
def test_plate(tmp_path: Path, shift: complex, lift: float, verdict: list[bool]) -> None:
    findings = judge_plate(plate(tmp_path / "x-plate.3mf", shift, lift), (100.0, 60.0), 2.0)
    assert [f.ok for f in findings] == verdict
    assert {f.code for f in findings} == {"BED_FIT"}
    assert findings[0].message.startswith("how far 2 bodies extend beyond the bed of 100 x 60 mm")


def test_a_plate_of_one_body(tmp_path: Path) -> None:
    block = solid(Part("block", "", (Layer(Region(polygon([0, 10, 10 + 10j, 10j])), 0, 3),)), 0.01)
    write_3mf(
        tmp_path / "x.3mf",
        {"block": block},
        [PartCopy("block", "block 1", placing(0, 95 + 5j, 0, 3))],
        "key",
    )
    out, lift = judge_plate(tmp_path / "x.3mf", (100.0, 60.0), 2.0)
    assert out.measured == pytest.approx(5, abs=1e-5) and not out.ok and lift.ok
    assert out.message.startswith("how far 1 body extends beyond")


@pytest.mark.parametrize("nose", [0.0, 0.05, 0.09])
def test_what_slides_on_a_straight_line_is_looked_at_as_a_whole(nose: float) -> None:
    """A bar of many sections 0.1 mm beside a wall; a nose on the last of them meets a spike of the wall on the way only."""
    along = np.exp(0.3j)
    wall = [box(-40 - 5j, 40 + 0j)] * 5 + [ring([-40 - 5j, 40 - 5j, 40, 7.1, 7 + 0.02j, 6.9, -40])]
    nosed = [-10 + 4j, -10 + 0.1j, -0.1 + 0.1j, 1j * (0.1 - nose), 0.1 + 0.1j, 10 + 0.1j, 10 + 4j]
    bar = [box(-10 + 0.1j, 10 + 4j)] * 5 + [ring(nosed)]
    stacks = [
        tuple(Slab(k, k + 1, (each.moved(along),)) for k, each in enumerate(some))
        for some in (wall, bar)
    ]

    def slide(t: Floats) -> tuple[Floats, Points]:
        return np.zeros(t.shape), along * (20 * np.sin(t)).astype(complex)

    c = only(
        sweep_clearances(
            [Body("wall", stacks[0]), Body("bar", stacks[1], slide)], {}, 0.02, resolution=1e-3
        )
    )
    assert c.gap == pytest.approx(0.08 - nose, abs=0.005) if nose < 0.08 else c.gap <= 0
    assert c.evaluations < (10_000 if nose else 100)
    if nose:
        assert 20 * math.sin(c.theta) == pytest.approx(7, abs=0.2)


# ---- what is said --------------------------------------------------------------------------------------------------------


def clearance(
    a: str, gap: float, proven: float, allowed: float | None = None, theta: float = 1.0
) -> Clearance:
    return Clearance(a, "frame", gap, proven, theta, allowed, 9)


def test_of_pairs_that_stay_apart_the_nearest_is_said_or_all_that_fail() -> None:
    """By what is proven against what is needed; what was seen stands beside it, and where."""
    apart = [
        clearance("rod", 0.9, 0.8),
        clearance("arm", 0.5, 0.4, theta=math.pi / 3),
        clearance("cam", 2.0, 1.9),
    ]
    (finding,) = interference(apart, 0.3, "crank angle")
    assert (finding.ok, finding.measured, finding.limit) == (True, 0.4, 0.3)
    assert str(finding.where) == "arm and frame: gap, crank angle 60.000 deg"
    assert finding.message.startswith(
        "nearest of 3 pairs that must stay apart; smallest gap seen 0.5000 mm; proven"
    )
    failed = interference(
        [*apart, clearance("pin", -0.2, -0.25), clearance("belt", 0.0, -0.1)], 0.6
    )
    assert [str(f.where).partition(" ")[0] for f in failed] == ["pin", "belt", "arm"] and not any(
        f.ok for f in failed
    )
    assert (
        "they overlap by 0.2000 mm or more" in failed[0].message
        and "overlap by 0.0000 mm" in failed[1].message
    )
    assert interference([clearance("rod", 0.4, 0.3)], 0.3)[0].ok  # just as much
    assert interference([], 0.3) == []


def test_of_pairs_that_touch_the_deepest_is_said_or_all_that_overlap_by_more() -> None:
    """Each against its own allowance: 0.09 of 0.1 mm is nearer to it than 0.3 of 0.5."""
    touching = [
        clearance("rod", -0.3, -0.3, 0.5),
        clearance("arm", -0.08, -0.09, 0.1),
        clearance("cam", 0.2, 0.1, 0.05),
    ]
    (finding,) = interference(touching, 0.3)
    assert (finding.ok, finding.measured, finding.limit) == (True, 0.09, 0.1)
    assert (
        str(finding.where).startswith("arm and frame: overlap, cam angle 57.29")
        and "overlap seen 0.0800 mm" in finding.message
    )
    assert "deepest of 3 pairs that touch by design" in finding.message
    failed = interference(
        [*touching, clearance("pin", -0.7, -0.8, 0.6), clearance("x", -0.1, -0.1, 0.1)], 0.3
    )
    assert [(str(f.where).partition(" ")[0], f.measured) for f in failed] == [("pin", 0.8)]
    both = interference([clearance("a", 5, 5), clearance("b", 1, 1, 0.1)], 0.3)
    assert [(f.ok, f.measured, f.limit) for f in both] == [(True, 5, 0.3), (True, 0.0, 0.1)]


@pytest.mark.long
@pytest.mark.parametrize("layers", [4, 5, 15])
@pytest.mark.parametrize("deep", [0, 1])
def test_of_stacks_of_many_sections_the_nearest_pair_counts(layers: int, deep: int) -> None:
    """A tower whose k-th section stands out most towards the wall, and the wall whose own does: where both meet counts."""
    out = (layers - 1) * deep
    tower = [Slab(k, k + 1.0, (disc(5, 20 - 0.05 * abs(k - out), 200),)) for k in range(layers)]
    wall = [
        Slab(k, k + 1.0, (box(complex(26 + 0.05 * abs(k - out), -50), 40 + 50j),))
        for k in range(layers)
    ]
    c = only(
        sweep_clearances([Body("tower", tuple(tower), SPIN), Body("wall", tuple(wall))], {}, 0.9)
    )
    assert c.proven <= 1.0 + 1e-9 and c.gap == pytest.approx(1.0, abs=0.03)
    shaft = [Slab(k, k + 1.0, (disc(0, 2 + (k == out), 90),)) for k in range(layers)]
    pushed = only(
        sweep_clearances([Body("tower", tuple(tower), SPIN), Body("shaft", tuple(shaft))], {})
    )
    assert pushed.gap == pytest.approx(-6.0, abs=0.01)  # the shaft's whole width
    assert (
        interference(
            sweep_clearances(
                [Body("tower", tuple(tower), SPIN), Body("wall", tuple(wall))], {}, 1.1
            ),
            1.1,
        )[0].ok
        is False
    )


@pytest.mark.parametrize("depth", [0.003, 0.2, 3.0])
def test_the_depth_of_an_overlap_is_the_largest_circle_in_it(depth: float) -> None:
    """A bar that lies on a stud, or turns through it: a strip, or the bar's width."""
    touch = {frozenset(("bar", "stud")): 1e-3}
    bar, stud = box(-30 - 2j, 30 + 2j), Body("stud", slabs(box(complex(-8, 2 - depth), 8 + 20j)))
    turning = only(sweep_clearances([Body("bar", slabs(bar), SPIN), stud], touch))
    assert (
        turning.gap == pytest.approx(-4.0, abs=0.006) and turning.proven <= turning.gap
    )  # somewhere across its whole width
    still = only(sweep_clearances([Body("bar", slabs(bar)), stud], touch))
    assert still.gap == pytest.approx(-depth, abs=0.006) and still.at_rest


def test_a_part_of_the_turn_is_judged_alone() -> None:
    """An eccentric that meets a post at a quarter of a turn: before that it does not."""
    cam, post = Body("cam", slabs(disc(5, 20)), SPIN), Body("post", slabs(disc(26j, 2)))
    for turn, meets in (
        ((0.0, math.tau), True),
        ((0.0, 0.5), False),
        ((-1.0, 1.3), True),
        ((2.8, 6.0), False),
    ):
        c = only(sweep_clearances([cam, post], {}, 0.05, turn=turn))
        assert (c.gap <= 0) is meets and turn[0] <= c.theta <= turn[1]
        theta = np.linspace(*turn, 20_001)
        true = float(np.min(np.abs(5 * np.exp(1j * theta) - 26j))) - 22
        assert meets or (
            c.proven <= true + 1e-9 and c.gap == pytest.approx(true, rel=0.3, abs=0.02)
        )
