"""Threads from post to post, on the assembly as written: whether each post holds them, and what they pass over a turn.

    THREAD_HELD     how far a post stands out above and below the groove in which the thread lies
    THREAD_CLEAR    how near a thread comes to all bodies but the posts at its ends: sideways to what reaches up or down to its
                    heights, upright to all else

A thread lies on a post's groove, on either side: off the line from axis to axis by its radius at most, which is taken off.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from camgen.files.threemf import read_3mf
from camgen.findings import Finding, Where, at_least, in_file
from camgen.geometry.distances import segments_to_sections
from camgen.geometry.mesh import Mesh, slice_mesh
from camgen.judge.assembly import standing
from camgen.machine.features import Strand, SweptMachine
from camgen.machine.model import Pose
from camgen.numerics import Floats, Points

# angles of a turn, and between the neighbours of the nearest
_STEPS = 720
_FINE = 201
_BESIDE = 0.1  # mm, above and below a groove, where what holds the thread is measured


@dataclass(frozen=True)
class _Copy:
    """A copy of a part as the file has it at theta = 0: its name, mesh, axis, and the body that it stands on."""

    name: str
    mesh: Mesh
    axis: complex
    body: str

    def sections(self, low: float, high: float) -> list[list[Points]]:
        """Rings at each height between two where its section may change."""
        z = np.unique(np.round(self.mesh.vertices[:, 2], 6))
        ends = np.unique(np.clip(z, low, high))
        return [rings for a, b in pairwise(ends) if (rings := self._cut((a + b) / 2))]

    def _cut(self, z: float) -> list[Points]:
        return [ring.points for ring in slice_mesh(self.mesh, z)]

    def radii(self, z: float) -> tuple[float, float]:
        """Least and greatest distance from its axis to its edge at a height, mm; 0 where there is nothing."""
        far = [float(r) for ring in self._cut(z) for r in np.abs(ring - self.axis)]
        return min(far, default=0.0), max(far, default=0.0)

    def at(self, place: Points | complex, pose: Pose, start: Pose) -> Points:
        """Places on the ground, (n,), as the body sees them where it stands at theta = 0."""
        turn = np.exp(1j * (start.angle - pose.angle))
        return np.asarray((place - pose.place) * turn + start.place, complex)

    def moved(self, pose: Pose, start: Pose) -> Points:
        """Its axis on the ground, (n,)."""
        return np.asarray(
            (self.axis - start.place) * np.exp(1j * (pose.angle - start.angle)) + pose.place,
            complex,
        )


def judge_strands(path: Path, machine: SweptMachine, strands: Sequence[Strand]) -> list[Finding]:
    """Findings of all threads; the file shows theta = 0."""
    copies = {
        name: _Copy(
            name, item.placed, complex(*item.transform[:2, 3]), body
        )  # a round post's axis: its part's origin
        for name, item, body in standing(read_3mf(path), machine)
    }
    return [
        finding for strand in strands for finding in _judged(strand, copies, machine, in_file(path))
    ]


def _judged(
    strand: Strand, copies: Mapping[str, _Copy], machine: SweptMachine, where: Where
) -> list[Finding]:
    names = [f"{part}-{copy + 1}" for part, copy in strand.posts]
    lost = [name for name in names if name not in copies]
    if lost:
        return [
            at_least(
                "THREAD_HELD",
                math.nan,
                strand.held,
                "mm",
                replace(where, part=lost[0]),
                "the post is not there",
            )
        ]
    posts = [copies[name] for name in names]
    findings = []
    widest = 0.0
    for post in posts:
        inner = max(
            post.radii(z)[1] for z in np.linspace(strand.low + _BESIDE, strand.high - _BESIDE, 3)
        )
        widest = max(widest, inner)
        above, below = (
            post.radii(z)[0] - inner for z in (strand.high + _BESIDE, strand.low - _BESIDE)
        )
        remark = (
            f"over the groove {strand.low:.4g} to {strand.high:.4g} mm high: a head {above:.3g}, a shoulder {below:.3g} mm; a "
            "plain post lets the thread slip: a groove holds it: parts.thread_posts.groove"
        )
        findings.append(
            at_least(
                "THREAD_HELD",
                min(above, below),
                strand.held,
                "mm",
                replace(where, part=post.name),
                remark,
            )
        )
    return [*findings, _clear(strand, posts, widest, copies, machine, where)]


def _clear(
    strand: Strand,
    posts: Sequence[_Copy],
    radius: float,
    copies: Mapping[str, _Copy],
    machine: SweptMachine,
    where: Where,
) -> Finding:
    """The nearest of all that a thread passes, and at which angle it does."""
    place = where
    best = math.inf
    for pair in pairwise(posts):
        for copy in (each for each in copies.values() if each not in pair):
            bottom = float(copy.mesh.vertices[:, 2].min())
            top = float(copy.mesh.vertices[:, 2].max())
            gap = max(strand.low - top, bottom - strand.high)
            how = "over" if top <= strand.low else "under"
            if gap >= best and gap >= strand.gap:
                continue
            level_apart = gap >= strand.gap  # in plan it may pass over it
            heights = (
                (bottom, top)
                if level_apart
                else (strand.low - strand.gap, strand.high + strand.gap)
            )
            beside, theta = _nearest(pair, copy, copy.sections(*heights), machine)
            gap, how = (gap, how) if level_apart else (beside - radius, "beside")
            if gap < best:
                best = gap
                place = replace(
                    where,
                    thing=f"thread {pair[0].name} to {pair[1].name}, {how} {copy.name}",
                    part=copy.name,
                    theta=theta % math.tau,
                    angle="nearest at",
                    digits=2,
                )
    remark = "least distance over the turn; move the thread's points, or raise the thread (parts.thread_posts.height)"
    return at_least("THREAD_CLEAR", best, strand.gap, "mm", place, remark)


def _nearest(
    pair: tuple[_Copy, _Copy],
    copy: _Copy,
    sections: Sequence[Sequence[Points]],
    machine: SweptMachine,
) -> tuple[float, float]:
    """How near the line between two axes comes to a copy's sections in plan, mm, and at which angle, rad."""
    start = machine.courses(np.zeros(1))

    def beside(theta: Floats) -> Floats:
        poses = machine.courses(theta)
        axes = (each.moved(poses[each.body], start[each.body]) for each in pair)
        a, b = (
            np.broadcast_to(copy.at(axis, poses[copy.body], start[copy.body]), theta.shape)
            for axis in axes
        )
        return segments_to_sections(a, b, sections)

    theta = np.linspace(0, math.tau, _STEPS, endpoint=False)
    theta = theta[int(np.argmin(beside(theta)))] + np.linspace(-1, 1, _FINE) * math.tau / _STEPS
    gaps = beside(theta)
    k = int(np.argmin(gaps))
    return float(gaps[k]), float(theta[k])
