"""A linkage as parts: links round their hubs, a ground plate, cams, pins, spacers and the shafts.

link     a band round its hubs, a plate where it has three and more; it lies on its level
slot     straight, as long as its pin's way; its link lies over the one with the pin
slide    a bar between rails of the plate or of the link that guides it; a cover on the rails holds it down
plate    the ground, under level 1: hubs round its pivots, holes for two screws from behind
pin      pressed into its lowest link or the plate, its head over the highest; the others turn on it; where that saves
         a level the plate's pins have their heads under it and are pressed into their highest link; other kinds: pins.py
spacer   round a pin, where levels between its links are empty
shaft    of a link that drives or carries wheels: its flat turns all of them; it turns in the plate, held by a collar;
         what drives may be the shaft of a motor that is screwed under the plate
gear     two wheels on shafts
cam      over its follower, whose roller turns on a pin that is pressed into it; a groove's cam is three plates
pen      a hole at a point that is an output and no pin
thread   over posts that stand over all links: threads.py
"""

from __future__ import annotations

import cmath
import math
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise

from camgen.errors import listed
from camgen.geometry.outlines import Contour, Region, circle
from camgen.machine import model as m
from camgen.machine.features import Feature, Mount, StandIn, Strand
from camgen.parts.assembly import FlatSeat, Shaft
from camgen.parts.catalogue import CORE_HOLES, SCREWS, Bought, fixed_motor, screw_for
from camgen.parts.generator import plates
from camgen.parts.generator.connections import GROUND
from camgen.parts.generator.discs import (
    cam_parts,
    cycloid_pins,
    disc_layer,
    edge_parts,
    gear_parts,
    roller_part,
    round_shaft,
    shaft_cap,
)
from camgen.parts.generator.dowels import dowel_holes, stud_holes
from camgen.parts.generator.genevas import GenevaDrive
from camgen.parts.generator.joints import features_of, part_name, point_of
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.link_outlines import own_contours, slot_holes
from camgen.parts.generator.pins import MountedPart, bearings, hand_crank, pin, sleeves
from camgen.parts.generator.plates import ground_plate, second
from camgen.parts.generator.seats import link_layers
from camgen.parts.generator.second_plate import ceiling_height, in_first, sleeve_ends
from camgen.parts.generator.sizes import Battery
from camgen.parts.generator.stubs import Stub, stubs
from camgen.parts.generator.threads import strands, thread_posts
from camgen.parts.generator.troughs import covers, rails
from camgen.parts.generator.wheels import with_touches
from camgen.parts.hardware import refuse_thin, spacer
from camgen.parts.inertia import Solids
from camgen.parts.motors import cells
from camgen.parts.part import Layer, Part, Role, SquareNote
from camgen.parts.set_screws import SetScrewHub
from camgen.parts.step_words import listed as in_words

_SHAFT = "shaft"
_NUMBERED: dict[Role, str] = {  # parts of which a machine has several unlike ones, and their titles
    "pin": "Pin {}",
    "crank-pin": "Crank pin {}",
    "spacer": "Spacer {}",
    "sleeve": "Sleeve {}",
    "cap": "Cap {} of a pin",
    "nut": "Nut {} of a pin",
    "cover": "Cover {} of a guide",
    "keeper": "Keeper {} of a disc",
    "thread-post": "Post {} of a thread",
}
# Wires reach over the whole machine, past the holder, and this far beyond; they are cut in steps of _WIRES, mm.
_SLACK = 100.0
_WIRES = 50.0
_CLEAR = 1.0  # mm, round what turns under the plate
_SQUARE = 0.02  # mm, zone of the axis of a bush's bore or a pin's hole: camgen's own rule
_THREADED = 1.5  # diameters of a screw that its thread is in the plate at least: camgen's own rule
_CHECK = "Move it slowly through its whole motion first: no joint may be stiff"


class Bodies:
    """What is made of a machine that is laid out."""

    def __init__(
        self,
        layout: Layout,
        weight: tuple[Part, Sequence[tuple[Part, complex]]] | None = None,
        under: float | None = None,
    ) -> None:
        self.weight = weight  # on the driven link's shaft, with its pins and their places
        self.under = under  # its radius, mm, where it lies under the plate in place of a collar
        self.layout = layout
        self.sizes = layout.sizes
        self.fits = layout.fits
        self.min_wall = layout.min_wall

    @cached_property
    def _made(self) -> tuple[list[Part], list[Mount]]:
        layout = self.layout
        moving = [link for link in layout.moving if link not in layout.alone]
        own = layout.fitted
        beside = max(self.collar_radius, self.under or 0.0)
        notes = [*self._pressed(GROUND), *self._square(GROUND)]
        base = ground_plate(layout, part_name(GROUND), beside, notes)
        parts = [base, *(own.links.get(name) or self._link(name) for name in moving)]
        mounts = [Mount(part_name(GROUND), GROUND)]
        mounts += [
            Mount(part_name(name), layout.carrier(name), z=layout.floor(layout.level[name]))
            for name in moving
        ]
        names: dict[Part, str] = {}
        titles: dict[Part, str] = {}
        for part, mount in [
            *(each for tip in layout.tips for each in cam_parts(layout, tip)),
            *(roller_part(layout, plate.roller) for plate in layout.plates),
            *gear_parts(layout),
            *(each for drive in layout.edge_drives for each in edge_parts(layout, drive)),
            *cycloid_pins(layout),
            *(each for point in layout.pivots for each in self._stack(point)),
            *covers(layout),
            *hand_crank(layout),
            *plates.motor_bar(layout),
            *second(layout),
            *self._counterweight(),
            *thread_posts(layout),
            *own.parts,
        ]:
            part = _with_even_heights(part)
            if part not in names:  # what is alike is one part
                number = sum(each.role == part.role for each in names) + 1
                names[part] = f"{part.role}-{number}" if part.role in _NUMBERED else part.name
                titles[part] = _NUMBERED.get(part.role, part.title).format(number)
            mounts.append(replace(mount, part=names[part]))
        copies = Counter(mount.part for mount in mounts)
        parts += [
            replace(part, name=name, title=titles[part], count=copies[name])
            for part, name in names.items()
        ]
        return parts, mounts

    @property
    def parts(self) -> Sequence[Part]:
        """Plate, links, then what holds them together."""
        return self._made[0]

    @property
    def mounts(self) -> Sequence[Mount]:
        """Every copy of every part on its body."""
        return self._made[1]

    def of_role(self, *roles: Role) -> list[Mount]:
        """Copies of all parts with one of these roles."""
        names = {part.name for part in self.parts if part.role in roles}
        return [mount for mount in self.mounts if mount.part in names]

    def strands(self) -> list[Strand]:
        """Its threads."""
        return strands(self.layout, self.of_role("thread-post"))

    @property
    def shaft_reach(self) -> float:
        """How far the shafts that drive stand over the plate's underside, the motors' faces, mm: the longest of them."""
        layout = self.layout
        tops = [layout.on(layout.shaft_of(link))[-1][2] for link in layout.drivers]
        top = max(tops, default=0.0)
        if layout.webs:  # it ends in the first of them
            top = layout.top(layout.level[layout.driven])
        return top if self.collar is None else top + self.collar.height

    def flat_seats(self) -> Iterator[FlatSeat]:
        """Bores by which flats turn printed links: of the driven one on the shaft, with the set screw's hub on it, then of webs on crank
        pins; none without a flat."""
        s = self.sizes
        layout = self.layout
        if not s.shaft_flat or s.shaft_key or s.of_sheet or not layout.drivers:
            return
        link = layout.driven
        length = layout.thickness(link) + (self.collar.height if self.collar else 0.0)
        yield FlatSeat(link, layout.shaft_of(link), s.shaft_diameter, s.shaft_flat, length)
        for web, points in layout.webs.items():
            for point in points:
                if point not in layout.shafts:
                    depth = layout.key_depth
                    yield FlatSeat(web, point, s.pin_diameter, depth, layout.thickness(web))

    @property
    def shaft(self) -> Shaft | None:
        """The shaft that drives; None where it is the motor's own."""
        if self.sizes.face is not None or not self.layout.drivers:
            return None
        return Shaft(_SHAFT, self.sizes.shaft_diameter, self.sizes.shaft_flat)

    @property
    def collar(self) -> SetScrewHub | None:
        """What holds the driven link on a motor's shaft, if it is asked for."""
        shafts = [self.layout.shaft_of(link) for link in self.layout.drivers[:1]]
        return self.layout.collar(shafts[0]) if shafts else None

    def bought(self, turning: str, volts: float = 0.0) -> list[Bought]:
        """Drive, by what it does in words, and screws. volts: of the motor, 0 where that is not known."""
        p = self.sizes
        face = self.sizes.face
        shaft = p.shaft_text
        motors = []
        if not self.layout.drivers:
            along = f"on link {self.layout.driven}, along its slide"
            motors.append(Bought("drive", "", turning, 1, "drive", how=along))
        elif not p.hand_crank:
            lower = "on the shaft's lower end"
            motors.append(Bought("drive", "", f"{turning}, for a {shaft}", 1, "drive", how=lower))
        if face is not None:
            if p.shaft_flat and not face.flat:
                shaft += " (measure your motor's flat, and set parts.shaft_flat)"
            said = f"{turning}, {shaft}, at least {self.shaft_reach:.4g} long from its face"
            motors = fixed_motor("drive", face, said, p.base_thickness - p.pocket)
        screws = self.layout.cover.bought(self.of_role("cover")) if self.layout.cover else []
        count = len(self.layout.drivers) or 1
        motors = [replace(each, count=count * each.count) for each in motors]
        if p.battery is not None:
            size = self._battery_text(p.battery, volts)
            place = "in the frame under the far plate; its wires to the motor, over the switch"
            motors.append(Bought("battery holder", "", size, 1, "supply", how=place))
        held = (
            []
            if self.collar is None
            else self.collar.bought(self.collar.least_radius, "shaft-collar")
        )
        screws += [replace(each, count=count * each.count) for each in held]
        behind = Bought(
            "screw of the plate, from behind", "", self._mount_screw, p.mount_screws, "mount"
        )
        thread = next((name for name, core in CORE_HOLES.items() if core == p.mount_diameter), "")
        behind = replace(behind, key="parts.mount_diameter", thread=thread)
        bushes = any(self.layout.kind(point) == "bush" for point in self.layout.shafts)
        knob = self.layout.metal and self.sizes.hand_crank
        greased = bushes or knob or self._greased
        return [
            *motors,
            *(
                [Bought("grease", "", "NLGI 2, where a step asks for it", 1, "aside")]
                if greased
                else []
            ),
            *(self.layout.fitted.bought if self.layout.fitted.holder else [behind]),
            *screws,
            *plates.bought(self.layout),
        ]

    @property
    def _mount_screw(self) -> str:
        """The screw that holds the plate on a board, whose thickness is a person's own."""
        core = self.sizes.mount_diameter
        most = self.sizes.base_thickness
        threads = [thread for thread, hole in CORE_HOLES.items() if hole == core]
        if not threads:
            return f"{screw_for(core)}, at most {most:g} into the plate"
        least = min(_THREADED * SCREWS[threads[0]].nominal, most)
        length = f"{least:g}" if least == most else f"{least:g} to {most:g}"
        return f"{screw_for(core)}, such as ISO 4762, {length} longer than the board is thick"

    def _battery_text(self, holder: Battery, volts: float) -> str:
        """What feeds the motor: the holder, its cells, and how long its wires are."""
        size = f"holder of at most {holder.length:g} x {holder.width:g}"
        kind = cells(volts, holder.length, holder.width)
        held = (
            f"for {kind} cells side by side, {volts:g} V, with its cells"
            if kind
            else "with batteries for the motor's voltage"
        )
        across = self.sizes.side_gap
        if self.layout.second is not None:
            across += 2 * (ceiling_height(self.layout) + self.sizes.base_thickness)
        wires = _WIRES * math.ceil((across + abs(complex(*holder.at)) + _SLACK) / _WIRES)
        return f"{size}, {held}, a switch, and two wires of {wires:g} mm from it to the motor"

    @property
    def stands(self) -> str:
        """On what the plate stands, and what turns the shaft."""
        if self.sizes.stand != "none":
            return f"Stand it on the table. {self._turned}. {self._greased}{_CHECK}"
        count = "two" if self.sizes.mount_screws == 2 else "three"
        thread = next(
            (f" {each}" for each, core in CORE_HOLES.items() if core == self.sizes.mount_diameter),
            "",
        )
        screws = f"{count} screws{thread} from behind, in the plate's outermost holes, hold it"
        board = (
            f"Fix the plate on a board or frame of yours: {self.layout.fitted.holder or screws}."
        )
        if self.sizes.face is not None:
            return f"{board} {self._turned}: leave it room there. {self._greased}{_CHECK}"
        low = -min(mount.z for mount in self.mounts)
        deep = f"at least {low + _CLEAR:.4g} mm deep"
        if low > 0 and self.layout.drivers:
            across = f"{2 * (self._swept + _CLEAR):.4g} mm across"
            hand = "right through, with room for your hand below, and at least"
            under = f"{hand} {across}" if self.sizes.hand_crank else f"{deep} and {across}"
            board += f" Leave it open under the shaft, {under}{self._other_shafts}."
        elif low > 0:
            board += f" Leave it open underneath, {deep}."
        return f"{board} {self._turned}. {self._greased}{_CHECK}"

    @property
    def _greased(self) -> str:
        """What of metal runs on metal and has no bearing that is greased when it is sold, in a sentence."""
        layout = self.layout
        if not layout.metal:
            return ""
        genevas = layout.drives_of(GenevaDrive)
        runs = (
            ("cams", layout.tips or layout.plates),
            ("teeth", layout.gear_wheels),
            ("slots", genevas),
            ("locking disc", genevas),
            ("rims of the rollers", layout.rollers),
            ("edges of the wheels", len(layout.edge_drives) > len(genevas)),
        )
        named = [what for what, there in runs if there]
        return f"Grease the {in_words(named)}. " if named else ""

    @property
    def _swept(self) -> float:
        """Radius about its shaft that a collar takes under the plate, or a hand crank with its knob, mm."""
        s = self.sizes
        end = max(s.pin_diameter + s.head, s.pin_diameter / 2 + s.wall)
        return max(self.collar_radius, s.hand_crank + end if s.hand_crank else 0.0)

    @property
    def _other_shafts(self) -> str:
        """Where else the board is left open, in words: under the collars of shafts that turn by what is on the plate."""
        layout = self.layout
        still = {*layout.discs, *layout.guest_links}  # shafts that do not turn, or are another's
        points = sorted(p for p in layout.shafts if p not in still)
        points = [p for p in points if layout.shafts[p] not in layout.drivers]
        if not points:
            return ""
        deep = self.sizes.thickness + 2 * self.fits.slide_clearance + _CLEAR
        across = 2 * (self.collar_radius + _CLEAR)
        return f"; under {' and '.join(points)} {deep:.4g} mm deep and {across:.4g} mm across"

    @property
    def _turned(self) -> str:
        """What turns the shafts, or pushes what slides."""
        if not self.layout.drivers:
            return f"Couple your drive to link {self.layout.driven}, along its slide"
        several = bool(self.layout.further)
        if self.sizes.face is not None:
            return (
                f"The motor{'s' if several else ''} under the plate turn{'' if several else 's'} it"
            )
        if self.sizes.hand_crank:
            return f"The hand crank turns it from {'below' if self.sizes.stand == 'none' else 'behind'}"
        flat = self.sizes.shaft_flat
        by = f", by {'their flats' if several else 'its flat'} {flat:g} mm deep" if flat else ""
        if self.sizes.shaft_key:
            by = f", by {'their keyways' if several else 'its keyway'}"
        if several:
            return f"Couple your drive to the shafts' lower ends{by}"
        return f"Couple your drive to the shaft's lower end{by}"

    def stand_ins(self) -> list[StandIn]:
        """The motor under the plate, and what is fitted."""
        face = self.sizes.face
        own = self.layout.fitted.stand_ins
        if face is None:
            return [*own]
        drivers = self.layout.drivers
        axes = [self.layout.at(GROUND, self.layout.shaft_of(link)) for link in drivers]
        wide = face.half if face.length else face.reach
        high = -self.sizes.base_thickness if face.width else 0.0  # where its sleeve ends
        low = -(face.length or 2 * face.half)
        names = ["motor", *(f"motor of {link}" for link in self.layout.further)]
        motors = zip(names, axes, strict=True)
        return [
            *(StandIn(name, GROUND, ((at, wide, low, high),), drives=True) for name, at in motors),
            *own,
        ]

    # ---- links and plate --------------------------------------------------------------------------------------------

    def _link(self, link: str) -> Part:
        layout = self.layout
        points = self.layout.points_of(link)
        thick = self.layout.thickness(link)
        holes: dict[str, Contour] = {}
        found = [point for point, (on, _) in layout.discs.items() if on == link]
        discs = [point for point in found if point not in layout.eccentrics]
        for point, z in ((point, z) for point, z in points.items() if point not in found):
            holes[f"hole {point}"] = circle(z, layout.hole(point, link) / 2)
            flat = layout.profile(point, link)
            if flat is not None:
                holes[f"hole {point}"] = flat.moved(1, z)
        holes |= dowel_holes(layout, link) | stud_holes(layout, link)
        holes |= slot_holes(layout, link, layout.slots_of(link).keys())
        bore = next((layout.hole(point, link) for point, z in points.items() if z == 0), None)
        if link in layout.marks:
            holes["mark"] = circle(layout.marks[link], self.sizes.pen_diameter / 2)
        own = own_contours(layout, link)
        if own:
            refuse_thin(link, own[0], holes, self.min_wall)
            holes |= {f"own hole {k}": hole for k, hole in enumerate(own[1:], 1)}
        layers, notes = link_layers(layout, link, holes)
        layers += [disc_layer(layout, point) for point in discs]
        notes = [
            f"level {layout.level[link]} of the machine, from the plate",
            *self._pressed(link),
            *self._square(link),
            *notes,
        ]
        if layout.metal and any(each.wheel.link == link for each in layout.pinned):
            notes.append("the dowel's hole is drilled with that of the locking disc in one go")
        return Part(
            part_name(link),
            self._titled(link),
            (*layers, *rails(layout, link, thick)),
            centres=tuple(points.values()),
            notes=tuple(notes),
            bore=bore,
            min_wall=self.min_wall,
            drawn_layer=len(layers) - 1,
            points=tuple(points.items()),
        )

    def _square(self, link: str) -> Iterator[str]:
        """How square to a link or plate of metal are its bores for bushes, its seats of ball bearings and its holes for pins: what leans in
        them tips what it carries, or the link."""
        layout = self.layout
        pivots = [point for point in layout.points_of(link) if point in layout.pivots]
        seats = [point for point in pivots if layout.bearing_in(point, link)]
        square = [*seats, *self._fixed(link)[1]]
        if layout.metal and square:
            yield SquareNote(listed("hole", square), _SQUARE)

    def _titled(self, link: str) -> str:
        """What a link is called: by its name, one that drives a Geneva wheel as the driver too."""
        name = link.replace("_", " ")
        drives = any(each.joint.cam == link for each in self.layout.drives_of(GenevaDrive))
        return f"Driver {name}" if drives else name[:1].upper() + name[1:]

    def _fixed(self, link: str) -> tuple[list[str], list[str]]:
        """Points at which shafts are fixed in a link, and those at which pins are."""
        layout = self.layout
        fixed = [
            point
            for point in layout.points_of(link)
            if point in layout.pivots
            and layout.pressed_in(point) == link
            and point not in layout.discs
            and (link != GROUND or in_first(layout, point))
        ]
        shafts = [point for point in fixed if point in layout.shafts]
        return shafts, [point for point in fixed if point not in shafts]

    def _pressed(self, link: str) -> list[str]:
        layout = self.layout
        shafts, pins = self._fixed(link)
        notes = [f"{listed('hole', shafts)} {layout.on_shaft} on the shaft"] if shafts else []
        by_joint: dict[str, list[str]] = {}
        for point in pins:
            said = f"{layout.pin_held(point)} in"
            by_joint.setdefault(said, []).append(point)
        for said, points in by_joint.items():
            what = "a pin" if len(points) == 1 else "pins"
            notes.append(f"{listed('hole', points)} for {what} {said}")
        return notes

    # ---- pins and shafts --------------------------------------------------------------------------------------------

    @property
    def collar_radius(self) -> float:
        """Of a shaft's collar, mm."""
        return self.sizes.shaft_diameter / 2 + self.sizes.head + self.sizes.wall

    @property
    def bore(self) -> Contour:
        """Of what is pressed on a shaft."""
        return self.sizes.shaft_bore(self.fits.press_clearance)

    def _counterweight(self) -> Iterator[MountedPart]:
        """The counterweight and its pins."""
        if self.weight is None:
            return
        link = self.layout.driven
        part, pins = self.weight
        at = self.layout.at(link, self.layout.shaft_of(link))
        z = -self.fits.slide_clearance - part.thickness
        if self.under is None:
            z = self.layout.floor(self.layout.level[part.name])
        yield part, Mount(part.name, link, at, z=z)
        yield from ((pin, Mount(pin.name, link, at + place, z=z)) for pin, place in pins)

    def _stack(self, point: str) -> Iterator[MountedPart]:
        """Pin or shaft of a point, and what is threaded on it."""
        layout = self.layout
        body = self.layout.pressed_in(point)
        if point in layout.guest_links:
            return
        at, bought = layout.at(body, point), layout.on_motor(point, GROUND)  # the motor's own shaft
        if point in layout.discs:
            yield from round_shaft(layout, point)
        for stub in stubs(layout, point):
            if point in layout.discs:
                continue
            if point not in layout.shafts:
                yield from pin(layout, point, stub)
            elif stub.hangs:
                yield self._shaft(layout.upper_web, stub, at)
            elif not bought:
                yield self._shaft(body, stub, at)
                if self.under is None or body != layout.driven:
                    yield self._collar(point, body, at)
            elif self.collar is not None:
                yield (
                    self.collar.collar(),
                    Mount("shaft-collar", layout.carrier(body), at, z=stub.grips[-1][1]),
                )
        if layout.capped(point):
            yield shaft_cap(layout, point)
        yield from bearings(layout, point)
        inner_rings = list(sleeves(layout, point))
        yield from inner_rings or self._spacers(point, body, at)

    def _spacers(self, point: str, body: str, at: complex) -> Iterator[MountedPart]:
        """What keeps apart what is threaded on a pin or shaft that is fixed in a body."""
        s = self.sizes
        layout = self.layout
        play = self.fits.slide_clearance
        for (_, under), (high, _) in (
            pair for stub in stubs(layout, point) for pair in pairwise(stub.grips)
        ):
            height = high - under - 2 * play
            step = s.thickness + play
            rings = int((height + play) / step + 1e-9) if s.of_sheet else 1  # of sheet one a level
            if height >= min(s.head, s.thickness / 4):  # what is thinner is play
                hole = layout.turning(point) + self.fits.running_clearance
                wide = layout.spacer_diameter(point)
                ring_part = spacer(
                    "spacer",
                    "Spacer",
                    hole,
                    wide,
                    s.thickness if s.of_sheet else height,
                    self.min_wall,
                )
                mount = Mount("spacer", layout.carrier(body), at, z=under + play)
                ring_part = replace(ring_part, role="spacer")
                yield from ((ring_part, replace(mount, z=mount.z + k * step)) for k in range(rings))

    def _collar(self, point: str, link: str, at: complex) -> MountedPart:
        """Of a shaft, under the plate."""
        s = self.sizes
        press = self.fits.press_clearance
        name = "collar"
        bore = self.bore
        if self.layout.clutch(point):
            name = f"collar-{link}"
        if self.layout.clutch(point) or s.shaft_key:  # it turns nothing
            bore = circle(0j, (s.shaft_diameter + press) / 2)
        part = Part(
            name,
            "Shaft collar",
            (Layer(Region(circle(0j, self.collar_radius), (bore,)), 0.0, s.thickness),),
            centres=(0j,),
            min_wall=self.min_wall,
            notes=("glued on the shaft under the plate",),
        )
        z = -self.fits.slide_clearance - s.thickness
        return part, Mount(name, self.layout.carrier(link), at, z=z)

    def _shaft(self, link: str, stub: Stub, at: complex) -> MountedPart:
        """A link's shaft, or the piece in its last web; the one that drives is longer below the plate."""
        driven = link in self.layout.drivers
        below = self.sizes.thickness + 2 * self.fits.slide_clearance
        below = self.sizes.shaft_length if driven else -stub.grips[0][0] if stub.hangs else below
        alone = link == self.layout.driven
        name = _SHAFT if alone else f"{_SHAFT}-{link}"
        sleeved = link in (self.layout.driven, self.layout.upper_web) and any(
            stand.sleeve for stand in self.layout.stands
        )
        top = sleeve_ends(self.layout)[1] if stub.far and sleeved else stub.grips[-1][1]
        reach = [stand.merged.shaft for stand in self.layout.stands if stand.merged is not None]
        top += (
            max(reach, default=0.0)
            if stub.far and link in (self.layout.driven, self.layout.upper_web)
            else 0.0
        )
        loose = [wheel for wheel, (on, _) in self.layout.freewheels.items() if on == link]
        if not (stub.far or loose):
            top -= self.layout.recess
        layer = Layer(Region(self.sizes.shaft_profile), 0.0, below + top)
        title = "Shaft" if alone else f"Shaft of {link.replace('_', ' ')}"
        held = self.layout.on_shaft
        collar = " and the collar" if held == "glued" else ", glued into the collar"
        if held == "glued" and driven and self.sizes.hand_crank:
            collar = f", the hand crank{collar}"
        said = f"{held} into {link}" + (", turns in the second plate" if stub.hangs else collar)
        s = self.sizes
        size = (
            f"{self.sizes.shaft_diameter:g}",
            f"x {below + top:g}",
        )
        flat = f", a flat {s.shaft_flat:g} deep" if s.shaft_flat else ""
        layers: tuple[Layer, ...] = (layer,)
        place = "all along"
        if s.shaft_key:
            layers, place = self._keyed(stub, below, below + top, driven)
        part = Part(
            name,
            title,
            layers,
            centres=(0j,),
            notes=(*s.rod(below + top, place, self.layout.rod_fit(link)), said),
            process=s.shafts_made,
            role="shaft",
            drawn_layer=max(range(len(layers)), key=lambda k: layers[k].region == layer.region),
        )
        if loose:
            end = below + max(self.layout.top(self.layout.level[wheel]) for wheel in loose)
            rod = Layer(Region(circle(0j, self.sizes.shaft_diameter / 2)), 0.0, end)
            hard = f"hardened steel rod {size[0]} h6 {size[1]}{flat} ground on its upper end"
            part = replace(
                part,
                layers=(rod, replace(layer, z0=end)),
                notes=(hard, said),
                process="bought",
                drawn_layer=1,
            )
        return part, Mount(name, self.layout.carrier(link), at, z=-below)

    def _keyed(
        self, stub: Stub, below: float, long: float, driven: bool
    ) -> tuple[tuple[Layer, ...], str]:
        """Layers of a shaft that is round where it turns in plates, with keyways along what it turns; and where these are, in words.

        below: how far it reaches under the plate, mm; long: all of it, mm; driven: whether its lower end drives.
        """
        s = self.sizes
        upper = below + stub.grips[1][0]
        end = below + stub.grips[-2][1] if stub.through else long
        lower = 0.0
        if driven and s.hand_crank:
            lower = s.thickness
        elif driven:
            play = self.fits.slide_clearance
            lower = below - play - (self.under is None) * (s.thickness + play)
        keyed = Region(s.shaft_profile)
        bare = Region(circle(0j, s.shaft_diameter / 2))
        ends = (0.0, lower, upper, end, long)
        spans = zip((keyed, bare, keyed, bare), pairwise(ends), strict=True)
        layers = tuple(Layer(region, *span) for region, span in spans if span[1] > span[0] + 1e-9)
        places = [f"over the first {lower:.4g}"] if lower > 1e-9 else []
        to = "on" if end == long else f"to {end:.4g}"
        return layers, " and ".join([*places, f"from {upper:.4g} {to}"])

    # ---- joints -----------------------------------------------------------------------------------------------------

    def features(self) -> Sequence[Feature]:
        """What its joints are measured on."""
        return features_of(self.layout, self.of_role("pin", "crank-pin", "shaft"))

    def machine(self) -> m.Machine:
        """The machine with the clearances of its fits, diametral, mm, its slides where their bars are."""
        layout = self.layout
        joints: list[m.Joint] = []
        for joint in layout.machine.joints:
            if isinstance(joint, m.Slide):
                guide = layout.guides[joint.runner.body].joint
                joint = replace(guide, clearance=self.fits.slide_clearance)
            elif isinstance(joint, m.Pin | m.Slot):
                point, a, b = point_of(layout, joint)
                joint = replace(joint, clearance=layout.fit(point, a) + layout.fit(point, b))
            elif isinstance(joint, m.Cam) and joint.name in layout.cams and joint.over is None:
                shaft = layout.at(joint.cam, layout.shaft_of(joint.cam))
                joint = with_touches(joint, layout.tips, shaft)
            elif isinstance(joint, m.Cam) and joint.over is not None:
                way = cmath.exp(1j * layout.machine.slide(joint.over).angle)
                plate = next(each for each in layout.plates if each.joint.name == joint.name)
                joint = plate.touched(way)
            joints.append(joint)
        return replace(layout.machine, joints=tuple(joints))

    def solids(self, density: float) -> Solids:
        """Its parts, as masses follow from them; density of what is printed, kg/m^3."""
        return Solids(self.parts, self.mounts, density)

    def with_masses(self, density: float, given: Collection[str]) -> m.Machine:
        """The fitted machine with the masses of its solids, but for links whose mass is given; density: kg/m^3."""
        machine = self.machine()
        solids = self.solids(density)
        kept = (GROUND, *given)
        bodies = (b if b.name in kept else solids.body(b) for b in machine.bodies)
        return replace(machine, bodies=tuple(bodies))


def _with_even_heights(part: Part) -> Part:
    """The part with heights without what rounding leaves: sums in another order give one part, not two."""

    def even(layers: Sequence[Layer]) -> tuple[Layer, ...]:
        return tuple(replace(each, z0=round(each.z0, 9), z1=round(each.z1, 9)) for each in layers)

    return replace(part, layers=even(part.layers), engraved=even(part.engraved))
