"""STEP files: read back as written, the same bytes anywhere; every damage is told."""

import re
from dataclasses import replace

import numpy as np
import pytest
from test_solids import cam, hub

from camgen.errors import FileError
from camgen.files.formats import Job, read_exact, write_part
from camgen.files.step import read_step, write_step
from camgen.files.threemf import PartCopy
from camgen.geometry.mesh import placing
from camgen.geometry.outlines import Region, rectangle
from camgen.judge.copies import judge_exact_copies
from camgen.judge.round_trip import judge_exact
from camgen.parts.exact import exact
from camgen.parts.part import Layer, Part
from camgen.pipeline.build import KINDS, build, check
from camgen.pipeline.expectation import nominal_part

TOLERANCE = 1e-3


def written(folder, part):
    path = folder / f"{part.name}.step"
    write_part(
        path,
        Job(part.name, f"x-{part.name}", "key", part.region, (), TOLERANCE, "bulge", None, part),
    )
    return path


def failing(path, part):
    return {
        finding.code
        for finding in judge_exact(path, nominal_part(part, TOLERANCE)).findings
        if not finding.ok
    }


@pytest.mark.parametrize("part", [cam(), hub()], ids=lambda part: part.name)
def test_a_part_comes_back_to_the_bit(tmp_path, part):
    path, body = written(tmp_path, part), exact(part, TOLERANCE)
    found, remarks = read_exact(path, part.name)
    assert remarks == [] and found.faces and not failing(path, part)
    assert found.volume == pytest.approx(body.volume, rel=1e-15)
    assert sorted(found.corners.tolist()) == sorted(body.corners.tolist())
    first = path.read_bytes()
    assert written(tmp_path, part).read_bytes() == first and b"1970" in first
    assert b"FILE_DESCRIPTION(('lengths in mm; no date of writing" in first
    assert not failing(written(tmp_path, replace(part, title="It's a \\ µ")), part)


DAMAGES = {
    "face lost": (r"(CLOSED_SHELL\('',\()#\d+,", r"\1", {"WATERTIGHT"}),
    "face twice": (r"(CLOSED_SHELL\('',\()(#\d+),", r"\1\2,\2,", {"WATERTIGHT"}),
    "corner moved": (r"(CARTESIAN_POINT\('',\(\d+\.\d)", r"\g<1>1", {"ROUND_TRIP"}),
    "circle wider": (r"(CIRCLE\('',#\d+,)\d", r"\g<1>9", {"ROUND_TRIP"}),
    "cylinder wider": (r"(CYLINDRICAL_SURFACE\('',#\d+,)\d", r"\g<1>9", {"ROUND_TRIP"}),
    "inches": (r"SI_UNIT\(\.MILLI\.", "SI_UNIT(.CENTI.", {"ROUND_TRIP"}),
    "another part": (r"PRODUCT\('hub'", "PRODUCT('rod'", {"ROUND_TRIP"}),
    "edge turned": (r"(ORIENTED_EDGE\('',\*,\*,#\d+,)\.T\.", r"\1.F.", {"WATERTIGHT"}),
}
BROKEN = {
    "surface turned": (r"(ADVANCED_FACE\('',\(#\d+\),#\d+,)\.T\.", r"\1.F."),
    "plane leans": (r"DIRECTION\('',\(0\.0,0\.0,-1\.0\)\)", "DIRECTION('',(0.6,0.0,-0.8))"),
    "entity lost": (r"#\d+=EDGE_LOOP[^;]*;", ""),
    "no number": (r"(CIRCLE\('',#\d+),[^)]*\)", r"\1,$)"),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_file_is_told(tmp_path, damage):
    path = written(tmp_path, hub())
    old, new, codes = DAMAGES[damage]
    text = path.read_text()
    path.write_text(re.sub(old, new, text, count=1))
    assert path.read_text() != text and failing(path, hub()) == codes


@pytest.mark.parametrize("damage", BROKEN)
def test_a_broken_file_is_refused(tmp_path, damage):
    path = written(tmp_path, hub())
    text = path.read_text()
    path.write_text(re.sub(*BROKEN[damage], text, count=1))
    assert path.read_text() != text
    with pytest.raises(FileError, match="not a STEP file of upright walls"):
        read_exact(path, "hub")
    path.write_text(text[: len(text) // 2])
    with pytest.raises(FileError, match="cut short"):
        read_exact(path, "hub")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (r"(#\d+)=PRODUCT_RELATED_PRODUCT_CATEGORY\(.*\);", r"\1=(\1);"),
        (r"(#\d+=PRODUCT_RELATED_PRODUCT_CATEGORY\('part',\$,\(#)\d+", r"\g<1>1"),
        (r"(#\d+=PRODUCT_RELATED_PRODUCT_CATEGORY\('part',\$,\(#)\d+", r"\g<1>99999"),
        (r"(#\d+)=APPLICATION_PROTOCOL_DEFINITION\(.*\);", r"\1=NONSENSE();"),
        (r"(#\d+=APPLICATION_PROTOCOL_DEFINITION)", r"\1 \1"),
        (r"(#\d+=DIRECTION\('',\(-?\d+\.\d+,)", r"\g<1>0.0,"),
        (r"(#3)=", r"#2="),
        (r"(#2)=", r"(\1)="),
    ],
)
def test_an_instance_of_another_form_is_refused_by_its_number(tmp_path, old, new):
    """Whether or not anything refers to it."""
    path = written(tmp_path, hub())
    text = path.read_text()
    number = re.search(r"#\d+", re.search(old, text)[0])[0].replace("#3", "#2")
    path.write_text(re.sub(old, new, text, count=1))
    assert path.read_text() != text
    with pytest.raises(
        FileError, match=rf"walls between level faces, or of a drum: .*{number} (is|stands) "
    ):
        read_exact(path, "hub")


@pytest.mark.parametrize("more", ["#1@", "&", "ENDSEC;\nDATA;\n", "#99999=PLANE('',#1)"])
def test_what_is_no_instance_is_refused(tmp_path, more):
    path = written(tmp_path, hub())
    text = path.read_text()
    path.write_text(text.replace("ENDSEC;\nEND-ISO", f"{more}ENDSEC;\nEND-ISO"))
    with pytest.raises(FileError, match="not the end"):
        read_exact(path, "hub")


def test_another_solid_under_the_same_name_is_told(tmp_path):
    part = hub()
    thicker = replace(part, layers=(part.layers[0], replace(part.layers[1], z1=12.5)))
    assert failing(written(tmp_path, thicker), part) == {"ROUND_TRIP", "VOLUME"}
    moved = replace(
        part,
        layers=tuple(
            replace(layer, region=layer.region.moved(shift=0.01)) for layer in part.layers
        ),
    )
    assert failing(written(tmp_path, moved), part) == {"ROUND_TRIP"}


def test_an_assembly(tmp_path):
    plate = Part("plate", "Plate", (Layer(Region(rectangle(0, 3 + 2j)), 0, 1),))
    files = {part.name: written(tmp_path, part) for part in (hub(), plate)}
    bodies = {part.name: exact(part, TOLERANCE) for part in (hub(), plate)}
    copies = [
        PartCopy("hub", "hub-1", placing(0.3, 4 - 2j, 5, 12, True)),
        PartCopy("plate", "plate-1"),
        PartCopy("plate", "plate-2", placing(-2.0, 1j, -3, 1)),
    ]
    path, places = tmp_path / "a.step", [(copy.object, copy.transform) for copy in copies]
    write_step(path, bodies, {}, "a", copies)
    _, found, remarks = read_step(path)
    assert remarks == [] and [(copy.object, copy.name) for copy in found] == [
        (copy.object, copy.name) for copy in copies
    ]
    assert (
        max(np.abs(a.transform - b.transform).max() for a, b in zip(found, copies, strict=True))
        < 1e-14
    )
    assert judge_exact_copies(path, files, places).ok
    astray = [*places[:2], ("plate", placing(-2.0, 1.001j, -3, 1))]
    assert judge_exact_copies(path, files, astray).measured == pytest.approx(1e-3)
    assert not judge_exact_copies(path, files, places[:2]).ok
    write_step(path, bodies | {"plate": bodies["hub"]}, {}, "a", copies)
    assert (
        "the faces of plate are not those of its own file"
        in judge_exact_copies(path, files, places).message
    )


@pytest.mark.long
def test_a_build_with_exact_solids_is_proved_by_them(tmp_path, root):
    spec = root / "specs" / "disc-cam.toml"
    report = build(spec, tmp_path, frozenset({"step"}))
    names = {path.name for path in report.folder.iterdir()}
    assert (
        report.ok
        and {"disc-cam-cam.step", "disc-cam-assembly.step"} <= names
        and "disc-cam-cam.stl" not in names
    )
    assert {"MOTION_ERROR", "ROUND_TRIP", "WATERTIGHT", "VOLUME"} <= {
        finding.code for finding in report.findings
    }
    path, whole = report.folder / "disc-cam-cam.step", report.folder / "disc-cam-assembly.step"
    assert check(report.folder).ok
    sound = whole.read_bytes()
    whole.write_bytes(sound.replace(b"DIRECTION('',(1.0,0.0,0.0))", b"DIRECTION('',(0.8,0.6,0.0))"))
    assert [(f.code, str(f.where)) for f in check(report.folder).findings if not f.ok] == [
        ("ROUND_TRIP", whole.name)
    ]
    whole.write_bytes(sound)
    path.write_text(re.sub(r"(CLOSED_SHELL\('',\()#\d+,", r"\1", path.read_text(), count=1))
    assert not check(report.folder).ok


@pytest.mark.long
def test_a_whole_build_makes_them_where_the_spec_asks(tmp_path, root):
    motor = "motor.model=hand crank"  # whose shaft is as thick as the bore
    settings = ("output.step=true", "print.hole_compensation=0.05", motor)
    report = build(root / "specs" / "disc-cam.toml", tmp_path, frozenset(KINDS), settings)
    assert report.ok and {path.suffix for path in report.folder.iterdir()} > {
        ".step",
        ".dxf",
        ".stl",
        ".3mf",
    }
    assert list(report.warnings) == [
        "print.hole_compensation = 0.05 changes only STL and 3MF: the DXF and STEP are as drawn"
    ]
    drawings = build(root / "specs" / "disc-cam.toml", tmp_path, frozenset({"dxf"}), settings)
    assert not list(drawings.folder.glob("*.step"))  # --only means what it says


@pytest.mark.long
def test_parts_without_one_are_named(tmp_path, root):
    report = build(root / "specs" / "chain-stitch-looper.toml", tmp_path, frozenset({"step"}))
    told = " ".join(each.why for each in report.not_judged if each.code == "ROUND_TRIP")
    assert "lower-spreader" in told and "needle-plate" in told and "crosswise" in told
    assert not list(report.folder.glob("*spreader.step")) and list(
        report.folder.glob("*outline.step")
    )
