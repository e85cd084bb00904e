"""A garment for other solvers: plain JSON, SI units, and USD. What is in the files and what each number becomes elsewhere:
docs/export-cloth.md."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path

import numpy as np

from .. import _doublet as d
from ..common.files import write_text
from .cloth_stiffness import RIGID, Springs, hinge_areas, springs_of
from .cloth_usd import write_cloth_usd
from .smpl_rotations import of_matrices

FORMAT, MOTION_FORMAT, VERSION = "doublet-cloth", "doublet-cloth-motion", 1
AREAL_DENSITY = 0.2  #: kg/m^2, of a light woven cotton: films do not tell it, and cloth in still air moves alike whatever it is
AIR = 1.2  #: kg/m^3
JOINTS_A_VERTEX = 4
CLOTH_FILE, MOTION_FILE, USD_FILE = "cloth.json", "motion.json", "cloth.usda"


def export_cloth(
    character: d.Character,
    folder: Path,
    areal_density: float = AREAL_DENSITY,
    motion: d.Motion | None = None,
    context: d.Context | None = None,
) -> list[Path]:
    """Writes cloth.json, with a motion motion.json, and with usd-core cloth.usda into `folder`, in the place of those of an
    earlier export; returns what was written. Raises ValueError for a character without cloth and a density that is none."""
    if not (np.isfinite(areal_density) and areal_density > 0):
        raise ValueError(f"areal_density: expected kg/m^2 above 0, found {areal_density:g}")
    simulator = simulator_of(character)
    if not simulator.regions:
        raise ValueError(f"{character.name}: expected a character with cloth, found no cloth region")
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    cloth = cloth_of(character, simulator, areal_density)
    played = None if motion is None else motion_of(character, simulator, motion, context or d.Context())
    for former in (MOTION_FILE, USD_FILE):  # they may be of another garment
        (folder / former).unlink(missing_ok=True)
    files = [folder / CLOTH_FILE]
    write_text(files[0], as_text(cloth))
    if played:
        files.append(folder / MOTION_FILE)
        write_text(files[-1], as_text(played))
    if importlib.util.find_spec("pxr"):
        files.append(folder / USD_FILE)
        write_cloth_usd(files[-1], cloth, played)
    return files


def simulator_of(character: d.Character) -> d.CharacterSimulator:
    return d.CharacterSimulator(character.actor, character.segmentation, character.proxies, character.solver.cloth)


def as_text(value) -> str:
    """JSON with a line for each member of the first two levels, so that a person finds the way."""

    def member(name: str, entry, inner: str) -> str:
        return f"{inner}{json.dumps(name)}: {text(entry, inner)}"

    def text(entry, indent: str) -> str:
        inner = indent + " "
        if isinstance(entry, dict) and len(indent) < 4:
            return "{\n" + ",\n".join(member(k, v, inner) for k, v in entry.items()) + f"\n{indent}}}"
        if isinstance(entry, list) and entry and isinstance(entry[0], dict) and len(indent) < 4:
            return "[\n" + ",\n".join(inner + text(one, inner) for one in entry) + f"\n{indent}]"
        return json.dumps(entry, allow_nan=False)

    return text(value, "") + "\n"


def numbers(array, decimals: int = 6) -> list:
    return np.round(np.asarray(array, float), decimals).tolist()


def significant(array) -> list:
    """To six digits, whatever the unit."""
    return [float(f"{x:.6g}") for x in np.asarray(array, float)]


# --- what stays


def cloth_of(character: d.Character, simulator: d.CharacterSimulator, areal_density: float) -> dict:
    options = character.solver.cloth
    skeleton = character.actor.skeleton
    rest = skeleton.joint_positions(np.zeros(len(skeleton.dof_names)))
    return {
        "format": FORMAT,
        "version": VERSION,
        "name": character.name,
        "units": {"length": "m", "mass": "kg", "time": "s", "up": "+Y", "handedness": "right", "quaternion": "x y z w"},
        "gravity": numbers(options.gravity),
        "frame_seconds": character.solver.dt,
        "solver": character.solver.to_dict() | {"cloth": plain(options.to_dict())},
        "skeleton": [
            {"name": name, "parent": int(parent), "position": numbers(place)}
            for name, parent, place in zip(skeleton.joint_names, skeleton.joint_parents, rest)
        ],
        "capsules": [
            {"joint": c.joint, "p0": numbers(c.p0), "p1": numbers(c.p1), "r0": round(c.r0, 6), "r1": round(c.r1, 6)}
            for c in character.proxies
        ],
        "contact": {"thickness": options.thickness, "self_thickness": options.self_thickness, "restitution": options.restitution},
        "garments": [
            garment_of(character, region, material, areal_density)
            for region, material in zip(simulator.regions, character.materials)
        ],
    }


def plain(values: dict) -> dict:
    return {name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in values.items()}


def garment_of(character: d.Character, region: d.ClothRegion, material: d.Material, areal_density: float) -> dict:
    model, at = region.model, np.asarray(region.vertex_from_cloth)
    springs = springs_of(model, material, areal_density)
    masses = areal_density * areas_of(model)
    clothness = np.asarray(model.clothness)
    weights = character.actor.weights[at]
    chosen = np.argsort(-weights, axis=1, kind="stable")[:, :JOINTS_A_VERTEX]
    shares = np.take_along_axis(weights, chosen, axis=1)
    return {
        "vertices": numbers(character.actor.mesh.vertices[at]),
        "rest_vertices": numbers(model.rest),
        "faces": np.asarray(model.faces).tolist(),
        "actor_vertices": at.tolist(),
        "areal_density": areal_density,
        "masses": significant(masses),
        "attachment": {
            "clothness": numbers(clothness),
            "spring": significant(attachment_springs(masses, clothness, character.solver.dt)),
            "joints": chosen.tolist(),
            "weights": numbers(shares / np.maximum(shares.sum(axis=1, keepdims=True), 1e-12)),
        },
        "material": plain(material.to_dict()),
        "stretch": {
            "edges": springs.edges.tolist(),
            "rest_lengths": numbers(springs.lengths),
            "stiffness": significant(springs.stretch),
            "rigid": springs.rigid,
            "rigid_gives": RIGID if springs.rigid else 0.0,
        },
        "bend": {
            "hinges": springs.hinges.tolist(),
            "rest_angles": numbers(springs.angles),
            "stiffness": significant(springs.bend),
        },
        "engines": engines_of(springs, model, material, areal_density),
    }


def areas_of(model: d.ClothModel) -> np.ndarray:
    """(N) m^2 that a vertex stands for, the pinned ones too: a third of the faces around it."""
    inverse = np.asarray(model.inverse_masses)
    areas = d.vertex_areas(model.rest, model.faces)
    return np.where(inverse > 0, 1 / np.where(inverse > 0, inverse, 1), areas)


def attachment_springs(masses: np.ndarray, clothness: np.ndarray, frame: float) -> np.ndarray:
    """(N) N/m to the place where the skeleton has the vertex; 0 = free. The pinned ones, of clothness 0, have none either."""
    blended = (clothness > 0) & (clothness < 1)
    share = np.where(blended, clothness, 1.0)
    return np.where(blended, masses * (1 - share) / (share * frame**2), 0.0)


# --- what it is elsewhere


def engines_of(springs: Springs, model: d.ClothModel, material: d.Material, areal_density: float) -> dict:
    """The numbers of other engines, under their names; formulas and what is approximate: docs/export-cloth.md."""
    stretch, bend = median(springs.stretch), median(springs.bend)
    lengths = np.linalg.norm(np.diff(np.asarray(model.rest)[springs.hinges[:, :2]], axis=1)[:, 0], axis=1)
    heights = hinge_heights(springs, np.asarray(model.rest), lengths)
    drag = areal_density * material.d_n / AIR  # the cloth's deceleration is d_n / 2 times its speed squared
    lame = 3 / 8 * springs.young  # both of Lame's, at Poisson's ratio 1/3
    mean_edge = float(np.mean(springs.lengths)) if len(springs.lengths) else 0.0
    values = {
        "newton": {
            "density": areal_density,
            "spring_ke": stretch,
            "tri_ke": lame,
            "tri_ka": lame,
            "edge_ke": median(springs.bend / lengths),
        },
        "physx_particle_cloth": {
            "springStretchStiffness": stretch,
            "springBendStiffness": median(springs.bend * (np.pi / 2) ** 2 / ((2 - np.sqrt(2)) * heights) ** 2),
            "friction": material.k_friction,
            "drag": drag,
        },
        "physx_surface": {
            "youngs_times_thickness": springs.young,
            "poissons": 1 / 3,
            "bending_rigidity": springs.bending_rigidity,
        },
        "chaos": {
            "density": areal_density,
            "xpbd_edge_spring_stiffness": stretch,
            "xpbd_bending_element_stiffness_cm": 1e4 * bend,
            "friction_coefficient": material.k_friction,
            "drag_coefficient": drag,
        },
        "unity": {
            "stretchingStiffness": 1 - (1 - material.k_stretch) ** 4,
            "bendingStiffness": 1 - (1 - material.k_bend) ** 4,
            "friction": material.k_friction,
        },
        "blender": {
            "mass": areal_density * float(areas_of(model).sum()) / model.vertex_count,
            "tension_stiffness": stretch * mean_edge,
            "compression_stiffness": stretch * mean_edge,
            "shear_stiffness": 0.0,
            "bending_stiffness": median(springs.bend / lengths) / 0.1,
        },
    }
    return {name: {key: float(f"{x:.6g}") for key, x in numbers_of.items()} for name, numbers_of in values.items()}


def median(values: np.ndarray) -> float:
    return float(np.median(values)) if len(values) else 0.0


def hinge_heights(springs: Springs, rest: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """(H) m, the mean height of the two faces over the edge."""
    return hinge_areas(rest, springs.hinges) / np.maximum(lengths, 1e-12)


# --- what moves


def motion_of(character: d.Character, simulator: d.CharacterSimulator, motion: d.Motion, context: d.Context) -> dict:
    """The skeleton's joints, the places that attached vertices are drawn to, and what our own solver makes of it."""
    skeleton = character.actor.skeleton
    rest = skeleton.joint_positions(np.zeros(len(skeleton.dof_names)))
    regions = [np.asarray(region.vertex_from_cloth) for region in simulator.regions]
    held = [np.flatnonzero(np.asarray(region.model.clothness) < 1) for region in simulator.regions]
    places, turns, targets, simulated = [], [], [[] for _ in regions], [[] for _ in regions]

    def keep(frame: d.AnimationFrame) -> None:
        world = np.asarray(skeleton.forward_kinematics(frame.dofs))  # from rest
        places.append(np.einsum("jab,jb->ja", world[:, :3, :3], rest) + world[:, :3, 3])
        turns.append(world[:, :3, :3])
        skinned = simulator.pose(frame.dofs).skinned
        for k, at in enumerate(regions):
            targets[k].append(skinned[at[held[k]]])
            simulated[k].append(frame.surface[at])

    count = d.animate_each(character, motion, keep, d.AnimateOptions(high=False, body=False), context)
    return {
        "format": MOTION_FORMAT,
        "version": VERSION,
        "frames": count,
        "fps": round(1 / character.solver.dt, 6),
        "joints": {"translations": numbers(places, 5), "rotations": numbers(quaternions_of(np.array(turns)), 6)},
        "garments": [
            {"attached": held[k].tolist(), "targets": numbers(targets[k], 5), "simulated": numbers(simulated[k], 4)}
            for k in range(len(regions))
        ],
    }


def quaternions_of(rotations: np.ndarray) -> np.ndarray:
    """(T, J, 4) x y z w of matrices, each joint's on the side of its last: a program that blends between frames must not spin."""
    found = of_matrices(rotations)[..., [1, 2, 3, 0]]
    turned = np.sum(found[1:] * found[:-1], axis=-1) < 0
    signs = np.cumprod(np.concatenate([np.ones_like(found[:1, :, 0]), np.where(turned, -1.0, 1.0)]), axis=0)
    return found * signs[..., None]
