"""What moves a finding of a spec: what is told of a key is what the machine with that key has."""

from __future__ import annotations

import json
import math
import re
import tomllib
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from test_cli import run as run  # noqa: F401  a fixture

import camgen
from camgen import starters
from camgen.errors import SpecError, dotted
from camgen.machines import MECHANISMS
from camgen.machines.loads.assess import assess
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import Template, read_mechanism
from camgen.sweep import influence as sweep_influence
from camgen.sweep.influence import influence, influence_text

SPECS = Path(__file__).resolve().parents[2] / "specs"
STEEP: dict[str, Any] = {
    "mechanism": "disc-cam",
    "name": "steep",
    "geometry": {
        "base_radius": 12,
        "follower": {"motion": "translating", "shape": "roller", "radius": 5},
    },
    "motor": {"speed_rpm": 60},
    "segment": [
        {"kind": "rise", "span_deg": 90, "lift": 25, "law": "cycloidal"},
        {"kind": "dwell"},
        {"kind": "return", "span_deg": 150, "lift": 25, "law": "cycloidal"},
    ],
}


def least_angle(crank: float, coupler: float, rocker: float, frame: float) -> float:
    """Least transmission angle of a crank-rocker, deg, where crank and frame lie in one line: the law of cosines."""
    angles = []
    for diagonal in (frame - crank, frame + crank):
        cosine = (coupler**2 + rocker**2 - diagonal**2) / (2 * coupler * rocker)
        angle = math.degrees(math.acos(cosine))
        angles.append(min(angle, 180 - angle))
    return min(angles)


def test_each_length_of_a_four_bar_moves_its_transmission_angle_as_the_law_of_cosines_says() -> (
    None
):
    found = influence(SPECS / "linkage.toml", "TRANSMISSION_ANGLE")
    lengths = {"O-A": 20.0, "A-B": 60.0, "C-B": 50.0, "O-C": 70.0}
    assert found.nearest is not None
    assert found.nearest.measured == pytest.approx(least_angle(*lengths.values()), abs=1e-9)
    assert found.limit_keys == ["limits.transmission_angle_deg"]
    changes = {}
    for effect in found.effects:
        (key,) = effect.keys
        changed = {**lengths, key.removeprefix("lengths."): effect.tried}
        assert effect.measured == pytest.approx(least_angle(*changed.values()), abs=1e-9)
        changes[key] = abs(effect.measured - found.nearest.measured)
        if effect.last is not None:
            last = least_angle(*{**lengths, key.removeprefix("lengths."): effect.last}.values())
            assert found.nearest.limit <= last < found.nearest.limit * 1.02
    assert sorted(changes) == [f"lengths.{key}" for key in sorted(lengths)]
    assert list(changes.values()) == sorted(changes.values(), reverse=True)


@pytest.mark.long
def test_of_a_limit_that_fails_the_nearest_values_that_keep_it_are_found() -> None:
    found = influence(STEEP, "PRESSURE_ANGLE")
    steep = camgen.load(STEEP)
    assert found.nearest is not None and not found.nearest.ok
    last = {tuple(each.keys): each.last for each in found.effects}
    base_radius = last["geometry.base_radius",]
    lift = last["segment.0.lift", "segment.2.lift"]  # neither goes alone: the turn would not close
    assert base_radius is not None and lift is not None and ("segment.0.span_deg",) in last
    for keys, value, less in (
        (["geometry.base_radius"], base_radius, 0.99 * base_radius),
        (["segment.0.lift", "segment.2.lift"], lift, 1.01 * lift),
    ):
        assert steep.replace(dict.fromkeys(keys, value)).limits()[0].ok
        assert not steep.replace(dict.fromkeys(keys, less)).limits()[0].ok


@pytest.fixture
def one_number(monkeypatch: pytest.MonkeyPatch) -> None:
    """One number of a spec in place of all: each takes its time."""
    one = [(("print", "press_clearance"), 0.0)]
    monkeypatch.setattr(sweep_influence, "_numbers", lambda tables: one)


@pytest.mark.long
@pytest.mark.usefixtures("one_number")
def test_a_key_that_is_not_set_is_named_where_it_would_set_the_limit() -> None:
    found = influence(SPECS / "linkage.toml", "LASH")
    assert len(found.findings) == 2 and found.limit_keys == ["limits.lash"]
    assert [each.keys for each in found.effects] == [["print.press_clearance"]]


ADVISED = re.compile(r"\b[a-z_]+(?:\.[a-z_0-9]+)+\b")


def advised(message: str, machine: Any) -> set[str]:
    """Keys that a message names in full and that this machine's schema has as numbers."""
    schema = json.loads(starters.schema_text(type(machine), machine.mechanism))

    def known(key: str) -> bool:
        tables = [schema]
        for step in key.split("."):
            below = [table.get("properties", {}).get(step) for table in tables]
            tables = []
            for node in filter(None, below):
                options = [node, *node.get("anyOf", ())]
                named = [each["$ref"].rpartition("/")[2] for each in options if "$ref" in each]
                tables += [*options, *(schema["$defs"][name] for name in named)]
        return any(table.get("type") in ("number", "integer") for table in tables)

    return {key for key in ADVISED.findall(message) if known(key)}


KNOCKING = {
    **STEEP,
    "motor": {"speed_rpm": 600},
    "load": {"mass_kg": 1.0, "resistance": 1.0},
    "geometry": {**STEEP["geometry"], "base_radius": 40},
}


@pytest.mark.long
@pytest.mark.parametrize("name", [*MECHANISMS, "dial-table", "groove", "knocking"])
def test_every_key_that_a_message_names_is_told(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """As one that changes the finding, that sets its limit, or that does neither alone; of all findings before files."""
    machine = camgen.load(KNOCKING if name == "knocking" else tomllib.loads(starters.text(name)))
    named = dict[str, set[str]]()
    for each in machine.forecast():
        named.setdefault(each.code, set()).update(advised(each.message, machine))
    numbers = sweep_influence._numbers
    for code, keys in named.items():
        if not keys or code == "BED_FIT":
            continue
        few = partial(numbers_of, numbers, keys)  # each takes its time
        monkeypatch.setattr(sweep_influence, "_numbers", few)
        found = influence(machine, code)
        told = {key for each in found.effects for key in each.keys}
        told |= {*found.limit_keys, *found.idle}
        assert found.nearest is not None
        assert advised(found.nearest.message, machine) <= told, (code, told)


def numbers_of(numbers: Any, keys: set[str], tables: Any, path: Any = ()) -> Any:
    return [each for each in numbers(tables, path) if dotted(each[0]) in keys]


@pytest.mark.long
def test_a_key_that_is_not_set_is_tried_where_advice_names_it() -> None:
    found = influence(KNOCKING, "LIFT_OFF")
    (preload,) = (each for each in found.effects if each.keys == ["spring.preload"])
    assert found.nearest is not None and not found.nearest.ok and math.isnan(preload.value)
    sprung = camgen.load(KNOCKING).replace({"spring.preload": preload.tried})
    (judged,) = sprung.limits_of("LIFT_OFF") or [
        f for f in sprung.forecast() if f.code == "LIFT_OFF"
    ]
    assert preload.measured == judged.measured > found.nearest.measured
    assert "`spring.preload`, not set: 1 gives" in influence_text(KNOCKING, "LIFT_OFF")


@pytest.mark.long
def test_a_cam_of_a_linkage_that_has_no_base_radius_is_tried_with_one() -> None:
    """A larger circle makes it less steep."""
    linkage = {
        "mechanism": "linkage",
        "name": "one-cam",
        "points": {"O": [0, 0], "D": [60, 0], "E": [15, 15]},
        "links": {"ground": ["O", "D"], "crank": ["O"], "arm": ["D", "E"]},
        "drive": {"link": "crank"},
        "output": [{"name": "swing", "link": "arm"}],
    }
    rise = {"kind": "rise", "span_deg": 90, "lift_deg": 20}
    back = {"kind": "return", "span_deg": 90, "to_deg": 0}
    cam = {"cam": "crank", "follower": "arm", "at": "E", "radius": 4}
    linkage["cam"] = [cam | {"segment": [rise, back, {"kind": "dwell"}]}]
    found = influence(linkage, "PRESSURE_ANGLE")
    assert found.nearest is not None
    (radius,) = (each for each in found.effects if each.keys == ["cam.0.base_radius"])
    assert math.isnan(radius.value) and radius.measured < found.nearest.measured


def test_what_is_judged_on_files_alone_says_so() -> None:
    found = influence(SPECS / "disc-cam.toml", "MOTION_ERROR")
    assert (found.findings, found.nearest, found.effects) == ([], None, ())
    assert "`camgen build` judges it" in influence_text(SPECS / "disc-cam.toml", "MOTION_ERROR")


@pytest.mark.usefixtures("one_number")
def test_no_number_moves_a_check_that_is_exact() -> None:
    text = influence_text(SPECS / "disc-cam.toml", "UNDERCUT")
    assert "- Holds (exact profile): 0 mm, at most 0 mm\n" in text
    assert "A change of 2 % in any one number" in text


@pytest.mark.usefixtures("one_number")
def test_explain_takes_a_spec_behind_the_codes(run: Any, tmp_path: Path) -> None:  # noqa: F811
    spec = tmp_path / "steep.toml"
    spec.write_text(camgen.load(STEEP).toml(), encoding="utf-8")
    code, out, _ = run("explain", "pressure-angle", str(spec))
    head, _, entry = camgen.explain("PRESSURE_ANGLE").partition("\n")
    assert code == 0 and out.startswith(f"{head[3:]}\n{'-' * 14}\n{entry}")
    assert out.endswith(camgen.explain("PRESSURE_ANGLE", spec).partition("steep.toml\n")[2])
    said = r"\nPRESSURE_ANGLE in steep.toml\n-{28}\n- Fails \(exact profile, cam angle [\d.]+ deg\): 49.45 deg, at most 30 deg"
    assert re.search(said, out)
    assert "- `limits.pressure_angle_deg` sets the limit\n" in out
    code, out, err = run("explain", str(spec))
    assert (code, out) == (2, "") and "a CODE in front of the SPEC" in err
    code, out, err = run("explain", "UNDERCUT", str(tmp_path / "none.toml"))
    assert code == 4 and "none.toml" in err


@pytest.mark.long
def test_explain_sets_keys_of_the_spec_before(run: Any) -> None:  # noqa: F811
    spec = str(SPECS / "linkage.toml")
    said = ("explain", "TRANSMISSION_ANGLE", spec, "--set")
    code, out, _ = run(*said, "limits.transmission_angle_deg=60")
    assert code == 0 and "Fails (joint B, 0.00 deg): 53.13 deg, at least 60 deg" in out
    code, _, err = run("explain", "TRANSMISSION_ANGLE", "--set", "lengths.A-B=55")
    assert code == 2 and "name its file after the CODE" in err
    code, _, err = run(*said, "lengths.A-Z=60")
    assert code == 2 and "lengths.A-Z" in err


def test_an_open_dwell_takes_the_rest_of_a_turn_that_is_changed() -> None:
    steep = camgen.load(STEEP)
    wide = steep.replace({"segment.0.span_deg": 110})
    assert [each.span_deg for each in wide.segment] == [110, 100, 150]
    with pytest.raises(SpecError, match="nothing is left of the turn"):
        steep.replace({"segment.0.span_deg": 300})
    swept = camgen.sweep(STEEP, {"segment.0.span_deg": [90, 110]})
    assert swept["pressure_angle_deg"][1] < swept["pressure_angle_deg"][0]


@pytest.mark.long
def test_the_corners_of_a_timing_chart_are_tried_under_the_keys_that_are_typed() -> None:
    """The same rise by its corner and by its span, the dwell behind it taking what is left; its level goes with that of the
    dwell, as the lifts of rise and return go together, and the level at which the turn closes stays."""
    spans = STEEP["segment"]
    ends = (90, 210, 360)
    lifts = (25, 25, 0)
    corners = [
        {"at_deg": end, "to": lift, "law": row.get("law")}
        for row, end, lift in zip(spans, ends, lifts, strict=True)
    ]
    corners[1].pop("law")
    chart = influence({**STEEP, "segment": corners}, "PRESSURE_ANGLE")
    spanned = influence(STEEP, "PRESSURE_ANGLE")
    (corner,) = [each for each in chart.effects if list(each.keys) == ["segment.0.at_deg"]]
    (span,) = [each for each in spanned.effects if list(each.keys) == ["segment.0.span_deg"]]
    assert (corner.value, corner.tried) == (span.value, span.tried) == (90, 91.8)
    assert corner.measured == pytest.approx(span.measured, rel=1e-12)
    (level,) = [each for each in chart.effects if any(key.endswith(".to") for key in each.keys)]
    (lift,) = [each for each in spanned.effects if any(key.endswith(".lift") for key in each.keys)]
    assert (level.keys, level.value) == (["segment.0.to", "segment.1.to"], lift.value)
    assert level.measured == pytest.approx(lift.measured, rel=1e-12)


def test_levels_of_a_program_are_those_between_which_it_moves() -> None:
    def levels(*rows: dict[str, float]) -> list[tuple[float, bool, int]]:
        found = sweep_influence._levels({"drive": {"segment": rows}})
        return [(each.value, each.closing, len(each.paths)) for each in found if each.paths]

    around = levels({"to": 0}, {"to": 9}, {}, {"to": 9}, {"to": 0}, {"to": 9}, {"to": 0}, {"to": 0})
    assert around == [(0, True, 1), (9, False, 2), (0, False, 1), (9, False, 1), (0, True, 2)]
    assert levels({"to_deg": 90}, {"to_deg": 90}) == [(90, False, 2)]  # it turns on
    assert levels({"to": 9}, {"lift": 9}, {"to": 9}) == [(9, False, 1), (9, False, 1)]


@pytest.mark.long
def test_a_value_that_camgen_found_is_a_key_and_stays_while_others_change(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    kept = {"base_radius", "radius"}
    numbers = sweep_influence._numbers
    monkeypatch.setattr(
        sweep_influence,
        "_numbers",
        lambda *tables: [each for each in numbers(*tables) if each[0][-1] in kept],
    )
    follower = STEEP["geometry"]["follower"]
    open_ = {**STEEP, "geometry": {"follower": follower}}
    found = influence(open_, "PRESSURE_ANGLE")
    free = camgen.load(open_)
    base = free.resolved().geometry.base_radius
    effects = {each.keys[0]: each for each in found.effects}
    assert effects["geometry.base_radius"].found and not effects["geometry.follower.radius"].found
    assert effects["geometry.base_radius"].value == base
    for key, effect in effects.items():
        found_base = {} if math.isnan(effect.value) else {"geometry.base_radius": base}
        changed = free.replace({**found_base, key: effect.tried})  # a key that was open: found anew
        assert effect.measured == pytest.approx(changed.limits()[0].measured, rel=1e-12)
    assert f"`geometry.base_radius`, found {base:.6g}: " in influence_text(open_, "PRESSURE_ANGLE")


@pytest.mark.long
def test_what_only_makes_it_worse_is_no_remedy_and_the_way_is_said() -> None:
    """Play of pins: pressed ones have none, and cannot have less; what slides has it from its clearance, so less holds."""
    mill = {
        "mechanism": "linkage",
        "name": "mill",
        "points": {"O": [0, 0], "C": [80, 10], "A": [18, 0], "B": [70, 60], "P": [50, 85]},
        "links": {
            "ground": ["O", "C"],
            "crank": ["O", "A"],
            "coupler": ["A", "B", "P"],
            "rocker": ["C", "B"],
        },
        "drive": {"link": "crank", "speed_rpm": 30},
        "output": [{"name": "path", "point": "P"}],
        "limits": {"lash": 1.0},
    }
    found = influence(mill, "LASH")
    assert found.nearest is not None and not found.nearest.ok
    named = {key: effect for effect in found.effects for key in effect.keys}
    assert "print.press_clearance" not in named
    last = named["print.slide_clearance"].last
    assert last is not None and last < 0.2
    text = influence_text(mill, "LASH")
    assert f"it holds from {last:.6g} down" in text and " up" in text
    within = camgen.load({**mill, "print": {"slide_clearance": last}}).forecast()
    beyond = camgen.load({**mill, "print": {"slide_clearance": last * 1.02}}).forecast()
    holds = [all(each.ok for each in some if each.code == "LASH") for some in (within, beyond)]
    assert holds == [True, False]


@pytest.mark.long
def test_room_on_the_bed_is_told_before_files_are_made() -> None:
    """The cam has a base circle of 24 mm: a bed of 12 mm is too narrow, one of 200 mm wide enough."""
    small = influence_text(STEEP | {"print": {"bed": [40, 12]}}, "BED_FIT")
    assert "- Fails (cam): " in small and "print.bed has room for 40 x 12 mm" in small
    assert "`print.bed.1`" in small
    wide = influence_text(STEEP | {"print": {"bed": [300, 200]}}, "BED_FIT")
    assert (
        "- Holds (cam): the part takes " in wide and "print.bed has room for 300 x 200 mm" in wide
    )
    assert "Nothing shows it" not in wide


def test_what_a_cam_bears_at_its_speed_is_explained_too() -> None:
    """The greatest acceleration goes by the square of the speed, and by the lift itself: so the values at which it just holds."""
    found = influence(SPECS / "disc-cam.toml", "FOLLOWER_ACCELERATION", ["limits.acceleration=200"])
    assert found.nearest is not None and not found.nearest.ok
    assert found.limit_keys == ["limits.acceleration"]
    effects = {each.keys[0]: each for each in found.effects}
    speed = effects["motor.speed_rpm"]
    share = 200 / found.nearest.measured
    assert speed.measured == pytest.approx(found.nearest.measured * 1.02**2)
    assert speed.last == pytest.approx(speed.value * math.sqrt(share), rel=5e-3)
    lift = effects["segment.0.lift"]
    assert lift.last == pytest.approx(lift.value * share, rel=5e-3)
    assert not any(key.startswith("geometry.") for key in effects)


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("gallery/flapping-bird", ["material.infill=0.98"]),  # whose stand says where down is
        ("disc-cam", ["parts.bore=20"]),  # of steel, with a hub and a keyway for its bore
        ("cylinder-cam", ["geometry.radius=40"]),
        ("linkage", ["laser.thickness=4"]),
    ],
)
def test_a_variant_is_the_spec_read_anew(name: str, settings: list[str]) -> None:
    """What one table decides in another is decided again, where only one of both has changed."""
    base = {
        "disc-cam": ["material.name=16MnCr5", "parts.hub_diameter=", "parts.hub_height="],
        "cylinder-cam": ["material.name=16MnCr5"],
        "linkage": ["laser.thickness=3", "parts.make=laser"],
    }.get(name, [])
    spec = SPECS / f"{name}.toml"
    before = read_mechanism(spec, base)
    (variant,) = Template(before.source_tables, "spec", Path()).variants([settings])
    assert isinstance(variant, Mechanism)
    assert variant.toml() == read_mechanism(spec, [*base, *settings]).toml()


@pytest.mark.long
@pytest.mark.parametrize("name", ["gallery/flapping-bird", "walking-leg"])
def test_what_a_key_does_to_the_torque_is_what_a_build_with_it_says(name: str) -> None:
    """The torque is far below the limit, that of a hand, and so is each change of it."""
    spec = SPECS / f"{name}.toml"
    found = influence(spec, "DRIVE_TORQUE")
    assert len(found.effects) >= 6
    for each in found.effects:
        settings = [f"{key}={each.tried!r}" for key in each.keys]
        report = assess(read_mechanism(spec, settings))
        (built,) = (row for row in report.findings if row.code == "DRIVE_TORQUE")
        assert each.measured == pytest.approx(built.measured, rel=1e-6)


@pytest.mark.parametrize("name", ["walking-leg", "gallery/flapping-bird"])
def test_the_play_of_the_design_is_that_of_its_files(name: str, tmp_path: Path) -> None:
    """Two links on a dowel that is loose in both have its gap twice; files add a chord tolerance at each side of a gap."""
    spec = SPECS / f"{name}.toml"
    report = camgen.build(spec, tmp_path, only=["dxf"])
    (built,) = (each for each in report.findings if each.code == "LASH")
    found = read_mechanism(spec).free_play()
    assert max(each.measured for each in found) == pytest.approx(built.measured, rel=1e-3)


def test_what_a_roller_presses_with_is_explained_by_its_radius_and_the_width() -> None:
    spec = SPECS / "disc-cam.toml"
    steel = ["material.name=C45", "load.mass_kg=0.3"]
    text = influence_text(spec, "HERTZ", steel)
    assert "`limits.hertz_mpa` sets the limit" in text
    for key in ("`geometry.follower.radius`", "`parts.thickness`"):
        assert key in text


def test_up_to_where_a_finding_holds_is_told_where_it_fails_beyond_alone() -> None:
    """A spring is wound anew for each preload, rate and lift: what holds a little further has no end that can be told."""
    settings = ["load.mass_kg=0.3", "spring.preload=15", "spring.rate=1"]
    found = influence(SPECS / "disc-cam.toml", "SPRING_STRESS", settings)
    assert found.nearest is not None and found.nearest.ok
    assert {"spring.preload", "spring.rate"} <= {each.keys[0] for each in found.effects}
    for effect in found.effects:
        if effect.last is None:
            continue
        further = effect.last * (1.02 if abs(effect.last) > abs(effect.value) else 0.98)
        (beyond,) = influence(
            SPECS / "disc-cam.toml", "SPRING_STRESS", [*settings, f"{effect.keys[0]}={further}"]
        ).findings
        assert not beyond.ok, effect
