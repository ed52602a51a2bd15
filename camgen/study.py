"""What the report shows of a machine, as data: plots, tables, sketches, numbers and notes."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from itertools import groupby
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import numpy as np

from camgen.errors import CamgenError
from camgen.numerics import Floats, Points

if TYPE_CHECKING:
    from pandas import DataFrame

T = TypeVar("T")
ROWS = 1441  # of curves and of motion.csv: every quarter degree of a turn, both ends


# Units whose writing in keys does not follow from the letters.
_SUFFIXES = {"%": "percent", "1/s": "per s", "N m/rad": "n m per rad"}


@dataclass(frozen=True)
class Figure:
    """A number of the report: what it is, its unit, of what, as designed or measured; its key names it in report.json.

    Figure("reaction {joint}", 3.2, "N", joint="A") has the key reaction_a_n.
    """

    quantity: str  # in words, with "{of}" or "{joint}" where these stand
    value: float
    unit: str = ""  # as people write it, such as "N m" or "mm/s²"; "" of a ratio or a count
    of: str = ""  # output, cam, part or spring
    joint: str = ""  # in words as in the model, in keys in small letters
    kind: str = ""  # of the files in which it was measured, "" as designed
    module: str = ""  # name of an included machine

    @property
    def key(self) -> str:
        """Its name in report.json, such as motion_error_pen_dxf_mm."""
        return _key(self.module, self.quantity, self.of, self.joint, self.kind, self.unit)


@lru_cache(4096)  # those of many variants are the same
def _key(module: str, quantity: str, of: str, joint: str, kind: str, unit: str) -> str:
    """Of a figure with these fields: their words with _ between them."""
    name = quantity.format(of=of, joint=joint.lower())
    words = f"{module} {name} {kind} {_SUFFIXES.get(unit, unit.lower())}"
    found = "_".join(filter(None, re.split(r"[ ,:/']+", words)))
    return found.translate({ord("²"): "2", ord("³"): "3"})


def figures_in(unit: str = "", **values: float) -> list[Figure]:
    """Several of one unit: figures_in("mm", base_radius=20, needle_stroke=16)."""
    return [Figure(name.replace("_", " "), value, unit) for name, value in values.items()]


class Figures(Mapping[str, float]):
    """Figures in their order, asked for by key: figures["peak_torque_n_m"] is a value; of two with one key the last counts."""

    def __init__(self, records: Iterable[Figure] = ()) -> None:
        self._by_key = {each.key: each for each in records}

    def __getitem__(self, key: str) -> float:
        try:
            return self._by_key[key].value
        except KeyError:
            raise KeyError(f"no figure {key!r}: list(numbers) names them all") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._by_key)

    def __len__(self) -> int:
        return len(self._by_key)

    def __or__(self, more: Iterable[Figure] | Figures) -> Figures:
        """These and more."""
        both = Figures()
        both._by_key = self._by_key | (more if isinstance(more, Figures) else Figures(more))._by_key
        return both

    @property
    def records(self) -> Sequence[Figure]:
        """The figures themselves."""
        return tuple(self._by_key.values())


@dataclass(frozen=True)
class Plot:
    """Curves of the report: series of (label, x, y); `marks` are vertical lines (label, x).

    A plot over the cam angle has x in degrees. equal: a shape, one mm the same both ways; dots: names of series that are
    points, not a line; hollow: of them those that are drawn hollow, with the series whose colour they share; points: places with
    names, (name, x, y); levels: horizontal lines (text, y) in place of the scale's,
    where each series has a scale of its own; sources: of labels such as "x from DXF" what they show and
    where it is from, ("x", "DXF"); places: y is where something stands, of which zero is a place as any other.
    """

    title: str
    x_label: str
    y_label: str
    series: Sequence[tuple[str, Floats, Floats]]
    marks: Sequence[tuple[str, float]] = ()
    equal: bool = False
    dots: Sequence[str] = ()
    hollow: Mapping[str, str] = field(default_factory=dict)
    points: Sequence[tuple[str, float, float]] = ()
    levels: Sequence[tuple[str, float]] = ()
    sources: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    places: bool = False

    @cached_property
    def ends(self) -> tuple[float, float] | None:
        """Least and greatest x of all that is shown, None where there is nothing."""
        found = [
            bound
            for _, x, _ in self.series
            if len(x)
            for bound in (float(np.nanmin(x)), float(np.nanmax(x)))
        ]
        found += [x for _, x, _ in self.points]
        return (min(found), max(found)) if found else None

    @property
    def turns(self) -> bool:
        """Whether x covers one turn in degrees."""
        ends = self.ends
        return ends is not None and -1 < ends[0] < 15 and 345 < ends[1] < 361


@dataclass(frozen=True)
class Mate:
    """Where a part that comes goes on, or through, one that is there; where the machine stands at theta = 0.

    how: "glue"; "press", such as a bearing's ring, without glue; "free", where a drop of glue would lock a joint.
    """

    how: Literal["glue", "press", "free"]
    label: (
        str  # of the hole, as its drawing names it; of one without a name that of the joint; or ""
    )
    place: tuple[float, float, float]  # middle of what both have in common, mm
    diameter: float = 0.0  # mm, of what goes through; 0 of faces that slide
    height: float = 0.0  # mm, of what both have in common
    comes: bool = False  # whether what goes through is the part that comes
    within: bool = False  # whether both come in one step


@dataclass(frozen=True)
class Doing:
    """What is done in a step, as the three pieces of a sentence; those that differ in the object alone are said in one."""

    verb: str  # such as "press and glue "
    thing: str = ""  # that is handled, and where it goes: "cap-2 on pin-5"
    rest: str = ""  # such as ", flush with its upper end"
    needs: tuple[str, ...] = ()  # tools and what is used up that it names, as in parts.tools
    props: tuple[float, ...] = ()  # heights of blocks that prop or bear something, one each, mm


Prism = tuple[Sequence[complex], float, float]  # corners, from where to where it reaches, mm
Laid = Sequence[tuple[str, Sequence[str], Sequence[Mate]]]


_SENTENCES = 4  # of a step, beyond which what is done first, next and so on are lines to tick off
_LONG = 400  # letters of a step, beyond which they are too


def sentences(doings: Sequence[Doing]) -> str:
    """What is done, for people: "Press and glue cap-1 on pin-6 and cap-2 on pin-5, each flush with its upper end." """
    return " ".join(_each_sentence(doings))


def _each_sentence(doings: Sequence[Doing]) -> list[str]:
    """What is done, one thing after the other."""
    said = []
    for (verb, rest), alike in groupby(doings, lambda each: (each.verb, each.rest)):
        things = list(dict.fromkeys(each.thing for each in alike))
        listed = " and ".join(filter(None, (", ".join(things[:-1]), things[-1])))
        each = rest.replace(", ", ", each ", 1) if len(things) > 1 and rest[:2] == ", " else rest
        whole = f"{verb}{listed}{each}"
        *lines, last = f"{whole[:1].upper()}{whole[1:]}".split("\n")
        ended = [each if each.startswith("☐") else _ended(each) for each in lines]
        said.append("\n".join([*ended, _ended(last)]))
    return said


def _ended(line: str) -> str:
    """A line with its full stop."""
    return line if line.endswith((".", ":")) else f"{line}."


@dataclass(frozen=True, eq=False)
class Step:
    """A step of assembly.

    A sub-assembly is built by itself in the steps that name it and have copies; the one that names it and has none puts it in.
    """

    doings: Sequence[Doing]  # what comes, and where it goes
    copies: Sequence[
        str
    ] = ()  # that come, by name, such as cam-1; none where nothing is made for it
    way: Literal[-1, 1] = -1  # in which they come on the bench: from above, or from below
    mates: Sequence[Mate] = ()
    group: str = ""  # the sub-assembly
    apart: str = ""  # what is built by itself from several steps, such as "far side"
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)  # what is up as that lies on the bench
    # what was built apart and comes too; where it comes again later, such as after a trial without glue, it is of the whole from then on
    joins: str = ""
    wire: Floats | None = None  # line of a spring that comes, (n, 3) mm
    # of what is bought and comes, such as a motor: corners of each prism, complex mm, and from where to where it reaches, mm
    shapes: Sequence[Prism] = ()
    # what is done in its place where all sub-assemblies are pressed before it; none where that is the same
    pressed: Sequence[Doing] = ()
    small: bool = False  # whether all that come are spacers, caps or nuts
    follows: bool = False  # whether it is done in one go with the step before it
    dry: Sequence[str] = ()  # parts that are held without glue, however tight they are
    # what the picture shows side by side on the bench: of each group its name, its copies, and where they are fixed on each other
    laid: Laid = ()
    # holes, by part and letter, in which no vice presses what comes: it goes in by hand
    hand_fits: Sequence[tuple[str, str]] = ()
    gauges: Sequence[
        str
    ] = ()  # that are cut of steel for it and stay in no machine: of what stock, and how long
    along: tuple[float, float, float] | None = (
        None  # in which they come, where neither from above nor from below
    )
    glued: Sequence[Mate] = ()  # what is glued besides the round holes of plates
    threads: Sequence[
        tuple[str, float]
    ] = ()  # of screws that come: thread, such as "M3", and length, mm
    screws: Sequence[Prism] = ()  # where these are

    @property
    def title(self) -> str:
        """What is done, for people."""
        return sentences(self.doings)

    @property
    def text(self) -> str:
        """The same with a line to tick off for each thing that is done, where these are many."""
        said = self.lines
        count = sum(each.count(". ") + 1 for each in said)
        brief = count <= _SENTENCES and len(self.title) <= _LONG
        if brief or len(said) == 1:
            return self.title
        return "\n".join(f"☐ {each}" for each in said)

    @property
    def lines(self) -> list[str]:
        """What is done, one thing after the other."""
        return _each_sentence(self.doings)

    def also(self, text: str) -> Step:
        """The step with one more sentence."""
        return replace(self, doings=[*self.doings, Doing(text)])


@dataclass(frozen=True)
class Table:
    """A table of the report: rows of text or numbers under the columns' names.

    digits: of its numbers on the page, 3 where they are estimates. steps: of an order of assembly, one for each row or, as a
    person at the bench takes them, one for each number in the first column.
    """

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[object]]
    steps: Sequence[Step] = ()
    digits: int = 6
    shopping: bool = (
        False  # whether it is the parts list, whose first four columns say what is bought
    )


@dataclass(frozen=True)
class Upright:
    """A plane that stands in the machine, in which a body moves: its x is the machine's -y, its y the machine's z.

    inner, outer: from where to where along the machine's x a thing in it reaches, mm; origin: of the body's own plane in it.
    """

    inner: float
    outer: float
    origin: complex = 0j


@dataclass(frozen=True)
class Sketch:
    """What is drawn but not made: strokes (polylines, complex mm) and circles (centre, radius) on a body of the model.

    course: of what changes its shape, such as a thread: theta, (n,) rad -> one polyline on the ground, (n, k) complex mm.
    swell: how far each point of a course lies over the height of the line, (k,) mm, as of a coil round a rod.
    z: height at which it lies, mm; None: as high as the parts of its `level`, a body of the model, of its own where none is named.
    upright: of a body whose plane stands, such as the follower of a drum; it is drawn in three dimensions alone.
    """

    name: str
    strokes: Sequence[Points] = ()
    circles: Sequence[tuple[complex, float]] = ()
    body: str = "ground"
    course: Callable[[Floats], Points] | None = None
    z: float | None = None
    level: str = ""
    upright: Upright | None = None
    swell: Floats | None = None


@dataclass(frozen=True, eq=False)
class Plate:
    """A plate ready to print: its file, and the copies on it, (part, transform (3, 4)), mm.

    size: width, depth and height of what lies on it; bed: width and depth of the printer's.
    """

    file: str
    copies: Sequence[tuple[str, Floats]]
    size: tuple[float, float, float]
    bed: tuple[float, float]


@dataclass(frozen=True)
class HoleLabel:
    """A hole as its drawing names it: label, shape in words, the middle of it in the part's frame, mm, and whether it is a joint's
    letter, as steps of assembly use it."""

    label: str
    shape: str
    place: tuple[float, float, float]
    lettered: bool = True


@dataclass(frozen=True, eq=False)
class Scene:
    """The machine in three dimensions.

    glb: with one turn as its animation; copies: names of its parts' copies, in the order of its nodes; work: what the steps
    are of; holes: of each part, in the order of its meshes.
    """

    glb: bytes
    copies: Sequence[str]
    plates: Sequence[Plate]
    steps: Sequence[Step]
    work: str = "Assembly, step by step"
    holes: Sequence[Sequence[HoleLabel]] = ()


class Later(Sequence[T]):
    """Items that are made when the first of them is looked at: whoever wants a study's numbers alone does not wait for them."""

    def __init__(self, make: Callable[[], Sequence[T]]) -> None:
        self._make = make

    @cached_property
    def _items(self) -> Sequence[T]:
        return self._make()

    def __getitem__(self, k: Any) -> Any:
        return self._items[k]

    def __len__(self) -> int:
        return len(self._items)

    def __reduce__(self) -> tuple[type, tuple[Sequence[T]]]:
        """Another process gets the items."""
        return list, (self._items,)


@dataclass(frozen=True)
class Study:
    """What the report shows of a mechanism, without the report knowing the mechanism.

    columns: of motion.csv, where no contact gives them; (1441,) each, every quarter degree of a turn, both ends included.
    """

    numbers: Figures = field(default_factory=Figures)
    plots: Sequence[Plot] = ()
    tables: Sequence[Table] = ()
    sketches: Sequence[Sketch] = ()
    notes: Sequence[str] = ()
    columns: Mapping[str, Floats] = field(default_factory=dict)


def together(studies: Sequence[Study]) -> Study:
    """All of them as one; of figures with one name the first counts."""
    return Study(
        united(each.numbers for each in studies),
        Later(lambda: [plot for each in studies for plot in each.plots]),
        Later(lambda: [table for each in studies for table in each.tables]),
        Later(lambda: [sketch for each in studies for sketch in each.sketches]),
        [note for each in studies for note in each.notes],
    )


def united(all_numbers: Iterable[Figures]) -> Figures:
    """Figures of several as one; of those with one key the first counts."""
    found: dict[str, Figure] = {}
    for numbers in all_numbers:
        for each in numbers.records:
            found.setdefault(each.key, each)
    return Figures(found.values())


def data_frame(columns: Mapping[str, Sequence[object] | Floats]) -> DataFrame:
    """Columns of one length by their names as a DataFrame of pandas; CamgenError where that is not installed."""
    try:
        import pandas
    except ImportError:
        from camgen.extras import install_line

        raise CamgenError(f"to_dataframe needs pandas: {install_line('table')}") from None
    return pandas.DataFrame(columns)
