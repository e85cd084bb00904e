"""From videos and a calibration to a session that can be true."""

from .._lazy import lazy_modules

MODULES = ("camera_files", "check", "external_masks", "first_frame", "import_calibration", "new_session", "synchronise")
__getattr__, __dir__ = lazy_modules(__name__, MODULES)
