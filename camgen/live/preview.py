"""A variant of a spec as the report's own page, by what needs no file: closed-form limits, figures, curves, moving picture."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from camgen.errors import DesignError, SpecError
from camgen.machines.sources import changed
from camgen.pipeline.curves import as_designed
from camgen.pipeline.shown import animation
from camgen.reading import Data
from camgen.report.page import to_html
from camgen.report.report import Report
from camgen.study import Study


def preview(
    data: Data, source: str, folder: Path, settings: Sequence[str], quick: bool = False
) -> dict[str, Any]:
    """What the variant is: ok, its verdict, its page, and s it took; of one that cannot be made or is no spec, the reasons.

    quick: without the study, which may take seconds: verdict, limits and parts in motion, but no curves and sketches.
    """
    began = time.perf_counter()
    try:
        mechanism = changed(data, source, folder, settings)
        findings = mechanism.forecast()
        study = Study() if quick else mechanism.study()
        plots = [] if quick else [*as_designed(mechanism), *study.plots]
        shown = animation(mechanism, study.sketches)
    except SpecError as error:
        return failure("no valid spec", [str(fault) for fault in error.faults])
    except DesignError as error:
        return failure("cannot be made", [str(error)])
    report = Report(
        mechanism.name,
        mechanism.mechanism,
        findings,
        study.numbers,
        plots=plots,
        notes=study.notes,
        animation=shown,
        not_judged=mechanism.assembly.unjudged,
    )
    page = to_html(report)
    return {
        "ok": report.ok,
        "verdict": report.verdict,
        "errors": [],
        "page": page,
        "s": time.perf_counter() - began,
    }


def failure(verdict: str, errors: Sequence[str]) -> dict[str, Any]:
    """The answer where there is no machine to show."""
    return {"ok": False, "verdict": verdict, "errors": list(errors)}
