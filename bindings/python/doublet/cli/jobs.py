"""The job of a command, from its flags."""

from __future__ import annotations

from pathlib import Path

from ..reconstruct import Job, config
from .common_flags import DOUBTFUL, common_flags, make_console
from .option_flags import add_option_flags, chosen_options


def add_stage_flags(parser, groups, with_body_model: bool) -> None:
    parser.add_argument("--force", action="store_true", help="run even if up to date, and overwrite files of other programs")
    parser.add_argument("--keep-going", action="store_true", help="continue after a result that is judged impossible")
    parser.add_argument("--config", type=Path, metavar="FILE", help="TOML file of options; flags take precedence")
    if with_body_model:
        parser.add_argument("--body-model", type=Path, metavar="FILE", help="statistical body (default: the one that ships)")
    common_flags(parser)
    parser.set_defaults(seed=None)  # 1, unless the file of --config has another
    add_option_flags(parser, groups)


def make_job(arguments, session: Path) -> Job:
    config.complete(arguments)
    return Job(
        session,
        arguments.out,
        chosen_options(arguments),
        arguments.seed,
        getattr(arguments, "body_model", None),
        console=make_console(arguments),
        keep_going=arguments.keep_going,
        config=arguments.config,
    )


def exit_status(job: Job) -> int:
    return DOUBTFUL if job.findings else 0
