"""`doublet new-session`: videos and a calibration -> a session folder, synchronised, upright, complete or not there at all."""

from __future__ import annotations

import argparse
import math
import os
import shutil
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from PIL import Image

from .. import _doublet as d
from ..common.console import Console
from ..common.files import folder_written_atomically, write_json
from ..common.quality_checks import DOUBTFUL, Finding
from ..common.video import ImageSeries, VideoFile, VideoWriter, read_image, read_video
from . import check as session_check
from . import import_calibration, synchronise
from .camera_files import CameraFile, list_files, match
from .external_masks import KINDS, ReadyMasks, read_masks, require_count, require_plausible, require_size

PICTURE = "new_session.png"
CRF = 14  #: of libx264: what is coded a second time loses next to nothing
SQUEEZED = 1.1  #: how much more one axis may be scaled than the other
SAME_RATE = 1e-3  #: share by which frame rates may differ and be one
PLATE_FRAMES = 25  #: of a clean plate's video, whose median is taken


@dataclass
class Request:
    """What the user gave."""

    videos: list[Path]
    calibration: Path
    out: Path
    calibration_options: d.CalibrationOptions = field(default_factory=d.CalibrationOptions)
    scale_calibration: bool = False
    cameras: dict[str, Path] = field(default_factory=dict)  # name -> file
    without: list[str] = field(default_factory=list)
    sync: str = "auto"  # auto, none, sound, silhouettes
    offsets: dict[str, float] = field(default_factory=dict)  # name -> s
    fps: float | None = None
    start: float = 0.0  # s after the last camera has begun
    frames: int | None = None
    masks: list[Path] = field(default_factory=list)
    background: list[Path] = field(default_factory=list)
    scan: Path | None = None
    joints: Path | None = None
    name: str = ""
    copy: bool = False
    force: bool = False


@dataclass
class FilmedCamera:
    """A calibrated camera and what it filmed."""

    calibrated: d.CalibratedCamera
    source: VideoFile | ImageSeries
    upright: bool = True  # false: the calibration is that of the images as they are stored
    masks: ReadyMasks | None = None
    plate: CameraFile | None = None

    @property
    def name(self) -> str:
        return self.calibrated.camera.name

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of what is written, px."""
        return self.source.size if self.upright else self.source.stored_size


@dataclass
class Made:
    """What was written, what was assumed, and what is doubtful about it."""

    folder: Path
    said: list[str]
    findings: list[Finding]


def new_session(request: Request, console: Console | None = None) -> Made:
    """Writes the session folder, complete or not at all. Raises FileNotFoundError, ValueError or RuntimeError with one sentence
    that names file, expectation and finding; FileExistsError if the folder is there."""
    console, said, findings = console or Console(), [], []
    refuse_existing(request)
    cameras = filmed_cameras(request, console, said)
    fps = common_rate(request, cameras, said)
    offsets = found_offsets(request, cameras, fps, console, said, findings)
    times = [camera.source.times for camera in cameras]
    names = [camera.name for camera in cameras]
    numbers = synchronise.frame_numbers(times, offsets, fps, request.start, request.frames, names)
    say_frames(cameras, times, offsets, numbers, fps, said)
    with folder_written_atomically(request.out) as folder:
        write_session(folder, request, cameras, numbers, fps, console, said)
        session = d.Session(folder)
        findings += look(session, folder / PICTURE, console, said)
    return Made(request.out, said, findings)


def refuse_existing(request: Request) -> None:
    out = request.out.absolute()
    for path in [*request.videos, request.calibration, *request.masks, *request.background, request.scan, request.joints]:
        if path is not None and path.absolute().is_relative_to(out) and path.exists():
            raise ValueError(
                f"{path}: expected files outside of the new session {request.out}, found one inside; choose another folder"
            )
    if not out.exists():
        return
    if not out.is_dir() or (any(out.iterdir()) and not (out / "session.json").exists()):
        raise FileExistsError(
            f"{request.out}: expected a new folder or a session, found something else there; choose another name"
        )
    if any(out.iterdir()) and not request.force:
        raise FileExistsError(f"{request.out}: there is a session already; --force writes this one in its place")


# --- which file is which camera


def filmed_cameras(request: Request, console: Console, said: list[str]) -> list[FilmedCamera]:
    calibrated = chosen_cameras(request)
    names = [c.camera.name for c in calibrated]
    files = match(names, list_files(request.videos), request.cameras)
    masks = match(names, list_files(request.masks), what="mask series") if request.masks else {}
    plates = match(names, list_files(request.background, single_images=True), what="clean plate") if request.background else {}
    cameras = []
    for index, (name, camera) in enumerate(zip(names, calibrated)):
        source = read_source(files[name], request.fps)
        said.append(f"{name}: {source.path}, {describe(source)}")
        cameras.append(fitted(camera, source, request.scale_calibration, said))
        cameras[-1].plate = plates.get(name)
        if name in masks:
            cameras[-1].masks = checked_masks(masks[name], cameras[-1])
        console.progress("reading", (index + 1) / len(names))
    console.finish()
    if masks:
        kinds = sorted({camera.masks.kind for camera in cameras})
        said += [f"masks: the actor is {KINDS[kind]}" for kind in kinds]
    return cameras


def chosen_cameras(request: Request) -> list[d.CalibratedCamera]:
    calibrated = d.read_calibration(request.calibration, request.calibration_options)
    names = [c.camera.name for c in calibrated]
    for flag, given in (("--without", request.without), ("--offset", request.offsets)):
        for name in given:
            if name not in names:
                raise ValueError(f"{flag} {name}: expected one of the calibration's cameras {', '.join(names)}")
    if not set(names) - set(request.without):
        raise ValueError("--without: expected a camera that is left, found none")
    return [c for c in calibrated if c.camera.name not in request.without]


def read_source(file: CameraFile, fps: float | None) -> VideoFile | ImageSeries:
    if not file.images:
        return read_video(file.path)
    if not fps:
        raise ValueError(f"{file.path}: expected the frame rate of the images, which they do not say: --fps")
    if len({image.suffix for image in file.images}) > 1:
        raise ValueError(
            f"{file.path}: expected images of one format, found {', '.join(sorted({i.suffix for i in file.images}))}"
        )
    return ImageSeries(file.path, file.images, fps)


def describe(source: VideoFile | ImageSeries) -> str:
    turned = {
        0: "",
        90: ", turned by 90 degrees to the left",
        180: ", turned by 180 degrees",
        270: ", turned by 90 degrees to the right",
    }
    return (
        f"{source.size[0]} x {source.size[1]}, {len(source.times)} frames at {source.fps:.5g} a second{turned[source.rotation]}"
    )


def checked_masks(file: CameraFile, camera: FilmedCamera) -> ReadyMasks:
    masks = read_masks(file.path, file.images)
    require_count(masks, len(camera.source.times))
    require_size(masks.source.size, camera.size, str(masks.source.path))
    return masks


# --- the calibration's images and the video's


def fitted(calibrated: d.CalibratedCamera, source, squeezed: bool, said: list[str]) -> FilmedCamera:
    """The camera for the images as they will be written. Raises ValueError if they are no scaled ones of the calibration's."""
    camera = calibrated.camera
    for upright in (True, False):
        width, height = source.size if upright else source.stored_size
        factor = common_factor((camera.width, camera.height), (width, height))
        if factor:
            if not upright:
                said.append(
                    f"{camera.name}: the calibration is that of the images as they are stored; the file's rotation is left out"
                )
            if (width, height) != (camera.width, camera.height):
                said.append(f"{camera.name}: calibration of {camera.width} x {camera.height} scaled by {factor:.4g}")
            return FilmedCamera(d.CalibratedCamera(camera.resized(width, height), calibrated.lens), source, upright)
    width, height = source.size
    across, down = width / camera.width, height / camera.height
    close = max(across / down, down / across) < SQUEEZED
    if squeezed and close:
        said.append(
            f"{camera.name}: calibration of {camera.width} x {camera.height} scaled by {across:.4g} across, {down:.4g} down"
        )
        return FilmedCamera(d.CalibratedCamera(camera.resized(width, height), calibrated.lens), source)
    turned = common_factor((camera.height, camera.width), (width, height))
    advice = "; the video lies on its side, turn it" if turned else ""
    if close:
        advice = "; if it was squeezed to this size, and not cropped, --scale-calibration scales each axis by itself"
    raise ValueError(
        f"{source.path}: expected {camera.width} x {camera.height} pixels as the calibration of camera '{camera.name}' says, "
        f"or these scaled, found {width} x {height}{advice}"
    )


def common_factor(before: tuple[int, int], after: tuple[int, int]) -> float:
    """By which both sides are scaled, to a pixel; 0 = there is none."""
    across, down = after[0] / before[0], after[1] / before[1]
    same = abs(after[0] - before[0] * down) <= 1 or abs(after[1] - before[1] * across) <= 1
    return math.sqrt(across * down) if same else 0.0


# --- when


def common_rate(request: Request, cameras: Sequence[FilmedCamera], said: list[str]) -> float:
    if request.fps is not None and not 0 < request.fps < 1e4:
        raise ValueError(f"--fps: expected frames a second above 0, found {request.fps:g}")
    rates = [camera.source.fps for camera in cameras]
    for camera, rate in zip(cameras, rates):
        if not rate and not request.fps:
            raise ValueError(f"{camera.source.path}: expected a frame rate above 0, found none in a single frame; give it: --fps")
    fps = request.fps or round(min(rates), 3)
    other = [f"{c.name} ({rate:.5g})" for c, rate in zip(cameras, rates) if abs(rate - fps) > SAME_RATE * fps]
    if other:
        said.append(f"{fps:.5g} frames a second, the nearest frame of cameras of another rate: {', '.join(other)}")
    return fps


def found_offsets(
    request: Request, cameras: Sequence[FilmedCamera], fps: float, console: Console, said: list[str], findings: list[Finding]
) -> np.ndarray:
    """(C) s, those that are given and those that are found between the other cameras."""
    open_cameras = [camera for camera in cameras if camera.name not in request.offsets]
    found = dict(request.offsets)
    if request.sync != "none" and len(open_cameras) > 1:
        result = synchronised(request.sync, open_cameras, fps, console, said, findings)
        found.update(zip([camera.name for camera in open_cameras], result))
    elif request.sync == "none" and open_cameras:
        said.append(f"{', '.join(camera.name for camera in open_cameras)}: taken as synchronous, as --sync none says")
    offsets = np.array([found.get(camera.name, 0.0) for camera in cameras])
    for camera, offset in zip(cameras, offsets):
        if offset or camera.name in request.offsets:
            given = " (given)" if camera.name in request.offsets else ""
            said.append(f"{camera.name}: began at {offset:+.3f} s on the common clock{given}")
    return offsets


def synchronised(
    method: str, cameras: Sequence[FilmedCamera], fps: float, console: Console, said: list[str], findings: list[Finding]
) -> np.ndarray:
    """(C) s, the first camera's 0; all 0 and a finding if they are not to be trusted."""
    silent = [camera for camera in cameras if camera.source.sound_start is None]
    if method == "sound" and silent:
        raise ValueError(f"{silent[0].source.path}: expected a sound track as --sync sound needs, found none")
    reasons = []
    for way in ("sound", "silhouettes") if method == "auto" else (method,):
        if way == "sound" and silent:
            continue
        result = offsets_by(way, cameras, fps, console)
        if result.trusted:
            said.append(f"synchronised by {way}: {result.reason}")
            return result.seconds
        reasons.append(f"{way}: {result.reason}")
    text = f"synchronisation: expected videos that tell by how much they are apart, found {'; '.join(reasons)}"
    advice = "; they are taken as synchronous, give what you know: --offset CAMERA=SECONDS, or --sync none"
    findings.append(Finding(False, text + advice))
    return np.zeros(len(cameras))


def offsets_by(way: str, cameras: Sequence[FilmedCamera], fps: float, console: Console) -> synchronise.Offsets:
    signals = []
    for index, camera in enumerate(cameras):
        if way == "sound":
            signals.append(synchronise.sound_signal(camera.source))
        elif camera.masks:
            small = synchronise.preview_size(camera.size)
            signals.append(synchronise.mask_signal(camera.source.times, camera.masks.masks(small)))
        else:
            signals.append(synchronise.video_signal(camera.source))
        console.progress(way, (index + 1) / len(cameras))
    if way == "sound":
        options = synchronise.SOUND_CLEAR, synchronise.SOUND_APART, 0.5 / fps
    else:
        options = synchronise.SIGHT_CLEAR, synchronise.SIGHT_APART, 1 / fps
    result = synchronise.find_offsets(signals, *options, [camera.name for camera in cameras])
    console.finish()
    return result


def say_frames(cameras, times, offsets, numbers: np.ndarray, fps: float, said: list[str]) -> None:
    seconds = np.array([t[n] + o for t, n, o in zip(times, numbers, offsets)])
    apart = float(np.ptp(seconds, axis=0).max())
    where = f"in which all {len(cameras)} cameras film, at most {1000 * apart:.0f} ms from each other"
    said.append(f"{numbers.shape[1]} frames at {fps:.5g} a second, {where}")
    for camera, n in zip(cameras, numbers):
        if (np.diff(n) == 0).any():
            said.append(f"{camera.name}: {int((np.diff(n) == 0).sum())} frames are shown twice, it has fewer")


# --- writing


def write_session(
    folder: Path,
    request: Request,
    cameras: Sequence[FilmedCamera],
    numbers: np.ndarray,
    fps: float,
    console: Console,
    said: list[str],
) -> None:
    d.write_calibration(folder / "calibration.yml", [camera.calibrated for camera in cameras])
    described, kept = [], []
    for index, (camera, chosen) in enumerate(zip(cameras, numbers)):

        def report(share: float, index: int = index) -> None:
            console.progress("writing", (index + share) / len(cameras))

        entry = {"name": camera.name}
        entry["video"] = write_frames(folder, camera, chosen, fps, request.copy, report)
        if is_kept(camera, chosen, fps):
            kept.append(camera.name)
            if first := first_frame(camera, chosen):
                entry["first_frame"] = first
        if camera.masks:
            start = entry.get("first_frame", 0)
            entry["masks"] = write_masks(folder, camera, np.r_[np.arange(start), chosen], report)
        if camera.plate:
            entry["background"] = write_plate(folder, camera, said)
        described.append(entry)
    console.finish()
    coded = [camera.name for camera in cameras if camera.name not in kept]
    said += [f"as they were filmed: {', '.join(kept)}"] if kept else []
    said += [f"coded anew: {', '.join(coded)}"] if coded else []
    session = {
        "name": request.name or request.out.absolute().name,
        "fps": fps,
        "frame_count": numbers.shape[1],
        "cameras": described,
    }
    session["calibration"] = "calibration.yml"
    for key, path in (("scan", request.scan), ("markers", request.joints)):
        if path:
            session[key] = ("scan" if key == "scan" else "joints") + path.suffix
            take(path, folder / session[key], copy=True)
    write_json(folder / "session.json", session)


def is_kept(camera: FilmedCamera, chosen: np.ndarray, fps: float) -> bool:
    """Nothing has to change: images may be chosen one by one, of a video no frame is left out after the first that is used."""
    if isinstance(camera.source, ImageSeries):
        return True
    same_rate = abs(camera.source.fps - fps) <= SAME_RATE * fps
    return same_rate and not camera.source.rotation and bool((np.diff(chosen) == 1).all())


def first_frame(camera: FilmedCamera, chosen: np.ndarray) -> int:
    """Of a file that is kept: the frame that is the session's frame 0."""
    return 0 if isinstance(camera.source, ImageSeries) else int(chosen[0])


def write_frames(folder: Path, camera: FilmedCamera, chosen: np.ndarray, fps: float, copy: bool, report) -> str:
    """Returns the name in session.json."""
    if isinstance(camera.source, ImageSeries):
        suffix = camera.source.files[0].suffix
        for frame, number in enumerate(chosen):
            take(camera.source.files[number], folder / "videos" / camera.name / f"{frame:04d}{suffix}", copy)
        return f"videos/{camera.name}/%04d{suffix}"
    if is_kept(camera, chosen, fps):
        name = f"videos/{camera.name}{camera.source.path.suffix}"
        take(camera.source.path, folder / name, copy)
        return name
    name = f"videos/{camera.name}.mp4"
    with VideoWriter(folder / name, *camera.size, fps, CRF) as video:
        for frame in chosen_frames(camera.source.frames(upright=camera.upright), chosen, report):
            video.write(frame)
    return name


def chosen_frames(frames, chosen: np.ndarray, report):
    """Those whose numbers (T, rising) are chosen, some of them more than once; stops reading after the last."""
    with ExitStack() as stack:
        stack.callback(getattr(frames, "close", lambda: None))
        wanted = 0
        for number, frame in enumerate(frames):
            while wanted < len(chosen) and chosen[wanted] == number:
                yield frame
                wanted += 1
            report(wanted / len(chosen))
            if wanted == len(chosen):
                return


def take(path: Path, target: Path, copy: bool) -> None:
    """A hard link where the disk allows one and no copy is wanted."""
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such file")
    target.parent.mkdir(parents=True, exist_ok=True)
    if not copy:
        try:
            os.link(path.resolve(), target)
            return
        except OSError:
            pass  # another disk, or one without links
    shutil.copyfile(path, target)


def write_masks(folder: Path, camera: FilmedCamera, chosen: np.ndarray, report) -> str:
    where, shares = str(camera.masks.source.path), []
    target = folder / "masks" / camera.name
    target.mkdir(parents=True)
    for frame, mask in enumerate(chosen_frames(camera.masks.masks(), chosen, report)):
        require_size(mask.shape[::-1], camera.size, where)
        shares.append(mask.mean())
        Image.fromarray(mask.astype(np.uint8) * 255).save(target / f"{frame:04d}.png")
    require_plausible(np.array(shares), where)
    return f"masks/{camera.name}/%04d.png"


def write_plate(folder: Path, camera: FilmedCamera, said: list[str]) -> str:
    name = f"background/{camera.name}.png"
    plate = plate_of(camera.plate.path)
    if plate.size != camera.size:
        stored = common_factor(plate.size, camera.size)
        across, down = camera.size[0] / plate.width, camera.size[1] / plate.height
        if not stored and not max(across / down, down / across) < SQUEEZED:
            found = f"found {plate.width} x {plate.height}"
            raise ValueError(
                f"{camera.plate.path}: expected {camera.size[0]} x {camera.size[1]} pixels as the video has, {found}"
            )
        said.append(f"{camera.name}: clean plate of {plate.width} x {plate.height} scaled to the video's size")
        plate = plate.resize(camera.size, Image.BICUBIC)
    (folder / name).parent.mkdir(exist_ok=True)
    plate.save(folder / name)
    return name


def plate_of(path: Path) -> Image.Image:
    """An image, or the median of a video's frames."""
    try:
        return read_image(path).convert("RGB")
    except RuntimeError:
        video = read_video(path)
    chosen = np.unique(np.linspace(0, len(video.times) - 1, PLATE_FRAMES).round().astype(int))
    frames = list(chosen_frames(video.frames(), chosen, lambda share: None))
    return Image.fromarray(np.median(frames, axis=0).astype(np.uint8)[..., ::-1])


# --- looking at it


def look(session: d.Session, path: Path, console: Console, said: list[str]) -> list[Finding]:
    """Draws frame 0 of every camera with its silhouette; returns what is doubtful."""
    context = d.Context(progress=console.progress, log=said.append)
    frames = d.FrameSource.open(session)
    extractor = d.session_silhouettes(session, frames, d.SilhouetteOptions(), context)
    console.finish()
    evidence = session_check.Evidence(session, frames, extractor)
    return session_check.look(evidence, path)


# --- the command


def pair(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not (name and equals and value):
        raise argparse.ArgumentTypeError(f"expected NAME=VALUE, found '{text}'")
    return name, value


def offset(text: str) -> tuple[str, float]:
    name, value = pair(text)
    try:
        seconds = float(value)
    except ValueError:
        seconds = math.nan
    if not math.isfinite(seconds):
        raise argparse.ArgumentTypeError(f"expected CAMERA=SECONDS, found '{text}'")
    return name, seconds


def add_command(commands, common_flags) -> None:
    text = "videos and a calibration -> a session folder: matched, synchronised, upright"
    command = commands.add_parser("new-session", help=text, description=text)
    flag = command.add_argument
    flag(
        "videos",
        type=Path,
        nargs="+",
        metavar="VIDEO",
        help="a video or a folder of images for each camera, or one folder of them",
    )
    flag("--calibration", type=Path, required=True, metavar="FILE", help="any that import-calibration reads")
    flag("-o", "--out", type=Path, required=True, metavar="SESSION", help="the new folder")
    many = {"nargs": "+", "action": "extend", "default": []}
    text = "which file is this camera's, where the names do not tell"
    flag("--camera", type=pair, metavar="NAME=FILE", help=text, **many)
    flag("--without", metavar="NAME", help="calibrated cameras to leave out", **many)
    flag("--sync", choices=("auto", "none", "sound", "silhouettes"), default="auto", help="how offsets are found (default: auto)")
    flag("--offset", type=offset, metavar="CAMERA=SECONDS", help="by which it begins after the others; wins over --sync", **many)
    flag("--fps", type=float, metavar="X", help="common frame rate (default: the lowest)")
    flag("--start", type=float, default=0.0, metavar="SECONDS", help="after the last camera has begun (default: 0)")
    flag("--frames", type=int, metavar="N", help="default: as long as all cameras film")
    flag("--masks", type=Path, metavar="PATH", help="ready silhouettes: videos, folders of images, or one folder of them", **many)
    flag("--background", type=Path, metavar="PATH", help="clean plates: an image or a video for each camera, or a folder", **many)
    flag("--scan", type=Path, metavar="FILE", help="scan of the dressed actor, if there is one")
    flag("--joints", type=Path, metavar="FILE", help="its joints.json, if there is one")
    flag("--name", default="", metavar="TEXT", help="of the session (default: that of the folder)")
    flag("--scale-calibration", action="store_true", help="where a video was squeezed: scale each axis by itself")
    flag("--copy", action="store_true", help="copy videos that need no change (default: hard links where the disk allows them)")
    flag("--force", action="store_true", help="put it in the place of the session that is there")
    import_calibration.add_flags(command)
    common_flags(command)
    command.set_defaults(run=run, when_stopped="nothing was written")


def request_of(arguments: argparse.Namespace) -> Request:
    named = {"cameras": [(name, Path(file)) for name, file in arguments.camera], "offsets": arguments.offset}
    for flag, pairs in (("--camera", named["cameras"]), ("--offset", named["offsets"])):
        names = [name for name, _ in pairs]
        if len(set(names)) < len(names):
            raise ValueError(f"{flag}: expected every camera once, found {', '.join(names)}")
    same = ("videos", "calibration", "out", "scale_calibration", "without", "sync", "fps", "start", "frames", "masks")
    same += ("background", "scan", "joints", "name", "copy", "force")
    return Request(
        **{name: getattr(arguments, name) for name in same},
        **{name: dict(pairs) for name, pairs in named.items()},
        calibration_options=import_calibration.options_of(arguments),
    )


def run(arguments: argparse.Namespace) -> int:
    console = Console(arguments.threads, quiet=arguments.quiet, verbose=arguments.verbose)
    made = new_session(request_of(arguments), console)
    print(*made.said, sep="\n")
    print(f"{made.folder / PICTURE}: look at it")
    session = d.Session(made.folder)
    if not session.scan.name or not session.markers.name:
        print(f"next: doublet scan {made.folder}   # scan and joints, from the cameras")
    print(f"next: doublet check {made.folder} -o OUT, doublet reconstruct {made.folder} -o OUT")
    for finding in made.findings:
        print(f"doublet: {finding.level}: {finding.text}", file=sys.stderr)
    return DOUBTFUL if made.findings else 0
