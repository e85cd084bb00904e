"""`doublet animate`: a character and a motion -> a new animation."""

from __future__ import annotations

import re
from pathlib import Path

from ... import _doublet as d
from ...export import bone_map
from ...export.animate import Output, animate
from ...export.bone_names import SCHEMES
from ...export.clips import read_clip
from ...export.video_camera import CAMERAS, Shot
from ..common_flags import MOTION_HELP, clip_flags, common_flags, make_console
from ..option_flags import add_option_flags, chosen_options

#: What `doublet animate` takes flags of.
ANIMATE_GROUPS = {"retarget": d.RetargetOptions, "animate": d.AnimateOptions, "glb": d.BakedGlbOptions}


def register(commands) -> None:
    text = "a character and a motion -> a new animation"
    command = commands.add_parser("animate", help=text, description=text)
    command.add_argument("character", type=Path, metavar="CHARACTER.glb")
    command.add_argument("motion", type=Path, metavar="MOTION", help=MOTION_HELP)
    text = ".npz, .glb, .usdc, .mp4, _vat.png (vertex animation texture), or .bvh of the skeleton alone"
    command.add_argument("-o", "--out", type=Path, metavar="OUT", help=text)
    text = "write the joints of the motion that match ours, and how each was found, to a file for --bone-map; run nothing"
    command.add_argument("--write-bone-map", type=Path, metavar="FILE", help=text)
    clip_flags(command)
    text = "names of the joints in a .bvh or .glb: Unreal's mannequin, Unity's humanoid and VRM (default: the character's own)"
    command.add_argument("--bone-names", choices=SCHEMES, default="", help=text)
    text = "begin over the world's origin (default: where the actor stood in the scan)"
    command.add_argument("--centre", action="store_true", help=text)
    text = "draw the display surface with about N triangles; not in a .bvh (default: all)"
    command.add_argument("--lod", type=int, default=0, metavar="N", help=text)
    text = "size of an .mp4, px (default: 720x720)"
    command.add_argument("--size", metavar="WIDTHxHEIGHT", help=text)
    text = "of an .mp4: front stands still, follow goes along, orbit also goes round; auto: front or follow (default: auto)"
    command.add_argument("--camera", choices=CAMERAS, help=text)
    text = "time in which --camera orbit goes round once, s (default: 8)"
    command.add_argument("--turn-seconds", type=float, metavar="X", help=text)
    command.add_argument("--background", metavar="COLOUR", help="of an .mp4: '#203040', 'white' (default: light grey)")
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
        clip = read_clip(arguments.motion, arguments.animation)
        known = bone_map.read(arguments.bone_map, clip) if arguments.bone_map else {}
        bone_map.write(arguments.write_bone_map, clip, {**known, **options["retarget"].joint_names})
        print(arguments.write_bone_map)
        return
    if not arguments.out:
        arguments.usage_error("the following arguments are required: -o/--out")
    console = make_console(arguments)
    if arguments.lod and arguments.lod < 4:
        raise ValueError(f"--lod: expected at least 4 triangles, found {arguments.lod}")
    output = Output(
        animation=options["animate"],
        glb=options["glb"],
        bone_map=arguments.bone_map,
        clip=arguments.animation,
        shot=shot_of(arguments),
        bone_names=arguments.bone_names,
        triangles=arguments.lod,
        centre=arguments.centre,
    )
    frames = animate(arguments.character, arguments.motion, arguments.out, console, options["retarget"], output)
    console.finish()
    print(f"{arguments.out}: {frames} frames")


def shot_of(arguments) -> Shot | None:
    """None = nothing was said about it."""
    chosen = {}
    if arguments.size:
        chosen["width"], chosen["height"] = size_of(arguments.size)
    if arguments.camera:
        chosen["camera"] = arguments.camera
    if arguments.turn_seconds is not None:
        if arguments.camera != "orbit":
            raise ValueError("--turn-seconds: only --camera orbit goes round")
        chosen["turn_seconds"] = arguments.turn_seconds
    if arguments.background:
        from ...export.character_edit import colour_of  # which loads Pillow

        chosen["background"] = tuple(channel / 255 for channel in colour_of(arguments.background, "--background"))
    if not chosen:
        return None
    shot = Shot(**chosen)
    shot.validate()
    return shot


def size_of(text: str) -> tuple[int, int]:
    found = re.fullmatch(r"([0-9]{1,5})x([0-9]{1,5})", text)
    if not found:
        raise ValueError(f"--size: expected WIDTHxHEIGHT such as 1920x1080, found '{text}'")
    width, height = int(found[1]), int(found[2])
    if width % 2 or height % 2:
        raise ValueError(f"--size: expected even numbers, which all video players show, found '{text}'")
    return width, height
