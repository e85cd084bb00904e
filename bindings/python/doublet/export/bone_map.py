"""Which joint of a clip plays which of ours, as a file (TOML) that a person looks at and corrects.

`doublet animate --write-bone-map FILE` writes it, `--bone-map FILE` reads it.
"""

from __future__ import annotations

import json
import textwrap
from pathlib import Path

from .. import _doublet as d
from ..common.files import read_toml, write_text

HEAD = """# Which joint of a clip plays which of doublet's: `doublet animate CHARACTER.glb CLIP -o OUT --bone-map THIS_FILE`.
# A joint is named after the bone that begins there. "" = no joint of the clip plays it; what is left out is guessed.
# Guessed from {source}, which has the joints
{joints}

[joints]
"""


def written(clip: d.SourceMotion, given: dict[str, str]) -> str:
    """The file's text: what was guessed, and how."""
    names = clip.joint_names
    joints = textwrap.fill(", ".join(names), 128, initial_indent="#   ", subsequent_indent="#   ", break_on_hyphens=False)
    lines = []
    for match in d.explain_match(clip, given):
        key = f"{match.part} = {json.dumps(names[match.joint] if match.joint >= 0 else '', ensure_ascii=False)}"
        lines.append(f"{key:<40} # {match.reason}")
    return HEAD.format(source=Path(clip.source).name, joints=joints) + "\n".join(lines) + "\n"


def write(path: Path, clip: d.SourceMotion, given: dict[str, str]) -> None:
    write_text(path, written(clip, given))


def read(path: Path, clip: d.SourceMotion) -> dict[str, str]:
    """Our joint -> joint of the clip. Raises RuntimeError naming the file for names that are not ours, or not the clip's."""
    path = Path(path)
    content = read_toml(path)
    joints = content.pop("joints", None)
    if not isinstance(joints, dict) or content:
        found = ", ".join(content) or ("no [joints]" if joints is None else "no table")
        raise RuntimeError(f"{path}: expected the table [joints] alone, found {found}")
    ours = [match.part for match in d.explain_match(clip)]
    for part, name in joints.items():
        if part not in ours:
            raise RuntimeError(f"{path}: expected joints of ours, {', '.join(ours)}, found '{part}'")
        if not isinstance(name, str):
            raise RuntimeError(f"{path}: {part}: expected the name of a joint in quotes, found {name}")
        if name and name not in clip.joint_names:
            theirs = ", ".join(clip.joint_names)
            raise RuntimeError(f"{path}: {part}: expected a joint of {clip.source}, {theirs}, found '{name}'")
    return joints
