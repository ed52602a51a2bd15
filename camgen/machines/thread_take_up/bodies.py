"""What a two-crank take-up is made of: frame, pivot, cranks, bell crank, shaft, pins, and finger and guides for the thread.

groove    of finger and guides, under their heads: the thread lies in it, above all heads of pins, and cannot slip along
collar    of the shaft, below the frame; a counterweight of the input crank takes its place
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

from camgen.errors import DesignError
from camgen.geometry.outlines import Contour, Region, circle
from camgen.machine.features import Eye, Feature, Mark, Mount, PinEyes, Strand
from camgen.machine.model import GROUND
from camgen.machines.loads.counterweights import ShaftSeat, ShaftWeight
from camgen.machines.loads.weights import with_masses
from camgen.parts.catalogue import TURNED
from camgen.parts.hardware import grooved, headed
from camgen.parts.inertia import Solids, printed_density
from camgen.parts.part import Layer, Part, d_bore, hull, rod
from camgen.tolerances import SAME_POINT

if TYPE_CHECKING:
    from camgen.machines.thread_take_up.mechanism import ThreadTakeUp

Disc = tuple[complex, float]
HEAD = 1.0  # mm, height of a head, and how far it and a groove's shoulder stand out all round
LINKS = {"input-crank": "crank", "bell-crank": "coupler", "output-crank": "output"}  # part -> body
_GLUED = "pressed and glued in"


class Bodies:
    """The parts of a take-up, and where they stand; sizes mm."""

    def __init__(self, spec: ThreadTakeUp) -> None:
        self.spec, self.sizes, self.fits, self.min_wall = (
            spec,
            spec.making,
            spec.print,
            spec.allowed.min_wall,
        )

    @property
    def level(self) -> float:
        """Height of a layer of the assembly: a part's thickness and the play to the next, mm."""
        return self.sizes.thickness + self.fits.slide_clearance

    @cached_property
    def bearing(self) -> float:
        """Radius of the disc about C: round the shaft and two dowels with a wall each, mm."""
        p, shaft, dowel = (
            self.sizes,
            (self.sizes.shaft_diameter + self.fits.slide_clearance) / 2,
            self._dowel_hole,
        )
        frame, room = self.spec.geometry.frame, shaft + dowel + p.wall
        beside = math.sqrt(max(0.0, room**2 - frame**2)) + dowel + p.wall
        return max(frame + shaft + p.wall, beside)

    @property
    def _dowel_hole(self) -> float:
        return (self.sizes.pin_diameter + self.fits.press_clearance) / 2

    @property
    def dowels(self) -> tuple[complex, complex]:
        """Places of the two dowels in the pivot, in its axes."""
        at = 1j * (self.bearing - self.sizes.wall - self._dowel_hole)
        return at, -at

    def _hubs(self, *holes: Disc) -> tuple[Disc, ...]:
        return tuple((centre, radius + self.sizes.wall) for centre, radius in holes)

    @cached_property
    def links(self) -> Mapping[str, tuple[tuple[Disc, ...], tuple[Disc, ...]]]:
        """Hubs and holes of each link, in its own frame: (centre, radius), mm."""
        g, p, slide, press = (
            self.spec.geometry,
            self.sizes,
            self.fits.slide_clearance,
            self.fits.press_clearance,
        )
        eye = self.spec.take_up.eye  # refuses lengths that do not assemble before any part is drawn
        turning, pressed, finger = (
            (p.pin_diameter + slide) / 2,
            (p.pin_diameter + press) / 2,
            (p.finger_diameter + press) / 2,
        )
        crank = ((0j, p.shaft_diameter / 2 + press / 2), (complex(g.input_crank), pressed))
        output = ((0j, self.bearing + slide / 2), (complex(g.output_crank), pressed))
        bell = ((0j, turning), (complex(g.coupler), turning), (eye, finger))
        holes = {"input-crank": crank, "output-crank": output, "bell-crank": bell}
        return {name: (self._hubs(*each), each) for name, each in holes.items()}

    @cached_property
    def bands(self) -> Mapping[str, tuple[tuple[Disc, ...], tuple[Disc, ...]]]:
        """The same of every flat part."""
        p, slide, t = self.sizes, self.fits.slide_clearance, self.spec.take_up
        shaft, guide = (
            (p.shaft_diameter + slide) / 2,
            (p.guide_diameter + self.fits.press_clearance) / 2,
        )
        dowels = tuple((z, self._dowel_hole) for z in self.dowels)
        posts = tuple((z, guide) for z in t.guides)
        plate = (
            (0j, shaft),
            *((t.pivot + cmath.exp(1j * t.tilt) * z, r) for z, r in dowels),
            *posts,
        )
        mounts = tuple((z, p.mount_diameter / 2) for z in self.mount_holes(t.pivot, t.guides))
        return {
            "frame": ((*self._hubs(*posts, *mounts), (t.pivot, self.bearing)), (*plate, *mounts)),
            "pivot": (
                ((0j, self.bearing),),
                ((complex(-self.spec.geometry.frame), shaft), *dowels),
            ),
            **self.links,
        }

    def mount_holes(self, pivot: complex, guides: Sequence[complex]) -> tuple[complex, ...]:
        """Where the frame is screwed on: beyond each guide, and beyond the pivot on the side away from both, clear of a
        counterweight."""
        p = self.sizes
        away = [guide - pivot for guide in guides]
        middle = sum(z / abs(z) for z in away if z)
        sides = [*away, -middle if abs(middle) > SAME_POINT else 1j * away[0]]
        past, weight = p.wall + p.mount_diameter / 2, self.weight_radius
        clear = (
            weight and weight + self.spec.geometry.frame + self.spec.allowed.gap + p.mount_diameter
        )  # for a screw's head
        reach = [
            *(abs(z) + (p.guide_diameter + self.fits.press_clearance) / 2 for z in away),
            max(self.bearing, clear),
        ]
        return tuple(
            pivot + z / abs(z) * (r + past) for z, r in zip(sides, reach, strict=True) if z
        )

    # ---- parts -------------------------------------------------------------------------------------------------------

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """Five flat parts, and the round ones: shaft with its collar or counterweight, pins, dowels, finger and guides."""
        p, level, slide = self.sizes, self.level, self.fits.slide_clearance
        crank, shaft, collar, pin_a = self._turning
        output, bell, pin_b, finger = self._carried
        return (
            self._flat(
                "frame",
                "Frame with the guides",
                p.thickness,
                (
                    "shaft at the origin; the guides are pressed in",
                    "the outermost holes are for screws from behind",
                ),
            ),
            self._flat(
                "pivot",
                "Pivot of the output crank",
                level,
                ("two dowels hold it on the frame; the shaft passes it",),
            ),
            output,
            crank,
            bell,
            shaft,
            *(self.weight.parts if self.weight else (collar,)),
            pin_a,
            pin_b,
            replace(
                rod("dowel", "Dowel", p.pin_diameter, p.thickness + level),
                count=2,
                notes=(_GLUED,),
                made=self._thin,
            ),
            finger,
            self._post("guide", "Guide", p.guide_diameter, 4 * level - slide + p.thread_height, 2),
        )

    @property
    def _made(self) -> str:
        return "printed" if self.sizes.pins == "printed" else TURNED

    @property
    def _thin(self) -> str:
        """How what does not bear a crank is made."""
        return TURNED if self.sizes.pins == "all-steel" else "printed"

    @cached_property
    def _turning(self) -> tuple[Part, Part, Part, Part]:
        """What turns with the input crank: itself, shaft, collar, pin A."""
        p, level = self.sizes, self.level
        length = p.shaft_length + 2 * level + p.thickness
        return (
            self._flat(
                "input-crank",
                "Input crank",
                p.thickness,
                ("pressed on the shaft; pin A is pressed in",),
            ),
            Part(
                "shaft",
                "Input shaft",
                (Layer(Region(self._shaft(0.0)), 0.0, length),),
                centres=(0j,),
                made=self._made,
                notes=("glued into input crank and collar, turns in frame and pivot",),
                role="shaft",
            ),
            Part(
                "collar",
                "Collar of the shaft",
                (Layer(Region(circle(0j, self._collar), (self._bore,)), 0.0, p.thickness),),
                centres=(0j,),
                notes=("pressed and glued on the shaft below the frame",),
                min_wall=self.min_wall,
            ),
            self._pin("pin-a", "Pin A", p.pin_diameter, 2 * level, self._made),
        )

    @cached_property
    def _carried(self) -> tuple[Part, Part, Part, Part]:
        """What else moves: output crank, bell crank, pin B, finger."""
        p = self.sizes
        return (
            self._flat(
                "output-crank",
                "Output crank",
                p.thickness,
                ("its ring turns on the pivot; pin B is pressed in",),
            ),
            self._flat(
                "bell-crank",
                "Bell crank with the eye",
                p.thickness,
                ("turns on pins A and B; finger pressed in",),
            ),
            self._pin("pin-b", "Pin B", p.pin_diameter, 3 * self.level, self._made),
            self._post(
                "finger", "Finger of the eye", p.finger_diameter, p.thickness + p.thread_height
            ),
        )

    @property
    def _collar(self) -> float:
        """Radius of the collar."""
        return self.sizes.shaft_diameter / 2 + 2 * self.sizes.wall

    @property
    def _bore(self) -> Contour:
        """What is pressed on the shaft."""
        return self._shaft(self.fits.press_clearance)

    def _shaft(self, fit: float) -> Contour:
        """Outline of the input shaft, a circle with a flat, or of its hole."""
        return d_bore(self.sizes.shaft_diameter + fit, self.sizes.shaft_flat)

    def _pin(self, name: str, title: str, diameter: float, length: float, made: str) -> Part:
        """A round pin so long below its head, pressed and glued in."""
        pin = headed(name, title, diameter, length, diameter + 2 * HEAD, HEAD)
        return replace(pin, notes=(_GLUED,), made=made, role="pin")

    def _post(self, name: str, title: str, diameter: float, length: float, count: int = 1) -> Part:
        """The same with a groove for the thread under its head."""
        groove = self.sizes.groove
        post = replace(self._pin(name, title, diameter, length, self._thin), count=count)
        if not groove:
            return post
        note = f"the thread runs in the groove, {groove:g} high, between head and shoulder"
        return replace(grooved(post, groove), notes=(_GLUED, note))

    def _flat(self, name: str, title: str, thickness: float, notes: tuple[str, ...]) -> Part:
        """A band round hubs with holes; raises DesignError where two holes meet."""
        hubs, holes = self.links[name] if name in self.links else self.bands[name]
        pairs = [(a, b) for k, a in enumerate(holes) for b in holes[k + 1 :]]
        wall, worst = min(
            ((abs(a[0] - b[0]) - a[1] - b[1], (a, b)) for a, b in pairs), key=lambda each: each[0]
        )
        if wall <= 0:
            sizes = " and ".join(f"{2 * radius:.4g} mm" for _, radius in worst)
            raise DesignError(
                f"wall of {name}",
                wall,
                self.min_wall,
                "mm",
                f"the holes of {sizes}",
                "they meet: use longer links, a smaller shaft_diameter, pin_diameter or frame",
            )
        contours = [circle(centre, radius) for centre, radius in holes]
        if name == "input-crank":
            contours[0] = self._bore
        region = Region(hull(hubs), tuple(contours))
        bore = None if name in ("frame", "pivot") else 2 * holes[0][1]  # of what turns
        return Part(
            name,
            title,
            (Layer(region, 0.0, thickness),),
            centres=tuple(centre for centre, _ in holes),
            notes=notes,
            bore=bore,
            min_wall=self.min_wall,
        )

    # ---- thread ------------------------------------------------------------------------------------------------------

    @property
    def strand(self) -> Strand:
        """The thread from guide to guide by way of the finger, and the heights of the grooves that hold it."""
        top = 4 * self.level - self.fits.slide_clearance + self.sizes.thread_height
        groove = (
            self.sizes.groove or self.sizes.thread_height
        )  # plain posts: from the bell crank up to their heads
        return Strand(
            "thread",
            (("guide", 0), ("finger", 0), ("guide", 1)),
            top - groove,
            top,
            HEAD / 2,
            self.spec.allowed.gap,
        )

    # ---- counterweight -----------------------------------------------------------------------------------------------

    @cached_property
    def weight(self) -> ShaftWeight | None:
        """The counterweight of the input crank, in place of the collar."""
        weight = self.spec.counterweight
        if weight is None:
            return None
        rest = [part for part in (*self._turning, *self._carried) if part.name != "collar"]
        solids = Solids(rest, mounts_of(self.spec), printed_density(self.spec.material))
        machine = with_masses(self.spec.model, solids, self.spec.load).machine
        seat = ShaftSeat(
            self._collar,
            self._bore,
            self.sizes.thickness,
            self.min_wall,
            self.fits,
            "pressed and glued on the shaft below the frame",
        )
        return ShaftWeight(weight, "crank", solids, machine, seat)

    @property
    def weight_radius(self) -> float:
        """How far a counterweight reaches from the shaft, mm; 0 without one."""
        return self.weight.radius if self.weight else 0.0

    @property
    def mounts(self) -> Sequence[Mount]:
        """Every part on its layer: frame 0, output crank and pivot 1, input crank 2, bell crank 3, thread above."""
        found, weight = mounts_of(self.spec), self.weight
        if weight is None:
            return found
        made = weight.mounts(-self.fits.slide_clearance - weight.part.thickness)
        return [new for old in found for new in (made if old.part == "collar" else [old])]


# ---- assembly --------------------------------------------------------------------------------------------------------


def features_of(spec: ThreadTakeUp) -> Sequence[Feature]:
    """Pins O, A, B and C; the eye and the guides, between which the thread is the output."""
    g, p, slide, press = (
        spec.geometry,
        spec.making,
        spec.print.slide_clearance,
        spec.print.press_clearance,
    )
    shaft, turning, pressed, ring = (
        p.shaft_diameter,
        p.pin_diameter + slide,
        p.pin_diameter + press,
        2 * spec.bodies.bearing,
    )
    return (
        PinEyes(
            "O",
            Eye("pivot", complex(-g.frame), shaft + slide),
            Eye("input-crank", 0j, shaft + press),
            Eye("shaft", 0j, shaft, True),
        ),
        PinEyes(
            "A",
            Eye("input-crank", complex(g.input_crank), pressed),
            Eye("bell-crank", 0j, turning),
            Eye("pin-a", 0j, p.pin_diameter, True),
        ),
        PinEyes(
            "B",
            Eye("output-crank", complex(g.output_crank), pressed),
            Eye("bell-crank", complex(g.coupler), turning),
            Eye("pin-b", 0j, p.pin_diameter, True),
        ),
        PinEyes("C", Eye("pivot", 0j, ring, True), Eye("output-crank", 0j, ring + slide)),
        Mark(Eye("bell-crank", spec.take_up.eye, p.finger_diameter + press)),
        *(Mark(Eye("frame", guide, p.guide_diameter + press)) for guide in spec.take_up.guides),
    )


def mounts_of(spec: ThreadTakeUp) -> Sequence[Mount]:
    """Every part on its body, a level for each layer, without a counterweight."""
    t, p, level = spec.take_up, spec.making, spec.bodies.level
    dowels = [t.pivot + cmath.exp(1j * t.tilt) * place for place in spec.bodies.dowels]
    return (
        Mount("frame", GROUND),
        Mount("pivot", GROUND, t.pivot, t.tilt, z=p.thickness),
        Mount("output-crank", "output", z=level),
        Mount("input-crank", "crank", z=2 * level),
        Mount("bell-crank", "coupler", z=3 * level),
        Mount("shaft", "crank", z=-p.shaft_length),
        Mount("collar", "crank", z=-level),
        Mount("pin-a", "crank", complex(t.crank), flipped=True, z=2 * level),
        Mount("pin-b", "output", complex(t.output), flipped=True, z=level),
        *(Mount("dowel", GROUND, z) for z in dowels),
        Mount("finger", "coupler", t.eye, flipped=True, z=3 * level),
        *(Mount("guide", GROUND, z, flipped=True) for z in t.guides),
    )
