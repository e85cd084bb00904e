"""Names that go on for one minor version, with a warning: old -> new (docs/stability.md)."""

from __future__ import annotations

import sys
import warnings

#: Names of the package.
NAMES = {
    "BodyMarks": "DetectedJoints",
    "Display": "DisplayMesh",
    "DressedScan": "ClothedScan",
    "JointMark": "JointAnnotation",
    "JointSight": "JointVisibility",
    "corrected_segmentation": "apply_corrections",
    "find_body_marks": "detect_joints",
    "make_display": "build_display_mesh",
    "offered": "width_variants",
    "unposed_frames": "canonical_frames",
    "worn": "choose_widths",
}
#: Class -> its options, other members and methods.
ATTRIBUTES = {
    "AnimateOptions": {"free_caught": "redrape_when_tangled", "tuck_body": "resolve_body_penetration"},
    "BackgroundOptions": {"smallest_blob": "min_blob_area"},
    "BakedGlbOptions": {"most_keys": "max_keys"},
    "BayesianOptions": {"smallest_gain": "min_gain"},
    "CalibrationRefinementOptions": {"least": "min_change"},
    "CaptureOptions": {"ends_turn": "extra_twist_range", "loose": "cloth_deviation_scale", "map_reach": "map_search_radius"},
    "CharacterSimulator": {"step_each": "step_batch"},
    "ChromaKeyOptions": {"smallest_blob": "min_blob_area", "smallest_key_share": "min_key_share"},
    "ClothSolver": {"step_each": "step_batch"},
    "CmaEsOptions": {"smallest_deviation": "min_deviation"},
    "Context": {"report": "report_progress", "say": "log_line"},
    "DetectedJoints": {"rival": "facing_ambiguity"},
    "EnergyOptions": {"fast_features": "speed_dependent_cap", "same_comparisons": "fixed_correspondences"},
    "FitOptions": {"first_samples": "initial_design_size", "smallest_deviation": "min_deviation", "smallest_gain": "min_gain"},
    "Garment": {"covers": "replaced_faces"},
    "GarmentOptions": {
        "band": "attachment_width",
        "closing": "closing_length",
        "own_mesh": "remesh",
        "smallest_edge": "min_edge_run",
        "smallest_hole": "min_hole_area",
        "smallest_piece": "min_piece_area",
        "spreads": "length_exceedances",
    },
    "Lens": {"undone": "needs_undistortion"},
    "LimbSearchOptions": {"lost": "lost_error", "reach": "max_error"},
    "ParameterSpace": {"even_steps": "warp_parameters"},
    "ParticleAnnealingOptions": {"spread": "covariance_share"},
    "PlantOptions": {"most_drop": "max_pelvis_drop"},
    "RestPoseOptions": {"most_bend": "max_bend", "reach": "fade_distance"},
    "SurfaceOptions": {"loose": "anchor_falloff", "memory": "offset_prior_share"},
    "TextureOptions": {"label_reach": "label_margin", "screen_reach": "screen_margin"},
    "ViewScanOptions": {"outvoted": "max_missing_views"},
}
#: Options of the command line and of config.toml, by group.
OPTIONS = {
    "animate.free_caught": "redrape_when_tangled",
    "animate.tuck_body": "resolve_body_penetration",
    "annealing.spread": "covariance_share",
    "background.smallest_blob": "min_blob_area",
    "calibration.least": "min_change",
    "capture.ends_turn": "extra_twist_range",
    "capture.loose": "cloth_deviation_scale",
    "capture.map_reach": "map_search_radius",
    "energy.fast_features": "speed_dependent_cap",
    "energy.same_comparisons": "fixed_correspondences",
    "fit.first_samples": "initial_design_size",
    "fit.smallest_deviation": "min_deviation",
    "fit.smallest_gain": "min_gain",
    "garment.band": "attachment_width",
    "garment.closing": "closing_length",
    "garment.own_mesh": "remesh",
    "garment.smallest_edge": "min_edge_run",
    "garment.smallest_hole": "min_hole_area",
    "garment.smallest_piece": "min_piece_area",
    "garment.spreads": "length_exceedances",
    "glb.most_keys": "max_keys",
    "key.smallest_blob": "min_blob_area",
    "key.smallest_key_share": "min_key_share",
    "limbs.lost": "lost_error",
    "limbs.reach": "max_error",
    "rest.most_bend": "max_bend",
    "rest.reach": "fade_distance",
    "scan.outvoted": "max_missing_views",
    "space.even_steps": "warp_parameters",
    "surface.loose": "anchor_falloff",
    "surface.memory": "offset_prior_share",
    "texture.label_reach": "label_margin",
    "texture.screen_reach": "screen_margin",
}


def deprecated_attribute(struct: str, old: str, new: str) -> property:
    """The old name of a member, a method or an option, which may be written as a keyword, too."""

    def warn() -> None:
        warnings.warn(f"{struct}.{old} is deprecated: use {new}", DeprecationWarning, stacklevel=3)

    def get(self):
        warn()
        return getattr(self, new)

    def put(self, value) -> None:
        warn()
        setattr(self, new, value)

    return property(get, put, doc=f"Deprecated: use {new}.")


def add_deprecated_attributes(module) -> None:
    for struct, members in ATTRIBUTES.items():
        for old, new in members.items():
            if struct in vars(module):
                setattr(getattr(module, struct), old, deprecated_attribute(struct, old, new))


def current_option(group: str, name: str) -> str:
    """The name that an option of config.toml has now."""
    new = OPTIONS.get(f"{group}.{name}", name)
    if new != name:
        print(f"doublet: warning: {group}.{name} is deprecated: use {group}.{new}", file=sys.stderr)
    return new


def dashed(*words: str) -> str:
    return "-".join(words).replace("_", "-")


def flags() -> dict[str, str]:
    found = {}
    for key, new in OPTIONS.items():
        group, old = key.split(".")
        for start in ("--", "--no-"):
            found[start + dashed(group, old)] = start + dashed(group, new)
    return found


def current_flags(arguments: list[str]) -> list[str]:
    """The command line with the names that flags have now."""
    known, found = flags(), []
    for argument in arguments:
        flag, equals, value = str(argument).partition("=")
        if flag in known:
            print(f"doublet: warning: {flag} is deprecated: use {known[flag]}", file=sys.stderr)
        found.append(known[flag] + equals + value if flag in known else argument)
    return found
