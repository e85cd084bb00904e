"""`doublet view`: a page on which a character dances."""

from __future__ import annotations

from pathlib import Path

from ... import _doublet as d
from ...pages.view import write_view
from ..common_flags import MOTION_HELP, clip_flags, clip_options, common_flags, make_console
from ..option_flags import add_option_flags, chosen_options


def register(commands) -> None:
    text = "a web page on which a character dances; the browser simulates its cloth, with sliders for the material"
    view = commands.add_parser("view", help=text, description=text)
    view.add_argument("character", type=Path, metavar="CHARACTER.glb")
    clips = f"one or more motions: {MOTION_HELP} (default: the character turns to and fro)"
    view.add_argument("--clip", type=Path, nargs="+", default=[], metavar="MOTION", help=clips)
    clip_flags(view)
    view.add_argument("--compare", type=Path, metavar="OTHER.glb", help="a second character, beside it")
    view.add_argument("-o", "--out", type=Path, required=True, metavar="FOLDER", help="folder of the page; open its index.html")
    common_flags(view)
    add_option_flags(view, {"retarget": d.RetargetOptions})
    view.set_defaults(run=run)


def run(arguments) -> None:
    console = make_console(arguments)
    retargeting = chosen_options(arguments, {"retarget": d.RetargetOptions})["retarget"]
    characters = [arguments.character] + ([arguments.compare] if arguments.compare else [])
    how = clip_options(arguments, bool(arguments.clip))
    write_view(arguments.out, characters, arguments.clip, retargeting, console.context(), *how)
    console.finish()
    print(arguments.out / "index.html")
