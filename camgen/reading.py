"""From a file to plain tables, lists, numbers and text: bounded, and every fault with its place."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Any, Literal

from camgen.bounds import Bound, read_bytes
from camgen.errors import Fault, Key, SpecError
from camgen.schemas import shortened

Data = dict[str, Any]

MOST_KEYS = 20_000  # of a spec, tables counted; machines of sixty links have a thousand
MOST_VALUES = (
    500_000  # of a spec, in its lists: three for each point of a table, which has 20,000 at most
)
DEEPEST = 32  # tables and lists in one another; no spec needs ten
SHALLOWER = f"tables and lists nested at most {DEEPEST} deep"

_KEY = r"""(?:[\w-]+|"[^"\n]*"|'[^'\n]*')[ \t]*\."""
_LONG_KEY = re.compile(
    rf"(?m)(?:^|[\[{{,])[ \t]*(?:{_KEY}[ \t]*){{{DEEPEST}}}"
)  # tomllib's time grows with its square


SPEC_FILE = Bound("a spec file", 10_000_000)

_COMMENT = re.compile(r"(?m)^[ \t]*#.*$")
# The header of a table; a row of an array has a comma, outside of what is quoted.
_HEADER = re.compile(
    r"""(?m)^[ \t]*\[(?:"(?:[^"\\\n]|\\.)*"|'[^'\n]*'|[^,=\n"'])*\][ \t\r]*(?:#|$)"""
)

_WIDE = re.compile(rb"\xff\xfe|\xfe\xff|[\s!-~]\0|\0[\s!-~]")  # how UTF-16 begins


def read(path: Path) -> Data:
    """Tables of a TOML file.

    FileError where it cannot be read; SpecError with line and column where it is empty, not UTF-8 or not TOML, or nested
    deeper than any spec, and where it holds more than any.
    """
    raw = read_bytes(path, SPEC_FILE)
    if _WIDE.match(raw):
        right = "UTF-8: save it with that encoding"
        raise SpecError([Fault((), "the file is UTF-16", right, source=_place(""))], str(path))
    try:
        text = raw.decode("utf-8-sig")
        if large := too_large(*counted(text)):
            raise SpecError(large, str(path))
        if long := _LONG_KEY.search(text):
            raise SpecError(
                [
                    Fault(
                        (),
                        shortened(long[0].strip()),
                        SHALLOWER,
                        source=_place(text[: long.start()]),
                    )
                ],
                str(path),
            )
        data = tomllib.loads(text)
    except UnicodeDecodeError as error:
        before = raw[: error.start].decode("utf-8", "replace")
        fault = Fault(
            (),
            f"byte 0x{raw[error.start]:02x}",
            "a spec, which is text in UTF-8",
            source=_place(before),
        )
        raise SpecError([fault], str(path)) from None
    except (ValueError, RecursionError) as error:
        raise SpecError([_syntax_fault(text, error)], str(path)) from None
    if not data:
        expected = (
            "a spec: at least 'mechanism' and 'name' ('camgen new MECHANISM' prints a starter)"
        )
        raise SpecError(
            [Fault((), "the file is empty", expected, source="line 1, column 1")], str(path)
        )
    return tables(data, str(path))


def counted(text: str) -> tuple[int, int]:
    """How many keys, tables among them, and values in lists a TOML file has at most, at a glance: to read it takes long."""
    bare = _COMMENT.sub(
        "", text
    )  # each key has its =, each list its bracket, each further value in it a comma
    return bare.count("=") + len(_HEADER.findall(bare)), bare.count(",") + bare.count("[")


def tables(given: Mapping[str, Any], source: str = "spec") -> Data:
    """Tables from Python or a file as plain dicts; SpecError where they lie deeper in one another than those of any spec, or
    hold more than any."""
    data = dict(given)
    deep, keys, values = extent_of(data)
    if deep > DEEPEST:
        raise SpecError([Fault(("spec",), f"nested {deep} deep", SHALLOWER)], source)
    if large := too_large(keys, values):
        raise SpecError(large, source)
    return data


def too_large(keys: int, values: int) -> list[Fault]:
    """What is wrong with a spec of so many keys, tables counted, and values in lists."""
    found = (("keys and tables", keys, MOST_KEYS), ("values in lists", values, MOST_VALUES))
    return [
        Fault(("spec",), f"{count:,} {things}", f"at most {most:,}")
        for things, count, most in found
        if count > most
    ]


FileKind = Literal["spec", "law", "load", "outline", "line", "path"]


@dataclass(frozen=True)
class Reference:
    """A key of a spec that names another file."""

    path: Key
    kind: FileKind  # what the file holds
    table: Data  # in which the key stands, the last step of the path

    @property
    def name(self) -> str:
        """The file, as the spec names it."""
        return str(self.table[str(self.path[-1])])

    @property
    def outside(self) -> bool:
        """Whether it leaves the spec's folder."""
        return ".." in PurePosixPath(self.name).parts

    def file(self, folder: Path) -> Path:
        """The file, seen from the folder of the spec; SpecError where that is no relative path."""
        name = self.name
        if PurePosixPath(name).is_absolute() or PureWindowsPath(name).drive or "\\" in name:
            raise SpecError(
                [
                    Fault(
                        self.path,
                        shortened(name),
                        'a relative path with "/", so that the folder can be moved',
                    )
                ]
            )
        return folder / name


# Keys of single tables that may name a file, and what that holds.
_FILE_KEYS: tuple[tuple[tuple[str, ...], FileKind], ...] = (
    (("geometry", "follower", "outline"), "outline"),
    (("pen", "line"), "line"),
    (("wanted", "path"), "path"),
    (("wanted", "drawing"), "path"),
)


def references(data: Data, path: Key = ()) -> Iterator[Reference]:
    """All files that a spec's tables name: specs that it includes, tables of laws and loads, outlines of links and followers, a path that is wanted; also those of
    an included spec whose tables stand in it. What is no such table is left for `validate` to find."""
    for k, each in enumerate(_listed(data, "include")):
        inner = each.get("spec") if isinstance(each, dict) else None
        if isinstance(inner, str):
            yield Reference((*path, "include", k, "spec"), "spec", each)
        elif isinstance(inner, dict):
            yield from (
                one
                for one in references(inner, (*path, "include", k, "spec"))
                if one.kind != "spec"
            )  # it includes none
    for k, each in enumerate(_listed(data.get("load"), "on")):
        if isinstance(each, dict) and isinstance(each.get("file"), str) and "points" not in each:
            yield Reference((*path, "load", "on", k, "file"), "load", each)
    parts = data.get("parts")
    for name, each in parts.items() if isinstance(parts, dict) else ():
        if isinstance(each, dict) and isinstance(each.get("outline"), str):
            yield Reference((*path, "parts", name, "outline"), "outline", each)
    for key, kind in _FILE_KEYS:
        table: Any = data
        for step in key[:-1]:
            table = table.get(step) if isinstance(table, dict) else None
        if isinstance(table, dict) and isinstance(table.get(key[-1]), str):
            yield Reference((*path, *key), kind, table)
    rest = {key: value for key, value in data.items() if key != "include"}
    yield from (Reference((*at, "file"), "law", law) for at, law in _laws(rest, path))


def _laws(value: Any, path: Key) -> Iterator[tuple[Key, Data]]:
    """Tables of laws that name a file in place of points, wherever a law may stand: as its name says, it is a table."""
    if isinstance(value, dict):
        name = value.get("name")
        file = value.get("file")
        if (
            isinstance(name, str)
            and isinstance(file, str)
            and name == "table"
            and "points" not in value
        ):
            yield path, value
        for key, inner in value.items():
            if isinstance(inner, dict | list):
                yield from _laws(inner, (*path, key))
    elif (
        isinstance(value, list) and value and isinstance(value[0], dict)
    ):  # one of numbers may be long
        for k, inner in enumerate(value):
            yield from _laws(inner, (*path, k))


def _listed(holder: Any, key: str) -> list[Any]:
    found = holder.get(key) if isinstance(holder, dict) else None
    return found if isinstance(found, list) else []


def extent_of(value: Any) -> tuple[int, int, int]:
    """How many tables and lists lie in one another, 0 for a plain value; how many keys and how many values in lists there are.

    Without recursion, which depth would break; no deeper, and no more, than tells that it is too much.
    """
    deepest = keys = values = 0
    level = [value]
    while (
        level := [item for item in level if isinstance(item, dict | list | tuple)]
    ) and deepest < 10 * DEEPEST:
        deepest += 1
        keys += sum(len(item) for item in level if isinstance(item, dict))
        values += sum(len(item) for item in level if not isinstance(item, dict))
        if keys > MOST_KEYS or values > MOST_VALUES:
            break
        level = [
            inner for item in level for inner in (item.values() if isinstance(item, dict) else item)
        ]
    return deepest, keys, values


def _place(before: str) -> str:
    """Line and column of what follows `before`, both counted from 1."""
    return f"line {before.count(chr(10)) + 1}, column {len(before) - before.rfind(chr(10))}"


# What may hold brackets, "=", commas and line breaks that are not the file's own, then these themselves.
_TOKEN = re.compile(
    r"""(?s)\#[^\n]*|\"{3}(?:\\.|[^\\])*?\"{3}|'{3}.*?'{3}|"(?:\\.|[^"\\\n])*"|'[^'\n]*'|[\[\]{}=,\n]"""
)


@dataclass
class _Opened:
    """A list or an inline table that is not closed yet."""

    place: Key
    items: int = 0  # commas so far: the place in a list of what follows


def lines(text: str) -> dict[Key, int]:
    """The line, from 1, where each table and key of a TOML file begins, and each table or list in a list."""
    found: dict[Key, int] = {}
    rows: dict[Key, int] = {}  # the last one of each array of tables
    table: Key = ()
    opened: list[_Opened] = []
    place: Key = ()  # of the key whose value follows
    header = False
    line = 1
    begin = 0  # of what stands before the next sign
    for token in _TOKEN.finditer(f"{text}\n"):
        sign = token[0]
        before = text[begin : token.start()].strip()
        if header:
            if sign == "\n":
                table = _resolved(_steps(before), before.startswith("[["), rows)
                found.setdefault(table, line)
                header = False
        elif sign == "[" and not (before or place or opened):
            header = True
        elif sign == "=":
            place = (*(opened[-1].place if opened else table), *_steps(f"{before} = 0"))
            found.setdefault(place, line)
        elif sign in "[{":
            place = place or (*opened[-1].place, opened[-1].items)
            found.setdefault(place, line)
            opened.append(_Opened(place))
            place = ()
        elif sign in "]}":
            opened.pop()
            place = ()
        elif sign == ",":
            opened[-1].items += 1
            place = ()
        elif sign == "\n" and not opened:
            place = ()
        if sign in "=[]{},\n" and not header:
            begin = token.end()
        line += sign.count("\n")
    return found


def _steps(statement: str) -> Key:
    """Names of a header, or of the key of a statement."""
    steps: list[str] = []
    value: Any = tomllib.loads(statement)
    while value:
        if isinstance(value, dict):
            ((step, value),) = value.items()
            steps.append(step)
        else:
            (value,) = value
    return tuple(steps)


def _resolved(names: Key, row: bool, rows: dict[Key, int]) -> Key:
    """A header's names with the places in lists of tables that they stand for; row: whether it begins another one."""
    path: Key = ()
    for k, name in enumerate(names):
        path = (*path, name)
        if row and k == len(names) - 1:
            rows[path] = rows.get(path, -1) + 1
        if path in rows:
            path = (*path, rows[path])
    return path


def _syntax_fault(text: str, error: Exception) -> Fault:
    """Fault for what tomllib says, "reason (at line 3, column 5)" or "reason (at end of document)"."""
    if isinstance(error, RecursionError):
        return Fault(("TOML",), "", SHALLOWER)
    said = re.fullmatch(r"(?s)(.*) \(at (?:line (\d+), column (\d+)|end of document)\)", str(error))
    if said is None:  # a number or a date that Python cannot hold comes without a place
        return Fault(("TOML",), "", str(error).partition(";")[0])
    reason, line, column = said.groups()
    end = text.rstrip()
    place = f"line {line}, column {column}" if line else _place(end)
    rows = (text if line else end).split("\n")
    quoted = rows[int(line) - 1 if line else -1].strip()
    above = "\n".join(rows[: int(line) - 1 if line else -1])
    return Fault((), shortened(quoted), _syntax_in_words(quoted, reason, above), source=place)


_COMMA = re.compile(r"=\s*([+-]?\d+),(\d+)\s*(?:#.*)?$")
# text without quotes, or with one at its beginning or end alone
_UNQUOTED = re.compile(
    r"""=\s*(?:["'](?=[^"'#]*(?:#|$)))?([A-Za-z][\w .-]*?)["']?\s*(?:[,}#].*)?$"""
)
_RATIO = re.compile(r"=\s*([+-]?\d+)\s*/\s*(\d+)\s*(?:#.*)?$")
_WITH_UNIT = re.compile(r"=\s*([+-]?[\d.]+)\s*([a-zA-Z°]+)\s*(?:#.*)?$")
_ROUND = re.compile(r"=\s*\(([^()]*)\)")
_COLON = re.compile(r"""([\w-]+(?:\.[\w-]+)*|"[^"]*")\s*:\s*(.*?)\s*(?:#.*)?$""")
_TEXTS = re.compile(r"""=\s*((?:"\w+"\s*,\s*)+"\w+")\s*(?:#.*)?$""")  # "D", "E"
_BARE_LIST = re.compile(r"=\s*\[((?:\s*[A-Za-z]\w*\s*,?)+)\]\s*(?:#.*)?$")  # [D, E]
_CURLY = re.compile("[\u201c\u201d\u201e\u2018\u2019]")
_TWICE = re.compile(r"Cannot declare \(.*\) twice")


def _slip(line: str, reason: str) -> str:
    """What a line should be in which one thing is written as elsewhere; "" where none is seen."""
    if (pair := _COLON.match(line)) and reason.startswith("Expected '='"):
        return f"= in place of the colon: {pair[1]} = {pair[2] or '...'}"
    if line.startswith("<"):
        return "a spec, which is TOML, not HTML or XML"
    if line.startswith("{") and "=" not in line:
        return 'TOML, not JSON: mechanism = "...", one key a line'
    if number := _COMMA.search(line):
        return f"a decimal point, not a comma: {number[1]}.{number[2]}"
    if (ratio := _RATIO.search(line)) and float(ratio[2]):
        return f"a decimal number: {float(ratio[1]) / float(ratio[2]):.6g}"
    if number := _WITH_UNIT.search(line):
        return f"a number without a unit: {number[1]}"
    if items := _ROUND.search(line):
        return f"square brackets round a list: [{items[1]}]"
    if (texts := _TEXTS.search(line)) or (texts := _BARE_LIST.search(line)):
        quoted = ", ".join(f'"{each}"' for each in re.findall(r"\w+", texts[1]))
        return f"a list of texts in brackets, each in quotes: [{quoted}]"
    if _CURLY.search(line):
        return 'straight quotes: "..."'
    if (word := _UNQUOTED.search(line)) and word[1] not in ("true", "false", "inf", "nan"):
        return f'quotes round text: "{word[1]}"'
    return ""


def _syntax_in_words(line: str, reason: str, above: str) -> str:
    """What a line that is no TOML should be: usual mistakes by their cure, others by tomllib's reason; above: the lines over it."""
    if slip := _slip(line, reason):
        return slip
    name = line.partition("]")[0].strip("[ ")
    if re.fullmatch(r"\[+[\w. -]+\]*", line) and line.count("[") != line.count("]"):
        double = line.startswith("[[")
        return f"as many brackets on both sides: {f'[[{name}]]' if double else f'[{name}]'}"
    if reason == "Cannot overwrite a value" and line.startswith("[["):
        return f"[[{name}]] at each row of a list: above it stands otherwise, such as [{name}]"
    if _TWICE.fullmatch(reason) and not line.startswith("[["):
        if first := _line_of(rf"[ \t]*\[\s*{re.escape(name)}\s*\]", above):
            return f"[{name}] once: it stands in line {first} too; put all of its keys under one (rows of a list begin with [[{name}]])"
        if first := _line_of(rf"[ \t]*\[\[\s*{re.escape(name)}\s*\]\]", above):
            return f"[[{name}]], as in line {first}: it is a row of the same list"
    if line.startswith("[") and (
        inline := _line_of(rf"[ \t]*{re.escape(name)}\s*(?:\.|=\s*[\[{{])", above)
    ):
        return _going_on(name, inline, above.splitlines()[inline - 1].strip())
    if reason == "Cannot overwrite a value" and line.startswith("["):
        table, _, key = name.rpartition(".")
        header = re.search(rf"(?m)^[ \t]*\[\s*{re.escape(table)}\s*\]", above)
        first = _line_of(rf"[ \t]*{re.escape(key)}\s*=", above, header.end() if header else 0)
        if first:
            return f"a table of another name, or no {key} in line {first}, where it is a value"
    if reason == "Cannot overwrite a value":
        key = line.partition("=")[0].strip()
        start = max((header.start() for header in _HEADER.finditer(above)), default=0)
        first = _line_of(rf"[ \t]*{re.escape(key)}\s*=", above, start)
        if first:
            return f"{key} once: it stands in line {first} too"
    return f"valid TOML: {reason}"


def _going_on(name: str, number: int, begun: str) -> str:
    """How a table that a line has begun goes on: a list, a table in braces, or a key with a dot."""
    if re.match(rf"{re.escape(name)}\s*=\s*\[", begun):
        return f"a row {{ ... }} more in the list {name}, which begins in line {number}; or all of its rows here, as [[{name}]]"
    if re.match(rf"{re.escape(name)}\s*=", begun):
        return (
            f"its keys within the braces in line {number}, where {name} begins; or all of them here"
        )
    return f"its keys as {name}.KEY = ... under line {number}, where {name} begins; or all of them here"


def _line_of(form: str, text: str, start: int = 0) -> int:
    """Number of the first line, from 1, that begins with a form, not before a place; 0 where none does."""
    found = re.compile(f"(?m)^{form}").search(text, start)
    return text.count("\n", 0, found.start()) + 1 if found else 0
