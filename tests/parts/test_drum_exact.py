"""Drums as exact solids: splines on the walls, a closed body, the same from a STEP file; damages of the file are told."""

from __future__ import annotations

import math
import re
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from camgen.errors import DesignError, FileError
from camgen.files.formats import Job, write_part
from camgen.files.step import read_part
from camgen.findings import in_file
from camgen.geometry.brep import Brep
from camgen.geometry.drums import Drum
from camgen.geometry.splines import patch, through
from camgen.judge.drum_pieces import placed, together
from camgen.judge.rolled_drum import Rolled, roll, track_findings
from camgen.judge.round_trip import judge_exact
from camgen.machines.sources import read_mechanism
from camgen.measuring.drum import read_roller
from camgen.parts.drum_exact import FIT
from camgen.parts.exact import exact
from camgen.parts.part import Part
from camgen.pipeline.expectation import nominal_part

sys.path.insert(0, str(Path(__file__).parents[1] / "geometry"))
from drums import END, OFFSET, RIB, A, B, C, bored, rise_and_return  # noqa: E402

BREAKS = (*map(float, rise_and_return(15).breaks),)
DRUMS = {
    "groove": replace(A, breaks=BREAKS),
    "arm": replace(B, breaks=BREAKS),
    "cone": replace(C, breaks=BREAKS),
    "end": replace(END, breaks=BREAKS),
    "rib": replace(RIB, breaks=BREAKS),
}
ROLLER = "radius=5,length=7.3,inner=22,tolerance=0.005"
TOLERANCE = 1e-3
COARSE = 5e-3  # of the triangles in which a roller runs


def written(folder: Path, part: Part) -> Path:
    path = folder / "drum.step"
    job = Job("drum", "x-drum", "key", part.region, (), TOLERANCE, "bulge", None, part)
    write_part(path, job)
    return path


def read(path: Path) -> Brep:
    body, remarks = read_part(path, "drum")
    assert remarks == []
    return body


def rolled(body: Brep) -> Rolled:
    return roll(body.facets(COARSE), read_roller(ROLLER), 60, 360)


@cache
def solid(name: str) -> Brep:
    """Made once for all tests."""
    return exact(bored(DRUMS[name]), TOLERANCE)


@pytest.fixture(scope="module")
def groove(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(tmp_path_factory.mktemp("step"), bored(DRUMS["groove"]))


@pytest.fixture(scope="module")
def end(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(tmp_path_factory.mktemp("step"), bored(DRUMS["end"]))


def test_a_curve_and_a_patch_are_exact_for_cubics() -> None:
    share = np.linspace(0, 1, 9)
    curve = through(share, np.column_stack([share, share**2, 1 - share**3]))
    np.testing.assert_allclose(curve(np.array([0.31])), [[0.31, 0.31**2, 1 - 0.31**3]], atol=1e-14)
    u, v = np.meshgrid(share, share, indexing="ij")
    found = patch(share, share, np.stack([2 * u + v**2, 3 * v, u**3 + v], axis=-1))
    at = found(np.array([0.4]), np.array([0.7]))[0, 0]
    np.testing.assert_allclose(at, [0.8 + 0.49, 2.1, 0.064 + 0.7], atol=1e-14)
    # of z (x_u y_v - x_v y_u) = 6 (u^3 + v) over the unit square
    assert found.flux == pytest.approx(6 * (1 / 4 + 1 / 2), rel=1e-14)
    assert found.turned.flux == pytest.approx(-found.flux)
    assert found.bulge(2, 2)[1] == pytest.approx(0.25**2)  # v^2 over half of its range


@pytest.mark.parametrize("name", DRUMS)
def test_the_body_is_closed_and_as_large_as_the_walls_make_it(name: str) -> None:
    """Of the splines by Gauss; of the walls heights over even angles: two routes."""
    drum = DRUMS[name]
    body = solid(name)
    assert (body.faults, body.bodies) == (0, 1)
    assert body.volume == pytest.approx(drum.moments.volume - math.pi * 36 * drum.length, rel=1e-7)


@pytest.mark.parametrize("name", ["groove", "arm", "cone"])
def test_splines_lie_on_their_walls(name: str) -> None:
    drum: Drum = DRUMS[name]
    body = solid(name)
    share = np.random.default_rng(4).random(40)
    worst = 0.0
    for face in body.faces:
        if face.patch is None:
            continue
        points = face.patch(share, share)
        below = face.patch.flux > 0  # it looks up: below the roller
        wall = drum.walls[0 if below else 1]
        beta = np.arctan2(points[..., 1], points[..., 0])
        true = wall.over(beta, np.hypot(points[..., 0], points[..., 1]))
        worst = max(worst, float(np.max(np.abs(points[..., 2] - true.z) * true.lean)))
    assert 0 < worst < FIT


@pytest.mark.parametrize("name", DRUMS)
def test_facets_of_cylinders_lie_on_them(name: str) -> None:
    """In the middle of its sides a triangle with its corners on a cylinder is farthest inside."""
    mesh = solid(name).facets(COARSE)
    corners = mesh.vertices[mesh.faces]
    distance = np.hypot(corners[..., 0], corners[..., 1])
    for radius in (DRUMS[name].floor, DRUMS[name].outside):
        mine = corners[np.all(np.abs(distance - radius) < 1e-5, axis=1)]
        middles = (mine + np.roll(mine, 1, axis=1)) / 2
        assert 0 < radius - np.hypot(middles[..., 0], middles[..., 1]).min() < COARSE


def test_a_law_that_is_not_cut_where_it_breaks_is_refused() -> None:
    with pytest.raises(DesignError, match="a spline's distance from the wall"):
        exact(bored(replace(OFFSET, breaks=())), TOLERANCE)


@pytest.mark.long
def test_the_file_holds_the_drum_and_a_roller_runs_in_it(groove: Path) -> None:
    part = bored(DRUMS["groove"])
    verdict = judge_exact(groove, nominal_part(part, TOLERANCE))
    assert [each for each in verdict.findings if not each.ok] == []
    assert groove.stat().st_size < 1_200_000
    body = read(groove)
    assert body.volume == pytest.approx(solid("groove").volume, rel=1e-14)
    run = rolled(body)
    wanted = rise_and_return(15)(run.theta, 0) + 20
    assert np.abs(run.motion - wanted).max() < COARSE / 2
    assert -2 * COARSE < run.play.min() <= run.play.max() < 1e-6
    again = groove.with_name("again")
    again.mkdir(exist_ok=True)
    assert written(again, part).read_bytes() == groove.read_bytes()


def damaged(sound: Path, folder: Path, pattern: str, put: str) -> Path:
    """A copy in which the last place of a pattern is another text."""
    text = sound.read_text(encoding="ascii")
    found = [*re.finditer(pattern, text)][-1]
    path = folder / "drum.step"
    path.write_text(
        text[: found.start()] + found.expand(put) + text[found.end() :], encoding="ascii"
    )
    return path


@pytest.mark.long
def test_a_pole_that_is_moved_moves_the_roller(groove: Path, tmp_path: Path) -> None:
    """In the middle of a wall: the body stays closed, so the roller alone finds it."""
    text = groove.read_text(encoding="ascii")
    rows = re.findall(r"B_SPLINE_SURFACE_WITH_KNOTS\('',3,3,\((.*?)\),\.UNSP", text)
    refs = [row.split(",") for row in rows[1].strip("()").split("),(")]
    middle = refs[len(refs) // 2][len(refs[0]) // 2]
    place = re.search(rf"^{middle}=CARTESIAN_POINT\('',\((.*),(.*),(.*)\)\);$", text, re.MULTILINE)
    assert place is not None
    lifted = f"{middle}=CARTESIAN_POINT('',({place[1]},{place[2]},{float(place[3]) + 0.05!r}));"
    path = tmp_path / "drum.step"
    path.write_text(text.replace(place[0], lifted), encoding="ascii")
    body = read(path)
    assert body.faults == 0
    sound = read(groove)
    assert (sound.edges, sound.faces) == (read(groove).edges, read(groove).faces)
    assert sound.edges == body.edges and sound.faces != body.faces
    found = track_findings(rolled(body), read_roller(ROLLER), in_file(path))
    assert {each.code for each in found if not each.ok} == {"GROOVE_FIT"}


@pytest.mark.parametrize(
    ("pattern", "put", "codes"),
    [
        (r"(CLOSED_SHELL\('',\()#\d+,", r"\1", {"WATERTIGHT"}),
        # an edge that leaves its faces, a wider floor, knots
        (r"(B_SPLINE_CURVE_WITH_KNOTS\('',3,\(#\d+,#\d+,)#\d+", r"\1#1", None),
        (r"(CYLINDRICAL_SURFACE\('',#\d+,)21\.5", r"\g<1>21.6", {"ROUND_TRIP"}),
        (r"(B_SPLINE_SURFACE_WITH_KNOTS.*,\(0\.0,0\.)\d", r"\g<1>9", None),
        (r"(B_SPLINE_SURFACE_WITH_KNOTS\('',3,)3", r"\g<1>2", None),
        (r"(B_SPLINE_SURFACE_WITH_KNOTS.*,\(4,)1,", r"\g<1>99999999999999,", None),
        (r"(B_SPLINE_SURFACE_WITH_KNOTS.*,\(4,)1,", r"\g<1>1.5,", None),
    ],
    ids=[
        "face lost",
        "edge elsewhere",
        "floor wider",
        "knots out of order",
        "other degree",
        "too many knots",
        "half a knot",
    ],
)
def test_damages_of_the_file_are_told(
    end: Path, tmp_path: Path, pattern: str, put: str, codes: set[str] | None
) -> None:
    path = damaged(end, tmp_path, pattern, put)
    expected = nominal_part(bored(DRUMS["end"]), TOLERANCE)
    if codes is None:
        with pytest.raises(FileError):
            judge_exact(path, expected)
        return
    found = judge_exact(path, expected).findings
    assert {each.code for each in found if not each.ok} == codes


@pytest.fixture(scope="module")
def pieces() -> tuple[Part, Part]:
    """Drum with a core and a key, and the ring on it, of the starter."""
    spec = Path(__file__).parents[2] / "specs" / "cylinder-cam.toml"
    drum, ring = read_mechanism(spec, ["parts.pieces=2"]).resolved().assembly.parts
    return drum, ring


def test_both_pieces_of_a_drum_are_closed_and_as_large_as_their_walls_make_them(
    pieces: tuple[Part, Part], tmp_path: Path
) -> None:
    """Of the splines by Gauss; of parts by heights over even angles. The ring is seen from its axis within its wall."""
    for piece in pieces:
        part = replace(piece, name="drum")  # as in the file
        body = exact(part, TOLERANCE)
        assert (body.faults, body.bodies) == (0, 1)
        assert body.volume == pytest.approx(part.volume, rel=1e-7)
        path = written(tmp_path, part)
        verdict = judge_exact(path, nominal_part(part, TOLERANCE))
        assert [each for each in verdict.findings if not each.ok] == []
        assert read(path).volume == pytest.approx(body.volume, rel=1e-14)
    assert {face.radius < 0 for face in body.faces if face.radius} == {True, False}
    # the first face whose surface looks the other way is that cylinder
    text = path.read_text(encoding="ascii")
    turned = re.sub(r"(ADVANCED_FACE\('',.*,)\.F\.", r"\1.T.", text, count=1)
    assert turned != text
    path.write_text(turned, encoding="ascii")
    with pytest.raises(FileError, match="looks the other way"):
        judge_exact(path, nominal_part(part, TOLERANCE))


def test_a_roller_runs_between_both_pieces(pieces: tuple[Part, Part]) -> None:
    """At 60 deg of a cycloidal rise of 15 mm over 120 deg it has gone half of the way."""
    drum, ring = (exact(part, TOLERANCE).facets(COARSE) for part in pieces)
    mesh = together(drum, placed(ring, pieces[0].thickness))
    run = roll(mesh, read_roller("radius=5,length=4,inner=25,tolerance=0.005"), 60, 360)
    rise = np.interp(math.radians(60), run.theta, run.motion) - run.motion[0]
    assert rise == pytest.approx(7.5, abs=COARSE)
    assert run.play.max() - run.play.min() < 0.2
