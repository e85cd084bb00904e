"""Scan and joints of a session that has none, from its own cameras."""

from .._lazy import lazy_modules
from .make_scan import refine_scan as refine_scan
from .make_scan import scan_session as scan_session

MODULES = ("make_scan",)
__getattr__, __dir__ = lazy_modules(__name__, MODULES)
