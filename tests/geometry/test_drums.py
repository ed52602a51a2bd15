"""Drums: their walls against published-like numbers and the sweep of the roller itself, their solids against sections."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from drums import END, OFFSET, REFERENCE, RIB, A, B, C, bored, mesh_of, rise_and_return, swings
from hypothesis import given, settings
from hypothesis import strategies as st

from camgen.errors import DesignError
from camgen.geometry.drum_walls import DrumRoller, DrumWall, slide_path
from camgen.geometry.drums import Drum
from camgen.geometry.facets import facet_circle
from camgen.geometry.mesh import mesh_faults, slice_mesh
from camgen.parts.fits import Compensation, compensated
from camgen.parts.inertia import centre_of, inertia_of
from camgen.parts.part import drum_part, keyed_bore
from camgen.parts.sheets import why_not
from camgen.parts.solids import solid

PHI = np.linspace(0, math.tau, 36001)
RADII = REFERENCE["radii"]
DRUMS = {"a": A, "b": B, "c": C, "offset": OFFSET, "end": END, "rib": RIB}


def published(text: str) -> object:
    """A number to one of its last decimal: the reference looked at fewer angles."""
    return pytest.approx(float(text), abs=1.01 * 10.0 ** -len(text.partition(".")[2]))


def swept(wall: DrumWall, beta: float, rho: float) -> float:
    """Height of the wall by the sweep itself: of all places of the roller the one that cuts farthest at this angle and radius."""

    def cut(phi: np.ndarray) -> np.ndarray:
        x = rho * np.cos(beta - phi)
        y = rho * np.sin(beta - phi) - wall.path.beside(phi, 0)
        room = wall.roller.at(x) ** 2 - y**2
        with np.errstate(invalid="ignore"):
            height = wall.side * wall.path.height(phi, 0) + np.sqrt(room)
        return np.where((room >= 0) & (x > 0), height, -math.inf)

    middle = beta
    width = math.pi / 2
    for _ in range(9):
        phi = np.linspace(middle - width, middle + width, 201)
        middle = float(phi[np.argmax(cut(phi))])
        width *= 0.05
    return wall.side * float(np.max(cut(phi)))


def test_the_walls_have_the_reference_s_angles_and_curvature() -> None:
    below, above = A.walls
    slope = np.max(np.abs(A.path.height(PHI, 1)))
    assert slope == published(REFERENCE["a"]["peak_slope"])
    for k, r in enumerate(RADII):
        depth = np.full(len(PHI), float(r))
        steepest = np.degrees(np.max(np.abs(above.contact(PHI, depth))))
        assert steepest == published(REFERENCE["a"]["pressure_angle_deg"][k])
        for wall in (below, above):
            least = np.min(wall.area_ratio(PHI, depth))
            assert least == published(REFERENCE["a"]["area_ratio"][k])
        arm = B.walls[1].contact(PHI, depth) - swings(-PHI, 0)
        assert np.degrees(np.max(np.abs(arm))) == published(REFERENCE["b"]["pressure_angle_deg"][k])
    depth = np.full(len(PHI), 22.0)
    assert np.min(B.walls[0].area_ratio(PHI, depth)) == published(
        REFERENCE["b"]["area_ratio_at_22"]
    )
    assert np.max(np.abs(B.path.beside(PHI, 0))) == published(REFERENCE["b"]["farthest_beside"])
    assert np.max(above.points(PHI, depth).rho) == published(REFERENCE["a"]["farthest_at_22"])
    dwell = np.radians(-np.linspace(140, 160, 5))
    assert below.points(dwell, np.full(5, 26.0)).z - 15 == pytest.approx(
        REFERENCE["a"]["dwell_wall"], abs=1e-12
    )


@pytest.mark.parametrize("name", DRUMS)
@settings(max_examples=20)
@given(beta=st.floats(0, math.tau), share=st.floats(0, 1))
def test_a_wall_is_what_the_roller_sweeps(name: str, beta: float, share: float) -> None:
    drum = DRUMS[name]
    rho = drum.floor + share * (drum.outside - drum.floor)
    for wall in drum.walls:
        found = wall.over(np.array([beta]), np.array([rho]))
        assert found.z[0] == pytest.approx(swept(wall, beta, rho), abs=1e-9)


@pytest.mark.parametrize("name", DRUMS)
def test_slopes_are_those_of_the_heights(name: str) -> None:
    for wall in DRUMS[name].walls:
        beta = np.linspace(0, math.tau, 37)
        step = 1e-5

        def height(
            turn: float, out: float, wall: DrumWall = wall, beta: np.ndarray = beta
        ) -> np.ndarray:
            return wall.over(beta + turn, np.full(len(beta), 26 + out)).z

        found = wall.over(beta, np.full(len(beta), 26.0))
        along = (height(step, 0) - height(-step, 0)) / (2 * step)
        deeper = (height(0, step) - height(0, -step)) / (2 * step)
        assert found.along == pytest.approx(along, abs=1e-5)
        assert found.deeper == pytest.approx(deeper, abs=1e-5)


@pytest.mark.parametrize("name", DRUMS)
def test_a_solid_is_watertight_and_near_its_walls(name: str) -> None:
    drum = DRUMS[name]
    tolerance = 0.01
    mesh = mesh_of(drum, tolerance)
    faults = mesh_faults(mesh)
    assert (faults.count, faults.bodies) == (0, 1)
    # along the walls' normals, of the triangles' middles and of those of their edges
    corners = mesh.vertices[mesh.faces]
    edges = [(corners[:, k] + corners[:, k - 1]) / 2 for k in range(3)]
    places = np.concatenate([corners.mean(axis=1), *edges])
    slope = np.tile(np.abs(mesh.across[:, 2]) / np.linalg.norm(mesh.across, axis=1), 4)
    rho = np.hypot(places[:, 0], places[:, 1])
    inside = (rho > drum.floor) & (rho < drum.outside)
    rows = (slope > 0.3) & inside & (places[:, 2] > 0.1) & (places[:, 2] < drum.length - 0.1)
    assert rows.sum() > 3000
    beta = np.arctan2(places[rows, 1], places[rows, 0])
    off = np.full(int(rows.sum()), math.inf)
    for wall in drum.walls:
        exact = wall.over(beta, rho[rows])
        off = np.minimum(off, np.abs(exact.z - places[rows, 2]) * exact.lean)
    assert 0.7 * tolerance < off.max() < tolerance


@pytest.mark.parametrize("name", ["a", "b", "c"])
def test_no_more_triangles_than_the_reference_s(name: str) -> None:
    for tolerance, count in REFERENCE[name]["triangles"].items():
        assert len(mesh_of(DRUMS[name], float(tolerance)).faces) < count


def test_volumes_come_to_the_reference_s() -> None:
    """Both meshes stand off the walls, each by its own cells: they come together as the tolerance falls."""
    for tolerance, volume in REFERENCE["a"]["volume"].items():
        if tolerance != "0.0001":  # a quarter of a million triangles
            t = float(tolerance)
            hole = facet_circle(0j, 6, t, outside=True)
            bored_out = float(np.sum((np.conj(hole) * np.roll(hole, -1)).imag)) / 2 * A.length
            unbored = volume + math.pi * 36 * A.length
            assert mesh_of(A, t).volume + bored_out == pytest.approx(unbored, abs=350 * t)
    exact = REFERENCE["a"]["volume"]["0.0001"]
    assert bored(A).volume == pytest.approx(exact, abs=0.5)  # whose facets take 0.4


@pytest.mark.parametrize("name", DRUMS)
def test_moments_are_those_of_the_mesh(name: str) -> None:
    """By tetrahedra from the origin to each triangle, a route that knows no walls."""
    part = bored(DRUMS[name])
    mesh = mesh_of(DRUMS[name], 0.004)
    corners = mesh.vertices[mesh.faces]
    volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    z = corners[..., 0] + 1j * corners[..., 1]
    first = np.sum(volume * z.sum(axis=1)) / 4
    square = np.abs(z.sum(axis=1)) ** 2 + np.sum(np.abs(z) ** 2, axis=1)
    assert part.volume == pytest.approx(volume.sum(), rel=3e-4)
    assert centre_of(part) == pytest.approx(first / volume.sum(), abs=2e-3)
    assert inertia_of(part, 1e15) == pytest.approx(np.sum(volume * square) / 20, rel=5e-4)


def test_a_drum_is_no_sheet_and_is_printed_as_it_is() -> None:
    part = bored(A)
    assert "drum" in why_not(part, part.thickness)
    with pytest.raises(DesignError, match="cannot be compensated"):
        compensated(part, Compensation(hole=0.1))


def test_a_keyway_goes_through_a_drum() -> None:
    keyed = drum_part("drum", "Drum", A, keyed_bore(12, 4, 1.8))
    mesh = solid(keyed, 0.01)
    assert mesh_faults(mesh).count == 0
    (ring,) = (ring for ring in slice_mesh(mesh, 5.0) if ring.area < 0)
    assert ring.points.imag.max() == pytest.approx(7.8, abs=1e-5)
    assert mesh.volume == pytest.approx(keyed.volume, abs=40)  # the keyway is 400


def test_a_rib_for_two_rollers_is_thinner_where_it_is_steep() -> None:
    lower, upper = RIB.walls
    beta = np.linspace(0, math.tau, 3601)
    rho = np.full(len(beta), 26.0)
    thickness = upper.over(beta, rho).z - lower.over(beta, rho).z
    assert thickness.max() == pytest.approx(REFERENCE["rib"]["dwell_thickness"], abs=1e-9)
    square = thickness * upper.over(beta, rho).lean
    assert square.min() < thickness.max() - 1
    with pytest.raises(DesignError, match="thickness of the rib"):
        mesh_of(replace(RIB, pitch=10.0), 0.01)


def test_a_rise_that_is_too_short_is_undercut() -> None:
    span = float(REFERENCE["a"]["least_span_deg"])
    depth = np.full(len(PHI), 22.0)

    def drum(span_deg: float) -> Drum:
        return replace(A, path=slide_path(rise_and_return(15, span_deg), 20))

    assert np.min(drum(span + 0.005).walls[0].area_ratio(PHI, depth)) > 0
    assert np.min(drum(span - 0.005).walls[0].area_ratio(PHI, depth)) < 0
    with pytest.raises(DesignError, match="undercut"):
        mesh_of(drum(40.0), 0.01)


@pytest.mark.parametrize("height", [4.0, 40.0])
def test_a_track_that_leaves_the_drum_is_refused(height: float) -> None:
    with pytest.raises(DesignError, match="height of the wall"):
        mesh_of(replace(A, path=slide_path(rise_and_return(15), height)), 0.01)


def test_a_smaller_tolerance_takes_more_triangles() -> None:
    coarse, fine = (mesh_of(replace(A, roller=DrumRoller(5, 26)), t) for t in (0.1, 0.01))
    assert 2 * len(coarse.faces) < len(fine.faces) < 7000


@pytest.mark.long
@pytest.mark.parametrize("tolerance", [1e-5, 1e-7])
def test_a_tolerance_that_no_file_holds_is_refused_with_one_that_does(tolerance: float) -> None:
    """The limit is that of the files' reader, 2,000,000 triangles; what is advised takes most of them, and no more."""
    with pytest.raises(DesignError, match="accuracy.chord_tolerance") as refused:
        A.rings(tolerance)
    least = refused.value.limit
    assert least > tolerance
    rings = A.rings(least)
    assert 1.4e6 < 2 * rings.shape[0] * rings.shape[1] < 2e6
