"""The option groups of a reconstruction: their names, how one is chosen from names and values, how it is written down."""

from __future__ import annotations

import numpy as np

from .. import _doublet as d

CLASSES = {
    "template": "TemplateOptions",
    "silhouette": "SilhouetteOptions",
    "key": "ChromaKeyOptions",
    "background": "BackgroundOptions",
    "capture": "CaptureOptions",
    "features": "FeatureTrackerOptions",
    "pose": "PoseOptions",
    "limbs": "LimbSearchOptions",
    "annealing": "ParticleAnnealingOptions",
    "surface": "SurfaceOptions",
    "calibration": "CalibrationRefinementOptions",
    "segment": "SegmentOptions",
    "opposite": "OppositeOptions",
    "body": "BodyFitOptions",
    "proxy": "ProxyOptions",
    "garment": "GarmentOptions",
    "cloth": "ClothOptions",
    "energy": "EnergyOptions",
    "fit": "FitOptions",
    "space": "ParameterSpace",
    "texture": "TextureOptions",
}
#: Option groups: name on the command line (`--segment-diffusion`) -> class; of the rooms that are built.
OPTION_GROUPS = {group: getattr(d, name) for group, name in CLASSES.items() if hasattr(d, name)}
MOST_SEED = 2**64 - 1
#: Set by the command itself, of groups that are no reconstruction's.
SET_BY_COMMAND = {("train", "command")}


def is_derived(group: str, name: str, value) -> bool:
    """Not set by an option of its own; also of options that are a group of their own, such as `annealing` in `limbs`."""
    if (group, name) in SET_BY_COMMAND or type(value) is OPTION_GROUPS.get(name):
        return True
    return d.ReconstructionOptions.is_derived(group, name)


def make_options(group: str, options_class: type, **chosen):
    """The defaults, and what was chosen on top of them; of a material or a dict this may be NAME=X pairs. Raises ValueError for a
    value that is none, TypeError for a name."""
    values = options_class().to_dict()
    for name, value in chosen.items():
        pairs = takes_pairs(values.get(name)) and isinstance(value, list)
        values[name] = with_pairs(values[name], value, f"{group}.{name}") if pairs else value
    try:
        return options_class(**values)
    except TypeError as error:
        name = str(error).partition("(")[0]
        if type(values.get(name)) is not int:
            raise
        raise ValueError(f"{options_class.__name__}: {name}: expected a smaller number, found {values[name]}") from error


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
