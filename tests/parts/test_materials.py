"""Materials: their rows against what was read of them, and that nothing speaks of printers where none prints."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import pytest

from camgen.errors import SpecError
from camgen.files.formats import KINDS
from camgen.findings import Finding
from camgen.machines.loads.assess import Assessment, assess
from camgen.machines.sources import read_mechanism
from camgen.parts.assembly import printed_parts
from camgen.parts.materials import FRICTION_METAL, MATERIALS, friction_of
from camgen.pipeline.build import build, has_exact_solids
from camgen.tolerance.spread import sizes_of

ROOT = Path(__file__).resolve().parents[2]
FACTS = tomllib.loads((ROOT / "tests" / "reference" / "materials.toml").read_text(encoding="utf-8"))
CUT = [name for name, row in MATERIALS.items() if not row.printed]
CAM = ROOT / "specs" / "disc-cam.toml"
LOADED = (
    "motor.speed_rpm=60",
    "load.mass_kg=2",
    "spring.rate=5",
    "spring.preload=40",
)


def within(value: float, told: Any) -> bool:
    """Whether a value is the one that was read, or lies in the range that was."""
    low, high = told if isinstance(told, list) else (told, told)
    return bool(low * (1 - 1e-9) <= value <= high * (1 + 1e-9))


@pytest.mark.parametrize("name", CUT)
def test_a_row_is_what_was_read(name: str) -> None:
    row = MATERIALS[name]
    facts = FACTS[name]
    assert within(row.elastic.modulus, facts["modulus"])
    assert within(row.density, facts["density"])
    if "poisson" in facts:
        assert row.elastic.poisson == facts["poisson"]
    if "fatigue" in facts:
        assert row.bears == facts["fatigue"]
    else:  # half of the tensile strength, or less
        assert row.bears <= facts["strength"][0] / 2 + 0.5
    assert row.source


def test_pressures_of_contacts_are_those_of_gears_or_where_a_material_flows() -> None:
    gears = FACTS["gears"]
    kgf = gears["kgf"]
    assert MATERIALS["C45"].hertz == pytest.approx(gears["S45C"]["200"] * kgf)
    assert MATERIALS["42CrMo4"].hertz == pytest.approx(gears["SCM440"]["310"] * kgf)
    for name in ("16MnCr5", "POM"):
        assert MATERIALS[name].hertz == FACTS[name]["hertz"]
    for name in ("stainless", "aluminium", "brass"):
        assert MATERIALS[name].hertz == pytest.approx(1.79 * FACTS[name]["yields"])
    assert {name for name in CUT if MATERIALS[name].hertz is None} == {"plywood", "acrylic"}


def test_friction_by_how_many_faces_are_of_metal() -> None:
    assert friction_of("C45", "brass") == FRICTION_METAL
    assert friction_of("PLA", "steel") == friction_of("POM", "C45") < FRICTION_METAL
    assert friction_of("PLA", "PLA") > FRICTION_METAL


def judged(material: str) -> Assessment:
    return assess(read_mechanism(CAM, (*LOADED, f"material.name={material}")).resolved())


def of_code(loads: Assessment, code: str) -> list[Finding]:
    return [each for each in loads.findings if each.code == code]


def test_a_cams_pressure_is_held_against_its_material() -> None:
    (steel,) = of_code(judged("16MnCr5"), "HERTZ")
    (print_,) = of_code(judged("PLA"), "HERTZ")
    assert steel.limit == 1460 and "DIN 3990" in steel.message
    assert steel.measured > 3 * print_.measured  # it gives way sixty times less
    wood = judged("plywood")
    assert not of_code(wood, "HERTZ")
    assert ("HERTZ", "limits.hertz_mpa") in {(each.code, each.needs) for each in wood.not_judged}


def test_a_material_that_is_not_printed_has_no_print_error_of_its_own() -> None:
    machine = read_mechanism(CAM, ("material.name=C45",)).resolved()
    assert not printed_parts(machine.assembly)
    with pytest.raises(SpecError, match="which is not printed"):
        sizes_of(machine)
    known = read_mechanism(CAM, ("material.name=C45", "print.size_error=0.01")).resolved()
    assert sizes_of(known).offset == 0.005


@pytest.mark.long
def test_nothing_of_a_cut_cam_speaks_of_printers(tmp_path: Path) -> None:
    build(CAM, tmp_path, frozenset(KINDS), ("material.name=C45",))
    folder = tmp_path / "disc-cam"
    said = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    words = json.dumps([said[key] for key in said if key not in ("spec",)]).lower()
    assert not [word for word in ("print", "nozzle", "plate.3mf", "bed_fit") if word in words]
    assert not list(folder.glob("*plate*.3mf"))
    assert (folder / "disc-cam-cam.step").exists() and "STEP" not in json.dumps(said["not_judged"])
    rows = (folder / "disc-cam-parts.csv").read_text(encoding="utf-8").splitlines()
    made = 'how,part,what,count,"material, mm^3"'
    assert rows[0] == f'{made},no,drawing,material,"mass of one, g","overall, mm"'
    mass = float(rows[1].split(",")[-2])
    assert rows[1].startswith("made of C45,cam") and 130 < mass < 160


@pytest.mark.parametrize(
    ("settings", "exact"),
    [
        (("material.name=C45",), True),
        (("material.name=aluminium",), True),
        (("material.name=C45", "files.step=false"), False),
        ((), False),
        (("files.step=true",), True),
    ],
)
def test_what_is_cut_of_metal_has_exact_solids(settings: tuple[str, ...], exact: bool) -> None:
    assert has_exact_solids(read_mechanism(CAM, settings)) == exact
