"""From where a mechanism comes: a spec's file or its tables, with some of their keys set anew."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from os import PathLike
from pathlib import Path
from typing import Any

from camgen import reading
from camgen import spec as specs
from camgen.bounds import read_bytes
from camgen.errors import CamgenError, DesignError, Fault, FileError, Key, SpecError, dotted
from camgen.machines import MECHANISMS, load
from camgen.machines.mechanism import Mechanism, made
from camgen.machines.spec_files import with_tables
from camgen.schemas import shown
from camgen.settings import override, split_setting

Source = str | PathLike[str] | Mapping[str, Any] | Mechanism


def read_mechanism(spec: Source, overrides: Sequence[str] = ()) -> Mechanism:
    """The mechanism that a spec describes, a file or its tables; SpecError with all faults, FileError where it cannot be read.

    A mechanism is given back as it is.
    """
    if isinstance(spec, Mechanism):
        return spec
    if isinstance(spec, Mapping):
        return changed(*read_tables(spec), overrides)
    data = reading.read(Path(spec))  # what is no TOML has its place already
    folder = Path(spec).parent
    try:
        return changed(opened_tables(data, folder), str(spec), folder, overrides)
    except SpecError as error:
        if error.source != str(spec):
            raise
        raise _located(error, Path(spec), overrides) from None
    except FileError as error:
        if not error.key:
            raise
        raise error.named_by(error.key, _lines(Path(spec)).get(error.key)) from None


def _lines(spec: Path) -> Mapping[Key, int]:
    """The line of each key of a spec's file."""
    return reading.lines(read_bytes(spec, reading.SPEC_FILE).decode("utf-8-sig"))


def _located(error: SpecError, spec: Path, overrides: Sequence[str]) -> SpecError:
    """The error with the line of each fault, in their order, what a table lacks behind what is wrong in it; keys that were set anew
    have none."""
    lines = _lines(spec)
    anew = [split_setting(setting)[0] for setting in overrides]

    def located(fault: Fault) -> Fault:
        path = fault.path
        if fault.source or any(list(map(str, path[: len(key)])) == key for key in anew):
            return fault
        held = (path[:k] for k in range(len(path), 0, -1))
        return replace(fault, line=next((lines[each] for each in held if each in lines), None))

    faults = [located(fault) for fault in error.faults]
    last: dict[Key, int] = {}  # line of a fault in each table
    for fault in faults:
        last[fault.path[:-1]] = max(last.get(fault.path[:-1], 0), fault.line or 0)

    def place(fault: Fault) -> tuple[float, bool]:
        lacks = fault.line is not None and fault.path not in lines
        return last[fault.path[:-1]] if lacks else fault.line or math.inf, lacks

    return SpecError(sorted(faults, key=place), error.source)


@contextmanager
def placing(spec: Source, overrides: Sequence[str], mechanism: Mechanism) -> Iterator[None]:
    """Within it a DesignError tells what was read in another way than it may be meant, and on which lines of a spec's file the
    keys stand that it names, or what holds without them."""
    try:
        yield
    except DesignError as error:
        places: list[str] = []
        if isinstance(spec, str | PathLike):
            places = _places(str(error), Path(spec), overrides, mechanism)
        raise error.placed([*(f"note: {hint}" for hint in mechanism.hints), *places]) from None


_KEY = re.compile(r"[a-z]\w*(?:\.\w+)+|[a-z]+_\w+")


def _places(said: str, spec: Path, overrides: Sequence[str], mechanism: Mechanism) -> list[str]:
    """A line for each key of a spec that a sentence names: where it is written, or its default."""
    written = {dotted(key): line for key, line in _lines(spec).items()}
    anew = {dotted(tuple(split_setting(setting)[0])) for setting in overrides}
    values = dict(_values(mechanism.model_dump(by_alias=True)))
    places = []
    for name in dict.fromkeys(_KEY.findall(said)):
        keys = [key for key in values if key == name or key.endswith(f".{name}")]
        if len(keys) != 1 or keys[0] in anew:
            continue
        (key,) = keys
        if key in written:
            places.append(f"{key}: line {written[key]}")
        elif values[key] is not None:
            places.append(f"{key}: not in {spec.name}; {shown(values[key])} is its default")
    return places


def _values(table: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """The values of a spec's tables, not of its lists, by their dotted keys."""
    for name, value in table.items():
        if isinstance(value, Mapping):
            yield from _values(value, f"{above}{name}.")
        elif not isinstance(value, list | tuple):
            yield f"{above}{name}", value


def read_tables(spec: Source) -> tuple[reading.Data, str, Path]:
    """The tables of a spec with those of the specs that it includes, what it is called in errors, and its folder."""
    if isinstance(spec, Mechanism | Mapping):
        data = spec.source_tables if isinstance(spec, Mechanism) else reading.tables(spec)
        source = "spec"
        folder = Path()
    else:
        data = reading.read(Path(spec))
        source = str(spec)
        folder = Path(spec).parent
    return opened_tables(data, folder), source, folder


def tables_of_text(text: str, folder: Path) -> tuple[reading.Data, str, Path]:
    """The same of a spec's text, of which files are seen from the folder."""
    return opened_tables(reading.tables(tomllib.loads(text)), folder), "spec", folder


def opened_tables(data: reading.Data, folder: Path) -> reading.Data:
    """The tables with those of the specs that they include, seen from a folder."""
    if "include" not in data:
        return data
    from camgen.machines.included import opened

    return opened(data, folder)


def files_of(spec: Path) -> list[Path]:
    """A spec's file, those that it names, and those that included specs name, whether they are there or not.

    Of what is no spec itself alone.
    """
    own = _references(spec)
    included = [file for kind, file in own if kind == "spec"]  # which include none
    theirs = [file for other in included for kind, file in _references(other) if kind != "spec"]
    return [spec, *(file for _, file in own), *theirs]


def _references(spec: Path) -> list[tuple[str, Path]]:
    """What each file that a spec names holds, and where it is; nothing of what is no spec."""
    files: list[tuple[str, Path]] = []
    with suppress(CamgenError):
        for each in reading.references(reading.read(spec)):
            with suppress(SpecError):
                files.append((each.kind, each.file(spec.parent)))
    return files


def changed(
    data: reading.Data,
    source: str,
    folder: Path,
    overrides: Sequence[str] = (),
    like: tuple[reading.Data, specs.Spec] | None = None,
) -> Mechanism:
    """The mechanism of some tables with some keys set anew; like: see `validate`.

    SpecError with the faults of settings and, where those are left out, of the tables.
    """
    unset: list[Fault] = []
    for setting in overrides:
        try:
            data = override(data, setting)
        except SpecError as error:
            unset += error.faults
    if unset:
        try:
            changed(data, source, folder, (), like)
        except SpecError as error:
            unset += error.faults
        raise SpecError(unset, source)
    hints = tuple(
        f"{dotted(each.path)} was read from {each.name}, outside the spec's folder"
        for each in reading.references(data)
        if each.kind != "spec" and each.outside
    )
    data = with_tables(data, folder, source)
    kind = load(specs.choose(data, MECHANISMS, source))
    keys = {field.alias or name for name, field in kind.model_fields.items()}
    if "wanted" in data and "wanted" not in keys:
        right = "no table here in a build: camgen design SPEC FILE writes a spec that meets it; build that one"
        raise SpecError([Fault(("wanted",), "a table", right)], source)
    return made(kind, data, source, hints, like)


@dataclass(frozen=True)
class Template:
    """Tables of a spec, its source and folder, and settings of all its variants: what a variant leaves alone is read once."""

    data: reading.Data
    source: str
    folder: Path
    settings: Sequence[str] = ()

    @cached_property
    def _tables(self) -> reading.Data:
        return reduce(override, self.settings, self.data)

    @cached_property
    def _like(self) -> tuple[reading.Data, specs.Spec] | None:
        try:
            return self._tables, changed(self._tables, self.source, self.folder)
        except CamgenError:
            return None

    def variants(self, several: Iterable[Sequence[str]]) -> list[Mechanism | CamgenError]:
        """The mechanism of each list of settings, or why there is none; those of one kind find together what they need."""
        variants: list[Mechanism | CamgenError] = []
        for each in several:
            try:
                variants.append(changed(self._tables, self.source, self.folder, each, self._like))
            except (DesignError, SpecError) as error:
                variants.append(error)
        return variants


def prepare(variants: Iterable[object]) -> None:
    """Let mechanisms of one kind find together what each of them needs; what is no mechanism is passed over."""
    kinds: dict[type[Mechanism], list[Mechanism]] = {}
    for each in variants:
        if isinstance(each, Mechanism):
            kinds.setdefault(type(each), []).append(each)
    for kind, alike in kinds.items():
        kind.prepare(alike)
