"""Reads damaged files by the thousand: python tests/fuzz/mutate.py [--count N] [--formats ply glb ...] [--seed N] [--keep DIR]

Small valid files are damaged (bits, bytes, cuts, insertions, numbers in text; arrays inside their archive, JSON inside its
GLB; half of them in their structure, see structures.py) and read in a child process with
768 MiB of address space more than it starts with and 10 s a file. What a reader does:

    read     it took it
    refused  it raised FileNotFoundError, ValueError or RuntimeError, in one short line that names the file
    unclear  it raised one of these, but the line is long, or does not name the file
    wrong    it raised anything else: MemoryError, KeyError, ...
    crash    the child died, or took too long

Prints a line a format, and every crash and the first of the others with the number that makes them again (--only). Exit
status 1 if anything was unclear, wrong or crashed.
"""

from __future__ import annotations

import argparse
import io
import random
import re
import struct
import sys
import tempfile
import zipfile
from collections import Counter
from pathlib import Path

from children import outcomes
from structures import structural

LONGEST = 500  # characters of a sentence, paths not counted
NUMBERS = [b"0", b"-1", b"1", b"3", b"4", b"255", b"65536", b"2147483647", b"2147483648", b"-2147483648", b"4294967295"]
NUMBERS += [b"99999999999999999999", b"1e308", b"1e-308", b"-1e30", b"nan", b"inf", b"0.5", b""]
WORDS = [0, 1, 2, 4, 255, 256, 65535, 65536, 2**31 - 1, 2**31, 2**32 - 1]


def damaged(data: bytes, rng: random.Random) -> bytes:
    """One to three things done to the bytes."""
    for _ in range(rng.choice((1, 1, 2, 3))):
        data = rng.choice(DAMAGES)(bytearray(data), rng)
    return bytes(data)


def flip_bit(data: bytearray, rng: random.Random) -> bytearray:
    if data:
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    return data


def set_byte(data: bytearray, rng: random.Random) -> bytearray:
    if data:
        data[rng.randrange(len(data))] = rng.choice((0, 255, 127, 128, rng.randrange(256)))
    return data


def set_word(data: bytearray, rng: random.Random) -> bytearray:
    if len(data) >= 4:
        at = rng.randrange(len(data) - 3)
        data[at : at + 4] = struct.pack("<I", rng.choice(WORDS))
    return data


def cut_end(data: bytearray, rng: random.Random) -> bytearray:
    return data[: rng.randrange(len(data) + 1)]


def cut_out(data: bytearray, rng: random.Random) -> bytearray:
    at = rng.randrange(len(data) + 1)
    del data[at : at + rng.choice((1, 2, 4, 16, 256))]
    return data


def insert(data: bytearray, rng: random.Random) -> bytearray:
    at = rng.randrange(len(data) + 1)
    data[at:at] = rng.choice((rng.randbytes(rng.choice((1, 2, 8, 64))), bytes(data[at : at + rng.choice((4, 32))])))
    return data


def edit_number(data: bytearray, rng: random.Random) -> bytearray:
    """Another number in the place of one that is written in text."""
    found = list(re.finditer(rb"-?\d+(\.\d+)?", data[:65536]))
    if found:
        begin, end = rng.choice(found).span()
        data[begin:end] = rng.choice(NUMBERS)
    return data


def swap_lines(data: bytearray, rng: random.Random) -> bytearray:
    lines = bytes(data).split(b"\n")
    a, b = rng.randrange(len(lines)), rng.randrange(len(lines))
    lines[a], lines[b] = lines[b], lines[a]
    return bytearray(b"\n".join(lines))


DAMAGES = (flip_bit, flip_bit, set_byte, set_word, cut_end, cut_out, insert, edit_number, edit_number, edit_number, swap_lines)


def damaged_archive(data: bytes, rng: random.Random) -> bytes:
    """One array damaged, or left out, in an archive that is whole: its checksum would catch what is done from outside."""
    out = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as archive, zipfile.ZipFile(out, "w") as copy:
        names = archive.namelist()
        chosen, left_out = rng.choice(names), rng.random() < 0.05
        for name in names:
            member = archive.read(name)
            if name == chosen and not left_out:
                header = 10 + struct.unpack("<H", member[8:10])[0]
                if rng.random() < 0.6:  # shape and type
                    member = damaged(member[:header], rng) + member[header:]
                else:
                    member = member[:header] + damaged(member[header:], rng)
            if name != chosen or not left_out:
                copy.writestr(name, member)
    return out.getvalue()


def damaged_glb(data: bytes, rng: random.Random) -> bytes:
    """Its JSON damaged, or its arrays, with lengths that fit again."""
    size = struct.unpack("<I", data[12:16])[0]
    text, binary = data[20 : 20 + size], data[28 + size :]
    if rng.random() < 0.8:
        for _ in range(rng.choice((1, 2))):
            found = list(re.finditer(rb"-?\d+(\.\d+)?", text))
            begin, end = rng.choice(found).span()
            text = text[:begin] + rng.choice(NUMBERS) + text[end:]
    else:
        binary = damaged(binary, rng)
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


STRUCTURAL = 0.5  #: share of the mutants whose form is that of a file of their kind
INSIDE = {".npz": damaged_archive, ".glb": damaged_glb}


def mutant(files: list, originals: dict, number: int, seed: int, name: str) -> tuple[Path, bytes]:
    """Which file is damaged, and what it then holds; the same for the same numbers."""
    rng = random.Random(f"{seed} {name} {number}")
    path = rng.choice(files)
    change = structural(path, originals[path])
    if change and rng.random() < STRUCTURAL:
        return path, change(originals[path], rng)
    inside = INSIDE.get(path.suffix)
    damage = inside if inside and rng.random() < 0.7 else damaged
    return path, damage(originals[path], rng)


def outcome(read, path: Path) -> tuple[str, str]:
    try:
        read(path)
    except (OSError, RuntimeError, ValueError) as error:
        text = str(error)
        clear = path.stem in text and "\n" not in text and len(text.replace(str(path.parent), "")) <= LONGEST
        return "refused" if clear else "unclear", f"{type(error).__name__}: {text[:300]}"
    except BaseException as error:
        return "wrong", f"{type(error).__name__}: {str(error)[:300]}"
    return "read", ""


class Runner:
    """Counts what the reader of one format does with its mutants."""

    def __init__(self, name: str, files: list, read, seed: int, keep: Path | None):
        self.name, self.files, self.read, self.seed, self.keep = name, files, read, seed, keep
        self.originals = {path: path.read_bytes() for path in files}
        self.counts, self.notes = Counter(), []

    def run(self, numbers: range) -> None:
        results = outcomes(len(numbers), lambda i: self.read_mutant(numbers[i]), keep_stderr=self.keep is not None)
        self.restore()
        for number, (kind, text) in zip(numbers, results):
            self.count(number, kind, text)

    def read_mutant(self, number: int) -> tuple[str, str]:
        self.restore()
        path, data = mutant(self.files, self.originals, number, self.seed, self.name)
        path.write_bytes(data)
        return outcome(self.read, path)

    def restore(self) -> None:
        for path, data in self.originals.items():
            path.write_bytes(data)

    def count(self, number: int, kind: str, text: str) -> None:
        self.counts[kind] += 1
        if kind == "crash" or (kind in ("unclear", "wrong") and self.counts[kind] <= 3):
            self.notes.append(f"    {self.name} --only {number}: {kind}: {text}")
            if self.keep:
                path, data = mutant(self.files, self.originals, number, self.seed, self.name)
                (self.keep / f"{self.name}_{number}_{path.name}").write_bytes(data)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=10000, help="mutants a format (default: 10000)")
    parser.add_argument("--formats", nargs="+", help="default: all")
    parser.add_argument("--seed", type=int, default=1, help="other mutants (default: 1)")
    parser.add_argument("--only", type=int, help="this mutant alone")
    parser.add_argument("--keep", type=Path, help="folder for the mutants that were not read or refused")
    arguments = parser.parse_args()
    from seeds import make_seeds

    bad = 0
    if arguments.keep:
        arguments.keep.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        formats, world = make_seeds(Path(folder) / "seeds")
        numbers = range(arguments.count) if arguments.only is None else range(arguments.only, arguments.only + 1)
        for name in arguments.formats or formats:
            files, read = formats[name]
            for path in files:
                read(path)  # what is damaged is whole before
            runner = Runner(name, files, read, arguments.seed, arguments.keep)
            runner.run(numbers)
            counted = ", ".join(f"{runner.counts[kind]} {kind}" for kind in ("read", "refused", "unclear", "wrong", "crash"))
            print(f"{name}: {counted}", *runner.notes, sep="\n", flush=True)
            bad += runner.counts["unclear"] + runner.counts["wrong"] + runner.counts["crash"]
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
