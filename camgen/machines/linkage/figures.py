"""What the report shows of a linkage: numbers, curves, paths, and the class of a four-bar."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from camgen.geometry.outlines import Floats
from camgen.machine import model as m
from camgen.machine.closed_form import FourBar, four_bar
from camgen.machine.run import solve
from camgen.machine.study import Plot, Sketch, Study, Table

if TYPE_CHECKING:
    from camgen.machines.linkage.mechanism import Linkage, Signal

ROWS = 1441  # of curves and of motion.csv: every quarter degree of a turn, both ends


def study(linkage: Linkage) -> Study:
    """Numbers, plots and tables of a linkage over its turn or range."""
    theta = np.linspace(*linkage.range, ROWS)
    run = linkage.solve(theta)
    numbers: dict[str, float] = {}
    plots, rows = [], []
    for signal in linkage.signals:
        value, first, second = signal.scale * signal.rows(run)
        low, high = _extremes(linkage, signal, theta, value)
        speed, hard = float(np.abs(first).max() * abs(linkage.speed)), float(np.abs(second).max() * linkage.speed**2)
        unit = signal.unit
        numbers |= {
            f"{signal.name}_least_{unit}": low, f"{signal.name}_greatest_{unit}": high,
            f"{signal.name}_stroke_{unit}": high - low,
            f"{signal.name}_peak_speed_{unit}_s": speed, f"{signal.name}_peak_acceleration_{unit}_s2": hard,
        }  # fmt: skip
        rows.append((signal.name, unit, low, high, high - low, speed, hard))
    for output in linkage.chain.outputs:
        if isinstance(output.of, m.Path):
            path = np.asarray(run[output.name], complex)
            marks = path[::60]  # of equal time where the drive turns evenly
            series = [("path", path.real, path.imag), ("every 15 deg", marks.real, marks.imag)]
            plots.append(Plot(f"Path of {output.name}", "x, mm", "y, mm", series, equal=True))
    heads = ("output", "unit", "least", "greatest", "stroke", "peak speed, /s", "peak acceleration, /s^2")
    tables = [Table("Outputs", heads, rows)]
    notes = []
    bar = four_bar_of(linkage.chain, linkage.drive.link)
    if bar is not None:
        numbers["grashof_margin_mm"] = bar.margin
        notes.append(f"A four-bar, by Grashof a {bar.kind}: the middle two lengths exceed the shortest and the longest by "
                     f"{bar.margin:.6g} mm.")  # fmt: skip
    if linkage.drive.range_deg is not None:
        notes.append("The drive goes to and fro over its range; speeds are those of an even turn of it.")
    forces = _forces(linkage, theta)
    return Study({**numbers, **forces.numbers}, [*plots, *forces.plots], [*tables, *forces.tables], paths(linkage), notes)


def _forces(linkage: Linkage, theta: Floats) -> Study:
    """Torque of the drive and reactions of the joints at an even turn, by the masses of the parts; nothing without parts."""
    if linkage.lacking() is not None:
        return Study()
    found, label = solve(linkage.machine(), theta).forces(), f"{linkage.drive.link}, deg"
    torque = next(iter(found.drives.values()))
    loads = {**found.reactions, **found.normals}
    numbers = {"peak_torque_n_m": float(np.abs(torque).max()), "peak_kinetic_energy_j": float(found.energy.max())}
    numbers |= {f"reaction_{name.lower().replace(' ', '_')}_n": float(np.abs(load).max()) for name, load in loads.items()}
    for cam in (joint for joint in linkage.chain.joints if isinstance(joint, m.Cam) and joint.closure == "force"):
        unit = "n_m" if cam.slide is None else "n"  # what a spring must give at least, along the follower's motion
        numbers[f"hold_{cam.name.replace(' ', '_')}_{unit}"] = max(0.0, -float((cam.push * found.contacts[cam.name]).min()))
    rows = [(name, float(np.abs(load).max()), math.degrees(theta[int(np.abs(load).argmax())])) for name, load in loads.items()]
    plots = [Plot("Torque of the drive", label, "N m", [("torque", np.degrees(theta), torque)])]
    return Study(numbers, plots, [Table("Loads of the joints, without friction", ("joint", "greatest, N", "at, deg"), rows)])


def paths(linkage: Linkage) -> tuple[Sketch, ...]:
    """Paths of points, on the ground."""
    run = linkage.solve(np.linspace(*linkage.range, ROWS // 2), 0)
    outputs = [output for output in linkage.chain.outputs if isinstance(output.of, m.Path)]
    return tuple(Sketch(f"path of {each.name}", (np.asarray(run[each.name], complex),)) for each in outputs)


def four_bar_of(machine: m.Machine, driven: str) -> FourBar | None:
    """The class of a machine that is a four-bar driven at a ground pivot; None where it is another."""
    pins = [joint for joint in machine.joints if isinstance(joint, m.Pin)]
    ground = [pin for pin in pins if m.GROUND in (pin.a.body, pin.b.body)]
    if not len(machine.joints) == len(pins) == 4 or len(machine.moving) != 3 or len(ground) != 2:
        return None

    def on(pin: m.Pin, body: str) -> complex | None:
        return next((place.at for place in (pin.a, pin.b) if place.body == body), None)

    lengths: dict[str, float] = {}
    for body in (m.GROUND, *(each.name for each in machine.moving)):
        places = [at for pin in pins if (at := on(pin, body)) is not None]
        if len(places) != 2:
            return None
        lengths[body] = abs(places[1] - places[0])
    output = [p.body for pin in ground for p in (pin.a, pin.b) if p.body not in (m.GROUND, driven)]
    if len(output) != 1:
        return None
    (coupler,) = set(lengths) - {m.GROUND, driven, output[0]}
    return four_bar(lengths[m.GROUND], lengths[driven], lengths[coupler], lengths[output[0]])


def _extremes(linkage: Linkage, signal: Signal, theta: Floats, value: Floats) -> tuple[float, float]:
    """Least and greatest of a signal, in its unit: the sample's, refined between its neighbours."""
    ends = [int(np.argmin(value)), int(np.argmax(value))]
    near = [np.linspace(theta[max(k - 1, 0)], theta[min(k + 1, len(theta) - 1)], 257) for k in ends]
    fine = signal.scale * signal.rows(linkage.solve(np.concatenate(near), 0))[0]
    return float(fine.min()), float(fine.max())
