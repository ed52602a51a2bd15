"""The ground as parts: the plate under level 1, and where asked for a second one over all levels, on posts.

plate      hubs round its pivots, holes for two screws from behind, rails
post       at a place that nothing sweeps; a screw from either side, heads sunk into the plates, cuts its thread in it; of two sides
           with spacers between them one screw goes through plates and post into the spacer
second     hubs round what it holds: far ends of pins and shafts, pins that hang from it
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import count, product

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.convex import distance
from camgen.geometry.outlines import Contour, Points, circle, rectangle
from camgen.machine.features import Mount
from camgen.parts.catalogue import HEAD_ROOM, Bought, shortest_screw
from camgen.parts.generator.connections import Sleeve
from camgen.parts.generator.dowels import disc_dowels, dowel_holes, stud_holes
from camgen.parts.generator.layout import GROUND, Layout
from camgen.parts.generator.link_outlines import link_hubs, slot_holes
from camgen.parts.generator.second_plate import (
    ceiling_height,
    channels_in,
    far_hole,
    in_first,
    sleeve_ends,
)
from camgen.parts.generator.sizes import SIDE_SPACER, SUNK, Battery, Parts
from camgen.parts.generator.troughs import rails
from camgen.parts.hardware import plate, spacer
from camgen.parts.level_rules import Axis, Thing, Wall, ways
from camgen.parts.part import GluedNote, HoldingNote, Layer, Part, d_bore, hull

SECOND = "second-plate"
# mm, between places that are tried for a post, and how far beyond the ground's points at first
_STEP = 4.0
_BEYOND = 40.0
_MOST_STEPS = 250  # from the middle outwards; of a machine that is larger they are longer
_AT_ONCE = 256  # places that are tried together
_EVERY = 8  # samples of the motion: posts need no finer ones
_ENGAGED = 2.0  # diameters of a screw in a spacer, at least: its thread is cut in a print
_LEAST = 2.0  # posts' diameters between two of them


def post_radius(sizes: Parts) -> float:
    """Of a post, mm."""
    return sizes.mount_diameter / 2 + sizes.wall + sizes.head


def columns(
    things: Sequence[Thing],
    corners: Sequence[complex],
    radius: float,
    gap: float,
    kept: Sequence[tuple[complex, float]],
) -> tuple[complex, ...]:
    """Places of four posts that all things pass by at `gap`, mm, on whichever level they lie.

    They are next to the corners of the box round the ground's points, one in each quarter of it; kept: discs that their hubs
    do not meet. They are looked for within _BEYOND of that box, then twice as far out, and so on: beyond what moves there is room.
    """
    low = complex(min(z.real for z in corners), min(z.imag for z in corners))
    high = complex(max(z.real for z in corners), max(z.imag for z in corners))
    needed = []
    for thing in things:
        corners_of = thing.place[None] if isinstance(thing, Axis) else thing.corners
        course = corners_of[:, ::_EVERY]
        least = thing.radius + radius + gap + ways(course)
        middle = complex(course.mean())
        needed.append((course, least, middle, float(np.abs(course - middle).max() + least.max())))

    def free(places: Points) -> np.ndarray:
        """Which of the places nothing meets, (n,) bool."""
        clear = np.ones(len(places), bool)
        for z, keeps in kept:
            clear &= np.abs(places - z) > radius + keeps + gap
        for course, least, middle, reach in needed:
            left = np.flatnonzero(clear & (np.abs(places - middle) < reach))
            n = course.shape[1]
            apart = distance(np.tile(course, len(left)), np.repeat(places[left], n)[None])
            clear[left] = np.all(apart.reshape(-1, n) >= least, axis=1)
        return clear

    for beyond in (_BEYOND * 2**k for k in count()):
        posts: list[complex] = []
        for corner, quarter in _quarters(low, high, beyond):
            for post in posts:
                quarter = quarter[np.abs(quarter - post) > 2 * _LEAST * radius]
            near = quarter[np.argsort(np.abs(quarter - corner), kind="stable")]
            tries = (near[k : k + _AT_ONCE] for k in range(0, len(near), _AT_ONCE))
            place = next((some[clear][0] for some in tries if (clear := free(some)).any()), None)
            if place is None:
                break
            posts.append(complex(place))
        else:
            break
    return tuple(posts)


def _quarters(low: complex, high: complex, beyond: float) -> Iterator[tuple[complex, Points]]:
    """Corners of a box, and the places that are tried in its quarters, no further than so much beyond it, mm; (n,) each."""
    middle = (low + high) / 2
    half = (high - low) / 2
    reach = half.real + beyond, half.imag + beyond
    step = max(_STEP, max(reach) / _MOST_STEPS)
    x, y = (step * np.arange(-k, k + 1) for k in (int(each // step) for each in reach))
    off = (x[:, None] + 1j * y[None, :]).ravel()
    for sx, sy in product((-1, 1), (-1, 1)):
        corner = complex(high.real if sx > 0 else low.real, high.imag if sy > 0 else low.imag)
        yield corner, middle + off[(off.real * sx >= 0) & (off.imag * sy >= 0)]


def ground_plate(layout: Layout, name: str, collar: float, notes: Sequence[str]) -> Part:
    """The plate under level 1; collar: radius of those of shafts, mm."""
    s = layout.sizes
    points = {
        name: z
        for name, z in layout.points_of(GROUND).items()
        if name in layout.thread_posts or (name in layout.pivots and in_first(layout, name))
    }
    pivots = [point for point in points if layout.on_ground(point)]
    holes = {
        f"hole {point}": circle(z, layout.hole(point, GROUND) / 2)
        for point, z in points.items()
        if point not in pivots
    }
    holes |= {
        f"dowel {k} of {point}": circle(z, wide)
        for point in pivots
        for k, (z, wide) in enumerate(disc_dowels(layout, point), 1)
    }
    hubs = [(z, layout.hub(point, GROUND)) for point, z in points.items()]
    hubs += [disc for disc in link_hubs(layout, GROUND) if disc not in layout.round_hubs(GROUND)]
    channels = channels_in(layout, False)
    holes |= slot_holes(layout, GROUND, channels.keys()) | dowel_holes(layout, GROUND)
    holes |= stud_holes(layout, GROUND)
    hubs += [(z, layout.hub(point, GROUND)) for point, ends in channels.items() for z in ends]
    posts, through, sunk = _posts(layout)
    screws = _mount_screws(layout, points, hubs, posts, collar)
    radius = s.mount_diameter / 2
    face = s.face
    pockets = {}
    if face is not None:
        wide = (face.screw.head + HEAD_ROOM) / 2
        screws_at = [z + screw for z in _motors(layout, points) for screw in face.screws]
        hubs += [(z, wide + s.wall) for z in screws_at]
        holes |= {
            f"motor screw {k}": circle(z, face.screw.clearance / 2)
            for k, z in enumerate(screws_at, 1)
        }
        pockets = {f"motor screw {k}": circle(z, wide) for k, z in enumerate(screws_at, 1)}
    hubs += posts
    holes |= through
    holes |= {f"screw {k}": circle(z, radius) for k, z in enumerate(screws, 1)}
    holes |= layout.fitted.holes
    hubs += layout.fitted.hubs
    holes |= {f"foot {k}": circle(z, wide / 2) for k, (z, wide) in enumerate(layout.feet, 1)}
    hubs += [(z, wide / 2 + layout.rim) for z, wide in layout.feet]
    outer = hull([*hubs, *((z, radius + s.wall) for z in screws)])
    floor = s.base_thickness
    whole = plate("ground plate", outer, holes, layout.min_wall)
    heads = 0.0 if not sunk else _depth(s)
    layers = (
        [Layer(plate("ground plate", outer, holes | sunk, layout.min_wall), 0.0, heads)]
        if sunk
        else []
    )
    layers.append(Layer(whole, heads, floor))
    if pockets:
        low = floor - s.pocket
        region = plate("ground plate", outer, holes | pockets, layout.min_wall)
        layers = [*layers[:-1], Layer(whole, heads, low), Layer(region, low, floor)]
    return Part(
        name,
        "Ground plate",
        (*layers, *rails(layout, GROUND, floor)),
        centres=(*points.values(), *screws, *(z for z, _ in layout.feet)),
        min_wall=layout.min_wall,
        drawn_layer=int(bool(sunk)),
        notes=(*(["the outermost holes are for screws from behind"] if screws else []), *notes),
        points=tuple(points.items()),
    )


def _motors(layout: Layout, points: Mapping[str, complex]) -> list[complex]:
    """Places of the shafts that motors turn."""
    return [points[layout.shaft_of(link)] for link in layout.drivers]


def _mount_screws(
    layout: Layout,
    points: Mapping[str, complex],
    hubs: Sequence[tuple[complex, float]],
    posts: Sequence[tuple[complex, float]],
    collar: float,
) -> list[complex]:
    """Places of the screws that hold the plate, on the line of what lies furthest apart on it; none of one that hangs.

    points, hubs, posts: what it has; collar: radius of those of shafts, mm.
    """
    s = layout.sizes
    # of a screw, beside what is there; a board that metal is screwed on has a wall there
    head = s.mount_diameter * (2 if layout.metal else 1)
    motors = _motors(layout, points)
    # a thread in metal has its own diameter beside a seat
    beside = [(z, radius + s.mount_diameter * layout.metal) for z, radius in hubs]
    beside += [(points[shaft], collar + head) for shaft in layout.shafts if shaft in points]
    if s.face is not None:
        beside += [(motor, s.face.reach + head) for motor in motors]
    if s.hand_crank:  # screws lie beside its way
        beside.append((motors[0], s.hand_crank + s.pin_diameter + s.head + head))
    if s.stand != "none":  # heads under the plate pass the stand's panel beside the screws
        beside += [(z, s.pin_diameter / 2 + s.head + head) for z in points.values()]
    beside += [(z, wide / 2 + head) for z, wide in layout.feet]
    beside += posts
    pairs = [(a, b) for a in beside for b in beside]
    a, b = max(pairs, key=lambda pair: abs(pair[1][0] - pair[0][0]) + pair[0][1] + pair[1][1])
    way = (b[0] - a[0]) / abs(b[0] - a[0]) if a[0] != b[0] else 1.0 + 0j
    for link in layout.drivers:
        _refuse_rails(layout, layout.shaft_of(link))
    if not layout.screwed:
        return []
    radius = s.mount_diameter / 2
    screws = [a[0] - way * (a[1] + radius), b[0] + way * (b[1] + radius)]
    return [*screws, _third(beside, a[0], way, radius)] if s.mount_screws == 3 else screws


def _third(
    hubs: Sequence[tuple[complex, float]], origin: complex, way: complex, radius: float
) -> complex:
    """Place of a screw's hole beyond the hub that reaches farthest from a line; way: of that, a unit vector."""
    off = [((z - origin) / way).imag for z, _ in hubs]
    k = max(range(len(hubs)), key=lambda each: abs(off[each]) + hubs[each][1])
    return hubs[k][0] + math.copysign(1, off[k]) * 1j * way * (hubs[k][1] + radius)


def _refuse_rails(layout: Layout, shaft: str) -> None:
    """DesignError where a rail would stand over the seat of the boss of the motor whose shaft is at a point."""
    seat = layout.hole(shaft, GROUND) / 2 if layout.sizes.face else 0.0
    motor = layout.at(GROUND, shaft)
    for link, guide in layout.guides.items():
        ends = [rail for rail in guide.rails if seat and guide.joint.guide.body == GROUND]
        for a, b in ends:
            foot = min(1.0, max(0.0, ((motor - a) / (b - a)).real))
            wall = abs(a + foot * (b - a) - motor) - seat - layout.sizes.rail_width / 2
            if wall < layout.min_wall:
                quantity = "wall between the motor's seat and the guide"
                remedy = "draw the guide further from the shaft, or use a motor with a smaller boss"
                where = f"rails of {link}"
                raise DesignError(quantity, wall, layout.min_wall, "mm", where, remedy)


def motor_bar(layout: Layout) -> Iterator[tuple[Part, Mount]]:
    """What holds a motor with a can: a bar behind it, or a sleeve round its gearbox."""
    s = layout.sizes
    face = layout.sizes.face
    if face is None or not face.length:
        return
    hole = face.screw.clearance / 2
    rim = layout.rim
    holes = {f"screw {k}": circle(z, hole) for k, z in enumerate(face.screws, 1)}
    if face.width:
        corner = complex(2 * face.half, face.width) / 2
        corner += complex(1, 1) * layout.fits.press_clearance / 2
        round_it = [(z, rim) for z in (corner, -corner, corner.conjugate(), -corner.conjugate())]
        opening = rectangle(-corner, corner)
        z = -s.base_thickness
        said = "round the motor's gearbox, pressed, flush with its front; two screws draw it to the plate"
    else:
        boss = (face.boss + layout.fits.slide_clearance) / 2
        round_it = [(0j, boss + rim)]
        opening = circle(0j, boss)
        z = -face.length - s.base_thickness
        said = "behind the motor; two long screws draw both to the plate"
    outer = hull([*round_it, *((z, hole + rim) for z in face.screws)])
    region = plate("motor bar", outer, {"motor": opening, **holes}, layout.min_wall)
    part = Part(
        "motor-bar",
        "Motor bar",
        (Layer(region, 0.0, s.base_thickness),),
        centres=(0j, *face.screws),
        min_wall=layout.min_wall,
        notes=(HoldingNote(said),),
        role="motor-bar",
    )
    for link in layout.drivers:
        yield part, Mount(part.name, GROUND, layout.at(GROUND, layout.shaft_of(link)), z=z)


def with_battery(layout: Layout) -> Layout:
    """The layout of a far side with a frame glued under its plate, which holds all of it; DesignError where the shaft or its
    collar is in its way."""
    s = layout.sizes
    battery = s.battery
    if battery is None:
        return layout
    at = complex(*battery.at)
    play, inner = _holder(layout, battery)
    shaft = layout.at(GROUND, layout.shaft_of(layout.driven)) - at
    aside = complex(max(0.0, abs(shaft.real) - inner.real), max(0.0, abs(shaft.imag) - inner.imag))
    room = abs(aside) - s.wall
    needed = s.shaft_diameter / 2 + s.head + s.wall + play
    if room < needed:
        remedy = "put it elsewhere: parts.battery.at"
        raise DesignError(
            "room beside the shaft's collar", room, needed, "mm", "frame of the battery", remedy
        )
    corners = [(z, s.wall) for z in (inner, -inner, inner.conjugate(), -inner.conjugate())]
    outer = hull(corners)
    region = plate("frame of the battery", outer, {"holder": rectangle(-inner, inner)}, s.wall / 2)
    part = Part(
        "battery-frame",
        "Frame of the battery",
        (Layer(region, 0.0, battery.height),),
        centres=(0j,),
        min_wall=layout.min_wall,
        notes=(HoldingNote("glued under the plate; the holder lies in it"),),
        role="battery-frame",
    )
    mount = Mount(part.name, GROUND, at, z=-battery.height)
    fitted = layout.fitted
    parts = (*fitted.parts, (part, mount))
    hubs = (*fitted.hubs, *((at + z, wide) for z, wide in corners))
    return replace(layout, fitted=replace(fitted, parts=parts, hubs=hubs))


def _holder(layout: Layout, battery: Battery) -> tuple[float, complex]:
    """Play of a battery holder in its frame, and the upper right corner of its opening, complex mm from its middle."""
    play = layout.fits.slide_clearance + layout.fits.press_clearance
    return play, complex(battery.length + play, battery.width + play) / 2


def over_screws(layout: Layout) -> list[Wall]:
    """What covers screws of posts: the frame of the battery, by which heads and their tool pass."""
    battery = layout.sizes.battery
    if battery is None:
        return []
    _, inner = _holder(layout, battery)
    around = np.array([inner, -inner.conjugate(), -inner, inner.conjugate()])
    wider = _head(layout.sizes) / 2 - post_radius(layout.sizes)  # heads, in place of posts
    corners = (complex(*battery.at) + around)[:, None]
    return [Wall("frame of the battery", corners, layout.sizes.wall + wider, "")]


def second(layout: Layout) -> Iterator[tuple[Part, Mount]]:
    """The second plate and its posts, spacers and what stands on it; nothing where none is asked for."""
    if layout.second is None:
        return
    s = layout.sizes
    floor = s.base_thickness
    ceiling = ceiling_height(layout)
    yield _second_plate(layout), Mount(SECOND, GROUND, z=ceiling)
    core = s.mount_diameter
    least = layout.min_wall
    joined = _side_screw(layout) > 0
    bore = _through(s) if joined else core
    post = spacer("post", "Post", bore, 2 * post_radius(s), ceiling - floor, least)
    held = (
        GluedNote(
            "glue each on the plate, over the hole of its screw, which centres it until the glue is hard"
        )
        if joined
        else HoldingNote("screw each on from below, through the plate")
    )
    post = replace(post, notes=(*post.notes, held))
    yield from ((post, Mount("post", GROUND, z, z=floor)) for z in layout.second.columns)
    if s.side_gap:
        wide = 2 * max(wide for _, wide in _posts(layout)[0])
        between = spacer(
            SIDE_SPACER,
            "Spacer between both sides",
            core if joined else _head(s),
            wide,
            s.side_gap,
            least,
        )
        held = (
            HoldingNote(
                "tilt the machine and screw each on from below, through plate, post and second plate"
            )
            if joined
            else GluedNote("glue each on the second plate, round a post's screw")
        )
        between = replace(between, notes=(*between.notes, held))
        yield from (
            (between, Mount(between.name, GROUND, z, z=ceiling + floor))
            for z in layout.second.columns
        )
    for stand in layout.stands:
        if stand.merged is not None:
            continue
        name = f"post-{stand.name}"
        foot = ceiling + floor
        wide = core + 2 * s.wall  # no head: it stands beside what hangs under the frame
        post = spacer(name, f"Post of {stand.name}", core, wide, stand.high - foot, least)
        yield from ((post, Mount(name, GROUND, z, z=foot)) for z in stand.places)
        if stand.sleeve is not None:
            yield _sleeve(layout, stand.name, stand.sleeve)


def _second_plate(layout: Layout) -> Part:
    """The plate that lies on posts."""
    s = layout.sizes
    floor = s.base_thickness
    points = {point: z for point, z in layout.points_of(GROUND).items() if layout.in_second(point)}
    holes = {f"hole {point}": circle(z, far_hole(layout, point) / 2) for point, z in points.items()}
    posts, through, sunk = _posts(layout)
    hubs = [*posts, *((z, far_hole(layout, point) / 2 + s.wall) for point, z in points.items())]
    channels = channels_in(layout, True)
    holes |= slot_holes(layout, GROUND, channels.keys())
    hubs += [(z, layout.hub(point, GROUND)) for point, ends in channels.items() for z in ends]
    feet = [z for each in layout.stands if each.merged is None for z in each.places]
    more, under, below = _screws(layout, feet, "stand")
    raised: list[Layer] = []
    for stand in layout.stands:
        if stand.merged is not None:
            more += stand.merged.discs
            through |= {f"{stand.name} {k}": hole for k, hole in enumerate(stand.merged.holes, 1)}
            raised += stand.merged.above
    outer = hull([*hubs, *more])
    depth = _depth(s)
    holes |= through | under
    heights = [(0.0, floor - depth, {}), (floor - depth, floor, sunk)]
    joined = _side_screw(layout) > 0
    if joined:  # no heads: the screws go on into spacers
        heights = [(0.0, floor, {})]
    if below:
        heights = [(0.0, depth, below), (depth, floor - depth, {}), (floor - depth, floor, sunk)]
    try:
        layers = tuple(
            Layer(plate("second plate", outer, holes | heads, layout.min_wall), *ends)
            for *ends, heads in heights
        )
    except DesignError as error:
        raise _moved(error, layout, {*under, *below}) from None
    layers += tuple(Layer(layer.region, floor + layer.z0, floor + layer.z1) for layer in raised)
    hanging = _hanging(layout, points)
    notes = [f"pins glued in, heads down: {', '.join(hanging)}"] if hanging else []
    held = f"screw it on {len(posts)} posts, over all other parts, tight crosswise"
    if joined:
        held = f"it lies on {len(posts)} posts, over all other parts"
    return Part(
        SECOND,
        "Second plate",
        layers,
        drawn_layer=max(0, len(heights) - 2),
        centres=tuple(points.values()),
        min_wall=layout.min_wall,
        notes=(HoldingNote(held), *notes),
        points=tuple(points.items()),
    )


def _moved(error: DesignError, layout: Layout, screws: Collection[str]) -> DesignError:
    """An error of the second plate's walls, with what moves the frame that stands there, if it is at one of its screws."""
    if not {*error.between} & {*screws}:
        return error
    names = ", ".join(stand.name for stand in layout.stands)
    a, b = error.between
    where = a, f"{b}, a screw of the frame of {names}"
    remedy = "move that machine (include.at), or make parts.wall or parts.head there larger, so that its screws lie elsewhere"
    return DesignError(error.quantity, error.value, error.limit, error.unit, where, remedy)


def _sleeve(layout: Layout, name: str, sleeve: Sleeve) -> tuple[Part, Mount]:
    """What joins the shaft that drives to another machine's over it."""
    s = layout.sizes
    press = layout.fits.press_clearance
    low, middle = sleeve_ends(layout)
    rim = circle(0j, max(s.shaft_diameter, sleeve.diameter) / 2 + s.head + s.wall)
    bores = (
        s.shaft_bore(press),
        d_bore(sleeve.diameter + press, sleeve.flat),
    )
    own, other = (
        plate("sleeve", rim, {"bore": bore.moved(turn)}, layout.min_wall)
        for bore, turn in zip(bores, (1, cmath.exp(1j * sleeve.turn)), strict=True)
    )
    long = middle - low
    part = Part(
        f"sleeve-{name}",
        f"Sleeve between the shafts of this machine and {name}",
        (Layer(own, 0.0, long), Layer(other, long, long + sleeve.up)),
        centres=(0j,),
        min_wall=layout.min_wall,
        notes=("glued on both shafts; its flats keep their phase",),
    )
    at = layout.at(layout.driven, layout.shaft_of(layout.driven))
    return part, Mount(part.name, layout.driven, at, z=low)


def bought(layout: Layout) -> list[Bought]:
    """Screws of the posts."""
    s = layout.sizes
    screw = s.post_screw
    if layout.second is None or screw is None:
        return []
    columns = len(layout.second.columns)
    core = f"into core holes of {s.mount_diameter:g}"
    key = "parts.mount_diameter"
    if long := _side_screw(layout):
        size = f"{screw.thread} x {long:g}, {core}"
        into = ((SIDE_SPACER, 1),)
        out = screw.nominal - _depth(s)  # a head of ISO 4762 is as high as its thread is thick
        proud = f"its head stands {out:.2g} mm out of the plate" if out > 0 else ""
        return [
            Bought(
                "screw of a spacer",
                "ISO 4762",
                size,
                columns,
                at=into,
                key=key,
                thread=screw.thread,
                length=long,
                details=proud,
            )
        ]
    length = screw.length(
        s.base_thickness - _depth(s), (ceiling_height(layout) - s.base_thickness) / 2
    )
    size = f"{screw.thread} x {length:g}, {core}"
    further = {f"post-{each.name}": each for each in layout.stands if each.merged is None}
    stands = sum(len(each.places) for each in further.values())
    on_posts = tuple((name, 1) for name in further)
    at = (("post", 1), (SECOND, columns), *on_posts)
    count = 2 * columns + stands
    screws = Bought(
        "screw of a post",
        screw.standard,
        size,
        count,
        at=at,
        key=key,
        thread=screw.thread,
        length=length,
    )
    if not stands:
        return [screws]
    stud = "stud of a post, half of it in the frame on it"
    return [screws, Bought(stud, "ISO 4026", f"{screw.thread} x 8", stands, at=on_posts)]


def _side_screw(layout: Layout) -> float:
    """Length of the screws through plate, post and second plate into a spacer between both sides, mm; 0 where there is no spacer,
    or none such is sold that meets none from the other side."""
    s = layout.sizes
    screw = s.post_screw
    if not s.side_gap or screw is None:
        return 0.0
    grip = ceiling_height(layout) + s.base_thickness - _depth(s)
    length = shortest_screw(grip + _ENGAGED * screw.nominal)
    return length if length - grip < s.side_gap / 2 else 0.0


def _hanging(layout: Layout, points: Iterable[str]) -> list[str]:
    """Points of the second plate whose pins hang from it."""
    return [
        point
        for point in points
        if point not in layout.shafts and layout.split_level(point) is not None
    ]


def motor_holes(layout: Layout) -> Iterator[tuple[str, complex, float]]:
    """Holes of the plate for the bosses of motors and for the heads of their screws: point of the shaft, centre and radius, mm;
    none without a motor."""
    face = layout.sizes.face
    if face is None:
        return
    wide = (face.screw.head + HEAD_ROOM) / 2
    for point in map(layout.shaft_of, layout.drivers):
        at = layout.at(GROUND, point)
        yield point, at, layout.hole(point, GROUND) / 2
        yield from ((point, at + z, wide) for z in face.screws)


def _depth(sizes: Parts) -> float:
    """Of the pockets for the heads of the posts' screws, mm."""
    screw = sizes.post_screw
    assert screw is not None, "a fault of the spec"
    return screw.height + SUNK


def _through(sizes: Parts) -> float:
    """Diameter of a hole through which the same screws go, mm."""
    screw = sizes.post_screw
    assert screw is not None, "a fault of the spec"
    return screw.clearance


def _head(sizes: Parts) -> float:
    """Diameter of the same pockets, mm."""
    screw = sizes.post_screw
    assert screw is not None, "a fault of the spec"
    return screw.head + HEAD_ROOM


def _posts(
    layout: Layout,
) -> tuple[list[tuple[complex, float]], dict[str, Contour], dict[str, Contour]]:
    """Hubs of the posts, their screws' holes in a plate, and the pockets for the heads."""
    return _screws(layout, () if layout.second is None else layout.second.columns, "post")


def _screws(
    layout: Layout, places: Sequence[complex], name: str
) -> tuple[list[tuple[complex, float]], dict[str, Contour], dict[str, Contour]]:
    """Hubs of posts at some places, their screws' holes in a plate, and the pockets for the heads."""
    screw = layout.sizes.post_screw
    if screw is None:
        return [], {}, {}
    wide = _head(layout.sizes) / 2
    hubs = [(z, max(post_radius(layout.sizes), wide + layout.sizes.wall)) for z in places]
    through = {f"{name} {k}": circle(z, screw.clearance / 2) for k, z in enumerate(places, 1)}
    return hubs, through, {f"{name} {k}": circle(z, wide) for k, z in enumerate(places, 1)}
