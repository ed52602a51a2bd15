"""The judge of machines: closed on what was measured, moved, and compared with what is wanted, output by output."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from camgen.findings import Finding
from camgen.geometry.rings import Shape
from camgen.machine.features import Asked, Feature, Mount
from camgen.machine.model import Floats, Machine
from camgen.machine.study import Table

Sections = Sequence[Sequence[Shape]]


@dataclass(frozen=True)
class Verdict:
    """Findings, numbers and a table of the joints' shares from one kind of file."""

    findings: tuple[Finding, ...]
    numbers: Mapping[str, float]
    table: Table | None = None


def judge_machine(
    kind: str,
    where: str,
    files: Mapping[str, Sections],
    machine: Machine,
    features: Sequence[Feature],
    mounts: Sequence[Mount],
    theta: Floats,
    chord_tolerance: float,
    slack: float = 0.0,
    asked: Sequence[Asked] = (),
) -> Verdict:
    """Fits, and every output of the machine closed on the measured features, against the wanted ones.

    kind: "dxf", "stl" or "3mf"; where: said in findings; files: sections (shapes at each height) of each part's file of this
    kind, by part; theta: judged values of the machine's own variable, (n,) rad; chord_tolerance: mm, of outlines and facets;
    slack: mm, what the way back from a print compensation may cost a fit; asked: more than the motion, by output.
    """
    raise NotImplementedError
