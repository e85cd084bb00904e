"""`doublet scan`: what a session without scanner and clicked joints lacks, from its own cameras: scan.ply and joints.json."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import _doublet as d
from . import pipeline, session_check
from .files import write_json
from .plausible import Finding

#: Option groups of the command.
GROUPS = {
    "scan": d.ViewScanOptions,
    "body": d.BodyFitOptions,
    **{name: pipeline.OPTION_GROUPS[name] for name in ("silhouette", "key", "background")},
}
SCAN, MARKS, PICTURE = "scan.ply", "joints.json", "scan_check.png"
#: Above this ratio it is hard to tell which way the person faces.
LIKELY_RIVAL = 0.7
#: Octree depth of the closed surface that the body is fitted to: joints need no fingers.
MARKS_DEPTH = 8


@dataclass
class Made:
    """What was written, and what is doubtful about it."""

    files: list[Path]
    findings: list[Finding]


def scan_session(job: pipeline.Job, options: d.ViewScanOptions | None = None, force: bool = False) -> Made:
    """Writes scan and joints into the folder of the job's session where it names none (`force`: anew), at frame 0, where the
    tracker starts, and a picture that shows both. A session that has both is refused."""
    folder = job.session_folder
    description = read_description(folder)
    wanted = [key for key in ("scan", "markers") if force or not description.get(key)]
    if not wanted:
        raise RuntimeError(f"{folder / 'session.json'}: names a scan and joints already; --force makes them anew")
    made = []
    if "scan" in wanted:
        d.write_mesh(claimed(folder / SCAN, force), scan_of(job, options or d.ViewScanOptions()))
        made.append(folder / SCAN)
        description["scan"] = SCAN
        write_json(folder / "session.json", description)
        job.__dict__.pop("session", None)
    rival = 0.0
    if "markers" in wanted:
        marks = marks_of(job)
        rival = marks.rival
        write_json(claimed(folder / MARKS, force), joints_file(marks))
        made.append(folder / MARKS)
        description["markers"] = MARKS
        write_json(folder / "session.json", description)
        job.__dict__.pop("session", None)
    evidence = session_check.Evidence(job.session, d.FrameSource.open(job.session), job.silhouettes)
    session_check.write_picture(folder / PICTURE, session_check.draw(evidence))
    return Made([*made, folder / PICTURE], [*facing(rival), *session_check.check_session(evidence)])


def read_description(folder: Path) -> dict:
    d.Session(folder)  # says what is wrong with it
    return json.loads((folder / "session.json").read_text(encoding="utf-8"))


def claimed(path: Path, force: bool) -> Path:
    if path.exists() and not force:
        raise FileExistsError(f"{path} exists, but session.json does not name it; --force overwrites it")
    return path


def scan_of(job: pipeline.Job, options: d.ViewScanOptions) -> d.Mesh:
    frames = d.FrameSource.open(job.session)
    views = [d.read_view(frames, camera, 0, job.silhouettes) for camera in range(frames.camera_count)]
    return d.scan_from_views(job.session.rig, views, options, job.context)


def marks_of(job: pipeline.Job) -> d.BodyMarks:
    surface = d.build_template(d.read_mesh(job.session.scan), d.TemplateOptions(poisson_depth=MARKS_DEPTH), job.context)
    model = d.BodyModel.read(job.body_model)
    return d.find_body_marks(surface.mesh, surface.face_valid, model, job.group("body"), job.context)


def joints_file(marks: d.BodyMarks) -> dict:
    """joints.json"""

    def rounded(point) -> list[float]:
        return [round(float(x), 4) for x in np.ravel(point)]

    return {
        "comment": f"found by doublet scan with {marks.fit.model}",
        "joints": {j.name: {"position": rounded(j.position), "parent": j.parent or None} for j in marks.joints},
        "landmarks": {name: rounded(point) for name, point in marks.landmarks.items()},
    }


def facing(rival: float) -> list[Finding]:
    if rival <= LIKELY_RIVAL:
        return []
    return [Finding(False, f"the joints: front and back of the person were hard to tell apart (ratio {rival:.2f})")]
