"""The stages one by one: `doublet check`, `template` ... `report`."""

from __future__ import annotations

from pathlib import Path

from ... import _doublet as d
from ...reconstruct import OPTION_GROUPS, STAGES, recorded_session
from ..jobs import add_stage_flags, exit_status, make_job

#: Command -> (stages it runs, what it does).
STAGE_COMMANDS = {
    "check": (("check",), "whether a session can be true: scan, joints, calibration, silhouettes; with a picture"),
    "template": (("template", "rig"), "scan and marked joints -> rigged template"),
    "capture": (("check", "template", "rig", "performance"), "scan and videos -> rigged template and reference performance"),
    "segment": (("segment",), "reference performance -> clothness of every vertex"),
    "body": (("body",), "dressed template -> body underneath and collision proxies"),
    "garment": (("garment",), "clothness and reference performance -> the garment's own mesh"),
    "fit": (("fit",), "performance and its images -> material of the cloth"),
    "character": (("character",), "everything so far -> character.glb and the re-animated performance"),
    "report": (("report",), "everything so far -> report.html"),
}


def register(commands) -> None:
    for name, (stages, text) in STAGE_COMMANDS.items():
        command = commands.add_parser(name, help=text, description=text, intermixed=name == "fit")
        if name in ("check", "template", "capture"):
            command.add_argument("session", type=Path, metavar="SESSION", help="folder with session.json")
            command.add_argument("-o", "--out", type=Path, required=True, metavar="OUT", help="folder of the results")
        else:
            command.add_argument("out", type=Path, metavar="OUT", help="folder of the results so far")
            if name == "fit":
                more = "more takes of the same garment: one material and one width are found that explain all of them together"
                command.add_argument("takes", type=Path, nargs="*", default=[], metavar="OUT", help=more)
            command.add_argument("--session", type=Path, metavar="DIR", help="default: the one that OUT was made from")
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
