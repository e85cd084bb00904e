"""`doublet edit-template OUT`: a page on this machine on which the user paints the invalid triangles of the template."""

from __future__ import annotations

import json
import webbrowser
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import numpy as np

from . import _doublet as d
from . import template_mask

PAGE = Path(__file__).parent / "data" / "edit_template.html"
HOST = "127.0.0.1"


def template_json(out: Path) -> bytes:
    """What the page shows: vertices (3 V) m, faces (3 F), the mask as it is and as suggested (F)."""
    mesh = d.read_mesh(out / "template.ply")
    suggested, mask = template_mask.read_suggestion(out), template_mask.read(out)
    if len(mask) != len(mesh.faces):
        raise RuntimeError(f"{out / 'template.ply'} has {len(mesh.faces)} triangles, its suggestion {len(mask)}")
    arrays = {
        "vertices": np.round(mesh.vertices, 6),
        "faces": mesh.faces,
        "valid": mask.astype(int),
        "suggested": suggested.astype(int),
    }
    return json.dumps({"name": str(out), **{k: v.ravel().tolist() for k, v in arrays.items()}}).encode()


def save_mask(out: Path, body: bytes) -> dict:
    """Writes the mask that the page sent; raises ValueError saying what is wrong with it."""
    try:
        values = json.loads(body)["face_valid"]
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError('expected {"face_valid": [...]}') from error
    if not isinstance(values, list) or not all(isinstance(v, int) for v in values):
        raise ValueError("expected a list of the integers 0 and 1")
    template_mask.write(out, values)
    return {"saved": str(out / template_mask.EDITED), "invalid": values.count(0)}


class Handler(BaseHTTPRequestHandler):
    def do_GET(self):
        if not self.is_local():
            return
        if self.path == "/":
            self.answer(200, "text/html; charset=utf-8", PAGE.read_bytes())
        elif self.path == "/template.json":
            self.answer(200, "application/json", self.server.template)
        else:
            self.answer(404, "text/plain", b"there is only / and /template.json\n")

    def do_POST(self):
        if not self.is_local():
            return
        length = int(self.headers.get("Content-Length") or 0)
        # A page from elsewhere cannot send this type without asking first, and is not answered.
        if self.path != "/mask" or self.headers.get("Content-Type") != "application/json" or length > self.server.largest_body:
            self.answer(400, "application/json", b'{"error": "expected a mask"}')
            return
        try:
            answer, status = save_mask(self.server.out, self.rfile.read(length)), 200
        except (ValueError, OSError) as error:
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


class Server(ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self, out: Path, port: int = 0):
        self.out = Path(out)
        for name in ("template.ply", template_mask.SUGGESTED):
            if not (self.out / name).exists():
                raise FileNotFoundError(f"{self.out / name} is missing; `doublet template SESSION -o {self.out}` writes it")
        self.template = template_json(self.out)
        self.largest_body = 1000 + 4 * len(template_mask.read_suggestion(self.out))
        super().__init__((HOST, port), Handler)

    @property
    def url(self) -> str:
        return f"http://{HOST}:{self.server_port}/"


def edit_template(out: Path, port: int = 0, browser: bool = True) -> None:
    """Serves the page until Ctrl-C."""
    with Server(out, port) as server:
        print(f"{server.url}  (Ctrl-C ends it)", flush=True)
        if browser:
            webbrowser.open(server.url)
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            print()
    edited = Path(out) / template_mask.EDITED
    print(f"{edited}: the next command on {out} uses it" if edited.exists() else "nothing saved; the suggestion stays")
