"""Sect. 7, the artificial data set: a reconstructed character is given a material, animated on its own motion and filmed.
What an estimation needs of it lies in a folder of its own, a reconstruction for `doublet.evaluation.study`."""

import hashlib
import json
import shutil
from dataclasses import asdict, dataclass
from pathlib import Path

import doublet as d
import numpy as np
from doublet import reconstruct
from doublet.common.console import Console
from doublet.common.files import write_json
from doublet.evaluation import study
from doublet.evaluation.synthesize import Surfaces, SynthesisOptions, synthesize
from doublet.export.clips import read_motion
from reconstructions import plain_job

MARKS = 1500  # points on the surface that perfect observations follow
SAME_SURFACE = 0.005  # m: a mark this close to what the camera sees is seen
AS_FITTED = {"edge_collision": False, "resolve_arm_penetration": False}  # what animations have and estimations do not


@dataclass(frozen=True)
class Filming:
    """How the character is filmed."""

    cameras: int = 0  # every n-th of the session's so that as many are left; 0 = all
    frames: int = -1  # the first so many; -1 = the whole motion
    noise: float = 3.0  # grey levels
    perfect: bool = False  # no images: outlines of rendered masks, and points of the surface projected


class GivenPose(d.PoseOptimizer):
    """Frame after frame of known poses."""

    def __init__(self, dofs: np.ndarray):
        super().__init__()
        self.dofs = iter(dofs)

    def optimize(self, problem, context=None):
        estimate = d.PoseEstimate()
        estimate.dofs = next(self.dofs)
        return estimate


class ExpectedSurface(d.SurfaceRefiner):
    """Leaves the surface as the pose has it."""

    def refine(self, problem, context=None):
        estimate = d.SurfaceEstimate()
        estimate.vertices = problem.base
        return estimate


def seen_in_images(made: reconstruct.Job, dofs: np.ndarray) -> d.Observations:
    """Contours and feature matches of made.session's images, by the pipeline's own capture with the poses given: neither
    depends on pose or surface."""
    # The poses are given, one a frame, of the actor as it is.
    once = {"second_pass": False, "extra_twist_range": 0.0, "refine_cameras": False}
    options = d.CaptureOptions(find_lost_limbs=False, use_feature_map=False, smooth_window=1, **once)
    options.features = made.options["features"]
    capture = d.PerformanceCapture.create(options, d.CaptureParts(pose=GivenPose(dofs), surface=ExpectedSurface()))
    frames = d.FrameSource.open(made.session)
    return capture.capture(made.results.actor, made.session.rig, frames, made.silhouettes, made.context).observations


class PerfectViews:
    """Observations without images."""

    def __init__(self, character: d.Character, rig: list[d.Camera], seed: int = 1):
        self.actor, self.rig, self.shown = character.actor, rig, Surfaces(character)
        mesh, random = self.actor.mesh, np.random.default_rng(seed)
        area = d.face_areas(mesh.vertices, mesh.faces) * np.asarray(self.actor.face_valid, bool)
        self.corners = mesh.faces[random.choice(len(area), MARKS, p=area / area.sum())]
        self.weights = random.dirichlet(np.ones(3), MARKS)
        self.before = None
        self.views = []

    def add(self, frame: d.AnimationFrame) -> None:
        body, cloth = self.shown.split(frame)
        now = [self.marks(frame.surface, camera) for camera in self.rig]
        views = []
        for camera, (pixels, seen), (old, seen_before) in zip(self.rig, now, self.before or now):
            mask = np.where(self.shown.mask(body, cloth, camera) > 0, 255, 0).astype(np.uint8)
            both = seen & seen_before if self.before else np.zeros(MARKS, bool)
            views.append(d.ViewObservation(d.trace_outline(mask).points, np.hstack([old, pixels])[both].astype(np.float32)))
        self.before = now
        self.views.append(views)

    def marks(self, surface: np.ndarray, camera: d.Camera) -> tuple[np.ndarray, np.ndarray]:
        """Pixels (MARKS, 2), and which of them the camera sees."""
        points = np.einsum("mk,mkx->mx", self.weights, surface[self.corners])
        pixels = np.array([camera.project(point) for point in points])
        _, depth = d.rasterize(surface, self.actor.mesh.faces, camera, self.actor.face_valid)
        x, y = pixels.round().astype(int).T
        inside = (x >= 0) & (x < camera.width) & (y >= 0) & (y < camera.height)
        away = (points @ np.asarray(camera.R).T + np.asarray(camera.t).ravel())[:, 2]
        seen = depth[y.clip(0, camera.height - 1), x.clip(0, camera.width - 1)]
        return pixels, inside & (np.abs(seen - away) < SAME_SURFACE)

    def observations(self) -> d.Observations:
        result = d.Observations()
        result.cameras, result.views, result.frames = self.rig, self.views, list(range(len(self.views)))
        return result


def known_motion(made: study.Film, frames: int) -> d.ReferencePerformance:
    """The poses of OUT, of the bare actor. Cloth starts as that of an animation does: the loose part of the template from the
    skinned surface, a garment with a mesh of its own from its rest shape. The captured surfaces after it only say where images
    matter."""
    performance = made.results.performance()
    dofs, surfaces = performance.dofs[:frames], np.array(performance.surface.frames[:frames])
    surfaces[0] = d.pose_surface(made.results.actor, dofs[0])
    result = d.ReferencePerformance()
    result.dofs, result.frames, result.joints = dofs, list(range(len(dofs))), performance.joints[:frames]
    result.surface = d.MeshSequence(performance.surface.faces, surfaces)
    return result


def chosen_cameras(session: d.Session, count: int) -> list[d.Camera]:
    rig = session.rig
    if count > len(rig):
        raise ValueError(f"--cameras is {count}, the session has {len(rig)}")
    return [rig[i * len(rig) // count] for i in range(count)] if count else list(rig)


def filmed(out: Path, session_folder: Path | None, truth: d.Material, how: Filming, work: Path) -> tuple[Path, dict]:
    """(folder, options): a reconstruction of the character of OUT under `truth`, up to what an estimation needs, and the
    options under which it is compared as it was animated. A folder that is there already is used."""
    base = plain_job(out, session_folder)
    made = study.film_of(base)
    session = d.Session(session_folder or reconstruct.recorded_session(out))
    settle = round(d.AnimateOptions().settle_seconds * base["fps"])
    # By images alone: the surface was captured of another material.
    options = {**base["options"], "energy.settle_frames": settle, "energy.delta": 0.0}
    request = {"of": base, "character": d.hash_files(out / "character.glb"), "truth": truth.to_dict(), "filming": asdict(how)}
    request["animated"] = AS_FITTED
    folder = work / f"filmed-{hashlib.sha256(json.dumps(request, sort_keys=True).encode()).hexdigest()[:12]}"
    if (folder / "filming.json").exists():
        return folder, options

    character = d.Character.read(out / "character.glb")
    character.materials = [truth] * len(character.materials)
    character.solver = d.SolverSettings(1 / base["fps"], made.options["cloth"])
    motion = read_motion(out / "performance.npz", character, d.RetargetOptions(fps=base["fps"]))
    frames = len(motion) if how.frames < 0 else min(how.frames, len(motion))
    motion = d.Motion(motion.fps, motion.dofs[:frames])
    rig, console = chosen_cameras(session, how.cameras), Console()
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("actor.npz", "segmentation.npz", "proxies.json", "garment.npz", "material.json"):  # the last has the width
        shutil.copy(out / name, folder / name)
    performance = known_motion(made, frames)
    d.write_performance(folder / "performance.npz", performance)
    if how.perfect:
        views = PerfectViews(character, rig)
        animating = d.AnimateOptions(high=views.shown.has_high, **AS_FITTED)
        d.animate_each(character, motion, views.add, animating, console.context())
        observations = views.observations()
    else:
        video = folder / "session"
        if not (video / "session.json").exists():
            synthesize(character, motion, video, SynthesisOptions(noise=how.noise), rig, console)
        observations = seen_in_images(reconstruct.Job(video, folder, made.options, console=console), performance.dofs)
    console.finish()
    d.write_observations(folder / "observations.npz", observations)
    write_json(folder / "filming.json", request)  # last: a folder with it is complete
    return folder, options
