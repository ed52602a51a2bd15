"""Springs against textbook examples (quoted without the book at hand) and by hand."""

from __future__ import annotations

import math

import pytest

from camgen import guide
from camgen.parts.springs import (
    WIRES,
    CompressionSpring,
    ExtensionSpring,
    compression_spring,
    extension_spring,
    round_stem,
    to_wind,
    wound,
)

LBF_IN = 0.1751268  # N/mm


def test_rate_of_shigleys_music_wire() -> None:
    """Shigley, Mechanical Engineering Design, ex. 10-1: wire 0.037 in, mean diameter 0.400 in, 10.5 active coils, G 11.85 Mpsi:
    4.13 lbf/in; of our wire, whose G is that of EN 10270, as many coils more as it is softer."""
    wire, mean = 0.037 * 25.4, 0.400 * 25.4
    found = extension_spring(4.13 * LBF_IN, 100.0, (100.0, 101.0), mean - wire)
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


def coil(wire: float, index: float) -> ExtensionSpring:
    """A spring of 1 N/mm that is as long free as it likes."""
    return ExtensionSpring(wire, (index + 1) * wire, 10.0, 100.0, 1.0)


def test_coils_last_at_zimmerlis_point_and_on_goodmans_line() -> None:
    """Zimmerli, unpeened: an amplitude of 241 MPa about 379 [scribd.com/document/383199681, machinecalcs.com]; on the same line
    through 0.67 of the tensile strength, 1980 of wire of 1 mm, 155 about 722 and none about 1327."""
    spring = coil(1.0, 8.0)
    unit = spring.stress(101.0)
    for amplitude, mean in ((241.0, 379.0), (154.0, 722.0)):
        low, high = (100 + (mean + sign * amplitude) / unit for sign in (-1, 1))
        swing = spring.swings(low, high)[0]
        assert (swing.amplitude, swing.mean) == pytest.approx((amplitude, mean))
        line = 241 * (1327 - mean) / (1327 - 379)
        assert swing.limit == pytest.approx(min(line, 0.45 * 1980 - mean), rel=2e-3)


def test_an_eye_lasts_where_it_is_bent_from_nothing_to_0_45_of_its_strength() -> None:
    """Shigley, table 10-8, ten million cycles, not peened, ratio 0 [amesweb.info]; and 0.75 at rest, no amplitude."""
    spring = coil(1.0, 8.0)
    unit = spring.bending(101.0)
    eyes = spring.swings(100.0, 100 + 0.45 * 1980 / unit)[1]
    assert eyes.use == pytest.approx(1)
    resting = spring.swings(100 + 0.75 * 1980 / unit, 100 + 0.75 * 1980 / unit)[1]
    assert resting.limit == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("index", [5.0, 8.0, 12.0])
def test_a_bent_eye_is_a_curved_beam(index: float) -> None:
    """Winkler: neutral radius of a round section (R + sqrt(R^2 - c^2)) / 2; at the inner edge M (r_n - r_i) / (A e r_i), and the
    pull alone. The factor in use is within 3 % of it."""
    spring = coil(1.0, index)
    radius = index / 2
    neutral = (radius + math.sqrt(radius**2 - 0.25)) / 2
    inner = radius - 0.5
    area = math.pi / 4
    exact = radius * (neutral - inner) / (area * (radius - neutral) * inner) + 1 / area
    assert spring.bending(101.0) == pytest.approx(exact, rel=0.03)


def test_a_spring_that_would_tire_is_wound_of_thicker_wire() -> None:
    """15 to 27 N: wire of 1 mm on 10 mm, the slimmest that does not yield, swings by 333 MPa about 1163 where it is bent."""
    slim = ExtensionSpring(1.0, 11.0, 10.2, 29.19, 1.0)
    assert slim.stress(56.19) <= slim.strength and not slim.lasts(44.19, 56.19)
    assert slim.fatigue(44.19, 56.19).place == "eyes"
    assert slim.fatigue(44.19, 56.19).amplitude == pytest.approx(333, rel=0.02)
    way = (75.0, 87.0)
    plain, lasting = (extension_spring(1.0, 60.0, way, 9.0, 0.0, each) for each in (False, True))
    assert plain is not None and not plain.lasts(*way)
    assert lasting is not None and lasting.lasts(*way) and lasting.wire > plain.wire
    found = wound(1.0, 15.0, 12.0)
    assert found is not None and found.lasts
    assert found.spring.outside / found.spring.wire < 11


@pytest.mark.parametrize(
    ("wire", "least"),
    [(0.3, 2370), (0.5, 2200), (1.0, 1980), (2.0, 1760), (4.0, 1530), (6.0, 1400), (8.0, 1310)],
)
def test_strength_of_wire_is_that_of_the_standard(wire: float, least: float) -> None:
    """EN 10270-1, class SM, least tensile strength, N/mm^2, as mollificiomodenese.it prints it; 0.45 of it in shear."""
    spring = ExtensionSpring(wire, 8 * wire, 10.0, 100.0, 1.0)
    assert spring.strength == pytest.approx(0.45 * least, rel=0.003)


def test_a_strong_spring_is_wound_of_thick_wire() -> None:
    """150 N and 8 N/mm over 12 mm: no wire of 2 mm bears 246 N at the narrowest index, 6: 8 F D / (pi d^3) alone is more."""
    found = wound(8.0, 150.0, 12.0)
    assert found is not None and found.spring.wire > 2
    assert 8 * 246 * 6 / (math.pi * 2**2) > 0.45 * 1760
    assert found.spring.stress(found.longest) <= found.spring.strength


def test_a_spring_to_be_wound_does_what_is_asked() -> None:
    found = wound(0.5, 12.0, 20.0)
    assert found is not None
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


def test_a_compression_spring_is_never_pressed_solid() -> None:
    """Shigley, table 10-1, squared and ground ends: solid length d (n + 2); eq. 10-17: the force at solid is at least 1.15 of the
    greatest at work. Rate by Castigliano: the wire as a bar twisted by F D / 2 over its length pi D n."""
    found = compression_spring(0.25, 2.0, 12.0, 6.6, 12.2)
    assert found is not None and isinstance(found.spring, CompressionSpring)
    spring = found.spring
    assert found.longest - found.shortest == pytest.approx(12)
    assert spring.force(found.longest) == pytest.approx(2)
    assert spring.force(found.shortest) == pytest.approx(2 + 0.25 * 12)
    assert spring.solid == pytest.approx(spring.wire * (spring.coils + 2))
    assert spring.force(spring.solid) == pytest.approx(1.15 * spring.force(found.shortest))
    assert spring.stress(spring.solid) <= spring.strength
    assert spring.inside == pytest.approx(6.6) and spring.outside <= 12.2
    polar = math.pi * spring.wire**4 / 32
    length = math.pi * spring.mean * spring.coils
    assert 81500 * polar / length / (spring.mean / 2) ** 2 == pytest.approx(0.25)
    said = found.bought.size
    for word in (
        "wire 0.5",
        "coils",
        "free length",
        "N/mm",
        "solid length",
        f"2 N at {found.longest:.4g}",
    ):
        assert word in said


def test_a_compression_spring_is_wider_where_a_slim_one_is_long_or_not_at_all() -> None:
    """Of so stiff a wire a slim spring has 60 coils, 105 mm where it is shortest."""
    slim = compression_spring(0.25, 2.0, 12.0, 6.6, 12.2)
    wide = compression_spring(2.0, 40.0, 12.0, 6.6, 16.2)
    assert slim is not None and wide is not None
    assert isinstance(wide.spring, CompressionSpring) and wide.spring.inside > 6.61
    assert wide.shortest < 80
    assert compression_spring(50.0, 4000.0, 12.0, 6.6, 12.2) is None


def test_a_spring_round_a_stem_presses_with_its_force_and_stays_off_its_solid_length() -> None:
    """15 N at its longest and 12 more over 12 mm at 1 N/mm: R = G d^4 / (8 D^3 n) [EN 13906-1]; of its stretch of 27 mm 15 % are left
    over the solid length (n + 2) d [Shigley, eq. 10-17, table 10-1]. Where no such spring lasts one pulls."""
    made = round_stem(1.0, 15.0, 12.0, 10.0)
    assert made is not None and made.lasts
    spring = made.spring
    assert spring.inside >= 11.0 and spring.wire in WIRES
    assert 81500 * spring.wire**4 / (8 * spring.mean**3 * spring.coils) == pytest.approx(1.0)
    assert spring.force(made.longest) == pytest.approx(15.0)
    assert spring.force(made.longest - 12) == pytest.approx(27.0)
    solid = (spring.coils + 2) * spring.wire
    assert made.shortest - solid == pytest.approx(0.15 * 27)
    (line,) = to_wind((1.0, 15.0, 12.0), 10.0)
    assert line.standard == "EN 13906-1" and "EN 10270-1 SM, EN 15800 grade 2" in line.size
    assert line.how.startswith("round your follower's stem")
    assert round_stem(100.0, 10.0, 12.0, 4.0) is None
    for pulls in (to_wind((1.0, 15.0, 12.0)), to_wind((100.0, 10.0, 12.0), 4.0)):
        assert pulls[0].standard == "EN 13906-2" and "no initial tension" in pulls[0].size
