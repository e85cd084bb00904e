"""`doublet reconstruct`: all stages."""

from __future__ import annotations

from pathlib import Path

from ...reconstruct import OPTION_GROUPS, config
from ..jobs import add_stage_flags, exit_status, make_job
from ..option_flags import chosen_options, describe_option
from ..parsing import shorten_help

#: What `reconstruct --help` shows of the options; --help-all shows them all.
USUAL = (
    "capture.first_frame", "capture.frame_count", "segment.even_odds", "segment.border", "garment.vertices",
    "garment.length_exceedances", "fit.max_evaluations",
)  # fmt: skip


def register(commands) -> None:
    text = "a capture session -> an animatable character and a report"
    command = commands.add_parser("reconstruct", help=text, description=text)
    command.add_argument("session", type=Path, nargs="?", metavar="SESSION", help="folder with session.json")
    command.add_argument("-o", "--out", type=Path, metavar="OUT", help="folder of the results; a stopped run is continued")
    text = "write every option with its value, unit and bounds to a file for --config, and run nothing"
    command.add_argument("--write-config", type=Path, metavar="FILE", help=text)
    add_stage_flags(command, OPTION_GROUPS, with_body_model=True)
    shorten_help(command, USUAL)
    usage = "doublet reconstruct SESSION -o OUT [options]\n       doublet reconstruct --write-config FILE [options]"
    command.usage = usage
    command.set_defaults(run=run, usage_error=command.error)


def run(arguments) -> int:
    if arguments.write_config:
        config.complete(arguments)
        config.write(arguments.write_config, chosen_options(arguments), arguments.seed, arguments.body_model, describe_option)
        print(arguments.write_config)
        return 0
    if not (arguments.session and arguments.out):
        arguments.usage_error("the following arguments are required: SESSION, -o/--out")
    job = make_job(arguments, arguments.session)
    job.run_all(arguments.force)
    print(job.path("report.html"))
    return exit_status(job)
