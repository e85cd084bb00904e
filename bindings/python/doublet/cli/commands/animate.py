"""`doublet animate`: a character and a motion -> a new animation."""

from __future__ import annotations

from pathlib import Path

from ... import _doublet as d
from ...export import bone_map
from ...export.animate import Output, animate
from ...export.clips import read_clip
from ..common_flags import MOTION_HELP, common_flags, make_console
from ..option_flags import add_option_flags, chosen_options

#: What `doublet animate` takes flags of.
ANIMATE_GROUPS = {"retarget": d.RetargetOptions, "animate": d.AnimateOptions, "glb": d.BakedGlbOptions}


def register(commands) -> None:
    command = commands.add_parser("animate", help="a character and a motion -> a new animation")
    command.add_argument("character", type=Path, metavar="CHARACTER.glb")
    command.add_argument("motion", type=Path, metavar="MOTION", help=MOTION_HELP)
    command.add_argument("-o", "--out", type=Path, metavar="OUT", help=".npz, .glb, .usdc, .mp4, or .bvh of the skeleton alone")
    text = "write which joint of the motion plays which of ours, and how that was guessed, for --bone-map, and run nothing"
    command.add_argument("--write-bone-map", type=Path, metavar="FILE", help=text)
    text = "which joint of the motion plays which of ours, from a TOML file; --retarget-joint-names beats it"
    command.add_argument("--bone-map", type=Path, metavar="FILE", help=text)
    text = "which of the animations in a MOTION.glb: name, or number from 1 (default: the first that moves the body)"
    command.add_argument("--animation", default="", metavar="NAME", help=text)
    common_flags(command)
    add_option_flags(command, ANIMATE_GROUPS)
    command.usage = (
        "doublet animate CHARACTER.glb MOTION -o OUT [options]\n"
        "       doublet animate CHARACTER.glb MOTION --write-bone-map FILE [options]"
    )
    command.set_defaults(run=run, usage_error=command.error)


def run(arguments) -> None:
    options = chosen_options(arguments, ANIMATE_GROUPS)
    if arguments.write_bone_map:
        bone_map.write(
            arguments.write_bone_map, read_clip(arguments.motion, arguments.animation), options["retarget"].joint_names
        )
        print(arguments.write_bone_map)
        return
    if not arguments.out:
        arguments.usage_error("the following arguments are required: -o/--out")
    console = make_console(arguments)
    output = Output(options["animate"], options["glb"], arguments.bone_map, arguments.animation)
    frames = animate(arguments.character, arguments.motion, arguments.out, console, options["retarget"], output)
    console.finish()
    print(f"{arguments.out}: {frames} frames")
