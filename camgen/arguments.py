"""Arguments of functions and methods for Python, held against their annotations before a call: what is of another type is a SpecError."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cache, wraps
from numbers import Integral, Real
from os import PathLike
from typing import ParamSpec, TypeVar

from camgen.errors import COMMAND_LINE, Fault, SpecError, file_errors
from camgen.schemas import shown

P = ParamSpec("P")
R = TypeVar("R")

# Of a name in an annotation: the type that it stands for, and what a person calls it.
_TYPES: Mapping[str, tuple[type, str]] = {
    "str": (str, "text"),
    "Literal": (str, "a word"),
    "PathLike": (PathLike, "a path"),
    "Mapping": (Mapping, "a dict"),
    "Iterable": (Iterable, "a list"),
    "Callable": (Callable, "a function"),  # type: ignore[dict-item]
    "int": (Integral, "a whole number"),
    "float": (Real, "a number"),
    "ArrayLike": (Real | Iterable, "a number or a list of numbers"),  # type: ignore[dict-item]
    "None": (type(None), "None"),
}
# Classes that are not imported for this: an argument has them by their name.
_CLASSES = {"Mechanism": "a machine", "Finding": "a finding"}


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """The function, which raises SpecError for arguments of a wrong type, all at once, and FileError in place of OSError."""

    @wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            given = _signature(function).bind(*args, **kwargs).arguments
        except TypeError:  # which arguments there are is Python's to say
            return function(*args, **kwargs)
        annotations = function.__annotations__
        faults = [
            Fault((name,), shown(value), _expected(annotations[name]))
            for name, value in given.items()
            if name in annotations  # self has none
            and not annotations[name].startswith(
                "Unpack"
            )  # options, which the function checks itself
            and not any(_is(value, each) for each in _names(annotations[name]))
        ]
        if faults:
            owner = "camgen" if function.__qualname__ == function.__name__ else "machine"
            called = f"{owner}.{function.__name__}"
            order = _order(function)
            if faults[-1].path[0] in order:  # perhaps swapped
                right = f"{faults[-1].expected}: {called}({', '.join(order)})"
                faults[-1] = replace(faults[-1], expected=right)
            raise SpecError(faults, called)
        with file_errors():
            try:
                return function(*args, **kwargs)
            except SpecError as error:
                if error.source != COMMAND_LINE:
                    raise
                found = error.faults
        raise SpecError(found, f"camgen.{function.__name__}")

    return call


_signature = cache(inspect.signature)


def _order(function: Callable[P, R]) -> list[str]:
    """The first arguments of a call that may be swapped: those that have to be given, or one and the next; else none."""
    parameters = _signature(function).parameters.values()
    placed = [each for each in parameters if each.kind is each.POSITIONAL_OR_KEYWORD]
    names = [each.name for each in placed if each.name != "self"]
    needed = sum(each.default is each.empty for each in placed if each.name != "self")
    return names[: max(needed, 2)] if len(names) > 1 else []


@cache
def _names(annotation: str) -> tuple[str, ...]:
    """Names of the types that an annotation allows, "str | Iterable[str]" -> str, Iterable."""
    return tuple(_alternatives(ast.parse(annotation, mode="eval").body))


def _alternatives(node: ast.expr) -> Iterator[str]:
    if isinstance(node, ast.BinOp):
        yield from _alternatives(node.left)
        yield from _alternatives(node.right)
    else:
        yield ast.unparse(node.value if isinstance(node, ast.Subscript) else node)


def _is(value: object, name: str) -> bool:
    """Whether a value is of a type; a text is no list, and true is no number."""
    if name in _CLASSES:
        return any(each.__name__ == name for each in type(value).__mro__)
    if (
        name in ("Iterable", "ArrayLike")
        and isinstance(value, str | bytes | Mapping)
        or isinstance(value, bool)
    ):
        return False
    return isinstance(value, _TYPES[name][0])


def _expected(annotation: str) -> str:
    """What an argument may be, in words; a path is a text as well."""
    names = _names(annotation)
    known = [name for name in names if not (name == "str" and "PathLike" in names)]
    *words, last = (_CLASSES.get(name) or _TYPES[name][1] for name in known)
    return f"{', '.join(words)} or {last}" if words else last
