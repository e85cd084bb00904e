"""A capture session with known truth: a character rendered back into calibrated cameras (docs/synthesis.md)."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image, ImageFilter

from .. import _doublet as d
from ..common.console import Console
from ..common.files import write_json, written_atomically
from ..common.packaged import body_model_path
from ..common.video import VideoWriter
from ..export.clips import at_own_rate

FRAMES_A_CHUNK = 32  # of ground_truth/frames_*.npz: bounds memory while writing and reading
BODY, GARMENT = 128, 255  # labels of the true masks


@dataclass
class SynthesisOptions:
    """What the cameras and their images are like."""

    camera_count: int = 8  # of a ring around the motion; unused if `rig` is given
    image_size: int = 1004  # px, width and height; likewise
    frame_count: int = -1  # -1 = the whole motion
    noise: float = 0.0  # grey levels (of 255), standard deviation of the sensor's noise
    blur: float = 0.0  # px, standard deviation of a Gaussian
    scan_noise: float = 0.0004  # m, along the normals
    mark_noise: float = 0.004  # m, of the marked joints
    mask_step: int = 10  # true masks every n-th frame
    key_colour: tuple[float, float, float] = (0.1, 0.7, 0.2)  # R G B of the screen
    seed: int = 1

    def validate(self) -> None:
        if not 2 <= self.camera_count <= 64:
            raise ValueError(f"camera_count must be 2 to 64, found {self.camera_count}")
        if self.image_size < 64 or self.image_size % 2:
            raise ValueError(f"image_size must be even and at least 64 pixels, found {self.image_size}")
        if self.mask_step < 1 or self.frame_count == 0 or self.frame_count < -1:
            raise ValueError("mask_step must be at least 1, frame_count positive or -1 for the whole motion")
        for name in ("noise", "blur", "scan_noise", "mark_noise"):
            if not getattr(self, name) >= 0:
                raise ValueError(f"{name} must not be negative, found {getattr(self, name)}")


def ring_of_cameras(character: d.Character, motion: d.Motion, count: int, size: int) -> list[d.Camera]:
    """Around the whole motion, every second one higher, so that all of it is inside every image."""
    joints = np.vstack([character.actor.skeleton.joint_positions(dofs) for dofs in motion.dofs])
    middle = (joints.min(axis=0) + joints.max(axis=0)) / 2
    radius = np.linalg.norm(joints - middle, axis=1).max() + 0.25  # m, hands and hem reach beyond the joints
    rig = []
    for c in range(count):
        camera = d.orbit_camera(middle, radius, 2 * np.pi * c / count, 0.12 if c % 2 else 0.42, size, size)
        camera.name = f"cam{c}"
        rig.append(camera)
    return rig


def drop_unused(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Indices of the vertices that `faces` use, and the faces that index those."""
    used, compact = np.unique(faces, return_inverse=True)
    return used, compact.reshape(-1, 3).astype(np.int32)


class Surfaces:
    """What is seen of a character: its display surface, split into body and garment, and the body that the garment hides."""

    def __init__(self, character: d.Character):
        self.has_high = len(character.high.vertices) > 0
        shown = character.high if self.has_high else character.actor.mesh
        valid = np.asarray(character.high_valid if self.has_high else character.actor.face_valid, bool)
        faces = shown.faces[valid] if len(valid) else shown.faces
        garment = self.garment_faces(character, shown.vertices, faces)
        self.scan_faces = faces
        self.skin_used, skin = drop_unused(shown.vertices, faces[~garment])
        self.cloth_used, self.cloth_faces = drop_unused(shown.vertices, faces[garment])
        hidden = np.asarray(character.body.faces)
        if len(character.body_shown):
            hidden = hidden[np.asarray(character.body_shown, bool)]
        self.hidden_used, hidden = drop_unused(character.body.vertices, hidden)
        self.body_faces = np.vstack([skin, hidden + len(self.skin_used)]).astype(np.int32)

    @staticmethod
    def garment_faces(character: d.Character, vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
        """bool (F): the closest valid face of the working surface is more cloth than not. (Skin that a garment stands for is
        where that garment is, but not valid.)"""
        closest, _, _ = d.RayScene(character.actor.mesh, character.actor.face_valid).closest(vertices[faces].mean(axis=1))
        return np.asarray(character.segmentation.clothness)[character.actor.mesh.faces[closest]].mean(axis=1) > 0.5

    def split(self, frame: d.AnimationFrame) -> tuple[np.ndarray, np.ndarray]:
        """(body, garment) vertices, m."""
        shown = frame.high if self.has_high else frame.surface
        return np.vstack([shown[self.skin_used], np.reshape(frame.body, (-1, 3))[self.hidden_used]]), shown[self.cloth_used]

    def mask(self, body: np.ndarray, cloth: np.ndarray, camera: d.Camera) -> np.ndarray:
        """(H, W) uint8: 0 background, 128 body, 255 garment."""
        faces = np.vstack([self.body_faces, self.cloth_faces + len(body)])
        face, _ = d.rasterize(np.vstack([body, cloth]), faces, camera)
        return np.where(face < 0, 0, np.where(face < len(self.body_faces), BODY, GARMENT)).astype(np.uint8)


class TruthWriter:
    """ground_truth/ as docs/formats.md has it, a chunk of frames at a time."""

    def __init__(self, folder: Path, surfaces: Surfaces, joint_names: list[str]):
        self.folder, self.joint_names = folder, joint_names
        for left in (*folder.glob("frames_*.npz"), *folder.glob("masks/*.png")):  # by a run that was stopped: of another motion
            left.unlink()
        label = np.r_[np.zeros(len(surfaces.skin_used) + len(surfaces.hidden_used)), np.ones(len(surfaces.cloth_used))]
        static = {"body_tris": surfaces.body_faces, "cloth_tris": surfaces.cloth_faces, "label": label.astype(np.uint8)}
        with written_atomically(folder / "static.npz") as path:
            np.savez_compressed(path, **static)
        self.body, self.cloth, self.surface, self.joints, self.dofs = [], [], [], [], []

    def add(self, frame: d.AnimationFrame, body: np.ndarray, cloth: np.ndarray) -> None:
        self.body.append(body.astype(np.float32))
        self.cloth.append(cloth.astype(np.float32))
        self.surface.append(frame.surface.astype(np.float32))
        self.joints.append(frame.joints.copy())
        self.dofs.append(frame.dofs.copy())
        if len(self.body) == FRAMES_A_CHUNK:
            self.flush()

    def flush(self) -> None:
        if not self.body:
            return
        start = len(self.joints) - len(self.body)
        with written_atomically(self.folder / f"frames_{start:04d}.npz") as path:
            np.savez_compressed(path, start=start, body=self.body, cloth=self.cloth, surface=self.surface)
        self.body, self.cloth, self.surface = [], [], []

    def finish(self) -> None:
        self.flush()
        with written_atomically(self.folder / "skeleton.npz") as path:
            np.savez_compressed(path, joint_names=self.joint_names, joints=self.joints, dofs=self.dofs)


def write_scan(path: Path, frame: d.AnimationFrame, surfaces: Surfaces, noise: float, random: np.random.Generator) -> None:
    """The first frame's visible surface, each face in four, moved along the normals."""
    vertices, faces = (frame.high if surfaces.has_high else frame.surface), surfaces.scan_faces
    edges, middle = np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0, return_inverse=True)
    ab, bc, ca = (middle.reshape(-1, 3) + len(vertices)).T
    a, b, c = faces.T
    fine = np.concatenate([np.stack(corners, axis=1) for corners in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    points = np.vstack([vertices, vertices[edges].mean(axis=1)])
    points = points + noise * random.standard_normal((len(points), 1)) * d.vertex_normals(points, fine.astype(np.int32))
    used, fine = drop_unused(points, fine)
    d.write_mesh(path, d.Mesh(points[used], fine))


def write_marks(path: Path, character: d.Character, frame: d.AnimationFrame, noise: float, random: np.random.Generator) -> None:
    """joints.json: the joints where they are in the first frame, with the noise of a hand that marks them; landmarks of the
    body, if it is of the model that ships."""
    skeleton = character.actor.skeleton
    names, parents = skeleton.joint_names, skeleton.joint_parents
    dof = {name: sum(n.startswith(name + ".") for n in skeleton.dof_names) for name in names}
    marks = frame.joints + noise / np.sqrt(3) * random.standard_normal(frame.joints.shape)
    joints = {
        name: {
            "position": [round(float(x), 5) for x in marks[j]],
            "parent": names[parents[j]] if parents[j] >= 0 else None,
            "dof": dof[name],
        }
        for j, name in enumerate(names)
    }
    landmarks = {}
    model = d.BodyModel.read(body_model_path())
    if len(frame.body) == model.vertex_count and len(frame.body):
        wanted = ("head_top", "nose_tip", "middle_fingertip", "thumb_tip", "big_toe_tip", "heel")
        for name, vertex in model.landmarks.items():
            if name.removeprefix("l_").removeprefix("r_") in wanted:
                landmarks[name] = [round(float(x), 5) for x in frame.body[vertex]]
    write_json(path, {"joints": joints, "landmarks": landmarks})


def photograph(renderer, frame, camera, options: SynthesisOptions, render: d.RenderOptions, seed) -> np.ndarray:
    """(H, W, 3) uint8 BGR: the picture, out of focus and with noise as asked for."""
    picture = renderer.render(frame.surface, frame.high, frame.body, camera, render)
    if options.blur:
        picture = np.asarray(Image.fromarray(picture).filter(ImageFilter.GaussianBlur(options.blur)))
    if options.noise:
        noise = np.random.default_rng(seed).standard_normal(picture.shape, np.float32)
        picture = np.clip(picture + options.noise * noise + 0.5, 0, 255).astype(np.uint8)
    return picture


def synthesize(
    character: d.Character,
    motion: d.Motion,
    out: Path,
    options: SynthesisOptions | None = None,
    rig: list[d.Camera] | None = None,
    console: Console | None = None,
) -> int:
    """Writes the session and its truth to the folder `out`; returns the number of frames, which are at the character's own rate.
    `rig`: cameras with names, or None for a ring of them. The motion's first frame is the scan pose. Raises ValueError for
    options out of range or cameras whose names no calibration can hold, FileExistsError if `out` holds a session already."""
    options, console, out = options or SynthesisOptions(), console or Console(), Path(out)
    options.validate()
    if (out / "session.json").exists():
        raise FileExistsError(f"{out / 'session.json'} exists; give another folder, or delete it")
    motion = at_own_rate(motion, character)
    if options.frame_count > len(motion):
        raise ValueError(f"frame_count is {options.frame_count}, the motion has {len(motion)} frames")
    if options.frame_count > 0:
        motion = d.Motion(motion.fps, motion.dofs[: options.frame_count])
    rig = rig or ring_of_cameras(character, motion, options.camera_count, options.image_size)
    d.write_calibration(out / "calibration.yml", rig)  # first: not every name of a camera can be written
    surfaces, renderer = Surfaces(character), d.CharacterRenderer(character)
    truth = TruthWriter(out / "ground_truth", surfaces, character.actor.skeleton.joint_names)
    # Little key light: the shadows that a texture baked from video keeps are of the studio's light.
    render = d.RenderOptions(background=options.key_colour, floor=False, light=0.35)
    random = np.random.default_rng(options.seed)
    count = 0
    with ExitStack() as stack:
        pool = stack.enter_context(ThreadPoolExecutor(console.context().threads or None))
        videos = [stack.enter_context(VideoWriter(out / "videos" / f"{c.name}.mp4", c.width, c.height, motion.fps)) for c in rig]

        def film(frame: d.AnimationFrame) -> None:
            nonlocal count
            body, cloth = surfaces.split(frame)
            truth.add(frame, body, cloth)
            if frame.index == 0:
                write_scan(out / "scan.ply", frame, surfaces, options.scan_noise, random)
                write_marks(out / "joints.json", character, frame, options.mark_noise, random)
            seeds = [(options.seed, frame.index, c) for c in range(len(rig))]
            pictures = pool.map(lambda c, seed: photograph(renderer, frame, c, options, render, seed), rig, seeds)
            for video, picture in zip(videos, pictures):
                video.write(picture)
            if frame.index % options.mask_step == 0:
                for camera, mask in zip(rig, pool.map(lambda c: surfaces.mask(body, cloth, c), rig)):
                    with written_atomically(out / "ground_truth" / "masks" / f"{camera.name}_{frame.index:04d}.png") as path:
                        Image.fromarray(mask).save(path)
            count += 1

        as_fitted = d.AnimateOptions(high=surfaces.has_high, edge_collision=False)  # the truth of an estimation
        d.animate_each(character, motion, film, as_fitted, console.context())
    truth.finish()
    materials = [m.to_dict() for m in character.materials]
    write_json(out / "ground_truth" / "material.json", {"regions": materials, "dt": character.solver.dt})
    session = {
        "name": character.name,
        "fps": motion.fps,
        "frame_count": count,
        "cameras": [{"name": c.name, "video": f"videos/{c.name}.mp4"} for c in rig],
        "calibration": "calibration.yml",
        "scan": "scan.ply",
        "markers": "joints.json",
        "background": "key colour",
    }
    write_json(out / "session.json", session)  # last: a folder with it is complete
    return count
