"""The uniform-swing mechanism: its part, the turned twin, walls, faults and designs that do not exist."""

from __future__ import annotations

import cmath
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from shapely import affinity

from camgen.errors import DesignError
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Contour
from camgen.machine.features import CamOutline, Eye
from camgen.machines.linkage.mechanism import Linkage
from camgen.machines.sources import read_mechanism
from camgen.machines.uniform_swing.mechanism import UniformSwing
from camgen.machines.uniform_swing.pictures import Model, pictures
from camgen.pipeline.shown import animation
from camgen.spec import validate

SHAFTS = ["plain", "keyway", "d-flat"]


def design(**keys: Any) -> UniformSwing:
    """Default machine with changed keys, given as table__key."""
    spec: dict[str, Any] = {
        "mechanism": "uniform-swing",
        "name": "cam",
        "geometry": {
            "pivot_distance": 60.0,
            "arm_offset": 30.0,
            "swing_deg": 30.0,
            "tip_radius": 3.0,
        },
    }
    for path, value in keys.items():
        table, key = path.split("__")
        spec.setdefault(table, {})[key] = value
    return UniformSwing.model_validate(spec)


def polygon(contour: Contour, tolerance: float = 1e-4) -> shapely.Polygon:
    z = facet_contour(contour, tolerance)
    return shapely.Polygon(np.c_[z.real, z.imag])


def walls(m: UniformSwing) -> tuple[float, list[float]]:
    """Smallest wall between bore, pin holes, windows; and that of each hole to the rim, measured by shapely."""
    region = m.assembly.parts[0].region
    rim, holes = polygon(region.outer), [polygon(h) for h in region.holes]
    assert rim.is_valid and all(h.is_valid and rim.contains(h) for h in holes)
    between = [a.distance(b) for k, a in enumerate(holes) for b in holes[k + 1 :]]
    return min(between, default=math.inf), [h.distance(rim.exterior) for h in holes]


@pytest.mark.parametrize("shaft", SHAFTS)
@pytest.mark.parametrize("wall", [1.0, 3.0])
@pytest.mark.parametrize("count", [0, 1, 5])
def test_windows_keep_the_wall(shaft: str, wall: float, count: int) -> None:
    m = design(
        parts__bore_shape=shaft,
        parts__wall=wall,
        parts__windows=count,
        parts__pin_diameter=2.0,
        parts__bore=6.0,
    )
    region = m.assembly.parts[0].region
    between, edges = walls(m)
    made = len(region.holes) - 3
    assert 0 <= made <= count
    if wall < 3 and count > 1:
        assert made
    assert between >= wall - 2e-4
    assert all(edge >= wall - 2e-4 for edge in edges[3:])


@pytest.mark.parametrize("shaft", SHAFTS)
def test_area_is_that_of_its_polygons(shaft: str) -> None:
    region = design(parts__bore_shape=shaft).assembly.parts[0].region
    expected = polygon(region.outer).area - sum(polygon(h).area for h in region.holes)
    assert region.area == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("shaft", SHAFTS)
def test_turned_over_it_fits_itself(shaft: str) -> None:
    """Turned about Oy, bore and pin holes come to lie on themselves; the rim does not."""
    region = design(parts__bore_shape=shaft).assembly.parts[0].region
    fixed = shapely.union_all([polygon(h, 1e-5) for h in region.holes[:3]])
    turned = affinity.scale(fixed, -1, 1, origin=(0, 0))
    assert fixed.symmetric_difference(turned).area < 1.1e-5 * fixed.length
    assert (
        fixed.symmetric_difference(affinity.rotate(turned, 0.01, origin=(0, 0))).area
        > 2e-5 * fixed.length
    )
    rim = polygon(region.outer)
    assert rim.symmetric_difference(affinity.scale(rim, -1, 1, origin=(0, 0))).area > 10


@pytest.mark.parametrize(
    ("shaft", "area", "top"),
    [
        ("plain", math.pi * 16, 4.0),
        # a keyway of 2 x (5 - 4) mm above the circle, counted from the chord of its width
        ("keyway", math.pi * 16 + 2 * 5 - (math.sqrt(15) + 16 * math.asin(0.25)), 5.0),
        # a segment of height 0.5 taken off
        ("d-flat", math.pi * 16 - (16 * math.acos(3.5 / 4) - 3.5 * math.sqrt(16 - 3.5**2)), 3.5),
    ],
)
def test_bores(shaft: str, area: float, top: float) -> None:
    bore = design(parts__bore_shape=shaft).assembly.parts[0].region.holes[0]
    assert abs(bore.area) == pytest.approx(area, rel=1e-9)
    assert polygon(bore, 1e-6).bounds[3] == pytest.approx(top, abs=1e-6)


def test_copies_and_layers() -> None:
    for closure, copies in (("conjugate", 2), ("force", 1)):
        m = design(geometry__closure=closure)
        (part,) = m.assembly.parts
        poses = m.assembly.poses(np.linspace(0, 6, 7))["cam"]
        assert part.count == len(poses) == len(m.assembly.features) == copies
        assert [p.flipped for p in poses] == [False, True][:copies]
        assert part.bore == 8.0 and part.layers[0].z1 == part.thickness == 6.0
        for engraved in part.engraved:
            assert (engraved.z0, engraved.z1) == (pytest.approx(5.6), 6.0)
            mark = polygon(engraved.region.outer)
            body = polygon(part.region.outer) - shapely.union_all(
                [polygon(h) for h in part.region.holes]
            )
            assert body.contains(mark)


def test_second_tip_rides_on_the_turned_cam() -> None:
    """Where features() puts the second tip it touches the turned rim, at every angle."""
    m = design(geometry__reversal_blend_deg=20.0)
    rim = polygon(m.assembly.parts[0].region.outer, 1e-5)
    theta = np.linspace(0, 2 * math.pi, 181) + 0.01
    for outline, mount in zip(m.assembly.features, m.assembly.mounts, strict=True):
        assert isinstance(outline, CamOutline) and isinstance(outline.tip, Eye)
        centre = (
            m.model.joint("pivot").b.at + outline.tip.at * np.exp(1j * m.cam.reachable(theta))
        ) * np.exp(-1j * theta)
        z = -np.conj(centre) if mount.flipped else centre
        gap = shapely.distance(shapely.points(z.real, z.imag), rim) - outline.tip.diameter / 2
        assert np.max(np.abs(gap)) < 1.1e-5


@pytest.mark.parametrize(
    ("keys", "quantity", "limit"),
    [
        ({"parts__bore": 30.0}, "parts.bore", 23.241),
        ({"parts__bore": 1000.0}, "parts.bore", 23.241),
        ({"parts__bore": 23.0, "parts__bore_shape": "keyway"}, "parts.bore", 23.241),
        ({"parts__pin_diameter": 20.0}, "wall", 0.8),
        ({"geometry__tip_radius": 15.0}, "tip_radius", 14.6078),
        ({"geometry__tip_radius": 1e6}, "tip_radius", 14.6078),
        ({"geometry__swing_deg": 53.2}, "geometry.swing_deg", 53.1301),
        ({"geometry__swing_deg": 179.0}, "geometry.swing_deg", 53.1301),
        ({"geometry__arm_offset": 0.001}, "geometry.swing_deg", 1.90986e-3),
    ],
)
def test_no_such_mechanism(keys: dict[str, Any], quantity: str, limit: float) -> None:
    with pytest.raises(DesignError) as caught:
        _ = design(**keys).assembly
    error = caught.value
    assert error.exit_code == 3
    assert error.quantity == quantity and error.limit == pytest.approx(limit, rel=1e-3)
    assert error.where and error.remedy and error.unit in ("mm", "deg")
    assert not math.isnan(error.value)


def test_a_wall_that_has_no_room_gives_way() -> None:
    """The pins go where the cam is deep: it reaches 43 mm above its shaft and 27 mm beside it."""
    m = design(parts__wall=20.0)
    between, edges = walls(m)
    assert min(between, *edges) > 5
    assert min(hole.centroid.imag for hole in m.assembly.parts[0].region.holes[1:3]) > 5


def test_sharp_bore_limit() -> None:
    """The bore's limit is the cam's nearest side: just under it the cam is only thin, just over it it is none."""
    with pytest.raises(DesignError) as caught:
        _ = design(parts__bore=100.0, parts__pin_diameter=0.0).assembly
    limit = caught.value.limit
    rim = polygon(design().assembly.parts[0].region.outer, 1e-5)
    assert limit == pytest.approx(2 * rim.exterior.distance(shapely.Point(0, 0)), abs=0.021)
    assert min(walls(design(parts__bore=limit - 0.2, parts__pin_diameter=0.0))[1]) == pytest.approx(
        0.1, abs=0.02
    )
    with pytest.raises(DesignError, match="parts.bore"):
        _ = design(parts__bore=limit + 0.05, parts__pin_diameter=0.0).assembly


@pytest.mark.parametrize(
    ("keys", "path"),
    [
        ({"parts__wall": 0.3}, "parts.wall"),
        ({"limits__min_wall": 0.3}, "limits.min_wall"),
        ({"parts__mark_depth": 6.0}, "parts.mark_depth"),
        ({"parts__bore_shape": "d-flat", "parts__flat_depth": 8.0}, "parts.flat_depth"),
        ({"parts__bore_shape": "keyway", "parts__key_width": 8.0}, "parts.key_width"),
        ({"geometry__reversal_blend_deg": 0.001}, "geometry.reversal_blend_deg"),
        ({"geometry__reversal_blend_deg": 179.9999}, "geometry.reversal_blend_deg"),
    ],
)
def test_cross_key_faults(keys: dict[str, Any], path: str) -> None:
    (fault,) = design(**keys).faults()
    assert fault.key == path and fault.value and fault.expected


def test_faults_come_all_at_once() -> None:
    assert not design().faults()
    bad = design(
        parts__wall=0.1,
        parts__mark_depth=9.0,
        limits__min_wall=0.2,
        geometry__reversal_blend_deg=1e-6,
    )
    assert len(bad.faults()) == 4
    # a key's depth does not matter on a plain shaft
    assert not design(parts__key_width=50.0, parts__flat_depth=50.0).faults()


@pytest.mark.parametrize("blend_deg", [0.0, 0.01, 17.0, 179.99, 180.0])
@pytest.mark.parametrize("rho", [0.0, 3.0, 11.0])
def test_findings_and_study(blend_deg: float, rho: float) -> None:
    geometry = {"geometry__reversal_blend_deg": blend_deg, "geometry__tip_radius": rho}
    m = design(**geometry, parts__bore=4.0, parts__pin_diameter=0.0, limits__undercut_deg=0.1)
    pressure, undercut, curvature, room, jumps = m.limits()
    assert (curvature.code, jumps.code) == ("CURVATURE", "MOTION_JUMP")
    assert room.ok
    numbers = m.study().numbers
    assert all(math.isfinite(v) for v in numbers.values())
    assert (undercut.measured > 0) == bool(m.cam.undercuts) == (numbers["undercut_deg"] > 0)
    if blend_deg == 0 and rho == 3:
        # cited, tests/reference/uniform_swing.toml
        assert undercut.measured == pytest.approx(0.0728319409614635, abs=1e-10) and undercut.ok
        assert pressure.measured == pytest.approx(58.3, abs=0.05)
        assert numbers["pitch_curvature_radius_min_mm"] == pytest.approx(10.52, abs=0.005)
        shown = animation(m, ())  # the moving picture loses as much
        loss = np.max(np.degrees(m.motion(shown.theta)) - shown.output)
        assert loss == pytest.approx(0.0728319409614635, abs=1e-9)
    theta = np.linspace(0, 2 * math.pi, 3001)
    worst = math.degrees(float(np.max(np.abs(m.motion(theta) - m.cam.reachable(theta)))))
    assert worst <= undercut.measured + 1e-12
    assert float(np.degrees(np.max(m.cam.pressure_angle(theta)))) <= pressure.measured + 1e-6
    assert float(np.ptp(np.degrees(m.motion(theta)))) == pytest.approx(30.0, abs=1e-5)


def test_a_cam_that_sweeps_over_the_followers_axle_is_told() -> None:
    """With H = L = 60 and 30 deg the tip stands farthest out where L and R enclose 45 + 15 deg: 75.56 mm, past the pivot."""
    (room,) = (
        each for each in design(geometry__arm_offset=60.0).limits() if each.code == "INTERFERENCE"
    )
    assert room.code == "INTERFERENCE" and not room.ok
    far = math.sqrt(60**2 + 7200 - 2 * 60 * math.sqrt(7200) * math.cos(math.radians(60)))
    assert room.measured == pytest.approx(
        60 - (far - 3), abs=0.1
    )  # the tip's radius acts along a slightly slanted normal


sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "bench"))
from bench_hard_cases import USUAL, outcome  # noqa: E402


@pytest.mark.long
@pytest.mark.parametrize(
    ("changes", "ends"),
    [
        ({"swing": 0.01}, "kept"),
        ({"swing": 80.0}, "refused"),
        ({"H/L": 0.0}, "refused"),
        ({"H/L": 3.0}, "kept"),
        ({"tip/L": 0.2}, "kept"),
        ({"tip/L": 0.25}, "refused: tip_radius"),
        ({"L": 0.1, "tolerance": 2e-6}, "kept"),
        ({"L": 10_000.0, "tolerance": 0.1}, "kept"),
        ({"tolerance": 1e-6}, "kept"),
        ({"tolerance": 0.1}, "kept"),
    ],
)
def test_hard_cases_keep_their_tolerance_or_are_refused(
    tmp_path: Path, changes: dict[str, float], ends: str
) -> None:
    fine, said = outcome(USUAL | changes, tmp_path)
    assert fine and said.startswith(ends)
    assert ("told: INTERFERENCE" in said) == (
        changes.get("H/L") == 3.0
    )  # the cam sweeps over the follower's axle


def test_figures_of_the_source() -> None:
    """R, alpha, r, beta by its equations 2 to 5, with beta by the arccosine as printed; L = 60, H = 30, Delta = 15 deg."""
    spec = Path(__file__).parents[2] / "specs" / "uniform-swing.toml"
    numbers = read_mechanism(spec, ["parts.make='cams'"]).study().numbers
    assert numbers["source_r_mm"] == pytest.approx(math.sqrt(60**2 + 30**2), rel=1e-14)
    for k, alpha in (
        (1, math.acos(60 / math.sqrt(4500)) - math.pi / 12),
        (2, math.acos(60 / math.sqrt(4500)) + math.pi / 12),
    ):
        r = math.sqrt(60**2 + 4500 - 2 * 60 * math.sqrt(4500) * math.cos(alpha))
        assert numbers[f"source_alpha_{k}_deg"] == pytest.approx(math.degrees(alpha), rel=1e-12)
        assert numbers[f"source_r_{k}_mm"] == pytest.approx(r, rel=1e-12)
        beta = math.degrees(math.acos(math.sqrt(4500) / r * math.sin(alpha)))
        assert numbers[f"source_beta_{k}_deg"] == pytest.approx(beta, rel=1e-12)


# ---- as a linkage with [[cam]] ----------------------------------------------------------------------------------------

# From rest to a speed that nothing changes up to the jerk, and the other way round: half a reversal.
OFF = ((0, 0, 0), (0, 1, 0), (0, 3, 0), (0, 5, 0), (1, 0, 1), (1, 2, 0), (1, 3, 0))
ON = tuple((1 - u, order, 0 if order else 1 - value) for u, order, value in OFF)


def as_linkage(m: UniformSwing) -> Linkage:
    """The same in the words of a linkage: the law as segments, the follower drawn at the inner end of its swing."""
    g, blend, swing = m.geometry, m.geometry.reversal_blend_deg, m.geometry.swing_deg
    turn = float(swing / 2 - np.degrees(m.motion(np.array([math.pi - math.radians(blend / 2)])))[0])
    start = cmath.exp(-0.5j * math.radians(swing))
    points = {
        "shaft": 0j,
        "pivot": complex(g.pivot_distance),
        "level": g.pivot_distance + 10 * start,  # its angle is s
        "tip": g.pivot_distance - complex(g.pivot_distance, g.arm_offset) * start,
    }
    halves = [{"name": "polynomial", "conditions": each} for each in (OFF, ON)]
    spans = ((blend / 2, halves[0]), (180 - blend, "uniform"), (blend / 2, halves[1]))
    ends = {"rise": (turn, swing - turn, swing), "return": (swing - turn, turn, 0.0)}
    segments = [
        {"kind": kind, "span_deg": span, "to_deg": to, "law": law}
        for kind, levels in ends.items()
        for (span, law), to in zip(spans, levels, strict=True)
        if span
    ]
    cam = {"name": "contact", "cam": "cam", "follower": "follower", "at": "tip"}
    cam |= {"radius": g.tip_radius, "closure": g.closure, "segment": tuple(segments)}
    tables = {
        "mechanism": "linkage",
        "name": "swing",
        "points": {name: (z.real, z.imag) for name, z in points.items()},
        "links": {
            "ground": ("shaft", "pivot"),
            "cam": ("shaft",),
            "follower": ("pivot", "level", "tip"),
        },
        "drive": {"link": "cam", "speed_rpm": 30.0},
        "cam": (cam,),
        "output": ({"name": "swing", "link": "follower"},),
    }
    return validate(Linkage, tables)


@pytest.mark.parametrize("blend_deg", [0.0, 20.0, 180.0])
@pytest.mark.parametrize("closure", ["conjugate", "force"])
def test_a_linkage_with_a_cam_moves_alike(blend_deg: float, closure: str) -> None:
    """The same motion, and the same cams; the second one of a pair is the first turned over about Oy."""
    m = design(geometry__reversal_blend_deg=blend_deg, geometry__closure=closure)
    linkage = as_linkage(m)
    theta = np.linspace(0, 2 * math.pi, 721) + 1e-3
    for order in range(3):
        off = linkage.motion(theta, order) - m.motion(theta, order)
        assert np.max(np.abs(off)) < 1e-9
    touches = m.model.joint("contact").touches
    tips = linkage.construction.sketched.tips
    assert len(tips) == len(touches) == (2 if closure == "conjugate" else 1)
    for tip, touch in zip(tips, touches, strict=True):
        assert np.max(np.abs(tip.turn * tip.cam.profile(theta) - touch(theta)[0])) < 1e-9


# ---- the source's figures --------------------------------------------------------------------------------------------


def test_figures_2_to_5_have_the_points_of_equations_2_to_6() -> None:
    pivot, width, half = 60.0, 30.0, math.radians(15)
    reach, alpha = (
        math.hypot(pivot, width),
        math.acos(60 / math.hypot(60, 30)) + half * np.array([-1, 1]),
    )  # eqs. 2, 3
    r = np.sqrt(pivot**2 + reach**2 - 2 * pivot * reach * np.cos(alpha))  # eq. 4
    beta = np.arccos(reach / r * np.sin(alpha))  # eq. 5
    cam = design().cam
    drawn = pictures(Model(pivot, width, 2 * half, cam))
    at = {
        plot.title.split(":")[0]: {name: complex(x, y) for name, x, y in plot.points}
        for plot in drawn
    }
    assert list(at) == [f"Source, figure {k}" for k in ("2, a", "2, b", "3", "4", "5")]
    first, second = (at[f"Source, figure {k}"] for k in (4, 5))
    start = -r[0] * complex(math.sin(beta[0]), math.cos(beta[0]))  # eq. 6
    assert (
        first["A0"] == pivot
        and first["C0"] == pytest.approx(start) == at["Source, figure 2, a"]["C"]
    )
    again = r[1] * complex(-math.sin(beta[1]), math.cos(beta[1]))
    assert second["A0"] == pytest.approx(-pivot) and second["C0"] == pytest.approx(again)
    for points in at.values():
        if {"A", "B", "C"} <= points.keys():
            a, b, c = points["A"] - points["B"], points["B"], points["C"] - points["B"]
            assert (abs(a), abs(c)) == pytest.approx((width, pivot)) and (
                a / c
            ).real == pytest.approx(0, abs=1e-12), b
    assert abs(at["Source, figure 3"]["C2"]) == pytest.approx(r[1])
    # OA runs clockwise, and each C lies on the profile: that of the cam's engine, at the same angle
    for k, phi in enumerate(np.radians([0, 45, 90, 135, 180])):
        for points, begin in ((first, 0.0), (second, math.pi)):
            assert points[f"A{k}"] == pytest.approx(pivot * cmath.exp(-1j * (phi + begin)))
            assert points[f"C{k}"] == pytest.approx(complex(cam.pitch(phi + begin)))
