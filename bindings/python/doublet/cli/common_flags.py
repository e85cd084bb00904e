"""What several commands take."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

from ..common.console import Console
from ..reconstruct.options import MOST_SEED

MOST_NUMBER = 2**31 - 1  #: of what the library counts
DOUBTFUL = 3  #: exit status of a run that ended, but with doubts
MOTION_HELP = (
    ".bvh, .amc with its .asf beside it, a clip in .fbx, .glb, .vrm or .vrma, poses of SMPL, SMPL-H or SMPL-X (AMASS) in "
    ".npz, or a performance.npz"
)


def whole(least: int, most: int) -> Callable[[str], int]:
    """The type of a flag: a whole number of these."""

    def number(text: str) -> int:
        if not (text.isdecimal() and least <= int(text) <= most):
            raise argparse.ArgumentTypeError(f"expected a whole number from {least} to {most}, found '{text}'")
        return int(text)

    return number


def common_flags(parser: argparse.ArgumentParser) -> None:
    text = "number of threads, 0 = one per core; results do not depend on it"
    parser.add_argument("--threads", type=whole(0, MOST_NUMBER), default=0, metavar="N", help=text)
    parser.add_argument("--seed", type=whole(0, MOST_SEED), default=1, metavar="N", help="seed of random numbers (default: 1)")
    parser.add_argument("--quiet", action="store_true", help="show no progress")
    parser.add_argument("--verbose", action="store_true", help="show the log of the stages, not only their progress")
    parser.add_argument("--debug", action="store_true", help="show the traceback of an error")


def clip_flags(command: argparse.ArgumentParser) -> None:
    """How a MOTION is read."""
    text = "TOML file: our joint = joint of the motion; --retarget-joint-names takes precedence"
    command.add_argument("--bone-map", type=Path, metavar="FILE", help=text)
    text = "which of the animations in a MOTION.glb: name, or number from 1 (default: the first that moves the body)"
    command.add_argument("--animation", default="", metavar="NAME", help=text)


def clip_options(arguments: argparse.Namespace, has_motion: bool = True) -> tuple[Path | None, str]:
    """`bone_map` and `animation` of read_motion()."""
    if not has_motion and (arguments.bone_map or arguments.animation):
        raise ValueError("--bone-map, --animation: expected a motion that is read with them, found none")
    return arguments.bone_map, arguments.animation


def page_flags(command) -> None:
    text = "port of the page on this machine (default: any free one)"
    command.add_argument("--port", type=whole(0, 65535), default=0, metavar="N", help=text)
    command.add_argument("--no-browser", dest="browser", action="store_false", help="only print the address")
    command.add_argument("--debug", action="store_true", help="show the traceback of an error")


def make_console(arguments: argparse.Namespace) -> Console:
    return Console(arguments.threads, quiet=arguments.quiet, verbose=arguments.verbose)


def report_findings(findings) -> int:
    """Says what is doubtful; the exit status."""
    for finding in findings:
        print(f"doublet: {finding.level}: {finding.text}", file=sys.stderr)
    return DOUBTFUL if findings else 0
