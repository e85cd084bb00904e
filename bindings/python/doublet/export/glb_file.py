"""A .glb as bytes: the text, and what lies behind it."""

from __future__ import annotations

import json
import struct

TEXT = 20  # where it begins
TEXT_KIND, BUFFER_KIND = 0x4E4F534A, 0x004E4942


def unpacked_glb(content: bytes) -> tuple[dict, bytes]:
    """The text, and the chunks behind it."""
    (length,) = struct.unpack_from("<I", content, 12)
    return json.loads(content[TEXT : TEXT + length]), content[TEXT + length :]


def packed_glb(gltf: dict, rest: bytes) -> bytes:
    text = json.dumps(gltf, separators=(",", ":"), ensure_ascii=False).encode()
    text += b" " * (-len(text) % 4)
    return struct.pack("<4sIIII", b"glTF", 2, TEXT + len(text) + len(rest), len(text), TEXT_KIND) + text + rest


def buffer_chunk(data: bytes) -> bytes:
    """Of whole words."""
    return struct.pack("<II", len(data), BUFFER_KIND) + data
