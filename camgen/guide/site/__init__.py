"""The guide as a site: its pages, the notebook, a gallery and a reference of the Python API; made by MkDocs."""

from __future__ import annotations

import json
import os
import re
import shutil
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import camgen
from camgen import guide, starters
from camgen.errors import FileError, file_errors
from camgen.extras import install_line
from camgen.machines import MECHANISMS

_HERE = Path(__file__).parent
_PAGES = _HERE.parent
_MARK = "objects.inv"  # the index of names that each such site has
_TYPES = {
    "machine": ("camgen.machines.mechanism.Mechanism",),
    "motion and forces": ("camgen.machine.run.Run", "camgen.machine.forces.Forces"),
    "report": ("camgen.report.report.Report", "camgen.findings.Finding"),
    "sweeps and designs": ("camgen.sweep.results.SweepTable", "camgen.design.run.DesignResult"),
    "errors": tuple(
        f"camgen.errors.{name}"
        for name in (
            "CamgenError",
            "SpecError",
            "ArgumentError",
            "DesignError",
            "FileError",
            "Fault",
        )
    ),
}
_OTHERS = {
    "notebook": "A notebook",
    "api": "Python API",
}  # pages that the guide in a terminal has not
_FIRST = "walking-leg-moving"  # the picture of the first page
_LIST = re.compile(r"\s*([-*]|\d+\.) ")


def write(folder: Path, reports: bool = False) -> Path:
    """Write the site into a folder, new or of an earlier site; its first page.

    reports: build each machine of the gallery and link the page of its report.
    FileError where MkDocs is missing, or where the folder holds something else.
    """
    try:
        import material  # noqa: F401
        import mkdocstrings  # noqa: F401
        from mkdocs.commands.build import build
        from mkdocs.config import load_config
    except ImportError as error:
        needed = f"needs {error.name}: {install_line('site')}"
        raise FileError("the guide as a site", needed) from None
    with file_errors():
        if folder.exists() and any(folder.iterdir()) and not (folder / _MARK).exists():
            raise FileError(folder, "is not empty and holds no site of this guide: name another")
        with tempfile.TemporaryDirectory() as made:
            pages = Path(made)
            settings: dict[str, Any] = {"docs_dir": made, "site_dir": str(folder.absolute())}
            os.environ.setdefault("NO_MKDOCS_2_WARNING", "1")  # Material's, of a version to come
            config = load_config(str(_HERE / "mkdocs.yml"), strict=True, **settings)
            _write_pages(pages, config.nav or (), reports)
            build(config)
    return folder / "index.html"


def _write_pages(folder: Path, menu: Sequence[Mapping[str, Any] | str], reports: bool) -> None:
    """Write what MkDocs reads: Markdown, pictures and style."""
    for path in (*_PAGES.glob("*.svg"), _HERE / "site.css", _HERE / "iframe-worker.js"):
        shutil.copy(path, folder)
    shutil.copy(starters.pictures() / f"{_FIRST}.svg", folder)
    texts = {topic: guide.page(topic) for topic in guide.TOPICS}
    texts["notebook"] = _notebook()
    texts["index"] = _index(menu)
    texts["gallery"] = _gallery(folder, reports)
    texts["api"] = _api()
    for name, text in texts.items():
        text = _spaced(text.replace("(python.ipynb)", "(notebook.md)"))
        (folder / f"{name}.md").write_text(text, encoding="utf-8", newline="\n")


def _spaced(text: str) -> str:
    """The same with a blank line before each list: Python-Markdown sees none without it, forges do."""
    lines: list[str] = []
    fenced = False
    for line in text.splitlines():
        before = lines[-1] if lines else ""
        follows = before.strip() and not _LIST.match(before) and not before.startswith(" ")
        if not fenced and follows and _LIST.match(line):
            lines.append("")
        fenced ^= line.startswith("```")
        lines.append(line)
    return "\n".join(lines) + "\n"


def _index(menu: Sequence[Mapping[str, Any] | str]) -> str:
    """The first page: what camgen is, a picture, how to begin, and all pages by the groups of the menu."""
    about = (camgen.__doc__ or "").partition("\n")[0].partition(": ")[2]
    groups = [
        (title, names) for each in menu if isinstance(each, dict) for title, names in each.items()
    ]
    listed = [
        f"## {title}\n\n" + "\n".join(f"- [{_title(name)}]({name})" for name in names)
        for title, names in groups
        if not isinstance(names, str)
    ]
    return "\n\n".join(
        [
            f"# camgen\n\n{about[0].upper()}{about[1:]} Version {camgen.__version__}.",
            f"![Jansen's walking leg, made and moved by camgen]({_FIRST}.svg)",
            "```sh\ncamgen new walking-leg my-leg.toml\ncamgen build my-leg.toml\n```",
            "New here? Begin with [your first cam](first-cam.md), or look at the [gallery](gallery.md).",
            *listed,
        ]
    )


def _title(file: str) -> str:
    """Of a page of the menu, by its first line; a reference and a notebook have their own."""
    topic = file.removesuffix(".md")
    return guide.title(topic) if topic in guide.TOPICS else _OTHERS[topic]


def _notebook() -> str:
    """The notebook as Markdown, its cells as they are before a run."""
    cells = json.loads((_PAGES / "python.ipynb").read_text(encoding="utf-8"))["cells"]
    texts = [(cell["cell_type"], "".join(cell["source"])) for cell in cells]
    return "\n\n".join(
        f"```python\n{text}\n```" if kind == "code" else text for kind, text in texts
    )


def _gallery(folder: Path, reports: bool) -> str:
    """A picture of each machine that has one, what it is and how to make it."""
    entries = ["# Gallery"]
    pictures = starters.pictures()
    alone = {*MECHANISMS, *starters.examples()}
    for picture in sorted(pictures.glob("*.svg")):
        name = picture.stem
        if not any(starters.folder().rglob(f"{name}.toml")):
            continue
        shutil.copy(picture, folder / f"gallery-{picture.name}")
        title, _, about = starters.summary(name).partition(": ")
        make = f"camgen new {name} {name}.toml\ncamgen build {name}.toml"
        if name not in alone:
            make = f"camgen build specs/{name}.toml  # in a checkout"
        entries += [f"## {name}", f"{title}: {about}" if about else title]
        entries += [f"![{name}](gallery-{picture.name})"]
        entries += [_report(name, folder)] if reports else []
        entries += [f"```sh\n{make}\n```"]
    return "\n\n".join(entries)


def _report(name: str, folder: Path) -> str:
    """A link to the page of a machine's report, which is made."""
    (spec,) = starters.folder().rglob(f"{name}.toml")
    with tempfile.TemporaryDirectory() as made:
        camgen.build(spec, made, only=("dxf", "stl", "report"))
        (page,) = Path(made).rglob("report.html")
        shutil.copy(page, folder / f"report-{name}.html")
    return f"[Its report, in motion](report-{name}.html)"


def _api() -> str:
    """The reference: all public names, from their docstrings."""
    about = "`import camgen` is enough. Lengths are mm and angles rad. [From Python](python.md) has examples."
    parts = ["# Python API", about, "## Functions"]
    parts += [f"::: camgen.{name}_" for name in camgen.__all__ if name.islower()]
    for title, names in _TYPES.items():
        parts.append(f"## {title.capitalize()}")
        parts += [f"::: {name}" for name in names]
    return "\n\n".join(parts)
