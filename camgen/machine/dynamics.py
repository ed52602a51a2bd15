"""Forces in a linkage that runs: reactions in its joints, the driving torque, and the counterweights that tame them.

    body      a rigid link on two points of a linkage, with mass, centre of mass and central moment of inertia
    pin       a turning joint at a point, between two bodies or a body and the ground
    slide     a straight guide on the ground that holds a body against turning and across the guide
    reaction  force of the second partner of a pin on the first, N

Units: points in mm, masses in kg, inertia in kg m^2; forces in N, torques in N m, energy in J. Every body is cut free:
force and moment balance of all bodies are one linear system for each angle. Friction and gravity are left out.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from camgen.machine.linkages import Floats, Jet, Points, direction
from camgen.numerics import solve

MM = 1e-3


@dataclass(frozen=True)
class Body:
    """A rigid link; its axes have their origin at point a and x towards point b.

    mass kg; centre: centre of mass in the axes, complex mm; inertia: about the centre of mass, kg m^2.
    """

    a: str
    b: str
    mass: float
    centre: complex = 0
    inertia: float = 0.0

    def with_weight(self, mass: float, place: complex) -> Body:
        """The body and a point mass (kg) at a place in its axes (complex mm), as one."""
        if mass == 0:
            return self
        total = self.mass + mass
        centre = (self.mass * self.centre + mass * place) / total
        spread = self.mass * abs(self.centre - centre) ** 2 + mass * abs(place - centre) ** 2
        return Body(self.a, self.b, total, centre, self.inertia + spread * MM**2)

    def balanced(self, about: complex, radius: float, carried: float = 0.0, at: complex = 0) -> Body:
        """The body with a counterweight `radius` mm from `about`, sized so that the centre of mass comes to lie there.

        carried, at: a further mass (kg) that hangs at a place of the body and is balanced along with it.
        """
        moment = self.mass * (self.centre - about) + carried * (at - about)
        size = abs(moment)
        return self if size == 0 else self.with_weight(size / radius, about - moment / size * radius)


@dataclass(frozen=True)
class Pin:
    """A turning joint at `point`: its reaction is the force of `by` (None: the ground) on `on`."""

    point: str
    on: str
    by: str | None = None


@dataclass(frozen=True)
class Slide:
    """A guide on the ground for a body that shifts along `angle` (rad) and does not turn; its force acts at `point`."""

    point: str
    on: str
    angle: float


@dataclass(frozen=True)
class Forces:
    """What a running linkage bears, each (n,): nan where it is not assembled or stands at a dead point.

    reactions: of each pin by its point, complex N. normals, moments: of each slide by its point, N to the left of the
    guide, and N m. torque: what drives, N m. energy: kinetic, J. power: its rate of change, W. shaking: the inertia
    force of all bodies, complex N.
    """

    reactions: Mapping[str, Points]
    normals: Mapping[str, Floats]
    moments: Mapping[str, Floats]
    torque: Floats
    energy: Floats
    power: Floats
    shaking: Points


def kinetostatics(
    jets: Mapping[str, Jet],
    bodies: Mapping[str, Body],
    pins: Sequence[Pin],
    slides: Sequence[Slide],
    driven: str,
    speed: float,
) -> Forces:
    """Reactions and torque of a linkage whose crank `driven` turns evenly at `speed`, rad/s.

    jets: points with two derivatives to theta, (3, n), mm. Three balances a body must meet two unknowns a pin, two a
    slide and the torque: ValueError where they do not, as the linkage is then not one of a single drive.
    """
    columns = 2 * len(pins) + 2 * len(slides) + 1
    if columns != 3 * len(bodies):
        raise ValueError(f"{columns} unknown forces for {3 * len(bodies)} balances")
    n = next(iter(jets.values())).shape[1]
    row = {name: 3 * k for k, name in enumerate(bodies)}
    system, load = np.zeros((n, columns, columns)), np.zeros((n, columns))
    energy, power, shaking = np.zeros(n), np.zeros(n), np.zeros(n, complex)
    centres: dict[str, Points] = {}
    slid = {slide.on for slide in slides}

    for name, body in bodies.items():
        # A slider's two points may be one: it does not turn.
        angle = np.zeros((3, n)) if name in slid else direction(jets[body.a], jets[body.b])
        turn, w, alpha = np.exp(1j * angle[0]), angle[1], angle[2]
        arm = turn * body.centre
        centres[name] = (jets[body.a][0] + arm) * MM
        v = (jets[body.a][1] + 1j * w * arm) * (speed * MM)
        a = (jets[body.a][2] + (1j * alpha - w * w) * arm) * (speed**2 * MM)
        load[:, row[name]], load[:, row[name] + 1] = body.mass * a.real, body.mass * a.imag
        load[:, row[name] + 2] = body.inertia * alpha * speed**2
        energy += 0.5 * (body.mass * np.abs(v) ** 2 + body.inertia * (w * speed) ** 2)
        power += body.mass * (np.conj(v) * a).real + body.inertia * w * alpha * speed**3
        shaking -= body.mass * a

    def push(name: str, column: int, where: Points, force: complex) -> None:
        """Enter a unit force on a body: its parts and its moment about the centre of mass."""
        r = where - centres[name]
        system[:, row[name], column] += force.real
        system[:, row[name] + 1, column] += force.imag
        system[:, row[name] + 2, column] += (np.conj(r) * force).imag

    for k, pin in enumerate(pins):
        where = jets[pin.point][0] * MM
        for column, force in ((2 * k, 1 + 0j), (2 * k + 1, 1j)):
            push(pin.on, column, where, force)
            if pin.by is not None:
                push(pin.by, column, where, -force)
    for k, slide in enumerate(slides, len(pins)):
        push(slide.on, 2 * k, jets[slide.point][0] * MM, 1j * complex(np.exp(1j * slide.angle)))
        system[:, row[slide.on] + 2, 2 * k + 1] = 1
    system[:, row[driven] + 2, -1] = 1

    solution = np.full((n, columns), math.nan)
    able: NDArray[np.bool_] = np.isfinite(np.concatenate([system.reshape(n, -1), load], axis=1)).all(axis=1)
    solution[able] = solve(system[able], load[able])
    able = np.isfinite(solution).all(axis=1)
    energy[~able] = power[~able] = shaking[~able] = math.nan
    first = 2 * len(pins)
    return Forces(
        {pin.point: solution[:, 2 * k] + 1j * solution[:, 2 * k + 1] for k, pin in enumerate(pins)},
        {slide.point: solution[:, first + 2 * k] for k, slide in enumerate(slides)},
        {slide.point: solution[:, first + 2 * k + 1] for k, slide in enumerate(slides)},
        solution[:, -1],
        energy,
        power,
        shaking,
    )


def crank_weight(force: Points, theta: Floats, speed: float) -> tuple[complex, float]:
    """Counterweight on an evenly turning crank that least loads its ground pin: mass times place, and the peak left.

    force: reaction on the crank, (n,) complex N, at crank angles theta. Returns the moment (complex kg mm, in axes that
    turn by theta) and the greatest remaining reaction, N. Seen from the crank the counterweight pulls with one
    constant force, so the best is the centre of the smallest circle round all reactions: no other weight does better.
    """
    seen = force * np.exp(-1j * theta)
    centre, radius = smallest_circle(seen[np.isfinite(seen)])
    return centre / (speed**2 * MM), radius


def smallest_circle(points: Points) -> tuple[complex, float]:
    """Centre and radius of the smallest circle round points, (n,) complex, n >= 1.

    Takes in the farthest point outside until none is left; the circle grows each time, so it ends.
    """
    held = [complex(points[0])]
    while True:
        centre, radius = _circle_round(held)
        away = np.abs(points - centre)
        far = int(np.argmax(away))
        if away[far] <= radius * (1 + 1e-12):
            return centre, radius
        on_edge = [p for p in held if abs(p - centre) >= radius * (1 - 1e-9)]
        held = [*on_edge, complex(points[far])]


def _circle_round(few: Sequence[complex]) -> tuple[complex, float]:
    """Smallest circle round up to a handful of points: the best of all that two or three of them span."""
    if len(few) == 1:
        return few[0], 0.0
    centres = [(a + b) / 2 for a, b in combinations(few, 2)]
    for a, b, c in combinations(few, 3):
        b, c = b - a, c - a
        area = 2 * (b.conjugate() * c).imag
        if area:
            centres.append(a + 1j * (b * abs(c) ** 2 - c * abs(b) ** 2) / area)
    return min(((centre, max(abs(p - centre) for p in few)) for centre in centres), key=lambda circle: circle[1])
