"""What mends a spec that cannot be made, tried on the spec itself: no change is said to mend it that does not."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from camgen.errors import DesignError, SpecError
from camgen.machine.run import Run
from camgen.machines.linkage import cures
from camgen.machines.linkage.changes import Change
from camgen.machines.linkage.layout import Layout
from camgen.machines.linkage.stacking import lies, stroked, tried, unlaid
from camgen.parts.level_rules import Crowded
from camgen.parts.part import Part


def mended(refused: DesignError, layout: Layout, run: Run, parts: Callable[[Change], Sequence[Part]]) -> DesignError:
    """The error with what mends it, as far as that is found.

    run: samples over the whole motion; parts: those of the spec with a change, DesignError or SpecError where it has none.
    """
    first = stroked(layout, run)

    def makes(change: Change) -> bool:
        try:
            return lies(change.of(first), run) and bool(parts(change))
        except (DesignError, SpecError):
            return False

    def refusal(change: Change) -> DesignError | None:
        return unlaid(change.of(first), run)

    return cures.mended(first, refused, makes, refusal, tried(first) if isinstance(refused, Crowded) else ())
