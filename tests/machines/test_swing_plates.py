"""Plates of the swing machine: walls that are named when they vanish, and fits between parts that belong together."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from camgen.errors import DesignError
from camgen.geometry.distances import point_to_ring
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Contour, Points
from camgen.machine.cams.profile import DiscCam, SwingingArm
from camgen.machines.uniform_swing.plates import Base, Frame, overlap, swept_box
from camgen.motion.program import uniform_swing
from camgen.parts.catalogue import BEARINGS, MOTOR_FACES, SCREWS, flange
from camgen.parts.solids import solid

SWING, TIP = math.radians(30), complex(-60, -30)


def shape(contour: Contour) -> shapely.Polygon:
    ring = facet_contour(contour, 1e-4)
    return shapely.Polygon(np.column_stack([ring.real, ring.imag]))


@pytest.fixture(scope="module")
def rims() -> Points:
    """The cam of the default spec over its turn, in the frame's axes (pivot at the origin), (m, n) complex."""
    cam = DiscCam(uniform_swing(SWING), SwingingArm(60 + 0j, TIP, 3.0, 1))
    theta = np.linspace(0, 2 * math.pi, 721)[:, None]
    rim = facet_contour(cam.outline, 0.01)
    return (rim * np.exp(1j * theta) - 60) * np.exp(-1j * cam.reachable(theta))


def frame(box: complex = complex(-17.5, -30.1), **changes: Any) -> Frame:
    whole = Frame(TIP, 3.0, box + complex(1, -1), 10.0, 6.0, 24.0, 3.4, 20.0, 3.0, 6.0, 3.0)
    return replace(whole, **changes)


BASE = Base(MOTOR_FACES["nema-17"], 60.0, 6.0, 12.0, 24.0, SWING, 6.0, 3.0, 0.2)


# ---- base ------------------------------------------------------------------------------------------------------------


@given(st.floats(0.01, 80), st.floats(15, 60), st.sampled_from(sorted(MOTOR_FACES)))
def test_slot_leaves_the_axle_its_play_over_the_whole_swing(
    swing_deg: float, slide_at: float, motor: str
) -> None:
    base = replace(BASE, swing=math.radians(swing_deg), slide_at=slide_at, motor=MOTOR_FACES[motor])
    ring = facet_contour(base.slot, 1e-5)
    places = 60 + slide_at * np.exp(1j * np.linspace(-base.swing / 2, base.swing / 2, 33))
    room = point_to_ring(places, ring) - 3
    assert np.allclose(room, 0.1, atol=2e-5)
    end = 60 + slide_at * np.exp(0.5j * base.swing + 1j * base.end_room / slide_at)
    assert (
        point_to_ring(np.array([end * np.exp(1e-3j)]), ring)[0] - 3 < 0.1 - 1e-3
    )  # and no more than that


def test_base_keeps_its_walls_and_takes_the_motor() -> None:
    part = BASE.part(0.8)
    lower, upper = (layer.region for layer in part.layers)
    edge = shape(lower.outer)
    for region in (lower, upper):
        holes = [shape(hole) for hole in region.holes]
        assert (
            min(edge.exterior.distance(hole) for hole in holes) > 2.99
        )  # the wall, less the facets
        assert min(a.distance(b) for k, a in enumerate(holes) for b in holes[:k]) > 0.8
    assert len(lower.holes) == 3 + 4 + 1  # boss, axle, slot; screws; window
    assert sorted(abs(h.centroid) for h in lower.holes)[1:5] == pytest.approx(
        [31 / math.sqrt(2)] * 4
    )
    assert upper.area < lower.area
    assert solid(part, 0.01).volume == pytest.approx(part.volume, rel=1e-3)
    assert (
        edge.is_valid
        and edge.symmetric_difference(shapely.affinity.scale(edge, 1, -1, origin=(0, 0))).area
        < 0.01
    )


@pytest.mark.parametrize(
    "changes, said",
    [
        ({"thickness": 2.0}, "thickness of the base"),
        ({"swing": math.radians(350)}, "arc slot"),
        ({"slide_at": 6.5}, "between axle and slot"),
        ({"pivot": 27.0}, "room for the axle's flange"),
        (
            {"pivot": 14.0, "motor": flange(24.0, 15.0, 3, "M2"), "axle_flange": 6.0},
            "wall of the base",
        ),
    ],
)
def test_base_refuses(changes: dict[str, float], said: str) -> None:
    with pytest.raises(DesignError, match=said):
        replace(BASE, **changes).part(0.8)  # type: ignore[arg-type]


def test_base_on_its_stand() -> None:
    """Four more holes, symmetrical, off the motor's body and the way of both axles' flanges; heads below the surface."""
    held = replace(BASE, mount=SCREWS["M4"])
    part = held.part(0.8)
    assert [len(layer.region.holes) for layer in part.layers] == [12, 12]
    assert sum(held.mounts).imag == 0 and len(set(held.mounts)) == 4
    for z in held.mounts:
        assert abs(z.imag) - SCREWS["M4"].head / 2 > held.motor.half
        swept = 60 + 24 * np.exp(1j * np.linspace(-SWING / 2, SWING / 2, 99))
        assert min(abs(z - 60), *np.abs(z - swept)) > 6 + SCREWS["M4"].head / 2
    assert part.layers[1].z1 - part.layers[1].z0 == pytest.approx(SCREWS["M4"].height + 0.2)


# ---- frame -----------------------------------------------------------------------------------------------------------


def test_frame_clears_the_cam_and_its_twin_fits_it(rims: Points) -> None:
    part = frame(swept_box(rims)).part(0.8)
    assert overlap(part.region, rims.ravel(), (TIP, 4.0)) == 0
    # the tip is a round of the tip's radius where the cam touches it
    edge = facet_contour(part.region.outer, 1e-4)
    near = edge[(np.abs(edge - TIP) < 3.5) & (edge.imag > TIP.imag)]
    assert np.allclose(np.abs(near - TIP), 3, atol=2e-4)
    centres = {
        (round(hole.centroid.real, 9), round(hole.centroid.imag, 9)) for hole in part.region.holes
    }
    assert {(x, -y + 0.0) for x, y in centres} == {(x, y + 0.0) for x, y in centres}
    assert len(centres) == 6 and part.count == 2


def test_frame_in_the_way_is_seen(rims: Points) -> None:
    region = frame(swept_box(rims)).part(0.8).region
    assert overlap(region, rims.ravel() + 15, (TIP, 4.0)) > 0.5
    assert overlap(region, rims.ravel() - 5j, (TIP, 4.0)) > 0.5


@pytest.mark.parametrize(
    "changes, said",
    [
        ({"pin": 9.0}, "wall of the frame"),
        ({"axle": 40.0}, "room for the axle's hub"),
        ({"spacing": 10.0}, "wall of the frame .* between sliding axle and nozzle screw"),
        ({"tip": complex(-8, -30), "inside": complex(-7, -31)}, "room between tip and post"),
        ({"seat": 5.5}, "between edge and seat"),
        ({"slide_at": 5.0}, "wall of the frame"),
    ],
)
def test_frame_refuses(changes: dict[str, float], said: str) -> None:
    with pytest.raises(DesignError, match=said):
        frame(**changes).part(0.8)


def test_nuts_lie_between_both_frames_or_below_one() -> None:
    nut = (5.7, 2.4)
    pair, single = frame(nut=nut).part(0.8), frame(nut=nut).part(0.8, 1)
    hexagon = 5.7**2 * math.sqrt(3) / 2
    assert [(x.z0, x.z1) for x in pair.layers] == [(0, pytest.approx(4.7)), (pytest.approx(4.7), 6)]
    assert [(x.z0, x.z1) for x in single.layers] == [
        (0, pytest.approx(2.5)),
        (pytest.approx(2.5), 6),
    ]
    for part, pocket in ((pair, 1), (single, 0)):
        areas = [[abs(hole.area) for hole in layer.region.holes] for layer in part.layers]
        assert sum(area == pytest.approx(hexagon) for area in areas[pocket]) == 2
        assert part.drawn_layer == 1 - pocket and not any(
            area == pytest.approx(hexagon) for area in areas[part.drawn_layer]
        )
    with pytest.raises(DesignError, match="thickness of the frame"):
        frame(nut=nut, thickness=2.0).part(0.8)
    with pytest.raises(DesignError, match="wall of the frame"):
        frame(nut=(12.0, 2.4)).part(0.8)


def test_frame_with_a_seat_and_with_a_knife_edge() -> None:
    bearing = BEARINGS["623"]
    seated = frame(seat=bearing.bore, tip_radius=bearing.bore / 2 + 3).part(0.8)
    assert shape(seated.region.holes[-1]).area == pytest.approx(math.pi * 1.5**2, rel=1e-3)
    knife = frame(tip_radius=0.0).part(0.8)
    edge = facet_contour(knife.region.outer, 1e-4)
    assert np.min(np.abs(edge - TIP)) < 1e-12
    assert edge[np.argmax(np.where(edge.real < -40, edge.imag, -99))] == pytest.approx(TIP)
