"""G-code as a slicer would write it of a built folder's parts, for tests and for the net."""

from __future__ import annotations

import numpy as np
import shapely

from camgen.files.stl import read_stl
from camgen.geometry.mesh import slice_mesh
from camgen.judge.round_trip import pieces_of

# mm
WIDTH = 0.45
LAYER = 0.8


def pieces(folder, name, height):
    """Material of a part's solid at a height, as polygons."""
    mesh = read_stl(folder / f"{folder.name}-{name}.stl")
    shapes = pieces_of(slice_mesh(mesh, height))
    xy = lambda ring: np.column_stack([ring.points.real, ring.points.imag])  # noqa: E731
    return mesh.vertices[:, 2].max(), [
        shapely.Polygon(xy(s.outer), [xy(hole) for hole in s.holes]) for s in shapes
    ]


def laid(folder, names, change=lambda name, k, flat: flat, mirrored=(), start=5):
    """G-code of parts side by side, each turned otherwise: centre lines half a line inside the material; change: (part, layer,
    its material) -> what is laid."""
    lines = ["; perimeter_generator = arachne", "M83", f";WIDTH:{WIDTH}"]
    layers = {}
    for place, name in enumerate(names):
        top = pieces(folder, name, 0.5)[0]
        for k in range(round(top / LAYER)):
            z = (k + 0.5) * LAYER
            flats = pieces(folder, name, top - z if name in mirrored else z)[1]
            for flat in (change(name, k, flat) for flat in flats):
                if name in mirrored:
                    flat = shapely.affinity.scale(flat, -1, 1, origin=(0, 0))
                flat = shapely.affinity.rotate(flat, 37 * place + start, origin=(0, 0))
                inner = shapely.affinity.translate(flat, 100 * place, 40).buffer(
                    -WIDTH / 2, join_style="mitre", mitre_limit=3
                )
                layers.setdefault(k, []).extend([inner.exterior, *inner.interiors])
    for k, rings in sorted(layers.items()):
        lines.append(f"G1 Z{(k + 1) * LAYER:.3f}")
        for ring in rings:
            (x, y), *rest = ring.coords
            lines += [
                f"G1 X{x:.3f} Y{y:.3f}",
                ";TYPE:External perimeter",
                *(f"G1 X{x:.3f} Y{y:.3f} E.1" for x, y in rest),
            ]
    path = folder.parent / "plate.gcode"
    path.write_text("\n".join(lines))
    return path
