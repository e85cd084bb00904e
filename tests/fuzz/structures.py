"""Damage that keeps a file's form: values of another kind, levels without end, entries a thousand times, arrays that do not
belong together. What a parser takes, and a reader does not expect."""

from __future__ import annotations

import io
import json
import random
import re
import struct
import zipfile
from pathlib import Path

import numpy as np

DEPTHS = (2, 70, 2000, 100_000)
COUNTS = (2, 100, 20_000)
VALUES = (None, True, -1, 0, 1e308, "", "x", "nan", [], {}, [[]], [0, "a"], {"a": 1}, float("nan"), 2**70)


def places(value, at=()) -> list[tuple]:
    """The ways to all values inside."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [at] + [place for key, inner in items for place in places(inner, (*at, key))]


def change_json(value, rng: random.Random):
    """One value changed, left out, given many times or put many levels deep."""
    all_places = places(value)[1:]
    if not all_places:
        return rng.choice(VALUES)
    *way, last = rng.choice(all_places)
    parent = value
    for key in way:
        parent = parent[key]
    what = rng.randrange(5)
    if what == 0:
        del parent[last]
    elif what == 1:
        parent[last] = rng.choice(VALUES)
    elif what == 2:
        parent[last] = [parent[last]] * rng.choice(COUNTS)
    elif what == 3 and isinstance(parent, dict):
        parent.update({f"{last}_{i}": parent[last] for i in range(rng.choice(COUNTS))})
    else:
        other = rng.choice(all_places)
        inner = value
        for key in other:
            if not isinstance(inner, (dict, list)) or (isinstance(inner, list) and key >= len(inner)):
                break
            inner = inner[key] if not isinstance(inner, dict) else inner.get(key)
        parent[last] = json.loads(json.dumps(inner))
    return value


def nested(text: str, rng: random.Random, pairs=(("[", "]"), ('{"a":', "}"))) -> str:
    """A number inside of brackets inside of brackets."""
    found = list(re.finditer(r"-?\d+(\.\d+)?", text))
    begin, end = rng.choice(found).span() if found else (0, 0)
    opening, closing = rng.choice(pairs)
    depth = rng.choice(DEPTHS)
    return text[:begin] + opening * depth + text[begin:end] + closing * (depth if rng.random() < 0.7 else 0) + text[end:]


def damage_json(data: bytes, rng: random.Random) -> bytes:
    if rng.random() < 0.3:
        return nested(data.decode(), rng).encode()
    return json.dumps(change_json(json.loads(data), rng)).encode()


def damage_glb(data: bytes, rng: random.Random) -> bytes:
    size = struct.unpack("<I", data[12:16])[0]
    text, binary = damage_json(data[20 : 20 + size].strip(), rng), data[28 + size :]
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def damage_lines(data: bytes, rng: random.Random) -> bytes:
    """Lines given many times, left out, or put elsewhere; other ends; words of another kind."""
    lines = data.split(b"\n")
    begin = rng.randrange(len(lines))
    block = lines[begin : begin + rng.choice((1, 1, 3, 8, 30))]
    what = rng.randrange(6)
    if what == 0:
        lines[begin:begin] = block * rng.choice(COUNTS)
    elif what == 1:
        del lines[begin : begin + len(block)]
    elif what == 2:
        at = rng.randrange(len(lines))
        lines[at:at] = block
    elif what == 3:
        lines[begin] = lines[begin].lstrip() if rng.random() < 0.5 else b" " * rng.choice((1, 300)) + lines[begin]
    elif what == 4:
        words = lines[begin].split(b" ")
        words[rng.randrange(len(words))] = rng.choice((b"nan", b"x", b"-", b"1e999", b"", b"{", b"}", b"1,5", b"#"))
        lines[begin] = b" ".join(words)
    else:
        return rng.choice((b"\xef\xbb\xbf" + data, data.replace(b"\n", b"\r"), data.decode("latin-1").encode("utf-16")))
    return b"\n".join(lines)


def damage_yaml(data: bytes, rng: random.Random) -> bytes:
    what = rng.random()
    if what < 0.3:
        return nested(data.decode(), rng, (("[", "]"), ("{ a: ", "}"), ("- ", ""))).encode()
    if what < 0.4:
        return data.replace(b"!!opencv-matrix", rng.choice((b"!!binary |", b"!!str", b"!!map", b"!!seq")), 1)
    return damage_lines(data, rng)


def damage_toml(data: bytes, rng: random.Random) -> bytes:
    what, depth = rng.random(), rng.choice(DEPTHS)
    if what < 0.2:
        return nested(data.decode(), rng, (("[", "]"), ("{a=", "}"))).encode()
    if what < 0.3:
        return data + b"\n" + b".".join([b"a"] * depth) + b" = 1\n"
    if what < 0.4:
        return data + b"\n[" + b".".join([b"a"] * depth) + b"]\n"
    return damage_lines(data, rng)


def damage_xml(data: bytes, rng: random.Random) -> bytes:
    """Elements nested, given many times, left out; lines as elsewhere."""
    found = list(re.finditer(rb"<(\w+)[^<>/]*/?>", data))
    if not found or rng.random() < 0.3:
        return damage_lines(data, rng)
    match = rng.choice(found)
    name, what = match[1], rng.randrange(3)
    if what == 0:
        depth = rng.choice(DEPTHS)
        return data[: match.start()] + (b"<" + name + b">") * depth + (b"</" + name + b">") * depth + data[match.start() :]
    if what == 1:
        return data[: match.start()] + data[match.end() :]
    end = data.find(b"</" + name + b">", match.end())
    element = data[match.start() : end + len(name) + 3] if end > 0 else match[0]
    return data[: match.start()] + element * rng.choice(COUNTS[:2]) + data[match.start() :]


def damage_bvh(data: bytes, rng: random.Random) -> bytes:
    if rng.random() < 0.7:
        return damage_lines(data, rng)
    depth = rng.choice(DEPTHS)
    joint = b"JOINT a\n{\nOFFSET 0 1 0\nCHANNELS 0\n"
    at = data.index(b"CHANNELS")
    at = data.index(b"\n", at) + 1
    return data[:at] + joint * depth + b"End Site\n{\nOFFSET 0 1 0\n}\n" + b"}\n" * depth + data[at:]


# --- arrays


def damage_array(array: np.ndarray, others: list[np.ndarray], rng: random.Random) -> np.ndarray:
    random_ = np.random.default_rng(rng.randrange(2**32))
    what = rng.randrange(9)
    if what == 0:
        return rng.choice(others)
    if what == 1:
        return (
            array.astype(rng.choice(["f4", "f8", "i4", "i8", "u1", "U3"]))
            if array.dtype.kind in "fiub"
            else np.atleast_1d(array)[:0]
        )
    if what == 2:
        return array.T
    if what == 3 and array.ndim:
        return np.repeat(array, 2, axis=0)
    if what == 4 and array.ndim:
        return array[random_.permutation(len(array))]
    if what == 5 and array.ndim:
        return array[: rng.randrange(len(array) + 1)]
    if what == 6:
        most = (100 << 20) // max(array.itemsize * int(np.prod(array.shape[1:])), 1)  # this takes memory, too
        return np.zeros((min(rng.choice((0, 1, 3, 2_000_000)), most), *array.shape[1:]), array.dtype)
    changed = array.copy()
    if changed.size and changed.dtype.kind in "fiu":
        # Rows as others are: faces twice, vertices at one place.
        chosen = random_.integers(0, len(np.atleast_1d(changed)), 3)
        if changed.ndim and what == 7:
            changed[chosen] = changed[random_.integers(0, len(changed), 3)]
        else:
            changed.reshape(-1)[random_.integers(0, changed.size)] = rng.choice((0, 1, -1 if changed.dtype.kind != "u" else 2, 9))
    return changed


def damage_npz(data: bytes, rng: random.Random) -> bytes:
    with np.load(io.BytesIO(data)) as file:
        arrays = {name: file[name] for name in file}
    name = rng.choice(list(arrays))
    what = rng.random()
    if what < 0.1:
        arrays["unknown"] = np.zeros(rng.choice((1, 40_000_000)))
    elif what < 0.15:
        del arrays[name]
    else:
        arrays[name] = damage_array(arrays[name], list(arrays.values()), rng)
    out = io.BytesIO()
    np.savez_compressed(out, **arrays)
    return out.getvalue()


def damage_stored(data: bytes, rng: random.Random) -> bytes:
    """The same arrays as another archive: stored, twice, with a folder, or with a comment in front."""
    out = io.BytesIO(rng.choice((b"", b"#!comment\n")))
    out.seek(0, io.SEEK_END)
    with zipfile.ZipFile(io.BytesIO(data)) as archive, zipfile.ZipFile(out, "a", zipfile.ZIP_STORED) as copy:
        for name in archive.namelist():
            copy.writestr(rng.choice((name, name, name, "folder/" + name)), archive.read(name))
    return out.getvalue()


KINDS = {
    ".json": damage_json, ".glb": damage_glb, ".yml": damage_yaml, ".toml": damage_toml, ".xml": damage_xml, ".bvh": damage_bvh,
    ".npz": lambda data, rng: (damage_npz if rng.random() < 0.9 else damage_stored)(data, rng),
}  # fmt: skip
TEXTS = {".asf", ".amc", ".obj", ".off"}


def structural(path: Path, data: bytes):
    """damage(data, rng) of a file by what it holds; None if nothing is known of it."""
    if path.suffix == ".txt" and data.lstrip().startswith(b"<"):
        return damage_xml
    if path.suffix in TEXTS or (path.suffix in {".txt", ".ply", ".stl"} and b"\0" not in data):
        return damage_lines
    return KINDS.get(path.suffix)
