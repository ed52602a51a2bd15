"""The model of any planar machine and what follows from it: positions, derivatives, forces, freedoms, play.

A machine is closed by two routes that share the model and nothing else. The maker's: vector loops, block by block, dyads in
closed form. The judge's: Newton's method on the poses of all bodies at once, with the joints where the files have them.
Positions, speeds and accelerations thus have two implementations that are held against each other; forces, play and freedoms
have one, on the Jacobian of the judge's.

    the model           model: bodies, joints, drives, loads, outputs; features: what of the parts' files makes the joints;
                        targets: what is wanted by value; joining: several machines as one
    the maker's route   loops: a machine in steps; order: which equations go together; dyads: two unknowns in closed form;
                        newton: larger blocks; jets: quantities with their derivatives; reach: how far the drive can turn
    the judge's route   constraints: the conditions of all joints, their Jacobian; closing: a machine closed on them
    on either           run: a machine over angles; forces; freedom: counts and rank, drawings closed
                        centrodes: where instant centres run
    known beforehand    closed_form: four-bars and slider-cranks; landmarks: what stands out on a curve
    cams/               followers, the profile of a disc cam and its limits, cam and follower as a machine
"""

from __future__ import annotations

from camgen.machine.forces import Forces
from camgen.machine.jets import thread_length
from camgen.machine.model import (
    GROUND,
    Along,
    Angle,
    Body,
    Cam,
    Clutch,
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
    "GROUND",
    "Along",
    "Angle",
    "Body",
    "Cam",
    "Clutch",
    "Drive",
    "Force",
    "Forces",
    "Function",
    "Gear",
    "Gravity",
    "Joint",
    "Law",
    "Load",
    "Machine",
    "Output",
    "Path",
    "Pin",
    "Place",
    "Play",
    "Pose",
    "Resistance",
    "Run",
    "Slide",
    "Slot",
    "Spring",
    "Torque",
    "TorsionSpring",
    "Turning",
    "solve",
    "thread_length",
]
