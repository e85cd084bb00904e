"""What is edited in a browser: `doublet edit-joints`, `edit-template`, `edit-segmentation`."""

from __future__ import annotations

from pathlib import Path

from ...pages.edit_joints import edit_joints
from ...pages.edit_segmentation import edit_segmentation
from ...pages.edit_template import edit_template
from ..common_flags import page_flags


def register(commands) -> None:
    add_edit_joints(commands)
    add_edit_template(commands)
    add_edit_segmentation(commands)


def add_edit_joints(commands) -> None:
    text = "move joints and landmarks in the cameras' images, in a browser"
    edit = commands.add_parser("edit-joints", help=text, description=text)
    edit.add_argument("session", type=Path, metavar="SESSION", help="folder with session.json that names its joints")
    page_flags(edit)
    edit.set_defaults(run=run_edit_joints)


def add_edit_template(commands) -> None:
    text = "paint the template's invalid triangles in a browser"
    edit = commands.add_parser("edit-template", help=text, description=text)
    edit.add_argument("out", type=Path, metavar="OUT", help="folder of the results so far, with a template")
    page_flags(edit)
    edit.set_defaults(run=run_edit_template)


def add_edit_segmentation(commands) -> None:
    text = "paint cloth, skin and seams between garments in a browser"
    edit = commands.add_parser("edit-segmentation", help=text, description=text)
    edit.add_argument("out", type=Path, metavar="OUT", help="folder of the results so far, with a segmentation")
    page_flags(edit)
    edit.set_defaults(run=run_edit_segmentation)


def run_edit_joints(arguments) -> None:
    edit_joints(arguments.session, arguments.port, arguments.browser)


def run_edit_template(arguments) -> None:
    edit_template(arguments.out, arguments.port, arguments.browser)


def run_edit_segmentation(arguments) -> None:
    edit_segmentation(arguments.out, arguments.port, arguments.browser)
