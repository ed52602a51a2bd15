"""Solid of a cylinder cam's drum and the roller rolled in it, at several tolerances: time of a processor, triangles, error; and what
a vertex raised by 0.02 mm adds to the follower's play. Its rows are those of RESULTS.md."""

from __future__ import annotations

import time

import numpy as np

from camgen.geometry.drum_walls import DrumRoller, slide_path
from camgen.geometry.drums import Drum
from camgen.geometry.mesh import Mesh
from camgen.geometry.outlines import circle
from camgen.judge.rolled_drum import roll
from camgen.measuring.drum import read_roller
from camgen.motion.segments import SegmentTable, program
from camgen.parts.part import drum_part
from camgen.parts.solids import solid

ANGLES = 3600
RAISED = 0.02  # mm
ROLLER = read_roller("radius=5,length=7.3,inner=22")


def main() -> None:
    """Print the rows."""
    rise, back = (
        SegmentTable(kind=kind, span_deg=120, lift=15, law="cycloidal")
        for kind in ("rise", "return")
    )
    dwell = SegmentTable(kind="dwell", span_deg=60)
    motion = program([rise, dwell, back, SegmentTable(kind="dwell")])
    drum = Drum(30, 21.5, 55, "groove", slide_path(motion, 20), DrumRoller(5, 26))
    for tolerance in (1e-3, 1e-4):
        start = time.process_time()
        mesh = solid(drum_part("drum", "Drum", drum, circle(0j, 6)), tolerance)
        made = time.process_time()
        rolled = roll(mesh, ROLLER, 36, ANGLES)
        judged = time.process_time()
        error = np.abs(rolled.motion - 20 - motion(rolled.theta, 0)).max()
        print(
            f"| {tolerance:g} | {len(mesh.faces):,} | {made - start:.2f} | {judged - made:.1f} "
            f"| {error:.2g} | {np.abs(rolled.play).max():.2g} |"
        )
        if tolerance == 1e-3:
            seen = [
                np.abs(roll(each, ROLLER, 36, ANGLES).play - rolled.play).max()
                for each in raised(mesh)
            ]
            print(f"raised by {RAISED} mm: play changes by {min(seen):.4f} to {max(seen):.4f} mm")


def raised(mesh: Mesh) -> list[Mesh]:
    """Copies with one vertex of a wall, within the roller's length, raised along its normal."""
    normals = mesh.across / np.linalg.norm(mesh.across, axis=1)[:, None]
    walls = np.unique(mesh.faces[np.abs(normals[:, 2]) > 0.4])
    x, y, z = mesh.vertices[walls].T
    radius = np.hypot(x, y)
    walls = walls[(radius > 23) & (radius < 28.5) & (z > 1) & (z < 54)]
    copies = []
    for k in np.random.default_rng(0).choice(walls, 8, replace=False):
        vertices = mesh.vertices.copy()
        vertices[k] += RAISED * normals[np.flatnonzero((mesh.faces == k).any(axis=1))[0]]
        copies.append(Mesh(vertices, mesh.faces))
    return copies


if __name__ == "__main__":
    main()
