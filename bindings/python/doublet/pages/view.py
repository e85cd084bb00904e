"""A page on which a character dances, its cloth simulated in the browser that shows it: docs/view.md."""

from __future__ import annotations

import base64
import copy
import json
import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from .. import _doublet as d
from ..common.files import write_text, written_atomically
from ..common.packaged import DATA
from ..export.clips import at_own_rate, read_motion

PACKAGED = DATA / "viewer"
#: Of the page <- of the bundle.
FILES = {"index.html": "page.html", "viewer.css": "viewer.css", "viewer.js": "viewer.js"}
TURN_SECONDS, TURN_ANGLE = 4.0, 0.9 * np.pi  # of the motion that a page without clips shows


def bundle_folder() -> Path:
    """What scripts/build-viewer.sh made: in this package, or where DOUBLET_VIEWER_DIR says."""
    folder = Path(os.environ.get("DOUBLET_VIEWER_DIR") or PACKAGED)
    missing = [name for name in FILES.values() if not (folder / name).is_file()]
    if missing:
        raise RuntimeError(
            f"{folder}: expected the viewer's page, found no {missing[0]}: this doublet was installed without it; in its sources "
            "`scripts/apt-install.sh scripts/apt-packages-viewer.txt`, `scripts/build-viewer.sh`, then `pip install .` "
            "again, or DOUBLET_VIEWER_DIR=build/viewer beside the command"
        )
    return folder


def write_view(
    out: Path,
    characters: Sequence[Path],
    clips: Sequence[Path],
    retargeting: d.RetargetOptions,
    context: d.Context | None = None,
    bone_map: Path | None = None,
    animation: str = "",
) -> None:
    """Writes `out`/index.html and what it needs. characters: one, or a second to stand beside it. clips: motions as
    `read_motion` takes them with `bone_map` and `animation`, retargeted to each character; none = it turns to and fro. Raises
    ValueError, RuntimeError naming what is wrong with a file."""
    if not 1 <= len(characters) <= 2:
        raise ValueError(f"expected one character, or two, found {len(characters)}")
    how = (retargeting, context or d.Context(), bone_map, animation)
    shown = [d.Character.read(path) for path in characters]
    if any(character.solver.dt != shown[0].solver.dt for character in shown):
        steps = " and ".join(f"{character.solver.dt:g}" for character in shown)
        raise ValueError(f"{characters[1]}: expected a character of the same time step as {characters[0]}, found {steps} s")
    data = {
        "characters": [
            {"name": character.name, "dofs": len(character.actor.skeleton.dof_names), "glb": base64_of(path.read_bytes())}
            for character, path in zip(shown, characters)
        ],
        "clips": [
            {"name": clip.stem, "poses": [base64_of(poses_of(clip, character, *how)) for character in shown]} for clip in clips
        ]
        or [{"name": "to and fro", "poses": [base64_of(turning(character)) for character in shown]}],
        "parameters": material_parameters(),
    }
    bundle = bundle_folder()
    out.mkdir(parents=True, exist_ok=True)
    for name, source in FILES.items():
        with written_atomically(out / name) as beside:
            beside.write_bytes((bundle / source).read_bytes())
    write_text(out / "data.js", f"window.DOUBLET_VIEW = {json.dumps(data)};\n")


def base64_of(content: bytes) -> str:
    return base64.b64encode(content).decode("ascii")


def poses_of(
    clip: Path,
    character: d.Character,
    retargeting: d.RetargetOptions,
    context: d.Context,
    bone_map: Path | None = None,
    animation: str = "",
) -> bytes:
    """(T, D) float64 at the character's own rate, the arms out of the body, as animate() has them and the page those of a file
    that is dropped."""
    retargeting = copy.copy(retargeting)
    retargeting.fps = retargeting.fps or 1 / character.solver.dt
    motion = at_own_rate(read_motion(clip, character, retargeting, context, bone_map, animation), character)
    motion = d.resolve_arm_penetration(character, motion, context)
    return np.ascontiguousarray(motion.dofs, "<f8").tobytes()


def turning(character: d.Character) -> bytes:
    """The same for an actor who turns to and fro on the spot, in the pose of the scan; a root that does not turn stands still."""
    skeleton = character.actor.skeleton
    count = round(2 * TURN_SECONDS / character.solver.dt)
    dofs = np.zeros((count, len(skeleton.dof_names)))
    yaw = [i for i, name in enumerate(skeleton.dof_names) if name.endswith(".ry")]
    dofs[:, yaw] = TURN_ANGLE * np.sin(np.linspace(0, 2 * np.pi, count, endpoint=False))[:, None] ** 3
    return np.ascontiguousarray(dofs, "<f8").tobytes()


def material_parameters() -> list[dict]:
    """In the order of the solver's."""
    described, boxes = d.Material.described(), d.Material.boxes()
    return [
        {"name": name, "lower": low, "upper": high, "unit": described[name]["unit"], "meaning": described[name]["meaning"]}
        for name, (low, high) in boxes.items()
    ]
