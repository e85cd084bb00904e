"""The stages in their order, each reading and writing its files (docs/formats.md): what `doublet reconstruct` runs."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from . import _doublet as d
from . import body_model_path, segmentation_paint, session_check, template_mask
from .appearance import first_colours
from .console import Console
from .files import write_json
from .plausible import Finding, Implausible, findings
from .run_record import RunRecord

#: Option groups: name on the command line (`--segment-diffusion`) -> class.
OPTION_GROUPS = {
    "template": d.TemplateOptions,
    "silhouette": d.SilhouetteOptions,
    "key": d.ChromaKeyOptions,
    "background": d.BackgroundOptions,
    "capture": d.CaptureOptions,
    "features": d.FeatureTrackerOptions,
    "pose": d.PoseOptions,
    "limbs": d.LimbSearchOptions,
    "annealing": d.ParticleAnnealingOptions,
    "surface": d.SurfaceOptions,
    "calibration": d.CalibrationRefinementOptions,
    "segment": d.SegmentOptions,
    "opposite": d.OppositeOptions,
    "fullness": d.FullnessOptions,
    "body": d.BodyFitOptions,
    "proxy": d.ProxyOptions,
    "garment": d.GarmentOptions,
    "cloth": d.ClothOptions,
    "energy": d.EnergyOptions,
    "fit": d.FitOptions,
    "space": d.ParameterSpace,
    "texture": d.TextureOptions,
}
#: Set by the session, by --seed or by the command itself, not by an option of their own.
DERIVED_FIELDS = {("energy", "dt"), ("fit", "seed"), ("annealing", "seed"), ("train", "command")}


def is_derived(group: str, name: str, value) -> bool:
    """Also of options that are a group of their own, such as `annealing` in `limbs`."""
    return (group, name) in DERIVED_FIELDS or type(value) is OPTION_GROUPS.get(name)


def make_options(group: str, options_class: type, **chosen):
    """The defaults, and what was chosen on top of them; of a material or a dict this may be NAME=X pairs."""
    values = options_class().to_dict()
    for name, value in chosen.items():
        pairs = takes_pairs(values.get(name)) and isinstance(value, list)
        values[name] = with_pairs(values[name], value, f"{group}.{name}") if pairs else value
    return options_class(**values)


def takes_pairs(value) -> bool:
    return isinstance(value, (d.Material, dict))


def with_pairs(before, pairs: list[str], where: str):
    """A material with settings such as "k_bend=0.7", or a dict of texts with any."""
    settings = dict(pair.partition("=")[::2] for pair in pairs)
    if isinstance(before, dict):
        return {**before, **settings}
    values = before.to_dict()
    for name, value in settings.items():
        if name not in values:
            raise ValueError(f"{where}: expected one of {', '.join(values)}, found '{name}'")
        try:
            values[name] = float(value)
        except ValueError:
            raise ValueError(f"{where}: expected a number for {name}, found '{value}'") from None
    return d.Material(**values)


@dataclass
class Job:
    """One reconstruction: where from, where to, how."""

    session_folder: Path
    out: Path
    options: dict = field(default_factory=dict)  # group -> Options object
    seed: int = 1
    body_model: Path = field(default_factory=body_model_path)
    console: Console = field(default_factory=Console)
    fps: float | None = None  # of the videos; None = as the session says
    keep_going: bool = False  # past a result that cannot be true
    config: Path | None = None  # the file that options are from, for the record
    stages: tuple[Stage, ...] = field(default_factory=lambda: STAGES)  # see with_stage
    doubts: list[Finding] = field(default_factory=list)  # what the stages that were asked for found doubtful

    def __post_init__(self):
        self.session_folder, self.out = Path(self.session_folder), Path(self.out)
        for name, options_class in OPTION_GROUPS.items():
            self.options.setdefault(name, options_class())

    @cached_property
    def session(self) -> d.Session:
        return d.Session(self.session_folder)

    @property
    def filmed(self) -> d.Session:
        """The session with the cameras that the performance was captured with: the refined ones, if there are any."""
        refined = self.path(CALIBRATION)
        return self.session.recalibrated(refined) if refined.exists() else self.session

    @cached_property
    def record(self) -> RunRecord:
        return RunRecord(self.out)

    @cached_property
    def silhouettes(self) -> d.SilhouetteExtractor | None:
        """Trained, for the cameras without ready masks; None if all have some."""
        return d.session_silhouettes(self.session, d.FrameSource.open(self.session), self.group("silhouette"), self.context)

    @property
    def context(self) -> d.Context:
        return self.console.context()

    def path(self, name: str) -> Path:
        return self.out / name

    def group(self, name: str):
        """The options of a group, and in them those of the groups that belong to it."""
        values = self.options[name].to_dict()
        inner = {k: self.group(k) for k, v in values.items() if type(v) is OPTION_GROUPS.get(k)}
        return OPTION_GROUPS[name](**{**values, **inner})

    @cached_property
    def actor(self) -> d.RiggedMesh:
        return d.read_actor(self.path("actor.npz"))

    def forget_garment(self) -> None:
        """Later stages read the files, so that a resumed run goes on with the same bits."""
        for read in ("offered_garment", "garment", "dressed"):
            self.__dict__.pop(read, None)

    def performance(self) -> d.ReferencePerformance:
        return d.read_performance(self.path("performance.npz"), self.actor)

    def segmentation(self) -> d.Segmentation:
        return d.read_segmentation(self.path("segmentation.npz"))

    @cached_property
    def offered_garment(self) -> d.Garment:
        """As the mesher made it, in several widths to choose from."""
        return d.read_garment(self.path("garment.npz"), self.actor)

    @cached_property
    def garment(self) -> d.Garment:
        """In the width that was estimated with the material; before, in the middle one."""
        material = self.path("material.json")
        return d.worn(self.offered_garment, d.read_widths(material) if material.exists() else [])

    @cached_property
    def dressed(self) -> d.DressedActor:
        """What is simulated: the actor in the garment of garment.npz."""
        return d.dress(self.actor, self.segmentation(), self.garment)

    def dressed_performance(self) -> d.ReferencePerformance:
        """Whatever the width: it is on the garment's mesh, which is that of all."""
        return d.dress(self.performance(), self.actor, self.offered_garment)

    def simulator(self, dressed: d.DressedActor | None = None) -> d.CharacterSimulator:
        """Of the dressed actor, that of garment.npz unless another is given: goes with the dressed performance."""
        dressed = dressed or self.dressed
        proxies = d.read_proxies(self.path("proxies.json"), self.actor.skeleton)
        return d.CharacterSimulator(dressed.actor, dressed.segmentation, proxies, self.options["cloth"])

    def take(self, garments: list[d.Garment] | None = None) -> d.Take:
        """What material and width are estimated from: the garment in each of these widths, default: in all that it offers."""
        garments = d.offered(self.offered_garment) if garments is None else garments
        simulators = [self.simulator(d.dress(self.actor, self.segmentation(), garment)) for garment in garments]
        observations = d.read_observations(self.path("observations.npz"))
        return d.Take(simulators, self.dressed_performance(), observations, self.solver_settings().dt)

    def energy_options(self) -> d.EnergyOptions:
        return d.EnergyOptions(**{**self.options["energy"].to_dict(), "dt": self.solver_settings().dt})

    def solver_settings(self) -> d.SolverSettings:
        """Without which the materials mean nothing."""
        return d.SolverSettings(1 / (self.fps or self.session.fps), self.options["cloth"])


@dataclass(frozen=True)
class Stage:
    name: str
    reads: tuple[str, ...]  # files of OUT
    writes: tuple[str, ...]  # files of OUT
    groups: tuple[str, ...]  # option groups
    run: Callable[[Job], dict]  # returns the numbers worth recording
    session_files: Callable[[d.Session], list[Path]] = lambda session: []
    may_read: tuple[str, ...] = ()  # files of OUT that count as inputs if they are there
    uses_seed: bool = False
    uses_body_model: bool = False
    goes_on_from: tuple[str, ...] = ()  # files of OUT that a stage that was stopped goes on from


CHECKPOINT = "fit_checkpoint.txt"
CAPTURE_CHECKPOINT = "capture_checkpoint.bin"
CALIBRATION = "calibration.yml"  # of OUT, if the cameras were refined


def run_check(job: Job) -> dict:
    evidence = session_check.Evidence(job.session, d.FrameSource.open(job.session), job.silhouettes, job.context)
    found = session_check.look(evidence, job.path("check.png"))
    if words := session_check.where_it_begins(evidence):
        job.console.finish()
        job.console.say(f"check: {words}")
    return {"findings": [asdict(finding) for finding in found], "frame": evidence.shown_frame}


def run_template(job: Job) -> dict:
    scan = d.read_mesh(job.session.scan)
    surface = d.build_template(scan, job.options["template"], job.context)
    d.write_mesh(job.path("template.ply"), surface.mesh)
    d.write_mesh(job.path("template_high.ply"), surface.high)
    d.write_template_suggestion(job.path(template_mask.SUGGESTED), surface)
    summary = d.summarise_template(surface, scan, job.context)
    return {
        f"{name}_{number}": value
        for name, quality in (("template", summary.mesh), ("display", summary.high))
        for number, value in quality_numbers(quality).items()
    }


def quality_numbers(quality: d.SurfaceQuality) -> dict:
    return {
        "triangles": quality.triangles,
        "self_intersections": quality.self_intersections,
        "suggested_invalid_area_m2": quality.invalid_area,
        "smallest_angle_degrees": quality.smallest_angle,
        "smallest_angle_1_percent_degrees": quality.first_centile_angle,
        "from_scan_mean_mm": 1000 * quality.scan_mean,
        "from_scan_max_mm": 1000 * quality.scan_max,
        "valid_to_scan_mean_mm": 1000 * quality.mean_to_scan,
        "valid_to_scan_max_mm": 1000 * quality.max_to_scan,
    }


def run_rig(job: Job) -> dict:
    surface = d.Template()
    surface.mesh = d.read_mesh(job.path("template.ply"))
    mask = template_mask.read(job.out)
    surface.face_valid = mask.tolist()
    actor = d.rig_template(surface, job.session.joints, job.context)
    d.write_actor(job.path("actor.npz"), actor)
    job.__dict__.pop("actor", None)  # later stages read the file, so that a resumed run goes on with the same bits
    areas = d.face_areas(actor.mesh.vertices, actor.mesh.faces)
    return {
        "mask": "edited" if job.path(template_mask.EDITED).exists() else "suggested",
        "invalid_area_m2": float(areas[~mask].sum()),
        "degrees_of_freedom": len(actor.skeleton.dof_names),
    }


def run_performance(job: Job) -> dict:
    options = job.group("capture")
    options.limbs.annealing.seed = job.seed
    options.checkpoint = job.path(CAPTURE_CHECKPOINT)
    frames, capture, silhouettes = d.FrameSource.open(job.session), d.PerformanceCapture.create(options), job.silhouettes
    try:
        result = capture.capture(job.actor, job.session.rig, frames, silhouettes, job.context)
    except KeyboardInterrupt:
        job.console.finish()
        if job.console.note.startswith("stopped"):
            job.console.say(f"performance: {job.console.note}")  # where the same command goes on
        raise
    d.write_observations(job.path("observations.npz"), result.observations)
    d.write_performance(job.path("performance.npz"), result.performance)
    write_refined_cameras(job, result)
    options.checkpoint.unlink(missing_ok=True)
    summary = result.summary
    return {
        "frames": len(result.performance.frames),
        "rim_px": float(np.mean(summary.rim_px)),
        "sift_px": float(np.mean(summary.sift_px)),
        "silhouette_iou_against_measured_masks": float(np.mean(summary.silhouette_iou)),
        "start_frame": summary.start_frame,
        "lost_limbs": len(summary.lost_limbs),
        "lost_limbs_recovered": sum(lost.recovered for lost in summary.lost_limbs),
        "frames_inferred": {sight.joint: sight.inferred for sight in summary.joints if sight.inferred},
        "frames_lost": {sight.joint: sight.lost for sight in summary.joints if sight.lost},
        "cameras_refined": summary.cameras_refined,
        "cameras": [plain_camera(camera) for camera in summary.cameras],
        "seconds_per_frame": summary.seconds_per_frame,
    }


def plain_camera(camera: d.RefinedCamera) -> dict:
    """What the take says about a camera, rounded to what matters."""
    return {
        "camera": camera.camera,
        "seen": camera.seen,
        "moved_mm": round(1000 * camera.moved, 2),
        "sure_mm": round(1000 * camera.sure, 2),
        "turned_degrees": round(camera.turned, 4),
        "shifted_mm": round(1000 * camera.shifted, 2),
        "focal_percent": round(100 * camera.focal, 3),
        "late_frames": round(camera.late, 3),
        "late_sure_frames": round(camera.late_sure, 3),
    }


def write_refined_cameras(job: Job, result: d.CaptureResult) -> None:
    """calibration.yml of OUT, which all later stages go by; none if the session's calibration is as good."""
    path = job.path(CALIBRATION)
    if not result.summary.cameras_refined:
        path.unlink(missing_ok=True)
        return
    filmed = d.filmed(job.session, result)
    cameras = [d.CalibratedCamera(c, lens, own.late) for c, lens, own in zip(filmed.rig, filmed.lenses, filmed.cameras)]
    d.write_calibration(path, cameras)
    moved = np.sqrt(np.mean([camera.moved**2 for camera in result.summary.cameras if camera.seen]))
    late = [f"{camera.camera} by {camera.delay}" for camera in result.summary.cameras if camera.delay]
    job.console.finish()
    job.console.say(
        f"performance: the calibration was {1000 * moved:.1f} mm off on the actor"
        + (f", and frames late: {', '.join(late)}" if late else "")
        + f"; {path} has the refined cameras"
    )


def run_segment(job: Job) -> dict:
    options, fullness = job.group("segment"), job.options["fullness"]
    segmenter, performance = d.ClothSegmenter.create(options), job.performance()
    if options.skin_colour > 0 or options.cloth_colour > 0:
        performance.surface.colours = first_colours(job.actor, performance, job.filmed, job.silhouettes, job.context)
    found = d.segment_performance(job.actor, performance, segmenter, fullness, job.context)
    result = with_paint(job, found)
    d.write_segmentation(job.path("segmentation.npz"), result)
    areas = d.vertex_areas(job.actor.mesh.vertices, job.actor.mesh.faces)
    cloth = result.clothness > 0.5
    doubtful = cloth_ends(job.actor, cloth, areas)
    text = "expected a garment without sole, hand or head, found the cloth to include what ends at {}; look at it"
    return {
        "findings": [asdict(Finding(False, text.format(joint), "cloth_ends")) for joint in doubtful],
        "thresholds_raised": thresholds_raised(job, result),
        "corrections": "none" if result is found else "painted",
        "regions": result.region_count,
        "doubtful_ends": doubtful,
        "cloth_area_m2": float(areas[cloth].sum()),
        "fullness": float(np.average(result.fullness[cloth], weights=areas[cloth])) if cloth.any() else 1.0,
    }


def with_paint(job: Job, found: d.Segmentation) -> d.Segmentation:
    """Corrected as a person painted it, if anybody did; what was found is then kept beside it, for the page that edits it."""
    painted = segmentation_paint.read(job.out, len(found.clothness))
    if painted is None:
        job.path(segmentation_paint.FOUND).unlink(missing_ok=True)
        return found
    d.write_segmentation(job.path(segmentation_paint.FOUND), found)
    actor, performance = job.actor, job.performance()
    pose, surface = d.segmented_pose(actor, performance), performance.surface
    result = d.corrected_segmentation(pose, actor.face_valid, found, painted)
    result.fullness = d.estimate_fullness(actor.mesh, actor.face_valid, result, surface, job.options["fullness"], job.context)
    return result


def thresholds_raised(job: Job, segmentation: d.Segmentation) -> float:
    """How many times its options a segmentation's thresholds are, for a capture that moves what should be skin."""
    pose, options = d.segmented_pose(job.actor, job.performance()), job.group("segment")
    raised = d.fitting_thresholds(pose, job.actor.face_valid, segmentation.sigma, options)
    return raised.rigid_threshold / options.rigid_threshold if options.rigid_threshold else 1.0


def cloth_ends(actor: d.RiggedMesh, cloth: np.ndarray, areas: np.ndarray) -> list[str]:
    """Joints at the ends of limbs (toes, hands, top of the head) with more cloth (V) than skin on the bone that ends there."""
    names, parents = actor.skeleton.joint_names, actor.skeleton.joint_parents
    share, doubtful = np.asarray(actor.weights), []
    for j in sorted(set(range(len(names))) - {int(p) for p in parents}):
        area = areas * share[:, parents[j]]
        if area[cloth].sum() > 0.5 * area.sum() > 0:
            doubtful.append(names[j])
    return doubtful


def run_body(job: Job) -> dict:
    model = d.BodyModel.read(job.body_model)
    segmentation = job.segmentation()
    fit = d.BodyFitter.create(job.options["body"]).fit(job.actor, segmentation, model, job.session.landmarks, job.context)
    proxies = d.fit_proxies(fit, job.actor, segmentation, job.options["proxy"])
    d.write_body(job.path("body.npz"), fit)
    d.write_proxies(job.path("proxies.json"), proxies, job.actor.skeleton)
    return {"residual_mm": 1000 * fit.residual, "model": fit.model, "proxies": len(proxies)}


def run_garment(job: Job) -> dict:
    mesher, body = d.GarmentMesher.create(job.options["garment"]), d.read_body(job.path("body.npz")).body
    garment = mesher.mesh(job.actor, job.segmentation(), body, job.performance().surface, job.context)
    d.write_garment(job.path("garment.npz"), garment)
    job.forget_garment()
    found = d.summarise_garment(garment)
    return {
        "vertices": found.vertices,
        "triangles": found.faces,
        "regions": found.regions,
        "boundary_loops": found.loops,
        "loops_that_hang": found.hanging_loops,
        "edge_mm": 1000 * found.mean_edge,
        "smallest_angle_1_percent_degrees": found.smallest_angle,
        "areas_m2": [float(d.face_areas(width, garment.mesh.faces).sum()) for width in garment.widths or [garment.rest]],
    }


def require_start_in_take(job: Job) -> None:
    """Throws ValueError if tracking would have to begin in a frame that is not tracked."""
    options = job.options["capture"]
    first, count, start = options.first_frame, options.frame_count, options.start_frame
    if start < 0:
        return
    last = (job.session.frame_count if count < 0 else first + count) - 1
    if not first <= start <= last:
        raise ValueError(f"capture.start_frame: expected one of the frames {first} to {last}, found {start}")


def fit_options(job: Job) -> d.FitOptions:
    options = job.group("fit")
    options.seed = job.seed
    options.energy = job.energy_options()
    return options


def run_fit(job: Job) -> dict:
    from .fit_page import FitPage

    options, page = fit_options(job), FitPage(job.out)
    options.log = job.path("fit_log.csv")
    options.checkpoint = job.path(CHECKPOINT)  # stays: a search with a larger budget goes on from it

    kept = False

    def keep(result: d.FitResult) -> None:
        """Whatever stops the search now, the best so far is there."""
        nonlocal kept
        d.write_materials(job.path("material.json"), result)
        kept = True
        page.show(over=False)

    options.on_generation = keep
    try:
        result = d.estimate_material([job.take()], options, job.context)
    except KeyboardInterrupt:
        job.console.finish()
        if kept:
            job.console.say("fit: stopped; material.json has the best material so far")
        raise
    d.write_materials(job.path("material.json"), result)
    job.forget_garment()
    page.show(over=True)
    return fit_summary(result)


def fit_summary(result: d.FitResult) -> dict:
    regions = result.to_dict()["regions"]
    return {
        "regions": len(regions),
        "energy_px2": [r["energy"] for r in regions],
        "energy_noise_px2": [r["energy_noise"] for r in regions],
        "widths": result.chosen_widths,
        "energy_at_centre_px2": [r["energy_at_centre"] for r in regions],
        "evaluations": [r["evaluations"] for r in regions],
        "stop_reason": [r["stop_reason"] for r in regions],
    }


def fit_together(jobs: list[Job]) -> None:
    """One material, and one width of the garment, for several takes of one garment, with the options and the seed of the first:
    material.json and fit_log.csv of every take, whose later stages are then to be run again. A search that was stopped goes on.
    Throws ValueError if the garments cannot be equally wide."""
    first, stage = jobs[0], next(s for s in STAGES if s.name == "fit")
    garments = [job.offered_garment for job in jobs]
    count = min(len(garment.widths) for garment in garments)
    positions = d.common_widths(garments, count) if count > 1 else []
    takes = []
    for k, job in enumerate(jobs):
        offered = job.offered_garment
        worn = [d.worn(offered, [width] * offered.region_count) for width in positions[k]] if positions else [d.worn(offered)]
        takes.append(job.take(worn))
    options = fit_options(first)
    options.log, options.checkpoint = first.path("fit_log.csv"), first.path(CHECKPOINT)
    together = {"takes": [str(job.out.resolve()) for job in jobs]}
    with ExitStack() as stack:
        summaries = []
        for job in jobs:
            chosen = {**stage_options(first, stage), **together}
            summaries.append(stack.enter_context(job.record.running("fit", stage_inputs(job, stage), chosen, stage.writes)))
        result = d.estimate_material(takes, options, first.context)
        for k, (job, summary) in enumerate(zip(jobs, summaries)):
            d.write_materials(job.path("material.json"), result.at_positions(positions[k]) if positions else result)
            if job is not first:
                shutil.copy(first.path("fit_log.csv"), job.path("fit_log.csv"))
            job.forget_garment()
            summary.update(plain_summary(fit_summary(result)))
    first.console.finish()


def run_report(job: Job) -> dict:
    from .report import write_report

    write_report(job)
    return {}


def run_character(job: Job) -> dict:
    from .character import build_character

    return build_character(job)


STAGES = (
    Stage(
        "check", (), ("check.png",), ("silhouette", "key", "background"), run_check,
        lambda s: [s.folder / "session.json", *scan_files(s), s.calibration, *image_files(s)],
    ),
    Stage(
        "template", (), ("template.ply", "template_high.ply", template_mask.SUGGESTED), ("template",), run_template,
        lambda s: [s.scan],
    ),
    Stage(
        "rig", ("template.ply", template_mask.SUGGESTED), ("actor.npz",), (), run_rig,
        lambda s: [s.folder / "session.json", s.markers], may_read=(template_mask.EDITED,),
    ),
    Stage(
        "performance", ("actor.npz",), ("performance.npz", "observations.npz"),
        ("silhouette", "key", "background", "capture", "features", "pose", "limbs", "annealing", "surface", "calibration"),
        run_performance,
        lambda s: [s.calibration, *image_files(s)], uses_seed=True, goes_on_from=(CAPTURE_CHECKPOINT,),
    ),
    Stage(
        "segment", ("actor.npz", "performance.npz"), ("segmentation.npz",), ("segment", "opposite", "fullness"), run_segment,
        may_read=(segmentation_paint.PAINTED, CALIBRATION),
    ),
    Stage(
        "body", ("actor.npz", "segmentation.npz"), ("body.npz", "proxies.json"), ("body", "proxy"), run_body,
        lambda s: [s.markers], uses_body_model=True,
    ),
    Stage(
        "garment",
        ("actor.npz", "performance.npz", "segmentation.npz", "body.npz"), ("garment.npz",),
        ("garment",), run_garment,
    ),
    Stage(
        "fit", ("actor.npz", "performance.npz", "observations.npz", "segmentation.npz", "proxies.json", "garment.npz"),
        ("material.json", "fit_log.csv"), ("cloth", "energy", "fit", "space"), run_fit, uses_seed=True,
        goes_on_from=(CHECKPOINT,),
    ),
    Stage(
        "character",
        ("actor.npz", "template_high.ply", "performance.npz", "segmentation.npz", "body.npz", "proxies.json", "garment.npz",
         "material.json"),
        ("simulated.npz", "character.glb"), ("silhouette", "key", "background", "cloth", "energy", "texture"), run_character,
        lambda s: image_files(s), may_read=(CALIBRATION,),
    ),
    Stage(
        "report",
        ("actor.npz", "performance.npz", "observations.npz", "segmentation.npz", "body.npz", "proxies.json", "garment.npz",
         "material.json", "fit_log.csv", "simulated.npz", "character.glb"),
        ("report.html",), (), run_report, lambda s: image_files(s), may_read=(CALIBRATION,),
    ),
)  # fmt: skip


def scan_files(session: d.Session) -> list[Path]:
    """Scan and joints, where there are any."""
    return [path for path in (session.scan, session.markers) if path.name]


def image_files(session: d.Session) -> list[Path]:
    """Videos, or the folders of image sequences, of images, ready masks and clean plates."""
    paths = [Path(p) for camera in session.cameras for p in (camera.video, camera.masks, camera.background) if p != Path()]
    return [p.parent if "%" in p.name else p for p in paths]


def with_stage(stages: tuple[Stage, ...], stage: Stage) -> tuple[Stage, ...]:
    """`stages` with `stage` in the place of the one of its name: Job(..., stages=with_stage(STAGES, mine)). Raises ValueError if
    there is none, or a file is missing in `stage.writes` that a later stage reads."""
    names = [s.name for s in stages]
    if stage.name not in names:
        raise ValueError(f"stage '{stage.name}': expected one of {', '.join(names)}")
    at = names.index(stage.name)
    needed = {name for later in stages[at + 1 :] for name in later.reads}
    missing = [name for name in stages[at].writes if name in needed and name not in stage.writes]
    if missing:
        raise ValueError(f"stage '{stage.name}': expected it to write {', '.join(missing)}, which later stages read")
    return (*stages[:at], stage, *stages[at + 1 :])


def plain(value):
    """An option's value as JSON has it."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if hasattr(value, "to_dict"):
        return {name: plain(inner) for name, inner in value.to_dict().items()}
    return value


def stage_options(job: Job, stage: Stage) -> dict:
    options = {f"{g}.{k}": plain(v) for g in stage.groups for k, v in job.options[g].to_dict().items() if not is_derived(g, k, v)}
    if stage.uses_seed:
        options["seed"] = job.seed
    if "energy" in stage.groups:
        options["fps"] = job.session.fps
    if stage.run.__module__ != __name__:  # somebody else's: its results are not those of ours
        options["run"] = f"{stage.run.__module__}.{stage.run.__qualname__}"
    return options


def name_in_session(session: d.Session, path: Path) -> Path:
    """Relative to the session's folder, or as it is: a session may name a video that lies elsewhere."""
    return path.relative_to(session.folder) if path.is_relative_to(session.folder) else path


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
    for finding in findings(stage.name, job.record.data["stages"].get(stage.name, {}).get("summary", {})):
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
