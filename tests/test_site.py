"""The guide as a site: links hold, nothing comes from the network, the reference is whole."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

import pytest
from mkdocs.exceptions import Abort
from test_cli import run as run  # noqa: F401  a fixture

import camgen
from camgen import FileError, guide
from camgen.guide import site

PAGES = Path(guide.__file__).parent


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return site.write(tmp_path_factory.mktemp("site") / "guide").parent


@pytest.mark.long
def test_each_page_is_there_and_named_in_the_menu(made: Path) -> None:
    menu = (made / "index.html").read_text(encoding="utf-8")
    for name in (*guide.TOPICS, "notebook", "gallery", "api"):
        assert (
            f'href="{name}.html"' in menu.partition("<article")[0]
            and (made / f"{name}.html").exists()
        )


@pytest.mark.long
def test_the_first_page_shows_a_machine_and_lists_each_page_in_a_group(made: Path) -> None:
    page = (made / "index.html").read_text(encoding="utf-8").partition("<article")[2]
    assert 'src="walking-leg-moving.svg"' in page and "my-leg.toml" in page
    groups = page.partition('<h2 id="use"')[2]
    listed = re.findall(r'<li><a href="([\w-]+)\.html">', groups)
    assert sorted(listed) == sorted((*guide.TOPICS, "notebook", "api"))


@pytest.mark.long
def test_nothing_is_fetched_from_elsewhere(made: Path) -> None:
    text = "".join(page.read_text(encoding="utf-8") for page in made.glob("*.html"))
    sources = re.findall(r'<(?:script|img|link|iframe)\b[^>]*?(?:src|href)="([^"]+)"', text)
    assert len(sources) > 100
    assert not [each for each in sources if re.match(r"(https?:)?//", each)]


@pytest.mark.long
def test_the_reference_has_all_public_names(made: Path) -> None:
    text = (made / "api.html").read_text(encoding="utf-8")
    shown = {each.rpartition(".")[2] for each in re.findall(r'<h3 id="([\w.]+)"', text)}
    assert shown - {"Mechanism"} == set(camgen.__all__) - {"Play"}
    assert "Search for what a spec" in text  # camgen.design, not the wing of its name


@pytest.mark.long
def test_the_gallery_shows_each_picture(made: Path) -> None:
    text = (made / "gallery.html").read_text(encoding="utf-8")
    pictures = set(re.findall(r'src="(gallery-[\w-]+\.svg)"', text))
    assert pictures == {path.name for path in made.glob("gallery-*.svg")} and len(pictures) > 10


def test_links_of_the_pages_hold_where_the_site_is_not_made() -> None:
    for topic in guide.TOPICS:
        for link in re.findall(r"\]\(([^)#\s]+)[^)]*\)", guide.page(topic)):
            assert re.match("https?://", link) or (PAGES / link).exists(), (topic, link)


@pytest.mark.long
def test_a_dead_link_ends_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guide, "page", lambda topic: f"# {topic}\n\n[dead](nowhere.md)\n")
    with pytest.raises(Abort):
        site.write(tmp_path / "guide")


def test_a_folder_of_something_else_stays(run: Any, tmp_path: Path) -> None:  # noqa: F811
    (tmp_path / "letter.txt").write_text("mine", encoding="utf-8")
    code, _, err = run("guide", "--html", str(tmp_path))
    assert code == FileError.exit_code and "name another" in err
    assert [path.name for path in tmp_path.iterdir()] == ["letter.txt"]


def test_without_the_extra_it_says_what_to_install(
    run: Any,  # noqa: F811
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "material", None)
    code, _, err = run("guide", "--html", str(tmp_path / "guide"))
    assert code == FileError.exit_code and "[site]" in err
    assert run("guide", "first-cam", "--html")[0] == run("guide", "--reports")[0] == 2
