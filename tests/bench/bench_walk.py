"""What a simulation in MuJoCo gives for its step and the stiffness of its loops, and by which phase the walker's sides are best
apart. Run `python tests/bench/bench_walk.py`, or with `phases` or `widths` behind it.

Two of Jansen's legs, their frame held, gravity in their plane, a turn of the crank at 30 rpm after a start of 0.3 s. Foot: greatest
distance from where the machine closes at the same crank angle; loop: greatest gap of a pin that closes one; energy: greatest
difference of the drive's work and the energy stored, as a share of the swing of that. Pins do not rub here.
"""

from __future__ import annotations

import re
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from camgen.files import mjcf
from camgen.machine.model import MM
from camgen.machine.run import solve
from camgen.machines.sources import read_mechanism
from camgen.parts.sides import PREFIX
from camgen.pipeline.multibody import simulated, standing_of
from camgen.simulation import walking

SPECS = Path(__file__).resolve().parents[2] / "specs"
SPEC = SPECS / "two-leg-walker.toml"
FEET = 'walk.feet=["foot1", "foot2", "foot3", "foot4"]'
WALKER = SPECS / "gallery" / "walker.toml"
STIFF = "0.9999 0.9999 0.0001 0.5 2"
SOFT = "0.9 0.95 0.001 0.5 2"
# integrator, step in s, time constant of the loops in steps (None: 0.02 s), their impedance
ROWS = [
    ("implicitfast", 1e-3, None, SOFT),
    ("implicitfast", 1e-3, 2, SOFT),
    ("implicitfast", 1e-4, 2, SOFT),
    ("discrete", 2e-3, 2, STIFF),
    ("discrete", 1e-3, 2, STIFF),
    ("discrete", 5e-4, 2, STIFF),
    ("discrete", 2.5e-4, 2, STIFF),
]


def smooth(mechanism: Any, standing: Any) -> mjcf.Model:
    """A machine whose pins do not rub."""
    return replace(simulated(mechanism, standing), rubs=())


def measured(text: str, motor: mjcf.Motor, machine: Any) -> tuple[float, float, float, float]:
    """Foot, mm; loop, mm; energy, %; seconds for a second."""
    simulation = mujoco.MjModel.from_xml_string(text)
    simulation.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    data = mujoco.MjData(simulation)
    feet = {each.name: each.of.of for each in machine.outputs}
    cranks, places, gaps, works, stored = [], [], [], [0.0], []
    begun = time.perf_counter()
    joint = data.joint(motor.joint)
    for k in range(round((2 * np.pi / motor.speed + 0.3) / simulation.opt.timestep)):
        data.ctrl[0] = motor.control * min(1.0, data.time / 0.3)
        before = joint.qpos[0]
        mujoco.mj_step(simulation, data)
        torque = simulation.actuator_gainprm[0, 0] * (data.ctrl[0] - joint.qvel[0])
        works.append(works[-1] + torque * (joint.qpos[0] - before))
        if k % 20:
            continue
        mujoco.mj_kinematics(simulation, data)
        mujoco.mj_comPos(simulation, data)
        mujoco.mj_energyPos(simulation, data)
        mujoco.mj_energyVel(simulation, data)
        stored.append((works[-1], float(data.energy.sum())))
        cranks.append(float(joint.qpos[0]))
        frame = data.body("ground").xmat.reshape(3, 3).T
        ends = [frame @ (data.geom(name).xpos - data.body("ground").xpos) / MM for name in feet]
        places.append([complex(x, y) for x, y, _ in ends])
        ties = zip(simulation.eq_obj1id, simulation.eq_obj2id, strict=True)
        gaps.append(
            max(np.hypot(*(frame @ (data.site_xpos[a] - data.site_xpos[b]))[:2]) for a, b in ties)
        )
    seconds = (time.perf_counter() - begun) / data.time
    run = solve(machine, np.array(cranks), 0)
    closed = np.stack([run[name] for name in feet], axis=1)
    work, energy = np.array(stored).T
    off = np.ptp(energy - work) / np.ptp(energy)
    return float(np.max(np.abs(closed - np.array(places)))), max(gaps) / MM, 100 * off, seconds


def main() -> None:
    """Print the table."""
    mechanism = read_mechanism(SPEC, ['walk.feet=["foot", "foot2"]', "drive.speed_rpm=30"])
    mechanism = mechanism.resolved()
    standing = standing_of(mechanism)
    assert standing is not None
    model = smooth(mechanism, standing).bare
    model = replace(model, motor=replace(model.motor, stall=None))
    text = mjcf.text(model).replace('<joint name="forward" type="slide" axis="1 0 0" />', "")
    text = text.replace('<joint name="upward" type="slide" axis="0 1 0" />', "")
    text = text.replace('<joint name="tilt" type="hinge" axis="0 0 1" />', "")
    text = re.sub(r'<geom name="floor"[^>]*/>', "", text)
    print(
        "| integrator, step, ms | time constant, ms | foot, mm | loop, mm | energy, % | s for 1 s |"
    )
    print("|---|---|---|---|---|---|")
    for integrator, step, steps, impedance in ROWS:
        constant = 0.02 if steps is None else steps * step
        one = re.sub(
            r'timestep="[^"]*" integrator="discrete"',
            f'timestep="{step}" integrator="{integrator}"',
            text,
        )
        loops = f'<equality solref="{constant} 1" solimp="{impedance}"'
        one = re.sub(r'<equality solref="[^"]*" solimp="[^"]*"', loops, one)
        foot, loop, energy, seconds = measured(one, model.motor, mechanism.assembly.exact)
        print(
            f"| {integrator} {1e3 * step:g} | {1e3 * constant:g} | {foot:.2g} | {loop:.2g} | {energy:.2g} | {seconds:.2g} |",
            flush=True,
        )


def phases() -> None:
    """Print how the walker of the gallery goes with its far side ahead by each of these angles, at a friction of 0.6.

    Its crank has two throws half a turn apart: from 180 deg on all comes again.
    """
    print("| far side ahead, deg | ends | way, mm a turn | slip, mm a turn | roll, deg |")
    print("|---|---|---|---|---|")
    for phase in range(0, 180, 30):
        mechanism = read_mechanism(WALKER, [f"parts.side_phase_deg={phase}"]).resolved()
        standing = standing_of(mechanism)
        assert standing is not None
        run = walking.walk(mechanism, smooth(mechanism, standing), 0.6, 3)
        end = "falls" if run.falls else "stalls" if run.stalls else "walks"
        end += "" if end == "walks" else f" after {run.turns:.2f} turns"
        roll = np.degrees(np.max(np.abs(run.roll)))
        row = f"{run.way_per_turn:.0f} | {run.slip_per_turn:.0f} | {roll:.0f}"
        print(f"| {phase} | {end} | {row} |", flush=True)


def apart(model: mjcf.Model, by: float) -> mjcf.Model:
    """The model with its far side further off, mm, its frame's mass in the middle."""

    def link(each: mjcf.Link, off: float) -> mjcf.Link:
        mass = replace(each.mass, centre=each.mass.centre + off * np.array([0.0, 0.0, 1.0]))
        feet = [replace(foot, low=foot.low + off, high=foot.high + off) for foot in each.feet]
        return replace(each, mass=mass, feet=feet)

    links = [link(each, by if each.name.startswith(PREFIX) else 0.0) for each in model.links]
    return replace(model, links=links, frame=link(model.frame, by / 2))


def widths() -> None:
    """Print how four of Jansen's legs a side go at 30 rpm, 80 g, friction 0.6, by phase and distance of the sides."""
    print(
        "| far side ahead, deg | sides apart, mm | ends | way, mm a turn | slip | tilt, deg | roll |"
    )
    print("|---|---|---|---|---|---|---|")
    spec = SPECS / "four-leg-walker.toml"
    two = [FEET, "walk.payload_g=80", "parts.sides=2", "parts.plates=2"]
    for phase, by in ((0, 0.0), (90, 0.0), (90, 35.0), (90, 60.0)):
        mechanism = read_mechanism(spec, [*two, f"parts.side_phase_deg={phase}"]).resolved()
        standing = standing_of(mechanism)
        assert standing is not None
        model = apart(smooth(mechanism, standing), by)
        run = walking.walk(mechanism, model, 0.6, 4)
        middles = [
            np.mean(
                [
                    foot.low
                    for each in model.links
                    if far is each.name.startswith(PREFIX)
                    for foot in each.feet
                ]
            )
            for far in (False, True)
        ]
        tilt = np.degrees([run.tilt.min(), run.tilt.max()])
        roll = np.degrees(np.max(np.abs(run.roll)))
        end = "falls" if run.falls else "walks"
        row = f"{run.way_per_turn:.0f} | {run.slip_per_turn:.0f} | {tilt[0]:.1f} to {tilt[1]:.1f} | {roll:.0f}"
        print(f"| {phase} | {np.ptp(middles):.0f} | {end} | {row} |", flush=True)


if __name__ == "__main__":
    {"phases": phases, "widths": widths}.get(sys.argv[-1], main)()
