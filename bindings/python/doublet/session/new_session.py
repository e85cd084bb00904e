"""`doublet new-session`: videos, and a calibration or a person's keypoints -> a session folder, synchronised, upright, complete
or not there at all."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from .. import _doublet as d
from ..common.console import Console
from ..common.files import folder_written_atomically
from . import calibrate, check, synchronise
from .filmed_cameras import filmed_cameras
from .keypoints import filmed_keypoints
from .request import FilmedCamera, Request
from .session_writer import write_cameras, write_session
from .timing import common_rate, found_offsets, say_frames

PICTURE = "new_session.png"


@dataclass
class NewSession:
    """What was written, what was assumed, and what is doubtful about it."""

    folder: Path
    messages: list[str]
    findings: list[d.Finding]


def new_session(request: Request, console: Console | None = None) -> NewSession:
    """Writes the session folder, complete or not at all. Raises FileNotFoundError, ValueError or RuntimeError with one sentence
    that names file, expectation and finding; FileExistsError if the folder is there."""
    console, messages, findings = console or Console(), [], []
    require_inputs(request)
    refuse_existing(request)
    calibrate.require_one_way(request)
    cameras = filmed_cameras(request, console, messages)
    findings += doubtful_frames(cameras)
    fps = common_rate(request, cameras, messages)
    offsets = found_offsets(request, cameras, fps, console, messages, findings)
    sources, names = [camera.source for camera in cameras], [camera.name for camera in cameras]
    times = [source.times for source in sources]
    numbers = synchronise.frame_numbers(times, offsets, fps, request.start, request.frames, names)
    say_frames(cameras, times, offsets, numbers, fps, messages)
    seen = filmed_keypoints(request.keypoints, names, sources, numbers) if request.keypoints else None
    person = None if request.calibration else calibrate.PersonCalibrator(request, cameras, seen, messages)
    with folder_written_atomically(request.out) as folder:
        write_session(folder, request, cameras, numbers, fps, seen, console, messages)
        session = d.Session(folder)
        context = d.Context(progress=console.progress, log=messages.append)
        frames = d.FrameSource.open(session)
        extractor = d.session_silhouettes(session, frames, d.SilhouetteOptions(), context)
        console.finish()
        if person:
            findings += person.calibrate(cameras, frames, extractor, console, messages)
            write_cameras(folder, cameras)
            session = d.Session(folder)
        findings += check.check_and_draw(session, frames, extractor, folder / PICTURE).findings
    return NewSession(request.out, messages, findings)


def doubtful_frames(cameras: list[FilmedCamera]) -> list[d.Finding]:
    """Of cameras whose files say that their frames are two half images, whatever is in them."""
    halves = ", ".join(camera.name for camera in cameras if camera.source.interlaced)
    text = f"{halves}: expected whole frames, found interlaced video, whose outlines are combs where something moves"
    return [d.Finding(False, f"{text}; ffmpeg -i IN -vf bwdif=mode=send_frame OUT.mp4 makes whole ones")] if halves else []


def inputs(request: Request) -> list[Path]:
    single = [request.calibration, request.keypoints, request.scan, request.joints]
    return [*request.videos, *request.masks, *request.background, *filter(None, single)]


def require_inputs(request: Request) -> None:
    """Before videos are decoded for minutes."""
    for path in inputs(request):
        if not path.exists():
            raise FileNotFoundError(f"{path}: no such file or folder")


def refuse_existing(request: Request) -> None:
    out = request.out.resolve()  # what is written replaces it, whatever it is called
    for path in inputs(request):
        if any(place.is_relative_to(out) for place in (path.resolve(), path.parent.resolve() / path.name)):
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
