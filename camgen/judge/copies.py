"""Copies of parts in an assembly or on a plate: each is the part of its own file, moved as bodies are, where it belongs."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from camgen import tolerances
from camgen.errors import counted
from camgen.files.formats import read_exact
from camgen.findings import Finding, at_most
from camgen.geometry.mesh import Mesh
from camgen.geometry.rings import Floats
from camgen.judge.round_trip import strange
from camgen.numerics import product

Copies = Sequence[tuple[str, Floats]]  # names of parts, (3, 4) transforms


def judge_copies(path: Path, originals: Mapping[str, Mesh], places: Copies | None = None) -> Finding:
    """ROUND_TRIP of a package that holds copies of parts: its solids are the originals, moved as bodies are and not deformed.

    places: the wanted name and (3, 4) transform of each copy, in any order; None where they may lie anywhere.
    """
    from camgen.files.threemf import read_3mf

    package, where = read_3mf(path), path.name
    remarks = package.remarks
    remarks += [f"there is no part {name}" for name in sorted(set(package.meshes) - set(originals))]
    found, wanted = Counter(item.name for item in package.items), Counter(name for name, _ in places or ())
    if places is not None and found != wanted:
        remarks.append(f"{found.total()} copies instead of {wanted.total()}")
    if remarks:
        return strange(path, remarks)
    off = max((_unlike(mesh, originals[name]) for name, mesh in package.meshes.items()), default=0.0)
    reach = max(float(np.max(np.abs(mesh.vertices), initial=0.0)) for mesh in originals.values())
    far = max((float(np.max(np.abs(item.transform))) for item in package.items), default=0.0)
    for item in package.items:
        turn = item.transform[:, :3]
        bent = float(np.max(np.abs(product(turn, turn.T) - np.eye(3)))) if np.linalg.det(turn) > 0 else math.inf
        off = max(off, bent * reach)
    if places is not None:
        off = max(off, _astray([(item.name, item.transform) for item in package.items], places))
    limit = tolerances.TRANSFORM_ROUNDING * (reach + far)
    remark = f"{len(package.items)} copies of {counted(len(package.meshes), 'part')}, each as its own file has it"
    return at_most("ROUND_TRIP", off, limit, "mm", where, remark)


def judge_exact_copies(path: Path, files: Mapping[str, Path], places: Copies) -> Finding:
    """ROUND_TRIP of an assembly of exact solids: each is the one in its part's own file, every copy stands in its place.

    files: of each part; places: the wanted part and (3, 4) transform of each copy, in any order.
    """
    from camgen.files.step import read_step

    bodies, copies, remarks = read_step(path)
    where = path.name
    if sorted(bodies) != sorted(files) or len(copies) != len(places):
        held = f"{len(copies)} copies of {', '.join(sorted(bodies))}"
        remarks = [f"{held} instead of {len(places)} of {', '.join(sorted(files))}", *remarks]
    if remarks:
        return strange(path, remarks)
    off = 0.0
    for name, file in files.items():
        own, body = read_exact(file, name)[0], bodies[name]
        same = own.corners.shape == body.corners.shape and (own.edges, own.faces) == (body.edges, body.faces)
        off = max(off, float(np.max(np.abs(own.corners - body.corners))) if same else math.inf)
    off = max(off, _astray([(copy.object, copy.transform) for copy in copies], places))
    said = f"{len(copies)} copies of {counted(len(bodies), 'part')}, each as its own file has it"
    return at_most("ROUND_TRIP", off, tolerances.SAME_POINT, "mm", where, said)


def _astray(laid: Copies, places: Copies) -> float:
    """How far copies lie from the nearest place of their part, and places from their nearest copy, as the largest difference of
    transforms: no copy astray, no place empty."""

    def nearest(name: str, at: Floats, others: Copies) -> float:
        return min((float(np.max(np.abs(at - place))) for other, place in others if other == name), default=math.inf)

    return max((nearest(*each, others) for ones, others in ((laid, places), (places, laid)) for each in ones), default=0.0)


def _unlike(mesh: Mesh, original: Mesh) -> float:
    """Largest distance between the corners of two meshes that should be one, mm; inf where they are not of the same triangles."""
    if mesh.faces.shape != original.faces.shape or not np.array_equal(mesh.faces, original.faces):
        return math.inf
    return float(np.max(np.abs(mesh.vertices - original.vertices)))
