"""A roller in a drum's mesh: against triangles that are sampled, against the motions of drums, and in damaged ones."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

sys.path.insert(0, str(Path(__file__).parents[1] / "geometry"))
from drums import END, OFFSET, REFERENCE, RIB, A, B, C, mesh_of  # noqa: E402

from camgen.geometry.drum_walls import slide_path  # noqa: E402
from camgen.geometry.drums import Drum  # noqa: E402
from camgen.geometry.mesh import Mesh  # noqa: E402
from camgen.judge.rolled_solid import SolidRoller, Wall, crossed, limits, walls  # noqa: E402
from camgen.motion.segments import SegmentTable, program  # noqa: E402

TOLERANCE = 0.01
ROLLER = SolidRoller(22, 29.3, 5)
PHI = np.linspace(0, math.tau, 720, endpoint=False)


def straight(height: np.ndarray) -> np.ndarray:
    """Of a slide without offset."""
    return np.zeros(len(height))


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    """The reference's groove."""
    return mesh_of(A, TOLERANCE)


def ends(
    mesh: Mesh, roller: SolidRoller = ROLLER, beside=straight
) -> tuple[np.ndarray, np.ndarray]:
    """Low and high end of the only groove."""
    below, above = walls(mesh, roller.inner)[1:3]
    assert (below.side, above.side) == (-1, 1)
    return limits(below, roller, PHI, beside), limits(above, roller, PHI, beside)


coordinate = st.floats(-8, 8)
corner = st.tuples(st.floats(15, 35), coordinate, coordinate)


@pytest.mark.long
@settings(max_examples=60)
@given(st.tuples(corner, corner, corner), st.sampled_from([0.0, 0.2, -0.15]), st.floats(-3, 3))
def test_a_triangle_forbids_what_its_points_forbid(
    corners: tuple[tuple[float, float, float], ...], slope: float, offset: float
) -> None:
    """All points of a grid on the triangle, each by itself: none forbids more, and the nearest comes close."""
    triangle = np.array(corners)
    roller = SolidRoller(20, 30, 5, slope)
    found = limits(
        Wall(-1, np.zeros(1, int), triangle[None], 0.0),
        roller,
        np.zeros(1),
        lambda height: np.full(1, offset),
    )[0]
    a, b = (each.ravel() for each in np.meshgrid(*[np.linspace(0, 1, 601)] * 2))
    weights = np.column_stack([1 - a, a * (1 - b), a * b])
    points = weights @ triangle
    x, y, z = points.T
    room = roller.at(x) ** 2 - (y - offset) ** 2
    inside = (x >= 20) & (x <= 30) & (room >= 0)
    if not inside.any():
        return
    nearest = np.max(z[inside] + np.sqrt(room[inside]))
    assert nearest <= found + 1e-9
    assert found - nearest < 1.0  # where the roller's edge is just met the root is steep
    fine = np.max(np.where(room > 1, np.nan_to_num(room), 0)) > 0
    if fine and inside.sum() > 180_000:
        assert found - nearest < 0.05


def test_the_roller_follows_the_motion_that_the_drum_was_made_for(mesh: Mesh) -> None:
    low, high = ends(mesh)
    wanted = A.path.height(PHI, 0)
    assert np.max(np.abs((low + high) / 2 - wanted)) < TOLERANCE
    assert np.min(high - low) > -2 * TOLERANCE
    assert np.max(high - low) < TOLERANCE
    # the wrong way round it does not
    assert np.max(np.abs((low + high) / 2 - A.path.height(-PHI, 0))) > 1


def test_a_cone_and_an_offset_are_followed() -> None:
    middle = (22 + 29.3) / 2
    cone = SolidRoller(22, 29.3, 5 + (middle - 26) * 5 / 26, 5 / 26)

    cases: list[tuple[Drum, SolidRoller, object]] = [
        (C, cone, straight),
        (OFFSET, ROLLER, lambda height: np.full(len(height), 3.0)),
    ]
    for drum, roller, beside in cases:
        low, high = ends(mesh_of(drum, TOLERANCE), roller, beside)
        assert np.max(np.abs((low + high) / 2 - drum.path.height(PHI, 0))) < TOLERANCE
        assert np.min(high - low) > -2 * TOLERANCE
        assert np.max(high - low) < TOLERANCE
    # the arm's roller on a straight line is off by what it lies beside it
    low, high = ends(mesh_of(B, TOLERANCE), ROLLER, straight)
    assert np.min(high - low) < -4 * TOLERANCE


def test_an_end_cam_has_one_wall_and_a_rib_two_turned_outwards() -> None:
    (end,) = (wall for wall in walls(mesh_of(END, TOLERANCE), 22) if wall.side < 0)
    assert limits(end, ROLLER, PHI, straight) == pytest.approx(
        A.path.height(PHI, 0), abs=1.3 * TOLERANCE
    )
    lower, upper = walls(mesh_of(RIB, TOLERANCE), 22)
    assert (lower.side, upper.side) == (1, -1)
    half = REFERENCE["rib"]["pitch"] / 2
    for wall, shift in ((lower, half), (upper, -half)):
        assert limits(wall, ROLLER, PHI, straight) + shift == pytest.approx(
            A.path.height(PHI, 0), abs=1.3 * TOLERANCE
        )


def test_a_vertex_that_stands_up_by_20_um_is_seen_as_20_um(mesh: Mesh) -> None:
    sound, _ = ends(mesh)
    vertices = mesh.vertices.copy()
    rho = np.hypot(vertices[:, 0], vertices[:, 1])
    # the lower wall's dwell, half way out
    rows = np.flatnonzero((np.abs(vertices[:, 2] - 15) < 1e-6) & (rho > 24) & (rho < 27))
    vertices[rows[0], 2] += 0.02
    low, high = ends(Mesh(vertices, mesh.faces))
    raised = low - sound
    assert raised.max() == pytest.approx(0.02, abs=1e-3)
    beta = math.atan2(vertices[rows[0], 1], vertices[rows[0], 0])
    assert abs(math.remainder(PHI[np.argmax(raised)] - beta, math.tau)) < math.radians(1)
    assert (raised > 1e-9).mean() < 0.1
    assert np.max(np.abs(high - ends(mesh)[1])) == 0


def extruded(mesh: Mesh) -> Mesh:
    """The groove that is right at the radius 26 and runs straight out from the axis."""
    vertices = mesh.vertices.copy()
    rho = np.hypot(vertices[:, 0], vertices[:, 1])
    beta = np.arctan2(vertices[:, 1], vertices[:, 0])
    ends_of_drum = (vertices[:, 2] == 0) | (vertices[:, 2] == A.length)
    exact = [wall.over(beta, np.maximum(rho, A.floor)).z for wall in A.walls]
    for wall, z in zip(A.walls, exact, strict=True):
        rows = ~ends_of_drum & (np.abs(z - vertices[:, 2]) < 1e-5)  # float32
        vertices[rows, 2] = wall.over(beta[rows], np.full(int(rows.sum()), 26.0)).z
    return Mesh(vertices, mesh.faces)


def test_a_groove_extruded_along_the_radius_has_the_right_middle_and_is_too_narrow(
    mesh: Mesh,
) -> None:
    low, high = ends(extruded(mesh), SolidRoller(22, 29.99, 5))
    assert np.max(np.abs((low + high) / 2 - A.path.height(PHI, 0))) < 2 * TOLERANCE
    assert np.min(high - low) == pytest.approx(
        float(REFERENCE["a"]["extruded_play"]), abs=2.5 * TOLERANCE
    )


def test_a_roller_that_meets_nothing_says_so(mesh: Mesh) -> None:
    below = walls(mesh, 22)[1]
    rows = below.corners[:, 0, 0] > 0
    half = Wall(-1, below.rows[rows], below.corners[rows], below.height)
    height = limits(half, ROLLER, PHI, straight)
    assert np.isnan(height[np.abs(np.degrees(PHI) - 180) < 60]).all()
    assert not np.isnan(height[np.degrees(PHI) < 60]).any()


@settings(max_examples=60)
@given(st.tuples(corner, corner, corner), st.floats(-12, 12), st.sampled_from([0.0, 0.2]))
def test_a_triangle_is_cut_where_one_of_its_points_is_in_the_roller(
    corners: tuple[tuple[float, float, float], ...], height: float, slope: float
) -> None:
    triangle = np.array(corners)
    roller = SolidRoller(20, 30, 5, slope)
    found = crossed(triangle[None], roller, np.zeros(1), np.array([height]), np.zeros(1))[0]
    a, b = (each.ravel() for each in np.meshgrid(*[np.linspace(0, 1, 151)] * 2))
    points = np.column_stack([1 - a, a * (1 - b), a * b]) @ triangle
    x, y, z = points.T

    def within(more: float) -> bool:
        """Of the roller, larger by so much."""
        radius = roller.at(x) + more
        long = (x > 20 - more) & (x < 30 + more)
        return bool((long & (np.hypot(y, z - height) < radius)).any())

    assert found or not within(-1e-9)
    assert within(0.5) or not found


# ---- a route of its own: sections of the mesh in planes through the axis ---------------------------------------------


def stretches(mesh: Mesh, angle: float) -> np.ndarray:
    """Where the half plane at an angle cuts the triangles: both ends of each stretch, (n, 2, 2), by rho and z, mm."""
    x, y, z = mesh.vertices.T
    rho = x * math.cos(angle) + y * math.sin(angle)
    off = y * math.cos(angle) - x * math.sin(angle)
    first = mesh.faces
    second = np.roll(mesh.faces, -1, axis=1)
    cut = (off[first] < 0) != (off[second] < 0)
    mine = cut.sum(axis=1) == 2
    first, second, cut = first[mine], second[mine], cut[mine]
    steps = np.where(cut, off[first] - off[second], 1.0)
    share = off[first] / steps
    at = np.stack(
        [each[first] + share * (each[second] - each[first]) for each in (rho, z)], axis=-1
    )
    return at[cut].reshape(-1, 2, 2)


def freedom(mesh: Mesh, phi: float, middle: float) -> tuple[float, float]:
    """Least and greatest height of the roller's axis at phi that points of the sections leave, about a height in between."""
    low, high = -math.inf, math.inf
    spread = 1.02 * math.asin(5 / 22)
    corners = mesh.vertices[:, 0] + 1j * mesh.vertices[:, 1]
    through = np.angle(corners * np.exp(-1j * phi))  # corners, where a section may have a peak
    through = np.unique(through[np.abs(through) < spread].round(9))
    for beta in [*np.linspace(-spread, spread, 301), *through]:
        start, end = np.moveaxis(stretches(mesh, phi + beta), 1, 0)
        even = np.repeat(np.linspace(0, 1, 9)[:, None], len(start), axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):  # upright ones
            of_ends = [(x / math.cos(beta) - start[:, 0]) / (end - start)[:, 0] for x in (22, 29.3)]
        share = np.clip(np.nan_to_num(np.vstack([even, of_ends])), 0, 1)[..., None]
        rho, z = np.moveaxis(start + share * (end - start), -1, 0)
        along = rho * math.cos(beta)
        across = rho * math.sin(beta)
        met = (along >= 22 - 1e-9) & (along <= 29.3 + 1e-9) & (np.abs(across) < 5)
        reach = np.sqrt(25 - across[met] ** 2)
        below = z[met] < middle
        low = max(low, np.max(z[met][below] + reach[below], initial=-math.inf))
        high = min(high, np.min(z[met][~below] - reach[~below], initial=math.inf))
    return low, high


@pytest.mark.long
@settings(max_examples=4, deadline=None, phases=[Phase.explicit, Phase.generate])
@given(
    span=st.floats(70, 150),
    lift=st.floats(3, 15),
    law=st.sampled_from(["cycloidal", "3-4-5", "modified-sine"]),
    phi=st.floats(0, math.tau),
)
def test_sections_through_the_axis_leave_what_the_judge_finds(
    span: float, lift: float, law: str, phi: float
) -> None:
    """Planes 0.0015 rad apart and through all corners miss at most (22 to 29 mm times half of that)^2 / 2R, 0.0001 mm."""
    rows = [
        SegmentTable(kind="rise", span_deg=span, lift=lift, law=law),
        SegmentTable(kind="dwell", span_deg=30),
        SegmentTable(kind="return", span_deg=140, to=0, law="cycloidal"),
        SegmentTable(kind="dwell"),
    ]
    drum = replace(A, path=slide_path(program(rows), 20))
    mesh = mesh_of(drum, 0.05)
    low, high = freedom(mesh, phi, float(drum.path.height(np.array([phi]), 0)[0]))
    below, above = walls(mesh, 22)[1:3]
    judged = [float(limits(wall, ROLLER, np.array([phi]), straight)[0]) for wall in (below, above)]
    assert 0 <= judged[0] - low + 1e-9 < 1.5e-4
    assert 0 <= high - judged[1] + 1e-9 < 1.5e-4
