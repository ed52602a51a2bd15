"""Bought parts by their standard name: motor frames, screws, bearings, mm; and what printers are fed with.

Motor frames: NEMA ICS 16-2001 (metric values as in BOSL2, nema_steppers.scad, and as tabled at piclist.com/techref/io/
stepper/nemasizes.htm: spacing of holes, shaft, boss and its height of NEMA 8, 11, 14, 17 and 23). Screw heads: ISO 7380-1 from M3, ISO 4762 below, where ISO 7380-1 has no size; clearance holes:
ISO 273, medium; nuts: ISO 4032, greatest sizes. Bearings: boundary dimensions of ISO 15 (2RS or ZZ width where two are sold);
dynamic load ratings: bd_warehouse 0.4, bearing tables.
Dowel pins: diameters and lengths of ISO 2338, m6. Shoulder screws: ISO 7379 as tabled in BOSL2, screws.scad (shoulder, thread
and its length, head), with the least height of nuts that clamps; the shoulder is f9, up to 0.05 mm under its size.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, replace
from typing import ClassVar, Literal

from camgen.parts.turned_shafts import TurnedShaft

_BROKEN = 0.2  # mm, of an edge of metal, at least


@dataclass(frozen=True)
class Screw:
    """A metric screw and its nut; mm."""

    thread: str
    clearance: float  # diameter of its hole
    head: float  # diameter
    height: float  # of the head
    standard: str
    flats: float  # of the nut, across them
    nut: float  # height

    @property
    def nominal(self) -> float:
        """Diameter of the thread, mm."""
        return float(self.thread[1:])

    def headed(self, standard: str) -> Screw:
        """The screw of this thread with the head of a standard."""
        if standard == self.standard or self.thread not in SOCKET_HEADS:
            return self
        head, height = SOCKET_HEADS[self.thread]
        return replace(self, head=head, height=height, standard=standard)

    def length(self, grip: float, depth: float = math.inf) -> float:
        """Longest length that is sold and engages behind a grip by at most 1.5 diameters and the depth, mm; 0 if none does."""
        most = grip + min(1.5 * self.nominal, depth)
        return max((length for length in SCREW_LENGTHS if length <= most), default=0.0)

    def through(self, grip: float) -> float:
        """Shortest length that is sold and passes a grip and a nut, mm; 0 where all are shorter."""
        return shortest_screw(grip + self.nut)


@dataclass(frozen=True)
class Bearing:
    """A deep groove ball bearing, or a plain bush; mm."""

    name: str
    bore: float
    outside: float  # diameter
    width: float
    standard: str = "ISO 15"
    rating: float | None = None  # dynamic, C, kN; None: not published
    plain: bool = False  # whether it is a bush of bronze
    exponent: ClassVar[float] = 3.0  # of its life

    @property
    def shoulder(self) -> float:
        """Diameter of what bears on the inner ring alone, mm: each ring is taken as a quarter of the section high."""
        return self.bore + (self.outside - self.bore) / 4

    @property
    def lip(self) -> float:
        """Bore of a lip under the outer ring, mm: the middle of the balls, clear of the inner ring."""
        return (self.bore + self.outside) / 2

    @property
    def machined_lip(self) -> float:
        """The same of a lip of metal, to half a mm below: its edge is broken, and what is flat begins with the outer ring, beside a shield."""
        ring = self.outside - (self.outside - self.bore) / 4
        return math.floor(2 * (ring - 2 * _BROKEN)) / 2

    @property
    def shielded(self) -> str:
        """Name of a ball bearing with shields, greased for life: the open one may be narrower."""
        return f"{self.name}ZZ"

    @property
    def size(self) -> str:
        """Bore, outside diameter and width."""
        return f"{self.bore:g} x {self.outside:g} x {self.width:g}"


@dataclass(frozen=True)
class ShoulderScrew:
    """A shoulder screw and its nut; mm."""

    diameter: float  # of the shoulder
    thread: str
    thread_length: float
    head: float  # diameter
    height: float  # of the head
    flats: float  # of the nut, across them
    nut: float  # height

    @property
    def nominal(self) -> float:
        """Diameter of the thread, mm."""
        return float(self.thread[1:])

    @property
    def longest(self) -> float:
        """Longest shoulder that is sold, mm."""
        return SHOULDER_LENGTHS[-1]

    def length(self, grip: float) -> float:
        """Shortest shoulder that is sold and passes a grip, mm; 0 where all are shorter."""
        return min((length for length in SHOULDER_LENGTHS if length >= grip - 1e-9), default=0.0)


@dataclass(frozen=True)
class CamFollower:
    """A roller on needles with a stud, in the sizes of ISO 7063; mm.

    rating: dynamic, C, kN, of IKO's CF with a cage, whose dimensions it has; that of other makers differs.
    """

    name: str
    outside: float  # diameter of its ring
    width: float  # of the ring
    stud: float  # diameter, in a hole H7
    thread: str
    length: float  # of the stud, with its thread
    rating: float
    beyond: float  # its ring: how far the head and the shoulder of the stud stand out, at most
    exponent: ClassVar[float] = 10 / 3  # of its life

    @property
    def coarse(self) -> bool:
        """Whether its thread has the pitch of ISO 262's coarse series: M6 x 1 and M8 x 1.25, of those that are sold."""
        return self.stud <= 8

    def bought(self, count: int, clear: float, where: str) -> list[Bought]:
        """Its lines in the parts list, with washers where what carries it would touch the cam.

        clear: how far its shoulder lies outside the cam, mm, below 0 inside; where: it goes, in words.
        """
        size = f"{self.name} with a cylindrical ring, not crowned: {self.outside:g} x {self.width:g}, stud {self.stud:g} x {self.length:g} in a hole H7, {self.thread}"
        grease = Bought(
            GREASE, "", "for rolling bearings", 1, how="a little, on the ring and where it rolls"
        )
        each = max(math.ceil((_CLEAR_OF_CAM - clear) / WASHERS[self.stud]), 0)
        grip = self.length - each * WASHERS[self.stud] - _NUT * self.stud
        nut = Bought(
            FOLLOWER_NUT,
            NUT_STANDARD if self.coarse else FINE_NUT_STANDARD,
            f"{self.thread}, often sold with the cam follower",
            count,
            how=f"on its stud, behind your follower, which is at most {math.floor(2 * grip) / 2:g} mm thick there; as tight as the maker of "
            "the cam follower says",
        )
        face = clear + each * WASHERS[self.stud]
        off = f"which is then {face:.3g} mm off the cam"
        if not each:
            how = f"{where}, against your follower, {off}"
            return [Bought("cam follower", ROLLER_STANDARD, size, count, how=how), nut, grease]
        washer = Bought(FOLLOWER_WASHER, "ISO 7089", f"M{self.stud:g}", each * count)
        some = "a washer" if each == 1 else f"{each} washers"
        how = f"{where}; {some} between its shoulder and your follower, {off}: it must not touch the cam"
        return [
            replace(washer, how="on the stud of the cam follower, before that goes in"),
            Bought("cam follower", ROLLER_STANDARD, size, count, how=how),
            nut,
            grease,
        ]


@dataclass(frozen=True)
class MotorFace:
    """Face of a motor about its shaft; mm."""

    name: str
    boss: float  # diameter of the centring boss
    boss_height: float
    screws: tuple[complex, ...]  # places of their holes
    screw: Screw
    half: float  # of the width of a square about its shaft that holds the body
    shaft: float  # usual diameter, 0 where the frame sets none
    depth: float = (
        math.inf
    )  # of the thread in the holes; of plain ones thickness of the flange, nuts behind
    plain: bool = False  # whether the holes have no thread
    standard: str = "NEMA ICS 16"  # "" where it has none
    flat: float = 0.0  # usual depth of the shaft's flat, 0 where none is known
    length: float = 0.0  # of a can between its face and its end, mm; 0: square
    width: float = 0.0  # of a gearbox with square corners, which a sleeve holds, mm; 0: none

    @property
    def title(self) -> str:
        """What it is, as a parts list says it."""
        if self.width:
            return f"gearbox {2 * self.half:g} x {self.width:g}, {self.length:g} long, collar {self.boss:g}"
        if self.length:
            return f"can {2 * self.half:g} x {self.length:g}, collar {self.boss:g}"
        if self.standard:
            return f"{self.name.upper().replace('-', ' ')} frame"
        return self.name.upper() if self.shaft else f"with a plain {self.name}"

    @property
    def reach(self) -> float:
        """Greatest radius of it and of what holds it, mm."""
        if not self.length:
            return math.sqrt(2) * self.half
        return max(self.half, *(abs(z) + self.screw.head for z in self.screws))

    def screw_length(self, grip: float) -> float:
        """Length of the screws that hold it through a grip, mm; 0 where none is sold."""
        return (
            self.screw.through(grip + self.depth)
            if self.plain
            else self.screw.length(grip, self.depth)
        )


def turning_text(rpm: float) -> str:
    """A speed for the parts list; one below 0 is clockwise."""
    return f"{abs(rpm):g} rpm{' clockwise' if rpm < 0 else ''}"


@dataclass(frozen=True)
class Bought:
    """A line of the parts list that is bought."""

    name: str
    standard: str
    size: str
    count: int
    # turns the machine; fixes what does; feeds its motor; holds its frame from behind; hangs between two of its points;
    # joins it to what is the builder's own; turns with cams that are made alone; goes in at a step of something else
    role: Literal[
        "", "drive", "drive screw", "supply", "mount", "spring", "own", "shaft", "aside"
    ] = ""
    at: tuple[
        tuple[str, int], ...
    ] = ()  # parts with which it is put in, and how many with each copy
    how: str = ""  # where else it goes
    key: str = ""  # of the spec, that sets its size
    thread: str = ""  # of a screw or a nut that pictures show, such as "M3"
    length: float = 0.0  # of a screw, mm; 0 where the spec leaves it open
    process: str = "bought"  # or how it is made
    details: str = ""  # what its maker has to know, for the parts list alone
    shaft: TurnedShaft | None = None  # of which there is a sheet

    @property
    def text(self) -> str:
        """How many of what, for a step of assembly."""
        return f"{self.count} × {self.name} ({self.size})"

    @property
    def listing(self) -> str:
        """What it is, as the parts list says it."""
        return ", ".join(text for text in (self.size, self.standard, self.details) if text)


CUT = "cut of steel"
TURNED = "turned of steel"  # how pins are made that a print does not bear

# Lengths in which screws are sold, mm [ISO 4762, ISO 7380-1].
SCREW_LENGTHS = (
    4.0,
    5.0,
    6.0,
    8.0,
    10.0,
    12.0,
    16.0,
    20.0,
    25.0,
    30.0,
    35.0,
    40.0,
    45.0,
    50.0,
    55.0,
    60.0,
    65.0,
    70.0,
    80.0,
    90.0,
    100.0,
)

SCREWS = {
    screw.thread: screw
    for screw in (
        Screw("M2", 2.4, 3.8, 2.0, "ISO 4762", 4.0, 1.6),
        Screw("M2.5", 2.9, 4.5, 2.5, "ISO 4762", 5.0, 2.0),
        Screw("M3", 3.4, 5.7, 1.65, "ISO 7380-1", 5.5, 2.4),
        Screw("M4", 4.5, 7.6, 2.2, "ISO 7380-1", 7.0, 3.2),
        Screw("M5", 5.5, 9.5, 2.75, "ISO 7380-1", 8.0, 4.7),
        Screw("M6", 6.6, 10.5, 3.3, "ISO 7380-1", 10.0, 5.2),
    )
}

# Diameter and height of the heads of ISO 4762, mm.
SOCKET_HEADS = {
    "M2": (3.8, 2.0),
    "M2.5": (4.5, 2.5),
    "M3": (5.5, 3.0),
    "M4": (7.0, 4.0),
    "M5": (8.5, 5.0),
    "M6": (10.0, 6.0),
}

# Width across flats of the hexagon socket, mm, by standard and thread.
HEX_KEYS = {
    "ISO 4762": {"M2": 1.5, "M2.5": 2.0, "M3": 2.5, "M4": 3.0, "M5": 4.0, "M6": 5.0},
    "ISO 7380-1": {"M3": 2.0, "M4": 2.5, "M5": 3.0, "M6": 4.0},
}


def shortest_screw(length: float) -> float:
    """Shortest length that is sold and not below this one, mm; 0 where all are shorter."""
    return min((each for each in SCREW_LENGTHS if each >= length - 1e-9), default=0.0)


HEAD_ROOM = 0.5  # mm, diametral room of a screw's head in its pocket
# Core holes of coarse threads, mm [ISO 2306].
CORE_HOLES = {"M2": 1.6, "M2.5": 2.05, "M3": 2.5, "M4": 3.3, "M5": 4.2, "M6": 5.0}

BEARINGS = {
    bearing.name: bearing
    for bearing in (
        Bearing("MR63", 3, 6, 2.5),
        Bearing("MR85", 5, 8, 2.5),
        Bearing("MR105", 5, 10, 4),
        Bearing("695", 5, 13, 4),
        Bearing("623", 3, 10, 4, rating=0.54),
        Bearing("624", 4, 13, 5, rating=0.936),
        Bearing("625", 5, 16, 5, rating=1.14),
        Bearing("626", 6, 19, 6, rating=2.34),
        Bearing("608", 8, 22, 7, rating=3.45),
    )
}

# Bushes of bronze, solid, form C: a choice of sizes, not checked against the standard; seats H7, and 1.75 MPa m/s for most bronzes
# with oil or grease [mecmove.se, lathed bronze bearing].
BUSHES = tuple(
    Bearing(f"C {bore} x {outside} x {width}", bore, outside, width, "ISO 4379", plain=True)
    for bore, outside, width in (
        *((6, 10, 6), (6, 10, 10), (8, 12, 6), (8, 12, 10), (10, 16, 6), (10, 16, 10)),
        *((12, 18, 10), (12, 18, 15), (15, 21, 10), (15, 21, 15), (16, 22, 12), (16, 22, 15)),
        *((20, 26, 15), (20, 26, 20)),
    )
)
BUSH = "bush"  # name of its part
BRONZE = "CuSn8"
BRONZE_PV = 1.75  # MPa m/s

_CLEAR_OF_CAM = 0.5  # mm, between a cam and what carries its roller, at least: camgen's own rule
# Plain washers ISO 7089, all narrower than the rings on these studs: their thickness by thread, mm
# [engineeringhardware.com/guide/standard/iso-7089-cad-svg-086-washer, designparams.com/parts/washers/flat-washer].
WASHERS = {6.0: 1.6, 8.0: 1.6, 10.0: 2.0, 12.0: 2.5, 16.0: 3.0, 18.0: 3.0, 20.0: 3.0}

# Cam followers: IKO, C-Lube Cam Followers, CF .. WBUUR/SG [scribd.com/document/676557690]; ring, stud and length of KR19 to KR35
# as INA has them [nodeshk.com/ina/art/track-roller-clearance.html].
CAM_FOLLOWERS = {
    row.name: row
    for row in (
        CamFollower("KR16", 16, 11, 6, "M6 x 1", 16, 3.66, 0.6),
        CamFollower("KR19", 19, 11, 8, "M8 x 1.25", 20, 4.25, 0.6),
        CamFollower("KR22", 22, 12, 10, "M10 x 1.25", 23, 5.43, 0.6),
        CamFollower("KR26", 26, 12, 10, "M10 x 1.25", 23, 5.43, 0.6),
        CamFollower("KR30", 30, 14, 12, "M12 x 1.5", 25, 7.91, 0.6),
        CamFollower("KR32", 32, 14, 12, "M12 x 1.5", 25, 7.91, 0.6),
        CamFollower("KR35", 35, 18, 16, "M16 x 1.5", 32.5, 12.0, 0.8),
        CamFollower("KR40", 40, 20, 18, "M18 x 1.5", 36.5, 14.8, 0.8),
        CamFollower("KR47", 47, 24, 20, "M20 x 1.5", 40.5, 20.7, 0.8),
        CamFollower("KR52", 52, 24, 20, "M20 x 1.5", 40.5, 20.7, 0.8),
    )
}

# Drawn cup roller clutches with bearings at both ends, on hardened shafts: by bore, the clutch and its torque, N m (INA, HFL).
CLUTCHES = {
    6.0: (Bearing("HFL0615", 6, 10, 15, ""), 1.76),
    8.0: (Bearing("HFL0822", 8, 12, 22, ""), 3.15),
    10.0: (Bearing("HFL1022", 10, 14, 22, ""), 5.3),
}

SHOULDER_LENGTHS = (
    10.0,
    12.0,
    16.0,
    20.0,
    25.0,
    30.0,
    40.0,
    50.0,
    60.0,
    70.0,
    80.0,
    90.0,
    100.0,
    120.0,
)  # mm, of the shoulder
SHOULDER_SCREWS = (
    ShoulderScrew(6.5, "M5", 9.5, 10.0, 4.5, 8.0, 4.7),
    ShoulderScrew(8.0, "M6", 11.0, 13.0, 5.5, 10.0, 5.2),
    ShoulderScrew(10.0, "M8", 13.0, 16.0, 7.0, 13.0, 6.8),
    ShoulderScrew(13.0, "M10", 16.0, 18.0, 9.0, 16.0, 8.4),
)


def narrowest(bore: float) -> Bearing | None:
    """The narrowest ball bearing of a bore, mm, of these the smallest outside."""
    fitting = (each for each in BEARINGS.values() if each.bore == bore)
    return min(fitting, key=lambda each: (each.width, each.outside), default=None)


def bush_in(bore: float, plate: float) -> Bearing | None:
    """The longest bush of a bore that is no longer than a plate is thick, or else the shortest, mm; None where none has the bore."""
    fitting = sorted((each for each in BUSHES if each.bore == bore), key=lambda each: each.width)
    held = [each for each in fitting if each.width <= plate]
    return held[-1] if held else next(iter(fitting), None)


def ball_roller(diameter: float, width: float) -> Bearing | None:
    """The ball bearing that is a roller of this size, mm."""
    fitting = (
        each for each in BEARINGS.values() if (each.outside, each.width) == (diameter, width)
    )
    return next(fitting, None)


def no_ball_roller(diameter: float) -> str:
    """Why a roller of this diameter, mm, is no ball bearing, and which size of [geometry.roller] would be one."""
    widths = sorted({each.width for each in BEARINGS.values() if each.outside == diameter})
    if widths:
        sold = " or ".join(f"{width:g}" for width in widths)
        return (
            f"ball bearings of {diameter:g} are {sold} wide: geometry.roller.length = {widths[0]:g}"
        )
    # of two as near the wider one, which bears more
    near = min(BEARINGS.values(), key=lambda each: (abs(each.outside - diameter), -each.width))
    return (
        f"no ball bearing is {diameter:g} across, the nearest one {near.outside:g} x {near.width:g}: "
        f"geometry.roller.radius = {near.outside / 2:g}, geometry.roller.length = {near.width:g}"
    )


GREASE = "grease"
FOLLOWER_NUT = "nut of the cam follower"
FOLLOWER_WASHER = "washer of the cam follower"
NUT_STANDARD = "ISO 4032"
FINE_NUT_STANDARD = "ISO 8673"
_NUT = 0.93  # diameters: height of these, at most
ROLLER_STANDARD = "ISO 7063"  # of cam followers
DOWEL_STANDARD = "ISO 2338"
# Length up to which a pin may be so much longer, mm [DIN 7: nutbolt.org/Standards/Pin-Dowel.html, table 2].
_DOWEL_EXCESS = ((10.0, 0.3), (50.0, 0.5), (math.inf, 0.8))
# Of hardened steel, m6, 1 to 20 mm thick [ISO 8734:1997, scope: scribd.com/document/429524111]; in lengths of ISO 2338.
HARD_DOWEL_STANDARD = "ISO 8734"
# Diameter -> shortest and longest, mm.
DOWELS = {
    1.0: (4, 10),
    1.5: (4, 16),
    2.0: (6, 20),
    2.5: (6, 24),
    3.0: (8, 30),
    4.0: (8, 40),
    5.0: (10, 50),
    6.0: (12, 60),
    8.0: (14, 80),
    10.0: (18, 95),
    12.0: (22, 140),
}
_DOWEL_LENGTHS = (*range(4, 7), *range(8, 33, 2), *range(35, 101, 5))


def dowel(diameter: float, longest: float) -> float:
    """Longest dowel pin of a diameter that is sold and no longer than `longest`, mm; 0 where there is none."""
    low, high = DOWELS.get(diameter, (1, 0))
    return float(
        max(
            (length for length in _DOWEL_LENGTHS if low <= length <= min(high, longest + 1e-9)),
            default=0,
        )
    )


def dowel_excess(length: float) -> float:
    """By how much a dowel pin of a length may be longer, mm: more than the +0.25, +0.5 and +0.75 of ISO 2338."""
    return next(excess for most, excess in _DOWEL_EXCESS if length <= most)


def next_dowel(diameter: float, shortest: float) -> float:
    """Shortest dowel pin of a diameter that is sold and at least so long, mm; 0 where there is none."""
    low, high = DOWELS.get(diameter, (1, 0))
    return float(
        min(
            (length for length in _DOWEL_LENGTHS if max(low, shortest - 1e-9) <= length <= high),
            default=0,
        )
    )


def _square(spacing: float) -> tuple[complex, ...]:
    """Corners of a square of this side, mm."""
    half = spacing / 2
    return tuple(
        complex(x, y) for x, y in ((half, half), (-half, half), (-half, -half), (half, -half))
    )


def in_bar(
    diameter: float, length: float, boss: float, shaft: float, thread: str, bar: float
) -> MotorFace:
    """A motor with a round can whose collar sits in the plate, and which a bar behind it holds by two screws; mm."""
    screw = SCREWS[thread]
    offset = 1j * (diameter / 2 + screw.clearance / 2 + 1)
    places = (-offset, offset)
    half = diameter / 2
    return MotorFace(
        "can", boss, 0.0, places, screw, half, shaft, length + bar, True, "", length=length
    )


def in_sleeve(
    gearbox: tuple[float, float, float], boss: float, shaft: float, thread: str, high: float
) -> MotorFace:
    """A motor whose gearbox, so long, wide and deep with its motor, is pressed into a sleeve that two screws hold; mm."""
    long, wide, deep = gearbox
    bar = in_bar(long, deep, boss, shaft, thread, 0.0)
    return replace(bar, name="gearbox", depth=high, width=wide)


MOTOR_FACES = {
    face.name: face
    for face in (
        MotorFace("nema-8", 15.0, 1.5, _square(16.0), SCREWS["M2"], 20.3 / 2, 4.0),
        MotorFace("nema-11", 22.0, 2.0, _square(23.0), SCREWS["M2.5"], 28.2 / 2, 5.0, 3.0),
        MotorFace("nema-14", 22.0, 2.0, _square(26.0), SCREWS["M3"], 35.2 / 2, 5.0, 4.5),
        # 4.5 over the flat: usual
        MotorFace("nema-17", 22.0, 2.0, _square(31.0), SCREWS["M3"], 42.3 / 2, 5.0, 4.5, flat=0.5),
        MotorFace("nema-23", 38.1, 1.6, _square(47.14), SCREWS["M5"], 57.0 / 2, 6.35, 4.8, True),
        # its shaft is 8 beside the middle of the can and of the ears, 3 over both flats [felixsu7/smart-medicine-container,
        # 3d_model/stepper.scad: from data sheet and measurement]
        MotorFace(
            "28byj-48",
            9.0,
            1.5,
            (17.5 - 8j, -17.5 - 8j),
            SCREWS["M3"],
            (28.0 / 2 + 8) / math.sqrt(2),
            5.0,
            0.8,
            True,
            "",
            flat=1.0,
        ),
    )
}


_RIM = 1.5  # mm of a plain flange outside its screws' heads


def flange(boss: float, screw_circle: float, count: int, thread: str) -> MotorFace:
    """A plain round flange: `count` screws evenly on a circle (diameter, mm), the first on the x axis.

    The boss is taken to be as high as the plate allows, the body to end a little beyond the screws' heads.
    """
    screw = SCREWS[thread]
    places = tuple(cmath.rect(screw_circle / 2, math.tau * k / count) for k in range(count))
    return MotorFace(
        "flange",
        boss,
        0.0,
        places,
        screw,
        screw_circle / 2 + screw.head / 2 + _RIM,
        0.0,
        standard="",
    )


def screw_for(core: float) -> str:
    """The thread of a core hole, mm, where one has it, and the hole."""
    return ", ".join(
        [
            *(thread for thread, hole in CORE_HOLES.items() if hole == core),
            f"for a core hole of {core:g}",
        ]
    )


def nut(name: str, thread: str, count: int) -> Bought:
    """Nuts of a thread."""
    return Bought(name, NUT_STANDARD, thread, count, thread=thread)


def fixed_motor(name: str, face: MotorFace, shaft: str, grip: float) -> list[Bought]:
    """A motor with a shaft that is so described, and what fixes it through a grip, mm: screws, and nuts where its holes are plain."""
    screw = face.screw
    length = face.screw_length(grip)
    count = len(face.screws)
    held = "with a nut" if face.plain else f"{length - grip:.3g} mm of it in the motor"
    size = f"{screw.thread} x {length:g}, {held}"
    return [
        Bought(name, face.standard, f"{face.title}, {shaft}", 1, "drive"),
        Bought(
            "screw of the motor",
            screw.standard,
            size,
            count,
            "drive screw",
            thread=screw.thread,
            length=length,
        ),
        *(
            [replace(nut("nut of the motor", screw.thread, count), role="drive screw")]
            if face.plain
            else []
        ),
    ]


def fastener(name: str, thread: str, through: float, count: int) -> Bought:
    """The shortest screw that is sold and passes so much material, mm, and its nut; a threaded rod where none is long enough."""
    screw = SCREWS[thread]
    length = screw.through(through)
    if not length:
        return Bought(name, "DIN 976-1", f"{thread} x {math.ceil(through + 2 * screw.nut)}", count)
    size = f"{thread} x {length:g}"
    return Bought(name, screw.standard, size, count, thread=thread, length=length)
