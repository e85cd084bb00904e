"""`doublet export-cloth`: a character's garment for other solvers."""

from __future__ import annotations

from pathlib import Path

from ... import _doublet as d
from ...export.clips import read_motion
from ...export.cloth import AREAL_DENSITY, export_cloth
from ..common_flags import MOTION_HELP, clip_flags, clip_options, common_flags, make_console
from ..option_flags import add_option_flags, chosen_options


def register(commands) -> None:
    text = "the garment for other solvers: rest mesh, masses, stiffness in N/m, attachment, capsules, as JSON and USD"
    command = commands.add_parser("export-cloth", help=text, description=text)
    command.add_argument("character", type=Path, metavar="CHARACTER.glb")
    command.add_argument("-o", "--out", type=Path, required=True, metavar="FOLDER", help="folder for cloth.json and cloth.usda")
    help_text = f"also write motion.json: joints, attachment and our own simulation in every frame of {MOTION_HELP}"
    command.add_argument("--motion", type=Path, metavar="MOTION", help=help_text)
    clip_flags(command)
    help_text = f"kg/m^2 of the cloth, which videos do not show; stiffnesses are proportional to it (default: {AREAL_DENSITY})"
    command.add_argument("--areal-density", type=float, default=AREAL_DENSITY, metavar="X", help=help_text)
    common_flags(command)
    add_option_flags(command, {"retarget": d.RetargetOptions})
    command.set_defaults(run=run)


def run(arguments) -> None:
    console = make_console(arguments)
    character = d.Character.read(arguments.character)
    retargeting = chosen_options(arguments, {"retarget": d.RetargetOptions})["retarget"]
    how = (retargeting, console.context(), *clip_options(arguments, bool(arguments.motion)))
    motion = read_motion(arguments.motion, character, *how) if arguments.motion else None
    written = export_cloth(character, arguments.out, arguments.areal_density, motion, console.context())
    console.finish()
    for path in written:
        print(path)
    if not any(path.suffix == ".usda" for path in written):
        print("no cloth.usda: the package usd-core is not installed (pip install usd-core)")
