"""`doublet new-session`: a made-up person who jumps and waves, filmed by cameras that began at other times, ran at other rates,
lay on their side, or whose files are named by nobody who has read a manual."""

import json
import shlex
import shutil
import subprocess
import wave
from pathlib import Path
from types import SimpleNamespace

import doublet as d
import numpy as np
import pytest
from doublet.cli import main
from doublet.cli.commands import new_session as command
from doublet.common.video import VideoWriter, read_video
from doublet.session import new_session, synchronise
from doublet.session.camera_files import CameraFile, list_files, match
from doublet.session.filmed_cameras import names_of
from doublet.session.new_session import PICTURE, Request
from PIL import Image

SIZE, FPS, SECONDS, CAMERAS = 96, 30.0, 4.0, 4
CENTRE = np.array([0, 1.0, 0])
GREEN = (40, 180, 30)  # B G R

# --- a person, cameras, files


def height(t):
    """m above the floor: jumps at no regular times."""
    return sum(0.25 * np.maximum(0, 1 - ((t - at) / 0.2) ** 2) for at in (0.7, 1.9, 2.5, 3.4))


def person(t: float) -> d.Mesh:
    """Trunk, head, legs, and an arm that waves."""
    swing, up = 0.9 * np.sin(2.2 * t + 0.8 * np.sin(5 * t)), np.array([0, height(t), 0])
    hand = [0.18 + 0.5 * np.cos(swing), 1.3 + 0.5 * np.sin(swing), 0.1]
    parts = [
        ((0, 0.85, 0), (0, 1.35, 0), 0.16),
        ((0, 1.62, 0), (0, 1.65, 0), 0.12),
        ((0.1, 0.8, 0), (0.1, 0.1, 0), 0.08),
        ((-0.1, 0.8, 0), (-0.1, 0.1, 0), 0.08),
        ((0.15, 1.3, 0), hand, 0.06),
    ]
    vertices, faces = [], []
    for p0, p1, radius in parts:
        mesh = d.capsule_mesh(np.array(p0) + up, np.array(p1) + up, radius, radius)
        faces.append(mesh.faces + sum(map(len, vertices)))
        vertices.append(mesh.vertices)
    return d.Mesh(np.vstack(vertices), np.vstack(faces))


def rig() -> list[d.Camera]:
    cameras = []
    for c in range(CAMERAS):
        camera = d.orbit_camera(CENTRE, 1.25, 2 * np.pi * (c + 0.2) / CAMERAS, 0.1, SIZE, SIZE)
        camera.name = f"cam{c}"
        cameras.append(camera)
    return cameras


def silhouette(camera: d.Camera, t: float) -> np.ndarray:
    mesh = person(t)
    return d.rasterize(mesh.vertices, mesh.faces, camera)[0] >= 0


def silhouettes(camera: d.Camera, offset: float = 0.0, fps: float = FPS, seconds: float = SECONDS) -> np.ndarray:
    """(T, H, W) bool of a camera that begins at `offset` s."""
    return np.stack([silhouette(camera, offset + k / fps) for k in range(round(seconds * fps))])


def picture(mask: np.ndarray) -> np.ndarray:
    frame = np.empty((*mask.shape, 3), np.uint8)
    frame[:] = GREEN
    frame[mask] = (60, 70, 200)
    return frame


def film(path, masks, fps=FPS) -> None:
    with VideoWriter(path, masks.shape[2], masks.shape[1], fps) as video:
        for mask in masks:
            video.write(picture(mask))


def ffmpeg(*arguments) -> None:
    subprocess.run(["ffmpeg", "-loglevel", "error", "-y", *map(str, arguments)], check=True)


def add_sound(path, offset: float, seconds: float, seed: int, late: float = 0.0) -> None:
    """The same clicks and knocks for all, as a camera hears them that begins at `offset`, in noise of its own; the track begins
    `late` s after the pictures."""
    rate = 16000
    noise = np.random.default_rng(seed).normal(0, 0.01, round(seconds * rate))
    t = np.arange(len(noise)) / rate + offset
    for at in (0.45, 0.93, 1.12, 1.9, 2.23, 2.71, 3.37, 3.8):
        noise += 0.6 * np.exp(-np.maximum(t - at, 0) / 0.02) * (t >= at) * np.sin(2 * np.pi * 900 * (t - at))
    write_sound(path, noise[round(late * rate) :], rate, late)


def write_sound(path, samples, rate, late) -> None:
    with wave.open(str(path.with_suffix(".wav")), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(rate)
        file.writeframes((np.clip(samples, -1, 1) * 32767).astype("<i2").tobytes())
    heard = path.with_name(f"heard_{path.name}")
    ffmpeg("-i", path, "-itsoffset", late, "-i", path.with_suffix(".wav"), "-c:v", "copy", "-c:a", "aac", heard)
    heard.replace(path)
    path.with_suffix(".wav").unlink()


class World:
    """Videos of synchronous cameras, filmed once, and their calibration."""

    def __init__(self, folder):
        self.folder, self.rig = folder, rig()
        self.masks = [silhouettes(camera) for camera in self.rig]
        for camera, masks in zip(self.rig, self.masks):
            film(folder / "videos" / f"{camera.name}.mp4", masks)
        d.write_calibration(folder / "calibration.yml", self.rig)


@pytest.fixture(scope="module")
def world(tmp_path_factory):
    return World(tmp_path_factory.mktemp("world"))


@pytest.fixture
def home(world, tmp_path):
    """A folder of the test's own with videos/ and calibration.yml."""
    shutil.copytree(world.folder, tmp_path, dirs_exist_ok=True)
    return tmp_path


def call(home, *more, videos=("videos",), status=0) -> None:
    arguments = ["new-session", *(str(home / v) for v in videos), "--calibration", str(home / "calibration.yml")]
    assert main([*arguments, "-o", str(home / "new"), "--quiet", *map(str, more)]) == status


def refused(home, capsys, *more, videos=("videos",)) -> str:
    """One sentence, and nothing is left."""
    before = {path.name for path in home.iterdir()}
    capsys.readouterr()
    call(home, *more, videos=videos, status=1)
    assert {path.name for path in home.iterdir()} == before
    said = capsys.readouterr().err.strip()
    assert said.startswith("doublet: ") and "\n" not in said and "internal error" not in said and ".part" not in said, said
    return said


def shown(frames: d.FrameSource, camera: int, frame: int) -> np.ndarray:
    image = frames.image(camera, frame).astype(int)
    return image[..., 2] > image[..., 1]


def overlap(a, b) -> float:
    return (a & b).sum() / (a | b).sum()


# --- the whole command


def test_a_session_that_the_other_commands_accept(home, capsys):
    call(home)
    said = capsys.readouterr().out
    session = d.Session(home / "new")
    assert session.fps == FPS and session.frame_count == SECONDS * FPS and session.name == "new"
    assert [camera.name for camera in session.cameras] == [f"cam{c}" for c in range(CAMERAS)]
    assert not session.scan.name and not session.markers.name
    assert "key colour" in said and "as they were filmed: cam0, cam1, cam2, cam3" in said and "doublet scan" in said
    for c in range(CAMERAS):  # nothing had to change: the same file
        assert (home / "new" / "videos" / f"cam{c}.mp4").samefile(home / "videos" / f"cam{c}.mp4")
    assert Image.open(home / "new" / PICTURE).size == (CAMERAS * 500, SIZE)
    assert main(["check", str(home / "new"), "-o", str(home / "out"), "--quiet"]) == 0
    assert main(["reconstruct", str(home / "new"), "-o", str(home / "out"), "--quiet"]) == 1
    assert "doublet scan" in capsys.readouterr().err


def test_copies_are_copies_and_names_are_taken(home):
    (home / "me.ply").write_bytes(b"")
    d.write_mesh(home / "me.ply", person(0))
    mark = {"joints": {"pelvis": {"position": [0, 1, 0], "parent": None, "dof": 6}}}
    (home / "marks.json").write_text(json.dumps(mark), encoding="utf-8")
    more = ("--sync", "none", "--copy", "--name", "jump", "--scan", home / "me.ply", "--joints", home / "marks.json")
    call(
        home,
        *more,
        "--start",
        0.5,
        "--frames",
        20,
        "--without",
        "cam3",
        videos=[f"videos/cam{c}.mp4" for c in range(3)],
        status=3,
    )
    session = d.Session(home / "new")
    assert session.name == "jump" and session.frame_count == 20 and len(session.rig) == 3
    assert session.scan.name == "scan.ply" and session.markers.name == "joints.json"
    assert overlap(shown(d.FrameSource.open(session), 1, 0), silhouette(session.rig[1], 0.5)) > 0.9
    call(home, "--sync", "none", "--copy", "--force")
    assert not (home / "new" / "videos" / "cam0.mp4").samefile(home / "videos" / "cam0.mp4")
    assert not (home / "new" / "scan.ply").exists()


# --- when


OFFSETS = (0.0, 0.31, -0.12, 0.213)  # s at which cameras begin; no whole frames


def shifted(home, world, rates=(FPS,) * CAMERAS):
    for camera, offset, fps in zip(world.rig, OFFSETS, rates):
        film(home / "videos" / f"{camera.name}.mp4", silhouettes(camera, offset, fps), fps)


def frames_late(session, camera: int) -> int:
    """By how many frames what a camera shows comes after the common time, which begins with the last camera."""
    frames, fits = d.FrameSource.open(session), dict.fromkeys(range(-2, 3), 0.0)
    for frame in range(4, session.frame_count - 4, 5):
        seen = shown(frames, camera, frame)
        for late in fits:
            fits[late] += overlap(seen, silhouette(session.rig[camera], max(OFFSETS) + (frame - late) / session.fps))
    return max(fits, key=fits.get)


def sources(home):
    return [read_video(home / "videos" / f"cam{c}.mp4") for c in range(CAMERAS)]


def test_sound_tells_offsets_to_half_a_frame(home, world):
    shifted(home, world)
    for c in range(CAMERAS):
        add_sound(home / "videos" / f"cam{c}.mp4", OFFSETS[c], SECONDS, c, late=0.25 if c == 1 else 0)
    signals = [synchronise.sound_signal(video) for video in sources(home)]
    clear, apart = synchronise.SOUND_CLEAR, synchronise.SOUND_APART
    found = synchronise.find_offsets(signals, clear, apart, 0.5 / FPS, list("abcd"))
    assert found.trusted, found.reason
    np.testing.assert_allclose(found.seconds, OFFSETS, atol=0.5 / FPS)
    call(home)  # sound comes first
    session = d.Session(home / "new")
    assert session.frame_count == pytest.approx((SECONDS + min(OFFSETS) - max(OFFSETS)) * FPS, abs=1)
    for c in range(CAMERAS):
        assert frames_late(session, c) == 0
        assert session.cameras[c].video.samefile(home / "videos" / f"cam{c}.mp4")  # as it was filmed
    assert [camera.first_frame for camera in session.cameras] == [round((max(OFFSETS) - o) * FPS) for o in OFFSETS]


@pytest.mark.parametrize("ready", [False, True])
def test_silhouettes_tell_offsets_to_a_frame(home, world, ready):
    shifted(home, world)
    if ready:
        signals = [
            synchronise.mask_signal(np.arange(SECONDS * FPS) / FPS, silhouettes(camera, offset))
            for camera, offset in zip(world.rig, OFFSETS)
        ]
    else:
        signals = [synchronise.video_signal(video) for video in sources(home)]
    clear, apart = synchronise.SIGHT_CLEAR, synchronise.SIGHT_APART
    found = synchronise.find_offsets(signals, clear, apart, 1 / FPS, list("abcd"))
    assert found.trusted, found.reason
    np.testing.assert_allclose(found.seconds, OFFSETS, atol=1 / FPS)


def test_cameras_of_other_rates_show_the_nearest_frame(home, world, capsys):
    shifted(home, world, (30.0, 25.0, 50.0, 30.0))
    call(home, "--offset", *(f"cam{c}={offset}" for c, offset in enumerate(OFFSETS)))
    said = capsys.readouterr().out
    assert "25 frames a second, the nearest frame of cameras of another rate: cam0 (30), cam2 (50), cam3 (30)" in said
    assert "cam1: began at +0.310 s on the common clock (given)" in said
    session = d.Session(home / "new")
    assert session.fps == 25
    for c in range(CAMERAS):
        assert frames_late(session, c) == 0


def test_nobody_moves_so_nothing_is_told(home, world, capsys):
    for c in range(CAMERAS):
        film(home / "videos" / f"cam{c}.mp4", np.stack([world.masks[c][0]] * 40))
    call(home, status=3)
    said = capsys.readouterr().err
    assert "doubtful: synchronisation: expected videos that tell by how much they are apart" in said and "--offset" in said
    assert d.Session(home / "new").frame_count == 40


def test_a_single_frame_tells_no_time(home, world, capsys):
    for c in range(CAMERAS):
        film(home / "videos" / f"cam{c}.mp4", world.masks[c][:1])
    assert "expected a frame rate above 0, found none in a single frame; give it: --fps" in refused(home, capsys)
    call(home, "--fps", 30, status=3)
    assert d.Session(home / "new").frame_count == 1


def test_a_clock_may_begin_anywhere(home):
    """Camcorders begin at 1.4 s, and offsets are those of the first frames."""
    ffmpeg("-i", home / "videos/cam1.mp4", "-c", "copy", "-output_ts_offset", "1.4", home / "videos/cam1.mkv")
    (home / "videos/cam1.mp4").unlink()
    call(home, "--sync", "none")
    session = d.Session(home / "new")
    assert session.frame_count == SECONDS * FPS and (home / "new/videos/cam1.mkv").samefile(home / "videos/cam1.mkv")


def test_a_beat_is_no_clear_sound():
    """Every beat is like the next: a peak as high half a second away."""
    steps = np.arange(3000)
    beats = (steps % 250 < 5).astype(float)
    a = synchronise.Signal(synchronise.standardised(beats[None]), 0.002, 0.0)
    b = synchronise.Signal(synchronise.standardised(np.roll(beats, 60)[None]), 0.002, 0.0)
    assert not synchronise.find_offsets([a, b], synchronise.SOUND_CLEAR, synchronise.SOUND_APART, 0.01, ["a", "b"]).trusted


def test_a_wrong_pair_does_not_move_the_others():
    true = np.array([0, 0.3, -0.2, 0.5])
    peaks = {(i, j): synchronise.Peak(true[j] - true[i], 0.8, 0.2) for i in range(4) for j in range(i + 1, 4)}
    peaks[1, 3] = synchronise.Peak(-1.7, 0.9, 0.2)
    np.testing.assert_allclose(synchronise.solve(4, peaks, 0.02), true, atol=1e-9)


def test_cameras_that_may_be_synchronous_stay_so(world):
    """Not a few milliseconds apart, so that videos need not be coded anew."""
    signals = [synchronise.mask_signal(np.arange(len(masks)) / FPS, masks) for masks in world.masks]
    clear, apart = synchronise.SIGHT_CLEAR, synchronise.SIGHT_APART
    found = synchronise.find_offsets(signals, clear, apart, 1 / FPS, list("abcd"))
    assert found.trusted and not found.seconds.any(), found.reason


def test_frames_of_the_common_time():
    times = [np.arange(10) / 10, np.arange(20) / 20]
    numbers = synchronise.frame_numbers(times, [0.2, 0.0], 10)
    np.testing.assert_array_equal(numbers, [range(8), range(4, 20, 2)])
    np.testing.assert_array_equal(synchronise.frame_numbers(times, [0.2, 0.0], 10, 0.3, 2), [[3, 4], [10, 12]])
    uneven = [np.array([0, 0.1, 0.19, 0.31, 0.52])]  # a phone's clock
    np.testing.assert_array_equal(synchronise.frame_numbers(uneven, [0.0], 10), [[0, 1, 2, 3, 3, 4]])


# --- the images' size and side


def lay_down(path, masks) -> None:
    """Turned images, and a container that says how players turn them back (in a direction that depends on ffmpeg's version)."""
    turned = path.with_name("turned.mp4")
    ffmpeg("-i", path, "-c", "copy", "-metadata:s:v:0", "rotate=90", turned)
    film(path, np.rot90(masks, -read_video(turned).rotation // 90, axes=(1, 2)))
    ffmpeg("-i", path, "-c", "copy", "-metadata:s:v:0", "rotate=90", turned)
    turned.replace(path)


def test_what_lay_on_its_side_is_upright(home, world):
    tall = [camera.resized(SIZE, 2 * SIZE) for camera in world.rig]
    d.write_calibration(home / "calibration.yml", tall)
    for c, camera in enumerate(tall):
        path = home / "videos" / f"cam{c}.mp4"
        masks = silhouettes(camera, seconds=1)
        film(path, masks)
        if c == 0:
            lay_down(path, masks)
            assert read_video(path).rotation % 180 == 90 and read_video(path).size == (SIZE, 2 * SIZE)
    call(home, "--sync", "none")
    session = d.Session(home / "new")
    assert (home / "new" / "videos" / "cam1.mp4").samefile(home / "videos" / "cam1.mp4")
    assert read_video(home / "new" / "videos" / "cam0.mp4").rotation == 0
    assert overlap(shown(d.FrameSource.open(session), 0, 5), silhouette(tall[0], 5 / FPS)) > 0.9


def test_a_calibration_of_larger_images_is_scaled(home, world, capsys):
    d.write_calibration(home / "calibration.yml", [camera.resized(2 * SIZE, 2 * SIZE) for camera in world.rig])
    call(home)
    assert "cam0: calibration of 192 x 192 scaled by 0.5" in capsys.readouterr().out
    for read, camera in zip(d.Session(home / "new").rig, world.rig):
        np.testing.assert_allclose(read.K, camera.K, atol=1e-9)


def test_a_squeezed_video_needs_a_word(home, world, capsys):
    d.write_calibration(home / "calibration.yml", [camera.resized(SIZE + 6, SIZE) for camera in world.rig])
    said = refused(home, capsys)
    assert "cam0.mp4: expected 102 x 96 pixels" in said and "found 96 x 96" in said and "--scale-calibration" in said
    call(home, "--scale-calibration")
    np.testing.assert_allclose(d.Session(home / "new").rig[0].K, world.rig[0].K, atol=1e-9)


def test_a_series_of_images_is_a_video(home, world):
    for c, masks in enumerate(world.masks):
        folder = home / "frames" / f"cam{c}"
        folder.mkdir(parents=True)
        for k, mask in enumerate(masks[:12]):
            Image.fromarray(picture(mask)[..., ::-1]).save(folder / f"frame{k + 7}.png")
    call(home, "--sync", "none", "--fps", 30, "--start", 0.1, videos=["frames"])
    session = d.Session(home / "new")
    assert session.frame_count == 9
    np.testing.assert_array_equal(shown(d.FrameSource.open(session), 2, 0), world.masks[2][3])


# --- masks and clean plates


def save_masks(folder, masks, kind) -> None:
    folder.mkdir(parents=True)
    for k, mask in enumerate(masks):
        if kind == "alpha":
            rgba = np.dstack([picture(mask)[..., ::-1], 255 * mask.astype(np.uint8)])
            image = Image.fromarray(rgba)
        elif kind == "palette":
            image = Image.fromarray(3 * mask.astype(np.uint8))
            image.putpalette([0, 0, 0, 9, 9, 9, 5, 5, 5, 60, 0, 0])
        else:
            image = Image.fromarray({"grey": 255, "numbers": 2}[kind] * mask.astype(np.uint8))
        image.save(folder / f"{k:05d}.png")


@pytest.mark.parametrize("kind", ["alpha", "palette", "numbers", "grey", "video"])
def test_masks_of_any_tool(home, world, kind):
    for c, masks in enumerate(world.masks):
        if kind == "video":
            with VideoWriter(home / "masks" / f"cam{c}_alpha.mp4", SIZE, SIZE, FPS) as video:
                for mask in masks:
                    video.write(np.repeat(255 * mask.astype(np.uint8)[..., None], 3, axis=2))
        else:
            save_masks(home / "masks" / f"cam{c}", masks, kind)
    call(home, "--masks", home / "masks", "--offset", "cam0=0", "cam1=0.2", "cam2=0", "cam3=0", "--frames", 5)
    frames = d.FrameSource.open(d.Session(home / "new"))
    for camera, first in ((0, 6), (1, 0), (3, 6)):
        assert overlap(frames.mask(camera, 2) > 0, world.masks[camera][first + 2]) > (0.95 if kind == "video" else 0.999)


def test_clean_plates(home, world):
    (home / "plates").mkdir()
    for c in range(CAMERAS - 1):
        Image.fromarray(picture(np.zeros((SIZE, SIZE), bool))[..., ::-1]).save(home / "plates" / f"cam{c}.png")
    film(home / "plates" / "cam3.mp4", np.zeros((6, SIZE, SIZE), bool))
    call(home, "--background", home / "plates")
    session = d.Session(home / "new")
    plate = np.asarray(Image.open(session.cameras[3].background)).astype(int)
    assert np.abs(plate - GREEN[::-1]).max() < 12


@pytest.mark.parametrize(
    ("spoil", "expected"),
    [
        (lambda masks: masks[:-1], "expected 120 masks, one for each frame of the video, found 119"),
        (lambda masks: masks[:, ::2], "expected masks of 96 x 96 pixels as the video has, found 96 x 48"),
        (lambda masks: 0 * masks, "found black ones, all 120"),
        (lambda masks: ~masks, "are they inverted?"),
        (lambda masks: masks | True, "found white ones"),
        (lambda masks: masks & (np.arange(120) % 7 > 0)[:, None, None], "found nothing in 18 of 120, with 16 gaps"),
        (lambda masks: masks & (np.arange(120) > 70)[:, None, None], "found nothing in 71 of 120"),
    ],
)
def test_masks_that_cannot_be_true(home, world, capsys, spoil, expected):
    for c, masks in enumerate(world.masks):
        save_masks(home / "masks" / f"cam{c}", spoil(masks) if c == 2 else masks, "grey")
    said = refused(home, capsys, "--masks", home / "masks", "--sync", "none")
    assert "masks/cam2" in said and expected in said, said


# --- which file is which camera


def names(cameras, files, given=None):
    found = match(cameras, [CameraFile(f.rpartition(".")[0], new_session.Path(f)) for f in files], given)
    return [str(found[camera].path) for camera in cameras]


@pytest.mark.parametrize(
    ("cameras", "files"),
    [
        (["cam0", "cam1"], ["cam0.mp4", "cam1.mov"]),
        (["cam01", "cam02"], ["01.mp4", "02.mp4"]),  # what a calibration makes of 01
        (["cam1", "cam10"], ["take3_cam1_b.mp4", "take3_cam10_b.mp4"]),
        (["left", "right"], ["Dance-Left.mp4", "Dance-Right.mp4"]),
        (["int_cam01_img", "int_cam02_img"], ["cam01.mp4", "cam02.mp4"]),
        (["c7", "c12"], ["view_007.mp4", "view_012.mp4"]),  # only the numbers agree
        (["cam11139", "cam9140"], ["Walk1_Miqus_1_11139.avi", "Walk1_Miqus_2_9140.avi"]),  # serial numbers, as QTM has them
        (["a", "b", "c"], ["cam_a.mp4", "cam_b.mp4", "cam_c.mp4"]),
    ],
)
def test_names_tell(cameras, files):
    assert names(cameras, files) == files
    assert names(cameras, files[::-1]) == files


@pytest.mark.parametrize(
    ("cameras", "files", "expected"),
    [
        (["cam0", "cam1"], ["cam0.mp4"], "none for cam1 among cam0.mp4; leave cameras out: --without NAME"),
        (["cam0"], ["cam0.mp4", "other.mp4"], "found other.mp4 beside those of cam0"),
        (
            ["cam0", "cam1"],
            ["GX1.mp4", "GX2.mp4"],
            "none for cam0, cam1, and GX1.mp4, GX2.mp4, whose camera is not clear; say which is which: --camera NAME=FILE",
        ),
        (["cam0"], ["cam0.mp4", "cam0.mov"], "camera 'cam0': expected one video, found cam0.mp4, cam0.mov"),
    ],
)
def test_names_that_do_not_tell(cameras, files, expected):
    with pytest.raises(ValueError, match="expected") as error:
        names(cameras, files)
    assert expected in str(error.value)


def test_a_camera_may_be_named(home):
    for c, name in enumerate(("north", "east", "south", "west")):
        (home / "videos" / f"cam{c}.mp4").rename(home / "videos" / f"{name}.mp4")
    pairs = [f"cam{c}={home / 'videos' / name}.mp4" for c, name in enumerate(("west", "south", "east", "north"))]
    call(home, "--sync", "none", "--camera", *pairs)
    assert (home / "new" / "videos" / "cam0.mp4").samefile(home / "videos" / "west.mp4")


def test_a_file_of_a_camera_may_be_called_by_any_way_to_it(tmp_path, monkeypatch):
    """By its name in the folder, from here, from the root, through a link; with a calibration and without."""
    for name in ("left", "right"):
        (tmp_path / "videos" / f"{name}.mp4").parent.mkdir(exist_ok=True)
        (tmp_path / "videos" / f"{name}.mp4").write_bytes(b"")
    (tmp_path / "link").symlink_to("videos")
    monkeypatch.chdir(tmp_path)
    files = list_files([Path("videos")])
    for start in ("", "videos/", "videos/../videos/", f"{tmp_path}/videos/", "link/"):
        given = {"a": Path(f"{start}right.mp4"), "b": Path(f"{start}left.mp4")}
        found = match(["a", "b"], files, given)
        assert {name: file.path.name for name, file in found.items()} == {"a": "right.mp4", "b": "left.mp4"}
        assert names_of(files, Request([Path("videos")], None, tmp_path / "new", cameras=given)) == ["b", "a"]


# --- what is refused


def truncate(path, share=0.6):
    path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])


def spoilt(name, content):
    return lambda home: (home / name).write_bytes(content)


@pytest.mark.parametrize(
    ("spoil", "more", "expected"),
    [
        (lambda home: shutil.rmtree(home / "videos"), (), "videos: no such file or folder"),
        (lambda home: [p.unlink() for p in (home / "videos").iterdir()], (), "videos: expected videos or images in the folder"),
        (spoilt("videos/cam1.mp4", b"no video at all"), (), "videos/cam1.mp4: expected a complete video file"),
        (lambda home: truncate(home / "videos/cam2.mp4"), (), "videos/cam2.mp4: expected"),
        (lambda home: shutil.copy(home / "videos/cam0.mp4", home / "videos/cam0.mov"), (), "camera 'cam0': expected one video"),
        (lambda home: (home / "videos/cam3.mp4").unlink(), (), "none for cam3 among"),
        (
            lambda home: shutil.copy(home / "videos/cam0.mp4", home / "videos/cat.mp4"),
            (),
            "cat.mp4 beside those of cam0, cam1, cam2, cam3",
        ),
        (spoilt("calibration.yml", b"nothing"), (), "calibration.yml: "),
        (lambda home: None, ("--offset", "cam2=100"), "found that camera cam2 begins 96.03 s after camera cam0 ended"),
        (lambda home: None, ("--offset", "cam9=1"), "--offset cam9: expected one of the calibration's cameras cam0, cam1"),
        (lambda home: None, ("--without", "cam9"), "--without cam9: expected one of"),
        (lambda home: None, ("--camera", "cam9=a.mp4"), "--camera cam9=a.mp4: expected one of"),
        (lambda home: None, ("--sync", "sound"), "cam0.mp4: expected a sound track as --sync sound needs, found none"),
        (lambda home: None, ("--fps", "0"), "--fps: expected frames a second above 0, found 0"),
        (lambda home: None, ("--sync", "none", "--start", "9"), "--start: expected 0 to 3.97 s"),
        (lambda home: None, ("--sync", "none", "--frames", "999"), "--frames: expected 1 to 120"),
        (lambda home: None, ("--sync", "none", "--scan", "none.ply"), "none.ply: no such file"),
        (lambda home: (home / "new").mkdir() or (home / "new/letter").write_text("dear"), ("--force",), "found something else"),
        (
            lambda home: shutil.copytree(home / "videos", home / "new") and (home / "new/session.json").write_text(""),
            (),
            "--force",
        ),
    ],
)
def test_bad_input_is_a_sentence(home, capsys, spoil, more, expected):
    spoil(home)
    assert expected in refused(home, capsys, *more)


def test_a_video_that_is_damaged_within(home, capsys):
    """Found late, while it is written: nothing is left."""
    path = home / "videos/cam1.mp4"
    data = bytearray(path.read_bytes())
    start = data.rindex(b"mdat") + 4
    data[start + 400 :] = bytes(len(data) - start - 400)
    path.write_bytes(data)
    assert "videos/cam1.mp4: " in refused(home, capsys, "--sync", "none", "--start", "0.2")


def test_stopped_half_way_leaves_nothing(home, monkeypatch, capsys):
    def stop(self, picture):
        raise KeyboardInterrupt

    monkeypatch.setattr(VideoWriter, "write", stop)
    call(home, "--sync", "none", "--fps", "15", status=130)
    assert "stopped; nothing was written" in capsys.readouterr().err
    assert not (home / "new").exists() and not list(home.glob(".*"))


def test_force_keeps_the_old_one_until_the_new_one_is_whole(home, capsys):
    call(home, "--sync", "none")
    assert "--force" in refused(home, capsys, "--sync", "none")
    assert "--frames" in refused(home, capsys, "--sync", "none", "--force", "--frames", "999")
    assert d.Session(home / "new").frame_count == 120
    call(home, "--sync", "none", "--force", "--frames", 7)
    assert d.Session(home / "new").frame_count == 7


def test_commands_that_are_printed_can_be_pasted(tmp_path, monkeypatch, capsys):
    folder = tmp_path / "my session #1"
    monkeypatch.setattr(command, "new_session", lambda request, console: new_session.NewSession(folder, [], []))
    monkeypatch.setattr(command, "d", SimpleNamespace(Session=lambda folder: SimpleNamespace(scan=Path(), markers=Path())))
    assert main(["new-session", "videos", "--calibration", "c.yml", "-o", str(folder)]) == 0
    said = [line for line in capsys.readouterr().out.splitlines() if line.startswith("next: ")]
    commands = [shlex.split(text, comments=True) for line in said for text in line.split("doublet ")[1:]]
    assert [words[:2] for words in commands] == [[name, str(folder)] for name in ("scan", "check", "reconstruct")]


def test_files_inside_of_the_new_session_stay_whatever_it_is_called(home, capsys, monkeypatch):
    """In their place it would come, and they would be gone."""
    call(home, "--sync", "none", "--copy")
    (home / "link").symlink_to("new")
    monkeypatch.chdir(home / "new")
    for out in (home / "new", home / "link", "../new", "."):
        given = ["videos", "--calibration", "calibration.yml", "--sync", "none", "--frames", "3", "--force"]
        assert main(["new-session", *given, "-o", str(out), "--quiet"]) == 1
        assert "expected files outside of the new session" in capsys.readouterr().err
    assert d.Session(home / "new").frame_count == 120


def test_check_of_masks_that_show_nothing(home, world, capsys):
    """Found by `check`, in words."""
    for c, masks in enumerate(world.masks):
        save_masks(home / "masks" / f"cam{c}", masks[:9], "grey")
        film(home / "videos" / f"cam{c}.mp4", masks[:9])
    call(home, "--masks", home / "masks", "--sync", "none")
    for path in (home / "new" / "masks" / "cam1").iterdir():
        Image.new("L", (SIZE, SIZE)).save(path)
    assert main(["check", str(home / "new"), "-o", str(home / "out"), "--quiet"]) == 1
    said = capsys.readouterr().err
    assert "camera cam1: expected masks that show a person, found nothing in 5 of the 5" in said and "internal" not in said


def test_in_python(home):
    made = new_session.new_session(Request([home / "videos"], home / "calibration.yml", home / "new", sync="none"))
    assert made.findings == [] and d.Session(made.folder).frame_count == 120
