"""The server of the pages that edit a file: several that save at once, browsers that go away, ports."""

import json
import re
import socket
import struct
import threading
import time
import urllib.error
import urllib.request
from concurrent.futures import ThreadPoolExecutor

import pytest
from doublet.common.files import read_json, write_json
from doublet.pages.page_server import HOST, LocalPage


@pytest.fixture
def counting(tmp_path):
    """A page whose save adds one to a number in a file."""
    page, file = tmp_path / "page.html", tmp_path / "count.json"
    page.write_text('<!doctype html>\n<meta charset="utf-8">\n')
    write_json(file, 0)

    def save(body: bytes) -> dict:
        count = read_json(file) + json.loads(body)
        time.sleep(0.002)
        write_json(file, count)
        return {"count": count}

    with LocalPage(page, {"/large": ("text/plain", bytes(8 << 20))}, "/count", save, 100) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield server, file
        server.shutdown()
        thread.join()


def test_two_that_save_at_once_take_turns(counting):
    server, file = counting
    token = re.search('name="token" content="([^"]+)"', urllib.request.urlopen(server.url, timeout=30).read().decode())[1]
    headers = {"Content-Type": "application/json", "X-Page-Token": token}

    def post(_) -> int:
        try:
            return urllib.request.urlopen(urllib.request.Request(f"{server.url}count", b"1", headers), timeout=30).status
        except urllib.error.HTTPError as error:
            return error.code

    with ThreadPoolExecutor(4) as pool:
        assert set(pool.map(post, range(12))) == {200}
    assert read_json(file) == 12


def test_a_browser_that_goes_away_is_no_error(counting, capfd):
    server, _ = counting
    with socket.create_connection((HOST, server.server_port)) as client:
        client.sendall(f"GET /large HTTP/1.1\r\nHost: {HOST}:{server.server_port}\r\n\r\n".encode())
        client.recv(100)
        client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # reset
    time.sleep(0.3)
    assert urllib.request.urlopen(server.url, timeout=30).status == 200
    assert capfd.readouterr().err == ""


def test_a_port_that_cannot_be_had_is_named(counting, tmp_path):
    server, _ = counting
    with pytest.raises(OSError, match=f"Address already in use.*{HOST}:{server.server_port}"):
        LocalPage(tmp_path / "page.html", {}, "/count", dict, 100, server.server_port)
