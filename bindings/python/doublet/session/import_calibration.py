"""Cameras of another program, in words by which a wrong unit or axis is seen."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from .. import _doublet as d


def distances(cameras: list[d.CalibratedCamera]) -> str:
    """How far the cameras are from each other, in words."""
    pairs = [np.linalg.norm(a.camera.centre - b.camera.centre) for a, b in combinations(cameras, 2)]
    return f", {min(pairs):.2f} to {max(pairs):.2f} m from each other" if pairs else ""


def camera_line(calibrated: d.CalibratedCamera) -> str:
    """A line about a camera, by which a wrong unit or axis is seen."""
    camera, lens = calibrated.camera, calibrated.lens
    terms = (
        f"{len(lens.distortion)} terms" + (" of a fisheye" if lens.fisheye else "")
        if lens.needs_undistortion
        else "up to 5 terms"
    )
    height, focal = camera.centre[1], camera.K[0, 0]
    note = "; frames are undistorted when they are read" if lens.needs_undistortion else ""
    return (
        f"{camera.name}: {camera.width} x {camera.height}, focal length {focal:.1f} px, at height {height:.2f} m, {terms}{note}"
    )
