"""Counterweights: on a link, so that its centre of mass lies where it is wanted; on a crank, so that its bearing bears least.

Places complex mm in the body's frame, masses kg.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from camgen.machine.model import MM, Body, Floats, Points


def together(body: Body, *others: Body) -> Body:
    """The body with others that are fixed on it; all in its frame."""
    bodies = (body, *others)
    mass = sum(each.mass for each in bodies)
    if not mass:
        return body
    centre = sum(each.mass * each.centre for each in bodies) / mass
    inertia = sum(
        each.inertia + each.mass * abs((each.centre - centre) * MM) ** 2 for each in bodies
    )
    return replace(body, mass=mass, centre=centre, inertia=inertia)


def with_weight(body: Body, mass: float, place: complex) -> Body:
    """The body and a point mass, as one."""
    return together(body, Body(body.name, mass=mass, centre=place)) if mass else body


def balanced(
    body: Body, about: complex, radius: float, carried: float = 0.0, at: complex = 0
) -> Body:
    """The body with a counterweight `radius` mm from `about`, sized so that the centre of mass comes to lie there.

    carried, at: a further mass that hangs at a place of the body and is balanced along with it.
    """
    moment = body.mass * (body.centre - about) + carried * (at - about)
    size = abs(moment)
    return body if size == 0 else with_weight(body, size / radius, about - moment / size * radius)


def crank_weight(force: Points, theta: Floats, speed: float) -> tuple[complex, float]:
    """Counterweight on an evenly turning crank that least loads its ground pin: mass times place, and the peak left.

    force: reaction on the crank, (n,) complex N, at crank angles theta. Returns the moment (complex kg mm, in axes that
    turn by theta) and the greatest remaining reaction, N. Seen from the crank the counterweight pulls with one
    constant force, so the best is the centre of the smallest circle round all reactions: no other weight does better.
    """
    turning = force * np.exp(-1j * theta)
    centre, radius = smallest_circle(turning[np.isfinite(turning)])
    return centre / (speed**2 * MM), radius


def smallest_circle(points: Points) -> tuple[complex, float]:
    """Centre and radius of the smallest circle round points, (n,) complex, n >= 1.

    Takes in the farthest point outside until none is left; the circle grows each time, so it ends. What is outside by no more
    than rounding counts as inside: points may all be one.
    """
    rounding = 1e-12 * float(np.abs(points).max(initial=0.0))
    support = [complex(points[0])]
    while True:
        centre, radius = _circle_round(support)
        away = np.abs(points - centre)
        far = int(np.argmax(away))
        if away[far] <= radius * (1 + 1e-12) + rounding:
            return centre, radius
        on_edge = [p for p in support if abs(p - centre) >= radius * (1 - 1e-9)]
        support = [*on_edge, complex(points[far])]


def _circle_round(few: Sequence[complex]) -> tuple[complex, float]:
    """Smallest circle round up to a handful of points: the best of all that two or three of them span."""
    if len(few) == 1:
        return few[0], 0.0
    centres = [(a + b) / 2 for a, b in combinations(few, 2)]
    for a, b, c in combinations(few, 3):
        b = b - a
        c = c - a
        area = 2 * (b.conjugate() * c).imag
        if area:
            centres.append(a + 1j * (b * abs(c) ** 2 - c * abs(b) ** 2) / area)
    return min(
        ((centre, max(abs(p - centre) for p in few)) for centre in centres),
        key=lambda circle: circle[1],
    )
