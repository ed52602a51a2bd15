"""A layout whose levels are found, by way of the stems of what slides."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

from camgen.errors import DesignError
from camgen.machine import model as m
from camgen.machine.run import Run
from camgen.machines.linkage.guides import STEMS
from camgen.machines.linkage.layout import Layout


def laid(layout: Layout, run: Run) -> Layout:
    """The layout with the strokes of its slots and slides, stems and levels; run: samples over the whole motion.

    Stems are tried in their order, the first that leaves room for all counts; DesignError of the first where none does.
    """
    ways = {joint.name: run.length(joint.name)[0] for joint in run.machine.joints if isinstance(joint, m.Slot | m.Slide)}
    strokes = {name: (float(way.min()), float(way.max())) for name, way in ways.items()}
    refused: DesignError | None = None
    for stems in product(STEMS, repeat=len(layout.slides)):
        tried = replace(layout, strokes=strokes, stems=dict(zip(layout.slides, stems, strict=True)))
        try:
            return replace(tried, given=tried.levels(run))
        except DesignError as error:
            refused = refused or error
    assert refused is not None
    raise refused
