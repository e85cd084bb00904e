"""What a take says about its cameras."""

from __future__ import annotations

import numpy as np

from .. import _doublet as d
from .results import CALIBRATION
from .workspace import Workspace


def rounded(camera: d.RefinedCamera) -> dict:
    """Numbers to as many digits as matter."""
    return {
        "camera": camera.camera,
        "seen": camera.seen,
        "moved_mm": round(1000 * camera.moved, 2),
        "sure_mm": round(1000 * camera.sure, 2),
        "turned_degrees": round(camera.turned, 4),
        "shifted_mm": round(1000 * camera.shifted, 2),
        "focal_percent": round(100 * camera.focal, 3),
        "late_frames": round(camera.late, 3),
        "late_sure_frames": round(camera.late_sure, 3),
    }


def write(job: Workspace, result: d.CaptureResult) -> None:
    """calibration.yml of OUT, which all later stages go by; none if the session's calibration is as good."""
    path = job.path(CALIBRATION)
    if not result.summary.cameras_refined:
        path.unlink(missing_ok=True)
        return
    filmed = d.filmed(job.session, result)
    cameras = [d.CalibratedCamera(c, lens, own.late) for c, lens, own in zip(filmed.rig, filmed.lenses, filmed.cameras)]
    d.write_calibration(path, cameras)
    moved = np.sqrt(np.mean([camera.moved**2 for camera in result.summary.cameras if camera.seen]))
    late = [f"{camera.camera} by {camera.delay}" for camera in result.summary.cameras if camera.delay]
    job.console.finish()
    job.console.say(
        f"performance: the calibration was {1000 * moved:.1f} mm off on the actor"
        + (f", and frames late: {', '.join(late)}" if late else "")
        + f"; {path} has the refined cameras"
    )
