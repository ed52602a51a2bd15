"""Two outlines, made by any tool, one of which drives the other: where the driven one can be, at every angle of the driver.

low, high          ends of what is free, rad about the driven file's origin, or mm along its slide
pushing flank      the one of both that the driver moves: high where the driven body turns backwards, else low; with a spring the
                   one on which it holds
transmission error peak to peak of the pushing flank less ratio x theta
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import Literal, TypedDict

import numpy as np

from camgen.errors import DesignError, Fault, FileError, SpecError
from camgen.files.folder import name_of
from camgen.findings import Finding, Where, at_least, at_most, in_file
from camgen.geometry.arcs import with_arcs
from camgen.geometry.rings import Floats, Points, Ring
from camgen.judge.locking import Lock, locks, ways_back
from camgen.judge.pair_events import Slide, Turn
from camgen.judge.pairs import Body as Solid
from camgen.judge.pairs import Jump, OutlinePair, PairMotion, hollow, pivots_apart
from camgen.machine.features import PartPose
from camgen.measuring.folder import OUTLINE_PACKAGES, write_folder
from camgen.measuring.outlines import AS_IT_IS, Hints, Outline, read_outline
from camgen.measuring.teeth import UnlikeTooth, unlike_tooth
from camgen.numerics import magnitude
from camgen.report.animation import Animation, Body
from camgen.report.report import Report
from camgen.study import Figure, Plot, Table
from camgen.tolerances import CURVE_CHORDS

MOST_TURNS = 60
_PER_TURN = 1440  # samples: every quarter degree
_REPEATS = 1e-4  # of a turn, by which a pair may be off after its turns
_TYPED = 1e-6  # by which a ratio that is typed in decimals may be off a fraction
_STEEPEST = 1e4  # ratio that is taken, either way
_SAME_OUTLINE = 2 * CURVE_CHORDS  # mm, by which straight edges may lie off arcs in place of them
_ALLOWED = 2e-3  # mm, overlap of pairs that are drawn without any clearance
_ALIKE = 1e-3  # mm, within which teeth are told to be alike
_FRAMES = 120
_ROWS = 50  # of jumps that are listed

Side = Literal["low", "high"]  # the bound that is meant


class DriveOptions(TypedDict, total=False):
    """What `camgen.drives` takes beside the distance, as Drive and Hints have it."""

    slides: float
    ratio: float
    spring: Side
    inside: bool
    start: float
    centre: tuple[float, float]
    driven_centre: tuple[float, float]
    height: float
    layer: str


@dataclass(frozen=True)
class Drive:
    """How one outline drives another: driver at (0, 0), driven body's pivot at (distance, 0), or its slide through (0, 0).

    centre, driven_centre: places of both pivots in their files, mm.
    slides: direction, rad. ratio: turns of the driven body for one of the driver, of a slide mm for a radian; less than 0: they
    turn against each other. inside: the driver runs within the driven contour. start: rad or mm, near which the driven body begins.
    """

    distance: float | None = None
    slides: float | None = None
    ratio: float | None = None
    spring: Side | None = None
    inside: bool = False
    start: float = 0.0
    centre: complex = 0j
    driven_centre: complex = 0j

    @property
    def unit(self) -> tuple[str, float]:
        """Of the driven body, and how many of it a rad or mm has."""
        return ("deg", math.degrees(1)) if self.slides is None else ("mm", 1.0)

    @property
    def turns(self) -> int:
        """Turns of the driver until the pair stands as before."""
        if self.ratio is None or self.slides is not None:
            return 1
        exact = self.exact_ratio
        off = [abs(n * exact - round(n * exact)) for n in range(1, MOST_TURNS + 1)]
        return next((n for n, each in enumerate(off, 1) if each <= _REPEATS), MOST_TURNS)

    @property
    def exact_ratio(self) -> float:
        """The ratio, as a fraction of small numbers where it is one but for its last decimals."""
        assert self.ratio is not None
        near = Fraction(self.ratio).limit_denominator(MOST_TURNS)
        return float(near) if abs(near - self.ratio) <= _TYPED and near else self.ratio

    def faults(self) -> Iterator[Fault]:
        """What is wrong with it, by the options."""
        if (self.distance is None) == (self.slides is None):
            yield _fault("", "one of both", "--distance, --slides")
        if self.distance is not None and not 0 < self.distance < math.inf:
            yield _fault(f"{self.distance:g}", "a distance above 0, mm", "--distance")
        if self.slides is not None and not math.isfinite(self.slides):
            yield _fault(f"{self.slides:g}", "a direction, deg", "--slides")
        if self.ratio is not None and not 1 / _STEEPEST <= abs(self.ratio) <= _STEEPEST:
            right = f"a ratio other than 0, at most {_STEEPEST:g} or 1 to {_STEEPEST:g}"
            yield _fault(f"{self.ratio:g}", right, "--ratio")
        if self.spring not in (None, "low", "high"):
            yield _fault(str(self.spring), "low or high", "--spring")
        if not math.isfinite(self.start):
            yield _fault(f"{self.start:g}", "a finite number", "--start-deg")
        for place, option in ((self.centre, "--centre"), (self.driven_centre, "--driven-centre")):
            if not cmath.isfinite(place):
                yield _fault(f"{place.real:g}/{place.imag:g}", "two finite numbers", option)


@dataclass(frozen=True, eq=False)
class Driven:
    """Where the driven body is free over the driver's angle, (n,) each.

    theta: rad. low, high: rad or mm, nan where open or where nothing is free. free: whether anything is. error: of the pushing
    flank less ratio x theta, nan without a ratio; back_error: of the other flank. proven: that nothing was skipped since the sample
    before. allowed: mm by which the outlines overlap.
    """

    theta: Floats
    low: Floats
    high: Floats
    free: np.ndarray
    error: Floats
    back_error: Floats
    proven: np.ndarray
    allowed: float
    motion: PairMotion

    @property
    def play(self) -> Floats:
        """High less low."""
        return self.high - self.low

    @property
    def transmission_error(self) -> float:
        """Of the pushing flank, peak to peak; nan without a ratio."""
        return _peak_to_peak(self.error)

    @property
    def back_transmission_error(self) -> float:
        """Of the other flank, peak to peak; nan without a ratio."""
        return _peak_to_peak(self.back_error)


def _peak_to_peak(error: Floats) -> float:
    known = error[np.isfinite(error)]
    return float(np.ptp(known)) if len(known) else math.nan


@dataclass(frozen=True)
class Request:
    """What a person wants of `camgen motion DRIVER --drives DRIVEN`."""

    driven: Path
    drive: Drive
    tolerance: float | None = None  # of the transmission error, deg or mm
    hints: Hints = AS_IT_IS

    def check(self) -> None:
        """SpecError with all that is wrong."""
        faults = list(self.drive.faults())
        if self.tolerance is not None:
            if not 0 < self.tolerance < math.inf:
                faults.append(_fault(f"{self.tolerance:g}", "a tolerance above 0", "--tolerance"))
            if self.drive.ratio is None:
                faults.append(_fault("", "the ratio that is wanted beside --tolerance", "--ratio"))
        if faults:
            raise SpecError(faults, "command line")


def _fault(value: str, expected: str, source: str) -> Fault:
    return Fault((), value, expected, None, source)


# ---- the pair --------------------------------------------------------------------------------------------------------


def drives(driver: Path, driven: Path, distance: float | None, options: DriveOptions) -> Driven:
    """Motion of the outline in one file, driven by that in another.

    SpecError for the options, TypeError for one that there is none of, FileError where a file holds no closed outline.
    """
    unknown = options.keys() - DriveOptions.__annotations__.keys()
    if unknown:
        raise TypeError(f"drives() got an unexpected keyword argument {min(unknown)!r}")
    kinds: list[tuple[str, Callable[[object], bool], tuple[str, ...]]] = [
        ("a number", _is_number, ("slides", "ratio", "start", "height")),
        ("text", lambda value: isinstance(value, str), ("spring", "layer")),
        ("True or False", lambda value: isinstance(value, bool), ("inside",)),
        ("two numbers", _is_place, ("centre", "driven_centre")),
    ]
    wrong = [
        _fault(repr(options[name]), right, name)  # type: ignore[literal-required]
        for right, fits, names in kinds
        for name in names
        if name in options and not fits(options[name])  # type: ignore[literal-required]
    ]
    if wrong:
        raise SpecError(wrong, "drives")
    drive = Drive(
        distance,
        options.get("slides"),
        options.get("ratio"),
        options.get("spring"),
        options.get("inside", False),
        options.get("start", 0.0),
        complex(*options.get("centre", (0.0, 0.0))),
        complex(*options.get("driven_centre", (0.0, 0.0))),
    )
    hints = Hints(options.get("height"), options.get("layer"))
    faults = list(drive.faults())
    if faults:
        raise SpecError(faults, "drives")
    outlines = _read(driver, driven, drive, hints)
    for path, outline in zip((driver, driven), outlines, strict=True):
        if outline.ring is None:
            failed = [f"{f.code}: {f.message}" for f in outline.findings if not f.ok]
            raise FileError(path, "; ".join(failed))
    first, second = (outline.ring for outline in outlines)
    assert first is not None and second is not None
    return driven_by(first, second, drive)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float | np.number) and not isinstance(value, bool)


def _is_place(value: object) -> bool:
    return isinstance(value, tuple | list) and len(value) == 2 and all(map(_is_number, value))


def driven_by(driver: Ring, driven: Ring, drive: Drive) -> Driven:
    """Motion of an outline that another one drives, both about their origins; DesignError where they never touch, or overlap
    throughout, or one is to turn round a place that is outside of it."""
    _refuse_outside(drive, driver, driven)
    driver, driven = (with_arcs(ring, _SAME_OUTLINE) for ring in (driver, driven))
    reach = [magnitude(ring.samples()) for ring in (driver, driven)]
    if drive.distance is not None and drive.distance > sum(reach):
        remedy = "they never touch: bring the pivots together"
        raise DesignError(
            "distance of the pivots", drive.distance, sum(reach), "mm", "any angle", remedy
        )
    theta: Floats = np.linspace(0, math.tau * drive.turns, _PER_TURN * drive.turns + 1)
    motion = _followed(driver, driven, drive, theta, 0.0)
    if not motion.samples.free.all():
        loose = _followed(driver, driven, drive, theta, _ALLOWED)
        if loose.samples.free.all():
            motion = loose
    bounds = motion.samples
    if not bounds.free.any():
        distance = drive.distance or 0.0
        remedy = "take a greater distance, or say where the pivots are in their files: --centre, --driven-centre"
        apart = f"with pivots {distance:g} mm apart" if drive.distance else "where it slides"
        raise DesignError(
            "distance of the pivots", distance, sum(reach), "mm", "all angles", remedy
        ).saying(f"the outlines overlap at every angle {apart}")
    if np.isnan(bounds.low).all() and np.isnan(bounds.high).all():
        remedy = "they never touch: check distance, --centre, --driven-centre and --driven-inside"
        distance = drive.distance or 0.0
        raise DesignError("distance of the pivots", distance, sum(reach), "mm", "any angle", remedy)
    low, high = _without_overlap(motion)
    pushing, back = (low, high) if _pushing(drive, motion) == "low" else (high, low)
    nominal = np.full(len(theta), np.nan) if drive.ratio is None else drive.exact_ratio * theta
    errors = pushing - nominal, back - nominal
    return Driven(
        theta, low, high, bounds.free, *errors, bounds.proven, motion.pair.overlap, motion
    )


def _refuse_outside(drive: Drive, driver: Ring, driven: Ring) -> None:
    """DesignError where a ratio makes an outline turn round and round a place that is outside of it."""
    if drive.ratio is None:
        return
    bodies = [("driver", "--centre", driver, drive.centre)]
    if drive.slides is None:
        bodies.append(("driven outline", "--driven-centre", driven, drive.driven_centre))
    for name, option, ring, known in bodies:
        if ring.encloses(0j):
            continue
        middle = ring.centroid
        place = middle + known
        said = f"the {name} would turn about a place that is outside of it, {abs(middle):.4g} mm from its middle"
        remedy = f"say where its pivot is in its file: {option} {place.real:.3f}/{place.imag:.3f} is its middle"
        raise DesignError(
            "distance of the pivot from the middle", abs(middle), 0, "mm", name, remedy
        ).saying(said)


def _followed(
    driver: Ring, driven: Ring, drive: Drive, theta: Floats, overlap: float
) -> PairMotion:
    """The pair, followed over all angles."""
    contour = hollow(driven) if drive.inside else driven
    slides = drive.slides is not None
    pair = OutlinePair(
        Solid((driver,)),
        Solid((contour,)),
        pivots_apart(drive.distance or 0.0),
        Slide(complex(np.exp(1j * (drive.slides or 0.0)))) if slides else Turn(),
        overlap,
        drive.spring or "play",
    )
    return pair.follow(theta, drive.start)


def _pushing(drive: Drive, motion: PairMotion) -> Side:
    """The bound that the driver moves."""
    if drive.spring is not None:
        return drive.spring
    rate = drive.ratio
    if rate is None:
        known = motion.samples
        low = np.where(np.isnan(known.low), known.high, known.low)
        high = np.where(np.isnan(known.high), known.low, known.high)
        middle = (low + high) / 2
        rate = float(np.nansum(np.diff(middle)))
    return "high" if rate < 0 else "low"


def _without_overlap(motion: PairMotion) -> tuple[Floats, Floats]:
    """Both bounds less what the allowed overlap adds to them, to first order."""
    bounds = motion.samples
    overlap = motion.pair.overlap
    if not overlap:
        return bounds.low, bounds.high
    low = motion.touch(bounds, "low")
    high = motion.touch(bounds, "high")
    return bounds.low + overlap / low.lever, bounds.high - overlap / high.lever


def _read(driver: Path, driven: Path, drive: Drive, hints: Hints) -> tuple[Outline, Outline]:
    """Outlines of both files about their pivots: the largest contour, or of a driven one round the driver the smallest that has room
    for it."""
    first, second = _from_files(driver, driven, drive, hints)
    return first.about(drive.centre), second.about(drive.driven_centre)


def _from_files(driver: Path, driven: Path, drive: Drive, hints: Hints) -> tuple[Outline, Outline]:
    """The same about their files' origins."""
    first = read_outline(driver, hints, 1)
    second = read_outline(driven, hints, 1)
    if not drive.inside or first.ring is None or second.ring is None:
        return first, second
    area = abs(first.ring.area)
    away = (drive.distance or 0.0) * complex(np.exp(-1j * drive.start))
    pivot = drive.driven_centre - away
    rank = 1
    while True:
        rank += 1
        try:
            smaller = read_outline(driven, hints, rank)
        except FileError:
            return first, second
        ring = smaller.ring
        if ring is None or abs(ring.area) <= area:
            return first, second
        if ring.encloses(pivot):
            second = smaller


# ---- the report ------------------------------------------------------------------------------------------------------


def run(
    path: Path, request: Request, out: Path, progress: Callable[[str], None] = lambda _: None
) -> Report:
    """Read both outlines, let the one drive the other, write OUT/<driver>-drives-<driven>/ with report.html, report.json, motion.csv.

    Raises SpecError, FileError or DesignError; where an outline is open or crosses itself, a finding says so.
    """
    request.check()
    progress(f"reading {path.name} and {request.driven.name}")
    outlines = _read(path, request.driven, request.drive, request.hints)
    findings = [finding for outline in outlines for finding in outline.findings]
    report = Report(
        f"{name_of(path)}-drives-{name_of(request.driven)}",
        "one outline drives another",
        list(dict.fromkeys(findings)),
    )
    columns: dict[str, Floats] = {}
    first, second = (outline.ring for outline in outlines)
    if first is not None and second is not None:
        progress("following the pair")
        driven = driven_by(first, second, request.drive)
        columns = _columns(driven, request.drive)
        report = _filled(report, driven, request, path, (first, second))
        remarks = tuple(
            f"{file.name}: {outline.remark}"
            for file, outline in zip((path, request.driven), outlines, strict=True)
        )
        report = replace(report, notes=(*remarks, *report.notes))
    return write_folder(report, columns, out, OUTLINE_PACKAGES, progress)


def _columns(driven: Driven, drive: Drive) -> dict[str, Floats]:
    name, scale = drive.unit
    return {
        "theta_deg": np.degrees(driven.theta),
        f"driven_low_{name}": driven.low * scale,
        f"driven_high_{name}": driven.high * scale,
    }


def _filled(
    empty: Report,
    driven: Driven,
    request: Request,
    path: Path,
    rings: tuple[Ring, Ring],
) -> Report:
    """The report with findings, figures, curves and pictures."""
    drive = request.drive
    name, scale = drive.unit
    play = driven.play * scale
    known = play[np.isfinite(play)]
    least = float(known.min()) if len(known) else math.nan
    most = float(known.max()) if len(known) else math.nan
    numbers = [Figure("play least", least, name), Figure("play most", most, name)]
    findings = [*empty.findings, _contact(driven, request)]
    if drive.ratio is not None:
        numbers.append(Figure("transmission error", driven.transmission_error * scale, name))
        numbers.append(
            Figure("back transmission error", driven.back_transmission_error * scale, name)
        )
    if request.tolerance is not None:
        findings += _transmission(driven, request, request.tolerance)
    side = _pushing(drive, driven.motion)
    touch = driven.motion.touch(driven.motion.samples, side)
    if np.isfinite(touch.pressure_angle).any():
        steepest = float(np.nanmax(np.abs(touch.pressure_angle)))
        numbers.append(Figure("pressure angle", math.degrees(steepest), "deg"))
    jumps = driven.motion.jumps(side)
    numbers.append(Figure("jumps", len(jumps)))
    teeth = [
        (name, tooth)
        for name, ring in zip(("driver", "driven outline"), rings, strict=True)
        if (tooth := unlike_tooth(ring)) is not None
    ]
    numbers += [Figure("tooth off {of}", tooth.off, "mm", name) for name, tooth in teeth]
    held = _held(driven, drive, jumps)
    if held and all(math.isfinite(each.lost) for each in held):
        draw = min(each.draw for each in held)
        numbers.append(Figure("lost angle", math.degrees(max(ways_back(jumps, held))), "deg"))
        numbers.append(Figure("draw angle", math.degrees(draw), "deg"))
    return replace(
        empty,
        findings=findings,
        numbers=empty.numbers | numbers,
        plots=_plots(driven, drive, rings),
        tables=_tables(jumps, side, drive, held),
        notes=tuple(_notes(driven, drive)),
        animation=_animation(driven, drive, rings),
        remarks=(*_summary(driven, request, jumps), *_unlike(teeth), *_holding(jumps, held)),
        files=("motion.csv", "report.json", "manifest.json"),
    )


def _contact(driven: Driven, request: Request) -> Finding:
    """CONTACT: at how many angles anything is free."""
    share = 100 * float(np.mean(driven.free))
    where = in_file(request.driven)
    if not driven.free.all():
        theta = float(driven.theta[np.flatnonzero(~driven.free)[0]])
        where = replace(where, theta=theta, angle="driver angle")
    message = "of the driver's angles the driven outline is free somewhere without overlap"
    if driven.allowed:
        message += f"; both may overlap by {driven.allowed:g} mm, else they jam"
    return at_least("CONTACT", share, 100, "percent", where, message)


def _transmission(driven: Driven, request: Request, limit: float) -> Iterator[Finding]:
    """TRANSMISSION_ERROR of the flank that pushes; BACK_FLANK_ERROR of the other one, where no spring keeps it off."""
    pushing = _pushing(request.drive, driven.motion)
    yield _flank_error("TRANSMISSION_ERROR", driven, request, limit, pushing)
    if request.drive.spring is None:
        yield _flank_error("BACK_FLANK_ERROR", driven, request, limit, _other(pushing))


def _other(side: Side) -> Side:
    return "low" if side == "high" else "high"


def _flank_error(code: str, driven: Driven, request: Request, limit: float, side: Side) -> Finding:
    """One flank's error, at the angle where it is farthest from its middle."""
    name, scale = request.drive.unit
    pushes = code == "TRANSMISSION_ERROR"
    error = driven.error if pushes else driven.back_error
    off = np.abs(error - _middle(error))
    where: Where = in_file(request.driven)
    message = f"the {'pushing' if pushes else 'other'} flank less ratio x theta, peak to peak"
    if np.isfinite(off).any():
        k = int(np.nanargmax(off))
        where = replace(where, theta=float(driven.theta[k]), angle="driver angle")
        message += _place_of(driven, request.drive, k, side)
    return at_most(code, _peak_to_peak(error) * scale, limit, name, where, message)


def _middle(values: Floats) -> float:
    """Median of those that are known, 0 of none."""
    return float(np.nanmedian(values)) if np.isfinite(values).any() else 0.0


def _place_of(driven: Driven, drive: Drive, k: int, side: Side) -> str:
    """Where both outlines touch at a sample, on one of the bounds, in words."""
    motion = driven.motion
    touch = motion.touch(motion.samples, side)
    point = complex(touch.point[k])
    if math.isnan(point.real):
        return ""
    theta = float(driven.theta[k])
    phi = float((driven.low if side == "low" else driven.high)[k])
    own = complex(drive.distance or 0.0) + point
    first = math.degrees(float(np.angle(own * np.exp(-1j * theta)))) % 360
    text = f"; most at {first:.1f} deg of the driver's outline"
    if drive.slides is None:
        second = math.degrees(float(np.angle(point * np.exp(-1j * phi)))) % 360
        text += f", {second:.1f} deg of the driven one's"
    return text


def _plots(driven: Driven, drive: Drive, rings: tuple[Ring, Ring]) -> list[Plot]:
    name, scale = drive.unit
    label = "driver angle, deg"
    theta = np.degrees(driven.theta)
    plots = [
        Plot(
            "Where the driven outline is free",
            label,
            name,
            [("low", theta, driven.low * scale), ("high", theta, driven.high * scale)],
            places=True,
        )
    ]
    if np.isfinite(driven.play).any():
        plots.append(Plot("Play", label, name, [("play", theta, driven.play * scale)]))
    if drive.ratio is not None:
        plots.append(
            Plot(
                "Transmission error, from its median",
                label,
                name,
                [
                    ("pushing flank", theta, (driven.error - _middle(driven.error)) * scale),
                    (
                        "other flank",
                        theta,
                        (driven.back_error - _middle(driven.back_error)) * scale,
                    ),
                ],
            )
        )
    plots.append(_picture(driven, drive, rings))
    return plots


def _picture(driven: Driven, drive: Drive, rings: tuple[Ring, Ring]) -> Plot:
    """Both outlines in contact, at the first angle at which they are."""
    rest = _rest(driven, drive)
    k = int(np.flatnonzero(np.isfinite(rest))[0]) if np.isfinite(rest).any() else 0
    theta = float(driven.theta[k])
    phi = float(rest[k]) if math.isfinite(rest[k]) else drive.start
    freedom = driven.motion.pair.freedom
    turn = complex(freedom.turned(np.array([phi]))[0])
    shift = complex(freedom.moved(np.array([phi]))[0]) + (drive.distance or 0.0)
    shapes = (
        rings[0].moved(complex(np.exp(1j * theta))),
        rings[1].moved(turn, shift),
    )
    series = []
    for label, ring in zip(("driver", "driven"), shapes, strict=True):
        z: Points = ring.facetted(0.02)
        z = np.append(z, z[:1])
        series.append((label, z.real, z.imag))
    title = f"Both in contact, driver at {math.degrees(theta):g} deg"
    return Plot(title, "x, mm", "y, mm", series, equal=True)


def _rest(driven: Driven, drive: Drive) -> Floats:
    """Where the driven body is shown: on its pushing flank, else on the other one, (n,)."""
    sides = {"low": driven.low, "high": driven.high}
    first = _pushing(drive, driven.motion)
    return np.where(np.isnan(sides[first]), sides[_other(first)], sides[first])


def _held(driven: Driven, drive: Drive, jumps: list[Jump]) -> list[Lock]:
    """How the driven outline holds the driver back behind each jump, where a spring makes a pawl of it and all are listed."""
    if drive.spring is None or drive.slides is not None or len(jumps) > _ROWS:
        return []
    return list(locks(driven.motion, jumps, drive.spring))


def _unlike(teeth: list[tuple[str, UnlikeTooth]]) -> Iterator[str]:
    """Which tooth of each outline is least like the others; one alone that is thin may drive as well as any, borne by its neighbours."""
    for name, tooth in teeth:
        if tooth.off < _ALIKE:
            yield f"the {tooth.count} teeth of the {name} are alike within {_ALIKE:g} mm"
        else:
            at = math.degrees(tooth.direction) % 360
            yield f"the tooth of the {name} that is least like the others is at {at:.1f} deg: {tooth.off:.4f} mm off"


def _holding(jumps: list[Jump], held: list[Lock]) -> Iterator[str]:
    """What a person wants to know of a ratchet; nothing where it locks nowhere, or where no spring makes it one."""
    if not held:
        return
    open_at = [jump for jump, lock in zip(jumps, held, strict=True) if math.isnan(lock.lost)]
    if len(open_at) == len(held):
        return
    if open_at:
        places = ", ".join(f"{math.degrees(each.theta):.2f}" for each in open_at)
        yield f"turned back, the driver does not lock behind the jumps at {places} deg: it throws the driven outline out"
        return
    least = math.degrees(min(each.lost for each in held))
    most = math.degrees(max(ways_back(jumps, held)))
    draw = min(each.draw for each in held)
    yield (
        f"turned back, the driver locks after {least:.4g} deg at least, {most:.4g} deg at most; its push draws the driven outline in by "
        f"{math.degrees(draw):.4g} deg at least: it holds without the spring up to a friction of {math.tan(draw):.3f}"
    )


def _tables(jumps: list[Jump], side: str, drive: Drive, held: list[Lock]) -> list[Table]:
    if not jumps:
        return []
    name, scale = drive.unit
    rows = [[math.degrees(each.theta), each.before * scale, each.after * scale] for each in jumps]
    columns: tuple[str, ...] = ("driver angle, deg", f"before, {name}", f"after, {name}")
    if held:
        columns += ("back to the lock, deg", "drawn in, deg")
        for row, lock in zip(rows, held, strict=False):
            row += [math.degrees(lock.lost), math.degrees(lock.draw)]
    return [Table(f"Jumps of the {side} bound", columns, rows[:_ROWS])]


def _notes(driven: Driven, drive: Drive) -> Iterator[str]:
    name, _ = drive.unit
    yield (
        "The driver turns counter-clockwise about its pivot; angles of the driven outline count from its file's pose, "
        "counter-clockwise."
        if name == "deg"
        else "The driver turns counter-clockwise about its pivot; the driven outline's way counts from its file's place."
    )
    open_count = np.count_nonzero(~driven.proven[1:])
    if open_count:
        at = math.degrees(float(driven.theta[1:][~driven.proven[1:]][0]))
        yield (
            f"{open_count} of {len(driven.theta) - 1} steps between samples are not proven, the first before {at:g} deg: a thin "
            "obstacle could be skipped there."
        )
    else:
        yield "Proven between the samples as well: no obstacle is skipped."
    if driven.allowed:
        yield (
            f"The outlines jam as they are drawn. They may overlap by {driven.allowed:g} mm here; low and high are without it, so "
            "that play below 0 is overlap."
        )


def _summary(driven: Driven, request: Request, jumps: list[Jump]) -> Iterator[str]:
    """What a person asked for, in a few lines."""
    drive = request.drive
    name, scale = drive.unit
    play = driven.play[np.isfinite(driven.play)] * scale
    if len(play):
        yield f"play is {play.min():.4g} to {play.max():.4g} {name}"
    if drive.ratio is not None:
        pushing = driven.transmission_error * scale
        back = driven.back_transmission_error * scale
        held = "" if request.tolerance else "; no limit is set: --tolerance"
        turns = "one turn" if drive.turns == 1 else f"{drive.turns} turns"
        yield (
            f"transmission error is {pushing:.4g} {name} peak to peak over {turns} of the driver, {back:.4g} {name} of the other "
            f"flank{held}"
        )
    elif drive.slides is None:
        yield "one turn of the driver: give --ratio, so that every tooth of both is seen"
    if jumps:
        largest = max(abs(each.after - each.before) for each in jumps) * scale
        yield f"{len(jumps)} jumps, {largest:.4g} {name} at most: impacts where a spring holds the driven outline there"


def _animation(driven: Driven, drive: Drive, rings: tuple[Ring, Ring]) -> Animation:
    """The first turn of the driver."""
    step = _PER_TURN // _FRAMES
    rows = np.arange(0, _PER_TURN, step)
    theta = driven.theta[rows]
    phi = _rest(driven, drive)[rows]
    freedom = driven.motion.pair.freedom
    still = np.zeros(len(theta), complex)
    place = freedom.moved(phi) + (drive.distance or 0.0)
    angle = phi if drive.slides is None else still.real
    name, scale = drive.unit
    bodies = [
        Body("driver", [PartPose(still, theta)], [(rings[0].points, rings[0].bulges)]),
        Body(
            "driven",
            [PartPose(np.where(np.isnan(phi), np.nan, place), np.asarray(angle))],
            [(rings[1].points, rings[1].bulges)],
        ),
    ]
    return Animation(theta, bodies, phi * scale, "driven", name)
