"""What to type for a package that is not there: by the pip of the environment that runs, from where camgen came from."""

from __future__ import annotations

import json
import shutil
import sys
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit
from urllib.request import url2pathname


def install_line(extra: str) -> str:
    """What to type for an extra of camgen."""
    return pip_line(_requirement(extra))


def pip_line(requirement: str) -> str:
    """What to type for a package: `pip` where that is the environment's own, else its Python by its path."""
    first = shutil.which("pip")
    own = first is not None and Path(first).parent == Path(sys.executable).parent
    python = f'"{sys.executable}"' if " " in sys.executable else sys.executable
    quoted = f'"{requirement}"' if set(requirement) & set("[ ") else requirement
    return f"{'pip' if own else f'{python} -m pip'} install {quoted}"


def _requirement(extra: str) -> str:
    """camgen with an extra, from the folder, archive or repository that it was installed from.   [PEP 508, PEP 610]"""
    try:
        record: dict[str, Any] = json.loads(
            distribution("camgen").read_text("direct_url.json") or "{}"
        )
    except (PackageNotFoundError, ValueError):
        record = {}
    url = record.get("url", "")
    address = urlsplit(url)
    if "dir_info" in record and address.scheme == "file":
        return f"{url2pathname(address.path)}[{extra}]"
    if "archive_info" in record:
        return f"camgen[{extra}] @ {url}"
    if "vcs_info" in record:
        vcs = record["vcs_info"]
        return f"camgen[{extra}] @ {vcs['vcs']}+{url}@{vcs['commit_id']}"
    return f"camgen[{extra}]"
