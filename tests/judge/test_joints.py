"""Joints put where features were measured: against the geometry of the pair itself."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.judge.joints import assembled
from camgen.judge.measured import Measured, Readings
from camgen.machine import GROUND, Body, Drive, Gear, Machine, Pin, Place, Pose
from camgen.machine.closing import close
from camgen.machine.constraints import Constraints
from camgen.machine.features import Eye, Feature, GearTeeth, Mount, PinEyes, Teeth

# ---- a pair of wheels --------------------------------------------------------------------------------------------------

SMALL, LARGE, MODULE = 12, 20, 2.0
RADII = MODULE * SMALL / 2, MODULE * LARGE / 2


def pair(line: complex, tooth: float, thickness: float) -> tuple[Machine, tuple[Feature, ...]]:
    """Wheels on the ground with `line` from axis to axis; at theta = 0 a tooth of the first points along it, in a gap of the
    second, whose tooth 0 is drawn at `tooth`."""
    lean = cmath.phase(line)
    second = lean + math.pi + math.pi / LARGE - tooth  # the angle of the second wheel at which a gap of it faces the first
    ratio = -SMALL / LARGE
    machine = Machine(
        (Body("first"), Body("second")),
        (Pin("O", Place(GROUND), Place("first")), Pin("P", Place(GROUND, line), Place("second")),
         Gear("mesh", "first", "second", ratio, phase=second - ratio * lean)),
        (Drive("motor", "first"),),
        {"first": Pose(0j, 0.0), "second": Pose(line, second - ratio * lean)},
    )  # fmt: skip
    teeth = Teeth("a", SMALL, RADII[0], thickness, 0.0), Teeth("b", LARGE, RADII[1], thickness, tooth)
    features = (
        PinEyes("O", Eye("plate", 0j, 3), Eye("a", 0j, 3), Eye(None, 0j, 3, shaft=True)),
        PinEyes("P", Eye("plate", line, 3), Eye("b", 0j, 3), Eye(None, 0j, 3, shaft=True)),
        GearTeeth("mesh", *teeth, ("O", "P")),
    )
    return machine, features


SMALL_ANGLE = st.floats(-0.02, 0.02)
SHIFT = st.complex_numbers(max_magnitude=0.3)


@settings(max_examples=40)
@given(
    bearing=st.floats(-3, 3), tooth=st.floats(0, 0.3), off=st.tuples(SMALL_ANGLE, SMALL_ANGLE), moved=st.tuples(SHIFT, SHIFT),
    thick=st.tuples(st.floats(2.7, 3.1), st.floats(2.7, 3.1)),
)  # fmt: skip
def test_measured_teeth_lie_in_each_others_gaps(
    bearing: float, tooth: float, off: tuple[float, float], moved: tuple[complex, complex], thick: tuple[float, float]
) -> None:
    """Axes and teeth off: on the line of the axes the middle of a gap still faces the middle of each tooth, at any angle; what
    is left between flanks is the space on the pitch circle and twice the shift apart by the tangent of 20 deg."""
    line = sum(RADII) * cmath.exp(1j * bearing)
    machine, features = pair(line, tooth, 3.0)
    gear = features[2]
    assert isinstance(gear, GearTeeth)
    found = Readings({
        eye: Measured(eye.at + (moved[k] if eye.part == "plate" else 0), eye.diameter)
        for k, pin in enumerate(features[:2]) if isinstance(pin, PinEyes) for eye in (pin.a, pin.b, pin.pin) if eye
    })  # fmt: skip
    made = [Teeth(t.part, t.count, t.radius, thick[k], t.tooth + off[k]) for k, t in enumerate((gear.a, gear.b))]
    found.teeth = dict(zip((gear.a, gear.b), made, strict=True))
    mounts = (Mount("plate", GROUND), Mount("a", "first"), Mount("b", "second"))
    closable = assembled(machine, features, mounts, found)
    theta = np.linspace(0, 2, 7)
    closed = close(Constraints(closable.machine), theta)
    apart = line + moved[1] - moved[0]
    lean, pitches = cmath.phase(apart), (math.tau / SMALL, math.tau / LARGE)
    # from the line of the axes to the nearest tooth, as shares of the pitch; both wheels turn against each other
    first = (closed.q[:, 2] + made[0].tooth - lean) / pitches[0]
    second = (closed.q[:, 5] + made[1].tooth - lean - math.pi) / pitches[1]
    assert np.allclose((first + second) % 1, 0.5, atol=1e-9)
    fit = closable.fits["mesh"]
    space, wider = math.pi * MODULE, 2 * (abs(apart) - abs(line)) * math.tan(math.radians(20))
    assert fit.play == pytest.approx(space - sum(thick) + wider, abs=1e-9)
    assert fit.meant == pytest.approx(space - 6.0, abs=1e-9)
    assert fit.misfit == pytest.approx(max(abs(wider), *(abs(each - 3.0) for each in thick)), abs=1e-9)
