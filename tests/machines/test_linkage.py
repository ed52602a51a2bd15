"""Any planar machine from a spec: motion against closed forms, what is refused and how, the bodies and their proof."""

from __future__ import annotations

import json
import math
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from judged import wrong

from camgen.errors import CamgenError, DesignError, SpecError
from camgen.machines.linkage.mechanism import Linkage
from camgen.pipeline.build import build
from camgen.reading import read
from camgen.spec import validate

THETA = np.linspace(0.1, 6.2, 97)

SLIDER_CRANK = {
    "points": {"O": [0, 0], "R": [50, 0], "A": [21, 0], "B": [80, 0]},
    "links": {"ground": ["O", "R"], "crank": ["O", "A"], "rod": ["A", "B"], "ram": ["B"]},
    "lengths": {"O-A": 20, "A-B": 60},
    "slide": [{"link": "ram", "along": ["O", "R"]}],
    "output": [{"name": "ram", "link": "ram"}],
}
YOKE = {
    "points": {"O": [0, 0], "R": [50, 0], "A": [20, 0], "D": [20, -30], "E": [20, 30]},
    "links": {"ground": ["O", "R"], "crank": ["O", "A"], "yoke": ["D", "E"]},
    "slide": [{"link": "yoke", "along": ["O", "R"]}],
    "slot": [{"pin": "A", "link": "yoke", "along": ["D", "E"]}],
    "output": [{"name": "yoke", "link": "yoke"}],
}
WHITWORTH = {
    "points": {"O": [0, 0], "A": [0, 20], "D": [0, -50], "E": [0, 60]},
    "links": {"ground": ["O", "D"], "crank": ["O", "A"], "arm": ["D", "E"]},
    "slot": [{"pin": "A", "link": "arm", "along": ["D", "E"]}],
    "output": [{"name": "arm", "link": "arm"}],
}


def spec(**tables: Any) -> dict[str, Any]:
    return {
        "mechanism": "linkage",
        "name": "own",
        "drive": {"link": "crank", "speed_rpm": 60},
        **tables,
    }


def linkage(**tables: Any) -> Linkage:
    return validate(Linkage, spec(**tables))


@pytest.fixture
def four_bar(root: Path) -> dict[str, Any]:
    return read(root / "specs" / "linkage.toml")


# ---- motion ----------------------------------------------------------------------------------------------------------


def test_four_bar_by_freudenstein(four_bar: dict[str, Any]) -> None:
    ground, crank, coupler, rocker = 70, 20, 60, 50
    run = validate(Linkage, four_bar).solve(THETA)
    k1, k2 = ground / crank, ground / rocker
    k3 = (crank**2 - coupler**2 + rocker**2 + ground**2) / (2 * crank * rocker)
    psi = run["swing"]
    assert np.max(np.abs(k1 * np.cos(psi) - k2 * np.cos(THETA) + k3 - np.cos(THETA - psi))) < 1e-12
    a = crank * np.exp(1j * THETA)
    b = ground + rocker * np.exp(1j * psi)
    drawn = (complex(22, 52) - 20) / abs(complex(55, 48) - 20)
    assert np.max(np.abs(np.abs(run["pen"] - a) - abs(drawn) * abs(complex(55, 48) - 20))) < 1e-12
    assert np.all(((run["pen"] - a) / (b - a)).imag > 0)


def test_slider_crank() -> None:
    machine = linkage(**SLIDER_CRANK)
    run = machine.solve(THETA)
    x = 20 * np.cos(THETA) + np.sqrt(60**2 - (20 * np.sin(THETA)) ** 2)
    assert np.max(np.abs(run["ram"] - x)) < 1e-12
    assert machine.study().numbers["ram_stroke_mm"] == pytest.approx(40, abs=1e-6)


def test_scotch_yoke_is_a_sine() -> None:
    run = linkage(**YOKE).solve(THETA)
    rate = math.tau  # 60 rpm
    assert np.max(np.abs(run["yoke"] - 20 * np.cos(THETA))) < 1e-12
    assert np.max(np.abs(run.acceleration["yoke"] + rate**2 * 20 * np.cos(THETA))) < 1e-9


def test_quick_return() -> None:
    machine = linkage(**WHITWORTH)
    run = machine.solve(THETA)
    pin = 20j * np.exp(1j * THETA) + 50j
    assert np.max(np.abs(np.exp(1j * run["arm"]) - pin / np.abs(pin))) < 1e-12
    swing = 2 * math.degrees(math.asin(20 / 50))
    assert machine.study().numbers["arm_stroke_deg"] == pytest.approx(swing, abs=1e-6)


def test_jansens_leg_steps_as_published(root: Path) -> None:
    """Foot path about 68 x 22.5 mm."""
    numbers = validate(Linkage, read(root / "specs" / "walking-leg.toml")).study().numbers
    assert numbers["foot_x_stroke_mm"] == pytest.approx(68, abs=0.5)
    assert numbers["foot_y_stroke_mm"] == pytest.approx(22.5, abs=0.25)


def test_peaucellier_draws_a_straight_line_with_pins_of_three_links(root: Path) -> None:
    machine = linkage(**read(root / "tests" / "reference" / "linkage_specs.toml")["peaucellier"])
    inverse = (130**2 - 64**2) / 80  # the foot of the inverse of the crank's circle
    path = machine.solve(np.radians(np.linspace(-40, 40, 81)))["out"]
    assert np.max(np.abs(path.real - inverse)) < 1e-10 and np.ptp(path.imag) > 100


# ---- bodies ---------------------------------------------------------------------------------------------------------


def shifted_hole(file: Path, near: complex, by: float) -> None:
    """Move the circle of a drawing that lies nearest to a place, mm."""
    import ezdxf

    document = ezdxf.readfile(file)
    hole = min(
        document.modelspace().query("CIRCLE"),
        key=lambda c: abs(complex(c.dxf.center.x, c.dxf.center.y) - near),
    )
    hole.dxf.center = (hole.dxf.center.x + by, hole.dxf.center.y, 0)
    document.saveas(file)


@pytest.mark.long
def test_four_bar_from_spec_to_verdict(built: Callable[..., Path], tmp_path: Path) -> None:
    folder = built("linkage")
    codes = {
        finding["code"]
        for finding in json.loads((folder / "report.json").read_text(encoding="utf-8"))["findings"]
    }
    assert {
        "MOTION_ERROR",
        "LASH",
        "PIN_GAP",
        "INTERFERENCE",
        "TRANSMISSION_ANGLE",
        "BED_FIT",
    } <= codes
    with open(folder / "motion.csv", encoding="utf-8") as file:
        head = file.readline().strip().split(",")
        rows = np.loadtxt(file, delimiter=",")
    columns = dict(zip(head, rows.T, strict=True))
    assert len(rows) == 1441 and columns["theta_deg"][-1] == 360
    for name in ("pen_x_mm", "pen_y_mm", "swing_deg"):
        for kind in ("dxf", "stl", "3mf"):
            assert np.max(np.abs(columns[f"{name}_{kind}"] - columns[name])) < 1e-4
    psi = np.radians(columns["swing_deg_dxf"])
    theta = np.radians(columns["theta_deg"])
    k3 = (20**2 - 60**2 + 50**2 + 70**2) / (2 * 20 * 50)
    assert (
        np.max(np.abs(70 / 20 * np.cos(psi) - 70 / 50 * np.cos(theta) + k3 - np.cos(theta - psi)))
        < 1e-6
    )
    levels = read(folder / "spec.toml")["layers"]
    assert levels == {"crank": 1, "coupler": 2, "rocker": 1}
    again = build(folder / "spec.toml", tmp_path / "again", frozenset({"dxf"}))
    assert again.ok
    assert (folder / "linkage-coupler.dxf").read_bytes() == (
        tmp_path / "again" / "linkage" / "linkage-coupler.dxf"
    ).read_bytes()


def test_masses_are_those_of_the_solids_and_torque_makes_the_energy(
    four_bar: dict[str, Any],
) -> None:
    from camgen.machine.run import solve

    four_bar["masses"] = {"rocker": {"mass_g": 50, "centre": [25, 0], "inertia_kg_m2": 1e-5}}
    built = validate(Linkage, four_bar).resolved()
    machine, made = built.model, {part.name: part for part in built.assembly.parts}
    moving = (
        sum(
            made[mount.part].volume
            for mount in built.assembly.mounts
            if mount.body in ("crank", "coupler")
        )
        * 1.24e-6
    )
    assert sum(machine.body(name).mass for name in ("crank", "coupler")) == pytest.approx(
        moving, rel=1e-9
    )
    assert (
        machine.body("rocker").mass == pytest.approx(0.05) and machine.body("rocker").centre == 25
    )
    assert (
        abs(machine.body("crank").centre.imag) < 0.2 and 0 < machine.body("crank").centre.real < 20
    )
    theta = np.linspace(0, math.tau, 721)
    forces = solve(machine, theta).forces()
    torque = np.gradient(forces.energy, theta)[5:-5]
    assert np.max(np.abs(forces.drives["drive"][5:-5] - torque)) < 1e-3 * np.max(np.abs(torque))


@pytest.mark.long
@pytest.mark.parametrize(
    ("part", "near"),
    [("coupler", 60 + 0j), ("rocker", 50 + 0j), ("crank", 20 + 0j), ("ground", 70 + 0j)],
)
def test_a_hole_off_by_30_um_is_found(
    built: Callable[..., Path], tmp_path: Path, part: str, near: complex
) -> None:
    folder = Path(shutil.copytree(built("linkage"), tmp_path / "linkage"))
    shifted_hole(folder / f"linkage-{part}.dxf", near, 0.03)
    assert "MOTION_ERROR" in {finding.code for finding in wrong(folder, "dxf")}


@pytest.mark.long
def test_two_links_swapped_are_found(built: Callable[..., Path], tmp_path: Path) -> None:
    folder = Path(shutil.copytree(built("linkage"), tmp_path / "linkage"))
    (folder / "linkage-rocker.dxf").rename(folder / "other.dxf")
    (folder / "linkage-coupler.dxf").rename(folder / "linkage-rocker.dxf")
    (folder / "other.dxf").rename(folder / "linkage-coupler.dxf")
    assert {"PIN_GAP", "ROUND_TRIP"} <= {finding.code for finding in wrong(folder, "dxf")}


@pytest.mark.long
def test_links_on_one_level_meet(root: Path, tmp_path: Path) -> None:
    report = build(
        root / "specs" / "linkage.toml", tmp_path, frozenset({"3mf"}), ["layers.crank=1"]
    )
    assert report.ok
    with pytest.raises(DesignError, match="link coupler and link rocker"):
        build(
            root / "specs" / "linkage.toml",
            tmp_path,
            frozenset({"3mf"}),
            ["layers.coupler=1", "layers.rocker=1"],
        )


def quick_return(theta: np.ndarray) -> np.ndarray:
    return np.unwrap(np.angle(20j * np.exp(1j * theta) + 50j))


def slider_crank(theta: np.ndarray) -> np.ndarray:
    return 20 * np.cos(theta) + np.sqrt(60**2 - (20 * np.sin(theta)) ** 2)


@pytest.mark.long
@pytest.mark.parametrize(
    ("tables", "column", "scale", "motion"),
    [
        (WHITWORTH, "arm_deg", math.degrees(1), quick_return),
        (SLIDER_CRANK, "ram_mm", 1.0, slider_crank),
    ],
)
def test_slot_and_slide_from_their_files(
    tmp_path: Path,
    tables: dict[str, Any],
    column: str,
    scale: float,
    motion: Callable[[np.ndarray], np.ndarray],
) -> None:
    import tomli_w

    file, table = tmp_path / "own.toml", tmp_path / "own" / "motion.csv"
    file.write_text(tomli_w.dumps(spec(**tables)), encoding="utf-8")
    report = build(file, tmp_path, frozenset({"dxf", "3mf"}))
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    assert {"MOTION_ERROR", "PIN_GAP", "INTERFERENCE"} <= {
        finding.code for finding in report.findings
    }
    head = table.read_text(encoding="utf-8").partition("\n")[0].split(",")
    rows = dict(zip(head, np.loadtxt(table, delimiter=",", skiprows=1).T, strict=True))
    for kind in ("", "_dxf", "_3mf"):
        assert (
            np.max(np.abs(rows[column + kind] - scale * motion(np.radians(rows["theta_deg"]))))
            < 1e-6 * scale
        )


@pytest.mark.long
def test_a_rocker_that_is_driven_to_and_fro(root: Path, tmp_path: Path) -> None:
    settings = ["drive.link=rocker", "drive.range_deg=[-2, 25]", "limits.transmission_angle_deg=10"]
    report = build(root / "specs" / "linkage.toml", tmp_path, frozenset({"dxf", "3mf"}), settings)
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    rows = np.loadtxt(tmp_path / "linkage" / "motion.csv", delimiter=",", skiprows=1)
    assert rows[0, 0] == -2 and rows[-1, 0] == 25 and len(rows) == 4 * 27 + 1


# ---- what is refused -------------------------------------------------------------------------------------------------


def twice(e: dict[str, Any]) -> None:
    e["output"].append(dict(e["output"][0]))


def long_crank(e: dict[str, Any], **drive: Any) -> None:
    e["points"] |= {"A": [30, 52], "B": [85, 45]}
    e["lengths"]["O-A"] = 60
    e["drive"] |= drive


def many(e: dict[str, Any]) -> None:
    for k in range(200):
        e["points"][f"N{k}"] = [k, 7]
        e["links"][f"l{k}"] = ["A", f"N{k}"]


@pytest.mark.parametrize(
    ("change", "kind", "said"),
    [
        (twice, SpecError, "output.2.name"),
        (lambda e: e["points"].update(X=[1, 2]), SpecError, "points.X"),
        (lambda e: e["points"].update({"1 x": [1, 2]}), SpecError, "a letter first"),
        (
            lambda e: (e["points"].update(X=[1, 2]), e["links"].update(loose=["X"])),
            SpecError,
            "nothing holds this link",
        ),
        (
            lambda e: e["links"].update(hung=["A"]),
            DesignError,
            "1 degree of freedom left over: link hung still moves",
        ),
        (lambda e: e["links"].update(strut=["A", "B"]), DesignError, "over-constrained: joints"),
        (lambda e: e["lengths"].update({"A-P": 1, "B-P": 1}), SpecError, "mm too long"),
        (lambda e: e["points"].update(A=[0, 0]), SpecError, "O and A are drawn at one place"),
        (
            lambda e: e["lengths"].update({"C-B": 5}),
            DesignError,
            "open by 4.79162 mm (coupler A-B 60, rocker C-B 5)",
        ),
        (
            lambda e: e.update(slide=[{"link": "rocker", "along": ["C", "C"]}]),
            SpecError,
            "two different points",
        ),
        (
            lambda e: e.update(drive=[e["drive"], e["drive"]]),
            SpecError,
            "drive.1.link: 'crank' - expected a link with a pivot of its own",
        ),
        (
            lambda e: (
                e["layers"].update(rocer=1) if "layers" in e else e.update(layers={"rocer": 1})
            ),
            SpecError,
            "'rocker'",
        ),
        (lambda e: e["parts"].update(rocker={"hub_diametr": 3}), SpecError, "'hub_diameter'"),
        (lambda e: e["parts"].update(rokcer={"thickness": 3}), SpecError, "parts.rokcer"),
        (lambda e: e["lengths"].update({"O-A": 40}), DesignError, "change point"),
        (many, SpecError, "at most 60"),
        (lambda e: e["links"].update(ROCKER=["C", "B"]), SpecError, "only in capitals"),
        (
            lambda e: e["links"].update(Assembly=["C", "B"]),
            SpecError,
            "would look like the assembly",
        ),
        (
            lambda e: e["links"].update(drawing=["C", "B"]),
            SpecError,
            "would look like a dimensioned",
        ),
        (lambda e: e["links"].update(timing=["C", "B"]), SpecError, "would look like the timing"),
        (long_crank, DesignError, "drive.range_deg = ["),
        (
            lambda e: e.update(gear=[{"a": "crank", "b": "rocker", "ratio": 2}]),
            DesignError,
            "1 time too often",
        ),
        (lambda e: long_crank(e, range_deg=[-40, 170]), DesignError, "drive.range_deg"),
        (lambda e: e.pop("output"), SpecError, "missing"),
    ],
)
def test_bad_specs(
    four_bar: dict[str, Any],
    change: Callable[[dict[str, Any]], object],
    kind: type[CamgenError],
    said: str,
) -> None:
    change(four_bar)
    with pytest.raises(kind) as caught:
        validate(Linkage, four_bar).chain  # noqa: B018
    assert said in str(caught.value) and caught.value.exit_code == (2 if kind is SpecError else 3)


def test_links_called_as_what_is_made_have_parts_of_their_own(four_bar: dict[str, Any]) -> None:
    names = {"crank": "shaft", "coupler": "collar", "rocker": "plate"}
    four_bar["links"] = {
        names.get(name, name): points for name, points in four_bar["links"].items()
    }
    four_bar["drive"]["link"], four_bar["output"][1]["link"] = "shaft", "plate"
    parts = [part.name for part in validate(Linkage, four_bar).assembly.parts]
    assert len(set(parts)) == len(parts) and {
        "link-shaft",
        "link-collar",
        "link-plate",
        "shaft",
        "collar",
    } <= set(parts)


@pytest.mark.parametrize(
    ("name", "tables"),
    [
        ("Counterweight", {"counterweight": {}}),
        ("Post", {"parts": {"plates": 2, "shaft": "interrupted"}}),
        ("knob", {"parts": {"hand_crank": 40}}),
    ],
)
def test_a_link_called_as_another_part_is_told_by_its_key(
    four_bar: dict[str, Any], name: str, tables: dict[str, Any]
) -> None:
    """Their files would have one name, with its capitals or, where a system does not tell these apart, without."""
    assert validate(Linkage, four_bar | tables).assembly.parts
    four_bar["links"] = {
        name if link == "coupler" else link: points for link, points in four_bar["links"].items()
    }
    for output in four_bar["output"]:
        if output.get("link") == "coupler":
            output["link"] = name
    with pytest.raises(SpecError) as told:
        _ = validate(Linkage, four_bar | tables).assembly
    assert [fault.key for fault in told.value.faults] == [f"links.{name}"]
    assert name.lower() in told.value.faults[0].expected


def test_to_and_fro_within_its_range(four_bar: dict[str, Any]) -> None:
    long_crank(four_bar, range_deg=[-20, 10])
    machine = validate(Linkage, four_bar)
    assert np.isfinite(machine.motion(np.linspace(0, math.tau, 100))).all()
    assert np.ptp(np.degrees(machine.cycle.theta(np.linspace(0, math.tau, 361)))) == pytest.approx(
        30
    )


def test_a_triangle_that_cannot_close_says_by_how_much() -> None:
    """The starter's coupler: A-P and B-P as drawn, hypot(2, 52) and hypot(33, 4); by the length that is typed, if it is one."""
    starter = Path(__file__).resolve().parents[2] / "specs" / "linkage.toml"
    for lengths, key, said in (
        ({"A-B": 200}, "lengths.A-B", "114.7 mm too long"),
        ({"B-A": 200}, "lengths.B-A", "114.7 mm too long"),
        ({"A-B": 9}, "links.coupler", "9.797 mm too long"),  # A-P is, as it is drawn
    ):
        data = read(starter)
        del data["lengths"]["A-B"]
        data["lengths"] |= lengths
        with pytest.raises(SpecError, match="too long") as caught:
            validate(Linkage, data)
        assert [fault.key for fault in caught.value.faults] == [key]
        assert f"it is {said}" in str(caught.value)


def test_a_triangle_by_formula_is_the_one_that_the_search_finds() -> None:
    """A longer third side; and what is drawn with its lengths stays to the last digit."""
    from camgen.machines.linkage import links

    drawn = np.array([1 + 2j, 40 - 5j, 20 + 33j])
    for lengths in ({(0, 1): 45.0}, {(0, 2): 30.0, (1, 2): 52.5}, {(0, 1): 38.0, (1, 2): 40.0}):
        formula, missed = links.shape(drawn, lengths)
        searched, _ = links._nearest(drawn, lengths)
        assert np.abs(formula - searched).max() < 1e-9 and missed == 0
        for (a, b), length in lengths.items():
            assert abs(formula[b] - formula[a]) == pytest.approx(length, rel=1e-14)
    as_drawn = {(0, 2): abs(drawn[2] - drawn[0])}
    assert links.shape(drawn, as_drawn)[0].tolist() == drawn.tolist()
    assert links._triangle(tuple(drawn.tolist()), {(0, 1): 100.0}) is None, "no such triangle"
