"""Video through the programs ffmpeg and ffprobe."""

from __future__ import annotations

import json
import re
import shutil
import struct
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from pathlib import Path

import numpy as np

from .files import written_atomically
from .programs import as_file, ffmpeg

#: What ffprobe is asked: the stream as it is stored, how it is to be turned, and the time of every frame.
PROBED = (
    "format=format_name:stream=codec_name,pix_fmt,width,height,sample_aspect_ratio,field_order,nb_frames,avg_frame_rate"
    ":stream_tags=rotate,alpha_mode"
    ":stream_side_data=rotation:packet=pts_time,flags"
)
WITH_ALPHA = re.compile(r"yuva|gbrap|rgba|argb|abgr|bgra|ya8|ya16|pal8")  #: pixel formats
ALPHA_DECODERS = {"vp8": "libvpx", "vp9": "libvpx-vp9"}  #: ffmpeg's own ones leave the second stream aside
HALVES = ("tt", "bb", "tb", "bt")  #: orders of fields; all others are whole frames
NO_FFMPEG = "the program ffmpeg is not installed; a video needs it (apt install ffmpeg, or pip install imageio-ffmpeg)"
EVEN = 0.1  #: of a frame, by which the times of one rate may be rounded
ROUNDED = 1e-6  #: of a frame's time, by which its number may be off
NTSC = 1001  #: denominator of broadcast rates: 30000/1001
DROPPED = 0.3  #: of a frame, by which the times of a clock may be off whose frames were dropped


@dataclass(frozen=True)
class VideoFile:
    """A video and what its container says."""

    path: Path
    stored_size: tuple[int, int]  # width, height, px, before it is turned
    rotation: int  # degrees by which players turn it, counterclockwise: 0, 90, 180, 270
    times: np.ndarray  # (N) s, of the frames, after the first
    clock: float  # s, what the file's clock shows at the first
    counted: bool = True  # its frames are those that the container says, from the first on: any reader finds them by number
    alpha: str | None = None  # it has an alpha channel, which this decoder reads; empty = any
    aspect: float = 1.0  # width of a stored pixel, in heights
    interlaced: bool = False  # every second line of a frame is half a frame later

    @property
    def size(self) -> tuple[int, int]:
        """Width and height as players turn it, px."""
        return self.stored_size[::-1] if self.rotation % 180 else self.stored_size

    @property
    def shown_size(self) -> tuple[int, int]:
        """The same as players show it, in square pixels."""
        width, height = round(self.stored_size[0] * self.aspect), self.stored_size[1]
        return (height, width) if self.rotation % 180 else (width, height)

    @property
    def fps(self) -> float:
        """Frames a second while it films, measured; 0 for a single frame."""
        return rate_of(self.times)

    @cached_property
    def sound_start(self) -> float | None:
        """s after the first frame; None = no sound track."""
        sounds = probe(self.path, "a:0", "stream=codec_type,start_time").get("streams", [])
        return float(sounds[0].get("start_time", self.clock)) - self.clock if sounds else None

    def frames(
        self, size: tuple[int, int] | None = None, grey: bool = False, upright: bool = True, alpha: bool = False
    ) -> Iterator[np.ndarray]:
        """Every frame: (H, W, 3) uint8 BGR, or grey (H, W); with `alpha` that channel, too, (H, W, 4), or as grey alone. Of a
        `size` (width, height) if given; turned as the container says unless `upright` is off. Raises RuntimeError if one
        cannot be decoded."""
        width, height = size or (self.size if upright else self.stored_size)
        decoder = ["-c:v", self.alpha] if alpha and self.alpha else []
        turn = [] if upright else ["-noautorotate"]
        command = [ffmpeg(), "-loglevel", "error", "-nostdin", *turn, *decoder, "-i", as_file(self.path)]
        filters = ["format=rgba,alphaextract"] if alpha and grey else []
        filters += [f"scale={width}:{height}:flags=area"] if size else []
        # Every frame once, whatever the clock says: at an even rate, for the option that says so has changed its name.
        command += ["-map", "0:V:0", "-vf", ",".join([*filters, "settb=AVTB,setpts=N/25/TB"]), "-r", "25"]
        command += ["-f", "rawvideo", "-pix_fmt", "gray" if grey else "bgra" if alpha else "bgr24", "-"]
        shape = (height, width) if grey else (height, width, 4 if alpha else 3)
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        try:
            for index in range(len(self.times)):
                data = process.stdout.read(int(np.prod(shape)))
                if len(data) < np.prod(shape):
                    raise RuntimeError(
                        f"{self.path}: expected {len(self.times)} frames as the file says, found that frame {index} cannot be "
                        "decoded; is the video truncated or damaged?"
                    )
                yield np.frombuffer(data, np.uint8).reshape(shape)
        finally:
            process.kill()
            process.stdout.close()
            process.wait()

    def sound(self, rate: int) -> np.ndarray:
        """(N) float32 in [-1, 1): the sound track, all channels together, `rate` samples a second from `sound_start` on."""
        command = [ffmpeg(), "-loglevel", "error", "-nostdin", "-i", as_file(self.path), "-map", "0:a:0", "-ac", "1"]
        done = subprocess.run([*command, "-ar", str(rate), "-f", "s16le", "-"], capture_output=True)
        if done.returncode:
            raise RuntimeError(f"{self.path}: expected a sound track that can be decoded, ffmpeg says: {first_line(done.stderr)}")
        return np.frombuffer(done.stdout, np.int16).astype(np.float32) / 32768


def read_video(path: Path) -> VideoFile:
    """Raises FileNotFoundError if there is no such file, RuntimeError naming it if it is no video, or is truncated."""
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such file")
    if not shutil.which("ffprobe"):
        raise FileNotFoundError("the program ffprobe is not installed; a video needs it (apt install ffmpeg)")
    if not shutil.which(ffmpeg()):
        raise FileNotFoundError(NO_FFMPEG)
    picture = probe(path, "V:0")
    streams, packets = picture.get("streams", []), picture.get("packets", [])
    if not streams or not packets or not streams[0].get("width"):
        raise RuntimeError(f"{path}: expected a video, found no pictures in it")
    stream, shown = streams[0], [p for p in packets if "D" not in p.get("flags", "")]
    timed = all("pts_time" in packet for packet in shown)  # in AVI no frame is that waits for a later one
    stated = int(stream.get("nb_frames", 0))
    if stated > len(packets) and is_truncated(path, stated, picture.get("format", {}).get("format_name", "")):
        raise RuntimeError(f"{path}: expected {stated} frames as the file says, found {len(packets)}; it is truncated")
    if timed and not begins_within(packets):
        times = np.sort([float(packet["pts_time"]) for packet in shown])
    else:
        times = decoded_times(path)
    return VideoFile(
        path,
        (int(stream["width"]), int(stream["height"])),
        rotation_of(stream),
        even_times(times - times[0], stream.get("avg_frame_rate", "0/0")),
        float(times[0]),
        timed and len(times) == len(packets) and stated in (0, len(packets)),
        alpha_of(stream),
        aspect_of(stream.get("sample_aspect_ratio", "")),
        stream.get("field_order") in HALVES,
    )


def is_truncated(path: Path, stated: int, kind: str) -> bool:
    """Does a file of which fewer frames are found than `stated` end too early? Recorders write a number of frames into an AVI
    that they meant to film, and nothing where they dropped one; of an MP4 that was trimmed without coding it anew an edit list
    shows a part."""
    if kind == "avi":
        return riff_bytes(path) > path.stat().st_size
    if "mp4" in kind or "mov" in kind:
        whole = probe(path, "V:0", "packet=flags", ("-ignore_editlist", "1"))
        return len(whole.get("packets", [])) < stated
    return False


def riff_bytes(path: Path) -> int:
    """Where the last of an AVI's chunks ends, as they say themselves; they follow each other."""
    at, size = 0, path.stat().st_size
    with path.open("rb") as file:
        while at + 8 <= size:
            file.seek(at)
            name, length = struct.unpack("<4sI", file.read(8))
            if name != b"RIFF" or length in (0, 0xFFFFFFFF):  # what follows is none, or it was never said
                break
            at += 8 + length + length % 2
    return at


def begins_within(packets: list[dict]) -> bool:
    """Are there pictures that need what stood before the file was cut: before the first key frame, as it is stored or shown?"""
    key = next((i for i, packet in enumerate(packets) if "K" in packet.get("flags", "")), 0)
    starts = float(packets[key].get("pts_time", 0))
    shown = (float(p["pts_time"]) for p in packets if "pts_time" in p and "D" not in p.get("flags", ""))
    return key > 0 or any(time < starts for time in shown)


def decoded_times(path: Path) -> np.ndarray:
    """(N) s of the frames that can be decoded, by decoding them all."""
    command = [ffmpeg(), "-loglevel", "info", "-nostats", "-nostdin", "-i", as_file(path), "-map", "0:V:0"]
    command += ["-vsync", "passthrough", "-vf", "showinfo=checksum=0", "-f", "null", "-"]
    done = subprocess.run(command, capture_output=True)
    times = [float(time) for time in re.findall(rb"\bpts_time:\s*(-?[0-9.]+)", done.stderr)]
    if not times:
        raise RuntimeError(
            f"{path}: expected frames with time stamps, found none; `ffmpeg -r RATE -i IN -c copy OUT.mp4` adds them"
        )
    return np.array(times)


def alpha_of(stream: dict) -> str | None:
    """The decoder that reads the alpha channel of a stream, empty for the usual one; None = there is no such channel."""
    if WITH_ALPHA.search(stream.get("pix_fmt", "")):
        return ""
    tags = {name.lower(): value for name, value in stream.get("tags", {}).items()}
    return ALPHA_DECODERS.get(stream.get("codec_name")) if tags.get("alpha_mode") == "1" else None


def aspect_of(stated: str) -> float:
    """Of a pixel: 4:3 is wide; 1 where the file does not say."""
    width, _, height = stated.partition(":")
    return int(width) / int(height) if width.isdigit() and height.isdigit() and int(width) * int(height) else 1.0


def probe(path: Path, stream: str, entries: str = PROBED, options: tuple[str, ...] = ()) -> dict:
    """What ffprobe says about a stream of a file."""
    command = ["ffprobe", "-v", "error", *options, "-select_streams", stream, "-show_entries", entries, "-of", "json"]
    done = subprocess.run([*command, as_file(path)], capture_output=True)
    if done.returncode:
        said = first_line(done.stderr).rpartition("] ")[2].removeprefix(f"{as_file(path)}: ")
        raise RuntimeError(f"{path}: expected a complete video file, found one that cannot be opened ({said})")
    return json.loads(done.stdout)


def rotation_of(stream: dict) -> int:
    """Degrees counterclockwise, a multiple of 90: the container's matrix, or the tag of older files, which is clockwise."""
    said = [data["rotation"] for data in stream.get("side_data_list", []) if "rotation" in data]
    said = said or [-float(stream.get("tags", {}).get("rotate", 0))]
    return round(float(said[0]) / 90) * 90 % 360


def even_times(times: np.ndarray, stated: str) -> np.ndarray:
    """Times (N) s of the rate that the file states ("30000/1001"), if they are these, rounded (Matroska has milliseconds)."""
    above, _, below = stated.partition("/")
    if not float(above) or not float(below or 1):
        return times
    even = np.arange(len(times)) * float(below or 1) / float(above)
    return even if np.abs(times - even).max() * float(above) / float(below or 1) < EVEN else times


def rate_of(times: np.ndarray) -> float:
    """Frames a second of times (N) s; 0 for fewer than two. Frames that were dropped do not make it lower: where times are whole
    numbers of one gap, off by what a clock may be, its mean counts, as a whole or broadcast rate if they cannot be told from one;
    else the mean of all."""
    span = float(times[-1] - times[0]) if len(times) > 1 else 0.0
    if span <= 0:
        return 0.0
    gaps = np.diff(times)
    usual = float(np.median(gaps))
    steps = np.round(gaps / usual) if usual > 0 else np.zeros(len(gaps))
    if steps.min() < 1:
        return len(gaps) / span
    frames = np.concatenate([[0], np.cumsum(steps)])
    gap, begin = np.polyfit(frames, times, 1)
    off = times - begin - gap * frames
    if np.abs(off).max() > DROPPED * usual:
        return len(gaps) / span
    whole = max(round(1 / gap), 1)
    likely = min((whole, whole / 1.001), key=lambda rate: abs(1 / rate - gap))
    error = float(np.sqrt(off @ off / len(off)) / np.linalg.norm(frames - frames.mean()))  # standard error of the gap
    return float(likely if abs(1 / likely - gap) <= 3 * error + ROUNDED * gap else 1 / gap)


def first_line(said: bytes) -> str:
    return (said.decode(errors="replace").strip().splitlines() or ["nothing"])[0]


class VideoWriter:
    """`with VideoWriter(path, width, height, fps) as video: video.write(bgr)`; the file is complete or absent. `matrix`: how
    colours are coded, which the file then says, such as bt709; empty = BT.601, unsaid, as computer vision reads them. `coding`:
    more of ffmpeg's options for it."""

    def __init__(
        self,
        path: Path,
        width: int,
        height: int,
        fps: float,
        crf: int = 20,
        preset: str = "medium",
        matrix: str = "",
        coding: tuple[str, ...] = (),
    ):
        self.path, self.shape, self.fps, self.crf, self.preset = Path(path), (height, width, 3), fps, crf, preset
        self.matrix, self.coding = matrix, coding

    def __enter__(self) -> VideoWriter:
        if not shutil.which(ffmpeg()):
            raise FileNotFoundError(NO_FFMPEG)
        height, width, _ = self.shape
        self._file = written_atomically(self.path)
        rate = Fraction(float(self.fps)).limit_denominator(NTSC)
        raw = ["-f", "rawvideo", "-pix_fmt", "bgr24", "-s", f"{width}x{height}", "-r", str(rate), "-i", "-"]
        # Colour of half the resolution needs even sizes.
        pixels = "yuv420p" if width % 2 == height % 2 == 0 else "yuv444p"
        coded = [
            "-an",
            "-c:v",
            "libx264",
            "-pix_fmt",
            pixels,
            "-crf",
            str(self.crf),
            "-preset",
            self.preset,
            *self.coding,
            "-movflags",
            "+faststart",
        ]
        if self.matrix:
            coded += ["-vf", f"scale=out_color_matrix={self.matrix}:out_range=tv", "-color_range", "tv"]
            for said in ("-colorspace", "-color_primaries", "-color_trc"):
                coded += [said, self.matrix]
        # Without -xerror ffmpeg calls a file success whose end did not fit on the disk.
        command = [ffmpeg(), "-loglevel", "error", "-xerror", "-y", *raw, *coded, as_file(self._file.__enter__())]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE)
        return self

    def write(self, picture: np.ndarray) -> None:
        if picture.shape != self.shape:
            raise ValueError(f"expected a picture of shape {self.shape}, found {picture.shape}")
        try:
            self._process.stdin.write(np.ascontiguousarray(picture).data)
        except BrokenPipeError:
            self._fail()

    def __exit__(self, kind, error, trace) -> None:
        if kind is not None:
            self._process.kill()
            self._process.communicate()
            self._file.__exit__(kind, error, trace)
            return
        _, message = self._process.communicate()
        if self._process.returncode or message.strip():
            self._fail(message)
        self._file.__exit__(None, None, None)

    def _fail(self, message: bytes = b"") -> None:
        message = message or self._process.communicate()[1]
        said = message.decode(errors="replace").strip().splitlines() or [f"exit status {self._process.returncode}"]
        failure = RuntimeError(f"{self.path}: cannot be written: ffmpeg says: {said[0]}")
        self._file.__exit__(RuntimeError, failure, None)
        raise failure
