"""Covers of what slides: where they lie, what they are screwed on, what goes wrong without, and damage that is found out."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen.errors import DesignError
from camgen.files.threemf import PartCopy, read_3mf, write_3mf
from camgen.geometry.mesh import placing
from camgen.judge.assembly import sweep
from camgen.machines.disc_cam.mechanism import DiscCamDrive
from camgen.machines.linkage.mechanism import Linkage
from camgen.machines.mechanism import Mechanism
from camgen.parts.assembly import bodies_in_motion
from camgen.parts.solids import solid
from camgen.pipeline.build import build
from camgen.reading import read
from camgen.spec import validate

SPECS = Path(__file__).resolve().parents[3] / "specs"
# print.slide_clearance, parts.thickness unless given
PLAY = 0.2
THICKNESS = 4.0
YOKE = {
    "mechanism": "linkage",
    "name": "own",
    "drive": {"link": "crank", "speed_rpm": 60},
    "points": {"O": [0, 0], "R": [50, 0], "A": [20, 0], "D": [20, -30], "E": [20, 30]},
    "links": {"ground": ["O", "R"], "crank": ["O", "A"], "yoke": ["D", "E"]},
    "slide": [{"link": "yoke", "along": ["O", "R"]}],
    "slot": [{"pin": "A", "link": "yoke", "along": ["D", "E"]}],
    "output": [{"name": "out", "link": "yoke"}],
}


def drive(**sizes: Any) -> DiscCamDrive:
    data = read(SPECS / "disc-cam.toml")
    data["parts"] |= {"make": "printed", **sizes}
    return validate(DiscCamDrive, data)


def shifted(
    path: Path, machine: Mechanism, part: str, by: complex = 0j, lower: float = 0.0
) -> set[str]:
    """Codes and pairs that fail in an assembly with one part out of its place, mm."""
    items, poses = [], machine.assembly.poses(np.zeros(1))
    for each in machine.assembly.parts:
        for k, pose in enumerate(poses[each.name]):
            at, z = complex(pose.place[0]), pose.z
            at, z = (at + by, z - lower) if each.name == part else (at, z)
            where = placing(float(pose.angle[0]), at, z, each.thickness, pose.flipped)
            items.append(PartCopy(each.name, f"{each.name}-{k + 1}", where))
    write_3mf(
        path, {each.name: solid(each, 0.005) for each in machine.assembly.parts}, items, "key"
    )
    return {
        f"{f.code} {str(f.where).partition(':')[0]}"
        for f in sweep(path, bodies_in_motion(machine.assembly))[0]
        if not f.ok
    }


@pytest.mark.long
def test_a_follower_has_its_play_under_a_cover_in_the_file(tmp_path: Path) -> None:
    """Heights in the written assembly: 0.2 mm under the follower and 0.2 over it; the cover is on the rails; four screws M3."""
    report = build(
        SPECS / "disc-cam.toml", tmp_path, frozenset({"3mf", "report"}), ["parts.make='printed'"]
    )
    assert report.ok
    found = {
        item.name: item.placed.vertices[:, 2]
        for item in read_3mf(tmp_path / "disc-cam" / "disc-cam-assembly.3mf").items
    }
    plate_top, rails = 5.0, float(found["ground"].max())
    follower = float(found["follower"].min()), float(found["follower"].max())
    assert follower == pytest.approx((plate_top + PLAY, plate_top + PLAY + THICKNESS), abs=1e-4)
    assert (rails, float(found["cover-1"].min())) == pytest.approx(
        (follower[1] + PLAY,) * 2, abs=1e-4
    )
    bought = (tmp_path / "disc-cam" / "disc-cam-parts.csv").read_text(encoding="utf-8")
    # ISO 7380-1 head 1.65 and 0.2 sunk into 4: 2.15 to grip, 3.85 of 6 in the rail, which is 4.4 high
    assert 'screw of a cover,"M3 x 6, into core holes of 2.5, ISO 7380-1",4' in bought
    tables = json.loads((tmp_path / "disc-cam" / "report.json").read_text(encoding="utf-8"))[
        "tables"
    ]
    steps = [
        row[1] for table in tables if table["title"].startswith("Assembly") for row in table["rows"]
    ]
    assert steps.index("cover-1") > steps.index("follower")


def test_each_screw_meets_a_core_hole_and_no_rail_is_left_out() -> None:
    machine = drive()
    parts, mounts = (
        {part.name: part for part in machine.assembly.parts},
        {mount.part: mount for mount in machine.assembly.mounts},
    )
    lid, top = parts["cover-1"], parts["ground"].thickness
    screws = [mounts["cover-1"].place(hole.centroid) for hole in lid.layers[0].region.holes]
    rails = [layer.region for layer in parts["ground"].layers if layer.z1 == top]
    cores = [hole for rail in rails for hole in rail.holes]
    assert len(screws) == 4 and [len(rail.holes) for rail in rails] == [2, 2]
    for place in screws:
        near = min(cores, key=lambda hole: abs(hole.centroid - place))
        assert abs(near.centroid - place) < 1e-9 and 2 * math.sqrt(
            abs(near.area) / math.pi
        ) == pytest.approx(2.5)
    # over the whole lift the stem stays longer than the rails at both ends
    stem = parts["follower"].region.outer
    low, high = (max(z.imag for z in (p.at(p.t0) for p in stem.pieces)) for _ in range(2))
    assert low == high  # one stem
    ends = [complex(piece.at(piece.t0)).imag for rail in rails for piece in rail.outer.pieces]
    lowest = machine.model.start_of("follower").place.imag
    assert low + lowest + mounts["follower"].at.imag >= max(ends) - 1e-9


@pytest.mark.long
def test_a_runner_over_others_has_a_saddle(tmp_path: Path) -> None:
    """On level 2 of a plate of 5: levels are 4.2 apart, so its underside is at 9.4 and the saddle ends 0.2 lower."""
    tables = {**YOKE, "layers": {"yoke": 2}}
    machine = validate(Linkage, tables)
    assert machine.bodies.layout.given["yoke"] == 2
    base = next(part for part in machine.assembly.parts if part.name == "ground")
    tops = sorted({round(layer.z1, 9) for layer in base.layers})
    assert tops == pytest.approx([5.0, 9.2, 13.6])
    saddles, rails = (
        [layer for layer in base.layers if layer.z1 == pytest.approx(top)] for top in tops[1:]
    )
    assert (len(saddles), len(rails)) == (2, 4)  # the yoke has stems at both ends
    assert all(saddle.region.area > 2 * rail.region.area for saddle in saddles for rail in rails)
    assert shifted(tmp_path / "x.3mf", machine, "none") == set()


@pytest.mark.long
@pytest.mark.parametrize(
    ("by", "lower", "pair"),
    [
        (0j, 0.3, "cover-1-1 and follower-1"),
        (-15j, 0.0, "cover-1-1 and pin-2-1"),
        (-30j, 0.0, "cam-contact-1 and cover-1-1"),
    ],
)
def test_a_cover_that_is_too_low_or_too_near_is_found_out(
    tmp_path: Path, by: complex, lower: float, pair: str
) -> None:
    machine = drive()
    assert shifted(tmp_path / "x.3mf", machine, "cover-1") == set()
    found = shifted(tmp_path / "x.3mf", machine, "cover-1", by, lower)
    names = {frozenset(each.removeprefix("INTERFERENCE ").split(" and ")) for each in found}
    assert frozenset(pair.split(" and ")) in names


def test_rails_without_covers_are_told_and_rails_that_hold_no_screw_refused() -> None:
    bare = drive(cover=False)
    assert not [part.name for part in bare.assembly.parts if part.name.startswith("cover")]
    assert any("open above" in note for note in bare.study().notes)
    assert not any("open above" in note for note in drive().study().notes)
    with pytest.raises(
        DesignError, match=r"parts.rail_width.*1.5 mm.*limit: at least 3.2.*parts.cover = false"
    ):
        _ = drive(rail_width=1.5).assembly
    assert [b.size for b in drive(rail_width=3.2).assembly.bought if b.name == "screw of a cover"][
        0
    ].startswith("M2 ")
    assert drive(rail_width=1.5, cover=False).assembly.parts
