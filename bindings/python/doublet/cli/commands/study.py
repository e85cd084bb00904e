"""`doublet study`: many material fits."""

from __future__ import annotations

import sys
from pathlib import Path

from ...evaluation import study
from ...reconstruct import OPTION_GROUPS
from ...reconstruct.options import MOST_SEED
from ..common_flags import MOST_NUMBER, whole
from ..option_flags import add_option_flags


def register(commands) -> None:
    text = "many material fits, over reconstructions and seeds, on many processes or machines"
    command = commands.add_parser("study", help=text, description=text, intermixed=True)
    command.add_argument("outs", type=Path, nargs="+", metavar="OUT", help="reconstructions up to stage 'garment'")
    command.add_argument(
        "-o", "--results", type=Path, required=True, metavar="FILE.jsonl", help="one line per fit; finished ones are kept"
    )
    command.add_argument(
        "--seeds", type=whole(0, MOST_SEED), nargs="+", default=[1], metavar="N", help="seeds; one fit for each (default: 1)"
    )
    text = "processes on this machine (default: 1)"
    command.add_argument("--workers", type=whole(1, MOST_NUMBER), default=1, metavar="N", help=text)
    command.add_argument("--dask", metavar="ADDRESS", help="a Dask scheduler to use instead, e.g. tcp://host:8786")
    command.add_argument("--quiet", action="store_true", help="show no progress")
    command.add_argument("--debug", action="store_true", help="show the traceback of an error")
    add_option_flags(command, {g: OPTION_GROUPS[g] for g in ("cloth", "energy", "fit", "space")})
    command.set_defaults(run=run)


def run(arguments) -> None:
    given = {k: v for k, v in vars(arguments).items() if "." in k}
    outs, results = arguments.outs, arguments.results
    jobs = study.fit_jobs(outs, arguments.seeds, [given], checkpoints=results.with_suffix(".checkpoints"))
    executor = study.dask_workers(arguments.dask) if arguments.dask else study.local_workers(arguments.workers)

    def say(row, done, count):
        if not arguments.quiet:
            print(f"{done}/{count} {study.table([row])}", file=sys.stderr, flush=True)

    rows = study.run(study.fit, jobs, executor, results, on_row=say)
    print(study.table(rows))
    failed = sum("error" in row for row in rows)
    if failed:
        raise RuntimeError(f"{failed} of {len(rows)} fits failed; the same command tries them again")
