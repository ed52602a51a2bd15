"""`camgen watch` and `camgen explore`: a server on 127.0.0.1 until Ctrl-C."""

from __future__ import annotations

import os
import socket
import tempfile
import threading
import time
import webbrowser
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from camgen.bounds import bounded
from camgen.errors import FileError
from camgen.extras import install_line
from camgen.machines.sources import files_of
from camgen.reading import SPEC_FILE, read

if TYPE_CHECKING:
    from starlette.applications import Starlette

    from camgen.live.gallery import Gallery
    from camgen.live.server import LastBuild

    Say = Callable[[str], None]
    App = Callable[[str], Starlette]  # of the word in its address

_EVERY = 0.2  # s between two looks at the files


def explore(
    spec: Path | None,
    out: Path,
    port: int,
    browser: bool,
    say: Say,
    gallery: Gallery | None = None,
) -> None:
    """Serve the spec until Ctrl-C, a linkage to draw on, any other with sliders; without one an empty sheet or the gallery.

    gallery: specs with which a sheet may begin. FileError where the extra is missing or the port is taken.
    """
    _need()
    from camgen.live.board import Board
    from camgen.live.server import Explorer

    if spec is None or read(spec).get("mechanism") == "linkage":
        app = Board(spec, out, gallery).app
    else:
        app = Explorer(spec, out).app
    folder = Path() if spec is None else spec.parent
    _serve(app, port, folder if browser else None, say)


def watch(spec: Path, out: Path, port: int, browser: bool, say: Say) -> None:
    """Build the spec on each save and serve its report until Ctrl-C; errors as of `explore`."""
    _need()
    from camgen.live.server import LastBuild, watcher

    bounded(spec, SPEC_FILE)
    last_build = LastBuild(spec, out)
    beside = threading.Thread(target=rebuild, args=(last_build, say), daemon=True)
    _serve(
        lambda word: watcher(last_build, word), port, spec.parent if browser else None, say, beside
    )


def _need() -> None:
    try:
        import starlette
        import uvicorn  # noqa: F401
    except ImportError as error:
        raise FileError("a live page", f"needs {error.name}: {install_line('live')}") from None
    assert starlette


FileStates = dict[Path, tuple[int, int, int] | None]


def states_of(files: Sequence[Path]) -> FileStates:
    """Of each file the time of its last change, ns, its bytes and its number on the disc; None where it is not there."""
    states = FileStates()
    for file in files:
        try:
            status = os.stat(file)
        except (OSError, ValueError):
            states[file] = None
        else:
            states[file] = status.st_mtime_ns, status.st_size, status.st_ino
    return states


def rebuild(last_build: LastBuild, say: Say, stop: threading.Event | None = None) -> None:
    """Build at once, then each time a file that the spec is made of has changed and rests; an editor that replaces the spec is
    waited for."""
    stop = stop or threading.Event()
    files = files_of(last_build.spec)
    last = FileStates()
    before = FileStates()
    while not stop.is_set():
        now = states_of(files)
        if now != last and (not last or now == before and now[last_build.spec] is not None):
            files = files_of(last_build.spec)
            began = time.perf_counter()
            last = now = states_of(files)
            answer = last_build.build([])
            say(
                f"{time.strftime('%H:%M:%S')}  {answer['verdict']}  ({time.perf_counter() - began:.1f} s)"
            )
            for error in answer["errors"]:
                say(f"  {error}")
        before = now
        stop.wait(_EVERY)


def _serve(
    app: App, port: int, way: Path | None, say: Say, beside: threading.Thread | None = None
) -> None:
    """Serve an app until Ctrl-C. way: where the page is put that leads a browser to it; None where none is opened."""
    import uvicorn

    from camgen.live.guard import Few, word

    # by its protocol asyncio knows that answers must not wait for the other side's receipts, 40 ms each
    with socket.socket(proto=socket.IPPROTO_TCP) as place:
        if os.name == "posix":  # elsewhere another program could take the port, too
            place.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            place.bind(("127.0.0.1", port))
        except OSError as error:
            raise FileError(
                f"127.0.0.1:{port}", f"{error.strerror}; choose another --port"
            ) from None
        place.listen()  # who comes before the server stands waits for it
        secret = word()
        address = f"http://127.0.0.1:{place.getsockname()[1]}/{secret}/"
        say(f"{address}  (Ctrl-C ends it)")
        server = uvicorn.Server(
            uvicorn.Config(
                app(secret),
                http=Few,
                ws="none",
                log_level="error",
                access_log=False,
                timeout_graceful_shutdown=1,
            )
        )
        if beside is not None:
            beside.start()
        with ExitStack() as stack:
            if way is not None:
                page = stack.enter_context(_leading_to(address, way))
                threading.Thread(target=webbrowser.open, args=(page.as_uri(),), daemon=True).start()
            try:
                server.run(sockets=[place])
            except KeyboardInterrupt:
                say("")


@contextmanager
def _leading_to(address: str, folder: Path) -> Iterator[Path]:
    """A page that leads to the address and that this user alone can read: what a browser is started with is seen by all users.

    folder: where it is put if that can be; some browsers may not read the system's own folder for such files.
    """
    try:
        handle, name = tempfile.mkstemp(".html", ".camgen-", folder)
    except OSError:
        handle, name = tempfile.mkstemp(".html", "camgen-")
    page = Path(name).resolve()
    try:
        with open(handle, "w", encoding="utf-8", newline="\n") as file:
            file.write(
                f'<!DOCTYPE html><meta http-equiv="refresh" content="0; url={escape(address)}">\n'
            )
        yield page
    finally:
        page.unlink(missing_ok=True)
