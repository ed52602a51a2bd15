"""What parts are made of, as loads see it; every row with its source. Where none is published there is no number.

modulus    Young's modulus of printed samples as they are built, MPa; Poisson's ratio
bears      alternating bending stress across the layers, MPa: half of what they bear in tension when stood upright
strength   greatest tensile strength that is told of such prints, in the plane, MPa
spread     usual tolerance of a printed size, +- mm
"""

from __future__ import annotations

from dataclasses import dataclass

from camgen.machine.strength import Elastic


@dataclass(frozen=True)
class Material:
    """One row; source: where its figures were read."""

    name: str
    elastic: Elastic
    bears: float
    spread: float
    source: str


_POISSON = (
    0.35  # of plastics, usually 0.33 to 0.40: its square is a few percent of a contact's stiffness
)
_GUIDE = "spread: FDM tolerance guide, toolsfast.app/3d-printing/fdm-tolerance-guide"

STEEL = Material(
    "steel",
    Elastic(207e3, 0.292),
    350.0,
    0.0,
    "207 GPa and 0.292 as handbooks have it; bears half of 700 MPa, the tensile strength of steel that can still be turned",
)

MATERIALS = {
    row.name: row
    for row in (
        Material(
            "PLA",
            Elastic(3500.0, _POISSON),
            20.0,
            0.2,
            f"additive.tools/materials/pla: 3-4 GPa, 35-45 MPa upright; {_GUIDE}",
        ),
        Material(
            "PETG",
            Elastic(2500.0, _POISSON),
            16.0,
            0.3,
            f"additive.tools/materials/petg: 2-3 GPa, 25-38 MPa upright; {_GUIDE}",
        ),
        Material(
            "PC",
            Elastic(2500.0, _POISSON),
            22.0,
            0.5,
            f"additive.tools/materials/pc: 2-3 GPa, 35-52 MPa upright; {_GUIDE} (not listed there: as ABS)",
        ),
        Material(
            "ABS",
            Elastic(1443.0, _POISSON),
            9.0,
            0.5,
            f"maker's values in PMC10406103, table 2: 1443 MPa, 35.3 MPa, half of that upright; {_GUIDE}",
        ),
        Material(
            "ASA", Elastic(1443.0, _POISSON), 9.0, 0.45, f"as ABS, no source of its own; {_GUIDE}"
        ),
        Material(
            "nylon",
            Elastic(1387.0, _POISSON),
            11.0,
            0.5,
            f"PA12, maker's values in PMC10406103, table 2: 1387 MPa, 43 MPa, half of that upright; {_GUIDE}",
        ),
    )
}

# The strongest of these prints in their plane, MPa [additive.tools/materials/pc: 58-75].
STRONGEST = 75.0

# Product of pressure and sliding speed that a plain bearing of plastic bears dry, MPa m/s. Of PLA, PETG, ABS, ASA and PC no limit
# is published: this is that of a plastic made for bearings, dry on steel, which no plastic that is printed reaches
# [igus.co.uk/info/plain-bearings-p210-material-data: iglidur P210 0.4; igus.eu: J260 0.35; igus.com: J 9,700 psi ft/min, 0.34].
# Grease that stays doubles it, oil makes it five times as much [igus.com, p x v value and lubrication, table 1.4].
PV_MOST = 0.4

# Coefficient of dry friction of two printed faces [doi 10.2478/msp-2025-0039: printed PLA 0.62-0.76, PA6 0.66-1.10], and of a
# bearing's plastic on steel [iglidur P210: 0.07-0.19].
FRICTION_PRINTED = 0.7
FRICTION_STEEL = 0.2

# Of a deep groove ball bearing, by its load at half its bore, without the drag of seals [SKF, Rolling bearings, catalogue,
# "Estimating the frictional moment": M = 0.5 mu P d, mu = 0.0015].
FRICTION_BALL = 0.0015


def of(name: str) -> Material:
    """The row of a material by its name in [material], or "steel"."""
    return STEEL if name == STEEL.name else MATERIALS[name]
