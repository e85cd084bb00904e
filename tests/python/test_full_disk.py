"""A file is complete or absent, on a full disk too, and the sentence names it."""

import contextlib
import io
import os
import re
import resource
import subprocess
import sys
from pathlib import Path

import doublet as d
import numpy as np
import pytest
from doublet.cli import commands
from doublet.cli import program as cli
from doublet.common.files import folder_written_atomically, write_json, written_atomically
from doublet.common.video import VideoWriter
from doublet.export.usd import usd_modules, write_usdc
from doublet.export.vertex_animation import write_png16
from doublet.pages.view import FILES, write_view

sys.path.append(str(Path(__file__).parents[1] / "fuzz"))
from children import outcomes  # noqa: E402
from seeds import World  # noqa: E402

ROOM = 8192  # bytes that a file may have


@pytest.fixture(scope="module")
def world():
    return World()


@contextlib.contextmanager
def small_disk():
    resource.setrlimit(resource.RLIMIT_FSIZE, (ROOM, resource.RLIM_INFINITY))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))


def noise(shape):
    return np.random.default_rng(3).normal(size=shape)


def savez(path):
    with written_atomically(path) as beside:
        np.savez(beside, noise=noise(9999))


def video(path, frames=40):
    pictures = np.random.default_rng(4).integers(0, 255, (frames, 128, 128, 3), np.uint8)
    with VideoWriter(path, 128, 128, 25) as out:
        for picture in pictures:
            out.write(picture)


def writers(world):
    usd_modules()  # loaded in a child it would count among what the child may have
    w, fine = world, np.linspace(0, 1, 99)
    vertices = np.stack(np.meshgrid(fine, fine, [0]), axis=-1).reshape(-1, 3) + 1e-3 * noise((99 * 99, 3))
    corner = np.arange(98 * 99)
    big = d.Mesh(vertices, np.stack([corner, corner + 1, corner + 99], axis=1).astype(np.int32))
    clothness = d.Segmentation(noise(9999), np.abs(np.sin(noise(9999))), np.zeros(9999, np.int32))
    long = d.Motion(40, np.repeat(w.dofs, 40, axis=0))
    animation = d.animate(w.character, long, d.AnimateOptions(high=False))
    w.character.high = big
    w.character.high_valid = [1] * len(big.faces)
    w.character.texcoords = np.zeros((3 * len(big.faces), 2))
    plain = d.make_character(w.actor, w.segmentation, w.body, w.proxies, [w.material], d.SolverSettings(1 / 40))  # no texture
    body = d.BodyFit()
    body.body, body.coefficients, body.model = big, np.zeros(1), "grid"
    many = [w.proxies[0]] * 500
    actor = d.RiggedMesh(big, [1] * len(big.faces), np.tile([0.5, 0.5], (len(vertices), 1)), w.skeleton)
    performance = d.ReferencePerformance()
    performance.surface = d.MeshSequence(big.faces, vertices[None])
    performance.dofs, performance.joints = w.dofs[:1], w.performance.joints[:1]
    performance.frames = [0]
    seen = d.ViewObservation(noise((9999, 2)).astype(np.float32), np.zeros((0, 4), np.float32))
    w.observations.views = [[seen for _ in w.cameras] for _ in range(3)]
    cameras = [d.orbit_camera([0, 1, 0], 0.9, a, 0.1, 48, 48) for a in fine]
    for c, camera in enumerate(cameras):
        camera.name = f"cam{c}"
    return {
        "mesh.ply": lambda path: d.write_mesh(path, big),
        "mesh.obj": lambda path: d.write_mesh(path, big),
        "mesh.stl": lambda path: d.write_mesh(path, big),
        "mesh.off": lambda path: d.write_mesh(path, big),
        "character.glb": w.character.write,
        "actor.npz": lambda path: d.write_actor(path, actor),
        "performance.npz": lambda path: d.write_performance(path, performance),
        "observations.npz": lambda path: d.write_observations(path, w.observations),
        "simulated.npz": lambda path: d.write_simulated(path, vertices[None], len(vertices)),
        "calibration.yml": lambda path: d.write_calibration(path, cameras),
        "motion.bvh": lambda path: d.write_bvh(path, w.skeleton, d.Motion(40, noise((400, 9)))),
        "motion.usdc": lambda path: write_usdc(path, plain, long, d.AnimateOptions(high=False)),
        "motion_vat.png": lambda path: write_png16(path, (1e4 * noise((99, 99, 3))).astype(np.uint16)),
        "segmentation.npz": lambda path: d.write_segmentation(path, clothness),
        "body.npz": lambda path: d.write_body(path, body),
        "proxies.json": lambda path: d.write_proxies(path, many, w.skeleton),
        "baked.npz": lambda path: d.write_baked_npz(path, w.character, animation),
        "baked.glb": lambda path: d.write_baked_glb(path, w.character, animation),
        "run.json": lambda path: write_json(path, list(range(9999))),
        "masks.npz": savez,
        "video.mp4": video,
    }


def written(write, path):
    try:
        write(path)
    except (RuntimeError, OSError) as error:
        return "refused", str(error)
    return "written", ""


@pytest.mark.parametrize("old", [None, b"old"])
def test_a_file_without_room_is_absent_and_named(world, tmp_path, old):
    made = writers(World())
    for name in made:
        if old:
            (tmp_path / name).write_bytes(old)
    with small_disk():
        results = outcomes(len(made), lambda i: written(made[list(made)[i]], tmp_path / list(made)[i]))
    for name, (kind, text) in zip(made, results):
        assert kind == "refused" and str(tmp_path / name) in text and len(text) < 400, (name, kind, text)
        assert (tmp_path / name).read_bytes() == old if old else not (tmp_path / name).exists(), name
    assert sorted(p.name for p in tmp_path.iterdir()) == (sorted(made) if old else [])  # no rest of a temporary file


@pytest.fixture
def tiny_disk(tmp_path):
    """A disk of 16 KiB that is really full, for what root may mount."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mounted = (
        os.geteuid() == 0
        and not subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16k", "tmpfs", str(folder)], capture_output=True).returncode
    )
    if not mounted:
        pytest.skip("needs a mount")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


def test_a_disk_that_is_really_full(tiny_disk):
    made = writers(World())
    for name, write in made.items():
        kind, text = written(write, tiny_disk / name)
        assert kind == "refused" and str(tiny_disk / name) in text, (name, kind, text)
        assert "No space left" in text or "exit status" in text or "Error" in text, text
        assert not list(tiny_disk.iterdir()), name


@pytest.mark.parametrize(("name", "write"), [("run.json", lambda path: write_json(path, "new")), ("masks.npz", savez)])
def test_a_link_stays_and_the_file_behind_it_is_written(tmp_path, name, write):
    """As the C++ half has it (tests/files/files_test.cpp)."""
    (tmp_path / "disk").mkdir()
    (tmp_path / "disk" / "blob").write_text("old")
    (tmp_path / "inner").symlink_to("disk/blob")
    (tmp_path / name).symlink_to("inner")
    write(tmp_path / name)
    assert (tmp_path / name).is_symlink() and (tmp_path / "inner").is_symlink()
    assert (tmp_path / "disk" / "blob").read_bytes() == (tmp_path / name).read_bytes() != b"old"
    assert sorted(p.name for p in (tmp_path / "disk").iterdir()) == ["blob"]


def test_a_link_to_a_folder_stays_and_that_folder_is_replaced(tmp_path):
    (tmp_path / "disk" / "session").mkdir(parents=True)
    (tmp_path / "mine").symlink_to("disk/session")
    with folder_written_atomically(tmp_path / "mine") as folder:
        write_json(folder / "session.json", "new")
    assert (tmp_path / "mine").is_symlink() and (tmp_path / "disk" / "session" / "session.json").is_file()
    said = re.escape(f"{tmp_path / 'mine' / 'x'}: no")
    with pytest.raises(RuntimeError, match=said), folder_written_atomically(tmp_path / "mine") as folder:
        raise RuntimeError(f"{folder / 'x'}: no")
    assert [sorted(p.name for p in folder.iterdir()) for folder in (tmp_path, tmp_path / "disk")] == [
        ["disk", "mine"],
        ["session"],
    ]


def test_a_folder_that_is_there_stays_the_same_one(tmp_path, monkeypatch):
    """A disk may be mounted on it, which nobody can rename, or somebody stand in it."""
    folder = tmp_path / "session"
    folder.mkdir()
    monkeypatch.chdir(folder)
    number = folder.stat().st_ino
    for round in ("first", "second"):
        with folder_written_atomically(Path()) as beside:
            write_json(beside / f"{round}.json", round)
            (beside / "videos").mkdir()
        assert folder.stat().st_ino == number and [p.name for p in tmp_path.iterdir()] == ["session"]
        assert sorted(p.name for p in Path.cwd().iterdir()) == [f"{round}.json", "videos"]


def test_what_was_in_a_folder_stays_if_another_content_cannot_come(tmp_path, monkeypatch):
    folder, move = tmp_path / "session", Path.replace
    folder.mkdir()
    for name in ("a", "b"):
        write_json(folder / name, "old")

    def fail(path, target):
        if path.name == "y":
            raise KeyboardInterrupt
        return move(path, target)

    monkeypatch.setattr(Path, "replace", fail)
    with pytest.raises(KeyboardInterrupt), folder_written_atomically(folder) as beside:
        for name in ("a", "x", "y", "z"):
            (beside / name).write_text("new", encoding="utf-8")
    assert sorted(p.name for p in folder.iterdir()) == ["a", "b"] and (folder / "a").read_text(encoding="utf-8") == '"old"\n'


def test_a_folder_of_one_that_was_killed_is_in_nobody_s_way(tmp_path):
    """In a container every process has the same number."""
    left = tmp_path / f".session.{os.getpid()}.part"
    left.mkdir()
    (left / "half").write_text("", encoding="utf-8")
    with folder_written_atomically(tmp_path / "session") as beside:
        write_json(beside / "whole", 1)
    assert [p.name for p in tmp_path.iterdir()] == ["session"]
    assert [p.name for p in (tmp_path / "session").iterdir()] == ["whole"]


def test_a_page_without_room(world, tmp_path, monkeypatch):
    bundle, page = tmp_path / "bundle", tmp_path / "page"
    bundle.mkdir()
    for name in FILES.values():
        (bundle / name).write_bytes(bytes(2 * ROOM))
    monkeypatch.setenv("DOUBLET_VIEWER_DIR", str(bundle))
    world.character.write(tmp_path / "c.glb")
    with small_disk(), pytest.raises(OSError) as refused:
        write_view(page, [tmp_path / "c.glb"], [], d.RetargetOptions())
    assert (refused.value.filename, list(page.iterdir())) == (str(page / "index.html"), [])


def test_a_command_says_so(world, tmp_path, capsys):
    world.character.write(tmp_path / "c.glb")
    from seeds import BVH

    (tmp_path / "walk.bvh").write_text(BVH)
    said = io.StringIO()
    with small_disk(), contextlib.redirect_stderr(said):
        status = cli.main(
            ["animate", str(tmp_path / "c.glb"), str(tmp_path / "walk.bvh"), "-o", str(tmp_path / "new.npz"), "--quiet"]
        )
    assert status == 1


def test_the_log_is_named(tmp_path):
    def chatter(job):
        with small_disk():
            for line in range(ROOM):
                job.context.log_line(f"line {line}")

    job = d.Reconstruction(tmp_path, tmp_path)
    job.session = d.Session()
    job.stages = [d.Stage("talk", chatter, needs_scan=False)]
    with pytest.raises(d.Error, match=re.escape(f"{tmp_path / 'log.txt'}: cannot be written: File too large")):
        job.run(["talk"])


def test_memory_that_a_thread_has_not(monkeypatch, capsys):
    """What TBB (in Embree, OpenCV) throws when there is no room for the stack of a thread."""

    def run(parsed):
        raise RuntimeError("pthread_create has failed: Resource temporarily unavailable")

    monkeypatch.setattr(commands.stages, "run_stages", run)
    assert cli.main(["check", "session", "-o", "out"]) == 1
    assert capsys.readouterr().err.startswith(
        "doublet: expected more memory than this process may have (pthread_create has failed: Resource temporarily unavailable); "
    )
