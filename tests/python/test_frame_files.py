"""Images and videos as capture reads them, held against Pillow's decoding and against frames that are known."""

import resource
import shutil
import subprocess
import sys
from pathlib import Path

import doublet as d
import numpy as np
import pytest
from PIL import Image

sys.path.append(str(Path(__file__).parents[1] / "fuzz"))
import seeds

SIZE, FRAMES = (64, 48), 40  # width, height


def picture() -> np.ndarray:
    """(48, 64, 3) uint8 RGB: ramps, and a bright square."""
    y, x = np.mgrid[: SIZE[1], : SIZE[0]]
    rgb = np.stack([3 * x, 5 * y, 255 - 2 * x - 2 * y], -1).astype(np.uint8)
    rgb[16:32, 20:36] = 250
    return rgb


def numbered(frame: int) -> np.ndarray:
    """(48, 64, 3) uint8 RGB by which a frame is known: its number in eight columns, black and white. The last is white: a
    picture of one colour is a camera that dropped out."""
    bits = [(((frame | 128) >> k) & 1) * 220 + 10 for k in range(8)]
    return np.broadcast_to(np.repeat(bits, 8)[None, :, None], (SIZE[1], SIZE[0], 3)).astype(np.uint8)


class OneCamera:
    """A session of one camera whose video is what the test writes."""

    def __init__(self, folder: Path):
        self.folder = folder
        world = seeds.World()
        seeds.write_session(folder, world)
        for camera in world.cameras:
            camera.width, camera.height = SIZE
        d.write_calibration(folder / "calibration.yml", world.cameras)
        self.text = (folder / "session.json").read_text()
        self.names = [camera.name for camera in world.cameras]

    def frames(self, video: str, count: int = 1, size: tuple[int, int] = SIZE) -> d.FrameSource:
        import json

        calibration = d.read_calibration(self.folder / "calibration.yml")
        for camera in calibration:
            camera.camera.width, camera.camera.height = size
        d.write_calibration(self.folder / "calibration.yml", calibration)
        session = json.loads(self.text)
        session["frame_count"] = count
        session["cameras"] = [{"name": name, "video": video} for name in self.names]
        (self.folder / "session.json").write_text(json.dumps(session))
        return d.FrameSource.open(d.Session(self.folder))

    def rgb(self, video: str, size: tuple[int, int] = SIZE) -> np.ndarray:
        return np.asarray(self.frames(video, size=size).image(0, 0))[..., ::-1]


@pytest.fixture
def camera(tmp_path):
    return OneCamera(tmp_path)


def saved(name: str, image: Image.Image, folder: Path, **how) -> Path:
    image.save(folder / name, **how)
    return folder / name


def by_pillow(path: Path) -> np.ndarray:
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB"))


RGB = Image.fromarray(picture())
GREY16 = Image.fromarray((np.asarray(RGB.convert("L")).astype(np.uint16) << 8) + 77)
TURNED = Image.Exif()
TURNED[0x0112] = 6


@pytest.mark.parametrize(
    "name, image, how",
    [
        ("rgb_%d.png", RGB, {}),
        ("palette_%d.png", RGB.quantize(64), {}),
        ("two_colours_%d.png", RGB.convert("1"), {}),
        ("grey_%d.png", RGB.convert("L"), {}),
        ("grey_and_alpha_%d.png", Image.merge("LA", [RGB.convert("L"), RGB.getchannel(0)]), {}),
        ("alpha_%d.png", Image.merge("RGBA", [*RGB.split(), RGB.getchannel(1)]), {}),
        ("plain_%d.jpg", RGB, {}),
        ("fine_colour_%d.jpg", RGB, {"quality": 90, "subsampling": 0, "progressive": True}),
        ("grey_%d.jpg", RGB.convert("L"), {}),
        ("plain_%d.ppm", RGB, {}),
        ("grey_%d.pgm", RGB.convert("L"), {}),
        ("plain_%d.bmp", RGB, {}),
        ("plain_%d.tif", RGB, {}),
        ("packed_%d.tif", RGB, {"compression": "tiff_lzw"}),
        ("lossless_%d.webp", RGB, {"lossless": True}),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_format_has_pillows_pixels(camera, name, image, how):
    path = saved(name % 0, image, camera.folder, **how)
    np.testing.assert_array_equal(camera.rgb(name), by_pillow(path))


def test_of_sixteen_bits_the_upper_eight_count(camera):
    saved("deep_0.png", GREY16, camera.folder)
    np.testing.assert_array_equal(camera.rgb("deep_%d.png")[..., 0], np.asarray(RGB.convert("L")))


def test_cmyk_is_as_bright_as_in_other_programs(camera):
    path = saved("print_0.jpg", RGB.convert("CMYK"), camera.folder, quality=95)
    difference = camera.rgb("print_%d.jpg").astype(int) - by_pillow(path)
    assert np.abs(difference).max() <= 2  # two ways of rounding


@pytest.mark.parametrize("orientation", range(1, 9))
def test_exif_turns_an_image(camera, orientation):
    exif = Image.Exif()
    exif[0x0112] = orientation
    path = saved("photo_0.jpg", RGB, camera.folder, exif=exif)
    from PIL import ImageOps

    with Image.open(path) as image:
        expected = np.asarray(ImageOps.exif_transpose(image))
    shown = camera.rgb("photo_%d.jpg", size=expected.shape[1::-1])
    np.testing.assert_array_equal(shown, expected)


@pytest.mark.parametrize("name", ["rgb_0.png", "rgb_0.jpg", "rgb_0.ppm", "rgb_0.bmp", "rgb_0.tif"])
def test_half_an_image_is_refused(camera, name):
    path = saved(name, RGB, camera.folder)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(RuntimeError, match=f"{name}: expected an image, found a file that cannot be decoded"):
        camera.frames(name.replace("0", "%d"))


def test_a_changed_byte_of_a_png_is_seen(camera):
    path = saved("rgb_0.png", RGB, camera.folder)
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)
    with pytest.raises(RuntimeError, match=r"rgb_0.png: expected an image"):
        camera.frames("rgb_%d.png")


def test_an_image_larger_than_any_cameras_is_refused_before_there_is_memory_for_it(camera):
    saved("rgb_0.png", Image.new("1", (32000, 32000)), camera.folder)
    with pytest.raises(RuntimeError, match=r"rgb_0.png: expected an image of at most 134217728 pixels, found 32000 x 32000"):
        camera.frames("rgb_%d.png")


def write_video(path: Path, *codec: str, rate: int = 25) -> None:
    raw = b"".join(numbered(frame).tobytes() for frame in range(FRAMES))
    given = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{SIZE[0]}x{SIZE[1]}", "-r", str(rate), "-i", "-"]
    subprocess.run(["ffmpeg", "-loglevel", "error", "-y", *given, *codec, str(path)], input=raw, check=True)


def number_of(image: np.ndarray) -> int:
    """Of a frame that numbered() made."""
    columns = np.asarray(image).reshape(SIZE[1], 8, 8, 3)[:, :, 2:6].mean(axis=(0, 2, 3))
    return sum((column > 128) << k for k, column in enumerate(columns[:7]))


CODECS = {
    "h264.mp4": ["-c:v", "libx264", "-g", "12", "-pix_fmt", "yuv444p", "-crf", "4"],
    "h264.mkv": ["-c:v", "libx264", "-g", "12", "-pix_fmt", "yuv444p", "-crf", "4"],
    "mpeg4.avi": ["-c:v", "mpeg4", "-q:v", "2", "-g", "12"],
    "mpeg.ts": ["-c:v", "mpeg2video", "-q:v", "2", "-g", "12", "-bf", "2"],
    "raw.h264": ["-c:v", "libx264", "-g", "12", "-pix_fmt", "yuv444p", "-crf", "4"],
    "vp8.webm": ["-c:v", "libvpx", "-b:v", "2M", "-g", "12", "-auto-alt-ref", "1", "-lag-in-frames", "10"],
    "vp9.webm": ["-c:v", "libvpx-vp9", "-b:v", "2M", "-g", "12"],
    "motion.mov": ["-c:v", "mjpeg", "-q:v", "2"],
}
ORDERS = {
    "onwards": range(FRAMES),
    "backwards": (FRAMES - 1, FRAMES - 2, 20, 19, 18, 1, 0),
    "jumps": (0, 39, 1, 38, 12, 11, 13, 24, 23, 5),
}


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("name", CODECS)
def test_frame_n_is_frame_n_in_whatever_order(camera, name, order):
    write_video(camera.folder / name, *CODECS[name])
    frames = camera.frames(name, FRAMES)
    assert [number_of(frames.image(0, frame)) for frame in ORDERS[order]] == list(ORDERS[order])


def test_a_video_that_was_cut_by_copying_begins_where_players_begin(camera):
    write_video(camera.folder / "whole.mp4", *CODECS["h264.mp4"])
    whole, cut = camera.folder / "whole.mp4", camera.folder / "cut.mp4"
    subprocess.run(["ffmpeg", "-loglevel", "error", "-ss", "0.6", "-i", str(whole), "-c", "copy", str(cut)], check=True)
    frames = camera.frames("cut.mp4", FRAMES - 15)
    assert [number_of(frames.image(0, frame)) for frame in (0, 1, 10, FRAMES - 16)] == [15, 16, 25, FRAMES - 1]
    with pytest.raises(RuntimeError, match=f"cut.mp4: expected {FRAMES} frames as session.json says, found {FRAMES - 15}$"):
        camera.frames("cut.mp4", FRAMES)


def test_a_video_is_turned_as_its_container_says(camera):
    write_video(camera.folder / "flat.mp4", *CODECS["h264.mp4"])
    turn = ["-c", "copy", "-metadata:s:v:0", "rotate=90", str(camera.folder / "turned.mp4")]
    subprocess.run(["ffmpeg", "-loglevel", "error", "-i", str(camera.folder / "flat.mp4"), *turn], check=True)
    assert camera.rgb("turned.mp4", size=SIZE[::-1]).shape == (SIZE[0], SIZE[1], 3)


def test_a_frame_that_cannot_be_decoded_is_not_replaced_by_the_next(camera):
    write_video(camera.folder / "motion.mov", *CODECS["motion.mov"])
    path = camera.folder / "motion.mov"
    data = bytearray(path.read_bytes())
    starts = [at for at in range(len(data) - 2) if data[at : at + 3] == b"\xff\xd8\xff"]
    assert len(starts) == FRAMES
    data[starts[7] : starts[8]] = bytes(starts[8] - starts[7])
    path.write_bytes(data)
    frames = camera.frames("motion.mov", FRAMES)
    assert number_of(frames.image(0, 6)) == 6
    with pytest.raises(RuntimeError, match=r"motion.mov: frame 7 cannot be decoded"):
        frames.image(0, 7)
    assert number_of(frames.image(0, 20)) == 20


def test_a_picture_of_another_frame_is_never_shown(camera):
    """Where ffmpeg could not be started for a moment."""
    write_video(camera.folder / "h264.mp4", *CODECS["h264.mp4"])
    frames = camera.frames("h264.mp4", FRAMES)
    assert number_of(frames.image(0, 2)) == 2
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (10, hard))
    try:
        with pytest.raises(RuntimeError, match="a pipe|temporary file"):
            frames.image(0, 1)
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    assert number_of(frames.image(0, 0)) == 0


def test_without_ffmpeg_one_sentence_says_so(camera, monkeypatch):
    write_video(camera.folder / "h264.mp4", *CODECS["h264.mp4"])
    monkeypatch.setenv("DOUBLET_FFMPEG", "no-ffmpeg-here")
    with pytest.raises(
        RuntimeError, match=r"the program no-ffmpeg-here is not installed; videos.*need it .*pip install imageio-ffmpeg"
    ):
        camera.frames("h264.mp4", FRAMES)


def test_a_playlist_names_no_other_file(camera):
    write_video(camera.folder / "h264.mp4", *CODECS["h264.mp4"])
    playlist = "#EXTM3U\n#EXT-X-TARGETDURATION:2\n#EXTINF:2,\nhttp://127.0.0.1:9/h264.ts\n#EXT-X-ENDLIST\n"
    (camera.folder / "list.m3u8").write_text(playlist)
    with pytest.raises(RuntimeError, match=r"list.m3u8: expected a complete video file"):
        camera.frames("list.m3u8", FRAMES)


def test_names_with_signs_of_ffmpegs_are_names(camera):
    write_video(camera.folder / "plain.mp4", *CODECS["h264.mp4"])
    shutil.copy(camera.folder / "plain.mp4", camera.folder / "-i http:x 'y'.mp4")
    assert number_of(camera.frames("-i http:x 'y'.mp4", FRAMES).image(0, 3)) == 3
