"""Kinds of pins and the hand crank: built to files and green, their sizes those of the standards, damage found."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from judged import forget, judged, wrong

from camgen.errors import DesignError, SpecError
from camgen.geometry.arcs import bulges
from camgen.geometry.outlines import circle
from camgen.geometry.rings import Ring, Shape
from camgen.judge import joints
from camgen.judge.measured import measure
from camgen.machine.features import Eye, PinEyes, SlotFaces
from camgen.machines.linkage.mechanism import Linkage
from camgen.parts.assembly import order_of_assembly
from camgen.parts.catalogue import Bearing
from camgen.pipeline.build import build
from camgen.pipeline.making import parts_table
from camgen.pipeline.shopping import steps_of_assembly
from camgen.reading import read
from camgen.spec import validate
from camgen.starters import in_metal
from camgen.study import sentences

# ISO 7379: shoulder -> thread, head's diameter and height, thread's length, mm [BOSL2, screws.scad].
SHOULDERS = {6.5: (5, 10, 4.5, 9.5), 8: (6, 13, 5.5, 11), 10: (8, 16, 7, 13), 13: (10, 18, 9, 16)}


def made(root: Path, folder: Path, *sets: str, kind: str = "3mf") -> Linkage:
    report = build(root / "specs" / "linkage.toml", folder, frozenset({kind}), list(sets))
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    return validate(Linkage, read(folder / "linkage" / "spec.toml"))


def with_parts(root: Path, **parts: Any) -> Linkage:
    return validate(Linkage, {**read(root / "specs" / "linkage.toml"), "parts": parts})


@pytest.mark.long
@pytest.mark.parametrize("diameter", [5.0, 8.0])
def test_shoulder_screws_are_those_of_the_standard(
    root: Path, tmp_path: Path, diameter: float
) -> None:
    sets = ["parts.pin=shoulder", f"parts.pin_diameter={diameter:g}", "parts.thickness=5"]
    machine = made(root, tmp_path, *sets)
    shoulder = min(size for size in SHOULDERS if size >= diameter)
    thread, head, high, long = SHOULDERS[shoulder]
    screws = [part for part in machine.assembly.parts if part.name.startswith("pin")]
    nuts = [part for part in machine.assembly.parts if part.name.startswith("nut")]
    assert sum(part.count for part in screws) == sum(part.count for part in nuts) == 3
    for part in screws:
        wide = [2 * float(np.abs(layer.region.outer.pieces[0].at(0.0))) for layer in part.layers]
        assert wide == [head, shoulder, thread] and part.process == "bought"
        assert part.layers[0].z1 == high and part.thickness - part.layers[1].z1 == long
        assert part.layers[1].z1 - part.layers[1].z0 in (10, 12, 16, 20, 25, 30)


@pytest.mark.long
def test_bearings_turn_in_all_links_but_one_of_each_joint(root: Path, tmp_path: Path) -> None:
    """MR85 is 5 x 8 x 2.5: ISO 15."""
    machine = made(root, tmp_path, "parts.pin=bearing")
    (ring,) = (part for part in machine.assembly.parts if part.name.startswith("bearing"))
    assert (ring.name, ring.count, ring.thickness, ring.bore) == ("bearing-mr85", 3, 2.5, 5)
    rocker = next(part for part in machine.assembly.parts if part.name == "rocker")
    holes = sorted(math.sqrt(4 * abs(hole.area) / math.pi) for hole in rocker.region.holes)
    assert holes[-1] == pytest.approx(8, abs=1e-9)
    assert [machine.model.joint(name).clearance for name in "ABC"] == [
        0,
        0,
        0,
    ]  # both press fits
    plain = with_parts(root)
    assert [plain.model.joint(name).clearance for name in "ABC"] == pytest.approx([0.2, 0.2, 0.2])


def rise(
    machine: Linkage, name: str = "bearing-mr85", shoulder: float = 5.75, width: float = 2.5
) -> dict[tuple[str, int], float]:
    """How far each link with a bearing can rise until its lip, the outer ring, the inner ring and the pin's head meet, mm; inf
    where the lip is no narrower than the outer ring, or the head no wider than the bore."""
    parts = {part.name: part for part in machine.assembly.parts}
    links = {mount.body: mount for mount in machine.assembly.mounts if mount.part == mount.body}
    poses, found = machine.assembly.poses(np.zeros(1)), dict[tuple[str, int], float]()
    outside = 2 * float(np.max(np.abs(parts[name].region.outer.pieces[0].at(0.0))))
    for k, mount in enumerate(mount for mount in machine.assembly.mounts if mount.part == name):
        link, place = links[mount.body], poses[name][k].place[0]
        pins = [
            (pose, parts[pin]) for pin in parts if pin.startswith("pin-") for pose in poses[pin]
        ]
        pose, pin = min(pins, key=lambda each: abs(each[0].place[0] - place))
        under = [layer for layer in parts[link.part].layers if link.z + layer.z1 <= mount.z + 1e-9]
        holes = [
            hole
            for layer in under
            for hole in layer.region.holes
            if abs(hole.centroid - mount.at) < 1e-6
        ]
        lips = [math.sqrt(4 * abs(hole.area) / math.pi) for hole in holes]
        head = math.sqrt(4 * pin.layers[0].region.area / math.pi)
        assert (
            pose.flipped and head <= shoulder + 1e-9
        )  # turned over, its head is above, on the inner ring alone
        holds = lips and shoulder < min(lips) < outside - 0.1 and head > 5
        found[link.part, k] = (
            pose.z + pin.thickness - pin.layers[0].z1 - (mount.z + width) if holds else math.inf
        )
    return found


def test_a_bearing_holds_its_link_down(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MR85, 2.5 wide, in a link of 4: over it a play of 0.2, under it a lip of 1.3, of the bore (5 + 8) / 2."""
    machine = with_parts(root, pin="bearing")
    rocker = next(part for part in machine.assembly.parts if part.name == "rocker")
    assert [(layer.z0, layer.z1) for layer in rocker.layers] == [
        (0, 1.3),
        (1.3, 4),
    ] and rocker.drawn_layer == 1
    sizes = [
        [math.sqrt(4 * abs(hole.area) / math.pi) for hole in layer.region.holes]
        for layer in rocker.layers
    ]
    assert max(sizes[0]) == pytest.approx(6.5) and max(sizes[1]) == pytest.approx(8)
    assert any("pressed in from above, down on the lip: MR85" in note for note in rocker.notes)
    ways = rise(machine)
    assert len(ways) == 3 and list(ways.values()) == pytest.approx([0.2] * 3)
    monkeypatch.setattr(Bearing, "lip", property(lambda self: self.outside))  # straight through
    assert set(rise(with_parts(root, pin="bearing")).values()) == {math.inf}


def test_in_metal_a_pin_clamps_inner_rings_on_sleeves_and_no_link_rubs(root: Path) -> None:
    """From below: the link in which the pin is fixed, a sleeve, the inner ring, the head. 695's ring, 5 x 13, bears on 7 at most, so
    that a sleeve on a pin of 5 has a wall of 1, its lip is 9 wide; between the links is a play of 0.2, whatever their thickness."""
    machine = validate(Linkage, tomllib.loads(in_metal("linkage")))
    parts = {part.name: part for part in machine.assembly.parts}
    copies = {(each.part, each.at): each for each in machine.assembly.mounts}
    (sleeve,) = (part for part in parts.values() if part.role == "sleeve")
    assert (sleeve.count, sleeve.bore, sleeve.region.area) == (
        3,
        5,
        pytest.approx(math.pi / 4 * (7**2 - 5**2)),
    )
    heights = {
        (mount.body, round(mount.z, 6), round(mount.z + parts[mount.part].thickness, 6))
        for mount in machine.assembly.mounts
        if mount.part == sleeve.name
    }
    links = {each.body: each for each in copies.values() if each.part == each.body}
    tops = {name: links[name].z + parts[name].thickness for name in ("ground", "crank", "rocker")}
    rings = sorted({each.z for each in machine.assembly.mounts if each.part == "bearing-695"})
    assert heights == {
        ("ground", round(tops["ground"], 6), round(rings[0], 6)),
        ("crank", round(tops["crank"], 6), round(rings[1], 6)),
        ("rocker", round(tops["rocker"], 6), round(rings[1], 6)),
    }
    assert links["coupler"].z - tops["crank"] == pytest.approx(0.2)
    assert list(rise(machine, "bearing-695", 7.0, 4.0).values()) == pytest.approx([0.0] * 3)
    steps = [sentences(step.doings) for step in order_of_assembly(machine.assembly).steps]
    assert any("its head down on bearing-695" in each for each in steps)
    assert not any(f"into {sleeve.name}" in each for each in steps)  # nothing glues it
    told = [sentences(step.doings) for step in steps_of_assembly(machine).steps]
    assert any("put it in the hole under that alone" in each for each in told)
    assert sum("on its outer ring alone" in each for each in told) == 2
    assert not any(part.role == "sleeve" for part in with_parts(root, pin="bearing").assembly.parts)


def test_a_bearing_is_pressed_in_before_its_link_goes_on(root: Path) -> None:
    machine = with_parts(root, pin="bearing")
    steps = [(row[1], str(row[3])) for row in order_of_assembly(machine.assembly).rows]
    names = [name for name, _ in steps]
    assert names.count("bearing-mr85") >= 1
    assert all(", glued into " in where for name, where in steps if name.startswith("pin-"))
    for k, (name, where) in enumerate(steps):  # from above, since the lip is under it
        if name == "bearing-mr85":
            link = where.partition(",")[0].rpartition(" ")[2]
            assert where.startswith("pressed into") and link == names[k - 1]
            assert where.endswith(", from above, down on the lip")
            assert names[k + 1] in ("bearing-mr85", link), "then the link goes on with it"
    rows = {str(row[1]): row for row in parts_table(machine).rows}
    assert "5 x 8 x 2.5" in str(rows["bearing-mr85"][2]) and rows["bearing-mr85"][4] == ""
    assert "glue" in rows and str(rows["screw of the plate, from behind"][2]).startswith(
        "M3, for a core hole of 2.5"
    )


def test_a_head_little_wider_than_its_pin_is_not_taken_for_it() -> None:
    sections = [[Shape(Ring(*bulges(circle(0j, size / 2))), ())] for size in (5.0, 5.02, 5.75)]
    found = measure(Eye("pin-1", 0j, 5.0, True), sections)
    assert found is not None and found.diameter == pytest.approx(5.02, abs=1e-9)


@pytest.mark.long
def test_a_bearing_for_the_shaft(root: Path, tmp_path: Path) -> None:
    machine = made(root, tmp_path, "parts.pins.O=bearing", "parts.base_thickness=6")
    (mount,) = (mount for mount in machine.assembly.mounts if mount.part == "bearing-626")
    assert mount.body == "ground" and mount.at == 0


@pytest.mark.long
def test_a_seat_that_is_too_wide_and_rings_that_are_not_counted_are_found(
    root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made(root, tmp_path, "parts.pin=bearing", kind="dxf")
    folder = tmp_path / "linkage"
    document = ezdxf.readfile(folder / "linkage-rocker.dxf")
    seat = max(
        (circle for circle in document.modelspace().query("CIRCLE")),
        key=lambda circle: circle.dxf.radius,
    )
    assert seat.dxf.radius == 4
    seat.dxf.radius = 4.02
    document.saveas(folder / "linkage-rocker.dxf")
    found = {finding.code: finding for finding in wrong(folder, "dxf")}
    assert found["PIN_GAP"].measured == pytest.approx(0.04, abs=2e-3)
    seat.dxf.radius = 4
    document.saveas(folder / "linkage-rocker.dxf")
    sound = judged(folder, "dxf").findings
    assert "PIN_GAP" not in {finding.code for finding in sound if not finding.ok}
    lash = {finding.code: finding for finding in sound}["LASH"].measured
    forget()
    monkeypatch.setattr(
        joints, "sum", lambda rings: 0.0, raising=False
    )  # as if a pin had all of the seat to itself
    assert {finding.code: finding for finding in judged(folder, "dxf").findings}[
        "LASH"
    ].measured > lash + 1


@pytest.mark.parametrize(
    ("parts", "error", "said"),
    [
        ({"pins": {"X": "bearing"}}, SpecError, "parts.pins.X"),
        ({"pins": {"P": "bearing"}}, DesignError, "parts.pins.P: no link turns there"),
        ({"pins": {"O": "shoulder"}}, DesignError, "parts.pins.O: it is a shaft"),
        (
            {"pins": {"O": "bearing"}, "motor": "nema-17", "shaft_diameter": 5},
            DesignError,
            "pins.O: it is the motor",
        ),
        (
            {"pins": {"O": "bearing"}},
            DesignError,
            "parts.base_thickness is 5 mm.*limit: at least 6 mm.*626",
        ),
        (
            {"pin": "bearing", "coupler": {"thickness": 2}},
            DesignError,
            "thickness is 2 mm.*limit: at least 3.5 mm.*MR85.*lip of 0.8",
        ),
        (
            {"pin": "bearing", "bearing": "608"},  # a bore of 8
            SpecError,
            "parts.bearing.*a bore of 5 mm: MR85, MR105, 695, 625",
        ),
        (
            {"pin": "bearing", "bearing": "608"},  # a bore of 8
            SpecError,
            "parts.bearing.*a bore of 5 mm: MR85, MR105, 695, 625",
        ),
        (
            {"pin": "bearing", "pin_diameter": 4.5},
            DesignError,
            "parts.pin_diameter is 4.5 mm.*3, 4, 5, 6, 8",
        ),
        ({"pin": "shoulder", "pin_diameter": 14}, SpecError, "parts.pin_diameter.*at most 13"),
        (
            {"pin": "shoulder", "base_thickness": 40, "thickness": 2, "head": 1},
            DesignError,
            'shoulder screw.*mended by parts.pin = "printed"',
        ),
        ({"hand_crank": 5}, SpecError, "parts.hand_crank.*at least 15 mm"),
        (
            {"hand_crank": 40, "shaft_length": 8},
            SpecError,
            "parts.shaft_length.*at least 10 mm.*hand crank",
        ),
        (
            {"hand_crank": 40, "motor": "nema-17", "shaft_diameter": 5},
            SpecError,
            "parts.hand_crank.*nema-17 already drives",
        ),
    ],
)
def test_pins_and_cranks_that_cannot_be(
    root: Path, parts: dict[str, Any], error: type[Exception], said: str
) -> None:
    with pytest.raises(error, match=said):
        _ = with_parts(root, **parts).assembly


@pytest.mark.long
def test_a_hand_crank_turns_with_the_shaft(root: Path, tmp_path: Path) -> None:
    """Its knob goes round the shaft with the crank, in the list, in the assembly and in place of a bought drive."""
    machine = made(root, tmp_path, "parts.hand_crank=40")
    theta = np.linspace(0, math.tau, 17)
    (knob,) = machine.assembly.poses(theta)["knob"]
    assert np.max(np.abs(knob.place - 40 * np.exp(1j * theta))) < 1e-9
    listed = (tmp_path / "linkage" / "linkage-parts.csv").read_text(encoding="utf-8")
    assert (
        all(name in listed for name in ("hand-crank,", "knob,", "knob-pin,"))
        and "drive" not in listed
    )
    steps = [row[1] for row in order_of_assembly(machine.assembly).rows]
    assert {"hand-crank", "knob", "knob-pin"} <= {str(step) for step in steps}
    heights = {
        mount.part: (
            mount.z,
            mount.z
            + next(part for part in machine.assembly.parts if part.name == mount.part).thickness,
        )
        for mount in machine.assembly.mounts
        if mount.part in ("hand-crank", "knob", "knob-pin", "shaft", "collar")
    }
    assert (
        heights["hand-crank"][0] == heights["shaft"][0]
        and heights["hand-crank"][1] < heights["collar"][0]
    )
    plate = next(part for part in machine.assembly.parts if part.name == "ground")
    screws = [z for z in plate.centres if z not in dict(plate.points).values()]
    assert (
        len(screws) == 2 and min(map(abs, screws)) > 40 + 5 + 1.5 + 2.5 / 2
    )  # beside the way of the knob, 13 wide
    assert heights["knob"][1] < heights["hand-crank"][0] and heights["knob-pin"][
        1
    ] == pytest.approx(heights["hand-crank"][1])


@pytest.mark.parametrize(
    ("spec", "link"), [("quick-return", "rod"), ("gallery/scotch-yoke", "yoke")]
)
def test_a_link_is_no_shaft_by_its_name(root: Path, spec: str, link: str) -> None:
    """Its joints are measured on the same pins, whatever it is called."""

    def called(value: Any, name: str) -> Any:
        if isinstance(value, dict):
            return {name if key == link else key: called(each, name) for key, each in value.items()}
        if isinstance(value, list):
            return [called(each, name) for each in value]
        return name if value == link else value

    def pins(name: str) -> list[str]:
        made = validate(Linkage, called(read(root / "specs" / f"{spec}.toml"), name)).assembly
        found = [each for each in made.features if isinstance(each, PinEyes | SlotFaces)]
        return [each.pin.part for each in found if each.pin is not None and each.pin.part]

    assert pins("shaft2") == pins(link) and len(pins(link)) > 2
