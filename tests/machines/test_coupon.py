"""The calibration coupon: least squares against the GUM's example, a printer that is found again, files like any part's."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen import starters
from camgen.errors import DesignError, SpecError
from camgen.machines.coupon.calibration import Feature, Printed, calibrate, least_squares
from camgen.machines.coupon.mechanism import Coupon
from camgen.machines.sources import read_mechanism
from camgen.parts.assembly import printed_parts
from camgen.pipeline.build import build
from camgen.spec import validate

STARTER = tomllib.loads(starters.text("coupon"))

# Calibration of a thermometer: readings and corrections, deg C [JCGM 100:2008, table H.6; the same in GTC's manual, GUM_H3].
READINGS = (21.521, 22.012, 22.512, 23.003, 23.507, 23.999, 24.513, 25.002, 25.503, 26.010, 26.511)
CORRECTIONS = (
    -0.171,
    -0.169,
    -0.166,
    -0.159,
    -0.164,
    -0.165,
    -0.156,
    -0.157,
    -0.159,
    -0.161,
    -0.160,
)


def test_least_squares_and_their_uncertainty_are_the_gums() -> None:
    rows = np.column_stack([np.ones(11), np.array(READINGS) - 20])
    fit = least_squares(rows, np.array(CORRECTIONS))
    known = fit.values[0], fit.scatter, np.sqrt(fit.covariance[0, 0])
    assert [f"{value:.4f}" for value in known] == ["-0.1712", "0.0035", "0.0029"]
    assert (f"{fit.values[1]:.5f}", f"{np.sqrt(fit.covariance[1, 1]):.5f}") == (
        "0.00218",
        "0.00067",
    )
    assert (
        round(fit.covariance[0, 1] / np.sqrt(fit.covariance[0, 0] * fit.covariance[1, 1]), 3)
        == -0.930
    )
    at_30 = np.array([1.0, 10.0])
    assert (
        round(float(at_30 @ fit.values), 4) == -0.1494
        and round(float(np.sqrt(at_30 @ fit.covariance @ at_30)), 4) == 0.0041
    )
    assert fit.freedom == 9 and fit.uncertainty(at_30) == pytest.approx(
        2.262 * 0.0041386, rel=1e-4
    )  # t of 95 %, 9: GUM, table G.2


def coupon(**changes: Any) -> Coupon:
    """The starter with other tables."""
    return validate(Coupon, {**STARTER, **changes})


def printed_by(
    made: Coupon, shrinkage: float, hole: float, profile: float, noise: float = 0.0, seed: int = 1
) -> dict[str, float]:
    """Sizes that a printer gives: what is sent to it shrinks, then walls of holes come in and outlines come out."""
    chance, p = np.random.default_rng(seed), made.print
    sizes = {}
    for each in made.sizes:
        inner, outer = each.holes / -2, each.outlines / 2
        sent = (
            each.nominal + 2 * inner * p.hole_compensation - 2 * outer * p.profile_compensation
        ) / (1 - p.shrinkage)
        sizes[each.name] = (
            sent * (1 - shrinkage)
            - 2 * inner * hole
            + 2 * outer * profile
            + noise * chance.standard_normal()
        )
    return sizes


@pytest.mark.parametrize(
    "sent", [{}, {"hole_compensation": 0.1, "profile_compensation": 0.05, "shrinkage": 0.002}]
)
def test_a_printer_is_found_again(sent: dict[str, float]) -> None:
    made = coupon(print=sent)
    sizes = printed_by(made, 0.003, 0.14, 0.09)
    sizes["disc foot"] += 0.3
    measured = {"caliper": 1e-6, "sizes": sizes, "runs": 0.6, "holds": 0.5}
    found = {each.key: each for each in coupon(print=sent, measured=measured).calibration.values}
    assert found["hole_compensation"].value == pytest.approx(0.14, abs=1e-9)
    assert found["profile_compensation"].value == pytest.approx(0.09, abs=1e-9)
    assert found["shrinkage"].value == pytest.approx(0.003, abs=1e-9)
    assert found["elephant_foot"].value == pytest.approx(0.15, abs=1e-9)
    for key, named in (
        ("slide_clearance", "fit 0.6"),
        ("press_clearance", "fit 0.5"),
    ):  # the play that was felt
        assert found[key].value == pytest.approx(
            max(0.0, sizes[named] - sizes["fit pin"]), abs=1e-9
        )
    assert found["slide_clearance"].uncertainty == pytest.approx(
        0.05, abs=1e-4
    )  # half a step of the holes


def test_a_press_fit_below_0_is_told() -> None:
    """Holes come in by 0.28, the pin comes out by 0.18: a hole 0.3 too wide for it holds with -0.16."""
    measured = {
        "caliper": 1e-6,
        "sizes": printed_by(coupon(), 0.0, 0.14, 0.09),
        "runs": 0.5,
        "holds": 0.3,
    }
    made = coupon(measured=measured)
    (line,) = (line for line in made.remarks().printed if line.startswith("press_clearance"))
    assert (
        line.startswith("press_clearance = 0.000 ")
        and "# mm, would be -0.160 +- 0.050 (95 %): " in line
    )
    assert "print.press_clearance cannot be below 0: glue" in line
    (row,) = (row for row in made.study().tables[0].rows if row[0] == "press_clearance")
    assert (
        row[1] == 0
        and row[2] == pytest.approx(-0.16, abs=1e-6)
        and row[3] == pytest.approx(0.05, abs=1e-4)
    )
    (line,) = (line for line in made.remarks().printed if line.startswith("slide_clearance"))
    assert "# mm, +- 0.050 (95 %): " in line and "below 0" not in line


def test_the_interval_holds_the_truth_as_often_as_it_says() -> None:
    made, inside = coupon(), []
    for seed in range(400):
        sizes = {
            name: (size,) for name, size in printed_by(made, 0.002, 0.12, 0.08, 0.04, seed).items()
        }
        found = {v.key: v for v in calibrate(made.sizes, sizes, Printed(), 1e-6).values}
        for key, truth in (
            ("hole_compensation", 0.12),
            ("profile_compensation", 0.08),
            ("shrinkage", 0.002),
        ):
            inside.append(abs(found[key].value - truth) <= found[key].uncertainty)
    assert 0.93 < np.mean(inside) < 0.97
    assert found["size_error"].value == pytest.approx(0.04, rel=0.4)


def test_short_sizes_do_not_tell_shrinkage_and_one_hole_tells_holes_alone() -> None:
    few = {"hole 3": 2.72, "hole 5": 4.70, "pin 3": 3.2}
    found = coupon(measured={"sizes": few}).calibration.values
    assert [each.key for each in found] == ["hole_compensation", "profile_compensation"]
    (alone,) = coupon(measured={"sizes": {"hole 5": (4.70, 4.74)}}).calibration.values
    assert (alone.key, alone.value) == ("hole_compensation", pytest.approx(0.14))
    assert alone.uncertainty == pytest.approx(0.0196, rel=1e-3)
    assert (
        coupon().calibration.values == ()
        and coupon().limits() == []
        and "nothing is measured" in coupon().remarks().printed[0]
    )


def test_findings_fail_on_bad_measuring() -> None:
    made = coupon()
    good = printed_by(made, 0.003, 0.14, 0.09, 0.01)
    assert all(finding.ok for finding in coupon(measured={"sizes": good}).limits())
    off = coupon(measured={"sizes": {**good, "hole 3": good["hole 3"] - 0.4}})
    failed = {finding.code: finding for finding in off.limits() if not finding.ok}
    assert set(failed) == {"CALIBRATION_FIT"} and str(failed["CALIBRATION_FIT"].where) == "hole 3"
    rough = coupon(measured={"caliper": 0.2, "sizes": {"hole 5": 4.7}}).limits()
    assert [finding.code for finding in rough if not finding.ok] == ["CALIBRATION"]


def test_all_faults_at_once() -> None:
    data = {**STARTER, "geometry": {"holes": [5, 3], "clearances": [0.2, 0.3]}}
    data["measured"] = {
        "runs": 0.25,
        "sizes": {"hole 4": 3.8, "hole 3": 5.2, "pins 3": 3.0, "pin 3": [3.1, "x"]},
    }
    with pytest.raises(SpecError) as caught:
        validate(Coupon, data)
    assert "measured.sizes.pin 3.1" in str(caught.value)
    data["measured"]["sizes"]["pin 3"] = [3.1]
    with pytest.raises(SpecError) as caught:
        validate(Coupon, data)
    told = {fault.key: fault for fault in caught.value.faults}
    sizes = {f"measured.sizes.{name}" for name in ("hole 4", "hole 3", "pins 3")}
    assert set(told) == {"geometry.holes", "measured.runs", *sizes}
    assert (
        told["measured.sizes.pins 3"].nearest == "pin 3"
        and "another size" in told["measured.sizes.hole 3"].expected
    )


@pytest.mark.parametrize("key, value", [("length", 60.0), ("width", 34.0), ("disc", 9.0)])
def test_a_plate_too_small_is_refused(key: str, value: float) -> None:
    with pytest.raises(DesignError) as caught:
        _ = coupon(geometry={key: value}).assembly
    assert caught.value.remedy
    if key != "disc":  # the size that it names is enough
        _ = coupon(geometry={key: caught.value.limit + 1e-6}).assembly


def test_sizes_above_their_table_are_told_where_they_belong() -> None:
    with pytest.raises(
        SpecError, match=r"1 fault\n  measured: .*below the line \[measured.sizes\]: pin 3, disc$"
    ):
        coupon(measured={"pin 3": 3.1, "disc": 40.1})


@pytest.mark.long
def test_it_is_built_and_proven_like_any_part(tmp_path: Path) -> None:
    spec = tmp_path / "mine.toml"
    sizes = printed_by(coupon(), 0.003, 0.14, 0.09, 0.01)
    lines = "\n".join(f'"{name}" = {size:.2f}' for name, size in sizes.items())
    text = starters.text("coupon").replace('\n# "hole 3"', f'\n{lines}\n# "hole 3"')
    spec.write_text(text, encoding="utf-8")
    report = build(read_mechanism(spec, ()), tmp_path, frozenset({"dxf", "stl"}))
    assert report.ok and {"ROUND_TRIP", "WATERTIGHT", "VOLUME", "MIN_WALL", "CALIBRATION"} <= {
        f.code for f in report.findings
    }
    assert report.remarks[0] == "for [print] of your specs:"
    pasted = tomllib.loads((tmp_path / "coupon" / "coupon-print.toml").read_text(encoding="utf-8"))[
        "print"
    ]
    assert pasted["hole_compensation"] == pytest.approx(0.14, abs=0.01) and len(
        report.remarks
    ) == 1 + len(pasted)
    again = read_mechanism(
        spec, [f"print.{key}={value}" for key, value in pasted.items()]
    )  # they are keys of [print]
    assert again.print.shrinkage == pasted["shrinkage"]


def test_a_feature_is_sent_as_the_printer_needs_it() -> None:
    assert Printed(0.1, 0.05, 0.01).sent(Feature("hole", 9.7, -2, 0)) == pytest.approx(10)
    assert Printed(0.1, 0.05, 0.01).sent(Feature("pin", 10, 0, 2)) == pytest.approx(10)


PINNED = {
    "uniform-swing": ("parts.pins=steel", {"cam-pin", "frame-pin"}),
    "thread-take-up": (
        "parts.pins=all-steel",
        {"pin-1", "pin-2", "dowel", "thread-post-1", "thread-post-2", "shaft"},
    ),
}


@pytest.mark.parametrize("name", PINNED)
def test_upright_pins_may_be_of_steel(name: str) -> None:
    setting, pins = PINNED[name]
    machine = read_mechanism(starters.folder() / f"{name}.toml", (setting,))
    steel = {part.name for part in machine.assembly.parts if part.process == "turned of steel"}
    assert steel == pins and not pins & {part.name for part in printed_parts(machine.assembly)}
