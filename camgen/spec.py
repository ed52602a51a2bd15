"""Spec files: the tables that all mechanisms share, and the way from plain tables to a checked record and back to TOML.

choose    data -> name of the mechanism
validate  data -> record of a mechanism's class, or SpecError with every fault
dump      record -> TOML with every default filled in
schema    class -> JSON Schema, for editors
"""

from __future__ import annotations

import re
import sys
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import replace
from datetime import date
from difflib import get_close_matches
from functools import lru_cache
from typing import Annotated, Any, ClassVar, Literal, TypeVar, get_args

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

from camgen.errors import UNKNOWN, Fault, Key, SpecError
from camgen.reading import Data
from camgen.schemas import in_words, keys_of, members_of, one_of, other_spelling, shown, step_below

_WIDE = 110  # characters of a line of TOML

# of a number, told by its schema
MM = {"unit": "mm"}
SHARE = {"unit": "1"}
Length = Annotated[
    float, Field(ge=1e-3, le=1e6, json_schema_extra=MM)
]  # a thousandth is less than any workshop makes
Mass = Annotated[float, Field(gt=0, le=1e6, json_schema_extra={"unit": "g"})]
Clearance = Annotated[float, Field(ge=0, le=10, json_schema_extra=MM)]
Spread = Annotated[float, Field(ge=0, le=5, json_schema_extra=MM)] | None


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
Rpm = Annotated[
    float, Field(ge=-1e6, le=1e6, json_schema_extra={"unit": "rpm"})
]  # not 0; below 0: clockwise


class Record(BaseModel):
    """A frozen table of a spec: unknown keys, wrong types, nan and inf are faults."""

    # defer_build: a table gets a validator where it is read by itself, not as a part of others; a default is made by
    # model_construct, which needs none
    model_config = ConfigDict(
        frozen=True, extra="forbid", strict=True, allow_inf_nan=False, defer_build=True
    )


class Accuracy(Record):
    """How far the files may be from the exact outline."""

    chord_tolerance: Annotated[float, Field(ge=1e-7, le=0.1)] = 0.001


class Print(Record):
    """What the workshop's printer needs; shared by all mechanisms.

    hole_compensation and profile_compensation: how far the printer's walls come into holes and out of outlines, mm;
    shrinkage: share in the plane; elephant_foot: height and width of a chamfer at the foot, in steps of first_layer, mm.
    They change what is printed (STL, 3MF, plates), not what a laser cuts (DXF) and not the assembly, which shows the print.
    xy_step: of the print head in the plane, mm, by which a slicer may move walls; 80 steps a mm as Marlin's Configuration.h has
    them: 20 teeth of a 2 mm belt a turn of 3,200 microsteps.
    """

    nozzle: Annotated[float, Field(ge=1e-9, le=5)] = 0.4
    slide_clearance: Clearance = 0.2
    press_clearance: Clearance = 0.0
    bed: tuple[Length, Length] = (220.0, 220.0)
    bed_height: Length = 250.0
    bed_margin: Annotated[float | None, Field(ge=0, le=1000)] = None
    hole_compensation: Annotated[float, Field(ge=-2, le=2)] = 0.0
    profile_compensation: Annotated[float, Field(ge=-2, le=2)] = 0.0
    shrinkage: Annotated[float, Field(ge=-0.05, le=0.05)] = 0.0
    elephant_foot: Annotated[float, Field(ge=0, le=2)] = 0.0
    first_layer: Annotated[float, Field(gt=0, le=2)] = 0.2
    layer: Annotated[float | None, Field(ge=0.01, le=2)] = None
    xy_step: Annotated[float, Field(ge=0, le=0.2)] = 0.0125
    size_error: Spread = None
    place_error: Spread = None
    form_error: Spread = None
    form_orders: Orders | None = None


class Material(Record):
    """What is printed with; density in g/cm^3 where it differs from the usual one."""

    name: Literal["PLA", "PETG", "ABS", "ASA", "nylon", "PC"] = "PLA"
    density: Annotated[float, Field(gt=0, le=25)] | None = None
    infill: Annotated[float, Field(gt=0, le=1, json_schema_extra=SHARE)] = 1.0


class Output(Record):
    """How files are written."""

    curves: Literal["bulge", "lines"] = "bulge"
    center_marks: bool = False
    engrave: bool = False
    step: bool | None = None
    profile_step_deg: Annotated[float | None, Field(ge=0.01, le=90)] = None
    cutter_radius: Annotated[float | None, Field(gt=0, le=1000)] = None

    @property
    def machining(self) -> bool:
        """Whether tables for machine tools are asked for."""
        return self.profile_step_deg is not None or self.cutter_radius is not None


class Drawing(Record):
    """What the dimensioned drawings say in their title blocks, and the step of the table of a cam's radii on them."""

    tolerance: Annotated[
        str,
        Field(
            pattern=r"^ISO 2768-[fmcv][HKL]?$",
            description='general tolerance: "ISO 2768-f", "-m", "-c" or "-v", with H, K or L behind it for form and place',
        ),
    ] = "ISO 2768-m"
    number: (
        Annotated[
            str,
            Field(
                pattern=r"^[!-~]([ -~]{0,28}[!-~])?$",
                description="a text of up to 30 letters, digits and signs",
            ),
        ]
        | None
    ) = None
    date: (
        Annotated[
            str,
            Field(
                pattern=r"^\d{4}-(0[1-9]|1[0-2])-(0[1-9]|[12]\d|3[01])$",
                description='a date such as "2026-05-31"',
            ),
            BeforeValidator(
                lambda value: value.isoformat() if type(value) is date else value
            ),  # as TOML has them
        ]
        | None
    ) = None
    position: Annotated[float, Field(ge=0, le=5)] = 0.2
    profile_step_deg: Annotated[float, Field(ge=5, le=90)] = 10.0


class Laser(Record):
    """What cuts flat parts of sheet, mm: kerf of its beam; sheet: width, height; gap between neighbours, half to the edge."""

    kerf: Annotated[float, Field(ge=0, le=5)] = 0.15
    thickness: Length = 3.0
    sheet: tuple[Length, Length] = (600.0, 400.0)
    gap: Annotated[float, Field(ge=0, le=100)] = 2.0


class Checked(Record):
    """A record that `validate` makes: its keys are judged one by one, then together."""

    # by table and word: the key of the same table that it is taken for
    old_words: ClassVar[Mapping[tuple[str, str], str]] = {}

    _hints: tuple[str, ...] = PrivateAttr(())

    @property
    def hints(self) -> tuple[str, ...]:
        """What to tell of keys that were read in another spelling."""
        return self._hints

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one; `validate` lists it with the rest."""
        return ()


def _no_device(name: str) -> str:
    if re.fullmatch(r"con|prn|aux|nul|(com|lpt)\d", name):
        raise ValueError(
            "another name: no folder of Windows can have this one, which is a device's"
        )
    return name


class Spec(Checked):
    """The tables that every mechanism has; `mechanism` picks the class, `name` the output folder and file prefix."""

    mechanism: str
    name: Annotated[
        str,
        Field(
            pattern=r"^[a-z0-9]+(-[a-z0-9]+)*$",
            max_length=60,
            description="a name of small letters a-z, digits and single hyphens between them, at most 60",
        ),
        AfterValidator(_no_device),
    ]
    print: Print = Print.model_construct()
    material: Material = Material.model_construct()
    accuracy: Accuracy = Accuracy.model_construct()
    output: Output = Output.model_construct()
    drawing: Drawing = Drawing.model_construct()
    laser: Laser | None = None


S = TypeVar("S", bound=Checked)

# ---- checking --------------------------------------------------------------------------------------------------------


def unknown(path: Key, value: object, known: Iterable[str]) -> Fault:
    """Fault for a value that is none of the known names, with the nearest of them."""
    names = sorted(known)
    nearest = get_close_matches(value, names, 1) if isinstance(value, str) else []
    return Fault(
        path, "" if value is None else shown(value), one_of(names), nearest[0] if nearest else None
    )


def choose(data: Data, known: Collection[str], source: str = "spec") -> str:
    """Name of the mechanism that the tables ask for.

    SpecError where it is missing or not known, together with the faults of the tables that every mechanism shares.
    """
    name = data.get("mechanism")
    if isinstance(name, str) and name in known:
        return name
    faults = [unknown(("mechanism",), name, known)]
    shared = {key: value for key, value in data.items() if key in Spec.model_fields} | {
        "mechanism": ""
    }
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
    old, made = (
        like if like is not None and type(like[1]) is cls and "laser" not in data else (None, None)
    )  # it fills tables
    data, read, notes = _in_new_words(cls, data)
    if read:
        try:
            return validate(cls, data, source, (*hints, *notes))
        except SpecError as error:
            typed = [replace(each, path=read.get(each.path, each.path)) for each in error.faults]
            raise SpecError(typed, source) from None
    try:
        record = cls.model_validate(_tuples(data, old, made))
    except ValidationError as error:
        if made is not None:
            return validate(cls, data, source, hints)
        told = _respell(cls, data := deepcopy(data), error)
        if told:
            return validate(cls, data, source, (*hints, *told))
        raise SpecError(_faults(cls, data, error), source) from None
    record._hints = hints
    faults = record.faults()
    if faults:
        raise SpecError(faults, source)
    return record


def _respell(cls: type[Checked], data: Data, error: ValidationError) -> list[str]:
    """Rename what is unknown in one spelling and known in the other; what to tell of it."""
    root, told = _json_schema(cls), list[str]()
    for item in error.errors(include_url=False):
        if item["type"] == "extra_forbidden":
            path, _, table = _locate(item["loc"], data, root)
            holder, name = _at(data, path[:-1]), other_spelling(str(path[-1]), keys_of(table, root))
            if name and isinstance(holder, dict) and name not in holder:
                holder[name] = holder.pop(path[-1])
                told.append(f"{'.'.join(map(str, path))} is read as {name}")
    return told


def _in_new_words(cls: type[Checked], data: Data) -> tuple[Data, dict[Key, Key], list[str]]:
    """The tables with old words by the keys that are meant, the old word of each such key, and what to tell of them.

    A table is no old word: where the same name is one, it is left.
    """
    read, notes = dict[Key, Key](), list[str]()
    for (table, word), new in getattr(cls, "old_words", {}).items():
        holder = data.get(table)
        if isinstance(holder, dict) and word in holder and not isinstance(holder[word], dict):
            beside = f", in place of {new} beside it" if new in holder else ""
            notes.append(f"{table}.{word} is read as {new}{beside}")
            data = {**data, table: {**holder, new: holder[word]}}
            del data[table][word]
            read[table, new] = (table, word)
    return data, read, notes


def _plain(value: float) -> float:
    """The value; 0 for -0 and for what is smaller than any normal float."""
    return 0.0 if abs(value) < sys.float_info.min else value


def _tuples(value: Any, old: Any = None, made: Any = None) -> Any:
    """The value with every list as a tuple, as frozen records hold them; what is `old` itself as the record made of it.

    -0 becomes 0, which it equals: results that are kept for equal records are to be the same to the bit. So does what is smaller
    than any normal float: of such numbers some functions make errors.
    """
    if isinstance(value, dict):
        if not (isinstance(made, Record) and isinstance(old, dict)):
            return {key: _tuples(item) for key, item in value.items()}
        if value is old:
            return made
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
        path, node, table = _locate(item["loc"][: -1 if key else None], data, root)
        expected, nearest = in_words(node, root), None
        no_such = item["type"] == "extra_forbidden"
        if no_such:
            keys = list(keys_of(table, root))
            close = get_close_matches(str(path[-1]), keys, 1)
            nearest = close[0] if close else None
            expected = f"{UNKNOWN}; known here: {', '.join(keys)}"
        elif key:
            held = members_of(_locate(item["loc"][:-2], data, root)[1] or {}, root)
            expected = next(
                (each["propertyNames"]["description"] for each in held if "propertyNames" in each),
                "another name",
            )
        elif item["type"] == "missing":
            beside = _at(data, path[:-1])
            extra = (
                [key for key in beside if key not in keys_of(table, root)]
                if isinstance(beside, dict)
                else []
            )
            close = get_close_matches(str(path[-1]), extra, 1)
            expected = f"missing: {expected}" + (f" ('{close[0]}' is no key)" if close else "")
        elif (
            item["type"] not in get_args(ErrorType) or node is None
        ):  # a class's own check brings its own words
            expected = item["msg"]
        elif item["type"] == "value_error":
            expected = str(item["ctx"]["error"])
        value = _at(data, path)
        if (
            item["type"] == "too_short"
            and isinstance(value, list | tuple)
            and len(value) >= item["ctx"]["min_length"]
        ):
            continue  # items of it were wrong, told by themselves, and are not counted
        given = "" if item["type"] == "missing" or key else shown(value)
        if item["type"] in ("too_long", "too_short") and isinstance(value, list):
            given = f"a list of {len(value)}"
        found.setdefault(
            tuple(path),
            Fault(tuple(path), given, expected, nearest, "" if path else "spec", no_such),
        )
    return list(found.values())


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
        table, node = node or table, below
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
    items, ends = [], ("]", "],")
    while (line := next(lines)).strip() not in ends:
        items.append(line if line[-1] != "[" else _array(line, lines))
    short = opened + ", ".join(item.strip().removesuffix(",") for item in items) + line.strip()
    return short if len(short) <= _WIDE and "\n" not in short else "\n".join([opened, *items, line])


def schema(cls: type[Spec], mechanism: str | None = None) -> Data:
    """JSON Schema (2020-12) of a spec; with a mechanism's name, of that one only."""
    found: Data = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **cls.model_json_schema(),
    }
    if mechanism is not None:
        found["properties"]["mechanism"] = {"const": mechanism}
    return found
