"""What the drawings of a machine's parts say beside their shapes: material, mass, number, fits of holes.

Two parts fit where, in the assembly, a round hole of one and the round outline of the other have one axis and heights in
common, and their diameters differ by the clearance of what slides or is pressed; or where a joint says what goes through.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from camgen.files.dimensions import flat_of, free, headed, number, rod_of, round_of
from camgen.files.limits import deviations, general, in_limits
from camgen.files.timing import Motion
from camgen.files.title_block import CORE, Facts, Fit, Groove, Rider
from camgen.files.tracks import looser
from camgen.geometry.arcs import as_circle
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Floats, Points
from camgen.machine.cams.machine import CamTouch
from camgen.machine.features import CamOutline, EdgePair, Mark, PartPose, PinEyes, parts_of
from camgen.machine.model import GROUND, Cam
from camgen.machines.follower_motions import follower_motions
from camgen.machines.mechanism import Mechanism
from camgen.motion.program import Program
from camgen.parts import materials
from camgen.parts.assembly import Assembly, cut_of_sheet
from camgen.parts.catalogue import BUSH, CORE_HOLES, CUT, TURNED
from camgen.parts.fixing import IN_BUSH, JOURNAL, PIN, is_rod, joint_of, rod_fit
from camgen.parts.keyways import key_length, keyed
from camgen.parts.materials import STEEL
from camgen.parts.part import ROD, Layer, Part
from camgen.parts.shafts import rod_with_keyways
from camgen.parts.standing import Round, standing
from camgen.parts.turned_shafts import TurnedShaft
from camgen.pipeline.lengths import stack_allowance
from camgen.pipeline.lock_limits import lock_limits
from camgen.pipeline.thicknesses import thickness_allowances
from camgen.tolerances import SAME_POINT

_SAMPLES = 1441  # of a turn
# What a part of metal has unless its spec says other: camgen's own rules, for a milled cam and a reamed bore.
_IN_METAL = Facts(
    tolerance="ISO 2768-mK",
    position=0.05,
    profile=0.05,
    roughness=0.8,
    bore_roughness=1.6,
    symmetry=0.04,
    run_out=0.03,
    roughness_elsewhere=3.2,
    edges="broken 0.2 to 0.4, ISO 13715",
    corner=1.0,
)
_IN_PLASTIC = Facts(position=0.2)
_OF_ROD = replace(_IN_METAL, profile=0.0, roughness=0.0, symmetry=0.0, run_out=0.0)  # in metal
# Of what bears on an inner ring, on a face a few tenths wide: camgen's own rule.
_OF_SLEEVE = "free of burrs"
_OF_JOURNAL = "free of burrs, corner under the head at most R0.1, free end chamfered 0.3 × 45°"
# Ra of slots, hollows and their lock, micrometres: a roller comes and goes there, slowly; camgen's own choice, as milled.
_MILLED = 1.6
_RING = "h11"  # of what bears on an inner ring: no wider than that, and easily turned
_ROD_STEEL = "C45+C"  # bright drawn: camgen's own choice
SHAFT_STEEL = "C45"  # of shafts that are no parts
_SEAT_ROUGHNESS = 0.8  # Ra of what is h6 under bearings, micrometres: camgen's own choice
_ROD_STRENGTH = f"tensile strength at least {2 * STEEL.bears:g} MPa"  # on which loads count
_UNTREATED = "no heat treatment"
_MEDIUM = "ISO 2768-m"  # general tolerance of what is printed or cut of a sheet, unless its spec says other
# The housing of a ball bearing is J7 under light load [auto-agro.sk/katalog/klietky, NTN, 6.4]; JS is within a few thousandths of J.
_SEAT = "JS7"
# Of holes that turn on pins and shafts, from close to loose: preferred classes of ISO 286, but C11, and E9 for a pin m6.
_RUNNING = ("F8", "E9", "D10", "C11")
_CAP = "E8"  # never tighter than m6: of a cap that goes on a pin m6 by hand and is glued there
# Fits of keyways for keys h9 by their width: of DIN 6885 the light and the tight one [berger-tools.co.uk, page 2078].
_KEY = "JS9"
_TIGHT_KEY = "P9"
# By how much the crowned ring of a cam follower may be thinner, mm [nodeshk.com/ina/art/track-roller-clearance].
_CROWNED = 0.05
# By how much a ball bearing with a bore of 2.5 to 50 may be narrower, mm [ISO 492; of a 688 fryer-to-fuel.com/ball-bearing-deflection].
_NARROWER = 0.12
_BETWEEN_RINGS = "h11"  # length of a drum: shims fill what is free, as far as it may slide
# Chamfer of a bore by the diameter up to which it is usual, mm: camgen's own rule.
_CHAMFERS = ((10.0, 0.5), (40.0, 1.0), (math.inf, 1.5))
_STEPS = (
    1.0,
    2.0,
    5.0,
    10.0,
    20.0,
    50.0,
    100.0,
    200.0,
    500.0,
)  # mm, from one row to the next of a plate's table
_FINER = 5  # of steps of the table of a track on a sheet of its own in one of that on the part's
_LEVELS = 60  # rows of it, at most
_FINE = 1e-3  # mm, chord tolerance of an outline on which a track has to lie


def facts_of(mechanism: Mechanism, part: Part) -> Facts:
    """What the drawing of one of its parts says."""
    sheet = mechanism.drawing
    of_sheet = cut_of_sheet(mechanism.assembly, part)
    printed = part.process == "printed" and not of_sheet
    steel = part.process in (TURNED, CUT)
    material = materials.of(mechanism.material.name)
    cut = printed and material.metal
    metal = steel or cut
    rod = round_of(part.region.outer) if steel and material.metal and is_rod(part) else None
    of_metal = metal or is_rod(part) or (material.metal and part.process == "bought")
    usual = _IN_METAL if cut else _OF_ROD if rod else _IN_PLASTIC
    bore_fit = sheet.bore_fit or ("H7" if metal else "")
    own = metal and _has_keyed_shaft(mechanism.assembly)
    profile = sheet.profile or usual.profile
    dowelled = cut and mechanism.assembly.dowel and profile
    place = _asked(sheet.position, usual.position)
    case = cut and material.case > 0
    runs = part.name in _cams(mechanism) | _slotted(mechanism)
    runs |= part.name in {each.part for each in mechanism.assembly.tracks}
    key_fit = sheet.key_fit or (_TIGHT_KEY if own else _KEY if metal else "")
    outer_fit = _outer_fit(mechanism, part) if of_metal else ""
    stride = _FINER if profile else 1
    step = sheet.profile_step_deg / stride
    tracks = list(_tracks(mechanism, part, step))
    return Facts(
        machine=_machine(mechanism),
        material=_numbered(*material_of(mechanism, part)),
        mass_g=part.volume
        * (mechanism.assembly.process.density if printed else 1e3 * STEEL.density)
        * 1e-6
        if printed or steel
        else None,
        tolerance=_tolerance(sheet.tolerance, metal, part),
        number=drawing_number(mechanism, part.name),
        date=sheet.date or "",
        fits=()
        if part.process == "bought"
        else tuple(_fits(mechanism, part, sheet.seat_fit or bore_fit, looser(usual.profile))),
        points=frozenset(name[0] for each in mechanism.assembly.parts for name, _ in each.points),
        outer_fit=outer_fit,
        ring_fit=_RING if cut and _ring_edges(mechanism, part) else "",
        shank=_pins(mechanism).get(part.name, (0.0, "")) if of_metal else (0.0, ""),
        profile_step_deg=sheet.profile_step_deg if part.name in _cams(mechanism) else None,
        # dowels carry a track: they lie no farther off than the track may
        position=min(place, profile) if dowelled else place,
        dowel=mechanism.assembly.dowel,
        thread=mechanism.assembly.thread,
        bore_fit=bore_fit,
        lip=_lip(mechanism) if cut else 0.0,
        thinner=_thinner(mechanism, part, sheet.tolerance or _IN_METAL.tolerance) if cut else 0.0,
        thicker=_thicker(mechanism, part, sheet.tolerance or _IN_METAL.tolerance) if cut else 0.0,
        shorter=_shorter(mechanism, part, sheet.tolerance or _IN_METAL.tolerance)
        if cut or rod
        else (0.0, 0.0),
        key_fit=key_fit,
        shaft=rod_with_keyways(part, outer_fit, key_fit, list(_keys(mechanism.assembly, part)))
        if steel
        else None,
        own_key=_asked(sheet.symmetry, _IN_METAL.symmetry) if own else 0.0,
        tracks=tuple(
            (each.name, tuple(zip(each.turned.tolist(), each.places.tolist(), strict=True)))
            for each in tracks
        ),
        riders=tuple(each.rider for each in tracks),
        centres=tuple(tuple(each.centres.tolist()) for each in tracks),
        heights=tuple(_heights(mechanism, part, step)),
        stride=stride,
        segments=tuple(_segments(mechanism, part)),
        sense=mechanism.assembly.cycle.sense,
        roller=_roller(mechanism, part),
        crowned=_CROWNED if mechanism.load and mechanism.load.cam_follower else 0.0,
        levels=tuple(_levels(mechanism, part)),
        groove=_groove(mechanism.assembly, part),
        lock=lock_limits(mechanism.assembly, part, (profile, place), (bore_fit, IN_BUSH))
        if cut
        else None,
        cutter=part.name in mechanism.assembly.whole_drums
        and mechanism.files.cutter_radius is not None,
        profile=profile,
        roughness=sheet.roughness
        or (_MILLED if usual.roughness and part.name in _slotted(mechanism) else usual.roughness),
        bore_roughness=sheet.bore_roughness or usual.bore_roughness,
        roughness_elsewhere=sheet.roughness_elsewhere or usual.roughness_elsewhere,
        symmetry=_asked(sheet.symmetry, usual.symmetry),
        run_out=_asked(sheet.run_out, usual.run_out),
        bore_chamfer=_asked(sheet.bore_chamfer, _chamfer(part.bore) if cut else 0.0),
        rod_chamfer=_chamfer(2 * rod[1]) if rod else 0.0,
        edges=sheet.edges or (cut and _ring_edges(mechanism, part)) or usual.edges,
        heat_treatment=sheet.heat_treatment
        or (_treatment(mechanism, part, runs) if cut else _ROD_STRENGTH if rod else ""),
        protection=sheet.protection or (materials.of("C45") if rod else material).protection
        if cut or rod
        else "",
        turned_deg=_turned(mechanism.assembly, part),
        case_only=case and runs and not sheet.heat_treatment,
        corner=usual.corner,
        ground=case and runs,
        revision=sheet.revision or "",
        drawn_by=sheet.drawn_by or "",
        checked_by=sheet.checked_by or "",
    )


def _tolerance(given: str | None, metal: bool, part: Part) -> str:
    """General tolerance of a part; "" of one that is bought, whose sizes are those of its maker."""
    if part.process == "bought" and not is_rod(part):
        return ""
    return given or (_IN_METAL.tolerance if metal else _MEDIUM)


def _treatment(mechanism: Mechanism, part: Part, runs: bool) -> str:
    """Heat treatment of a part of metal, as its loads count on it; runs: whether a follower, a roller or another part runs on it.

    Links that turn on bearings alone bear no contact, nor do those that carry the pin of a roller, and what is in no joint, such as a knob or
    a collar, no load. A roller is harder than what it rolls in: each place of that meets it once a turn, its own rim far more often.
    """
    material = materials.of(mechanism.material.name)
    assembly = mechanism.assembly
    if material.case:
        return material.treatment if runs else ""
    joints = [
        each
        for each in assembly.features
        if not (isinstance(each, Mark | EdgePair) or (isinstance(each, PinEyes) and each.rings))
    ]
    if material.hard and part.name in _edge_rollers(mechanism):
        return material.hard
    pins = {name for name in _pins(mechanism) if assembly.by_name[name].role}
    loaded = runs or part.name in {*parts_of(joints), *pins, *_rollers(mechanism)}
    pressed = any(map(flat_of, part.region.holes))  # by the flat of a shaft
    if loaded or pressed or assembly.dowel:
        return material.treatment
    return _UNTREATED if material.treatment else ""


def _turned(assembly: Assembly, part: Part) -> float:
    """By which angle the arrangement shows a part turned from its sheet, deg, 0 to 360; 0 of what is round, or of several copies."""
    poses = _standing_still(assembly)[0][part.name]
    if len(poses) != 1 or poses[0].flipped or poses[0].upright or rod_of(part.region.outer):
        return 0.0
    return math.degrees(float(poses[0].angle[0])) % 360


def _keys(assembly: Assembly, shaft: Part) -> Iterator[tuple[float, float]]:
    """Where keys lie on a shaft, mm from its lower end: half way along each keyed bore that it goes through."""
    poses, outlines = _standing_still(assembly)
    low = min((each.low for each in outlines[shaft.name]), default=0.0)
    for part in assembly.parts:
        for layer in part.layers:
            for hole in filter(keyed, layer.region.holes):
                around = round_of(hole)
                assert around is not None, "it has a keyway"
                for pose in poses[part.name]:
                    bore = standing(part, pose, layer, *around)
                    if any(bore.holds(each) for each in outlines[shaft.name]):
                        middle = (bore.low + bore.high) / 2 - low
                        half = key_length(bore.diameter, bore.high - bore.low) / 2
                        yield middle - half, middle + half


def _thinner(mechanism: Mechanism, part: Part, tolerance: str) -> float:
    """By how much a part of metal may be thinner than drawn, mm, where the gaps beside it do not bear a general tolerance; else 0.

    What an inner ring lies on takes at most half of the play over it, and so does a link on which that stands, or else the next one, which
    lies on two such links, would lean in its bearings; a pin with flats never reaches through what it is glued in, and a collar never
    up to the plate.
    """
    if part.role == "pin" and len(part.layers) > 1 and headed(part) is None:
        return general(part.thickness, tolerance)
    if _is_under_plate(mechanism, part):
        return general(part.thickness, tolerance)
    allowed = thickness_allowances(mechanism.assembly).get(part.name, math.inf)
    if part.role == "sleeve" or _bears_sleeve(mechanism.assembly, part):
        return min(allowed, _lip(mechanism), general(part.thickness, tolerance))
    between = deviations(part.thickness, _BETWEEN_RINGS) if part.drum else None
    if between:
        return -between[0]
    return allowed if allowed < general(part.thickness, tolerance) else 0.0


def _is_under_plate(mechanism: Mechanism, part: Part) -> bool:
    """Whether a part that moves is a play below the plate, such as the collar of a shaft."""
    low = -mechanism.print.slide_clearance
    return any(
        each.part == part.name
        and each.body != GROUND
        and abs(each.z + part.thickness - low) < SAME_POINT
        for each in mechanism.assembly.mounts
    )


def _thicker(mechanism: Mechanism, part: Part, tolerance: str) -> float:
    """By how much the plate may be thicker than drawn, mm, and no thinner: what ends with a part over it would stand out there, and a bush
    under it; 0 of any other part, of a plate in which no shaft or pin ends or turns, and of one with bosses, whose height is no thickness."""
    assembly = mechanism.assembly
    if not any(
        each.part == part.name and each.body == GROUND and not each.z for each in assembly.mounts
    ):
        return 0.0
    poses, outlines = _standing_still(assembly)
    bores = [
        standing(part, pose, layer, *hole)
        for layer in part.layers
        if abs(layer.z1 - layer.z0 - part.thickness) < SAME_POINT
        for hole in filter(None, map(round_of, layer.region.holes))
        for pose in poses[part.name]
    ]
    rods = [each.name for each in assembly.parts if is_rod(each) or each.name == BUSH]
    held = [shaft for name in rods for shaft in outlines[name]]
    pins = [shank for name in _pins(mechanism) for shank in outlines[name]]
    held += [shank for shank in pins if shank.low > -SAME_POINT]  # whose head is above
    through = any(bore.holds(each) for bore in bores for each in held)
    return general(part.thickness, tolerance) if through else 0.0


def _shorter(mechanism: Mechanism, part: Part, tolerance: str) -> tuple[float, float]:
    """By how much a rod or the shank of a headed pin is shorter than drawn, at least and at most, mm, so that it never stands out of what it
    goes through; 0 of any other part. A shaft hangs from the plate, or stands on blocks beside it: what lies under that does not move its
    end."""
    pin = headed(part) is not None and part.role == "pin"
    if not pin and not is_rod(part):
        return 0.0, 0.0

    def thinner(other: Part) -> float:
        if other.process != "printed":
            return _NARROWER if other in _rings(mechanism.assembly) else 0.0
        if _thicker(mechanism, other, tolerance):
            return 0.0
        return _thinner(mechanism, other, tolerance) or general(other.thickness, tolerance)

    least = stack_allowance(mechanism.assembly, part, thinner, pin)
    if least is None:
        return 0.0, 0.0
    length = part.thickness - (min(layer.z1 for layer in part.layers) if pin else 0.0)
    return round(least, 3), round(least + general(length, tolerance), 3)


def _bears_sleeve(assembly: Assembly, part: Part) -> bool:
    """Whether a sleeve under an inner ring stands on a part that moves."""
    sleeves = [each for each in assembly.mounts if assembly.by_name[each.part].role == "sleeve"]
    tops = {
        (each.body, round(each.z + part.thickness, 6))
        for each in assembly.mounts
        if each.part == part.name and part.points and each.body != GROUND
    }
    return any((each.body, round(each.z, 6)) in tops for each in sleeves)


def _lip(mechanism: Mechanism) -> float:
    """By how much a lip under an inner ring's bearing, and the sleeve through it, may be lower, mm: half of the play over the next link."""
    return mechanism.print.slide_clearance / 2


def _ring_edges(mechanism: Mechanism, part: Part) -> str:
    """State of the edges of what bears on the inner ring of a ball bearing; "" of any other part."""
    if part.role == "sleeve":
        return _OF_SLEEVE
    return _OF_JOURNAL if _pins(mechanism).get(part.name, (0.0, ""))[1] == JOURNAL else ""


def _has_keyed_shaft(assembly: Assembly) -> bool:
    """Whether shafts with keyways are made: these are tight, for what they turn may go to and fro."""
    return any(keyed(layer.region.outer) for part in assembly.parts for layer in part.layers)


def drawing_number(mechanism: Mechanism, part: str) -> str:
    """Number of a part's drawing; "" where it is its file's name."""
    names = [each.name for each in mechanism.assembly.parts]
    number = mechanism.drawing.number
    return f"{number}-{names.index(part) + 1:02d}" if number else ""


def material_of(mechanism: Mechanism, part: Part) -> tuple[str, str]:
    """Of what a part is made, and the number of a steel; of one that is bought that it is."""
    material = materials.of(mechanism.material.name)
    of_sheet = cut_of_sheet(mechanism.assembly, part)
    if of_sheet and material.printed:
        return "as the sheet", ""
    if of_sheet or part.process == "printed":
        return material.name, material.number
    if part.process not in (TURNED, CUT):
        return part.process, ""
    if material.metal and is_rod(part) and round_of(part.region.outer):
        return _ROD_STEEL, materials.of("C45").number
    return "steel", ""


def _numbered(material: str, number: str) -> str:
    """Name of a material, a steel's with its number."""
    return f"{material} ({number})" if number else material


def _asked(value: float | None, usual: float) -> float:
    """What a spec says, 0 too, or else what is usual."""
    return usual if value is None else value


def _chamfer(bore: float | None) -> float:
    """Usual chamfer of a bore, mm; 0 without a bore."""
    return next(chamfer for most, chamfer in _CHAMFERS if bore <= most) if bore else 0.0


def timing_of(mechanism: Mechanism) -> list[Motion]:
    """What the followers of a machine's cams and the teeth of its rows of pins do over a turn of their shafts, by the angle by which
    these have turned."""
    x = np.linspace(0.0, 360.0, _SAMPLES)
    teeth = [
        Motion(
            row.name,
            "mm",
            x,
            row.bend(np.radians(x), 0),
            row.bend(np.radians(x), 1) * np.radians(1),
        )
        for row in mechanism.assembly.rows
    ]
    return [
        *(
            Motion(each.name, each.unit, x, each.law(x, 0), each.law(x, 1))
            for each in follower_motions(mechanism)
        ),
        *teeth,
    ]


def machine_facts(mechanism: Mechanism, kind: str, behind: str = "") -> Facts:
    """What the title block of a sheet of the whole machine says; kind: in its file's name; behind: what follows the drawings' number."""
    sheet = mechanism.drawing
    return Facts(
        machine=_machine(mechanism),
        number=f"{sheet.number}{behind}" if sheet.number else f"{mechanism.name}-{kind}-drawing",
        date=sheet.date or "",
        revision=sheet.revision or "",
        drawn_by=sheet.drawn_by or "",
        checked_by=sheet.checked_by or "",
    )


def shaft_facts(mechanism: Mechanism, shaft: TurnedShaft) -> Facts:
    """What the sheet of a shaft that is no part says."""
    sheet = mechanism.drawing
    return replace(
        machine_facts(mechanism, "shaft", "-S1"),
        material=f"{SHAFT_STEEL} ({materials.of(SHAFT_STEEL).number})",
        mass_g=shaft.volume * 1e3 * STEEL.density * 1e-6,
        tolerance=sheet.tolerance or _IN_METAL.tolerance,
        roughness=_SEAT_ROUGHNESS,
        roughness_elsewhere=sheet.roughness_elsewhere or _IN_METAL.roughness_elsewhere,
        run_out=_asked(sheet.run_out, _IN_METAL.run_out),
        symmetry=_asked(sheet.symmetry, _IN_METAL.symmetry),
        rod_chamfer=_chamfer(shaft.diameter),
        edges=sheet.edges or _IN_METAL.edges,
        heat_treatment=materials.of(SHAFT_STEEL).treatment,
        protection=sheet.protection or materials.of(SHAFT_STEEL).protection,
    )


def _machine(mechanism: Mechanism) -> str:
    """Name of a machine with its mechanism."""
    name = mechanism.name
    kind = mechanism.mechanism
    return name if name == kind else f"{name} ({kind})"


def _cams(mechanism: Mechanism) -> set[str]:
    """Names of parts whose outline a follower touches."""
    features = mechanism.assembly.features
    return {each.part for each in features if isinstance(each, CamOutline)}


def _slotted(mechanism: Mechanism) -> set[str]:
    """Names of the parts of a Geneva drive or the like that touch each other."""
    pairs = [each for each in mechanism.assembly.features if isinstance(each, EdgePair)]
    return {edge.part for pair in pairs for edge in pair.edges}


@dataclass(frozen=True)
class _Track:
    """Of a cam's track its name with its heights, "" of one alone; by the angles by which the cam has turned, (n,) deg, where its
    follower touches it and where its roller's axis is, (n,) complex mm in the part's frame; and how it stands at angle 0."""

    name: str
    turned: Floats
    places: Points
    centres: Points
    rider: Rider


def _tracks(mechanism: Mechanism, part: Part, step: float) -> Iterator[_Track]:
    """Each of a cam's tracks, from the bottom; nothing of another part."""
    outlines = [
        each
        for each in reversed(mechanism.assembly.features)
        if isinstance(each, CamOutline) and each.part == part.name and not each.inside
    ]
    own = {each.layer or (0, 0): each for each in outlines}  # the first of each layer
    for _, outline in sorted(own.items()):
        layer = part.drawn if outline.layer is None else part.layers[outline.layer[0]]
        heights = f", z {number(layer.z0)} to {number(layer.z1)}"
        name = f"{outline.track}{heights if outline.track else ''}"
        yield from _track(mechanism, part, outline, (name, layer), step)
    yield from _outer_wall(mechanism, part, step)


def _outer_wall(mechanism: Mechanism, part: Part, step: float) -> Iterator[_Track]:
    """The track of a groove's outer wall, which is as far from the inner one as the groove is wide; nothing of another part."""
    assembly = mechanism.assembly
    groove = _groove(assembly, part)
    if groove is None or groove.inner:
        return
    outer = next(
        each
        for each in assembly.features
        if isinstance(each, CamOutline) and each.inside and each.part == part.name
    )
    inner = assembly.outlines[outer.joint]
    plate = next(each for each in assembly.parts if each.name == inner.part)
    rim = facet_contour(next(hole for hole in part.region.holes if free(hole)), _FINE)
    for track in _track(mechanism, plate, inner, ("", plate.drawn), step):
        across = (track.centres - track.places) / np.abs(track.centres - track.places)
        places = track.places + groove.width * across
        if max(abs(_off(z, rim)) for z in places) >= 10 * _FINE:
            return
        radius = groove.roller / 2
        rider = Rider(places[0].item(), -across[0].item(), radius, track.rider.way)
        yield _Track("", track.turned, places, places - radius * across, rider)


def _track(
    mechanism: Mechanism, part: Part, outline: CamOutline, of: tuple[str, Layer], step: float
) -> Iterator[_Track]:
    """What a follower touches of the outline of one of its layers; nothing where that is not known. of: its name, the layer."""
    assembly = mechanism.assembly
    joint = assembly.machine.cam(outline.joint)
    mounts = [each for each in assembly.mounts if each.part == part.name and each.body == joint.cam]
    if not joint.touches or joint.over is not None or len(mounts) != 1:
        return
    (mount,) = mounts
    turned = np.arange(0.0, 360.0, step)
    theta = np.radians(turned) * assembly.cycle.sense - joint.phase
    rim = facet_contour(of[1].region.outer, _FINE)

    def own(vectors: Points) -> Points:
        vectors = vectors * np.exp(-1j * mount.angle)
        return -vectors.conj() if mount.flipped else vectors

    for touch in joint.touches:
        places, normals = touch(theta)
        places = own(places - mount.at)
        if max(abs(_off(z, rim)) for z in places) >= 10 * _FINE or not isinstance(touch, CamTouch):
            continue
        radii = touch.across(theta)
        ways = own(touch.way(theta[:1]))
        normals = own(normals)
        rolls = np.where(np.isfinite(radii), radii, 0.0)
        rider = Rider(places[0].item(), normals[0].item(), radii[0].item(), ways[0].item())
        yield _Track(of[0], turned, places, places + rolls * normals, rider)
        return


def _heights(mechanism: Mechanism, part: Part, step: float) -> Iterator[tuple[float, float, float]]:
    """Where the axis of a drum's roller is, on the cylinder half way along the roller, by the angle by which the drum has turned: deg,
    deg from X counter-clockwise, mm over its lower end; of a rib the middle between both rollers; nothing of another part."""
    drum = part.drum
    if drum is None or part.name not in mechanism.assembly.whole_drums:
        return
    turned = np.arange(0.0, 360.0, step)
    phi = -np.radians(turned) * mechanism.assembly.cycle.sense
    aside = np.arctan2(drum.path.beside(phi, 0), drum.roller.middle)
    at = np.mod(np.round(np.degrees(phi + aside), 6), 360.0)
    yield from zip(turned.tolist(), at.tolist(), drum.path.height(phi, 0).tolist(), strict=True)


def _segments(mechanism: Mechanism, part: Part) -> Iterator[tuple[str, float, float]]:
    """Segments of the motion of a drum's follower, by the angles by which the drum has turned, deg; nothing of another part."""
    assembly = mechanism.assembly
    for track in assembly.tracks:
        joint = assembly.machine.joint(track.joint)
        if track.part != part.name or not isinstance(joint, Cam):
            continue
        if not isinstance(joint.law, Program):
            continue
        for segment, begin in zip(joint.law.segments, joint.law.joints, strict=False):
            ends = np.degrees([begin, begin + segment.span]) * assembly.cycle.sense
            start, end = np.round(np.sort(ends), 9).tolist()
            yield segment.kind, start % 360, start % 360 + end - start


def _levels(mechanism: Mechanism, part: Part) -> Iterator[complex]:
    """Points of the upper edge of a plate that slides under its follower, at even places along it; nothing of another part."""
    if part.name not in {each.part for each in mechanism.assembly.edges}:
        return
    rim = facet_contour(part.region.outer, _FINE / 100)
    after = np.roll(rim, -1)
    low = float(np.min(rim.real))
    high = float(np.max(rim.real))
    step = next(each for each in _STEPS if (high - low) / each <= _LEVELS)
    for x in step * np.arange(math.ceil(low / step), math.floor(high / step) + 1):
        sides = (np.minimum(rim.real, after.real) <= x) & (x <= np.maximum(rim.real, after.real))
        sides &= rim.real != after.real
        a = rim[sides]
        edge = after[sides] - a
        yield complex(x, float(np.max(a.imag + (x - a.real) * edge.imag / edge.real)))


def _groove(assembly: Assembly, part: Part) -> Groove | None:
    """The groove of whose walls a part is one; None of another part."""
    for outer in assembly.features:
        if not (isinstance(outer, CamOutline) and outer.inside):
            continue
        inner = assembly.outlines[outer.joint]
        pair = [next(p for p in assembly.parts if p.name == each.part) for each in (inner, outer)]
        if part not in pair or outer.joint not in assembly.outlines:
            continue
        ways = [
            (m.at, m.angle, m.flipped) for p in pair for m in assembly.mounts if m.part == p.name
        ]
        walls = [hole for hole in pair[1].region.holes if free(hole)]
        if len(ways) != 2 or ways[0] != ways[1] or not walls:
            return None  # walls that are not in one frame
        point = facet_contour(walls[0], _FINE)[0]
        rim = facet_contour(pair[0].region.outer, _FINE / 100)
        width = round(_off(complex(point), rim), 3)
        return Groove(width, round(width - outer.free, 3), part is pair[0])
    return None


def _roller(mechanism: Mechanism, part: Part) -> tuple[float, float, float] | None:
    """Diameter, length and distance of its inner end from the axis of the roller in a drum's track; None of another part."""
    for track in mechanism.assembly.tracks:
        if track.part == part.name:
            radius, length, inner, _ = track.roller
            return 2 * radius, length, inner
    return None


def _thread_of(assembly: Assembly, part: Part, place: complex) -> str:
    """Thread that a hole is for by which the machine is screwed to a frame from behind; "" of another hole, or a wider one."""
    frame = assembly.frame
    if frame is None or part.name != frame.part:
        return ""
    sizes = [size for z, size in frame.fixings if abs(z - place) < SAME_POINT]
    return next((name for name, core in CORE_HOLES.items() if core in sizes), "")


def _off(z: complex, rim: Points) -> float:
    """Distance of a point from a polygon, mm."""
    edges = np.roll(rim, -1) - rim
    along = np.clip(((z - rim) * edges.conj()).real / np.abs(edges) ** 2, 0.0, 1.0)
    return float(np.min(np.abs(z - rim - along * edges)))


def _outer_fit(mechanism: Mechanism, part: Part) -> str:
    """Fit of the round outline of a pin, a rod or a roller; "" of another part, or of one with a head."""
    discs = [round_of(layer.region.outer) for layer in part.layers]
    if len({disc and round(disc[1], 6) for disc in discs}) != 1:
        return ""
    if part.name in _pins(mechanism):
        return _pins(mechanism)[part.name][1]
    return rod_fit(part) or (ROD if part.name in _rollers(mechanism) else "")


def _pins(mechanism: Mechanism) -> dict[str, tuple[float, str]]:
    """Diameters of what is pressed into others, mm, and their fits, by the names of the parts."""
    return _pressed(mechanism.assembly, mechanism.print.press_clearance)


def _rings(assembly: Assembly) -> list[Part]:
    """Ball bearings."""
    rings = (p for p in assembly.parts if p.process == "bought" and p.region.holes)
    return [ring for ring in rings if ring.name != BUSH]


@lru_cache(maxsize=1)
def _pressed(assembly: Assembly, clearance: float) -> dict[str, tuple[float, str]]:
    """Solid round parts of which a hole of another part holds the thinnest layer with that clearance, but for rods: diameters, mm, and
    fits."""
    poses, outlines = _standing_still(assembly)

    def bores(parts: Sequence[Part]) -> list[tuple[str, Round]]:
        return [
            (part.name, standing(part, pose, layer, *hole))
            for part in parts
            for layer in part.layers
            for hole in filter(None, map(round_of, layer.region.holes))
            for pose in poses[part.name]
        ]

    rings = bores(_rings(assembly))
    others = bores(assembly.parts)
    found = dict[str, tuple[float, str]]()
    for part in assembly.parts:
        round_layers = all(as_circle(layer.region.outer) for layer in part.layers)
        solid = not any(layer.region.holes for layer in part.layers)
        if not (round_layers and solid) or is_rod(part):
            continue
        size = min(shaft.diameter for shaft in outlines[part.name])
        shanks = [each for each in outlines[part.name] if abs(each.diameter - size) < SAME_POINT]

        if _tight(others, part, shanks, clearance):
            borne = _tight(rings, part, shanks, clearance)
            found[part.name] = size, JOURNAL if borne else PIN
    return found


def _tight(
    bores: Sequence[tuple[str, Round]], part: Part, shanks: Sequence[Round], clearance: float
) -> bool:
    """Whether one of the bores of other parts holds one of a part's round layers with that clearance, mm."""
    return any(
        abs(bore.diameter - shank.diameter - clearance) < SAME_POINT and bore.holds(shank)
        for name, bore in bores
        for shank in shanks
        if name != part.name
    )


def _rollers(mechanism: Mechanism) -> Iterator[str | None]:
    """Names of the parts that roll on a cam or in a slot."""
    for each in mechanism.assembly.features:
        if isinstance(each, CamOutline):
            yield each.roller
    yield from _edge_rollers(mechanism)


def _edge_rollers(mechanism: Mechanism) -> Iterator[str]:
    """Names of the parts that roll in a slot or the like."""
    pairs = (each for each in mechanism.assembly.features if isinstance(each, EdgePair))
    yield from (edge.part for pair in pairs for edge in pair.edges if edge.seat)


def _fits(mechanism: Mechanism, part: Part, seat: str, play: str) -> Iterator[Fit]:
    """Fits of a part's round holes. seat: of ISO 286, of holes into which something is pressed; play: deviations of those in which
    something turns."""
    clearances = (
        ("press", mechanism.print.press_clearance),
        ("slide", mechanism.print.running_clearance),
        ("slide", mechanism.print.slide_clearance),
    )
    poses, outlines = _standing_still(mechanism.assembly)
    dowel = mechanism.assembly.dowel
    thread = mechanism.assembly.thread
    metal = materials.of(mechanism.material.name).metal
    shafts = [shaft for other, rounds in outlines.items() if other != part.name for shaft in rounds]
    held = {each.name: rod_fit(each) for each in mechanism.assembly.parts if is_rod(each)}
    held |= {name: fit for name, (_, fit) in _pins(mechanism).items()}
    shanks = [(shaft, fit) for name, fit in held.items() for shaft in outlines[name]]
    rings = [shaft for ring in _rings(mechanism.assembly) for shaft in outlines[ring.name]]
    holes = set[tuple[complex, float]]()
    for layer in part.layers:
        for contour in layer.region.holes:
            around = round_of(contour)
            if around is None or around in holes:
                continue
            place, radius = around
            if seat and dowel and abs(2 * radius - dowel) < SAME_POINT and abs(place) > SAME_POINT:
                holes.add((place, radius))
                yield Fit(place, dowel, f"{in_limits(seat, dowel)}, dowel m6")
                continue
            cut = thread or (metal and _thread_of(mechanism.assembly, part, place)) or ""
            if cut and abs(2 * radius - CORE_HOLES[cut]) < SAME_POINT:
                holes.add((place, radius))
                yield Fit(place, CORE_HOLES[cut], f"{CORE}, {cut} through")
                continue
            inside = list(_nominal_diameters(mechanism, part.name, place))
            bores = [standing(part, pose, layer, place, radius) for pose in poses[part.name]]
            for bore in bores:
                inside += [shaft.diameter for shaft in shafts if bore.holds(shaft)]
            borne = any(bore.holds(ring) for bore in bores for ring in rings)
            for word, clearance in clearances:
                sizes = [size for size in inside if abs(2 * radius - size - clearance) < SAME_POINT]
                if sizes:
                    holes.add((place, radius))
                    words = f"{word} on Ø{number(sizes[0])}"
                    if word == "press" and seat and not clearance:
                        words = _held(bores, shanks, words, sizes[0], keyed(contour) is not None)
                        usual = bool(play) and not mechanism.drawing.seat_fit
                        own, words = _seat(part, words, borne, seat, usual)
                        words = f"{in_limits(own, 2 * radius)}, {words}"
                    nominal = 0.0
                    if word == "slide" and play:
                        on = _fit_inside(bores, shanks)
                        own = _running_fit(sizes[0], clearance, on)
                        nominal = sizes[0] if own else 0.0
                        words = f"{own or play}, {words} {on}".rstrip()
                    yield Fit(place, 2 * radius, words, borne, nominal)
                    break


def _seat(part: Part, words: str, borne: bool, seat: str, usual: bool) -> tuple[str, str]:
    """Fit and words of a hole in which something sits; borne: whether that is a ball bearing; seat: the fit of others; usual: whether the
    spec leaves it open. A cap and a lock go on their pins by hand, and nothing fixes a sleeve on its pin."""
    if part.role == "sleeve":
        return seat, words.replace(joint_of(JOURNAL), "slides")
    on_pin = part.role == "cap" or (part.role == "lock" and words.startswith(joint_of(PIN)))
    if on_pin and usual:
        return _CAP, words.replace(joint_of(PIN), joint_of(ROD))
    if borne:
        return _SEAT if usual else seat, "ball bearing"
    return seat, words


def _held(
    bores: Sequence[Round],
    held: Sequence[tuple[Round, str]],
    words: str,
    size: float,
    key: bool,
) -> str:
    """Words of a hole in which something of so much is fixed, mm; held: rods and pins with their fits; key: whether it has a keyway."""
    fit = _fit_inside(bores, held)
    return f"{joint_of(fit, key)} on Ø{number(size)} {fit}" if fit else words


def _fit_inside(bores: Sequence[Round], held: Sequence[tuple[Round, str]]) -> str:
    """Fit of what goes through a hole, "" where none is known; held: as in `_held`."""
    return next((fit for shank, fit in held if any(bore.holds(shank) for bore in bores)), "")


def _running_fit(size: float, clearance: float, on: str) -> str:
    """The closest fit of ISO 286, with its deviations, of a hole that runs on a shaft of a size, mm, as its files have it, by so much wider;
    "" where none has that size between its limits. on: the shaft's fit, which never fills the hole."""
    high = (deviations(size, on) or (0.0, 0.0))[1] if on else 0.0
    for fit in _RUNNING:
        limits = deviations(size, fit)
        if limits and high < limits[0] and limits[0] <= clearance <= limits[1]:
            return in_limits(fit, size)
    return ""


@lru_cache(maxsize=1)  # an assembly is the same object for all of its parts
def _standing_still(
    assembly: Assembly,
) -> tuple[Mapping[str, Sequence[PartPose]], dict[str, list[Round]]]:
    """At angle 0, by the parts' names: where their copies are, and the round outlines of these."""
    poses = assembly.poses(np.zeros(1))
    outlines = {
        part.name: [
            standing(part, pose, layer, *outer)
            for layer in part.layers
            if (outer := round_of(layer.region.outer))
            for pose in poses[part.name]
        ]
        for part in assembly.parts
    }
    return poses, outlines


def _nominal_diameters(mechanism: Mechanism, part: str, place: complex) -> Iterator[float]:
    """Diameters, mm, of what goes through a part's hole and no file shows: as its joints say, and a motor's at its own datum."""
    tables = [getattr(mechanism, name, None) for name in ("geometry", "making", "motor")]
    sizes = [
        getattr(table, name, None)
        for table in tables
        if getattr(table, "make", "") != "cams"
        for name in ("shaft_diameter", "boss_diameter")
    ]
    yield from (size for size in sizes if size and abs(place) < SAME_POINT)
    for joint in mechanism.assembly.features:
        if isinstance(joint, PinEyes):
            holes = [
                eye
                for eye in (joint.a, joint.b)
                if eye.part == part and not eye.shaft and abs(eye.at - place) < SAME_POINT
            ]
            yield from (
                eye.diameter for eye in (joint.pin, joint.a, joint.b) if holes and eye and eye.shaft
            )
