"""A layout whose levels are found, by way of the stems of what slides and of the heads of the ground's pins."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

from camgen.errors import DesignError
from camgen.machine import model as m
from camgen.machine.run import Run
from camgen.machines.linkage.guides import STEMS
from camgen.machines.linkage.layout import Layout


def laid(layout: Layout, run: Run) -> Layout:
    """The layout with the strokes of its slots and slides, stems, heads and levels; run: samples over the whole motion.

    Stems are tried in their order, the first that leaves room for all counts. The ground's pins have their heads on top, or
    under the plate where that saves a level. DesignError of the first layout where none can be laid.
    """
    ways = {joint.name: run.length(joint.name)[0] for joint in run.machine.joints if isinstance(joint, m.Slot | m.Slide)}
    strokes = {name: (float(way.min()), float(way.max())) for name, way in ways.items()}
    tries = [
        replace(layout, strokes=strokes, stems=dict(zip(layout.slides, stems, strict=True)))
        for stems in product(*map(layout.stems_of, layout.slides))
    ]
    for explain in (False, True):
        refused: DesignError | None = None
        for tried in tries:
            try:
                found = [(each, each.levels(run, explain)) for each in (tried, replace(tried, sunk=True))]
            except DesignError as error:
                refused = refused or error
                continue
            best = min((pair for pair in found if pair[1]), key=lambda pair: max((pair[1] or {}).values()), default=None)
            if best is not None and best[1] is not None:
                return replace(best[0], given=best[1])
    assert refused is not None
    e, rails = refused, f", and rails {', '.join(STEMS)}" if len(tries) > 1 else ""
    remedy = f"{e.remedy}, heads over and under the plate{rails}"
    raise DesignError(e.quantity, e.value, e.limit, e.unit, e.where, remedy)
