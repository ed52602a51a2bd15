"""What a shaft asks of its motor over a turn: mean torque, swing of the energy, and the spring that evens it best."""

from __future__ import annotations

import numpy as np

from camgen.numerics import Floats, from_zero, magnitude


def energy_swing(theta: Floats, torque: Floats) -> float:
    """Greatest swing of the energy, J, about the mean torque; theta: (n,) rad over a whole period, both ends; torque: N m."""
    steps = np.diff(theta)
    work = from_zero((torque[1:] + torque[:-1]) / 2 * steps)
    energy = work - work[-1] * (theta - theta[0]) / (theta[-1] - theta[0])
    return float(np.ptp(energy))


def mean_torque(theta: Floats, torque: Floats) -> float:
    """Mean over the period, N m; as above."""
    return float(np.sum((torque[1:] + torque[:-1]) / 2 * np.diff(theta)) / (theta[-1] - theta[0]))


def spring_on_shaft(angle: Floats, torque: Floats) -> tuple[float, float, float]:
    """The spring that evens the torque best: from a place on the ground to a pin of the evenly turning shaft.

    angle: the shaft's angle, (n,) rad evenly over one turn, both ends; torque: that the drive gives, (n,) N m. A spring whose
    pull grows from nothing gives the shaft k e d sin(place - phi), with e and d from the axis to its ends, by its energy
    -k e d cos(phi - place): one harmonic, the turn's first, of which it takes all.
    Returns k e d, N m, `place` of its end on the ground, rad, where its pin is at phi, and the peak that is left, N m.
    """
    first = 2 * np.mean((torque * np.exp(-1j * angle))[:-1])
    rest = torque - np.real(first * np.exp(1j * angle))
    return (
        float(np.abs(first)),
        float(np.angle(1j * np.conj(first)) % (2 * np.pi)),
        magnitude(rest),
    )
