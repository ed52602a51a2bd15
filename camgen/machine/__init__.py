"""The model of any planar machine and what follows from it: positions, derivatives, forces, freedoms, play."""

from __future__ import annotations

from camgen.machine.forces import Forces
from camgen.machine.jets import thread_length
from camgen.machine.model import (
    GROUND,
    Along,
    Angle,
    Body,
    Cam,
    Drive,
    Force,
    Function,
    Gear,
    Gravity,
    Joint,
    Law,
    Load,
    Machine,
    Output,
    Path,
    Pin,
    Place,
    Pose,
    Resistance,
    Slide,
    Slot,
    Spring,
    Torque,
    TorsionSpring,
    Turning,
)
from camgen.machine.run import Play, Run, solve

__all__ = [
    "GROUND", "Along", "Angle", "Body", "Cam", "Drive", "Force", "Forces", "Function", "Gear", "Gravity", "Joint", "Law",
    "Load", "Machine", "Output", "Path", "Pin", "Place", "Play", "Pose", "Resistance", "Run", "Slide", "Slot", "Spring", "Torque",
    "TorsionSpring", "Turning", "solve", "thread_length",
]  # fmt: skip
