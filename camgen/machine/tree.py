"""A machine as a tree of bodies with loops that are closed, as programs for the dynamics of many bodies want it.

    branch    a body on its parent, nearer to the ground, by a pin or a slide; or rigidly, on a shaft that drives it
    block     what runs in a slot: a body of its own, which slides in the slot and turns on the slot's pin
    closing   a pin that is left over; it closes a loop
    coupling  angles of bodies whose weighted sum stays as it is: of gears, and of drives at other speeds

The tree grows from the ground, over slides first, so that only pins are left over.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from camgen.machine.model import (
    GROUND,
    Cam,
    Clutch,
    Drive,
    Gear,
    Machine,
    Pin,
    Place,
    Pose,
    Slide,
    Slot,
)
from camgen.numerics import magnitude
from camgen.tolerances import SAME_POINT

_EVEN = 1e-9  # share by which the speed of a drive may differ over a turn and be even
_LOOKED_AT = 64  # angles of a turn


@dataclass(frozen=True)
class Branch:
    """A body on its parent; joint: None where it is fixed on it."""

    body: str
    parent: str
    joint: Pin | Slide | None


@dataclass(frozen=True)
class Coupling:
    """Angles that go together: the sum of share * angle, rad, stays as it is at the start."""

    name: str
    shares: Mapping[str, float]  # by body


@dataclass(frozen=True)
class Tree:
    """Branches, each behind its parent's; what closes loops; blocks of slots, as (guide, runner's place) by their names."""

    branches: Sequence[Branch]
    closing: Sequence[Pin]
    couplings: Sequence[Coupling]
    blocks: Mapping[str, tuple[str, Place]]
    left_out: Sequence[str]  # names of joints and drives that have no place in it

    def turning(self, body: str) -> Iterator[Pin]:
        """The pins between a body and the ground, whose angles sum up to its own."""
        of = {branch.body: branch for branch in self.branches}
        while body in of:
            if isinstance(of[body].joint, Pin):
                yield of[body].joint  # type: ignore[misc]
            body = of[body].parent

    def with_blocks(self, poses: Mapping[str, Pose]) -> dict[str, Pose]:
        """Poses of the bodies, and of the blocks too: each at its pin, turned as its guide."""
        whole = dict(poses)
        for name, (guide, runner) in self.blocks.items():
            body = poses[runner.body]
            place = body.place + np.exp(1j * body.angle) * runner.at
            whole[name] = Pose(place, poses[guide].angle)
        return whole


def tree_of(machine: Machine) -> Tree:
    """The tree of a machine with one drive that turns or slides; cams, clutches and uneven drives are left out of it."""
    edges: list[Pin | Slide] = []
    blocks: dict[str, tuple[str, Place]] = {}
    for joint in machine.joints:
        if isinstance(joint, Slot):
            block = f"{joint.name} block"
            blocks[block] = (joint.guide.body, joint.runner)
            edges.append(Slide(joint.name, joint.guide, Place(block), joint.angle))
            edges.append(Pin(block, Place(block), joint.runner))
        elif isinstance(joint, Pin | Slide):
            edges.append(joint)
    fixed, couplings, uneven = _drives(machine)
    branches, rest = _grown([each for each in edges if each.name not in fixed.values()], fixed)
    couplings += [_of_gear(joint) for joint in machine.joints if isinstance(joint, Gear)]
    left_out = [
        *(joint.name for joint in machine.joints if isinstance(joint, Cam | Clutch)),
        *(joint.name for joint in rest if isinstance(joint, Slide)),
        *uneven,
    ]
    closing = [joint for joint in rest if isinstance(joint, Pin)]
    return Tree(branches, closing, couplings, blocks, left_out)


def _grown(
    edges: Sequence[Pin | Slide], fixed: Mapping[tuple[str, str], str]
) -> tuple[list[Branch], list[Pin | Slide]]:
    """Branches from the ground on, slides before pins, near ones before far ones; and the joints that are left over."""
    branches: list[Branch] = []
    reached = {GROUND}
    left = list(edges)
    pins: deque[tuple[str, str, Pin]] = deque()

    def reach(body: str, parent: str, joint: Pin | Slide | None) -> None:
        if body in reached:
            return
        reached.add(body)
        branches.append(Branch(body, parent, joint))
        if joint is not None:
            left.remove(joint)
        grow(body)

    def grow(body: str) -> None:
        for onto, other in fixed:
            if onto == body:
                reach(other, body, None)
        for edge in edges:
            ends = _ends(edge)
            if body not in ends:
                continue
            other = ends[0] if ends[1] == body else ends[1]
            if isinstance(edge, Pin):
                pins.append((other, body, edge))
            else:
                reach(other, body, edge)

    grow(GROUND)
    while pins:
        reach(*pins.popleft())
    return branches, left


def _ends(edge: Pin | Slide) -> tuple[str, str]:
    """The bodies that a joint holds."""
    if isinstance(edge, Pin):
        return edge.a.body, edge.b.body
    return edge.guide.body, edge.runner.body


def _drives(machine: Machine) -> tuple[dict[tuple[str, str], str], list[Coupling], list[str]]:
    """Of all drives but the first: bodies that are fixed on the first one's shaft, by the pins that fall away; those that turn
    in proportion to it; names of those that do neither."""
    fixed: dict[tuple[str, str], str] = {}
    couplings: list[Coupling] = []
    uneven: list[str] = []
    first = machine.drives[0]
    if _rate(first) is None:
        uneven.append(first.name)
    for drive in machine.drives[1:]:
        rates = _rate(first), _rate(drive)
        if rates[0] is None or rates[1] is None or first.slide or drive.slide:
            uneven.append(drive.name)
            continue
        near = _seat(machine, first.body)
        far = _seat(machine, drive.body)
        if rates[0] == rates[1] and near and far and _in_line(near, far):
            fixed[first.body, drive.body] = far.name
        else:
            couplings.append(
                Coupling(drive.name, {drive.body: 1.0, first.body: -rates[1] / rates[0]})
            )
    return fixed, couplings, uneven


def _rate(drive: Drive) -> float | None:
    """How fast a drive goes over theta; None where that is not even."""
    rates = np.asarray(drive.law(np.linspace(0.0, 2 * np.pi, _LOOKED_AT), 1))
    even = float(np.ptp(rates)) <= _EVEN * magnitude(rates)
    return float(rates[0]) if even and rates[0] else None


def _seat(machine: Machine, body: str) -> Pin | None:
    """The pin by which a body turns on the ground."""
    return next(
        (
            joint
            for joint in machine.joints
            if isinstance(joint, Pin) and {joint.a.body, joint.b.body} == {GROUND, body}
        ),
        None,
    )


def _in_line(a: Pin, b: Pin) -> bool:
    """Whether two pins of the ground have one axis."""
    places = [{place.body: place.at for place in (pin.a, pin.b)}[GROUND] for pin in (a, b)]
    return abs(places[0] - places[1]) < SAME_POINT


def _of_gear(gear: Gear) -> Coupling:
    """angle of b - carrier's = ratio * (angle of a - carrier's) + phase."""
    shares = {gear.b: 1.0, gear.a: -gear.ratio}
    if gear.carrier != GROUND:
        shares[gear.carrier] = shares.get(gear.carrier, 0.0) + gear.ratio - 1
    return Coupling(gear.name, shares)
