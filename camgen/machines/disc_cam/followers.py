"""Where a disc cam's followers stand on its base circle, of each motion and shape."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence

from camgen.errors import DesignError
from camgen.machine.cams.followers import Follower, SlidingFace, SlidingTip, SwingingFace
from camgen.machine.cams.profile import SwingingArm
from camgen.machine.cams.shoes import Shoe, SlidingShoe, SwingingShoe, convex_edges
from camgen.machines.disc_cam.tables import DiscCamGeometry

_UP = 1j


def drawn(geometry: DiscCamGeometry) -> Follower:
    """The follower on some base circle that it can stand on."""
    f = geometry.follower
    if f.shape == "outline":
        return _shoe(geometry)
    if not f.swings:
        base = abs(f.offset) + 1
    elif f.shape == "flat":
        base = f.face_offset
    else:
        base = max(f.pivot_distance or 0.0, f.arm or 0.0) - (f.radius or 0.0)
    return standing_on(base, geometry, 0.0)[0]


def _shoe(geometry: DiscCamGeometry) -> Shoe:
    """An outline of a person's own, somewhere on its way."""
    f = geometry.follower
    edges = convex_edges(f.drawing[0])
    if not f.swings:
        return SlidingShoe(edges, complex(f.offset), _UP)
    return SwingingShoe(edges, complex(f.pivot_distance or 0.0))


def standing_on(base: float, geometry: DiscCamGeometry, top: float) -> Sequence[Follower]:
    """The follower on a base circle, mm; with conjugate closure also its second one, on the far side.

    top: greatest displacement, mm or rad. Raises DesignError where it cannot stand on that circle.
    """
    f = geometry.follower
    if f.shape == "outline":
        try:
            return [_shoe(geometry).on_base(base)]
        except ValueError:
            raise DesignError(
                "geometry.base_radius",
                base,
                0.0,
                "mm",
                "the base circle",
                "the outline passes by it on its way: use another base_radius, or draw the outline nearer to its origin",
            ) from None
    both = geometry.closure == "conjugate"
    radius = f.radius or 0.0
    prime = base + radius
    if not f.swings:
        if f.shape == "flat":
            start = f.offset + _UP * base
            return [SlidingFace(start, _UP), SlidingFace(start - _UP * (2 * base + top), _UP, -1)][
                : 1 + both
            ]
        if abs(f.offset) >= prime:
            raise DesignError(
                "geometry.follower.offset",
                f.offset,
                prime,
                "mm",
                "the base circle",
                "the slide passes beside the pitch circle: use a smaller offset or a larger base_radius",
            )
        high = math.sqrt(prime**2 - f.offset**2)
        start = f.offset + _UP * high
        second = SlidingTip(start - _UP * (2 * high + top), _UP, radius, -1)
        return [SlidingTip(start, _UP, radius), second][: 1 + both]
    far = f.pivot_distance or 0.0
    if f.shape == "flat":
        share = (base - f.face_offset) / far
        if not abs(share) < 1:
            raise DesignError(
                "geometry.base_radius",
                base,
                far + f.face_offset,
                "mm",
                "the base circle",
                "the face cannot touch it from that pivot: use a smaller base_radius or a larger pivot_distance",
            )
        facing = cmath.rect(1, -math.acos(share))
        turned = facing.conjugate() * cmath.exp(-1j * top)
        return [
            SwingingFace(complex(far), way, f.face_offset) for way in (facing, turned)[: 1 + both]
        ]
    arm = f.arm or 0.0
    bearing = (far**2 + arm**2 - prime**2) / (2 * far * arm)
    if not abs(bearing) < 1:
        raise DesignError(
            "geometry.base_radius",
            base,
            max(abs(far - arm), min(far + arm, prime)) - radius,
            "mm",
            "the base circle",
            "pivot_distance, arm and the pitch circle make no triangle: change one of them",
        )
    spoke = -cmath.rect(arm, math.acos(bearing))
    second_arm = spoke.conjugate() * cmath.exp(-1j * top)
    return [
        SwingingArm(complex(far), spoke, radius, 1),
        SwingingArm(complex(far), second_arm, radius, -1),
    ][: 1 + both]
