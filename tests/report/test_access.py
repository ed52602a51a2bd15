"""Every page by keyboard and by ear: names of what one acts on, heads of tables, landmarks, as axe-core asked once."""

from __future__ import annotations

from html.parser import HTMLParser
from importlib.resources import files

import pytest
from test_page import solid

from camgen.report.page import to_html

ACTS = {"button", "input", "select", "textarea", "canvas", "iframe", "summary"}
VOID = {"meta", "input", "br", "link", "img", "hr"}


class Access(HTMLParser):
    """What a page lacks, told as it is read."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.faults: list[str] = []
        self.mains = self.titles = 0
        self.named: set[str] = set()  # ids that a label is for
        self.nameless: list[tuple[str, str | None]] = []  # what has no name of its own, and its id
        self.open: list[
            tuple[str, dict[str, str | None], list[str], str]
        ] = []  # tag, attributes, text, where
        self.feed(text)
        self.faults += [
            f"{where}: no name"
            for where, own in self.nameless
            if own is None or own not in self.named
        ]
        self.faults += [f"{self.mains} main landmarks"] if self.mains != 1 else []
        self.faults += [f"{self.titles} first headings"] if self.titles != 1 else []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        own, where = dict(attrs), f"{tag} at line {self.getpos()[0]}"
        self.mains += tag == "main"
        self.titles += tag == "h1"
        if tag == "label" and own.get("for"):
            self.named.add(str(own["for"]))
        if tag == "html" and not own.get("lang"):
            self.faults.append(f"{where}: no language")
        if own.get("class") == "scroll" and not (
            own.get("tabindex") == "0" and own.get("role") and own.get("aria-label")
        ):
            self.faults.append(f"{where}: it scrolls and has no name or cannot be reached by keys")
        if tag in VOID:
            self.check(tag, own, "", where)
        else:
            self.open.append((tag, own, [], where))

    def handle_data(self, data: str) -> None:
        for _, _, text, _ in self.open:
            text.append(data)

    def handle_endtag(self, tag: str) -> None:
        while self.open:
            name, own, text, where = self.open.pop()
            self.check(name, own, "".join(text).strip(), where)
            if name == tag:
                return

    def check(self, tag: str, own: dict[str, str | None], text: str, where: str) -> None:
        named = (
            own.get("aria-label")
            or own.get("aria-labelledby")
            or (text and tag in ("button", "summary"))
        )
        named = (
            named
            or any(name == "label" for name, *_ in self.open)
            or own.get("aria-hidden") == "true"
        )
        if tag in ACTS and not named:
            self.nameless.append((where, own.get("id")))
        if tag == "th" and not text:
            self.faults.append(f"{where}: an empty head")
        if tag == "th" and own.get("scope") not in ("col", "row"):
            self.faults.append(f"{where}: a head of neither column nor row")
        if tag == "img" and "alt" not in own:
            self.faults.append(f"{where}: no words in its place")


def page(name: str) -> str:
    if name == "report":
        return to_html(solid())
    return files("camgen").joinpath(name).read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "name", ["report", "report/sweep.html", "live/explore.html", "live/watch.html"]
)
def test_page_can_be_used_by_keyboard_and_by_ear(name: str) -> None:
    assert Access(page(name)).faults == []


@pytest.mark.parametrize(
    ("was", "without", "fault"),
    [
        ("<main>", "<div>", "0 main landmarks"),
        ('<html lang="en">', "<html>", "no language"),
        ('class="scroll" tabindex="0"', 'class="scroll"', "cannot be reached by keys"),
        ('<th scope="col">', '<th scope="col"></th><th scope="col">', "an empty head"),
        ('<th scope="row">', "<th>", "of neither column nor row"),
        ("<h1>", "<h2>", "0 first headings"),
        ("</main>", "<button><svg></svg></button></main>", "no name"),
        ("</main>", '<input id="x"></main>', "no name"),
    ],
)
def test_what_is_lacking_is_seen(was: str, without: str, fault: str) -> None:
    whole = page("report")
    assert was in whole and any(
        fault in each for each in Access(whole.replace(was, without)).faults
    )
