"""From videos and a calibration to a session that can be true."""

from .._lazy import lazy_modules

MODULES = (
    "calibrate",
    "camera_files",
    "check",
    "external_masks",
    "import_calibration",
    "keypoints",
    "new_session",
    "synchronise",
)
__getattr__, __dir__ = lazy_modules(__name__, MODULES)
