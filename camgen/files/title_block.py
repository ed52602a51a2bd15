"""The title block of a drawing: what it says beside the part's shape, its cells, and the symbol of first-angle projection."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from camgen._version import __version__
from camgen.files.dimensions import Hole, number
from camgen.files.limits import signed
from camgen.files.sheet import Sheet
from camgen.files.symbols import cell
from camgen.parts.part import Part
from camgen.parts.turned_shafts import TurnedShaft
from camgen.tolerances import SAME_POINT

WIDTH = 170.0  # mm [ISO 7200]
_ROW = 9.0
BLOCK = 4 * _ROW  # height of the block


CORE = "core hole"  # how the words of the hole of a thread begin


@dataclass(frozen=True)
class Fit:
    """How a round hole of a part fits what goes through."""

    at: complex  # its centre, mm
    diameter: float  # mm
    words: str  # such as "slide on Ø6"
    ring: bool = False  # whether a ball bearing sits there
    nominal: float = 0.0  # mm, to which the words refer; 0: the diameter


# Letters that no other is mistaken for [ISO 5459].
_OF_DATUMS = "ABCDEFGHJKLMNPRSTUVWXYZ"


@dataclass(frozen=True)
class Groove:
    """A groove between two plates."""

    width: float  # mm, square to its walls
    roller: float  # diameter, mm
    inner: bool  # whether the part is its inner wall


@dataclass(frozen=True)
class LockLimits:
    """How a lock and the hollows of its wheel fit at the limits of all sheets."""

    least: float  # gap between them, mm; below 0 the lock binds
    bush: float  # run-out of bushes on which that counts, mm
    turn: float  # by which the wheel turns in its greatest play, from end to end, rad


@dataclass(frozen=True)
class Rider:
    """A follower where its cam has not turned, in the part's frame, complex mm."""

    place: complex  # where it touches
    normal: complex  # unit, into it
    radius: float  # of its tip, mm: 0 of an edge, inf of a flat face
    way: complex  # unit, in which it moves as its displacement grows

    @property
    def tip(self) -> float:
        """Radius of its roller, mm; 0 of an edge or a face."""
        return self.radius if math.isfinite(self.radius) else 0.0

    @property
    def centre(self) -> complex:
        """Of its roller; where it touches of an edge or a face."""
        return self.place + self.normal * self.tip


@dataclass(frozen=True)
class Facts:
    """What a drawing says of a part besides its shape; "" or None is left out."""

    machine: str = ""  # its name and mechanism
    material: str = ""
    mass_g: float | None = None  # of one part, g
    tolerance: str = ""  # general tolerance
    number: str = ""  # of the drawing, its file's name unless given
    date: str = ""
    fits: Sequence[Fit] = ()
    profile_step_deg: float | None = None  # between the rows of a cam's table
    position: float = 0.0  # of holes: the diameter in which their axes lie, mm
    dowel: float = 0.0  # diameter of the dowels that join a groove's plates, mm
    thread: str = ""  # such as "M6", of the screws that hold a groove's plates together
    bore_fit: str = ""  # of the bore, such as "H7"
    outer_fit: str = ""  # of a round outline
    shank: tuple[float, str] = (0.0, "")  # of a headed pin its diameter, mm, and fit
    turned_deg: float = 0.0  # by which its machine's arrangement shows it turned
    thinner: float = (
        0.0  # by which the gaps beside the part let it be, mm; 0: they bear its general tolerance
    )
    thicker: float = 0.0  # by which a plate through which shafts and pins go may be, and no thinner
    # by how much a rod or the shank of a headed pin is shorter than drawn, at least and at most, mm
    shorter: tuple[float, float] = (0.0, 0.0)
    lip: float = (
        0.0  # by which the lip under a ball bearing may be lower, mm; 0: nothing is asked of it
    )
    key_fit: str = ""  # of a keyway's width
    own_key: float = 0.0  # symmetry of the keyways of shafts that are made too, mm; 0: none is
    # of each track its name, and by cam angle, deg, where its follower touches it: complex mm, in the sense in which it turns
    tracks: Sequence[tuple[str, Sequence[tuple[float, complex]]]] = ()
    riders: Sequence[Rider] = ()  # of these tracks, where the cam has not turned
    centres: Sequence[
        Sequence[complex]
    ] = ()  # and places of their rollers' axes, by the same angles
    # by the angle by which a drum has turned, deg, where its roller's axis is: angle from X, deg, and height, mm
    heights: Sequence[tuple[float, float, float]] = ()
    # kinds of a follower's segments, and by which angles the drum has turned where each begins and ends, deg
    segments: Sequence[tuple[str, float, float]] = ()
    sense: int = 1  # in which a drum turns
    # of a drum's roller: diameter half way along it, length, distance of its inner end from the axis, mm
    roller: tuple[float, float, float] | None = None
    crowned: float = 0.0  # by how much a crowned ring of that, if sold so, may be thinner, mm
    shaft: TurnedShaft | None = None  # what it is, where its sheet is that of a shaft
    groove: Groove | None = None  # of whose walls the part is one
    lock: LockLimits | None = None  # of a Geneva wheel, if it is one
    levels: Sequence[complex] = ()  # of a plate's upper edge, on which a follower runs, mm
    cutter: bool = False  # whether a file has the path of a cutter along a drum's track
    profile: float = 0.0  # width of the zone of a cam's track, mm
    roughness: float = 0.0  # Ra of the track, micrometres
    bore_roughness: float = 0.0
    symmetry: float = 0.0  # of a keyway about its bore: width of the zone of its middle plane, mm
    run_out: float = 0.0  # of the face at z = 0 about the bore, mm
    bore_chamfer: float = 0.0  # at both ends of the bore, at 45 deg, mm
    rod_chamfer: float = 0.0  # at both ends of a rod, at 45 deg, mm
    roughness_elsewhere: float = 0.0
    edges: str = ""
    heat_treatment: str = ""
    protection: str = ""  # against rust
    case_only: bool = False  # whether what a follower runs on is hardened, and nothing else
    corner: float = 0.0  # largest radius where a hub meets its disc, mm
    ground: bool = False  # whether what has a roughness of its own is ground after that
    stride: int = (
        1  # of tracks, centres and heights: every so many of them stand on the part's own sheet
    )
    revision: str = ""
    drawn_by: str = ""
    checked_by: str = ""
    # of a sleeve, or of the head of a pin, that bears on the inner ring of a ball bearing and not beyond it
    ring_fit: str = ""
    points: frozenset[str] = frozenset()  # letters of its machine's points: no datum is called so

    @property
    def datum_letters(self) -> list[str]:
        """Letters of datums, the best first: in a machine with points none of these, and from D on, for its parts call holes A to C; so a
        bore has the same on all sheets."""
        low = "D" if self.points else "A"
        return sorted(_OF_DATUMS, key=lambda each: (each in self.points, each < low))

    @property
    def length_limits(self) -> str:
        """Limits of the length of a rod or of a pin's shank, such as "-0.05/-0.35"; "" of any other part."""
        least, most = self.shorter
        return f"{signed(-least)}/{signed(-most)}" if most else ""

    @property
    def thickness_limits(self) -> str:
        """Limits of a part's thickness, such as "0/-0.05"; "" where its general tolerance will do."""
        if self.thicker:
            return f"{signed(self.thicker)}/0"
        return f"0/{signed(-self.thinner)}" if self.thinner else ""

    def shape(self, hole: Hole) -> str:
        """What a hole or a round layer is, with its fit where one is known."""
        for fit in self.fits:
            if (
                abs(fit.at - hole.place) < SAME_POINT
                and abs(fit.diameter - 2 * hole.radius) < SAME_POINT
            ):
                size, *more = hole.shape.split(", ", 1)
                size = f"Ø{number(fit.nominal)}" if fit.nominal else size
                return ", ".join([f"{size} {fit.words}", *more])
        shank, fit_of_shank = self.shank
        is_shank = fit_of_shank and abs(2 * hole.radius - shank) < SAME_POINT
        return f"{hole.shape} {fit_of_shank}" if is_shank else hole.shape


def weighed(mass: float) -> str:
    """A mass in g to three digits, from 1000 g on in kg."""
    value = float(f"{mass:.3g}")
    return f"{value / 1000:g} kg" if value >= 1000 else f"{value:g} g"


def ratio(scale: float) -> str:
    """A scale in words; 0 is none."""
    if not scale:
        return "none"
    return f"{number(scale)}:1" if scale >= 1 else f"1:{number(1 / scale)}"


def sheet_words(size: str, number: int, count: int) -> str:
    """Size of a sheet's paper, and which it is where a part has several, such as "A3, 1 of 2"."""
    return size if count == 1 else f"{size}, {number} of {count}"


def title_block(
    sheet: Sheet, corner: complex, part: Part, facts: Facts, scale: float, size: str
) -> None:
    """Draw the block, its lower right corner there; what no one has given of people, date and revision is left to be filled in by hand.

    scale: mm of paper for a mm of the part, 0: none; size: of the paper, with what else `sheet_words` says.
    """
    mass = "" if facts.mass_g is None else weighed(facts.mass_g)
    middle = [
        ("Machine", facts.machine, 0.0),
        ("Material", facts.material, 36.0),
        ("Mass", mass, 24.0),
        ("General tolerance", facts.tolerance, 36.0),
    ]
    middle = [cell for cell in middle if cell[1]]
    middle = [
        (key, value, width or WIDTH - sum(cell[2] for cell in middle))
        for key, value, width in middle
    ]
    rows = [
        [
            ("Quantity", str(part.count), 19.0),
            ("Scale", ratio(scale), 19.0),
            ("Sheet", size, 28.0),
            ("Units", "mm", 14.0),
            ("Projection", "", 49.0),
            ("Made by", f"camgen {__version__}", 41.0),
        ],
        [
            ("Drawn by", facts.drawn_by, 50.0),
            ("Checked by", facts.checked_by, 50.0),
            ("Date", facts.date, 40.0),
            ("Revision", facts.revision, 30.0),
        ],
        middle,
        [("Part", part.title, 85.0), ("Drawing number", facts.number, 85.0)],
    ]
    for k, row in enumerate(rows):
        left = corner - WIDTH + 1j * _ROW * k
        for key, value, width in row:
            cell(sheet, left, width, _ROW)
            sheet.text(left + 1.5 + 6.2j, key, 1.8)
            if key == "Projection":
                _first_angle(sheet, left + 21 + 3.8j)
                sheet.text(left + 32 + 2.6j, "first angle", 2.5, room=width - 32)
            else:
                sheet.text(left + 1.5 + 1.7j, value, 3.5, room=width - 3)
            left += width


def _first_angle(sheet: Sheet, middle: complex) -> None:
    """A cone's frustum from the side, small end left, and to its right as seen from there. [ISO 5456-2]"""
    # radii, mm
    large = 2.8
    small = 1.4
    side = middle - 5.5
    front = middle + 4.5
    sheet.line(
        side - 2.8 - 1j * small,
        side + 2.8 - 1j * large,
        side + 2.8 + 1j * large,
        side - 2.8 + 1j * small,
        layer="TEXT",
        closed=True,
    )
    for radius in (large, small):
        sheet.arc(front, radius, 0.0, math.tau, "TEXT")
    sheet.line(side - 4, side + 4, layer="CENTER")
    sheet.line(front - 4, front + 4, layer="CENTER")
    sheet.line(front - 3.6j, front + 3.6j, layer="CENTER")
