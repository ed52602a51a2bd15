"""Many variants of a disc cam: what costs most of each is found for all of them as arrays, and each then judges itself."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from camgen.errors import DesignError
from camgen.machine.cams.many import Figures, figures_of
from camgen.machine.cams.profile import DiscCam

if TYPE_CHECKING:
    from camgen.machines.disc_cam.mechanism import DiscCamDrive

_TIE = 1e-6  # deg or mm from a limit, nearer than which a cam is looked at by itself


def prepare(many: Sequence[DiscCamDrive]) -> None:
    """Fill in pressure angles, curvature and sizes of all that are cams alone, given by their size, without load."""
    alone = []
    for each in many:
        if each.geometry.base_radius is not None and not each.standing and each.load is None:
            with suppress(DesignError):  # told when its limits are asked for
                alone.append((each, each.cams))
    found = iter(figures_of([cam for _, cams in alone for cam in cams]))
    for each, cams in alone:
        mine = [next(found) for _ in cams]
        known = [
            one
            for cam, one in zip(cams, mine, strict=True)
            if one is not None and _decides(each, cam, one)
        ]
        if len(known) < len(cams):
            continue
        for cam, one in zip(cams, known, strict=True):
            vars(cam).update(
                undercuts=(),
                least_radius=one.least_radius,
                length=one.length,
                area=one.area,
                nearest=one.nearest,
                steepest=one.steepest,
                face_contact=(one.face_from, one.face_to),
            )
        vars(each).update(_clears_axle=True)


def _decides(drive: DiscCamDrive, cam: DiscCam[Any], one: Figures) -> bool:
    """Whether no rounding can turn a verdict on what is seen of a cam, and it clears its follower's axle in any case."""
    f, limits = drive.geometry.follower, drive.allowed
    width = (
        one.face_to - one.face_from
        if f.motion == "oscillating"
        else 2 * max(one.face_to, -one.face_from)
    )
    near = [
        one.steepest - drive.cam_limits.steepest(cam),
        one.least_radius - limits.least_radius,
        width - (f.face_width or 0.0),
    ]
    room = math.inf if f.motion == "translating" else (f.pivot_distance or 0.0) - one.farthest
    return room > drive.accuracy.chord_tolerance and not any(
        abs(each) < _TIE for each in near[: 2 + bool(f.face_width)]
    )
