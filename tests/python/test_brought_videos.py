"""Videos, series of images and masks as people have them: what a container says wrongly, frames that were dropped, files that
were trimmed without coding them anew, alpha channels, palettes in any order, key points that are not there. Every picture shows
its number by where a bar stands."""

import json
import runpy
import shutil
import struct
import subprocess
import sys
from pathlib import Path

import doublet as d
import numpy as np
import pytest
from doublet.common.images import ImageSeries, counted, in_order
from doublet.common.video import VideoFile, rate_of, read_video
from doublet.session.external_masks import read_masks
from doublet.session.keypoints import CameraKeypoints, joints_of, read_keypoints
from doublet.session.new_session import Request, new_session
from PIL import Image, ImageFilter

ROOT = Path(__file__).parents[2]
WIDTH, HEIGHT, CAMERAS = 160, 120, 2


def picture(number: int) -> np.ndarray:
    """RGB: a red bar whose left edge says the number."""
    image = np.full((HEIGHT, WIDTH, 3), (40, 170, 60), np.uint8)
    image[::7] = (30, 150, 50)
    image[20:100, 10 + 2 * number : 22 + 2 * number] = (220, 40, 50)
    return image


def number_in(image: np.ndarray) -> int | None:
    """Of an image of the library, B G R."""
    if image.size == 0:
        return None
    bar = np.argwhere(image[..., 2].astype(int) > image[..., 1])
    return round((bar[:, 1].mean() - 15.5) / 2)


def rig() -> list:
    cameras = [d.orbit_camera(np.array([0, 1.0, 0]), 1.25, c, 0.1, WIDTH, HEIGHT) for c in range(CAMERAS)]
    for c, camera in enumerate(cameras):
        camera.name = f"cam{c}"
    return cameras


def ffmpeg(*arguments, data=b"") -> None:
    subprocess.run(["ffmpeg", "-loglevel", "error", "-y", *map(str, arguments)], check=True, input=data)


def film(path: Path, numbers, *codec, rate=25) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{WIDTH}x{HEIGHT}", "-r", rate, "-i", "-"]
    ffmpeg(*raw, *(codec or ("-c:v", "libx264", "-bf", 2, "-g", 10)), path, data=b"".join(picture(n).tobytes() for n in numbers))


def session_of(folder: Path, messages=None, **more):
    d.write_calibration(folder / "calibration.yml", rig())
    request = Request([folder / "films"], folder / "calibration.yml", folder / "new", sync="none", **more)
    made = new_session(request)
    if messages is not None:
        messages += made.messages
    return d.FrameSource.open(d.Session(folder / "new"))


def shown(frames) -> list[list]:
    return [[number_in(np.asarray(frames.image(c, t))) for t in range(frames.frame_count)] for c in range(CAMERAS)]


# --- containers


def mjpeg_avi(path: Path, numbers, dropped=(), stated=None) -> None:
    """As a recorder writes it: a chunk without bytes for a frame that it dropped, a number of frames that it meant to film."""
    film(path, numbers, "-c:v", "mjpeg", "-q:v", 2, "-pix_fmt", "yuvj444p")
    data = bytearray(path.read_bytes())
    movi, index = data.index(b"movi") - 8, data.rindex(b"idx1")
    chunks, at = [], movi + 12
    while data[at : at + 4] == b"00dc":
        length = struct.unpack_from("<I", data, at + 4)[0]
        chunks.append(bytes(data[at + 8 : at + 8 + length]))
        at += 8 + length + length % 2
    body, entries = b"movi", b""
    for k, chunk in enumerate(chunks):
        chunk = b"" if k in dropped else chunk
        entries += struct.pack("<4sIII", b"00dc", 16, len(body), len(chunk))
        body += struct.pack("<4sI", b"00dc", len(chunk)) + chunk + b"\0" * (len(chunk) % 2)
    assert index > movi
    out = bytes(data[:movi]) + struct.pack("<4sI", b"LIST", len(body)) + body
    out = bytearray(out + struct.pack("<4sI", b"idx1", len(entries)) + entries)
    struct.pack_into("<I", out, 4, len(out) - 8)
    if stated:
        struct.pack_into("<I", out, out.index(b"avih") + 8 + 16, stated)
        struct.pack_into("<I", out, out.index(b"strh") + 8 + 32, stated)
    path.write_bytes(out)


def test_an_avi_that_says_more_frames_than_it_has(tmp_path):
    mjpeg_avi(tmp_path / "films/cam0.avi", range(20), stated=23)
    mjpeg_avi(tmp_path / "films/cam1.avi", range(20))
    assert shown(session_of(tmp_path)) == [list(range(20))] * 2


def test_an_avi_that_was_cut_off_is_refused(tmp_path):
    mjpeg_avi(tmp_path / "films/cam0.avi", range(20))
    mjpeg_avi(tmp_path / "films/cam1.avi", range(20))
    path = tmp_path / "films/cam0.avi"
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(RuntimeError, match=r"cam0\.avi: expected 20 frames as the file says, found \d+; it is truncated"):
        session_of(tmp_path)


def test_a_video_without_a_frame_is_named(tmp_path):
    mjpeg_avi(tmp_path / "films/cam0.avi", range(5), dropped=range(5))
    mjpeg_avi(tmp_path / "films/cam1.avi", range(5))
    with pytest.raises(RuntimeError, match=r"cam0\.avi: expected a video, found no pictures in it"):
        session_of(tmp_path)
    with pytest.raises(RuntimeError, match=r"cam0\.avi: expected a video, found no pictures in it"):
        read_masks(tmp_path / "films/cam0.avi")


def test_dropped_frames_shift_nothing_that_follows(tmp_path):
    mjpeg_avi(tmp_path / "films/cam0.avi", range(20), dropped=(6, 13))
    mjpeg_avi(tmp_path / "films/cam1.avi", range(20))
    messages = []
    frames = session_of(tmp_path, messages)
    cam0, cam1 = shown(frames)
    assert frames.frame_count == 20 and cam1 == list(range(20))
    assert [n for k, n in enumerate(cam0) if k not in (6, 13)] == [k for k in range(20) if k not in (6, 13)]
    assert cam0[6] in (5, 7) and cam0[13] in (12, 14)
    assert "cam0: 2 frames are shown twice, it has fewer" in messages


def test_an_uneven_clock_with_a_pause_keeps_its_rate(tmp_path):
    film(tmp_path / "films/cam1.mp4", range(25))
    film(tmp_path / "all.mp4", range(25))
    keep = "select='not(eq(n,8)+eq(n,9))',setpts='PTS+0.2*sin(N)/25/TB*0.5'"
    ffmpeg("-i", tmp_path / "all.mp4", "-vf", keep, "-vsync", "vfr", "-enc_time_base", "1/10000", "-video_track_timescale", 10000,
           tmp_path / "films/cam0.mp4")  # fmt: skip
    assert read_video(tmp_path / "films/cam0.mp4").fps == pytest.approx(25, rel=0.01)
    cam0, cam1 = shown(session_of(tmp_path))
    assert cam1 == list(range(25))
    assert [n for k, n in enumerate(cam0) if k not in (8, 9)] == [k for k in range(25) if k not in (8, 9)]


@pytest.mark.parametrize("missing", [[], [12, 13]])
def test_a_clock_that_shakes_neither_slows_nor_shortens_the_take(tmp_path, missing):
    """Its first frame is late, its last one early."""
    shaken = np.arange(30) / 25 + 0.006 * np.cos(np.pi * np.arange(30) / 29)
    stored = [k for k in range(30) if k not in missing]
    film(tmp_path / "all.mp4", stored)
    film(tmp_path / "films/cam1.mp4", range(30))
    when = "+".join(f"eq(N,{n})*{shaken[k]:.6f}" for n, k in enumerate(stored))
    ffmpeg("-i", tmp_path / "all.mp4", "-vf", f"setpts='({when})/TB'", "-vsync", "passthrough", "-enc_time_base", "1/90000",
           "-video_track_timescale", 90000, tmp_path / "films/cam0.mp4")  # fmt: skip
    cam0, cam1 = shown(session_of(tmp_path))
    assert cam1 == list(range(30)) and [cam0[k] for k in stored] == stored


@pytest.mark.parametrize("shake, rate", [(0.3, 25), (2, 25), (8, 25), (0, 25.03), (0.01, 25.03), (2, 30 / 1.001)])
def test_the_rate_of_a_clock_that_shakes(shake, rate):
    """A whole rate only where the times cannot be told from it."""
    frames = np.delete(np.arange(60), [20, 21, 40])
    times = frames / rate + 1e-3 * shake * np.random.default_rng(5).uniform(-1, 1, len(frames))
    assert rate_of(times) == pytest.approx(rate, rel=1e-6 if shake == 0 or rate == 25 else 1e-4)


@pytest.mark.parametrize("form", ["mp4", "mov", "mkv", "ts.mts", "avi"])
def test_what_was_trimmed_without_coding_it_anew(tmp_path, form):
    """Cut between key frames: every picture that can be decoded is counted once, in its order. (AVI has no times: the last
    ones, some of which are cut off, are guessed there.)"""
    film(tmp_path / "whole.mp4", range(40))
    for c in range(CAMERAS):
        target = tmp_path / f"films/cam{c}.{form.split('.')[-1]}"
        target.parent.mkdir(exist_ok=True)
        kind = ["-f", "mpegts"] if form == "ts.mts" else []
        ffmpeg("-ss", 0.52, "-i", tmp_path / "whole.mp4", "-t", 0.8, "-c", "copy", *kind, target)
    video = read_video(tmp_path / f"films/cam0.{form.split('.')[-1]}")
    decoded = [number_in(frame) for frame in video.frames()]
    sure = len(decoded) if form != "avi" else 22
    expected = decoded[0] + np.round(25 * video.times).astype(int)
    assert len(decoded) == len(video.times) >= 18 and decoded[:sure] == expected.tolist()[:sure]
    for numbers in shown(session_of(tmp_path)):
        for t, number in enumerate(numbers[:sure]):
            assert number == decoded[0] + t or (decoded[0] + t not in decoded and abs(number - decoded[0] - t) == 1)


def test_a_stream_that_begins_between_key_frames(tmp_path):
    """A transport stream from a broken-off recorder: what cannot be decoded is no frame."""
    for c in range(CAMERAS):
        film(tmp_path / f"films/cam{c}.mts", range(40), "-c:v", "libx264", "-g", 12, "-bf", 2, "-f", "mpegts")
        path = tmp_path / f"films/cam{c}.mts"
        data = path.read_bytes()
        path.write_bytes(data[:564] + data[len(data) // 3 // 188 * 188 :])
    video = read_video(tmp_path / "films/cam0.mts")
    assert len(list(video.frames())) == len(video.times)
    cam0, cam1 = shown(session_of(tmp_path))
    assert cam0 == cam1 and len(cam0) > 10


@pytest.mark.parametrize("ending", ["ts", "h264"])
def test_streams_of_cameras_are_videos(tmp_path, ending):
    for c in range(CAMERAS):
        film(tmp_path / f"films/cam{c}.{ending}", range(4))
    assert shown(session_of(tmp_path)) == [list(range(4))] * CAMERAS


@pytest.mark.parametrize("ending", ["ppm", "jfif"])
def test_images_of_other_programs_are_images(tmp_path, ending):
    for c in range(CAMERAS):
        save_series(tmp_path / f"films/cam{c}", range(2), form=f"{{:06d}}.{ending}")
    assert shown(session_of(tmp_path, fps=25)) == [[0, 1]] * CAMERAS


def test_pixels_that_are_not_square_squeeze_the_calibration(tmp_path):
    """As HDV has them: 1440 x 1080 that are shown, and were calibrated, as 1920 x 1080. Of a person's cameras it is refused."""
    for c in range(CAMERAS):
        film(tmp_path / f"films/cam{c}.mp4", range(6), "-c:v", "libx264", "-vf", "scale=120:120,setsar=4/3")
    messages = []
    session_of(tmp_path, messages)
    assert any("scaled by 0.75 across, 1 down, as the file says" in message for message in messages)
    for squeezed, camera in zip(d.read_calibration(tmp_path / "new/calibration.yml"), rig()):
        assert (squeezed.camera.width, squeezed.camera.height) == (120, 120)
        across, down = squeezed.project([0.2, 1.1, 0.1])
        x, y = camera.project([0.2, 1.1, 0.1])
        np.testing.assert_allclose([across, down], [0.75 * (x + 0.5) - 0.5, y], atol=1e-3)
    (tmp_path / "seen").mkdir()
    for c in range(CAMERAS):
        (tmp_path / f"seen/cam{c}.json").write_text("[]")
    with pytest.raises(ValueError, match=r"cam0\.mp4: expected square pixels, .* 120 x 120 that is shown as 160 x 120; ffmpeg"):
        new_session(Request([tmp_path / "films"], None, tmp_path / "other", keypoints=tmp_path / "seen"))


@pytest.mark.parametrize("codec", [("libx264", "mp4"), ("mpeg2video", "mts")])
def test_interlaced_video_is_doubtful(tmp_path, codec):
    """As camcorders film: 50 half images a second in 25 frames."""
    name, ending = codec
    for c in range(CAMERAS):
        fields = ["-c:v", name, *(("-vf", "setfield=tff", "-flags", "+ilme+ildct") if c == 1 else ())]
        film(tmp_path / f"films/cam{c}.{ending}", range(6), *fields)
    d.write_calibration(tmp_path / "calibration.yml", rig())
    made = new_session(Request([tmp_path / "films"], tmp_path / "calibration.yml", tmp_path / "new", sync="none"))
    (said,) = [finding.text for finding in made.findings if "interlaced" in finding.text]
    assert said.startswith("cam1: expected whole frames, found interlaced video") and "ffmpeg -i IN -vf bwdif" in said


# --- series of images


def save_series(folder: Path, numbers, form="{:06d}.png", first=101) -> None:
    folder.mkdir(parents=True)
    for n in numbers:
        Image.fromarray(picture(n)).save(folder / form.format(first + n))


@pytest.mark.parametrize("form", ["{:06d}.png", "frame_{}.png", "take2_img{:04d}_left.png", "{}_cam2_1080p.png"])
def test_a_series_with_a_gap_stays_in_step(tmp_path, form):
    save_series(tmp_path / "films/cam0", range(20), form)
    save_series(tmp_path / "films/cam1", [k for k in range(20) if k not in (7, 12, 13)], form)
    messages = []
    cam0, cam1 = shown(session_of(tmp_path, messages, fps=25))
    assert cam0 == list(range(20))
    assert cam1 == [None if k in (7, 12, 13) else k for k in range(20)]
    assert any(m.startswith("cam1: 3 images are missing by their numbers, the first behind ") for m in messages)


def test_a_folder_of_a_camera_holds_one_series(tmp_path):
    """Depth beside colour, a preview: they would be frames, and what follows late."""
    folders = [tmp_path / f"films/cam{c}" for c in range(CAMERAS)]
    for folder in folders:
        save_series(folder, range(3), form="color_{}.png")
    for name in ("depth_101.png", "preview.png"):
        other = Path(shutil.copy(folders[1] / "color_102.png", folders[1] / name))
        with pytest.raises(ValueError, match=rf"cam1: expected the images of one series, found color_101\.png, {name}; put"):
            session_of(tmp_path, fps=25)
        other.unlink()
    for folder in folders:
        (folder / "color_101.png").rename(folder / "color_.png")  # as programs number from the second on
    assert shown(session_of(tmp_path, fps=25)) == [[0, 1, 2]] * CAMERAS


def test_the_images_of_a_series_have_one_size(tmp_path):
    for c in range(CAMERAS):
        save_series(tmp_path / f"films/cam{c}", range(4))
    Image.fromarray(picture(2)[::2, ::2]).save(tmp_path / "films/cam1/000103.png")
    with pytest.raises(
        ValueError, match=r"cam1/000103\.png: expected an image of 160 and 120 pixels as 000101\.png is, found 80 and 60"
    ):
        session_of(tmp_path, fps=25)


def test_what_is_said_of_a_new_session_names_it(tmp_path):
    """And not the folder in which it is made."""
    for c in range(CAMERAS):
        (tmp_path / f"films/cam{c}").mkdir(parents=True)
        for n in range(3):
            Image.new("RGB", (WIDTH, HEIGHT), (200, 30, 30)).save(tmp_path / f"films/cam{c}/{n:04d}.png")
    with pytest.raises(ValueError, match=f"^{tmp_path}/new: camera 'cam0' shows nothing in any of the frames looked at"):
        session_of(tmp_path, fps=25)


def test_of_16_bits_the_upper_eight_are_seen(tmp_path):
    """In clean plates and in what tells when cameras began, as in the frames that the library reads."""
    ramp = np.tile(np.linspace(0, 65535, WIDTH).astype(np.uint16), (HEIGHT, 1))
    for c in range(CAMERAS):
        for folder in ("films", "plates"):
            (tmp_path / folder / f"cam{c}").mkdir(parents=True)
        Image.fromarray(ramp).save(tmp_path / f"plates/cam{c}/plate.png")
        for n in range(2):
            Image.fromarray(ramp).save(tmp_path / f"films/cam{c}/{n}.png")
    frames = session_of(tmp_path, fps=25, background=[tmp_path / "plates"])
    np.testing.assert_array_equal(frames.image(0, 0)[..., 0], ramp >> 8)
    np.testing.assert_array_equal(np.asarray(Image.open(tmp_path / "new/background/cam0.png"))[..., 0], ramp >> 8)
    series = ImageSeries(tmp_path, (tmp_path / "films/cam0/0.png",), 25)
    np.testing.assert_array_equal(next(series.frames(grey=True)), ramp >> 8)


def test_one_format_may_be_spelled_in_several_ways(tmp_path):
    for c in range(CAMERAS):
        save_series(tmp_path / f"films/cam{c}", range(3), form="{:06d}.jpg")
        (tmp_path / f"films/cam{c}/000102.jpg").rename(tmp_path / f"films/cam{c}/000102.JPG")
        (tmp_path / f"films/cam{c}/000103.jpg").rename(tmp_path / f"films/cam{c}/000103.jpeg")
    assert shown(session_of(tmp_path, fps=25)) == [[0, 1, 2]] * CAMERAS
    (tmp_path / "films/cam0/000101.jpg").rename(tmp_path / "films/cam0/000101.png")
    with pytest.raises(ValueError, match=r"cam0: expected images of one format, found \.JPG, \.jpeg, \.png$"):
        session_of(tmp_path, fps=25, force=True)


def test_a_series_that_lost_its_first_images_stays_in_step(tmp_path):
    save_series(tmp_path / "films/cam0", range(20))
    save_series(tmp_path / "films/cam1", range(3, 20))
    cam0, cam1 = shown(session_of(tmp_path, fps=25))
    assert cam0 == cam1 == list(range(3, 20))


def test_every_camera_may_count_for_itself(tmp_path):
    save_series(tmp_path / "films/cam0", range(20), first=0)
    save_series(tmp_path / "films/cam1", range(20), first=7000)
    assert shown(session_of(tmp_path, fps=25)) == [list(range(20))] * 2


@pytest.mark.parametrize("lost", [(7, 12, 13), (0, 1)], ids=["in the middle", "at the beginning"])
def test_images_that_are_named_after_a_clock_stay_in_step(tmp_path, lost):
    """As industrial cameras write them, in nanoseconds, some of which are late."""
    for c, left_out in enumerate(((), lost)):
        folder = tmp_path / f"films/cam{c}"
        folder.mkdir(parents=True)
        for k in (k for k in range(20) if k not in left_out):
            late = (7 * k + 3 * c) % 5 * 1_000_000
            Image.fromarray(picture(k)).save(folder / f"{1_700_000_000_000_000_000 + 40_000_000 * k + late}.png")
    cam0, cam1 = shown(session_of(tmp_path, fps=25))
    first = 2 if 0 in lost else 0
    assert cam0 == list(range(first, 20))
    assert cam1 == [None if k in lost else k for k in range(first, 20)]


@pytest.mark.parametrize(
    "name",
    [
        lambda k: f"{1403636579 + (40 * k + 700) // 1000}.{(40 * k + 700) % 1000:03d}",
        lambda k: f"{1403636579 + (40 * k + 700) / 1000:.9f}".rstrip("0"),
        lambda k: f"12-30-{9 + (40 * k + 700) // 1000}-{(40 * k + 700) % 1000:03d}",
    ],
    ids=["seconds", "seconds without zeros at their ends", "times of the day"],
)
def test_images_that_are_named_after_a_time_are_in_its_order(tmp_path, name):
    for c in range(CAMERAS):
        (tmp_path / f"films/cam{c}").mkdir(parents=True)
        for k in range(20):
            Image.fromarray(picture(k)).save(tmp_path / f"films/cam{c}/{name(k)}.png")
    assert shown(session_of(tmp_path, fps=25)) == [list(range(20))] * 2


def test_images_that_are_named_after_seconds_stay_in_step(tmp_path):
    for c, lost in enumerate(((), (7, 12, 13))):
        (tmp_path / f"films/cam{c}").mkdir(parents=True)
        for k in (k for k in range(20) if k not in lost):
            Image.fromarray(picture(k)).save(tmp_path / f"films/cam{c}/{1403636579.7 + 0.04 * k:.6f}.png")
    cam0, cam1 = shown(session_of(tmp_path, fps=25))
    assert cam0 == list(range(20)) and cam1 == [None if k in (7, 12, 13) else k for k in range(20)]


def test_numbers_that_do_not_count_images():
    assert list(counted(["a_0", "a_2", "a_4", "a_8"])) == [0, 1, 2, 4]  # every second one, and one is missing
    assert list(counted(["1634200000041", "1634200000083", "1634200000124"])) == [0, 1, 2]  # times
    assert list(counted(["1_left", "1_right"])) == [0, 1]
    assert list(counted(["a", "b", "c"])) == [0, 1, 2]
    assert list(counted(["7"])) == [7]
    assert list(counted(["1634200000041", "1634200000083", "1634200000166", "1634200000207"])) == [
        0,
        1,
        3,
        4,
    ]  # times, one missing
    assert list(counted(["3", "5", "100"])) == [0, 1, 2]


@pytest.mark.parametrize(
    "numbers",
    [
        [9997, 9998, 9999, 1, 2],
        [65533, 65535, 0, 1, 2, 3, 4],
        [0, 1, 2, 9997],  # one from another series
        [*range(6000), *range(6001, 10000)],  # one is missing
    ],
    ids=["ten thousand", "two bytes", "another", "whole"],
)
def test_a_counter_that_begins_anew_goes_on(numbers):
    files = [Path(f"IMG_{number:04d}.png") for number in numbers]
    assert in_order(sorted(files)) == files


@pytest.mark.parametrize(
    ("form", "orientation", "stored"),
    [("png", 6, Image.ROTATE_90), ("webp", 3, Image.ROTATE_180), ("tif", 8, Image.ROTATE_270)],
)
def test_images_that_exif_turns_are_shown_upright(tmp_path, form, orientation, stored):
    """The library itself turns JPEGs alone."""
    exif = Image.Exif()
    exif[0x0112] = orientation
    for c in range(CAMERAS):
        (tmp_path / f"films/cam{c}").mkdir(parents=True)
        for n in range(3):
            image = Image.fromarray(picture(n)).transpose(stored)
            image.save(tmp_path / f"films/cam{c}/{n}.{form}", exif=exif, lossless=True)
    messages = []
    assert shown(session_of(tmp_path, messages, fps=25)) == [[0, 1, 2]] * CAMERAS
    assert "coded anew: cam0, cam1" in messages


def test_masks_of_a_series_with_a_gap_are_those_of_its_images(tmp_path):
    for c, numbers in enumerate([range(20), [k for k in range(20) if k != 7]]):
        save_series(tmp_path / f"films/cam{c}", numbers)
        (tmp_path / f"masks/cam{c}").mkdir(parents=True)
        for n in numbers:
            mask = (picture(n)[..., 0] > 100).astype(np.uint8)
            Image.fromarray(255 * mask).save(tmp_path / f"masks/cam{c}/{101 + n:06d}.png")
    frames = session_of(tmp_path, fps=25, masks=[tmp_path / "masks"])
    for t in (6, 8, 15):
        mask = np.asarray(frames.mask(1, t))
        assert (mask > 0).tolist() == (picture(t)[..., 0] > 100).tolist()
    assert np.asarray(frames.mask(1, 7)).size == 0


# --- masks


ACTOR = np.zeros((HEIGHT, WIDTH), bool)
ACTOR[20:100, 40:70] = True


def cut_outs(count=6) -> bytes:
    """RGBA: dark clothes before nothing."""
    frames = b""
    for k in range(count):
        rgba = np.zeros((HEIGHT, WIDTH, 4), np.uint8)
        rgba[..., :3] = 30
        rgba[..., 3] = 255 * np.roll(ACTOR, k, axis=1)
        frames += rgba.tobytes()
    return frames


@pytest.mark.parametrize(
    ("name", "codec"),
    [
        ("a.mov", ("-c:v", "png")),
        ("a.mov", ("-c:v", "qtrle")),
        ("a.mov", ("-c:v", "prores_ks", "-profile:v", "4444", "-pix_fmt", "yuva444p10le")),
        ("a.webm", ("-c:v", "libvpx-vp9", "-pix_fmt", "yuva420p", "-auto-alt-ref", "0")),
        ("a.webm", ("-c:v", "libvpx", "-pix_fmt", "yuva420p", "-auto-alt-ref", "0")),
        ("a.mkv", ("-c:v", "ffv1", "-pix_fmt", "yuva444p")),
        ("a.avi", ("-c:v", "rawvideo", "-pix_fmt", "bgra")),
    ],
    ids=["png", "qtrle", "prores", "vp9", "vp8", "ffv1", "raw"],
)
def test_the_alpha_channel_of_a_video_is_the_mask(tmp_path, name, codec):
    raw = ["-f", "rawvideo", "-pix_fmt", "rgba", "-s", f"{WIDTH}x{HEIGHT}", "-r", 25, "-i", "-"]
    ffmpeg(*raw, *codec, tmp_path / name, data=cut_outs())
    masks = read_masks(tmp_path / name)
    found = list(masks.masks())
    assert masks.kind == "alpha" and len(found) == 6
    for k, mask in enumerate(found):
        actor = np.roll(ACTOR, k, axis=1)
        assert (mask & actor).sum() / (mask | actor).sum() > 0.97
    assert next(masks.masks((WIDTH // 2, HEIGHT // 2))).shape == (HEIGHT // 2, WIDTH // 2)


def test_a_video_of_coloured_parts_shows_all_of_them(tmp_path):
    """Pure red and blue are dark as greys."""
    parts = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    for k, colour in enumerate([(255, 0, 0), (0, 255, 0), (0, 0, 255), (180, 0, 180)]):
        parts[20 + 20 * k : 40 + 20 * k, 40:70] = colour
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{WIDTH}x{HEIGHT}", "-r", 25, "-i", "-"]
    ffmpeg(*raw, "-c:v", "libx264", "-crf", 10, "-pix_fmt", "yuv420p", tmp_path / "a.mp4", data=parts.tobytes() * 6)
    for mask in read_masks(tmp_path / "a.mp4").masks():
        assert (mask & ACTOR).sum() / (mask | ACTOR).sum() > 0.97


def test_what_masks_are_is_told_by_the_first_frames_that_show_something(tmp_path, monkeypatch):
    """The actor may come later. Those are decoded once."""
    empty = np.zeros((20, HEIGHT, WIDTH, 3), np.uint8)
    dark = empty[:8].copy()
    dark[:, 20:100, 40:80] = 90
    dark[:, 20:30, 40:80] = 200
    raw = ["-f", "rawvideo", "-pix_fmt", "bgr24", "-s", f"{WIDTH}x{HEIGHT}", "-r", 25, "-i", "-"]
    ffmpeg(*raw, "-c:v", "ffv1", "-pix_fmt", "bgra", tmp_path / "a.mkv", data=empty.tobytes() + dark.tobytes())
    decoded, frames = [], VideoFile.frames
    monkeypatch.setattr(VideoFile, "frames", lambda self, *given, **named: decoded.append(named) or frames(self, *given, **named))
    with pytest.raises(ValueError, match="expected masks in black and white, found areas darker than half"):
        read_masks(tmp_path / "a.mkv")
    assert len(decoded) == 1


def test_an_alpha_channel_that_is_not_used_is_no_mask(tmp_path):
    raw = ["-f", "rawvideo", "-pix_fmt", "rgba", "-s", f"{WIDTH}x{HEIGHT}", "-r", 25, "-i", "-"]
    grey = np.repeat(255 * ACTOR.astype(np.uint8)[..., None], 4, axis=2)
    grey[..., 3] = 255
    ffmpeg(*raw, "-c:v", "png", tmp_path / "a.mov", data=grey.tobytes() * 3)
    masks = read_masks(tmp_path / "a.mov")
    assert masks.kind == "grey" and all((mask == ACTOR).all() for mask in masks.masks())


#: Palettes: colour of the background, of the actor, and what else.
PALETTES = {
    "white actor first": ([255, 255, 255, 0, 0, 0], 1, 0),
    "black last": ([9, 200, 9, 200, 0, 0, 0, 0, 0], 2, 1),
    "numbers": ([0, 0, 0, 128, 0, 0, 0, 128, 0], 0, 2),
    "greys that count": ([0, 0, 0, 1, 1, 1, 2, 2, 2], 0, 2),
    "nearly white and black": ([254, 254, 255, 200, 200, 200, 1, 0, 0], 2, 0),
    "no black": ([60, 60, 200, 200, 60, 60], 0, 1),
}


@pytest.mark.parametrize("name", PALETTES)
def test_a_palette_may_have_any_order(tmp_path, name):
    colours, background, actor = PALETTES[name]
    image = Image.fromarray(np.where(ACTOR, actor, background).astype(np.uint8), "P")
    image.putpalette(colours)
    image.save(tmp_path / "0.png")
    (mask,) = read_masks(tmp_path, (tmp_path / "0.png",)).masks()
    np.testing.assert_array_equal(mask, ACTOR)


@pytest.mark.parametrize("soft", [1, 4, 10])
def test_the_edges_of_masks_may_be_soft(tmp_path, soft):
    """However wide: as those of a network's small image."""
    edges = Image.fromarray(255 * ACTOR.astype(np.uint8)).filter(ImageFilter.GaussianBlur(soft))
    for n in range(3):
        edges.save(tmp_path / f"{n}.jpg", quality=90)
    for mask in read_masks(tmp_path, tuple(sorted(tmp_path.iterdir()))).masks():
        assert (mask & ACTOR).sum() / (mask | ACTOR).sum() > 0.8  # corners are round


def test_cut_outs_of_bright_clothes_lose_dark_hair(tmp_path):
    """A sixth of the actor, and no mask says so."""
    image = 230 * ACTOR.astype(np.uint8)
    image[20:34] = np.minimum(image[20:34], 60)
    for n in range(3):
        Image.fromarray(image).save(tmp_path / f"{n}.jpg", quality=90)
    with pytest.raises(ValueError, match="expected masks in black and white, found areas darker than half"):
        read_masks(tmp_path, tuple(sorted(tmp_path.iterdir())))


def test_parts_of_a_person_may_be_dark_without_a_palette(tmp_path):
    parts = np.where(ACTOR[..., None], (0, 0, 85), 0).astype(np.uint8)
    parts[20:50, 40:70] = 85, 51, 0
    parts[20:30, 50:60] = 254, 0, 0
    Image.fromarray(parts).save(tmp_path / "0.png")
    masks = read_masks(tmp_path, (tmp_path / "0.png",))
    assert masks.kind == "colours"
    np.testing.assert_array_equal(next(masks.masks()), ACTOR)


def test_cut_outs_on_black_are_masks_however_dark_the_clothes(tmp_path):
    folder, whole = tmp_path / "cam0", np.zeros((HEIGHT, WIDTH), bool)
    folder.mkdir()
    whole[20:100, 40:80] = True
    clothes = np.random.default_rng(1).integers((20, 25, 30), (60, 90, 250), (HEIGHT, WIDTH, 3)).astype(np.uint8)
    clothes[60:, :, 2] = 30
    for n in range(2):
        Image.fromarray(clothes * whole[..., None].astype(np.uint8)).save(folder / f"{n}.png")
    for mask in read_masks(folder, tuple(sorted(folder.iterdir()))).masks():
        np.testing.assert_array_equal(mask, whole)


@pytest.mark.parametrize("form", ["jpg", "mp4", "avi"])
@pytest.mark.parametrize("what", ["cut-outs", "numbers", "mattes"])
def test_what_loses_areas_below_a_half_is_no_mask(tmp_path, form, what):
    """Of a video, or of JPEG, which blur what is black; the soft edges of mattes are a line."""
    folder, whole = tmp_path / "cam0", 255.0 * ACTOR
    folder.mkdir()
    if what == "cut-outs":
        whole *= np.kron(np.random.default_rng(1).uniform(0.15, 0.7, (HEIGHT // 8, WIDTH // 8)), np.ones((8, 8)))
    elif what == "numbers":
        whole[60:] *= 0.3
    for _ in range(2 * (what == "mattes")):
        whole = sum(np.roll(whole, move, (0, 1)) for move in [(0, 0), (0, 1), (0, -1), (1, 0), (-1, 0)]) / 5
    images = whole.round().astype(np.uint8)
    for n in range(3):
        Image.fromarray(images).save(folder / f"{n}.jpg", quality=92)
    if form != "jpg":
        raw = ["-f", "rawvideo", "-pix_fmt", "gray", "-s", f"{WIDTH}x{HEIGHT}", "-r", 25, "-i", "-"]
        codec = {"mp4": "libx264", "avi": "mjpeg"}[form]
        ffmpeg(*raw, "-c:v", codec, "-q:v", 3, "-pix_fmt", "yuvj420p", tmp_path / f"a.{form}", data=images.tobytes() * 3)
    path, files = (folder, tuple(sorted(folder.iterdir()))) if form == "jpg" else (tmp_path / f"a.{form}", ())
    if what == "mattes":
        assert all((mask & ACTOR).sum() / (mask | ACTOR).sum() > 0.97 for mask in read_masks(path, files).masks())
        return
    with pytest.raises(ValueError, match=r"expected masks in black and white, found areas darker than half in \d+ %"):
        read_masks(path, files)


@pytest.mark.parametrize(("values", "form"), [((38, 75, 113), "png"), ((60, 200), "png"), ((255, 255), "jpg")])
def test_greys_below_a_half_are_objects_where_they_fill_areas(tmp_path, values, form):
    """DAVIS's red, green and olive as grey; parts of a person, one of them dark; the traces of a JPEG are none of them."""
    folder, whole = tmp_path / "cam0", np.zeros((HEIGHT, WIDTH), np.uint8)
    folder.mkdir()
    for k, value in enumerate(values):
        whole[20 + 20 * k : 40 + 20 * k, 40:80] = value
    for n in range(2):
        Image.fromarray(whole).save(folder / f"{n}.{form}")
    for mask in read_masks(folder, tuple(sorted(folder.iterdir()))).masks():
        np.testing.assert_array_equal(mask, whole > 0)


def test_shares_from_0_to_1_count_from_a_half_on(tmp_path):
    Image.fromarray(np.where(ACTOR, 0.9, 0.2).astype(np.float32)).save(tmp_path / "0.tiff")
    (mask,) = read_masks(tmp_path, (tmp_path / "0.tiff",)).masks()
    np.testing.assert_array_equal(mask, ACTOR)


def test_a_transparent_colour_of_a_palette_is_background(tmp_path):
    image = Image.fromarray(np.where(ACTOR, 0, 1).astype(np.uint8), "P")
    image.putpalette([20, 20, 20, 255, 0, 255])
    image.save(tmp_path / "0.png", transparency=1)
    (mask,) = read_masks(tmp_path, (tmp_path / "0.png",)).masks()
    np.testing.assert_array_equal(mask, ACTOR)


def test_an_image_of_a_thousand_million_pixels_is_refused_unread(tmp_path):
    Image.new("1", (32000, 32000)).save(tmp_path / "0.png")
    with pytest.raises(RuntimeError, match="expected an image, found a file that cannot be decoded"):
        read_masks(tmp_path, (tmp_path / "0.png",))


# --- key points


@pytest.mark.parametrize("nothing", [np.nan, np.inf, None])
def test_key_points_that_are_not_there_have_no_confidence(nothing):
    person = [[10.0 * k, 5.0, 0.9] for k in range(17)]
    person[7] = [nothing, nothing, nothing]
    person[9] = [3.0, 4.0, nothing]
    found = joints_of([[[nothing] * 3] * 17, json.loads(json.dumps(person))], Path("a.json"))
    assert (found[[2, 4]] == 0).all()  # l_elbow, l_wrist
    np.testing.assert_array_equal(found[0], [50, 5, 0.9])


@pytest.mark.parametrize("size", [1, 1.7])  # shares of the image, metres about the hips
def test_key_points_that_are_no_pixels_are_refused(size):
    person = np.column_stack([size * np.linspace(0.1, 0.9, 33), size * np.linspace(0.2, 1, 33), np.full(33, 0.9)])
    with pytest.raises(ValueError, match=r"a\.json: expected keypoints in pixels of the video, found a person smaller than 2"):
        joints_of([person.tolist()], Path("a.json"))
    person[:, 2] = 0.1  # of nobody
    assert joints_of([person.tolist()], Path("a.json")).any()
    pixels = person * [640, 480, 9]
    np.testing.assert_allclose(joints_of([pixels.tolist()], Path("a.json"))[0], pixels[11])


@pytest.mark.parametrize("form", ["folder", "instance_info"])
def test_frames_without_key_points_are_left_out(tmp_path, form):
    """Programs write nothing where they see nobody: what follows stays in step."""
    frames = {k: {"instances": [{"keypoints": [[k, 1.0]] * 17, "keypoint_scores": [0.9] * 17}]} for k in (0, 1, 4, 5)}
    path = tmp_path / "cam0"
    if form == "folder":
        path.mkdir()
        for k, content in frames.items():
            (path / f"take_{k + 12:09d}_keypoints.json").write_text(json.dumps(content))
    else:
        path = tmp_path / "cam0.json"
        path.write_text(json.dumps({"instance_info": [{"frame_id": k + 1, **content} for k, content in frames.items()]}))
    assert CameraKeypoints(path, (64, 48)).of(4)[0].tolist() == [4, 1, 0.9] and CameraKeypoints(path, (64, 48)).of(1)[
        0
    ].tolist() == [1, 1, 0.9]
    assert not CameraKeypoints(path, (64, 48)).of(2).any()
    with pytest.raises(ValueError, match="expected keypoints of frame 6, found those of 4 frames"):
        CameraKeypoints(path, (64, 48)).of(6)


def test_mmpose_writes_a_list_of_people_for_each_image(tmp_path):
    (tmp_path / "cam0").mkdir()
    for k, people in enumerate([person_at(7)["instances"], [], person_at(9)["instances"]]):
        (tmp_path / f"cam0/{k:06d}.json").write_text(json.dumps(people))
    (found,) = read_keypoints(tmp_path, ["cam0"], [3], [(64, 48)])
    assert [found.of(t)[0, 0] for t in range(3)] == [7, 0, 9]


@pytest.mark.parametrize("program", ["EasyMocap", "OpenPifPaf"])
def test_people_of_an_image_with_their_points(tmp_path, program):
    (tmp_path / "cam0").mkdir()
    for n in range(3):
        rows = [[k + n + 1.0, 2 * k + 1.0, 0.9] for k in range(25 if program == "EasyMocap" else 17)]
        if program == "EasyMocap":
            name, content = (
                f"{n:06d}.json",
                {"filename": f"images/cam0/{n:06d}.jpg", "annots": [{"personID": 0, "keypoints": rows}]},
            )
        else:
            people = [{"keypoints": sum(rows, []), "category_id": 1}, {"keypoints": []}]
            name, content = f"{n:06d}.jpg.predictions.json", people
        (tmp_path / "cam0" / name).write_text(json.dumps(content))
    (found,) = read_keypoints(tmp_path, ["cam0"], [3], [(640, 480)])
    assert [found.of(n)[0, 0] for n in range(3)] == [6, 7, 8]


#: What MMPose calls the points of its datasets, in their order.
NAMED = {
    "Human3.6M": "root right_hip right_knee right_foot left_hip left_knee left_foot spine thorax neck_base head left_shoulder "
    "left_elbow left_wrist right_shoulder right_elbow right_wrist",
    "MPII": "right_ankle right_knee right_hip left_hip left_knee left_ankle pelvis thorax upper_neck head_top right_wrist "
    "right_elbow right_shoulder left_shoulder left_elbow left_wrist",
}


@pytest.mark.parametrize("form", ["of a video", "of images"])
@pytest.mark.parametrize("dataset", NAMED)
def test_points_are_what_their_file_calls_them(tmp_path, dataset, form):
    """As MMPose's demos write it; Human3.6M has 17 points as COCO, in another order."""
    names = NAMED[dataset].split()
    person = {"keypoints": [[k + 1.0, 2 * k + 1.0] for k in range(len(names))], "keypoint_scores": [0.9] * len(names)}
    meta = {"dataset_name": dataset, "keypoint_name2id": {name: k for k, name in enumerate(names)}}
    if form == "of a video":
        frames = [{"frame_id": n, "instances": [person]} for n in range(2)]
        (tmp_path / "cam0.json").write_text(json.dumps({"meta_info": meta, "instance_info": frames}))
    else:
        (tmp_path / "cam0").mkdir()
        for n in range(2):
            (tmp_path / f"cam0/{n:06d}.json").write_text(json.dumps({"meta_info": meta, "instance_info": [person]}))
    (found,) = read_keypoints(tmp_path, ["cam0"], [2], [(64, 48)])
    ankle = "foot" if dataset == "Human3.6M" else "ankle"
    order = [f"{side}_{part}" for part in ("shoulder", "elbow", "wrist", "hip", "knee", ankle) for side in ("left", "right")]
    np.testing.assert_array_equal(found.of(1)[:, 0], [names.index(name) + 1 for name in order])


def test_points_that_a_file_leaves_out_are_named(tmp_path):
    content = {"meta_info": {"keypoint_name2id": {"nose": 0, "left_hip": 1}}, "instance_info": []}
    (tmp_path / "cam0.json").write_text(json.dumps(content))
    with pytest.raises(ValueError, match=r"cam0\.json: expected points named left_shoulder, .*, found nose, left_hip"):
        read_keypoints(tmp_path, ["cam0"], [2], [(64, 48)])


@pytest.mark.parametrize("count", [70, 308])
def test_points_of_sapiens_are_told_by_their_number(count):
    points = [[k, 2 * k, 0.9] for k in range(count)]
    np.testing.assert_array_equal(joints_of([points], Path("a"))[:, 0], [5, 6, 7, 8, 62, 41, 9, 10, 11, 12, 13, 14])


def test_the_only_file_of_a_camera_may_lie_in_its_folder(tmp_path):
    """As AlphaPose and MMPose write it into the folder that they are given."""
    names = ["cam0", "cam1", "cam2"]
    for name in names:
        (tmp_path / name).mkdir()
    people = [{"image_id": f"{n}.jpg", "keypoints": [n + 1.0, 1.0, 0.9] * 17} for n in range(3)]
    frames = [{"frame_id": n, **person_at(n + 1)} for n in range(3)]
    (tmp_path / "cam0/alphapose-results.json").write_text(json.dumps(people))
    (tmp_path / "cam1/take3.json").write_text(json.dumps(frames))
    (tmp_path / "cam2/take3.json").write_text(json.dumps({"instance_info": frames}))
    for found in read_keypoints(tmp_path, names, [3] * 3, [(64, 48)] * 3):
        assert [found.of(t)[0, 0] for t in range(3)] == [1, 2, 3]


def test_what_macos_keeps_beside_files_are_no_key_points(tmp_path):
    (tmp_path / "cam0").mkdir()
    for path in (tmp_path / "cam0/000000000000_keypoints.json", tmp_path / "cam1.json"):
        path.write_text(json.dumps(person_at(7) if path.parent.name == "cam0" else [{"frame_id": 0, **person_at(8)}]))
        (path.parent / f"._{path.name}").write_bytes(b"\0\5\26\7Mac OS X")
    found = read_keypoints(tmp_path, ["cam0", "cam1"], [1, 1], [(64, 48)] * 2)
    assert [keypoints.of(0)[0, 0] for keypoints in found] == [7, 8]


def test_a_list_of_people_names_the_image_of_each(tmp_path):
    """AlphaPose; in frame 1 there are two, in frame 2 nobody."""
    told = [(11, 11, 0.9), (1, 3, 0.1), (1, 1, 0.9), (0, 0, 0.9), (10, 10, 0.9), (3, 3, 0.9)]
    people = [{"image_id": f"{n}.jpg", "category_id": 1, "keypoints": [x, 1.0, c] * 17, "score": c} for n, x, c in told]
    (tmp_path / "cam1.json").write_text(json.dumps([p for p in people if p["image_id"] != "0.jpg"]))
    (alone,) = read_keypoints(tmp_path, ["cam1"], [12], [(64, 48)])
    assert alone.of(3)[0, 0] == 3  # in frame 0 there was nobody in any camera
    (tmp_path / "cam0.json").write_text(json.dumps(people))
    (tmp_path / "cam2.json").write_text(json.dumps([{**p, "image_id": int(p["image_id"][:-4])} for p in people]))  # COCO
    for found in read_keypoints(tmp_path, ["cam0", "cam1", "cam2"], [12, 12, 12], [(64, 48)] * 3):
        assert [found.of(t)[0, 0] for t in range(1, 12)] == [1, 0, 3, 0, 0, 0, 0, 0, 0, 10, 11]


@pytest.mark.parametrize("confidence", [True, False])
@pytest.mark.parametrize("more", ["", " 0.87", " 0.87 3"])  # of the person, as --save-conf has it; the track
def test_labels_of_yolo_are_shares_of_the_image(tmp_path, confidence, more):
    """Frames count from 1, and one without anybody has no file."""
    (tmp_path / "cam0").mkdir()
    for frame in (0, 1, 3, 11):
        point = [(frame + 0.5) / 64, 0.25, 0.9][: 2 + confidence]
        points = [[0.0] * len(point) if k == 7 else point for k in range(17)]  # an elbow is not found
        line = " ".join(f"{x:g}" for x in [0, 0.5, 0.5, 0.2, 0.9, *sum(points, [])]) + more
        (tmp_path / f"cam0/take3_{frame + 1}.txt").write_text(line + "\n")
    (found,) = read_keypoints(tmp_path, ["cam0"], [12], [(64, 48)])
    np.testing.assert_allclose(found.of(11)[0], [11.5, 12, 0.9 if confidence else 1], atol=1e-3)
    assert found.of(11)[2, 2] == 0 and not found.of(2).any() and found.of(3)[0, 0] == pytest.approx(3.5, abs=1e-3)
    (tmp_path / "cam0/take3_1.txt").write_text("0 0.5 0.5 0.2 0.9\n")  # boxes alone
    with pytest.raises(ValueError, match=r"take3_1\.txt: expected lines of class, box and 17 keypoints"):
        found.of(0)


@pytest.mark.parametrize(
    "content",
    [
        [{"people": [{"pose_keypoints_2d": 5}]}],
        {"instance_info": [{"instances": [{"keypoints": 5, "keypoint_scores": 3}]}]},
        {"instance_info": [{"instances": [{"keypoints": [5], "keypoint_scores": [3]}]}]},
        [{"image_id": "a.jpg", "keypoints": "left"}],
    ],
)
def test_what_should_be_a_list_of_key_points_and_is_none(tmp_path, content):
    path = tmp_path / "cam0.json"
    path.write_text(json.dumps(content))
    try:
        assert not CameraKeypoints(path, (64, 48)).of(0).any()
    except ValueError as error:
        assert str(path) in str(error)


def person_at(x: float) -> dict:
    return {"instances": [{"keypoints": [[x, 1.0]] * 17, "keypoint_scores": [0.9] * 17}]}


#: Names of a camera's files or values of its frame_id -> frames of its video; another camera's first is 1 where that is said.
BEGINNINGS = {
    "OpenPose counts from 0": ([f"take_{n:012d}_keypoints" for n in (3, 4, 6)], 0, [3, 4, 6]),
    "OpenPose, frame 0 left out": ([f"{n:012d}_keypoints" for n in (1, 2)], 0, [1, 2]),
    "another camera counts from 0": ([f"cam0_{n:06d}" for n in (1, 2)], 0, [1, 2]),
    "another camera counts from 1": ([3, 4], 1, [2, 3]),
    "only counted from 1 it ends in time": ([f"f{n}" for n in (8, 9, 10)], 2, [7, 8, 9]),
    "of a take of which the video is a part": ([f"f{n}" for n in (101, 102)], 1, [0, 1]),
}


@pytest.mark.parametrize("case", BEGINNINGS)
def test_key_points_that_begin_late(tmp_path, case):
    called, other, frames = BEGINNINGS[case]
    if isinstance(called[0], str):
        (tmp_path / "cam0").mkdir()
        for name, frame in zip(called, frames):
            (tmp_path / f"cam0/{name}.json").write_text(json.dumps(person_at(frame + 1)))
    else:
        told = [{"frame_id": number, **person_at(frame + 1)} for number, frame in zip(called, frames)]
        (tmp_path / "cam0.json").write_text(json.dumps({"instance_info": told}))
    (tmp_path / "cam1.json").write_text(json.dumps({"instance_info": [{"frame_id": other, **person_at(5)}]}))
    found, _ = read_keypoints(tmp_path, ["cam0", "cam1"], [10, 10], [(64, 48)] * 2)
    assert [found.of(t)[0, 0] for t in range(found.count)] == [t + 1 if t in frames else 0 for t in range(frames[-1] + 1)]


def test_key_points_of_images_are_those_of_their_names(tmp_path):
    """cam1 has lost images, at the beginning, too."""
    images = {0: range(20), 1: [k for k in range(20) if k not in (0, 1, 7)]}
    for c, numbers in images.items():
        save_series(tmp_path / f"films/cam{c}", numbers)
        (tmp_path / f"keypoints/cam{c}").mkdir(parents=True)
        for n in numbers:
            (tmp_path / f"keypoints/cam{c}/{101 + n:06d}_keypoints.json").write_text(json.dumps(person_at(10 + n)))
    frames = session_of(tmp_path, fps=25, keypoints=tmp_path / "keypoints")
    for c, t in ((0, 0), (0, 10), (1, 2), (1, 10), (1, 17)):
        assert frames.keypoints(c, t)[0, 0] == 12 + t
    assert not np.any(frames.keypoints(1, 5))


# --- examples


def test_a_mediapipe_without_its_networks_is_named(tmp_path, monkeypatch, capsys):
    (tmp_path / "mediapipe.py").write_text("__version__ = '0.10.35'\n")
    (tmp_path / "cv2.py").write_text("")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(sys, "argv", ["mediapipe_masks.py", "x.mp4", "-o", str(tmp_path / "m")])
    for name in ("mediapipe", "cv2"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    with pytest.raises(SystemExit):
        runpy.run_path(str(ROOT / "examples" / "mediapipe_masks.py"), run_name="__main__")
    said = capsys.readouterr().err
    assert "expected MediaPipe 0.10.21, the last with its networks inside, found 0.10.35; it needs Python 3.9 to 3.12" in said
    for name in ("mediapipe", "cv2"):
        sys.modules.pop(name, None)
