"""`doublet synthesize`: a session with known truth."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

from ... import _doublet as d
from ...evaluation.synthesize import SynthesisOptions, synthesize
from ...export.clips import read_motion
from ..common_flags import MOTION_HELP, clip_flags, clip_options, common_flags, make_console
from ..option_flags import add_option_flags, chosen_options
from .edit_character import materials_of


def register(commands) -> None:
    text = "a character and a motion -> a capture session with known truth"
    command = commands.add_parser("synthesize", help=text, description=text)
    command.add_argument("character", type=Path, metavar="CHARACTER.glb")
    command.add_argument("--motion", type=Path, required=True, metavar="FILE", help=MOTION_HELP)
    clip_flags(command)
    command.add_argument("-o", "--out", type=Path, required=True, metavar="SESSION", help="folder of the new session")
    command.add_argument("--cameras", type=Path, metavar="DIR", help="session whose cameras are used (default: a ring)")
    command.add_argument(
        "--material", nargs="+", metavar="NAME=X", help="parameters of all cloth, e.g. k_bend=0.7 (default: the character's)"
    )
    flag = command.add_argument
    flag("--camera-count", type=int, default=8, metavar="N", help="number of cameras of the ring (default: 8)")
    flag("--image-size", type=int, default=1004, metavar="N", help="width and height of the ring's images, px (default: 1004)")
    flag("--frame-count", type=int, default=-1, metavar="N", help="number of frames (default: the whole motion)")
    flag("--noise", type=float, default=0.0, metavar="X", help="deviation of the sensor noise, grey levels (default: 0)")
    flag("--blur", type=float, default=0.0, metavar="X", help="deviation of the Gaussian blur, px (default: 0)")
    flag("--scan-noise", type=float, default=0.0004, metavar="X", help="deviation of the scan's points, m (default: 0.0004)")
    flag("--mark-noise", type=float, default=0.004, metavar="X", help="deviation of the marked joints, m (default: 0.004)")
    flag("--mask-step", type=int, default=10, metavar="N", help="write the true masks of every n-th frame (default: 10)")
    common_flags(command)
    add_option_flags(command, {"retarget": d.RetargetOptions})
    command.set_defaults(run=run)


def run(arguments) -> None:
    console = make_console(arguments)
    character = d.Character.read(arguments.character)
    chosen = {f.name: getattr(arguments, f.name) for f in fields(SynthesisOptions) if f.name not in ("key_colour",)}
    options = SynthesisOptions(**chosen)
    options.validate()
    if arguments.material:
        character.materials = materials_of(character, arguments.material)
    retargeting = chosen_options(arguments, {"retarget": d.RetargetOptions})["retarget"]
    retargeting.fps = retargeting.fps or 1 / character.solver.dt
    motion = read_motion(arguments.motion, character, retargeting, console.context(), *clip_options(arguments))
    rig = d.Session(arguments.cameras).rig if arguments.cameras else None
    frames = synthesize(character, motion, arguments.out, options, rig, console)
    console.finish()
    print(f"{arguments.out}: {frames} frames")
