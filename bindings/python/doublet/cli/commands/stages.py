"""The stages one by one: `doublet check`, `template` ... `report`."""

from __future__ import annotations

from pathlib import Path

from ... import _doublet as d
from ...reconstruct import OPTION_GROUPS, STAGES, recorded_session
from ..jobs import add_stage_flags, exit_status, make_job

#: Command -> (stages it runs, what it does).
STAGE_COMMANDS = {
    "check": (("check",), "plausibility check of a session: scan, joints, calibration, silhouettes -> check.png"),
    "template": (("template", "rig"), "scan and marked joints -> template with skeleton and skin weights"),
    "capture": (("check", "template", "rig", "performance"), "scan and videos -> rigged template and reference performance"),
    "segment": (("segment",), "reference performance -> what is cloth: clothness and probability of every vertex"),
    "body": (("body",), "template and segmentation -> body under the clothes, and collision proxies"),
    "garment": (("garment",), "segmentation, body and reference performance -> the garment's own mesh"),
    "fit": (("fit",), "reference performance and what its images show -> material of the cloth"),
    "character": (("character",), "results of all stages -> character.glb, and the reference performance simulated with it"),
    "report": (("report",), "results of all stages -> report.html"),
}


def register(commands) -> None:
    for name, (stages, text) in STAGE_COMMANDS.items():
        command = commands.add_parser(name, help=text, description=text, intermixed=name == "fit")
        if name in ("check", "template", "capture"):
            command.add_argument("session", type=Path, metavar="SESSION", help="folder with session.json")
            command.add_argument("-o", "--out", type=Path, required=True, metavar="OUT", help="folder of the results")
        else:
            command.add_argument("out", type=Path, metavar="OUT", help="folder of the results of the earlier stages")
            if name == "fit":
                more = "more takes of the same garment, which get one material and one width together"
                command.add_argument("takes", type=Path, nargs="*", default=[], metavar="OUT", help=more)
            command.add_argument("--session", type=Path, metavar="DIR", help="session (default: the one OUT was made from)")
        used = {group for stage in STAGES if stage.name in stages for group in stage.option_groups}
        groups = {group: c for group, c in OPTION_GROUPS.items() if group in used}
        add_stage_flags(command, groups, with_body_model=name in ("segment", "body"))
        command.set_defaults(run=run_fit if name == "fit" else run_stages, stages=stages)


def run_stages(arguments) -> int:
    session = arguments.session or recorded_session(arguments.out)
    job = make_job(arguments, session)
    job.run(list(arguments.stages), arguments.force)
    return exit_status(job)


def run_fit(arguments) -> int:
    if not arguments.takes:
        return run_stages(arguments)
    if arguments.session:
        raise ValueError("--session: expected a single OUT beside it; of several takes each has its own")
    jobs = []
    for out in (arguments.out, *arguments.takes):
        arguments.out = out
        jobs.append(make_job(arguments, recorded_session(out)))
    d.fit_together(jobs)
    jobs[0].console.finish()
    return exit_status(jobs[0])
