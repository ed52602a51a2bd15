"""Hard cases of all six mechanisms against mpmath at 50 digits: each within its tolerance, or refused with the reason.

    python tests/bench/stability.py [MECHANISM...]

Two kinds of rows. "motion": the output and its first two derivatives, from the formulas of the sources, as a share of the
output's own range. "outline": the written DXF and STL; at each angle the tip's centre, by the source's formula turned back by
the cam's angle, must be a tip's radius from the contour in the file, within the chord tolerance (and the float32 of STL);
inside an undercut that the design tells it may only be farther. Nothing here uses the project's motion, profile or contact.

condition: by how much an error of a length is magnified: 1 / cos of the steepest pressure angle of a cam, 1 / sin of the
least transmission angle of a linkage. Motion is allowed 64 roundings times the condition (its square for each derivative).
"""

from __future__ import annotations

import math
import os
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import mpmath
import numpy as np

from camgen.errors import CamgenError
from camgen.files.dxf import read_dxf
from camgen.files.stl import read_stl
from camgen.geometry.mesh import slice_mesh
from camgen.geometry.rings import Ring, shape_of
from camgen.pipeline import build as pipeline

SPECS = Path(__file__).resolve().parent.parent.parent / "specs"
ROUNDING = 2.0**-53
FLOAT32 = 2.0**-24
mp = mpmath.mp.clone()
mp.dps = 50
Truth = Callable[[Any], Any]


@dataclass(frozen=True)
class Case:
    """A spec of specs/ with keys changed; `quick` ones are a test as well."""

    mechanism: str
    name: str
    settings: tuple[str, ...] = ()
    outline: bool = False
    quick: bool = False


@dataclass(frozen=True)
class Outcome:
    """What became of a case: error against its tolerance (mm, or a share of the range), or why it was refused."""

    error: float
    tolerance: float
    condition: float
    said: str

    @property
    def fine(self) -> bool:
        """Within the tolerance, or refused with a reason."""
        return (
            self.said.startswith("refused: ")
            if math.isnan(self.error)
            else self.error <= self.tolerance
        )


# ---- the sources' formulas at 50 digits ------------------------------------------------------------------------------


def law(name: str, u: Any) -> Any:
    """Displacement 0 to 1 of a motion law. [VDI 2143; MR-13 by its published coefficients, sign of A6 corrected]"""
    if name == "cycloidal":
        return u - mp.sin(2 * mp.pi * u) / (2 * mp.pi)
    if name == "simple-harmonic":
        return (1 - mp.cos(mp.pi * u)) / 2
    if name == "3-4-5":
        return u**3 * (10 - 15 * u + 6 * u**2)
    assert name == "mr-13", name
    b1 = mp.mpf("2.550126")
    sines = [mp.mpf(a) for a in ("3.587020", "-0.871476", "-0.566845", "0.316224", "-0.025629")]
    waves = mp.fsum(
        a * mp.sin(2 * k * mp.pi * u) / (4 * k**2 * mp.pi**2) for k, a in enumerate(sines, 1)
    )
    return ((mp.pi**2 - 2 * b1) * u + b1 - b1 * mp.cos(mp.pi * u)) / mp.pi**2 - waves


def program(segments: Sequence[tuple[float, float, float, str]], theta: Any) -> Any:
    """Displacement after segments (span, deg; from; to; law); the last one fills the turn."""
    degrees = mp.mpf(theta) * 180 / mp.pi % 360
    for k, (span, start, stop, name) in enumerate(segments):
        if degrees <= span or k == len(segments) - 1:
            return (
                start + (stop - start) * law(name, degrees / span)
                if stop != start
                else mp.mpf(start)
            )
        degrees -= mp.mpf(span)
    raise AssertionError


def uniform_swing(machine: Any) -> Truth:
    """The tip's centre in the ground: equations 3 to 5 of the source."""
    g = machine.geometry
    far, lever = mp.mpf(g.pivot_distance), mp.mpf(g.arm_offset)
    arm, delta = mp.sqrt(far**2 + lever**2), mp.mpf(g.swing_deg) * mp.pi / 360

    def centre(theta: Any) -> Any:
        share = mp.mpf(theta) / mp.pi % 2
        alpha = mp.atan2(lever, far) + delta * (2 * share - 1 if share <= 1 else 3 - 2 * share)
        return mp.mpc(far - arm * mp.cos(alpha), -arm * mp.sin(alpha))

    return centre


def swing_arm(far: float, arm: float, reach: float, motion: Truth) -> Truth:
    """Roller's centre on an arm about (far, 0), so far from the shaft at displacement 0, moving outwards."""
    a, r, d = mp.mpf(arm), mp.mpf(reach), mp.mpf(far)
    opening = mp.acos((d**2 + a**2 - r**2) / (2 * d * a))
    return lambda theta: d - a * mp.expj(opening + motion(theta))


def indexing_cam(machine: Any) -> Truth:
    """The roller's centre: rise, dwell, return, dwell of the arm."""
    g, f = machine.geometry, machine.geometry.follower
    swing = mp.mpf(g.index_deg) / mp.mpf(g.gear_ratio) * mp.pi / 180
    back = g.rise_deg if g.return_deg is None else g.return_deg
    spans = ((g.rise_deg, 0, swing), (g.dwell_deg, swing, swing), (back, swing, 0), (360, 0, 0))
    segments = [(*span, getattr(g.law, "name", g.law)) for span in spans]
    return swing_arm(
        f.pivot_distance, f.arm, g.base_radius + f.roller_radius, partial(program, segments)
    )


def disc_cam(machine: Any) -> Truth:
    """The roller's centre, or for a face i times its height."""
    f, table, at = machine.geometry.follower, [], mp.mpf(0)
    oscillating = f.motion == "oscillating"
    for segment in machine.segment:
        to = segment.to if segment.to is not None else float(at) + (segment.lift or 0.0)
        table.append((segment.span_deg, at, mp.mpf(to), getattr(segment.law, "name", segment.law)))
        at = mp.mpf(to)
    reach = machine.geometry.base_radius + (f.radius or 0.0)
    if oscillating:
        return swing_arm(
            f.pivot_distance, f.arm, reach, lambda theta: program(table, theta) * mp.pi / 180
        )
    return lambda theta: mp.mpc(0, reach + program(table, theta))


def eccentric_drive(machine: Any) -> Truth:
    """Way of the slider from its outermost place: the closed vector contour, with an offset guide."""
    g = machine.geometry
    crank, rod, offset = (mp.mpf(x) for x in (g.eccentricity, g.rod, g.offset))
    most = mp.sqrt((rod + crank) ** 2 - offset**2)
    return lambda theta: (
        most - crank * mp.cos(theta) - mp.sqrt(rod**2 - (crank * mp.sin(theta) - offset) ** 2)
    )


def eye_of(machine: Any) -> Truth:
    """The take-up's eye D: B by the crossing of two circles, D in the coupler's axes."""
    g = machine.geometry
    crank, coupler, output, frame = (
        mp.mpf(x) for x in (g.input_crank, g.coupler, g.output_crank, g.frame)
    )
    # B lies to the left (branch +1) of the way from A to C: seen from B, C and D lie to the left of the way to A
    eye = mp.mpf(g.eye_distance) * mp.expj(g.branch * mp.mpf(g.eye_angle_deg) * mp.pi / 180)
    tilt = mp.expj(mp.mpf(g.frame_angle_deg) * mp.pi / 180)

    def eye_at(theta: Any) -> Any:
        a, c = crank * mp.expj(theta), frame * tilt
        way = c - a
        along = (abs(way) ** 2 + coupler**2 - output**2) / (2 * abs(way))
        across = mp.sqrt(coupler**2 - along**2)
        b = a + way / abs(way) * mp.mpc(along, g.branch * across)
        return b + (a - b) / coupler * eye

    return eye_at


def thread_take_up(machine: Any) -> Truth:
    """The feed |M D| + |D N|."""
    eye, (m, n) = eye_of(machine), (mp.mpc(*guide) for guide in machine.geometry.guides)
    return lambda theta: abs(m - eye(theta)) + abs(n - eye(theta))


def chain_stitch_looper(machine: Any) -> Truth:
    """Way of the spreaders, 0.5 L_X (1 - cos phi), L_X = r S_X with the stroke that the feed asks for."""
    g = machine.geometry
    (h1, h2), (a1, a2), (s1, s2) = (
        [mp.mpf(x) for x in pair] for pair in (g.point_lengths, g.nose_over_eye, g.loop_rise)
    )
    b = a2 - a1 + (h2 - h1) / 2
    e, thick = mp.mpf(g.plate_to_spreader), mp.mpf(g.material_thickness)
    in_fabric = max(
        h1 + s1 + a1 + 2 * (b + mp.mpf(g.protrusion)) + e + thick, h2 + s2 + a2 + b + e + thick
    )
    stroke = 2 * in_fabric / (1 - mp.cos(mp.pi - mp.mpf(g.feed_deg) * mp.pi / 360))
    return lambda theta: mp.mpf(g.velocity_ratio) * stroke * (1 - mp.cos(theta)) / 2


TRUTHS: dict[str, Callable[[Any], Truth]] = {
    "uniform-swing": uniform_swing,
    "disc-cam": disc_cam,
    "indexing-cam": indexing_cam,
    "eccentric-drive": eccentric_drive,
    "thread-take-up": thread_take_up,
    "chain-stitch-looper": chain_stitch_looper,
}


def refused(reason: CamgenError) -> Outcome:
    """No such mechanism, and why."""
    said = " ".join(str(reason).replace(f"{SPECS}{os.sep}", "").split())
    return Outcome(math.nan, math.nan, math.nan, f"refused: {said}")


# ---- outlines --------------------------------------------------------------------------------------------------------


def apart(ring: Ring, z: np.ndarray) -> np.ndarray:
    """Distance of each z from a ring of lines and arcs, mm: to every edge, no table."""
    a, chord = ring.points, np.roll(ring.points, -1) - ring.points
    arcs = ring.bulges != 0
    start, half = a[arcs], 2 * np.arctan(ring.bulges[arcs])  # half the arc's sweep
    top = (
        -1j * chord[arcs] / 2 / np.tan(half)
    )  # from the centre to the middle of the chord, or away from it
    centre = start + chord[arcs] / 2 - top
    middle = np.abs(start - centre) * -1j * np.sign(half) * chord[arcs] / np.abs(chord[arcs])
    found = np.empty(len(z))
    for k, p in enumerate(z):
        u = np.clip((np.conj(chord) * (p - a)).real / np.abs(chord) ** 2, 0, 1)
        reach = np.abs(p - a - u * chord)
        within = np.abs(np.angle((p - centre) / middle)) <= np.abs(half)
        ends = np.minimum(np.abs(p - start), np.abs(p - start - chord[arcs]))
        reach[arcs] = np.where(within, np.abs(np.abs(p - centre) - np.abs(start - centre)), ends)
        found[k] = reach.min()
    return found


def highest(ring: Ring, turn: float) -> float:
    """Greatest y of a ring of lines and arcs turned about the origin."""
    a = ring.points * np.exp(1j * turn)
    half, chord = 2 * np.arctan(ring.bulges), np.roll(a, -1) - a
    bowed = half > 0  # the others' ends are higher
    radius = np.abs(chord[bowed]) / (2 * np.sin(half[bowed]))
    side = -1j * chord[bowed] / np.abs(chord[bowed])  # from the centre to the arc's middle
    centre = a[bowed] + chord[bowed] / 2 - side * radius * np.cos(half[bowed])
    crowned = np.abs(np.angle(1j / side)) <= half[bowed]
    return float(max(a.imag.max(), (centre.imag + radius)[crowned].max(initial=-np.inf)))


def rings(folder: Path, part: str) -> dict[str, Ring]:
    """The outer contour in a part's DXF and STL."""
    name = folder / f"{folder.name}-{part}"
    mesh = read_stl(name.with_name(name.name + ".stl"))
    levels = np.unique(mesh.vertices[:, 2])
    cut = slice_mesh(mesh, float(levels[0] + levels[1]) / 2)
    return {
        "dxf": shape_of(read_dxf(name.with_name(name.name + ".dxf")).cut).outer,
        "stl": shape_of(cut).outer,
    }


def judged_outline(case: Case, folder: Path) -> Outcome:
    """Build, read back, and hold the tip to it."""
    spec = SPECS / f"{case.mechanism}.toml"
    try:
        machine: Any = pipeline.read_mechanism(spec, case.settings)
        report = pipeline.build(spec, folder, frozenset({"dxf", "stl"}), case.settings)
    except CamgenError as reason:
        return refused(reason)
    cam = machine.cams["cam"] if case.mechanism == "indexing-cam" else machine.cam
    truth, theta = TRUTHS[case.mechanism](machine), angles(case, cam)
    centres = np.array([complex(truth(t) * mp.expj(-t)) for t in theta])
    radius = float(getattr(cam.follower, "tip_radius", 0.0))
    undercut = np.zeros(len(theta), bool)
    for cut in cam.undercuts:
        undercut |= (theta - cut.begin + 1e-9) % (2 * math.pi) <= (cut.end - cut.begin) + 2e-9
    error, allowed = 0.0, machine.accuracy.chord_tolerance
    for kind, ring in rings(folder / machine.name, "cam").items():
        if machine.mechanism == "disc-cam" and machine.geometry.follower.shape == "flat":
            heights = np.array([abs(truth(t)) for t in theta], float)
            off = heights - np.array([highest(ring, t) for t in theta])
        else:
            off = apart(ring, centres) - radius
        off = np.where(undercut, np.minimum(off, 0), off)
        float32 = FLOAT32 * float(np.abs(ring.points).max()) * 2 if kind == "stl" else 0.0
        error = max(error, float(np.abs(off).max()) - float32)
    told = sorted({f.code for f in report.findings if not f.ok})
    steep = float(np.max(cam.pressure_angle(theta)))
    said = "kept" + (", and told: " + ", ".join(told) if told else "")
    return Outcome(error, allowed * (1 + 1e-6) + 1e-12, 1 / math.cos(steep), said)


def angles(case: Case, cam: Any) -> np.ndarray:
    """200 angles that made nothing, and both sides of every joint."""
    seed = np.random.default_rng(sum(map(ord, case.name)))
    joints = np.cumsum([segment.span for segment in cam.program.segments])
    near = np.concatenate([joints - 1e-6, joints + 1e-6])
    return np.sort(np.concatenate([seed.uniform(0, 2 * math.pi, 200), near]) % (2 * math.pi))


# ---- motion ----------------------------------------------------------------------------------------------------------


def judged_motion(case: Case, folder: Path) -> Outcome:
    """The output and two derivatives at seeded angles."""
    try:
        machine: Any = pipeline.read_mechanism(SPECS / f"{case.mechanism}.toml", case.settings)
        theta = np.random.default_rng(7).uniform(0, 2 * math.pi, 25)
        theta = np.append(theta, [0.0, math.pi / 2, math.pi])
        values = [machine.motion(theta, order) for order in range(3)]
        if not all(np.isfinite(value).all() for value in values):
            _ = machine.assembly
    except CamgenError as reason:
        return refused(reason)
    truth = TRUTHS[case.mechanism](machine)
    condition, error, share = steepness(machine, theta), 0.0, 0.0
    for order, found in enumerate(values):
        exact = [
            truth(mp.mpf(t))
            if order == 0
            else mp.diff(truth, mp.mpf(t), order, h=mp.mpf(10) ** -12)
            for t in theta
        ]
        scale = max(abs(x) for x in exact)
        worst = max(
            float(abs(mp.mpf(float(a)) - b) / scale) for a, b in zip(found, exact, strict=True)
        )
        allowed = 64 * ROUNDING * condition ** (2 * order + 1) * weight(machine)
        if worst / allowed >= share:
            share, error, tolerance = worst / allowed, worst, allowed
    return Outcome(error, tolerance, condition, "kept")


def steepness(machine: Any, theta: np.ndarray) -> float:
    """1 / sin of the least transmission angle at these angles; 1 for the looper, whose output is a law alone.

    Of a take-up, besides, how near its eye comes to a guide, as a share of its own arm.
    """
    g = machine.geometry
    if machine.mechanism == "eccentric-drive":
        lean = np.abs(g.eccentricity * np.sin(theta) - g.offset) / g.rod
        return 1 / math.sqrt(1 - float(np.max(lean)) ** 2)
    if machine.mechanism == "thread-take-up":
        way2 = (
            g.input_crank**2
            + g.frame**2
            - 2 * g.input_crank * g.frame * np.cos(theta - math.radians(g.frame_angle_deg))
        )
        cosine = (g.coupler**2 + g.output_crank**2 - way2) / (2 * g.coupler * g.output_crank)
        eye = np.array([complex(eye_of(machine)(mp.mpf(t))) for t in theta])
        near = min(
            float(np.abs(eye - complex(*guide)).min()) for guide in g.guides
        )  # there the thread turns in no time
        return max(
            1 / math.sqrt(1 - float(np.max(np.abs(cosine))) ** 2), float(g.eye_distance) / near
        )
    return 1.0


def weight(machine: Any) -> float:
    """How much larger the lengths are than the output's range, where it is a difference of them."""
    g = machine.geometry
    if machine.mechanism == "thread-take-up":
        return float(max(abs(complex(*guide)) for guide in g.guides) / max(g.frame, 1e-3))
    # the looper's stroke is made a hair longer, 1e-12 of itself
    return 200.0 if machine.mechanism == "chain-stitch-looper" else 1.0


# ---- the cases -------------------------------------------------------------------------------------------------------

# What the designer accepts is opened wide: here the question is whether files keep the motion.
WIDE = ("limits.speed_ripple=10", "print.nozzle=0.001", "print.bed=[1e6,1e6]")
OPEN = {
    "uniform-swing": (
        *WIDE,
        "parts.make='cams'",
        "parts.windows=0",
        "parts.pin_diameter=0",
        "parts.mark_depth=0",
        "limits.pressure_angle_deg=90",
        "limits.undercut_deg=180",
        "limits.lash_deg=180",
    ),
    "disc-cam": (
        *WIDE,
        "parts.hub_height=0",
        "limits.pressure_angle_deg=89.9",
        "limits.undercut=1000",
        "limits.least_radius=0",
        "limits.continuous=-1",
    ),
    "indexing-cam": (
        *WIDE,
        "limits.pressure_angle_deg=89.9",
        "limits.undercut_deg=180",
        "limits.acceleration_jump=1e6",
        "limits.residual=100",
    ),
}


def swing(
    name: str,
    quick: bool = False,
    *,
    swing: float = 30,
    offset: float = 0.5,
    tip: float = 0.05,
    size: float = 60.0,
    tolerance: float = 1e-3,
) -> Case:
    """A uniform-swing cam; lengths are shares of the pivot distance, `size`, and so are the body's."""
    shares = {
        "geometry.pivot_distance": 1.0,
        "geometry.arm_offset": offset,
        "geometry.tip_radius": tip,
        "parts.thickness": 0.1,
        "parts.bore": 0.02,
        "parts.wall": 0.01,
        "limits.min_wall": 0.001,
    }
    sized = [
        f"{key}={max(share * size, 0 if key == 'geometry.tip_radius' else 1e-3):.12g}"
        for key, share in shares.items()
    ]
    sized += [f"geometry.swing_deg={swing:.12g}", f"accuracy.chord_tolerance={tolerance:.3g}"]
    return Case("uniform-swing", name, (*OPEN["uniform-swing"], *sized), True, quick)


def segments(*rows: tuple[str, float, float, str]) -> str:
    """The disc cam's program: kind, span, end, law."""
    tables = []
    for kind, span, to, name in rows:
        moves = "" if kind == "dwell" else f',to={to!r},law="{name}"'
        tables.append(f'{{kind="{kind}",span_deg={span!r}{moves}}}')
    return f"segment=[{','.join(tables)}]"


def disc(name: str, program: str, *more: str, quick: bool = False) -> Case:
    """A disc cam with its limits opened."""
    return Case("disc-cam", name, (*OPEN["disc-cam"], program, *more), True, quick)


def plain(lift: float, law: str = "cycloidal", span: float = 120.0, dwell: float = 60.0) -> str:
    """Rise, dwell, return, dwell."""
    return segments(
        ("rise", span, lift, law),
        ("dwell", dwell, lift, law),
        ("return", span, 0.0, law),
        ("dwell", 360 - 2 * span - dwell, 0.0, law),
    )


def indexing(name: str, *settings: str, quick: bool = False) -> Case:
    """An indexing cam with its limits opened."""
    return Case("indexing-cam", name, (*OPEN["indexing-cam"], *settings), True, quick)


def drive(name: str, *settings: str, quick: bool = True) -> Case:
    """An eccentric drive, its motion."""
    return Case("eccentric-drive", name, settings, False, quick)


def take_up(name: str, *settings: str, quick: bool = True) -> Case:
    """A thread take-up, its feed."""
    return Case("thread-take-up", name, settings, False, quick)


def looper(name: str, *settings: str, quick: bool = True) -> Case:
    """A looper, its strokes."""
    return Case("chain-stitch-looper", name, settings, False, quick)


FLAT = 'geometry.follower={motion="translating",shape="flat"}'
KNIFE = 'geometry.follower={motion="translating",shape="knife"}'
CASES = (
    swing("as shipped", True),
    *(
        swing(f"swing {x:g} deg", x == 1e-4, swing=x)
        for x in (1e-4, 1e-3, 0.01, 1, 10, 45, 50, 53, 53.1, 53.2, 80)
    ),
    *(
        swing(f"swing {x:g} deg, arm offset 6 L", swing=x, offset=6.0)
        for x in (53, 120, 150, 160, 161.1)
    ),
    *(swing(f"arm offset {x:g} L", offset=x) for x in (0, 0.01, 0.2679, 0.268, 0.27, 0.3, 1, 3)),
    *(
        swing(f"tip {x:g} L", x == 0.1753, tip=x)
        for x in (0, 1e-6, 1e-4, 0.01, 0.1, 0.175, 0.1753, 0.1754, 0.18, 0.2, 0.25, 1)
    ),
    *(
        swing(f"size {x:g} mm", size=x, tolerance=max(1e-7, min(0.1, x * 2e-5)))
        for x in (1e-3, 1e-2, 0.1, 1, 1e3, 1e4, 1e5)
    ),
    *(swing(f"tolerance {x:g} mm", tolerance=x) for x in (0.1, 0.01, 1e-4, 1e-5, 1e-6, 1e-7)),
    disc("as shipped but for its laws", plain(12.0), quick=True),
    *(
        disc(f"rise and return in {x:g} deg", plain(1.0, span=x, dwell=1.0))
        for x in (0.01, 1, 5, 20, 179)
    ),
    *(disc(f"dwell of {x:g} deg", plain(12.0, dwell=x)) for x in (1e-12, 1e-9, 1e-6, 1e-3, 1)),
    disc(
        "speed jumps at both ends (harmonic, no dwell)",
        segments(
            ("rise", 180.0, 12.0, "simple-harmonic"), ("return", 180.0, 0.0, "simple-harmonic")
        ),
    ),
    *(disc(f"lift {x:g} mm", plain(x)) for x in (1e-9, 1e-6, 1e-3, 30, 60, 100, 200)),
    *(
        disc(
            f"roller {x:g} mm",
            plain(12.0),
            f'geometry.follower={{motion="translating",shape="roller",radius={x:g}}}',
        )
        for x in (1e-6, 1, 10, 20, 40, 100)
    ),
    *(
        disc(f"base circle {x:g} mm", plain(12.0), f"geometry.base_radius={x:g}")
        for x in (5, 6, 8, 10, 15, 1e3, 1e5)
    ),
    disc("knife edge", plain(12.0), KNIFE),
    *(
        disc(f"flat face, base {x:g} mm", plain(12.0, "3-4-5"), FLAT, f"geometry.base_radius={x:g}")
        for x in (8, 12, 14.2, 14.3, 20, 40)
    ),
    *(
        disc(
            f"arm {x:g} mm on a pivot at 60 mm",
            plain(15.0),
            "geometry.base_radius=25",
            f'geometry.follower={{motion="oscillating",shape="roller",radius=5,pivot_distance=60,arm={x:g}}}',
        )
        for x in (30.0001, 31, 50, 89, 89.9999)
    ),
    *(
        disc(f"tolerance {x:g} mm", plain(12.0), f"accuracy.chord_tolerance={x:g}")
        for x in (0.1, 1e-5, 1e-6, 1e-7)
    ),
    indexing("as shipped", quick=True),
    *(
        indexing(f"turn in {x:g} deg", f"geometry.rise_deg={x:g}")
        for x in (1, 10, 40, 60, 149, 150, 151)
    ),
    *(
        indexing(f"dwell of {x!r} deg", f"geometry.dwell_deg={x!r}")
        for x in (1e-9, 1e-6, 0.01, 119.999999, 120.0)
    ),
    *(
        indexing(f"gear ratio {x:g}", f"geometry.gear_ratio={x:g}")
        for x in (1, 1.2, 2, 3, 100, 1e6)
    ),
    *(
        indexing(f"base circle {x:g} mm", f"geometry.base_radius={x:g}")
        for x in (20.0001, 25, 35, 100, 199)
    ),
    *(
        indexing(
            f"roller {x:g} mm",
            f"geometry.follower={{arm=90,pivot_distance=120,roller_radius={x:g}}}",
        )
        for x in (0, 0.01, 30, 40, 60)
    ),
    drive("as shipped"),
    *(
        drive(f"crank / rod {x!r}", "geometry.rod=1e6", f"geometry.eccentricity={1e6 * x!r}")
        for x in (1e-9, 1e-8, 1e-6)
    ),
    *(
        drive(f"crank / rod {x!r}", f"geometry.rod={1.5 / x!r}")
        for x in (1e-3, 0.1, 0.9, 0.99, 0.999999, 0.999999999999, 1.0, 1.0001, 2.0)
    ),
    *(
        drive(f"offset {x:g} mm", f"geometry.offset={x:g}")
        for x in (1e-9, 1, 20, 40, 46, 46.49, 46.4999, 46.5, 47)
    ),
    *(
        drive(
            f"size {x:g}",
            *(
                f"{key}={value * x:.12g}"
                for key, value in (
                    ("geometry.eccentricity", 1.5),
                    ("geometry.rod", 48),
                    ("geometry.eccentric_diameter", 9),
                    ("geometry.shaft_diameter", 2),
                    ("motor.boss_diameter", 6),
                    ("motor.diameter", 21),
                )
            ),
        )
        for x in (1e-3, 1e-2, 1e2, 1e3)
    ),
    take_up("as shipped"),
    *(
        take_up(f"frame {x!r} mm, fold at 19", f"geometry.frame={x!r}")
        for x in (1e-9, 1e-3, 18.9, 18.99, 18.999, 18.9999, 18.999999, 18.999999999, 19.0, 19.0001)
    ),
    take_up("coupler and output crank alike", "geometry.coupler=30"),
    take_up("parallelogram", "geometry.coupler=9", "geometry.output_crank=30"),
    take_up("eye at the joint", "geometry.eye_distance=1e-6"),
    take_up(
        "guide on the eye's path", "geometry.guides=[[21.5355314508, -20.2259486324], [-80, 160]]"
    ),
    take_up("both guides in one place", "geometry.guides=[[40, 15], [40, 15]]"),
    take_up("guides far away", "geometry.guides=[[4e4, 15], [-8e4, 160]]"),
    looper("as shipped"),
    *(
        looper(f"b = {x:g} mm", f"geometry.point_lengths=[6, {6 + 2 * (x - 2.5):.12g}]")
        for x in (3.5, 1, 0.1, 1e-3, 1e-6, 1e-9, 0, -0.4)
    ),
    *(
        looper(f"feed over {x:g} deg", f"geometry.feed_deg={x:g}")
        for x in (1e-6, 1, 240, 300, 350, 359.9, 359.999999)
    ),
    *(
        looper(f"velocity ratio {x:g}", f"geometry.velocity_ratio={x:g}")
        for x in (1e-6, 0.1, 0.86, 5, 1e3)
    ),
    *(looper(f"loop rise {x:g} mm", f"geometry.loop_rise=[{x:g}, 4.5]") for x in (0, 1e-9, 10, 50)),
    looper("needle as wide as the stitch", "geometry.needle_diameter=6.4"),
    looper("needle of no width", "geometry.needle_diameter=1e-9"),
)


def judged(case: Case, folder: Path) -> Outcome:
    """What becomes of a case; a fault of ours is told as one."""
    try:
        return (judged_outline if case.outline else judged_motion)(case, folder)
    except Exception as error:  # the table is to show it, whatever it is
        return Outcome(math.inf, 0.0, math.nan, f"BROKEN: {type(error).__name__}: {error}")


def main(wanted: Sequence[str]) -> int:
    """Print the table; 1 where a row is neither kept nor refused."""
    print(
        "| mechanism | case | error | allowed | condition | outcome |",
        "|---|---|---|---|---|---|",
        sep="\n",
    )
    bad = 0
    with tempfile.TemporaryDirectory() as folder:
        for case in CASES:
            if wanted and case.mechanism not in wanted:
                continue
            found = judged(case, Path(folder))
            bad += not found.fine
            unit = "mm" if case.outline else "of its range"
            numbers = (
                ("-", "-", "-")
                if math.isnan(found.error)
                else (
                    f"{found.error:.1e} {unit}",
                    f"{found.tolerance:.1e}",
                    f"{found.condition:.3g}",
                )
            )
            said = found.said if found.fine else f"**BAD** {found.said}"
            print("| " + " | ".join((case.mechanism, case.name, *numbers, said)) + " |", flush=True)
    print(f"\n{bad} rows are neither within their tolerance nor refused")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
