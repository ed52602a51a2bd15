"""What a machine stands on: sheets with tabs and slots, found from all that moves.

board   the plate stands up on its edge: a panel behind it, two gussets behind that, all of them in a foot under everything that moves
box     the plate lies: a lid under it on four walls with finger joints, round all that hangs under the plate, open below

Places are local here: x along the table, y up for a board; of a box those of the machine. What passes the panel or the lid has an
opening there, as wide as it sweeps. A tab is nominal, what it goes into is wider: several tabs go in at once, with glue.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Contour, Points, Region, circle, polygon, rectangle
from camgen.machine.features import Mount, StandIn, heights
from camgen.machine.model import GROUND, MM
from camgen.numerics import coordinates, magnitude
from camgen.parts.assembly import TABLE, Assembly, StandStep, Support, bodies_in_motion
from camgen.parts.catalogue import CORE_HOLES, SCREWS, Bought, screw_for
from camgen.parts.generator.sizes import Parts
from camgen.parts.hardware import plate
from camgen.parts.inertia import centre_of
from camgen.parts.part import Layer, Part, hull
from camgen.spec import Print

_SAMPLES = (
    720  # of a turn, between which 100 mm from its axis nothing moves out by more than 0.001 mm
)
_FACETS = 0.05  # mm, on which the reach of outlines is measured
_AIR = 2.0  # mm, between what moves and the stand
_BESIDE = 0.5  # mm more than bodies keep, round what passes through an opening
_HAND = 20.0  # mm, for fingers round a hand crank
_LEAN = math.tan(math.radians(12))  # of the height of the centre of mass: how far inside it stays
_DEEP = 0.3  # of a panel's height, that the gussets reach behind it at least
_SHALLOW = 20.0  # mm, of a box and of gussets at least
_FINGER = 3.0  # thicknesses, width of a finger
_LOOSE = 0.5  # mm, by which a hole for a screw without a known thread is wider
_TOO_NEAR = (
    "use a smaller parts.hand_crank or a longer parts.shaft_length, or leave parts.stand out"
)
_FRAME = 10.0  # mm, width of a window of a stand, and of the frame round that of a box, at least
_RIB = 4.0  # mm, width of what a window of a board leaves beside holes, slots and edges, at least
_TABLE = 3.0  # mm, half of what is taken of the table


@dataclass(frozen=True, eq=False)
class Sweep:
    """What one layer of a part, or a thing that is not made, reaches over the motion, mm."""

    low: float
    high: float
    centre: complex  # of a circle round all of it
    radius: float
    box: tuple[complex, complex]  # lower left and upper right corner
    moves: bool


def sweeps(assembly: Assembly, turn: complex = 1 + 0j) -> list[Sweep]:
    """What all bodies reach over the motion, in axes that are turned by a unit complex."""
    machine = bodies_in_motion(assembly)
    turns = assembly.cycle.turns
    phase = np.linspace(0, turns * math.tau, turns * _SAMPLES, endpoint=False)
    courses = machine.courses(phase)
    found: list[Sweep] = []

    def add(body: str, origin: complex, corners: Points, low: float, high: float) -> None:
        pose = courses[body]
        way = np.exp(1j * np.broadcast_to(pose.angle, phase.shape))
        place = np.broadcast_to(np.asarray(pose.place, complex), phase.shape)
        moved = (place + way * corners[:, None]) / turn
        middle = (place + way * origin) / turn
        moved = moved[:, np.isfinite(moved).all(axis=0)]
        centre = complex(np.mean(middle[np.isfinite(middle)]))
        low_left = complex(moved.real.min(), moved.imag.min())
        high_right = complex(moved.real.max(), moved.imag.max())
        moves = bool(np.ptp(moved.real, axis=1).max() + np.ptp(moved.imag, axis=1).max() > 1e-9)
        reach = magnitude(moved - centre)
        found.append(Sweep(low, high, centre, reach, (low_left, high_right), moves))

    for mount in assembly.mounts:
        part = assembly.by_name[mount.part]
        for layer in part.layers:
            rim = facet_contour(layer.region.outer, _FACETS)
            corners = np.array([mount.place(z) for z in _convex(rim)])
            add(mount.body, mount.at, corners, *heights(mount, part.thickness, layer.z0, layer.z1))
    for thing in machine.stand_ins:
        for at, radius, low, high in thing.discs:
            add(thing.body, at, _round(at, radius), low, high)
        for a, b, radius, low, high in thing.bars:
            add(thing.body, a, np.append(_round(a, radius), _round(b, radius)), low, high)
    return found


def _round(at: complex, radius: float) -> Points:
    return np.asarray(at + radius * np.exp(1j * np.linspace(0, math.tau, 64, endpoint=False)))


def _convex(rim: Points) -> list[complex]:
    import shapely

    hull_of = shapely.MultiPoint(coordinates(rim)).convex_hull
    return [complex(x, y) for x, y in shapely.get_coordinates(hull_of).tolist()]


@dataclass(frozen=True)
class _Extent:
    """A box that grows, mm."""

    low: complex
    high: complex

    def grown(self, low: complex, high: complex, by: complex = 0j) -> _Extent:
        """So large that it holds another one with some air on all sides."""
        return _Extent(
            complex(min(self.low.real, low.real - by.real), min(self.low.imag, low.imag - by.imag)),
            complex(
                max(self.high.real, high.real + by.real), max(self.high.imag, high.imag + by.imag)
            ),
        )


@dataclass(frozen=True)
class StandParts:
    """What a stand is made of, where the copies stand, the table, and what the steps say of each part."""

    parts: Sequence[Part]
    mounts: Sequence[Mount]
    table: StandIn
    steps: Sequence[StandStep]


@dataclass(frozen=True, eq=False)
class TableStand:
    """A stand of a machine; up: unit complex that points away from the table, of a board."""

    assembly: Assembly
    kind: str  # "board" or "box"
    sizes: Parts
    fits: Print
    min_wall: float
    up: complex = 1j

    # ---- what is in the way ------------------------------------------------------------------------------------------

    @property
    def turn(self) -> complex:
        """The local x axis, as a unit complex."""
        return self.up / 1j if self.kind == "board" else 1 + 0j

    @cached_property
    def swept(self) -> list[Sweep]:
        """All that is there, in local axes."""
        return sweeps(self.assembly, self.turn)

    @property
    def thick(self) -> float:
        """Of all its sheets, mm."""
        return self.sizes.thickness

    @property
    def fit(self) -> float:
        """By how much a slot is longer and wider than its tab, mm: of sheet by the press fit, which the kerf keeps to."""
        printed = self.assembly.process.sheet is None
        return self.fits.slide_clearance if printed else self.fits.press_clearance

    @property
    def rim(self) -> float:
        """Material round tabs and openings, mm: round a slot, which is wider than its tab, no less than the least wall."""
        return max(self.sizes.wall, self.min_wall + self.fit / 2)

    @cached_property
    def behind(self) -> list[Sweep]:
        """What reaches under the plate and beyond the panel."""
        return [each for each in self.swept if each.low < -self.thick]

    @property
    def hand(self) -> float:
        """Room round what moves behind the panel, mm."""
        return _HAND if self.assembly.motor.crank else 0.0

    @cached_property
    def screws(self) -> list[complex]:
        """Places of the plate's screws."""
        assert self.assembly.frame is not None, "a machine with a plate"
        return [z / self.turn for z, _ in self.assembly.frame.fixings]

    @property
    def _screw_hole(self) -> float:
        """Diameter of their holes, mm."""
        core = self.sizes.mount_diameter
        threads = [SCREWS[thread] for thread, hole in CORE_HOLES.items() if hole == core]
        return threads[0].clearance if threads else core + _LOOSE

    @cached_property
    def openings(self) -> list[Contour]:
        """Of panel or lid, for what reaches into it; those that nearly meet are one."""
        passing = [each for each in self.swept if each.low < 0 and each.high > -self.thick - _AIR]
        air = self.assembly.process.gap + _BESIDE
        groups = [[(each.centre, each.radius + air)] for each in passing]
        while True:
            near = next(
                (
                    (j, k)
                    for k in range(len(groups))
                    for j in range(k)
                    if any(
                        abs(a - b) < r + s + self.rim for a, r in groups[j] for b, s in groups[k]
                    )
                ),
                None,
            )
            if near is None:
                return [hull(group) for group in groups]
            j, k = near
            groups[j] += groups.pop(k)

    def holes(self) -> dict[str, Contour]:
        """Of panel or lid, for screws and for what passes it."""
        named = {
            f"screw {k}": circle(z, self._screw_hole / 2) for k, z in enumerate(self.screws, 1)
        }
        return named | {f"opening {k}": each for k, each in enumerate(self.openings, 1)}

    @cached_property
    def held(self) -> _Extent:
        """Box round the holes of panel or lid, with material round them."""
        rims = [facet_contour(each, _FACETS) for each in self.holes().values()]
        z = np.concatenate(rims)
        margin = self.rim + _FACETS
        low = complex(z.real.min() - margin, z.imag.min() - margin)
        return _Extent(low, complex(z.real.max() + margin, z.imag.max() + margin))

    @cached_property
    def centres(self) -> tuple[Points, float]:
        """The machine's centre of mass without its stand over the motion, local (n,) complex mm, and its height over the plate."""
        solids = self.assembly.solids
        turns = self.assembly.cycle.turns
        phase = np.linspace(0, turns * math.tau, turns * _SAMPLES, endpoint=False)
        courses = self.assembly.courses(phase)
        total = 0.0
        high = 0.0
        moment = np.zeros(len(phase), complex)
        for mount in self.assembly.mounts:
            part = solids.by_name[mount.part]
            if part.process == "dummy":
                continue
            mass = part.volume * solids.density_of(part) * MM**3
            pose = courses[mount.body]
            place = pose.place + np.exp(1j * pose.angle) * mount.place(centre_of(part))
            low, top = heights(mount, part.thickness, 0.0, part.thickness)
            moment = moment + mass * place
            high += mass * (low + top) / 2
            total += mass
        centre = moment / total / self.turn
        return centre[np.isfinite(centre)], high / total

    # ---- parts -------------------------------------------------------------------------------------------------------

    def _panel(self, name: str, title: str, outer: Any, slots: Mapping[str, Contour]) -> Part:
        """What the plate is screwed on."""
        holes = {**self.holes(), **slots}
        try:
            region = plate(title.lower(), _contour(outer), holes, self.min_wall)
        except DesignError as error:
            if not error.between:
                raise
            a, b = error.between
            quantity = error.quantity
            value = error.value
            limit = error.limit
            raise DesignError(quantity, value, limit, error.unit, (a, b), _TOO_NEAR) from None
        notes = (f"{len(self.screws)} screws through it from behind, into the plate",)
        return self._sheet(name, title, region, notes)

    def _sheet(self, name: str, title: str, region: Region, notes: Sequence[str] = ()) -> Part:
        layer = Layer(region, 0.0, self.thick)
        return Part(name, title, (layer,), min_wall=self.min_wall, notes=tuple(notes))

    @property
    def frame(self) -> float:
        """Width of the frame round a window, mm: fingers or a tab with material on both sides."""
        return max(2 * self.rim + self.thick, _FRAME)

    @property
    def rib(self) -> float:
        """Width of what windows of a board leave, mm: a screw's head or a tab's glue bears on no less."""
        return max(2 * self.rim, _RIB)

    def _slot(self, low: complex, high: complex) -> Contour:
        """For a tab between two corners."""
        by = complex(self.fit, self.fit) / 2
        return rectangle(low - by, high + by)

    def made(self) -> StandParts:
        """All that it is."""
        return _board(self) if self.kind == "board" else _box(self)

    def bought(self) -> list[Bought]:
        """Screws that hold the plate on it; the others of the machine."""
        core = self.sizes.mount_diameter
        screw = next((SCREWS[name] for name, hole in CORE_HOLES.items() if hole == core), None)
        if screw is None:
            size = f"{screw_for(core)}, at most {self.thick + self.sizes.base_thickness:g} long"
        else:
            size = f"{screw.thread} x {screw.length(self.thick, self.sizes.base_thickness):g}"
        name = "screw of the plate, through the stand"
        sheet = "panel" if self.kind == "board" else "lid"
        how = f"from below, through the {sheet} into the {core:g} mm holes of the plate"
        key = "parts.mount_diameter"
        own = Bought(name, "", size, len(self.screws), "mount", key=key, how=how)
        if screw is not None:
            length = screw.length(self.thick, self.sizes.base_thickness)
            own = replace(own, standard=screw.standard, thread=screw.thread, length=length)
        return [*(each for each in self.assembly.bought if each.role != "mount"), own]


def on_stand(stand: TableStand) -> Assembly:
    """The machine with its stand, and the table, which is in the way."""
    made = stand.assembly
    own = stand.made()
    down = (-stand.up.real, -stand.up.imag, 0.0) if stand.kind == "board" else (0.0, 0.0, -1.0)
    return replace(
        made,
        parts=[*made.parts, *own.parts],
        mounts=[*made.mounts, *own.mounts],
        stand_ins=[*made.stand_ins, own.table],
        bought=stand.bought(),
        support=Support(down, tuple(own.steps), frozenset(part.name for part in own.parts)),
    )


def _area(contour: Contour) -> Any:
    import shapely

    rim = facet_contour(contour, _FACETS)
    return shapely.Polygon(coordinates(rim))


def _box_of(low: complex, high: complex) -> Any:
    import shapely

    return shapely.box(low.real, low.imag, high.real, high.imag)


def _contour(area: Any) -> Contour:
    """The edge of an area of straight lines, without corners that are none."""
    import shapely

    rim = shapely.get_coordinates(shapely.simplify(shapely.normalize(area), 0.0).exterior)
    z = np.round(rim[:-1, 0] + 1j * rim[:-1, 1], 9)
    before = z - np.roll(z, 1)
    after = np.roll(z, -1) - z
    corners = z[np.abs(np.imag(before.conj() * after)) > 1e-9]
    return polygon(corners.tolist()).counter_clockwise()


# ---- a board ---------------------------------------------------------------------------------------------------------


def _window(name: str, low: complex, high: complex, edge: float) -> dict[str, Contour]:
    """An opening between two corners that leaves a frame, if it is worth one: the frame lies on the table or has a gusset behind."""
    low += edge * (1 + 1j)
    high -= edge * (1 + 1j)
    small = min(high.real - low.real, high.imag - low.imag) < max(edge, _FRAME)
    return {} if small else {name: rectangle(low, high)}


@dataclass(frozen=True)
class _Board:
    """Sizes of a board, mm, local: x along the table, y up, and z from the plate's underside to the front."""

    thick: float
    rim: float
    left: float  # between the gussets, which stand outside of left and right
    right: float
    floor: float  # underside of the panel, upper side of the foot
    top: float
    tall: float  # of the gussets
    deep: float  # how far they reach behind the panel
    front: float  # of the foot

    @classmethod
    def of(cls, stand: TableStand) -> _Board:
        """So large that it holds all holes, stays under the centre of mass and clear of what moves."""
        t = stand.thick
        centre, high = stand.centres
        lowest = min(
            each.box[0].imag - (stand.hand if each.low < -t and each.moves else 0.0)
            for each in stand.swept
        )
        floor = min(lowest, stand.held.low.imag) - _AIR
        top = stand.held.high.imag
        lean = _LEAN * (float(centre.imag.max()) - floor + t)
        left = min(stand.held.low.real, float(centre.real.min()) - lean)
        right = max(stand.held.high.real, float(centre.real.max()) + lean)
        for each in stand.behind:
            air = _AIR + (stand.hand if each.moves else 0.0)
            left = min(left, each.box[0].real - air)
            right = max(right, each.box[1].real + air)
        hanging = [-each.low - t for each in stand.behind if not each.moves]  # a motor
        deep = max(_DEEP * (top - floor), lean - t - high, _SHALLOW, *hanging)
        front = max(*(each.high for each in stand.swept), high + lean)
        return cls(t, stand.rim, left, right, floor, top, 0.6 * (top - floor), deep, front)

    @property
    def back(self) -> float:
        """Of the foot, in z."""
        return -self.thick - self.deep - self.rim

    @property
    def tabs(self) -> list[tuple[float, float]]:
        """Ends in x of the panel's tabs in the foot."""
        wide = self.right - self.left
        return [
            (self.left + wide * share - wide / 12, self.left + wide * share + wide / 12)
            for share in (0.25, 0.75)
        ]

    @property
    def gussets(self) -> tuple[float, float]:
        """Their left sides, in x."""
        return self.left - self.thick, self.right

    @property
    def foot_tab(self) -> tuple[float, float]:
        """Ends in z of a gusset's tab in the foot."""
        middle = -self.thick - self.deep / 2
        return middle - self.deep / 6, middle + self.deep / 6

    @property
    def panel_tab(self) -> tuple[float, float]:
        """Ends in y of a gusset's tab in the panel."""
        middle = self.floor + self.tall / 2
        return middle - self.tall / 6, middle + self.tall / 6

    def bays(self, stand: TableStand) -> list[tuple[float, float]]:
        """Between which heights the panel has no holes, mm."""
        rims = [facet_contour(each, _FACETS).imag for each in stand.holes().values()]
        bays = []
        under = self.floor
        for low, high in sorted((float(y.min()), float(y.max())) for y in rims):
            bays.append((under, low))
            under = max(under, high)
        return [*bays, (under, self.top)]

    def panel(self, stand: TableStand) -> Part:
        """What the machine's plate is screwed on."""
        t = self.thick
        outer = _box_of(
            complex(self.left - t - self.rim, self.floor),
            complex(self.right + t + self.rim, self.top),
        )
        for a, b in self.tabs:
            outer = outer.union(_box_of(complex(a, self.floor - t), complex(b, self.floor)))
        low, high = self.panel_tab
        slots = {
            f"slot {k}": stand._slot(complex(x, low), complex(x + t, high))
            for k, x in enumerate(self.gussets, 1)
        }
        for k, (low, high) in enumerate(self.bays(stand), 1):
            corners = complex(self.left, low), complex(self.right, high)
            slots |= _window(f"window {k}", *corners, stand.rib)
        return stand._panel("stand-panel", "Panel of the stand", outer, slots)

    def foot(self, stand: TableStand) -> Part:
        """What lies on the table; its y is the machine's height over the plate."""
        t = self.thick
        slots = {
            f"slot {k}": stand._slot(complex(a, -t), complex(b, 0))
            for k, (a, b) in enumerate(self.tabs, 1)
        }
        low, high = self.foot_tab
        slots |= {
            f"slot {k}": stand._slot(complex(x, low), complex(x + t, high))
            for k, x in enumerate(self.gussets, 3)
        }
        outer = rectangle(
            complex(self.left - t - self.rim, self.back),
            complex(self.right + t + self.rim, self.front),
        )
        behind = complex(self.left, -t - self.deep), complex(self.right, -t)
        slots |= _window("window 1", *behind, stand.rib)
        before = complex(self.left, 0), complex(self.right, self.front)
        slots |= _window("window 2", *before, stand.rib)
        region = plate("foot of the stand", outer, slots, stand.min_wall)
        return stand._sheet("stand-foot", "Foot of the stand", region)

    def gusset(self, stand: TableStand) -> Part:
        """What holds the panel upright, twice; its x is up."""
        t = self.thick
        corner = min(2 * self.rim + t, self.deep / 2)
        back = -t - self.deep
        high = self.floor + self.tall
        web = polygon(
            [
                complex(self.floor, back),
                complex(self.floor + corner, back),
                complex(high, -t - corner),
                complex(high, -t),
                complex(self.floor, -t),
            ]
        ).counter_clockwise()
        low, up = self.foot_tab
        area = _area(web).union(_box_of(complex(self.floor - t, low), complex(self.floor, up)))
        low, up = self.panel_tab
        area = area.union(_box_of(complex(low, -t), complex(up, 0)))
        inner = _area(web).buffer(-stand.rib, join_style="mitre")
        holes = (
            (_contour(inner),) if inner.geom_type == "Polygon" and inner.area > stand.rib**2 else ()
        )
        made = stand._sheet("stand-gusset", "Gusset of the stand", Region(_contour(area), holes))
        return replace(made, count=2)


def _board(stand: TableStand) -> StandParts:
    t = stand.thick
    sizes = _Board.of(stand)
    panel = sizes.panel(stand)
    gusset = sizes.gusset(stand)
    foot = sizes.foot(stand)
    turn = cmath.phase(stand.turn)
    mounts = [
        Mount(panel.name, GROUND, angle=turn, z=-stand.thick),
        *(
            Mount(gusset.name, GROUND, stand.turn * x, turn + math.pi / 2, upright=True)
            for x in sizes.gussets
        ),
        Mount(foot.name, GROUND, stand.turn * 1j * sizes.floor, turn, upright=True),
    ]
    low = sizes.floor - t - _TABLE
    west, east = (stand.turn * complex(x, low) for x in _along(stand))
    ends = min(sizes.back, *(each.low for each in stand.swept)), sizes.front
    table = StandIn(TABLE, GROUND, (), bars=((west, east, _TABLE, *ends),))
    behind = -t / 2, sum(sizes.foot_tab) / 2  # in z: of the panel's tabs, and of the gussets'
    beside = [x + t / 2 for x in sizes.gussets]
    middle = sum(sizes.panel_tab) / 2
    under = sizes.floor - t / 2
    in_panel = [(complex(x, middle), behind[0]) for x in beside]
    in_foot = [(complex(sum(ends) / 2, under), behind[0]) for ends in sizes.tabs]
    in_foot += [(complex(x, under), behind[1]) for x in beside]

    def glued(places: Sequence[tuple[complex, float]]) -> list[tuple[complex, float]]:
        return [(stand.turn * at, z) for at, z in places]

    up = stand.turn * 1j
    steps = [
        StandStep(
            gusset.name,
            "behind the panel, a tab of each in its slot",
            (0.0, 0.0, 1.0),
            glued(in_panel),
            t,
        ),
        StandStep(
            foot.name,
            "on the tabs of panel and gussets, flush below",
            (up.real, up.imag, 0.0),
            glued(in_foot),
            t,
        ),
    ]
    return StandParts([panel, gusset, foot], mounts, table, steps)


def _along(stand: TableStand) -> tuple[float, float]:
    """From where to where anything reaches along the table, mm."""
    return (
        min(each.box[0].real for each in stand.swept) - 1.0,
        max(each.box[1].real for each in stand.swept) + 1.0,
    )


# ---- a box -----------------------------------------------------------------------------------------------------------


def _box(stand: TableStand) -> StandParts:
    t = stand.thick
    centre, high = stand.centres
    depth = max(_SHALLOW, -t - min(each.low for each in stand.swept) + _AIR)
    lean = _LEAN * (high + t + depth)
    inside = stand.held.grown(
        complex(centre.real.min(), centre.imag.min()),
        complex(centre.real.max(), centre.imag.max()),
        complex(lean, lean),
    )
    for each in stand.behind:
        inside = inside.grown(*each.box, complex(_AIR, _AIR))
    low = inside.low - complex(t, t)
    high_corner = inside.high + complex(t, t)
    x = _fingers(low.real, high_corner.real, t)
    y = _fingers(low.imag, high_corner.imag, t)
    column = np.linspace(-t - depth, -t, max(2, round(depth / (_FINGER * t))) + 1).tolist()
    # lid: notches where tabs of the walls come up
    lid = _box_of(low, high_corner)
    half = stand.fit / 2
    for a, b in _odd(x):
        for y0 in (low.imag, high_corner.imag - t):
            corner = complex(a - half, y0)
            lid = lid.difference(_box_of(corner, complex(b + half, y0 + t)))
    for a, b in _odd(y):
        for x0 in (low.real, high_corner.real - t):
            corner = complex(x0, a - half)
            lid = lid.difference(_box_of(corner, complex(x0 + t, b + half)))
    panel = stand._panel("stand-lid", "Lid of the stand", lid, {})
    long = _wall(x, column, depth, t)
    for a, b in _odd(column):
        for x0 in (low.real, high_corner.real - t):
            long = long.difference(_box_of(complex(x0, a), complex(x0 + t, b)))
    short = _wall(y, column, depth, t)
    for a, b in _even(column):
        for y0 in (low.imag, high_corner.imag - t):
            short = short.difference(_box_of(complex(y0, a - half), complex(y0 + t, b + half)))
    walls = [
        stand._sheet("stand-side", "Side of the stand", _with_window(long, x, depth, stand)),
        stand._sheet("stand-end", "End of the stand", _with_window(short, y, depth, stand)),
    ]
    side, end = (replace(wall, count=2) for wall in walls)
    quarter = math.pi / 2
    mounts = [
        Mount(panel.name, GROUND, z=-t),
        Mount(side.name, GROUND, 1j * (low.imag + t), upright=True),
        Mount(side.name, GROUND, 1j * high_corner.imag, upright=True),
        Mount(end.name, GROUND, complex(low.real), quarter, upright=True),
        Mount(end.name, GROUND, complex(high_corner.real - t), quarter, upright=True),
    ]
    middle = (low + high_corner) / 2
    bottom = -t - depth
    disc = middle, abs(high_corner - middle), bottom - 2 * _TABLE, bottom
    table = StandIn(TABLE, GROUND, (disc,))
    beneath = (0.0, 0.0, 1.0)
    in_ends = [
        (complex(x0 + t / 2, (a + b) / 2), -t / 2)
        for a, b in _odd(y)
        for x0 in (low.real, high_corner.real - t)
    ]
    in_sides = [
        (complex((a + b) / 2, y0 + t / 2), -t / 2)
        for a, b in _odd(x)
        for y0 in (low.imag, high_corner.imag - t)
    ]
    fingers = "beside the ends, the fingers in theirs, the tabs in the lid"
    steps = [
        StandStep(end.name, "under the lid, the tabs in its notches", beneath, in_ends, t),
        StandStep(side.name, fingers, beneath, in_sides, t),
    ]
    return StandParts([panel, side, end], mounts, table, steps)


def _with_window(wall: Any, edge: Sequence[float], depth: float, stand: TableStand) -> Region:
    """A wall with an opening in its middle, under its tabs, where it is high enough."""
    low = complex(edge[0], -stand.thick - depth)
    window = _window("window", low, complex(edge[-1], -stand.thick), stand.frame)
    return Region(_contour(wall), tuple(window.values()))


def _wall(edge: Sequence[float], column: Sequence[float], depth: float, thick: float) -> Any:
    """A wall with its tabs into the lid."""
    wall = _box_of(complex(edge[0], column[0]), complex(edge[-1], column[-1]))
    for a, b in _odd(edge):
        wall = wall.union(_box_of(complex(a, -thick), complex(b, 0)))
    return wall


def _fingers(low: float, high: float, thick: float) -> list[float]:
    """Ends of an odd number of fingers along an edge, mm."""
    count = max(3, 2 * math.floor((high - low) / (2 * _FINGER * thick)) + 1)
    return list(np.linspace(low, high, count + 1).tolist())


def _odd(ends: Sequence[float]) -> Iterator[tuple[float, float]]:
    yield from list(zip(ends, ends[1:], strict=False))[1::2]


def _even(ends: Sequence[float]) -> Iterator[tuple[float, float]]:
    yield from list(zip(ends, ends[1:], strict=False))[::2]
