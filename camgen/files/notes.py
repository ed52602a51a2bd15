"""Notes on the sheet of a part: what its views leave open, and how it is made."""

from __future__ import annotations

import cmath
import math
import re

from camgen.files.bore_detail import turn_of_flat, turn_of_key
from camgen.files.dimensions import STACK, flat_of, free, number, round_of
from camgen.files.drawn_part import DrawnPart
from camgen.files.page import FILING, MARGIN, SIZES
from camgen.files.sheet import Text
from camgen.files.title_block import CORE, WIDTH, LockLimits
from camgen.geometry.arcs import as_circle
from camgen.parts.keyways import keyed
from camgen.parts.part import SizeNote
from camgen.tolerances import SAME_POINT

NOTES = SIZES["A4"][0] - FILING - MARGIN - WIDTH - 6  # width, beside the title block of an A4 sheet

# Roughness of a shank of grade 6, um: 1.6 takes half of its tolerance; camgen's own rule.
_SHANK = 0.8
_STRAIGHT = 1000.0  # mm, radius from which on a hollow is as good as straight to a wheel


def notes_of(drawn: DrawnPart, own_sheets: int) -> list[str]:
    """All notes on a part, in lines that fit beside the title block; own_sheets: how many its tables take after the first."""
    part = drawn.part
    stock = any(isinstance(note, SizeNote) for note in part.notes)  # which is cut
    bought = part.process == "bought" and not stock
    lines = ["Bought, not made: this sheet shows which one"] if bought else []
    off_zero = any({x, y} - {"0", ""} for _, x, y, _ in drawn.rows)
    if drawn.zero_is and drawn.rows and (off_zero or drawn.zero):
        lines.append(f"X and Y from {drawn.zero_is}")
    if drawn.zero:
        lines[-1] += (
            f", which in the part's files is at {number(drawn.zero.real)}, {number(drawn.zero.imag)}"
        )
    circle = as_circle(drawn.outer)
    if circle and abs(circle[0]) > 1e-9:
        x = circle[0].real
        y = circle[0].imag
        lines.append(f"Outline Ø{number(2 * circle[1])} about X {number(x)}, Y {number(y)}")
    if part.side_profile is not None:
        lines.append("Material is what lies within both outlines, along z and from above")
    if len(part.layers) > STACK:
        lines.append(f"{len(part.layers)} layers, see the STL")
    depths = sorted({number(layer.z1 - layer.z0) for layer in part.engraved})
    lines += [f"Engraved {depth} deep" for depth in depths]
    lines += _files(drawn)
    if part.tap:
        lines.append(f"Thread {part.tap.thread}: on this sheet alone, no file has it")
    if drawn.own_tables:
        what = "tables of the tracks" if len(drawn.own_tables) > 1 else "table of the track"
        sheets = "sheet 2" if own_sheets == 1 else f"sheets 2 to {own_sheets + 1}"
        lines.append(f"Full {what}: {sheets}")
    if drawn.turns:
        lines.append("+ : positive sense of turning (ccw)")
    if drawn.slotted:
        first, second, *_ = sorted(
            math.degrees(cmath.phase(z)) % 360 for z in drawn.slotted[0].slots
        )
        places = f"{number(first, 2)}, {number(second, 2)}"
        lines.append(f"Slots at {places}, ... deg from X, counter-clockwise; hollows midway")
    if drawn.riders:
        lines.append("Dashed: the follower at cam angle 0; s: the way in which it rises")
    lines += _shop_notes(drawn)
    lines += _lock_notes(drawn.facts.lock)
    turned = drawn.facts.turned_deg
    if number(turned, 1) not in ("0", "360"):
        lines.append(f"In the arrangement turned by {number(turned, 1)}°, counter-clockwise")
    lines += [note for note in part.notes if note is not drawn.square]
    return [line for note in lines for line in wrapped(note[:1].upper() + note[1:])]


def _files(drawn: DrawnPart) -> list[str]:
    """What of the part is in which file."""
    part = drawn.part
    if part.outlined:
        if not any(map(free, (part.region.outer, *part.region.holes))):
            return [f"Outlines: {drawn.stem}.dxf"]
        span = f", z {number(part.drawn.z0)} to {number(part.drawn.z1)}" if part.layers[1:] else ""
        exact = f"within {drawn.tolerance:g} of the exact curve"
        return [f"Profile{span}: {drawn.stem}.dxf, {exact}"]
    if part.stacked:
        low, high = number(part.drawn.z0), number(part.drawn.z1)
        return [f"Drawn thick: the layer z {low} to {high}; all outlines: {drawn.stem}.stl"]
    if drawn.facts.heights:
        path = f", the cutter's path: {drawn.stem}-path.csv" if drawn.facts.cutter else ""
        lower_end = f"Z from the lower end, on the left in {drawn.letter}-{drawn.letter}"
        return [f"Track: {drawn.stem}-developed.dxf{path}", lower_end]
    return [f"The blank is drawn; its track: {drawn.stem}.stl"]


def _shop_notes(drawn: DrawnPart) -> list[str]:
    """Notes on how the part is made."""
    lines = list[str]()
    facts = drawn.facts
    if drawn.chamfer:
        lines.append(f"Bore chamfered {number(drawn.chamfer)} × 45° at both ends")
    lines += _corner_notes(drawn)
    lines += _turn_notes(drawn)
    if drawn.plate:
        lines.append("All holes go through")
    fine = _listed(_ground(drawn))
    if "outside" in _ground(drawn):
        lines.append(f"Outside Ra {facts.bore_roughness:g}")
    if "shank" in _ground(drawn):
        lines.append(f"Shank Ra {_SHANK:g}")
    fitted = _fitted(drawn)
    lines += [f"Holes with a fit Ra {facts.bore_roughness:g}"] if fitted else []
    if facts.roughness_elsewhere:
        others = _listed([*_ground(drawn), *["holes with a fit"][:fitted]])
        where = f" but for the {others}" if others else ""
        lines.append(f"All faces{where} Ra {facts.roughness_elsewhere:g}")
    if drawn.rim_letter and facts.profile:
        form = "flat" if facts.levels else "round"
        fine_rim = f", Ra {facts.bore_roughness:g}" if facts.bore_roughness else ""
        lines.append(
            f"{_rim(drawn)} {drawn.rim_letter} {form} within {facts.profile / 2:g}{fine_rim}"
        )
    if drawn.rim_letter and facts.groove:
        lines.append(
            f"Rim {drawn.rim_letter} centres the wall to be cut and measured; the dowels locate it"
        )
    lines += [f"Edges {facts.edges}"] if facts.edges else []
    lines += [facts.heat_treatment] if facts.heat_treatment else []
    if facts.case_only and (running := _running(drawn)):
        soft = _listed(_soft(drawn))
        where = " (thick chain line)" if drawn.cased or drawn.drum else ""
        kept = f"; keep {soft} soft" if soft else ""
        lines.append(f"Case on the {_listed(running)} only{where}{kept}")
    if facts.ground and fine:
        lines.append(f"{fine} ground after hardening; all sizes hold after it")
    if facts.thread:
        before = ", before hardening" if facts.ground else ""
        lines.append(f"Fit the walls on the back; drill and ream the dowel holes together{before}")
        lines += [f"Threads {facts.thread} cut before hardening"] if facts.ground else []
    lines += [facts.protection] if facts.protection else []
    return lines


def _corner_notes(drawn: DrawnPart) -> list[str]:
    """Radii of corners and hollows that no view has, and the ends of a rod."""
    facts = drawn.facts
    lines = list[str]()
    if facts.corner and drawn.bosses and drawn.turns and not drawn.part.drum:
        lines.append(f"Corners of hub and disc at most R{number(facts.corner)}")
    if facts.profile and drawn.surface:
        if drawn.hollow < _STRAIGHT:  # rounded down: a larger wheel cuts into the track
            least = math.floor(10 * drawn.hollow) / 10
            lines.append(f"Smallest hollow radius of the track: R{least:g}")
        else:
            lines.append("Track without a hollow: a cutter of any size reaches it")
    if facts.rod_chamfer:
        lines.append(f"Both ends chamfered {number(facts.rod_chamfer)} × 45°")
        lines += [f"Round face Ra {facts.bore_roughness:g}"] if facts.bore_roughness else []
    return lines


def _turn_notes(drawn: DrawnPart) -> list[str]:
    """By how much what holds a part on its shaft lets it turn, at the limits of the sheets of both."""
    facts = drawn.facts
    if not facts.key_fit:
        return []
    for hole in drawn.part.region.holes:
        key = keyed(hole)
        flat = flat_of(hole)
        around = round_of(hole)
        if key and facts.own_key:
            turn = math.degrees(turn_of_key(2 * key.radius, key.width, facts.key_fit))
            return [f"Keyway of shaft and bore {facts.key_fit}, key h9: turns at most ±{turn:.1g}°"]
        if flat and around:
            turn = math.degrees(turn_of_flat(around[1], flat[1]))
            return [f"On the flat of its shaft it turns at most ±{turn:.1g}°"]
    return []


def _lock_notes(limits: LockLimits | None) -> list[str]:
    """How a lock fits its wheel at the limits of all sheets."""
    if limits is None:
        return []
    worst = f"Worst limits: {limits.least:.1g} clear of the hollows"
    if limits.least < 0:
        worst = f"Worst limits: binds by {-limits.least:.1g}; use a greater geneva.clearance"
    return [
        f"{worst}, bushes true within {limits.bush:g}",
        f"Loosest limits: the wheel turns by {math.degrees(limits.turn):.1g}°",
    ]


def _rim(drawn: DrawnPart) -> str:
    """What the datum is that is no hole."""
    return "lower side" if drawn.facts.levels else "rim"


def _running(drawn: DrawnPart) -> list[str]:
    """Faces on which a follower, a roller or another part runs."""
    faces = (
        ("track", drawn.track_tables),
        ("slots and hollows", drawn.slotted),
        ("locking arc", drawn.lock),
    )
    return [name for name, own in faces if own]


def _soft(drawn: DrawnPart) -> list[str]:
    """What is not hardened where a case is, as far as the part has it."""
    tapped = drawn.facts.thread or drawn.part.tap
    faces = (("bore", drawn.part.bore), ("keyway", drawn.key), ("threads", tapped))
    return [name for name, own in faces if own]


def _fitted(drawn: DrawnPart) -> bool:
    """Whether holes have a fit besides the bore that is dimensioned by itself."""
    fits = [each for each in drawn.facts.fits if not each.words.startswith(CORE)]
    alone = drawn.bored is not None
    others = [each for each in fits if not (alone and abs(each.at) < SAME_POINT)]
    return bool(others and drawn.facts.bore_roughness)


def _ground(drawn: DrawnPart) -> list[str]:
    """Faces that have a roughness of their own, and are ground where a part is hardened: "track", "bore"."""
    facts = drawn.facts
    faces = (
        ("bore", facts.bore_roughness and drawn.bored),
        ("round face", facts.bore_roughness and facts.rod_chamfer),
        ("outside", facts.bore_roughness and facts.outer_fit and not facts.rod_chamfer),
        ("shank", facts.roughness_elsewhere and facts.shank[1]),
        (_rim(drawn), facts.bore_roughness and drawn.rim_letter),
    )
    running = _running(drawn) if facts.roughness else []
    return [*running, *(name for name, own in faces if own)]


def _listed(names: list[str]) -> str:
    """Names in words, such as "track and bore"."""
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def wrapped(note: str) -> list[str]:
    """A note in lines that fit beside the title block of an A4 sheet."""
    room = NOTES
    lines = [""]
    for word in re.findall(r"Ra \S+|\S+", note):
        longer = f"{lines[-1]} {word}".strip()
        lines = (
            [*lines[:-1], longer]
            if not lines[-1] or Text(0j, longer, 2.5).room <= room
            else [*lines, word]
        )
    return lines
