"""`camgen watch` and `camgen explore`: a server on 127.0.0.1 until Ctrl-C."""

from __future__ import annotations

import gc
import os
import socket
import threading
import time
import webbrowser
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from camgen.bounds import bounded
from camgen.errors import FileError
from camgen.reading import SPEC_FILE

if TYPE_CHECKING:
    from starlette.applications import Starlette

    from camgen.live.server import Built

    Say = Callable[[str], None]

_EVERY = 0.2  # s between two looks at the folder
_READ = (".toml", ".csv", ".txt", ".dxf")  # endings of files that a spec may be made of


def explore(spec: Path, out: Path, port: int, browser: bool, say: Say) -> None:
    """Serve the spec with sliders until Ctrl-C; FileError where the extra is missing or the port is taken."""
    _need()
    from camgen.live.server import Explorer

    _serve(Explorer(spec, out).app(), port, browser, say)


def watch(spec: Path, out: Path, port: int, browser: bool, say: Say) -> None:
    """Build the spec on each save and serve its report until Ctrl-C; errors as of `explore`."""
    _need()
    from camgen.live.server import Built, watcher

    bounded(spec, SPEC_FILE)
    built = Built(spec, out)
    _serve(watcher(built), port, browser, say, threading.Thread(target=rebuild, args=(built, say), daemon=True))


def _need() -> None:
    try:
        import starlette
        import uvicorn  # noqa: F401
    except ImportError as error:
        raise FileError("a live page", f"needs {error.name}: pip install 'camgen[live]'") from None
    assert starlette


def seen(spec: Path) -> dict[str, tuple[int, int]]:
    """What the spec's folder holds of files that it may be made of: name, (time of the last change, ns, bytes)."""
    found = {}
    for entry in os.scandir(spec.parent):
        if entry.name == spec.name or entry.name.lower().endswith(_READ) and not entry.name.startswith("."):
            try:
                status = entry.stat()
            except FileNotFoundError:  # an editor's file that went as we looked
                continue
            found[entry.name] = status.st_mtime_ns, status.st_size
    return found


def rebuild(built: Built, say: Say, ended: threading.Event | None = None) -> None:
    """Build at once, then each time the folder has changed and rests; an editor that replaces the file is waited for."""
    ended, last, before = ended or threading.Event(), None, None
    while not ended.is_set():
        now = seen(built.spec)
        if now != last and (last is None or now == before and built.spec.name in now):
            last, began = now, time.perf_counter()
            answer = built.build([])
            say(f"{time.strftime('%H:%M:%S')}  {answer['verdict']}  ({time.perf_counter() - began:.1f} s)")
            for error in answer["errors"]:
                say(f"  {error}")
        before = now
        ended.wait(_EVERY)


def _serve(app: Starlette, port: int, browser: bool, say: Say, beside: threading.Thread | None = None) -> None:
    import uvicorn

    gc.enable()  # a server runs long
    with socket.socket() as place:
        place.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            place.bind(("127.0.0.1", port))
        except OSError as error:
            raise FileError(f"127.0.0.1:{port}", f"{error.strerror}; choose another --port") from None
        address = f"http://127.0.0.1:{place.getsockname()[1]}/"
        say(f"{address}  (Ctrl-C ends it)")
        if beside is not None:
            beside.start()
        if browser:
            threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
        server = uvicorn.Server(uvicorn.Config(app, log_level="warning", access_log=False, timeout_graceful_shutdown=1))
        try:
            server.run(sockets=[place])
        except KeyboardInterrupt:
            say("")
