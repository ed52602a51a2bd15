"""What followers roll to on measured outlines: levers, slopes and changes of element, against outlines that are moved."""

from __future__ import annotations

import math

import numpy as np
import pytest
from shapes import polygon, rounded

from camgen.geometry.rings import Ring
from camgen.judge.contact import contact
from camgen.judge.contact_faces import ArmFace, SlideFace
from camgen.judge.contact_tips import ArmTip, Form, SlideTip
from camgen.judge.joints import RollingLaw

THETA = np.random.default_rng(4).uniform(0, math.tau, 60)
TRIANGLE = np.array([14 - 3j, -9 + 12j, -6 - 11j])
FORMS: dict[str, tuple[Form, float | None]] = {
    "tip on an arm": (ArmTip(60 + 10j, 50 * np.exp(2.6j), 3.0, -1), 50.0),
    "tip on an arm, the other way": (ArmTip(60 - 10j, 50 * np.exp(-2.6j), 3.0, 1), 50.0),
    "face on an arm": (ArmFace(60 + 0j, np.exp(-1.2j), 4.0, 1), 40.0),
    "tip on a slide": (SlideTip(5 + 0j, 1j, 3.0, 1), None),
    "face on a slide": (SlideFace(0j, 1j, -1), None),
}


@pytest.mark.parametrize("name", FORMS)
def test_a_lever_is_what_the_follower_moves_for_an_outline_that_is_larger(name: str) -> None:
    """All round by 1 um: s grows by that over the lever, where no pressure angle is steeper than 75 deg."""
    form, arm = FORMS[name]
    here, more = (RollingLaw(contact(rounded(TRIANGLE, 5 + h), form), arm) for h in (0.0, 1e-6))
    moved = np.abs(more(THETA) - here(THETA)) / 1e-6
    steep = np.abs(here.contact.touch(THETA).pressure_angle) > math.radians(74)
    assert np.count_nonzero(~steep) > 30
    np.testing.assert_allclose(here.lever(THETA)[~steep], 1 / moved[~steep], rtol=1e-4)
    least = 0.25 * (arm or 1.0)
    assert np.min(here.lever(THETA)) >= least * (1 - 1e-12)
    assert np.all(RollingLaw(here.contact, arm, least=7.0).lever(THETA) == 7.0)


def test_where_a_tip_is_pushed_nearly_along_the_outline_its_lever_is_no_less() -> None:
    """A long nose that comes round to an arm: its cosine counts as 0.25, and a face's place as a quarter of its arm."""
    long = rounded(np.array([25 + 0j, -3 + 4j, -3 - 4j]), 1.0)
    theta = np.linspace(0, math.tau, 400)
    tip = RollingLaw(contact(long, FORMS["tip on an arm"][0]), 50.0)
    angles = np.abs(tip.contact.touch(theta).pressure_angle)
    assert np.nanmax(angles) > math.radians(76)
    wanted = 50 * np.maximum(np.cos(angles), 0.25)
    np.testing.assert_allclose(tip.lever(theta), wanted)
    face = RollingLaw(
        contact(rounded(TRIANGLE, 5.0), ArmFace(60 + 0j, np.exp(-1.2j), 4.0, 1)), 500.0
    )
    assert np.all(face.lever(theta) == 125.0)  # of an arm of 500 mm it is nowhere as far out


@pytest.mark.parametrize("name", FORMS)
def test_a_slope_is_that_of_the_motion_and_is_kept(name: str) -> None:
    """On arcs, where the motion is smooth, by wider differences; asked again among others it is the same."""
    form, arm = FORMS[name]
    law = RollingLaw(contact(Ring(4 + 15 * np.array([1, -1 + 0j]), np.ones(2)), form), arm)
    wide = (law(THETA + 1e-4) - law(THETA - 1e-4)) / 2e-4
    np.testing.assert_allclose(law(THETA, 1), wide, rtol=1e-5, atol=1e-6)
    assert np.all(law(THETA, 2) == 0) and law(THETA, 2).shape == THETA.shape
    first = {k: (law(THETA + k), law(THETA + k, 1)) for k in range(12)}
    for k, (value, slope) in first.items():
        assert np.array_equal(law(THETA + k), value) and np.array_equal(law(THETA + k, 1), slope)
    assert law(THETA) is law(THETA)
    assert law(THETA[:6]).shape == (6,) and law(THETA[:6].reshape(2, 3)).shape == (2, 3)


@pytest.mark.parametrize("name", FORMS)
def test_changes_lie_beside_each_angle_at_which_another_element_is_touched(name: str) -> None:
    """On both sides of it by a hair, and nowhere else, as a dense look over the turn tells."""
    table = contact(
        polygon(25 * np.exp(2j * np.pi * np.arange(23) / 23 + 0.02j) + 3), FORMS[name][0]
    )
    theta = np.linspace(0, math.tau, 50_001)
    element = table.touch(theta).element
    k = np.flatnonzero(np.diff(element))
    changes = np.sort(table.changes)
    for step in k:  # one change on either side of the step's own
        inside = changes[(changes > theta[step] - 1e-8) & (changes < theta[step + 1] + 1e-8)]
        assert len(inside) >= 2
        assert table.touch(inside[:1]).element[0] == element[step]
        assert table.touch(inside[-1:]).element[0] == element[step + 1]
        assert inside[-1] - inside[0] < 1e-8
