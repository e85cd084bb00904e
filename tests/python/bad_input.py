"""Bad inputs, and what is said about each: docs/bad-input.md. `python tests/python/bad_input.py` writes the page again."""

from __future__ import annotations

import contextlib
import copy
import io
import json
import os
import resource
import shutil
import signal
import struct
import sys
import tempfile
import zipfile
from functools import partial
from pathlib import Path
from typing import Callable, NamedTuple

import doublet as d
import numpy as np
from doublet.cli import program as cli
from doublet.common.console import Console
from doublet.common.files import write_json
from doublet.common.video import VideoWriter
from PIL import Image

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "bad-input.md"
sys.path.append(str(ROOT / "tests" / "fuzz"))
from calibrations import write_all  # noqa: E402
from children import outcomes  # noqa: E402
from seeds import AMC, ASF, BVH, PLY, World, write_session, write_truth  # noqa: E402

HEAD = """# What is said about bad input

A command that cannot go on says why in one sentence on stderr, and ends with status 1 (2 if it was not understood, 128 + the
number of a signal that stopped it); in Python the same sentence is the text of a `RuntimeError` (`doublet.Error`), `ValueError`
or `FileNotFoundError`. Nothing is left half written. `tests/python/test_bad_input.py` runs every row of this table;
`python tests/python/bad_input.py` writes it.

What stops `doublet reconstruct` while a stage runs leaves the stages before it, and where capture and search stood; the same
command goes on from there, to the same bits in every file. `python tests/slow/every_stage.py` tries all of it at each of the
ten stages ([how](fuzzing.md#stopped-at-every-stage)):

| what happens meanwhile | sentence | status |
| --- | --- | --- |
| Ctrl-C, SIGTERM | doublet: stopped; what is complete stays, the same command goes on from there | 130, 143 |
| SIGKILL, power cut | none | 137 |
| the disk is full | doublet: out/segmentation.npz: cannot be written: No space left on device | 1 |
| the disk is read-only | doublet: out/fit_checkpoint.txt: cannot be written: Read-only file system | 1 |
| no memory is left (`ulimit -v`) | doublet: expected more memory than this process may have; \
what is complete stays, the same command goes on from there | 1 |

| input | command | sentence | status |
| --- | --- | --- | --- |
"""


class Case(NamedTuple):
    group: str
    what: str  # in words
    command: str  # arguments of `doublet`, from the folder with session/ and out/
    spoil: Callable[[Path], None]


CASES: list[Case] = []


def spoilt_by(group: str, command: str, **cases):
    """Each function spoils a folder that has session/, footage/, calibrations/, out/, truth/, c.glb, walk.bvh, person.asf and
    person_01.amc."""
    for what, spoil in cases.items():
        CASES.append(Case(group, what.replace("_", " "), command, spoil))


# --- the folder that is spoilt


def make_folder(folder: Path) -> None:
    world = World()
    write_session(folder / "session", world)
    write_footage(folder / "footage", world)
    write_all(folder / "calibrations")
    out = folder / "out"
    d.write_mesh(out / "template.ply", world.mesh)
    d.write_mesh(out / "template_high.ply", world.high)
    valid = np.ones(len(world.mesh.faces), bool)
    np.savez(out / "template_suggestion.npz", face_valid=valid, high_face_valid=np.ones(len(world.high.faces), bool))
    d.write_actor(out / "actor.npz", world.actor)
    d.write_performance(out / "performance.npz", world.performance)
    d.write_observations(out / "observations.npz", world.observations)
    d.write_segmentation(out / "segmentation.npz", world.segmentation)
    d.write_body(out / "body.npz", world.body)
    d.write_proxies(out / "proxies.json", world.proxies, world.skeleton)
    d.write_garment(out / "garment.npz", world.garment)
    write_json(out / "material.json", {"regions": [{"parameters": d.Material().to_dict()}]})
    write_json(out / "run.json", {"session": str(folder / "session"), "stages": {}})
    write_truth(folder / "truth", world)
    (folder / "truth" / "masks").mkdir()
    Image.fromarray(world.mask).save(folder / "truth" / "masks" / "cam0_0000.png")
    world.character.write(folder / "c.glb")
    (folder / "walk.bvh").write_text(BVH)
    (folder / "person.asf").write_text(ASF)
    (folder / "person_01.amc").write_text(AMC)


def write_footage(folder: Path, world: World) -> None:
    """What the session's cameras filmed, before there was a session: videos/ and masks/, four frames."""
    masks = np.zeros((4, 48, 48), np.uint8)
    for frame in range(4):
        masks[frame, 8:40, 18 + frame : 30 + frame] = 255
    for camera in world.cameras:
        with VideoWriter(folder / "videos" / f"{camera.name}.mp4", 48, 48, 40) as video:
            for mask in masks:
                video.write(np.where(mask[..., None] > 0, [60, 70, 200], [40, 180, 30]).astype(np.uint8))
        (folder / "masks" / camera.name).mkdir(parents=True)
        for frame, mask in enumerate(masks):
            Image.fromarray(mask).save(folder / "masks" / camera.name / f"{frame:04d}.png")


def text(path: str, *replacements):
    """Replaces pieces of a text file; each must be there."""

    def spoil(folder: Path) -> None:
        content = (folder / path).read_text()
        for old, new in replacements:
            assert old in content, f"{old!r} is not in {path}"
            content = content.replace(old, new, 1)
        (folder / path).write_text(content)

    return spoil


def content(path: str, value: str | bytes):
    return lambda folder: (folder / path).write_bytes(value.encode() if isinstance(value, str) else value)


def cut(path: str, share: float = 0.5):
    def spoil(folder: Path) -> None:
        whole = (folder / path).read_bytes()
        (folder / path).write_bytes(whole[: int(share * len(whole))])

    return spoil


def gone(path: str):
    def spoil(folder: Path) -> None:
        target = folder / path
        shutil.rmtree(target) if target.is_dir() else target.unlink()

    return spoil


def arrays(path: str, **changes):
    """Changes arrays of an archive: a function of the old one, None to leave it out, or the new one."""

    def spoil(folder: Path) -> None:
        with np.load(folder / path) as file:
            values = dict(file)
        for name, change in changes.items():
            values[name] = change(values[name]) if callable(change) else change
        np.savez(folder / path, **{k: v for k, v in values.items() if v is not None})

    return spoil


def bomb(path: str):
    """An archive of a few kilobytes that unpacks to gigabytes: its members are one and the same."""

    def spoil(folder: Path) -> None:
        with zipfile.ZipFile(folder / path, "w", zipfile.ZIP_DEFLATED) as archive:
            with archive.open("vertices.npy", "w") as member:
                np.save(member, np.zeros(1 << 20))
            (one,) = archive.filelist
            for name in ("faces", "face_valid", "weights", "joint_names", "joint_parents", "joint_positions"):
                archive.filelist.append(copy.copy(one))
                archive.filelist[-1].filename = f"{name}.npy"

    return spoil


def claimed_shape(path: str, name: str, shape: tuple):
    """The header of an array says another shape than there are numbers."""

    def spoil(folder: Path) -> None:
        with np.load(folder / path) as file:
            values = dict(file)
        with zipfile.ZipFile(folder / path, "w") as archive:
            for key, array in values.items():
                with archive.open(f"{key}.npy", "w") as member:
                    header = {"descr": array.dtype.str, "fortran_order": False, "shape": shape if key == name else array.shape}
                    np.lib.format.write_array_header_1_0(member, header)
                    member.write(array.tobytes())

    return spoil


def first(value):
    """An array with another first element."""

    def change(array):
        array = array.copy()
        array.reshape(-1)[0] = value
        return array

    return change


def gltf(change):
    """Changes the JSON of c.glb."""

    def spoil(folder: Path) -> None:
        data = (folder / "c.glb").read_bytes()
        size = struct.unpack("<I", data[12:16])[0]
        document = json.loads(data[20 : 20 + size])
        changed = change(document)
        new = (changed if isinstance(changed, str) else json.dumps(document)).encode()
        new += b" " * (-len(new) % 4)
        rest = struct.pack("<II", len(new), 0x4E4F534A) + new + data[20 + size :]
        (folder / "c.glb").write_bytes(b"glTF" + struct.pack("<II", 2, 12 + len(rest)) + rest)

    return spoil


def extension(document: dict) -> dict:
    return document["extensions"]["DOUBLET_character"]


def view_of_texture(document: dict) -> dict:
    return document["bufferViews"][document["images"][0]["bufferView"]]


def accessor_of_faces(document: dict) -> dict:
    return document["accessors"][extension(document)["mesh"]["faces"]]


def scan(value: str):
    return content("session/scan.ply", value)


def small_disk(folder: Path) -> None:
    """From here on no file may grow beyond 512 bytes, which is to a program what a full disk is."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (512, resource.RLIM_INFINITY))


def while_it_runs(action: Callable[[], None]):
    """Once a stage says that it runs."""

    def spoil(folder: Path) -> None:
        say = Console.say

        def say_and_act(console: Console, line: str) -> None:
            say(console, line)
            if ": running (" in line:
                Console.say = say
                action()

        Console.say = say_and_act

    return spoil


def png(path: str, size: int):
    return lambda folder: Image.new("L", (size, size), 255).save(folder / path)


# --- scans

TEMPLATE = "template session -o new"
spoilt_by(
    "Scan",
    TEMPLATE,
    a_face_of_no_corners=scan(PLY.replace("4 0 1 2 3", "0")),
    a_face_of_two_corners=scan(PLY.replace("4 0 1 2 3", "2 0 1")),
    a_corner_beyond_the_vertices=scan(PLY.replace("3 0 1 4", "3 0 1 5")),
    a_negative_corner=scan(PLY.replace("3 0 1 4", "3 0 1 -1")),
    a_face_of_2000000000_corners=scan(PLY.replace("4 0 1 2 3", "2000000000 0 1 2 3")),
    more_vertices_than_the_file_has_room_for=scan(PLY.replace("vertex 5", "vertex 4000000000")),
    more_faces_than_there_are=scan(PLY.replace("face 2", "face 3")),
    fewer_faces_than_there_are=scan(PLY.replace("face 2", "face 1")),
    a_NaN_vertex=scan(PLY.replace("0.5 0.5 1 5", "nan 0.5 1 5")),
    no_faces=scan(PLY.replace("face 2", "face 0").replace("4 0 1 2 3\n3 0 1 4\n", "")),
    vertices_without_z=scan(PLY.replace("property float z", "property float w")),
    an_unknown_type=scan(PLY.replace("property float x", "property float128 x")),
    an_empty_file=scan(""),
    a_file_of_another_kind=scan("solid thing"),
    half_a_file=cut("session/scan.ply"),
    a_byte_too_many=lambda folder: scan_bytes(folder, lambda data: data + b"x"),
    a_byte_inserted=lambda folder: scan_bytes(folder, lambda data: data[:-50] + b"\0" + data[-50:]),
    a_last_corner_of_2139062143=lambda folder: scan_bytes(folder, lambda data: data[:-4] + b"\x7f" * 4),
)


def scan_bytes(folder: Path, change) -> None:
    path = folder / "session" / "scan.ply"
    path.write_bytes(change(path.read_bytes()))


def other_scan(name: str, value: str | bytes):
    def spoil(folder: Path) -> None:
        (folder / "session" / name).write_bytes(value.encode() if isinstance(value, str) else value)
        text("session/session.json", ("scan.ply", name))(folder)

    return spoil


spoilt_by(
    "Scan",
    TEMPLATE,
    OBJ_with_a_corner_beyond_the_vertices=other_scan("scan.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
    OBJ_with_corner_0=other_scan("scan.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n"),
    OBJ_with_a_face_of_two_corners=other_scan("scan.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n"),
    OBJ_with_a_word_for_a_number=other_scan("scan.obj", "v 0 zero 0\n"),
    STL_with_more_triangles_than_bytes=other_scan("scan.stl", bytes(80) + struct.pack("<I", 2**32 - 1) + bytes(50)),
    STL_with_an_incomplete_triangle=other_scan("scan.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\n"),
    OFF_with_more_vertices_than_bytes=other_scan("scan.off", "OFF\n3000000000 1 0\n0 0 0\n"),
    a_format_that_is_not_known=other_scan("scan.xyz", "0 0 0\n"),
)

# --- sessions

RECONSTRUCT = "reconstruct session -o new"
SESSION = "session/session.json"
spoilt_by("Session", "scan footage/videos", videos_in_its_place=lambda folder: None)
spoilt_by("Session", "scan footage/videos/cam0.mp4", a_video_in_its_place=lambda folder: None)
spoilt_by(
    "Session",
    RECONSTRUCT,
    no_such_folder=gone("session"),
    no_session_json=gone(SESSION),
    JSON_with_a_syntax_error=text(SESSION, ('"fps": 40', '"fps" 40')),
    JSON_of_100000_levels=content(SESSION, "[" * 100000),
    no_frame_rate=text(SESSION, ('"fps": 40,', "")),
    a_frame_rate_of_0=text(SESSION, ('"fps": 40', '"fps": 0')),
    a_word_for_the_number_of_frames=text(SESSION, ('"frame_count": 3', '"frame_count": "all"')),
    a_negative_number_of_frames=text(SESSION, ('"frame_count": 3', '"frame_count": -3')),
    more_frames_than_images=text(SESSION, ('"frame_count": 3', '"frame_count": 4')),
    no_cameras=lambda folder: (folder / SESSION).write_text(
        json.dumps({**json.loads((folder / SESSION).read_text()), "cameras": []})
    ),
    two_cameras_of_one_name=text(SESSION, ('"cam1"', '"cam0"')),
    a_camera_that_is_not_calibrated=text("session/calibration.yml", *[(f"cam1_{k}:", f"spare_{k}:") for k in ("K", "R", "t")]),
    no_calibration=gone("session/calibration.yml"),
    a_calibration_that_is_no_YAML=content("session/calibration.yml", "cam0_K: [1, 2"),
    a_matrix_of_too_many_rows=text("session/calibration.yml", ("rows: 3", "rows: 2000000000")),
    a_matrix_of_fewer_numbers=text("session/calibration.yml", ("cols: 3", "cols: 1")),
    a_rotation_that_is_none=text("session/calibration.yml", ("cam0_R", "cam0_Q"), ("cam0_K", "cam0_R"), ("cam0_Q", "cam0_K")),
    an_image_width_of_0=text("session/calibration.yml", ("cam0_image_width: 48", "cam0_image_width: 0")),
    a_camera_late_by_no_number=text("session/calibration.yml", ("cam0_image_width: 48", "cam0_image_width: 48\ncam0_late: soon")),
    images_of_another_size=png("session/masks/cam0_0000.png", 32),
    a_damaged_image=cut("session/masks/cam1_0000.png", 0.3),
    images_that_are_not_there=gone("session/masks"),
    no_scan=gone("session/scan.ply"),
    no_joints=gone("session/joints.json"),
    a_joint_with_an_unknown_parent=text("session/joints.json", ('"parent": "pelvis"', '"parent": "hip"')),
    a_joint_of_7_degrees_of_freedom=text("session/joints.json", ('"dof": 3', '"dof": 7')),
    a_joint_without_a_place=text("session/joints.json", ('"position"', '"place"')),
    a_landmark_of_two_numbers=text("session/joints.json", ("0,\n   1.1,\n   0.2", "0, 1.1")),
)

# --- what a session is made from

NEW_SESSION = "new-session footage/videos --calibration session/calibration.yml -o new"
FOOTAGE = "footage/videos/"


def copied(path: str, target: str):
    return lambda folder: shutil.copy(folder / path, folder / target)


def all_masks(change):
    """Every mask of cam1, changed."""

    def spoil(folder: Path) -> None:
        for path in sorted((folder / "footage" / "masks" / "cam1").iterdir()):
            changed = change(np.asarray(Image.open(path)))
            Image.fromarray(changed).save(path)

    return spoil


spoilt_by(
    "New session",
    NEW_SESSION,
    no_videos=gone("footage/videos"),
    a_file_that_is_no_video=content(FOOTAGE + "cam1.mp4", "a letter"),
    a_video_cut_after_three_quarters=cut(FOOTAGE + "cam1.mp4", 0.75),  # how long it is depends on the cores that coded it
    two_files_for_one_camera=copied(FOOTAGE + "cam0.mp4", FOOTAGE + "cam0.mov"),
    a_camera_without_a_file=gone(FOOTAGE + "cam1.mp4"),
    a_file_without_a_camera=copied(FOOTAGE + "cam0.mp4", FOOTAGE + "garden.mp4"),
    a_calibration_that_is_none=content("session/calibration.yml", "a letter"),
    images_of_another_size=text("session/calibration.yml", ("cam0_image_width: 48", "cam0_image_width: 64")),
    a_session_that_is_there=lambda folder: shutil.copytree(folder / "session", folder / "new"),
    a_folder_of_something_else=lambda folder: [(folder / "new").mkdir(), content("new/letter.txt", "dear")(folder)],
)
for more, case in (
    ("--offset cam1=5", "no_overlap_in_time"),
    ("--offset cam7=1", "an_offset_of_an_unknown_camera"),
    ("--sync sound", "no_sound_track"),
    ("--fps 0", "a_frame_rate_of_0"),
    ("--sync none --frames 9", "more_frames_than_there_are"),
):
    spoilt_by("New session", f"{NEW_SESSION} {more}", **{case: lambda folder: None})
spoilt_by("New session", f"{NEW_SESSION} --sync none", a_disk_that_is_full=small_disk)
spoilt_by(
    "New session",
    f"{NEW_SESSION} --sync none --masks footage/masks",
    masks_that_show_nothing=all_masks(lambda mask: 0 * mask),
    masks_that_are_white=all_masks(lambda mask: mask | 255),
    masks_that_are_inverted=all_masks(lambda mask: 255 - mask),
    a_mask_too_few=gone("footage/masks/cam1/0003.png"),
    masks_of_another_size=all_masks(lambda mask: mask[::2].copy()),
)
spoilt_by(
    "New session",
    f"{NEW_SESSION} --scan scan.ply",
    a_scan_that_is_not_there=content(FOOTAGE + "cam1.mp4", "a letter"),  # said before the videos are read
)
spoilt_by("New session", "new-session footage/videos -o new", no_calibration=lambda folder: None)

# --- calibrations of other programs


def import_of(name: str) -> str:
    return f"import-calibration calibrations/{name} -o new.yml"


TOML = "calibrations/toml/Calib.toml"
spoilt_by(
    "Calibration",
    import_of("toml/Calib.toml"),
    no_such_file=gone(TOML),
    TOML_with_a_syntax_error=text(TOML, ("matrix = [[", "matrix = [")),
    TOML_of_100000_levels=content(TOML, "a = " + "[" * 100000),
    two_cameras_of_one_name=text(TOML, ('name = "cam1"', 'name = "cam0"')),
    no_camera=content(TOML, "[metadata]\nerror = 0.0\n"),
    a_NaN_in_a_matrix=text(TOML, ("matrix = [[1681.2", "matrix = [[nan")),
    a_rotation_that_is_none=text(TOML, ("rotation = [", "rotation = [1.0, 0.0, 0.0, 0.0, 1.2, 0.0, 0.0, 0.0, 1.0]\nold = [")),
    a_rotation_of_four_numbers=text(TOML, ("rotation = [", "rotation = [1.0, 0.0, 0.0, 0.0]\nold = [")),
    three_terms_of_distortion=text(TOML, ("distortions = [", "distortions = [0.0, 0.1, 0.2]\nold = [")),
    a_fisheye_of_five_terms=text(TOML, ("distortions = [", "fisheye = true\ndistortions = [0.0, ")),
    images_without_a_size=text(TOML, ("size = [", "sizes = [")),
    millimetres_that_are_taken_for_metres=text(TOML, ("translation = [", "translation = [9e3, 9e3, 9e3]\nold = [")),
    an_axis_that_does_not_point_up=lambda folder: turned(folder / TOML),
)


def turned(path: Path) -> None:
    """Every camera with its right and its lower edge exchanged for the left and the upper one."""
    lines = path.read_text().splitlines()
    for i, line in enumerate(lines):
        if line.startswith("rotation"):
            right, down, forward = json.loads(line.partition("=")[2])
            lines[i] = f"rotation = {[[-v for v in right], [-v for v in down], forward]}"
    path.write_text("\n".join(lines) + "\n")


spoilt_by(
    "Calibration",
    import_of("colmap_binary"),
    COLMAP_with_images_cut_in_half=cut("calibrations/colmap_binary/images.bin"),
    COLMAP_with_2147483648_cameras=content("calibrations/colmap_binary/cameras.bin", struct.pack("<Q", 2**31) + bytes(100)),
    COLMAP_with_an_unknown_model=content(
        "calibrations/colmap_binary/cameras.bin", struct.pack("<QIiQQ", 1, 1, 10, 8, 8) + bytes(96)
    ),
    COLMAP_without_images=gone("calibrations/colmap_binary/images.bin"),
)
spoilt_by(
    "Calibration",
    import_of("colmap_text"),
    COLMAP_with_a_model_that_OpenCV_does_not_have=text("calibrations/colmap_text/cameras.txt", ("OPENCV", "THIN_PRISM_FISHEYE")),
    COLMAP_with_an_image_of_no_camera=text("calibrations/colmap_text/images.txt", (" 1 cam0.png", " 2 cam0.png")),
)
spoilt_by(
    "Calibration",
    import_of("opencv/cam0.yml"),
    OpenCV_file_without_a_pose=text("calibrations/opencv/cam0.yml", ("\nR: ", "\nQ: ")),
    OpenCV_file_with_a_matrix_of_too_many_rows=text("calibrations/opencv/cam0.yml", ("rows: 3", "rows: 2000000000")),
    OpenCV_file_of_an_unknown_camera_model=text("calibrations/opencv/cam0.yml", ("\nR: ", '\ncamera_model: "mei"\nR: ')),
    OpenCV_file_of_two_documents=text("calibrations/opencv/cam0.yml", ("\nR: ", "\n...\n- R: ")),
    a_file_of_no_known_format=content("calibrations/opencv/cam0.yml", "cameras: 2\n"),
)
spoilt_by(
    "Calibration",
    import_of("easymocap"),
    EasyMocap_without_extri_yml=gone("calibrations/easymocap/extri.yml"),
    EasyMocap_without_names=text("calibrations/easymocap/intri.yml", ("names:", "cameras:")),
    EasyMocap_without_a_size=text("calibrations/easymocap/intri.yml", ("W_cam1", "V_cam1")),
)
spoilt_by(
    "Calibration",
    import_of("qualisys/session.qca.txt"),
    XML_with_a_syntax_error=content("calibrations/qualisys/session.qca.txt", "<calibration>\n<cameras>\n</calibration>\n"),
    a_word_for_a_focal_length=text("calibrations/qualisys/session.qca.txt", ('focalLengthU="', 'focalLengthU="long')),
    Qualisys_without_a_pose=text("calibrations/qualisys/session.qca.txt", ("<transform", "<transformation")),
)
spoilt_by(
    "Calibration",
    "import-calibration calibrations/toml/Calib.toml -o new.yml --units feet",
    units_that_are_not_known=lambda folder: None,
)
spoilt_by("Calibration", "import-calibration out -o new.yml", a_folder_without_a_calibration=lambda folder: None)

# --- files of a reconstruction

spoilt_by(
    "Files between stages",
    "segment out --force",
    actor_npz_missing=gone("out/actor.npz"),
    actor_npz_cut_in_half=cut("out/actor.npz"),
    actor_npz_of_many_names_for_one_large_array=bomb("out/actor.npz"),
    actor_npz_without_weights=arrays("out/actor.npz", weights=None),
    weights_for_another_number_of_joints=arrays("out/actor.npz", weights=lambda w: w[:, :1]),
    weights_that_do_not_sum_to_one=arrays("out/actor.npz", weights=lambda w: 2 * w),
    a_face_of_the_actor_beyond_its_vertices=arrays("out/actor.npz", faces=first(99999)),
    a_joint_that_is_its_own_parent=arrays("out/actor.npz", joint_parents=lambda p: np.array([-1, 1])),
    Python_objects_in_place_of_numbers=arrays("out/actor.npz", vertices=np.array([None], object)),
    big_endian_numbers=arrays("out/actor.npz", vertices=lambda v: v.astype(">f4")),
    half_floats=arrays("out/actor.npz", vertices=lambda v: v.astype(np.float16)),
    a_NaN_vertex_in_the_performance=arrays("out/performance.npz", vertices=first(np.nan)),
    a_performance_of_another_actor=arrays("out/performance.npz", vertices=lambda v: v[:, :-1]),
    fewer_poses_than_frames=arrays("out/performance.npz", dofs=lambda q: q[:-1]),
    paint_of_fewer_vertices=lambda folder: np.savez(folder / "out/segmentation_paint.npz", painted=np.zeros(39, np.int8)),
    paint_of_another_kind=lambda folder: np.savez(folder / "out/segmentation_paint.npz", painted=np.full(40, 4, np.int8)),
)
spoilt_by(
    "Files between stages",
    "body out --force",
    clothness_of_2=arrays("out/segmentation.npz", clothness=first(2)),
    clothness_of_fewer_vertices=arrays("out/segmentation.npz", clothness=lambda c: c[:-1]),
)
spoilt_by(
    "Files between stages",
    "body out --force --body-model model.npz",
    a_body_model_that_is_missing=lambda folder: None,
    a_body_model_of_other_arrays=lambda folder: np.savez(folder / "model.npz", vertices=np.zeros(3)),
    a_body_model_cut_in_half=lambda folder: [np.savez(folder / "model.npz", a=np.zeros(999)), cut("model.npz")(folder)],
)
spoilt_by(
    "Files between stages",
    "garment out --force",
    a_body_with_a_face_beyond_its_vertices=arrays("out/body.npz", faces=first(-1)),
    a_body_without_its_model_name=arrays("out/body.npz", model=None),
)
spoilt_by(
    "Files between stages",
    "fit out --force",
    a_proxy_of_an_unknown_joint=text("out/proxies.json", ('"pelvis"', '"tail"')),
    a_proxy_of_negative_radius=text("out/proxies.json", ('"r0": 0.1', '"r0": -0.1')),
    proxies_that_are_no_JSON=content("out/proxies.json", "capsules"),
    a_garment_for_other_faces=arrays("out/garment.npz", covers=lambda c: c[:-1]),
    observations_with_falling_offsets=arrays("out/observations.npz", contour_offsets=lambda o: o[::-1]),
    observations_of_a_camera_without_size=arrays("out/observations.npz", camera_size=lambda s: 0 * s),
    a_checkpoint_that_is_damaged=content("out/fit_checkpoint.txt", '{"kind": "minimise", "problem": ' + "9" * 5000),
)
spoilt_by(
    "Files between stages",
    "character out --force",
    a_material_without_a_parameter=text("out/material.json", ('"k_bend"', '"k_fold"')),
    a_material_beyond_its_range=text("out/material.json", ('"k_bend": 0.7', '"k_bend": 7.0')),
    material_json_that_is_no_JSON=content("out/material.json", "{"),
    a_material_of_another_solver=content("out/material.json", '{"solver": {"substeps": 1}, "regions": []}'),
    a_material_file_of_the_future=content("out/material.json", '{"version": 3, "regions": []}'),
    simulated_cloth_without_a_material=content("out/material.json", '{"regions": []}'),
    template_high_ply_cut_in_half=cut("out/template_high.ply"),
)
spoilt_by(
    "Files between stages",
    "report out --force",
    run_json_that_is_no_JSON=content("out/run.json", "{"),
    run_json_without_a_session=content("out/run.json", "{}"),
)
# --- characters

ANIMATE = "animate c.glb walk.bvh -o new.npz"
spoilt_by(
    "Character",
    ANIMATE,
    no_such_file=gone("c.glb"),
    half_a_character=cut("c.glb"),
    a_character_that_is_no_glTF=content("c.glb", b"PK" + bytes(100)),
    a_glTF_of_another_program=gltf(lambda g: g.pop("extensions") and None),
    a_version_of_the_future=gltf(lambda g: extension(g).update(version=4)),
    a_buffer_in_another_file=gltf(lambda g: g["buffers"][0].update(uri="../../../etc/passwd")),
    an_image_in_another_file=gltf(lambda g: g["images"][0].update(uri="https://example.com/a.png")),
    a_buffer_view_that_begins_at_2147483647=gltf(lambda g: view_of_texture(g).update(byteOffset=2**31 - 1)),
    a_buffer_view_of_4294967295_bytes=gltf(lambda g: view_of_texture(g).update(byteLength=2**32 - 1)),
    a_buffer_view_of_a_negative_length=gltf(lambda g: view_of_texture(g).update(byteLength=-1)),
    an_accessor_longer_than_its_view=gltf(lambda g: accessor_of_faces(g).update(count=10**6)),
    an_accessor_of_a_view_that_is_not_there=gltf(lambda g: accessor_of_faces(g).update(bufferView=999)),
    an_accessor_of_another_type=gltf(lambda g: accessor_of_faces(g).update(componentType=5126)),
    an_accessor_that_is_not_there=gltf(lambda g: extension(g)["mesh"].update(vertices=-1)),
    faces_in_place_of_vertices=gltf(lambda g: extension(g)["mesh"].update(weights=extension(g)["mesh"]["vertices"])),
    a_proxy_of_joint_99=gltf(lambda g: extension(g)["proxies"][0].update(joint=99)),
    a_joint_whose_parent_is_itself=gltf(lambda g: extension(g)["skeleton"][1].update(parent="spine")),
    a_material_too_few=gltf(lambda g: extension(g)["materials"].pop() and None),
    a_step_of_0_seconds=gltf(lambda g: extension(g)["solver"].update(dt=0)),
    glTF_of_1000_levels=gltf(lambda g: "[" * 1000 + "]" * 1000),
)

# --- motions

spoilt_by(
    "Motion",
    ANIMATE,
    no_such_motion=gone("walk.bvh"),
    a_motion_cut_in_half=cut("walk.bvh", 0.9),
    a_word_for_an_angle=text("walk.bvh", ("0.1 1 0 5", "0.1 1 0 five")),
    a_value_too_few_in_a_frame=text("walk.bvh", ("0.1 1 0 5", "0.1 1 0")),
    more_frames_than_it_says=text("walk.bvh", ("Frames: 3", "Frames: 2")),
    fewer_frames_than_it_says=text("walk.bvh", ("Frames: 3", "Frames: 1000000")),
    a_frame_time_of_0=text("walk.bvh", ("Time: 0.025", "Time: 0")),
    a_frame_time_of_1e300=text("walk.bvh", ("Time: 0.025", "Time: 1e300")),
    an_infinite_offset=text("walk.bvh", ("OFFSET 0 0.2 0", "OFFSET 0 inf 0")),
    a_channel_that_is_not_known=text("walk.bvh", ("Zrotation", "Wrotation")),
    a_hierarchy_that_does_not_close=text("walk.bvh", ("  }\n}", "")),
    joints_that_are_no_person=lambda folder: None,
)
ACCLAIM = "animate c.glb person_01.amc -o new.npz"
spoilt_by(
    "Motion",
    ACCLAIM,
    an_AMC_without_its_ASF=gone("person.asf"),
    a_bone_that_the_skeleton_has_not=text("person_01.amc", ("thorax 4", "tail 4")),
    a_bone_missing_in_a_frame=text("person_01.amc", ("thorax 4\n", "")),
    a_bone_that_hangs_on_nothing=text("person.asf", ("    lowerback thorax\n", "")),
    an_axis_order_that_is_none=text("person.asf", ("axis 0 0 0 XYZ", "axis 0 0 0 XXZ")),
)
spoilt_by("Motion", "animate c.glb walk.c3d -o new.npz", a_format_that_is_not_read=content("walk.c3d", "P"))
spoilt_by("Motion", "animate c.glb walk.fbx -o new.npz", an_fbx_that_is_cut=content("walk.fbx", "Kaydara FBX Binary  "))

spoilt_by(
    "Motion",
    ANIMATE + " --bone-map map.toml",
    no_such_bone_map=lambda folder: None,
    a_bone_map_that_is_no_TOML=content("map.toml", "l_hip: LeftUpLeg"),
    a_bone_map_without_joints=content("map.toml", 'l_hip = "spine"'),
    a_joint_that_is_not_ours=content("map.toml", '[joints]\nl_tail = "spine"'),
    a_joint_that_the_clip_has_not=content("map.toml", '[joints]\nl_hip = "LeftUpLeg"'),
    a_number_for_a_joint=content("map.toml", "[joints]\nl_hip = 3"),
    a_joint_that_is_both_hips=content("map.toml", '[joints]\nl_hip = "spine"\nr_hip = "spine"'),
)
spoilt_by(
    "Motion",
    "animate c.glb out/performance.npz -o new.npz --bone-map map.toml",
    a_bone_map_for_poses_of_the_character_itself=content("map.toml", '[joints]\nl_hip = "spine"'),
)

# --- where it goes, and what was asked

spoilt_by("Character", "view c.glb --compare other.glb -o new", nobody_to_compare_with=lambda folder: None)
spoilt_by("Character", "export-cloth c.glb -o new --areal-density 0", cloth_that_weighs_nothing=lambda folder: None)
spoilt_by("Motion", "export-cloth c.glb --motion dance.bvh -o new", a_motion_that_is_not_there=lambda folder: None)
spoilt_by("Motion", "view c.glb --clip dance.bvh -o new", a_clip_that_is_not_there=lambda folder: None)
spoilt_by("Output", "animate c.glb walk.bvh -o new.avi", a_format_that_is_not_written=lambda folder: None)
spoilt_by("Output", RECONSTRUCT, a_file_where_the_folder_should_be=content("new", "here"))
spoilt_by("Output", "segment out --force", a_disk_that_is_full=small_disk)

# --- stopped: at every stage, with what is left then, in tests/slow/every_stage.py

LATER_STAGES = ("segment", "body", "garment", "fit", "character")
STOPS = (("Ctrl_C", signal.SIGINT), ("SIGTERM", signal.SIGTERM))

for command in ("check session -o new", TEMPLATE, *(f"{stage} out --force" for stage in LATER_STAGES)):
    spoilt_by(
        "Stopped",
        command,
        **{
            f"{name}_while_{command.split()[0]}_runs": while_it_runs(partial(signal.raise_signal, number))
            for name, number in STOPS
        },
    )
spoilt_by("Options", RECONSTRUCT + " --segment-diffusion -1", a_length_below_0=lambda folder: None)
spoilt_by("Options", RECONSTRUCT + " --capture-start-frame 500", a_start_after_the_last_frame=lambda folder: None)
spoilt_by("Options", RECONSTRUCT + " --garment-length-exceedances 0.5 0.3", widths_that_are_not_in_order=lambda folder: None)
spoilt_by("Options", RECONSTRUCT + " --cloth-substeps 0", no_steps_at_all=lambda folder: None)
spoilt_by("Options", RECONSTRUCT + " --fit-optimizer newton", an_optimiser_that_is_not_there=lambda folder: None)
spoilt_by("Options", RECONSTRUCT + " --energy-dt x", an_option_that_is_not_there=lambda folder: None)
spoilt_by("Options", "fit out --space-names k_colour", a_parameter_that_is_not_there=lambda folder: None)
spoilt_by(
    "Options",
    "synthesize c.glb --motion walk.bvh -o new --material k_colour=1",
    a_material_parameter_that_is_not_there=lambda folder: None,
)
CONFIGURED = RECONSTRUCT + " --config mine.toml"
spoilt_by(
    "Options",
    CONFIGURED,
    a_file_of_options_that_is_missing=lambda folder: None,
    a_file_of_options_with_a_syntax_error=content("mine.toml", "[segment\ndiffusion = 0.03\n"),
    a_file_of_options_of_100000_levels=content("mine.toml", "a = " + "[" * 100000),
    a_file_of_options_that_is_no_text=content("mine.toml", bytes(range(128, 256))),
    a_group_of_options_that_is_not_there=content("mine.toml", "[sigment]\ndiffusion = 0.03\n"),
    a_key_that_is_not_there=content("mine.toml", "[segment]\ndifusion = 0.03\n"),
    a_text_for_a_number=content("mine.toml", '[segment]\ndiffusion = "0.03"\n'),
    a_fraction_for_a_whole_number=content("mine.toml", "[fit]\nmax_evaluations = 1.5\n"),
    a_number_beyond_its_bounds=content("mine.toml", "[segment]\ndiffusion = -1\n"),
    a_word_for_a_number_in_a_list=content("mine.toml", '[garment]\nspreads = [0.1, "wide"]\n'),
    a_material_parameter_of_another_name=content("mine.toml", "[space.fixed]\nk_colour = 1\n"),
    a_seed_within_a_group=content("mine.toml", "[fit]\nseed = 2\n"),
    a_seed_below_0=content("mine.toml", "seed = -1\n"),
    a_number_for_a_group=content("mine.toml", "segment = 3\n"),
)
spoilt_by(
    "Ground truth",
    "evaluate out --truth truth",
    a_ground_truth_that_is_missing=gone("truth"),
    frames_cut_in_half=cut("truth/frames_0000.npz"),
    faces_that_are_no_triangles=arrays("truth/static.npz", body_tris=np.zeros((4, 2), np.int32)),
    a_face_beyond_the_vertices=arrays("truth/static.npz", cloth_tris=first(999)),
    an_array_of_12_gigabytes_in_a_small_file=claimed_shape("truth/frames_0000.npz", "cloth", (2, 250000000, 3)),
    a_NaN_vertex=arrays("truth/frames_0000.npz", body=first(np.nan)),
    words_for_vertices=arrays("truth/frames_0000.npz", body=np.array(["a", "b"])),
    joints_of_fewer_names=arrays("truth/skeleton.npz", joint_names=["pelvis"]),
    a_mask_cut_in_half=cut("truth/masks/cam0_0000.png"),
)
spoilt_by("Options", "render out", a_command_that_is_not_there=lambda folder: None)


def keypoints(value: str):
    """Of both cameras, for a session whose joints are to be found."""

    def spoil(folder: Path) -> None:
        text("session/session.json", (',\n "markers": "joints.json"', ""))(folder)
        for camera in ("cam0", "cam1"):
            (folder / "keypoints").mkdir(exist_ok=True)
            (folder / "keypoints" / f"{camera}.json").write_text(value)

    return spoil


spoilt_by(
    "Keypoints",
    "scan session --keypoints keypoints",
    no_such_keypoints=lambda folder: (keypoints("")(folder), gone("keypoints")(folder)),
    keypoints_with_a_syntax_error=keypoints("[[1, 2,"),
    keypoints_of_100000_levels=keypoints("[" * 100000),
    keypoints_of_another_program=keypoints('{"bodies": []}'),
    keypoints_without_confidence=keypoints(json.dumps([np.ones((17, 2)).tolist()])),
    a_word_for_a_coordinate=keypoints(json.dumps([[["left", 1, 1]] * 17])),
    nobody_in_any_view=keypoints("[null]"),
)


# --- running them


class Row(NamedTuple):
    case: Case
    sentence: str
    status: str


def run(case: Case, folder: Path) -> tuple[str, str]:
    """(status, sentence) of the command line in this process, in the folder."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    made, arguments = folder / "made", case.command.split()
    shutil.rmtree(made, ignore_errors=True)
    shutil.copytree(folder / "good", made)
    record = made / "out" / "run.json"
    record.write_text(record.read_text().replace(str(folder / "good"), str(made)))
    case.spoil(made)
    said = io.StringIO()
    os.chdir(made)
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
        try:
            status = cli.main(arguments)
        except SystemExit as stop:  # of argparse
            status = stop.code
    lines = [line for line in said.getvalue().splitlines() if line.startswith("doublet")]
    return str(status), (lines[-1] if lines else "").replace(f"{made}/", "").replace(str(made), ".")


def run_all() -> list[Row]:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve()
        make_folder(folder / "good")
        results = outcomes(len(CASES), lambda i: run(CASES[i], folder))
    return [Row(case, sentence, status) for case, (status, sentence) in zip(CASES, results)]


def page(rows: list[Row]) -> str:
    def cell(value: str) -> str:
        return value.replace("|", "\\|").replace("<", "&lt;")

    lines = []
    for row in rows:
        command = f"`doublet {row.case.command}`"
        lines.append(f"| {row.case.group}: {row.case.what} | {command} | {cell(row.sentence)} | {row.status} |")
    return HEAD + "\n".join(lines) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(run_all()), encoding="utf-8")
