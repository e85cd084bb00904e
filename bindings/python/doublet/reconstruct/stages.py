"""The stages in their order, each reading and writing its files (docs/formats.md): what `doublet reconstruct` runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .. import _doublet as d
from ..common.quality_checks import Finding, entry
from ..corrections import segmentation_paint, template_mask
from ..pages.report import write_report
from ..session import check
from ..session.first_frame import first_colours
from . import refined_cameras
from .character import build_character
from .fit import CHECKPOINT, run_fit
from .results import CALIBRATION
from .stage import Stage
from .workspace import Workspace

CAPTURE_CHECKPOINT = "capture_checkpoint.bin"
HEAD = "head_top"


def run_check(job: Workspace) -> dict:
    frames = d.FrameSource.open(job.session)
    checked = check.check_and_draw(job.session, frames, job.silhouettes, job.path("check.png"), job.context)
    if checked.start_text:
        job.console.finish()
        job.console.say(f"check: {checked.start_text}")
    return {"findings": [entry(finding) for finding in checked.findings], "frame": checked.frame}


def run_template(job: Workspace) -> dict:
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


def run_rig(job: Workspace) -> dict:
    surface = d.Template()
    surface.mesh = d.read_mesh(job.path("template.ply"))
    mask = template_mask.read(job.out)
    surface.face_valid = mask
    actor = d.rig_template(surface, job.session.joints, job.context)
    d.write_actor(job.path("actor.npz"), actor)
    job.results.forget("actor")
    areas = d.face_areas(actor.mesh.vertices, actor.mesh.faces)
    return {
        "mask": "edited" if job.path(template_mask.EDITED).exists() else "suggested",
        "invalid_area_m2": float(areas[~mask].sum()),
        "degrees_of_freedom": len(actor.skeleton.dof_names),
    }


def run_performance(job: Workspace) -> dict:
    options = job.group("capture")
    options.limbs.annealing.seed = job.seed
    options.checkpoint = job.path(CAPTURE_CHECKPOINT)
    frames, capture, silhouettes = d.FrameSource.open(job.session), d.PerformanceCapture.create(options), job.silhouettes
    try:
        result = capture.capture(job.results.actor, job.session.rig, frames, silhouettes, job.context)
    except KeyboardInterrupt:
        job.console.finish()
        if job.console.note.startswith("stopped"):
            job.console.say(f"performance: {job.console.note}")  # where the same command goes on
        raise
    d.write_observations(job.path("observations.npz"), result.observations)
    d.write_performance(job.path("performance.npz"), result.performance)
    refined_cameras.write(job, result)
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
        "cameras": [refined_cameras.rounded(camera) for camera in summary.cameras],
        "seconds_per_frame": summary.seconds_per_frame,
    }


def run_segment(job: Workspace) -> dict:
    options, fullness = job.group("segment"), job.options["fullness"]
    segmenter, performance = d.ClothSegmenter.create(options), job.results.performance()
    colours = None
    if options.colour > 0:
        colours = first_colours(job.results.actor, performance, job.filmed, job.silhouettes, job.context)
    found = d.segment_performance(job.results.actor, performance, segmenter, colours, fullness, job.context)
    result = apply_corrections(job, found)
    d.write_segmentation(job.path("segmentation.npz"), result)
    pose = d.segmentation_pose(job.results.actor, performance)
    summary = d.summarise_segmentation(pose, job.results.actor.face_valid, result)
    areas = d.vertex_areas(job.results.actor.mesh.vertices, job.results.actor.mesh.faces)
    cloth = result.clothness > 0.5
    doubtful = cloth_ends(job.results.actor, cloth, areas)
    return {
        "findings": [entry(finding) for finding in end_findings(doubtful)],
        "noise_mm": 1000 * summary.noise,
        "uncertain_area": summary.uncertain_area,
        "corrections": "none" if result is found else "painted",
        "regions": result.region_count,
        "doubtful_ends": doubtful,
        "cloth_area_m2": float(areas[cloth].sum()),
        "fullness": float(np.average(result.fullness[cloth], weights=areas[cloth])) if cloth.any() else 1.0,
    }


def apply_corrections(job: Workspace, found: d.Segmentation) -> d.Segmentation:
    """Corrected as a person painted it, if anybody did; what was found is then kept beside it, for the page that edits it."""
    painted = segmentation_paint.read(job.out, len(found.clothness))
    if painted is None:
        job.path(segmentation_paint.FOUND).unlink(missing_ok=True)
        return found
    d.write_segmentation(job.path(segmentation_paint.FOUND), found)
    actor, performance = job.results.actor, job.results.performance()
    pose, surface = d.segmentation_pose(actor, performance), performance.surface
    result = d.apply_corrections(pose, actor.face_valid, found, painted)
    result.fullness = d.estimate_fullness(actor.mesh, actor.face_valid, result, surface, job.options["fullness"], job.context)
    return result


def cloth_ends(actor: d.RiggedMesh, cloth: np.ndarray, areas: np.ndarray) -> list[str]:
    """Joints at the ends of limbs (toes, hands, top of the head) with more cloth (V) than skin on the bone that ends there."""
    names, parents = actor.skeleton.joint_names, actor.skeleton.joint_parents
    share, doubtful = np.asarray(actor.weights), []
    for j in sorted(set(range(len(names))) - {int(p) for p in parents}):
        area = areas * share[:, parents[j]]
        if area[cloth].sum() > 0.5 * area.sum() > 0:
            doubtful.append(names[j])
    return doubtful


def end_findings(joints: list[str]) -> list[Finding]:
    """About ends of limbs that are cloth: a glove or a boot may be one, a head is not."""
    text = "expected a garment without sole, hand or head, found the cloth to include what ends at {}; look at it"
    return [Finding(joint == HEAD, text.format(joint), "cloth_ends") for joint in joints]


def run_body(job: Workspace) -> dict:
    model = d.BodyModel.read(job.body_model)
    segmentation = job.results.segmentation()
    fit = d.BodyFitter.create(job.options["body"]).fit(job.results.actor, segmentation, model, job.session.landmarks, job.context)
    proxies = d.fit_proxies(fit, job.results.actor, segmentation, job.options["proxy"])
    d.write_body(job.path("body.npz"), fit)
    d.write_proxies(job.path("proxies.json"), proxies, job.results.actor.skeleton)
    return {
        "residual_mm": 1000 * fit.residual,
        "largest_coefficient": float(np.abs(fit.coefficients).max(initial=0)),
        "model": fit.model,
        "proxies": len(proxies),
    }


def run_garment(job: Workspace) -> dict:
    mesher, body = d.GarmentMesher.create(job.options["garment"]), job.results.body().body
    garment = mesher.mesh(job.results.actor, job.results.segmentation(), body, job.results.performance().surface, job.context)
    d.write_garment(job.path("garment.npz"), garment)
    job.results.forget_garment()
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


def run_report(job: Workspace) -> dict:
    write_report(job)
    return {}


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
        ("simulated.npz", "character.glb"), ("silhouette", "key", "background", "cloth", "energy", "texture"), build_character,
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
