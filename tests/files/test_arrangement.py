"""The arrangement drawing: what is seen and cut against the solids of the machine, and the sheet against its own paper."""

from __future__ import annotations

import tomllib
from collections import Counter
from dataclasses import replace
from functools import cache
from itertools import combinations
from pathlib import Path
from typing import Any

import ezdxf
import ezdxf.bbox
import numpy as np
import pytest
import shapely
from balloons_read import balloons_on

from camgen.files.arrangement import Arrangement, Copy
from camgen.files.arrangement_sheet import _Page, write_arrangement
from camgen.files.assembly_list import Item, folded, folded_in_full, height
from camgen.files.sheet import Size, Stroke, Text
from camgen.files.title_block import Facts
from camgen.geometry.outlines import Arc, Contour, extent, start_point
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import read_mechanism
from camgen.parts.solids import solid
from camgen.pipeline.arrangement import Cut, arrangement_of
from camgen.pipeline.bought_shapes import bought_shapes
from camgen.pipeline.drawings import facts_of
from camgen.pipeline.making import assembly_copies, parts_table
from camgen.pipeline.shopping import bought_things, supplies
from camgen.starters import in_metal

SPECS = Path(__file__).resolve().parents[2] / "specs"
# A stand that is upright, a drum on its side in a box, gears, a section that is not level, a coil and a lever, a cam on its shaft.
MACHINES = (
    "gallery/flapping-bird",
    "gallery/drum-feeder",
    "planetary-reducer",
    "walking-leg",
    "gallery/plate-gripper",
    "metal disc-cam",
)
FAR = 0.05  # mm from an edge, within which a point may count to either side: more than any chord


@cache
def machine(name: str) -> tuple[Mechanism, Arrangement]:
    """A shipped machine, or a starter in metal, and its arrangement."""
    starter = name.removeprefix("metal ")
    spec = SPECS / f"{name}.toml" if starter == name else tomllib.loads(in_metal(starter))
    mechanism = read_mechanism(spec)
    return mechanism, arrangement_of(mechanism, parts_table(mechanism))


class Facets:
    """Of a solid: their corners where it stands, (n, 3, 3) mm, and between what each lies in the plan, (n, 2) mm."""

    def __init__(self, corners: np.ndarray) -> None:
        self.corners = corners
        self.low, self.high = corners[:, :, :2].min(axis=1), corners[:, :, :2].max(axis=1)

    def met(self, x: float, y: float) -> np.ndarray:
        """Heights at which the upright line through (x, y) goes through them, mm."""
        at = np.array([x, y])
        corners = self.corners[((self.low <= at) & (self.high >= at)).all(axis=1)]
        flat = corners[:, :, :2] - at
        a, b, c = flat[:, 0], flat[:, 1], flat[:, 2]
        weights = np.stack(
            [p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0] for p, q in ((b, c), (c, a), (a, b))], axis=1
        )
        inside = (weights > 0).all(axis=1) | (weights < 0).all(axis=1)
        share = weights[inside] / weights[inside].sum(axis=1, keepdims=True)
        return np.sum(share * corners[inside, :, 2], axis=1)


@cache
def solids(name: str) -> list[tuple[int, Facets]]:
    """Number of every copy and its facets where it stands."""
    mechanism, _ = machine(name)
    parts = {part.name: k for k, part in enumerate(mechanism.assembly.parts, 1)}
    fine = mechanism.accuracy.chord_tolerance
    meshes = {part.name: solid(part, fine) for part in mechanism.assembly.parts}
    moved = [
        (parts[copy.object], meshes[copy.object].moved(copy.transform))
        for copy in assembly_copies(mechanism)
    ]
    return [(number, Facets(mesh.vertices[mesh.faces])) for number, mesh in moved]


@cache
def bought(name: str) -> list[tuple[int, Any, float, float]]:
    """Number, polygon and heights of every prism of what is bought and is no part."""
    mechanism, arrangement = machine(name)
    rows = {(item.what, item.designation): item.number for item in arrangement.items}
    own = {item.what: item.number for item in arrangement.items}  # of a shaft that has a sheet
    return [
        (rows.get((thing.name, thing.listing), own[thing.name]), *piece)
        for thing, shapes in bought_shapes(mechanism, bought_things(mechanism)).items()
        for shape in shapes
        for piece in shape
    ]


def highest(name: str, z: complex) -> set[int]:
    """Numbers of the parts that a line of sight meets first there, several where they are as high."""
    point = shapely.Point(z.real, z.imag)
    tops = [(max(tops), k) for k, facets in solids(name) if len(tops := facets.met(z.real, z.imag))]
    tops += [(high, k) for k, shape, _, high in bought(name) if shape.contains(point)]
    return {k for top, k in tops if top > max(tops)[0] - 1e-6}


@pytest.mark.parametrize("name", MACHINES)
def test_what_is_seen_from_the_front_is_what_a_line_of_sight_meets_first(name: str) -> None:
    """Random points: the number whose visible face holds it is that of the solid that reaches highest there."""
    _, arrangement = machine(name)
    low, high = arrangement.box
    rng = np.random.default_rng(3)
    looked = 0
    edges = shapely.union_all([edges for _, _, edges in arrangement.seen])
    for x, y in rng.uniform((low.real, low.imag), (high.real, high.imag), (400, 2)):
        point = shapely.Point(x, y)
        if edges.distance(point) < FAR:
            continue
        first = highest(name, complex(x, y))
        holders = {number for number, face, _ in arrangement.seen if face.contains(point)}
        assert holders <= first and bool(holders) == bool(first), (x, y, holders, first)
        looked += bool(first)
    assert looked > 50


@pytest.mark.parametrize("name", MACHINES)
def test_the_section_holds_what_lies_inside_of_the_solids(name: str) -> None:
    """Random points in the plane of the section: a copy's face holds one just where an odd number of its facets is above."""
    _, arrangement = machine(name)
    near, far = arrangement.deep
    origin, along = arrangement.line
    before = arrangement.bend or along
    points = np.random.default_rng(4).uniform(
        (near.real, near.imag), (far.real, far.imag), (600, 2)
    )
    beside = 1e-5  # mm, off the edges of facets that lie in the plane
    inside = 0
    made = [copy for copy in arrangement.copies if not copy.bought]
    for copy, (number, facets) in zip(made, solids(name), strict=True):
        assert copy.number == number
        edge = copy.cut.boundary
        plan = facets.corners[:, :, 0] + 1j * facets.corners[:, :, 1]
        halves = []
        for way in (along, before):
            off = np.imag((plan - origin) * np.conj(way))
            met = (off.min(axis=1) <= beside) & (off.max(axis=1) >= beside)
            halves.append(Facets(facets.corners[met]))
        for s, z in points:
            point = shapely.Point(s, z)
            if not copy.cut.is_empty and edge.distance(point) < FAR:
                continue
            at = origin + (s + 1j * beside) * (along if s > 0 else before)
            held = np.count_nonzero(halves[int(s < 0)].met(at.real, at.imag) > z) % 2 == 1
            assert copy.cut.contains(point) == held, (s, z, number)
            inside += held
    assert inside > 20


def test_what_both_views_hide_is_dashed_and_has_its_number() -> None:
    """A small plate under a large one, beside the section: two views that do not show it."""
    from camgen.files.arrangement_sheet import _Page

    large, small = shapely.box(0, 0, 30, 30), shapely.box(20, 20, 24, 25)
    copies = [
        Copy(1, [(large, 5.0)], shapely.box(0, 3, 30, 5), True),
        Copy(2, [(small, 2.0)], shapely.Polygon(), True),
    ]
    arrangement = Arrangement(copies, [], (0j, 1), [], [])
    page = _Page(arrangement)
    sheet = page.draw("two", Facts())
    dashed = [each for each in sheet.things if isinstance(each, Stroke) and each.layer == "HIDDEN"]
    (outline,) = dashed
    low, high = extent([Contour(outline.pieces)])
    assert (high - low) / page.scale == pytest.approx(4 + 5j)
    assert arrangement.shown(page.front.scale, page.section.scale)[0][2].equals(small)


def test_a_part_has_its_number_where_it_lies_nearer_to_the_outline() -> None:
    """A disc of 4 in the middle of a plate of 60, 28 inside its edge, that stands out of it in the section has its number there; one
    of 48, which is 6 inside, in the front."""
    plate = shapely.box(0, 0, 60, 60)
    disc = shapely.Point(30, 30).buffer(2)
    copies = [
        Copy(1, [(plate.difference(disc), 5.0)], shapely.box(0, 0, 60, 5), True),
        Copy(2, [(disc, 20.0)], shapely.box(28, 5, 32, 20), False),
    ]
    arrangement = Arrangement(copies, [], (30j, 1), [], [])
    front, cut = arrangement.shown(1.0, 1.0)
    assert [*front] == [1] and [*cut] == [2]
    wide = Copy(2, [(disc.buffer(22), 20.0)], shapely.box(6, 5, 54, 20), False)
    front, cut = Arrangement([copies[0], wide], [], (30j, 1), [], []).shown(1.0, 1.0)
    assert [*front] == [1, 2] and not cut


def test_screws_and_their_nuts_stand_in_their_own_holes() -> None:
    """Of the eccentric drive, from its spec and its parts' holes by hand: M2 x 35 from the sink in the plate, 2.8 over z = 0, down
    through the bar at -30, with nuts under it; M3 x 4 of the cover from 10.55 down; M2 x 10 of the clamp from 12.2 down."""
    mechanism, _ = machine("eccentric-drive")
    places = {
        thing.name: [[(round(low, 3), round(high, 3)) for _, low, high in each] for each in shapes]
        for thing, shapes in bought_shapes(mechanism, bought_things(mechanism)).items()
    }
    assert places["screw of the motor"] == 2 * [[(-32.2, 2.8), (2.8, 4.8), (2.8, 3.8)]]
    assert places["nut of the motor"] == 2 * [[(-31.6, -30.0)]]
    assert [each[0] for each in places["screw of a cover"]] == 4 * [(6.55, 10.55)]
    assert [each[0] for each in places["screw of the wire clamp"]] == 2 * [(2.2, 12.2)]
    assert len(places["screw for mounting"]) == 4 and len(places["nut"]) == 4
    assert places["drive"][0][0] == (-25.0, 0.0)


def test_a_cam_alone_is_drawn_on_its_shaft() -> None:
    """The bore of 24 begins 27 from the shaft's upper end, at z = 24 + 27: bearings of 12 from 5 and 61 on, 105 in all, rings of
    1.2 beside both. The section goes through the roller, of 16 at 40 from the axis, and through the key."""
    mechanism, arrangement = machine("metal disc-cam")
    places = {
        thing.name: [[(round(low, 2), round(high, 2)) for _, low, high in each] for each in shapes]
        for thing, shapes in bought_shapes(mechanism, bought_things(mechanism)).items()
    }
    # M5 in a hub of 36 over a keyway 2.8 deep in a bore of 20, by its own tap's height
    tap = mechanism.assembly.parts[0].tap
    assert tap is not None
    assert places["set screw of the hub"] == [[(tap.height - 2.5, tap.height + 2.5)]]
    (rod,) = places["shaft"]
    assert (min(low for low, _ in rod), max(high for _, high in rod)) == (-54.0, 51.0)
    assert [each[0] for each in places["bearing of the shaft"]] == [(34.0, 46.0), (-22.0, -10.0)]
    rings = places["retaining ring of a bearing"]
    on_first, on_second = [(46.0, 47.2), (32.7, 33.9)], [(-10.0, -8.8), (-23.3, -22.1)]
    assert [each[0] for each in rings] == on_first + on_second
    numbers = {item.what.partition(":")[0]: item.number for item in arrangement.items}
    cut = {
        (copy.number, copy.hatched): copy.cut
        for copy in arrangement.copies
        if not copy.cut.is_empty
    }
    follower = numbers["cam follower"]
    assert cut[follower, True].bounds == pytest.approx((32.0, 0.5, 48.0, 11.5))
    assert (numbers["parallel key"], False) in cut
    assert abs(arrangement.line[1].imag) == pytest.approx(1.0)


def test_a_cam_follower_has_its_stud_on_the_side_without_the_hub() -> None:
    """KR16: a ring of 11, at both ends 0.6 beyond it, and a stud of 6, 16 long [IKO], down from the cam of 12 whose hub is up to 24; and
    the races of bearings are hatched."""
    _, arrangement = machine("metal disc-cam")
    numbers = {item.what: item.number for item in arrangement.items}
    (stud,) = (
        copy
        for copy in arrangement.copies
        if copy.number == numbers["cam follower"] and not copy.hatched
    )
    assert stud.span == pytest.approx((-16.1, 12.1))
    assert stud.cut.bounds == pytest.approx((37.0, -16.1, 43.0, 12.1))
    bearings = [
        copy for copy in arrangement.copies if copy.number == numbers["bearing of the shaft"]
    ]
    assert len(bearings) == 2 and all(copy.hatched for copy in bearings)
    rows = {item.what: item.heights for item in arrangement.items}
    assert rows["cam follower"] == ["-16.1 to 12.1"]


def test_the_distance_of_bearings_and_the_bores_of_the_frame_are_told() -> None:
    """Bearings 6004 from -22 to -10 and from 34 to 46, by hand their middles 56 apart; 42 is their outside [ISO 15]."""
    from camgen.files.arrangement_sheet import _Page

    _, arrangement = machine("metal disc-cam")
    assert arrangement.bearings == [-16.0, 40.0]
    sizes = {
        each.value
        for each in _Page(arrangement).draw("cam", Facts()).things
        if isinstance(each, Size)
    }
    assert 56.0 in sizes
    assert any("42 H7" in note for note in arrangement.notes)
    _, arrangement = machine("walking-leg")
    assert not arrangement.bearings and not any("H7" in note for note in arrangement.notes)


def test_what_has_no_known_place_is_said_to_be_not_drawn() -> None:
    """A hand crank that is not made; a screw of which there are fewer holes than are bought. Glue goes where the steps say."""
    mechanism, arrangement = machine("walking-leg")
    drawn = {copy.number for copy in arrangement.copies}
    said = {item.what: (item.material, item.heights) for item in arrangement.items}
    assert said["drive"] == ("bought", ["not drawn"])
    assert said["glue"] == ("bought", ["in the steps"])
    assert said["screw of the plate, from behind"] == ("bought", ["0 to 5"])
    assert all(
        (item.heights in (["not drawn"], ["in the steps"])) != (item.number in drawn)
        for item in arrangement.items
    )
    things = bought_things(mechanism)
    (screw,) = (thing for thing in things if thing.thread)
    assert len(bought_shapes(mechanism, [screw])[screw]) == 2
    assert not bought_shapes(mechanism, [replace(screw, count=3)])


@pytest.mark.parametrize(
    "name", ["thread-take-up", "gallery/beak", "four-leg-walker", "gallery/five-bar"]
)
def test_all_screws_are_drawn_where_their_holes_are_known(name: str) -> None:
    """From behind, through a stand, of motors, and from both ends of a post."""
    mechanism = read_mechanism(SPECS / f"{name}.toml")
    things = [thing for thing in bought_things(mechanism) if thing.thread]
    shapes = bought_shapes(mechanism, things)
    assert things
    assert {thing.name: len(shapes.get(thing, ())) for thing in things} == {
        thing.name: thing.count for thing in things
    }


def test_screws_from_both_ends_of_a_spacer_meet_in_it() -> None:
    """M3 x 45 of a walker, from its sinks 1.85 over the lower and under the upper face of plates that are 141.1 apart: by hand to
    46.85, 6.3 into the spacer from 40.55 on, and from 139.25 down to 94.25."""
    mechanism = read_mechanism(SPECS / "gallery/walker.toml")
    shapes = bought_shapes(mechanism, bought_things(mechanism))
    screws = next(found for thing, found in shapes.items() if thing.length == 45)
    shanks = Counter((round(low, 2), round(high, 2)) for (_, low, high), *_ in screws)
    assert shanks == {(1.85, 46.85): 4, (94.25, 139.25): 4}


def test_the_head_of_a_screw_is_that_of_its_standard() -> None:
    """M3 x 45 with the head of ISO 4762, which is 3 high, where ISO 7380-1 has 1.65: 48 in all. Its seat is 1.85 deep in the plate."""
    _, arrangement = machine("gallery/walker")
    (heights,) = (item.heights for item in arrangement.items if item.what == "screw of a spacer")
    low, high = map(float, heights[0].split(" to "))
    assert (low, high - low) == pytest.approx((1.85 - 3.0, 48.0))


def test_a_drum_has_its_roller_in_its_track() -> None:
    """KR16: a ring of 16 x 11, 0.6 beyond it a stud of 6 x 16 [IKO]; where the drum's sheet has its axis, and how far in it reaches."""
    mechanism, _ = machine("metal cylinder-cam")
    facts = facts_of(mechanism, mechanism.assembly.parts[0])
    _, angle, height = facts.heights[0]
    assert facts.roller is not None and angle == 0.0
    inner = facts.roller[2]
    shapes = bought_shapes(mechanism, bought_things(mechanism))
    ((ring, stud),) = next(found for thing, found in shapes.items() if "KR16" in thing.size)
    assert ring[0].bounds == pytest.approx((inner, -8.0, inner + 11, 8.0))
    assert ring[1:] == pytest.approx((height - 8, height + 8))
    assert stud[0].bounds == pytest.approx((inner + 11, -3.0, inner + 27.6, 3.0))


def test_a_motor_whose_length_nothing_says_is_not_measured() -> None:
    """NEMA 17 has 42.3 across [NEMA ICS 16] and no length: the depth is that of the parts, by hand 24.8 to the collet's top over z = 0
    and the rail of 20 under it, beside what the section cuts."""
    from camgen.files.arrangement_sheet import _Page

    _, arrangement = machine("uniform-swing")
    said = {item.what: (item.number, item.heights) for item in arrangement.items}
    number, heights = said["motor"]
    assert heights == ["drawn short"]
    (motor,) = (copy for copy in arrangement.copies if copy.number == number)
    assert motor.short and motor.faces[0][0].bounds == pytest.approx((-21.15, -21.15, 21.15, 21.15))
    sheet = _Page(arrangement).draw("swing", Facts())
    sizes = {each.value for each in sheet.things if isinstance(each, Size)}
    assert sizes == {119.6, 98.7, 44.8}


def test_a_can_beside_its_shaft_stands_between_its_screws() -> None:
    """28BYJ-48: a can of 28 whose shaft is 8 off its middle [felixsu7/smart-medicine-container, 3d_model/stepper.scad]."""
    mechanism = read_mechanism(SPECS / "gallery/beak.toml")
    shapes = bought_shapes(mechanism, bought_things(mechanism))
    ((body, _, shaft),) = next(found for thing, found in shapes.items() if thing.role == "drive")
    low_x, low_y, high_x, high_y = body[0].bounds
    assert (high_x - low_x, high_y - low_y) == pytest.approx((28.0, 28.0), abs=1e-6)
    assert body[0].centroid.distance(shaft[0].centroid) == pytest.approx(8.0, abs=1e-6)


def test_a_section_has_a_dozen_heights_at_most() -> None:
    """Of 12 plates 5 thick and 1 apart: the lowest face at 0, the highest at 71, and of the rest those of the ten that are broader."""
    from camgen.files.arrangement_sheet import _Page

    wide = [170.0 if 0 < k < 6 else 100.0 for k in range(12)]
    plates = [shapely.box(0, 6.0 * k, wide[k], 6.0 * k + 5) for k in range(12)]
    front = [(shapely.box(0, 0, 170, 400), 71.0)]
    copies = [Copy(1, front, plate, True) for plate in plates]
    sheet = _Page(Arrangement(copies, [], (0j, 1), [], [])).draw("many", Facts())
    texts = [each for each in sheet.things if isinstance(each, Text) and each.layer == "DIM"]
    assert sorted(float(each.text) for each in texts) == sorted(
        [0.0, 71.0, *(6.0 * k + z for k in range(1, 6) for z in (0, 5))]
    )
    heights = sorted(each.at.imag for each in texts)
    assert all(b - a >= 1.3 * 2.5 for a, b in zip(heights, heights[1:], strict=False))


def test_the_depth_beside_a_section_is_that_of_the_whole_machine() -> None:
    """Of a walker from its motor's end, 30 under its plate, to the frame of its batteries, 8 over the far plate, whose face is at
    141.1; the section cuts less."""
    from camgen.files.arrangement_sheet import _Page

    _, arrangement = machine("gallery/walker")
    assert arrangement.deep[1].imag < 149.1
    sheet = _Page(arrangement).draw("walker", Facts())
    assert 179.1 in {each.value for each in sheet.things if isinstance(each, Size)}


def test_heights_of_a_far_side_are_not_said_twice() -> None:
    """Plates of 5 at 0 and, as their images about half of 141.1, up to that: those of both, such as the second plate from 35.55 on, have
    one height; the shaft of both sides its own; of 20 dowels 10 on one side, at more heights than there is room for."""
    _, arrangement = machine("gallery/walker")
    said = {item.what.partition(":")[0]: [*item.heights] for item in arrangement.items}
    assert said["Second plate"] == ["35.55 to 40.55"]
    assert said["Shaft of both sides"] == ["29.45 to 111.65"]
    assert said["Pin 5"] == ["7 heights from", "5.05 to 34.4"]
    assert any("about z = 70.55" in note for note in arrangement.notes)
    axes = (
        "A (-18.64, 49.28), B (-47.2, -14.08), A2 (18.64, 49.28), B2 (47.2, -14.08)"  # of its spec
    )
    assert f"Fixed axes, X and Y from O: {axes}." in arrangement.notes


def test_a_section_has_a_letter_that_no_hole_has_and_says_how_it_is_turned() -> None:
    """Of a bird whose rods have A; of a disc cam, whose roller is over the shaft, along y."""
    from camgen.files.arrangement_sheet import _Page

    _, arrangement = machine("gallery/flapping-bird")
    assert arrangement.letter == "B"
    texts = {
        each.text
        for each in _Page(arrangement).draw("bird", Facts()).things
        if isinstance(each, Text)
    }
    assert {"B-B", "O", "W", "V"} <= texts
    _, arrangement = machine("metal disc-cam")
    things = _Page(arrangement).draw("cam", Facts()).things
    names = [each.text for each in things if isinstance(each, Text) and each.text[:3] == "A-A"]
    assert len(names) == 1 and names[0].endswith("turned 90° clockwise")


def test_a_section_bends_at_the_drive_where_it_meets_more_axes_so() -> None:
    """Of a bird from the wing's pin W at (-26, 44), 51.1 off, through O to the crank pin A, 9 to its right: it cuts crank, both rods and
    the pin that joins them. V, which is 59 deg from A, is beside it. A linkage whose axes lie on one line has a straight one."""
    mechanism, arrangement = machine("gallery/flapping-bird")
    at = {axis.name: axis.at for axis in arrangement.axes}
    assert arrangement.place(at["W"]) == pytest.approx(-((26**2 + 44**2) ** 0.5))
    assert arrangement.place(9 + 0j) == pytest.approx(9.0)
    assert arrangement.place(at["V"]) is None
    parts = mechanism.assembly.parts
    over = shapely.box(5, -40, 13, 20)
    made = [copy for copy in arrangement.copies if not copy.bought]
    cut = {parts[each.number - 1].name for each in made if each.cut.intersects(over)}
    assert {"crank", "left_rod", "right_rod", "pin-2", "ground"} <= cut
    linkage = read_mechanism(tomllib.loads(in_metal("linkage")))
    assert arrangement_of(linkage, parts_table(linkage)).bend is None


def test_bearings_have_balls_and_notes_say_where_bearing_and_follower_go() -> None:
    """6004, 20 x 42: a third of 11 each for the rings, so balls of 11/3 at 15.5 from the axis. The roller's axis by its spec: 32 + 8
    at rest, 12 more at the top; the bore of the free bearing is 2 wider than its 12."""
    _, arrangement = machine("metal disc-cam")
    assert [(abs(at.real), at.imag) for at, _ in arrangement.balls] == [
        pytest.approx((15.5, z)) for z in (40.0, 40.0, -16.0, -16.0)
    ]
    assert all(radius == pytest.approx(11 / 6) for _, radius in arrangement.balls)
    notes = " ".join(arrangement.notes)
    assert "Axis of the cam follower: 40 to 52 from that of the shaft." in notes
    assert "at least 14 and open at the other" in notes and "Shown at cam angle 0 deg" in notes


def test_notes_stand_behind_each_other_where_they_fit() -> None:
    """By their own lengths, in lines that hold two short ones: the third is behind the fourth, which is longer than a line and goes on in
    the next."""
    from camgen.files.arrangement_sheet import _packed

    short = "A short one."
    long = " ".join(["longer"] * 4) + "."
    room = 2.1 * Text(0j, short, 2.5).room
    lines = _packed([short, short, long, short], room)
    assert lines[0] == f"{short} {short}"
    assert " ".join(lines[1:]) == f"{long} {short}" and len(lines) == 3
    assert all(Text(0j, line, 2.5).room <= 1.1 * room for line in lines)


def test_a_cam_and_its_section_have_one_scale_and_letters_of_one_height() -> None:
    """Of a disc cam of 76 x 92 with its shaft of 105 on an A3: both at 1:1; sizes are 3.5 high in both views. [ISO 3098]"""
    from camgen.files.arrangement_sheet import _Page

    _, arrangement = machine("metal disc-cam")
    page = _Page(arrangement)
    assert page.front.scale == page.section.scale == 1.0
    mechanism, arrangement = machine("quick-return")
    page = _Page(arrangement)
    assert page.front.scale != page.section.scale
    texts = [each for each in page.draw("rack", Facts()).primitives if isinstance(each, Text)]
    parts = mechanism.assembly.by_name
    ends = [(each.z, each.z + parts[each.part].thickness) for each in mechanism.assembly.mounts]
    whole = max(high for _, high in ends) - min(low for low, _ in ends)
    depth = [each.height for each in texts if each.text == f"({whole:.1f})"]
    assert depth == [3.5]


def test_a_washer_and_a_nut_are_on_the_stud_of_a_cam_follower() -> None:
    """KR16: a shoulder 0.6 beyond its ring, a stud of 16 [IKO], a washer of 1.6 [ISO 7089] at the shoulder and a nut that ends 1 before
    the stud. On a disc its ring is from 0.5 to 11.5, so all is under -0.1; on a drum of 37 it begins at 25, is 11 long, and what carries
    it begins at 25 + 11 + 0.6 + 1.6."""
    _, arrangement = machine("metal disc-cam")
    said = {item.what: item.heights for item in arrangement.items}
    assert said["washer of the cam follower"] == ["-1.7 to -0.1"]
    assert said["nut of the cam follower"] == ["-15.1 to -10.3"]
    _, arrangement = machine("metal cylinder-cam")
    numbers = {item.what: item.number for item in arrangement.items}
    (washer,) = (
        copy for copy in arrangement.copies if copy.number == numbers["washer of the cam follower"]
    )
    bounds = shapely.union_all([face for face, _ in washer.faces]).bounds
    assert (bounds[0], bounds[2]) == pytest.approx((36.6, 38.2))
    assert any("ring from 25, your part from 38.2 off" in note for note in arrangement.notes)


def test_what_is_used_up_is_no_item() -> None:
    """Oil and paper for gaps are in the parts list, not in the machine; glue stays in it."""
    mechanism, arrangement = machine("walking-leg")
    names = {item.what.partition(":")[0] for item in arrangement.items}
    used_up = {each.name for each in supplies(mechanism)}
    assert used_up & names == {"two-part glue"} and len(used_up) > 1 and "glue" in names


def test_a_key_fills_its_keyway_and_a_spring_reaches_from_pin_to_pin() -> None:
    """A key 3 wide from 3.2 to 6.4 mm off the axis: shaft 10 less t1 1.8, bore 10 with t2 1.4; the spring's ends by its own coil."""
    mechanism = read_mechanism(tomllib.loads(in_metal("linkage")))
    (keys,) = (
        shapes
        for thing, shapes in bought_shapes(mechanism, bought_things(mechanism)).items()
        if thing.name == "parallel key"
    )
    assert len(keys) == 2  # of crank and hand crank
    for ((shape, low, high),) in keys:
        off = np.abs(shapely.get_coordinates(shape) @ np.array([1, 1j]))
        assert shape.area == pytest.approx(3 * 3.2) and high - low == pytest.approx(6.0)
        assert off.min() == pytest.approx(abs(3.2 + 1.5j))
        assert off.max() == pytest.approx(abs(6.4 + 1.5j))
    mechanism, _ = machine("gallery/plate-gripper")
    (spring,) = mechanism.assembly.coils
    things = bought_shapes(mechanism, bought_things(mechanism))
    ((zigzag, _, _),) = next(
        shapes[0] for thing, shapes in things.items() if thing.role == "spring"
    )
    long = spring.length(mechanism.assembly.courses(np.zeros(1)))
    low_y, high_y = zigzag.bounds[1], zigzag.bounds[3]
    assert high_y - low_y == pytest.approx(long, abs=1e-6)


@pytest.mark.parametrize("name", [*MACHINES, "eccentric-drive", "uniform-swing", "stitch-head"])
def test_views_stand_beside_the_list_or_over_it(name: str) -> None:
    """No line of a view or a balloon lies in the list or the title block, and none outside the frame."""
    from camgen.files.arrangement_sheet import _Page

    _, arrangement = machine(name)
    page = _Page(arrangement)
    sheet = page.draw(name, Facts())
    top = 46 + height(page.lists[0])
    strokes = [
        each for each in sheet.primitives if isinstance(each, Stroke) and each.layer != "TEXT"
    ]
    for piece in (piece for stroke in strokes for piece in stroke.pieces):
        reach = piece.radius * (1 + 1j) if isinstance(piece, Arc) and abs(piece.sweep) > 6 else 0
        middle = piece.centre if isinstance(piece, Arc) and reach else start_point(piece)
        low, high = middle - reach, middle + reach
        assert low.real >= 20 and low.imag >= 10
        assert high.real <= page.wide - 10 and high.imag <= page.high - 10
        in_block = high.real > page.wide - 180 and high.imag < 46
        assert in_block or high.real < page.wide - 180 or low.imag > top, piece


def test_what_lies_behind_is_left_out() -> None:
    """Two plates of 10 x 10, one 4 to the right and higher: of the lower 40 mm^2 and 24 mm of its edge are seen, by hand."""
    lower, upper = shapely.box(0, 0, 10, 10), shapely.box(4, 0, 14, 10)
    copies = [Copy(1, [(lower, 2.0)], lower, True), Copy(2, [(upper, 5.0)], upper, True)]
    seen = {
        number: (face, edges)
        for number, face, edges in Arrangement(copies, [], (0j, 1), [], []).seen
    }
    assert seen[1][0].area == pytest.approx(40, abs=1e-9)
    # 10 on the left, 4 above and 4 below: the rest is under the upper plate or on its edge
    assert seen[1][1].length == pytest.approx(18, abs=1e-3)
    assert seen[2][0].area == pytest.approx(100) and seen[2][1].length == pytest.approx(40)


def test_heights_beside_the_section_are_those_of_the_faces_that_it_cuts() -> None:
    """A plate 2 thick, one 2.9 thick that lies 0.1 over it, by hand: the two faces with 0.1 between them have one height, that of the
    broader; the side of a face 0.4 wide has none, nor has the pit's floor behind 25 of a block."""
    from camgen.files.arrangement_sheet import _Page

    plates = [shapely.box(0, 0, 10, 2), shapely.box(4, 2.1, 16, 5), shapely.box(20, 0, 20.4, 7)]
    copies = [Copy(k, [(plate, 2.0 * k)], plate, True) for k, plate in enumerate(plates, 1)]
    arrangement = Arrangement(copies, [], (0j, 1), [], [])
    assert arrangement.levels(12) == [(5.0, 16.0), (2.1, 16.0), (0.0, 10.0)]
    sheet = _Page(arrangement).draw("two", Facts())
    texts = [thing for thing in sheet.things if isinstance(thing, Text) and thing.layer == "DIM"]
    heights = {thing.text: thing.at.imag for thing in texts}
    # upwards on paper, none on another
    places = [heights[text] for text in ("0", "2.1", "5")]
    assert all(b - a >= 3.3 for a, b in zip(places, places[1:], strict=False))
    block = shapely.Polygon([(0, 0), (30, 0), (30, 9), (5, 9), (5, 6), (0, 6)])
    alone = Arrangement([Copy(1, [(block, 9.0)], block, True)], [], (0j, 1), [], [])
    assert alone.levels(12) == [(9.0, 30.0), (0.0, 30.0)]


def test_both_walls_of_a_groove_are_rounded_alike() -> None:
    """A metal cylinder cam at angle 0: the groove of 16.05 about z = 15.2, from 7.175 to 23.225; halves go away from zero."""
    from camgen.files.arrangement_sheet import _Page

    _, arrangement = machine("metal cylinder-cam")
    sheet = _Page(arrangement).draw("cam", Facts())
    texts = {each.text for each in sheet.things if isinstance(each, Text) and each.layer == "DIM"}
    assert {"7.18", "23.23"} <= texts


def test_a_height_has_a_line_to_its_face() -> None:
    """Of a plate 10 wide and 2 thick beside a broader one below: the line to 2 begins 0.8 of paper right of its end."""
    from camgen.files.arrangement_sheet import _Page

    plates = [shapely.box(0, 0, 10, 2), shapely.box(0, -9, 30, -4)]
    copies = [Copy(1, [(plate, 2.0)], plate, True) for plate in plates]
    page = _Page(Arrangement(copies, [], (0j, 1), [], []))
    sheet = page.draw("two", Facts())
    starts = [
        start_point(each.pieces[0])
        for each in sheet.things
        if isinstance(each, Stroke) and each.layer == "DIM" and len(each.pieces) == 2
    ]
    faces = {0.8 + page.section.at(z) for z in (10 + 2j, 10 + 0j, 30 - 4j, 30 - 9j)}
    assert len(starts) == 4
    assert all(min(abs(start - face) for face in faces) < 1e-9 for start in starts)


def test_a_section_without_a_level_face_has_no_heights() -> None:
    """A wedge on its edge: the sheet is drawn, as one of a looper's bent needles is."""
    from camgen.files.arrangement_sheet import _Page

    wedge = shapely.Polygon([(0, 0), (9, 6), (-2, 7)])
    copies = [Copy(1, [(shapely.box(-2, 0, 9, 4), 7.0)], wedge, True)]
    arrangement = Arrangement(copies, [], (0j, 1), [], [])
    assert arrangement.levels(12) == []
    assert not [
        each
        for each in _Page(arrangement).draw("wedge", Facts()).things
        if isinstance(each, Text) and each.layer == "DIM"
    ]


@pytest.mark.parametrize("name", [*MACHINES, "gallery/walker", "gallery/heart", "cylinder-cam"])
def test_every_part_has_its_number_and_its_row(name: str, tmp_path: Path) -> None:
    """Balloons overlap nowhere, name each part at most once, and point at their own part; rows are those of the parts list."""
    from camgen.files.arrangement_sheet import _Page

    mechanism, arrangement = machine(name)
    page = _Page(arrangement)
    sheet = page.draw(name, Facts())
    named = [*balloons_on(sheet)]
    assert all(abs(a - b) >= 8.0 for a, b in combinations([each[1] for each in named], 2))
    front, cut = arrangement.shown(page.front.scale, page.section.scale)
    assert [number for number, *_ in named] == [*front, *cut] and not front.keys() & cut.keys()
    for number, _, dot in named[: len(front)]:
        z = (dot - page.front.origin) / page.front.scale + (1e-5 + 2e-5j)  # off edges of facets
        met_there = [k for k, facets in solids(name) if len(facets.met(z.real, z.imag))]
        point = shapely.Point(z.real, z.imag)
        met_there += [k for k, shape, *_ in bought(name) if shape.contains(point)]
        assert number in (met_there if number in arrangement.hidden else highest(name, z))
    for number, _, dot in named[len(front) :]:
        place = (dot - page.section.origin) / page.section.scale
        point = shapely.Point(place.real, place.imag)
        assert any(c.cut.contains(point) for c in arrangement.copies if c.number == number)
    texts = [thing for thing in sheet.primitives if isinstance(thing, Text)]
    for text in texts:
        reach = text.width * {"left": 1, "centre": 0.5, "right": 0}[text.align] * text.direction
        end = text.at + reach
        assert 20 <= text.at.real <= page.wide - 10 and 20 <= end.real <= page.wide - 9.5, text.text
        assert 10 <= text.at.imag <= page.high - 10 and 10 <= end.imag <= page.high - 10, text.text
    parts = mechanism.assembly.parts
    assert [(item.number, item.count) for item in arrangement.items[: len(parts)]] == [
        (k, part.count) for k, part in enumerate(parts, 1)
    ]
    assert [item.number for item in arrangement.items] == [*range(1, len(arrangement.items) + 1)]
    numbers = Counter(text.text for text in texts)
    assert all(numbers[str(number)] >= 2 for number in (*front, *cut))
    assert len(front) + len(cut) == len({copy.number for copy in arrangement.copies})


def test_a_section_that_would_miss_all_parts_goes_through_the_largest(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As where all axes lie beside what is made."""
    mechanism, _ = machine("gallery/flapping-bird")
    monkeypatch.setattr("camgen.pipeline.arrangement._line", lambda *_: Cut(1e4j, 1 + 0j, 1 + 0j))
    found = arrangement_of(mechanism, parts_table(mechanism))
    largest = max(found.copies, key=lambda copy: max(face.area for face, _ in copy.faces))
    assert not largest.cut.is_empty and found.line[1] == 1


def test_a_machine_of_a_kilometre_has_a_scale_too() -> None:
    _, arrangement = machine("gallery/flapping-bird")

    def long(shape: Any) -> Any:
        return shapely.transform(shape, lambda points: 1e4 * points)

    copies = [
        replace(copy, faces=[(long(face), top) for face, top in copy.faces], cut=long(copy.cut))
        for copy in arrangement.copies
    ]
    axes = [replace(axis, at=1e4 * axis.at) for axis in arrangement.axes]
    page = _Page(replace(arrangement, copies=copies, axes=axes))
    low, high = page.arrangement.box
    assert 50 < page.scale * (high.real - low.real) < page.wide


def test_the_drawing_for_cad_is_at_full_size(tmp_path: Path) -> None:
    """Its edges as ezdxf reads them are as wide and as high as the machine, from the machine's own origin."""
    _, arrangement = machine("gallery/flapping-bird")
    dxf, pdf = write_arrangement(tmp_path, "bird", arrangement, Facts())
    assert dxf.name == "bird-assembly-drawing.dxf" and pdf.read_bytes().startswith(b"%PDF")
    document = ezdxf.readfile(dxf)
    assert not document.audit().errors
    low, high = arrangement.box
    lines = document.modelspace().query('LINE[layer=="VIEW"]')
    ends = np.array([tuple(end)[:2] for line in lines for end in (line.dxf.start, line.dxf.end)])
    ahead = ends[ends[:, 1] > low.imag - 1]  # above the section and the line A
    assert ahead[:, 0].min() == pytest.approx(low.real, abs=0.01)
    assert ahead[:, 1].max() >= high.imag - 0.01


def test_a_cell_that_is_too_long_goes_on_in_the_next_line() -> None:
    """No word is left out, and no line is longer than its column of 62, in a CAD program too."""
    words = "KR16 with a cylindrical ring, not crowned: 16 x 11, stud 6 x 16 in a hole H7, M6 x 1, ISO 7063"
    item = Item(7, 1, "cam follower", words, "bought", ["0 to 12"])
    designation = [line[3] for line in item.lines]
    assert " ".join(designation) == words and len(designation) == 4
    assert all(Text(0j, line, 2.5).room <= 62 for line in designation)
    assert item.lines[0] == ("7", "1", "cam follower", designation[0], "bought", "0 to 12")


def test_a_designation_is_in_full_where_its_list_takes_no_more_columns() -> None:
    """Of 62 mm a line holds some thirty letters: thirty words of five take more than four lines. One item is 4 mm a line high, and the
    head as much."""
    words = [f"word{k:02}" for k in range(30)]
    item = Item(1, 1, "rod", " ".join(words))
    said = " ".join(line[3] for line in item.lines)
    assert "as in the parts list" in said and words[-1] not in said
    (column,) = folded_in_full([item], 100.0, 2)
    assert " ".join(line[3] for line in column[0].lines).split() == words
    assert column[0].whole and not item.whole
    (column,) = folded_in_full([item], 5 * 4.0, 2)
    assert column == [item], "a head and four lines"
    (column,) = folded_in_full([item, item], (1 + 4 + 10) * 4.0, 2)
    first, second = (" ".join(line[3] for line in each.lines) for each in column)
    assert first.split() == words and "as in the parts list" in second, "as many as have room"


@pytest.mark.parametrize(("name", "size"), [("gallery/dial-table", "A2"), ("gallery/walker", "A1")])
def test_a_list_that_a_sheet_would_cut_takes_a_larger_one(name: str, size: str) -> None:
    """All that the parts list says of the spring of a dial table, or of a walker's motor, is on the sheet, in letters of full height."""
    from camgen.files.arrangement_sheet import _Page

    mechanism, arrangement = machine(name)
    page = _Page(arrangement)
    assert page.size == size and (page.front.scale, page.section.scale) == (1.0, 1.0)
    texts = [each for each in page.draw(name, Facts()).primitives if isinstance(each, Text)]
    said = " ".join(each.text for each in texts)
    assert "as in the parts list" not in said
    longest = max(bought_things(mechanism), key=lambda thing: len(thing.listing))
    words = longest.listing.split()
    column = [each.text for each in texts if each.at.real == page.wide - 180 + 62 + 1]
    rows = " ".join(" ".join(reversed(column)).split())
    assert all(word in rows for word in words) and len(words) > 25


def test_a_list_that_is_too_high_is_folded_and_says_how_many_items_it_lacks() -> None:
    """30 items and the head are 31 lines of 4; in 88 mm there are 22 lines, one for the head: 21 items and 9, and of the one column
    20 and a line for the rest."""
    items = [Item(k, 1, "link", "link-drawing") for k in range(1, 31)]
    assert height(items) == pytest.approx(31 * 4.0)
    assert [len(each) for each in folded(items, 124.1, 1)] == [30]
    assert [len(each) for each in folded(items, 88.1, 2)] == [21, 9]
    (short,) = folded(items, 88.1, 1)
    assert [each.number for each in short] == list(range(1, 22))
    assert short[-1].designation == "10 more: see the list of parts"


def test_pins_shafts_and_what_is_bought_are_not_hatched() -> None:
    """As is usual where they are cut along their axis; links, wheels and plates are."""
    mechanism, arrangement = machine("planetary-reducer")
    hatched = {
        mechanism.assembly.parts[copy.number - 1].name: copy.hatched
        for copy in arrangement.copies
        if not copy.bought
    }
    assert not any(copy.hatched for copy in arrangement.copies if copy.bought)
    assert not any(hatched[name] for name in ("shaft", "pin-1", "knob-pin"))
    assert all(hatched[name] for name in ("ground", "carrier", "knob", "collar"))


def test_a_bush_is_hatched_though_it_is_bought() -> None:
    """It stood as an empty ring round its shaft."""
    mechanism = read_mechanism(tomllib.loads(in_metal("geneva-table")))
    copies = arrangement_of(mechanism, parts_table(mechanism)).copies
    parts = mechanism.assembly.parts
    hatched = {parts[each.number - 1].name: each.hatched for each in copies if not each.bought}
    assert hatched["bush"] and not hatched["pin-1"] and not hatched["shaft"]


def test_a_motor_s_shaft_reaches_what_it_turns() -> None:
    """The N20 lies with its face on the plate's underside, z = 0; spacer and plate are 5.05 high, the crank on its shaft 3."""
    _, arrangement = machine("gallery/walker")
    (heights,) = (item.heights for item in arrangement.items if item.what == "drive")
    assert heights == ["-30 to 8.05"]
