"""One small calibration in every format that is read, of the same two cameras: {format: (INPUT, every file of it)}."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np

K = np.array([[1681.2, 0, 532.97], [0, 1680.9, 948.14], [0, 0, 1]])
SIZE = 1088, 1920
TERMS = [-0.046, 0.039, 6e-4, -7e-4]
Z_UP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # z-up from y-up


def poses() -> dict:
    """Name -> (R, t), two upright cameras 4 m from each other, +Y up, metres."""
    found = {}
    for name, x in (("cam0", -2.0), ("cam1", 2.0)):
        centre = np.array([x, 1.4, 3.0])
        forward = (np.array([0, 1, 0]) - centre) / np.linalg.norm(np.array([0, 1, 0]) - centre)
        right = np.cross(forward, [0, 1, 0]) / np.linalg.norm(np.cross(forward, [0, 1, 0]))
        R = np.array([right, np.cross(forward, right), forward])
        found[name] = R, -R @ centre
    return found


def quaternion(R) -> np.ndarray:
    w = np.sqrt(1 + np.trace(R)) / 2
    return np.array([w, *(np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / (4 * w))])


def rows(values) -> str:
    return ", ".join(repr(float(v)) for v in np.ravel(values))


def yaml(key: str, values) -> str:
    values = np.atleast_2d(values)
    return (
        f"{key}: !!opencv-matrix\n   rows: {values.shape[0]}\n   cols: {values.shape[1]}\n   dt: d\n   data: [ {rows(values)} ]\n"
    )


def write_opencv(folder: Path) -> None:
    for name, (R, t) in poses().items():
        size = f"image_width: {SIZE[0]}\nimage_height: {SIZE[1]}\n"
        matrices = {"camera_matrix": K, "distortion_coefficients": TERMS, "R": R, "T": t[:, None]}
        (folder / f"{name}.yml").write_text("%YAML:1.0\n---\n" + size + "".join(yaml(*item) for item in matrices.items()))


def write_easymocap(folder: Path) -> None:
    head = "%YAML:1.0\n---\nnames:\n" + "".join(f'   - "{name}"\n' for name in poses())
    intri = "".join(yaml(f"K_{n}", K) + yaml(f"dist_{n}", TERMS) + f"W_{n}: {SIZE[0]}\nH_{n}: {SIZE[1]}\n" for n in poses())
    extri = "".join(yaml(f"Rot_{n}", R @ Z_UP.T) + yaml(f"T_{n}", t[:, None]) for n, (R, t) in poses().items())
    (folder / "intri.yml").write_text(head + intri)
    (folder / "extri.yml").write_text(head + extri)


def colmap_parameters() -> list:
    return [K[0, 0], K[1, 1], K[0, 2] + 0.5, K[1, 2] + 0.5, *TERMS]


def write_colmap_text(folder: Path) -> None:
    camera = f"1 OPENCV {SIZE[0]} {SIZE[1]} {' '.join(map(repr, map(float, colmap_parameters())))}\n"
    (folder / "cameras.txt").write_text(camera)
    lines = [
        f"{i} {' '.join(repr(float(v)) for v in (*quaternion(R), *t))} 1 {name}.png\n\n"
        for i, (name, (R, t)) in enumerate(poses().items())
    ]
    (folder / "images.txt").write_text("# images\n" + "".join(lines))


def write_colmap_binary(folder: Path) -> None:
    camera = struct.pack("<QIiQQ8d", 1, 1, 4, *SIZE, *colmap_parameters())
    (folder / "cameras.bin").write_bytes(camera)
    images = struct.pack("<Q", len(poses()))
    for i, (name, (R, t)) in enumerate(poses().items()):
        images += struct.pack("<I7dI", i, *quaternion(R), *t, 1) + f"{name}.png".encode() + b"\0"
        images += struct.pack("<Q2dQ", 1, 3.5, 4.5, 9)
    (folder / "images.bin").write_bytes(images)


def write_toml(folder: Path) -> None:
    text = ""
    for name, (R, t) in poses().items():
        text += f'[{name}]\nname = "{name}"\nsize = [{SIZE[0]}.0, {SIZE[1]}.0]\n'
        text += f"matrix = [{', '.join(f'[{rows(row)}]' for row in K)}]\ndistortions = [{rows(TERMS)}]\n"
        text += f"rotation = [{', '.join(f'[{rows(row)}]' for row in R @ Z_UP.T)}]\ntranslation = [{rows(t)}]\n\n"
    (folder / "Calib.toml").write_text(text + "[metadata]\nerror = 0.0\n")


def write_qualisys(folder: Path) -> None:
    text = "<?xml version='1.0' encoding='ASCII'?>\n<calibration><cameras>\n"
    for name, (R, t) in poses().items():
        R = R @ Z_UP.T
        axes, centre = np.diag([1, -1, -1]) @ R, -1000 * R.T @ t
        transform = {f"r{r + 1}{c + 1}": axes[r, c] for r in range(3) for c in range(3)} | dict(zip("xyz", centre))
        intrinsic = {"focalLengthU": 64 * K[0, 0], "focalLengthV": 64 * K[1, 1], "skew": 0}
        intrinsic |= {"centerPointU": 64 * K[0, 2], "centerPointV": 64 * K[1, 2], "radialDistortion3": 0}
        intrinsic |= {f"radialDistortion{i + 1}": TERMS[i] for i in range(2)}
        intrinsic |= {f"tangentalDistortion{i + 1}": TERMS[2 + i] for i in range(2)}
        text += f'<camera active="1" serial="{name}">'
        text += f'<fov_video left="0" top="0" right="{SIZE[0] - 1}" bottom="{SIZE[1] - 1}"/>'
        for tag, values in (("transform", transform), ("intrinsic", intrinsic)):
            text += f"<{tag} " + " ".join(f'{key}="{round(float(value), 9) + 0.0!r}"' for key, value in values.items()) + "/>"
        text += "</camera>\n"
    (folder / "session.qca.txt").write_text(text + "</cameras></calibration>\n")


def write_anipose(folder: Path) -> None:
    cameras = [
        {
            "name": name,
            "size": SIZE,
            "matrix": K.tolist(),
            "distortions": TERMS,
            "rotation": R.tolist(),
            "translation": t.tolist(),
        }
        for name, (R, t) in poses().items()
    ]
    (folder / "setting.json").write_text(json.dumps(cameras))


def write_panoptic(folder: Path) -> None:
    """Centimetres, -Y up, and a camera of another kind."""
    cameras = [{"name": "vga", "type": "vga"}]
    for name, (R, t) in poses().items():
        camera = {"name": name, "type": "hd", "resolution": SIZE, "K": K.tolist(), "distCoef": [*TERMS, 0]}
        cameras.append(camera | {"R": (R * [1, -1, -1]).tolist(), "t": (100 * t[:, None]).tolist()})
    (folder / "calibration_studio.json").write_text(json.dumps({"calibDataSource": "studio", "cameras": cameras}))


def write_metashape(folder: Path) -> None:
    """In a chunk of half the size, turned and moved; a camera that was not aligned."""
    turn, move, scale = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]), np.array([0.3, -2, 1]), 2.0
    terms = {"k1": TERMS[0], "k2": TERMS[1], "p1": TERMS[3], "p2": TERMS[2], "b1": K[0, 0] - K[1, 1], "f": K[1, 1]}
    terms |= {"cx": K[0, 2] + 0.5 - SIZE[0] / 2, "cy": K[1, 2] + 0.5 - SIZE[1] / 2}
    size = f'<resolution width="{SIZE[0]}" height="{SIZE[1]}"/>'
    lens = "".join(f"<{key}>{float(value)!r}</{key}>" for key, value in terms.items())
    text = f'<sensors><sensor id="0" type="frame">{size}<calibration type="frame" class="adjusted">{size}{lens}'
    text += "</calibration></sensor></sensors><cameras>"
    for i, (name, (R, t)) in enumerate(poses().items()):
        R = R @ Z_UP.T
        place = np.eye(4)
        place[:3, :3], place[:3, 3] = turn.T @ R.T, turn.T @ (-R.T @ t - move) / scale
        numbers = " ".join(repr(float(v)) for v in place.ravel())
        text += f'<camera id="{i}" sensor_id="0" label="{name}.jpg"><transform>{numbers}</transform></camera>'
    text += '<camera id="7" sensor_id="0" label="lost"/></cameras>'
    text += (
        f"<transform><rotation>{rows(turn).replace(',', '')}</rotation><translation>{rows(move).replace(',', '')}</translation>"
    )
    text += f"<scale>{scale}</scale></transform>"
    (folder / "cameras.xml").write_text(f'<?xml version="1.0"?><document version="2.0.0"><chunk>{text}</chunk></document>')


def write_nerfstudio(folder: Path) -> None:
    """A focal length, and what is alike, ahead of the frames; cameras that look along -Z."""
    head = dict(zip(("fl_x", "fl_y", "cx", "cy"), (K[0, 0], K[1, 1], K[0, 2] + 0.5, K[1, 2] + 0.5)))
    head |= {"camera_model": "OPENCV", "w": SIZE[0], **dict(zip(("k1", "k2", "p1", "p2"), TERMS))}
    frames = []
    for name, (R, t) in poses().items():
        R, pose = R @ Z_UP.T, np.eye(4)
        pose[:3, :3], pose[:3, 3] = R.T @ np.diag([1, -1, -1]), -R.T @ t
        frames.append({"file_path": f"./images/{name}/0001.png", "h": SIZE[1], "transform_matrix": pose.tolist()})
    (folder / "transforms.json").write_text(json.dumps({**head, "frames": frames}))


def write_actorshq(folder: Path) -> None:
    text = "name, w, h, rx, ry, rz, tx, ty, tz, fx, fy, px, py, k1, k2\n"
    for name, (R, t) in poses().items():
        q = quaternion(R.T)
        vector = 2 * np.arccos(q[0]) * q[1:] / np.linalg.norm(q[1:])
        lens = [K[0, 0] / SIZE[0], K[1, 1] / SIZE[1], (K[0, 2] + 0.5) / SIZE[0], (K[1, 2] + 0.5) / SIZE[1], *TERMS[:2]]
        text += f"{name}, {SIZE[0]}, {SIZE[1]}, {rows([*vector, *(-R.T @ t), *lens])}\n"
    (folder / "calibration.csv").write_text(text)


WRITERS = {
    "opencv": (write_opencv, "", ["cam0.yml", "cam1.yml"]),
    "easymocap": (write_easymocap, "", ["intri.yml", "extri.yml"]),
    "colmap_text": (write_colmap_text, "", ["cameras.txt", "images.txt"]),
    "colmap_binary": (write_colmap_binary, "", ["cameras.bin", "images.bin"]),
    "toml": (write_toml, "Calib.toml", ["Calib.toml"]),
    "qualisys": (write_qualisys, "session.qca.txt", ["session.qca.txt"]),
    "anipose": (write_anipose, "setting.json", ["setting.json"]),
    "panoptic": (write_panoptic, "calibration_studio.json", ["calibration_studio.json"]),
    "metashape": (write_metashape, "cameras.xml", ["cameras.xml"]),
    "nerfstudio": (write_nerfstudio, "transforms.json", ["transforms.json"]),
    "actorshq": (write_actorshq, "calibration.csv", ["calibration.csv"]),
}
TERMS_OF = {"actorshq": [*TERMS[:2], 0, 0]}  #: of formats that cannot have TERMS


def write_all(folder: Path) -> dict[str, tuple[Path, list[Path]]]:
    written = {}
    for name, (write, read, files) in WRITERS.items():
        (folder / name).mkdir(parents=True)
        write(folder / name)
        written[name] = folder / name / read, [folder / name / file for file in files]
    return written
