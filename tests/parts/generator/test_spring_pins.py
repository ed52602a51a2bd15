"""What sits on a pin under the eye of a spring has no room to climb off what it runs on: by heights of the assembly."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import camgen
from camgen.machines.mechanism import Mechanism
from camgen.parts.assembly import order_of_assembly
from camgen.parts.coils import spring_sketches
from camgen.pipeline.shown import animation

DISC = (
    {"kind": "rise", "span_deg": 180, "law": "cycloidal"},
    {"kind": "return", "span_deg": 180, "law": "cycloidal"},
)


def bench(**tables: Any) -> Mechanism:
    """A cam under the roller of an arm."""
    segments = [{**DISC[0], "lift": 12}, {**DISC[1], "to": 0}]
    follower = {
        "motion": "oscillating",
        "shape": "roller",
        "radius": 5,
        "pivot_distance": 60,
        "arm": 50,
    }
    return camgen.load(
        {
            "mechanism": "disc-cam",
            "name": "own",
            "geometry": {"closure": "force", "follower": follower},
            "segment": segments,
            "motor": {"speed_rpm": 60},
            "limits": {"pressure_angle_deg": 45},
            **tables,
            "parts": {"make": "printed", **tables.get("parts", {})},
        }
    )


def own_linkage() -> Mechanism:
    """A rocker on a disc, its roller's pin drawn to the ground."""
    segments = [{**each, "lift_deg": 20} for each in DISC]
    return camgen.load(
        {
            "mechanism": "linkage",
            "name": "own",
            "drive": {"link": "disc", "speed_rpm": 60},
            "points": {"O": [0, 0], "C": [60, 0], "T": [30, 35], "S": [-60, -20]},
            "links": {"ground": ["O", "C", "S"], "disc": ["O"], "rocker": ["C", "T"]},
            "cam": [
                {"cam": "disc", "follower": "rocker", "at": "T", "radius": 5, "segment": segments}
            ],
            "spring": [{"between": ["T", "S"], "rate": 0.2, "preload": 6.0}],
            "output": [{"name": "a", "link": "rocker"}],
        }
    )


def including() -> Mechanism:
    """A four-bar with the cam on its bench beside it."""
    return camgen.load(
        {
            "mechanism": "linkage",
            "name": "host",
            "drive": {"link": "crank", "speed_rpm": 60},
            "points": {"O": [0, 0], "C": [70, 0], "A": [20, 0], "B": [60, 45]},
            "links": {
                "ground": ["O", "C"],
                "crank": ["O", "A"],
                "coupler": ["A", "B"],
                "rocker": ["C", "B"],
            },
            "output": [{"name": "a", "link": "rocker"}],
            "include": [
                {"spec": bench().model_dump(by_alias=True, exclude_none=True), "at": [200, 0]}
            ],
        }
    )


def spans(machine: Mechanism, body: str, at: complex) -> dict[str, list[tuple[float, float]]]:
    """Heights of the rollers and spacers there, by the kind of part; "head": underside and top of a pin's head or its cap."""
    parts, found = (
        {part.name: part for part in machine.assembly.parts},
        dict[str, list[tuple[float, float]]](),
    )
    for mount in machine.assembly.mounts:
        part, kind = parts[mount.part], mount.part.partition("-")[0]
        if (
            mount.body != body
            or abs(mount.at - at) > 1e-9
            or kind not in ("roller", "spacer", "pin", "cap")
        ):
            continue
        low, high = mount.z, mount.z + part.thickness
        if kind == "pin" and mount.flipped:
            found["head"] = [(high - part.layers[0].z1, high)]
        found.setdefault("head" if kind == "cap" else kind, []).append((low, high))
    return found


@pytest.mark.parametrize(
    "machine",
    [
        bench(),
        bench(parts={"pin": "dowel"}),
        bench(parts={"make": "laser"}, laser={"thickness": 3.0}),
        own_linkage(),
    ],
    ids=["printed", "dowel", "laser", "linkage"],
)
def test_a_roller_under_a_spring_cannot_climb_off_its_cam(machine: Mechanism) -> None:
    """Up to the head spacers fill it, but for the wire of the eye and plays."""
    (roller,) = (mount for mount in machine.assembly.mounts if mount.part.startswith("roller"))
    (cam,) = (mount for mount in machine.assembly.mounts if mount.part.startswith("cam-"))
    stack = spans(machine, roller.body, roller.at)
    ((low, top),), ((head, _),) = stack["roller"], stack["head"]
    assert low == pytest.approx(cam.z)
    ends = [top, *(z for span in sorted(stack["spacer"]) for z in span), head]
    assert len(ends) > 2 and ends == sorted(ends)
    room = sum(high - under for under, high in zip(ends[::2], ends[1::2], strict=True))
    assert room < (top - low) / 2, "with or without the spring's eye it stays on"


@pytest.mark.parametrize(
    "machine",
    [bench(), bench(parts={"pin": "dowel"}), own_linkage(), including()],
    ids=["bench", "dowel", "linkage", "included"],
)
def test_a_spring_comes_before_the_heads_that_are_wider_than_its_eyes(machine: Mechanism) -> None:
    """Its eyes are 1.1 pins wide, the heads of a pin of 5 are 8: what of pins and caps ends above the eyes comes later."""
    table, parts, number = (
        order_of_assembly(machine.assembly),
        {part.name: part for part in machine.assembly.parts},
        Counter[str](),
    )
    (step,) = (k for k, row in enumerate(table.rows) if row[1] == "extension spring")
    eye, over = float(str(table.rows[step][5])), set()
    for mount in machine.assembly.mounts:
        number[mount.part] += 1
        kind = mount.part.removeprefix("own-") if machine.name == "host" else mount.part
        if kind == mount.part and machine.name == "host":
            continue  # the four-bar's own
        headed = kind.startswith("cap") or kind.startswith("pin") and mount.flipped
        if headed and mount.z + parts[mount.part].thickness > eye:
            over.add(f"{mount.part}-{number[mount.part]}")
    before = {copy for each in table.steps[:step] for copy in each.copies}
    assert (
        len(over) == 2
        and not over & before
        and over <= {copy for each in table.steps[step:] for copy in each.copies}
    )
    assert [row[0] for row in table.rows] == list(range(1, len(table.rows) + 1))


@pytest.mark.parametrize("machine", [bench(), including()], ids=["bench", "included"])
def test_the_step_of_a_spring_shows_its_wire_round_both_pins_as_far_apart_as_it_says(
    machine: Mechanism,
) -> None:
    """Where pins with heads up stand at theta = 0, from the poses of the parts."""
    table = order_of_assembly(machine.assembly)
    (number,) = (k for k, row in enumerate(table.rows) if row[1] == "extension spring")
    wire = table.steps[number].wire
    (coil,) = machine.assembly.coils
    poses = machine.assembly.poses(np.zeros(1))
    pins = []
    for copy in (copy for end in coil.heads for copy in end):
        name, _, count = copy.rpartition("-")
        pins.append(complex(poses[name][int(count) - 1].place[0]))
    a, b = pins
    assert wire is not None and wire.shape[1] == 3
    flat = wire[:, 0] + 1j * wire[:, 1]
    radius = coil.diameter / 2
    turn = 24
    np.testing.assert_allclose(abs(flat[: turn + 1] - a), radius, rtol=1e-9)
    np.testing.assert_allclose(abs(flat[-turn - 1 :] - b), radius, rtol=1e-9)
    for eye, pin in ((flat[: turn + 1], a), (flat[-turn - 1 :], b)):
        assert abs(np.sum(np.angle((eye[1:] - pin) / (eye[:-1] - pin)))) == pytest.approx(2 * np.pi)
    way = (b - a) / abs(b - a)
    aside = np.hypot(((flat - a) / way).imag, wire[:, 2] - coil.height)
    assert aside.max() == pytest.approx(radius), "the coils are as wide as it is"
    assert 2 * radius == pytest.approx(np.ptp(wire[:, 2]), rel=0.02)
    assert f"; {abs(b - a):.4g} mm from pin to pin" in table.steps[number].title
    said = [step.title for step in table.steps[number + 1 :] if "eye of the" in step.title]
    first, other = (title.rpartition(" through ")[2].removesuffix(".") for title in said)
    assert first.startswith("an eye of the extension spring")
    assert other.endswith(f": stretch it to {abs(b - a):.4g} mm")
    assert [row[3] for row in table.rows[number + 1 :] if str(row[3]).endswith(other)]


def test_both_pins_of_a_step_go_through_both_eyes() -> None:
    (coil,) = bench().assembly.coils
    (one,), (other,) = coil.heads
    assert coil.through([one, other], [], 70.0).endswith("stretched to 70 mm")
    assert coil.through([one], [], 70.0).startswith("through an eye")
    assert coil.through([other], [one], 70.0).startswith("through the other eye")
    assert coil.through(["ground-1"], [one], 70.0) == ""
    assert replace(coil, capped=True).through([one], [], 70.0) == ""


def test_springs_are_drawn_between_their_pins() -> None:
    """From the pin in the ground to that of the follower, at their height; of an included machine where it stands."""
    theta, whole, own = np.linspace(0, 6, 7), including(), bench()
    (drawn,), (there,) = (
        spring_sketches(own.assembly.coils, own.assembly.courses),
        spring_sketches(whole.assembly.coils, whole.assembly.courses),
    )
    assert (
        drawn.course is not None
        and there.course is not None
        and drawn.z is not None
        and there.z is not None
    )
    line = drawn.course(theta)
    spring = own.assembly.springs["return spring"]
    assert spring is not None and np.ptp(line[:, 0]) == 0
    inside = np.abs(line[:, -1] - line[:, 0]) + own.sizes.pin_diameter  # type: ignore[attr-defined]
    assert spring.shortest - 1e-6 < inside.min() < inside.max() < spring.longest + 1e-6
    assert np.ptp(inside) > 0.5 * (spring.longest - spring.shortest)
    np.testing.assert_allclose(there.course(theta), line + 200, atol=1e-9)
    tops = [mount.z for mount in whole.assembly.mounts if mount.part.startswith("own-")]
    assert there.z - drawn.z == pytest.approx(
        min(tops) - min(mount.z for mount in own.assembly.mounts)
    )
    assert "return_spring" in [body.name for body in animation(own).bodies]


def test_coils_lie_clear_of_what_is_beneath() -> None:
    """Of the cam and the roller, where the eye has sunk onto its spacer: by as much as all that slides."""
    own = bench()
    mounted, parts = (
        own.assembly.springs["return spring"],
        {part.name: part for part in own.assembly.parts},
    )
    assert mounted is not None
    tops = {mount.part: mount.z + parts[mount.part].thickness for mount in own.assembly.mounts}
    eye = max(top for name, top in tops.items() if name.startswith("spacer"))
    beneath = max(top for name, top in tops.items() if name.startswith(("cam", "roller")))
    spring = mounted.spring
    assert (
        eye + spring.wire / 2 - spring.outside / 2 - beneath >= 0.2 - 1e-9
    )  # print.slide_clearance
