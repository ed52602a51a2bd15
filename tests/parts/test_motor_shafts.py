"""How long a motor's shaft may be under what passes over it."""

from __future__ import annotations

import tomllib

import pytest

from camgen import load, starters
from camgen.parts.assembly import order_of_assembly


def test_a_rod_that_passes_over_a_motors_shaft_limits_its_length() -> None:
    """In the toy that walks O lies between M and C2 at the start: conn2 passes over the shaft there, and no other rod lies lower."""
    tables = tomllib.loads(starters.text("walker"))
    m, c2 = tables["points"]["M"], tables["points"]["C2"]
    assert m[1] == c2[1] == 0 and m[0] < 0 < c2[0]
    made = load(tables)
    assembly = made.assembly
    conn2 = min(each.z for each in assembly.mounts if each.part == "conn2")
    room = conn2 - tables["print"]["slide_clearance"]
    assert tables["motor"]["shaft_length"] > conn2, "the motor's shaft, as it is sold, meets it"
    assert assembly.motor.most == pytest.approx(room) and assembly.motor.under == "conn2"
    (drive,) = (each for each in assembly.bought if each.role == "drive")
    assert assembly.motor.reach == pytest.approx(room)
    said = f"at least {room:.4g} long from its face, file off what is longer, for conn2 passes over its end"
    assert drive.listing.endswith(said)
    (step,) = (each for each in order_of_assembly(assembly).steps if "motor's face" in each.title)
    assert (
        f"file off what is longer than {room:.4g} mm, for conn2 passes over its end" in step.title
    )

    titles = [step.title for step in order_of_assembly(assembly).steps]
    assert any("ove low2 by hand, or by the motor where that holds it: " in each for each in titles)


def test_a_motors_shaft_that_nothing_passes_over_stays_as_it_is() -> None:
    """A motor that drives a five-bar from its edge: nothing lies over its shaft below that shaft's end."""
    assembly = load(tomllib.loads(starters.text("five-bar"))).assembly
    assert assembly.motor.reach is not None and assembly.motor.most is None
    (drive,) = (each for each in assembly.bought if each.role == "drive")
    assert not drive.details
