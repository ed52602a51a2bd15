"""A machine's solids where they stand at one angle, as a scene of trimesh: mm, z up.

    world    the ground
    body     a node where the body stands, by its name
    copy     a node on its body where a copy of a part is mounted: "rocker-1", "rocker-2"
    part     a mesh in the part's own frame, by its name

Bodies and copies are called as in the machine's GLB.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.mesh import Mesh, in_standing_plane, placing
from camgen.machine.model import GROUND
from camgen.machine.run import solve
from camgen.numerics import Floats
from camgen.parts.assembly import Assembly

if TYPE_CHECKING:
    from trimesh import Scene


def posed_scene(assembly: Assembly, solids: Mapping[str, Mesh], theta: float) -> Scene:
    """All bodies as exact parts move them at theta, rad, the angle that `solve` takes; solids: of the parts, by name.

    DesignError where the machine does not close at theta.
    """
    from trimesh import Scene, Trimesh

    run = solve(assembly.exact, float(theta), 0)
    scene = Scene(base_frame="world")
    graph: Any = scene.graph
    for name in (GROUND, *(body.name for body in run.machine.moving)):
        pose = run.pose(name)
        angle = float(pose.angle[0])
        place = complex(pose.place[0])
        if not math.isfinite(angle + abs(place)):
            where = f"{assembly.cycle.name} {math.degrees(theta):.6g} deg"
            message = f"the machine does not close at {where}"
            raise DesignError(
                f"place of {name}",
                math.nan,
                math.nan,
                "mm",
                where,
            ).saying(message)
        stands = placing(angle, place + assembly.planes.get(name, 0j), 0, 0)
        if name in assembly.planes:
            stands = in_standing_plane(stands)
        graph.update(frame_from="world", frame_to=name, matrix=_square(stands))
    for name, solid in solids.items():
        scene.geometry[name] = Trimesh(solid.vertices, solid.faces, process=False)
    scene.units = "mm"
    copies: Counter[str] = Counter()
    for mount in assembly.mounts:
        part = assembly.by_name[mount.part]
        copies[part.name] += 1
        at = complex(mount.at)
        thick = part.thickness
        stands = placing(mount.angle, at, mount.z, thick, mount.flipped, mount.upright)
        graph.update(
            frame_from=mount.body,
            frame_to=f"{part.name}-{copies[part.name]}",
            matrix=_square(stands),
            geometry=part.name,
        )
    return scene


def _square(transform: Floats) -> Floats:
    """A (3, 4) transform as (4, 4)."""
    return np.vstack([transform, [0, 0, 0, 1]])
