"""What a report shows of an eccentric drive: peak speed, harmonics, forces, and the paper's table with its errata."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from camgen.machine.landmarks import zeros
from camgen.machine.model import Floats, Machine
from camgen.machine.run import solve
from camgen.numerics import magnitude
from camgen.study import Figure, Figures, Plot, Study, Table

Motion = Callable[[Floats, int], Floats]

_PAPER = (1.5, 48.0, 0.0)
PAPER_SPEED = 22.6  # rad/s: 13000/60 taken for rpm
# Published: angle deg, v3 mm/s, phi2 deg, phi2' rad/s.
PUBLISHED = (
    (30, 16.49, 0.9, 0.61),
    (60, 28.9, 1.55, 0.35),
    (90, 33.9, 1.79, 0.0),
    (120, 28.9, 1.55, -0.35),
    (150, 16.49, 0.9, -0.61),
    (180, 0.0, 0.0, -0.7),
    (210, -16.49, -0.9, -0.61),
    (240, -28.9, -1.55, -0.35),
    (270, -33.9, -1.79, 0.0),
    (300, -28.9, -1.55, 0.35),
    (330, -16.49, -0.9, 0.61),
    (360, 0.0, 0.0, 0.7),
)
_ERRATA = (
    "Erratum 1: the published v3 at 30 and 330 deg is 5.28 % low, at 60 and 300 deg 3.08 % low: the table mirrors 150 and "
    "120 deg.",
    "Erratum 2: phi2 is printed without its minus sign, which contradicts the closure; the header gives phi2' in degrees, it is "
    "rad/s.",
    "Erratum 3: 22.6 rad/s puts 13000/60, revolutions per second, into a formula that wants rpm. The motor's real speed is "
    "1361.357 rad/s; 22.69 rad/s is 216.67 rpm, 3.6 strokes per second.",
    "Erratum 4: the greatest speed is not at 90 deg but at 88.212 deg.",
    "Erratum 5: the speed curve is not a sine: it has a second harmonic of about half of eccentricity / rod.",
    "Erratum 6: an eccentric disc of 5 mm, bored 1.5 mm off centre for a 2 mm shaft, leaves a wall of 2.5 - 1.5 - 1 = 0 mm. A "
    "printable one is larger, with a strap round it; the motion does not change.",
)


def study(
    machine: Machine, motion: Motion, lengths: tuple[float, float, float], rpm: float, loaded: bool
) -> Study:
    """Numbers, curves and tables; forces where [masses] load it; the published table where the lengths are the paper's.

    motion: the slider's way (theta, order), mm; lengths: eccentricity, rod, offset, mm.
    """
    degrees = np.linspace(0, 360, 1441)
    theta = np.radians(degrees)
    speed = rpm * math.tau / 60
    at, top = _peak(motion)
    wave = np.abs(np.fft.rfft(motion(np.linspace(0, math.tau, 4096, endpoint=False), 1)))
    outermost = float(motion(np.zeros(1), 2)[0]) * speed**2
    figures = [
        Figure("motor speed", speed, "rad/s"),
        Figure("strokes", abs(rpm) / 60, "1/s"),
        Figure("peak speed", top * abs(speed), "mm/s"),
        Figure("peak speed angle", math.degrees(at), "deg"),
        Figure("peak speed ratio", top / lengths[0]),
        Figure("acceleration outermost", outermost, "mm/s²"),
        Figure("second harmonic share", float(wave[2] / wave[1])),
    ]
    label = "crank angle, deg"
    plots = [
        Plot(title, label, unit, [("exact", degrees, motion(theta, order) * speed**order * 1e-3)])
        for order, title, unit in ((1, "Slider speed", "m/s"), (2, "Slider acceleration", "m/s²"))
    ]
    units = (1.0, speed, speed**2 * 1e-3)
    rows = np.column_stack(
        [degrees[::120], *(_clean(motion(theta[::120], k) * unit) for k, unit in enumerate(units))]
    )
    columns = ("crank angle, deg", "travel, mm", "speed, mm/s", "acceleration, m/s²")
    tables = [
        Table("Travel from the outermost place, at the motor's speed", columns, rows.tolist())
    ]
    notes: tuple[str, ...] = ()
    if lengths == _PAPER:
        plots.append(_other_sizes(machine))
        figures.append(Figure("paper speed", PAPER_SPEED, "rad/s"))
        figures.append(Figure("paper peak speed", top * PAPER_SPEED, "mm/s"))
        tables.append(_published(machine, motion))
        source = "Source: Sviridov, Vladimirov, Chusovitin, study of the crank-slider mechanism of a tattoo machine."
        notes = (source, *_ERRATA)
    if loaded:
        forces = solve(machine, theta).forces()
        (torque,) = forces.drives.values()
        for name, force in forces.reactions.items():
            peak = magnitude(force)
            figures.append(Figure("peak force {joint}", peak, "N", joint=name))
        figures.append(Figure("peak torque", magnitude(torque), "N m"))
        plots += [
            Plot(
                "Joint forces",
                label,
                "N",
                [(name, degrees, np.abs(f)) for name, f in forces.reactions.items()],
            ),
            Plot("Driving torque", label, "N m", [("torque", degrees, torque)]),
        ]
    return Study(Figures(figures), plots, tables, (), notes)


def _peak(motion: Motion) -> tuple[float, float]:
    """Crank angle, rad, and size, mm/rad, of the greatest speed; the first of equal ones."""

    def slope(theta: Floats, order: int) -> Floats:
        return motion(theta, 2) if order == 0 else np.full(theta.shape, np.nan)

    found = zeros(slope)
    speeds = np.abs(motion(found, 1))
    k = int(np.argmax(speeds > speeds.max() * (1 - 1e-12)))
    return float(found[k]), float(speeds[k])


def _other_sizes(machine: Machine) -> Plot:
    """The paper's figure 6: speed at its own crank speed, with crank and rod larger and smaller. By how much it does not say."""
    theta = np.linspace(0, math.tau, 721)
    speed = solve(machine, theta, 1).derivatives("travel")[1] * PAPER_SPEED
    # crank and rod by one factor: the same shape, so the same curve by that factor
    series = [
        (f"crank {_PAPER[0] * k:g}, rod {_PAPER[1] * k:g}", np.degrees(theta), speed * k)
        for k in (4 / 3, 1.0, 2 / 3)
    ]
    return Plot(
        f"Slider speed of figure 6, at {PAPER_SPEED:g} rad/s", "crank angle, deg", "mm/s", series
    )


def _published(machine: Machine, motion: Motion) -> Table:
    """The paper's table beside exact values at the paper's speed; v3 positive towards the shaft, as printed."""
    theta = np.radians([row[0] for row in PUBLISHED])
    rod = solve(machine, theta, 1).angle("rod")
    tilt = np.degrees(rod[0])
    rate = rod[1] * PAPER_SPEED
    exact = zip(
        *(_clean(values) for values in (motion(theta, 1) * PAPER_SPEED, tilt, rate)), strict=True
    )
    rows = [
        [angle, v, x, round((v / x - 1) * 100, 9) + 0.0 if x else 0.0, phi, y, dphi, z]
        for (angle, v, phi, dphi), (x, y, z) in zip(PUBLISHED, exact, strict=True)
    ]
    columns = (
        "crank angle, deg",
        "published v3, mm/s",
        "exact v3, mm/s",
        "v3 off by, %",
        "published phi2, deg",
        "exact phi2, deg",
        "published phi2', rad/s",
        "exact phi2', rad/s",
    )
    return Table(f"Published table and exact values at {PAPER_SPEED:g} rad/s", columns, rows)


def _clean(values: Floats) -> list[float]:
    """Values of a table, rounding noise beside its greatest made zero."""
    return [
        float(v) for v in np.where(np.abs(values) < 1e-13 * np.max(np.abs(values)), 0.0, values)
    ]
