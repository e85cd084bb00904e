"""From a session to an animatable character: stages, and the record of what is up to date."""

from .._lazy import lazy_modules

MODULES = ("character", "config", "run_record", "stages")
__getattr__, __dir__ = lazy_modules(__name__, MODULES)
