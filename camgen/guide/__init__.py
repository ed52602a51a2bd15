"""The guide: pages of Markdown beside this file, shown by `camgen guide` and `camgen explain`, readable on the forge as well."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from camgen.progress import Progress, silent

if TYPE_CHECKING:
    from camgen.machines.sources import Source

_PAGES = Path(__file__).parent

# The pages in the order in which one reads them.
TOPICS = (
    "first-cam",
    "laws",
    "own-linkage",
    "design",
    "sweeps",
    "printing",
    "laser",
    "servo",
    "simulation",
    "report",
    "findings",
    "python",
    "new-machine",
    "house",
    "theory-disc-cam",
    "theory-uniform-swing",
    "theory-eccentric-drive",
    "theory-thread-take-up",
    "theory-chain-stitch-looper",
    "theory-indexing-cam",
    "theory-linkage",
    "theory-dynamics",
    "theory-pairs",
    "theory-drums",
)


def page(topic: str) -> str:
    """Markdown of a page of TOPICS."""
    return (_PAGES / f"{topic}.md").read_text(encoding="utf-8")


def holding(word: str) -> list[str]:
    """Topics of the three pages that hold a word most often, with one of their headings above all; not within another word.

    Capitals and small letters are the same, and so are one thing and several.
    """
    form = re.compile(rf"\b{re.escape(word.removesuffix('s'))}s?\b", re.IGNORECASE)
    counts = {}
    for topic in TOPICS:
        text = page(topic)
        headings = "\n".join(line for line in text.splitlines() if line.startswith("#"))
        counts[topic] = len(form.findall(headings)), len(form.findall(text))
    found = [topic for topic in TOPICS if counts[topic][1]]
    return sorted(found, key=counts.__getitem__, reverse=True)[:3]


def in_terminal(topic: str) -> str:
    """The same where no picture can be seen: each says in words what it shows, and where its file is."""
    return re.sub(
        r"!\[(.*?)\]\((.*?\.svg)\)",
        lambda found: f"Picture: {found[1]}\n`{_PAGES / found[2]}`",
        page(topic),
    )


def title(topic: str) -> str:
    """Its first line."""
    return page(topic).partition("\n")[0].lstrip("# ")


def entries() -> dict[str, str]:
    """What is said of each code of a finding, as Markdown under its own head, in the order of the page."""
    parts = re.split(r"^## (?=[A-Z_]+$)", page("findings"), flags=re.MULTILINE)[1:]
    return {part.partition("\n")[0]: f"## {part.strip()}\n" for part in parts}


def laws() -> dict[str, str]:
    """What is said of each law of motion, as Markdown under its own head, in the order of the page."""
    parts = re.split(r"^## (?=[a-z0-9-]+$)", page("laws"), flags=re.MULTILINE)[1:]
    return {part.partition("\n")[0]: f"## {part.strip()}\n" for part in parts}


class Explanation(str):
    """What is said of codes, Markdown: a notebook lays it out."""

    def __repr__(self) -> str:
        """The text as it is."""
        return str(self)

    def _repr_markdown_(self) -> str:
        return str(self)


def explanation(
    code: str | None = None,
    spec: Source | None = None,
    settings: Sequence[str] = (),
    progress: Progress = silent,
) -> Explanation:
    """What a code means, its formula, where its limit comes from and what helps, or what a law is for; without one all codes, a line
    each.

    spec: in which it is explained as well, by its numbers and keys; settings: of its keys, as of `--set`.
    SpecError, with the nearest, for a code that there is none of, and for the spec.
    """
    known = entries()
    if code is None:
        return Explanation("\n".join(f"- `{name}` {in_short(known[name])}" for name in known))
    from camgen.motion.tasks import SYNONYMS

    law = laws().get(SYNONYMS.get(code, code))
    if law is not None:
        return Explanation(law)
    name = code.upper().replace("-", "_")
    if name not in known:
        from camgen.errors import SpecError, by_beginning
        from camgen.spec import unknown

        fault = unknown(("CODE",), name, known)
        fault = replace(fault, nearest=by_beginning(name, [*known]) or fault.nearest)
        if not fault.nearest:
            fault = unknown(("CODE",), code, laws())
        right = "a finding that 'camgen explain' lists, or a law of 'camgen list'"
        right += ", and the spec behind it" * code.endswith(".toml")
        fault = replace(fault, expected=right)
        raise SpecError([fault], "command line")
    if spec is None:
        return Explanation(known[name])
    from camgen.sweep.influence import influence_text

    return Explanation(f"{known[name]}\n{influence_text(spec, name, settings, progress)}")


def in_short(entry: str) -> str:
    """An entry's first sentence."""
    text = " ".join(entry.partition("\n")[2].partition("\n- ")[0].split())
    return re.split(r"(?<=[a-z0-9)])\. |: ", text, maxsplit=1)[0].rstrip(".")
