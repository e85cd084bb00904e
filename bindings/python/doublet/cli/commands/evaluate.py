"""`doublet evaluate`: errors against a ground truth."""

from __future__ import annotations

import json
from pathlib import Path

from ...evaluation import motion_metrics
from ...evaluation.metrics import evaluate, format_table
from ...evaluation.reconstruction import Reconstruction
from ...evaluation.truth import Truth
from ...reconstruct import Job, recorded_session
from ..common_flags import common_flags, make_console


def register(commands) -> None:
    text = "errors of a reconstruction against a ground truth"
    command = commands.add_parser("evaluate", help=text, description=text)
    command.add_argument("out", type=Path, metavar="OUT", help="folder of the results")
    command.add_argument("--truth", type=Path, required=True, metavar="DIR", help="the session's ground_truth folder")
    command.add_argument("--session", type=Path, metavar="DIR", help="session (default: the one OUT was made from)")
    command.add_argument("--every", type=int, default=1, metavar="N", help="measure every n-th frame (default: all)")
    text = "also compare how the true and the simulated garment move in all frames: speed, lag, fast motion, folds"
    command.add_argument("--motion", action="store_true", help=text)
    command.add_argument("--json", action="store_true", help="print JSON instead of a table")
    common_flags(command)
    command.set_defaults(run=run)


def run(arguments) -> None:
    console = make_console(arguments)
    if not arguments.out.is_dir():
        raise FileNotFoundError(f"{arguments.out} is not a folder")
    job = Job(arguments.session or recorded_session(arguments.out), arguments.out, console=console)
    result = evaluate(arguments.out, arguments.truth, job.filmed, console, arguments.every)
    if arguments.motion:
        result["motion"] = motion_metrics.compare(Reconstruction(arguments.out), Truth(arguments.truth), job.session.fps)
    if arguments.json:
        print(json.dumps(result, indent=1))
        return
    print(format_table(result))
    if arguments.motion:
        print(f"\n{motion_metrics.format_table(result['motion'])}")
