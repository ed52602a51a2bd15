"""Linkages built to files, each green, its motion from the files against a closed form; damaged files are found out."""

from __future__ import annotations

import math
import re
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import tomli_w
from judged import wrong

from camgen.errors import DesignError, SpecError
from camgen.machines.linkage.mechanism import Linkage
from camgen.machines.sources import read_mechanism
from camgen.pipeline.build import build
from camgen.reading import read
from camgen.spec import validate

Floats = np.ndarray
DWELLS = [
    {"kind": "rise", "span_deg": 120, "law": "cycloidal"},
    {"kind": "dwell", "span_deg": 60},
    {"kind": "return", "span_deg": 120, "law": "cycloidal"},
    {"kind": "dwell", "span_deg": 60},
]

YOKE = {
    "points": {"O": [0, 0], "R": [50, 0], "A": [20, 0], "D": [20, -30], "E": [20, 30]},
    "links": {"ground": ["O", "R"], "crank": ["O", "A"], "yoke": ["D", "E"]},
    "slide": [{"link": "yoke", "along": ["O", "R"]}],
    "slot": [{"pin": "A", "link": "yoke", "along": ["D", "E"]}],
    "output": [{"name": "out", "link": "yoke"}],
}
CYLINDER = {
    "points": {"O": [0, 0], "C": [80, 0], "A": [20, 0], "X": [60, 0]},
    "links": {"ground": ["O", "C"], "crank": ["O", "A"], "rod": ["A"], "cylinder": ["C", "X"]},
    "slide": [{"link": "rod", "on": "cylinder", "along": ["C", "X"]}],
    "output": [{"name": "out", "link": "cylinder"}],
}

GEARED = {
    "points": {"O": [0, 0], "A": [20, 0], "C": [60, 0], "B": [70, 0]},
    "links": {"ground": ["O", "C"], "crank": ["O", "A"], "drum": ["C", "B"]},
    "gear": [{"a": "crank", "b": "drum", "ratio": -2}],
    "output": [{"name": "out", "link": "drum"}],
}
FIVE_BAR = {  # two cranks that turn against each other: their common point stays on the middle line
    "points": {"O": [0, 0], "C": [60, 0], "A": [20, 0], "B": [40, 0], "P": [30, 60]},
    "links": {
        "ground": ["O", "C"],
        "crank": ["O", "A"],
        "other": ["C", "B"],
        "left": ["A", "P"],
        "right": ["B", "P"],
    },
    "lengths": {"A-P": 70, "B-P": 70},
    "gear": [{"a": "crank", "b": "other", "ratio": -1}],
    "output": [{"name": "out", "point": "P"}],
    "limits": {"transmission_angle_deg": 15},
}


def without_none(table: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in table.items() if value is not None}


def cam_rocker(**cam: Any) -> dict[str, Any]:
    rows = [
        {
            **row,
            **(
                {"lift_deg": 15}
                if row["kind"] == "rise"
                else {"to_deg": 0}
                if row["kind"] == "return"
                else {}
            ),
        }
        for row in DWELLS
    ]
    return {
        "points": {"O": [0, 0], "A": [15, 0], "C": [60, 0], "T": [30, 25]},
        "links": {"ground": ["O", "C"], "crank": ["O", "A"], "rocker": ["C", "T"]},
        "cam": [
            without_none(
                {
                    "cam": "crank",
                    "follower": "rocker",
                    "at": "T",
                    "radius": 6,
                    "segment": rows,
                    **cam,
                }
            )
        ],
        "output": [{"name": "out", "link": "rocker"}],
    }


def cam_ram(**cam: Any) -> dict[str, Any]:
    rows = [
        {
            **row,
            **(
                {"lift": 12}
                if row["kind"] == "rise"
                else {"to": 0}
                if row["kind"] == "return"
                else {}
            ),
        }
        for row in DWELLS
    ]
    return {
        "points": {"O": [0, 0], "A": [10, 0], "R": [0, 60], "T": [0, 35]},
        "links": {"ground": ["O", "R"], "crank": ["O", "A"], "ram": ["T"]},
        "slide": [{"link": "ram", "along": ["O", "R"]}],
        "cam": [
            without_none(
                {"cam": "crank", "follower": "ram", "at": "T", "radius": 6, "segment": rows, **cam}
            )
        ],
        "output": [{"name": "out", "link": "ram"}],
    }


def knife_rocker() -> dict[str, Any]:
    tables = cam_rocker(shape="knife", radius=None)
    return {**tables, "points": {**tables["points"], "T": [0, 38], "C": [70, 50]}}


def cycloidal(theta: Floats) -> Floats:
    """Rise, dwell, return, dwell of DWELLS, as a share of the lift; s = u - sin(2 pi u) / 2 pi."""
    degrees = np.degrees(theta) % 360
    u = np.clip(degrees / 120, 0, 1) - np.clip((degrees - 180) / 120, 0, 1)
    return np.asarray(u - np.sin(math.tau * u) / math.tau)


def made(folder: Path, tables: dict[str, Any], *kinds: str, **more: Any) -> Path:
    """The folder of a green build."""
    spec = {
        "mechanism": "linkage",
        "name": "own",
        "drive": {"link": "crank", "speed_rpm": 60},
        **tables,
        **more,
    }
    (folder / "own.toml").write_text(tomli_w.dumps(spec), encoding="utf-8")
    report = build(folder / "own.toml", folder, frozenset(kinds))
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    return folder / "own"


def curves(folder: Path) -> dict[str, Floats]:
    """The columns of motion.csv."""
    head = (folder / "motion.csv").read_text(encoding="utf-8").partition("\n")[0].split(",")
    return dict(
        zip(head, np.loadtxt(folder / "motion.csv", delimiter=",", skiprows=1).T, strict=True)
    )


def failing(folder: Path) -> set[str]:
    return {
        finding.code
        for finding in wrong(
            folder, *{path.suffix[1:] for path in folder.iterdir()} & {"dxf", "stl", "3mf"}
        )
    }


@pytest.mark.long
@pytest.mark.parametrize(
    ("tables", "column", "motion", "within"),
    [
        (YOKE, "out_mm", lambda t: 20 * np.cos(t), 1e-5),
        (
            CYLINDER,
            "out_deg",
            lambda t: 180 - np.degrees(np.arctan2(20 * np.sin(t), 80 - 20 * np.cos(t))),
            1e-5,
        ),
        (
            cam_rocker(),
            "out_deg",
            lambda t: math.degrees(math.atan2(25, -30)) - 15 * cycloidal(t),
            2e-3,
        ),
        (
            cam_rocker(closure="conjugate"),
            "out_deg",
            lambda t: math.degrees(math.atan2(25, -30)) - 15 * cycloidal(t),
            2e-3,
        ),
        (cam_ram(), "out_mm", lambda t: 35 + 12 * cycloidal(t), 1.2e-3),
        (
            cam_rocker(shape="flat", radius=None),
            "out_deg",
            lambda t: math.degrees(math.atan2(25, -30)) - 15 * cycloidal(t),
            2e-3,
        ),
        (
            knife_rocker(),
            "out_deg",
            lambda t: math.degrees(math.atan2(-12, -70)) % 360 - 15 * cycloidal(t),
            2e-3,
        ),
        (cam_ram(shape="flat", radius=None), "out_mm", lambda t: 35 + 12 * cycloidal(t), 1.2e-3),
        (cam_ram(shape="knife", radius=None), "out_mm", lambda t: 35 + 12 * cycloidal(t), 1.2e-3),
        (cam_ram(closure="groove"), "out_mm", lambda t: 35 + 12 * cycloidal(t), 1.2e-3),
    ],
)
def test_motion_from_the_files(
    tmp_path: Path,
    tables: dict[str, Any],
    column: str,
    motion: Callable[[Floats], Floats],
    within: float,
) -> None:
    rows = curves(made(tmp_path, tables, "stl"))
    theta = np.radians(rows["theta_deg"])
    off = rows[f"{column}_stl"] - motion(theta)
    assert np.max(np.abs(off - 360 * np.rint(off / 360))) < within


KNOWN = read(Path(__file__).resolve().parents[1] / "reference" / "linkage_specs.toml")


@pytest.mark.long
@pytest.mark.parametrize("name", KNOWN)
def test_known_linkages_are_built(tmp_path: Path, name: str) -> None:
    kind = (
        "3mf" if name == "ram" else "stl"
    )  # that one is swept, too: it has a cam, a gear and a slide
    rows = curves(made(tmp_path, KNOWN[name], kind))
    for column in (column for column in rows if column.endswith(f"_{kind}")):
        assert np.max(np.abs(rows[column] - rows[column.removesuffix(f"_{kind}")])) < 2.5e-3
    if name == "hoeken":  # nearly straight over half a turn
        low = np.abs(rows["theta_deg"] - 180) <= 90
        assert np.ptp(rows["out_y_mm_stl"][low]) < 0.02 * np.ptp(rows["out_x_mm_stl"][low])
    if name == "ram":
        assert (
            np.max(np.abs(rows["drum_deg_3mf"] - rows["drum_deg_3mf"][0] + 2 * rows["theta_deg"]))
            < 1e-4
        )


def test_jansens_leg_and_peaucelliers_cell_need_few_levels(root: Path) -> None:
    """Jansen: crank and both rods share a pin, so three; two legs on one crank: four rods, so five; Peaucellier: three links on
    each of A, B, Q, P, and a crank."""
    leg = validate(Linkage, read(root / "specs" / "walking-leg.toml"))
    assert max(leg.bodies.layout.given.values()) == 3
    walker = validate(Linkage, read(root / "specs" / "two-leg-walker.toml"))
    assert max(walker.bodies.layout.given.values()) == 5
    cell = validate(Linkage, {"mechanism": "linkage", "name": "own", **KNOWN["peaucellier"]})
    assert max(cell.bodies.layout.given.values()) == 4


@pytest.mark.long
def test_a_geared_five_bar_draws_a_straight_line(tmp_path: Path) -> None:
    rows = curves(made(tmp_path, FIVE_BAR, "3mf"))
    theta = np.radians(rows["theta_deg"])
    assert np.max(np.abs(rows["out_x_mm_3mf"] - 30)) < 1e-4
    assert (
        np.max(
            np.abs(
                rows["out_y_mm_3mf"]
                - 20 * np.sin(theta)
                - np.sqrt(70**2 - (30 - 20 * np.cos(theta)) ** 2)
            )
        )
        < 1e-4
    )


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"ratio": 2}, "link with a wheel between"),
        ({"ratio": -math.pi}, "ratio .*take one of whole teeth"),
        ({"ratio": -97 / 89}, "module"),
        ({"teeth": 21}, "multiple of 2"),
        ({"teeth": 10}, "contact ratio .*use more teeth"),
        ({"teeth": 12, "shift_b": 0.9}, "tooth's tip .*6 teeth"),
        ({"teeth": 60, "shift_b": -0.9}, "shift_b is -0.9 .*at least shift_b = "),
    ],
)
def test_wheels_that_cannot_be(tmp_path: Path, change: dict[str, Any], said: str) -> None:
    with pytest.raises(DesignError, match=said):
        made(tmp_path, {**GEARED, "gear": [GEARED["gear"][0] | change]}, "dxf")


def test_a_ring_hangs_on_dowels_under_its_link_over_the_pinion() -> None:
    """Its rim holds the dowels; it fills its level up to its link, and the pinion runs at its height."""
    spec = {
        "points": {"O": [0, 0], "A": [24, 0]},
        "links": {"ground": ["O", "A"], "pinion": ["A"], "drum": ["O"]},
        "drive": {"link": "pinion"},
        "gear": [{"a": "pinion", "b": "drum", "ratio": "12/36", "inner": True, "name": "pair"}],
        "output": [{"name": "drum", "link": "drum"}],
    }
    assembly = read_mechanism({"mechanism": "linkage", "name": "inner", **spec}).assembly
    mounts = {mount.part: mount for mount in assembly.mounts}
    ring, web = assembly.by_name["gear-pair-drum"], assembly.by_name["drum"]
    dowel = assembly.by_name["dowel-gear-pair-drum"]
    assert dowel.count == 3 and mounts[dowel.name].body == mounts[ring.name].body == "drum"
    low = mounts[ring.name].z
    assert low == mounts["gear-pair-pinion"].z == mounts[dowel.name].z
    assert low + ring.thickness == pytest.approx(mounts[web.name].z)
    assert low + dowel.thickness == pytest.approx(mounts[web.name].z + web.thickness)
    for part in (ring, web):
        holes = [hole for hole in part.drawn.region.holes if abs(hole.centroid) > 1]
        assert len(holes) == 3


@pytest.mark.parametrize("ratio", [-0.4, 2.5])
def test_the_ratio_of_a_ring_is_that_of_a_pinion_in_it(ratio: float) -> None:
    gear = GEARED["gear"][0] | {"ratio": ratio, "inner": True}
    head = {"mechanism": "linkage", "name": "inner", "drive": {"link": "crank"}}
    with pytest.raises(SpecError, match="gear.0.ratio: .*above 0 and below 1"):
        read_mechanism(head | GEARED | {"gear": [gear]})


def test_a_face_that_is_touched_at_its_hinge_and_a_face_in_a_groove_are_refused(
    tmp_path: Path,
) -> None:
    near = cam_rocker(shape="flat", radius=None)
    near["points"] = near["points"] | {"C": [32, 0], "T": [26, 25]}
    with pytest.raises(DesignError, match="place on the face"):
        made(tmp_path, near, "dxf")
    with pytest.raises(DesignError, match="closure of a knife"):
        made(tmp_path, cam_ram(shape="knife", radius=None, closure="groove"), "dxf")


@pytest.mark.long
def test_a_face_that_is_off_is_found(tmp_path: Path) -> None:
    folder = made(tmp_path, cam_ram(shape="flat", radius=None), "dxf")
    bent(folder / "own-ram.dxf", 20j, lambda z: z - 0.03j if z.imag < 1 else z)
    assert "MOTION_ERROR" in failing(folder)


def test_a_cam_that_undercuts_or_is_steep_is_told() -> None:
    def failing_limits(**cam: Any) -> set[str]:
        machine = validate(
            Linkage,
            {"mechanism": "linkage", "name": "own", "drive": {"link": "crank"}, **cam_ram(**cam)},
        )
        return {finding.code for finding in machine.limits() if not finding.ok}

    assert failing_limits() == set()
    steep = [
        {"kind": "rise", "span_deg": 40, "lift": 24, "law": "cycloidal"},
        {"kind": "return", "span_deg": 320, "to": 0, "law": "cycloidal"},
    ]
    assert failing_limits(segment=steep) == {"PRESSURE_ANGLE"}
    assert failing_limits(segment=steep, radius=30) >= {"PRESSURE_ANGLE", "UNDERCUT"}


def test_what_a_spring_must_hold_is_the_followers_inertia() -> None:
    """A cycloidal motion over 120 deg at 1 Hz: the greatest deceleration is 2 pi lift / time^2."""
    masses = {"masses": {"ram": {"mass_g": 500}}, "drive": {"link": "crank", "speed_rpm": 60}}
    machine = validate(Linkage, {"mechanism": "linkage", "name": "own", **cam_ram(), **masses})
    needed = 0.5 * math.tau * 0.012 / (1 / 3) ** 2
    assert machine.study().numbers["hold_crank_on_ram_n"] == pytest.approx(needed, rel=1e-3)


def test_a_bar_between_two_rollers_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DesignError, match="crank on ram.*meets the shaft"):
        made(tmp_path, cam_ram(closure="conjugate"), "dxf")


@pytest.mark.long
def test_steel_dowels_in_place_of_printed_pins(root: Path, tmp_path: Path) -> None:
    """Lengths of ISO 2338: above 8 mm they step by 2."""
    report = build(
        root / "specs" / "linkage.toml", tmp_path, frozenset({"3mf"}), ["parts.pin=dowel"]
    )
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    table = (tmp_path / "linkage" / "linkage-parts.csv").read_text(encoding="utf-8")
    bought = validate(Linkage, read(tmp_path / "linkage" / "spec.toml")).assembly.parts
    lengths = {part.thickness for part in bought if part.process == "bought"}
    assert lengths and all(length % 2 == 0 for length in lengths) and "bought" in table
    with pytest.raises(SpecError, match=r"parts.pin_diameter.*dowels are sold"):
        validate(
            Linkage,
            read(root / "specs" / "linkage.toml")
            | {"parts": {"pin": "dowel", "pin_diameter": 5.2}},
        )


# ---- damage ----------------------------------------------------------------------------------------------------------


def bent(file: Path, near: complex, change: Callable[[complex], complex]) -> None:
    """Map the corners of the closed line of a drawing whose middle is nearest to a place; arcs keep their bulge."""
    document = ezdxf.readfile(file)

    def middle(line: Any) -> complex:
        return complex(np.mean([complex(x, y) for x, y in line.get_points("xy")]))

    line = min(document.modelspace().query("LWPOLYLINE"), key=lambda line: abs(middle(line) - near))
    rows = [(change(complex(x, y)), bulge) for x, y, bulge in line.get_points("xyb")]
    mirrored = (change(1j) - change(0j)) * (change(1 + 0j) - change(0j)).conjugate()
    sign = 1 if mirrored.imag > 0 else -1
    line.set_points([(z.real, z.imag, sign * bulge) for z, bulge in rows], format="xyb")
    document.saveas(file)


@pytest.mark.long
def test_a_slot_turned_by_a_fifth_of_a_degree_is_found(tmp_path: Path) -> None:
    folder = made(tmp_path, YOKE, "dxf")
    turn = complex(math.cos(math.radians(0.2)), math.sin(math.radians(0.2)))
    bent(folder / "own-yoke.dxf", 30 + 0j, lambda z: 30 + (z - 30) * turn)
    assert "MOTION_ERROR" in failing(folder)


@pytest.mark.long
def test_a_wheel_with_turned_teeth_and_a_thin_one_are_found(tmp_path: Path) -> None:
    folder = made(tmp_path, GEARED, "dxf")
    path = folder / "own-gear-crank_to_drum-drum.dxf"
    sound = path.read_bytes()
    turn = complex(math.cos(math.radians(0.2)), math.sin(math.radians(0.2)))
    bent(path, 0j, lambda z: z * turn if abs(z) > 5 else z)
    assert "MOTION_ERROR" in failing(folder)
    path.write_bytes(sound)
    bent(path, 0j, lambda z: z * 0.999 if abs(z) > 5 else z)
    assert "PIN_GAP" in failing(folder)


@pytest.mark.long
def test_a_mirrored_cam_is_found(tmp_path: Path) -> None:
    folder = made(tmp_path, cam_rocker(), "dxf")
    bent(folder / "own-cam-crank_on_rocker.dxf", 100 + 0j, lambda z: z.conjugate())
    assert {"MOTION_ERROR", "ROUND_TRIP"} <= failing(folder)


@pytest.mark.long
def test_links_that_change_their_levels_in_the_assembly_are_found(tmp_path: Path) -> None:
    folder = made(tmp_path, YOKE, "3mf")
    path = folder / "own-assembly.3mf"
    with zipfile.ZipFile(path) as package:
        files = {name: package.read(name) for name in package.namelist()}
    text = files["3D/3dmodel.model"].decode()
    floor = {
        name: re.search(rf'name="{name}-1".*?transform="[^"]* ([^ "]+)"', text, re.S)
        for name in ("crank", "yoke")
    }
    (low, a), (high, b) = (
        (found[1], found.span(1)) for found in (floor["crank"], floor["yoke"]) if found
    )
    assert low != high and a < b
    text = text[: a[0]] + high + text[a[1] : b[0]] + low + text[b[1] :]
    with zipfile.ZipFile(path, "w") as package:
        for name, data in files.items():
            package.writestr(name, text.encode() if name == "3D/3dmodel.model" else data)
    assert {"INTERFERENCE", "ROUND_TRIP"} <= failing(folder)


def test_a_ratio_of_teeth_is_the_number_that_it_makes() -> None:
    """As --ratio of camgen motion takes it; text that is no ratio is refused by its key."""

    def geared(ratio: object) -> object:
        head = {"mechanism": "linkage", "name": "own", "drive": {"link": "crank", "speed_rpm": 60}}
        return read_mechanism(head | GEARED | {"gear": [GEARED["gear"][0] | {"ratio": ratio}]})

    assert geared("-24/12") == geared("-2.0") == geared(-2)
    for text in ("-24/0", "two", "1e400"):
        with pytest.raises(SpecError, match=f"gear.0.ratio: '{text}' - expected a number"):
            geared(text)
