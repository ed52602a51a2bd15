"""Which variants a sweep has: values of keys as a grid, side by side, or as a Latin hypercube; each follows from its number.

Nothing is listed beforehand, so a grid of 1e12 variants can be counted, and refused, at once.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

import numpy as np

from camgen.errors import COMMAND_LINE, Fault, SpecError, dotted
from camgen.settings import setting_of, split_setting

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_RANGE = re.compile(rf"\s*({_NUMBER}):({_NUMBER})(?::(\d{{1,16}}))?\s*")
_ENDS = re.compile(r"(\d+(?:\.\d+)?)\s*(?:-|\.\.+|to)\s*(\d+(?:\.\d+)?)")  # as people write a range
_LIKE_RANGE = re.compile(r"""[^,:"'\[{]*(:[^,:"'\[{]*){1,2}""")
_LARGE = 1e15  # beyond it a number is typed with an exponent


@dataclass(frozen=True)
class Wording:
    """How a sweep is typed, for messages: as options of the command line, or as arguments of `camgen.sweep`."""

    key: str  # what names a key, {key}
    form: str  # values of a key
    side_by_side: str
    fewer: str  # what asks for so many variants

    def refused(self, key: str, value: str, expected: str) -> Fault:
        """A key's values that are wrong."""
        return Fault((), value, expected, source=self.key.format(key=key).strip())


OPTIONS = Wording(
    "--vary {key}", "KEY=A:B:N, N values from A to B, or KEY=a,b,c", "--zip", "--latin N"
)
ARGUMENTS = Wording(
    "vary {key}", '"A:B:N", N values from A to B, or a list [a, b, c]', 'how="zip"', "how=N"
)


@dataclass(frozen=True)
class Axis:
    """A key and its values: either listed, as texts, or a range from low to high of `count` values (0: of any number)."""

    key: str
    options: tuple[str, ...] = ()
    low: float = 0.0
    high: float = 0.0
    count: int = 0

    def __len__(self) -> int:
        return len(self.options) or self.count

    def at(self, k: int) -> str:
        """The k-th value, as `--set` takes it; ends of a range to the last digit."""
        return self.options[k] if self.options else _text(self.low, self.high, k / (self.count - 1))

    def share(self, u: float) -> str:
        """The value at a share u, 0 to 1, of the range or of the list."""
        return (
            self.options[min(int(u * len(self.options)), len(self.options) - 1)]
            if self.options
            else _text(self.low, self.high, u)
        )


def _text(low: float, high: float, u: float) -> str:
    value = low * (1 - u) + high * u
    value = float(f"{value:.12g}") if abs(value) > 1e-12 * (high - low) else 0.0
    # as a whole number is typed: a key may take no other
    return repr(int(value)) if value.is_integer() and abs(value) < _LARGE else repr(value)


def axis(text: str, words: Wording = OPTIONS) -> Axis:
    """Read `KEY=A:B:N`, `KEY=A:B` or `KEY=a,b,c`; SpecError where it is none of them, empty or the wrong way round."""
    keys, values = split_setting(text)
    key = dotted(keys)
    values = values.strip()

    def refused(expected: str) -> SpecError:
        return SpecError([words.refused(key, repr(values), expected)], COMMAND_LINE)

    if not (all(keys) and values):
        raise SpecError([words.refused("", repr(text), words.form)], COMMAND_LINE)
    match = _RANGE.fullmatch(values)
    if not match:
        options = _split(values)
        if ends := _ENDS.fullmatch(values):
            raise refused(
                f"{ends[1]}:{ends[2]}:N, N values from {ends[1]} to {ends[2]}, such as {ends[1]}:{ends[2]}:5"
            )
        if _LIKE_RANGE.fullmatch(values):
            raise refused(f"A and B finite numbers, N a whole one; {words.form}")
        if not all(options):
            raise refused(f"a value between every two commas; {words.form}")
        if len(set(options)) < len(options):
            raise refused("each value once")
        return Axis(key, tuple(options))
    low = float(match[1])
    high = float(match[2])
    count = int(match[3] or 0)
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise refused(f"A less than B, both finite; {words.form}")
    if count > 10**15:
        raise refused(f"N of at most 1e15; {words.form}")
    if match[3] and count < 2:
        raise refused(f"N of at least 2; {words.form}")
    return Axis(key, low=low, high=high, count=count)


def axis_of(key: str, values: str | Iterable[Any], ends: bool = False) -> Axis:
    """A key and its values from Python: all of them, or a text as of `axis`; ends: two numbers are those of a range."""
    if isinstance(values, str):
        return axis(f"{key}={values}", ARGUMENTS)
    if not isinstance(values, Iterable):
        fault = ARGUMENTS.refused(key, repr(values), f"a list of values; {ARGUMENTS.form}")
        raise SpecError([fault], COMMAND_LINE)
    items = list(values)
    if ends and len(items) == 2 and not any(isinstance(item, str) for item in items):
        low, high = items
        return axis(f"{key}={low!r}:{high!r}", ARGUMENTS)
    if not items:
        raise SpecError([ARGUMENTS.refused(key, "no value", ARGUMENTS.form)], COMMAND_LINE)
    name = dotted(split_setting(f"{key}=")[0])
    return Axis(name, tuple(split_setting(setting_of(key, item))[1] for item in items))


def _split(text: str) -> list[str]:
    """The text at its commas, but for those inside brackets and quotes."""
    items = [""]
    depth = 0
    quote = ""
    for c in text:
        if quote:
            quote = "" if c == quote else quote
        elif c in "\"'":
            quote = c
        elif c == "," and depth == 0:
            items.append("")
            continue
        depth += (not quote) * ((c in "[{") - (c in "]}"))
        items[-1] += c
    return [item.strip() for item in items]


@dataclass(frozen=True)
class Variants:
    """All variants of some axes. Numbered from 0; of a grid the last axis changes fastest."""

    axes: tuple[Axis, ...]
    how: Literal["grid", "zip", "latin"] = "grid"
    samples: int = (
        0  # of a Latin hypercube: each axis has each of so many equal parts of its range once
    )
    seed: int = 0
    words: Wording = field(default=OPTIONS, repr=False, compare=False)

    def __post_init__(self) -> None:
        faults: list[Fault] = []
        keys = [each.key for each in self.axes]
        twice = sorted({key for key in keys if keys.count(key) > 1})
        words = self.words
        if not keys:
            faults.append(words.refused("", "", f"at least one key: {words.form}"))
        faults += [
            words.refused(key, "given twice", "each key once, with all its values") for key in twice
        ]
        if self.how != "latin":
            bare = [each.key for each in self.axes if not len(each)]
            without = "a range without a number of values"
            faults += [words.refused(key, without, words.form) for key in bare]
        if self.how == "zip" and not faults and len({len(each) for each in self.axes}) > 1:
            sizes = ", ".join(f"{each.key} {len(each)}" for each in self.axes)
            right = "the same number of values for every key"
            faults.append(Fault((), f"values: {sizes}", right, source=words.side_by_side))
        if faults:
            raise SpecError(faults, COMMAND_LINE)

    @property
    def count(self) -> int:
        """How many there are."""
        if self.how == "latin":
            return self.samples
        return (
            len(self.axes[0]) if self.how == "zip" else math.prod(len(each) for each in self.axes)
        )

    @cached_property
    def _shares(self) -> list[np.ndarray]:
        rng = np.random.default_rng(self.seed)
        return [(rng.permutation(self.samples) + 0.5) / self.samples for _ in self.axes]

    def values(self, number: int) -> list[str]:
        """The values of a variant's keys, in the order of the axes, as `--set` takes them."""
        if self.how == "latin":
            return [
                each.share(float(fractions[number]))
                for each, fractions in zip(self.axes, self._shares, strict=True)
            ]
        if self.how == "zip":
            return [each.at(number) for each in self.axes]
        values = []
        for each in reversed(self.axes):
            number, k = divmod(number, len(each))
            values.append(each.at(k))
        return values[::-1]

    def settings(self, number: int) -> list[str]:
        """The same as texts of `--set`."""
        return self.set_to(self.values(number))

    def set_to(self, values: Sequence[str]) -> list[str]:
        """Values of the keys, in the order of the axes, as texts of `--set`."""
        return [f"{each.key}={value}" for each, value in zip(self.axes, values, strict=True)]


def variants_of(
    vary: Mapping[str, str | Iterable[Any]], how: Literal["grid", "zip"] | int = "grid"
) -> Variants:
    """The variants of keys and their values; how: all with all, side by side, or so many as a Latin hypercube."""
    latin = how if isinstance(how, int) and how is not True else 0
    axes = tuple(axis_of(key, values, latin > 0) for key, values in vary.items())
    if how not in ("grid", "zip") and latin < 1:
        right = '"grid", "zip", or how many a Latin hypercube has'
        raise SpecError([Fault((), repr(how), right, source="how")], COMMAND_LINE)
    kind: Literal["grid", "zip", "latin"] = "latin" if latin else "zip" if how == "zip" else "grid"
    return Variants(axes, kind, latin, words=ARGUMENTS)


def variants(
    texts: Sequence[str], zipped: bool = False, latin: int = 0, seed: int = 0, grid: bool = False
) -> Variants:
    """The variants that a command line asks for; SpecError with what is wrong with it."""
    faults: list[Fault] = []
    axes: list[Axis] = []
    for text in texts:
        try:
            axes.append(axis(text))
        except SpecError as error:
            faults += error.faults
    if zipped + bool(latin) + grid > 1:
        faults.append(
            Fault((), "more than one", "one of the three", source="--zip, --latin, --grid")
        )
    if faults:
        raise SpecError(faults, COMMAND_LINE)
    return Variants(tuple(axes), "latin" if latin else "zip" if zipped else "grid", latin, seed)
