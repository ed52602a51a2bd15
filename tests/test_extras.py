"""What to type for an optional extra works from where the package came from."""

from __future__ import annotations

import json
from types import SimpleNamespace

import pytest

from camgen import extras


@pytest.mark.parametrize(
    "record, line",
    [
        ({"url": "file:///home/a%20b/camgen", "dir_info": {}}, '"/home/a b/camgen[live]"'),
        ({"url": "file:///x/camgen.whl", "archive_info": {}}, '"camgen[live]"'),
        ({"url": "https://example.org/camgen.git", "vcs_info": {}}, '"camgen[live]"'),
        (None, '"camgen[live]"'),
    ],
)
def test_an_extra_comes_from_where_the_package_came_from(
    record: object, line: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = None if record is None else json.dumps(record)
    found = SimpleNamespace(read_text=lambda name: text)
    monkeypatch.setattr(extras, "distribution", lambda name: found)
    assert extras.install_line("live") == f"pip install {line}"
