"""Chains from and for other programs: PMKS lines and pylinkage's JSON in, a commented spec out; PMKS lines and SVG out.

    PMKS line    one joint: J[R, P[x, y], L[ground, crank]], also within M[...]; further fields such as color[...] are passed
                 over. R: a pin of all its links, of one link alone a place that is traced. RP, A[angle]: a pin of the links
                 behind the first in a slot of the first; P: the second slides along the first
    pylinkage    what mechanism_to_dict gives: joints with their places, links with their joints, the driver among them

Of PMKS lines nothing says what drives; it is the first link that is pinned to the ground.
"""

from __future__ import annotations

import cmath
import json
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from html import escape
from itertools import combinations, count
from pathlib import Path
from typing import Any

from camgen.bounds import Bound, read_bytes
from camgen.errors import Fault, SpecError
from camgen.machine import model as m

_SIZE = Bound("a chain as PMKS lines or pylinkage's JSON", 1_000_000)
_JOINT = re.compile(r"J\[\s*(\w+)\s*((?:,\s*\w+\[[^\]]*\]\s*)*)\]")
_FIELD = re.compile(r"(\w+)\[([^\]]*)\]")
_SAME = 1e-9  # mm, places that are one
_COLOURS = ("#0b62a8", "#b5541c", "#2c7a4b", "#7a3e9d", "#8a6d00", "#a8326e")


@dataclass
class ForeignChain:
    """A chain as it was read."""

    points: dict[str, complex] = field(default_factory=dict)  # mm
    links: dict[str, list[str]] = field(default_factory=lambda: {m.GROUND: []})  # their points
    slots: list[tuple[str, str, tuple[str, str]]] = field(default_factory=list)  # pin, link, along
    slides: list[tuple[str, str, tuple[str, str]]] = field(default_factory=list)  # link, on, along
    driven: str = ""  # link that drives
    range_deg: tuple[float, float] | None = None  # of the drive; None where it turns all round
    traced: list[str] = field(default_factory=list)  # points whose paths are outputs
    remarks: list[str] = field(default_factory=list)

    def point(self, name: str, at: complex, links: Iterable[str]) -> str:
        """A new point on links; its name made one that a spec may have."""
        fresh = _fresh(name, self.points)
        self.points[fresh] = at
        for link in links:
            self.links.setdefault(link, []).append(fresh)
        return fresh

    def line(self, name: str, at: complex, angle: float, link: str) -> tuple[str, str]:
        """Two points of a link on the line through a place at an angle, rad."""
        reach = max((abs(z - at) for z in self.points.values()), default=0.0) / 2 or 10.0
        ends = [at + sign * reach * cmath.exp(1j * angle) for sign in (-1, 1)]
        return self.point(f"{name}1", ends[0], [link]), self.point(f"{name}2", ends[1], [link])


def read_chain(path: Path) -> ForeignChain:
    """The chain in a file; FileError where it cannot be read, SpecError with every fault where it is none."""
    try:
        text = read_bytes(path, _SIZE).decode("utf-8-sig")
    except UnicodeDecodeError:
        fault = Fault((), "", "text: PMKS lines or pylinkage's JSON", source=path.name)
        raise SpecError([fault], str(path)) from None
    faults: list[Fault] = []
    chain = _pylinkage(text, faults) if text.lstrip().startswith("{") else _pmks(text, faults)
    if not faults and not chain.driven:
        right = "a link that is pinned to the ground: none can be driven"
        faults.append(Fault(("joints",), "", right))
    if faults:
        raise SpecError(faults, str(path))
    return chain


@dataclass(frozen=True)
class _Joint:
    """A joint of PMKS lines: its kind, its place, the angle of its slide, rad, the links that it joins."""

    kind: str  # "R", "P" or "RP"
    place: complex
    angle: float
    links: tuple[str, ...]


def _pmks(text: str, faults: list[Fault]) -> ForeignChain:
    chain = ForeignChain()
    names = _letters()
    joints = list(_pmks_joints(text, faults))
    for joint in joints:
        if joint.kind == "R":
            _pin(chain, next(names), joint)
    for joint in joints:
        if joint.kind != "R":
            _guide(chain, names, joint)
    if not joints and not faults:
        right = "PMKS lines such as J[R, P[0, 0], L[ground, crank]], or pylinkage's JSON"
        faults.append(Fault(("joints",), "", right))
    chain.remarks.append(
        f"PMKS lines do not say what drives: the first link on the ground is taken, {chain.driven}."
    )
    return chain


def _pmks_joints(text: str, faults: list[Fault]) -> Iterator[_Joint]:
    """The joints of PMKS lines, in their order; what cannot be read becomes a fault."""
    links = _Names()
    for number, line in enumerate(text.splitlines(), 1):
        source = f"line {number}"
        written = line.partition("#")[0]
        rest = re.sub(r"[\s,;\]]|M\[", "", _JOINT.sub("", written))
        if rest:
            right = "joints such as J[R, P[0, 0], L[ground, crank]]"
            faults.append(Fault((), rest[:40], right, source=source))
        for match in _JOINT.finditer(written):
            try:
                yield _pmks_joint(match, links)
            except (KeyError, ValueError):
                right = "R, P or RP with P[x, y], L[links], and A[deg] of a slide"
                faults.append(Fault((), match[0][:60], right, source=source))


def _pmks_joint(match: re.Match[str], links: _Names) -> _Joint:
    """KeyError or ValueError where it is none."""
    kind = match[1]
    fields = dict(_FIELD.findall(match[2]))
    x, y = (float(value) for value in fields["P"].split(","))
    angle = math.radians(float(fields.get("A", "0")))
    joined = tuple(links(name.strip()) for name in fields["L"].split(",") if name.strip())
    fewest = 1 if kind == "R" else 2
    if kind not in ("R", "P", "RP") or not math.isfinite(x + y + angle) or len(joined) < fewest:
        raise ValueError(kind)
    return _Joint(kind, complex(x, y), angle, joined)


def _pin(chain: ForeignChain, name: str, joint: _Joint) -> None:
    """A pin of all its links; on one that moves alone a place that is traced."""
    point = chain.point(name, joint.place, joint.links)
    moving = [link for link in joint.links if link != m.GROUND]
    if len(joint.links) == 1 and moving:
        chain.traced.append(point)
    if m.GROUND in joint.links and moving and not chain.driven:
        chain.driven = moving[0]


def _guide(chain: ForeignChain, names: Iterator[str], joint: _Joint) -> None:
    """A slot or a slide of the first link, at a point that the others have there or get."""
    base, *riders = joint.links
    shared = (
        point
        for rider in riders
        for point in chain.links.get(rider, ())
        if abs(chain.points[point] - joint.place) <= _SAME
    )
    point = next(shared, "") or chain.point(next(names), joint.place, [])
    for rider in riders:
        carried = chain.links.setdefault(rider, [])
        if point not in carried:
            carried.append(point)
    along = chain.line(f"S{point}", joint.place, joint.angle, base)
    if joint.kind == "RP":
        chain.slots.append((point, base, along))
    else:
        chain.slides.append((riders[0], base, along))


def _pylinkage(text: str, faults: list[Fault]) -> ForeignChain:
    chain = ForeignChain()
    names = _Names()
    try:
        data = json.loads(text)
        joints = list(data["joints"])
        links = list(data["links"])
        places = {joint["id"]: complex(*map(float, joint["position"])) for joint in joints}
        ends = {str(link["id"]): [str(joint) for joint in link["joints"]] for link in links}
        lost = [joint for ids in ends.values() for joint in ids if joint not in places]
        if lost or not all(map(cmath.isfinite, places.values())):
            raise ValueError
    except (ValueError, KeyError, TypeError, RecursionError):
        right = (
            "what pylinkage's mechanism_to_dict writes: joints with positions, links with joints"
        )
        faults.append(Fault(("JSON",), "", right))
        return chain
    ground = {str(link["id"]) for link in links if link.get("type") == "ground"}
    for joint in joints:
        key = joint["id"]
        kind = joint.get("type", "revolute")
        place = places[key]
        on = [m.GROUND if link in ground else names(link) for link in ends if key in ends[link]]
        if kind == "tracker":
            pair = {joint.get("ref_joint1_id"), joint.get("ref_joint2_id")}
            on = on or [names(link) for link, ids in ends.items() if pair <= set(ids)][:1]
        if kind == "ground" and m.GROUND not in on:
            on.insert(0, m.GROUND)
        name = chain.point(str(joint.get("name", key)), place, on)
        if kind == "tracker" or (len(on) == 1 and kind == "revolute"):
            chain.traced.append(name)
        if kind == "prismatic":
            axis = complex(*joint.get("axis", (1, 0)))
            origin = complex(*joint.get("line_point", (0, 0)))
            foot = origin + axis * ((place - origin) / axis).real
            along = chain.line(f"S{name}", foot, cmath.phase(axis), m.GROUND)
            chain.slots.append((name, m.GROUND, along))
    for link in links:
        if link.get("type") in ("driver", "arc_driver") and not chain.driven:
            chain.driven = names(str(link["id"]))
            if link["type"] == "arc_driver":
                first = float(link.get("initial_angle") or link.get("arc_start", 0.0))
                ends_deg = (
                    math.degrees(float(link.get(key, 0.0)) - first)
                    for key in ("arc_start", "arc_end")
                )
                low, high = sorted(ends_deg)
                chain.range_deg = low, high
    return chain


def spec_text(chain: ForeignChain, name: str, source: str) -> str:
    """A spec of the chain with its remarks; drawn distances count, as no length is given."""
    driven = chain.driven
    fixed = set(chain.links[m.GROUND])
    swung = [
        link
        for link, points in chain.links.items()
        if link not in (m.GROUND, driven) and set(points) & fixed
    ]
    rows = [
        f"# Read from {source}: places as they were there, in mm. Drawn distances count; give exact ones in [lengths].",
        *(f"# {remark}" for remark in chain.remarks),
        "",
        'mechanism = "linkage"',
        f'name = "{name}"',
        "",
        "[points]                            # mm, at theta = 0",
        *(f"{point} = {_pair(z.real, z.imag)}" for point, z in chain.points.items()),
        "",
        "[links]                             # bodies by their points; two that share a point are pinned there",
        *(f"{link} = {json.dumps(points)}" for link, points in chain.links.items() if points),
        "",
        "# [lengths]                         # mm, exact, between two points of one link",
    ]
    pairs = [pair for points in chain.links.values() for pair in combinations(points, 2)]
    rows += [f'# "{a}-{b}" = {abs(chain.points[a] - chain.points[b]):.6g}' for a, b in pairs[:40]]
    rows += [
        "",
        "[drive]",
        f'link = "{driven}"',
        "speed_rpm = 60                      # below 0: clockwise",
    ]
    if chain.range_deg:
        rows.append(f"range_deg = {_pair(*chain.range_deg)}")
    for link, on, along in chain.slides:
        rows += [
            "",
            "[[slide]]",
            f'link = "{link}"',
            f'on = "{on}"',
            f"along = {json.dumps(along)}",
        ]
    for pin, link, along in chain.slots:
        rows += [
            "",
            "[[slot]]",
            f'pin = "{pin}"',
            f'link = "{link}"',
            f"along = {json.dumps(along)}",
        ]
    outputs = [(point, "point") for point in chain.traced]
    head = "[[output]]                          # what is judged and shown"
    for output, key in outputs or [((*swung, driven)[0], "link")]:
        rows += ["", head, f'name = "{output}"', f'{key} = "{output}"']
    return "\n".join(rows) + "\n"


def pmks(machine: m.Machine) -> str:
    """The chain as drawn in PMKS lines, the driven link's pin first; what they cannot say is named in lines after a #."""
    at = _places(machine)
    driven = {drive.body for drive in machine.drives}

    def drives(pin: m.Pin) -> bool:
        pair = {pin.a.body, pin.b.body}
        return m.GROUND in pair and not pair.isdisjoint(driven)

    pins = [joint for joint in machine.joints if isinstance(joint, m.Pin)]
    groups: list[tuple[complex, list[str]]] = []
    for pin in sorted(pins, key=drives, reverse=True):
        z = at(pin.a)
        pair = (pin.a.body, pin.b.body)
        for place, bodies in groups:
            if abs(place - z) <= 1e-6 and not set(pair).isdisjoint(bodies):
                bodies += [body for body in pair if body not in bodies]
                break
        else:
            groups.append((z, list(pair)))
    rows = [_line("R", z, bodies) for z, bodies in groups]
    for joint in machine.joints:
        if isinstance(joint, m.Slot | m.Slide):
            kind = "RP" if isinstance(joint, m.Slot) else "P"
            links = (joint.guide.body, joint.runner.body)
            angle = float(machine.start_of(joint.guide.body).angle) + joint.angle
            rows.append(_line(kind, at(joint.runner), links, angle))
        elif not isinstance(joint, m.Pin):
            rows.append(f"# not said in PMKS: {type(joint).__name__.lower()} {joint.name}")
    for output in machine.outputs:
        if isinstance(output.of, m.Path):
            z = at(output.of.of)
            if all(abs(z - pin) > 1e-6 for pin, _ in groups):
                rows.append(_line("R", z, [output.of.of.body]))
    return "\n".join(rows) + "\n"


def _line(kind: str, z: complex, links: Iterable[str], angle: float | None = None) -> str:
    slope = "" if angle is None else f" A[{_number(math.degrees(angle))}],"
    return f"J[{kind},{slope} P{_pair(z.real, z.imag)}, L[{', '.join(links)}]]"


def svg(machine: m.Machine) -> str:
    """The chain as drawn: each link as the shape between its points, pins as circles, with the names of both."""
    place_of = _places(machine)

    def at(place: m.Place) -> complex:  # y downwards, as in pictures, and to a nanometre
        z = place_of(place)
        return complex(round(z.real, 6) + 0.0, round(-z.imag, 6) + 0.0)

    shapes = {body.name: [at(body.at(point)) for point in body.points] for body in machine.bodies}
    places = {point: at(body.at(point)) for body in machine.bodies for point in body.points}
    every = list(places.values()) or [0j]
    low, high = (
        complex(end(z.real for z in every), end(z.imag for z in every)) for end in (min, max)
    )
    size = max(abs(high - low), 1.0)
    edge = 0.12 * size * (1 + 1j)
    corner = low - edge
    wide = high - low + 2 * edge
    box = " ".join(f"{value:.6g}" for value in (corner.real, corner.imag, wide.real, wide.imag))
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}" width="640" font-family="sans-serif"'
    rows = [f'{head} font-size="{size / 40:.4g}">']
    for k, (name, corners) in enumerate(shapes.items()):
        if not corners:
            continue
        colour = "#39424e" if name == m.GROUND else _COLOURS[k % len(_COLOURS)]
        path = " ".join(f"{z.real:.6g},{z.imag:.6g}" for z in corners)
        dashes = f' stroke-dasharray="{size / 60:.4g}"' if name == m.GROUND else ""
        stroke = (
            f'stroke="{colour}" stroke-width="{size / 150:.4g}" stroke-linejoin="round"{dashes}'
        )
        rows.append(f'<polygon points="{path}" fill="{colour}" fill-opacity="0.12" {stroke}/>')
        middle = sum(corners) / len(corners)
        rows.append(
            f'<text x="{middle.real:.6g}" y="{middle.imag:.6g}" fill="{colour}">{escape(name)}</text>'
        )
    for point, z in places.items():
        rows.append(
            f'<circle cx="{z.real:.6g}" cy="{z.imag:.6g}" r="{size / 90:.4g}" fill="#fff" stroke="#1d2530" '
            f'stroke-width="{size / 300:.4g}"/>'
        )
        rows.append(
            f'<text x="{z.real + size / 60:.6g}" y="{z.imag - size / 60:.6g}">{escape(point)}</text>'
        )
    return "\n".join([*rows, "</svg>"]) + "\n"


def _places(machine: m.Machine) -> Callable[[m.Place], complex]:
    def at(place: m.Place) -> complex:
        pose = machine.start_of(place.body)
        return complex(pose.place + cmath.exp(1j * pose.angle) * place.at)

    return at


def _number(value: float) -> str:
    return f"{value:z.12g}" if abs(value) > 1e-12 else "0"


def _pair(a: float, b: float) -> str:
    return f"[{_number(a)}, {_number(b)}]"


class _Names:
    """Names of links as a spec may have them, by the names in a file."""

    def __init__(self) -> None:
        self._given: dict[str, str] = {m.GROUND: m.GROUND}

    def __call__(self, name: str) -> str:
        if name not in self._given:
            self._given[name] = _fresh(name, set(self._given.values()))
        return self._given[name]


def _fresh(name: str, taken: Iterable[str] | Mapping[str, Any]) -> str:
    """The name with what no spec allows left out, and numbered where it is taken."""
    plain = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")[:30] or "P"
    plain = plain if plain[0].isalpha() else f"P{plain}"
    name = plain
    numbers = count(2)
    while name in taken:
        name = f"{plain}_{next(numbers)}"
    return name


def _letters() -> Iterator[str]:
    yield from "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
    yield from (f"P{k}" for k in count(27))
