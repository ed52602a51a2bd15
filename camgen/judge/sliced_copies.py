"""Copies on sliced plates against the list of parts: what is sliced is what a person prints."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from camgen.findings import Finding, NotJudged, Where, at_most


def judge_sliced_copies(
    laid: Counter[str], wanted: Counter[str], plates: Mapping[str, Counter[str]], where: Where
) -> tuple[Finding, list[NotJudged]]:
    """ROUND_TRIP of how often each part is laid, by its name.

    wanted: the list of parts; plates: what each plate of the folder holds, by its file. A plate of which more than half is laid
    counts as sliced, and must be there as a whole. Of the others, such as a part that is printed anew, nothing is asked.
    """
    left, sliced, others = laid.copy(), Counter[str](), []
    for name, held in sorted(
        plates.items(), key=lambda plate: -(plate[1] & laid).total() / plate[1].total()
    ):
        found = held & left
        if 2 * found.total() > held.total():
            left -= found
            sliced += held
        else:
            others.append(name)
    lacking, beyond = sliced - laid, laid - wanted
    said = [f"too few for the list of parts: {_listed(lacking)}"] if lacking else []
    said += [f"too many, as if sliced twice: {_listed(beyond)}"] if beyond else []
    finding = at_most(
        "ROUND_TRIP",
        (lacking + beyond).total(),
        0,
        "copies",
        where,
        "; ".join(said) or f"{laid.total()} copies on the plates that are sliced",
    )
    absent = wanted - laid - lacking
    if not absent:
        return finding, []
    why = f"copies that lie on none of these plates: {_listed(absent)}"
    return finding, [
        NotJudged("ROUND_TRIP", why, f"the G-code of {', '.join(sorted(others)) or 'all parts'}")
    ]


def _listed(parts: Counter[str]) -> str:
    return ", ".join(f"{count} of {name}" for name, count in sorted(parts.items()))
