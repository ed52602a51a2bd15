"""Which parts can be cut of a sheet."""

from __future__ import annotations

from camgen.parts.part import Part

_SAME = 1e-6  # mm, thicknesses that are one


def why_not(part: Part, thickness: float) -> str:
    """Why a part cannot be cut of a sheet of a thickness, mm; "" where it can."""
    if part.side_profile is not None:
        return "crossed: its outline changes with height"
    if part.drum is not None:
        return "a drum: its track goes round it"
    if part.process != "printed":
        return part.process
    if len({(layer.z0, layer.z1) for layer in part.layers}) > 1:
        return "stepped: its layers have different outlines"
    if len(part.layers) > 1:
        return "of separate pieces"
    if abs(part.thickness - thickness) > _SAME:
        return f"{part.thickness:g} mm thick, the sheet is {thickness:g}"
    return ""
