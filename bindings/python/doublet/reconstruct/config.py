"""A file of options (TOML): `doublet reconstruct --write-config FILE` writes it, `--config FILE` reads it."""

from __future__ import annotations

import argparse
import json
import os
from pathlib import Path

import numpy as np

from .._doublet import __version__
from ..common.files import read_toml, write_text
from ..common.renamed import current_option
from .options import MOST_SEED, OPTION_GROUPS, is_derived, make_options, plain, takes_pairs

HEAD = """# Options of doublet {version}: `doublet reconstruct SESSION -o OUT --config THIS_FILE`.
# A flag on the command line beats this file; what is left out of it has its default. A key is a flag's name: `diffusion` of
# [segment] is --segment-diffusion.
"""
SEED = "of every random choice; a whole number of at least 0 (default: 1)"
BODY_MODEL = "statistical body; a path, seen from this file's folder (default: the one that ships)"
#: Python's word for a kind of value -> ours.
KINDS = {bool: "true or false", int: "a whole number", float: "a number", str: "a text", list: "a list", dict: "a table"}


# --- writing


def written(chosen: dict, seed: int, body_model: Path | None, describe) -> str:
    """The file's text: every option with its value. chosen: group -> options object; describe(described, default)
    -> a comment."""
    place = f"body_model = {as_toml(str(body_model))}" if body_model else '# body_model = "FILE"'
    lines = [HEAD.format(version=__version__), f"# {SEED}", f"seed = {seed}", f"# {BODY_MODEL}", place]
    for group, options in chosen.items():
        defaults, described = type(options)().to_dict(), options.described()
        lines += ["", f"[{group}]  # {type(options).__doc__.splitlines()[0]}"]
        for name, value in options.to_dict().items():
            if not is_derived(group, name, value):
                lines += [f"# {describe(described[name], defaults[name])}", f"{name} = {as_toml(plain(value))}"]
    return "\n".join(lines) + "\n"


def as_toml(value) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(name)} = {as_toml(x)}" for name, x in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(as_toml, value)) + "]"
    if isinstance(value, (bool, str)):
        return json.dumps(value, ensure_ascii=False)
    return repr(value)


def write(path: Path, chosen: dict, seed: int, body_model: Path | None, describe) -> None:
    if body_model and not body_model.is_absolute():  # as the file is read, not as the command line is
        body_model = Path(os.path.relpath(body_model.resolve(), path.parent.resolve()))
    write_text(path, written(chosen, seed, body_model, describe))


# --- reading


def read(path: Path) -> dict:
    """What the file says, by the names that the parsed command line has: "segment.diffusion", "seed", "body_model". Raises
    RuntimeError, in a sentence that names the file and the key, for whatever doublet would not take."""
    path, values = Path(path), {}
    for key, value in read_toml(path).items():
        if key == "seed":
            values[key] = checked(path, key, value, 1)
            if value < 0:
                raise RuntimeError(f"{path}: seed: expected a whole number of at least 0, found {value}")
            if value > MOST_SEED:
                raise RuntimeError(f"{path}: seed: expected a whole number of at most {MOST_SEED}, found {value}")
        elif key == "body_model":
            values[key] = path.parent / checked(path, key, value, "")
        elif key not in OPTION_GROUPS:
            expected = ", ".join(["seed", "body_model", *(f"[{group}]" for group in OPTION_GROUPS)])
            raise RuntimeError(f"{path}: expected one of {expected}, found '{key}'")
        else:
            values.update({f"{key}.{name}": x for name, x in group_of(path, key, value).items()})
    return values


def group_of(path: Path, group: str, table) -> dict:
    """The options that a table names, as their class takes them."""
    options_class = OPTION_GROUPS[group]
    defaults, described = options_class().to_dict(), options_class.described()
    names = [name for name, default in defaults.items() if not is_derived(group, name, default)]
    chosen = {}
    for given, value in checked(path, group, table, {}).items():
        name = current_option(group, given)
        if name not in names:
            raise RuntimeError(f"{path}: {group}.{name}: expected one of {', '.join(names)}, found '{name}'")
        chosen[name] = option_of(path, f"{group}.{name}", value, defaults[name], described[name])
    try:
        make_options(group, options_class, **chosen)
    except (TypeError, ValueError) as error:
        text = str(error).splitlines()[0].removeprefix(f"{options_class.__name__}: ")
        raise RuntimeError(f"{path}: {group}.{text}") from error
    return chosen


def option_of(path: Path, key: str, value, default, described: dict):
    """A value of the kind of the default."""
    if takes_pairs(default):
        known = plain(default)
        for name, x in checked(path, key, value, {}).items():
            if name not in known:
                raise RuntimeError(f"{path}: {key}.{name}: expected one of {', '.join(known)}, found '{name}'")
            checked(path, f"{key}.{name}", x, known[name])
        try:
            return type(default)(**{**known, **value})
        except ValueError as error:
            raise RuntimeError(f"{path}: {key}: {str(error).splitlines()[0]}") from error
    if isinstance(default, (list, np.ndarray)):
        for x in checked(path, key, value, []):
            checked(path, f"{key}, an element", x, 0.0 if "lower" in described else "")
        return value
    return checked(path, key, value, default)


def checked(path: Path, key: str, value, default):
    """The value, if it is of the default's kind; a whole number does for any."""
    kind = type(default)
    whole = isinstance(value, int) and not isinstance(value, bool)
    if type(value) is not kind and not (kind is float and whole):
        found = value if type(value) is float else KINDS.get(type(value), type(value).__name__)
        raise RuntimeError(f"{path}: {key}: expected {KINDS[kind]}, found {found}")
    return value


def complete(arguments: argparse.Namespace) -> None:
    """What the file of --config says, where the command line says nothing."""
    values = read(arguments.config) if arguments.config else {}
    for key, value in {"seed": 1, **values}.items():
        if getattr(arguments, key, None) is None:
            setattr(arguments, key, value)
