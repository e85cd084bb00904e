"""Small files that the pure-Python half writes: complete or absent, as the C++ half does. And archives that it reads."""

from __future__ import annotations

import json
import math
import os
import re
import shutil
import sys
from contextlib import contextmanager, suppress
from pathlib import Path
from zipfile import ZipFile

import numpy as np

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


@contextmanager
def written_atomically(path: Path):
    """A path beside `path` to write to; brought to the disk and renamed to `path` if the block succeeds, removed if not. A
    symbolic link stays: the file that it leads to is replaced."""
    path = Path(path)
    with suppress(OSError):  # of a name that no disk takes what follows speaks
        require_file(path)
    target = Path(os.path.realpath(path))
    target.parent.mkdir(parents=True, exist_ok=True)
    # Same suffix: writers choose the format by it.
    beside = target.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
    try:
        yield beside
        with beside.open("rb") as written:
            os.fsync(written.fileno())  # a full disk may only say so now
        beside.replace(target)
    except OSError as error:
        if error.errno is None or error.filename not in (None, str(beside)):
            raise
        raise OSError(error.errno, f"cannot be written: {error.strerror}", str(path)) from error
    finally:
        with suppress(OSError):  # on a disk that is read-only even for what is not there
            beside.unlink()


@contextmanager
def folder_written_atomically(path: Path):
    """A new folder to fill, which becomes `path` if the block succeeds, and is removed if not. What is said about a file in it
    names the file that it would have become. A folder that is there stays the same one and gets another content: a disk may be
    mounted on it, or somebody stand in it. A symbolic link stays, as above."""
    named, path = Path(path).absolute(), Path(os.path.realpath(path))
    is_there = path.is_dir()
    beside, before = ((path if is_there else path.parent) / f".{path.name}.{os.getpid()}.{what}" for what in ("part", "old"))
    shutil.rmtree(beside, ignore_errors=True)  # of one that was killed: in a container all have the same number
    beside.mkdir(parents=True)
    try:
        yield beside
        if is_there:
            replace_content(path, beside, before)
        else:
            beside.replace(path)
    except OSError as error:
        if error.errno is None or (error.filename is not None and str(beside) not in str(error.filename)):
            raise
        name = str(error.filename or named).replace(str(beside), str(named))
        raise OSError(error.errno, f"cannot be written: {error.strerror.removeprefix('cannot be written: ')}", name) from error
    except (RuntimeError, ValueError) as error:
        if str(beside) not in str(error):
            raise
        kind = RuntimeError if isinstance(error, RuntimeError) else ValueError
        raise kind(str(error).replace(str(beside), str(named))) from error
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def replace_content(folder: Path, new: Path, old: Path) -> None:
    """By that of `new`; both are in `folder`, `old` takes what was there until that is done."""
    old.mkdir(exist_ok=True)
    try:
        move_content(folder, old, but=(new, old))
        try:
            move_content(new, folder)
        except BaseException:
            move_content(old, folder)
            raise
    except BaseException:
        old.rmdir()
        raise
    shutil.rmtree(old, ignore_errors=True)


def move_content(source: Path, target: Path, but: tuple[Path, ...] = ()) -> None:
    """All of it or, if that fails, nothing."""
    entries = [entry for entry in source.iterdir() if entry not in but]
    try:
        for entry in entries:
            entry.replace(target / entry.name)
    except BaseException:
        for entry in entries:
            if os.path.lexists(target / entry.name):
                (target / entry.name).replace(entry)
        raise


def write_text(path: Path, text: str) -> None:
    with written_atomically(path) as beside:
        beside.write_text(text, encoding="utf-8")


def write_json(path: Path, value) -> None:
    write_text(path, json.dumps(value, indent=1) + "\n")


def require_file(path: Path) -> None:
    """Raises RuntimeError for a device or a pipe, which may never end, and in whose place no file is to come."""
    if path.exists() and not path.is_file() and not path.is_dir():
        raise RuntimeError(f"{path}: expected a file, found a device or pipe")


def require_other_file(out: Path, *read: Path) -> None:
    """Raises ValueError if a result would take the place of what it is made from: of another kind, it cannot be made again."""
    for path in read:
        if out.exists() and path.exists() and out.samefile(path):
            raise ValueError(f"{out}: expected another file than the one that is read; choose another name")


DEEPEST = 64  #: levels of a file of options


def require_shallow(text: str) -> None:
    """Raises RecursionError for TOML whose brackets or dotted keys nest deeper than any of ours: its parser takes memory for each
    level. Quotes do not count: what is one is the parser's to say."""
    depth = 0
    for mark in re.findall(r"[\[{\]}]", text):
        depth = depth + 1 if mark in "[{" else max(depth - 1, 0)
        if depth > DEEPEST:
            raise RecursionError
    if any(part.count(".") > DEEPEST for part in re.split(r"[=,{}\n]", text)):
        raise RecursionError


def read_toml(path: Path) -> dict:
    """What is wrong with the text is a RuntimeError that names the file."""
    require_file(Path(path))
    try:
        text = path.read_text(encoding="utf-8-sig")
        require_shallow(text)
        return tomllib.loads(text)
    except RecursionError:
        raise RuntimeError(f"{path}: expected TOML, found brackets inside of brackets without end") from None
    except ValueError as error:  # a syntax error, or bytes that are no text
        raise RuntimeError(f"{path}: expected TOML, found: {error}") from error


def read_json(path: Path):
    """What is wrong with the text is a RuntimeError that names the file."""
    require_file(Path(path))
    try:
        return json.loads(Path(path).read_text(encoding="utf-8-sig"))
    except RecursionError:
        raise RuntimeError(f"{path}: expected JSON, found brackets inside of brackets without end") from None
    except ValueError as error:  # a syntax error, or bytes that are no text
        raise RuntimeError(f"{path}: expected JSON, found a syntax error ({error})") from error


@contextmanager
def arrays_of(path: Path):
    """`np.load(path)`; what is wrong with the archive, or missing in it, is a RuntimeError that names it."""
    require_file(Path(path))
    try:
        require_room(path)
        with np.load(path) as arrays:
            yield arrays
    except (FileNotFoundError, MemoryError):
        raise
    except Exception as error:  # of zipfile, zlib, struct, tokenize, ast or NumPy
        if str(path) in str(error):
            raise
        said = " ".join(str(error).split())[:200]  # some quote the file
        raise RuntimeError(f"{path}: expected an .npz archive with the arrays of docs/formats.md, found: {said}") from error


MOST_EXPANSION = 1032  # of deflate
#: Of one array, in the place of that, and bytes whatever it expands from: what packs better has nothing in it but one number.
USUAL_EXPANSION, ANYWAY = 100, 256 << 20


def require_room(path: Path) -> None:
    """Raises ValueError for arrays that say they are larger than the file can hold: NumPy asks for the memory before it looks."""
    readers = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
    room = MOST_EXPANSION * Path(path).stat().st_size
    with ZipFile(path) as archive:
        for member in archive.infolist():
            if member.file_size > ANYWAY + USUAL_EXPANSION * member.compress_size:
                raise ValueError(f"{member.filename} of {member.file_size >> 20} MiB out of {member.compress_size} bytes")
            room -= member.file_size  # many can name the same packed bytes
            with archive.open(member) as stream:
                version = np.lib.format.read_magic(stream)
                if version not in readers:
                    raise ValueError(f"{member.filename} of version {version}")
                shape, _, kind = readers[version](stream)
                has = member.file_size - stream.tell()
            if max(kind.itemsize, 1) * math.prod(shape) > has and not kind.hasobject:  # Python's objects are refused unread
                raise ValueError(f"{member.filename} of shape {shape} in {has} bytes")
    if room < 0:
        raise ValueError("more than deflate can pack into a file of this size")


def array_of(arrays, path: Path, name: str, kinds: str, shape: tuple) -> np.ndarray:
    """An array of an archive that was opened with `arrays_of`, of one of these kinds (`dtype.kind`) and this shape (None: any
    number), and finite. Raises RuntimeError naming file and array."""
    found = arrays[name]
    fits = found.ndim == len(shape) and all(n in (None, m) for n, m in zip(shape, found.shape))
    if not fits or found.dtype.kind not in kinds:
        expected = " x ".join("N" if n is None else str(n) for n in shape)
        raise RuntimeError(f"{path}: array '{name}': expected {expected} numbers, found {found.dtype} of shape {found.shape}")
    if found.dtype.kind == "f" and not np.isfinite(found).all():
        raise RuntimeError(f"{path}: array '{name}': expected finite numbers, found others")
    return found
