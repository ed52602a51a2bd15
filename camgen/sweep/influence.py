"""What moves a finding of one spec: each number of it is changed alone, a little, and the machine judged anew.

The margin of a finding is how far its measured value is within its limit, below 0 where it fails. A key acts on the limit
where the measured value stays; else it acts on the machine, and the secant method finds the value at which the margin is 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from pathlib import Path
from typing import Any

from camgen.errors import CamgenError, DesignError, Key, dotted
from camgen.findings import Finding
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import Source, Template, read_mechanism
from camgen.progress import Progress, silent
from camgen.schemas import keys_of, step_below, unit_of
from camgen.settings import setting_of

_STEP = 0.02  # by which a number is changed, as a share of it
_STEP_AT_ZERO = 0.1  # the same of a 0, in its unit
_TRIED = (1.0, 10.0, 0.1, 30.0, 100.0)  # of a key that is not set, in its unit
# Keys that a finding's message or the guide's entry names as what helps, by its code; *: of each row of a list. A spec may leave
# them open, so they are tried where it does, and told however little they do.
_HELPING = {
    "BLADE_LENGTH": ("geometry.blade_length",),
    "CLUTCH_TORQUE": ("parts.shaft_diameter",),
    "CURVATURE": (
        "geometry.base_radius",
        "geometry.radius",
        "geometry.reversal_blend_deg",
        "geometry.tip_radius",
        "cam.*.base_radius",
    ),
    "FACE_WIDTH": ("geometry.follower.face_width",),
    "FEED": ("geometry.feed_deg",),
    "FORCE_CLOSURE": ("load.friction_n_m",),
    "HERTZ": ("geometry.follower.radius", "parts.thickness"),
    "LASH": ("limits.lash", "limits.lash_deg", "geometry.follower.arm"),
    "LIFT_OFF": ("spring.preload", "spring.rate", "load.gravity_deg"),
    "MIN_WALL": (
        "geometry.core_radius",
        "geometry.length",
        "geometry.radius",
        "parts.pin_diameter",
        "parts.rim",
        "parts.wall",
    ),
    "NEEDLE_GUIDED": ("parts.tube_length", "parts.wire_length"),
    "NEEDLE_REACH": ("parts.wire_length",),
    "PIN_SPACING": ("motor.speed_rpm", "tooth.return_ms"),
    "PRESSURE_ANGLE": (
        "geometry.base_radius",
        "geometry.radius",
        "geometry.arm_offset",
        "geometry.follower.offset",
        "geometry.swing_deg",
        "cam.*.base_radius",
    ),
    "SCREW_GRIP": ("base.thickness",),
    "SIDE_GAP": ("parts.side_gap", "accuracy.chord_tolerance"),
    "SPRING_RESERVE": ("spring.preload", "spring.rate"),
    "STROKE": ("geometry.eccentricity",),
    "UNDERCUT": (
        "geometry.base_radius",
        "geometry.reversal_blend_deg",
        "geometry.tip_radius",
        "cam.*.base_radius",
    ),
    "VELOCITY_RATIO": ("geometry.velocity_ratio",),
}
_BODIES = 9  # most of a machine whose forces are found anew for each key: of a walker that would take minutes
_FELT = 1e-4  # least change that counts: of a measured value as a share of it, of a margin or limit as one of the greater of both
_MOST = 6  # keys that are told, beside those that help
_LONGEST = 12  # numbers of a list that are changed; longer lists are tables of points
_SECANTS = 8
_BEYOND = 0.01  # of a value up to which a finding holds, by which it no longer does
_WIDEST = 4.0  # how far a value is looked for, as a share of the one that is
_DIGITS = 3  # of a value at which the limit is reached
_BED = "BED_FIT"  # without files each part's size
_FORM = frozenset(
    {"files", "drawing", "name", "mechanism"}
)  # tables that say how files are written
_ARRANGED = frozenset({"layers", "include"})  # tables that camgen fills in to say where parts are
_LEVELS = frozenset({"to", "to_deg"})  # keys of a segment that say where it ends
_LIFTS = frozenset({"lift", "lift_deg"})


@dataclass(frozen=True)
class KeyEffect:
    """What a number of the spec does to a finding, or several of one list that go together, such as a rise and its return."""

    keys: Sequence[str]  # as for `--set`
    value: float  # as it is; nan of a key that is not set, which may help
    found: bool  # whether camgen found it, as the spec leaves it open
    tried: float
    measured: float  # of the finding, where the key has the value tried
    limit: float  # the same; some limits follow the machine's size
    last: float | None  # value at which the finding just holds, tried; None: none was found


@dataclass(frozen=True)
class Influence:
    """The findings of one code in a spec, and what moves the one that is nearest to its limit."""

    findings: Sequence[Finding]  # none: the code is judged on files alone, or not of this machine
    nearest: Finding | None  # None too where keys are not tried: forces of a large machine
    limit_keys: Sequence[str]
    effects: Sequence[KeyEffect]  # the strongest first
    idle: Sequence[
        str
    ] = ()  # keys that help in other machines, or with others, and do not move it alone


def influence(
    spec: Source, code: str, settings: Sequence[str] = (), progress: Progress = silent
) -> Influence:
    """What a finding says of this spec before files are made, and which keys move it; settings: as of `--set`.

    Keys that help in general are tried where they are not set, too.
    SpecError for the spec, DesignError where no such mechanism exists.
    """
    mechanism = read_mechanism(spec, settings)
    tables = mechanism.source_tables
    with suppress(DesignError):
        tables = mechanism.settled_tables()
    judge, quick = _judge(mechanism, code)
    findings = judge(mechanism)
    judged = [k for k, each in enumerate(findings) if math.isfinite(_margin(each))]
    if not judged or not quick or (code == _BED and all(each.ok for each in findings)):
        return Influence(findings, None, (), ())
    number = min(judged, key=lambda k: _margin(findings[k]) / (abs(findings[k].limit) or 1.0))
    template = Template(tables, "spec", Path())
    trial = _Trial(mechanism, template, judge, number, findings[number])
    limit_keys: list[str] = []
    effects = []
    helping = trial.helping
    count = max(1, len(trial.numbers))
    for k, (keys, value, tried, found) in enumerate(chain(trial.changes(), trial.unset())):
        progress(f"{code}: tried {' and '.join(keys)}", min(1.0, k / count))
        if trial.only_worsens(keys, value, tried, found):
            continue
        if trial.moved(found.measured):
            change = abs(_margin(found) - trial.margin)
            effects.append((change, keys, value, tried, found))
        elif math.isclose(found.limit, tried) and trial.felt(found.limit - trial.finding.limit):
            limit_keys += keys
    limit_keys += trial.unset_limits()
    effects.sort(key=lambda each: -each[0])
    told = [
        KeyEffect(
            keys,
            value,
            trial.found(keys),
            tried,
            found.measured,
            found.limit,
            trial.last(keys, value, tried),
        )
        for k, (_, keys, value, tried, found) in enumerate(effects)
        if k < _MOST or not set(helping).isdisjoint(keys)
    ]
    acting = {key for each in told for key in each.keys} | {*limit_keys}
    known = {dotted(path) for path in trial.numbers}
    idle = [key for key in helping if key in known and key not in acting]
    return Influence(findings, trial.finding, limit_keys, told, idle)


@dataclass(frozen=True)
class _Level:
    """A level at which a program ends a segment, and rests in those behind it that end there too."""

    paths: list[Key]  # that say it
    value: float
    closing: bool = False  # whether the turn begins or ends at it


def _judge(
    mechanism: Mechanism, code: str
) -> tuple[Callable[[Mechanism], Sequence[Finding]], bool]:
    """Findings of one code: of the limits or the pins' play alone, where they have it, for what is known of files takes longer,
    and forces longest; and whether they are found quickly enough to try many keys."""

    def limits(each: Mechanism) -> Sequence[Finding]:
        return each.limits_of(code)

    def play(each: Mechanism) -> Sequence[Finding]:
        return [finding for finding in each.free_play() if finding.code == code]

    def forecast(each: Mechanism) -> Sequence[Finding]:
        return [finding for finding in each.forecast() if finding.code == code]

    if code == _BED:
        from camgen.pipeline.judging import room_on_bed

        return room_on_bed, True
    if limits(mechanism):
        return limits, True
    for judge in (play, forecast):
        if judge(mechanism):
            return judge, True
    from camgen.machines.loads.assess import assess

    def at_work(each: Mechanism) -> Sequence[Finding]:
        return [finding for finding in assess(each).findings if finding.code == code]

    return at_work, len(mechanism.model.bodies) <= _BODIES


def _margin(finding: Finding) -> float:
    """How far a finding is within its limit."""
    within = finding.measured - finding.limit
    return within if finding.floor else -within


def _numbers(value: Any, path: Key = ()) -> Iterator[tuple[Key, float]]:
    """The numbers of a spec's tables by their keys, without tables of points and what concerns files alone."""
    if isinstance(value, bool | str) or (path and path[0] in _FORM):
        return
    if isinstance(value, int | float):
        yield path, value
    elif isinstance(value, Mapping):
        for key, item in value.items():
            yield from _numbers(item, (*path, key))
    elif isinstance(value, list | tuple) and len(value) <= _LONGEST:
        for k, item in enumerate(value):
            yield from _numbers(item, (*path, k))


def _levels(value: Any, path: Key = ()) -> Iterator[_Level]:
    """The levels of all programs in a spec's tables."""
    for key, item in value.items() if isinstance(value, Mapping) else enumerate(value):
        if key == "segment" and isinstance(item, list | tuple):
            yield from _levels_of((*path, key), item)
        elif isinstance(item, Mapping | list | tuple):
            yield from _levels(item, (*path, key))


def _levels_of(path: Key, rows: Sequence[Mapping[str, Any]]) -> list[_Level]:
    """The levels of one program."""
    levels = [_Level([], 0.0, True)]
    for k, row in enumerate(rows):
        if not row.keys().isdisjoint(_LIFTS):
            levels.append(_Level([], math.nan))  # from here the spec says no level
        for key in row.keys() & _LEVELS:
            if row[key] != levels[-1].value:
                levels.append(_Level([], float(row[key])))
            levels[-1].paths.append((*path, k, key))
    *before, last = levels
    return [*before, replace(last, closing=last.value == 0)]


def _node(schema: Mapping[str, Any], key: str) -> dict[str, Any] | None:
    """A key's node in a schema; None where there is none."""
    root = dict(schema)
    node: dict[str, Any] | None = root
    for step in key.split("."):
        node = step_below(node, int(step) if step.isdigit() else step, root)
    return node


def _nearby(value: float) -> tuple[float, float]:
    """A little more, and a little less where that is refused."""
    if isinstance(value, int):
        return value + 1, value - 1
    step = _STEP * abs(value) or _STEP_AT_ZERO
    return value + step, value - step


@dataclass(frozen=True)
class _Trial:
    """A machine, judged anew with some keys changed."""

    mechanism: Mechanism
    template: Template  # its tables, with what camgen works out
    judge: Callable[[Mechanism], Sequence[Finding]]
    number: int  # of the finding among those of its code
    finding: Finding

    @cached_property
    def keys(self) -> Mapping[str, Any]:
        """The spec's tables with every default."""
        return self.mechanism.model_dump(by_alias=True, exclude_none=True)

    @property
    def numbers(self) -> Mapping[Key, float]:
        """Numbers of the spec by their keys, with those that are typed and stand for others, such as at_deg for span_deg, and
        those that camgen found."""
        tables = {key: each for key, each in self.template.data.items() if key not in _ARRANGED}
        typed = {
            path: float(value)
            for source in (tables, self.mechanism.source_tables)
            for path, value in _numbers(source)
        }
        return typed | dict(_numbers(self.keys))

    @cached_property
    def _given(self) -> frozenset[str]:
        """Keys that the spec sets, or that have a default."""
        tables = (self.mechanism.source_tables, self.keys)
        return frozenset(dotted(path) for each in tables for path, _ in _numbers(each))

    def found(self, keys: Sequence[str]) -> bool:
        """Whether camgen found the value of these keys."""
        return self._given.isdisjoint(keys)

    @property
    def margin(self) -> float:
        """Of the machine as it is."""
        return _margin(self.finding)

    def felt(self, change: float) -> bool:
        """Whether a change of the margin or the limit is more than rounding."""
        size = max(abs(self.finding.measured), abs(self.finding.limit))
        return abs(change) > _FELT * size if size else change != 0

    def moved(self, measured: float) -> bool:
        """Whether another measured value differs by more than rounding, which may be most of one that is far below its limit."""
        size = max(abs(self.finding.measured), _FELT * abs(self.finding.limit))
        change = measured - self.finding.measured
        return abs(change) > _FELT * size if size else change != 0

    def changes(self) -> Iterator[tuple[Sequence[str], float, float, Finding]]:
        """Keys, their value, another one near it and the finding then; what is refused alone goes with its likes in a list."""
        refused: dict[tuple[str, float], list[str]] = {}
        numbers = dict(self.numbers)
        for level in _levels(self.mechanism.source_tables):
            for path in level.paths:
                numbers.pop(path, None)
            keys = [dotted(path) for path in level.paths]
            change = self._changed(keys, level.value) if keys and not level.closing else None
            if change is not None:
                yield keys, level.value, *change
        for path, value in numbers.items():
            keys = [dotted(path)]
            change = self._changed(keys, value)
            if change is not None:
                yield keys, value, *change
            elif len(path) > 2 and isinstance(path[-2], int):
                refused.setdefault((dotted((*path[:-2], path[-1])), value), []).extend(keys)
        for (_, value), keys in refused.items():
            change = self._changed(keys, value) if len(keys) > 1 else None
            if change is not None:
                yield keys, value, *change

    @cached_property
    def helping(self) -> Sequence[str]:
        """Keys of this machine that help in general, set or not."""
        schema = type(self.mechanism).model_json_schema(by_alias=True)
        found = list[str]()
        for key in _HELPING.get(self.finding.code, ()):
            table, every, rest = key.partition(".*.")
            rows = len(self.keys.get(table, ())) if every else 0
            found += [f"{table}.{row}.{rest}" for row in range(rows)] if every else [key]
        return [key for key in found if unit_of(_node(schema, key) or {}) is not None]

    def unset(self) -> Iterator[tuple[Sequence[str], float, float, Finding]]:
        """The same as `changes` of helping keys that are not set, without limits: by the first of some values that helps, else by
        the first that is not refused. They are tried in the spec as it is typed: what camgen found may not go with them."""
        known = {dotted(path) for path in self.numbers}
        typed = replace(self, template=Template(self.mechanism.source_tables, "spec", Path()))
        for key in self.helping:
            if key in known or key.startswith("limits."):
                continue
            possible = []
            for tried in _TRIED:
                found = typed([key], tried)
                if found is not None:
                    possible.append((tried, found))
                    if _margin(found) > self.margin:
                        break
            if possible:
                better = _margin(possible[-1][1]) > self.margin
                yield [key], math.nan, *possible[-1 if better else 0]

    def _changed(self, keys: Sequence[str], value: float) -> tuple[float, Finding] | None:
        """A value near that of the keys, and the finding then; None where both ways are refused."""
        for tried in _nearby(value):
            found = self(keys, tried)
            if found is not None:
                return tried, found
        return None

    def __call__(self, keys: Sequence[str], value: float) -> Finding | None:
        """The finding of the machine with this value of the keys; None where there is none, or no such machine."""
        settings = [setting_of(key, value) for key in keys]
        (variant,) = self.template.variants([settings])
        if isinstance(variant, CamgenError):
            return None
        try:
            findings = self.judge(variant)
        except CamgenError:
            return None
        if self.number >= len(findings) or not math.isfinite(_margin(findings[self.number])):
            return None
        return findings[self.number]

    def only_worsens(self, keys: Sequence[str], value: float, tried: float, found: Finding) -> bool:
        """Whether a key stands at 0 and its only way from there makes a finding that fails fail by more."""
        worse = not self.finding.ok and _margin(found) < self.margin
        return worse and value == 0 and self(keys, -tried) is None

    def unset_limits(self) -> list[str]:
        """Keys of [limits] that are not set and would set this limit."""
        schema = type(self.mechanism).model_json_schema(by_alias=True)
        rules = keys_of(step_below(schema, "limits", schema), schema)
        given = self.numbers
        keys = []
        for key, rule in rules.items():
            if ("limits", key) in given or unit_of(rule) != self.finding.unit:
                continue
            wanted = self.finding.limit * (1 + _STEP) or _STEP
            found = self([f"limits.{key}"], wanted)
            if found is not None and math.isclose(found.limit, wanted):
                keys.append(f"limits.{key}")
        return keys

    def last(self, keys: Sequence[str], value: float, tried: float) -> float | None:
        """The value of the keys, to three digits, at which the finding just holds; None where it is at its limit already."""
        if not self.felt(self.margin) or math.isnan(value):
            return None
        margins = [(value, self.margin)]
        at = tried
        for _ in range(_SECANTS):
            found = self(keys, at)
            if found is None:
                return None
            margins.append((at, _margin(found)))
            (before, first), (now, second) = margins[-2:]
            if not self.felt(second) or first == second:
                break
            at = now - second * (now - before) / (second - first)
            if value and not 0 < at / value < _WIDEST:
                at = value * (_WIDEST if at / value > 1 else 1 / _WIDEST)
        holding = math.copysign(1.0, (at - value) * -self.margin)  # the way in which it holds
        last = _rounded(at, holding)
        if isinstance(value, int) or last == value:
            return None
        found = self(keys, last)
        beyond = self(keys, last - holding * _BEYOND * abs(last))
        # else the end is further than what was tried, or what is judged is sized anew for each value
        ends = beyond is None or not beyond.ok
        return last if found is not None and found.ok and ends else None


def _rounded(value: float, way: float) -> float:
    """A number to three digits, rounded up (way above 0) or down."""
    if value == 0:
        return 0.0
    digit = 10.0 ** (math.floor(math.log10(abs(value))) + 1 - _DIGITS)
    steps = value / digit
    whole = math.ceil(steps - 1e-9) if way > 0 else math.floor(steps + 1e-9)
    return float(f"{whole * digit:.{_DIGITS}g}")


def influence_text(
    spec: Source, code: str, settings: Sequence[str] = (), progress: Progress = silent
) -> str:
    """The same as Markdown, to stand behind what is said of the code."""
    found = influence(spec, code, settings, progress)
    lines = [f"### {code} in {_title(spec)}"]
    if not found.findings:
        lines.append(
            "Only files show this finding: `camgen build` judges it, if it applies to the machine and has a limit."
        )
    for each in found.findings:
        sign = "at least" if each.floor else "at most"
        state = "Holds" if each.ok else "Fails"
        place = f" ({each.where})" if str(each.where) else ""
        numbers = f"{_number(each.measured, each)}, {sign} {_number(each.limit, each)}"
        if each.ok and code == _BED:  # how far it is beyond the bed is 0
            numbers = each.message
        lines.append(f"- {state}{place}: {numbers}")
        if not each.ok and each.message:
            lines.append(f"  {each.message}")
    if found.limit_keys:
        keys = " and ".join(f"`{key}`" for key in found.limit_keys)
        lines.append(f"- {keys} {'sets' if len(found.limit_keys) == 1 else 'set'} the limit")
    if found.effects and found.nearest is not None:
        several = "; for the finding nearest to its limit" if len(found.findings) > 1 else ""
        lines.append(f"- Keys that change it, each alone, the strongest first{several}:")
        lines += [f"  - {_effect_text(each, found.nearest)}" for each in found.effects]
    elif found.nearest is not None:
        lines.append("- A change of 2 % in any one number of the spec does not change it.")
    if found.idle:
        keys = " and ".join(f"`{key}`" for key in found.idle)
        lines.append(f"- {keys}: a small change alone does nothing here, or is refused")
    return "\n".join(lines) + "\n"


def _title(spec: Source) -> str:
    """What a spec is called."""
    if isinstance(spec, Mechanism):
        return spec.name
    return str(spec.get("name", "this spec")) if isinstance(spec, Mapping) else Path(spec).name


def _effect_text(effect: KeyEffect, finding: Finding) -> str:
    keys = " and ".join(f"`{key}`" for key in effect.keys)
    result = _number(effect.measured, finding)
    now = f"{'found' if effect.found else 'now'} {effect.value:.6g}"
    state = "not set" if math.isnan(effect.value) else now
    text = f"{keys}, {state}: {effect.tried:.6g} gives {result}"
    if effect.limit != finding.limit:
        text += f" against {_number(effect.limit, finding)}"
    if effect.last is None:
        return text
    way = "up" if effect.last > effect.value else "down"
    ends = f"{way} to {effect.last:.6g}" if finding.ok else f"from {effect.last:.6g} {way}"
    return f"{text}; it holds {ends}"


def _number(value: float, finding: Finding) -> str:
    """A measured value or limit with its unit."""
    return f"{value:.4g} {finding.unit}" if finding.unit != "1" else f"{value:.4g}"
