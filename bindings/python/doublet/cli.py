"""The command `doublet`."""

from __future__ import annotations

import argparse
import json
import signal
import sys
from contextlib import contextmanager
from dataclasses import fields
from pathlib import Path

import numpy as np

from . import __version__, body_model_path, config, import_calibration, new_session, pipeline
from . import _doublet as d
from .console import Console
from .plausible import DOUBTFUL

STOPPING = (signal.SIGINT, signal.SIGTERM)


class Stopped(KeyboardInterrupt):
    """A signal asked to stop."""

    def __init__(self, number: int):
        super().__init__(f"signal {number}")
        self.status = 128 + number  # as shells have it


@contextmanager
def stopped_by_signals():
    """Ctrl-C, SIGTERM, and SIGINT where a shell in the background has it ignored, all end the command in the same way."""

    def stop(number, frame):
        raise Stopped(number)

    try:
        before = {number: signal.signal(number, stop) for number in STOPPING}
    except ValueError:  # not the main thread: signals are somebody else's
        before = {}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, signal.SIG_DFL if handler is None else handler)


#: What `reconstruct --help` shows of the options; --help-all shows them all.
USUAL = (
    "capture.first_frame", "capture.frame_count", "segment.rigid_threshold", "segment.cloth_threshold", "garment.vertices",
    "garment.spreads", "fit.max_evaluations",
)  # fmt: skip


class HelpAll(argparse.Action):
    """Shows the help of the flags that --help leaves out, too."""

    def __call__(self, parser, namespace, values, option_string=None):
        for action, text in self.const:
            action.help = text
        for group in parser._action_groups:
            group.description = getattr(group, "whole_description", group.description)
        parser.print_help()
        parser.exit()


def shorten_help(parser: argparse.ArgumentParser, shown) -> None:
    """Leaves --help with the options that `shown` names, and adds --help-all."""
    left_out = []
    for group in parser._action_groups:
        options = [action for action in group._group_actions if "." in action.dest]
        hidden = [action for action in options if action.dest not in shown]
        left_out += [(action, action.help) for action in hidden]
        for action in hidden:
            action.help = argparse.SUPPRESS
        if options and len(hidden) == len(options):
            group.whole_description, group.description = group.description, argparse.SUPPRESS
    parser.add_argument("--help-all", action=HelpAll, nargs=0, const=left_out, help="show every option of every stage, and exit")


def add_option_flags(parser: argparse.ArgumentParser, groups) -> None:
    """`--GROUP-FIELD` for every field of the option classes, with its meaning, range and default."""
    for group, options_class in groups.items():
        flags = parser.add_argument_group(f"{group} options", options_class.__doc__.splitlines()[0])
        described = options_class.described()
        for name, default in options_class().to_dict().items():
            if pipeline.is_derived(group, name, default):
                continue
            text = in_words(described[name], default).replace("%", "%%")
            flag = {"dest": f"{group}.{name}", "default": argparse.SUPPRESS, "help": text}
            if isinstance(default, bool):
                flag["action"] = argparse.BooleanOptionalAction
            elif pipeline.takes_pairs(default):
                flag["nargs"], flag["metavar"] = "+", "NAME=X"
            elif isinstance(default, (list, np.ndarray)):
                flag["nargs"] = len(default) if isinstance(default, np.ndarray) else "*"
                flag["type"], flag["metavar"] = (number, "X") if "lower" in described[name] else (str, "NAME")
            else:
                flag["type"] = type(default)
                flag["metavar"] = "N" if isinstance(default, int) else "X"
            flags.add_argument(f"--{group}-{name.replace('_', '-')}", **flag)


def in_words(described: dict, default) -> str:
    """What an option is: meaning, bounds, unit, default."""
    takes = " ".join(t for t in (described["takes"], described["unit"]) if t)
    return described["meaning"] + (f"; {takes}" if takes else "") + f" (default: {shown(default)})"


def number(text: str) -> int | float:
    """Whole numbers stay whole: a list of seeds, of indices."""
    try:
        return int(text)
    except ValueError:
        return float(text)


def shown(value) -> str:
    if pipeline.takes_pairs(value):
        value = [f"{name}={x}" for name, x in pipeline.plain(value).items()]
    if isinstance(value, (list, np.ndarray)):
        return " ".join(str(v) for v in value) or "none"
    return str(value)


def chosen_options(arguments: argparse.Namespace, groups=pipeline.OPTION_GROUPS) -> dict:
    """The option objects, made from the flags that were given; wrong values raise ValueError here, before any work."""
    chosen: dict[str, dict] = {}
    for key, value in vars(arguments).items():
        if "." in key:
            group, name = key.split(".", 1)
            chosen.setdefault(group, {})[name] = value
    return {group: pipeline.make_options(group, c, **chosen.get(group, {})) for group, c in groups.items()}


def make_console(arguments: argparse.Namespace) -> Console:
    return Console(arguments.threads, quiet=arguments.quiet, verbose=arguments.verbose)


def make_job(arguments: argparse.Namespace, session: Path) -> pipeline.Job:
    config.complete(arguments)
    return pipeline.Job(
        session_folder=session,
        out=arguments.out,
        options=chosen_options(arguments),
        seed=arguments.seed,
        body_model=getattr(arguments, "body_model", None) or body_model_path(),
        console=make_console(arguments),
        keep_going=arguments.keep_going,
        config=arguments.config,
    )


def exit_status(job: pipeline.Job) -> int:
    return DOUBTFUL if job.doubts else 0


def run_reconstruct(arguments) -> int:
    if arguments.write_config:
        config.complete(arguments)
        config.write(arguments.write_config, chosen_options(arguments), arguments.seed, arguments.body_model, in_words)
        print(arguments.write_config)
        return 0
    if not (arguments.session and arguments.out):
        arguments.usage_error("the following arguments are required: SESSION, -o/--out")
    job = make_job(arguments, arguments.session)
    pipeline.reconstruct(job, arguments.force)
    print(job.path("report.html"))
    return exit_status(job)


def run_stages(arguments) -> int:
    session = arguments.session or pipeline.recorded_session(arguments.out)
    job = make_job(arguments, session)
    pipeline.start_record(job, scanned=tuple(arguments.stages) != ("check",))
    for stage in job.stages:
        if stage.name in arguments.stages:
            pipeline.run_stage(job, stage, arguments.force)
    return exit_status(job)


def run_fit(arguments) -> int:
    if not arguments.takes:
        return run_stages(arguments)
    if arguments.session:
        raise ValueError("--session: expected a single OUT beside it; of several takes each has its own")
    jobs = []
    for out in (arguments.out, *arguments.takes):
        arguments.out = out
        jobs.append(make_job(arguments, pipeline.recorded_session(out)))
        pipeline.start_record(jobs[-1])
    pipeline.fit_together(jobs)
    return exit_status(jobs[0])


def run_scan(arguments) -> int:
    from . import scan

    options = chosen_options(arguments, scan.GROUPS)
    scan_options, rest_options = options.pop("scan"), options.pop("rest")
    console = make_console(arguments)
    job = pipeline.Job(
        arguments.session, arguments.session, options, body_model=arguments.body_model or body_model_path(), console=console
    )
    if arguments.refine:
        made = scan.refine_scan(job, arguments.refine, rest_options, arguments.keypoints)
    else:
        made = scan.scan_session(job, scan_options, arguments.force, arguments.frame, arguments.keypoints, arguments.given)
    console.finish()
    print("\n".join(map(str, made.files)))
    for finding in made.findings:
        print(f"doublet: {finding.level}: {finding.text}", file=sys.stderr)
    return DOUBTFUL if made.findings else 0


#: What `doublet animate` takes flags of.
ANIMATE_GROUPS = {"retarget": d.RetargetOptions, "animate": d.AnimateOptions, "glb": d.BakedGlbOptions}


def run_animate(arguments) -> None:
    from . import bone_map
    from .character import Output, animate
    from .motions import read_clip

    options = chosen_options(arguments, ANIMATE_GROUPS)
    if arguments.write_bone_map:
        bone_map.write(arguments.write_bone_map, read_clip(arguments.motion), options["retarget"].joint_names)
        print(arguments.write_bone_map)
        return
    if not arguments.out:
        arguments.usage_error("the following arguments are required: -o/--out")
    console = make_console(arguments)
    output = Output(options["animate"], options["glb"], arguments.bone_map)
    frames = animate(arguments.character, arguments.motion, arguments.out, console, options["retarget"], output)
    console.finish()
    print(f"{arguments.out}: {frames} frames")


def run_view(arguments) -> None:
    from .view import write_view

    console = make_console(arguments)
    retargeting = chosen_options(arguments, {"retarget": d.RetargetOptions})["retarget"]
    characters = [arguments.character] + ([arguments.compare] if arguments.compare else [])
    write_view(arguments.out, characters, arguments.clip, retargeting, console.context())
    console.finish()
    print(arguments.out / "index.html")


def run_edit_template(arguments) -> None:
    from .edit_template import edit_template

    edit_template(arguments.out, arguments.port, arguments.browser)


def run_edit_segmentation(arguments) -> None:
    from .edit_segmentation import edit_segmentation

    edit_segmentation(arguments.out, arguments.port, arguments.browser)


def run_edit_joints(arguments) -> None:
    from .edit_joints import edit_joints

    edit_joints(arguments.session, arguments.port, arguments.browser)


def run_evaluate(arguments) -> None:
    from . import garment_motion
    from .evaluate import Reconstruction, Truth, evaluate, format_table

    console = make_console(arguments)
    if not arguments.out.is_dir():
        raise FileNotFoundError(f"{arguments.out} is not a folder")
    session = d.Session(arguments.session or pipeline.recorded_session(arguments.out))
    refined = arguments.out / pipeline.CALIBRATION
    filmed = session.recalibrated(refined) if refined.exists() else session
    result = evaluate(arguments.out, arguments.truth, filmed, console, arguments.every)
    if arguments.motion:
        result["motion"] = garment_motion.compare(Reconstruction(arguments.out), Truth(arguments.truth), session.fps)
    if arguments.json:
        print(json.dumps(result, indent=1))
        return
    print(format_table(result))
    if arguments.motion:
        print(f"\n{garment_motion.format_table(result['motion'])}")


def run_study(arguments) -> None:
    from . import study

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


MOTION_HELP = (
    ".bvh, .amc with its .asf beside it, a clip in .glb, poses of SMPL, SMPL-H or SMPL-X (AMASS) in .npz, or a performance.npz"
)


def run_synthesize(arguments) -> None:
    from .motions import read_motion
    from .synthesize import SynthesisOptions, synthesize

    console = make_console(arguments)
    character = d.Character.read(arguments.character)
    chosen = {f.name: getattr(arguments, f.name) for f in fields(SynthesisOptions) if f.name not in ("key_colour",)}
    options = SynthesisOptions(**chosen)
    options.validate()
    if arguments.material:
        character.materials = [pipeline.with_pairs(m, arguments.material, "--material") for m in character.materials]
    retargeting = chosen_options(arguments, {"retarget": d.RetargetOptions})["retarget"]
    retargeting.fps = 1 / character.solver.dt
    motion = read_motion(arguments.motion, character, retargeting)
    rig = d.Session(arguments.cameras).rig if arguments.cameras else None
    frames = synthesize(character, motion, arguments.out, options, rig, console)
    console.finish()
    print(f"{arguments.out}: {frames} frames")


def run_train_body(arguments) -> None:
    options = chosen_options(arguments, {"train": d.TrainOptions})["train"]
    options.command = f"doublet train-body {arguments.population.name} -o {arguments.out.name}"
    console = make_console(arguments)
    summary = d.train_body_model(arguments.population, arguments.out, options, console.context())
    console.finish()
    print(
        f"{arguments.out}: {summary.components} shape components of {summary.meshes} meshes, "
        f"{100 * summary.variance_kept:.2f} % of the variance, {summary.reconstruction_mm:.2f} mm mean vertex error"
    )


def common_flags(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--threads", type=int, default=0, metavar="N", help="worker threads, 0 = one a core; results do not depend on it"
    )
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of every random choice (default: 1)")
    parser.add_argument("--quiet", action="store_true", help="no progress")
    parser.add_argument("--verbose", action="store_true", help="show what the stages say, not only their progress")
    parser.add_argument("--debug", action="store_true", help="show the traceback of an error")


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


def build_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="doublet", description="Animatable doubles of people in loose clothing, from video.")
    parser.add_argument("--version", action="version", version=__version__)
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    reconstruct = commands.add_parser("reconstruct", help="a capture session -> an animatable character and a report")
    reconstruct.add_argument("session", type=Path, nargs="?", metavar="SESSION", help="folder with session.json")
    reconstruct.add_argument("-o", "--out", type=Path, metavar="OUT", help="folder of the results; an earlier run goes on")
    text = "write every option with its value, unit and bounds to a file for --config, and run nothing"
    reconstruct.add_argument("--write-config", type=Path, metavar="FILE", help=text)
    add_stage_flags(reconstruct, pipeline.OPTION_GROUPS, with_body_model=True)
    shorten_help(reconstruct, USUAL)
    usage = "doublet reconstruct SESSION -o OUT [options]\n       doublet reconstruct --write-config FILE [options]"
    reconstruct.usage = usage
    reconstruct.set_defaults(run=run_reconstruct, usage_error=reconstruct.error)

    for name, (stages, text) in STAGE_COMMANDS.items():
        command = commands.add_parser(name, help=text, description=text)
        if name in ("check", "template", "capture"):
            command.add_argument("session", type=Path, metavar="SESSION", help="folder with session.json")
            command.add_argument("-o", "--out", type=Path, required=True, metavar="OUT", help="folder of the results")
        else:
            command.add_argument("out", type=Path, metavar="OUT", help="folder of the results so far")
            if name == "fit":
                more = "more takes of the same garment: one material and one width are found that explain all of them together"
                command.add_argument("takes", type=Path, nargs="*", metavar="OUT", help=more)
            command.add_argument("--session", type=Path, metavar="DIR", help="default: the one that OUT was made from")
        used = {group for stage in pipeline.STAGES if stage.name in stages for group in stage.groups}
        groups = {group: c for group, c in pipeline.OPTION_GROUPS.items() if group in used}
        add_stage_flags(command, groups, with_body_model=name == "body")
        command.set_defaults(run=run_fit if name == "fit" else run_stages, stages=stages)

    new_session.add_command(commands, common_flags)
    import_calibration.add_command(commands)
    add_scan(commands)
    add_edit_joints(commands)
    add_edit_template(commands)
    add_edit_segmentation(commands)
    add_animate(commands)
    add_view(commands)
    add_evaluate(commands)
    add_study(commands)
    add_synthesize(commands)
    add_train_body(commands)
    return parser


def add_stage_flags(parser, groups, with_body_model: bool) -> None:
    parser.add_argument("--force", action="store_true", help="run even if up to date, and overwrite files made elsewhere")
    parser.add_argument("--keep-going", action="store_true", help="go on with a result that cannot be true")
    parser.add_argument("--config", type=Path, metavar="FILE", help="options from a TOML file; flags beat it")
    if with_body_model:
        parser.add_argument("--body-model", type=Path, metavar="FILE", help="statistical body (default: the one that ships)")
    common_flags(parser)
    parser.set_defaults(seed=None)  # 1, unless the file of --config has another
    add_option_flags(parser, groups)


def frame_or_best(text: str) -> int | str:
    if text != "best" and not text.isdecimal():
        raise argparse.ArgumentTypeError(f"expected the number of a frame, or best, found '{text}'")
    return text if text == "best" else int(text)


def add_scan(commands) -> None:
    from .scan import GROUPS

    text = "scan and joints of a session that has none, from its cameras"
    scan = commands.add_parser("scan", help=text, description=text)
    scan.add_argument("session", type=Path, metavar="SESSION", help="folder with session.json; gets scan.ply and joints.json")
    scan.add_argument("--force", action="store_true", help="make them anew, and overwrite files made elsewhere")
    scan.add_argument(
        "--frame",
        type=frame_or_best,
        default=0,
        metavar="N",
        help="frame in which the person stands upright, arms and legs apart, or 'best': found; the session then begins there "
        "(default: 0)",
    )
    scan.add_argument(
        "--keypoints",
        type=Path,
        metavar="FOLDER",
        help="joints in the images, of OpenPose, RTMPose or MediaPipe: a JSON file or a folder of them for each camera",
    )
    scan.add_argument(
        "--given",
        type=Path,
        metavar="FILE",
        help="a scan in the pose of the frame, in any unit, on any axis, with its floor: brought to what the cameras see",
    )
    scan.add_argument(
        "--refine",
        type=Path,
        metavar="OUT",
        help="correct the scan by what was tracked with it: a folder of reconstruct, which is then to be run again",
    )
    scan.add_argument("--body-model", type=Path, metavar="FILE", help="statistical body (default: the one that ships)")
    common_flags(scan)
    add_option_flags(scan, GROUPS)
    scan.set_defaults(run=run_scan)


def add_edit_template(commands) -> None:
    text = "paint the template's invalid triangles in a browser"
    edit = commands.add_parser("edit-template", help=text, description=text)
    edit.add_argument("out", type=Path, metavar="OUT", help="folder of the results so far, with a template")
    page_flags(edit)
    edit.set_defaults(run=run_edit_template)


def add_edit_segmentation(commands) -> None:
    text = "paint cloth, skin and seams between garments in a browser"
    edit = commands.add_parser("edit-segmentation", help=text, description=text)
    edit.add_argument("out", type=Path, metavar="OUT", help="folder of the results so far, with a segmentation")
    page_flags(edit)
    edit.set_defaults(run=run_edit_segmentation)


def add_edit_joints(commands) -> None:
    text = "move joints and landmarks in the cameras' images, in a browser"
    edit = commands.add_parser("edit-joints", help=text, description=text)
    edit.add_argument("session", type=Path, metavar="SESSION", help="folder with session.json that names its joints")
    page_flags(edit)
    edit.set_defaults(run=run_edit_joints)


def page_flags(command) -> None:
    command.add_argument("--port", type=int, default=0, metavar="N", help="of the page on this machine (default: any free one)")
    command.add_argument("--no-browser", dest="browser", action="store_false", help="only print the address")
    command.add_argument("--debug", action="store_true", help="show the traceback of an error")


def add_animate(commands) -> None:
    animate = commands.add_parser("animate", help="a character and a motion -> a new animation")
    animate.add_argument("character", type=Path, metavar="CHARACTER.glb")
    animate.add_argument("motion", type=Path, metavar="MOTION", help=MOTION_HELP)
    animate.add_argument("-o", "--out", type=Path, metavar="OUT", help=".npz, .glb, .usdc, .mp4, or .bvh of the skeleton alone")
    text = "write which joint of the motion plays which of ours, and how that was guessed, for --bone-map, and run nothing"
    animate.add_argument("--write-bone-map", type=Path, metavar="FILE", help=text)
    text = "which joint of the motion plays which of ours, from a TOML file; --retarget-joint-names beats it"
    animate.add_argument("--bone-map", type=Path, metavar="FILE", help=text)
    common_flags(animate)
    add_option_flags(animate, ANIMATE_GROUPS)
    animate.usage = (
        "doublet animate CHARACTER.glb MOTION -o OUT [options]\n"
        "       doublet animate CHARACTER.glb MOTION --write-bone-map FILE [options]"
    )
    animate.set_defaults(run=run_animate, usage_error=animate.error)


def add_view(commands) -> None:
    text = "a page on which a character dances, its cloth simulated in the browser, with sliders for its material"
    view = commands.add_parser("view", help=text, description=text)
    view.add_argument("character", type=Path, metavar="CHARACTER.glb")
    clips = f"to dance to, any number of them; {MOTION_HELP} (default: it turns to and fro)"
    view.add_argument("--clip", type=Path, nargs="+", default=[], metavar="MOTION", help=clips)
    view.add_argument("--compare", type=Path, metavar="OTHER.glb", help="a second character, beside it")
    view.add_argument("-o", "--out", type=Path, required=True, metavar="FOLDER", help="gets index.html, to be opened as it lies")
    common_flags(view)
    add_option_flags(view, {"retarget": d.RetargetOptions})
    view.set_defaults(run=run_view)


def add_evaluate(commands) -> None:
    evaluate = commands.add_parser("evaluate", help="errors of a reconstruction against a ground truth")
    evaluate.add_argument("out", type=Path, metavar="OUT")
    evaluate.add_argument("--truth", type=Path, required=True, metavar="DIR", help="ground_truth folder")
    evaluate.add_argument("--session", type=Path, metavar="DIR", help="default: the one that OUT was made from")
    evaluate.add_argument("--every", type=int, default=1, metavar="N", help="measure every n-th frame (default: all)")
    text = "also how true and simulated garment move: speed, lag, fast motion, folds; every frame"
    evaluate.add_argument("--motion", action="store_true", help=text)
    evaluate.add_argument("--json", action="store_true", help="print JSON instead of a table")
    common_flags(evaluate)
    evaluate.set_defaults(run=run_evaluate)


def add_study(commands) -> None:
    text = "many material fits, over reconstructions and seeds, on many processes or machines"
    study = commands.add_parser("study", help=text, description=text)
    study.add_argument("outs", type=Path, nargs="+", metavar="OUT", help="reconstructions up to stage 'garment'")
    study.add_argument("-o", "--results", type=Path, required=True, metavar="FILE.jsonl", help="one line a fit; goes on with it")
    study.add_argument("--seeds", type=int, nargs="+", default=[1], metavar="N", help="of each fit (default: 1)")
    study.add_argument("--workers", type=int, default=1, metavar="N", help="processes on this machine (default: 1)")
    study.add_argument("--dask", metavar="ADDRESS", help="a Dask scheduler to use instead, e.g. tcp://host:8786")
    study.add_argument("--quiet", action="store_true", help="no progress")
    study.add_argument("--debug", action="store_true", help="show the traceback of an error")
    add_option_flags(study, {g: pipeline.OPTION_GROUPS[g] for g in ("cloth", "energy", "fit", "space")})
    study.set_defaults(run=run_study)


def add_synthesize(commands) -> None:
    text = "a character and a motion -> a capture session with known truth"
    synthesize = commands.add_parser("synthesize", help=text, description=text)
    synthesize.add_argument("character", type=Path, metavar="CHARACTER.glb")
    synthesize.add_argument("--motion", type=Path, required=True, metavar="FILE", help=MOTION_HELP)
    synthesize.add_argument("-o", "--out", type=Path, required=True, metavar="SESSION", help="folder of the new session")
    synthesize.add_argument("--cameras", type=Path, metavar="DIR", help="those of this session (default: a ring of them)")
    synthesize.add_argument(
        "--material", nargs="+", metavar="NAME=X", help="of every cloth region, e.g. k_bend=0.7 (default: the character's)"
    )
    flag = synthesize.add_argument
    flag("--camera-count", type=int, default=8, metavar="N", help="of the ring (default: 8)")
    flag("--image-size", type=int, default=1004, metavar="N", help="px, of the ring's images (default: 1004)")
    flag("--frame-count", type=int, default=-1, metavar="N", help="default: the whole motion")
    flag("--noise", type=float, default=0.0, metavar="X", help="grey levels, sensor noise (default: 0)")
    flag("--blur", type=float, default=0.0, metavar="X", help="px, Gaussian blur (default: 0)")
    flag("--scan-noise", type=float, default=0.0004, metavar="X", help="m, noise of the scan (default: 0.0004)")
    flag("--mark-noise", type=float, default=0.004, metavar="X", help="m, noise of the marked joints (default: 0.004)")
    flag("--mask-step", type=int, default=10, metavar="N", help="true masks every n-th frame (default: 10)")
    common_flags(synthesize)
    add_option_flags(synthesize, {"retarget": d.RetargetOptions})
    synthesize.set_defaults(run=run_synthesize)


def add_train_body(commands) -> None:
    train = commands.add_parser("train-body", help="registered meshes -> statistical body model")
    train.add_argument("population", type=Path, metavar="POPULATION.npz")
    train.add_argument("-o", "--out", type=Path, required=True, metavar="MODEL.npz")
    common_flags(train)
    add_option_flags(train, {"train": d.TrainOptions})
    train.set_defaults(run=run_train_body)


def what_is_left(parsed) -> str:
    """After a command that was stopped."""
    return getattr(parsed, "when_stopped", "what is complete stays, the same command goes on from there")


def is_no_memory(error: Exception) -> bool:
    """Also TBB's words, in Embree and OpenCV, where there is no room for the stack of a thread."""
    return isinstance(error, MemoryError) or str(error).startswith("pthread_create has failed")


def no_memory(parsed, error: Exception) -> str:
    said = str(error)
    found = f"({said[0].lower()}{said[1:]})" if said and said != "std::bad_alloc" else ""
    return f"expected more memory than this process may have {found}; {what_is_left(parsed)}".replace(" ;", ";")


def main(arguments=None) -> int:
    parsed = build_parser().parse_args(arguments)
    try:
        with stopped_by_signals():
            return parsed.run(parsed) or 0
    except KeyboardInterrupt as stop:
        print(f"doublet: stopped; {what_is_left(parsed)}", file=sys.stderr)
        return getattr(stop, "status", 128 + signal.SIGINT)
    except BrokenPipeError:
        return 1
    except Exception as error:
        if parsed.debug:
            raise
        if is_no_memory(error):
            error = RuntimeError(no_memory(parsed, error))
        expected = isinstance(error, (RuntimeError, OSError, ValueError))
        if isinstance(error, OSError) and error.filename and error.strerror:
            error = f"{error.filename}: {error.strerror}"
        text = str(error) if expected else f"internal error: {type(error).__name__}: {error} (--debug shows where)"
        print(f"doublet: {' '.join(text.split())}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
