"""`camgen design`: the spec that fulfils what a spec wants, its own text and comments kept where that can be."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import numpy as np

from camgen import reading
from camgen import spec as specs
from camgen.design.chains import chains
from camgen.design.keys import Search
from camgen.design.linkages import Candidate
from camgen.design.paths import ChainDesign
from camgen.design.prototype import Prototype
from camgen.design.wanted import FunctionWish, KeyWish, PathWish, asked_for, wish, without
from camgen.edits import edited, with_tables
from camgen.errors import DesignError, Fault, FileError, SpecError, counted, dotted, file_errors
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import Source, changed, read_mechanism, read_tables, tables_of_text
from camgen.numerics import Points
from camgen.report.sketches import Sketch
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
_STEP = 0.02  # least difference of bars of two designs of a front for a path, as a share
_BEHIND = 0.8  # of the error and bars of a design that could be built: the front reaches to those at most so much worse
_PROTOTYPES = 60  # designs for a path whose parts are made; a layer more at most
# of the wanted path's longest chord: error, and length of all bars, that a front reaches to
_WORST = 0.2
_MOST = 10.0


class Design(Protocol):
    """A machine that a search found."""

    @property
    def prototype(self) -> Prototype:
        """Whether it can be made, and its play."""

    @property
    def sketch(self) -> Sketch:
        """What a sketch shows."""

    def data(self, tolerance: float | None = None) -> reading.Data:
        """Tables of its spec."""

    def row(self, number: int) -> dict[str, Any]:
        """What a table of the front shows."""


D = TypeVar("D", bound=Design)


@dataclass(frozen=True, repr=False)
class Front:
    """Designs that no other one beats."""

    title: str  # of the page
    summary: str
    axes: Mapping[
        str, str
    ]  # columns that are drawn, one over the other, and how a person reads them
    texts: Sequence[str]  # a spec for each design
    rows: Sequence[Mapping[str, Any]]  # of the table
    sketches: Sequence[Sketch]

    def __repr__(self) -> str:
        """Its title and figures."""
        return "\n".join([self.title, *(f"  {words}" for words in self._captions())])

    def _repr_html_(self) -> str:
        """For a notebook: its table."""
        head = "".join(f"<th>{escape(name)}</th>" for name in self.rows[0])
        rows = [
            "".join(f"<td>{escape(str(cell))}</td>" for cell in row.values()) for row in self.rows
        ]
        body = "".join(f"<tr>{row}</tr>" for row in (head, *rows))
        return f"<h4>{escape(self.title)}</h4><p>{escape(self.summary)}</p><table>{body}</table>"

    def _captions(self) -> list[str]:
        """What is said of each design."""
        captions = []
        for row in self.rows:
            figures = ", ".join(text.format(row[column]) for column, text in self.axes.items())
            captions.append(f"design {row['design']}: {figures}, {row['verdict']}")
        return captions

    def write(self, folder: Path) -> None:
        """01.toml, 02.toml, ..., front.csv and front.html; FileError where the folder exists."""
        from camgen.report.sketches import picture
        from camgen.report.sweep_page import SweepPage, write_page

        with file_errors():
            try:
                folder.mkdir(parents=True)
            except FileExistsError:
                raise FileError(
                    folder, "exists already and is left as it is; choose another folder"
                ) from None
            for number, text in enumerate(self.texts, 1):
                (folder / f"{number:02d}.toml").write_text(text, encoding="utf-8", newline="\n")
            stream = io.StringIO()
            table = csv.DictWriter(stream, list(self.rows[0]), lineterminator="\n")
            table.writeheader()
            table.writerows(self.rows)
            (folder / "front.csv").write_text(stream.getvalue(), encoding="utf-8", newline="\n")
        across, up = self.axes
        pictures = [
            (picture(each, words), words)
            for each, words in zip(self.sketches, self._captions(), strict=True)
        ]
        page = SweepPage(self.title, self.summary, list(self.rows[0]), [across], [up], pictures)
        write_page(folder / "front.html", page, self.rows, len(self.rows))


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
    if keep is not None and kind not in ("path", "function"):
        raise SpecError(
            [
                Fault(
                    (),
                    "",
                    "a search for a path or a function: they alone have a front",
                    source="--front",
                )
            ],
            "command line",
        )
    if not kind:
        mechanism = read_mechanism(spec, settings)
        designed = getattr(mechanism, "designed", None)
        if designed is None:
            right = 'a table with path = "..." or function = [...] (a linkage for it), or vary = { key = [least, most] } and '
            raise SpecError(
                [Fault(("wanted",), "", f'missing: {right}least = "figure"; camgen guide design')],
                source,
            )
        return specs.dump(designed())
    search = {"path": _for_path, "function": _for_function, "vary": _for_keys}[kind]
    return search(Request(data, source, folder, text, ends, jobs, say, keep))


@dataclass(frozen=True, repr=False)
class DesignResult:
    """What a search found."""

    text: str  # of the spec, as `camgen design` writes it
    machine: Mechanism  # that it is
    front: (
        Front | None
    )  # of a search for a path or a function: all designs that are best in something
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
    keep = fronts.append if asked_for(data) in ("path", "function") else None
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
        self, front: Sequence[D], title: str, summary: str, axes: Mapping[str, str], note: str
    ) -> list[dict[str, Any]]:
        """The rows of a front, which is kept where that is asked for."""
        rows = []
        for number, each in enumerate(front, 1):
            self.say(f"parts of design {number} of {len(front)}")
            rows.append(each.row(number))
        if self.keep is not None:
            texts = [self.spec_of(each, note, None) for each in front]
            name = str(self.data.get("name"))
            self.keep(
                Front(
                    f"{title} of {name}",
                    summary,
                    axes,
                    texts,
                    rows,
                    [each.sketch for each in front],
                )
            )
        return rows

    def spec_of(self, each: Design, note: str, tolerance: float | None) -> str:
        """The spec of a design: the text that was given with what was found, or one of its own."""
        from camgen.machines import MECHANISMS, load

        data = each.data(tolerance)
        if self.text is None:
            return specs.dump(specs.validate(load(specs.choose(data, MECHANISMS)), data))
        keys = (
            "points",
            "links",
            "drive",
            "output",
            *(["limits"] if "lash" in self.data["wanted"] else []),
        )
        return with_tables(self.text, {key: data[key] for key in keys}, ["wanted"], note).replace(
            "\n", self.ends
        )


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
    front = functions.search(found, request.with_lash("lash_deg", found.lash))
    note = "found by camgen design for a function; output.function: its pairs, and how far this machine may be off"
    summary = (
        f"{len(front)} four-bars: each is nearer to the function than all of better transmission, or transmits better "
        "than all nearer. Design 1 is 01.toml, and so on; a refused design cannot be built as it is."
    )
    axes = {
        "worst_error_deg": "worst error {:.4g} deg",
        "transmission_deg": "transmission {:.4g} deg",
    }
    rows = request.front_rows(front, "Four-bars for the function", summary, axes, note)

    def error(each: functions.Generator) -> float:
        return math.degrees(each.error)

    goal = Aim(found, found.allowance, "deg", "off at the pairs", "the rocker's swing")
    best = choice(front, goal, error, lambda each: each.transmission, lambda each: -each.error)
    row = rows[front.index(best)]
    request.say(
        f"design {row['design']} of {len(front)}: at most {row['worst_error_deg']:.4g} deg off at the pairs, "
        f"transmission angle {row['transmission_deg']:.4g} deg and more"
    )
    return request.spec_of(best, note, found.tolerance)


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
    with Workers(request.jobs) as workers:
        found = paths.search(goal, kinds, wanted.effort, wanted.seed, workers.map, request.say)
    if not found:
        raise DesignError("designs whose chain closes", 0, 1, "", "wanted", wanted.further)
    tables = request.with_lash("lash", wanted.lash)
    front = _buildable_front(
        found, lambda each: Candidate(each, line, tables, aim.allowance, wanted.joined), request.say
    )
    name = wanted.path if isinstance(wanted.path, str) else f"{len(wanted.path)} points"
    note = f"found by camgen design for the path {name}; output.path: that path, and how far this machine's may be from it"
    summary = (
        f"{len(front)} designs: each is nearer to the path in the mean than all with less bar, or has less bar than all "
        "nearer, of all designs or of those that can be built. Design 1 is 01.toml, and so on; a refused design cannot "
        "be built as it is."
    )
    axes = {"mean_distance_mm": "mean distance {:.4g} mm", "bars_mm": "bars {:.4g} mm"}
    rows = request.front_rows(front, "Linkages for the path", summary, axes, note)

    def worth(each: Candidate) -> float:
        return (1 - each.design.error / goal.worst) * (1 - each.design.bars / goal.most)

    best = choice(front, aim, lambda each: each.worst, lambda each: -each.design.bars, worth)
    row = rows[front.index(best)]
    request.say(
        f"design {row['design']} of {len(front)}: at most {best.worst:.4g} mm from the path, "
        f"{row['mean_distance_mm']:.3g} mm in the mean, bars of {best.design.bars:.4g} mm, "
        f"play of {best.prototype.lash:.3g} mm"
    )
    return request.spec_of(best, note, wanted.tolerance)


def _buildable_front(
    designs: Sequence[ChainDesign], candidate: Callable[[ChainDesign], Candidate], say: Say
) -> list[Candidate]:
    """The front of all designs, that of those that can be made and that of those that are of use, by rising error.

    What is of no use leaves room for designs behind it: they are weighed front after front.
    """
    from camgen.design import paths

    remaining = paths.apart(paths.near(designs, paths.front(designs), _BEHIND))
    candidates: dict[ChainDesign, Candidate] = {}
    useful: list[ChainDesign] = []
    while remaining and len(candidates) < _PROTOTYPES:
        layer = paths.front(remaining, _STEP)
        candidates |= {each: candidate(each) for each in layer}
        useful += [each for each in layer if candidates[each].prototype.of_use]
        say(
            f"{len(candidates)} designs judged, {len(useful)} of them can be built and keep the limits"
        )
        remaining = [
            each
            for each in remaining
            if each not in layer
            and not any(one.error <= each.error and one.bars <= each.bars for one in useful)
        ]
    buildable = [each for each in candidates if not candidates[each].prototype.obstacle]
    front = {
        *paths.front(candidates, _STEP),
        *paths.front(buildable, _STEP),
        *paths.front(useful, _STEP),
    }
    return [candidates[each] for each in sorted(front, key=lambda each: (each.error, each.bars))]


def _refuse_made_tables(request: Request) -> None:
    """SpecError for tables that a search makes, and for another mechanism."""
    right = "nothing here: it is found, with [points], [links] and [[output]]"
    faults = [Fault((key,), "a table", right) for key in _MADE if key in request.rest]
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


@dataclass(frozen=True)
class Aim:
    """What a design must keep to be chosen, and how that is said."""

    wish: PathWish | FunctionWish
    allowance: float  # how far it may be off
    unit: str  # of that
    off: str  # what an error is
    size: str  # that of which a twentieth is borne without a tolerance


def choice(
    front: Sequence[D],
    aim: Aim,
    error: Callable[[D], float],
    within: Callable[[D], float],
    best: Callable[[D], float],
) -> D:
    """Of those that can be built, with no more play and error than is borne: the one of most `within` the tolerance, or without
    one the `best`; DesignError."""
    wanted = aim.wish
    unit = aim.unit
    buildable = [each for each in front if not each.prototype.obstacle]
    if not buildable:
        room = "a larger wanted.frame" if isinstance(wanted, FunctionWish) else wanted.further
        raise DesignError(
            "buildable designs",
            0,
            1,
            "",
            f"front of {len(front)}",
            f"{room}, or thinner parts",
        ).saying(
            f"none of {len(front)} designs can be built; the first: {front[0].prototype.obstacle}"
        )
    if wanted.lash is not None:
        tight = [each for each in buildable if each.prototype.lash <= wanted.lash]
        if not tight:
            least = min(each.prototype.lash for each in buildable)
            remedy = "a smaller print.slide_clearance, or more play"
            raise DesignError(
                "wanted.lash", least, wanted.lash, unit, "the tightest buildable design", remedy
            )
        buildable = tight
    can = [each for each in buildable if not each.prototype.failures]
    if not can:
        nearest = min(buildable, key=error).prototype
        many = counted(len(buildable), "buildable design")
        only_play = {each.code for each in nearest.failures} == {"LASH"}
        remedy = (
            "a smaller print.slide_clearance, or a greater wanted.lash"
            if only_play
            else "wider [limits]"
        )
        message = f"none of {many} keeps its limits; the nearest one: {nearest.refusal}"
        raise DesignError(
            "designs that keep their limits",
            0,
            1,
            "",
            many,
            remedy,
        ).saying(message)
    near = [each for each in can if error(each) <= aim.allowance]
    least = min(map(error, can))
    if not near and wanted.tolerance is None:
        raise DesignError(
            f"distance {aim.off}",
            least,
            aim.allowance,
            unit,
            "the nearest buildable design",
            f"{wanted.further}, or wanted.tolerance = {math.ceil(100 * least) / 100:g}",
        ).saying(
            f"the nearest buildable design is {least:.4g} {unit} {aim.off}; without wanted.tolerance the limit is a twentieth of "
            f"{aim.size}, {aim.allowance:.4g} {unit}"
        )
    if not near:
        remedy = f"{wanted.further}, or a wider wanted.tolerance"
        raise DesignError(
            "wanted.tolerance", least, aim.allowance, unit, "the nearest buildable design", remedy
        )
    return max(near, key=best if wanted.tolerance is None else within)
