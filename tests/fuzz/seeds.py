"""Small valid files of every format, made by the library's own writers where it has one, and how each is read."""

from __future__ import annotations

import json
import struct
from functools import partial
from pathlib import Path

import doublet as d
import numpy as np
from calibrations import write_all
from doublet.common.images import read_image
from doublet.evaluation.metrics import Truth
from doublet.export import bone_map
from doublet.export.clips import read_clip, read_motion
from doublet.reconstruct import config
from doublet.session import keypoints
from PIL import Image

FPS = 40.0

BVH = """HIERARCHY
ROOT pelvis
{
  OFFSET 0 1 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT spine
  {
    OFFSET 0 0.2 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 0.3 0
    }
  }
}
MOTION
Frames: 3
Frame Time: 0.025
0 1 0 0 0 0 0 0 0
0.1 1 0 5 0 0 0 4 0
0.2 1 0 9 0 0 0 8 0
"""

ASF = """:version 1.10
:name person
:units
  mass 1.0
  length 0.45
  angle deg
:documentation
  two bones
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 0
:bonedata
  begin
    id 1
    name lowerback
    direction 0 1 0
    length 2.0
    axis 0 0 0 XYZ
    dof rx ry rz
    limits (-20.0 45.0)
           (-30.0 30.0)
           (-30.0 30.0)
  end
  begin
    id 2
    name thorax
    direction 0 1 0
    length 1.5
    axis 0 0 0 XYZ
    dof rx
    limits (-20.0 45.0)
  end
:hierarchy
  begin
    root lowerback
    lowerback thorax
  end
"""

AMC = """#!comment
:FULLY-SPECIFIED
:DEGREES
1
root 0 17 0 0 10 0
lowerback 1 2 3
thorax 4
2
root 0.1 17 0 0 12 0
lowerback 1 2 4
thorax 5
"""

PLY = """ply
format ascii 1.0
comment a quad and a triangle
element vertex 5
property float x
property float y
property float z
property uchar red
element face 2
property list uchar int vertex_indices
end_header
0 0 0 1
1 0 0 2
1 1 0 3
0 1 0 4
0.5 0.5 1 5
4 0 1 2 3
3 0 1 4
"""


def tube(radius: float, low: float, high: float, around: int = 8, rows: int = 5):
    """Open tube about +Y: vertices (V, 3) m, faces (F, 3)."""
    turn = np.linspace(0, 2 * np.pi, around, endpoint=False)
    ring = np.stack([radius * np.sin(turn), np.zeros(around), radius * np.cos(turn)], axis=1)
    vertices = np.concatenate([ring + [0, h, 0] for h in np.linspace(low, high, rows)])
    here = (np.arange(rows - 1)[:, None] * around + np.arange(around)).ravel()
    ahead = (np.arange(rows - 1)[:, None] * around + (np.arange(around) + 1) % around).ravel()
    faces = np.vstack([np.stack([here, ahead, ahead + around], 1), np.stack([here, ahead + around, here + around], 1)])
    return vertices, faces.astype(np.int32)


class World:
    """One small person in a skirt: a value of every kind that stages hand to each other."""

    def __init__(self):
        vertices, faces = tube(0.2, 0.5, 1.5)
        self.mesh = d.Mesh(vertices, faces)
        self.marks = [d.JointAnnotation("pelvis", "", [0, 1, 0], 6), d.JointAnnotation("spine", "pelvis", [0, 1.2, 0], 3)]
        self.skeleton = d.Skeleton(self.marks)
        upper = np.clip((vertices[:, 1] - 0.9) / 0.4, 0, 1)
        self.weights = np.stack([1 - upper, upper], axis=1)
        self.actor = d.RiggedMesh(self.mesh, [1] * len(faces), self.weights, self.skeleton)
        self.cloth = (vertices[:, 1] < 1).astype(float)
        region = np.where(self.cloth > 0, 0, -1).astype(np.int32)
        self.segmentation = d.Segmentation(np.full(len(vertices), 0.01), self.cloth, region)
        self.body = d.BodyFit()
        self.body.body = d.Mesh(*tube(0.18, 0.5, 1.5, 6, 4))
        self.body.coefficients = np.array([0.5, -0.5])
        self.body.model = "tube"
        self.proxies = [d.TaperedCapsule(0, [0, -0.4, 0], [0, 0.1, 0], 0.1, 0.12)]
        self.dofs = np.zeros((3, 9))
        self.dofs[:, 0] = [0, 0.05, 0.1]
        self.motion = d.Motion(FPS, self.dofs)
        self.performance = d.ReferencePerformance()
        self.performance.surface = d.MeshSequence(faces, np.stack([vertices + [x, 0, 0] for x in self.dofs[:, 0]]))
        self.performance.dofs = self.dofs
        self.performance.joints = np.stack([self.skeleton.joint_positions(dofs) for dofs in self.dofs])
        self.performance.frames = [0, 1, 2]
        self.cameras = [d.orbit_camera([0, 1, 0], 0.9, a, 0.1, 48, 48) for a in (0.0, 2.0)]
        for c, camera in enumerate(self.cameras):
            camera.name = f"cam{c}"
        self.observations = d.Observations()
        self.observations.cameras = self.cameras
        self.observations.frames = [0, 1, 2]
        contour, matches = np.array([[10, 10], [11, 12]], np.float32), np.array([[10, 10, 11, 11]], np.float32)
        self.observations.views = [[d.ViewObservation(contour, matches) for _ in self.cameras] for _ in range(3)]
        self.simulator = d.CharacterSimulator(self.actor, self.segmentation, self.proxies)
        self.material = d.Material(k_stretch=1.0)
        self.high = d.Mesh(*tube(0.2, 0.5, 1.5, 12, 7))
        self.character = d.make_character(
            self.actor, self.segmentation, self.body, self.proxies, [self.material], d.SolverSettings(1 / FPS), self.high
        )
        self.picture = np.random.default_rng(1).integers(0, 255, (48, 48, 3), np.uint8)
        self.mask = np.full((48, 48), 255, np.uint8)
        texture = d.TextureOptions(size=64)
        d.texture_character(self.character, vertices, self.cameras, [self.picture] * 2, [self.mask] * 2, texture)
        self.garment = d.mesh_garment(
            self.actor, self.segmentation, d.Mesh(), d.MeshSequence(), d.GarmentOptions(vertices=60, remesh=False)
        )


class Bowl(d.Objective):
    def parameter_count(self):
        return 2

    def evaluate(self, samples, context):
        return np.square(samples - 0.7).sum(axis=1, keepdims=True)


def search(path: Path) -> None:
    options = d.MinimiseOptions(checkpoint=path, problem="bowl")
    options.make_optimizer = lambda n, seed: d.create_cma_es(n, d.CmaEsOptions(max_evaluations=24, seed=seed))
    d.minimise(Bowl(), options)


def write_session(folder: Path, world: World) -> None:
    """Two cameras with masks, three frames."""
    (folder / "masks").mkdir(parents=True)
    for camera in world.cameras:
        for frame in range(3):
            Image.fromarray(world.mask).save(folder / "masks" / f"{camera.name}_{frame:04d}.png")
    d.write_mesh(folder / "scan.ply", world.mesh)
    d.write_calibration(folder / "calibration.yml", world.cameras)
    joints = {
        mark.name: {"position": list(mark.position), "parent": mark.parent or None, "dof": mark.dof} for mark in world.marks
    }
    (folder / "joints.json").write_text(json.dumps({"joints": joints, "landmarks": {"navel": [0, 1.1, 0.2]}}, indent=1))
    session = {
        "name": "small",
        "fps": 40,
        "frame_count": 3,
        "cameras": [{"name": c.name, "masks": f"masks/{c.name}_%04d.png"} for c in world.cameras],
        "calibration": "calibration.yml",
        "scan": "scan.ply",
        "markers": "joints.json",
    }
    (folder / "session.json").write_text(json.dumps(session, indent=1))


def smpl_arrays() -> dict:
    """A model of the SMPL family: a standing figure of eight vertices, three joints."""
    rng = np.random.default_rng(2)
    v_template = np.array([[x, y, z] for y in (0.0, 1.6) for x in (-0.2, 0.2) for z in (-0.1, 0.1)])
    regressor = np.zeros((3, 8))
    regressor[0, :4], regressor[1, 4:], regressor[2, 6:] = 0.25, 0.25, 0.5
    return {
        "v_template": v_template,
        "f": np.array([[0, 1, 2], [1, 3, 2], [4, 6, 5], [5, 6, 7]]),
        "shapedirs": 0.01 * rng.normal(size=(8, 3, 2)),
        "J_regressor": regressor,
        "weights": np.full((8, 3), 1 / 3),
        "kintree_table": np.array([[-1, 0, 1], [0, 1, 2]]),
        "joint_names": np.array(["pelvis", "neck", "head"]),
    }


def region_json() -> dict:
    parameters = d.Material().to_dict()
    return {"parameters": parameters, "energy": 3.5, "energy_at_centre": 5.0, "evaluations": 8, "stop_reason": "8 evaluations"}


def write_fit(folder: Path) -> None:
    folder.mkdir()
    fitted = {"estimated": ["d_n"], "seed": 1, "seconds": 2.0, "interrupted": False, "regions": [region_json()]}
    (folder / "material.json").write_text(json.dumps(fitted, indent=1))
    (folder / "fit_log.csv").write_text(
        "region,generation,evaluations,best,generation_best,mean_d_n,deviation_d_n,seconds\n"
        "0,1,8,3.7,3.7,4.1,0.2,0.5\n0,2,16,3.5,3.6,4.0,0.1,1.0\n"
    )


def make_seeds(folder: Path) -> tuple[dict, World]:
    """Name of the format -> (files to mutate, function that reads). A reader's argument is the mutated file, in its own place."""
    world = World()
    formats: dict[str, tuple[list[Path], object]] = {}
    folder.mkdir(parents=True, exist_ok=True)

    meshes = folder / "meshes"
    for extension in ("ply", "obj", "stl", "off"):
        d.write_mesh(meshes / f"mesh.{extension}", world.mesh)
        formats[extension] = ([meshes / f"mesh.{extension}"], d.read_mesh)
    write_glb(meshes / "mesh.glb", world.mesh)
    formats["scan"] = ([meshes / "mesh.glb"], d.read_mesh)
    (meshes / "text.ply").write_text(PLY)
    formats["ply"][0].append(meshes / "text.ply")

    arrays = folder / "arrays"
    d.write_actor(arrays / "actor.npz", world.actor)
    d.write_performance(arrays / "performance.npz", world.performance)
    d.write_segmentation(arrays / "segmentation.npz", world.segmentation)
    d.write_garment(arrays / "garment.npz", world.garment)
    d.write_body(arrays / "body.npz", world.body)
    d.write_observations(arrays / "observations.npz", world.observations)
    surface = np.array(world.mesh.vertices)
    d.write_simulated(arrays / "simulated.npz", np.stack([surface, surface]), len(surface) - 3)
    np.savez(arrays / "model.npz", **smpl_arrays())
    readers = {
        "actor.npz": d.read_actor,
        "performance.npz": partial(lambda actor, path: d.read_performance(path, actor), world.actor),
        "segmentation.npz": d.read_segmentation,
        "garment.npz": partial(lambda actor, path: d.read_garment(path, actor), world.actor),
        "body.npz": d.read_body,
        "observations.npz": d.read_observations,
        "simulated.npz": d.read_simulated,
        "model.npz": d.BodyModel.read,
    }
    formats["npz"] = ([arrays / name for name in readers], lambda path: readers[path.name](path))

    texts = folder / "texts"
    d.write_proxies(texts / "proxies.json", world.proxies, world.skeleton)
    formats["proxies"] = ([texts / "proxies.json"], lambda path: d.read_proxies(path, world.skeleton))
    write_fit(folder / "fitted")
    formats["material"] = ([folder / "fitted" / "material.json"], d.read_materials)
    (texts / "run.json").write_text(json.dumps({"session": "session", "stages": {}}))
    formats["run"] = ([texts / "run.json"], lambda path: d.RunRecord(path.parent))
    search(texts / "fit_checkpoint.txt")
    formats["checkpoint"] = ([texts / "fit_checkpoint.txt"], search)

    motions = folder / "motions"
    motions.mkdir()
    for name, text in (("walk.bvh", BVH), ("person.asf", ASF), ("person_01.amc", AMC)):
        (motions / name).write_text(text)
    formats["bvh"] = ([motions / "walk.bvh"], d.SourceMotion.read)
    formats["amc"] = ([motions / "person_01.amc", motions / "person.asf"], lambda path: read_acclaim(path.parent))

    for name, kind in (("fbx", "blender_binary"), ("fbx_text", "text")):
        clip = motions / f"{name}.fbx"
        clip.write_bytes((Path(__file__).parent / "corpus/fbx_motion" / kind).read_bytes())
        formats[name] = ([clip], d.SourceMotion.read)

    d.write_baked_glb(motions / "clip.glb", world.character, d.animate(world.character, world.motion))
    formats["clip"] = ([motions / "clip.glb"], d.SourceMotion.read)

    world.character.write(folder / "characters" / "character.glb")
    formats["glb"] = ([folder / "characters" / "character.glb"], d.Character.read)

    write_session(folder / "session", world)
    for name in ("session.json", "joints.json", "calibration.yml"):
        formats[name.partition(".")[0]] = ([folder / "session" / name], lambda path: d.Session(path.parent))
    lens = d.Lens()
    lens.fisheye, lens.distortion = True, [0.02, -0.01, 3e-3, -4e-4]
    d.write_calibration(texts / "lenses.yml", [d.CalibratedCamera(camera, lens) for camera in world.cameras])
    formats["lenses"] = ([texts / "lenses.yml"], d.read_calibration)
    for name, (_, files) in write_all(folder / "calibrations").items():
        kind = d.CalibrationOptions(format=name.partition("_")[0])
        formats[name] = (files, partial(lambda kind, path: d.read_calibration(path, kind), kind))
    return {**formats, **read_in_python(folder / "in_python", world), **pictures(folder / "pictures", world)}, world


def write_glb(path: Path, mesh: d.Mesh) -> None:
    """A scan: one mesh below a node that is turned."""
    points, indices = np.asarray(mesh.vertices, "<f4").tobytes(), np.asarray(mesh.faces, "<u4").tobytes()
    views = [{"buffer": 0, "byteOffset": 0, "byteLength": len(points)}]
    views.append({"buffer": 0, "byteOffset": len(points), "byteLength": len(indices)})
    accessors = [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": len(mesh.vertices)}]
    accessors.append({"bufferView": 1, "componentType": 5125, "type": "SCALAR", "count": mesh.faces.size})
    gltf = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "bufferViews": views, "accessors": accessors}
    gltf["nodes"] = [{"children": [1], "rotation": [0, 1, 0, 0]}, {"mesh": 0, "scale": [2, 2, 2]}]
    gltf["meshes"] = [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]
    gltf["buffers"] = [{"byteLength": len(points) + len(indices)}]
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(points) + len(indices), 0x004E4942) + points + indices
    path.write_bytes(b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks)


def read_in_python(folder: Path, world: World) -> dict:
    """What no C++ reads; as `make_seeds`."""
    folder.mkdir()
    count, faces = len(world.mesh.vertices), len(world.mesh.faces)
    d.write_mesh(folder / "template.ply", world.mesh)
    d.write_segmentation_paint(folder, np.resize([-1, 0, 1, 2], count), count)
    np.savez(folder / "template_suggestion.npz", face_valid=np.ones(faces, bool))
    d.write_template_mask(folder, np.arange(faces) > 3)
    (folder / "keypoints.json").write_text(json.dumps(np.ones((2, 17, 3)).tolist()))
    (folder / "options.toml").write_text("seed = 2\n[segment]\ndiffusion = 0.05\n[space.fixed]\nd_n = 9\n")
    (folder / "walk.bvh").write_text(BVH)
    clip = d.SourceMotion.read(folder / "walk.bvh")
    bone_map.write(folder / "map.toml", clip, {})
    np.savez(folder / "dofs.npz", dofs=world.dofs)
    turns = np.zeros((3, 66)) + 0.01
    np.savez_compressed(folder / "amass.npz", poses=turns, trans=np.zeros((3, 3)), mocap_framerate=np.array(40.0))
    np.savez_compressed(folder / "matrices.npz", poses=np.tile(np.eye(3), (3, 24, 1, 1)), trans=np.zeros((3, 3)), fps=30)
    poses = {
        "dofs.npz": lambda path: read_motion(path, world.character, d.RetargetOptions()),
        "amass.npz": read_clip,
        "matrices.npz": read_clip,
    }
    masks = [folder / "template_mask.npz", folder / "template_suggestion.npz"]
    return {
        "paint": ([folder / "segmentation_paint.npz"], lambda path: d.read_segmentation_paint(path.parent, count)),
        "mask": (masks, lambda path: d.read_template_mask(path.parent)),
        "keypoints": ([folder / "keypoints.json"], lambda path: keypoints.CameraKeypoints(path, (64, 48)).of(1)),
        "options": ([folder / "options.toml"], config.read),
        "bone_map": ([folder / "map.toml"], lambda path: bone_map.read(path, clip)),
        "poses": ([folder / name for name in poses], lambda path: poses[path.name](path)),
        "truth": (write_truth(folder / "truth", world), lambda path: read_truth(path.parent)),
    }


def write_truth(folder: Path, world: World) -> list[Path]:
    folder.mkdir()
    vertices, faces = np.array(world.mesh.vertices), world.mesh.faces
    files = [folder / name for name in ("static.npz", "frames_0000.npz", "skeleton.npz")]
    np.savez(files[0], body_tris=faces, cloth_tris=faces)
    np.savez_compressed(files[1], start=0, body=[vertices] * 2, cloth=[vertices] * 2)
    np.savez(files[2], joint_names=["pelvis", "spine"], joints=np.zeros((2, 2, 3)))
    return files


def read_truth(folder: Path) -> None:
    truth = Truth(folder)
    for frame in truth.chunks:
        vertices, faces, _ = truth.surface(frame)
        d.vertex_normals(vertices, faces)
    truth.pelvis()


def pictures(folder: Path, world: World) -> dict:
    """Read by Python, and as the frames of a session; as `make_seeds`."""
    write_session(folder / "session", world)
    folder.joinpath("plain").mkdir()
    files = [folder / "plain" / f"picture.{extension}" for extension in ("png", "jpg")]
    for file in files:
        Image.fromarray(world.picture).save(file)
    session = folder / "session"
    return {
        "picture": (files, read_image),
        "frame": ([session / "masks" / "cam0_0001.png"], lambda _: d.FrameSource.open(d.Session(session)).mask(0, 1)),
    }


def read_acclaim(folder: Path) -> d.SourceMotion:
    return d.SourceMotion.read(folder / "person_01.amc")
