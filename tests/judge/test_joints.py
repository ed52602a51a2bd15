"""Joints put where features were measured: against the geometry of parts as they stand on their bodies."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.geometry.arcs import bulges, fit_arcs
from camgen.geometry.rings import Ring as Outline
from camgen.judge.joints import measured_machine, mounts_on_flats
from camgen.judge.measured import MeasuredEye, MeasuredFaces, Readings
from camgen.machine import (
    GROUND,
    Angle,
    Body,
    Drive,
    Gear,
    Machine,
    Output,
    Path,
    Pin,
    Place,
    Pose,
    Slide,
    Slot,
)
from camgen.machine.closing import close
from camgen.machine.constraints import Constraints
from camgen.machine.features import (
    Eye,
    Faces,
    Feature,
    GearTeeth,
    Mark,
    Mount,
    PinEyes,
    Ring,
    SharedFlat,
    SlideFaces,
    SlotFaces,
    Steady,
    Teeth,
)
from camgen.parts.wheels.involute import BasicRack
from camgen.parts.wheels.mesh import Sizes

# ---- a pair of wheels --------------------------------------------------------------------------------------------------

SMALL = 12
LARGE = 20
MODULE = 2.0
RADII = MODULE * SMALL / 2, MODULE * LARGE / 2


def pair(line: complex, tooth: float, thickness: float) -> tuple[Machine, tuple[Feature, ...]]:
    """Wheels on the ground with `line` from axis to axis; at theta = 0 a tooth of the first points along it, in a gap of the
    second, whose tooth 0 is drawn at `tooth`."""
    lean = cmath.phase(line)
    second = (
        lean + math.pi + math.pi / LARGE - tooth
    )  # the angle of the second wheel at which a gap of it faces the first
    ratio = -SMALL / LARGE
    machine = Machine(
        (Body("first"), Body("second")),
        (
            Pin("O", Place(GROUND), Place("first")),
            Pin("P", Place(GROUND, line), Place("second")),
            Gear("mesh", "first", "second", ratio, phase=second - ratio * lean),
        ),
        (Drive("motor", "first"),),
        {"first": Pose(0j, 0.0), "second": Pose(line, second - ratio * lean)},
    )
    teeth = (
        Teeth("a", SMALL, RADII[0], thickness, 0.0),
        Teeth("b", LARGE, RADII[1], thickness, tooth),
    )
    features = (
        PinEyes("O", Eye("plate", 0j, 3), Eye("a", 0j, 3), Eye(None, 0j, 3, shaft=True)),
        PinEyes("P", Eye("plate", line, 3), Eye("b", 0j, 3), Eye(None, 0j, 3, shaft=True)),
        GearTeeth("mesh", *teeth, ("O", "P")),
    )
    return machine, features


MESH = Sizes(BasicRack(MODULE), SMALL, LARGE, 1, 0.3).mesh(0.0, 0.0)
OUTLINES = [Outline(*bulges(fit_arcs(each.outline(), 2e-4))) for each in (MESH.a, MESH.b)]
SMALL_ANGLE = st.floats(-0.02, 0.02)
SHIFT = st.complex_numbers(max_magnitude=0.1)


@settings(max_examples=3)
@given(
    bearing=st.floats(-3, 3),
    tooth=st.floats(0, 0.3),
    off=st.tuples(SMALL_ANGLE, SMALL_ANGLE),
    moved=st.tuples(SHIFT, SHIFT),
)
def test_measured_teeth_lie_in_each_others_gaps(
    bearing: float,
    tooth: float,
    off: tuple[float, float],
    moved: tuple[complex, complex],
) -> None:
    """Axes and teeth off: on the line of the axes the middle of a gap still faces the middle of each tooth, at any angle; what
    is left between flanks is the backlash and what the involutes open as their axes part, 2 a (inv' - inv)."""
    line = sum(RADII) * cmath.exp(1j * bearing)
    machine, features = pair(line, tooth, 3.0)
    gear = features[2]
    assert isinstance(gear, GearTeeth)
    found = Readings(
        {
            eye: MeasuredEye(eye.at + (moved[k] if eye.part == "plate" else 0), eye.diameter)
            for k, pin in enumerate(features[:2])
            if isinstance(pin, PinEyes)
            for eye in (pin.a, pin.b, pin.pin)
            if eye
        }
    )
    made = [teeth.tooth + off[k] for k, teeth in enumerate((gear.a, gear.b))]
    found.wheels = {
        teeth: outline.moved(cmath.exp(1j * angle))
        for teeth, outline, angle in zip((gear.a, gear.b), OUTLINES, made, strict=True)
    }
    mounts = (Mount("plate", GROUND), Mount("a", "first"), Mount("b", "second"))
    closable = measured_machine(machine, features, mounts, found)
    theta = np.linspace(0, 2, 7)
    closed = close(Constraints(closable.machine), theta)
    apart = line + moved[1] - moved[0]
    lean, pitches = cmath.phase(apart), (math.tau / SMALL, math.tau / LARGE)
    # from the line of the axes to the nearest tooth, as shares of the pitch; both wheels turn against each other
    first = (closed.q[:, 2] + made[0] - lean) / pitches[0]
    second = (closed.q[:, 5] + made[1] - lean - math.pi) / pitches[1]
    assert np.allclose((first + second) % 1, 0.5, atol=1e-4)
    fit = closable.fits["mesh"]
    inv = [
        math.tan(angle) - angle
        for angle in (
            math.acos(abs(line / away) * math.cos(math.radians(20))) for away in (line, apart)
        )
    ]
    wider = 2 * abs(line) * (inv[1] - inv[0])
    assert fit.play == pytest.approx(MESH.backlash() * RADII[1] + wider, abs=1.5e-3)
    assert fit.nominal == pytest.approx(math.pi * MODULE - 6.0, abs=1e-9)
    half = abs(fit.play - fit.nominal) / 2 * math.cos(gear.pressure)
    assert fit.misfit == pytest.approx(half, abs=1e-9)
    assert (fit.shifts, fit.parts) == ((0.0, 0.0), ("", ""))
    assert closable.meshings["mesh"].lead == pytest.approx(
        closable.machine.joint("mesh").phase - closable.meshings["mesh"].start
    )


# ---- pins ----------------------------------------------------------------------------------------------------------------

BODIES = Body("crank"), Body("rod")
PLACES = 5 + 2j, -7 + 1j  # of the pin, in the frames of crank and rod
NUMBER, POINT = st.floats(-3, 3), st.complex_numbers(max_magnitude=40)
STANDING = st.tuples(POINT, NUMBER, st.booleans())  # at, turned, flipped
SIZE = st.floats(-0.2, 0.2)


def drawn(mount: Mount, place: complex) -> complex:
    """The point of a part, as drawn, that stands on a place of its body: turned back, and over."""
    z = (place - mount.at) * cmath.exp(-1j * mount.angle)
    return -z.conjugate() if mount.flipped else z


def machine(*joints: Pin | Slide | Slot) -> Machine:
    return Machine(
        BODIES, joints, (Drive("motor", "crank"),), {body.name: Pose(0j, 0.0) for body in BODIES}
    )


@settings(max_examples=40)
@given(
    standing=st.tuples(STANDING, STANDING),
    shifts=st.tuples(SHIFT, SHIFT),
    sizes=st.tuples(SIZE, SIZE, SIZE),
    spreads=st.tuples(st.floats(0, 0.4), st.floats(0, 0.4)),
    swapped=st.booleans(),
    shaft=st.booleans(),
)
def test_a_pin_is_where_its_eyes_are(
    standing: tuple[tuple[complex, float, bool], ...],
    shifts: tuple[complex, complex],
    sizes: tuple[float, float, float],
    spreads: tuple[float, float],
    swapped: bool,
    shaft: bool,
) -> None:
    """Each eye off its place in its part, each size off: a hole and a pin that is part of the crank, or two holes and a third."""
    mounts = [
        Mount(name, body.name, *how) for name, body, how in zip("ab", BODIES, standing, strict=True)
    ]
    wide = (4.0 if shaft else 4.4), 4.3
    eyes = [Eye(m.part, drawn(m, at), d) for m, at, d in zip(mounts, PLACES, wide, strict=True)]
    eyes[0] = Eye("a", eyes[0].at, wide[0], shaft)
    third = None if shaft else Eye("pin", 0j, 4.0, shaft=True)
    feature = PinEyes("P", *(eyes[::-1] if swapped and not shaft else eyes), third)
    found = Readings(
        {
            eye: MeasuredEye(eye.at + shift, eye.diameter + size, spread)
            for eye, shift, size, spread in zip(eyes, shifts, sizes, spreads, strict=False)
        }
    )
    if third is not None:
        found.eyes[third] = MeasuredEye(0j, 4.0 + sizes[2])
    pin = Pin("P", Place("crank", PLACES[0]), Place("rod", PLACES[1]))
    closable = measured_machine(machine(pin), [feature], mounts, found)
    (joint,) = closable.machine.joints
    assert isinstance(joint, Pin)
    for side, place, mount, shift in zip((joint.a, joint.b), PLACES, mounts, shifts, strict=True):
        spin = cmath.exp(1j * mount.angle)
        assert side.at == pytest.approx(
            place + spin * (-shift.conjugate() if mount.flipped else shift), abs=1e-9
        )
    fit = closable.fits["P"]
    air = sizes[1] - sizes[0] if shaft else sizes[0] + sizes[1] - 2 * sizes[2]
    assert fit.nominal == pytest.approx(0.3 if shaft else 0.7) and fit.play == pytest.approx(
        fit.nominal + air
    )
    assert fit.misfit == pytest.approx(
        max(abs(air) / (1 if shaft else 2), *map(abs, sizes[:2]), *spreads)
    )
    assert sorted(fit.shifts) == pytest.approx(sorted(map(abs, shifts)), abs=1e-9)
    assert dict(zip(fit.parts, fit.shifts, strict=True)) == pytest.approx(
        {"a": abs(shifts[0]), "b": abs(shifts[1])}, abs=1e-9
    )


def test_a_bearing_takes_its_thickness_of_the_hole() -> None:
    """Pressed into the first hole; the pin turns in its bore."""
    eyes = Eye("a", PLACES[0], 9.0), Eye("b", PLACES[1], 4.2)
    pin = Eye(None, 0j, 4.0, shaft=True)
    feature = PinEyes("P", *eyes, pin, rings=(Ring("ball", 4.0, 9.0),))
    found = Readings(
        {
            eyes[0]: MeasuredEye(eyes[0].at, 9.06),
            eyes[1]: MeasuredEye(eyes[1].at, 4.2),
            pin: MeasuredEye(0j, 4.0),
        }
    )
    pins = Pin("P", Place("crank", PLACES[0]), Place("rod", PLACES[1]))
    fit = measured_machine(
        machine(pins), [feature], [Mount("a", "crank"), Mount("b", "rod")], found
    ).fits["P"]
    assert (fit.nominal, fit.play, fit.misfit) == pytest.approx((0.2, 0.26, 0.06))


def test_of_two_copies_the_one_at_the_joint_counts() -> None:
    """A part twice on the crank; what no file shows stays where it is meant, and a part elsewhere is refused."""
    eyes = Eye("a", 1 + 0j, 4.0), Eye(None, PLACES[1], 0.0)
    mounts = [
        Mount("a", "crank", -PLACES[0] - 1),
        Mount("a", "crank", PLACES[0] - 1j, angle=math.pi / 2),
        Mount("a", "rod"),
    ]
    found = Readings({eyes[0]: MeasuredEye(1.1 + 0j, 4.0), eyes[1]: MeasuredEye(PLACES[1], 0.0)})
    pin = Pin("P", Place("crank", PLACES[0]), Place("rod", PLACES[1]))
    (joint,) = measured_machine(
        machine(pin), [PinEyes("P", *eyes)], mounts[:2], found
    ).machine.joints
    assert isinstance(joint, Pin)
    assert (joint.a.at, joint.b.at) == (pytest.approx(PLACES[0] + 0.1j), PLACES[1])
    with pytest.raises(ValueError, match="a is not mounted on crank"):
        measured_machine(machine(pin), [PinEyes("P", *eyes)], [Mount("a", "elsewhere")], found)
    with pytest.raises(ValueError, match="P is no joint for SlideFaces"):
        faces = Faces("a", 0j, 0.0, 8)
        measured_machine(machine(pin), [SlideFaces("P", faces, faces)], mounts, found)


@pytest.mark.parametrize(
    "off, sizes, spread, misfit",
    [
        (0.0, (0.0, 0.0), 0.0, 0.02),
        (0.05j, (0.0, 0.0), 0.0, 0.05),
        (0.0, (0.07, 0.0), 0.0, 0.07),
        (0.0, (0.0, -0.06), 0.0, 0.06),
        (0.0, (0.0, 0.0), 0.08, 0.08),
    ],
)
@pytest.mark.parametrize("webs", [False, True])
def test_what_is_off_at_the_far_end_of_a_shaft_is_a_misfit(
    off: complex, sizes: tuple[float, float], spread: float, misfit: float, webs: bool
) -> None:
    """In a second plate that stands elsewhere; of a crank of two webs what they lie apart counts too. Both ends off together
    are off by nothing."""
    places = [Place("crank", 0j), Place(GROUND, 3 + 4j)]
    ground = Pin("O", *(places if webs else places[::-1]))
    near, far, pin = (
        Eye("plate", 3 + 4j, 5.0),
        Eye("top", 4j, 5.2),
        Eye("shaft", 0j, 5.0, shaft=True),
    )
    own, end = Eye("web", 0j, 5.0, shaft=True), Eye("last", 2 + 0j, 5.0, shaft=True)
    features = [PinEyes("O", own, near), Steady("O", near, far, pin, (own, end) if webs else None)]
    mounts = [
        Mount("plate", GROUND),
        Mount("top", GROUND, 3 + 0j),
        Mount("web", "crank"),
        Mount("last", "crank", 0.03j - 2),
    ]
    together = 0.4 - 0.3j
    aside = 0.2 + 0.1j if webs else 0.0  # both webs
    found = Readings(
        {
            near: MeasuredEye(near.at + together, 5.02),
            own: MeasuredEye(aside, 5.0),
            end: MeasuredEye(2 + aside, 5.0),
            far: MeasuredEye(far.at + together + off, 5.2 + sizes[0], spread),
            pin: MeasuredEye(0j, 5.0 + sizes[1]),
        }
    )
    fit = measured_machine(
        Machine(BODIES[:1], (ground,), (), {"crank": Pose(3 + 4j, 0.0)}), features, mounts, found
    ).fits["O"]
    apart = 0.03 if webs else 0.0
    assert fit.misfit == pytest.approx(max(0.02, abs(off) + apart, *map(abs, sizes), spread))
    assert misfit == pytest.approx(fit.misfit) or webs
    assert fit.shifts[0] == pytest.approx(abs(together)) or fit.shifts[1] == pytest.approx(
        abs(together)
    )


@settings(max_examples=20)
@given(standing=st.tuples(STANDING, STANDING), shifts=st.tuples(SHIFT, SHIFT), guide=POINT)
def test_places_of_outputs_go_with_what_they_are_of(
    standing: tuple[tuple[complex, float, bool], ...],
    shifts: tuple[complex, complex],
    guide: complex,
) -> None:
    """A joint's place with the joint, a thread guide with its hole, in whichever copy it is; any other place stays."""
    mounts = [
        Mount(name, body.name, *how) for name, body, how in zip("ab", BODIES, standing, strict=True)
    ]
    eyes = [Eye(m.part, drawn(m, at), 4.0) for m, at in zip(mounts, PLACES, strict=True)]
    mark = Eye("b", drawn(mounts[1], guide), 2.0)
    found = Readings(
        {eye: MeasuredEye(eye.at + shifts[0], 4.0) for eye in eyes}
        | {mark: MeasuredEye(mark.at + shifts[1], 2.0)}
    )
    pin = Pin("P", Place("crank", PLACES[0]), Place("rod", PLACES[1]))
    places = (
        Place("rod", PLACES[1]),
        Place("rod", guide),
        Place("rod", guide + 1),
        Place("crank", guide),
    )
    outputs = tuple(Output(str(k), Path(place)) for k, place in enumerate(places))
    features: list[Feature] = [PinEyes("P", *eyes), Mark(mark)]
    made = measured_machine(
        replace(machine(pin), outputs=outputs), features, [*mounts, Mount("b", "crank", 99j)], found
    ).machine
    spin = cmath.exp(1j * mounts[1].angle)
    ways = [spin * (-shift.conjugate() if mounts[1].flipped else shift) for shift in shifts]
    wanted = PLACES[1] + ways[0], guide + ways[1], guide + 1, guide
    assert [output.of.of.at for output in made.outputs] == [
        pytest.approx(at, abs=1e-9) for at in wanted
    ]  # type: ignore[union-attr]
    turning = replace(machine(pin), outputs=(Output("turn", Angle("rod"), "rad"),))
    assert measured_machine(turning, features, mounts, found).machine.outputs == turning.outputs


# ---- faces ---------------------------------------------------------------------------------------------------------------

LEAN, OFFSET = st.floats(-0.009, 0.009), st.floats(-0.5, 0.5)


def crossing(
    mount: Mount, faces: Faces, found: MeasuredFaces, place: complex, along: float
) -> tuple[complex, float]:
    """The middle line of two faces in their body's frame, from two points of it: where it crosses the line through a place
    square to `along`, and its direction to the nearest half turn of it."""
    way = cmath.exp(1j * faces.angle)
    ends = [
        mount.place(faces.at + way * (x + 1j * (found.offset + x * math.tan(found.lean))))
        for x in (0.0, 1.0)
    ]
    line, square = ends[1] - ends[0], 1j * cmath.exp(1j * along)
    a, b = np.linalg.solve(
        [[line.real, -square.real], [line.imag, -square.imag]],
        [(place - ends[0]).real, (place - ends[0]).imag],
    )
    assert ends[0] + a * line == pytest.approx(place + b * square, abs=1e-9)
    angle = cmath.phase(line)
    return ends[0] + a * line, angle + round((along - angle) / math.pi) * math.pi


@settings(max_examples=40)
@given(
    standing=st.tuples(STANDING, STANDING),
    angle=NUMBER,
    turn=NUMBER,
    off=st.tuples(OFFSET, OFFSET),
    lean=st.tuples(LEAN, LEAN),
    widths=st.tuples(SIZE, SIZE),
    aside=st.tuples(NUMBER, NUMBER),
    over=st.tuples(st.booleans(), st.booleans()),
)
def test_a_slide_is_the_middle_line_of_its_faces(
    standing: tuple[tuple[complex, float, bool], ...],
    angle: float,
    turn: float,
    off: tuple[float, float],
    lean: tuple[float, float],
    widths: tuple[float, float],
    aside: tuple[float, float],
    over: tuple[bool, bool],
) -> None:
    """Rails and runner that lean and lie beside their place, sought from anywhere along them and run either way."""
    mounts = [
        Mount(name, body.name, *how) for name, body, how in zip("ab", BODIES, standing, strict=True)
    ]
    along = angle, angle - turn  # in the frames of guide and runner
    faces, found = [], Readings()
    for k, (mount, place) in enumerate(zip(mounts, PLACES, strict=True)):
        own = along[k] - mount.angle
        own = math.pi - own if mount.flipped else own
        one = Faces(
            mount.part,
            drawn(mount, place + aside[k] * cmath.exp(1j * along[k])),
            own + math.pi * over[k],
            (8.4, 8.0)[k],
        )
        found.faces[one] = MeasuredFaces(off[k], lean[k], one.width + widths[k])
        faces.append(one)
    slide = Slide("S", Place("crank", PLACES[0]), Place("rod", PLACES[1]), angle=angle, turn=turn)
    closable = measured_machine(machine(slide), [SlideFaces("S", *faces)], mounts, found)
    (joint,) = closable.machine.joints
    assert isinstance(joint, Slide)
    at, way = crossing(mounts[0], faces[0], found.faces[faces[0]], PLACES[0], along[0])
    assert (joint.guide.at, joint.angle) == (
        pytest.approx(at, abs=1e-9),
        pytest.approx(way, abs=1e-9),
    )
    block, own_way = crossing(mounts[1], faces[1], found.faces[faces[1]], PLACES[1], along[1])
    assert (joint.runner.at, joint.turn) == (
        pytest.approx(block, abs=1e-9),
        pytest.approx(way - own_way, abs=1e-9),
    )
    fit = closable.fits["S"]
    assert (fit.nominal, fit.play) == pytest.approx((0.4, 0.4 + widths[0] - widths[1]))
    assert fit.misfit == pytest.approx(abs(widths[0] - widths[1]))
    assert fit.shifts == pytest.approx((abs(at - PLACES[0]), abs(block - PLACES[1])), abs=1e-9)


@settings(max_examples=20)
@given(
    standing=STANDING,
    angle=NUMBER,
    off=OFFSET,
    lean=LEAN,
    shift=SHIFT,
    sizes=st.tuples(SIZE, SIZE, SIZE),
    spread=st.floats(0, 0.3),
)
def test_a_slot_is_the_middle_line_of_its_walls(
    standing: tuple[complex, float, bool],
    angle: float,
    off: float,
    lean: float,
    shift: complex,
    sizes: tuple[float, float, float],
    spread: float,
) -> None:
    """With a pin in it that goes through the rod's hole: between walls and hole it is looser by what both are wider."""
    mounts = [Mount("a", "crank", *standing), Mount("b", "rod")]
    own = math.pi - angle + mounts[0].angle if mounts[0].flipped else angle - mounts[0].angle
    walls, eye = Faces("a", drawn(mounts[0], PLACES[0]), own, 4.3), Eye("b", PLACES[1], 4.2)
    pin = Eye(None, 0j, 4.0, shaft=True)
    found = Readings(
        {
            eye: MeasuredEye(PLACES[1] + shift, 4.2 + sizes[1], spread),
            pin: MeasuredEye(0j, 4.0 + sizes[2]),
        }
    )
    found.faces[walls] = MeasuredFaces(off, lean, 4.3 + sizes[0])
    slot = Slot("S", Place("crank", PLACES[0]), Place("rod", PLACES[1]), angle=angle)
    closable = measured_machine(machine(slot), [SlotFaces("S", walls, eye, pin)], mounts, found)
    (joint,) = closable.machine.joints
    assert isinstance(joint, Slot)
    at, way = crossing(mounts[0], walls, found.faces[walls], PLACES[0], angle)
    assert (joint.guide.at, joint.angle) == (
        pytest.approx(at, abs=1e-9),
        pytest.approx(way, abs=1e-9),
    )
    assert joint.runner.at == pytest.approx(PLACES[1] + shift, abs=1e-9)
    fit, air = closable.fits["S"], sizes[0] + sizes[1] - 2 * sizes[2]
    assert (fit.nominal, fit.play) == pytest.approx((0.5, 0.5 + air))
    assert fit.misfit == pytest.approx(max(abs(air) / 2, abs(sizes[1]), spread))
    assert fit.shifts == pytest.approx((abs(at - PLACES[0]), abs(shift)), abs=1e-9)


def test_rails_on_the_runner_are_refused() -> None:
    faces = Faces("a", 0j, 0.0, 8), Faces("b", 0j, 0.0, 8)
    slide = Slide("S", Place("crank"), Place("rod"))
    found = Readings(faces={each: MeasuredFaces(0.0, 0.0, 8.0) for each in faces})
    with pytest.raises(ValueError, match="S: a is mounted on its runner"):
        measured_machine(
            machine(slide),
            [SlideFaces("S", *faces)],
            [Mount("a", "rod"), Mount("b", "crank")],
            found,
        )


# ---- parts on a pin with a flat ----------------------------------------------------------------------------------------


@settings(max_examples=40)
@given(
    at=st.complex_numbers(max_magnitude=30),
    turned=st.floats(-3, 3),
    flipped=st.tuples(st.booleans(), st.booleans()),
    holes=st.tuples(st.complex_numbers(max_magnitude=20), st.complex_numbers(max_magnitude=20)),
    facing=st.tuples(st.floats(-3, 3), st.floats(-3, 3)),
)
def test_a_part_on_a_pin_with_a_flat_stands_hole_on_hole_and_flat_beside_flat(
    at: complex,
    turned: float,
    flipped: tuple[bool, bool],
    holes: tuple[complex, complex],
    facing: tuple[float, float],
) -> None:
    """Wherever its own mount puts it, either of them turned over; other parts stay."""
    key = SharedFlat(Eye("a", 0j, 5.0), Eye("b", 0j, 5.0), 0.0)
    found = Readings(
        {key.a: MeasuredEye(holes[0], 5.0), key.b: MeasuredEye(holes[1], 5.0)}, facing={key: facing}
    )
    first, other = Mount("a", "crank", at, turned, flipped[0], 2.0), Mount("c", "crank", 1j, 0.5)
    same, kept, moved = mounts_on_flats(
        [key], [first, other, Mount("b", "crank", 99j, 2.0, flipped[1], 7.0)], found
    )
    assert (same, kept) == (first, other) and (moved.part, moved.body, moved.z) == (
        "b",
        "crank",
        7.0,
    )
    assert moved.place(holes[1]) == pytest.approx(first.place(holes[0]), abs=1e-9)
    ahead = [
        mount.place(hole + cmath.exp(1j * way)) - mount.place(hole)
        for mount, hole, way in zip((first, moved), holes, facing, strict=True)
    ]
    assert ahead[1] == pytest.approx(ahead[0], abs=1e-9)
