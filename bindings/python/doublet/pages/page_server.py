"""Pages that edit a file, served on this machine to this machine alone."""

from __future__ import annotations

import json
import re
import secrets
import sys
import threading
import webbrowser
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from ..common.packaged import DATA

HOST = "127.0.0.1"
TOKEN_HEADER = "X-Page-Token"
LENGTH = re.compile("[0-9]{1,12}")
SURFACE_PAGE = DATA / "surface_page.js"


def surface_page() -> dict[str, tuple[str, bytes]]:
    """What a page on which a user paints on a surface needs besides itself: LocalPage(shown={**surface_page(), ...})."""
    return {"/surface_page.js": ("text/javascript; charset=utf-8", SURFACE_PAGE.read_bytes())}


class Handler(BaseHTTPRequestHandler):
    def do_GET(self):
        if not self.is_local():
            return
        shown = self.server.shown
        if self.path in shown:
            self.answer(200, *shown[self.path])
        else:
            self.answer(404, "text/plain", f"there is only {' and '.join(shown)}\n".encode())

    def do_POST(self):
        if not self.is_local():
            return
        if not secrets.compare_digest(self.headers.get(TOKEN_HEADER, "").encode(), self.server.token.encode()):
            self.refuse(403, "expected the token of the page: reload it")
            return
        length = self.headers.get("Content-Length", "")
        expected = self.path == self.server.saved_at and self.headers.get("Content-Type") == "application/json"
        if not (expected and LENGTH.fullmatch(length) and int(length) <= self.server.largest_body):
            self.refuse(400, f"expected a {self.server.saved_at[1:]} of at most {self.server.largest_body} bytes")
            return
        try:
            body = self.rfile.read(int(length))
            with self.server.saving:  # of two tabs: it reads the file, changes and writes it
                saved = self.server.save(body)
        except (OSError, RuntimeError, ValueError) as error:
            self.refuse(400, str(error))
            return
        self.answer(200, "application/json", json.dumps(saved).encode())

    def refuse(self, status: int, error: str) -> None:
        self.answer(status, "application/json", json.dumps({"error": error}).encode())

    def is_local(self) -> bool:
        """Refuses names that somebody made to point here."""
        if self.headers.get("Host") == f"{HOST}:{self.server.server_port}":
            return True
        self.answer(403, "text/plain", b"only by the address that was printed\n")
        return False

    def answer(self, status: int, kind: str, body: bytes) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *args):
        """Quiet: the page tells the user."""


def with_token(page: bytes, token: str) -> bytes:
    """The page, knowing the token that it has to send with what it saves."""
    charset = b'<meta charset="utf-8">'
    return page.replace(charset, charset + f'\n<meta name="token" content="{token}">'.encode(), 1)


class LocalPage(ThreadingHTTPServer):
    """shown: path -> (content type, bytes). What the page posts to `saved_at` as JSON of at most `largest_body` bytes goes to
    save(), which returns the answer, or raises ValueError, OSError or RuntimeError saying what
    is wrong."""

    daemon_threads = True

    def __init__(
        self,
        page: Path,
        shown: dict[str, tuple[str, bytes]],
        saved_at: str,
        save: Callable[[bytes], dict],
        largest_body: int,
        port: int = 0,
    ):
        self.token = secrets.token_urlsafe(16)  # a page from elsewhere cannot read it, and so cannot save
        self.shown = {"/": ("text/html; charset=utf-8", with_token(page.read_bytes(), self.token)), **shown}
        self.saved_at, self.save, self.largest_body = saved_at, save, largest_body
        self.saving = threading.Lock()
        try:
            super().__init__((HOST, port), Handler)
        except OSError as error:
            raise OSError(error.errno, f"no page can be served here: {error.strerror}", f"{HOST}:{port}") from error

    @property
    def url(self) -> str:
        return f"http://{HOST}:{self.server_port}/"

    def handle_error(self, request, client_address) -> None:
        """A browser may go away in the middle of an answer."""
        if not isinstance(sys.exc_info()[1], ConnectionError):
            super().handle_error(request, client_address)

    def run(self, browser: bool) -> None:
        """Until Ctrl-C."""
        print(f"{self.url}  (Ctrl-C ends it)", flush=True)
        if browser:
            webbrowser.open(self.url)
        try:
            self.serve_forever()
        except KeyboardInterrupt:
            print()
