"""Conformance kits: one sentence for each rule that a stage, a solver or a body model of yours breaks; [] if it breaks none."""

from contextlib import suppress

# Of the rooms that are built.
with suppress(ImportError):
    from ._doublet import feature_tracker_violations as feature_tracker_violations
    from ._doublet import frame_source_violations as frame_source_violations
    from ._doublet import limb_search_violations as limb_search_violations
    from ._doublet import performance_capture_violations as performance_capture_violations
    from ._doublet import pose_optimizer_violations as pose_optimizer_violations
    from ._doublet import silhouette_extractor_violations as silhouette_extractor_violations
    from ._doublet import surface_refiner_violations as surface_refiner_violations
with suppress(ImportError):
    from ._doublet import cloth_segmenter_violations as cloth_segmenter_violations
    from ._doublet import garment_mesher_violations as garment_mesher_violations
with suppress(ImportError):
    from ._doublet import body_fitter_violations as body_fitter_violations
    from ._doublet import body_model_violations as body_model_violations
with suppress(ImportError):
    from ._doublet import cloth_solver_violations as cloth_solver_violations
with suppress(ImportError):
    from ._doublet import objective_violations as objective_violations
    from ._doublet import optimizer_violations as optimizer_violations

__all__ = sorted(name for name in globals() if name.endswith("_violations"))
