"""Motions from files: clips of any human skeleton, retargeted, and poses of the SMPL family (AMASS and its like)."""

from __future__ import annotations

import copy
from pathlib import Path

import numpy as np

from .. import _doublet as d
from ..common.files import arrays_of
from . import bone_map as bone_maps
from . import smpl_rotations
from .smpl_rotations import product, quaternions, rotated

#: Joints of SMPL (Loper et al. 2015) under our names, with their parents, and their places from the parent in the zero pose of
#: a person of ordinary build, m, +Y up, facing +Z. A file has no places but through the model, which is not ours to ship: from
#: these come directions and proportions, and retargeting scales by the legs.
JOINTS = (
    ("pelvis", -1, (0, 0, 0)),
    ("l_hip", 0, (0.07, -0.09, 0)),
    ("r_hip", 0, (-0.07, -0.09, 0)),
    ("spine", 0, (0, 0.11, -0.03)),
    ("l_knee", 1, (0.03, -0.38, -0.005)),
    ("r_knee", 2, (-0.03, -0.38, -0.005)),
    ("spine2", 3, (0, 0.135, 0)),
    ("l_ankle", 4, (-0.01, -0.40, -0.04)),
    ("r_ankle", 5, (0.01, -0.40, -0.04)),
    ("chest", 6, (0, 0.055, 0.03)),
    ("l_toe", 7, (0.04, -0.06, 0.12)),
    ("r_toe", 8, (-0.04, -0.06, 0.12)),
    ("neck", 9, (0, 0.21, -0.03)),
    ("l_clavicle", 9, (0.08, 0.12, -0.02)),
    ("r_clavicle", 9, (-0.08, 0.12, -0.02)),
    ("head", 12, (0, 0.09, 0.05)),
    ("l_shoulder", 13, (0.09, 0.03, -0.01)),
    ("r_shoulder", 14, (-0.09, 0.03, -0.01)),
    ("l_elbow", 16, (0.26, -0.01, -0.02)),
    ("r_elbow", 17, (-0.26, -0.01, -0.02)),
    ("l_wrist", 18, (0.25, 0.01, 0)),
    ("r_wrist", 19, (-0.25, 0.01, 0)),
    ("l_hand", 20, (0.085, -0.01, -0.01)),
    ("r_hand", 21, (-0.085, -0.01, -0.01)),
)
TURNING = 22  # of these have a rotation in every file of the family; hands end in one of SMPL, or in fingers
#: Arrays that hold the turning joints' rotations, side by side, and the root's place: AMASS, its SMPL-X, SMPLify and its like.
POSES = (("poses",), ("root_orient", "pose_body"), ("global_orient", "body_pose"))
PLACES = ("trans", "transl")
PICKLED = (".pkl", ".pickle", ".pt", ".pth", ".npy")  # as programs that find poses write them
RATES = ("mocap_framerate", "mocap_frame_rate", "fps")
MOST_LIKELY_FPS = 1000  # nobody films people faster
MOST_LIKELY_SPEED = 15  # m/s, nobody runs faster
AMASS_RATES = RATES[:2]  # its world has +Z up
ONE_OF_SEVERAL = "expected a .glb or .fbx, which can have several animations, to choose '{}' of"


def at_own_rate(motion: d.Motion, character: d.Character) -> d.Motion:
    """The motion at the rate of the character's solver, for which its material was estimated."""
    own = 1 / character.solver.dt
    return motion if np.isclose(motion.fps, own) else d.resample(character.actor.skeleton, motion, own)


def read_motion(
    path: Path,
    character: d.Character,
    retargeting: d.RetargetOptions,
    context: d.Context | None = None,
    bone_map: Path | None = None,
    animation: str = "",
) -> d.Motion:
    """A clip (.bvh, .amc, .fbx, .glb, poses of the SMPL family in .npz), retargeted; or the poses of a performance.npz of the
    same skeleton, as they are, at the rate of `retargeting.fps`, else the character's own; or those of an animation's .npz, which
    has its rate. `bone_map`: a file of `doublet.export.bone_map`; what `retargeting.joint_names` says beats it. `animation`: of a
    .glb or .fbx, by name or number from 1."""
    path, context = Path(path), context or d.Context()
    own = own_poses(path)
    if own is None:
        clip = read_clip(path, animation)
        if len(clip.animations) > 1:
            context.log_line(f"{path}: plays the animation '{clip.animations[clip.animation]}' of {', '.join(clip.animations)}")
        if bone_map:
            retargeting = copy.copy(retargeting)
            retargeting.joint_names = {**bone_maps.read(bone_map, clip), **retargeting.joint_names}
        return d.retarget(clip, character.actor.skeleton, retargeting, context)
    if bone_map:
        raise ValueError(f"{path}: expected a clip on bones of its own for a bone map, found poses of the character's skeleton")
    if animation:
        raise ValueError(f"{path}: {ONE_OF_SEVERAL.format(animation)}")
    dofs, fps = own
    expected = len(character.actor.skeleton.dof_names)
    if dofs.ndim != 2 or dofs.shape[1] != expected or not len(dofs) or not np.isfinite(dofs).all():
        raise ValueError(f"{path}: expected finite 'dofs' of shape (T, {expected}), found {dofs.shape}")
    wanted = retargeting.fps or fps or 1 / character.solver.dt
    if np.isclose(fps or wanted, wanted):
        return d.Motion(wanted, dofs)
    return d.resample(character.actor.skeleton, d.Motion(fps, dofs), wanted)


def centred(motion: d.Motion, skeleton: d.Skeleton) -> d.Motion:
    """The same motion, begun with the root over the world's origin."""
    dofs = np.array(motion.dofs)
    place, root = skeleton.joint_positions(dofs[0])[0], skeleton.joint_names[0]
    for axis, name in ((0, "tx"), (2, "tz")):
        dofs[:, skeleton.dof_names.index(f"{root}.{name}")] -= place[axis]
    return d.Motion(motion.fps, dofs)


def own_poses(path: Path) -> tuple[np.ndarray, float | None] | None:
    """The array `dofs` of a performance.npz, and the rate if the file has it, as that of an animation; None of any other file."""
    if path.suffix.lower() != ".npz":
        return None
    if not path.exists():
        raise FileNotFoundError(f"{path} does not exist")
    with arrays_of(path) as file:
        if "dofs" not in file:
            return None
        return file["dofs"].astype(float), rate_of(path, file) if any(name in file for name in RATES) else None


def read_clip(path: Path, animation: str = "") -> d.SourceMotion:
    """A clip on its own bones: .bvh, .amc, .fbx, .glb, poses of the SMPL family in .npz. `animation`: of a .glb or .fbx, by name
    or number."""
    path = Path(path)
    if path.suffix.lower() in PICKLED:
        expected = "a clip in .bvh, .amc, .fbx or .glb, or 'poses', 'trans' and 'mocap_framerate' of the SMPL family in an .npz"
        how = "numpy.savez writes them; places of joints alone, as of HumanML3D, say no rotations: have them fitted or as BVH"
        raise ValueError(f"{path}: expected {expected}, found '{path.suffix}'; {how}")
    if path.suffix.lower() != ".npz":
        return d.SourceMotion.read(path, animation=animation)
    if animation:
        raise ValueError(f"{path}: {ONE_OF_SEVERAL.format(animation)}")
    return read_smpl_motion(path)


def read_smpl_motion(path: Path) -> d.SourceMotion:
    """Poses of SMPL, SMPL-H or SMPL-X as AMASS has them: the body's rotations (axis times angle, or matrices, of each joint from
    its parent), the root's place and the rate. Fingers, face and shape are left out. The world may have any axis up; it becomes
    +Y, as up_of_world() finds it, to which AMASS says +Z. Raises ValueError naming the file and the array."""
    path = Path(path)
    if not path.exists():
        raise FileNotFoundError(f"{path} does not exist")
    with arrays_of(path) as file:
        return smpl_motion(path, file)


def smpl_motion(path: Path, file) -> d.SourceMotion:
    """The same of a file that is open."""
    file = of_one_person(path, file)
    local = rotations_of(path, file)
    count = len(local)
    local = np.concatenate([local, np.tile([1.0, 0, 0, 0], (count, len(JOINTS) - TURNING, 1))], axis=1)
    place = place_of(path, file, count)
    places, turned = np.empty((count, len(JOINTS), 3)), np.empty_like(local)
    for j, (_, parent, offset) in enumerate(JOINTS):
        turned[:, j] = local[:, j] if parent < 0 else product(turned[:, parent], local[:, j])
        if parent >= 0:
            places[:, j] = places[:, parent] + rotated(turned[:, parent], np.array(offset, float))
        else:
            places[:, j] = place
    names, parents, offsets = zip(*JOINTS)
    frame = list(names), list(parents), np.array(offsets, float)
    usual = [0, 0, 1] if any(name in file for name in AMASS_RATES) else [0, 0, 0]
    upright = upright_from(d.up_of_world(d.SourceMotion(*frame, places, turned, rate_of(path, file), str(path), usual)))
    return d.SourceMotion(*frame, rotated(upright, places), product(upright, turned), rate_of(path, file), str(path), [0, 1, 0])


def upright_from(up: np.ndarray) -> np.ndarray:
    """The turn that brings an axis to +Y; of +Z, +X stays."""
    turn = np.cross(up, [0.0, 1, 0])
    if np.any(turn):
        return quaternions(turn * np.pi / 2)
    return np.array([1.0, 0, 0, 0]) if up[1] > 0 else np.array([0.0, 1, 0, 0])


# --- arrays


def of_one_person(path: Path, file):
    """Without the axis of people that some programs write before that of frames, to which the root's place has one too many."""
    name = next((name for name in PLACES if name in file), None)
    if name is None or np.ndim(file[name]) != 3:
        return file
    if len(file[name]) != 1:
        raise ValueError(f"{path}: expected poses of one person, found '{name}' of shape {file[name].shape}; choose one")
    used = {name: file[name] for name in {*PLACES, *RATES, *(name for names in POSES for name in names)} if name in file}
    return {**dict.fromkeys(file), **{name: array[0] if array.ndim > 2 else array for name, array in used.items()}}


def rotations_of(path: Path, file) -> np.ndarray:
    """(T, 22, 4) quaternions of each joint from its parent."""
    names = next((group for group in POSES if all(name in file for name in group)), None)
    if names is None and "dofs" in file:
        raise ValueError(f"{path}: expected a clip on bones of its own, found poses of a character's skeleton, 'dofs'")
    if names is None:
        expected = ", or ".join(" and ".join(f"'{name}'" for name in group) for group in POSES)
        raise ValueError(f"{path}: expected a performance with 'dofs', or {expected}, found {', '.join(file) or 'nothing'}")
    parts = [numbers(path, file, name) for name in names]
    shapes = " and ".join(str(part.shape) for part in parts)
    rows = [part.reshape(len(part), -1) if part.ndim > 1 else part for part in parts]
    wanted = " and ".join(f"'{name}'" for name in names)
    turns = None
    if all(row.ndim == 2 and len(row) == len(rows[0]) for row in rows):
        matrices = all(part.shape[-2:] == (3, 3) for part in parts)
        turns = smpl_rotations.turns_of(np.concatenate(rows, axis=1), matrices)
    if turns is None or turns.shape[1] < TURNING:
        raise ValueError(
            f"{path}: expected {wanted} with a row of at least {3 * TURNING} angles a frame (axis times angle of SMPL, SMPL-H or "
            f"SMPL-X), or of rotation matrices, found {shapes}{smpl_rotations.doubt_about(rows)}"
        )
    return turns[:, :TURNING]


def place_of(path: Path, file, count: int) -> np.ndarray:
    """(T, 3) m."""
    name = next((name for name in PLACES if name in file), None)
    if name is None:
        raise ValueError(f"{path}: expected the root's place, 'trans' or 'transl', found {', '.join(file)}")
    place = numbers(path, file, name)
    if place.shape != (count, 3):
        raise ValueError(f"{path}: expected '{name}' of shape ({count}, 3), found {place.shape}")
    speed = np.median(np.linalg.norm(np.diff(place, axis=0), axis=1)) * rate_of(path, file) if count > 1 else 0
    if speed > MOST_LIKELY_SPEED:
        raise ValueError(f"{path}: expected '{name}' in metres, found a body that moves by {speed:.3g} a second most of the time")
    return place


def rate_of(path: Path, file) -> float:
    name = next((name for name in RATES if name in file), None)
    if name is None:
        raise ValueError(f"{path}: expected a rate, 'mocap_framerate', 'mocap_frame_rate' or 'fps', found {', '.join(file)}")
    rate = numbers(path, file, name)
    if rate.size != 1 or not 0 < rate.item() <= MOST_LIKELY_FPS:
        found = str(rate) if rate.size == 1 else f"numbers of shape {rate.shape}"
        raise ValueError(f"{path}: expected '{name}' to be one rate in (0, {MOST_LIKELY_FPS}], found {found}")
    return rate.item()


def numbers(path: Path, file, name: str) -> np.ndarray:
    array = np.asarray(file[name])
    if array.dtype.kind not in "iuf" or array.size == 0 or not np.isfinite(array).all():
        raise ValueError(f"{path}: expected '{name}' to hold finite numbers, found {array.dtype} of shape {array.shape}")
    return array.astype(float)
