"""The option groups of a reconstruction: their names, how one is chosen from names and values, how it is written down."""

from __future__ import annotations

import numpy as np

from .. import _doublet as d

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


def plain(value):
    """An option's value as JSON has it."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if hasattr(value, "to_dict"):
        return {name: plain(inner) for name, inner in value.to_dict().items()}
    return value
