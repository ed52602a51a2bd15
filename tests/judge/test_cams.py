"""What is said of followers on outlines, beside the motion: places of tips, names of files, play between two outlines."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from camgen import tolerances
from camgen.findings import Finding, Where, at_most
from camgen.geometry.rings import Ring, Shape
from camgen.judge.cams import (
    FollowerOnOutline,
    _overlap,
    _own_tip,
    _tips,
    judge_cams,
    judged_angles,
    limit,
    named,
    outline_and_law,
    s_unit,
)
from camgen.judge.contact import contact
from camgen.judge.contact_faces import ArmFace, SlideFace
from camgen.judge.contact_tips import ArmTip, Form, SlideTip
from camgen.judge.joints import Outline, RollingLaw
from camgen.judge.measured import Files
from camgen.machine import GROUND, Body, Cam, Drive, Machine, Pin, Place, Pose, Slide
from camgen.machine.features import CamOutline, Eye, Flat, Mount, NominalCam, OwnTip
from camgen.machine.model import Floats
from camgen.study import Figures

TIP = Eye(None, 30 + 0j, 6.0, shaft=True)
OFF = 0.002


def disc(centre: complex, radius: float) -> Ring:
    return Ring(centre + radius * np.array([1, -1 + 0j]), np.ones(2))


def outline(
    part: str, form: Form, ring: Ring, air: float = 0.0, arm: float | None = None, **keys: object
) -> Outline:
    feature = CamOutline("lift", part, "O", None, TIP, leaves=form.leaves, free=air, **keys)  # type: ignore[arg-type,attr-defined]
    law = RollingLaw(contact(ring, form), arm)
    return Outline(feature, law, law)


def test_where_a_follower_has_its_tips() -> None:
    """Of two parts each, in mm from the shaft; a tip within a groove is the other wall's, and of one part nothing is said."""
    ring, within = disc(3 + 0j, 20.0), disc(3 + 0j, 40.0).reversed()
    first = outline("cam", ArmTip(60 + 5j, 50 * np.exp(2.6j), 3.0, -1), ring)
    second = outline("return-cam", ArmFace(60 + 5j, np.exp(-1.2j), 4.0, 1), ring)
    slide, face = (
        outline("cam", SlideTip(2 + 30j, 1j, 3.0, 1), ring),
        outline("top", SlideFace(-31j, 1j, -1), ring),
    )
    groove = outline("other", SlideTip(2 + 30j, 1j, 3.0, 1, True), within)
    tip, foot = 60 + 5j + 50 * np.exp(2.6j), 60 + 5j + 4 * np.exp(-1.2j)
    assert dict(Figures(_tips([first, second]))) == pytest.approx(
        {
            "tip_on_cam_x_mm": tip.real,
            "tip_on_cam_y_mm": tip.imag,
            "tip_on_return_cam_x_mm": foot.real,
            "tip_on_return_cam_y_mm": foot.imag,
        }
    )
    assert Figures(_tips([slide, face])) == {
        "tip_on_cam_x_mm": 2,
        "tip_on_cam_y_mm": 30,
        "tip_on_top_x_mm": 0,
        "tip_on_top_y_mm": -31,
    }
    assert Figures(_tips([slide, groove])) == {"tip_on_cam_x_mm": 2, "tip_on_cam_y_mm": 30}
    assert _tips([first]) == _tips([slide, slide]) == []


@pytest.mark.parametrize(
    "where, parts, said",
    [
        ("x-*.dxf", {"b"}, "x-b.dxf"),
        ("x-*.dxf", {"b", "a"}, "x-a.dxf with x-b.dxf"),
        ("x-*.dxf", {"a", "b", "c"}, "x-*.dxf"),
        ("x-*.dxf", set(), "x-*.dxf"),
        ("x.3mf", {"b"}, "x.3mf"),
    ],
)
def test_one_or_two_files_are_named(where: str, parts: set[str], said: str) -> None:
    assert named(Where(file=where), parts).file == said


class Harmonic:
    """A flat face on an eccentric disc: its centre's way, and the radius."""

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        return 4 * np.cos(theta + order * math.pi / 2)


CAM = Cam("lift", "cam", "follower", Harmonic(), slide="stem", phase=0.3, closure="force")


@pytest.mark.parametrize("gap", [0.1, -0.05])
def test_play_between_two_outlines_is_the_gap_between_them(gap: float) -> None:
    """Two faces about one disc, so far apart; the limit is what two outlines may be off."""
    ring = disc(4 + 0j, 16.0)
    front = outline("cam", SlideFace(16 + 0j, 1 + 0j, 1), ring)
    back = outline("cam", SlideFace(complex(-16 - gap), 1 + 0j, -1), ring)
    finding, play = _overlap(CAM, front, back, Where(file="x"), OFF)
    assert play == pytest.approx(gap, abs=1e-9)
    assert finding.measured == pytest.approx(max(0.0, -gap), abs=1e-9) and finding.unit == "mm"
    assert finding.limit == pytest.approx(
        2 * OFF * (1 + tolerances.BOUND_SPARE)
    ) and finding.ok is (gap > 0)


LIFTED = Machine(
    (Body("cam"), Body("follower")),
    (
        Pin("O", Place(GROUND), Place("cam")),
        Slide("stem", Place(GROUND), Place("follower")),
        CAM,
    ),
    (Drive("motor", "cam"),),
    dict.fromkeys(("cam", "follower"), Pose(0j, 0.0)),
)


def test_of_a_copy_that_is_turned_over_the_play_is_judged_alone() -> None:
    """The second of three outlines, on the first one's part; the motion is judged on the third."""
    ring = disc(4 + 0j, 16.0)
    first = outline("cam", SlideFace(16 + 0j, 1 + 0j, 1), ring)
    copy = outline("cam", SlideFace(-16.1 + 0j, 1 + 0j, -1), ring, copy=1)
    other = outline("return", SlideFace(-16.2 + 0j, 1 + 0j, -1), ring)
    moved = []

    def motion(driven: Mapping[str, Outline], own: bool, where: Where) -> Finding:
        moved.append(driven["lift"])
        return at_most("MOTION_ERROR", 0.0, 1.0, "mm", where, "")

    files = Files("DXF", Where(file="x-*.dxf"), {})
    verdict = judge_cams(files, LIFTED, {"lift": [first, copy, other]}, OFF, True, motion)
    assert moved == [other] and verdict.sound
    lash = [each.value for each in verdict.figures if each.quantity == "lash {of}"]
    assert lash == pytest.approx([0.1, 0.2], abs=1e-6)


@pytest.mark.parametrize(
    "free, said",
    [(0.0, "both outlines;"), (0.05, "each 0.05 mm off its tip"), (-0.05, "the preload, 0.05 mm")],
)
def test_an_overlap_is_told_where_it_is_largest(free: float, said: str) -> None:
    """The back is an eccentric further out: they overlap by 2 e at most, where it looks away. Of a pair with preload what tips
    that are smaller by it would overlap."""
    front = outline("cam", SlideFace(16 + 0j, 1 + 0j, 1), disc(4 + 0j, 16.0), free)
    back = outline("return", SlideFace(-16 + 0j, 1 + 0j, -1), disc(4.5 + 0j, 16.0), free)
    smaller = Outline(
        back.feature,
        outline("return", SlideFace(-16 + 0j, 1 + 0j, -1), disc(4.2 + 0j, 16.0)).law,
        back.tight,
    )
    finding, play = _overlap(CAM, front, smaller, Where(file="x"), OFF)
    assert play == pytest.approx(0.5, abs=1e-5)
    assert (
        finding.measured == pytest.approx(0.2 if free < 0 else 0.5, abs=1e-5)
        and said in finding.message
    )
    degrees = float(str(finding.where).removeprefix("x, cam angle ").removesuffix(" deg"))
    assert math.cos(math.radians(degrees) - 0.3) == pytest.approx(-1, abs=1e-5)


@pytest.mark.parametrize("phase", [0.0, 0.7])
@pytest.mark.parametrize("bored", [True, False])
def test_an_outline_is_seen_about_its_bore(bored: bool, phase: float) -> None:
    """A disc whose bore is off by what its outline is: about the bore it lies where it is meant, and moves the follower so. A
    tip that another part has counts as meant."""
    axis = 1 - 2j  # in the cam's own frame
    machine = Machine(
        (Body("cam"), Body("follower")),
        (
            Pin("O", Place(GROUND), Place("cam", axis)),
            Slide("stem", Place(GROUND), Place("follower")),
            Cam("lift", "cam", "follower", Harmonic(), "stem", phase, 19.0, closure="force"),
        ),
        (Drive("motor", "cam"),),
        {"cam": Pose(-axis, 0.0), "follower": Pose(23 + 0j, 0.0)},
    )
    off = 2 - 3j
    bore = Eye("cam", axis, 5.0) if bored else None
    mounts = [Mount("cam", "cam"), Mount("stem", "follower", angle=math.pi)]
    theta = np.linspace(0, math.tau, 50)
    tips = Eye("stem", 0j, 6.0, shaft=True), Flat("stem", 0j, 0.0, 30.0)
    for tip, more in zip(tips, (3.0, 0.0), strict=True):
        given_ = CamOutline("lift", "cam", "O", None, tip, bore=bore)
        sections = [[Shape(disc(axis + 4 + off, 16.0), (disc(axis + off, 2.5),))]]
        ring, law = outline_and_law(machine, given_, mounts, sections)
        assert ring.centroid == pytest.approx(4 if bored else axis + 4 + off, abs=1e-6)
        centre = (4 if bored else 4 + off) * np.exp(1j * (theta + phase))
        across = centre.imag if more else 0.0
        np.testing.assert_allclose(
            law(theta), centre.real + np.sqrt((16 + more) ** 2 - across**2) - 19, atol=1e-6
        )


@pytest.mark.parametrize("rest", [0.0, 0.4])
def test_an_arm_on_a_slanted_plate_is_where_the_triangle_says(rest: float) -> None:
    """A straight edge that slides to the left, drawn, mounted and held aslant: the tip's middle is a radius from its line."""
    tilt, mounted, at = 0.2, -0.05, 2 - 1j
    axle, arm, pivot, radius = 3 + 2j, 40 * np.exp(0.1j), -20 + 10j, 3.0
    joints = (
        Slide("bed", Place(GROUND, 1 + 2j), Place("plate", 4 - 3j), math.pi, tilt),
        Pin("A", Place(GROUND, pivot), Place("arm", axle)),
        Cam("lift", "plate", "arm", Harmonic(), None, 1.5, rest, "force", over="bed"),
    )
    starts = dict.fromkeys(("plate", "arm"), Pose(0j, 0.0))
    bodies = Body("plate"), Body("arm")
    machine = Machine(bodies, joints, (Drive("motor", "plate"),), starts)
    tip = Eye("arm", axle + arm, 2 * radius, shaft=True)
    feature = CamOutline("lift", "plate", "bed", "A", tip, way=(-15.0, 15.0))
    mounts = [Mount("plate", "plate", at, mounted), Mount("arm", "arm")]
    edge = 5.0  # mm over the part's origin
    low, high = -80 - 20j, 80 + edge * 1j
    corners = np.array([low, complex(80, -20), high, complex(-80, edge)])
    plate = Shape(Ring(corners, np.zeros(4)), ())
    _, law = outline_and_law(machine, feature, mounts, [[plate]])
    x = np.linspace(-15, 15, 31)
    held = np.exp(1j * tilt)
    line = 1 + 2j - 1.5 - held * (4 - 3j) + held * (at + np.exp(1j * mounted) * edge * 1j) - x
    normal = 1j * held * np.exp(1j * mounted)
    height = np.real(np.conj(normal) * (line - pivot)) + radius
    place = np.angle(normal) - np.arccos(height / abs(arm))
    assert law(x) == pytest.approx(place - np.angle(arm) - rest, abs=1e-6)


def test_the_limit_of_s_is_the_outlines_over_the_least_lever() -> None:
    tip = outline("cam", ArmTip(60 + 5j, 50 * np.exp(2.6j), 3.0, -1), disc(3 + 0j, 20.0), arm=50.0)
    least = 50 * math.cos(np.max(np.abs(tip.law.contact.touch(judged_angles()).pressure_angle)))
    assert limit(tip.law, OFF) == pytest.approx(OFF * (1 + tolerances.BOUND_SPARE) / least)
    assert s_unit(CAM) == ("mm", 1.0) and s_unit(Cam("x", "cam", "arm", Harmonic())) == (
        "deg",
        math.degrees(1),
    )


def test_judged_angles_are_one_in_each_step() -> None:
    """Even steps of the turn, an angle in each, none of them even."""
    theta, n = judged_angles(), tolerances.JUDGED_ANGLES
    assert np.array_equal(np.floor(theta / (math.tau / n)), np.arange(n)) and np.array_equal(
        theta, judged_angles()
    )
    assert (
        0.4 < np.mean(theta / (math.tau / n) % 1) < 0.6
        and np.std(theta / (math.tau / n) % 1) > 0.25
    )


@pytest.mark.parametrize(
    "width, middle, beyond",
    [(12.0, 0.0, -2.0), (6.0, 0.0, 1.0), (12.0, 3.0, 1.0), (12.0, -3.0, 1.0)],
)
def test_contact_runs_along_a_face_by_the_eccentricity(
    width: float, middle: float, beyond: float
) -> None:
    """4 mm to either side of the stem's line; the face's middle may lie beside it."""
    ring = disc(4 + 0j, 16.0)
    feature = CamOutline("lift", "cam", "O", None, Flat(None, 0j, math.pi, width), leaves=1)
    law = RollingLaw(contact(ring, SlideFace(16 + 0j, 1 + 0j, 1)), None, middle=middle)
    finding = FollowerOnOutline(CAM, Outline(feature, law, law), Where(file="x"), OFF).on_face()
    assert (
        finding is not None
        and finding.measured == pytest.approx(beyond, abs=1e-5)
        and finding.ok is (beyond < 0)
    )
    assert "from -4.000 to 4.000 mm" in finding.message
    degrees = (
        math.radians(float(str(finding.where).removeprefix("x, cam angle ").removesuffix(" deg")))
        - 0.3
    )
    assert abs(math.sin(degrees)) == pytest.approx(1, abs=1e-5)
    assert middle == 0 or math.sin(degrees) * middle < 0
    endless = Outline(
        CamOutline("lift", "cam", "O", None, Flat(None, 0j, math.pi, math.inf)), law, law
    )
    assert FollowerOnOutline(CAM, endless, Where(file="x"), OFF).on_face() is None
    assert (
        FollowerOnOutline(
            CAM, outline("cam", SlideTip(2 + 30j, 1j, 3.0, 1), ring), Where(file="x"), OFF
        ).on_face()
        is None
    )


@pytest.mark.parametrize("more", [0.0, 0.02])
def test_speed_ripple_is_of_the_greatest_speed_over_a_window(more: float) -> None:
    """An eccentric larger by a share: its speed is too, everywhere; the exact one has none."""
    half = math.radians(tolerances.SPEED_WINDOW_DEG) / 2
    made = outline(
        "cam",
        SlideFace(16 + 0j, 1 + 0j, 1),
        disc(4 * (1 + more) + 0j, 16.0),
        nominal=NominalCam(ripple=0.01),
    )
    finding = FollowerOnOutline(CAM, made, Where(file="x"), OFF).ripple()
    assert (
        finding is not None
        and finding.measured == pytest.approx(more, abs=1e-6)
        and finding.ok is (more == 0)
    )
    shaken = outline(
        "cam", SlideFace(16 + 0j, 1 + 0j, 1), disc(4 + 1j, 16.0), nominal=NominalCam(ripple=0.01)
    )
    off = FollowerOnOutline(
        CAM, shaken, Where(file="x"), OFF
    ).ripple()  # a quarter of a turn later: speeds differ by cos
    assert off is not None and off.measured == pytest.approx(0.25, abs=1e-4) and half > 0
    assert (
        FollowerOnOutline(
            CAM,
            outline("cam", SlideFace(16 + 0j, 1 + 0j, 1), disc(4 + 0j, 16.0)),
            Where(file="x"),
            OFF,
        ).ripple()
        is None
    )


def test_what_is_lost_of_the_wanted_motion_counts_where_the_exact_outline_loses_it() -> None:
    """Wanted 0.3 mm more where the cosine is above 0.5; the file loses 0.1 mm everywhere."""

    def wanted(theta: Floats, order: int = 0) -> Floats:
        return Harmonic()(theta, order) + 0.3 * (np.cos(theta) > 0.5) * (order == 0)

    joint = Cam("lift", "cam", "follower", wanted, slide="stem", phase=0.3, closure="force")
    for accepted, ok in ((0.41, True), (0.39, False)):
        meant = NominalCam(law=Harmonic(), undercut=accepted)
        made = outline("cam", SlideFace(16 + 0j, 1 + 0j, 1), disc(4 + 0j, 15.9), nominal=meant)
        finding = FollowerOnOutline(joint, made, Where(file="x"), OFF).undercut()
        assert (
            finding is not None
            and finding.measured == pytest.approx(0.4, abs=1e-6)
            and finding.ok is ok
        )
        assert finding.limit == pytest.approx(accepted + OFF * (1 + tolerances.BOUND_SPARE))
    assert (
        FollowerOnOutline(
            CAM,
            outline("cam", SlideFace(16 + 0j, 1 + 0j, 1), disc(4 + 0j, 15.9)),
            Where(file="x"),
            OFF,
        ).undercut()
        is None
    )


def test_of_the_findings_on_an_outline_the_undercut_is_a_figure() -> None:
    """0.4 mm lost; how far contact stays within the face is none."""

    def lower(theta: Floats, order: int = 0) -> Floats:
        return Harmonic()(theta, order) - 0.4 * (order == 0)

    made = outline(
        "cam", SlideFace(16 + 0j, 1 + 0j, 1), disc(4 + 0j, 15.6), nominal=NominalCam(law=lower)
    )
    face = replace(made, feature=replace(made.feature, tip=Flat(None, 0j, math.pi, 30.0)))
    verdict = judge_cams(
        Files("DXF", Where(file="x.dxf"), {}), LIFTED, {"lift": [face]}, OFF, True, unmoved
    )
    assert {each.code for each in verdict.findings} == {"UNDERCUT", "FACE_WIDTH"}
    lost = [each.value for each in verdict.figures if each.quantity == "undercut {of}"]
    assert lost == pytest.approx([0.4], abs=1e-6)


def unmoved(driven: Mapping[str, Outline], own: bool, where: Where) -> Finding:
    return at_most("MOTION_ERROR", 0.0, 1.0, "mm", where, "")


def test_a_parts_own_tip_may_be_off_by_the_tolerance_as_well() -> None:
    """Twice the motion's limit; what is larger by the air counts without it, and a tip that is lost is told."""
    form, ring = SlideTip(2 + 30j, 1j, 3.2, 1), disc(3 + 0j, 20.0)
    tip = OwnTip("arm", TIP, Eye("arm", 0j, 3.0))
    moved = at_most("MOTION_ERROR", 0.003, 0.002, "mm", Where(theta=math.radians(3), digits=0), "")
    made = outline("cam", form, ring, 0.2)
    finding, numbers = _own_tip(
        Outline(made.feature, made.law, made.law, made.law), tip, Where(file="x-*.dxf"), moved
    )
    assert (finding.code, finding.measured, finding.limit, finding.ok) == (
        "TIP_MOTION",
        0.003,
        0.004,
        True,
    )
    assert (
        str(finding.where) == "x-arm.dxf, cam angle 3 deg"
        and "frame's own tip, radius 3.0000 mm" in finding.message
    )
    assert Figures(numbers) == {"tip_motion_error_mm": 0.003, "tip_radius_mm": pytest.approx(3.0)}
    lost, none = _own_tip(made, OwnTip("arm", TIP, TIP, 3.0), Where(file="x-*.dxf"), moved)
    assert math.isnan(lost.measured) and not lost.ok and none == []
