"""The commands. Each module has `register(commands)`, which adds the parsers of its own."""

from __future__ import annotations

from importlib import import_module

from ..._lazy import lazy_modules

#: Modules, with the commands that each registers, in the order of the help.
COMMANDS = {
    "reconstruct": ("reconstruct",),
    "stages": ("check", "template", "capture", "segment", "body", "garment", "fit", "character", "report"),
    "new_session": ("new-session",),
    "import_calibration": ("import-calibration",),
    "scan": ("scan",),
    "edit": ("edit-joints", "edit-template", "edit-segmentation"),
    "edit_character": ("edit-character",),
    "animate": ("animate",),
    "view": ("view",),
    "export_cloth": ("export-cloth",),
    "evaluate": ("evaluate",),
    "study": ("study",),
    "synthesize": ("synthesize",),
    "train_body": ("train-body",),
}
__getattr__, __dir__ = lazy_modules(__name__, tuple(COMMANDS))


def register(commands, command: str = "") -> None:
    """All of them, or only those of the module that has `command`: to load all takes as long as to load NumPy."""
    wanted = [module for module, names in COMMANDS.items() if command in names]
    for module in wanted or COMMANDS:
        import_module(f"{__name__}.{module}").register(commands)
