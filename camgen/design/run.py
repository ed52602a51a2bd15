"""`camgen design`: the spec that fulfils what a spec wants, its own text and comments kept where that can be."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from camgen import reading
from camgen import spec as specs
from camgen.design.candidates import Candidates
from camgen.design.chains import chains
from camgen.design.found import NO_ERROR, Found, weighed
from camgen.design.front import Aim, D, Design, Front, acceptable, keeping, with_prototype
from camgen.design.keys import Search
from camgen.design.linkages import Candidate
from camgen.design.paths import ChainDesign
from camgen.design.wanted import (
    DrawingWish,
    FunctionWish,
    KeyWish,
    LinkWish,
    PathWish,
    asked_for,
    wish,
    without,
)
from camgen.edits import edited, with_tables
from camgen.errors import DesignError, Fault, SpecError, counted, dotted
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import Source, changed, read_mechanism, read_tables, tables_of_text
from camgen.numerics import Points
from camgen.settings import override
from camgen.workers import Workers

if TYPE_CHECKING:
    from camgen.parts.generator.sizes import Parts

Say = Callable[[str], None]

_MADE = (
    "points",
    "links",
    "lengths",
    "output",
    "slide",
    "slot",
    "gear",
    "cam",
    "layers",
)  # tables that a search makes
# of the wanted path's longest chord: error, and length of all bars, that a front reaches to
_WORST = 0.2
_MOST = 10.0
_WITHOUT_FRONT = ("", "drawing", "vary")  # wishes whose search gives one design
_OF_DRAWING = 0.9  # of its tolerance, that the pen's motion takes; files and facets leave the rest


Keep = Callable[[Front], None] | None


def design(
    spec: Source,
    settings: Sequence[str] = (),
    jobs: int = 1,
    say: Say = lambda text: None,
    keep: Keep = None,
) -> str:
    """Text of the spec that was found. keep: is handed the front of a search for a linkage, also where none of it will do.

    SpecError with every fault of wish and spec; DesignError, with the nearest that was reached, where nothing fulfils it.
    """
    data, source, folder = read_tables(spec)
    for setting in settings:
        data = override(data, setting)
    text, ends = _text_of(spec) if isinstance(spec, str | Path) and not settings else (None, "\n")
    kind = asked_for(data)
    if keep is not None and kind in _WITHOUT_FRONT:
        right = "a search for a linkage: it alone has a front"
        raise SpecError([Fault((), kind, right, source="--front")], "command line")
    if not kind:
        mechanism = read_mechanism(spec, settings)
        designed = getattr(mechanism, "designed", None)
        if designed is None:
            right = "a table with path, poses, points, function, slide or dwell (a linkage for it), drawing (cams that draw it), or vary = { key = [least, most] } and "
            raise SpecError(
                [Fault(("wanted",), "", f'missing: {right}least = "figure"; camgen guide design')],
                source,
            )
        return specs.dump(designed())
    search = {
        "path": _for_path,
        "function": _for_function,
        "drawing": _for_drawing,
        "vary": _for_keys,
    }
    return search.get(kind, _for_positions)(
        Request(data, source, folder, text, ends, jobs, say, keep)
    )


@dataclass(frozen=True, repr=False)
class DesignResult:
    """What a search found."""

    text: str  # of the spec, as `camgen design` writes it
    machine: Mechanism  # that it is
    front: Front | None  # of a search for a linkage: all designs that are best in something
    notes: Sequence[str]  # how it went

    def __repr__(self) -> str:
        """The machine, and how the search went."""
        many = "" if self.front is None else f", one of {counted(len(self.front.texts), 'design')}"
        return "\n  ".join([f"Found {self.machine!r}{many}", *self.notes])

    def _repr_html_(self) -> str:
        """For a notebook: how it went, the machine, the front as a table."""
        notes = "<br>".join(map(escape, self.notes))
        front = "" if self.front is None else self.front._repr_html_()
        return f"<p>{notes}</p>{self.machine._repr_html_()}{front}"


def found(
    spec: Source,
    settings: Sequence[str] = (),
    jobs: int = 1,
    say: Say = lambda text: None,
) -> DesignResult:
    """The same as `design`, with the machine, and the front of a search that has one."""
    fronts: list[Front] = []
    notes: list[str] = []

    def noted(text: str) -> None:
        notes.append(text)
        say(text)

    data, _, folder = read_tables(spec)
    for setting in settings:
        data = override(data, setting)
    keep = None if asked_for(data) in _WITHOUT_FRONT else fronts.append
    text = design(spec, settings, jobs, noted, keep)
    machine = changed(*tables_of_text(text, folder))
    return DesignResult(text, machine, fronts[0] if fronts else None, notes)


def _text_of(spec: str | Path) -> tuple[str, str]:
    """A spec's text with line feeds, and how its lines end."""
    text = Path(spec).read_bytes().decode("utf-8-sig")
    return text.replace("\r\n", "\n"), "\r\n" if "\r\n" in text else "\n"


@dataclass(frozen=True)
class Request:
    """What a search is to do."""

    data: reading.Data  # tables of the spec
    source: str
    folder: Path
    text: str | None  # of the spec, where it is to be kept
    ends: str  # of its lines
    jobs: int
    say: Say  # takes a line on how it goes
    keep: Keep  # takes the front

    @cached_property
    def rest(self) -> reading.Data:
        """The tables less [wanted]."""
        return without(self.data)

    def with_lash(self, key: str, lash: float | None) -> reading.Data:
        """The tables less [wanted], with the play that a wish bears as limits.KEY."""
        if lash is None:
            return self.rest
        return {**self.rest, "limits": {key: lash, **self.rest.get("limits", {})}}

    def checked(self, *looks: Callable[[], object]) -> list[Any]:
        """What each look gives; SpecError with the faults of all of them."""
        results = list[Any]()
        faults = dict[Fault, None]()
        for look in looks:
            try:
                results.append(look())
            except SpecError as error:
                faults |= dict.fromkeys(error.faults)
        if faults:
            raise SpecError(list(faults), self.source)
        return results

    def front_rows(
        self, front: Sequence[D], title: str, summary: str, figures: Mapping[str, str], note: str
    ) -> list[dict[str, Any]]:
        """The rows of a front, which is kept where that is asked for."""
        rows = [each.row(number) for number, each in enumerate(front, 1)]
        if self.keep is not None:
            texts = [self.spec_of(each, note) for each in front]
            name = str(self.data.get("name"))
            self.keep(
                Front(
                    f"{title} of {name}",
                    summary,
                    figures,
                    texts,
                    rows,
                    [each.sketch for each in front],
                )
            )
        return rows

    def spec_of(self, each: Design, note: str) -> str:
        """The spec of a design: the text that was given with what was found, or one of its own."""
        from camgen.machines import MECHANISMS, load

        data = each.data()
        sizes = each.prototype.sizes
        if sizes:
            data = {**data, "parts": {**data.get("parts", {}), **sizes}}
        if self.text is None:
            return specs.dump(specs.validate(load(specs.choose(data, MECHANISMS)), data))
        keys = (
            "points",
            "links",
            "drive",
            *(["slide"] if "slide" in data else []),
            "output",
            *(["limits"] if "lash" in self.data["wanted"] else []),
        )
        tables = {key: data[key] for key in keys} | ({"parts": sizes} if sizes else {})
        return with_tables(self.text, tables, ["wanted"], note).replace("\n", self.ends)


def _for_keys(request: Request) -> str:
    def keys() -> KeyWish:
        settings = wish(request.data, request.source)
        assert isinstance(settings, KeyWish)
        wrong = [
            fault for key, ends in settings.vary.items() for fault in _beyond(request, key, ends)
        ]
        if wrong:
            raise SpecError(wrong, request.source)
        return settings

    *_, goal = request.checked(lambda: changed(request.rest, request.source, request.folder), keys)
    settings = Search(request.rest, request.source, request.folder, goal, request.say).run()
    if request.text is not None:
        return with_tables(edited(request.text, settings), {}, ["wanted"]).replace(
            "\n", request.ends
        )
    rest = request.rest
    for setting in settings:
        rest = override(rest, setting)
    return specs.dump(changed(rest, request.source, request.folder))


def _for_function(request: Request) -> str:
    from camgen.design import functions

    def wanted() -> FunctionWish:
        found = wish(request.data, request.source)
        assert isinstance(found, FunctionWish)
        return found

    *_, found = request.checked(
        lambda: _refuse_made_tables(request), lambda: _sizes(request), wanted
    )
    searched = functions.search(found, request.with_lash("lash_deg", found.lash))
    request.say(f"parts of {len(searched)} designs")
    with Workers(request.jobs) as workers:
        weighed = list(workers.map(with_prototype, searched))
    front = sorted(weighed, key=lambda each: not each.prototype.of_use)
    note = "found by camgen design for a function; output.function: its pairs, and how far this machine may be off"
    summary = (
        f"{len(front)} four-bars: each is nearer to the function than all of better transmission, or transmits better "
        "than all nearer. Design 1 is 01.toml, and so on. Those that can be built stand first."
    )
    figures = {
        "worst_error_deg": "worst error {:.4g} deg",
        "transmission_deg": "transmission {:.4g} deg",
        "lash": "play {:.3g} deg",
    }
    rows = request.front_rows(front, "Four-bars for the function", summary, figures, note)

    def error(each: functions.Generator) -> float:
        return math.degrees(each.error)

    aim = Aim(found, found.allowance, "deg", "off at the pairs", "the rocker's swing")
    near = acceptable(front, aim, error)
    if found.tolerance is None:
        best = min(near, key=error)
    else:
        best = max(near, key=lambda each: each.transmission)
    row = rows[front.index(best)]
    request.say(
        f"design {row['design']} of {len(front)}: at most {row['worst_error_deg']:.4g} deg off at the pairs, "
        f"transmission angle {row['transmission_deg']:.4g} deg and more, play of {best.prototype.lash:.3g} deg"
    )
    return request.spec_of(best, note)


def _for_positions(request: Request) -> str:
    from camgen.design.positions import designs_for

    def wanted_positions() -> LinkWish:
        found = wish(request.data, request.source)
        assert isinstance(found, LinkWish)
        return found

    _, sizes, wanted = request.checked(
        lambda: _refuse_made_tables(request, ("range_deg", "segment")),
        lambda: _sizes(request),
        wanted_positions,
    )
    room = wanted.room(sizes.pin_diameter + 2 * sizes.wall)
    designs = designs_for(wanted, room, request.with_lash(wanted.lash_key, wanted.lash))
    with Workers(request.jobs) as workers:
        looked = weighed(designs.losses, designs.of, workers.map, request.say)
    front = sorted(looked, key=partial(_rank, wanted))
    note = f"found by camgen design for {wanted.title}; [[output]]: what was wanted, and how far this machine may be off"
    best_in = "shorter bars" if wanted.trades_size else "a smaller error"
    summary = (
        f"{len(front)} linkages: each has {best_in} than all that transmit better, or was tried next. Design 1 is 01.toml, "
        "and so on. Those that can be built stand first."
    )
    rows = request.front_rows(front, f"Linkages for {wanted.title}", summary, wanted.figures, note)
    can = keeping(front, wanted, wanted.unit, lambda each: each.share)
    near = [each for each in can if not each.miss]
    if not near:
        far = min(can, key=lambda each: each.share).farthest
        remedy = f"{wanted.further}, or a wider wanted.{far.key}"
        where = "the nearest buildable design"
        raise DesignError(f"wanted.{far.key}", far.error, far.allowance, far.unit, where, remedy)
    row = rows[front.index(near[0])]
    words = [text.format(row[key]) for key, text in wanted.figures.items()]
    request.say(f"design {row['design']} of {len(front)}: {', '.join(words)}")
    if near[0].prototype.lash > wanted.useful_play:
        request.say(
            f"no design has less play, and of use is {wanted.useful_play:.4g} {wanted.unit} at most: {wanted.tighter}"
        )
    return request.spec_of(near[0], note)


def _rank(wanted: LinkWish, each: Found) -> tuple[int, float, float]:
    """What designs are sorted by: those of use with useful play by what is best of them, then the others as `_merit` has them."""
    made = each.prototype
    flat = -each.figures["transmission_deg"]
    if not made.of_use:
        return (3 if made.obstacle else 2, each.share, flat)
    if made.lash > wanted.useful_play:
        return (1, made.lash, flat)
    return (0, 0.0 if wanted.trades_size else max(each.share, NO_ERROR), flat)


def _for_path(request: Request) -> str:
    from camgen.design import paths
    from camgen.design.polish import Goal
    from camgen.design.target import Target

    def path() -> tuple[PathWish, Points]:
        found = wish(request.data, request.source)
        assert isinstance(found, PathWish)
        return found, found.line(request.folder)

    _, sizes, (wanted, line) = request.checked(
        lambda: _refuse_made_tables(request), lambda: _sizes(request), path
    )
    target = Target(wanted.points(line))
    aim = Aim(
        wanted, wanted.allowance(target.chord), "mm", "from the path", "the path's longest chord"
    )
    shortest = wanted.shortest or sizes.pin_diameter + 2 * sizes.wall  # of a hub
    sine = math.sin(math.radians(max(wanted.transmission_deg, 0.1)))
    goal = Goal(target, _WORST * target.chord, _MOST * target.chord, shortest, sine)
    kinds = [
        chain for chain in paths.kinds(wanted.bars // 2, 2) if len(chain.bodies) <= wanted.bars
    ]
    request.say(
        f"searched: {len(kinds)} chain" + ("s; this takes minutes" if len(kinds) > 1 else "")
    )
    tables = request.with_lash("lash", wanted.lash)
    with Workers(request.jobs) as workers:
        found = paths.search(goal, kinds, wanted.effort, wanted.seed, workers.map, request.say)
        if not found:
            raise DesignError("designs whose chain closes", 0, 1, "", "wanted", wanted.further)
        candidates = Candidates(
            lambda each: Candidate(
                each, line, tables, aim.allowance, wanted.joined, wanted.tolerance
            ),
            workers.map,
            request.say,
        )
        weighed = candidates.front(found)
    play = wanted.useful_play(target.chord)
    front = sorted(weighed, key=lambda each: _merit(each, play))
    name = wanted.path if isinstance(wanted.path, str) else f"{len(wanted.path)} points"
    note = f"found by camgen design for the path {name}; output.path: that path, and how far this machine's may be from it"
    summary = (
        f"{len(front)} designs: each is nearer to the path in the mean than all with less bar, or has less bar than all "
        "nearer, of all designs or of those that can be built. Design 1 is 01.toml, and so on. Those that can be built stand "
        f"first: by their greatest distance from the path those whose play is of use, {play:.4g} mm at most."
    )
    figures = {
        "worst_distance_mm": "at most {:.3g} mm from the path",
        "bars_mm": "bars of {:.4g} mm",
        "mean_distance_mm": "{:.3g} mm in the mean",
        "lash": "play {:.3g} mm",
    }
    request.front_rows(front, "Linkages for the path", summary, figures, note)
    near = acceptable(front, aim, lambda each: each.worst)
    best = front[0]
    request.say(f"design 1 of {len(front)}: {_said(best)}")
    if best.prototype.lash > play:
        request.say(
            f"no design has less play, and of use is {play:.4g} mm at most: set a smaller print.slide_clearance"
        )
    shortest = min(near, key=lambda each: each.design.bars)
    if shortest is not best:
        request.say(f"design {front.index(shortest) + 1} has the shortest bars: {_said(shortest)}")
    return request.spec_of(best, note)


def _for_drawing(request: Request) -> str:
    from camgen.design.drawings import plotter_tables
    from camgen.motion.pen import peak_acceleration, pen_motion

    def drawing() -> tuple[DrawingWish, Points]:
        found = wish(request.data, request.source)
        assert isinstance(found, DrawingWish)
        return found, found.line(request.folder)

    *_, (wanted, line) = request.checked(
        lambda: _refuse_made_tables(request), lambda: _sizes(request), drawing
    )
    pen = pen_motion(line, _OF_DRAWING * wanted.tolerance)
    request.say(f"peak acceleration of the pen: {peak_acceleration(pen):.4g} mm/rad^2")
    closed = np.append(line, line[0])
    rest = request.with_lash("lash", wanted.lash)
    data, found = plotter_tables(pen, closed, wanted.tolerance, rest, wanted.roller_radius)
    request.say(
        f"arms of {found.arm:.4g} mm, rods of {found.rod:.4g} mm, cams of {found.cam:.4g} mm in the middle"
    )
    name = wanted.drawing if isinstance(wanted.drawing, str) else f"{len(wanted.drawing)} points"
    note = f"found by camgen design for the drawing {name}; output.path: that line, and how far the pen may be off"
    if request.text is None:
        return specs.dump(changed(data, request.source, request.folder))
    keys = ("points", "links", "drive", "cam", "output", *(["limits"] if wanted.lash else []))
    tables = {key: data[key] for key in keys}
    return with_tables(request.text, tables, ["wanted"], note).replace("\n", request.ends)


def _merit(each: Candidate, play: float) -> tuple[int, float]:
    """What designs are sorted by: those of use with no more play than that by their error, then the others of use by their
    play; those that can be built, and those that cannot, by their error."""
    made = each.prototype
    if made.of_use:
        return (0, each.worst) if made.lash <= play else (1, made.lash)
    return (3 if made.obstacle else 2, each.worst)


def _said(each: Candidate) -> str:
    """Error, play and size of a design, in words."""
    frame = f", with {each.prototype.frame}" if each.prototype.frame else ""
    return (
        f"at most {each.worst:.3g} mm from the path, {each.design.error / 2:.3g} mm in the mean, "
        f"play of {each.prototype.lash:.3g} mm, bars of {each.design.bars:.4g} mm{frame}"
    )


def _refuse_made_tables(request: Request, of_drive: Sequence[str] = ()) -> None:
    """SpecError for tables that a search makes, keys of [drive] among them, and for another mechanism."""
    right = "nothing here: it is found, with [points], [links] and [[output]]"
    faults = [Fault((key,), "a table", right) for key in _MADE if key in request.rest]
    drive = request.rest.get("drive")
    if isinstance(drive, list):
        one = "[drive], one table: what is found has one motor"
        faults.append(Fault(("drive",), f"{len(drive)} drives", one))
    if isinstance(drive, dict):
        faults += [Fault(("drive", key), "given", right) for key in of_drive if key in drive]
    if request.data.get("mechanism") != "linkage":
        faults.append(
            Fault(
                ("mechanism",),
                str(request.data.get("mechanism")),
                f'"linkage", for a {asked_for(request.data)}',
            )
        )
    if faults:
        raise SpecError(faults, request.source)


def _sizes(request: Request) -> Parts:
    """Sizes of the parts; SpecError with the faults of everything that is not found, before a search: seen with a four-bar."""
    from camgen.machines.linkage.mechanism import Linkage

    points = (0j, 20 + 0j, 70 + 0j, 45 + 40j, 20 + 60j)
    tables = {key: value for key, value in request.rest.items() if key not in _MADE} | {
        "mechanism": "linkage"
    }
    any_one = Candidate(
        ChainDesign(chains(2, 1)[0], points, 0.0, 0.0), np.array(points), tables, 1.0
    )
    return specs.validate(Linkage, any_one.data(1.0), request.source).making


def _beyond(request: Request, key: str, ends: Sequence[float | str]) -> list[Fault]:
    """What is wrong with a key that varies, at both ends or each word by itself: no such key, or a value that it cannot have."""
    for value in ends:
        try:
            changed(request.rest, request.source, request.folder, [f"{key}={value!r}"])
        except SpecError as error:
            own_faults = [fault for fault in error.faults if dotted(fault.path) == key or not value]
            own_faults = own_faults or [
                fault
                for fault in error.faults
                if fault.unknown or fault.source == "--set" and not fault.path
            ]
            if own_faults:
                text = value if isinstance(value, str) else f"{value:g}"
                return [
                    Fault(("wanted", "vary", key), text, fault.expected, fault.nearest)
                    for fault in own_faults
                ]
    return []
