"""Joints of an animation under the names that another program gives its bones."""

from __future__ import annotations

import re
from pathlib import Path

from ..common.files import written_atomically
from .glb_file import packed_glb, unpacked_glb

BOTH = {
    "unreal": {
        "clavicle": "clavicle_{s}", "shoulder": "upperarm_{s}", "elbow": "lowerarm_{s}", "wrist": "hand_{s}",
        "hip": "thigh_{s}", "knee": "calf_{s}", "ankle": "foot_{s}", "toe": "ball_{s}", "hand": "middle_01_{s}",
    },
    "humanoid": {
        "clavicle": "{side}Shoulder", "shoulder": "{side}UpperArm", "elbow": "{side}LowerArm", "wrist": "{side}Hand",
        "hip": "{side}UpperLeg", "knee": "{side}LowerLeg", "ankle": "{side}Foot", "toe": "{side}Toes",
        "hand": "{side}MiddleProximal",
    },
}  # fmt: skip
MIDDLE = {
    "unreal": {"pelvis": "pelvis", "spine": "spine_01", "chest": "spine_03", "neck": "neck_01", "head": "head"},
    "humanoid": {"pelvis": "hips", "spine": "spine", "chest": "chest", "neck": "neck", "head": "head"},
}
#: Of Unreal's mannequin, and of Unity's humanoid and VRM.
SCHEMES = tuple(BOTH)


def names_of(scheme: str) -> dict[str, str]:
    """Our joint -> its name there; joints without one (the top of the head) keep ours."""
    sides = (("l", "left"), ("r", "right"))
    limbs = {f"{s}_{part}": name.format(s=s, side=side) for s, side in sides for part, name in BOTH[scheme].items()}
    return MIDDLE[scheme] | limbs


def rename(path: Path, scheme: str) -> None:
    """Of a .bvh or .glb that was written."""
    names = names_of(scheme)
    content = renamed_bvh(path.read_bytes(), names) if path.suffix == ".bvh" else renamed_glb(path.read_bytes(), names)
    with written_atomically(path) as beside:
        beside.write_bytes(content)


def renamed_bvh(content: bytes, names: dict[str, str]) -> bytes:
    def renamed(found) -> str:
        return found[1] + names.get(found[2], found[2])

    return re.sub(r"^(\s*(?:ROOT|JOINT) )(\S+)", renamed, content.decode(), flags=re.MULTILINE).encode()


def renamed_glb(content: bytes, names: dict[str, str]) -> bytes:
    """The nodes that a skin names as its joints."""
    gltf, rest = unpacked_glb(content)
    for joint in {joint for skin in gltf.get("skins", []) for joint in skin["joints"]}:
        node = gltf["nodes"][joint]
        node["name"] = names.get(node["name"], node["name"])
    return packed_glb(gltf, rest)
