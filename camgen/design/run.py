"""`camgen design`: the spec that fulfils what a spec wants, its own text and comments kept where that can be."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from camgen import spec as specs
from camgen.design.front import Front
from camgen.design.offers import written
from camgen.design.request import Keep, Request, Say
from camgen.design.wanted import asked_for
from camgen.errors import Fault, SpecError, counted
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import Source, changed, read_mechanism, read_tables, tables_of_text
from camgen.report.report import Report
from camgen.report.summary import summary
from camgen.report.terminal import figure_lines
from camgen.settings import override

_WITHOUT_FRONT = ("", "drawing", "vary")  # wishes whose search gives one design


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
        found = designed()
        for line in _figures_of(found):
            say(line)
        return specs.dump(found)
    return _search(kind, Request(data, source, folder, text, ends, jobs, say, keep))


def _figures_of(machine: Mechanism) -> Iterator[str]:
    """What it reaches, as a build tells it of its files: one figure a line."""
    findings = machine.forecast()
    reached = Report(machine.name, machine.mechanism, findings, machine.study().numbers)
    return figure_lines(summary(reached).figures)


def _search(kind: str, request: Request) -> str:
    """The spec that is found for a kind of wish; what a search needs is loaded where it is wanted."""
    if kind == "vary":
        from camgen.design import keys

        return keys.written(request)
    if kind == "drawing":
        from camgen.design import drawings

        return drawings.written(request)
    if kind == "path":
        from camgen.design.linkages import offer
    elif kind == "function":
        from camgen.design.functions import offer
    else:
        from camgen.design.positions import offer
    return written(request, offer(request))


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
