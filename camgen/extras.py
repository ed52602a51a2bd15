"""How a reader gets an optional extra of this package: from where it was installed from."""

from __future__ import annotations

import json
from importlib.metadata import PackageNotFoundError, distribution
from urllib.parse import urlsplit
from urllib.request import url2pathname


def install_line(extra: str) -> str:
    """What to type for an extra; a package that was installed from a folder is named by it.   [PEP 610]"""
    return f'pip install "{_origin() or "camgen"}[{extra}]"'


def _origin() -> str:
    """The folder from which this package was installed; "" for one from an index."""
    try:
        record = json.loads(distribution("camgen").read_text("direct_url.json") or "{}")
    except (PackageNotFoundError, ValueError):
        return ""
    url = urlsplit(record.get("url", "")) if "dir_info" in record else None
    return url2pathname(url.path) if url is not None and url.scheme == "file" else ""
