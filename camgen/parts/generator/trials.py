"""What mends a spec that cannot be made, tried on the spec itself: no change is said to mend it that does not."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from camgen.errors import CamgenError, DesignError, SpecError
from camgen.machine.run import Run
from camgen.parts.generator import cures
from camgen.parts.generator.changes import Change
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.stacking import attempts, first_choice, has_levels, refusal
from camgen.parts.level_rules import NoPassage
from camgen.parts.part import Part


def with_cures(
    refused: DesignError, layout: Layout, run: Run, parts: Callable[[Change], Sequence[Part]]
) -> DesignError:
    """The error with what mends it, as far as that is found.

    run: samples over the whole motion; parts: those of the spec with a change, DesignError or SpecError where it has none.
    """
    first = first_choice(layout, run)

    def makes(change: Change) -> bool:
        try:
            return has_levels(first.changed(change), run) and bool(parts(change))
        except (DesignError, SpecError):
            return False

    def why_not(change: Change) -> DesignError | None:
        return refusal(first.changed(change), run)

    return cures.with_cures(
        first, refused, makes, why_not, attempts(first) if isinstance(refused, NoPassage) else ()
    )


def tried(refused: CamgenError, layout: Layout, changes: Sequence[Change]) -> CamgenError:
    """The error with what was tried without success: all ways to lay the layout out, and these changes of its spec."""
    if not isinstance(refused, DesignError):
        return refused
    ways = attempts(layout) if isinstance(refused, NoPassage) else []
    words = ", ".join([*ways, *(change.words for change in changes)])
    if not words:
        return refused
    guess = "" if isinstance(refused, NoPassage) else refused.remedy
    return refused.mended("; ".join(filter(None, (guess, f"tried without success: {words}"))))
