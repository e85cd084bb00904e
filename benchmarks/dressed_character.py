"""A character in trousers, a shirt, an open jacket or several of them: for synthetic sessions.

python benchmarks/dressed_character.py trousers -o trousers.glb [--ease 0.03] [--shape 3] [--snug pelvis hip]
python benchmarks/dressed_character.py trousers tee -o both.glb      # one over the other, the outermost last
python benchmarks/dressed_character.py trousers -o plain.glb --remesh # a mesh of its own, as of `doublet garment`; no pattern
doublet synthesize trousers.glb --motion CLIP.bvh --camera-count 8 --image-size 502 --frame-count 80 -o session
doublet capture session -o out && doublet segment out && doublet evaluate out --truth session/ground_truth

The body is the shipped model's, in a random shape; the garment is a layer of cloth around it that hangs from a band at its top,
with folds. Along the bones that are --snug it clings to the body, which carries it. Body and garment have patterns of their own,
so that there is something to track.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import doublet as d
import numpy as np
from body_subjects import join, smooth_normals
from doublet.evaluation.synthesize import ring_of_cameras

FPS = 40.0
BAND = 0.04  # m, of the cloth that is fastened
SLIT = 0.04  # m, half the width of the open front
CLINGING = 0.003  # m, from the body to cloth that clings to it
LAYER = 0.012  # m, from a garment to one that is worn over it
LEGS, ARMS = ("hip", "knee"), ("shoulder", "elbow")
TRUNK = ("pelvis", "spine1", "spine2", "chest", "clavicle")


@dataclass
class Cut:
    """What a garment covers: bone -> share of its length, from its joint on; the bones beside which it is fastened."""

    covers: dict[str, float]
    fastened: tuple[str, ...]
    is_open: bool = False  # in front
    snug: tuple[str, ...] = ()  # bones along which it clings to the body


WHOLE = np.inf  # of a bone, and what its weights move beyond the next joint
WAIST, NECK = ("spine1", "spine2"), ("neck", "head")
GARMENTS = {
    "trousers": Cut(dict.fromkeys(("pelvis", *LEGS), WHOLE), WAIST),
    "shorts": Cut({"pelvis": WHOLE, "hip": 0.7}, WAIST),
    "tee": Cut({**dict.fromkeys(TRUNK, WHOLE), "shoulder": 0.6}, NECK),
    "shirt": Cut(dict.fromkeys((*TRUNK, *ARMS), WHOLE), NECK),
    "jacket": Cut(dict.fromkeys((*TRUNK, *ARMS), WHOLE), NECK, True),
}
SKIN_TINT, CLOTH_TINTS = (0.35, 0.5, 0.7), ((0.55, 0.15, 0.1), (0.1, 0.2, 0.6))  # B G R
#: As a session's joints.json has them.
DEGREES = {"pelvis": 6, "spine1": 3, "neck": 3, "shoulder": 3, "elbow": 2, "wrist": 2, "hip": 3, "knee": 1, "ankle": 1}
MATERIAL = {"d_n": 2.0, "d_t": 2.0, "k_bend": 0.3, "k_stretch": 1.0, "k_friction": 0.3}
CELL = {False: 0.018, True: 0.03}  # m, of the pattern on the body, on the garment


def without_side(name: str) -> str:
    return name.removeprefix("l_").removeprefix("r_")


class Person:
    """The shipped model in a random shape: vertices, faces, joints, skin weights."""

    def __init__(self, shape: int):
        path = d.body_model_path()
        model = d.BodyModel.read(path)
        with np.load(path) as file:
            self.names = [str(n) for n in file["joint_names"]]
            self.parents = [int(p) for p in file["joint_parents"]]
            indices, weights = file["skin_indices"], file["skin_weights"].astype(float)
        coefficients = np.zeros(model.component_count)
        first = min(10, model.shape_count)
        coefficients[:first] = 0.7 * np.random.default_rng(shape).standard_normal(first)
        self.vertices, self.faces = np.array(model.vertices(coefficients)), np.array(model.faces)
        self.joints = np.array(model.joints(coefficients)[0])
        floor = [0, self.vertices[:, 1].min(), 0]
        self.vertices, self.joints = self.vertices - floor, self.joints - floor
        self.weights = np.zeros((len(self.vertices), len(self.names)))
        for k in range(indices.shape[1]):
            np.add.at(self.weights, (np.arange(len(indices)), indices[:, k]), weights[:, k])
        self.weights /= self.weights.sum(axis=1, keepdims=True)
        self.bone = np.array([without_side(n) for n in self.names])[self.weights.argmax(axis=1)]

    def skeleton(self) -> d.Skeleton:
        parents = [self.names[p] if p >= 0 else "" for p in self.parents]
        marks = zip(self.names, parents, self.joints)
        return d.Skeleton([d.JointAnnotation(n, p, at, DEGREES.get(without_side(n), 0)) for n, p, at in marks])

    def covered(self, cut: Cut) -> np.ndarray:
        """bool (V)"""
        bones = self.weights.argmax(axis=1)
        along = np.zeros(len(self.vertices))
        for joint in range(len(self.names)):
            children = [c for c, parent in enumerate(self.parents) if parent == joint]
            if len(children) == 1:
                way = self.joints[children[0]] - self.joints[joint]
                at = bones == joint
                along[at] = (self.vertices[at] - self.joints[joint]) @ way / (way @ way)
        share = np.array([cut.covers.get(without_side(name), -np.inf) for name in self.names])[bones]
        slit = np.zeros(len(self.vertices), bool)
        if cut.is_open:
            trunk = np.isin(self.bone, ("pelvis", "spine1", "spine2", "chest"))
            slit = trunk & (np.abs(self.vertices[:, 0]) < SLIT) & (d.vertex_normals(self.vertices, self.faces)[:, 2] > 0)
        return (along <= share) & ~slit


def distance_to(points: np.ndarray, others: np.ndarray) -> np.ndarray:
    return np.array([np.linalg.norm(others - p, axis=1).min() for p in points])


def standing_off(person: Person, cut: Cut, ease: float, wave: np.ndarray, gap: np.ndarray):
    """(V) m from the body to the cloth; (V) bool where it clings; (V) bool where it is fastened."""
    snug = person.weights[:, np.isin([without_side(n) for n in person.names], cut.snug)].sum(axis=1)
    wide = np.minimum(ease * (0.75 + 0.5 * wave), 0.3 * gap)  # the cloth of a leg does not enter that of the other
    wide = snug * np.minimum(CLINGING, wide) + (1 - snug) * wide
    band = distance_to(person.vertices, person.vertices[np.isin(person.bone, cut.fastened)]) < BAND
    return np.where(band, 0.3 * wide, wide), snug > 0.5, band


def without_crossing(body: d.Mesh, wide: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """(V, 3) m: the body's vertices, so far along the normals; less where the layer would pass through itself, which lasts."""
    for _ in range(30):  # to a thousandth; a body may pass through itself, too
        layer = body.vertices + wide[:, None] * normals
        crossing = body.faces[d.self_intersecting_faces(d.Mesh(layer, body.faces))]
        wide[np.unique(crossing)] *= 0.8
    return layer


def around(person: Person, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of each vertex of the body: (V, 3) its normal, (V) in [-1, 1] the folds of cloth there, (V) m to what is before it."""
    body, faces = person.vertices, person.faces
    normals = smooth_normals(body, faces)
    wave = np.sin(body @ random.normal(0, 40, (3, 4)) + random.uniform(0, 6, 4)).mean(axis=1)
    _, gap = d.RayScene(d.Mesh(body, faces)).cast(body, normals, 0.002)
    return normals, wave, gap


def dressed(person: Person, cuts: Sequence[Cut], ease: float, random: np.random.Generator):
    """(vertices, faces, clothness, fabric, weights) of skin and cloth; fabric: which garment, -1 = skin; clothness is 0 of
    fabric that is fastened or clings. What lies over another garment is `LAYER` farther out."""
    body, faces = person.vertices, person.faces
    normals, wave, gap = around(person, random)
    index = np.arange(len(body))[:, None] * [1.0, 0, 0]  # which vertex of the body each is, carried through join()
    covers = [person.covered(cut) for cut in cuts]
    parts = [(index, faces[~np.any(covers, axis=0)[faces].any(axis=1)], -1.0)]
    sheets, below = [], np.zeros(len(body))
    for layer, (cut, cover) in enumerate(zip(cuts, covers)):
        away, clings, band = standing_off(person, cut, ease, wave, gap)
        away = np.where(below > 0, np.maximum(away, below + LAYER), away)
        below = np.where(cover, away, below)
        worn = faces[cover[faces].all(axis=1)]
        sheets.append((without_crossing(d.Mesh(body, worn), away, normals), clings, band))
        parts.append((index, worn, float(layer)))
    used, kept_faces, layer = join(parts)
    of, layer = used[:, 0].round().astype(int), layer.astype(int)
    vertices, clothness, fabric = body[of], np.zeros(len(of)), np.full(len(of), -1)
    for number, (cloth, clings, band) in enumerate(sheets):
        here = layer == number
        vertices[here] = cloth[of[here]]
        fabric[here & (clings | ~band)[of]] = number  # what is fastened looks like skin
        clothness[here & ~band[of] & ~clings[of]] = 1
    return vertices, kept_faces, clothness, fabric, person.weights[of]


def as_scanned(person: Person, cut: Cut, ease: float, random: np.random.Generator):
    """(vertices, faces, face_valid, clothness) of one surface, as a template has them: not valid between a hem and the skin,
    where it ends free."""
    faces, cover = person.faces, person.covered(cut)
    normals, wave, gap = around(person, random)
    away, clings, band = standing_off(person, cut, ease, wave, gap)
    cloth = without_crossing(d.Mesh(person.vertices, faces[cover[faces].all(axis=1)]), away, normals)
    at_hem = cover[faces].any(axis=1) & ~cover[faces].all(axis=1) & ~band[faces].any(axis=1)
    return np.where(cover[:, None], cloth, person.vertices), faces, ~at_hem, (cover & ~band & ~clings).astype(float)


def pattern(points: np.ndarray, cell: np.ndarray, seed: int) -> np.ndarray:
    """(N, 3) uint8: coloured blots of `cell` (N) m, fixed to the points (N, 3)."""
    grid = np.floor(points / cell[:, None]).astype(np.int64)
    best, colour = np.full(len(points), np.inf), np.zeros((len(points), 3))
    for offset in np.ndindex(3, 3, 3):
        corner = grid + np.array(offset) - 1
        mixed = corner @ np.array([73856093, 19349663, 83492791]) + seed * 7919 + (cell * 1e4).astype(np.int64)
        hashes = [((mixed * p + q) ^ (mixed >> 3)) % 1009 for p, q in ((6971, 13), (7919, 29), (8699, 47))]
        noise = np.stack(hashes, axis=1) / 1009
        away = np.linalg.norm((corner + noise) * cell[:, None] - points, axis=1)
        nearer = away < best
        best[nearer], colour[nearer] = away[nearer], noise[nearer][:, [1, 2, 0]]
    return colour


def picture(
    character: d.Character, fabric: np.ndarray, camera: d.Camera, seed: int, tints: np.ndarray, contrast: float
) -> tuple[np.ndarray, np.ndarray]:
    """(H, W, 3) uint8 BGR, (H, W) uint8: the character with its patterns, fabric (V) of its vertices, and where it is."""
    mesh = character.actor.mesh
    face, depth = d.rasterize(mesh.vertices, mesh.faces, camera)
    rows, columns = np.nonzero(face >= 0)
    rays = np.stack([columns, rows, np.ones(len(rows))], axis=1) @ np.linalg.inv(camera.K).T
    points = (rays * depth[rows, columns][:, None] - np.asarray(camera.t).ravel()) @ np.asarray(camera.R)
    garment = fabric[mesh.faces[face[rows, columns]]].max(axis=1)
    cell = np.where(garment >= 0, CELL[True], CELL[False])
    colours = pattern(points, cell, seed)
    shown = 255 * ((1 - contrast) * tints[garment] + contrast * colours * [1, 0.6, 1])
    image = np.zeros((camera.height, camera.width, 3), np.uint8)
    image[rows, columns] = np.clip(shown, 0, 255)
    return image, (255 * (face >= 0)).astype(np.uint8)


def body_of(person: Person) -> d.BodyFit:
    fit = d.BodyFit()
    fit.body = d.Mesh(person.vertices, person.faces)
    return fit


def remeshed_character(cut: Cut, ease: float, shape: int) -> d.Character:
    """Its garment has a mesh of its own, as of `doublet garment`, and the solver's own substeps; without a texture."""
    person = Person(shape)
    vertices, faces, valid, clothness = as_scanned(person, cut, ease, np.random.default_rng(shape))
    actor, fit = d.RiggedMesh(d.Mesh(vertices, faces), valid, person.weights, person.skeleton()), body_of(person)
    segmentation = d.Segmentation(np.zeros(len(vertices)), clothness, np.where(clothness > 0, 0, -1).astype(np.int32))
    garment = d.mesh_garment(actor, segmentation, fit.body, d.MeshSequence(faces, vertices[None]))
    worn = d.dress(actor, segmentation, garment)
    drawn = d.build_display_mesh(worn.actor, worn.segmentation, actor.mesh)
    materials = [d.Material(**MATERIAL)] * worn.segmentation.region_count
    proxies = d.fit_proxies(fit, actor, segmentation)
    parts = worn.actor, worn.segmentation, fit, proxies, materials, d.SolverSettings(1 / FPS)
    return d.make_character(*parts, drawn.mesh, drawn.valid, drawn.garment_subdivisions)


def dressed_character(
    cuts: Sequence[Cut], ease: float, shape: int, cloth_tints=CLOTH_TINTS, contrast: float = 0.5
) -> d.Character:
    """In these garments, the outermost last."""
    person, random = Person(shape), np.random.default_rng(shape)
    vertices, faces, clothness, fabric, weights = dressed(person, cuts, ease, random)
    actor = d.RiggedMesh(d.Mesh(vertices, faces), [1] * len(faces), weights, person.skeleton())
    region = np.where(clothness > 0, fabric, -1).astype(np.int32)
    segmentation = d.Segmentation(np.zeros(len(vertices)), clothness, region)
    fit = body_of(person)
    proxies = d.fit_proxies(fit, actor, segmentation)
    # A shank is thinner than what it moves in a quarter of a frame: the cloth would pass through it.
    material, solver = d.Material(**MATERIAL), d.SolverSettings(1 / FPS, d.ClothOptions(substeps=16))
    high_valid = [1] * len(faces)
    materials = [material] * segmentation.region_count
    character = d.make_character(actor, segmentation, fit, proxies, materials, solver, actor.mesh, high_valid)
    cameras = ring_of_cameras(character, d.Motion(FPS, np.zeros((1, len(actor.skeleton.dof_names)))), 12, 1400)
    tints = np.array([*cloth_tints[: len(cuts)], SKIN_TINT])  # no green: the screen is; -1 is the skin
    pictures = [picture(character, fabric, camera, shape, tints, contrast) for camera in cameras]
    d.texture_character(character, vertices, cameras, [p[0] for p in pictures], [p[1] for p in pictures])
    return character


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("garments", nargs="+", choices=GARMENTS, help="the outermost last")
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--ease", type=float, default=0.03, help="m, how far the cloth stands off the body")
    parser.add_argument("--shape", type=int, default=1, help="seed of the person and the folds")
    parser.add_argument("--snug", nargs="+", default=(), metavar="BONE", help="along which it clings to the body: pelvis, hip")
    parser.add_argument("--remesh", action="store_true", help="the garment gets a mesh of its own; no pattern")
    options = parser.parse_args()
    cuts = [replace(GARMENTS[name], snug=tuple(options.snug)) for name in options.garments]
    if options.remesh and len(cuts) > 1:
        parser.error(f"expected one garment with --remesh, found {len(cuts)}")
    if options.remesh:
        character = remeshed_character(cuts[0], options.ease, options.shape)
    else:
        character = dressed_character(cuts, options.ease, options.shape)
    character.name = " and ".join(options.garments)
    character.write(options.output)


if __name__ == "__main__":
    main()
