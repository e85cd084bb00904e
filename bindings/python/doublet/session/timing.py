"""When each camera began, and which of its frames are those of the session."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .. import _doublet as d
from ..common.console import Console
from . import synchronise
from .request import FilmedCamera, Request

SAME_RATE = 1e-3  #: share by which frame rates may differ and be one


def common_rate(request: Request, cameras: Sequence[FilmedCamera], messages: list[str]) -> float:
    if request.fps is not None and not 0 < request.fps < 1e4:
        raise ValueError(f"--fps: expected frames a second above 0, found {request.fps:g}")
    rates = [camera.source.fps for camera in cameras]
    for camera, rate in zip(cameras, rates):
        if not rate and not request.fps:
            raise ValueError(f"{camera.source.path}: expected a frame rate above 0, found none in a single frame; give it: --fps")
    fps = request.fps or round(min(rates), 3)
    other = [f"{c.name} ({rate:.5g})" for c, rate in zip(cameras, rates) if abs(rate - fps) > SAME_RATE * fps]
    if other:
        messages.append(f"{fps:.5g} frames a second, the nearest frame of cameras of another rate: {', '.join(other)}")
    return fps


def found_offsets(
    request: Request,
    cameras: Sequence[FilmedCamera],
    fps: float,
    console: Console,
    messages: list[str],
    findings: list[d.Finding],
) -> np.ndarray:
    """(C) s, those that are given and those that are found between the other cameras."""
    open_cameras = [camera for camera in cameras if camera.name not in request.offsets]
    found = dict(request.offsets)
    if request.sync != "none" and len(open_cameras) > 1:
        result = synchronised(request.sync, open_cameras, fps, console, messages, findings)
        found.update(zip([camera.name for camera in open_cameras], result))
    elif request.sync == "none" and open_cameras:
        messages.append(f"{', '.join(camera.name for camera in open_cameras)}: taken as synchronous, as --sync none says")
    offsets = np.array([found.get(camera.name, 0.0) for camera in cameras])
    for camera, offset in zip(cameras, offsets):
        if offset or camera.name in request.offsets:
            given = " (given)" if camera.name in request.offsets else ""
            messages.append(f"{camera.name}: began at {offset:+.3f} s on the common clock{given}")
    return offsets


def synchronised(
    method: str, cameras: Sequence[FilmedCamera], fps: float, console: Console, messages: list[str], findings: list[d.Finding]
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
            messages.append(f"synchronised by {way}: {result.reason}")
            return result.seconds
        reasons.append(f"{way}: {result.reason}")
    text = f"synchronisation: expected videos that tell by how much they are apart, found {'; '.join(reasons)}"
    advice = "; they are taken as synchronous, give what you know: --offset CAMERA=SECONDS, or --sync none"
    findings.append(d.Finding(False, text + advice))
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


def say_frames(cameras, times, offsets, numbers: np.ndarray, fps: float, messages: list[str]) -> None:
    seconds = np.array([t[n] + o for t, n, o in zip(times, numbers, offsets)])
    apart = float(np.ptp(seconds, axis=0).max())
    where = f"in which all {len(cameras)} cameras film, at most {1000 * apart:.0f} ms from each other"
    messages.append(f"{numbers.shape[1]} frames at {fps:.5g} a second, {where}")
    for camera, n in zip(cameras, numbers):
        if (np.diff(n) == 0).any():
            messages.append(f"{camera.name}: {int((np.diff(n) == 0).sum())} frames are shown twice, it has fewer")
