"""Several motors of one linkage, `[[drive]]` twice: the laws of their drives over one theta, and where that does not close.

theta     of all of them: it grows at the first one's speed; another that turns evenly makes whole turns of its own in a turn of it
period    one turn of theta, over which each program runs once
gap       of a dyad: by how much its ends are farther apart than both its links reach, or nearer than they can come, mm
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from camgen.errors import DesignError, Fault, Key, listed
from camgen.machine import model as m
from camgen.machine.loops import Chain, chain_of
from camgen.machine.programs import DriveLaw
from camgen.machine.reach import LOOKED, refuse_folds
from camgen.machine.state import Direct, Dyad
from camgen.machine.stepwise import stays_clear
from camgen.machines.linkage.drawing import Drawing
from camgen.machines.linkage.tables import OneDrive, SlidingDrive
from camgen.numerics import Floats
from camgen.parts.generator.sizes import Parts

_WHOLE = 1e-9  # turns, by which a whole number may be missed


def faults(drawing: Drawing, sizes: Parts, beside: Mapping[str, bool]) -> Iterator[Fault]:
    """What is wrong between several drives, or beside one that slides.

    beside: tables that only a machine with one shaft that drives has, and whether they are there.
    """
    slides = isinstance(drawing.drive, SlidingDrive)
    if len(drawing.drives) == 1 and not slides:
        return
    pivots: dict[str, int] = {}
    for k, drive in enumerate(drawing.drives):
        pivot = drawing.pivot(drive.link) if drive.link in drawing.links else None
        path: Key = ("drive", k)
        if pivot is not None:
            before = pivots.setdefault(pivot, k)
            if before != k:
                right = f"a link with a pivot of its own: drive.{before} already turns {drawing.drives[before].link} at {pivot}"
                yield Fault((*path, "link"), repr(drive.link), right)
    words = "no value here: it is for a machine with one motor, and this one has several"
    if slides:
        words = "no value here beside drive.slide: it is for a drive that turns"
    for table, there in beside.items():
        if there:
            yield Fault((table,), "", words)
    for key, value, usual in (
        ("sides", sizes.sides, 1),
        ("shaft", sizes.shaft, "through"),
        ("hand_crank", sizes.hand_crank, 0),
        ("motor", sizes.motor if slides else "none", "none"),
        ("can", sizes.can if slides else None, None),
    ):
        if value != usual:
            yield Fault(("parts", key), str(value), words)


def program_faults(drives: Sequence[OneDrive]) -> Iterator[Fault]:
    """What is wrong with how several motors turn, each by itself."""
    first, *others = drives
    for k, drive in enumerate(drives if others else ()):
        if drive.range_deg is not None:
            right = "segments in its place: several motors move by programs, or evenly"
            yield Fault(("drive", k, "range_deg"), str(list(drive.range_deg)), right)
    for k, drive in enumerate(others, 1):
        yield from _speed_faults(("drive", k, "speed_rpm"), first, drive)


def _speed_faults(path: Key, first: OneDrive, drive: OneDrive) -> Iterator[Fault]:
    """Of another drive, whose period is to be the first one's."""
    ratio = drive.speed_rpm / first.speed_rpm
    value = f"{drive.speed_rpm:g}"
    if drive.segments and abs(ratio - 1) > _WHOLE:
        right = f"{first.speed_rpm:g}, the same as drive.0, or no value: all programs run over one period"
        yield Fault(path, value, right)
    elif not drive.segments and abs(ratio - round(ratio)) > _WHOLE:
        right = (
            f"a whole multiple of drive.0's {first.speed_rpm:g}, so that a period brings it round"
        )
        yield Fault(path, value, right)


def driven(chain: m.Machine, drives: Sequence[OneDrive]) -> m.Machine:
    """The chain with the laws of all its drives; DesignError where it does not close over their period, or folds.

    chain: closed as drawn, a drive for each of `drives` in their order, others after them.
    """
    chain = moved(chain, drives)
    refuse_open(chain)
    return chain


def moved(chain: m.Machine, drives: Sequence[OneDrive]) -> m.Machine:
    """The same, which may not close; of a machine with one motor the chain itself."""
    if len(drives) == 1:
        return chain
    laws = []
    for k, (drive, joint) in enumerate(zip(drives, chain.drives, strict=False)):
        program = drive.program(("drive", k))
        start = float(chain.start[drive.link].angle)
        laws.append(joint if program is None else replace(joint, law=DriveLaw(program, start)))
    return replace(chain, drives=(*laws, *chain.drives[len(laws) :]))


def refuse_open(
    machine: m.Machine,
    said: str = "the drives lead the machine out of reach",
    remedy: str = "let the drives turn less far, or make the links there longer",
) -> None:
    """Raise DesignError where the laws of a machine's drives lead it over a period of theta where it does not close, or folds;
    said, remedy: its words on that."""
    if stays_clear(machine):
        return
    theta = np.linspace(0, math.tau, LOOKED + 1)
    chain = chain_of(machine)
    state = chain.state(theta, 0)
    for number, step in enumerate(chain.steps):
        if isinstance(step, Direct):
            continue
        block = step.block if isinstance(step, Dyad) else step
        rows = [state.spins[name][0] for name in block.angles]
        rows += [state.lengths[name][0] for name in block.lengths]
        is_open = ~np.isfinite(np.array(rows)).all(axis=0)
        if is_open.any():
            gaps = np.where(is_open, _gaps(chain, number, theta), 0.0)
            error = _open_error(block.joints, np.degrees(theta), is_open, gaps)
            raise error.saying(f"{said}: {error.sentence}").mended(remedy)
    refuse_folds(machine)


def _open_error(
    joints: Sequence[str], theta_deg: Floats, is_open: NDArray[np.bool_], gaps: Floats
) -> DesignError:
    """Where a program is out of reach: the joints that open, from where on, and by how much at most."""
    where = listed("joint", joints)
    first = int(np.argmax(is_open))
    share = float(np.mean(is_open))
    known = bool(np.isfinite(gaps).all())
    worst = int(np.argmax(gaps)) if known else first
    short = f", by {gaps[worst]:.4g} mm at {theta_deg[worst]:.4g} deg" if known else ""
    said = f"from {theta_deg[first]:.4g} deg of the period on {where} cannot close{short}"
    value, limit, unit = (float(gaps[worst]), 0.0, "mm") if known else (100 * share, 0.0, "percent")
    return DesignError(
        f"gap at {where}" if known else "share of the period that does not close",
        value,
        limit,
        unit,
        f"{theta_deg[worst]:.4g} deg of the period",
    ).saying(said)


def _gaps(chain: Chain, number: int, theta: Floats) -> Floats:
    """Of a step that is a dyad of two links that turn, at theta, (n,) mm: 0 where it closes; of another one nan."""
    step = chain.steps[number]
    if not isinstance(step, Dyad) or step.kind != "angles":
        return np.full(theta.shape, math.nan)
    with np.errstate(all="ignore"):
        (apart,) = chain.state(theta, 0, number).known(step.block).loops
        (loop,) = step.block.loops
        a, b = (abs(loop.levers[name]) for name in step.block.angles)
        distance = np.abs(apart[0])
    return np.asarray(np.maximum(np.maximum(distance - (a + b), abs(a - b) - distance), 0.0))
