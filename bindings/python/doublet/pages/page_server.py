"""Pages that edit a file, served on this machine to this machine alone."""

from __future__ import annotations

import json
import webbrowser
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from ..common.packaged import DATA

HOST = "127.0.0.1"
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
        length = int(self.headers.get("Content-Length") or 0)
        # A page from elsewhere cannot send this type without asking first, and is not answered.
        expected = self.path == self.server.saved_at and self.headers.get("Content-Type") == "application/json"
        if not expected or length > self.server.largest_body:
            answer = {"error": f"expected a {self.server.saved_at[1:]}"}
            self.answer(400, "application/json", json.dumps(answer).encode())
            return
        try:
            answer, status = self.server.save(self.rfile.read(length)), 200
        except (OSError, RuntimeError, ValueError) as error:
            answer, status = {"error": str(error)}, 400
        self.answer(status, "application/json", json.dumps(answer).encode())

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
        self.shown = {"/": ("text/html; charset=utf-8", page.read_bytes()), **shown}
        self.saved_at, self.save, self.largest_body = saved_at, save, largest_body
        super().__init__((HOST, port), Handler)

    @property
    def url(self) -> str:
        return f"http://{HOST}:{self.server_port}/"

    def run(self, browser: bool) -> None:
        """Until Ctrl-C."""
        print(f"{self.url}  (Ctrl-C ends it)", flush=True)
        if browser:
            webbrowser.open(self.url)
        try:
            self.serve_forever()
        except KeyboardInterrupt:
            print()
