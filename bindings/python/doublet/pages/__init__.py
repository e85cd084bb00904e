"""What is looked at in a browser: the report, the material search, editors, the viewer."""

from .._lazy import lazy_modules

MODULES = ("edit_joints", "edit_segmentation", "edit_template", "fit_page", "html_document", "page_server", "report", "view")
__getattr__, __dir__ = lazy_modules(__name__, MODULES)
