"""Solids: closed, oriented, upright, exact where they can be; and refused where they cannot be made."""

import cmath
import math
import time
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import camgen
from camgen.errors import DesignError
from camgen.files.views import corners, polar_table
from camgen.geometry.mesh import Mesh
from camgen.geometry.outlines import Contour, Region, Smooth, circle, kidney, polygon
from camgen.parts.caps import triangles
from camgen.parts.part import Layer, Part, keyed_bore
from camgen.parts.solids import _check, _upright, rings, solid
from camgen.pipeline.arrangement import _levels

ROOT = Path(__file__).parents[2]
TOLERANCE = 1e-3


def oval(mean=28.0, wave=3.0, shift=6.0):
    def curve(t, order):
        rho, d, dd = (
            mean + wave * np.cos(2 * t),
            -2 * wave * np.sin(2 * t),
            -4 * wave * np.cos(2 * t),
        )
        u = np.exp(1j * t)
        return [rho * u + shift, (d + 1j * rho) * u, (dd + 2j * d - rho) * u][order]

    return Contour((Smooth(curve, 0, math.pi), Smooth(curve, math.pi, 2 * math.pi)))


def cam():
    pin = 12 * cmath.exp(-1j)
    holes = (
        keyed_bore(10, 3, 1.4),
        kidney(0, 18, 4, 0.4, 1.0),
        kidney(0, 18, 4, 2.6, 0.7),
        circle(pin, 1.5),
    )
    return Part("cam", "Cam", (Layer(Region(oval(), holes), 0, 6),), 2, (), (0j, pin))


def hub():
    disc = Layer(Region(oval(), (circle(0, 4), kidney(0, 18, 4, 0.4, 1.0))), 0, 6)
    boss = Layer(Region(circle(0, 9), (circle(0, 4),)), 6, 12)
    return Part(
        "hub",
        "Hub",
        (disc, boss),
        1,
        (Layer(Region(polygon([-18, -12, -15 + 5j])), 5.5, 6),),
        (0j,),
    )


def edge_balance(mesh: Mesh):
    """Every directed edge occurs once, and its opposite too: closed and oriented, with no help from a library."""
    edges = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]])
    codes, back = edges @ [10**6, 1], edges @ [1, 10**6]
    return len(np.unique(codes)) == len(codes) and np.array_equal(np.sort(codes), np.sort(back))


@pytest.mark.parametrize("part", [cam(), hub()], ids=lambda p: p.name)
def test_closed_oriented_float32_clean(part):
    mesh = solid(part, TOLERANCE)
    assert edge_balance(mesh)
    assert np.array_equal(mesh.vertices, mesh.vertices.astype(np.float32))
    assert not np.any(np.signbit(mesh.vertices) & (mesh.vertices == 0))
    assert len(np.unique(mesh.vertices, axis=0)) == len(mesh.vertices)
    triangles = mesh.vertices[mesh.faces]
    area = np.linalg.norm(
        np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1
    )
    assert area.min() > 0
    # facets are off by at most the tolerance along all edges
    slack = sum(TOLERANCE * layer.region.length * (layer.z1 - layer.z0) for layer in part.layers)
    assert abs(mesh.volume - part.volume) < slack
    broken = Mesh(mesh.vertices, mesh.faces[:-1])
    assert not edge_balance(broken)


@pytest.mark.parametrize("part", [cam(), hub()], ids=lambda p: p.name)
def test_walls_are_upright_to_the_bit(part):
    mesh = solid(part, TOLERANCE)
    triangles = mesh.vertices[mesh.faces]
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    walls = triangles[np.ptp(triangles[:, :, 2], axis=1) > 0]
    plan = walls[:, :, 0] + 1j * walls[:, :, 1]
    # a triangle of an upright wall has only two different places in the plan, or three in line
    twice = np.imag(np.conj(plan[:, 1] - plan[:, 0]) * (plan[:, 2] - plan[:, 0]))
    assert np.abs(twice).max() < 1e-6
    levels = {0, 5.5, 6, 12} if part.engraved else {0, 6}
    assert set(mesh.vertices[:, 2]) == levels
    assert np.all(np.abs(normal[np.ptp(triangles[:, :, 2], axis=1) == 0][:, :2]) == 0)


def test_single_layer_keeps_its_rings():
    part = cam()
    z = np.concatenate(rings(part.region, TOLERANCE))
    mesh = solid(part, TOLERANCE)
    for height, half in ((0, mesh.vertices[: len(z)]), (6, mesh.vertices[len(z) :])):
        assert np.array_equal(half, np.column_stack([z.real, z.imag, np.full(len(z), height)]))


def test_bore_is_circumscribed_and_outline_inscribed():
    region = Region(circle(0, 20), (circle(3, 5),))
    outer, bore = rings(region, 0.01)
    assert np.abs(outer).max() <= 20 * (1 + 2**-23)
    middles = (bore + np.roll(bore, 1)) / 2 - 3
    assert np.abs(middles).min() >= 5 * (1 - 2**-23) and np.abs(bore - 3).max() <= 5.01
    (pocket,) = rings(Region(circle(3, 5)), 0.01, pocket=True)
    assert np.abs((pocket + np.roll(pocket, 1)) / 2 - 3).min() >= 5 * (1 - 2**-23)


def test_clockwise_input_is_the_same_solid():
    part = cam()
    region = part.region
    other = Region(region.outer.reversed(), tuple(hole.reversed() for hole in region.holes))
    assert math.isclose(
        solid(Part("cam", "", (Layer(other, 0, 6),)), TOLERANCE).volume,
        solid(part, TOLERANCE).volume,
        rel_tol=1e-9,
    )


def test_same_part_same_arrays():
    for make in (cam, hub):
        one, two = solid(make(), TOLERANCE), solid(make(), TOLERANCE)
        assert (
            one.vertices.tobytes() == two.vertices.tobytes()
            and one.faces.tobytes() == two.faces.tobytes()
        )


BOW_TIE = polygon([0, 10 + 10j, 10, 10j])


@pytest.mark.parametrize(
    ("region", "place"),
    [
        (Region(BOW_TIE), "5 5"),
        (Region(circle(0, 20), (circle(18, 4),)), "Self-intersection"),
        (Region(circle(0, 20), (circle(40, 4),)), "outside"),
        (Region(circle(0, 20), (circle(3, 4), circle(-3, 4))), "intersection"),
        (Region(circle(0, 20), (circle(0, 8), circle(0, 3))), "nested"),
    ],
)
def test_crossing_outlines_are_refused_with_their_place(region, place):
    with pytest.raises(DesignError, match=place):
        solid(Part("bad", "", (Layer(region, 0, 5),)), TOLERANCE)


def test_layers_apart_are_refused():
    layers = (Layer(Region(circle(0, 5)), 0, 2), Layer(Region(circle(0, 5)), 3, 4))
    with pytest.raises(DesignError, match="bodies of apart is 2"):
        solid(Part("apart", "", layers), TOLERANCE)


def test_check_sees_damage():
    mesh = solid(cam(), TOLERANCE)
    _check(mesh, "cam")
    doubled = mesh.vertices.copy()
    doubled[1] = doubled[0]
    inverted, holed = Mesh(mesh.vertices, mesh.faces[:, ::-1]), Mesh(mesh.vertices, mesh.faces[1:])
    for damaged in (Mesh(doubled, mesh.faces), holed, inverted):
        with pytest.raises(DesignError):
            _check(damaged, "cam")


def test_points_in_line_carry_nothing():
    square = polygon([0, 5, 10, 10 + 5j, 10 + 10j, 10j, 5j])
    mesh = solid(Part("square", "", (Layer(Region(square), 0, 2),)), TOLERANCE)
    assert len(mesh.vertices) == 8 and math.isclose(mesh.volume, 200)


@settings(max_examples=40)
@given(st.integers(3, 60), st.integers(1, 7), st.integers(3, 30), st.floats(0, 6.2))
def test_triangles_cover_the_region(corners, holes, facets, turn):
    def ring(centre, radius, n):
        z = centre + radius * np.exp(1j * (turn + 2 * np.pi * np.arange(n) / n))
        return z.astype(np.complex64).astype(complex)

    loops = [ring(0, 100, corners)]
    loops += [ring(30 * cmath.exp(2j * math.pi * k / holes), 5, facets)[::-1] for k in range(holes)]
    covers(loops)


def covers(loops):
    """Assert that triangles lie side by side on the region of the rings and use every point; returns the points."""
    z, faces = triangles(loops)
    a, b, c = z[faces].T
    doubled = np.imag(np.conj(b - a) * (c - a))
    polygons = [np.column_stack([loop.real, loop.imag]) for loop in loops]
    assert doubled.min() > 0
    assert math.isclose(
        doubled.sum() / 2, shapely.Polygon(polygons[0], polygons[1:]).area, rel_tol=1e-9
    )
    assert set(faces.ravel()) == set(range(len(z)))
    return z


def wavy(n, waves, depth):
    phi = np.arange(n) * (2 * np.pi / n)
    return (
        ((40 + depth * np.cos(waves * phi)) * np.exp(1j * phi)).astype(np.complex64).astype(complex)
    )


@pytest.mark.parametrize(("waves", "depth"), [(3, 5.0), (40, 3.0), (1, 12.0)])
def test_long_rings_with_hollows(waves, depth):
    hole = wavy(3000, 0, -31.0)[::-1]
    assert len(covers([wavy(20_000, waves, depth), hole])) > 23_000


def test_long_rings_round_a_thin_wall():
    """The fans' points would come through a wall of 0.01 mm: earcut alone must do it."""
    outer = wavy(6000, 5, 3.0)
    inner = (0.99975 * outer[::-1]).astype(np.complex64).astype(complex)
    assert len(covers([outer, inner])) == 12_000


def test_long_rings_with_corners():
    side = np.linspace(0, 50, 3000, endpoint=False)
    bent = side + 1e-3j * side * (50 - side)  # hollow sides, square corners
    square = np.concatenate([bent, 50 + 1j * bent, 50 + 50j - bent, 50j - 1j * bent])
    assert len(covers([square.astype(np.complex64).astype(complex)])) > 12_000


@settings(max_examples=25)
@given(
    st.floats(10, 60),
    st.floats(0, 0.08),
    st.floats(-2, 2),
    st.sampled_from([1e-1, 1e-2, 1e-3, 1e-4]),
)
def test_volume_lies_within_the_facets(mean, wave, shift, tolerance):
    part = Part("p", "", (Layer(Region(oval(mean, wave * mean, shift), (circle(0, 3),)), 0, 5),))
    mesh = solid(part, tolerance)
    assert edge_balance(mesh)
    share = part.region.length * 5 * (tolerance + 60 * 2**-23)
    assert part.volume - share < mesh.volume < part.volume + 60 * 2**-23 * part.region.length * 5


def test_points_that_float32_makes_one_are_kept_once():
    """Corners 1e-8 mm apart, as short pieces give, leave one vertex; losing both would cut the corner off."""
    corners = [0, 20 + 7j, 20 + 7.00000001j, 20 + 20j, 20j]
    (ring,) = rings(Region(polygon(corners)), 1e-3)
    assert sorted(ring.tolist(), key=lambda z: (z.real, z.imag)) == [0, 20j, 20 + 7j, 20 + 20j]


@given(st.integers(0, 10**6))
@settings(max_examples=30)
def test_points_that_differ_by_rounding_take_the_first_of_them(seed):
    """Held against the definition, each point against each."""
    chance = np.random.default_rng(seed)

    def points(count, size):
        return size * (chance.normal(size=count) + 1j * chance.normal(size=count))

    known = points(20, 30.0)
    known = np.unique(known.astype(np.complex64).astype(complex))
    crossings = points(20, 30.0)
    off = [z + points(20, 10.0 ** chance.uniform(-7, -4)) for z in (known, crossings, crossings)]
    plan = chance.permutation(np.concatenate([known, crossings, *off]))
    same = 4 * 2.0**-24 * max(1.0, np.abs(plan).max())
    first = []
    expected = []
    for z in plan:
        near = [each for each in first if abs(each - z) <= same]
        if z in known:
            expected.append(z)
        elif near:
            expected.append(near[0])
        else:
            closest = known[np.argmin(np.abs(known - z))]
            first.append(closest if abs(closest - z) <= same else complex(np.complex64(z)))
            expected.append(first[-1])
    assert np.array_equal(_upright(plan, known), expected)


def test_points_of_an_outline_are_told_before_they_are_made(tmp_path: Path) -> None:
    """A circle of 1 km has a chord for each 2 sqrt(2 r e): at 1e-6 mm 2.2 million, for which a build took 90 s."""
    cam = camgen.load(ROOT / "specs" / "disc-cam.toml")
    far = cam.replace({"geometry.base_radius": 1e6, "accuracy.chord_tolerance": 1e-6})
    began = time.process_time()
    for only, most in (("dxf", 500_000), (None, 40_000)):
        with pytest.raises(DesignError, match=f"which may have {most:,} points") as refused:
            camgen.build(far, tmp_path, only=only)
        chord = 2 * math.sqrt(2 * 1e6 * 1e-6)
        least = 1e-6 * (math.tau * 1e6 / chord / most) ** 2
        assert least / 2 < refused.value.limit < 1.6 * least
    assert time.process_time() - began < 10 and not [*tmp_path.iterdir()]


def test_a_drum_of_many_points_is_refused_before_it_is_made() -> None:
    """A drum of a kilometre: its walls are nearly level there, and caps of 70,000 points took minutes."""
    drum = camgen.load(ROOT / "specs" / "cylinder-cam.toml").replace({"geometry.radius": 1e6})
    with pytest.raises(DesignError, match="which may have 40,000 points"):
        solid(drum.assembly.parts[0], 1e-3)


def test_heights_of_slopes_that_are_nearly_level_are_told_once() -> None:
    """Of a wall with a triangle each 2 um of height; faces that are clearly apart stay."""
    corners = [
        (x, k + y, z)
        for k, z in enumerate([3.0, *np.arange(1.0, 1.001, 2e-6), 0.5])
        for x, y in ((0, 0), (1, 0), (0, 1))
    ]
    found = _levels(Mesh(np.array(corners, float), np.arange(len(corners)).reshape(-1, 3)))
    assert found[0] == 3.0 and found[-1] == 0.5 and len(found) < 9
    assert max(np.diff(found)) < -2e-4


def test_a_drawing_of_a_large_cam_has_no_more_points_than_it_shows() -> None:
    """To a millionth of its size, its radii to a hundredth of that; those of a cam of the usual size are as fine as asked."""
    for radius, most in ((1e6, 1e-2), (20.0, 1e-5)):
        table = polar_table(circle(0j, radius), 10)
        assert max(abs(radius - r) for _, r in table) <= 2 * most
    assert len(corners(circle(0j, 1e6), 1e-6)) == pytest.approx(math.pi / 2e-3, rel=0.01)
    assert len(corners(circle(0j, 20.0), 1e-3)) == pytest.approx(
        math.pi * math.sqrt(20 / 2e-3), rel=0.02
    )
