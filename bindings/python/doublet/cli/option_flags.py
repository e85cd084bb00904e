"""Flags of option classes: `--GROUP-FIELD`, and the options that they choose."""

from __future__ import annotations

import argparse

import numpy as np

from ..reconstruct.options import OPTION_GROUPS, is_derived, make_options, plain, takes_pairs


def add_option_flags(parser: argparse.ArgumentParser, groups) -> None:
    """`--GROUP-FIELD` for every field of the option classes, with its meaning, range and default."""
    for group, options_class in groups.items():
        flags = parser.add_argument_group(f"{group} options", options_class.__doc__.splitlines()[0])
        described = options_class.described()
        for name, default in options_class().to_dict().items():
            if is_derived(group, name, default):
                continue
            text = describe_option(described[name], default).replace("%", "%%")
            flag = {"dest": f"{group}.{name}", "default": argparse.SUPPRESS, "help": text}
            if isinstance(default, bool):
                flag["action"] = argparse.BooleanOptionalAction
            elif takes_pairs(default):
                flag["nargs"], flag["metavar"] = "+", "NAME=X"
            elif isinstance(default, (list, np.ndarray)):
                flag["nargs"] = len(default) if isinstance(default, np.ndarray) else "*"
                flag["type"], flag["metavar"] = (number, "X") if "lower" in described[name] else (str, "NAME")
            else:
                flag["type"] = type(default)
                flag["metavar"] = "N" if isinstance(default, int) else "X"
            flags.add_argument(f"--{group}-{name.replace('_', '-')}", **flag)


def describe_option(described: dict, default) -> str:
    """What an option is: meaning, bounds, unit, default."""
    takes = " ".join(t for t in (described["takes"], described["unit"]) if t)
    return described["meaning"] + (f"; {takes}" if takes else "") + f" (default: {to_text(default)})"


def number(text: str) -> int | float:
    """Whole numbers stay whole: a list of seeds, of indices."""
    try:
        return int(text)
    except ValueError:
        return float(text)


def to_text(value) -> str:
    if takes_pairs(value):
        value = [f"{name}={x}" for name, x in plain(value).items()]
    if isinstance(value, (list, np.ndarray)):
        return " ".join(str(v) for v in value) or "none"
    return str(value) if not isinstance(value, bool) else "on" if value else "off"


def chosen_options(arguments: argparse.Namespace, groups=OPTION_GROUPS) -> dict:
    """The option objects, made from the flags that were given; wrong values raise ValueError here, before any work."""
    chosen: dict[str, dict] = {}
    for key, value in vars(arguments).items():
        if "." in key:
            group, name = key.split(".", 1)
            chosen.setdefault(group, {})[name] = value
    return {group: make_options(group, c, **chosen.get(group, {})) for group, c in groups.items()}
