"""Who may ask the pages of this machine: whoever was given their address, for a word of chance stands in it.

    word      of 32 bytes, anew each time, the first step of every path: other users of this machine do not know it
    host      the name by which this machine was asked: a foreign name may be given this machine's address (DNS rebinding)
    origin    the page that asks: a page of another site may send a browser's requests here; ours alone may change anything

What asks for too much, or says for too long nothing at all, is left.
"""

from __future__ import annotations

import asyncio
import re
import secrets

from starlette.datastructures import Headers, MutableHeaders
from starlette.exceptions import HTTPException
from starlette.responses import JSONResponse, PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from uvicorn.protocols.http.h11_impl import H11Protocol

_HERE = re.compile(r"(?:127\.0\.0\.1|localhost)(?::[0-9]{1,5})?", re.IGNORECASE)
_MOST = 100_000  # bytes that a page may send
_CONNECTIONS = 100  # at once; a browser opens six
_PATIENCE = 10.0  # s, until a connection has said what it wants
_HEADERS = {
    "Cross-Origin-Resource-Policy": "same-origin",
    "X-Frame-Options": "SAMEORIGIN",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
}


def word() -> str:
    """A word that nobody guesses."""
    return secrets.token_urlsafe(32)


class OnlyHere:
    """Lets in what asks for this machine by name and knows the word, and of what changes anything that which our pages send."""

    def __init__(self, app: ASGIApp, word: str) -> None:
        self.app = app
        self.word = word

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve a request, or refuse it."""
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
            return
        if scope["type"] != "http":
            await send({"type": "websocket.close", "code": 1008})
            return
        answering = _Answering(receive, send)
        refused = self._refusal(scope)
        if refused is not None:
            await refused(scope, answering.receive, answering.send)
            return
        try:
            await self.app(
                {**scope, "root_path": f"/{self.word}"}, answering.receive, answering.send
            )
        except Exception as error:  # a fault of ours is told, and does not fill the terminal
            if not answering.begun:
                said = [f"{type(error).__name__}: {error}; please report it with the spec"]
                fault = JSONResponse(
                    {"ok": False, "verdict": "internal error", "errors": said}, 500
                )
                await fault(scope, answering.receive, answering.send)

    def _refusal(self, scope: Scope) -> PlainTextResponse | None:
        """The answer to what is not let in."""
        headers = Headers(scope=scope)
        host = headers.get("host", "")
        length = headers.get("content-length", "0")
        first = scope["path"].removeprefix("/").partition("/")[0]
        if not _HERE.fullmatch(host):
            message = "this page is for this machine alone: its address is 127.0.0.1"
            status = 403
        elif not secrets.compare_digest(first.encode("utf-8", "replace"), self.word.encode()):
            message = "the address is another one: open the one that the terminal shows, which is new at each start"
            status = 403
        elif scope["method"] not in ("GET", "HEAD") and headers.get("origin") != f"http://{host}":
            message = "only a page of camgen itself may ask for this"
            status = 403
        elif not (
            length.isascii() and length.isdecimal() and len(length) < 10 and int(length) <= _MOST
        ):
            message = f"at most {_MOST} bytes"
            status = 413
        else:
            return None
        return PlainTextResponse(message, status, {"Connection": "close"})


class _Answering:
    """One request and its answer: no more than so many bytes are read, and every answer has our headers."""

    def __init__(self, receive: Receive, send: Send) -> None:
        self._receive = receive
        self._send = send
        self.read = 0
        self.begun = False

    async def receive(self) -> Message:
        """The next piece; a body in chunks does not say how long it is."""
        message = await self._receive()
        self.read += len(message.get("body", b""))
        if self.read > _MOST:
            raise HTTPException(413, f"at most {_MOST} bytes", {"Connection": "close"})
        return message

    async def send(self, message: Message) -> None:
        """A piece of the answer."""
        if message["type"] == "http.response.start":
            self.begun = True
            MutableHeaders(scope=message).update(_HEADERS)
        await self._send(message)


class Few(H11Protocol):
    """A connection of few, which says within some seconds what it wants."""

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Take it, unless there are too many."""
        super().connection_made(transport)
        if len(self.connections) > _CONNECTIONS:
            transport.abort()
        else:
            self.loop.call_later(_PATIENCE, self._leave_silent)

    def _leave_silent(self) -> None:
        if self.scope is None:
            self.transport.close()
