"""`doublet import-calibration`: cameras of another program -> calibration.yml of a session."""

from __future__ import annotations

import argparse
import re
from pathlib import Path

from ... import _doublet as d
from ...common.files import require_other_file
from ...session.import_calibration import camera_line, distances


def image_size(text: str) -> tuple[int, int]:
    """1920x1080"""
    found = re.fullmatch(r"([1-9]\d{0,5})x([1-9]\d{0,5})", text)
    if not found:
        raise argparse.ArgumentTypeError(f"expected WIDTHxHEIGHT in pixels, found '{text}'")
    return int(found[1]), int(found[2])


def calibration_options(arguments: argparse.Namespace) -> d.CalibrationOptions:
    """What the flags of `calibration_flags` say."""
    width, height = arguments.image_size or (0, 0)
    return d.CalibrationOptions(
        format=arguments.format, units=arguments.units, up=arguments.up, image_width=width, image_height=height
    )


def register(commands) -> None:
    text = "cameras of another program (docs/calibration.md has the list) -> calibration.yml"
    command = commands.add_parser("import-calibration", help=text, description=text)
    flag = command.add_argument
    flag("input", type=Path, metavar="INPUT", help="file, or the folder that the program writes")
    out = Path("calibration.yml")
    flag("-o", "--out", type=Path, default=out, metavar="FILE", help=f"file to write (default: {out})")
    calibration_flags(command)
    flag("--debug", action="store_true", help="show the traceback of an error")
    command.set_defaults(run=run)


def calibration_flags(parser) -> None:
    """How a calibration file is to be read."""
    says, flag = d.CalibrationOptions.described(), parser.add_argument
    flag("--format", choices=says["format"]["choices"], default="found", help=f"{says['format']['meaning']} (default)")
    flag("--units", default="found", metavar="found|m|cm|mm|X", help=f"{says['units']['meaning']} (default)")
    flag(
        "--up",
        choices=says["up"]["choices"],
        default="found",
        help=f"{says['up']['meaning']} (default); a negative one as --up=-y",
    )
    flag("--image-size", type=image_size, metavar="WxH", help="size of all images, px, for formats that do not have it")


def run(arguments: argparse.Namespace) -> None:
    require_other_file(arguments.out, arguments.input)
    cameras = d.read_calibration(arguments.input, calibration_options(arguments), d.Context(log=print))
    d.write_calibration(arguments.out, cameras)
    print(*map(camera_line, cameras), sep="\n")
    print(f"{arguments.out}: {len(cameras)} cameras{distances(cameras)}")
