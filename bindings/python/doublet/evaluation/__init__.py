"""How good a reconstruction is: against a truth, over many fits, on synthetic sessions."""

from .._lazy import lazy_modules

MODULES = ("cameras", "metrics", "motion_metrics", "study", "synthesize")
__getattr__, __dir__ = lazy_modules(__name__, MODULES)
