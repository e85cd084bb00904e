"""What every room uses: files that are complete or absent, video, progress, pictures, findings."""

from .._lazy import lazy_modules

MODULES = ("console", "drawing", "files", "video")
__getattr__, __dir__ = lazy_modules(__name__, MODULES)
