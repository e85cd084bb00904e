"""`doublet scan`: what a session without scanner and clicked joints lacks, from its own cameras: scan.ply and joints.json."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .. import _doublet as d
from ..common.files import read_json, write_json
from ..common.scan_frame import scan_frame
from ..reconstruct import OPTION_GROUPS, Job
from ..session import check
from ..session.keypoints import adopt_keypoints, kept_joints

#: Option groups of the command.
GROUPS = {
    "scan": d.ViewScanOptions,
    "body": d.BodyFitOptions,
    "rest": d.RestPoseOptions,
    **{name: OPTION_GROUPS[name] for name in ("silhouette", "key", "background")},
}
BEST = "best"
SCAN, MARKS, PICTURE = "scan.ply", "joints.json", "scan_check.png"
FIRST_SCAN = "scan_before.ply"
WRITTEN = (".ply", ".obj", ".stl", ".off")  #: meshes; others, as .glb, are only read
#: What joints.json says of joints that this command has found; others are a person's, and stay.
FOUND = "found by doublet scan"
#: m; of the valid template from the scan on average, above which it was made from another.
OF_ANOTHER_SCAN = 0.01
#: m; of the skin, by which a correction is told from the template's own distance from the scan.
CLEARLY_MOVED = 0.005
#: Above this ratio it is hard to tell which way the person faces.
LIKELY_RIVAL = 0.8
#: m; a joint farther from where keypoints see it is put there.
FAR_FROM_KEYPOINT = 0.06
#: The hull that a given scan is aligned to, and that a body is first fitted to.
COARSE = d.ViewScanOptions(cell=0.012, poisson_depth=7, search_depth=0)
#: How coarsely frames are tried for the best one, and how many at most.
TRIED, MOST_TRIED = d.ViewScanOptions(cell=0.02, poisson_depth=6, search_depth=0), 24
#: Octree depth of the closed surface that the body is fitted to: joints need no fingers.
MARKS_DEPTH = 8


@dataclass
class ScanResult:
    """What was written, and what is doubtful about it."""

    files: list[Path]
    findings: list[d.Finding]


def scan_session(
    job: Job,
    options: d.ViewScanOptions | None = None,
    force: bool = False,
    frame: int | str | None = None,
    keypoints: Path | None = None,
    given: Path | None = None,
) -> ScanResult:
    """Writes scan and joints into the folder of the job's session where it names none (`force`: anew), and a picture that shows
    both. A session that has scan and joints is refused.

    frame: where; tracking starts there, and goes both ways; BEST = found; None = 0, or the best one where nobody stands in that.
    keypoints: of all cameras, see filmed_keypoints(); the session keeps them.
    given: a scan of the same pose, which is brought to where the cameras see it."""
    folder = job.session_folder
    description = read_description(folder)
    wanted = [key for key in ("scan", "markers") if force or not description.get(key)]
    if not wanted and not keypoints:
        raise RuntimeError(f"{folder / 'session.json'}: names a scan and joints already; --force makes them anew")
    if frame is not None and "scan" not in wanted:
        raise RuntimeError(f"{folder / 'session.json'}: names a scan already; --force makes another at --frame")
    if given and "scan" not in wanted:
        raise RuntimeError(f"--given: {folder / 'session.json'} names a scan already; --force makes it anew")
    made = []
    if "scan" in wanted:
        chosen = best_frame(job) if frame == BEST else frame or 0
        require_frame(job, chosen)
    else:
        chosen = scan_frame(job.session)
    if keypoints:
        messages: list[str] = []
        description["keypoints"] = adopt_keypoints(job.session, keypoints, chosen, messages)
        for message in messages:
            job.console.say(message)
        made.append(folder / description["keypoints"])
        save(job, description)
    if "scan" in wanted:
        options = options or d.ViewScanOptions()
        mesh = aligned(job, given, chosen) if given else scan_of(job, options, chosen)
        d.write_mesh(require_free(folder / SCAN, force), mesh)
        made.append(folder / SCAN)
        description["scan"] = SCAN
        description["scan_from_views"], description["scan_frame"] = given is None, chosen
        save(job, description)
    findings: list[d.Finding] = []
    if "markers" in wanted:
        found = write_marks(job, force, of_cameras="scan" in wanted and not given)
        better = frame_that_would_do(job, chosen) if found.nobody and frame != BEST else None
        if better is not None and frame is None:
            job.console.say(f"scan: {found.nobody.text}; so frame {better} is taken, which is more like a standing body")
            return scan_session(job, options, True, better, keypoints)
        findings = reported(found, better, folder)
        made.append(folder / MARKS)
        description["markers"] = MARKS
        save(job, description)
    return with_check_picture(job, made, findings)


def seen_joints(job: Job, frame: int) -> dict[str, np.ndarray]:
    """name -> (3) m, of a session that has keypoints; none of others."""
    return kept_joints(job.session, frame) if job.session.keypoints.name else {}


@dataclass
class Marked:
    """What is doubtful about joints, and what tells that nobody stands in the frame."""

    findings: list[d.Finding]
    nobody: d.Finding | None
    written: bool = True


def write_marks(job: Job, force: bool, of_cameras: bool) -> Marked:
    """Writes joints.json, unless no person is found in a scan of the cameras."""
    path, seen = require_free(job.session_folder / MARKS, force), seen_joints(job, scan_frame(job.session))
    try:
        marks = marks_of(job, d.read_mesh(job.session.scan), seen)
    except d.Error as error:
        if not of_cameras:
            raise
        return Marked([], d.Finding(True, str(error)), written=False)
    write_json(path, corrected(joints_file(marks), seen, job))
    if not of_cameras:
        return Marked(facing_findings(marks), None)
    doubts = [*facing_findings(marks), *shape_findings(marks)]
    return Marked(doubts[:-1], doubts[-1] if doubts else None)


def shape_findings(marks: d.DetectedJoints) -> list[d.Finding]:
    """Of a body that nobody has: limbs that grew together, somebody who sits."""
    limit = next(limit for limit in d.quality_limits() if limit.number == "largest_coefficient")
    found = limit.check(float(np.abs(marks.fit.coefficients).max()))
    return [found] if found else []


def frame_that_would_do(job: Job, chosen: int) -> int | None:
    """Another one than was chosen, if there is any."""
    try:
        best = best_frame(job)
    except RuntimeError:
        return None
    return best if best != chosen else None


def reported(found: Marked, better: int | None, folder: Path) -> list[d.Finding]:
    """What is doubtful, and where nobody stands in the frame, which would do. Throws where there are no joints."""
    if not found.nobody:
        return found.findings
    text = found.nobody.text
    if better is not None:
        text += f"; frame {better} is more like a standing body: doublet scan {shlex.quote(str(folder))} --force --frame {better}"
    if not found.written:
        raise RuntimeError(text)
    return [*found.findings, d.Finding(found.nobody.impossible, text)]


def with_check_picture(job: Job, made: list[Path], findings: list[d.Finding]) -> ScanResult:
    picture = job.session_folder / PICTURE
    checked = check.check_and_draw(job.session, d.FrameSource.open(job.session), job.silhouettes, picture)
    return ScanResult([*made, picture], [*findings, *checked.findings])


def refine_scan(job: Job, out: Path, options: d.RestPoseOptions | None = None, force: bool = False) -> ScanResult:
    """The session's scan corrected by what was tracked with it: `out` is a folder of `reconstruct`, or of its stages to
    `segment`. Skin goes where the frames nearest to the rest pose have it, cloth stays (refine_rest_pose). The scan before is
    kept as FIRST_SCAN, joints that this command had found are found anew. A scan of a kind that cannot be written becomes SCAN
    (`force`: in the place of a file that the session does not name)."""
    path = Path(job.session.scan)
    if path == Path():
        raise RuntimeError(f"{job.session_folder / 'session.json'}: names no scan to refine; doublet scan makes one")
    target = path if path.suffix.lower() in WRITTEN else require_free(job.session_folder / SCAN, force)
    scan, actor = d.read_mesh(path), d.read_actor(out / "actor.npz")
    require_made_from(scan, actor, path, out)
    performance = d.read_performance(out / "performance.npz", actor)
    skin = np.asarray(d.read_segmentation(out / "segmentation.npz").clothness) == 0
    refined = d.refine_rest_pose(actor, performance, skin.astype(np.uint8), options or d.RestPoseOptions(), job.context)
    moved = 1000 * np.linalg.norm(refined - actor.mesh.vertices, axis=1)[skin]
    made, findings = [target], []
    if is_refined(scan, actor, refined, skin):  # the command was stopped, or given twice
        job.console.say(f"scan: {path} is corrected by {out} already, and stays as it is")
        made = []
    else:
        job.console.say(f"scan: skin moved by {np.mean(moved):.1f} mm, 5 % of it by over {np.percentile(moved, 95):.0f} mm")
        if not (job.session_folder / FIRST_SCAN).exists():
            d.write_mesh(job.session_folder / FIRST_SCAN, scan)
        fine = d.SurfaceTransfer(actor.mesh, [], scan, []).apply(refined)
        d.write_mesh(target, d.Mesh(fine, scan.faces))
        if target != path:
            save(job, {**read_description(job.session_folder), "scan": SCAN})
    if found_here(job.session_folder / MARKS):
        found = write_marks(job, force=True, of_cameras=True)
        findings = reported(found, None, job.session_folder)
        made.append(job.session_folder / MARKS)
    return with_check_picture(job, made, findings)


def is_refined(scan: d.Mesh, actor: d.RiggedMesh, refined: np.ndarray, skin: np.ndarray) -> bool:
    """Does the scan lie where the correction leads, and not where the template is, where these two are apart?"""
    apart = np.linalg.norm(refined - actor.mesh.vertices, axis=1) > CLEARLY_MOVED
    chosen = on_valid(actor)[(skin & apart)[on_valid(actor)]]
    if not len(chosen):
        return False
    scene = d.RayScene(scan)
    before, after = (scene.closest(vertices[chosen])[1].mean() for vertices in (actor.mesh.vertices, refined))
    return bool(after < before)


def on_valid(actor: d.RiggedMesh) -> np.ndarray:
    """Indices of the vertices that the scan supports."""
    return np.unique(actor.mesh.faces[np.asarray(actor.face_valid, bool)])


def require_made_from(scan: d.Mesh, actor: d.RiggedMesh, path: Path, out: Path) -> None:
    off = float(np.mean(d.RayScene(scan).closest(actor.mesh.vertices[on_valid(actor)])[1]))
    if off > OF_ANOTHER_SCAN:
        raise RuntimeError(
            f"{out / 'actor.npz'}: expected a template made from {path}, found one that is {1000 * off:.0f} mm off on average"
        )


def found_here(marks: Path) -> bool:
    return marks.exists() and str(read_json(marks).get("comment", "")).startswith(FOUND)


def require_frame(job: Job, frame: int) -> None:
    last = job.session.frame_count - 1
    if not 0 <= frame <= last:
        raise RuntimeError(f"--frame: expected 0 to {last}, found {frame}")
    if frame:
        job.console.say(
            f"scan: made at frame {frame} ({frame / job.session.fps:.2f} s); tracking starts there, and goes both ways"
        )


def save(job: Job, description: dict) -> None:
    write_json(job.session_folder / "session.json", description)
    job.reread_session()


def best_frame(job: Job) -> int:
    """The frame, of MOST_TRIED evenly spread over the take, whose coarse hull is most like a standing body."""
    frames, model = d.FrameSource.open(job.session), d.BodyModel.read(job.options.body_model)
    tried = np.unique(np.linspace(0, job.session.frame_count - 1, MOST_TRIED).astype(int))
    costs = {}
    quiet = d.Context(threads=job.context.threads)
    for i, frame in enumerate(tried):
        job.context.report_progress("scan: the best frame", i / len(tried))
        try:
            hull = d.scan_from_views(job.session.rig, views_at(job, frames, int(frame)), TRIED, quiet)
            marks = d.detect_joints(hull, [], model, d.BodyFitOptions(iterations=6), context=quiet)
        except d.Error:
            continue  # nobody, or nobody who stands: another frame may do
        costs[int(frame)] = marks.fit.residual * np.linalg.norm(marks.fit.coefficients)
    if not costs:
        raise RuntimeError(
            f"scan: in none of {len(tried)} frames of {job.session_folder} do the silhouettes show a standing person"
        )
    return min(costs, key=costs.get)


def views_at(job: Job, frames: d.FrameSource, frame: int) -> list[d.CameraView]:
    return [d.read_view(frames, camera, frame, job.silhouettes) for camera in range(frames.camera_count)]


def read_description(folder: Path) -> dict:
    """session.json. A scan or joints of this command's that were deleted are as if it did not name them."""
    path = folder / "session.json"
    try:
        d.Session(folder)  # says what is wrong with it
    except FileNotFoundError:
        description = read_json(path) if path.is_file() else {}
        deleted = [key for key, name in (("scan", SCAN), ("markers", MARKS)) if is_deleted(description, key, folder / name)]
        if not deleted:
            raise
        write_json(path, {key: value for key, value in description.items() if key not in deleted})
        d.Session(folder)
    return read_json(path)


def is_deleted(description: dict, key: str, made: Path) -> bool:
    return description.get(key) == made.name and not made.exists()


def require_free(path: Path, force: bool) -> Path:
    if path.exists() and not force:
        raise FileExistsError(f"{path} exists, but session.json does not name it; --force overwrites it")
    return path


def views_of(job: Job, frame: int) -> list[d.CameraView]:
    return views_at(job, d.FrameSource.open(job.session), frame)


def hull_of(job: Job, views: list[d.CameraView]) -> d.Mesh:
    return d.scan_from_views(job.session.rig, views, COARSE, job.context)


def scan_of(job: Job, options: d.ViewScanOptions, frame: int) -> d.Mesh:
    """The surface that the cameras see around a body, which is first fitted to their hull."""
    seen, views = seen_joints(job, frame), views_of(job, frame)
    hull = hull_of(job, views)
    try:
        body = marks_of(job, hull, seen).fit.body
    except d.Error as error:
        job.console.say(f"scan: no body was found in the cameras' hull, which is the scan as it is ({error})")
        body = None
    return d.scan_from_views(job.session.rig, views, options, job.context, body)


def corrected(marks: dict, seen: dict[str, np.ndarray], job: Job) -> dict:
    """joints.json with the joints that keypoints see somewhere else put there; what the model says of landmarks beyond them does
    not count then."""
    joints, landmarks = marks["joints"], marks["landmarks"]
    for name, point in seen.items():
        off = float(np.linalg.norm(point - joints[name]["position"]))
        if off > FAR_FROM_KEYPOINT:
            job.console.say(f"joints: {name} is {1000 * off:.0f} mm from where the keypoints see it, and was put there")
            joints[name]["position"] = rounded(point)
            ends = {"wrist": ("middle_fingertip", "thumb_tip"), "ankle": ("big_toe_tip", "heel")}.get(name[2:], ())
            for end in ends:
                landmarks.pop(f"{name[0]}_{end}", None)
    return marks


def rounded(point) -> list[float]:
    return [round(float(x), 4) for x in np.ravel(point)]


def aligned(job: Job, given: Path, frame: int) -> d.Mesh:
    found = d.align_scan(d.read_mesh(given), hull_of(job, views_of(job, frame)), job.context)
    floor = ", without its floor" if found.floor else ""
    off = f"{1000 * found.distance:.0f} mm from what the cameras see"
    job.console.say(f"scan: {given} is in {found.unit}, {found.up} is up{floor}; brought to {off}")
    return found.mesh


def marks_of(job: Job, scan: d.Mesh, seen: dict[str, np.ndarray]) -> d.DetectedJoints:
    surface = d.build_template(scan, d.TemplateOptions(poisson_depth=MARKS_DEPTH), job.context)
    model, options = d.BodyModel.read(job.options.body_model), job.options["body"]
    return d.detect_joints(surface.mesh, surface.face_valid, model, options, seen, job.context)


def joints_file(marks: d.DetectedJoints) -> dict:
    """joints.json"""
    return {
        "comment": f"{FOUND} with {marks.fit.model}",
        "joints": {j.name: {"position": rounded(j.position), "parent": j.parent or None} for j in marks.joints},
        "landmarks": {name: rounded(point) for name, point in marks.landmarks.items()},
    }


def facing_findings(marks: d.DetectedJoints) -> list[d.Finding]:
    rival = marks.facing_ambiguity
    if rival <= LIKELY_RIVAL:
        return []
    return [d.Finding(False, f"the joints: front and back of the person were hard to tell apart (ratio {rival:.2f})")]
