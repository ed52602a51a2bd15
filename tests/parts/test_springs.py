"""Springs against textbook examples (quoted without the book at hand) and by hand."""

from __future__ import annotations

import math

import pytest

from camgen import guide
from camgen.parts.springs import ExtensionSpring, extension_spring, wound

LBF_IN = 0.1751268  # N/mm


def test_rate_of_shigleys_music_wire() -> None:
    """Shigley, Mechanical Engineering Design, ex. 10-1: wire 0.037 in, mean diameter 0.400 in, 10.5 active coils, G 11.85 Mpsi:
    4.13 lbf/in; of our wire, whose G is that of EN 10270, as many coils more as it is softer."""
    wire, mean = 0.037 * 25.4, 0.400 * 25.4
    found = extension_spring(4.13 * LBF_IN, 100.0, 101.0, mean - wire)
    assert found is not None
    index = (found.outside - found.wire) / mean
    coils = found.coils * index**3 * (wire / found.wire) ** 4  # of the book's wire and diameter
    assert coils * 11.85e6 * 6.894757e-3 / 81500 == pytest.approx(10.5, abs=0.03)


def test_stress_of_shigleys_spring() -> None:
    """The same example: C = 10.8, K_B = 1.124; 6.46 lbf brings the wire to its torsional yield, 146 kpsi. EN 13906's curvature
    factor is the same one, Bergstraesser's; Wahl's is another, which is named nowhere."""
    wire, mean = 0.037 * 25.4, 0.4 * 25.4
    force = 6.46 * 4.448222
    spring = ExtensionSpring(wire, mean + wire, 10.5, 30.0, 1.0)
    ours = spring.stress(30.0 + force)
    index = mean / wire
    bergstraesser = (4 * index + 2) / (4 * index - 3)
    wahl = (4 * index - 1) / (4 * index - 4) + 0.615 / index
    theirs = bergstraesser * 8 * force * mean / (math.pi * wire**3)
    assert bergstraesser == pytest.approx(1.124, abs=1e-3)
    assert ours == pytest.approx(theirs, rel=1e-9) and ours != pytest.approx(
        theirs * wahl / bergstraesser, rel=2e-3
    )
    said = guide.entries()["SPRING_STRESS"]
    assert "Bergstraesser" in said and "Wahl" not in said
    assert theirs / 6.894757 == pytest.approx(146, rel=0.01)


def test_surge_is_half_the_root_of_rate_over_mass() -> None:
    """Shigley, eqs. 10-25 and 10-27: f = sqrt(k g / W) / 2, W = pi^2 d^2 D N gamma / 4."""
    spring = ExtensionSpring(1.0, 11.0, 12.0, 40.0, 0.85)
    weight = math.pi**2 * 1e-3**2 * 10e-3 * 12 * 7850 * 9.81 / 4
    assert spring.surge == pytest.approx(0.5 * math.sqrt(850 * 9.81 / weight), rel=1e-9)


def test_a_spring_to_be_wound_does_what_is_asked() -> None:
    found = wound(0.5, 12.0, 20.0)
    assert found is not None and not found.made
    assert found.spring.force(found.shortest) == pytest.approx(12) and found.spring.force(
        found.longest
    ) == pytest.approx(22)
    assert found.spring.stress(found.longest) <= found.spring.strength
    assert (
        found.longest - found.shortest == pytest.approx(20)
        and found.spring.free >= found.spring.least_free() - 1e-9
    )
    soft = wound(0.0, 9.0, 10.0)
    assert soft is not None and soft.spring.force(soft.longest) == pytest.approx(12)
    assert wound(1000.0, 1e5, 100.0) is None


def test_the_list_of_parts_says_how_long_its_legs_are() -> None:
    """12 coils of 1 mm wire lie closed over 13 mm; of 53 mm inside the eyes 20 are left at each end."""
    told = ExtensionSpring(1.0, 11.0, 12.0, 53.0, 0.85).bought(60.0, 70.0)
    assert (
        "free length 53 inside the eyes: closed coils of 13 and a leg of 20 at each end"
        in told.size
    )
    round_eyes = ExtensionSpring(1.0, 11.0, 12.0, 13.0 + 2 * 9.0, 0.85).bought(40.0, 50.0)
    assert "closed coils of 13, 0.85 N/mm" in round_eyes.size
