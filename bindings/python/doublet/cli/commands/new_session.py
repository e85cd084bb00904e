"""`doublet new-session`: videos and a calibration, or a person's keypoints -> a session."""

from __future__ import annotations

import argparse
import math
import shlex
from pathlib import Path

from ... import _doublet as d
from ...session.calibrate import HEIGHT
from ...session.new_session import PICTURE, new_session
from ...session.request import Request
from ..common_flags import common_flags, make_console, report_findings
from .import_calibration import calibration_flags, calibration_options


def pair(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not (name and equals and value):
        raise argparse.ArgumentTypeError(f"expected NAME=VALUE, found '{text}'")
    return name, value


def offset(text: str) -> tuple[str, float]:
    name, value = pair(text)
    try:
        seconds = float(value)
    except ValueError:
        seconds = math.nan
    if not math.isfinite(seconds):
        raise argparse.ArgumentTypeError(f"expected CAMERA=SECONDS, found '{text}'")
    return name, seconds


def register(commands) -> None:
    text = "videos and a calibration -> a session folder: cameras matched, synchronised, +Y up"
    command = commands.add_parser("new-session", help=text, description=text, intermixed=True)
    command.usage = (
        "doublet new-session VIDEO ... --calibration FILE -o SESSION [options]\n"
        "       doublet new-session VIDEO ... --calibrate KEYPOINTS --height M -o SESSION [options]"
    )
    flag = command.add_argument
    flag(
        "videos",
        type=Path,
        nargs="+",
        metavar="VIDEO",
        help="a video or a folder of images for each camera, or one folder of them",
    )
    flag("--calibration", type=Path, metavar="FILE", help="any file or folder that import-calibration reads")
    text = "instead of --calibration: the person's keypoints for each camera, from which the cameras are calibrated"
    flag("--calibrate", type=Path, metavar="KEYPOINTS", help=text)
    text = "the person's keypoints for each camera, for scan and tracking (default: those of --calibrate)"
    flag("--keypoints", type=Path, metavar="KEYPOINTS", help=text)
    flag("--height", type=float, metavar="M", help=f"with --calibrate: how tall the person is (default: {HEIGHT})")
    text = "with --calibrate: angle across the larger side of the images (default: from the files, else estimated)"
    flag("--field-of-view", type=float, metavar="DEGREES", help=text)
    flag("-o", "--out", type=Path, required=True, metavar="SESSION", help="the new folder")
    many = {"nargs": "+", "action": "extend", "default": []}
    text = "the file of a camera, where names do not match"
    flag("--camera", type=pair, metavar="NAME=FILE", help=text, **many)
    flag("--without", metavar="NAME", help="calibrated cameras to leave out", **many)
    flag("--sync", choices=("auto", "none", "sound", "silhouettes"), default="auto", help="how offsets are found (default: auto)")
    flag("--offset", type=offset, metavar="CAMERA=SECONDS", help="delay of a camera; overrides --sync", **many)
    flag("--fps", type=float, metavar="X", help="common frame rate (default: the lowest)")
    flag("--start", type=float, default=0.0, metavar="SECONDS", help="begin so long after the last camera (default: 0)")
    flag("--frames", type=int, metavar="N", help="number of frames (default: as long as all cameras film)")
    flag("--masks", type=Path, metavar="PATH", help="ready silhouettes: videos, folders of images, or one folder of them", **many)
    flag("--background", type=Path, metavar="PATH", help="clean plates: an image or a video for each camera, or a folder", **many)
    flag("--scan", type=Path, metavar="FILE", help="scan of the dressed actor, if there is one")
    flag("--joints", type=Path, metavar="FILE", help="its joints.json, if there is one")
    flag("--name", default="", metavar="TEXT", help="name of the session (default: that of the folder)")
    flag("--scale-calibration", action="store_true", help="for squeezed videos: scale the calibration by a factor for each axis")
    flag("--copy", action="store_true", help="copy videos that need no change (default: hard links where the disk allows them)")
    flag("--force", action="store_true", help="replace an existing session")
    calibration_flags(command)
    common_flags(command)
    command.set_defaults(run=run, when_stopped="nothing was written")


def request_of(arguments: argparse.Namespace) -> Request:
    named = {"cameras": [(name, Path(file)) for name, file in arguments.camera], "offsets": arguments.offset}
    for flag, pairs in (("--camera", named["cameras"]), ("--offset", named["offsets"])):
        names = [name for name, _ in pairs]
        if len(set(names)) < len(names):
            raise ValueError(f"{flag}: expected every camera once, found {', '.join(names)}")
    if arguments.calibrate and (arguments.calibration or arguments.keypoints):
        other = "--calibration" if arguments.calibration else "--keypoints"
        raise ValueError(f"--calibrate: expected no {other} beside it, found {arguments.calibration or arguments.keypoints}")
    if arguments.keypoints and not arguments.calibration:
        raise ValueError("--keypoints: expected --calibration FILE beside it, found none; --calibrate calibrates by keypoints")
    same = ("videos", "calibration", "out", "scale_calibration", "without", "sync", "fps", "start", "frames", "masks")
    same += ("background", "scan", "joints", "name", "copy", "force", "height", "field_of_view")
    return Request(
        **{name: getattr(arguments, name) for name in same},
        **{name: dict(pairs) for name, pairs in named.items()},
        keypoints=arguments.calibrate or arguments.keypoints,
        calibration_options=calibration_options(arguments),
    )


def run(arguments: argparse.Namespace) -> int:
    made = new_session(request_of(arguments), make_console(arguments))
    print(*made.messages, sep="\n")
    print(f"{made.folder / PICTURE}: look at it")
    session, name = d.Session(made.folder), shlex.quote(str(made.folder))
    if not session.scan.name or not session.markers.name:
        print(f"next: doublet scan {name}   # scan and joints, from the cameras")
    print(f"next: doublet check {name} -o OUT, doublet reconstruct {name} -o OUT")
    return report_findings(made.findings)
