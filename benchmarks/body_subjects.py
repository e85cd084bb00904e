"""People of a registered population as scans whose naked body is known: with holes, hair, shoes, other poses, and dressed."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from doublet import _doublet as d

#: Landmarks of a session, by the population's names.
CLICKED = ["crown", "nose_tip"] + [f"{s}_{n}" for s in "lr" for n in ("middle_tip", "thumb_tip", "big_toe_tip", "heel")]
ARM, LEG = ("shoulder", "elbow"), ("hip", "knee")


class Population:
    """population.npz as docs/body-model.md lists it, dequantised on demand."""

    def __init__(self, path: Path):
        self.path = Path(path)
        if not self.path.exists():
            raise FileNotFoundError(f"{path} (the population) does not exist")
        with np.load(self.path) as file:
            self.arrays = {name: file[name] for name in file.files}
        missing = sorted({"vertices_q", "mesh_individual", "joint_rotvec", "ind_rest_joints"} - set(self.arrays))
        if missing:
            raise RuntimeError(f"{path}: array '{missing[0]}' is missing, expected a population of registered meshes")
        self.faces = self.arrays["faces"].astype(np.int32)
        self.weights = self.arrays["skin_weights"].astype(float)
        self.weights /= self.weights.sum(axis=1, keepdims=True)
        self.joint_names = [str(n) for n in self.arrays["joint_names"]]
        self.parents = self.arrays["joint_parents"].astype(int)
        self.individual = self.arrays["mesh_individual"].astype(int)
        self.people = len(self.arrays["ind_rest_joints"])
        self.landmarks = dict(zip(map(str, self.arrays["landmark_names"]), self.arrays["landmark_indices"].astype(int)))
        self.bone = self.weights.argmax(axis=1)  # of every vertex

    def vertices(self, mesh: int) -> np.ndarray:
        return self.arrays["vertex_offset"] + float(self.arrays["vertex_scale"]) * self.arrays["vertices_q"][mesh]

    def transforms(self, mesh: int, turns: dict[str, np.ndarray] | None = None) -> np.ndarray:
        """(J, 4, 4) world_from_rest of a mesh; turns: joint -> rotation vector in the world, added to its pose."""
        rest = self.arrays["ind_rest_joints"][self.individual[mesh]].astype(float)
        angles, root = self.arrays["joint_rotvec"][mesh].astype(float), self.arrays["joints"][mesh, 0].astype(float)
        world = np.tile(np.eye(4), (len(rest), 1, 1))
        for j, parent in enumerate(self.parents):
            above = np.eye(3) if parent < 0 else world[parent, :3, :3]
            position = root if parent < 0 else above @ rest[j] + world[parent, :3, 3]
            world[j, :3, :3] = turn((turns or {}).get(self.joint_names[j], np.zeros(3))) @ above @ turn(angles[j])
            world[j, :3, 3] = position - world[j, :3, :3] @ rest[j]
        return world

    def joints(self, mesh: int, world: np.ndarray) -> np.ndarray:
        rest = self.arrays["ind_rest_joints"][self.individual[mesh]].astype(float)
        return np.einsum("jab,jb->ja", world[:, :3, :3], rest) + world[:, :3, 3]

    def posed(self, mesh: int, turns: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Vertices and joints of a mesh after further turns of its joints."""
        now, then = self.transforms(mesh), self.transforms(mesh, turns)
        unposed = d.dual_quaternion_skinning(self.vertices(mesh), self.weights, np.linalg.inv(now))
        # The inverse of a blend is not the blend of inverses; one round trip removes most of the difference.
        unposed += self.vertices(mesh) - d.dual_quaternion_skinning(unposed, self.weights, now)
        return d.dual_quaternion_skinning(unposed, self.weights, then), self.joints(mesh, then)

    def is_of(self, *bones: str) -> np.ndarray:
        """(V) whether a vertex moves most with one of the bones, l_ and r_ alike."""
        chosen = [j for j, name in enumerate(self.joint_names) if name.removeprefix("l_").removeprefix("r_") in bones]
        return np.isin(self.bone, chosen)


def turn(vector: np.ndarray) -> np.ndarray:
    """Rotation matrix of a rotation vector (Rodrigues)."""
    angle = np.linalg.norm(vector)
    if angle == 0:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


@dataclass
class Subject:
    """A scan and what is under it."""

    people: Population
    truth: np.ndarray  # (V, 3) m, naked
    joints: np.ndarray  # (J, 3) m
    mesh: d.Mesh  # the scan
    clothness: np.ndarray  # of its vertices
    face_valid: np.ndarray
    hidden: np.ndarray  # (V) bool, of the naked body
    landmarks: dict[str, np.ndarray] = field(default_factory=dict)
    marks_off: float = 0.004  # m, how far marks on the skin are off

    def actor(self, rng: np.random.Generator) -> tuple[d.RiggedMesh, d.Segmentation, dict]:
        """As a session gives it: joints 10 mm off (they lie inside), marks marks_off, the surface 0.4 mm."""
        names = self.people.joint_names
        off = {name: away(rng, max(0.01, self.marks_off)) for name in names}
        marks = [
            d.JointAnnotation(name, names[p] if p >= 0 else "", self.joints[j] + off[name], 6 if p < 0 else 0)
            for j, (name, p) in enumerate(zip(names, self.people.parents))
        ]
        skeleton = d.Skeleton(marks)
        noisy = d.Mesh(self.mesh.vertices + rng.normal(0, 0.0004, self.mesh.vertices.shape), self.mesh.faces)
        count = len(noisy.vertices)
        weights = np.zeros((count, len(names)))
        weights[:, 0] = 1
        clothness = d.Segmentation(np.zeros(count), self.clothness, np.where(self.clothness > 0, 0, -1))
        landmarks = {n: p + away(rng, self.marks_off) for n, p in self.landmarks.items()}
        return d.RiggedMesh(noisy, self.face_valid.astype(np.uint8), weights, skeleton), clothness, landmarks


def away(rng: np.random.Generator, distance: float) -> np.ndarray:
    direction = rng.normal(size=3)
    return distance * direction / np.linalg.norm(direction)


def naked(people: Population, mesh: int, turns: dict[str, np.ndarray] | None = None) -> Subject:
    vertices, joints = (
        people.posed(mesh, turns) if turns else (people.vertices(mesh), people.arrays["joints"][mesh].astype(float))
    )
    count = len(vertices)
    marks = {n: vertices[people.landmarks[n]] for n in CLICKED if n in people.landmarks}
    skin = d.Mesh(vertices, people.faces)
    return Subject(
        people, vertices, joints, skin, np.zeros(count), np.ones(len(people.faces), bool), np.zeros(count, bool), marks
    )


def without(subject: Subject, gone: np.ndarray) -> Subject:
    """The scan lacks these vertices of the naked body."""
    invalid = gone[subject.people.faces].any(axis=1)
    return replace(subject, face_valid=subject.face_valid & ~invalid, hidden=subject.hidden | gone)


def band(subject: Subject) -> np.ndarray:
    """(V) between hips and knees, hands left out: what a skirt hides."""
    people, names = subject.people, subject.people.joint_names
    height = subject.truth[:, 1]
    hip, knee = (subject.joints[[names.index(f"{s}_{n}") for s in "lr"], 1].mean() for n in LEG)
    return (height > knee) & (height < hip) & people.is_of("pelvis", "hip", "knee", "spine", "spine1", "spine2")


def with_holes(subject: Subject, rng: np.random.Generator, count: int = 15, radius: float = 0.06) -> Subject:
    centres = subject.truth[rng.choice(len(subject.truth), count, replace=False)]
    gone = (np.linalg.norm(subject.truth[:, None] - centres, axis=2) < radius).any(axis=1)
    return without(subject, gone)


def with_hair_and_shoes(subject: Subject) -> Subject:
    """Hair 3 cm thick over the skull and down the neck, soles of 3 cm, uppers of 8 mm. All of it is scan, none is marked."""
    people = subject.people
    vertices = subject.mesh.vertices.copy()
    normals = d.vertex_normals(vertices, people.faces)
    head = subject.joints[people.joint_names.index("head")]
    above = vertices - head
    hair = people.is_of("head", "neck") & (above @ [0, 0.5, -1] > 0.02)
    vertices[hair] += 0.03 * normals[hair]
    feet = people.is_of("ankle", "toe") & (vertices[:, 1] < vertices[:, 1].min() + 0.09)
    sole = feet & (normals[:, 1] < -0.5)
    vertices[feet] += 0.008 * normals[feet]
    vertices[sole, 1] -= 0.03
    landmarks = {name: vertices[people.landmarks[name]] for name in subject.landmarks}
    return replace(subject, mesh=d.Mesh(vertices, people.faces), landmarks=landmarks, hidden=subject.hidden | hair | feet)


def sleeve_cover(subject: Subject, garment: str) -> np.ndarray:
    """(V) what a garment of one layer along the body covers."""
    people = subject.people
    legs = people.is_of("hip", "knee")
    hips = people.is_of("pelvis", "spine1")
    trunk = people.is_of("pelvis", "spine1", "spine2", "chest", "clavicle")
    arms = people.is_of("shoulder", "elbow")
    upper = people.is_of("shoulder")
    return {
        "trousers": legs | hips,
        "shirt": trunk | arms,
        "overall": legs | trunk | arms,
        "dress": trunk | upper,
        "long_dress": trunk | arms,
        "skirt": hips & ~people.is_of("spine1"),
    }[garment]


#: Garment -> where its wide part ends between hip (0), knee (1) and ankle (2); None = along the body everywhere.
GARMENTS = {"skirt": 1.0, "dress": 1.0, "long_dress": 1.7, "trousers": None, "shirt": None, "overall": None}


def dressed(subject: Subject, garment: str, ease: float, rng: np.random.Generator) -> Subject:
    """In a garment `ease` m wide, with folds of a third of that; what it covers is gone from the scan."""
    people, body = subject.people, subject.truth
    cover = sleeve_cover(subject, garment)
    names = people.joint_names
    middle = {n: subject.joints[[names.index(f"{s}_{n}") for s in "lr"]].mean(axis=0) for n in ("hip", "knee", "ankle")}
    length = GARMENTS[garment]
    if length is not None:
        y = [middle[n][1] for n in ("hip", "knee", "ankle")]
        hem = np.interp(length, [0, 1, 2], y)
        limbs = people.is_of("pelvis", "hip", "knee", "spine1")
        cover = cover | (limbs & (body[:, 1] < y[0] + 0.05) & (body[:, 1] > hem))
    normals = smooth_normals(body, people.faces)
    wave = np.sin(body @ rng.normal(0, 40, (3, 4)) + rng.uniform(0, 6, 4)).mean(axis=1)
    # No wider than 0.4 of the gap to the body opposite: the cloth of an arm does not enter that of the trunk.
    _, gap = d.RayScene(subject.mesh).cast(body, normals, 0.002)
    cloth = body + np.minimum(ease * (0.75 + 0.5 * wave), 0.4 * gap)[:, None] * normals
    along = cover.copy()
    if length is not None:
        along &= body[:, 1] > y[0]
    faces = people.faces
    parts = [(body, faces[~cover[faces].any(axis=1)], 0.0), (cloth, faces[along[faces].all(axis=1)], 1.0)]
    if length is not None:
        parts.append((*lathe(body[limbs], y[0] + 0.02, hem, ease, rng), 1.0))
    vertices, triangles, clothness = join(parts)
    marks = {n: p for n, p in subject.landmarks.items() if not cover[people.landmarks[n]]}
    mesh = d.Mesh(vertices, triangles)
    return replace(
        subject, mesh=mesh, clothness=clothness, face_valid=np.ones(len(triangles), bool), hidden=cover, landmarks=marks
    )


def join(parts) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Parts (vertices, faces, clothness) as one mesh without unused vertices."""
    vertices, faces, clothness, first = [], [], [], 0
    for points, triangles, cloth in parts:
        used, index = np.unique(triangles, return_inverse=True)
        vertices.append(points[used])
        faces.append(index.reshape(-1, 3) + first)
        clothness.append(np.full(len(used), cloth))
        first += len(used)
    return np.vstack(vertices), np.vstack(faces).astype(np.int32), np.concatenate(clothness)


def smooth_normals(vertices: np.ndarray, faces: np.ndarray, rounds: int = 5) -> np.ndarray:
    normals = d.vertex_normals(vertices, faces)
    for _ in range(rounds):
        total = np.zeros_like(normals)
        for k in range(3):
            np.add.at(total, faces[:, k], normals[faces].sum(axis=1))
        normals = total / np.linalg.norm(total, axis=1, keepdims=True)
    return normals


def lathe(limbs: np.ndarray, top: float, hem: float, ease: float, rng: np.random.Generator):
    """A skirt: rings around the hull of what is inside, wider towards the hem, with folds."""
    around, rows = 72, 24
    angle = np.linspace(0, 2 * np.pi, around, endpoint=False)
    direction = np.stack([np.sin(angle), np.cos(angle)], axis=1)
    phase = rng.uniform(0, 2 * np.pi)
    rings, radius = [], np.zeros(around)
    centre = limbs[np.abs(limbs[:, 1] - top) < 0.05][:, [0, 2]].mean(axis=0)
    for t in np.linspace(0, 1, rows):
        height = top + t * (hem - top)
        slab = limbs[np.abs(limbs[:, 1] - height) < 0.03][:, [0, 2]] - centre
        if len(slab):
            radius = np.maximum(radius, (slab @ direction.T).max(axis=0))
        wide = radius + ease * (1 + t) + 0.6 * ease * t * np.sin(9 * angle + phase)
        ring = centre + wide[:, None] * direction
        rings.append(np.stack([ring[:, 0], np.full(around, height), ring[:, 1]], axis=1))
    here = np.arange(rows - 1)[:, None] * around + np.arange(around)
    ahead = np.arange(rows - 1)[:, None] * around + (np.arange(around) + 1) % around
    faces = np.stack([np.stack([here, here + around, ahead], -1), np.stack([ahead, here + around, ahead + around], -1)])
    return np.vstack(rings), faces.reshape(-1, 3).astype(np.int32)
