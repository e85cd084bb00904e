"""Small files that ask for much: levels without end, things by the hundred thousand, arrays of nothing. Each gets its sentence,
soon and without much memory: it is read in a process of its own that has 1.5 GiB and 20 s."""

import json
import os
import resource
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import doublet as d
import numpy as np
import pytest
from doublet.evaluation import metrics
from PIL import Image

sys.path.append(str(Path(__file__).parents[1] / "fuzz"))
import calibrations  # noqa: E402
from seeds import World, write_session  # noqa: E402
from test_brought_motions import CLEAN  # noqa: E402

DEEP = 100_000
HEAD = "%YAML:1.0\n---\n"
ALLOWED = 1536 << 20  # bytes
READ = """
import sys, doublet as d
from pathlib import Path
path = Path(sys.argv[1])
try:
    {}
except (RuntimeError, OSError, ValueError) as error:
    print(error)
"""


def limited() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (ALLOWED, ALLOWED))


def said(path: Path, call: str = "d.read_calibration(path)") -> str:
    """What is said about a file; it has to be read or refused in time, in little memory, without a crash."""
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    command = [sys.executable, "-c", READ.format(call), str(path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, preexec_fn=limited, env=environment)
    assert done.returncode == 0, (done.returncode, done.stderr[-500:])
    return done.stdout.strip()


def nested(opening: str, closing: str, inside: str = "1") -> str:
    return opening * DEEP + inside + closing * DEEP


LEVELS = {
    "flow.yml": HEAD + f"cam0_K: {nested('[', ']')}\n",
    "maps.yml": HEAD + f"cam0_K: {nested('{ a: ', ' }')}\n",
    "indents.yml": HEAD + "a:\n" + "".join(f"{' ' * i}a:\n" for i in range(1, 400)),
    "lists.yml": HEAD + "a:\n  " + "- " * DEEP + "1\n",
    "entry.yml": HEAD + "a: " + "- " * DEEP + "1\n",
    "opencv.json": '{"camera_matrix": ' + nested("[", "]") + "}",
    "opencv.xml": '<?xml version="1.0"?><opencv_storage>' + nested("<a>", "</a>") + "</opencv_storage>",
    "keys.toml": ".".join(["a"] * DEEP) + " = 1\n",
    "tables.toml": "[" + ".".join(["a"] * DEEP) + "]\nb = 1\n",
    "arrays.toml": "a = " + nested("[", "]") + "\n",
    "session.qca.txt": "<calibration>" + nested("<a>", "</a>") + "</calibration>",
    "metashape.xml": "<document><chunk><sensors/>" + nested("<a>", "</a>") + "</chunk></document>",
    "anipose.json": nested("[", "]"),
    "panoptic.json": '{"distCoef": ' + nested("[", "]") + "}",
}


@pytest.mark.parametrize("name", LEVELS)
def test_levels_without_end(tmp_path, name):
    (tmp_path / name).write_text(LEVELS[name])
    found = said(tmp_path / name)
    assert (
        name in found
        and "\n" not in found
        and ("levels, found more" in found or "columns of indent and 64 lists, found more" in found)
    ), found


def test_base64_in_a_calibration(tmp_path):
    (tmp_path / "cam0.yml").write_text(HEAD + "camera_matrix: !!binary |\n" + "  " + "A" * 3_000_000 + "\n")
    assert "cam0.yml: expected numbers written out, found base64" in said(tmp_path / "cam0.yml")


def test_cameras_by_the_hundred_thousand(tmp_path):
    names = "".join(f'   - "cam{i}"\n' for i in range(DEEP))
    (tmp_path / "intri.yml").write_text(HEAD + "names:\n" + names)
    (tmp_path / "extri.yml").write_text(HEAD + "a: 1\n")
    assert "intri.yml: expected at most 1000 cameras, found 100000" in said(tmp_path / "intri.yml")
    (tmp_path / "calibration.yml").write_text(HEAD + "".join(f"cam{i}_K: 1\n" for i in range(DEEP)))
    assert "calibration.yml: expected at most 1000 cameras, found 100000" in said(tmp_path / "calibration.yml")
    (tmp_path / "list.json").write_text(json.dumps([{}] * DEEP))
    assert "list.json: expected a list of 1 to 1000 cameras, found 100000" in said(tmp_path / "list.json")


@pytest.fixture(scope="module")
def world():
    return World()


@pytest.mark.parametrize("what", ["joints", "landmarks"])
@pytest.mark.parametrize("count", [2000, DEEP])
def test_marks_by_the_hundred_thousand(tmp_path, world, what, count):
    write_session(tmp_path / "session", world)
    path = tmp_path / "session" / "joints.json"
    content = json.loads(path.read_text())
    content[what] = {f"mark{i}": {"position": [0, 0, 0]} if what == "joints" else [0, 0, 0] for i in range(count)}
    path.write_text(json.dumps(content))
    expected = f"1000 {what}, found {count}" if count < DEEP else "20000 keys, found more"
    assert f"joints.json: expected at most {expected}" in said(tmp_path / "session", "d.Session(path)")


@pytest.mark.parametrize("name", ["a" * DEEP, "a/" * DEEP, "cam0_%" + "[" * DEEP])
def test_a_session_that_names_a_file_of_a_hundred_thousand_letters(tmp_path, world, name):
    write_session(tmp_path / "session", world)
    path = tmp_path / "session" / "session.json"
    content = json.loads(path.read_text())
    content["cameras"][0]["masks"] = name
    path.write_text(json.dumps(content))
    found = said(tmp_path / "session", "d.Session(path)")
    assert "session.json: expected the name of a mask series of camera 'cam0' of at most 255 characters" in found


def test_masks_of_a_thousand_million_pixels(tmp_path, world):
    write_session(tmp_path / "session", world)
    Image.new("1", (32000, 32000)).save(tmp_path / "mask.png")
    for path in (tmp_path / "session" / "masks").glob("*.png"):
        shutil.copy(tmp_path / "mask.png", path)
    assert ".png: expected an image of at most 134217728 pixels, found 32000 x 32000" in said(
        tmp_path / "session", "d.Session(path)"
    )


JOINT = "JOINT a\n{\nOFFSET 0 1 0\nCHANNELS 0\n"
END = "End Site\n{\nOFFSET 0 1 0\n}\n"
MOTION = "MOTION\nFrames: {}\nFrame Time: 0.1\n"
MOTIONS = {
    "deep.bvh": (
        f"HIERARCHY\n{JOINT.replace('JOINT', 'ROOT')}{JOINT * DEEP}{END}" + "}\n" * (DEEP + 1) + MOTION.format(1),
        "a skeleton of at most 10000 joints",
    ),
    "still.bvh": (
        f"HIERARCHY\n{JOINT.replace('JOINT', 'ROOT')}{END}}}\n" + MOTION.format(9_000_000),
        "joints with CHANNELS before",
    ),
    "many.bvh": (
        CLEAN.replace("Frames: 3", "Frames: 9000000"),
        "expected a clip of at most 2e+07 poses of nodes, found 9e+06 of",
    ),
    "deep.asf": (
        ":root\norder TX\n:bonedata\n"
        + "".join(f"begin\nname b{i}\ndirection 0 1 0\nlength 1\nend\n" for i in range(DEEP))
        + ":hierarchy\nbegin\n"
        + "".join(f"{f'b{i - 1}' if i else 'root'} b{i}\n" for i in range(DEEP))
        + "end\n",
        "expected a skeleton of at most 10000 bones, found more",
    ),
}


@pytest.mark.parametrize("name", MOTIONS)
def test_motions_that_are_too_large(tmp_path, name):
    text, sentence = MOTIONS[name]
    path = tmp_path / name
    path.write_text(text)
    if name.endswith("asf"):
        path = tmp_path / "deep.amc"
        path.write_text(":degrees\n1\nroot 0\n")
    found = said(path, "d.SourceMotion.read(path)")
    assert sentence in found.replace("e.07", "e+07").replace("e06", "e+06"), found


@pytest.mark.parametrize(
    ("name", "call"),
    [
        ("scan.ply", "d.read_mesh(path)"),
        ("walk.bvh", "d.SourceMotion.read(path)"),
        ("actor.npz", "d.read_actor(path)"),
        ("cal.toml", "d.read_calibration(path)"),
        ("options.toml", "__import__('doublet.reconstruct.config').reconstruct.config.read(path)"),
        ("poses.npz", "__import__('doublet.export.clips').export.clips.read_clip(path)"),
    ],
)
def test_a_pipe_that_nobody_writes_to(tmp_path, name, call):
    os.mkfifo(tmp_path / name)
    assert f"{name}: expected a file, found a" in said(tmp_path / name, call)


def test_a_gigabyte_of_nothing_in_a_megabyte(tmp_path, world):
    d.write_actor(tmp_path / "actor.npz", world.actor)
    with zipfile.ZipFile(tmp_path / "actor.npz", "a", zipfile.ZIP_DEFLATED) as archive, archive.open("zeros.npy", "w") as member:
        np.lib.format.write_array_header_1_0(member, {"descr": "<f8", "fortran_order": False, "shape": (1 << 27,)})
        for _ in range(1 << 10):
            member.write(bytes(1 << 20))
    found = said(tmp_path / "actor.npz", "d.read_actor(path)")
    assert "actor.npz: array 'zeros': expected numbers that fill the array, found more than" in found, found


def test_widths_of_no_garment(tmp_path, world):
    """As many as one likes fit into a file of 4 kB, and none into memory."""
    whole = {"region": (0,), "actor_face": (0,), "faces": (0, 3)}
    numbers = {"vertices": (0, 3), "clothness": (0,), "rest": (0, 3), "barycentric": (0, 3), "widths": (10**11, 0, 3)}
    arrays = {name: np.zeros(shape, np.int32) for name, shape in whole.items()}
    arrays |= {name: np.zeros(shape, np.float32) for name, shape in numbers.items()}
    covers = np.zeros(len(world.actor.mesh.faces), bool)
    np.savez(tmp_path / "garment.npz", format=np.array([1], np.int32), covers=covers, **arrays)
    d.write_actor(tmp_path / "actor.npz", world.actor)
    call = "d.read_garment(path, d.read_actor(path.parent / 'actor.npz'))"
    assert "MemoryError" not in said(tmp_path / "garment.npz", call)


@pytest.mark.parametrize("region", [2**31 - 1, -7])
def test_a_region_that_cannot_be(tmp_path, region):
    path = tmp_path / "segmentation.npz"
    d.write_segmentation(path, d.Segmentation(np.zeros(4), np.ones(4), [0, 0, 0, 0]))
    with np.load(path) as arrays:
        np.savez(path, **{**arrays, "region": np.array([0, 0, 0, region], np.int32)})
    with pytest.raises(d.Error, match="segmentation.npz: array 'region'"):
        d.read_segmentation(path)


def test_the_same_read_by_python(tmp_path):
    np.savez_compressed(tmp_path / "poses.npz", poses=np.zeros((2_000_000, 66)), trans=np.zeros((3, 3)), fps=30)
    call = "__import__('doublet.export.clips').export.clips.read_clip(path)"
    assert "found: poses.npy of 1007 MiB out of" in said(tmp_path / "poses.npz", call)


def test_texts_without_a_letter(tmp_path):
    with zipfile.ZipFile(tmp_path / "skeleton.npz", "w") as archive, archive.open("joint_names.npy", "w") as member:
        np.lib.format.write_array_header_1_0(member, {"descr": "<U0", "fortran_order": False, "shape": (1 << 31,)})
    call = "__import__('doublet.common.files').common.files.arrays_of(path).__enter__()['joint_names']"
    assert "found: joint_names.npy of shape (2147483648,) in 0 bytes" in said(tmp_path / "skeleton.npz", call)


# --- records and truths


ENTRY = {"state": "done", "version": d.__version__, "options": {}, "inputs": {}, "outputs": {}, "summary": {"regions": 1}}
ENTRY |= {"seconds": 1.0, "peak_memory_mb": 5.0}


@pytest.mark.parametrize(
    "damage",
    [
        {"state": 3},
        {"options": []},
        {"inputs": None},
        {"inputs": {"a": 3}},
        {"outputs": ["a"]},
        {"summary": "none"},
        {"seconds": "long"},
        {"peak_memory_mb": None},
        {"version": 7},
    ],
)
def test_entries_of_a_damaged_record_are_none(tmp_path, damage):
    (tmp_path / "run.json").write_text(json.dumps({"format": 1, "stages": {"segment": {**ENTRY, **damage}, "body": ENTRY}}))
    record = d.RunRecord(tmp_path)
    assert record.reason_to_run("body", {}, {}, []) == ""
    assert record.reason_to_run("segment", {}, {}, []) in ("first run", "")
    assert record.foreign_outputs("segment", ["a"]) == []


def test_a_damaged_session_in_a_record_is_named(tmp_path):
    (tmp_path / "run.json").write_text(json.dumps({"session": 5, "stages": {}}))
    with pytest.raises(RuntimeError, match=r"run\.json: expected 'session' to be a folder"):
        d.RunRecord(tmp_path)


def test_areas_of_nothing_are_missing_not_a_division():
    with pytest.raises(metrics.Missing, match="the truth has no surface"):
        metrics.averaged(np.ones(3), np.zeros(3), "surface")
    assert metrics.averaged(np.array([1.0, 3]), np.array([1.0, 3]), "surface") == 2.5


def test_every_calibration_is_still_read(tmp_path):
    """What is refused above is not what programs write."""
    for path, _ in calibrations.write_all(tmp_path).values():
        assert len(d.read_calibration(path)) == 2
