"""A printed copy's pins: at the edge of their clearance, off by the printer's error of a place; what drives stays."""

from __future__ import annotations

import numpy as np
import pytest
from test_tolerance import SPECS

from camgen.machine.model import GROUND, Machine, Pin
from camgen.machine.print_errors import Sizes
from camgen.machines.sources import read_mechanism
from camgen.tolerance.printed import loose, misplaced


@pytest.fixture(scope="module")
def four_bar() -> Machine:
    return read_mechanism(SPECS / "linkage.toml").model


def moves(machine: Machine, copy: Machine) -> dict[str, tuple[complex, complex]]:
    """Of both sides of each pin."""
    return {
        one.name: (other.a.at - one.a.at, other.b.at - one.b.at)
        for one, other in zip(machine.joints, copy.joints, strict=True)
        if isinstance(one, Pin) and isinstance(other, Pin)
    }


def test_a_pin_lies_at_the_edge_of_its_play(four_bar: Machine) -> None:
    copy = loose(four_bar, np.random.default_rng(1))
    (drive,) = four_bar.drives
    for pin in four_bar.joints:
        assert isinstance(pin, Pin)
        (a, b) = moves(four_bar, copy)[pin.name]
        driven = {pin.a.body, pin.b.body} == {GROUND, drive.body}
        assert b == 0 and abs(a) == pytest.approx(0 if driven else pin.clearance / 2)
    assert any(pin.clearance > 0 for pin in four_bar.joints if isinstance(pin, Pin))


def test_centres_are_off_by_the_print(four_bar: Machine) -> None:
    """As often and as far as said, in both sides alike; the same seed gives the same copy."""
    chance = np.random.default_rng(2)
    copies = [misplaced(four_bar, Sizes(0, 0, 0.05, 0), chance) for _ in range(400)]
    off = np.array([moves(four_bar, each)["B"][1] for each in copies])
    assert np.std(off.real) == pytest.approx(0.05, rel=0.15)
    assert np.std(off.imag) == pytest.approx(0.05, rel=0.15)
    again = misplaced(four_bar, Sizes(0, 0, 0.05, 0), np.random.default_rng(2))
    assert moves(four_bar, again) == moves(four_bar, copies[0])
