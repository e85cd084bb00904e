"""Conformance kits: one sentence for each rule that a stage, a solver or a body model of yours breaks; [] if it breaks none."""

from ._doublet import (
    body_fitter_violations,
    body_model_violations,
    cloth_segmenter_violations,
    cloth_solver_violations,
    feature_tracker_violations,
    frame_source_violations,
    garment_mesher_violations,
    limb_search_violations,
    objective_violations,
    optimizer_violations,
    performance_capture_violations,
    pose_optimizer_violations,
    silhouette_extractor_violations,
    surface_refiner_violations,
)

__all__ = [
    "body_fitter_violations",
    "body_model_violations",
    "cloth_segmenter_violations",
    "cloth_solver_violations",
    "feature_tracker_violations",
    "frame_source_violations",
    "garment_mesher_violations",
    "limb_search_violations",
    "objective_violations",
    "optimizer_violations",
    "performance_capture_violations",
    "pose_optimizer_violations",
    "silhouette_extractor_violations",
    "surface_refiner_violations",
]
