"""What is edited in a browser: `doublet edit-joints`, `edit-template`, `edit-segmentation`."""

from __future__ import annotations

from pathlib import Path

from ...pages.edit_joints import edit_joints
from ...pages.edit_segmentation import edit_segmentation
from ...pages.edit_template import edit_template
from ..common_flags import page_flags

#: command, what it does, its folder, what that is, the function that serves the page.
PAGES = (
    (
        "edit-joints", "move joints and landmarks in the cameras' images, in a browser",
        "SESSION", "folder with session.json that names its joints", edit_joints,
    ),
    (
        "edit-template", "paint the template's invalid triangles in a browser",
        "OUT", "folder of results, with a template", edit_template,
    ),
    (
        "edit-segmentation", "paint cloth, skin and borders between garments in a browser",
        "OUT", "folder of results, with a segmentation", edit_segmentation,
    ),
)  # fmt: skip


def register(commands) -> None:
    for name, text, folder, meaning, serve in PAGES:
        command = commands.add_parser(name, help=text, description=text)
        command.add_argument("folder", type=Path, metavar=folder, help=meaning)
        page_flags(command)
        command.set_defaults(run=run, serve=serve)


def run(arguments) -> None:
    arguments.serve(arguments.folder, arguments.port, arguments.browser)
