"""What people paint over what was found, as files beside the results."""

from .._lazy import lazy_modules

MODULES = ("segmentation_paint", "template_mask")
__getattr__, __dir__ = lazy_modules(__name__, MODULES)
