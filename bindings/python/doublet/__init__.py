"""Animatable doubles of people in loose clothing, from video.

Stages (each callable alone): build_template / rig_template, PerformanceCapture, ClothSegmenter, BodyFitter, fit_proxies,
CharacterSimulator, estimate_material. `doublet.pipeline.reconstruct` runs them all, `doublet.evaluate.evaluate` measures what
comes out.
Arrays are NumPy; metres, seconds, radians, +Y up. Stages release the GIL, report progress through `Context`, and stop at Ctrl-C.
"""

import sys
from pathlib import Path

from . import _doublet
from ._doublet import *  # noqa: F403
from ._doublet import __version__ as __version__
from ._lazy import RenamedModules, lazy_modules

__all__ = [name for name in dir(_doublet) if not name.startswith("_")] + ["__version__", "body_model_path"]

#: Rooms, loaded when they are first named.
MODULES = ("corrections", "evaluation", "export", "optimizers", "pages", "reconstruct", "scan", "session")
#: Modules whose old name goes with the next minor version -> the one to use.
RENAMED = {
    "appearance": "session.first_frame",
    "bone_map": "export.bone_map",
    "camera_files": "session.camera_files",
    "character": "export.animate",
    "config": "reconstruct.config",
    "console": "common.console",
    "edit_joints": "pages.edit_joints",
    "edit_segmentation": "pages.edit_segmentation",
    "edit_template": "pages.edit_template",
    "evaluate": "evaluation.metrics",
    "files": "common.files",
    "fit_page": "pages.fit_page",
    "garment_motion": "evaluation.motion_metrics",
    "given_scan": "scan.alignment",
    "import_calibration": "session.import_calibration",
    "keypoints": "scan.keypoints",
    "local_page": "pages.page_server",
    "motions": "export.clips",
    "new_session": "session.new_session",
    "page": "pages.html_document",
    "picture": "common.drawing",
    "pipeline": "reconstruct",
    "plausible": "common.quality_checks",
    "ready_masks": "session.external_masks",
    "report": "pages.report",
    "run_record": "reconstruct.run_record",
    "segmentation_paint": "corrections.segmentation_paint",
    "session_check": "session.check",
    "study": "evaluation.study",
    "synchronise": "session.synchronise",
    "synthesize": "evaluation.synthesize",
    "template_mask": "corrections.template_mask",
    "usd": "export.usd",
    "video": "common.video",
    "view": "pages.view",
}
__getattr__, __dir__ = lazy_modules(__name__, (*MODULES, *RENAMED))
sys.meta_path.append(RenamedModules({f"{__name__}.{old}": f"{__name__}.{new}" for old, new in RENAMED.items()}))


def body_model_path() -> Path:
    """The statistical body model that ships with the package."""
    return Path(__file__).parent / "data" / "body_model.npz"
