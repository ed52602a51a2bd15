"""Clearance from files: against the page's table, brute force, closed forms, and seen to fail on damaged files."""

from __future__ import annotations

import math
import shutil
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import shapely
from hypothesis import example, given, settings
from hypothesis import strategies as st

from camgen import reading, spec
from camgen.files.dxf import write_dxf
from camgen.files.stl import write_stl
from camgen.files.threemf import PartCopy, write_3mf
from camgen.geometry.outlines import Region, polygon
from camgen.judge.clearance import (
    _chords,
    _way,
    convex_pieces,
    judge_clearance,
    least_distance,
    meeting,
    signed_distances,
)
from camgen.machine.features import PartPose, Passing
from camgen.machines.chain_stitch_looper.mechanism import ChainStitchLooper
from camgen.parts.part import Layer, Part
from camgen.parts.solids import solid

ROOT = Path(__file__).resolve().parents[2]
REFERENCE = tomllib.loads(
    (ROOT / "tests" / "reference" / "chain-stitch-looper.toml").read_text(encoding="utf-8")
)["clearance"]
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
PAIRS = ("N1/P1", "N2/P1", "N2/P2", "N1/P2")
SQUARE = np.array([0, 2, 2 + 2j, 2j], complex)
DART = np.array([0, 4, 4 + 4j, 3 + 1j], complex)  # not convex


# ---- shapes whose distance is known ----------------------------------------------------------------------------------


def files_in(folder: Path) -> Callable[[str, str], Path]:
    """Where the files of a part lie, by part and kind."""
    return lambda part, kind: folder / f"x-{part}.{kind}"


def circling(radius: float, centre: complex) -> Callable[[np.ndarray], np.ndarray]:
    return lambda theta: centre + radius * np.exp(1j * np.asarray(theta))


@pytest.mark.parametrize("at", [0.05, 0.8, math.pi + 0.1, 6.2])
def test_least_distance_lies_between_all_samples(at: float) -> None:
    # the point of a small triangle circles about 10 + i; nearest to the square's side x = 2 at one angle of the turn
    tip = np.array([0, 1 + 0.2j, 1 - 0.2j], complex)
    found = least_distance(
        meeting([SQUARE], [tip]), lambda t: 10 + 1j - 5 * np.exp(1j * (np.asarray(t) - at))
    )
    assert found.distance == pytest.approx(3.0, abs=2e-9)
    assert found.theta == pytest.approx(at, abs=1e-3)
    assert found.overlaps == ()


@pytest.mark.parametrize(
    ("shift", "wanted"), [(0.25, 0.25), (1e-4, 1e-4), (0.0, 0.0), (-1e-4, -1e-4), (-0.25, -0.25)]
)
def test_grazing_is_told_from_a_strike(shift: float, wanted: float) -> None:
    """A square sliding along another one: the distance is the shift, and below 0 the depth."""

    def way(theta: np.ndarray) -> np.ndarray:
        return 2 + shift + 3j * np.sin(theta)

    found = least_distance(meeting([SQUARE], [SQUARE]), way)
    assert found.distance == pytest.approx(wanted, abs=1e-9)
    assert bool(found.overlaps) == (wanted <= 0)


def test_of_a_way_to_and_fro_the_least_distance_is_where_it_turns() -> None:
    """Straight, and even but for its ends: towards the square till half a turn, then back."""
    tip = np.array([0, 1 + 0.2j, 1 - 0.2j], complex)
    found = least_distance(
        meeting([SQUARE], [tip]), lambda t: 5 + 1j + np.abs(np.asarray(t) - math.pi)
    )
    assert found.distance == pytest.approx(3.0, abs=2e-9)
    assert found.theta == pytest.approx(math.pi, abs=1e-9)


@settings(max_examples=30)
@given(
    width=st.floats(0.5, 9),
    height=st.floats(0.5, 9),
    begin=st.floats(0, 6),
    step=st.floats(1e-3, 0.3),
)
def test_a_way_leaves_its_chord_by_no_more_than_is_told(
    width: float, height: float, begin: float, step: float
) -> None:
    """An ellipse, against points along it as fine as you like; and hardly by less."""

    def way(theta: np.ndarray) -> np.ndarray:
        return width * np.cos(theta) + 1j * height * np.sin(theta)

    z = way(np.linspace(begin, begin + step, 401))
    off = np.max(np.abs(np.imag((z - z[0]) / (z[-1] - z[0])))) * abs(z[-1] - z[0])
    _, _, (told,) = _chords(way, np.array([begin]), np.array([begin + step]))
    assert off <= told <= 1.06 * off


def test_depth_is_the_shortest_way_out_and_overlaps_are_placed() -> None:
    def way(theta: np.ndarray) -> np.ndarray:
        return 3 * np.cos(theta) + 0.7j

    found = least_distance(meeting([SQUARE], [SQUARE]), way)
    assert found.distance == pytest.approx(-1.3, abs=1e-9)  # 2 - 0.7 upwards
    (first, last), (again, end) = found.overlaps
    touch = math.acos(2 / 3)
    assert (first, last, again, end) == pytest.approx(
        (touch, math.pi - touch, math.pi + touch, math.tau - touch), abs=2e-3
    )


@pytest.mark.parametrize("height", [0.0, 0.5])
def test_the_deepest_place_is_told_by_its_angle(height: float) -> None:
    """Squares of 2 mm that lie on each other once, as 3 + 4 cos is 0; the way is a straight line, or one that bends."""

    def way(theta: np.ndarray) -> np.ndarray:
        x = 3 + 4 * np.cos(theta)
        return x + 1j * height * x**2 * np.sin(theta)

    found = least_distance(meeting([SQUARE], [SQUARE]), way)
    assert found.distance == pytest.approx(-2, abs=1e-6)
    assert math.cos(found.theta) == pytest.approx(-0.75, abs=1e-6)


def still(theta: np.ndarray) -> dict[str, list[PartPose]]:
    """Bodies that stand where they are drawn, b 30 mm to the right and 4 mm higher."""
    none = np.zeros(theta.shape)
    return {
        name: [PartPose(none + at, none, z=z)]
        for name, at, z in (("a", 0j, 0.0), ("b", 30 + 0j, 4.0))
    }


def blocks(folder: Path, kind: str, widths: tuple[float, float]) -> None:
    """Squares of 20 mm whose right side lies so far from their middle, 6 mm thick."""
    for name, width in zip("ab", widths, strict=True):
        region = Region(polygon([-10 - 10j, width - 10j, width + 10j, -10 + 10j]))
        if kind == "dxf":
            write_dxf(folder / f"x-{name}.dxf", region, (), 0.01)
        else:
            write_stl(
                folder / f"x-{name}.stl",
                solid(Part(name, name, (Layer(region, 0, 6),)), 0.01),
                name,
            )


@pytest.mark.parametrize("kind", ["dxf", "stl"])
@pytest.mark.parametrize(
    "width, said, ok",
    [
        (19.0, "clear by 1.000 mm", True),
        (19.985, "grazes at", True),
        (20.015, "grazes at", True),
        (20.03, "strikes", False),
    ],
)
def test_what_outlines_may_be_off_is_grazing(
    tmp_path: Path, kind: str, width: float, said: str, ok: bool
) -> None:
    """Of both by 0.01 mm; in a solid by what float32 leaves of the larger one as well."""
    blocks(tmp_path, kind, (width, 90.0))
    found = judge_clearance(
        kind, files_in(tmp_path), [Passing("A/B", "a", "b", planes=(5.0,))], still, 0.01
    )
    (finding,) = found.findings
    assert (
        finding.ok is ok
        and said in finding.message
        and finding.measured == pytest.approx(20 - width, abs=1e-4)
    )
    size = math.hypot(90, 10) if kind == "stl" else 0.0
    slack = 0.02 + 4 * 2.0**-24 * size
    assert finding.message.endswith(f"up to {slack:.2g} mm either way is grazing")
    (figure,) = found.figures
    assert figure.key == f"clearance_a_b_{kind}_mm"
    assert figure.value == pytest.approx(20 - width, abs=1e-4)
    ((name, degrees, curve),) = found.curves
    assert name == "A/B" and degrees[-1] == 360 and np.allclose(curve, 20 - width, atol=1e-4)


@pytest.mark.parametrize("kind, ok", [("dxf", False), ("stl", True)])
def test_of_large_solids_float32_leaves_more_than_the_tolerance(
    tmp_path: Path, kind: str, ok: bool
) -> None:
    """0.03 mm of overlap beside 90 m, of which 24 bits are 0.02 mm: at every height the larger size counts."""
    blocks(tmp_path, kind, (20.03, 90e3))
    pair = Passing("A/B", "a", "b", planes=(4.5, 5.0))
    (finding,) = judge_clearance(kind, files_in(tmp_path), [pair], still, 0.01).findings
    assert finding.ok is ok


def test_what_cannot_be_compared_is_told(tmp_path: Path) -> None:
    """No section at a height that one of both does not reach, and a drawing that is open or has nothing to cut."""
    blocks(tmp_path, "stl", (19.0, 10.0))
    for height, lacks in ((2.0, "b"), (8.0, "a")):
        (finding,) = judge_clearance(
            "stl", files_in(tmp_path), [Passing("A/B", "a", "b", planes=(5.0, height))], still, 0.01
        ).findings
        assert (
            math.isnan(finding.measured)
            and finding.message == f"no section of {lacks} at height {height:g} mm"
        )
    blocks(tmp_path, "dxf", (19.0, 10.0))
    for entity, said in (("line", "is no part of a cut"), ("", "nothing is drawn to be cut")):
        drawing = ezdxf.new()
        if entity:
            drawing.modelspace().add_line((0, 0), (5, 0))
        drawing.saveas(tmp_path / "x-b.dxf")
        (finding,) = judge_clearance(
            "dxf", files_in(tmp_path), [Passing("A/B", "a", "b")], still, 0.01
        ).findings
        assert math.isnan(finding.measured) and said in finding.message


@pytest.mark.parametrize("turned, angle", [("a", 0.0), ("b", 0.0), ("a", 1e-3), ("b", 1e-3)])
@pytest.mark.parametrize("flipped", [False, True])
def test_only_bodies_that_shift_are_compared(turned: str, angle: float, flipped: bool) -> None:
    """One that turns on a part of its way alone, or that lies turned over, is refused; else b's way is what a sees of it."""

    def poses(theta: np.ndarray) -> dict[str, list[PartPose]]:
        still = np.zeros(theta.shape)
        ways = {"a": 3 * np.exp(1j * theta), "b": 5 + 1j * theta}
        return {
            name: [
                PartPose(
                    way,
                    angle * (theta > 3) if name == turned else still,
                    flipped and name == turned,
                )
            ]
            for name, way in ways.items()
        }

    theta = np.linspace(0, math.tau, 9)
    way = _way(Passing("x", "a", "b"), poses)
    if angle or flipped:
        with pytest.raises(ValueError, match="x: only bodies that shift are compared"):
            way(theta)
    else:
        np.testing.assert_allclose(way(theta), 5 + 1j * theta - 3 * np.exp(1j * theta))


def test_pieces_fill_what_is_not_convex() -> None:
    assert len(convex_pieces(SQUARE)) == 1 and len(convex_pieces(SQUARE[::-1])) == 1
    parts = [shapely.Polygon(np.column_stack([z.real, z.imag])) for z in convex_pieces(DART)]
    whole = shapely.Polygon(np.column_stack([DART.real, DART.imag]))
    assert sum(p.area for p in parts) == pytest.approx(whole.area)
    # in the dart's notch a small square is clear, though the hull holds it
    assert signed_distances(meeting([DART], [SQUARE / 10]), np.array([1.5 + 1.2j]))[0] > 0
    assert signed_distances(meeting([DART], [SQUARE / 10]), np.array([3.4 + 0.5j]))[0] < 0


CORNERS = st.lists(
    st.complex_numbers(max_magnitude=4, allow_nan=False, allow_infinity=False),
    min_size=3,
    max_size=7,
)


def hull(points: list[complex]) -> np.ndarray | None:
    found = shapely.convex_hull(
        shapely.MultiPoint([(round(z.real, 9), round(z.imag, 9)) for z in points])
    )
    if found.geom_type != "Polygon" or found.area < 0.1:
        return None
    x, y = np.array(found.exterior.coords)[:-1].T
    return np.asarray(x + 1j * y)


@pytest.mark.long
@settings(max_examples=40)
@example(
    [0j, -2 + 1.125j, 2 - 1j], [0j, -2 + 1.125j, 2 - 1j], 4.0, 0.0, 0.0
)  # along a straight line, not evenly
@given(CORNERS, CORNERS, st.floats(0.5, 8), st.floats(0, 8), st.floats(0, 6.2))
def test_never_above_any_sample_and_reached_by_one(a, b, width, height, phase):  # type: ignore[no-untyped-def]
    first, second = hull(a), hull(b)
    if first is None or second is None:
        return

    def way(theta: np.ndarray) -> np.ndarray:
        return 3 + width * np.cos(theta) + 1j * height * np.sin(2 * np.asarray(theta) + phase)

    found = least_distance(meeting([first], [second]), way)
    theta = np.linspace(0, math.tau, 1001)
    bodies = shapely.polygons(
        [np.column_stack([z.real, z.imag]) for z in second + way(theta)[:, None]]
    )
    fixed = shapely.Polygon(np.column_stack([first.real, first.imag]))
    sampled = float(np.min(shapely.distance(fixed, bodies)))
    step = (width + 2 * height) * math.tau / 1000
    if found.distance > 0:
        assert sampled - step <= found.distance <= sampled + 1e-8
    else:
        assert sampled <= step
        # moving out by the depth along no direction parts them sooner: try 360
        ways = np.exp(1j * np.linspace(0, math.tau, 361))
        at = way(np.array([found.theta]))[0]
        short = at + ways * (-found.distance) * 0.99
        assert np.all(signed_distances(meeting([first], [second]), short) <= 1e-9)


# ---- files -----------------------------------------------------------------------------------------------------------


def machine(**keys: Any) -> ChainStitchLooper:
    data = reading.read(ROOT / "specs" / "chain-stitch-looper.toml")
    data["geometry"] |= {"plate_to_spreader": 8, "blade_length": 45, "p6_setback": 0}
    data["limits"]["clearance"] = 0
    for path, value in keys.items():
        table, key = path.split("__")
        data.setdefault(table, {})[key] = value
    return spec.validate(ChainStitchLooper, data)


DESIGNS = {
    "r08": {"geometry__velocity_ratio": 0.8, "timing__needle_stroke": 34.0},
    "published": {"geometry__velocity_ratio": 0.8, "geometry__mode": "published"},
    "r12": {"geometry__velocity_ratio": 41.7 / 34, "timing__needle_stroke": 34.0},
}


def written(m: ChainStitchLooper, folder: Path) -> None:
    for part in m.assembly.parts[:4]:
        mesh = solid(part, m.accuracy.chord_tolerance)
        write_stl(folder / f"x-{part.name}.stl", mesh, part.name)
        write_3mf(
            folder / f"x-{part.name}.3mf",
            {part.name: mesh},
            [PartCopy(part.name, part.name)],
            "key",
        )


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[ChainStitchLooper, Path]]:
    found = {}
    for name, keys in DESIGNS.items():
        folder = tmp_path_factory.mktemp(name)
        found[name] = (machine(**keys), folder)
        written(*found[name])
    return found


def judged(m: ChainStitchLooper, folder: Path, kind: str = "stl", **changes: Any):  # type: ignore[no-untyped-def]
    pairs = [
        replace(pair, **changes) if pair.name in PAIRS else pair for pair in m.assembly.passing
    ]
    return judge_clearance(
        kind, files_in(folder), pairs, m.assembly.poses, m.accuracy.chord_tolerance
    )


@pytest.mark.long
@pytest.mark.parametrize("kind", ["stl", "3mf"])
@pytest.mark.parametrize("name", DESIGNS)
def test_the_table_comes_out_of_the_files(
    made: dict[str, tuple[ChainStitchLooper, Path]], name: str, kind: str
) -> None:
    cleared = judged(*made[name], kind)
    assert [str(f.where).split(":")[0] for f in cleared.findings] == [*PAIRS, "P1/P2"]
    for finding, wanted in zip(cleared.findings, REFERENCE[name], strict=False):
        assert finding.ok == (wanted >= 0)
        if wanted > 0:
            assert (
                finding.measured == pytest.approx(wanted, abs=5.1e-4)
                and "clear by" in finding.message
            )
        elif wanted == 0:
            assert abs(finding.measured) < 1e-5 and "grazes" in finding.message
        else:
            assert finding.measured < -0.05 and "strikes" in finding.message
    assert cleared.findings[4].measured == pytest.approx(0.1, abs=1e-5)


@pytest.mark.long
def test_strikes_are_as_deep_as_the_source_has_them(
    made: dict[str, tuple[ChainStitchLooper, Path]],
) -> None:
    inside, offsets = REFERENCE["published_inside"], made["published"][0].design.offsets()
    d = made["published"][0].design
    at_top = offsets["N1/P1"] + d.l2 - d.spreader_stroke / d.needle_stroke * d.given.height
    assert -at_top == pytest.approx(inside[0], abs=0.005) and -offsets["N2/P2"] == pytest.approx(
        inside[1], abs=0.006
    )
    # at right angles to P6 needle 1 comes in by less than along the stroke, and no deeper than the corner lets it
    deepest = judged(*made["published"]).findings[0].measured
    assert (
        -0.14 < deepest < -0.14 * math.sin(math.atan2(1, d.spreader_stroke / d.needle_stroke)) * 0.9
    )


@pytest.mark.long
def test_curves_agree_with_the_least_distance(
    made: dict[str, tuple[ChainStitchLooper, Path]],
) -> None:
    for name in DESIGNS:
        cleared = judged(*made[name])
        for finding, (_, theta, curve) in zip(cleared.findings, cleared.curves, strict=True):
            assert len(theta) == len(curve) and np.min(curve) >= finding.measured - 1e-6
            # steps of a degree move a body by 0.4 mm at the most
            assert np.min(curve) <= finding.measured + 0.42


@pytest.mark.long
def test_spreaders_that_touch_graze(tmp_path: Path) -> None:
    m = machine(**DESIGNS["r08"], parts__running_gap=0.0)
    written(m, tmp_path)
    last = judged(m, tmp_path).findings[-1]
    assert last.ok and abs(last.measured) < 1e-5 and "grazes" in last.message


def test_more_distance_can_be_asked_for(made: dict[str, tuple[ChainStitchLooper, Path]]) -> None:
    assert [f.ok for f in judged(*made["r08"], gap=3.0).findings] == [
        False,
        True,
        False,
        True,
        True,
    ]


@pytest.mark.long
def test_other_laws_out_of_step_against_brute_force(tmp_path: Path) -> None:
    m = machine(**DESIGNS["r12"], timing__lag_deg=12.0, timing__spreader="cycloidal")
    written(m, tmp_path)
    cleared = judged(m, tmp_path)
    theta = np.linspace(0, math.tau, 4001)
    poses = m.assembly.poses(theta)
    section = np.array(
        [m.design.l1 - 1j * 0.9, 57 - 0.9j, 57 + 3.5j, m.design.nose + 3.5j, m.design.l1]
    )
    for finding, spreader, k in zip(cleared.findings, ("lower", "upper"), (0, 1), strict=False):
        body = section if spreader == "upper" else -section.conj()
        pair = next(f for f in cleared.findings if str(f.where).startswith(f"N{k + 1}/P{k + 1}"))
        h = m.geometry.point_lengths[k]
        needle = np.array([0, 0.45 + 1j * h, 0.45 + 60j, -0.45 + 60j, -0.45 + 1j * h])
        shifts = poses[f"needle-{k + 1}"][0].place - poses[f"{spreader}-spreader"][0].place
        brute = float(np.min(signed_distances(meeting([body], [needle]), shifts)))
        assert finding.code == "CLEARANCE"
        assert pair.measured == pytest.approx(brute, abs=0.02)
        assert pair.measured <= brute + 1e-4


# ---- damage ----------------------------------------------------------------------------------------------------------


def edit(path: Path, change: Callable[[np.ndarray], np.ndarray]) -> None:
    data = path.read_bytes()
    triangles = np.frombuffer(data[84:], TRIANGLE).copy()
    triangles["corners"] = change(triangles["corners"].astype(float))
    path.write_bytes(data[:84] + triangles.tobytes())


@pytest.fixture
def folder(made: dict[str, tuple[ChainStitchLooper, Path]], tmp_path: Path) -> Path:
    return Path(shutil.copytree(made["r08"][1], tmp_path / "x"))


def failing(m: ChainStitchLooper, folder: Path) -> set[str]:
    return {str(f.where).split(":")[0] for f in judged(m, folder).findings if not f.ok}


def test_a_sound_folder_passes(
    made: dict[str, tuple[ChainStitchLooper, Path]], folder: Path
) -> None:
    assert failing(made["r08"][0], folder) == set()


def test_a_front_that_stands_out_by_10_um_strikes(
    made: dict[str, tuple[ChainStitchLooper, Path]], folder: Path
) -> None:
    def forward(c: np.ndarray) -> np.ndarray:
        near = (np.abs(c[..., 0] - 8) < 1e-3) & (np.abs(c[..., 1]) < 1e-3)
        c[near, 0] -= 0.01
        return c

    edit(folder / "x-upper-spreader.stl", forward)
    assert failing(made["r08"][0], folder) == {"N2/P2"}


def test_a_thicker_spreader_meets_the_other(
    made: dict[str, tuple[ChainStitchLooper, Path]], folder: Path
) -> None:
    def thicker(c: np.ndarray) -> np.ndarray:
        c[..., 1] = np.where(c[..., 1] < -0.5, c[..., 1] - 0.15, c[..., 1])
        return c

    edit(folder / "x-upper-spreader.stl", thicker)
    assert failing(made["r08"][0], folder) == {"P1/P2"}


def test_a_needle_of_another_length_is_told(
    made: dict[str, tuple[ChainStitchLooper, Path]], folder: Path
) -> None:
    def longer(c: np.ndarray) -> np.ndarray:
        c[..., 1] = np.where(c[..., 1] < 1, c[..., 1] - 0.5, c[..., 1])
        return c

    edit(folder / "x-needle-2.stl", longer)
    assert failing(made["r08"][0], folder) == {"N2/P2"}


def test_a_body_moved_out_of_the_plane_is_told(
    made: dict[str, tuple[ChainStitchLooper, Path]], folder: Path
) -> None:
    edit(folder / "x-needle-1.stl", lambda c: c + [0, 0, 5])
    lost = [f for f in judged(made["r08"][0], folder).findings if not f.ok]
    assert len(lost) == 2 and all(
        math.isnan(f.measured) and "no section of needle-1" in f.message for f in lost
    )


def test_bodies_that_turn_are_refused(made: dict[str, tuple[ChainStitchLooper, Path]]) -> None:
    m, at = made["r08"]

    def turning(theta: np.ndarray) -> Any:
        found = dict(m.assembly.poses(theta))
        found["needle-1"] = [replace(found["needle-1"][0], angle=theta)]
        return found

    with pytest.raises(ValueError, match="shift"):
        judge_clearance("stl", files_in(at), m.assembly.passing, turning, 0.001)
