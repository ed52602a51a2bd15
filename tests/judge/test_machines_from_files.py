"""Machines of simple parts, written and read back: each small damage is found at the output, whatever lies between."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from camgen.files.dxf import read_dxf, write_dxf
from camgen.files.stl import read_stl, write_stl
from camgen.findings import Where
from camgen.geometry.mesh import slice_mesh
from camgen.geometry.outlines import Contour, Region, circle, polygon
from camgen.geometry.rings import shape_of
from camgen.judge.joints import Nominal
from camgen.judge.measured import Files
from camgen.judge.motion import Verdict, judge_machine
from camgen.machine import (
    GROUND,
    Along,
    Angle,
    Body,
    Cam,
    Drive,
    Gear,
    Machine,
    Output,
    Pin,
    Place,
    Pose,
    Slide,
    Slot,
    solve,
)
from camgen.machine.features import (
    CamOutline,
    Demand,
    Eye,
    Faces,
    Feature,
    Flat,
    Mount,
    NominalCam,
    PinEyes,
    SlideFaces,
    SlotFaces,
)
from camgen.machine.model import Floats
from camgen.parts.part import Layer, Part, hull
from camgen.parts.solids import solid

TOLERANCE = 0.002
THETA = np.linspace(0, math.tau, 361)[:-1] + 0.003
PIN, HOLE = Eye(None, 0j, 3, shaft=True), 3.1
KINDS = ("dxf", "stl")
Regions = Mapping[str, Region]


def sections(name: str, region: Region, kind: str, folder: Path) -> list[list[object]]:
    """What is read of a part's file."""
    path = folder / f"{name}.{kind}"
    if kind == "dxf":
        write_dxf(path, region, (), TOLERANCE)
        return [[shape_of(read_dxf(path).cut)]]
    write_stl(path, solid(Part(name, name, (Layer(region, 0.0, 4.0),)), TOLERANCE), name)
    mesh = read_stl(path)
    return [[shape_of(slice_mesh(mesh, z))] for z in (0.7, 3.1)]


def link(*holes: complex, radius: float = 5.0) -> Region:
    return Region(hull([(z, radius) for z in holes]), tuple(circle(z, HOLE / 2) for z in holes))


def box(middle: complex, length: float, width: float, turned: float = 0.0) -> Contour:
    corners = [
        complex(x, y) / 2
        for x, y in ((-length, -width), (length, -width), (length, width), (-length, width))
    ]
    return polygon([middle + z * cmath.exp(1j * turned) for z in corners])


def eyes(joint: str, a: str, at: complex, b: str, there: complex = 0j) -> PinEyes:
    return PinEyes(joint, Eye(a, at, HOLE), Eye(b, there, HOLE), PIN)


@dataclass(frozen=True)
class Case:
    """A machine, what it is measured on, and its parts as they may be damaged."""

    machine: Machine
    features: tuple[Feature, ...]
    regions: Callable[..., Regions]
    mounts: tuple[Mount, ...] = ()

    def judged(
        self, kind: str, folder: Path, asked: Sequence[Demand] = (), **damage: object
    ) -> Verdict:
        regions = self.regions(**damage)
        files = {name: sections(name, region, kind, folder) for name, region in regions.items()}
        mounts = self.mounts or tuple(Mount(name, name) for name in regions)
        return judge_machine(
            Nominal(self.machine, self.features, mounts, asked),
            Files(kind, Where(file="f"), files),
            THETA,
            TOLERANCE,
        )  # type: ignore[arg-type]

    def wanted(self) -> list[Demand]:
        """Its outputs by the other route, in closed form."""

        def motion(name: str) -> Callable[[Floats, int], Floats]:
            return lambda theta, order: solve(self.machine, theta, 1).derivatives(name)[order]  # type: ignore[return-value]

        return [
            Demand(output.name, motion(output.name), stroke=True) for output in self.machine.outputs
        ]


def failing(verdict: Verdict) -> set[str]:
    return {finding.code for finding in verdict.findings if not finding.ok}


def meeting(a: complex, c: complex, near: float, far: float) -> complex:
    """The point `near` from a and `far` from c, to the left of the way from a to c: two circles."""
    way = c - a
    along = (near**2 - far**2 + abs(way) ** 2) / (2 * abs(way))
    return a + way / abs(way) * complex(along, math.sqrt(near**2 - along**2))


# ---- a four-bar whose rocker drives a ram by a slot --------------------------------------------------------------------

FRAME = 40
CRANK = 12
COUPLER = 38
ROCKER = 24
HEIGHT = 45


def shaper() -> Case:
    a, b = complex(CRANK), meeting(CRANK, FRAME, COUPLER, ROCKER)
    lean = cmath.phase(b - FRAME)
    ram = FRAME + HEIGHT / math.tan(lean)
    machine = Machine(
        (Body("crank"), Body("coupler"), Body("rocker"), Body("ram")),
        (
            Pin("O", Place(GROUND), Place("crank"), 0.2),
            Pin("A", Place("crank", CRANK), Place("coupler"), 0.2),
            Pin("B", Place("coupler", COUPLER), Place("rocker", ROCKER), 0.2),
            Pin("C", Place(GROUND, FRAME), Place("rocker"), 0.2),
            Slot("slot", Place("rocker"), Place("ram"), clearance=0.2),
            Slide("guide", Place(GROUND, 1j * HEIGHT), Place("ram"), clearance=0.2),
        ),
        (Drive("motor", "crank"),),
        {
            "crank": Pose(0j, 0.0),
            "coupler": Pose(a, cmath.phase(b - a)),
            "rocker": Pose(FRAME, lean),
            "ram": Pose(complex(ram, HEIGHT), 0.0),
        },
        outputs=(Output("ram", Along("guide")), Output("rocker", Angle("rocker"), "rad")),
    )

    def regions(
        hole: complex = 0j, slot: float = 0.0, swapped: bool = False, high: float = 0.0
    ) -> Regions:
        holes = (circle(0j, HOLE / 2), circle(ROCKER, HOLE / 2), box(50, 26, 3.1, slot))
        rocker = Region(hull([(0j, 5), (66, 5)]), holes)
        parts = {
            "base": Region(
                box(30 + 20j, 140, 90),
                (
                    circle(0j, HOLE / 2),
                    circle(FRAME, HOLE / 2),
                    box(50 + 1j * (HEIGHT + high), 90, 10.2),
                ),
            ),
            "crank": link(0j, CRANK),
            "coupler": link(0j, COUPLER + hole),
            "rocker": rocker,
            "ram": Region(box(0j, 30, 10), (circle(0j, HOLE / 2),)),
        }
        return parts | {"crank": parts["coupler"], "coupler": parts["crank"]} if swapped else parts

    features = (
        eyes("O", "base", 0j, "crank"),
        eyes("A", "crank", CRANK, "coupler"),
        eyes("B", "coupler", COUPLER, "rocker", ROCKER),
        eyes("C", "base", FRAME, "rocker"),
        SlotFaces("slot", Faces("rocker", 50 + 0j, 0.0, 3.1), Eye("ram", 0j, HOLE), PIN),
        SlideFaces("guide", Faces("base", 50 + 1j * HEIGHT, 0.0, 10.2), Faces("ram", 0j, 0.0, 10)),
    )
    mounts = (
        Mount("base", GROUND),
        *(Mount(name, name) for name in ("crank", "coupler", "rocker", "ram")),
    )
    return Case(machine, features, regions, mounts)


@pytest.mark.parametrize("kind", KINDS)
def test_a_shaper_from_its_files(kind: str, tmp_path: Path) -> None:
    case = shaper()
    sound = case.judged(kind, tmp_path, case.wanted())
    assert failing(sound) == set()
    assert {f.code for f in sound.findings} == {"PIN_GAP", "MOTION_ERROR", "LASH", "STROKE_ERROR"}
    assert sound.numbers[f"motion_error_ram_{kind}_mm"] < 2e-5
    assert sound.numbers[f"motion_error_rocker_{kind}_deg"] < 2e-5


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "damage, output, codes",
    [
        pytest.param({"hole": 0.03}, "both", {"MOTION_ERROR"}, id="a hole 30 um off"),
        pytest.param(
            {"slot": math.radians(0.2)}, "ram", {"MOTION_ERROR"}, id="a slot turned by 0.2 deg"
        ),
        pytest.param({"high": 0.03}, "ram", {"MOTION_ERROR"}, id="the guide 30 um too high"),
        pytest.param({"swapped": True}, "", {"PIN_GAP"}, id="two links swapped"),
    ],
)
def test_a_damaged_shaper(
    kind: str, damage: dict[str, object], output: str, codes: set[str], tmp_path: Path
) -> None:
    case = shaper()
    verdict = case.judged(kind, tmp_path, case.wanted(), **damage)
    assert codes <= failing(verdict) <= codes | {"STROKE_ERROR"}
    if output:  # the slot and the guide come after the rocker
        assert verdict.numbers[f"motion_error_ram_{kind}_mm"] > 0.005
        assert (verdict.numbers[f"motion_error_rocker_{kind}_deg"] > 0.01) is (output == "both")


def test_a_moved_hole_is_told_by_its_share(tmp_path: Path) -> None:
    """What the table foretells for the shift is what the closed machine shows, at most."""
    verdict = shaper().judged("dxf", tmp_path, hole=0.01)
    assert verdict.table is not None
    rows = {
        row[0]: dict(zip(verdict.table.columns, row, strict=True)) for row in verdict.table.rows
    }
    assert rows["B"]["centres off, mm"] == pytest.approx(0.01, abs=1e-9)
    assert rows["A"]["centres off, mm"] == pytest.approx(0, abs=1e-9)
    (said,) = (finding.message for finding in verdict.findings if finding.code == "MOTION_ERROR")
    assert said.endswith("; coupler is furthest from its place, by 0.01 mm at joint B")
    told = rows["B"]["error of ram from the shift, mm"]
    assert 0.5 * told < verdict.numbers["motion_error_ram_dxf_mm"] <= told * 1.001  # type: ignore[operator]


# ---- a cam, its rocker and a ram --------------------------------------------------------------------------------------

PIVOT = 45
ARM = 40
DISC = 16
TIP = 3
OFF, OTHER, ROD = 4 * cmath.exp(0.5j), 30 * cmath.exp(-2j), 50


@dataclass(frozen=True)
class Rocking:
    """A round tip on an eccentric disc: a four-bar whose coupler is both radii."""

    rest: float = 0.0

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        tip = meeting(OFF, PIVOT, DISC + TIP, ARM)
        bodies = (Body("crank"), Body("rod"), Body("rocker"))
        pins = (
            Pin("O", Place(GROUND), Place("crank")),
            Pin("A", Place("crank", OFF), Place("rod")),
            Pin("B", Place("rod", DISC + TIP), Place("rocker", ARM)),
            Pin("C", Place(GROUND, PIVOT), Place("rocker")),
        )
        start = {
            "crank": Pose(0j, 0.0),
            "rod": Pose(OFF, cmath.phase(tip - OFF)),
            "rocker": Pose(PIVOT, cmath.phase(tip - PIVOT)),
        }
        chain = Machine(
            bodies,
            pins,
            (Drive("motor", "crank"),),
            start,
            outputs=(Output("angle", Angle("rocker"), "rad"),),
        )
        angle: Floats = solve(chain, theta, order).derivatives("angle")[order]
        return angle - (self.rest if order == 0 else 0.0)


def rocking_cam(flipped: bool = False) -> Case:
    rest = float(Rocking()(np.zeros(1))[0])
    if rest < 0:
        raise AssertionError("drawn above the line of the shafts")
    joint = PIVOT + OTHER * cmath.exp(1j * rest)
    high = round(joint.imag, 3)
    far = joint.real + math.sqrt(ROD**2 - (high - joint.imag) ** 2)
    machine = Machine(
        (Body("cam"), Body("rocker"), Body("rod"), Body("ram")),
        (
            Pin("shaft", Place(GROUND), Place("cam"), 0.2),
            Pin("pivot", Place(GROUND, PIVOT), Place("rocker"), 0.2),
            Cam("lift", "cam", "rocker", Rocking(rest), rest=rest, closure="force", leaves=-1),
            Pin("P", Place("rocker", OTHER), Place("rod"), 0.2),
            Pin("Q", Place("rod", ROD), Place("ram"), 0.2),
            Slide("guide", Place(GROUND, 1j * high), Place("ram"), clearance=0.2),
        ),
        (Drive("motor", "cam"),),
        {
            "cam": Pose(0j, 0.0),
            "rocker": Pose(PIVOT, rest),
            "ram": Pose(complex(far, high), 0.0),
            "rod": Pose(joint, cmath.phase(complex(far, high) - joint)),
        },
        outputs=(Output("ram", Along("guide")),),
    )

    def regions(
        mirrored: bool = False, tip: complex = 0j, bore: complex = 0j, disc: float = DISC
    ) -> Regions:
        off = -OFF.conjugate() if mirrored is not flipped else OFF
        return {
            "base": Region(
                box(80 + 10j, 240, 90),
                (circle(0j, HOLE / 2), circle(PIVOT, HOLE / 2), box(complex(far, high), 60, 10.2)),
            ),
            "cam": Region(circle(off, disc), (circle(bore, HOLE / 2),)),
            "rocker": Region(
                hull([(0j, 6), (ARM + tip, TIP), (OTHER, 5)]),
                (circle(0j, HOLE / 2), circle(OTHER, HOLE / 2)),
            ),
            "rod": link(0j, ROD),
            "ram": Region(box(0j, 30, 10), (circle(0j, HOLE / 2),)),
        }

    features = (
        CamOutline(
            "lift", "cam", "shaft", "pivot", Eye("rocker", ARM, 2 * TIP, shaft=True), leaves=-1
        ),
        eyes("shaft", "base", 0j, "cam"),
        eyes("pivot", "base", PIVOT, "rocker"),
        eyes("P", "rocker", OTHER, "rod"),
        eyes("Q", "rod", ROD, "ram"),
        SlideFaces(
            "guide", Faces("base", complex(far, high), 0.0, 10.2), Faces("ram", 0j, 0.0, 10)
        ),
    )
    mounts = (
        Mount("base", GROUND),
        Mount("cam", "cam", flipped=flipped),
        *(Mount(n, n) for n in ("rocker", "rod", "ram")),
    )
    return Case(machine, features, regions, mounts)


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("flipped", [False, True])
def test_a_cam_machine_from_its_files(kind: str, flipped: bool, tmp_path: Path) -> None:
    case = rocking_cam(flipped)
    sound = case.judged(kind, tmp_path, case.wanted())
    assert failing(sound) == set()
    # arcs and circles are exact in a drawing, facets within their tolerance at the ram
    assert sound.numbers[f"motion_error_{kind}_mm"] < (1e-9 if kind == "dxf" else 0.003)


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "damage",
    [
        pytest.param({"mirrored": True}, id="a cam mirrored"),
        pytest.param({"tip": 0.03j}, id="the follower's tip 30 um off"),
        pytest.param({"bore": 0.03}, id="the cam's bore 30 um off"),
    ],
)
def test_a_damaged_cam_machine(kind: str, damage: dict[str, object], tmp_path: Path) -> None:
    case = rocking_cam()
    verdict = case.judged(kind, tmp_path, case.wanted(), **damage)
    assert {"MOTION_ERROR"} <= failing(verdict) <= {"MOTION_ERROR", "STROKE_ERROR"}
    assert verdict.numbers[f"motion_error_{kind}_mm"] > 0.005


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_a_follower_that_misses_its_cam_is_told(kind: str, tmp_path: Path) -> None:
    """A disc so small that the arm's tip, never nearer to the shaft than 5 mm, loses it."""
    verdict = rocking_cam().judged(kind, tmp_path, disc=5.6)
    (wrong,) = (finding for finding in verdict.findings if not finding.ok)
    assert (
        wrong.code == "MOTION_ERROR"
        and math.isinf(wrong.measured)
        and "it does not close at" in wrong.message
    )
    assert not [
        f for f in rocking_cam().judged(kind, tmp_path).findings if "does not close" in f.message
    ]
    assert verdict.proof is None


@dataclass(frozen=True)
class More:
    """A law and 0.1 deg more over a quarter of the turn."""

    law: Callable[[Floats, int], Floats]

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        return self.law(theta, order) + math.radians(0.1) * (np.cos(theta) > math.sqrt(0.5)) * (
            order == 0
        )


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_what_is_judged_on_the_cam_of_any_machine(kind: str, tmp_path: Path) -> None:
    """Its ripple and what its outline loses of the wanted motion; the ram's error is that from what is reachable."""
    case = rocking_cam()
    lift = case.machine.joint("lift")
    assert isinstance(lift, Cam)
    joints = tuple(
        replace(lift, law=More(lift.law)) if joint is lift else joint
        for joint in case.machine.joints
    )
    machine = replace(case.machine, joints=joints)
    for ripple, undercut, codes in (
        (0.01, 0.11, set()),
        (1e-9, 0.11, {"SPEED_RIPPLE"}),
        (0.01, 0.09, {"UNDERCUT"}),
    ):
        meant = NominalCam(lift.law, None, ripple, math.radians(undercut))
        features = tuple(
            replace(f, nominal=meant) if isinstance(f, CamOutline) else f for f in case.features
        )
        found = replace(case, machine=machine, features=features).judged(kind, tmp_path)
        told = failing(found)
        assert told == (
            codes if kind != "dxf" else codes - {"SPEED_RIPPLE"}
        )  # a drawing's circle is exact
        assert found.numbers[f"undercut_{kind}_deg"] == pytest.approx(0.1, abs=0.004)
        assert 0 < found.numbers[f"pressure_angle_{kind}_deg"] < 60


def test_a_lost_outline_and_a_wrong_pin_are_told(tmp_path: Path) -> None:
    case = rocking_cam()
    files = {
        name: sections(name, region, "dxf", tmp_path) for name, region in case.regions().items()
    }
    for changed, code, words in (
        ({"cam": [[]]}, "PIN_GAP", "the outline of cam is lost"),
        ({"rocker": files["rod"]}, "PIN_GAP", "no eye of 6 mm near 40.000 in rocker"),
    ):
        found = judge_machine(
            Nominal(case.machine, case.features, case.mounts),
            Files("dxf", Where(file="f"), files | changed),
            THETA,
            TOLERANCE,
        )  # type: ignore[arg-type]
        (wrong,) = (finding for finding in found.findings if not finding.ok)
        assert wrong.code == code and words in wrong.message


# ---- a flat face on an eccentric, and a pair of gears -----------------------------------------------------------------


@dataclass(frozen=True)
class Lift:
    """A flat face on an eccentric disc: the disc's radius and the way of its centre."""

    size: float = 4.0

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        return self.size * np.cos(theta + order * math.pi / 2)


def flat_faced(phase: float = 0.0) -> Case:
    machine = Machine(
        (Body("cam"), Body("follower"), Body("wheel")),
        (
            Pin("shaft", Place(GROUND), Place("cam"), 0.2),
            Slide("stem", Place(GROUND), Place("follower"), clearance=0.2),
            Cam(
                "lift",
                "cam",
                "follower",
                Lift(),
                slide="stem",
                phase=phase,
                rest=DISC,
                closure="force",
            ),
            Gear("wheels", "cam", "wheel", -0.5),
            Pin("axle", Place(GROUND, -60), Place("wheel"), 0.2),
        ),
        (Drive("motor", "cam"),),
        {
            "cam": Pose(0j, 0.0),
            "follower": Pose(complex(DISC + 4 * math.cos(phase)), 0.0),
            "wheel": Pose(-60, 0.0),
        },
        outputs=(Output("lift", Along("stem")), Output("wheel", Angle("wheel"), "rad")),
    )

    def regions(lean: float = 0.0, ahead: float = 0.0) -> Regions:
        stem = [
            complex(4, -12),
            complex(4, -5),
            complex(60, -5),
            complex(60, 5),
            complex(4, 5),
            complex(4, 12),
        ]
        face = [complex(ahead - y * math.tan(lean), y) for y in (12, -12)]
        return {
            "base": Region(
                box(0j, 180, 60), (circle(0j, HOLE / 2), circle(-60, HOLE / 2), box(55, 40, 10.2))
            ),
            "cam": Region(circle(4 * cmath.exp(1j * phase), DISC), (circle(0j, HOLE / 2),)),
            "wheel": Region(circle(0j, 20), (circle(0j, HOLE / 2),)),
            "follower": Region(polygon([*face, *stem])),
        }

    features = (
        eyes("shaft", "base", 0j, "cam"),
        eyes("axle", "base", -60, "wheel"),
        SlideFaces("stem", Faces("base", 55 + 0j, 0.0, 10.2), Faces("follower", 30 + 0j, 0.0, 10)),
        CamOutline("lift", "cam", "shaft", None, Flat("follower", 0j, math.pi, 24), leaves=1),
    )
    mounts = (Mount("base", GROUND), *(Mount(name, name) for name in ("cam", "follower", "wheel")))
    return Case(machine, features, regions, mounts)


@pytest.mark.parametrize("kind", KINDS)
def test_a_flat_face_and_gears_from_their_files(kind: str, tmp_path: Path) -> None:
    case = flat_faced()
    lift = Demand(
        "lift", lambda theta, order: Lift()(theta, order) + DISC * (order == 0), stroke=True
    )
    sound = case.judged(kind, tmp_path, [lift])
    assert failing(sound) == set()
    assert sound.numbers[f"stroke_recovered_lift_{kind}_mm"] == pytest.approx(8, abs=0.002)
    (told,) = sound.not_judged
    assert told.why.startswith("wheels counts as meant")
    assert failing(case.judged(kind, tmp_path, ahead=0.02)) == {"MOTION_ERROR"}


def yoke() -> Case:
    """The same between two faces: an eccentric disc is of constant breadth, so the play is the same all round."""
    case = flat_faced()
    machine = Machine(
        case.machine.bodies[:2],
        case.machine.joints[:3],
        case.machine.drives,
        {name: case.machine.start[name] for name in ("cam", "follower")},
        outputs=case.machine.outputs[:1],
    )

    def regions(gap: float = 0.1) -> Regions:
        window = box(complex(-DISC - gap / 2, 0), 2 * DISC + gap, 50)
        return {
            "base": Region(box(0j, 220, 60), (circle(0j, HOLE / 2), box(65, 40, 10.2))),
            "cam": case.regions()["cam"],
            "follower": Region(
                polygon(
                    [-40 - 30j, 10 - 30j, 10 - 5j, 70 - 5j, 70 + 5j, 10 + 5j, 10 + 30j, -40 + 30j]
                ),
                (window,),
            ),
        }

    features = (
        case.features[0],
        case.features[3],
        SlideFaces("stem", Faces("base", 65 + 0j, 0.0, 10.2), Faces("follower", 30 + 0j, 0.0, 10)),
        CamOutline(
            "lift",
            "cam",
            "shaft",
            None,
            Flat("follower", complex(-2 * DISC - 0.1), 0.0, 24),
            leaves=-1,
        ),
    )
    return Case(machine, features, regions, case.mounts)


@pytest.mark.parametrize("kind", KINDS)
def test_a_follower_between_two_faces(kind: str, tmp_path: Path) -> None:
    case = yoke()
    sound = case.judged(kind, tmp_path)
    assert failing(sound) == set() and "INTERFERENCE" in {f.code for f in sound.findings}
    assert sound.numbers[f"clearance_band_{kind}_mm"] == pytest.approx(
        0.05, abs=0.003
    )  # the stem's own is across
    assert sound.numbers[f"lash_{kind}_mm"] == pytest.approx(0.1, abs=0.003)
    tight = case.judged(kind, tmp_path, gap=-0.01)
    assert failing(tight) == {"INTERFERENCE"} and tight.numbers[
        f"preload_{kind}_mm"
    ] == pytest.approx(0.01, abs=0.003)
    assert not [name for name in sound.numbers if "tip_on" in name]  # both faces touch one part
