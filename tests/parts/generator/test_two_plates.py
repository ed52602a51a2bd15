"""Two plates and an interrupted shaft: built to files and green, what they hold by closed forms; damage to each is found."""

from __future__ import annotations

import math
import re
import shutil
import zipfile
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import tomli_w
from judged import wrong

from camgen.errors import DesignError, SpecError
from camgen.judge.joints import mounts_on_flats
from camgen.judge.measured import MeasuredEye, Readings
from camgen.machine.features import Eye, Mount, SharedFlat, Steady
from camgen.machines.linkage.mechanism import Linkage
from camgen.machines.loads.assess import assess
from camgen.parts.generator.second_plate import ceiling_height
from camgen.pipeline.build import build
from camgen.reading import read
from camgen.spec import validate

TWO = {  # two four-bars on opposite throws
    "mechanism": "linkage",
    "name": "two",
    "drive": {"link": "crank"},
    "points": {
        "O": [0, 0],
        "C": [60, 0],
        "D": [-60, 0],
        "A": [15, 0],
        "Q": [-15, 0],
        "B": [50, 40],
        "E": [-50, 40],
    },
    "links": {
        "ground": ["O", "C", "D"],
        "crank": ["O", "A", "Q"],
        "rod": ["A", "B"],
        "rocker": ["C", "B"],
        "rod2": ["Q", "E"],
        "rocker2": ["D", "E"],
    },
    "output": [{"name": "out", "link": "rocker"}, {"name": "out2", "link": "rocker2"}],
    "parts": {"plates": 2, "shaft": "interrupted"},
}


def linkage(**more: Any) -> Linkage:
    return validate(Linkage, {**TWO, **more})


def made(out: Path, tables: dict[str, Any], kind: str) -> Path:
    (out / "two.toml").write_text(tomli_w.dumps(tables), encoding="utf-8")
    report = build(out / "two.toml", out, frozenset({kind}))
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    return out / "two"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made(tmp_path_factory.mktemp("two"), TWO, "dxf")


@pytest.fixture(scope="module")
def single(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One four-bar, its crank's pin between two webs: swept."""
    points, links = (
        {
            key: value
            for key, value in TWO[name].items()
            if key not in ("D", "Q", "E", "rod2", "rocker2")
        }
        for name in ("points", "links")
    )
    links |= {"ground": ["O", "C"], "crank": ["O", "A"]}
    return made(
        tmp_path_factory.mktemp("one"),
        {**TWO, "points": points, "links": links, "output": TWO["output"][:1]},
        "3mf",
    )


@pytest.mark.long
def test_a_shaft_of_steel_has_crank_pins_of_steel() -> None:
    """All that is the shaft, and its pins are judged as steel; printed, PIN_STRESS names the key for both."""
    parts = dict(TWO["parts"])
    for made, asked in (("turned of steel", {"shaft_made": "steel"}), ("printed", {})):
        machine = linkage(parts={**parts, **asked}, limits={"pin_stress_mpa": 1e-6})
        shaft = {
            part.process
            for part in machine.assembly.parts
            if part.name.startswith(("shaft", "crank-pin"))
        }
        assert shaft == {made} and {
            part.process for part in machine.assembly.parts if part.name.startswith("pin")
        } == {"printed"}
        told = {
            str(f.where): f.message
            for f in assess(machine).findings
            if f.code == "PIN_STRESS" and not f.ok
        }
        assert told and [where for where, said in told.items() if "shaft_made" in said] == [
            where for where in told if where in ("pin O", "pin A", "pin Q") and not asked
        ]
        assert all(
            "parts.pin_diameter" in said
            for where, said in told.items()
            if where in ("pin A", "pin Q")
        )


@pytest.mark.long
def test_shaft_ends_in_webs_that_pins_join(folder: Path) -> None:
    machine = validate(Linkage, read(folder / "spec.toml"))
    layout, parts = machine.bodies.layout, {part.name: part for part in machine.assembly.parts}
    assert layout.webs == {"crank": ("O", "A"), "crank_web2": ("A", "Q"), "crank_web3": ("Q", "O")}
    order = [layout.level[name] for name in ("crank", "rod", "crank_web2", "rod2", "crank_web3")]
    assert order == sorted(set(order))
    over = ceiling_height(layout) + layout.sizes.base_thickness
    ends = {
        mount.part: (mount.z, mount.z + parts[mount.part].thickness)
        for mount in machine.assembly.mounts
    }
    assert ends["shaft"][1] == pytest.approx(layout.top(layout.level["crank"]))
    assert ends["shaft-crank_web3"] == pytest.approx(
        (layout.floor(layout.level["crank_web3"]), over)
    )
    assert ends["second-plate"][1] == pytest.approx(over) and ends["post"] == pytest.approx(
        (5, ceiling_height(layout))
    )
    pins = [
        mount
        for mount in machine.assembly.mounts
        if mount.body == "crank" and mount.part.startswith("crank-pin")
    ]
    assert [mount.at for mount in pins] == pytest.approx([15, -15])
    for mount, (low, high) in zip(
        pins, (("crank", "crank_web2"), ("crank_web2", "crank_web3")), strict=True
    ):
        assert (mount.z, mount.z + parts[mount.part].thickness) == pytest.approx(
            (layout.floor(layout.level[low]), layout.top(layout.level[high]))
        )


@pytest.mark.long
def test_posts_pass_by_all_links(folder: Path) -> None:
    """Nearest to the links' middle lines, as lines through their points, on ten times as many angles."""
    machine = validate(Linkage, read(folder / "spec.toml"))
    second = machine.bodies.layout.second
    assert second is not None and len(second.columns) == 4
    run = machine.run(np.linspace(0, math.tau, 3601), 0)
    for post in second.columns:
        for a, b, radius in (
            ("A", "B", 4.6),
            ("C", "B", 4.6),
            ("Q", "E", 4.6),
            ("D", "E", 4.6),
            ("A", "Q", 4.6),
        ):
            p, q = (
                run.point(next(name for name, held in machine.links.items() if end in held), end)[0]
                for end in (a, b)
            )
            share = np.clip(((post - p) * (q - p).conj()).real / np.abs(q - p) ** 2, 0, 1)
            assert np.min(np.abs(post - p - share * (q - p))) > radius + (2.5 / 2 + 2 + 1.5)


def turned_hole(path: Path, at: complex, degrees: float) -> None:
    """Turn the hole with a flat about its centre."""
    drawing = ezdxf.readfile(path)
    (hole,) = (
        each
        for each in drawing.modelspace().query("LWPOLYLINE")
        if abs(complex(*np.mean(each.get_points("xy"), axis=0)) - at) < 3 and len(each) < 8
    )
    turn = np.exp(1j * math.radians(degrees))
    moved = [at + turn * (complex(x, y) - at) for x, y in hole.get_points("xy")]
    hole.set_points(
        [(z.real, z.imag, bulge) for z, (bulge,) in zip(moved, hole.get_points("b"), strict=True)],
        format="xyb",
    )
    drawing.saveas(path)


def failing(folder: Path, kind: str) -> dict[str, str]:
    return {finding.code: str(finding.where) for finding in wrong(folder, kind)}


@pytest.mark.long
def test_a_web_whose_flat_is_turned_is_found(folder: Path, tmp_path: Path) -> None:
    """By 2 deg: the rod's pin is off by 30 mm x 2 deg, so is the rocker; the shaft's far end is off the axis."""
    shutil.copytree(folder, tmp_path / "two")
    turned_hole(tmp_path / "two" / "two-crank_web2.dxf", 15 + 0j, 2)
    found = failing(tmp_path / "two", "dxf")
    assert {"MOTION_ERROR", "PIN_GAP", "ROUND_TRIP"} <= found.keys()
    assert "out2" in found["MOTION_ERROR"] and found["PIN_GAP"].endswith(", O")


def test_webs_follow_each_others_flats() -> None:
    """A flat that faces 2 deg elsewhere in the second web turns it back by 2 deg about the pin."""
    joint = SharedFlat(Eye("a", 15, 5), Eye("b", 15, 5), math.pi / 2)
    found = Readings({joint.a: MeasuredEye(15.1, 5), joint.b: MeasuredEye(15, 5)})
    found.facing[joint] = math.pi / 2, math.pi / 2 + math.radians(2)
    mount = mounts_on_flats([joint], [Mount("a", "crank"), Mount("b", "crank")], found)[1]
    assert mount.place(15 + 0j) == pytest.approx(15.1)
    assert mount.place(-15 + 0j) == pytest.approx(15.1 - 30 * np.exp(-1j * math.radians(2)))


@pytest.mark.long
def test_the_far_end_of_a_shaft_off_its_axis_is_a_misfit(folder: Path, tmp_path: Path) -> None:
    shutil.copytree(folder, tmp_path / "two")
    path = tmp_path / "two" / "two-second-plate.dxf"
    drawing = ezdxf.readfile(path)
    (hole,) = (
        each for each in drawing.modelspace().query("CIRCLE") if abs(each.dxf.radius - 3.1) < 1e-6
    )
    hole.dxf.center = (0.03, 0, 0)
    drawing.saveas(path)
    found = {f.code: f for f in wrong(tmp_path / "two", "dxf")}
    assert found["PIN_GAP"].measured == pytest.approx(0.03, abs=1e-6) and str(
        found["PIN_GAP"].where
    ).endswith(", O")


@pytest.mark.long
@pytest.mark.parametrize("what", ["post", "plates"])
def test_a_post_elsewhere_and_plates_that_are_swapped_are_found(
    single: Path, tmp_path: Path, what: str
) -> None:
    shutil.copytree(single, tmp_path / "two")
    path = tmp_path / "two" / "two-assembly.3mf"
    with zipfile.ZipFile(path) as archive:
        files = {name: archive.read(name).decode() for name in archive.namelist()}
    model = next(name for name in files if name.endswith(".model"))
    ids = {
        name: number
        for number, name in re.findall(r'<object id="(\d+)" name="([\w-]+)"', files[model])
    }
    ground, second, post = (
        f'<component objectid="{ids[name]}"' for name in ("ground", "second-plate", "post")
    )
    if what == "plates":
        files[model] = (
            files[model].replace(ground, "@@").replace(second, ground).replace("@@", second)
        )
    else:
        place = re.escape(post) + r' transform="([^"]*) (\S+) (\S+) (\S+)"'
        files[model] = re.sub(place, post + r' transform="\1 5\2 \3 \4"', files[model], count=1)
    with zipfile.ZipFile(path, "w") as archive:
        for name, text in files.items():
            archive.writestr(name, text)
    assert "ROUND_TRIP" in failing(tmp_path / "two", "3mf")


def test_pins_and_the_shafts_upper_end_are_held_by_the_second_plate() -> None:
    machine = linkage()
    (joint,) = (
        each
        for each in machine.assembly.features
        if isinstance(each, Steady) and each.webs is not None
    )
    assert joint.far.part == "second-plate" and joint.pin.part == "shaft-crank_web3"
    assert {each.joint for each in machine.assembly.features if isinstance(each, Steady)} == {
        "O",
        "C",
        "D",
    }


@pytest.mark.long
def test_the_walker_has_nine_levels_and_pins_in_both_plates(root: Path) -> None:
    machine = validate(Linkage, read(root / "specs" / "four-leg-walker.toml"))
    layout = machine.bodies.layout
    assert max(layout.level.values()) == 9 and layout.second is not None
    low, high = layout.level["crank"], layout.level["crank_web3"]
    crossing = [layout.level[name] for name in ("conn1", "conn2", "conn3", "conn4")]
    assert low < min(crossing) and max(crossing) < high
    assert {"O"} <= layout.second.cuts.keys() and "A" not in layout.second.cuts


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (
            {"links": {**TWO["links"], "crank": ["O", "A"], "crank_web2": ["Q", "E"]}},
            "links.crank_web2",
        ),
        ({"points": {**TWO["points"], "Q": [15, 0]}}, "lie at one place"),
        ({"parts": {"plates": 2, "mount_diameter": 2.2}}, "parts.mount_diameter"),
        ({"parts": {"plates": 2, "base_thickness": 2}}, "parts.base_thickness"),
        ({"links": {"ground": ["O", "C"], "crank": ["O"], "rocker": ["C", "B"]}}, "parts.shaft"),
    ],
)
def test_what_cannot_be_is_told_by_its_key(more: dict[str, Any], said: str) -> None:
    with pytest.raises(SpecError) as caught:
        linkage(**more)
    assert any(said in str(fault) for fault in caught.value.faults)


def test_no_dowel_for_both_plates_is_told() -> None:
    """They are sold up to 32, then 35 long; 34.2 it is from plate to plate, of which the upper is 4."""
    with pytest.raises(
        DesignError, match="no dowel of 5 mm is sold between 32.2 and 34.2 mm long, .*parts.pins.C"
    ):
        _ = linkage(
            parts={**TWO["parts"], "pins": {"C": "dowel"}, "thickness": 5, "base_thickness": 4}
        ).assembly


def test_a_crank_pin_is_of_no_other_kind() -> None:
    with pytest.raises(DesignError, match="joins webs"):
        _ = linkage(parts={**TWO["parts"], "pins": {"A": "dowel"}}).assembly
