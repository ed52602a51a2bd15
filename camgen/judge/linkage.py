"""The judge of linkages: links are put together on the holes that are in the files, and moved.

It knows nothing of dyads. Every body has a pose (x, y, angle); each joint says that two measured centres coincide, each
guide that one lies on a line; Newton's method closes all of it at once, from where the spec's poses put the bodies.
The same Jacobian tells how far a displacement in each joint moves the output.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from camgen import tolerances
from camgen.findings import Finding, at_most
from camgen.geometry.rings import Circle, Ring, Shape, hole_circles
from camgen.machine.contacts import Contact, Eye, Pin, Pose, Slide, Traced
from camgen.numerics import solve

Floats = NDArray[np.float64]
Points = NDArray[np.complex128]
Sections = Sequence[Sequence[Shape]]
Poses = Callable[[Floats], Mapping[str, Sequence[Pose]]]
Joint = Pin | Slide

_STEPS = 30  # of Newton's method; it needs five
_CLOSED = 1e-12  # largest misfit of a closed chain, by the size of its links and of the ground under them
_PARALLEL = 0.01  # rad, leaning more is another face
_LASH = 0.5  # of the stroke: with more play a mechanism is none
_SAME_FACE = 0.02  # of the width: faces at two heights that are further apart are two faces
_FLAT = 0.35  # of the diameter: a longer straight piece of a hole is a flat
_SAME_HOLE = 0.25  # of the diameter: a ring that is nearer than this in place and size is the eye
_HEAD = 1.0  # mm, a ring that is larger by more is a pin's head, not its shank


@dataclass(frozen=True)
class Measured:
    """An eye as found in a file: centre and free diameter, mm (a shaft's: over its vertices), and how far the centres at
    several heights lie apart."""

    centre: complex
    diameter: float
    spread: float = 0.0


def measure(eye: Eye, sections: Sections) -> Measured | None:
    """The eye in the sections of its part, at all heights at which it is there; None where no ring comes near it."""
    found: list[tuple[Circle, float]] = []
    least = min(_SAME_HOLE * eye.diameter, max(_HEAD, 0.02 * eye.diameter))
    for shapes in sections:
        for shape in shapes:
            rings: Sequence[Ring] = [shape.outer] if eye.shaft else shape.holes
            near = [ring for ring in rings if abs(ring.centroid - eye.at) <= _SAME_HOLE * eye.diameter]
            circles = hole_circles(Shape(shape.outer, tuple(near)))
            pairs = zip(circles, near, strict=True)
            found += [(c, _free(c, ring)) for c, ring in pairs if abs(c.diameter - eye.diameter) <= least]
    if not found:
        return None
    centres = np.array([c.centre for c, _ in found])
    sizes = [c.diameter if eye.shaft else free for c, free in found]
    spread = float(np.max(np.abs(centres - centres[0])))
    return Measured(complex(centres.mean()), max(sizes) if eye.shaft else min(sizes), spread)


def _free(circle: Circle, ring: Ring) -> float:
    """The free diameter of a hole's round part, mm: a flat, longer than any facet, is left out."""
    straight = ring.bulges == 0
    flat = straight & (np.abs(ring.ends - ring.points) > _FLAT * circle.diameter)
    if not flat.any():
        return circle.clear_diameter
    facets = np.abs((ring.points + ring.ends)[straight & ~flat] / 2 - circle.centre)
    return min(circle.diameter, 2 * float(facets.min(initial=np.inf)))


@dataclass(frozen=True)
class Faces:
    """Two parallel faces as found: how far their middle lies to the left of the line they were sought at, mm, how far they
    lean from it, rad, and their distance, mm."""

    offset: float
    lean: float
    width: float


def measure_faces(through: complex, angle: float, width: float, sections: Sections) -> Faces | None:
    """The two faces of a part, `width` apart, on either side of a line: the mean of all heights; None where one is missing."""
    along = complex(math.cos(angle), math.sin(angle))
    sides = []
    for side in (-1, 1):
        found = []
        for shapes in sections:
            rings = [ring for shape in shapes for ring in (shape.outer, *shape.holes)]
            a, b = (np.concatenate([getattr(ring, end)[ring.bulges == 0] for ring in rings]) for end in ("points", "ends"))
            long = np.abs(b - a) > width / 4
            start, way = (a[long] - through) / along, (b[long] - a[long]) / along
            lean = np.arctan2(np.where(way.real < 0, -way.imag, way.imag), np.abs(way.real))
            away = start.imag - start.real * np.tan(lean)  # of the face, across from `through`
            off = np.where(np.abs(lean) < _PARALLEL, np.abs(away - side * width / 2), np.inf)
            nearest = int(np.argmin(off)) if len(off) else 0
            if len(off) and off[nearest] < _SAME_HOLE * width:
                found.append((off[nearest], away[nearest], lean[nearest]))
        if not found:
            return None
        face = [row[1:] for row in found if row[0] <= min(found)[0] + _SAME_FACE * width]
        sides.append(np.mean(face, axis=0))
    right, left = sides
    return Faces(float(left[0] + right[0]) / 2, float(left[1] + right[1]) / 2, float(left[0] - right[0]))


@dataclass(frozen=True)
class Guide:
    """A measured guide: its line on the ground, the eye's place to the left of the part's middle, the part's angle on it."""

    through: complex
    angle: float
    eye: float
    turn: float
    play: float


def measure_guide(
    slide: Slide, files: Mapping[str, Sections], given: Mapping[str, Pose], eye: complex, drawing: bool
) -> Guide | None:
    """A guide as the files show it, None where a face is lost; rails that a drawing does not show count as meant.

    eye: the measured centre of the slide's eye.
    """
    assert slide.eye.part is not None
    part, base = given[slide.eye.part], given[slide.rails]
    turn, shift = float(base.angle[0]), complex(base.position[0])
    sought = (slide.through - shift) * complex(math.cos(turn), -math.sin(turn))
    wide = slide.width + slide.clearance
    hidden = drawing and not slide.drawn
    rails = Faces(0.0, 0.0, wide) if hidden else measure_faces(sought, slide.angle - turn, wide, files[slide.rails])
    own = slide.angle - float(part.angle[0])
    block = measure_faces(slide.eye.at, own, slide.width, files[slide.eye.part])
    if rails is None or block is None:
        return None
    across = 1j * complex(math.cos(slide.angle), math.sin(slide.angle))
    aside = ((eye - slide.eye.at) * complex(math.cos(own), -math.sin(own))).imag - block.offset
    return Guide(
        slide.through + across * rails.offset, slide.angle + rails.lean, aside,
        float(part.angle[0]) + rails.lean - block.lean, rails.width - block.width,
    )  # fmt: skip


@dataclass(frozen=True)
class Closed:
    """A chain closed at n angles: nan where it does not close.

    output: (n,) mm; slope: to theta; shares: by joint, (n,) largest movement of the output per mm of displacement there.
    """

    output: Floats
    slope: Floats
    shares: Mapping[str, Floats]


class Chain:
    """Bodies and joints with their measured centres, ready to be closed at any angle."""

    def __init__(
        self, joints: Sequence[Joint], traced: Traced, poses: Poses, centres: Mapping[Eye, complex], guides: Mapping[str, Guide]
    ) -> None:
        self.joints, self.traced, self.poses, self.centres, self.guides = joints, traced, poses, centres, guides
        named = [traced.crank, *(eye.part for joint in joints for eye in _eyes(joint))]
        self.bodies = [name for name in dict.fromkeys(named) if name is not None and name not in traced.ground]
        equations = 2 * len(joints) + 1
        if equations != 3 * len(self.bodies):
            raise ValueError(f"{equations} conditions for {len(self.bodies)} bodies with 3 freedoms each")

    def close(self, theta: Floats) -> Closed:
        """Close the chain at theta, (n,) rad."""
        given = {name: copies[0] for name, copies in self.poses(theta).items()}
        q = np.zeros((len(theta), 3 * len(self.bodies)))
        for k, name in enumerate(self.bodies):
            pose = given[name]
            q[:, 3 * k : 3 * k + 3] = np.column_stack([pose.position.real, pose.position.imag, pose.angle])
        open_ = ~np.isfinite(q).all(axis=1)
        q[open_] = 0
        for _ in range(_STEPS):
            misfit, slope = self._conditions(q, given)
            step = solve(slope, misfit)
            open_ |= ~np.isfinite(step).all(axis=1)
            step[open_] = 0
            q -= step
            if np.abs(step).max(initial=0) <= 1e-14 * (1 + np.abs(q).max(initial=0)):
                break
        misfit, slope = self._conditions(q, given)
        size = max(1.0, np.abs(q).max(initial=0), *(abs(centre) for centre in self.centres.values()))
        open_ |= ~(np.abs(misfit).max(axis=1, initial=0) <= _CLOSED * size)
        return self._output(q, slope, open_, given)

    def _local(self, eye: Eye, given: Mapping[str, Pose]) -> complex:
        """The eye's measured centre in the frame of its body, a turned-over body's mirrored."""
        centre = self.centres[eye]
        return -centre.conjugate() if eye.part is not None and given[eye.part].flipped else centre

    def _place(self, eye: Eye, q: Floats, given: Mapping[str, Pose]) -> tuple[Points, Points, int]:
        """An eye's place on the ground and its slope to the body's angle, (n,), and the body's first column (-1: ground)."""
        local = self._local(eye, given)
        if eye.part in self.bodies:
            k = 3 * self.bodies.index(eye.part)
            spoke = local * np.exp(1j * q[:, k + 2])
            return q[:, k] + 1j * q[:, k + 1] + spoke, 1j * spoke, k
        still: Points = np.full(len(q), local)
        if eye.part is not None:
            pose = given[eye.part]
            still = pose.position + np.exp(1j * pose.angle) * local
        return still, np.zeros(len(q), complex), -1

    def _conditions(self, q: Floats, given: Mapping[str, Pose]) -> tuple[Floats, Floats]:
        """Misfit of every condition, (n, m), and its slopes to all poses, (n, m, m); the crank's angle comes last."""
        n, size = q.shape
        misfit, slope = np.zeros((n, size)), np.zeros((n, size, size))

        def turn(row: int, part: str, angle: Floats | float) -> None:
            column = 3 * self.bodies.index(part) + 2
            misfit[:, row] = q[:, column] - angle
            slope[:, row, column] = 1

        for j, joint in enumerate(self.joints):
            row = 2 * j
            if isinstance(joint, Slide):
                guide = self.guides[joint.name]
                place, swing, k = self._place(joint.eye, q, given)
                across = complex(-math.sin(guide.angle), math.cos(guide.angle))
                misfit[:, row] = np.real(np.conj(across) * (place - guide.through)) - guide.eye
                slope[:, row, k : k + 2] = across.real, across.imag
                slope[:, row, k + 2] = np.real(np.conj(across) * swing)
                assert joint.eye.part is not None
                turn(row + 1, joint.eye.part, guide.turn)
                continue
            for eye, sign in ((joint.a, 1), (joint.b, -1)):
                place, swing, k = self._place(eye, q, given)
                misfit[:, row] += sign * place.real
                misfit[:, row + 1] += sign * place.imag
                if k >= 0:
                    slope[:, row, k] += sign
                    slope[:, row + 1, k + 1] += sign
                    slope[:, row, k + 2] += sign * swing.real
                    slope[:, row + 1, k + 2] += sign * swing.imag
        turn(size - 1, self.traced.crank, given[self.traced.crank].angle)
        return misfit, slope

    def _output(self, q: Floats, slope: Floats, open_: NDArray[np.bool_], given: Mapping[str, Pose]) -> Closed:
        path, swing, k = self._place(self.traced.eye, q, given)
        places = [self._place(eye, q, given)[0] for eye in self.traced.still]
        steep = self.traced.gradient(path, *places)
        to_pose = np.zeros(q.shape)
        to_pose[:, k], to_pose[:, k + 1] = steep.real, steep.imag
        to_pose[:, k + 2] = np.real(np.conj(steep) * swing)
        shares = solve(np.swapaxes(slope, 1, 2), to_pose)  # d output / d misfit of each condition
        output = np.where(open_, np.nan, self.traced.output(path, *places))
        shares[open_] = np.nan
        by_joint = {
            joint.name: np.abs(shares[:, 2 * j]) if isinstance(joint, Slide) else np.hypot(*shares[:, 2 * j : 2 * j + 2].T)
            for j, joint in enumerate(self.joints)
        }
        return Closed(output, shares[:, -1], by_joint)


def _eyes(joint: Joint) -> tuple[Eye, ...]:
    return (joint.eye,) if isinstance(joint, Slide) else (joint.a, joint.b)


def eyes_of(part: str, contacts: Sequence[Contact]) -> tuple[tuple[complex, float], ...]:
    """Nominal centres and diameters of a part's eyes in its joints, mm."""
    joints = [eye for contact in contacts if isinstance(contact, Pin | Slide) for eye in _eyes(contact)]
    still = [eye for contact in contacts if isinstance(contact, Traced) for eye in contact.still]
    return tuple((eye.at, eye.diameter) for eye in (*joints, *still) if eye.part == part)


# ---- findings --------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Verdict:
    """Findings and numbers from one kind of file, and the chain closed on it (None where it cannot be)."""

    findings: tuple[Finding, ...]
    numbers: Mapping[str, float]
    chain: Chain | None = None
    plays: Mapping[str, float] | None = None

    def band(self, closed: Closed) -> Floats:
        """How far the play of all joints together can move the output either way, (n,) mm: worst case, first order."""
        assert self.plays is not None
        total: Floats = np.zeros(closed.output.shape)
        for name, share in closed.shares.items():
            total = total + share * max(self.plays[name], 0.0) / 2
        return total


def judge_linkage(
    kind: str,
    where: str,
    files: Mapping[str, Sections],
    contacts: Sequence[Contact],
    poses: Poses,
    motion: Callable[[Floats, int], Floats],
    theta: Floats,
    chord_tolerance: float,
    slack: float = 0.0,
) -> Verdict:
    """Fit of the pins, and the motion and stroke of the linkage closed on the measured holes, against the wanted ones.

    files: sections of each part's file of this kind; theta: judged crank angles, (n,) rad; slack: mm, what the way back from
    a print compensation may cost a fit.
    The limit of motion and stroke is what one joint's centre off by the chord tolerance can do at the worst angle.
    """
    joints = [contact for contact in contacts if isinstance(contact, Pin | Slide)]
    (traced,) = (contact for contact in contacts if isinstance(contact, Traced))
    rounding = 0.0 if kind == "dxf" else tolerances.FLOAT32_ROUNDING * _size(files)
    eyes = [eye for joint in joints for eye in _eyes(joint)]
    eyes += [joint.pin for joint in joints if isinstance(joint, Pin) and joint.pin is not None]
    eyes += [traced.eye, *traced.still]
    found = {
        eye: measure(eye, files[eye.part]) if eye.part and eye.diameter else Measured(eye.at, eye.diameter)
        for eye in dict.fromkeys(eyes)
    }
    given = {name: copies[0] for name, copies in poses(theta[:1]).items()}
    lost = [f"no eye of {e.diameter:g} mm near {e.at:.3f} in {e.part}" for e, place in found.items() if place is None]
    guides = {}
    for slide in (joint for joint in joints if isinstance(joint, Slide)):
        eye = found[slide.eye]
        guide = None if eye is None else measure_guide(slide, files, given, eye.centre, kind == "dxf")
        if guide is None:
            lost.append(f"{slide.name}: a face or its eye is lost")
        else:
            guides[slide.name] = guide
    if lost:
        return Verdict((at_most("PIN_GAP", math.nan, 0, "mm", where, "; ".join(lost)),), {})
    held = {eye: place for eye, place in found.items() if place is not None}
    plays = {joint.name: guides[joint.name].play if isinstance(joint, Slide) else _play(joint, held) for joint in joints}
    findings = [_fit(joints, held, plays, 2 * chord_tolerance + 4 * rounding + slack, where)]

    chain = Chain(joints, traced, poses, {eye: place.centre for eye, place in held.items()}, guides)
    closed = chain.close(theta)
    share = {name: float(np.nanmax(s, initial=0.0)) for name, s in closed.shares.items()}
    limit = chord_tolerance * max(share.values()) * (1 + tolerances.BOUND_SPARE) + 2 * rounding * sum(share.values())
    error = np.where(np.isnan(closed.output), np.inf, np.abs(closed.output - motion(theta, 0)))
    worst = int(np.argmax(error))
    remark = f"{traced.name}: linkage closed on the measured centres at {len(theta)} crank angles"
    if np.isinf(error).any():
        remark += f"; it does not close at {np.count_nonzero(np.isinf(error))} of them"
    place = f"{where}, crank angle {math.degrees(theta[worst]):.3f} deg"
    findings.append(at_most("MOTION_ERROR", error[worst], limit, "mm", place, remark))
    numbers = {f"motion_error_{kind}_mm": float(error[worst])}
    if np.isinf(error).any():
        return Verdict(tuple(findings), numbers)
    verdict = Verdict(tuple(findings), numbers, chain, plays)
    band = numbers[f"clearance_band_{kind}_mm"] = float(np.max(verdict.band(closed)))

    def recovered(t: Floats) -> tuple[Floats, Floats]:
        again = chain.close(t)
        return again.output, again.slope

    made = _stroke(theta, closed.output, recovered)
    meant = _stroke(theta, motion(theta, 0), lambda t: (motion(t, 0), motion(t, 1)))
    numbers[f"stroke_recovered_{kind}_mm"] = made
    half = made * _LASH
    cause = "limits.lash" if traced.lash < half else "half of the stroke: with more it is no mechanism"
    remark = f"free play of the output, by that of all joints at the worst angle; the limit is {cause}"
    findings.append(at_most("LASH", 2 * band, min(traced.lash, half), "mm", where, remark))
    if traced.stroke:
        remark = f"{made:.6f} mm recovered, {meant:.6f} mm wanted"
        findings.append(at_most("STROKE_ERROR", abs(made - meant), limit, "mm", where, remark))
    return Verdict(tuple(findings), numbers, chain, plays)


def _size(files: Mapping[str, Sections]) -> float:
    return max(float(np.abs(shape.outer.points).max()) for sections in files.values() for shapes in sections for shape in shapes)


def _play(joint: Pin, held: Mapping[Eye, Measured]) -> float:
    """Measured diametral play of a turning joint, mm."""
    a, b = held[joint.a].diameter, held[joint.b].diameter
    if joint.pin is not None:
        return a + b - 2 * held[joint.pin].diameter
    return b - a if joint.a.shaft else a - b


def _fit(joints: Sequence[Joint], held: Mapping[Eye, Measured], plays: Mapping[str, float], limit: float, where: str) -> Finding:
    """The joint that fits worst: play against the spec's, each hole's own size, its centres at several heights.

    Each hole by itself, for one that is too tight is not mended by another one that is too wide. Two holes' play on one pin
    counts by the half.
    """
    fits = {joint.name: 1 if getattr(joint, "pin", None) is None else 2 for joint in joints}  # a pin is in two holes
    misfit = {joint.name: abs(plays[joint.name] - joint.clearance) / fits[joint.name] for joint in joints}
    for joint in joints:
        for eye in _eyes(joint):
            size = abs(held[eye].diameter - eye.diameter) if eye.part and eye.diameter else 0.0
            misfit[joint.name] = max(misfit[joint.name], held[eye].spread, size)
    worst = max(joints, key=lambda joint: misfit[joint.name])
    return at_most(
        "PIN_GAP", misfit[worst.name], limit, "mm", f"{where}, {worst.name}",
        f"play {plays[worst.name]:.4f} mm, {worst.clearance:.4f} mm wanted; worst of {len(joints)} joints, by each "
        "hole's diameter and by the centres at several heights",
    )  # fmt: skip


def _stroke(theta: Floats, output: Floats, both: Callable[[Floats], tuple[Floats, Floats]]) -> float:
    """Difference of the output's extremes, mm: from the judged angles, then by the secant of the slope."""
    ends = []
    for sign in (1, -1):
        k = int(np.argmax(sign * output))
        a, b = theta[k - 1] if k else theta[0] - (theta[1] - theta[0]), theta[(k + 1) % len(theta)]
        b = b if b > theta[k] else 2 * theta[k] - a
        t = np.array([a, b])
        value, slope = both(t)
        best = max(float(np.max(sign * value)), float(sign * output[k]))
        for _ in range(8):
            if slope[1] == slope[0]:
                break
            new = t[1] - slope[1] * (t[1] - t[0]) / (slope[1] - slope[0])
            v, s = both(np.array([new]))
            best = max(best, float(sign * v[0]))
            t, slope = np.array([t[1], new]), np.array([slope[1], s[0]])
        ends.append(sign * best)
    return ends[0] - ends[1]
