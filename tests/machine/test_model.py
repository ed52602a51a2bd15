"""Names in a machine: each one that is not there is told."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any, get_args

import pytest

from camgen.errors import SpecError
from camgen.machine import (
    GROUND,
    Along,
    Angle,
    Body,
    Cam,
    Drive,
    Force,
    Function,
    Gear,
    Gravity,
    Machine,
    Output,
    Path,
    Pin,
    Place,
    Pose,
    Resistance,
    Slide,
    Slot,
    Spring,
    Torque,
    TorsionSpring,
)
from camgen.machine import features as f
from camgen.machine.joining import Module


def law(theta: Any, order: int = 0) -> Any:
    return theta if order == 0 else 1 + 0 * theta


HERE = Place("crank", 3j)
JOINTS: Mapping[str, Any] = {
    "pin": Pin("pin", HERE, Place(GROUND)),
    "slide": Slide("slide", Place(GROUND), Place("ram")),
    "slot": Slot("slot", Place("crank"), Place("ram")),
    "gear": Gear("gear", "crank", "wheel", -2.0, carrier="arm"),
    "cam": Cam("cam", "crank", "ram", law, "slide"),
}
LOADS: Mapping[str, Any] = {
    "force": Force("force", HERE, 1j),
    "torque": Torque("torque", "crank", 1.0, by="arm"),
    "spring": Spring("spring", HERE, Place("ram"), 1.0),
    "wound": TorsionSpring("wound", "crank", "arm", 1.0),
    "brake": Resistance("brake", Along("slide")),
    "drag": Resistance("drag", Angle("crank", "arm")),
}
OUTPUTS: Mapping[str, Any] = {
    "angle": Output("angle", Angle("crank", "arm")),
    "way": Output("way", Along("slide")),
    "path": Output("path", Path(HERE)),
    "thread": Output("thread", Function((HERE, Place("ram")), law)),
}
MOVING = ("crank", "ram", "wheel", "arm")
MACHINE = Machine(
    (Body(GROUND), *map(Body, MOVING)),
    tuple(JOINTS.values()),
    (Drive("motor", "arm"), Drive("push", "ram", law, "slide", "pump")),
    dict.fromkeys(MOVING, Pose(0j, 0.0)),
    (*LOADS.values(), Gravity()),
    tuple(OUTPUTS.values()),
)


def damaged(record: Any, key: str) -> Any:
    """The record with a name in it that is nowhere."""
    value = getattr(record, key)
    if isinstance(value, str):
        return replace(record, **{key: "zz"})
    if isinstance(value, Place):
        return replace(record, **{key: Place("zz")})
    if isinstance(value, tuple):
        return replace(record, **{key: (Place("zz"), *value[1:])})
    return replace(record, **{key: damaged(value, next(field.name for field in fields(value)))})


@pytest.mark.parametrize(
    "table, name, key",
    [
        *(
            ("joints", name, key)
            for name, keys in {
                "pin": "a b",
                "slide": "guide runner",
                "slot": "guide runner",
                "gear": "a b carrier",
                "cam": "cam follower slide",
            }.items()
            for key in keys.split()
        ),
        ("drives", "motor", "body"),
        ("drives", "push", "slide"),
        *(
            ("loads", name, key)
            for name, keys in {
                "force": "on",
                "torque": "on by",
                "spring": "a b",
                "wound": "a b",
                "brake": "of",
                "drag": "of",
            }.items()
            for key in keys.split()
        ),
        *(("outputs", name, "of") for name in OUTPUTS),
    ],
)
def test_a_name_that_is_nowhere_is_told(table: str, name: str, key: str) -> None:
    rows = getattr(MACHINE, table)
    changed = tuple(damaged(row, key) if getattr(row, "name", "") == name else row for row in rows)
    with pytest.raises(
        ValueError,
        match=f"^{name} is (on zz, which is no body|along zz, which is no slide or slot)$",
    ):
        replace(MACHINE, **{table: changed})


@pytest.mark.parametrize("table", ["bodies", "joints", "drives", "loads", "outputs"])
def test_a_name_used_twice_is_told(table: str) -> None:
    rows = getattr(MACHINE, table)
    with pytest.raises(ValueError, match=f"^named twice: {rows[0].name}$"):
        replace(MACHINE, **{table: (*rows, rows[0])})


@pytest.mark.parametrize("what", ["body", "joint", "slide", "output"])
def test_what_is_asked_for_by_a_wrong_name_is_told(what: str) -> None:
    with pytest.raises(SpecError, match="'zz' - expected "):
        getattr(MACHINE, what)("zz")
    assert MACHINE.body(GROUND).name == GROUND and MACHINE.joint("pin") is JOINTS["pin"]


EYE, FACES = f.Eye("part", 0j, 4.0), f.Faces("part", 0j, 0.0, 4.0)
FEATURES = (
    f.PinEyes("pin", EYE, EYE, EYE, (f.Ring("part", 3.0, 9.0),)),
    f.SlideFaces("slide", FACES, FACES),
    f.SlotFaces("slot", FACES, EYE),
    f.CamOutline(
        "cam",
        "part",
        "pin",
        "pin",
        f.Flat("part", 0j, 0.0, 4.0),
        bore=EYE,
        own=f.OwnTip("part", EYE, EYE),
        roller="part",
    ),
    f.GearTeeth("gear", f.Teeth("part", 9, 9.0, 1.0), f.Teeth("part", 9, 9.0, 1.0), ("pin", "pin")),
    f.EngagedPair(
        "cam", (f.Edge("part", EYE),), (f.Edge("part", EYE, EYE),), "pin", "pin", 0.1, (), 6.0
    ),
    f.PawlPair(
        "cam",
        (f.Edge("part", EYE),),
        (f.Edge("part", EYE),),
        "pin",
        "pin",
        1,
        12,
        0.0,
        1.0,
        0.1,
        0.2,
    ),
    f.Mark(EYE),
    f.SharedFlat(EYE, EYE, 0.0),
    f.Steady("pin", EYE, EYE, EYE, (EYE, EYE)),
)


def names(record: Any) -> list[str]:
    """Every text in a record, however deep; units aside, and what a spec calls a track."""
    found: list[str] = []
    values = (
        record
        if isinstance(record, tuple)
        else [
            getattr(record, field.name)
            for field in fields(record)
            if field.name not in ("unit", "closure", "track")
        ]
    )
    for value in values:
        if isinstance(value, str):
            found.append(value)
        elif isinstance(value, tuple) or hasattr(value, "__dataclass_fields__"):
            found += names(value)
    return found


@pytest.mark.parametrize(
    "record", [*JOINTS.values(), *MACHINE.drives, *LOADS.values(), *OUTPUTS.values(), *FEATURES]
)
def test_every_name_in_a_record_is_given_the_prefix_in_a_larger_machine(record: Any) -> None:
    before, after = names(record), names(Module("left").renamed(record))
    given = [a if a == GROUND else f"left-{a}" if a == "part" else f"left_{a}" for a in before]
    assert before and after == given
    assert {type(each) for each in FEATURES} == set(get_args(f.Feature))
