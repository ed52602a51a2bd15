"""What parts are made of, as loads see it; every row with its source. Where none is published there is no number.

elastic    Young's modulus, MPa, of plastics of printed samples as they are built; Poisson's ratio
bears      alternating bending stress, MPa: half of the tensile strength, of prints of what they bear across the layers
density    g/cm^3
hertz      pressure of a contact that may come again and again, MPa, and where it was read; None where no one gives any
spread     usual tolerance of a printed size, +- mm; None of what is not printed
glued      alternating shear of two-part glue on it, MPa; None where none is known
"""

from __future__ import annotations

from dataclasses import dataclass

from camgen.machine.strength import YIELDS, Elastic


@dataclass(frozen=True)
class Material:
    """One row; source: where its figures were read."""

    name: str
    elastic: Elastic
    bears: float
    density: float
    source: str
    hertz: float | None = None
    hertz_source: str = ""
    spread: float | None = None
    glued: float | None = None
    metal: bool = False
    treatment: str = ""  # heat treatment, without which it does not bear that pressure
    hard: str = ""  # treatment of what runs on a part with the former and is to wear less
    # mm, depth of the skin that it hardens alone, of what a follower runs on, ground afterwards; 0: hardened through
    case: float = 0.0
    number: str = ""  # of the steel [EN 10027-2], in the sources of its row
    protection: str = ""  # of what rusts

    @property
    def printed(self) -> bool:
        """Whether a printer makes parts of it."""
        return self.spread is not None


_POISSON = (
    0.35  # of plastics, usually 0.33 to 0.40: its square is a few percent of a contact's stiffness
)
_GUIDE = "spread: FDM tolerance guide, toolsfast.app/3d-printing/fdm-tolerance-guide"
# Densities of plastics that are printed: the generic profiles of UltiMaker's fdm_materials, generic_pla.xml.fdm_material and
# its neighbours, element <density>.

# The strongest of these prints in their plane, MPa [additive.tools/materials/pc: 58-75].
_STRONGEST = 75.0
_KGF = 9.80665  # N

# Half of the least that laps of PMMA, PC, PVC and ABS bore, 865 to 2570 lb/in^2 with three two-part acrylic glues: mostly the
# plastic gave way [E. M. Petrie, Handbook of Adhesives and Sealants, table 10.17]. No table has PLA or PETG; of printed laps those of
# PLA bore most with epoxy, and those of PETG most of all with two-part acrylic glue [Oz, Ozturk, Welding in the World 69, 2025, abstract].
# ASA bore little with epoxy [Yap et al., 2020, abstract].
_GLUED = 2.9
_GLUES_WELL = ("PLA", "PETG", "PC", "ABS")

STEEL = Material(
    "steel",
    Elastic(207e3, 0.292),
    350.0,
    7.85,
    "207 GPa and 0.292 as handbooks have it; bears half of 700 MPa, the tensile strength of steel that can still be turned",
    metal=True,
)


def _print(
    name: str, modulus: float, bears: float, density: float, spread: float, source: str
) -> Material:
    """A row of a plastic that is printed."""
    return Material(
        name,
        Elastic(modulus, _POISSON),
        bears,
        density,
        f"{source}; {_GUIDE}",
        YIELDS * _STRONGEST,
        f"no limit is published for prints of {name}: at this limit the strongest printed plastic yields (PC, "
        f"{_STRONGEST:g} MPa in its plane, {YIELDS:g} times that in a line contact)",
        spread,
        _GLUED if name in _GLUES_WELL else None,
    )


def _flows(strength: float) -> str:
    """Where a limit comes from that is no fatigue limit."""
    return f"it yields there: {YIELDS:g} times its yield stress of {strength:g} MPa; no fatigue limit was found"


_PRINTS = (
    _print(
        "PLA", 3500.0, 20.0, 1.24, 0.2, "additive.tools/materials/pla: 3-4 GPa, 35-45 MPa upright"
    ),
    _print(
        "PETG", 2500.0, 16.0, 1.27, 0.3, "additive.tools/materials/petg: 2-3 GPa, 25-38 MPa upright"
    ),
    _print(
        "PC",
        2500.0,
        22.0,
        1.19,
        0.5,
        "additive.tools/materials/pc: 2-3 GPa, 35-52 MPa upright; spread not listed: as ABS",
    ),
    _print(
        "ABS",
        1443.0,
        9.0,
        1.10,
        0.5,
        "maker's values in PMC10406103, table 2: 1443 MPa, 35.3 MPa, half of that upright",
    ),
    _print("ASA", 1443.0, 9.0, 1.06, 0.45, "as ABS, no source of its own"),
    _print(
        "nylon",
        1387.0,
        11.0,
        1.14,
        0.5,
        "PA12, maker's values in PMC10406103, table 2: 1387 MPa, 43 MPa, half of that upright",
    ),
)

_OILED = "oiled against rust"
# S45C reaches 52 to 58 HRC, SCM440 55 to 60 [vsheattreatment.com/en/knowledge/hardening-by-steel-grade]; a thin ring is hardened through.
_HARD = "hardened and tempered, 50+5 HRC, sizes hold after it"
_CUT = (
    Material(
        "C45",
        Elastic(210e3, 0.269),
        325.0,
        7.85,
        "szrtjs.com/en_product_detail.asp?id=930: 210 GPa, 0.269, 7.85; appluslaboratories.com, C45 1.0503, quenched and "
        "tempered, 16 to 40 mm: 650 to 800 MPa",
        57 * _KGF,
        "limit for gears of S45C, quenched and tempered to 200 HB (SDP/SI, table 17-12)",
        metal=True,
        treatment="quenched and tempered, at least 200 HB",
        hard=_HARD,
        number="1.0503",
        protection=_OILED,
    ),
    Material(
        "42CrMo4",
        Elastic(200e3, 0.292),
        500.0,
        7.84,
        "kooz.si, 1.7225: 190 to 210 GPa, 7.84, quenched and tempered, 17 to 40 mm, 1000 to 1200 MPa; Poisson's ratio as steel",
        84 * _KGF,
        "limit for gears of SCM440, quenched and tempered to 310 HB (SDP/SI, table 17-12)",
        metal=True,
        treatment="quenched and tempered, at least 310 HB",
        hard=_HARD,
        number="1.7225",
        protection=_OILED,
    ),
    Material(
        "16MnCr5",
        Elastic(210e3, 0.3),
        410.0,
        7.85,
        "case hardened, HRC 60 and more: akrostal.pl, 1.7131: 7.85, core 820 MPa at 16 to 40 mm; 210 GPa, 0.3 as with the pressure",
        1460.0,
        "limit for gears, case hardened (DIN 3990:1987, as a public gear program has it)",
        metal=True,
        # the depth is camgen's own rule: under a roller of 40 mm at that pressure the shear is greatest at 0.4
        treatment="case hardened and tempered, 60+4 HRC, CHD 0.8+0.4",
        case=0.8,
        number="1.7131",
        protection=_OILED,
    ),
    Material(
        "stainless",
        Elastic(193e3, 0.29),
        215.0,
        8.0,
        "1.4301: alloysintl.com, stainless steel 304: 193 GPa, 0.29, 505 MPa, yields at 215, less than half of which it bears; "
        "apacinfrastructure.com.au: 8.0",
        YIELDS * 215,
        _flows(215),
        metal=True,
        number="1.4301",
    ),
    Material(
        "aluminium",
        Elastic(68.9e3, 0.33),
        96.5,
        2.70,
        "6061-T6: glemco.com/capabilities/material-expertise/aluminum-6061-t6: 68.9 GPa, 0.33, yields at 276 MPa, 96.5 MPa for "
        "5e8 turns, 2.7",
        YIELDS * 276,
        _flows(276),
        metal=True,
    ),
    Material(
        "brass",
        Elastic(97e3, 0.31),
        138.0,
        8.49,
        "C36000, half hard: ezlok.com/technical-info/mechanical-properties/brass: 97 GPa, 0.31, 8.49; "
        "azom.com/article.aspx?ArticleID=7266: yields at 170 MPa, fatigue 138",
        YIELDS * 170,
        _flows(170),
        metal=True,
    ),
    Material(
        "POM",
        Elastic(2855.0, 0.37),
        33.0,
        1.39,
        "scribd.com/document/479235228, POM-C: 2855 MPa, 65 MPa, 1.39; 0.37 as with the pressure",
        48.0,
        "limit for worm wheels on steel, 23 deg C, 1e7 turns (Hostaform and ISO 14521, by a public library of plastic worm wheels)",
    ),
    Material(
        "plywood",
        Elastic(8200.0, _POISSON),
        14.0,
        0.6,
        "of sheathing, along the face's grain: matweb.com, plywood: 8.2 to 10.3 GPa, 27.6 to 34.5 MPa, 0.4 to 0.6; birch is "
        "stronger and heavier",
    ),
    Material(
        "acrylic",
        Elastic(2800.0, _POISSON),
        33.0,
        1.19,
        "cast: stainlessandaluminium.co.uk/engineering-plastics/acrylic-ppma: 2800 to 3200 MPa, 67 to 75 MPa; "
        "designerdata.nl, PMMA: 1.19. It breaks before it flows, and no one gives a pressure",
    ),
)

MATERIALS = {row.name: row for row in (*_PRINTS, *_CUT)}

# Product of pressure and sliding speed that a plain bearing of plastic bears dry, MPa m/s. Of PLA, PETG, ABS, ASA and PC no limit
# is published: this is that of a plastic made for bearings, dry on steel, which no plastic that is printed reaches
# [igus.co.uk/info/plain-bearings-p210-material-data: iglidur P210 0.4; igus.eu: J260 0.35; igus.com: J 9,700 psi ft/min, 0.34].
# Grease that stays doubles it, oil makes it five times as much [igus.com, p x v value and lubrication, table 1.4].
PV_MOST = 0.4

# Coefficient of dry friction of two printed faces [doi 10.2478/msp-2025-0039: printed PLA 0.62-0.76, PA6 0.66-1.10], and of a
# bearing's plastic on steel [iglidur P210: 0.07-0.19].
FRICTION_PRINTED = 0.7
FRICTION_STEEL = 0.2

# Of two faces of metal, dry, sliding [www-eng.lbl.gov/~ajdemell/coefficients_of_friction.html: steel on steel 0.42; clean of
# oxide and oil far more, oiled a quarter].
FRICTION_METAL = 0.42

# Of a deep groove ball bearing, by its load at half its bore, without the drag of seals [SKF, Rolling bearings, catalogue,
# "Estimating the frictional moment": M = 0.5 mu P d, mu = 0.0015].
FRICTION_BALL = 0.0015


def of(name: str) -> Material:
    """The row of a material by its name in [material], or "steel"."""
    return STEEL if name == STEEL.name else MATERIALS[name]


def friction_of(*names: str) -> float:
    """Coefficient of dry friction of two faces by the names of their materials."""
    metals = sum(of(name).metal for name in names)
    return (FRICTION_PRINTED, FRICTION_STEEL, FRICTION_METAL)[metals]
