"""Runs stages that are not up to date, and notes what they ran on in run.json."""

from __future__ import annotations

from pathlib import Path

from .. import _doublet as d
from ..common.files import write_json
from ..common.quality_checks import Implausible, findings
from .job import Job
from .options import is_derived, plain
from .run_record import RunRecord
from .stage import Stage
from .stages import STAGES


def stage_options(job: Job, stage: Stage) -> dict:
    options = {f"{g}.{k}": plain(v) for g in stage.groups for k, v in job.options[g].to_dict().items() if not is_derived(g, k, v)}
    if stage.uses_seed:
        options["seed"] = job.seed
    if "energy" in stage.groups:
        options["fps"] = job.session.fps
    if stage.run not in {own.run for own in STAGES}:  # somebody else's: its results are not those of ours
        options["run"] = f"{stage.run.__module__}.{stage.run.__qualname__}"
    return options


def stage_inputs(job: Job, stage: Stage) -> dict[str, str]:
    """Hash of every input; throws FileNotFoundError naming the stage that writes a missing one."""
    inputs = {}
    for name in stage.reads:
        if not job.path(name).exists():
            writer = next(s.name for s in job.stages if name in s.writes)
            raise FileNotFoundError(f"{job.path(name)} is missing; stage '{writer}' writes it")
        inputs[name] = job.record.hash(job.path(name))
    inputs.update({name: job.record.hash(job.path(name)) for name in stage.may_read if job.path(name).exists()})
    for path in stage.session_files(job.session):
        inputs[f"session/{name_in_session(job.session, path)}"] = job.record.hash(path)
    if stage.uses_body_model:
        if not Path(job.body_model).exists():
            raise FileNotFoundError(f"{job.body_model} (the body model) does not exist")
        inputs["body model"] = job.record.hash(job.body_model)
    return inputs


def run_stage(job: Job, stage: Stage, force: bool = False) -> bool:
    """Runs a stage unless it is up to date; returns whether it ran. Throws Implausible if its result, old or new, cannot be true
    (what it wrote stays); says what is doubtful in it, and notes that in job.doubts."""
    ran = run_if_needed(job, stage, force)
    try:
        found = findings(stage.name, job.record.summary(stage.name))
    except (TypeError, ValueError) as error:
        job.record.refuse_summary(stage.name, error)
    for finding in found:
        if finding.impossible and not job.keep_going:
            raise Implausible(f"{stage.name}: {finding.text} (--keep-going goes on with it)")
        job.console.say(f"{stage.name}: {finding.level}: {finding.text}")
        job.doubts.append(finding)
    return ran


def run_if_needed(job: Job, stage: Stage, force: bool) -> bool:
    inputs, options = stage_inputs(job, stage), stage_options(job, stage)
    say = job.console.say
    if not force:
        foreign = job.record.foreign_outputs(stage.name, stage.writes)
        if foreign and all(job.path(o).exists() for o in stage.writes):
            say(f"{stage.name}: kept, {foreign[0]} was not written by this program (delete it, or --force, to compute it)")
            return False
        reason = job.record.reason_to_run(stage.name, inputs, options, stage.writes)
        if not reason:
            say(f"{stage.name}: up to date")
            return False
    else:
        reason = "forced"
        if job.record.is_done(stage.name):  # else the forced run was stopped, and goes on
            for name in stage.goes_on_from:
                job.path(name).unlink(missing_ok=True)
    say(f"{stage.name}: running ({reason})")
    job.console.log(f"== {stage.name}")
    with job.record.running(stage.name, inputs, options, stage.writes) as summary:
        summary.update(plain_summary(stage.run(job)))
    job.console.finish()
    entry = job.record.data["stages"][stage.name]
    say(f"{stage.name}: done in {entry['seconds']:.1f} s, peak memory {entry['peak_memory_mb']:.0f} MB")
    return True


def plain_summary(summary: dict) -> dict:
    """Rounded to what matters, so that run.json reads well."""
    return {k: float(f"{v:.6g}") if isinstance(v, float) else plain(v) for k, v in summary.items()}


def refuse_other_session(job: Job) -> None:
    """A folder of results is of one session, which may have been moved but is the same in every file that was read."""
    before = job.record.data.get("session")
    if not before or Path(before) == job.session.folder:
        return
    read = {name: known for stage in job.record.data["stages"].values() for name, known in stage.get("inputs", {}).items()}
    for name, known in read.items():
        if not name.startswith("session/"):
            continue
        path = job.session.folder / name.removeprefix("session/")
        if not path.exists() or job.record.hash(path) != known:
            raise d.Error(f"{job.out} holds results of {before}, which is not {job.session.folder}; choose another folder")


def start_record(job: Job, scanned: bool = True) -> None:
    """Writes what the whole run was asked to do. Throws Error if the folder has the results of another session, or if the session
    has no scan or joints, which only `check` does without."""
    if job.out.exists() and not job.out.is_dir():
        raise RuntimeError(f"{job.out}: expected a folder for the results, found a file")
    refuse_other_session(job)
    require_start_in_take(job)
    if scanned:
        d.require_scanned(job.session)
    job.out.mkdir(parents=True, exist_ok=True)
    job.console.log_file = job.path("log.txt")
    job.record.data["session"] = str(job.session.folder)
    job.record.data["seed"] = job.seed
    job.record.data["threads"] = job.console.threads
    job.record.data["config"] = {"file": str(job.config), "hash": job.record.hash(job.config)} if job.config else None
    job.record.save()


def reconstruct(job: Job, force: bool = False) -> None:
    """All stages; those that are up to date are skipped."""
    session = job.session
    job.console.say(f"{session.name}: {len(session.cameras)} cameras, {session.frame_count} frames at {session.fps:g} fps")
    start_record(job)
    for stage in job.stages:
        run_stage(job, stage, force)
    write_json(job.record.path, job.record.data)


def recorded_session(out: Path) -> Path:
    """The session that OUT was made from."""
    record = RunRecord(out)
    if "session" not in record.data:
        raise FileNotFoundError(f"{record.path} does not name a session; give it with --session")
    return Path(record.data["session"])


def require_start_in_take(job: Job) -> None:
    """Throws ValueError if tracking would have to begin in a frame that is not tracked."""
    options = job.options["capture"]
    first, count, start = options.first_frame, options.frame_count, options.start_frame
    if start < 0:
        return
    last = (job.session.frame_count if count < 0 else first + count) - 1
    if not first <= start <= last:
        raise ValueError(f"capture.start_frame: expected one of the frames {first} to {last}, found {start}")


def name_in_session(session: d.Session, path: Path) -> Path:
    """Relative to the session's folder, or as it is: a session may name a video that lies elsewhere."""
    return path.relative_to(session.folder) if path.is_relative_to(session.folder) else path
