"""Copies of parts in an assembly or on a plate: each is the part of its own file, moved as bodies are, where it belongs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from camgen import tolerances
from camgen.errors import counted
from camgen.files.formats import read_exact
from camgen.findings import Finding, at_most, in_file
from camgen.geometry.mesh import Mesh
from camgen.geometry.rings import Floats
from camgen.judge.round_trip import strange
from camgen.numerics import magnitude, product

Copies = Sequence[tuple[str, Floats]]  # names of parts, (3, 4) transforms


def judge_copies(
    path: Path, originals: Mapping[str, Mesh], places: Copies | None = None
) -> Finding:
    """ROUND_TRIP of a package that holds copies of parts: its solids are the originals, moved as bodies are and not deformed.

    places: the wanted name and (3, 4) transform of each copy, in any order; None where they may lie anywhere.
    """
    from camgen.files.threemf import read_3mf

    package = read_3mf(path)
    where = in_file(path)
    remarks = package.remarks
    remarks += [f"there is no part {name}" for name in sorted(set(package.meshes) - set(originals))]
    count = Counter(item.name for item in package.items)
    wanted_count = Counter(name for name, _ in places or ())
    if places is not None and count != wanted_count:
        remarks.append(f"{count.total()} copies instead of {wanted_count.total()}")
    for name, mesh in package.meshes.items():
        if name in originals and not np.array_equal(mesh.faces, originals[name].faces):
            remarks.append(f"the triangles of {name} are not those of its own file")
    turns = [(item.name, item.transform[:, :3]) for item in package.items]
    remarks += [
        f"a copy of {name} is mirrored or flat"
        for name, turn in turns
        if not np.linalg.det(turn) > 0
    ]
    if remarks:
        return strange(path, remarks)
    size = max(float(np.max(np.abs(mesh.vertices), initial=0.0)) for mesh in originals.values())
    shift = max((magnitude(item.transform) for item in package.items), default=0.0)
    limit = tolerances.TRANSFORM_ROUNDING * (size + shift)
    faults = [
        (
            magnitude(mesh.vertices - originals[name].vertices),
            f"{name} is not as in its own file",
        )
        for name, mesh in package.meshes.items()
    ]
    strains = ((magnitude(product(turn, turn.T) - np.eye(3)), name) for name, turn in turns)
    faults += [(off * size, f"a copy of {name} is deformed") for off, name in strains]
    if places is not None:
        copies = [(item.name, item.transform) for item in package.items]
        faults += [
            (off, f"a copy of {name} is out of its place") for off, name in _astray(copies, places)
        ]
    off, remark = max(faults, default=(0.0, ""))
    if off <= limit:
        remark = f"{counted(len(package.items), 'copy', 'copies')} of {counted(len(package.meshes), 'part')}, each the same as its own file"
    return at_most("ROUND_TRIP", off, limit, "mm", where, remark)


def judge_exact_copies(path: Path, files: Mapping[str, Path], places: Copies) -> Finding:
    """ROUND_TRIP of an assembly of exact solids: each is the one in its part's own file, every copy stands in its place.

    files: of each part; places: the wanted part and (3, 4) transform of each copy, in any order.
    """
    from camgen.files.step import read_step

    bodies, copies, remarks = read_step(path)
    where = in_file(path)
    faults = list[tuple[float, str]]()
    if sorted(bodies) != sorted(files) or Counter(copy.object for copy in copies) != Counter(
        name for name, _ in places
    ):
        content = f"{len(copies)} copies of {', '.join(sorted(bodies))}"
        remarks = [f"{content} instead of {len(places)} of {', '.join(sorted(files))}", *remarks]
    for name, file in files.items() if not remarks else ():
        original = read_exact(file, name)[0]
        body = bodies[name]
        if (original.corners.shape, original.edges, original.faces) != (
            body.corners.shape,
            body.edges,
            body.faces,
        ):
            remarks = [*remarks, f"the faces of {name} are not those of its own file"]
            continue
        faults.append(
            (
                magnitude(original.corners - body.corners),
                f"{name} is not as in its own file",
            )
        )
    if remarks:
        return strange(path, remarks)
    placements = [(copy.object, copy.transform) for copy in copies]
    faults += [
        (off, f"a copy of {name} is out of its place") for off, name in _astray(placements, places)
    ]
    off, remark = max(faults, default=(0.0, ""))
    if off <= tolerances.SAME_POINT:
        remark = f"{counted(len(copies), 'copy', 'copies')} of {counted(len(bodies), 'part')}, each the same as its own file"
    return at_most("ROUND_TRIP", off, tolerances.SAME_POINT, "mm", where, remark)


def _astray(copies: Copies, places: Copies) -> list[tuple[float, str]]:
    """How far each copy lies from the nearest place of its part, and each place from its nearest copy, as the largest difference
    of transforms, with the part's name: no copy astray, no place empty. There are as many of each part."""

    def nearest(name: str, at: Floats, others: Copies) -> float:
        return min(magnitude(at - place) for other, place in others if other == name)

    return [
        (nearest(name, at, others), name)
        for group, others in ((copies, places), (places, copies))
        for name, at in group
    ]
