"""Spec files: the tables that all mechanisms share, and the way from plain tables to a checked record and back to TOML.

choose    data -> name of the mechanism
validate  data -> record of a mechanism's class, or SpecError with every fault
dump      record -> TOML with every default filled in
schema    class -> JSON Schema, for editors
"""

from __future__ import annotations

import json
import math
import re
import sys
from collections.abc import Collection, Iterable, Iterator, Sequence
from copy import deepcopy
from dataclasses import replace
from datetime import date
from difflib import get_close_matches
from functools import cache, cached_property, lru_cache
from typing import Annotated, Any, ClassVar, Literal, NoReturn, TypeVar, get_args, get_origin

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PrivateAttr,
    ValidationError,
)
from pydantic_core.core_schema import ErrorType

from camgen.errors import UNKNOWN, CamgenError, Fault, Key, SpecError, dotted
from camgen.reading import Data
from camgen.schemas import (
    in_words,
    keys_of,
    members_of,
    one_of,
    other_spelling,
    shown,
    step_below,
    tables_of,
    unit_of,
)
from camgen.vocabulary import (
    OldWords,
    Wording,
    example,
    kind_of,
    likely,
    likely_key,
    other_key,
    other_words,
    wording,
)

_PROGRAM = "segment"  # the table whose faults do not hang on the machine's sizes
_WIDE = 110  # characters of a line of TOML
# Tables whose keys no other key depends on: a wrong value of one hides no other fault.
_BESIDE = ("accuracy", "drawing", "files", "laser", "limits", "material", "print")


def quantity(unit: str, description: str | None = None, **bounds: Any) -> Any:
    """Of a number: its unit, "1" of a ratio, as the schema has it; its bounds are gt, ge, lt, le."""
    return Field(description=description, json_schema_extra={"unit": unit}, **bounds)


def text_of_form(form: str, pattern: str, max_length: int | None = None) -> Any:
    """A text's pattern, and in words the form that it asks for, which a fault tells."""
    return Field(pattern=pattern, max_length=max_length, json_schema_extra={"form": form})


Length = Annotated[float, quantity("mm", ge=1e-3, le=1e6)]  # none makes less than a thousandth
Distance = Annotated[float, quantity("mm", ge=0, le=1e6)]
Angle = Annotated[float, quantity("deg", ge=0, le=180)]
Force = Annotated[float, quantity("N or N m", ge=0, le=1e6)]
MinWall = Annotated[
    float,
    quantity(
        "mm",
        "least wall of every part; default: two lines of the nozzle, in metal 1, and in a hardened cam or drum made alone at "
        "least 4 times the case depth (camgen's own rule)",
        ge=1e-3,
        le=1e6,
    ),
]
Coordinate = Annotated[float, quantity("mm", ge=-1e6, le=1e6)]
Mass = Annotated[float, quantity("g", gt=0, le=1e6)]
Clearance = Annotated[float, quantity("mm", ge=0, le=10)]
Spread = Annotated[float, quantity("mm", ge=0, le=5)] | None


def turning(least: float = 0.001) -> AfterValidator:
    """Check of a speed: not 0, and either way at least so many rpm."""

    def check(value: float) -> float:
        if not (value and abs(value) >= least):
            raise ValueError(
                f"a number other than 0{f', at least {least:g} either way' if least else ''}; below 0: clockwise"
            )
        return value

    return AfterValidator(check)


def _growing(ends: tuple[int, int]) -> tuple[int, int]:
    if ends[0] > ends[1]:
        raise ValueError("the least first, then the greatest")
    return ends


Orders = Annotated[
    tuple[Annotated[int, Field(ge=2, le=30)], Annotated[int, Field(ge=2, le=30)]],
    AfterValidator(_growing),
]
Rpm = Annotated[float, quantity("rpm", ge=-1e6, le=1e6)]  # not 0; below 0: clockwise


_PYDANTIC = frozenset(name for name in dir(BaseModel) if name[0] != "_")


class Record(BaseModel):
    """A frozen table of a spec: unknown keys, wrong types, nan and inf are faults."""

    # defer_build: a table gets a validator where it is read by itself, not as a part of others; a default is made by
    # model_construct, which needs none
    model_config = ConfigDict(
        frozen=True, extra="forbid", strict=True, allow_inf_nan=False, defer_build=True
    )

    def __dir__(self) -> list[str]:
        """Its names without those of pydantic, for the completion of a console."""
        return [name for name in super().__dir__() if name not in _PYDANTIC]

    def __setattr__(self, name: str, value: Any) -> None:
        """SpecError: a record stays as it was read; what is private is its own."""
        if name[:1] != "_":
            right = f'a record cannot be changed; machine.replace({{"{name}": ...}}), with the whole key, gives a changed copy'
            raise SpecError([Fault((name,), "", right)])
        super().__setattr__(name, value)


class FixedTable(dict[str, Any]):
    """A table of a record whose keys are names: it is read as a dict, and stays as it is, as the record does."""

    key: Key = ()  # of the table in its spec

    def __reduce__(self) -> tuple[Any, ...]:
        return FixedTable, (dict(self),), {"key": self.key}

    def _refused(self, name: object = "NAME", value: object = ..., *_: Any, **__: Any) -> NoReturn:
        """SpecError: how another record is made."""
        key = dotted((*self.key, name if isinstance(name, str) else "NAME"))
        new = "..." if value is ... else shown(value)
        right = (
            f'a record cannot be changed; machine.replace({{"{key}": {new}}}) gives a changed copy'
        )
        raise SpecError(
            [Fault((*self.key, *((name,) if isinstance(name, str) else ())), "", right)]
        )

    def __setitem__(self, name: str, value: Any) -> NoReturn:
        self._refused(name, value)

    def __delitem__(self, name: str) -> NoReturn:
        self._refused(name, None)

    def __ior__(self, other: Any) -> NoReturn:  # type: ignore[misc]
        self._refused()

    clear = pop = popitem = setdefault = update = _refused  # type: ignore[assignment]


@lru_cache
def _tables_of_names(cls: type[Record]) -> tuple[tuple[str, str], ...]:
    """Fields of a record that may be tables of names, or hold such, and their keys."""
    return tuple(
        (name, field.alias or name)
        for name, field in cls.model_fields.items()
        if _may_hold(field.annotation)
    )


def _may_hold(annotation: Any) -> bool:
    """Whether a type may have a table of names in it."""
    if annotation is dict or get_origin(annotation) is dict:
        return True
    if isinstance(annotation, type) and issubclass(annotation, Record):
        return bool(_tables_of_names(annotation))
    return any(map(_may_hold, get_args(annotation)))


def _fix(record: Record, key: Key = ()) -> None:
    """Make tables of names in a record, and in those that it holds, such that stay as they are; key: of the record in its spec."""
    held = vars(record)
    for name, own in _tables_of_names(type(record)):
        value = held.get(name)
        if value.__class__ is dict:
            held[name] = table = FixedTable(value)
            table.key = (*key, own)
        elif isinstance(value, Record):
            _fix(value, (*key, own))
        elif isinstance(value, tuple):
            for k, each in enumerate(value):
                if isinstance(each, Record):
                    _fix(each, (*key, own, k))


class Accuracy(Record):
    """How far the files may be from the exact outline."""

    chord_tolerance: Annotated[float, quantity("mm", ge=1e-7, le=0.1)] = Field(
        default=0.001, description="largest distance between an outline in a file and the exact one"
    )


class Print(Record):
    """What the workshop's printer needs; shared by all mechanisms.

    Compensations change what is printed (STL, 3MF, plates), not what a laser cuts (DXF) and not the assembly, which shows the
    print. The default of xy_step is 80 steps a mm, as Marlin's Configuration.h has them: 20 teeth of a 2 mm belt a turn of 3,200
    microsteps.
    """

    nozzle: Annotated[float, quantity("mm", ge=1e-9, le=5)] = Field(
        default=0.4, description="width of the lines that the printer lays, that of its nozzle"
    )
    slide_clearance: Clearance = Field(
        default=0.2,
        description="diametral clearance of joints that move; also the play between parts that lie on "
        "each other",
    )
    bore_clearance: Clearance | None = Field(
        default=None,
        description="diametral clearance of round holes that turn on pins and shafts of a linkage; default: slide_clearance",
    )
    press_clearance: Clearance = Field(
        default=0.0,
        description="diametral clearance of press fits, for holes as drawn; printed holes come out narrower: see hole_compensation",
    )
    bed: tuple[Length, Length] = Field(
        default=(220.0, 220.0), description="width and depth of the bed: every part must fit on it"
    )
    bed_height: Length = Field(
        default=250.0, description="height of the tallest part that it can print"
    )
    bed_margin: Annotated[float | None, quantity("mm", ge=0, le=1000)] = Field(
        default=None,
        description="strip along the bed's edge that stays free; default: what a brim needs, if there is room",
    )
    hole_compensation: Annotated[float, quantity("mm", ge=-2, le=2)] = Field(
        default=0.0,
        description="how much smaller the printer makes the radius of a hole, often 0.05 to 0.15; print a coupon to measure it: camgen "
        "guide printing",
    )
    profile_compensation: Annotated[float, quantity("mm", ge=-2, le=2)] = Field(
        default=0.0, description="how much larger the printer makes an outline, all round"
    )
    shrinkage: Annotated[float, quantity("1", ge=-0.05, le=0.05)] = Field(
        default=0.0, description="share by which the plastic shrinks in the plane, such as 0.003"
    )
    elephant_foot: Annotated[float, quantity("mm", ge=0, le=2)] = Field(
        default=0.0, description="chamfer of the lower edges, because the first layers swell"
    )
    first_layer: Annotated[float, quantity("mm", gt=0, le=2)] = Field(
        default=0.2,
        description="height of the first layer, and of the steps of the elephant_foot chamfer",
    )
    layer: Annotated[float | None, quantity("mm", ge=0.01, le=2)] = Field(
        default=None,
        description="height of the other layers, for the print time and for notes on faces between layers",
    )
    xy_step: Annotated[float, quantity("mm", ge=0, le=0.2)] = Field(
        default=0.0125,
        description="step of the print head, 1 / steps per mm: the most by which a slicer may shift walls",
    )
    size_error: Spread = Field(
        default=None,
        description="standard deviation of a size; default: a third of the plastic's usual tolerance",
    )
    place_error: Spread = Field(
        default=None,
        description="standard deviation of a hole's centre along an axis; default: size_error / sqrt 2",
    )
    form_error: Spread = Field(
        default=None,
        description="standard deviation of an outline's waves; default: size_error / 4",
    )
    form_orders: Annotated[Orders, quantity("1")] | None = Field(
        default=None,
        description="number of waves of form_error per turn, least and greatest; default: 2 to 4",
    )

    @property
    def running_clearance(self) -> float:
        """Diametral clearance of round holes that turn on pins and shafts, mm."""
        return self.slide_clearance if self.bore_clearance is None else self.bore_clearance


class Material(Record):
    """The material that you print with, or cut the parts from."""

    name: Literal[
        "PLA",
        "PETG",
        "ABS",
        "ASA",
        "nylon",
        "PC",
        "C45",
        "42CrMo4",
        "16MnCr5",
        "stainless",
        "aluminium",
        "brass",
        "POM",
        "plywood",
        "acrylic",
    ] = Field(
        default="PLA",
        description='printed: "PLA", "PETG", "ABS", "ASA", "nylon" or "PC"; cut: "C45", "42CrMo4", '
        '"16MnCr5" (hardened), "stainless", "aluminium", "brass", "POM", "plywood" or "acrylic"',
    )
    density: Annotated[float, quantity("g/cm^3", gt=0, le=25)] | None = Field(
        default=None, description="density, if it differs from the usual one"
    )
    infill: Annotated[float, quantity("1", gt=0, le=1)] = Field(
        default=1.0,
        description="share of a part's volume that is material: in prints walls and infill together, often 0.3 to 0.6; with 1 the weight "
        "is on the safe side",
    )


class Files(Record):
    """How files are written."""

    curves: Literal["bulge", "lines", "arcs", "spline"] = Field(
        default="bulge",
        description='curves in the DXF: "bulge" for polylines with arcs; for programs that cannot read these: "lines" for chords, "arcs" '
        'for single lines and arcs, "spline" for a spline for each contour',
    )
    center_marks: bool = Field(default=False, description="true: centre marks on the layer CENTER")
    engrave: bool = Field(
        default=False, description="true: the DXF also has the engraving, on the layer ENGRAVE"
    )
    hole_letters: bool | None = Field(
        default=None,
        description="true: the links of a linkage carry the letters of their holes, engraved 0.4 mm deep",
    )
    up_marks: bool = Field(
        default=True,
        description="true: UP is engraved on the upper side of a machine's cam, wheel or crank that would also fit upside down",
    )
    step: bool | None = Field(
        default=None,
        description="true: a build without --only also makes exact solids (STEP); default: true for metals",
    )
    profile_step_deg: Annotated[float | None, quantity("deg", ge=0.01, le=90)] = Field(
        default=None,
        description="angle from row to row in a table of a cam's radius, normal and curvature; default: no table",
    )
    cutter_radius: Annotated[float | None, quantity("mm", gt=0, le=1000)] = Field(
        default=None,
        description="radius of a cutter: camgen draws the path of its centre round each cam; default: no path",
    )

    @property
    def machining(self) -> bool:
        """Whether tables for machine tools are asked for."""
        return self.profile_step_deg is not None or self.cutter_radius is not None


Fit = Literal["H6", "H7", "H8", "H9", "H11", "G6", "G7", "F7", "F8"]
_SAID = r"^[ -~°±µØ×]+$"


def said(most: int) -> Any:
    """A text of people on a drawing."""
    return text_of_form(f"a text of up to {most} letters, digits and signs", _SAID, most)


class Drawing(Record):
    """What the dimensioned drawings show besides the shapes."""

    tolerance: (
        Annotated[
            str,
            text_of_form(
                'general tolerance: "ISO 2768-f", "-m", "-c" or "-v", with H, K or L behind it for form and place',
                r"^ISO 2768-[fmcv][HKL]?$",
            ),
        ]
        | None
    ) = Field(
        default=None,
        description='general tolerance of ISO 2768: f, m, c or v, then H, K or L for form and position; default: "ISO 2768-mK" in metal, '
        'else "ISO 2768-m"',
    )
    number: (
        Annotated[
            str,
            text_of_form(
                "a text of up to 30 letters, digits and signs", r"^[!-~]([ -~]{0,28}[!-~])?$"
            ),
        ]
        | None
    ) = Field(
        default=None,
        description='number of the drawings: "K-104" gives K-104-01, K-104-02 and so on; default: the names of their files',
    )
    date: (
        Annotated[
            str,
            text_of_form(
                'a date such as "2026-05-31"', r"^\d{4}-(0[1-9]|1[0-2])-(0[1-9]|[12]\d|3[01])$"
            ),
            BeforeValidator(
                lambda value: value.isoformat() if type(value) is date else value
            ),  # as TOML has them
        ]
        | None
    ) = Field(
        default=None,
        description="date of the drawings; default: none, so that the same spec gives the same files on any day",
    )
    position: Annotated[float, quantity("mm", ge=0, le=5)] | None = Field(
        default=None,
        description="position tolerance of holes: the diameter within which their axes must lie (ISO 1101); 0: not shown; default: 0.2, in "
        "metal 0.05, and for dowels that carry a track in metal at most profile",
    )
    profile_step_deg: Annotated[float, quantity("deg", ge=5, le=90)] = Field(
        default=10.0, description="angle from row to row in a cam's table of radii on the drawings"
    )
    bore_fit: Fit | None = Field(
        default=None,
        description='fit of a bore on its shaft (ISO 286), such as "H7"; default: "H7" in metal, else none',
    )
    key_fit: Literal["P9", "JS9", "N9"] | None = Field(
        default=None,
        description='fit of a keyway\'s width: "P9" tight, "JS9" light; default: "JS9" in metal, else none',
    )
    seat_fit: Fit | None = Field(
        default=None,
        description='fit of holes into which dowels and bearings are pressed; default: as bore_fit, but "JS7" for ball bearings in metal',
    )
    profile: Annotated[float, quantity("mm", gt=0, le=1)] | None = Field(
        default=None,
        description="tolerance of a cam's track: the width of its zone (line profile, ISO 1101); default: 0.05 in metal, else none",
    )
    roughness: Annotated[float, quantity("um", gt=0, le=100)] | None = Field(
        default=None,
        description="Ra of a cam's track, or of a Geneva wheel's slots and its lock; default: in metal 0.8 and 1.6, else not shown",
    )
    bore_roughness: Annotated[float, quantity("um", gt=0, le=100)] | None = Field(
        default=None,
        description="Ra of a cam's bore; default: 1.6 in metal (a reamed bore), else not shown",
    )
    symmetry: Annotated[float, quantity("mm", ge=0, le=1)] | None = Field(
        default=None,
        description="symmetry of a keyway about its bore (ISO 1101); 0: not shown; default: 0.04 in metal, else not shown",
    )
    run_out: Annotated[float, quantity("mm", ge=0, le=1)] | None = Field(
        default=None,
        description="run-out about the bore (ISO 1101) of a cam's face at z = 0, or of a cylinder cam's ends and outside; 0: not shown; "
        "default: 0.03 in metal, else not shown",
    )
    bore_chamfer: Annotated[float, quantity("mm", ge=0, le=5)] | None = Field(
        default=None,
        description="chamfer at 45 deg at both ends of a cam's bore, on the drawing only, not in the other files; 0: none; default: in "
        "metal 0.5 up to a bore of 10, 1 up to 40, 1.5 above; else none",
    )
    roughness_elsewhere: Annotated[float, quantity("um", gt=0, le=100)] | None = Field(
        default=None, description="Ra of all other faces; default: 3.2 in metal, else not shown"
    )
    edges: Annotated[str, said(60)] | None = Field(
        default=None,
        description='state of edges; default: "broken 0.2 to 0.4, ISO 13715" in metal, else not shown',
    )
    heat_treatment: Annotated[str, said(60)] | None = Field(
        default=None,
        description='heat treatment, such as "case hardened 60+4 HRC, CHD 0.8+0.4"; default: the treatment that the material needs to bear '
        "its load, if any, for what rolls, slides or is a pin, a roller in slots of C45 or 42CrMo4 harder than these; for 16MnCr5 only where a follower runs",
    )
    protection: Annotated[str, said(60)] | None = Field(
        default=None,
        description='protection against rust, such as "black oxide, oiled"; default: "oiled against rust" for parts of C45, 42CrMo4 '
        "and 16MnCr5, else not shown",
    )
    revision: Annotated[str, said(8)] | None = Field(
        default=None, description="revision of the drawings, in the title block"
    )
    drawn_by: Annotated[str, said(30)] | None = Field(
        default=None, description="name of the person who drew it, in the title block"
    )
    checked_by: Annotated[str, said(30)] | None = Field(
        default=None, description="name of the person who checked it, in the title block"
    )


class Laser(Record):
    """Beam and sheet for flat parts."""

    kerf: Annotated[float, quantity("mm", ge=0, le=5)] = Field(
        default=0.15, description="width of the beam"
    )
    thickness: Length = Field(default=3.0, description="thickness of the sheet")
    sheet: tuple[Length, Length] = Field(
        default=(600.0, 400.0), description="width and height of the sheet"
    )
    gap: Annotated[float, quantity("mm", ge=0, le=100)] = Field(
        default=2.0, description="gap between neighbouring parts; half of it to the sheet's edge"
    )


class Checked(Record):
    """A record that `validate` makes: its keys are judged one by one, then together."""

    old_words: ClassVar[OldWords] = {}

    _hints: tuple[str, ...] = PrivateAttr(())
    _filled: frozenset[str] = PrivateAttr(frozenset())  # keys of which another table decides a part

    @classmethod
    def wording(cls, data: Data) -> Wording:
        """The tables in the words of today."""
        return wording(data, cls.old_words)

    @classmethod
    def filled(cls, data: Any) -> Any:
        """The tables with what one of them decides in another, where that leaves it open."""
        return data

    @property
    def hints(self) -> tuple[str, ...]:
        """What to tell of keys that were read in another spelling."""
        return self._hints

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one; `validate` lists it with the rest."""
        return ()

    def faults_beside(self, before: Checked, changed: Collection[str]) -> Sequence[Fault]:
        """What is wrong beside a record without faults, of which some tables were changed."""
        return self.faults()


DEVICES = r"con|prn|aux|nul|(com|lpt)\d"  # names that no file or folder of Windows can have


def _no_device(name: str) -> str:
    if re.fullmatch(DEVICES, name):
        raise ValueError(
            "another name: no folder of Windows can have this one, which is a device's"
        )
    return name


class Spec(Checked):
    """The tables that every mechanism has; `mechanism` picks the class, `name` the output folder and file prefix."""

    old_words: ClassVar[OldWords] = {("output",): ("files",)}

    mechanism: str = Field(description="the kind of machine, see camgen list")
    name: Annotated[
        str,
        text_of_form(
            "a name of small letters a-z, digits and hyphens, at most 60",
            r"^[a-z0-9-]+$",
            60,
        ),
        AfterValidator(_no_device),
    ] = Field(description="output folder and file prefix: a-z, 0-9, -")
    print: Print = Field(
        default=Print.model_construct(), description="your printer, and the fits that it needs"
    )
    material: Material = Field(
        default=Material.model_construct(),
        description="material that you print with, or cut parts from",
    )
    accuracy: Accuracy = Field(
        default=Accuracy.model_construct(), description="how exact the outlines in the files are"
    )
    files: Files = Field(default=Files.model_construct(), description="how files are written")
    drawing: Drawing = Field(
        default=Drawing.model_construct(),
        description="what the dimensioned drawings show besides the shapes",
    )
    laser: Laser | None = Field(
        default=None,
        description="flat parts cut from sheet: with this table a whole build lays out the sheets (SVG, "
        "DXF)",
    )

    @cached_property
    def source_tables(self) -> Data:
        """Its tables as they were given; of a spec that was made without them with every default."""
        tables: Data = _lists(self.model_dump(by_alias=True, exclude_none=True))
        return tables


def _lists(value: Any) -> Any:
    """The value with lists in place of tuples, as tables have them."""
    if isinstance(value, dict):
        return {key: _lists(item) for key, item in value.items()}
    return [_lists(item) for item in value] if isinstance(value, tuple | list) else value


S = TypeVar("S", bound=Checked)

# ---- checking --------------------------------------------------------------------------------------------------------


_NEAR = 0.8  # likeness of a key to one that is not known, where another table has that very key
_OTHER_BEGINNING = (
    0.75  # likeness of names that do not begin alike, where one may stand for the other
)


def unknown(path: Key, value: object, known: Iterable[str], kind: str = "") -> Fault:
    """Fault for a value that is none of the known names, with those that it may mean; kind: of the value, unless its key says it."""
    names = sorted(known)
    kind = kind or kind_of(path)
    given = "" if value is None else shown(value)
    meant = likely(kind, value, names)
    if len(meant) > 1:
        others = ", ".join(shown(name) for name in names if name not in meant)
        elsewhere = other_key(kind, value)
        ends = (f"or of {others}" if others else "", elsewhere)
        return Fault(path, given, "; ".join((one_of(meant), *filter(None, ends))))
    if new := example(kind, value):
        return Fault(path, given, f"'linkage': camgen new {new} FILE writes such a one")
    texts = [each for each in names if isinstance(each, str)]  # a literal may be a number
    nearest = meant or (_alike(value, texts) if isinstance(value, str) else ())
    return Fault(path, given, one_of(names), nearest[0] if nearest else None)


_SIZED = re.compile(r"([A-Za-z-]+)(\d+)")  # a name of a catalogue, such as KR16
_TWICE = re.compile(r"(\d)\1")  # a digit that was typed twice


def _alike(value: str, names: Sequence[str]) -> Sequence[str]:
    """The name that a person may have meant: without a digit typed twice, of a catalogue's the one with the nearest number, else the
    nearest in spelling.

    A name that begins otherwise has to be nearer: "rolling" does not mean oscillating.
    """
    once = _TWICE.sub(r"\1", value)  # H7 for H77
    if once in names:
        return [once]
    sized = _SIZED.fullmatch(value)
    if sized is not None:
        sizes = {
            name: abs(int(each[2]) - int(sized[2]))
            for name in names
            if (each := _SIZED.fullmatch(name)) and each[1].lower() == sized[1].lower()
        }
        if sizes:
            return [min(sizes, key=lambda name: sizes[name])]
    near = get_close_matches(value, names, 1)
    same = near and near[0][:1].lower() == value[:1].lower()
    return near if same else get_close_matches(value, names, 1, _OTHER_BEGINNING)


def choose(data: Data, known: Collection[str], source: str = "spec") -> str:
    """Name of the mechanism that the tables ask for.

    SpecError where it is missing or not known, together with the faults of the tables that every mechanism shares.
    """
    name = data.get("mechanism")
    if isinstance(name, str) and name in known:
        return name
    fault = unknown(("mechanism",), name, known)
    faults = [replace(fault, expected=f"missing: {fault.expected}") if name is None else fault]
    tables = wording(data, Spec.old_words).data
    shared = {key: tables[key] for key in tables if key in Spec.model_fields} | {"mechanism": ""}
    try:
        validate(Spec, shared, source)
    except SpecError as error:
        faults += error.faults
    raise SpecError(faults, source)


def validate(
    cls: type[S],
    data: Data,
    source: str = "spec",
    hints: tuple[str, ...] = (),
    like: tuple[Data, Spec] | None = None,
) -> S:
    """The tables as a record of the class; SpecError with every fault at once, each by its dotted path.

    A key in the other of American and British spelling, or by an old word, is taken for the one that is meant; hints: what is
    told of such.
    like: tables and the record that was made of them: what is the same object in both tables is not checked again.
    """
    words = cls.wording(data)
    before = None
    if like is None:
        hints = (*hints, *_other_units(cls, words.data))
    else:
        before = (cls.wording(like[0]).data, like[1])
    try:
        return _checked(cls, words.data, (*hints, *words.notes), before)
    except SpecError as error:
        faults = list(map(words.as_typed, error.faults))
    raise SpecError(faults, source)


def _other_units(cls: type[Checked], data: Data) -> Iterator[str]:
    """A sentence for each number that looks as if it were in radians, metres or grams, and is read in degrees, mm or kg.

    Radians: a multiple of 5 degrees, to the last of at least three decimals. Metres: below 0.05 mm where a thousand times as
    much is at most ten times the longest of the spec; what is small by its nature, as a tolerance is, is left alone.
    """
    root = _json_schema(cls)
    units: dict[Key, str] = {}  # by keys without places in lists, of which there may be thousands
    numbers = []
    for path, value in _numbers(data):
        names = tuple(step for step in path if isinstance(step, str))
        if names not in units:
            units[names] = unit_of(_locate(path, data, root)[1] or {}) or ""
        numbers.append((path, value, units[names]))
    largest = max((abs(value) for _, value, unit in numbers if "mm" in unit.split()), default=0)
    for path, value, unit in sorted(numbers, key=lambda row: dotted(row[0])):
        key = f"{dotted(path)} = {value:g}"
        if unit == "deg":
            decimals = len(repr(abs(value)).partition(".")[2])
            known = 5 * round(math.degrees(value) / 5)
            if (
                known
                and decimals >= 3
                and abs(value - math.radians(known)) <= 0.51 * 10.0**-decimals
            ):
                yield f"{key} is read in degrees; {value:g} rad are {known} deg"
        elif "mm" in unit.split() and 0 < value < _TINY and not _is_small(path):
            if 1e3 * value <= 10 * largest:
                yield f"{key} is read in mm; {value:g} m are {1e3 * value:g} mm"
        elif unit == "kg" and value >= _MASSIVE:
            yield f"{key} is read in kg; {value:g} g are {1e-3 * value:g} kg"


def _is_small(path: Key) -> bool:
    """Whether a length is small by its nature, as a tolerance is, by its own name or its table's."""
    return any(_SMALL.search(str(step)) for step in (path[0], path[-1]))


def _numbers(tables: Any, path: Key = ()) -> Iterator[tuple[Key, float]]:
    """All finite numbers in tables and lists, each with its key."""
    if isinstance(tables, dict | list):
        for step, value in tables.items() if isinstance(tables, dict) else enumerate(tables):
            yield from _numbers(value, (*path, step))
    elif isinstance(tables, int | float) and abs(tables) < 1e300 and tables is not True:
        yield path, tables


def _checked(
    cls: type[S], data: Data, hints: tuple[str, ...], like: tuple[Data, Spec] | None = None
) -> S:
    """The tables in the words of today as a record; see `validate`."""
    old, made = like if like is not None and type(like[1]) is cls else ({}, None)
    filled = cls.filled(data)
    if made is not None and made._filled:  # what another table has filled is not taken over
        old = {key: value for key, value in old.items() if key not in made._filled}
    try:
        record = cls.model_validate(_tuples(filled, old, made))
    except ValidationError as error:
        if made is not None:
            return _checked(cls, data, hints)
        told = _respell(cls, data := deepcopy(data), error)
        if told:
            return _checked(cls, data, (*hints, *told))
        wrong = _faults(cls, data, error)
        raise SpecError([*wrong, *_further(cls, data, wrong)]) from None
    _fix(record)
    record._hints = hints
    if filled is not data:
        record._filled = frozenset(key for key in filled if filled[key] is not data.get(key))
    if made is None:
        faults = record.faults()
    else:
        changed = {key for key in {*data, *old} if data.get(key) is not old.get(key)}
        faults = record.faults_beside(made, changed)
    if faults and made is not None:
        return _checked(cls, data, hints)  # a dwell may have taken the rest of another turn
    if faults:
        raise SpecError(faults)
    return record


def _further(cls: type[Checked], data: Data, faults: Sequence[Fault]) -> list[Fault]:
    """Faults between the keys, beside those of keys one by one: of the tables as they are meant; none where that is not known."""
    tables = deepcopy(data)
    unread = set()  # tables of which a key may mean another one
    guessed = False  # whether a value of the machine's own stands in for a wrong one
    for fault in faults:
        holder = _at(tables, fault.path[:-1])
        if not isinstance(holder, dict):
            return []
        value = holder.pop(fault.path[-1], None)
        if fault.nearest is not None and "." not in fault.nearest:
            name = (fault.path[-1], fault.nearest)[fault.unknown]
            holder.setdefault(name, value if fault.unknown else fault.nearest)
        elif fault.unknown:
            unread.add(fault.path[:-1])
        elif fault.path[0] not in _BESIDE:
            if fault.path[0] == _PROGRAM:
                return []
            guessed = True
            holder[fault.path[-1]] = _any_right(fault.path, data, _json_schema(cls))
    try:
        found = cls.model_validate(_tuples(cls.filled(tables))).faults()
    except (CamgenError, ValidationError):
        return []
    told = {fault.path[:k] for fault in faults for k in range(1, len(fault.path) + 1)}
    return [
        each
        for each in found
        if each.path not in told
        and each.path[:-1] not in unread
        and (each.path[0] == _PROGRAM or not guessed)
    ]


def _any_right(path: Key, data: Data, root: Data) -> Any:
    """A value that a key may have: its default, the first of its names, or a number that its bounds let through; None: none is known."""
    node = _locate(path, data, root)[1] or {}
    if "default" in node:
        return node["default"]
    for each in members_of(node, root):
        if names := each.get("enum"):
            return names[0]
        if each.get("type") in ("number", "integer"):
            return min(max(1, each.get("minimum", 1)), each.get("maximum", 1e6))
    return None


def _respell(cls: type[Checked], data: Data, error: ValidationError) -> list[str]:
    """Rename what is unknown in one spelling and known in the other, or in other capitals; what to tell of it."""
    root = _json_schema(cls)
    told = list[str]()
    for item in error.errors(include_url=False):
        if item["type"] == "literal_error" and isinstance(item["input"], str):
            path, node, _ = _locate(item["loc"], data, root)
            holder = _at(data, path[:-1])
            names = [name for each in members_of(node or {}, root) for name in each.get("enum", ())]
            same = [name for name in names if str(name).lower() == item["input"].lower()]
            if len(same) == 1 and isinstance(holder, dict):
                holder[path[-1]] = same[0]
                told.append(f"{dotted(path)} = {shown(item['input'])} is read as {shown(same[0])}")
        if item["type"] == "extra_forbidden":
            path, _, table = _locate(item["loc"], data, root)
            holder = _at(data, path[:-1])
            name = other_spelling(str(path[-1]), keys_of(table, root))
            if name and isinstance(holder, dict) and name not in holder:
                holder[name] = holder.pop(path[-1])
                told.append(f"{'.'.join(map(str, path))} is read as {name}")
    return told


def _plain(value: float) -> float:
    """The value; 0 for -0 and for what is smaller than any normal float."""
    return 0.0 if abs(value) < sys.float_info.min else value


def _tuples(value: Any, old: Any = None, made: Any = None) -> Any:
    """The value with every list as a tuple, as frozen records hold them; what is `old` itself as the record made of it.

    -0 becomes 0, which it equals: results that are kept for equal records are to be the same to the bit. So does what is smaller
    than any normal float: of such numbers some functions make errors.
    """
    if value is old and made is not None:
        return made
    if isinstance(value, dict):
        if not (isinstance(made, Record) and isinstance(old, dict)):
            return {key: _tuples(item) for key, item in value.items()}
        names = _names(type(made))
        return {
            key: _tuples(item, old[key], getattr(made, names[key]))
            if key in old and key in names
            else _tuples(item)
            for key, item in value.items()
        }
    if not isinstance(value, list):
        return _plain(value) if isinstance(value, float) else value
    if isinstance(old, list) and isinstance(made, tuple) and len(value) == len(old) == len(made):
        return tuple(map(_tuples, value, old, made))
    return tuple(map(_tuples, value))


@lru_cache
def _names(cls: type[Record]) -> dict[str, str]:
    """A table's keys, and what its record calls them."""
    return {field.alias or name: name for name, field in cls.model_fields.items()}


@lru_cache
def _json_schema(cls: type[Checked]) -> Data:
    """The class's schema, to look things up in."""
    return cls.model_json_schema()


def _faults(cls: type[Checked], data: Data, error: ValidationError) -> list[Fault]:
    """pydantic's errors in plain words, one for each place, in the order of the places' first mention."""
    root = _json_schema(cls)
    found: dict[Key, Fault] = {}
    for item in error.errors(include_url=False):
        key = item["loc"][-1:] == ("[key]",)  # of a table whose keys are names
        loc = _whole(item["loc"][: -1 if key else None], data, root)
        path, node, table = _locate(loc, data, root)
        expected = in_words(node, root)
        nearest = None
        keys = list(keys_of(table, root))
        value = _at(data, path)
        tables = all(each.get("type") == "object" for each in members_of(node or {}, root))
        # where names of tables are free, beside keys
        other = path and keys and path[-1] not in keys
        misspelt = bool(other) and tables and not isinstance(value, dict | list)
        no_such = item["type"] == "extra_forbidden" or misspelt
        if no_such:  # a union's other tables may know it
            nearest, expected = _no_such(path, value, keys, root)
        elif key:
            held = members_of(_locate(item["loc"][:-2], data, root)[1] or {}, root)
            expected = next(
                (each["propertyNames"]["form"] for each in held if "propertyNames" in each),
                "another name",
            )
        elif item["type"] == "missing":
            beside = _at(data, path[:-1])
            extra = (
                [key for key in beside if key not in keys_of(table, root)]
                if isinstance(beside, dict)
                else []
            )
            close = get_close_matches(str(path[-1]), map(str, extra), 1)
            expected = _needed(node, root) or _described(node, expected)
            expected = f"missing: {expected}" + (f" ('{close[0]}' is no key)" if close else "")
        elif (
            item["type"] not in get_args(ErrorType) or node is None
        ):  # a class's own check brings its own words
            expected = item["msg"]
        elif item["type"] == "value_error":
            expected = str(item["ctx"]["error"])
        names = [name for each in members_of(node or {}, root) for name in each.get("enum", ())]
        if names and isinstance(value, str | float) and not (no_such or key):
            alike = unknown(tuple(path), value, names)
            nearest = alike.nearest
            own = item["type"] == "value_error" or item["type"] not in get_args(ErrorType)
            expected = expected if nearest or own or isinstance(value, float) else alike.expected
        meant = "" if node is None or no_such or key else _meant(path, value, node, root)
        expected = meant or expected
        if (
            item["type"] == "too_short"
            and isinstance(value, list | tuple)
            and len(value) >= item["ctx"]["min_length"]
        ):
            continue  # items of it were wrong, told by themselves, and are not counted
        given = "" if item["type"] == "missing" or key else shown(value)
        if meant and isinstance(value, dict):
            given = "a table"
        if item["type"] in ("too_long", "too_short") and isinstance(value, list):
            given = f"a list of {len(value)}"
        found.setdefault(
            tuple(path),
            Fault(tuple(path), given, expected, nearest, "" if path else "spec", no_such),
        )
    return list(found.values())


def _no_such(
    path: Sequence[str | int], value: object, keys: Sequence[str], root: Data
) -> tuple[str | None, str]:
    """The key that is meant by one that a table, with these keys, does not have, and what else to say."""
    name = str(path[-1])
    keys = [each for each in keys if each != name]
    radius = re.sub("diameter$", "radius", name)
    if radius != name and radius in keys and isinstance(value, int | float) and abs(value) < 1e9:
        return None, f"{UNKNOWN}; write {radius} = {value / 2:g}, which is half of it"
    called = likely_key(name, keys)
    close = called or get_close_matches(name, keys, 1)
    words = (
        name,
        *(() if called else other_words(name)),
        *(value if isinstance(value, dict) else ()),
    )
    elsewhere = next(filter(None, (_in_others(key, path, root) for key in words)), [])
    if len(path) > 1:
        close = called or get_close_matches(name, keys, 1, _NEAR if elsewhere else 0.6)
        meant = [*close, *elsewhere]
    elif isinstance(value, dict | list):
        meant = close or elsewhere
    else:  # without its table
        meant = elsewhere or close
    meant = meant or _longer(name, keys)
    if len(meant) > 1:
        return None, f"{UNKNOWN}; did you mean {_any_of(meant)}?"
    return next(iter(meant), None), f"{UNKNOWN}; known here: {', '.join(keys)}"


def _described(node: Data | None, expected: str) -> str:
    """What a key is that is missing, and what its value has to be."""
    described = (node or {}).get("description", "").partition("\n")[0]
    return f"{described} ({expected})" if described else expected


def _needed(node: Data | None, root: Data) -> str:
    """What a table has to have, of which other keys may be left out; "" of all else."""
    for member in members_of(node or {}, root):
        needed = member.get("required", ())
        if (
            needed
            and "form" not in {**(node or {}), **member}
            and len(needed) < len(member.get("properties", ()))
        ):
            listed = " and ".join(filter(None, [", ".join(needed[:-1]), needed[-1]]))
            return f"a table with {listed}; other keys may be left out"
    return ""


def _in_others(name: str, path: Sequence[str | int], root: Data) -> list[str]:
    """A key as other tables than the one at a path have it: speed_rpm as drive.speed_rpm, lift as segment.0.lift."""
    found = [name] if name in keys_of(root, root) else []
    for table, node in keys_of(root, root).items():
        tables = {f"{table}.{key}": each for key, each in keys_of(node, root).items()}
        if f"{table}.{name}" in tables:
            found.append(f"{table}.{name}")
        elif name in keys_of(step_below(node, 0, root), root):
            found.append(f"{table}.0.{name}")
        else:
            found += [f"{key}.{name}" for key in tables if name in keys_of(tables[key], root)]
    return [key for key in found if key != dotted(tuple(path))]


def _any_of(keys: Sequence[str]) -> str:
    """Keys of which one is meant, at most five of them."""
    quoted = [f"'{key}'" for key in keys[:5]]
    return f"{', '.join(quoted[:-1])} or {quoted[-1]}"


def _longer(name: str, keys: Sequence[str]) -> list[str]:
    """The shortest key that holds a name: rpm as speed_rpm."""
    return sorted((key for key in keys if len(name) > 2 and name in key), key=len)[:1]


_TINY = 0.05  # mm, less than any size of a part
_SMALL = re.compile(
    "tolerance|clearance|allowance|play|lash|kerf|error|gap|offset|step|caliper|^drawing$"
)
_MASSIVE = 100.0  # kg, more than what a machine of this size moves
_NUMBER = re.compile(r"([+-]?\d+(?:[.,/]\d+)?)\s*(\S*)")
_FIGURE = re.compile(r"[+-]?\d+(?:\.\d+)?")
_LISTED = re.compile(
    r"[\[(]?\s*[+-]?[\d.]+(?:\s*[,; x]\s*[+-]?[\d.]+)+\s*[\])]?"
)  # numbers as a text
_WORDS = re.compile(r"[A-Za-z]\w*(?:\s*[-,; ]\s*[A-Za-z]\w*)+")  # such as two points
_FIT = re.compile(r"[A-Za-z]{1,2}\d{1,2}")  # of ISO 286, such as H7
# What a number is in and how people write that, with the size of each.
_UNITS: dict[str, tuple[str, dict[str, float]]] = {
    "mm": (
        "lengths are in mm",
        {"mm": 1, "cm": 10, "m": 1000, "um": 1e-3, "in": 25.4, "inch": 25.4, '"': 25.4},
    ),
    "deg": ("angles are in degrees", {"deg": 1, "°": 1, "rad": math.degrees(1)}),
    "rpm": ("speeds are in rpm", {"rpm": 1, "1/min": 1, "1/s": 60}),
    "g": ("masses are in g", {"g": 1, "kg": 1000}),
}


def _scalar(node: Data) -> bool:
    """Whether a key takes no table."""
    kinds = {each.get("type") for each in (node, *node.get("anyOf", ()))}
    return not kinds & {"object", None}


def _meant_list(value: object, node: Data) -> str:
    """What to write in place of a list that is a text, of a text in a list, of decimal commas in one, or of a square's side; or "" """
    sides = node.get("prefixItems", ())
    if (
        isinstance(value, int | float)
        and not isinstance(value, bool)
        and len(sides) == 2
        and all(0 < each.get("minimum", 0) <= value <= each.get("maximum", 0) for each in sides)
    ):
        return f"a list of two sizes: write [{value:g}, {value:g}]"
    if isinstance(value, list) and len(node.get("prefixItems", ())) + 1 == len(value) == 3:
        a, b, c = map(str, value)
        if f"{a}{b}{c}".lstrip("-").isdigit() and b.isdigit():
            return f"two numbers: write [{a}, {b}], or with decimal points [{a}.{b}, {c}] or [{a}, {b}.{c}]"
    if isinstance(value, list) and node.get("type") == "string" and list(map(type, value)) == [str]:
        return f'text, no list: write "{value[0]}"'
    if not isinstance(value, str) or node.get("type") != "array":
        return ""
    if _LISTED.fullmatch(value):
        return f"a list without quotes: write [{', '.join(_FIGURE.findall(value))}]"
    words = ", ".join(f'"{each}"' for each in re.findall(r"\w+", value))
    return f"a list: write [{words}]" if _WORDS.fullmatch(value) else ""


def _meant_table(value: object, node: Data, root: Data) -> str:
    """What to write in place of a number that is to be a table, in which it has a key; or "" """
    for member in members_of(node, root) if isinstance(value, int | float) else ():
        needed = member.get("required", ())
        if "value" in needed and not isinstance(value, bool):
            keys = (f"{key} = {value:g}" if key == "value" else f"{key} = ..." for key in needed)
            return f"a table: write {{ {', '.join(keys)} }}"
    return ""


def _decimal(text: str) -> str:
    """A number with a comma, or a ratio, as TOML has it."""
    whole, _, part = text.replace(",", ".").partition("/")
    return f"{float(whole) / (float(part) or 1.0):.6g}" if part else whole


def _meant(path: Sequence[str | int], value: object, node: Data, root: Data) -> str:
    """What to write in place of a number that is a text, perhaps with its unit, or of a table that is to be a list; or "" """
    if isinstance(value, dict) and "array" in {
        each.get("type") for each in (node, *node.get("anyOf", ()))
    }:
        return f"a list: begin each row with [[{dotted(path)}]]"
    if isinstance(value, dict) and path[:-1] == ["parts"] and _scalar(node):
        return f"a value: {path[-1]} is a key of [parts]; a link of that name needs another one"
    if path == ["name"] and isinstance(value, str):
        plain = re.sub(r"[^a-z0-9]+", "-", value.lower()).strip("-")[:60].strip("-")
        return f'{in_words(node, node)}: write "{plain}"' if plain not in ("", value) else ""
    if path[-1] in ("lift", "lift_deg") and isinstance(value, int | float) and value < 0:
        return f'a number above 0: kind = "return" with {path[-1]} = {-value:g} goes back'
    if said := _meant_list(value, node) or _meant_table(value, node, root):
        return said
    unit = unit_of(node)
    if isinstance(value, bool) and unit and _scalar(node):
        return f"{in_words(node, root)}, in {unit}"
    least = max((each.get("minimum", 0.0) for each in members_of(node, root)), default=0.0)
    if unit == "mm" and isinstance(value, int | float) and 0 < value < least <= 1e3 * value:
        return f"{in_words(node, root)}; lengths are in mm: {1e3 * value:.6g}?"
    found = _NUMBER.fullmatch(value.strip()) if isinstance(value, str) and unit else None
    if found is None or unit is None:
        return ""
    number = _decimal(found[1])
    written = found[2]
    if not written:
        right = "with a decimal point" if "," in found[1] else "without quotes"
        return f"a number {right}: write {number}"
    if _FIT.fullmatch(written):
        return f"a number without a fit: write {number}; drawing.bore_fit has the fit"
    several = {each: _UNITS.get(each, ("", {each: 1.0})) for each in unit.split(" or ")}
    words = several[unit][0] if unit in several else ""
    words = words or f"it is in {unit}"
    size = next((sizes[written] for _, sizes in several.values() if written in sizes), None)
    if size is None:
        foreign = any(written in sizes for _, sizes in _UNITS.values())
        return f"a number without a unit; {words}" if foreign else ""
    return f"a number without a unit; {words}: write {float(number) * size:.6g}"


def _whole(loc: tuple[int | str, ...], data: Data, root: Data) -> tuple[int | str, ...]:
    """Where an error is told: at the value itself, or at the one round it whose parts say too little, `whole` in the schema."""
    for k in range(1, len(loc)):
        node = _locate(loc[:k], data, root)[1]
        if node is not None and node.get("whole"):
            return loc[:k]
    return loc


def _locate(
    loc: Sequence[str | int], data: Data, root: Data
) -> tuple[list[str | int], Data | None, Data]:
    """Path of an error in the data, the schema of its value (None: no such key) and of the table that holds it.

    pydantic names the member of a union as a step of the path; such a step is in neither data nor schema: left out.
    """
    path: list[str | int] = []
    node: Data | None = root
    table = root
    for depth, step in enumerate(loc):
        below = step_below(node, step, root)
        value = _at(data, path)
        held = step in value if isinstance(value, dict) else isinstance(step, int)
        if below is None and not (held and depth == len(loc) - 1):
            continue
        path.append(step)
        table = node or table
        node = below
    return path, node, table


def _at(data: Any, path: Iterable[str | int]) -> Any:
    """The value at a path; None where there is none."""
    for step in path:
        try:
            data = data[step]
        except (KeyError, IndexError, TypeError):
            return None
    return data


# ---- writing ---------------------------------------------------------------------------------------------------------


def dump(record: Spec) -> str:
    """The spec as TOML with every default filled in; read again it gives an equal record and the same text.

    Arrays that fit stand on one line.
    """
    import tomli_w

    lines = iter(tomli_w.dumps(record.model_dump(by_alias=True, exclude_none=True)).splitlines())
    return "".join(f"{line if line[-1:] != '[' else _array(line, lines)}\n" for line in lines)


def _array(opened: str, lines: Iterator[str]) -> str:
    """An array that tomli_w spreads over lines, of which the first is read: on one line where it fits, and whole in any case."""
    items = []
    ends = ("]", "],")
    while (line := next(lines)).strip() not in ends:
        items.append(line if line[-1] != "[" else _array(line, lines))
    short = opened + ", ".join(item.strip().removesuffix(",") for item in items) + line.strip()
    return short if len(short) <= _WIDE and "\n" not in short else "\n".join([opened, *items, line])


def schema(cls: type[Spec], mechanism: str | None = None) -> Data:
    """JSON Schema (2020-12) of a spec; with a mechanism's name, of that one only.

    Each key has what its field says of it, a table the first line of its class where its field says nothing; each number
    its unit. Each call gives one of its own.
    """
    found: Data = json.loads(_schema(cls, mechanism))
    return found


def _keys_beside(word: Sequence[str], found: Data) -> list[Data]:
    """The keys of each table of a schema in which a word of a spec may stand."""
    holders = [found] if len(word) == 1 else tables_of(found["properties"][word[0]], found)
    return [holder["properties"] for holder in holders]


@cache
def _schema(cls: type[Spec], mechanism: str | None) -> str:
    found: Data = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **cls.model_json_schema(),
    }
    if mechanism is not None:
        found["properties"]["mechanism"]["const"] = mechanism
    for old, new in cls.old_words.items():
        if len(old) == 3:
            continue
        meant = next(keys for keys in _keys_beside(new, found) if new[-1] in keys)[new[-1]]
        for keys in _keys_beside(old, found):
            if old[-1] not in keys:
                said = f"another name of {dotted(new)}"
                keys[old[-1]] = {**meant, "description": said, "deprecated": True}
    for table in (found, *found["$defs"].values()):
        for node in table.get("properties", {}).values():
            unit = unit_of(node)
            if unit is not None:
                node["unit"] = unit
            for each in tables_of(node, found) + tables_of(step_below(node, "a", found), found):
                if "description" in each:
                    node.setdefault("description", each["description"].partition("\n")[0])
    return json.dumps(found)
