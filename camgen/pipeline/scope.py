"""What is judged, and what is not: each step says which codes it gives and which kinds of files it takes."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from camgen.files.formats import DRAWN, EXACT, SOLID
from camgen.findings import Finding, NotJudged
from camgen.geometry.outlines import Floats
from camgen.machine.features import CamOutline, EdgePair, EngagedPair, Flat, GearTeeth, PawlPair
from camgen.machines.mechanism import Mechanism
from camgen.parts.sheets import why_not
from camgen.study import Figures, Plot, Table

if TYPE_CHECKING:
    from camgen.pipeline.case import Case

ANY = (*DRAWN, *SOLID)
READ = (*ANY, *EXACT)  # part by part

# Keys of [print] that change what is sent to a printer.
_FITS = ("hole_compensation", "profile_compensation", "shrinkage", "elephant_foot")


@dataclass(frozen=True)
class Outcome:
    """What one stage found, for the report."""

    findings: Sequence[Finding] = ()
    numbers: Figures = field(default_factory=Figures)
    plots: Sequence[Plot] = ()
    tables: Sequence[Table] = ()
    columns: Mapping[str, Floats] = field(default_factory=dict)
    not_judged: Sequence[NotJudged] = ()
    warnings: Sequence[str] = ()
    notes: Sequence[str] = ()


@dataclass(frozen=True)
class Stage:
    """A step of judging.

    codes: that it gives; what: it looks at, for people; takes: kinds of files, of which one is enough, none: it needs no
    file; work: (case, kinds that are there) -> its outcome, None where it is done as parts are read.
    """

    codes: tuple[str, ...]
    what: str = ""
    takes: tuple[str, ...] = ()
    work: Callable[[Case, Sequence[str]], Any] | None = field(default=None, compare=False)

    def runs(self, kinds: Collection[str]) -> bool:
        """Whether files of these kinds are enough."""
        return not self.takes or any(kind in kinds for kind in self.takes)


def of_parts(mechanism: Mechanism) -> list[Stage]:
    """The steps that are done as parts are read: each file by itself, and the motion that the files give."""
    holes = any(layer.region.holes for part in mechanism.assembly.parts for layer in part.layers)
    drawings = Stage(("DXF_CLOSED", "DXF_UNITS"), "drawings", DRAWN)
    stages = [
        *([drawings] if any(part.outlined for part in mechanism.assembly.parts) else []),
        Stage(("WATERTIGHT", "VOLUME"), "solids", (*SOLID, *EXACT)),
        Stage(
            ("ROUND_TRIP", *(("MIN_WALL",) if holes else ())),
            "contours as they are in the files",
            READ,
        ),
    ]
    features = mechanism.assembly.features
    cams = [feature for feature in features if isinstance(feature, CamOutline)]
    if cams:
        ripple = ("SPEED_RIPPLE",) if any(math.isfinite(cam.nominal.ripple) for cam in cams) else ()
        stages.append(Stage(("MOTION_ERROR", *ripple), "the follower, rolled on the outline", READ))
    if mechanism.assembly.rows:
        pins = Stage(("RELEASE_ANGLE", "PIN_SPACING"), "the pins of each row", (*SOLID, *EXACT))
        stages.append(pins)
    if len(cams) > len({cam.joint for cam in cams}):
        stages.append(
            Stage(("LASH", "INTERFERENCE"), "the follower between both its contacts", READ)
        )
    if any(cam.own is not None for cam in cams):
        stages.append(Stage(("TIP_MOTION",), "the frame's own tip on the cam", READ))
    if any(isinstance(cam.tip, Flat) and math.isfinite(cam.tip.width) for cam in cams):
        stages.append(Stage(("FACE_WIDTH",), "where the face is touched", READ))
    if any(isinstance(feature, GearTeeth) for feature in features):
        stages.append(Stage(("GEAR_MESH",), "the outlines of gears, one driving the other", READ))
    pairs = [feature for feature in features if isinstance(feature, EdgePair)]
    if pairs:
        stages.append(Stage(("CONTACT",), "outlines of any shape, one driving the other", READ))
    if any(isinstance(pair, EngagedPair) and pair.tracks for pair in pairs):
        stages.append(Stage(("PIN_TRACK",), "each pin along lobes or in its hole", READ))
    if any(isinstance(pair, PawlPair) for pair in pairs):
        stages.append(Stage(("PAWL_HOLDS",), "the ratchet, turned back behind each drop", READ))
    if len(cams) < len(features):
        wishes = mechanism.assembly.demands
        codes = dict.fromkeys(target.code for each in wishes for target in each.targets)
        codes |= {"STROKE_ERROR": None} if any(each.stroke for each in wishes) else {}
        stages.append(
            Stage(
                ("MOTION_ERROR", "PIN_GAP", "LASH", *codes),
                "the linkage, closed on the holes of its parts",
                READ,
            )
        )
    return stages


def machined(mechanism: Mechanism) -> bool:
    """Whether there are files for machine tools: tables and paths that are asked for, developments of drums."""
    return mechanism.files.machining or bool(mechanism.assembly.whole_drums)


def not_judged(
    stages: Sequence[Stage], kinds: Collection[str], findings: Sequence[Finding]
) -> tuple[NotJudged, ...]:
    """Codes that no stage could give: no file of its kinds is there, or none that could be judged."""
    codes = {finding.code for finding in findings}
    failing = any(not finding.ok for finding in findings)
    bare = not any(kind in kinds for kind in READ)
    reasons: dict[str, NotJudged] = {}
    for stage in stages:
        needs = " or ".join(kind.upper() for kind in stage.takes)
        absent = f"the folder has no {needs}, from which camgen judges {stage.what}"
        if bare:
            absent = "the folder has no drawing or solid of a part"
        for code in stage.codes:
            if not stage.runs(kinds):
                reasons.setdefault(code, NotJudged(code, absent, needs, absent=True))
            elif failing and code not in codes:
                why = f"the failures above leave no sound {needs}, from which camgen judges {stage.what}"
                reasons.setdefault(code, NotJudged(code, why, "a file without the faults above"))
    return tuple(reasons.values())


def unheard(mechanism: Mechanism, kinds: Collection[str]) -> tuple[str, ...]:
    """Sentences on keys that were set and cannot act on a kind of file that is there."""
    sentences = []
    drawn, solid = (" and ".join(map(str.upper, each)) for each in (DRAWN, SOLID))
    as_drawn = [kind.upper() for kind in (*DRAWN, *EXACT) if kind in kinds]
    told = f"{' and '.join(as_drawn)} {'is' if len(as_drawn) == 1 else 'are'} as drawn"
    for key in _FITS if as_drawn else ():
        value = getattr(mechanism.print, key)
        if value:
            sentences.append(f"print.{key} = {value:g} changes only {solid}: the {told}")
    if mechanism.laser is not None and "dxf" in kinds:
        kerf = mechanism.laser.kerf
        sentences.append(
            f"laser.kerf = {kerf:g} changes only the sheets: the DXF of each part is as drawn"
        )
        if all(why_not(part, mechanism.laser.thickness) for part in mechanism.assembly.parts):
            flat = {
                part.thickness: part.name
                for part in mechanism.assembly.parts
                if not why_not(part, part.thickness)
            }
            said = ", ".join(f"{name} is {thick:g}" for thick, name in sorted(flat.items()))
            told = f"no part is flat and as thick ({said} mm)" if flat else "no part is flat"
            sentences.append(
                f"laser.thickness = {mechanism.laser.thickness:g}: {told}, so camgen makes no sheet"
            )
    elif mechanism.laser is not None:
        sentences.append("[laser] has no effect without DXF: the sheets are made with it")
    plain = not any(part.engraved for part in mechanism.assembly.parts)
    asked = {"engrave": mechanism.files.engrave, "hole_letters": mechanism.files.hole_letters}
    none = [key for key, wanted in asked.items() if wanted and plain]
    sentences += [
        f"files.{key} = true has no effect: no part has anything engraved" for key in none
    ]
    if mechanism.files.engrave and not plain and not any(kind in kinds for kind in DRAWN):
        sentences.append(f"files.engrave = true has no effect without {drawn}")
    idle = mechanism.remarks().unused
    if idle:
        sentences.append(
            f'{", ".join(idle)} {"acts" if len(idle) == 1 else "act"} on cams alone (parts.make = "cams")'
        )
    curves = mechanism.files.curves
    if (
        curves != "bulge"
        and any(kind in kinds for kind in SOLID)
        and not any(kind in kinds for kind in DRAWN)
    ):
        sentences.append(f'files.curves = "{curves}" has no effect without {drawn}')
    return tuple(sentences)
