"""What a printer's errors do to a machine: a budget by where they arise, and many printed copies, the worst really rolled.

All first order: an output's error is the sum over modes of sensitivity times error (`machine.print_errors`). Copies are drawn
from normal distributions, the same seed gives the same copies. The worst are then made: their outlines, or the walls of their drum,
displaced and rolled by the judge's own contact, their joints shifted and closed by Newton's method.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from camgen.errors import Fault, SpecError
from camgen.geometry.facets import facet_contour
from camgen.geometry.rings import Ring, Shape
from camgen.judge.joints import PlateLaw, RollingLaw
from camgen.machine.closing import close
from camgen.machine.constraints import Constraints
from camgen.machine.features import CamOutline, Eye, Mark, judged_outputs
from camgen.machine.model import (
    Along,
    Angle,
    Cam,
    Joint,
    Law,
    Machine,
    Output,
    Pin,
    Place,
    Slide,
    Slot,
    placed,
    places_of,
    unit_of,
)
from camgen.machine.print_errors import (
    ORDERS,
    Mode,
    Sensitivity,
    Sizes,
    hole_at,
    sensitivities,
    waviness,
)
from camgen.machine.run import Run, solve
from camgen.machines.mechanism import Mechanism
from camgen.numerics import Floats
from camgen.parts import materials
from camgen.parts.catalogue import ball_roller
from camgen.study import Figure, Figures, Study, Table
from camgen.tolerances import SAME_POINT

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

    from camgen.tolerance.drum_copies import DrumCopies

_ANGLES = 145  # of the turn, at which copies are looked at, and at least:
_PER_WAVE = 12  # of a wave of an outline's form
_NOTHING = 1e-9  # mm or rad, by which rounding moves what no joint moves
_CHUNK = 2000  # copies at a time: their errors stay in the processor's cache


def sizes_of(mechanism: Mechanism) -> Sizes:
    """Standard deviations of the spec's printer: as it says, else by the usual tolerance of its plastic, taken as three of them.

    A wall's is half of a size's, which has two walls; that of an outline's form, a quarter, is an estimate. SpecError where the
    spec says none of a material that is not printed.
    """
    given = mechanism.print
    usual = materials.of(mechanism.material.name).spread
    if given.size_error is None and usual is None:
        name = mechanism.material.name
        expected = f"the standard deviation of a size, mm: no usual one is known of {name}, which is not printed"
        raise SpecError([Fault(("print", "size_error"), "", expected)])
    size = (usual or 0.0) / 3 if given.size_error is None else given.size_error
    place = size / math.sqrt(2) if given.place_error is None else given.place_error
    form = size / 4 if given.form_error is None else given.form_error
    return Sizes(size / 2, form, place, size, given.form_orders or ORDERS)


@dataclass(frozen=True)
class Bend:
    """What each mode does to a follower's s over its cam's angle: a periodic curve through all of them at once."""

    curves: PPoly

    def by(self, errors: Floats) -> Law:
        """The sum of the modes times their errors, mm."""
        from scipy.interpolate import PPoly

        bent = PPoly(self.curves.c @ errors, self.curves.x, "periodic")

        def law(theta: Floats, order: int = 0) -> Floats:
            return np.asarray(bent(theta, order))

        return law

    def law(self, wanted: Law, errors: Floats) -> Law:
        """The wanted law and that."""
        bent = self.by(errors)

        def law(theta: Floats, order: int = 0) -> Floats:
            return np.asarray(wanted(theta, order) + bent(theta, order))

        return law


@dataclass(frozen=True)
class Spread:
    """A mechanism's modes and what they do to each judged output; holes: as `sensitivities` has them."""

    mechanism: Mechanism
    theta: Floats
    sizes: Sizes
    holes: Mapping[str, Place]
    modes: Sequence[Mode]
    outputs: Sequence[Output]
    found: Mapping[str, Sensitivity]

    def felt(self, run: Run, outputs: Sequence[str]) -> Mapping[str, Sensitivity]:
        """What the same modes do at other angles, or to other outputs of the machine."""
        return sensitivities(run, outputs, self.sizes, _exact(self.mechanism), self.holes)[1]

    @cached_property
    def air(self) -> Mapping[str, float]:
        """By cam that is touched on both sides, mm that each side is meant to stay off: a pair's own, half of a groove's."""
        outlines = [
            each for each in self.mechanism.assembly.features if isinstance(each, CamOutline)
        ]
        tracks = {each.joint: each.clearance / 2 for each in self.mechanism.assembly.tracks}
        return tracks | {each.joint: each.free / (2 if each.inside else 1) for each in outlines}

    @cached_property
    def bends(self) -> Mapping[str, Bend]:
        """Of each cam that says how it is touched and makes one turn, always the same way."""
        return _bends(self)

    def budget(self) -> Table:
        """Largest error of each output by where it arises, at three standard deviations."""
        heads = [
            "where",
            "what",
            "standard deviation, mm",
            *(f"{each.name}, {unit_of(each)[0]}" for each in self.outputs),
        ]
        groups: dict[tuple[str, str], list[int]] = {}
        for k, mode in enumerate(self.modes):
            groups.setdefault((mode.where, mode.kind), []).append(k)
        rows: list[list[object]] = []
        for (where, kind), members in groups.items():
            errors = [
                error if (error := 3 * self._size(output, members)) > _NOTHING else 0.0
                for output in self.outputs
            ]
            if max(errors, default=0.0) > _NOTHING:
                rows.append([where, kind, self.modes[members[0]].size, *errors])
        # what differs by rounding alone stays in the order of the joints, whatever adds the sums
        rows.sort(key=lambda row: -float(f"{float(str(row[3])):.9g}"))
        everything = range(len(self.modes))
        rows.append(
            [
                "all together",
                "",
                "",
                *(3 * self._size(output, everything) for output in self.outputs),
            ]
        )
        return Table("Error budget of the print, three standard deviations", heads, rows)

    def _size(self, output: Output, members: Sequence[int]) -> float:
        """Standard deviation of an output's error by some modes at its worst angle, in its unit for people."""
        sizes = np.array([self.modes[k].size for k in members])
        moved = np.abs(self.found[output.name].modes[list(members)]) * sizes[:, None]
        return float(np.max(np.sqrt(np.sum(moved**2, axis=0)), initial=0.0)) * unit_of(output)[1]

    def study(self) -> Study:
        """The budget, for a build's report."""
        if not self.modes:
            return Study()
        every = range(len(self.modes))
        figures = [
            Figure("print error {of}", 3 * self._size(each, every), unit_of(each)[0], each.name)
            for each in self.outputs
        ]
        return Study(Figures(figures), tables=[self.budget()])


def spread_of(mechanism: Mechanism) -> Spread:
    """Modes of a mechanism's model, cams that say how they are touched among them."""
    machine = mechanism.model
    sizes = sizes_of(mechanism)
    outputs = judged_outputs(machine.outputs, mechanism.assembly.demands)
    theta = np.linspace(
        *mechanism.assembly.cycle.range, max(_ANGLES, _PER_WAVE * sizes.orders[1] + 1)
    )
    holes = _holes(mechanism, outputs)
    if mechanism.mechanism == "cylinder-cam":
        from camgen.machines.cylinder_cam.mechanism import CylinderCam
        from camgen.tolerance.drums import DrumErrors

        assert isinstance(mechanism, CylinderCam)
        rolled = mechanism.geometry.roller
        exact = ball_roller(2 * rolled.radius, rolled.length) is not None
        key = mechanism.pieces.corner if mechanism.pieces else None
        drum, sensitivity = DrumErrors(mechanism.track, theta, sizes, exact, key).sensitivity()
        return Spread(mechanism, theta, sizes, holes, drum, outputs, {outputs[0].name: sensitivity})
    if not machine.joints:
        return Spread(mechanism, theta, sizes, holes, (), outputs, {})
    run = solve(machine, theta, 0)
    names = [each.name for each in outputs]
    modes, found = sensitivities(run, names, sizes, _exact(mechanism), holes)
    sound = np.ones(len(theta), bool)
    for each in found.values():
        sound &= np.isfinite(each.modes).all(axis=0)
        for gap, _ in each.held.values():
            sound &= np.isfinite(gap).all(axis=0)
    kept = {
        name: Sensitivity(
            each.modes[:, sound],
            {joint: reach[sound] for joint, reach in each.reach.items()},
            {cam: (gap[:, sound], air[sound]) for cam, (gap, air) in each.held.items()},
        )
        for name, each in found.items()
    }
    told = any(np.any(np.abs(each.modes) > _NOTHING) for each in kept.values())
    return Spread(mechanism, theta[sound], sizes, holes, modes if told else (), outputs, kept)


def _bends(spread: Spread) -> dict[str, Bend]:
    """See `Spread.bends`."""
    from scipy.interpolate import CubicSpline

    machine = spread.mechanism.model
    cams = [joint for joint in machine.joints if isinstance(joint, Cam) and joint.touches]
    outputs = [
        Output(f"s of {cam.name}", Angle(cam.follower) if cam.slide is None else Along(cam.slide))
        for cam in cams
    ]
    if not cams:
        return {}
    followed = replace(machine, outputs=tuple(outputs))
    run = solve(followed, spread.theta, 0)
    found = spread.felt(run, [each.name for each in outputs])
    system = Constraints(followed)
    poses = run.poses()
    bends = {}
    for cam, output in zip(cams, outputs, strict=True):
        if cam.over is not None:
            continue
        angle = np.asarray(system.angle(cam.cam, poses) + np.zeros(len(poses))) - cam.phase
        turned = float(angle[-1] - angle[0])
        if abs(abs(turned) - math.tau) < 1e-9 and np.all(np.diff(angle) * turned > 0):
            at, first = np.unique(np.mod(angle[:-1], math.tau), return_index=True)
            rows = found[output.name].modes.T[:-1][first]
            closed = np.append(at, at[0] + math.tau), np.concatenate([rows, rows[:1]])
            bends[cam.name] = Bend(CubicSpline(*closed, bc_type="periodic"))
    return bends


def _exact(mechanism: Mechanism) -> list[str]:
    """Cams whose tip is no print."""
    return (
        [joint.name for joint in mechanism.model.joints if isinstance(joint, Cam)]
        if mechanism.assembly.follower.roller
        else []
    )


def _holes(mechanism: Mechanism, outputs: Sequence[Output]) -> dict[str, Place]:
    """Holes whose centres are places of outputs and make no joint."""
    marks = [each.eye for each in mechanism.assembly.features if isinstance(each, Mark)]
    made = [
        (mount.body, mount.place(eye.at))
        for eye in marks
        for mount in mechanism.assembly.mounts
        if mount.part == eye.part
    ]
    holes: dict[str, Place] = {}
    for output in outputs:
        for place in places_of(output.of):
            if any(body == place.body and abs(at - place.at) < SAME_POINT for body, at in made):
                if hole_at(mechanism.model, place, holes) is None:
                    points = mechanism.model.body(place.body).points
                    name = next(
                        (name for name, at in points.items() if abs(at - place.at) < SAME_POINT),
                        output.name,
                    )
                    holes[f"{name}, {place.body}"] = place
    return holes


@dataclass(frozen=True)
class Copies:
    """Printed copies of a machine: worst error of each output, (n,) in its own unit; loosest and tightest play of each pair of
    contacts, (n,), and the air at both tips that frees it, mm; play of the joints at each output; tight: whether some pin does
    not go in."""

    errors: Mapping[str, Floats]
    held: Mapping[tuple[str, str], tuple[Floats, Floats, Floats]]
    play: Mapping[str, Floats]
    tight: Any


def copies_of(spread: Spread, samples: int, seed: int) -> Copies:
    """So many copies; by first order, in blocks."""
    machine = spread.mechanism.model
    chance = np.random.default_rng(seed)
    sizes = np.array([mode.size for mode in spread.modes])
    pins = [
        joint
        for joint in machine.joints
        if joint.clearance > 0 and isinstance(joint, Pin | Slot | Slide)
    ]
    errors = {output.name: np.empty(samples) for output in spread.outputs}
    play = {output.name: np.zeros(samples) for output in spread.outputs}
    held = {
        (output.name, cam): (np.empty(samples), np.empty(samples), np.empty(samples))
        for output in spread.outputs
        for cam in spread.found[output.name].held
    }
    tight = np.zeros(samples, bool)
    for begin in range(0, samples, _CHUNK):
        block = slice(begin, min(begin + _CHUNK, samples))
        drawn = _drawn(chance, sizes)[: block.stop - begin]
        fits = np.array([pin.clearance for pin in pins])
        gaps = fits + chance.standard_normal((_CHUNK, len(pins)))[
            : block.stop - begin
        ] * spread.sizes.hole * math.sqrt(2)
        tight[block] = np.any(gaps < 0, axis=1)
        for output in spread.outputs:
            found = spread.found[output.name]
            moved = found.modes
            if np.iscomplexobj(moved):
                errors[output.name][block] = np.sqrt(
                    np.max((drawn @ moved.real) ** 2 + (drawn @ moved.imag) ** 2, axis=1)
                )
            else:
                made = drawn @ moved
                errors[output.name][block] = np.maximum(made.max(axis=1), -made.min(axis=1))
            reach = (
                np.stack([found.reach[pin.name] for pin in pins])
                if pins
                else np.zeros((0, len(spread.theta)))
            )
            if pins:
                play[output.name][block] = np.max(np.maximum(gaps, 0) @ reach, axis=1)
            for cam, (gap, air) in found.held.items():
                loose, least, needed = held[output.name, cam]
                between = drawn @ gap
                moving = (
                    air > _NOTHING * air.max()
                )  # elsewhere the output stands still, whatever the follower does
                needed[block] = np.maximum(
                    0.0, -(between[:, moving] / air[moving]).min(axis=1, initial=0.0)
                )
                between += spread.air.get(cam, 0.0) * air
                loose[block] = between.max(axis=1)
                least[block] = between.min(axis=1)
    return Copies(errors, held, play, tight)


def _drawn(chance: np.random.Generator, sizes: Floats) -> Floats:
    """Errors of a block of copies, (copies, modes), mm."""
    return np.asarray(chance.standard_normal((_CHUNK, len(sizes))) * sizes)


def drawn_again(spread: Spread, seed: int, which: Sequence[int]) -> Floats:
    """Errors of some copies, (copies, modes), as `copies_of` drew them."""
    chance = np.random.default_rng(seed)
    sizes = np.array([mode.size for mode in spread.modes])
    pins = sum(
        joint.clearance > 0 and isinstance(joint, Pin | Slot | Slide)
        for joint in spread.mechanism.model.joints
    )
    rows = np.empty((len(which), len(sizes)))
    wanted = dict(zip(which, range(len(which)), strict=True))
    for begin in range(0, max(which, default=-1) + 1, _CHUNK):
        block = _drawn(chance, sizes)
        chance.standard_normal((_CHUNK, pins))
        for k in [k for k in wanted if begin <= k < begin + _CHUNK]:
            rows[wanted[k]] = block[k - begin]
    return rows


# ---- the worst, really made ------------------------------------------------------------------------------------------


def rolled_outputs(spread: Spread, errors: Floats) -> dict[str, Any]:
    """Outputs of copies with these errors, (copies, modes) mm, over theta, less those of one without: by rolling and closing.

    Returns (copies, n) each, in the output's own unit.
    """
    if spread.mechanism.assembly.tracks:
        return {spread.outputs[0].name: _drum_copies(spread).outputs(errors)}
    exact = _run(spread, np.zeros(len(spread.modes)))
    made = [_run(spread, each) for each in errors]
    return {
        output.name: np.array([each[output.name] - exact[output.name] for each in made])
        for output in spread.outputs
    }


def _drum_copies(spread: Spread) -> DrumCopies:
    """Of a cylinder cam."""
    from camgen.machines.cylinder_cam.mechanism import CylinderCam
    from camgen.tolerance.drum_copies import DrumCopies

    mechanism = spread.mechanism
    assert isinstance(mechanism, CylinderCam)
    key = mechanism.pieces.corner if mechanism.pieces else None
    samples = len(spread.theta) - 1
    return DrumCopies(mechanism.track, spread.modes, spread.sizes.waves, samples, key)


def laws_of(
    spread: Spread, errors: Floats, shifted: Machine
) -> dict[str, tuple[CamOutline, RollingLaw | PlateLaw]]:
    """Of each cam of one copy what its follower rolls to on the displaced outline, and the outline with its own tip; shifted: the
    machine with its joints' centres off, see `shifted_by`."""
    from camgen.judge.cams import outline_and_law

    mechanism = spread.mechanism
    given: dict[str, dict[str, list[float]]] = {}
    for mode, error in zip(spread.modes, errors, strict=True):
        given.setdefault(mode.where, {}).setdefault(mode.kind, []).append(float(error))
    laws = {}
    first = mechanism.assembly.outlines
    for joint in shifted.joints:
        own = given.get(f"{joint.name}, 1")
        if not isinstance(joint, Cam) or own is None:
            continue
        outline = first[joint.name]
        mount = [
            m for m in mechanism.assembly.mounts if (m.part, m.body) == (outline.part, joint.cam)
        ][outline.copy]
        edge = mechanism.assembly.touched(outline).outer.counter_clockwise()
        points = facet_contour(edge, mechanism.accuracy.chord_tolerance)
        ahead = np.roll(points, -1) - np.roll(points, 1)
        normals = -1j * ahead / np.abs(ahead)
        places = np.array([mount.place(z) for z in points])
        turned = np.exp(1j * mount.angle) * (-normals.conjugate() if mount.flipped else normals)
        amounts = [*own["offset"], *own["bore"], *own["form"]]
        off = np.asarray(amounts) @ waviness(places, turned, spread.sizes.waves)
        ring = Ring(points + off * normals, np.zeros(len(points)))
        wider = own.get("tip", [0.0])[0]
        if isinstance(outline.tip, Eye):
            radius = None if outline.radius is None else outline.radius + wider
            tip = replace(outline.tip, diameter=outline.tip.diameter + 2 * wider)
            outline = replace(
                outline, tip=tip if outline.radius is None else outline.tip, radius=radius
            )
        laws[joint.name] = (
            outline,
            outline_and_law(
                shifted,
                outline,
                mechanism.assembly.mounts,
                [[Shape(ring, ())]],
                mechanism.assembly.shoe(outline),
            )[1],
        )
    return laws


def _run(spread: Spread, errors: Floats) -> dict[str, Any]:
    """Outputs of one copy."""
    shifted = shifted_by(spread, errors)
    laws = laws_of(spread, errors, shifted)
    joints = tuple(
        replace(j, law=laws[j.name][1]) if isinstance(j, Cam) and j.name in laws else j
        for j in shifted.joints
    )
    system = Constraints(replace(shifted, joints=joints))
    closed = close(system, spread.theta, solve(spread.mechanism.model, spread.theta, 0).poses(), 1)
    return {output.name: system.output(output.name, closed.q)[0] for output in spread.outputs}


def shifted_by(spread: Spread, errors: Floats) -> Machine:
    """The machine with its joints' centres off by the errors."""
    machine = spread.mechanism.model
    moved: dict[str, complex] = {}
    for mode, error in zip(spread.modes, errors, strict=True):
        if mode.kind == "centre":
            moved[mode.where] = moved.get(mode.where, 0j) + mode.along * float(error)
    joints: list[Joint] = []
    for joint in machine.joints:
        if isinstance(joint, Pin):
            a, b = (
                replace(p, at=p.at + moved.get(f"{joint.name}, {p.body}", 0j))
                for p in (joint.a, joint.b)
            )
            joints.append(replace(joint, a=a, b=b))
        elif isinstance(joint, Slot | Slide):
            r, g = (
                replace(p, at=p.at + moved.get(f"{joint.name}, {p.body}", 0j))
                for p in (joint.runner, joint.guide)
            )
            joints.append(replace(joint, runner=r, guide=g))
        else:
            joints.append(joint)

    def off(place: Place) -> Place:
        """A place of an output, with the hole that is there."""
        return replace(
            place, at=place.at + moved.get(hole_at(machine, place, spread.holes) or "", 0j)
        )

    outputs = tuple(replace(each, of=placed(each.of, off)) for each in machine.outputs)
    return replace(machine, joints=tuple(joints), outputs=outputs)
