"""Copies on sliced plates against the parts list: what is sliced is what a person prints."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from camgen.findings import Finding, NotJudged, Where, at_most


def judge_sliced_copies(
    copies: Counter[str], needed: Counter[str], plates: Mapping[str, Counter[str]], where: Where
) -> tuple[Finding, list[NotJudged]]:
    """ROUND_TRIP of how often each part is laid, by its name.

    wanted: the parts list; plates: what each plate of the folder holds, by its file. A plate of which more than half is laid
    counts as sliced, and must be there as a whole. Of the others, such as a part that is printed anew, nothing is asked.
    """
    rest = copies.copy()
    sliced = Counter[str]()
    others = []
    for name, content in sorted(
        plates.items(), key=lambda plate: -(plate[1] & copies).total() / plate[1].total()
    ):
        common = content & rest
        if 2 * common.total() > content.total():
            rest -= common
            sliced += content
        else:
            others.append(name)
    missing = sliced - copies
    surplus = copies - needed
    remarks = [f"too few for the parts list: {_listed(missing)}"] if missing else []
    remarks += [f"too many, as if sliced twice: {_listed(surplus)}"] if surplus else []
    finding = at_most(
        "COPIES",
        (missing + surplus).total(),
        0,
        "copies",
        where,
        "; ".join(remarks) or f"{copies.total()} copies on the plates that are sliced",
    )
    absent = needed - copies - missing
    if not absent:
        return finding, []
    why = f"copies that lie on none of these plates: {_listed(absent)}"
    return finding, [
        NotJudged("ROUND_TRIP", why, f"the G-code of {', '.join(sorted(others)) or 'all parts'}")
    ]


def _listed(parts: Counter[str]) -> str:
    return ", ".join(f"{count} of {name}" for name, count in sorted(parts.items()))
