"""`doublet scan`: scan and joints of a session that has none."""

from __future__ import annotations

import argparse
from pathlib import Path

from ...reconstruct import Job
from ...scan import refine_scan, scan_session
from ...scan.make_scan import GROUPS
from ..common_flags import common_flags, make_console, report_findings
from ..option_flags import add_option_flags, chosen_options


def frame_or_best(text: str) -> int | str:
    if text != "best" and not text.isdecimal():
        raise argparse.ArgumentTypeError(f"expected the number of a frame, or best, found '{text}'")
    return text if text == "best" else int(text)


def register(commands) -> None:
    text = "makes scan and joints of a session that has none, from its videos"
    scan = commands.add_parser("scan", help=text, description=text)
    scan.add_argument("session", type=Path, metavar="SESSION", help="folder with session.json; gets scan.ply and joints.json")
    scan.add_argument("--force", action="store_true", help="make both anew, and overwrite files of other programs")
    scan.add_argument(
        "--frame",
        type=frame_or_best,
        metavar="N",
        help="number of a frame in which the person stands upright, arms and legs apart, or 'best' to search for one; "
        "tracking starts there (default: 0, or best if nobody stands in frame 0)",
    )
    scan.add_argument(
        "--keypoints",
        type=Path,
        metavar="FOLDER",
        help="joints in the images, of OpenPose, RTMPose, AlphaPose, YOLO or MediaPipe: a file or a folder of them for each "
        "camera; the session keeps them, and tracking uses them, too",
    )
    scan.add_argument(
        "--given",
        type=Path,
        metavar="FILE",
        help="a scan in the pose of the frame (in m, cm, mm or inches, any axis up, with or without floor), which is moved to "
        "where the cameras see the person",
    )
    scan.add_argument(
        "--refine",
        type=Path,
        metavar="OUT",
        help="correct the scan with the tracked frames of OUT, a folder of reconstruct; then run reconstruct again",
    )
    scan.add_argument("--body-model", type=Path, metavar="FILE", help="statistical body (default: the one that ships)")
    common_flags(scan)
    add_option_flags(scan, GROUPS)
    scan.set_defaults(run=run)


def run(arguments) -> int:
    options = chosen_options(arguments, GROUPS)
    scan_options, rest_options = options.pop("scan"), options.pop("rest")
    console = make_console(arguments)
    job = Job(arguments.session, arguments.session, options, body_model=arguments.body_model, console=console)
    if arguments.refine:
        if arguments.keypoints:
            raise ValueError("--keypoints: expected no --refine beside it; give them first, the session keeps them")
        for flag, value in (("--given", arguments.given), ("--frame", arguments.frame)):
            if value is not None:
                raise ValueError(f"{flag}: expected no --refine beside it, which corrects the scan that the session names")
        made = refine_scan(job, arguments.refine, rest_options, arguments.force)
    else:
        made = scan_session(job, scan_options, arguments.force, arguments.frame, arguments.keypoints, arguments.given)
    console.finish()
    print("\n".join(map(str, made.files)))
    return report_findings(made.findings)
