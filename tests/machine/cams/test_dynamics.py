"""An elastic follower against the shock spectra of textbooks and closed solutions."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgen.machine.cams.dynamics import Elastic, Excitation, residual
from camgen.motion.laws import LAWS

RATIOS = (0.3, 0.8, 1.3, 2.2, 3.7)  # of a pulse's length to the natural period


@pytest.mark.parametrize("ratio", RATIOS)
def test_residual_spectra_of_harris(ratio: float) -> None:
    """Harris, Shock and Vibration Handbook (Ayre): residual response to pulses of length tau over the static one, T a period:
    rectangle 2 sin(pi r), half sine 4 r cos(pi r) / (1 - 4 r^2), versed sine sin(pi r) / (1 - r^2), r = tau / T."""
    span, frequency = 0.7, math.tau * ratio / 0.7
    static = 1 / frequency**2  # of a unit of acceleration
    turn = math.pi * ratio
    for pulse, wanted in (
        (lambda t: np.ones_like(t), 2 * math.sin(turn)),
        (lambda t: np.sin(math.pi * t / span), 4 * ratio * math.cos(turn) / (1 - 4 * ratio**2)),
        (lambda t: (1 - np.cos(math.tau * t / span)) / 2, math.sin(turn) / (1 - ratio**2)),
    ):
        assert residual(pulse, span, frequency) / static == pytest.approx(
            abs(wanted), rel=1e-9, abs=1e-12
        )


@pytest.mark.parametrize("periods", [2, 3, 5])
def test_a_cycloid_of_whole_periods_leaves_nothing(periods: int) -> None:
    """One whole sine of acceleration, over a whole number of periods but one: textbook, its Fourier integral is 0."""
    law = LAWS["cycloidal"]
    left = residual(lambda t: law(t, 2), 1.0, math.tau * periods)
    assert left < 1e-9 and residual(lambda t: law(t, 2), 1.0, math.tau) > 0.1


def test_one_harmonic_answers_by_itself() -> None:
    """x = -s'' / (w^2 - W^2 + 2 i z w W): amplitude and phase of a vibrating base, any textbook."""
    theta = np.linspace(0, math.tau, 720, endpoint=False)
    model, speed = Elastic(1.0, 50.0**2, 0.1), 12.0
    found = model.response(Excitation(np.cos(theta), -np.cos(theta)), speed)
    answer = speed**2 / (50.0**2 - speed**2 + 2j * 0.1 * 50 * speed)
    assert np.allclose(found.vibration, np.real(answer * np.exp(1j * theta)), atol=1e-12)
    assert np.allclose(
        found.acceleration, np.real(-(speed**2) * (1 + answer) * np.exp(1j * theta)), atol=1e-9
    )
    assert np.allclose(
        found.velocity, np.real(1j * speed * (1 + answer) * np.exp(1j * theta)), atol=1e-9
    )


def test_a_stiff_follower_does_what_the_cam_does() -> None:
    theta = np.linspace(0, math.tau, 720, endpoint=False)
    found = Elastic(1.0, 1e10, 0.05).response(
        Excitation(-np.sin(3 * theta) / 9, np.sin(3 * theta)), 10.0
    )
    assert np.abs(found.vibration).max() < 1e-7 and np.allclose(
        found.acceleration, 100 * np.sin(3 * theta), atol=1e-4
    )


@pytest.mark.parametrize("frequency", [1e6, 40.0])
def test_speed_at_which_an_eccentric_loses_its_follower(frequency: float) -> None:
    """s = e sin theta, pressed with F: m e W^2 w^2 / (w^2 - W^2) = F."""
    theta = np.linspace(0, math.tau, 720, endpoint=False)
    e, mass, force = 0.005, 0.4, 5.0
    rigid = force / (mass * e)
    wanted = math.sqrt(rigid * frequency**2 / (frequency**2 + rigid))
    model, cam = (
        Elastic(mass, mass * frequency**2, 0.0),
        Excitation(e * np.sin(theta), -e * np.sin(theta)),
    )
    assert model.loses_contact(cam, 10.0, np.full(720, force), 1) == pytest.approx(wanted, rel=1e-3)
    assert math.isinf(model.loses_contact(cam, 0.1, np.full(720, force), 1))
