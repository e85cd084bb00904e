"""Animatable doubles of people in loose clothing, from video.

Names of this module, by what they are for; each has its own help:

  session        Session, Camera, FrameSource, SilhouetteExtractor, read_calibration
  template       read_mesh, build_template, rig_template, RiggedMesh, Skeleton, scan_from_views
  capture        PerformanceCapture, CaptureOptions, ReferencePerformance, Observations
  segmentation   ClothSegmenter, SegmentOptions, segment_performance, Segmentation
  body           BodyModel, BodyFitter, fit_proxies, TaperedCapsule
  garment        GarmentMesher, GarmentOptions, choose_widths, dress
  cloth          ClothModel, ClothState, ClothSolver, ClothOptions, Material
  fit            estimate_material, FitOptions, MaterialObjective, Optimizer, Take
  character      make_character, Character, CharacterSimulator, Player, animate
  motion         SourceMotion, retarget, RetargetOptions, Motion, plant_feet,
                 resolve_arm_penetration
  pictures       render, rasterize, RenderMesh, orbit_camera

`doublet.reconstruct` runs all stages, `doublet.evaluation.metrics` measures what comes of it; the other packages are below.
Options describe themselves: ClothOptions.described(), and paper() where the paper has other values.
Arrays are NumPy; metres, seconds, radians, +Y up. Stages release the GIL, report progress through Context, stop at Ctrl-C.
"""

from . import _doublet
from ._doublet import *  # noqa: F403
from ._doublet import __version__ as __version__
from ._lazy import DEPRECATED_MODULES, DEPRECATED_NAMES, find_deprecated_modules, lazy_modules
from .common.packaged import body_model_path as body_model_path
from .common.programs import use_packaged_ffmpeg
from .common.renamed import add_deprecated_attributes

#: Packages and modules, loaded when they are first named.
MODULES = ("evaluation", "export", "optimizers", "pages", "reconstruct", "scan", "session", "testing")
version_info = tuple(int(part) for part in __version__.split("."))  #: to compare: doublet.version_info >= (0, 2)
__all__ = list(MODULES)  # what help() goes through, too: classes and functions each have their own


for _name in DEPRECATED_NAMES:
    globals().pop(_name, None)  # still found, with a warning; of a room that is not built there is none
find_deprecated_modules()
add_deprecated_attributes(_doublet)
use_packaged_ffmpeg()
__getattr__, __dir__ = lazy_modules(__name__, (*MODULES, *DEPRECATED_MODULES), DEPRECATED_NAMES)
