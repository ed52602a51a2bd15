"""`camgen explore` of a linkage: its text with what was done to it, what the page draws of it, and the page's requests."""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache, reduce
from hashlib import sha256
from html import escape
from pathlib import Path
from string import Template
from threading import Lock
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from camgen import reading
from camgen import spec as specs
from camgen.bounds import read_bytes
from camgen.edits import edited
from camgen.errors import DesignError, Fault, FileError, SpecError, file_errors
from camgen.findings import Finding, as_read
from camgen.live.gallery import Gallery, cards, usable
from camgen.live.numbers import Refusal, numbers, overrides, write
from camgen.live.operations import FILE_NAME, GROUND, NAMED_FILE, ROWS, applied, moved
from camgen.live.preview import failure, preview
from camgen.live.server import Answer, LastBuild, asset, served
from camgen.machines import load
from camgen.machines.linkage.mechanism import Linkage
from camgen.machines.linkage.traces import angles, apexes, cam_shapes, idle, traces
from camgen.machines.sources import changed, opened_tables
from camgen.numerics import Floats, Points
from camgen.report.report import Report
from camgen.report.words import sentence
from camgen.settings import override

if TYPE_CHECKING:
    from starlette.applications import Starlette

_MOST_UNDONE = 500
_GAPS = "closes at PERCENT % of the angles of its drive: the others are drawn as gaps"
# What a sheet has to have, in the order in which one draws, each with what to do where it has none.
_TO_DRAW = {
    "links": "Take Link, press on the paper where a link begins and drag to where it ends",
    "ground": "Take Ground and click the points that stand still",
    "drive": "Take Drive and click the link that drives",
    "output": "Take Output and click the point whose path you want, or a link whose motion you want",
}
_EMPTY = """# Drawn with camgen explore.

mechanism = "linkage"
name = "my-linkage"

[points]                            # mm, at theta = 0

[links]

[drive]
speed_rpm = 30
"""


@dataclass
class SheetFile:
    """Where a sheet is kept, and what was last read from there or written."""

    path: Path | None = None  # None: it is not saved yet
    digest: str = ""
    text: str = ""


class Board:
    """A linkage's text while it is drawn. Without a spec a page with the gallery comes first."""

    def __init__(self, spec: Path | None, out: Path, gallery: Gallery | None = None) -> None:
        """gallery: those of its specs are shown that are linkages and name no file."""
        self.file = SheetFile(spec)
        given = gallery or Gallery()
        self.gallery = usable(given.texts)
        self.pictures = given.pictures
        self.last_build = LastBuild(spec or Path("sheet.toml"), out)
        self.lock = Lock()
        self.text: str | None = None
        self.typed: set[str] = set()  # links of which a person gave the names
        self.past: list[tuple[str, SheetFile]] = []
        self.future: list[tuple[str, SheetFile]] = []
        if spec is not None:
            self._read(spec)

    def _read(self, spec: Path) -> None:
        """Take the text as its file has it now; what was drawn before stays behind Undo."""
        reading.read(spec)
        raw = read_bytes(spec, reading.SPEC_FILE)
        digest = sha256(raw).hexdigest()
        if digest == self.file.digest:
            return
        if self.text is not None:
            self.past.append((self.text, self.file))
        self.file.digest = digest
        self.file.text = raw.decode("utf-8-sig")
        self._take(self.file.text)
        self.typed |= _sheet(self.tables)["links"].keys()

    def _take(self, text: str) -> None:
        """Show this text."""
        self.text = text
        self.tables = reading.tables(tomllib.loads(text))
        self.linkage: Linkage | None = None
        self.faults: Sequence[Fault] = ()
        self.reason = ""
        try:
            self.linkage = self._linkage(self.tables)
        except SpecError as error:
            self.faults = error.faults
            return
        try:
            self.linkage.chain  # noqa: B018
        except DesignError as error:
            self.reason = str(error)

    def _keep(self, text: str) -> None:
        """Put the text that is shown behind Undo."""
        self.past = [*self.past, (text, self.file)][-_MOST_UNDONE:]
        self.future.clear()

    @property
    def spec(self) -> Path | None:
        """The file of the sheet that is shown."""
        return self.file.path

    @property
    def folder(self) -> Path:
        """Where files are that the spec names."""
        return Path() if self.spec is None else self.spec.parent

    def _linkage(self, tables: reading.Data, shown: bool = True) -> Linkage:
        """The machine of some tables; shown: as the sheet has it, also where no output is chosen yet."""
        first = next(iter(_sheet(tables)["points"]), None)
        if shown and "output" not in tables and first:
            tables = {**tables, "output": [{"name": "sheet", "point": first}]}
        made = changed(opened_tables(tables, self.folder), "sheet", self.folder)
        assert isinstance(made, Linkage)
        return made

    # ---- what the page asks for ----

    def draw(self, request: Answer) -> Answer:
        """Do an operation; try = true: only show what it would do, as while a hand drags."""
        with self.lock:
            if request.get("try") is True:
                return self._tried(request)
            text = self._after(request)
            if text != self.text:
                self._keep(self._shown)
                self._take(text)
            return self._seen()

    def undo(self, _request: Answer) -> Answer:
        """Take the last operation back."""
        return self._step(self.past, self.future)

    def redo(self, _request: Answer) -> Answer:
        """Do again what was taken back."""
        return self._step(self.future, self.past)

    def idle(self, _request: Answer) -> Answer:
        """Keys of [points] that have no effect, and the cams' outlines: what takes a moment."""
        linkage = self.linkage
        if linkage is None or self.reason:
            return Answer(ok=True, idle=[], cams=[])
        keys = [f"points.{key}" for key in idle(linkage)]
        return Answer(ok=True, idle=keys, cams=_cams(linkage))

    def limits(self, _request: Answer) -> Answer:
        """The verdict of the design's own limits, which may take seconds; none of what is no machine yet."""
        linkage = self.linkage
        if linkage is None or self.reason or "output" not in self.tables:
            return Answer(ok=False, verdict="", errors=[])
        try:
            findings = linkage.forecast()
        except DesignError as error:
            return failure("cannot be made", [str(error)])
        report = Report(linkage.name, linkage.mechanism, findings)
        said = [_failing(finding) for finding in findings if not finding.ok]
        return Answer(ok=report.ok, verdict=report.verdict, errors=said)

    def preview(self, request: Answer) -> Answer:
        """The report's page of what is drawn, by what needs no file."""
        if wanted := _wanted(_sheet(self.tables)):
            return _unfinished(wanted)
        with self.lock:
            tables = opened_tables(self.tables, self.folder)
        return preview(tables, "sheet", self.folder, [], request.get("quick") is True)

    def build(self, _request: Answer) -> Answer:
        """All files of what is drawn."""
        if wanted := _wanted(_sheet(self.tables)):
            return _unfinished(f"Nothing to build yet: {wanted[:1].lower()}{wanted[1:]}")
        with self.lock:
            made = self._linkage(self.tables, shown=False)
        return self.last_build.build([], made)

    def save(self, _request: Answer) -> Answer:
        """Write the text into its file, which has to be as it was read; of a new sheet into one by its name."""
        with self.lock:
            text = self._shown
            raw = text.encode("utf-8")
            path = self.spec
            if path is None:
                path = self._new_file(raw)
                self.file.path = path
            else:
                before = read_bytes(path, reading.SPEC_FILE)
                if sha256(before).hexdigest() != self.file.digest:
                    right = "was changed since this page read it; reload the page to see it, and Undo to have yours again"
                    raise FileError(path, right)
                write(path, text)
            self.file.digest = sha256(raw).hexdigest()
            self.file.text = text
            self.typed |= _sheet(self.tables)["links"].keys()
            return {**self._seen(), "verdict": f"saved in {path.name}"}

    def start(self, request: Answer) -> Answer:
        """Begin a new sheet, empty or with one of the gallery; what was drawn before stays in its file, and with it behind Undo."""
        name = request.get("name")
        with self.lock:
            if name and str(name) not in self.gallery:
                raise SpecError([specs.unknown(("name",), str(name), self.gallery)], "gallery")
            if self.text is not None:
                self._keep(self.text)
            self.file = SheetFile()
            self._take(self.gallery[str(name)] if name else _EMPTY)
            self.typed = {*_sheet(self.tables)["links"]}
        return Answer(ok=True, verdict="", errors=[])

    # ---- how it answers ----

    @property
    def _shown(self) -> str:
        if self.text is None:
            raise SpecError(
                [Fault(("sheet",), "", "begin with an empty sheet or a spec of the gallery")],
                "sheet",
            )
        return self.text

    def _after(self, request: Answer) -> str:
        """The text after an operation; `set` gives keys other values."""
        if request.get("op") == "set":
            return edited(self._shown, self._settings(request))
        text = applied(self._shown, request, self.typed)
        if request.get("op") == "rename" and "link" in request:
            self.typed.add(str(request.get("to")))
        return text

    def _settings(self, request: Answer) -> list[str]:
        return overrides(request.get("settings"), self._numbers())

    def _numbers(self) -> Any:
        return numbers(self.tables, _schema())

    def _step(
        self, back: list[tuple[str, SheetFile]], ahead: list[tuple[str, SheetFile]]
    ) -> Answer:
        with self.lock:
            if back:
                ahead.append((self._shown, self.file))
                text, self.file = back.pop()
                self._take(text)
            return self._seen()

    def _tried(self, request: Answer) -> Answer:
        """Where the points go: of places in between a drag, or of keys that a slider moves."""
        linkage = self.linkage
        points = lengths = None
        try:
            if request.get("op") == "set":
                settings = self._settings(request)
                linkage = self._linkage(reduce(override, settings, self.tables))
                points = {**linkage.points}
            elif linkage is not None:
                points, lengths = moved(self.tables, request)
            return Answer(ok=True, **_motion(linkage, points, lengths))
        except SpecError as error:
            return Answer(ok=True, faults=_told(error.faults), **_motion(None))
        except (KeyError, TypeError, ValueError):
            raise SpecError(
                [Fault(("points",), "", "places of points of the sheet")], "sheet"
            ) from None

    def _seen(self) -> Answer:
        """All that the page shows of the text."""
        sheet = _sheet(self.tables)
        return Answer(
            ok=not self.faults and not self.reason,
            verdict="",
            errors=[],
            sheet=sheet,
            wanted=_wanted(sheet),
            faults=_told(self.faults),
            file="new sheet" if self.spec is None else self.spec.name,
            undo=bool(self.past),
            redo=bool(self.future),
            changed=self.text != self.file.text,
            text=self.text,
            numbers=[vars(number) for number in self._numbers()],
            chain=_chain(self.linkage),
            **(_motion(self.linkage) | ({"reason": self.reason} if self.reason else {})),
        )

    # ---- files and pages ----

    def _new_file(self, raw: bytes) -> Path:
        name = self.tables.get("name")
        if not isinstance(name, str) or not FILE_NAME.fullmatch(name):
            raise SpecError(
                [Fault(("name",), str(name), NAMED_FILE)],
                "sheet",
            )
        path = Path(f"{name}.toml")
        if path.exists():
            raise Refusal(
                [Fault(("name",), name, f"another one: {path} is there already")], "sheet"
            )
        with file_errors(), open(path, "xb") as file:
            file.write(raw)
        return path

    def page(self) -> str:
        """The sheet with its file as it is now; first the gallery, where there is no spec."""
        with self.lock:
            if self.spec is not None:
                self._read(self.spec)
            if self.text is None:
                return self.choice()
            seen = self._seen()
        data = json.dumps(seen, ensure_ascii=False).replace("<", "\\u003c")
        way = '<a href="gallery">Gallery</a>' if self.gallery else ""
        return Template(asset("draw.html")).substitute(
            name=escape(seen["file"]), data=data, gallery=way
        )

    def choice(self) -> str:
        """The gallery, with which a sheet begins; what is drawn stays."""
        return Template(asset("start.html")).substitute(
            cards=cards(Gallery(self.gallery, self.pictures))
        )

    def app(self, word: str) -> Starlette:
        """What serves it, below the word."""
        asked = ("draw", "undo", "redo", "idle", "limits", "preview", "build", "save", "start")
        answers = {f"/{name}": getattr(self, name) for name in asked}
        pages = {"/": self.page, "/gallery": self.choice}
        return served(word, pages, self.last_build, answers, self.pictures)


# ---- what is drawn ---------------------------------------------------------------------------------------------------


@lru_cache(maxsize=1)
def _schema() -> Any:
    return specs.schema(load("linkage"), "linkage")


def _failing(finding: Finding) -> str:
    limit, _ = as_read(finding.limit, finding.unit)
    bound = f"at {'least' if finding.floor else 'most'} {limit:.4g}"
    size, unit = as_read(finding.measured, finding.unit)
    measured = f"{size:.4g} {unit}, {bound}"
    return f"{finding.code}, {finding.where}: {sentence(measured)}; {sentence(finding.message)}"


def _told(faults: Sequence[Fault]) -> list[Answer]:
    """Each fault with the steps of its key, by which the page finds its place."""
    return [{"path": list(fault.path), "text": str(fault)} for fault in faults]


def _sheet(tables: reading.Data) -> Answer:
    """What there is to draw, also of tables that are no machine yet."""
    points = {
        name: [float(x) for x in place]
        for name, place in _table(tables, "points").items()
        if isinstance(place, list)
        and len(place) == 2
        and all(isinstance(x, int | float) for x in place)
    }
    links = {
        name: [point for point in each if isinstance(point, str) and point in points]
        for name, each in _table(tables, "links").items()
        if isinstance(each, list)
    }
    listed = {kind: tables[kind] for kind in ROWS if isinstance(tables.get(kind), list)}
    rows = {kind: [row for row in listed.get(kind, ()) if isinstance(row, dict)] for kind in ROWS}
    return {
        "name": str(tables.get("name", "")),
        "points": points,
        "links": links,
        "lengths": _table(tables, "lengths"),
        "drive": _drive(tables).get("link", _drive(tables).get("slide", "")),
        **rows,
    }


def _wanted(sheet: Answer) -> str:
    """What to draw next, in the words of the page; "" where all is there that a machine has."""
    links = sheet["links"]
    there = {**sheet, "links": links.keys() - {GROUND}, "ground": links.get(GROUND)}
    return next((words for part, words in _TO_DRAW.items() if not there[part]), "")


def _unfinished(wanted: str) -> Answer:
    """The answer where there is no machine yet, and nothing is wrong."""
    return Answer(ok=False, wanted=wanted, verdict=wanted, errors=[])


def _drive(tables: reading.Data) -> reading.Data:
    """The first drive."""
    several = tables.get("drive")
    first = several[0] if isinstance(several, list) and several else several
    return first if isinstance(first, dict) else {}


def _table(tables: reading.Data, name: str) -> reading.Data:
    value = tables.get(name)
    return value if isinstance(value, dict) else {}


def _motion(linkage: Linkage | None, points: Any = None, lengths: Any = None) -> Answer:
    """Places of all points, drawn (`start`) and over the turn (`paths`: x, y, x, y, ..., mm; null where it does not close)."""
    if linkage is None:
        return {"start": None, "paths": {}, "reason": ""}
    theta = angles(linkage)
    try:
        found = traces(linkage, np.append(0.0, theta), points, lengths)
    except (DesignError, ArithmeticError, ValueError) as error:
        return {"start": None, "paths": {}, "reason": str(error)}
    closed = np.all([np.isfinite(z) for z in found.values()], axis=0)
    closed[1:] = _reached(closed[1:], theta)
    if not closed[0]:
        reason = "it does not close as drawn: lengths and places contradict each other"
        return {"start": None, "paths": {}, "reason": reason}
    gap = complex(math.nan, math.nan)
    return {
        "start": {name: [z[0].real, z[0].imag] for name, z in found.items()},
        "paths": {name: _flat(np.where(closed[1:], z[1:], gap)) for name, z in found.items()},
        "reason": ""
        if closed.all()
        else _GAPS.replace("PERCENT", f"{100 * closed[1:].mean():.0f}"),
    }


def _reached(closed: NDArray[np.bool_], theta: Floats) -> NDArray[np.bool_]:
    """Angles that the drive comes to: of a turn those beside the drawn place, as far as the chain closes either way."""
    if not math.isclose(np.ptp(theta), math.tau):
        return closed
    return np.logical_and.accumulate(closed) | np.logical_and.accumulate(closed[::-1])[::-1]


def _chain(linkage: Linkage | None) -> Answer | None:
    """What the page needs to place all points by itself while a hand drags; None where it has to ask."""
    steps = None if linkage is None else apexes(linkage)
    if linkage is None or steps is None:
        return None
    return Answer(
        apexes=steps,
        angles=np.append(0.0, angles(linkage)).tolist(),
        gaps=_GAPS,
    )


def _cams(linkage: Linkage) -> list[Answer]:
    """Each cam's outline about its pivot (x, y, x, y, ..., mm), and its angle over the turn, rad, as the paths have theirs."""
    theta = angles(linkage)
    return [
        Answer(
            link=each.link,
            pivot=each.pivot,
            outline=_flat(each.outline),
            angles=np.round(each.turns * theta, 4).tolist(),
        )
        for each in cam_shapes(linkage)
    ]


def _flat(places: Points) -> list[float | None]:
    rounded = np.round(np.stack([places.real, places.imag], axis=1), 3)
    return [None if math.isnan(value) else value for place in rounded.tolist() for value in place]
