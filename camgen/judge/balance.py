"""BALANCE: the first moment of a crank and all that turns with it, weighed from the solids of the assembly as written."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from camgen.files.threemf import read_3mf
from camgen.findings import Finding, at_most, in_file
from camgen.geometry.mesh import Mesh
from camgen.geometry.rings import Floats
from camgen.judge.assembly import standing
from camgen.machine.features import Balance, SweptMachine


def first_moment(mesh: Mesh) -> tuple[float, Floats]:
    """Volume of a closed mesh, mm^3, and its first moment, (3,) mm^4: of the tetrahedra on its faces."""
    corners = mesh.vertices[mesh.faces]
    volumes = np.einsum("ij,ij->i", corners[:, 0], mesh.across) / 6
    return float(volumes.sum()), np.asarray(volumes @ corners.sum(axis=1) / 4)


def judge_balance(path: Path, machine: SweptMachine, balance: Balance) -> Finding:
    """The assembly's file against what is asked; it shows theta = 0."""
    pose = machine.courses(np.zeros(1))[balance.body]
    turn = cmath.exp(1j * float(pose.angle[0]))
    pivot = complex(pose.place[0]) + turn * balance.about
    moment_of_crank = 0j
    for _, item, body in standing(read_3mf(path), machine):
        if body == balance.body:
            volume, (x, y, _) = first_moment(item.placed)
            moment = complex(x, y)
            moment_of_crank += balance.density[item.name] * (moment - volume * pivot) / turn
    remark = (
        f"{abs(moment_of_crank):.5g} g mm at {math.degrees(cmath.phase(moment_of_crank)):z.2f} deg in the crank's axes, {abs(balance.moment):.5g} at "
        f"{math.degrees(cmath.phase(balance.moment)):z.2f} wanted; build again, or make what turns with the crank as drawn"
    )
    off = abs(moment_of_crank - balance.moment)
    where = replace(
        in_file(path), thing=f"{balance.body} about {balance.joint}", joint=balance.joint
    )
    return at_most("BALANCE", off, balance.tolerance, "g mm", where, remark)
