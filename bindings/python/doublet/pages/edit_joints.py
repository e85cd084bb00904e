"""`doublet edit-joints SESSION`: a page on this machine on which the user moves joints and landmarks in the cameras' images."""

from __future__ import annotations

import io
import json
import math
from pathlib import Path

import numpy as np
from PIL import Image

from .. import _doublet as d
from ..common.files import read_json, write_json
from ..common.packaged import DATA
from ..common.scan_frame import scan_frame
from .page_server import LocalPage

PAGE = DATA / "edit_joints.html"
SHOWN_SIZE = 720  # px, larger side of an image on the page
BY_HAND = "corrected by hand"  # begins the comment then: no command replaces them unasked


def open_page(folder: Path, port: int = 0) -> LocalPage:
    session = d.Session(folder)
    if not session.markers.name:
        raise RuntimeError(f"{folder / 'session.json'}: names no joints; `doublet scan {folder}` makes them")
    shown, cameras = {}, []
    frames = d.FrameSource.open(session)
    frame = scan_frame(session)
    for index, full in enumerate(session.rig):
        camera = smaller(full)
        shown[f"/{index}.jpg"] = ("image/jpeg", photo(frames, frame, index, (camera.width, camera.height)))
        cameras.append(
            {
                "name": full.name,
                "size": [camera.width, camera.height],
                "K": np.asarray(camera.K).tolist(),
                "R": np.asarray(camera.R).tolist(),
                "t": np.ravel(camera.t).tolist(),
                "distortion": np.ravel(camera.distortion).tolist(),
            }
        )
    marks = read_marks(session.markers)
    content = {"name": str(session.markers), "cameras": cameras, **marks}
    shown["/joints.json"] = ("application/json", json.dumps(content).encode())
    largest = 10_000 + 200 * (len(marks["joints"]) + len(marks["landmarks"]))
    return LocalPage(PAGE, shown, "/joints", lambda body: save_joints(session.markers, body), largest, port)


def smaller(camera: d.Camera) -> d.Camera:
    scale = min(1.0, SHOWN_SIZE / max(camera.width, camera.height))
    return camera.resized(round(scale * camera.width), round(scale * camera.height))


def photo(frames: d.FrameSource, frame: int, camera: int, size: tuple[int, int]) -> bytes:
    """JPEG of an image, or of its mask where there is none."""
    image, mask = frames.image(camera, frame), frames.mask(camera, frame)
    shown = Image.new("L", size, 60)
    if image.size:
        shown = Image.fromarray(np.ascontiguousarray(image[..., ::-1])).resize(size)
    elif mask.size:
        shown = Image.fromarray(60 + mask // 3).resize(size)
    file = io.BytesIO()
    shown.save(file, "JPEG", quality=88)
    return file.getvalue()


def read_marks(path: Path) -> dict:
    """{"joints": {name: {"position", "parent"}}, "landmarks": {name: [x, y, z]}}, m."""
    content = read_json(path)
    joints = {name: {"position": j["position"], "parent": j.get("parent")} for name, j in content["joints"].items()}
    return {"joints": joints, "landmarks": content.get("landmarks") or {}}


def save_joints(path: Path, body: bytes) -> dict:
    """Writes the positions that the page sent, and in the comment that they are a person's; all else in the file stays. Raises
    ValueError saying what is wrong with them."""
    try:
        sent = json.loads(body)
        joints, landmarks = sent["joints"], sent["landmarks"]
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError('expected {"joints": {...}, "landmarks": {...}}') from error
    content = read_json(path)
    require_points(joints, content["joints"], "joints")
    require_points(landmarks, content.get("landmarks") or {}, "landmarks")
    before = json.dumps(content)
    for name, point in joints.items():
        content["joints"][name]["position"] = [round(x, 4) for x in point]
    for name, point in landmarks.items():
        content["landmarks"][name] = [round(x, 4) for x in point]
    comment = str(content.get("comment") or "")
    if json.dumps(content) != before and not comment.startswith(BY_HAND):
        content["comment"] = f"{BY_HAND}; {comment}" if comment else BY_HAND
    write_json(path, content)
    return {"saved": str(path)}


def require_points(sent, known: dict, what: str) -> None:
    if not isinstance(sent, dict) or sent.keys() != known.keys():
        raise ValueError(f"expected the {what} of the file, {', '.join(known)}")
    for name, point in sent.items():
        numbers = isinstance(point, list) and len(point) == 3 and all(type(x) in (int, float) and math.isfinite(x) for x in point)
        if not numbers:
            raise ValueError(f"{name}: expected three numbers, m")


def edit_joints(folder: Path, port: int = 0, browser: bool = True) -> None:
    """Serves the page until Ctrl-C."""
    with open_page(Path(folder), port) as page:
        page.run(browser)
