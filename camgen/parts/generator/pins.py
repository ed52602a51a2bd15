"""What goes through the links at a point, and holds them on each other.

printed    a pin with a head, pressed into one link
turned     the same of steel
dowel      of steel, with a printed cap on what stands out
shoulder   a shoulder screw, its shoulder through all links, a nut on its thread under them, a spacer under its head
bearing    a printed pin; each link that turns on it has a ball bearing pressed into it from above, down on a lip; the pin's
           head bears on the highest one's inner ring, which so holds its link down by the lip under the outer ring; in metal
           it clamps the rings on sleeves, which hold their links a play apart
keyed      a crank pin, which joins the webs of an interrupted shaft
crank      an arm at the lower end of the shaft that drives, with a knob that turns on a pin, to turn it by hand
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator
from dataclasses import replace

from camgen.errors import DesignError
from camgen.geometry.outlines import Region, circle, polygon
from camgen.machine.features import Mount
from camgen.parts.catalogue import (
    BEARINGS,
    BRONZE,
    BUSH,
    BUSHES,
    DOWELS,
    TURNED,
    Bearing,
    dowel,
    dowel_excess,
    next_dowel,
)
from camgen.parts.fixing import PIN, joint_of
from camgen.parts.generator.changes import Change, Unmade
from camgen.parts.generator.connections import GROUND
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.seats import least_thickness, lip, seat_floor
from camgen.parts.generator.stubs import Stub
from camgen.parts.generator.webs import keyed_pin
from camgen.parts.hardware import FACETS, headed, plate, spacer
from camgen.parts.part import GREASED, HoldingNote, Layer, Part, hull, rod

_HELD = 0.75  # of the thickness of a cap of sheet: its pin fills that at least
_PRESSED = "press on its outer ring alone, with a tube; a trace of compound goes round that ring"
KNOB = 4.0  # lengths of a hand crank's knob to the pin's diameter

MountedPart = tuple[Part, Mount]


def refuse(layout: Layout) -> None:
    """Raise DesignError where a pin cannot be of its kind, or a thread has no room for its posts."""
    _refuse_threads(layout)
    for point in layout.sizes.discs or ():
        links = layout.pivots.get(point, ())
        said = {
            "no shaft goes through it": point not in layout.discs or len(links) < 2,
            "it is in a slot": point in layout.slots,
            "a roller or a spring sits on it": point in layout.riders,
            "the shaft is interrupted": layout.sizes.shaft == "interrupted",
        }
        for why in (why for why, wrong in said.items() if wrong):
            raise DesignError("discs", 1, 0, "", f"parts.discs.{point}: {why}", "leave it out")
    for point, kind in layout.sizes.pins.items():
        links = layout.pivots.get(point, ())
        hangs = point in {roller.point for roller in layout.rollers if roller.hung}
        said = {
            "no link turns there": len(links) < 2,
            "it is in a slot": kind == "bearing" and point in layout.slots,
            "a roller or a spring sits on it": kind == "bearing"
            and point in layout.riders
            and point not in layout.shafts,
            "it is the motor's shaft": layout.on_motor(point, GROUND),
            "a roller hangs on it": kind == "shoulder" and hangs,
            "it joins webs of the shaft": layout.kind(point) == "keyed",
            "only a shaft has a bush": kind == "bush" and point not in layout.shafts,
            "a second plate holds it too": kind == "bush" and layout.sizes.plates > 1,
            'it is a shaft (of steel: parts.shaft_made = "steel")': kind
            in ("shoulder", "dowel", "turned")
            and point in layout.shafts,
        }
        for why in (why for why, wrong in said.items() if wrong):
            raise DesignError(
                f"{kind} pins", 1, 0, "", f"parts.pins.{point}: {why}", "leave it out"
            )
    borne = (point for point in layout.pivots if layout.kind(point) in ("bearing", "bush"))
    for point in borne:
        bearing = layout.bearing(point)
        shaft = point in layout.shafts
        if bearing is None:
            plain = layout.kind(point) == "bush"
            bores = [each.bore for each in (BUSHES if plain else BEARINGS.values())]
            sold = ", ".join(f"{bore:g}" for bore in sorted(set(bores)))
            key = "parts.shaft_diameter" if shaft else "parts.pin_diameter"
            remedy = f"use a bore in which {'bushes' if plain else 'bearings'} are sold: {sold}"
            wanted = layout.turning(point)
            error = DesignError(key, wanted, 0, "mm", f"pin {point}", remedy)
            near = min(bores, key=lambda bore: abs(bore - wanted))
            change = Change(f"{key} = {near:g}", {key.partition(".")[2]: near})
            raise Unmade(error, "the nearest bore", change)
        for link in (link for link in layout.pivots[point] if (link == GROUND) == shaft):
            least = bearing.width
            key = "parts.base_thickness"
            kind = "bush" if bearing.plain else "bearing"
            remedy = f"make it at least as thick as a {kind} {bearing.name} is wide"
            if not shaft:
                least = least_thickness(layout, bearing)
                key = f"parts.{link}.thickness"
                remedy += f", plus a lip of {lip(layout):g} mm that holds it and the play over it"
            if layout.thickness(link) < least:
                thickness = layout.thickness(link)
                error = DesignError(key, thickness, least, "mm", f"pin {point}", remedy)
                size = {"base_thickness": least} if shaft else {link: {"thickness": least}}
                raise Unmade(error, "a thicker one", Change(f"{key} = {least:g}", size))


def _refuse_threads(layout: Layout) -> None:
    for point in layout.thread_posts:
        said = {
            "a pin is there": point in layout.pivots,
            "a second plate lies over all links": layout.sizes.plates > 1,
        }
        for why in (why for why, wrong in said.items() if wrong):
            remedy = "let the thread pass another point, or parts.plates = 1"
            raise DesignError("posts of threads", 1, 0, "", f"point {point}: {why}", remedy)


def _made_of(layout: Layout, point: str) -> str:
    """How a pin with a head is made, for the parts list."""
    return TURNED if layout.kind(point) == "turned" else "printed"


def pin(layout: Layout, point: str, stub: Stub) -> Iterator[MountedPart]:
    """The pin of a point, or a stub of it, and what holds it, on the link in which it is fixed."""
    s = layout.sizes
    play = layout.fits.slide_clearance
    link = layout.pressed_in(point)
    body = layout.carrier(link)
    at = layout.at(link, point)
    hung = point in layout.hung_points or stub.hangs
    bottom = stub.grips[0][0]
    grip = stub.grips[-1][1] + play - bottom
    if stub.through:
        yield _between(layout, point, stub)
        return
    match layout.kind(point):
        case "keyed":
            ends = [top - low for low, top in (stub.grips[0], stub.grips[-1])]
            if levels_beyond(layout, point)[0]:  # a head in place of the upper web
                between = grip - ends[0]
                ends = [ends[0], 0.0]
            else:
                between = stub.grips[-1][0] - stub.grips[0][1]
            head = s.pin_diameter / 2 + s.head, s.head
            lengths = ends[0], between, ends[1]
            reach = _reach(layout, point)
            depth = layout.key_depth
            made = keyed_pin(s.pin_diameter, lengths, depth, head, s.shafts_made, reach)
            yield made, Mount(made.name, body, at, z=bottom)
        case "dowel":
            steel, cap = _dowel(layout, grip, point)
            low = bottom - (play + steel.thickness - grip) * hung
            yield steel, Mount("pin", body, at, z=low)
            low = bottom - play - cap.thickness if hung else bottom + grip
            yield cap, Mount("cap", body, at, z=low)
        case "shoulder":
            yield from _shoulder(layout, grip, point, body, bottom)
        case _:
            wide = s.pin_diameter + 2 * s.head
            notes = [f"{layout.pin_joint(point)} in"]
            bearing = layout.bearing(point)
            if bearing is not None:
                # its head reaches down to the inner ring, which lies a play below the link's upper side; in metal it clamps that
                grip -= 2 * play if layout.metal else play
                wide = bearing.shoulder
                notes.append(f"its head bears on the inner ring of the {bearing.shielded} alone")
            made = headed("pin", "Pin", s.pin_diameter, grip - layout.recess, wide, s.head)
            how = _made_of(layout, point)
            made = replace(made, notes=tuple(notes), role="pin", process=how)
            low = bottom - play - s.head if hung else bottom + layout.recess
            yield made, Mount("pin", body, at, 0.0, not hung, low)


def _reach(layout: Layout, point: str) -> float:
    """How far the other axis of the upper web on a crank pin is from that, mm."""
    web = layout.webs_at(point)[-1]
    here = layout.at(web, point)
    return max(abs(layout.at(web, other) - here) for other in layout.webs[web])


def _between(layout: Layout, point: str, stub: Stub) -> MountedPart:
    """A pin without a head from plate to plate; a dowel where one is sold that ends in the upper one."""
    s = layout.sizes
    whole = stub.grips[-1][1]
    mount = Mount("pin", GROUND, layout.at(GROUND, point))
    held = f"{layout.pin_held(point)} into both plates"
    notes = (held,)
    if layout.kind(point) != "dowel":
        whole_pin = rod("pin", "Pin", s.pin_diameter, whole)
        how = _made_of(layout, point)
        return replace(whole_pin, notes=notes, role="pin", process=how), mount
    length = dowel(s.pin_diameter, whole)
    least = whole - s.base_thickness / 2
    if length < least:
        remedy = "change parts.thickness or parts.base_thickness"
        said = _unsold(s.pin_diameter, least, whole, point)
        quantity = "length of the dowel"
        where = f"pin {point}"
        error = DesignError(
            quantity,
            length,
            least,
            "mm",
            where,
            remedy,
        ).saying(said)
        raise _as_printed(point, error)
    notes = (f"dowel {layout.dowels}, {s.pin_diameter:g} m6 x {length:g}, {held}",)
    steel = rod("pin", "Pin", s.pin_diameter, length)
    return replace(steel, notes=notes, process="bought", role="pin"), mount


def _as_printed(point: str, error: DesignError, kind: str = "printed") -> Unmade:
    """An error of a pin that is bought, which a pin of another kind may mend."""
    change = Change(f'parts.pins.{point} = "{kind}"', {"pins": {point: kind}})
    return Unmade(error, f"a pin that is {kind}", change)


def _unsold(diameter: float, least: float, most: float, point: str) -> str:
    """Sentence that no dowel of a diameter is sold which is at least and at most so long, mm, and why."""
    shortest, longest = DOWELS[diameter]
    if longest < least:
        return f"the longest dowel of {diameter:g} mm is {longest:g} mm, {least:.4g} mm are needed at pin {point}"
    if shortest > most:
        return f"the shortest dowel of {diameter:g} mm is {shortest:g} mm, there is room for {most:.4g} mm at pin {point}"
    return f"no dowel of {diameter:g} mm is sold between {least:.4g} and {most:.4g} mm long, as pin {point} needs it"


def _dowel(layout: Layout, grip: float, point: str) -> tuple[Part, Part]:
    """A dowel through so much, mm, and the cap on what stands out; DesignError where none of such a length is sold."""
    s = layout.sizes
    length, least, most = _dowel_length(layout, grip)
    if not least <= length <= most:
        remedy = f"change {s.thick_key} or parts.pin_diameter"
        remedy += ": thin dowels are sold shorter" if s.of_sheet else ""
        said = _unsold(s.pin_diameter, least, most, point)
        quantity = "length of the dowel"
        error = DesignError(
            quantity,
            length,
            least,
            "mm",
            f"pin {point}",
            remedy,
        ).saying(said)
        raise error if s.of_sheet else _as_printed(point, error)
    out = round(length - grip - s.thickness, 2)
    over = f", stands {out:g} mm out of its cap" if out > 0 else ""
    notes = (
        f"dowel {layout.dowels}, {s.pin_diameter:g} m6 x {length:g}, {layout.pin_held(point)} in{over}",
    )
    steel = rod("pin", "Pin", s.pin_diameter, length)
    hole = s.pin_diameter + layout.fits.press_clearance
    wide = s.pin_diameter + 2 * s.head
    thickness = s.thickness if s.of_sheet else length - grip
    cap = spacer("cap", "Cap of a pin", hole, wide, thickness, layout.min_wall)
    steel = replace(steel, notes=notes, process="bought", role="pin")
    return steel, replace(cap, role="cap")


def _dowel_length(layout: Layout, grip: float) -> tuple[float, float, float]:
    """Length of the dowel through so much, the least that holds its cap, and the most, mm.

    As thick a cap is printed as it is long, one of sheet is filled by three quarters, or by the next longer one, which stands
    out by less than another sheet. Between parts of metal the longest that is sold under its name has room, where one is long enough.
    """
    s = layout.sizes
    most = grip + s.thickness
    length = dowel(s.pin_diameter, most)
    if layout.metal and not s.of_sheet:
        room = most + layout.fits.slide_clearance
        shorter = dowel(s.pin_diameter, room - dowel_excess(length)) if length else 0.0
        length = shorter if shorter >= grip + _least_cap(layout) else length
    if not s.of_sheet:
        return length, grip + _least_cap(layout), most
    least = grip + _HELD * s.thickness
    if length < least:
        length = next_dowel(s.pin_diameter, least)
    return length, least, grip + 2 * s.thickness


def _least_cap(layout: Layout) -> float:
    """Thickness of the thinnest cap of a dowel that is not of sheet, mm."""
    return max(layout.min_wall, layout.sizes.head / 2)


def tall(layout: Layout) -> frozenset[str]:
    """Points whose dowel stands out of its cap beyond the levels that are kept free for that."""
    points = set()
    play = layout.fits.slide_clearance
    for point in layout.pivots.keys() - layout.guest_links.keys() - layout.under_plate:
        if layout.kind(point) != "dowel" or layout.between_plates(point):
            continue
        low, under, _ = layout.on(point)[0]
        high, _, top = layout.on(point)[-1]
        grip = top + play - under
        beyond = _dowel_length(layout, grip)[0] - grip
        levels = sum(levels_beyond(layout, point))
        room = levels * (layout.sizes.thickness + play)
        room += under - layout.floor(low) if point in layout.hung_points else layout.top(high) - top
        if beyond > room + 1e-9:
            points.add(point)
    return frozenset(points)


def _shoulder(
    layout: Layout, grip: float, point: str, body: str, bottom: float
) -> Iterator[MountedPart]:
    """A shoulder screw through so much, mm, head up, its nut, and a spacer; DesignError where no such length is sold."""
    screw = layout.sizes.shoulder
    s = layout.sizes
    at = layout.at(body, point)
    length = screw.length(grip)
    room = head_room(layout, point) - screw.height
    if not grip <= length <= grip + room:
        kind = "dowel" if s.of_sheet else "printed"
        raise _as_printed(
            point,
            DesignError(
                "length of the shoulder screw",
                length or screw.longest,
                grip + room * bool(length),
                "mm",
                f"pin {point}",
                f"change {s.thick_key}",
            ),
            kind,
        )
    discs = (
        (screw.head, screw.height),
        (screw.diameter, length),
        (screw.nominal, screw.thread_length),
    )
    layers = []
    z = 0.0
    for wide, high in discs:
        layers.append(Layer(Region(circle(0j, wide / 2)), z, z + high))
        z += high
    notes = (
        f"shoulder screw ISO 7379, {screw.diameter:g} x {length:g}, {screw.thread}",
        "glued in",
    )
    steel = Part(
        "pin",
        "Pin",
        tuple(layers),
        centres=(0j,),
        notes=notes,
        drawn_layer=1,
        process="bought",
        role="pin",
    )
    yield steel, Mount("pin", body, at, 0.0, True, bottom - screw.thread_length)
    corners = [cmath.rect(screw.flats / math.sqrt(3), math.tau * k / 6) for k in range(6)]
    nut = Region(polygon(corners), (circle(0j, screw.nominal / 2),))
    tight = (f"nut ISO 4032 {screw.thread}, tight on the shoulder",)
    made = Part(
        "nut",
        "Nut of a pin",
        (Layer(nut, 0.0, screw.nut),),
        centres=(0j,),
        notes=tight,
        process="bought",
        role="nut",
    )
    yield made, Mount("nut", body, at, z=bottom - screw.nut)
    if length - grip >= s.head / 2:  # what is thinner is play
        wide = screw.diameter + 2 * s.head
        hole = screw.diameter + layout.fits.running_clearance
        fill = spacer("spacer", "Spacer", hole, wide, length - grip, layout.min_wall)
        fill = replace(fill, role="spacer")
        if s.of_sheet:
            fill = replace(fill, process="bought", notes=("washers",))
        yield fill, Mount("spacer", body, at, z=bottom + grip)


def bearings(layout: Layout, point: str) -> Iterator[MountedPart]:
    """The ball bearings in the links at a point."""
    for link in layout.pivots[point]:
        bearing = layout.bearing_in(point, link)
        if bearing is not None:
            z = layout.floor(layout.level[link]) + seat_floor(layout, point, link)
            yield (
                _bearing(layout, bearing),
                Mount(bearing_name(bearing), link, layout.at(link, point), z=z),
            )


def sleeves(layout: Layout, point: str) -> Iterator[MountedPart]:
    """In metal, what lies under the inner ring of each ball bearing on a pin, which the pin's head clamps: it holds the link a play over
    what is beneath, so that neither that nor an outer ring rubs."""
    if not layout.metal or point in layout.shafts:
        return
    fixed = layout.pressed_in(point)
    top = layout.top_of(fixed)
    for link in sorted(layout.pivots[point], key=lambda each: layout.level[each]):
        bearing = layout.bearing_in(point, link)
        if bearing is None:
            continue
        low = layout.floor(layout.level[link]) + seat_floor(layout, point, link)
        wall = (bearing.shoulder - bearing.bore) / 2 - 2 * FACETS
        ring = spacer(
            "sleeve",
            "Sleeve",
            bearing.bore,
            bearing.shoulder,
            low - top,
            min(wall, layout.min_wall),
        )
        ring = replace(
            ring, notes=(f"bears on the inner ring of the {bearing.shielded} alone",), role="sleeve"
        )
        yield ring, Mount("sleeve", layout.carrier(fixed), layout.at(fixed, point), z=top)
        top = low + bearing.width


def bearing_name(bearing: Bearing) -> str:
    """Name of its part."""
    return BUSH if bearing.plain else f"bearing-{bearing.name.lower()}"


def _bearing(layout: Layout, bearing: Bearing) -> Part:
    title = "Ball bearing"
    notes = [
        f"ball bearing {bearing.shielded}, {bearing.size}, greased for life, pressed into its link"
    ]
    if layout.metal:
        notes.append(HoldingNote(_PRESSED))
    if bearing in [clutch for _, clutch in layout.freewheels.values()]:
        said = HoldingNote("seen from above, the ring can only turn counter-clockwise on its shaft")
        title = "One-way clutch"
        notes = [f"one-way clutch {bearing.name}, {bearing.size}", "pressed in", said]
    if bearing.plain:
        title = "Bush"
        notes = [
            f"bush {bearing.standard} {bearing.name}, bronze {BRONZE}, pressed into the plate; drawn with its play",
            HoldingNote(
                "the shaft must turn freely in each bush: pressing narrows them, so open one that is tight"
            ),
            HoldingNote("grease each bush inside, and the faces round it on which something runs"),
        ]
    ring = spacer(
        bearing_name(bearing), title, bearing.bore, bearing.outside, bearing.width, layout.min_wall
    )
    return replace(ring, notes=tuple(notes), process="bought")


def hand_crank(layout: Layout) -> Iterator[MountedPart]:
    """Arm, knob and its pin under the plate, on the link that the shaft drives; nothing where none is asked for. Of sheet is the
    arm alone, the pin is a dowel."""
    s = layout.sizes
    play = layout.fits.slide_clearance
    press = layout.fits.press_clearance
    link = layout.driven
    if not s.hand_crank:
        return
    at = layout.at(link, layout.shaft_of(link))
    knob = complex(s.hand_crank)
    z = -s.shaft_length
    bore = s.shaft_bore(press)
    hubs = [(0j, s.shaft_diameter / 2 + s.head + s.wall), (knob, s.pin_diameter / 2 + s.wall)]
    region = plate(
        "hand crank",
        hull(hubs),
        {"shaft": bore, "knob": circle(knob, (s.pin_diameter + press) / 2)},
        layout.min_wall,
    )
    arm = Part(
        "hand-crank",
        "Hand crank",
        (Layer(region, 0.0, s.thickness),),
        centres=(0j, knob),
        bore=s.shaft_diameter + press,
        min_wall=layout.min_wall,
        notes=(f"{layout.on_shaft} on the lower end of the shaft",),
    )
    yield arm, Mount(arm.name, link, at, z=z)
    long = KNOB * s.pin_diameter
    if s.of_sheet:
        long = dowel(s.pin_diameter, long + s.thickness) or next_dowel(
            s.pin_diameter, long + s.thickness
        )
        said = (
            f"dowel ISO 2338, {s.pin_diameter:g} m6 x {long:g}, pressed and glued in, flush with the crank's upper face",
        )
        steel = rod("knob-pin", "Pin of the knob", s.pin_diameter, long)
        steel = replace(steel, notes=said, process="bought")
        yield steel, Mount("knob-pin", link, at + knob, z=z + s.thickness - long)
        return
    turns = spacer(
        "knob",
        "Knob",
        s.pin_diameter + layout.fits.running_clearance,
        2 * s.pin_diameter + 2 * s.head,
        long,
        layout.min_wall,
    )
    turns = replace(turns, notes=(HoldingNote(GREASED),)) if layout.metal else turns
    yield turns, Mount("knob", link, at + knob, z=z - play - long)
    wide = s.pin_diameter + 2 * s.head
    pin = headed(
        "knob-pin",
        "Pin of the knob",
        s.pin_diameter,
        long + 2 * play + s.thickness,
        wide,
        s.head,
    )
    pin = replace(pin, notes=(f"{joint_of(PIN)} in",))
    yield pin, Mount("knob-pin", link, at + knob, z=z - 2 * play - long - s.head)


def levels_beyond(layout: Layout, point: str) -> tuple[int, int]:
    """How many levels the head of a pin takes over its highest link, and it or a thread under its lowest."""
    if point in layout.shafts:
        collar = layout.collar(point)
        step = layout.least_thickness + layout.fits.slide_clearance
        over = int(point in layout.over_shafts)
        return over if collar is None else math.ceil(collar.height / step), 0
    if len(layout.webs_at(point)) > 1 or layout.on_ground(point):
        return 0, 0
    if point in layout.eccentrics.values():  # another eccentric holds down what turns on it
        return 0, 0
    if layout.kind(point) == "shoulder":
        screw = layout.sizes.shoulder
        least = layout.least_thickness
        step = least + layout.fits.slide_clearance
        over = math.ceil((screw.height + least / 2) / step)
        return over, math.ceil(screw.thread_length / step)
    taken = 1 + (point in layout.tall)
    return (0, taken) if point in layout.hung_points else (taken, 0)


def head_room(layout: Layout, point: str) -> float:
    """Height of the levels that are kept free over a pin's highest link, mm."""
    over = levels_beyond(layout, point)[0]
    play = layout.fits.slide_clearance
    return over * (layout.least_thickness + play) - play
