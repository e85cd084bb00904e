"""Joints in the images, as OpenPose, RTMPose, AlphaPose, YOLO or MediaPipe find them: their files, what a session keeps of them,
and where they are in space."""

from __future__ import annotations

import re
import shutil
from collections.abc import Sequence
from itertools import zip_longest
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import numpy as np

from .. import _doublet as d
from ..common.files import read_json, require_file, written_atomically
from ..common.images import MOST_NUMBER, ImageSeries, counted, in_order, numbers_of
from ..common.video import VideoFile, read_video
from .camera_files import VIDEOS, CameraFile, match, visible

#: In the order of kKeypointNames (doublet/capture/keypoints.h).
JOINTS = [f"{side}_{joint}" for joint in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle") for side in "lr"]
#: Index of JOINTS in the lists that programs write, told apart by their length.
_COCO = (5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16)
_GOLIATH = (5, 6, 7, 8, 62, 41, 9, 10, 11, 12, 13, 14)
LAYOUTS = {
    17: _COCO,
    18: (5, 2, 6, 3, 7, 4, 11, 8, 12, 9, 13, 10),  # OpenPose COCO
    25: (5, 2, 6, 3, 7, 4, 12, 9, 13, 10, 14, 11),  # OpenPose BODY_25
    26: _COCO,  # Halpe: COCO and feet
    33: (11, 12, 13, 14, 15, 16, 23, 24, 25, 26, 27, 28),  # MediaPipe
    70: _GOLIATH,  # SAM 3D Body
    133: _COCO,  # COCO whole body
    136: _COCO,  # Halpe with face and hands
    308: _GOLIATH,  # Sapiens
}
LEAST_AGREED = 6  #: of JOINTS
SURE = 0.3  #: confidence from which a joint counts
LEAST_SIZE = 2  #: pixels that a person is across; nobody is as many metres
FILE = "keypoints.npz"  #: of a session: for each camera (T, 12, 3) of its video
FORMATS = (
    "a list of frames or people (AlphaPose), instance_info (RTMPose), a folder of people (OpenPose) or labels (YOLO) by frame"
)


def triangulated(session: d.Session, path: Path, frame: int) -> dict[str, np.ndarray]:
    """name -> (3) m: the joints that two cameras or more agree on at a frame of the session, by a folder of keypoints of its
    videos. Raises FileNotFoundError or ValueError naming file, expectation and finding."""
    return agreed_at(session, Path(path), frame, keypoints_of_videos(session, Path(path), []))


def kept_joints(session: d.Session, frame: int) -> dict[str, np.ndarray]:
    """As triangulated(), by the keypoints that the session keeps."""
    frames = d.FrameSource.open(session)
    seen = [frames.keypoints(camera, frame) for camera in range(frames.camera_count)]
    known = [camera for camera, points in enumerate(seen) if len(points)]
    cameras = [d.CalibratedCamera(session.rig[camera]) for camera in known]
    return agreed(cameras, [seen[camera] for camera in known], f"{session.keypoints}: frame {frame}")


def agreed(cameras: Sequence[d.CalibratedCamera], seen: Sequence[np.ndarray], where: str) -> dict[str, np.ndarray]:
    points = {name: d.triangulate(cameras, [s[i] for s in seen]) for i, name in enumerate(JOINTS)}
    found = {name: point for name, point in points.items() if point is not None}
    if len(found) < LEAST_AGREED:
        raise ValueError(
            f"{where}: expected at least {LEAST_AGREED} joints that two cameras agree on, found {len(found)}; are these "
            "keypoints of the session's videos, in pixels, from their first frame on?"
        )
    return found


def filmed_keypoints(
    path: Path, names: Sequence[str], sources: Sequence[VideoFile | ImageSeries], numbers: Sequence[np.ndarray]
) -> list[np.ndarray]:
    """(T, 12, 3) pixel and confidence of JOINTS for each camera, at these frames of its video. `path`: a folder with a file or a
    folder of JSON for each, of all frames of its video, in pixels as it was filmed. Raises FileNotFoundError or ValueError naming
    file, expectation and finding."""
    counts = [len(source.times) for source in sources]
    images = [numbers_of([file.stem for file in getattr(source, "files", ())]) for source in sources]
    read = read_keypoints(path, names, counts, [source.size for source in sources], images)
    return [np.stack([keypoints.of(int(number)) for number in chosen]) for keypoints, chosen in zip(read, numbers)]


def write_keypoints(folder: Path, names: Sequence[str], seen: Sequence[np.ndarray]) -> str:
    """Writes the file of a session, `seen` being of all frames of its videos; returns its name in session.json."""
    with written_atomically(folder / FILE) as path, ZipFile(path, "w", ZIP_DEFLATED) as file:  # np.savez has names of its own
        for name, frames in zip(names, seen):
            with file.open(f"{name}.npy", "w") as array:
                np.lib.format.write_array(array, frames.astype(np.float32))
    return FILE


def adopt_keypoints(session: d.Session, path: Path, frame: int, messages: list[str]) -> str:
    """Writes the file of a session that is there, of keypoints of its videos; returns its name in session.json. Nobody was seen
    in frames behind the last one that a camera has keypoints of. Raises ValueError where cameras do not agree at `frame`."""
    seen = keypoints_of_videos(session, path, messages)
    agreed_at(session, path, frame, seen)
    return write_keypoints(Path(session.folder), [camera.name for camera in session.cameras], seen)


def keypoints_of_videos(session: d.Session, path: Path, messages: list[str]) -> list[np.ndarray]:
    """For each camera (T, 12, 3), of all frames of its video that the session has; zeros where it has no keypoints."""
    names = [camera.name for camera in session.cameras]
    counts = [camera.first_frame + session.frame_count for camera in session.cameras]
    whole_videos = [filmed_frames(camera, count) for camera, count in zip(session.cameras, counts)]
    sizes = [(camera.width, camera.height) for camera in session.rig]
    seen = []
    for keypoints, count in zip(read_keypoints(path, names, whole_videos, sizes), counts):
        known = min(count, keypoints.count)
        if known < count:
            messages.append(f"{keypoints.path}: keypoints of {known} of {count} frames")
        whole = np.zeros((count, len(JOINTS), 3))
        for number in range(known):
            whole[number] = keypoints.of(number)
        seen.append(whole)
    return seen


def filmed_frames(camera: d.SessionCamera, used: int) -> int:
    """How many frames a camera's video has, of which a session may use fewer; `used` where nothing can tell."""
    is_video = camera.video.suffix.lower() in VIDEOS and shutil.which("ffprobe")
    return len(read_video(camera.video).times) if is_video else used


def agreed_at(session: d.Session, path: Path, frame: int, seen: Sequence[np.ndarray]) -> dict[str, np.ndarray]:
    lenses = session.lenses or [d.Lens()] * len(session.rig)
    cameras = [d.CalibratedCamera(camera, lens) for camera, lens in zip(session.rig, lenses)]
    at = [shown_at(frame, whole, camera, session.frame_count) for whole, camera in zip(seen, session.cameras)]
    return agreed(cameras, at, f"{path}: frame {frame}")


def shown_at(frame: int, whole: np.ndarray, camera: d.SessionCamera, frame_count: int) -> np.ndarray:
    """(12, 3) of a session's frame, which a late camera shows later, and not at all where it was not filming."""
    own = frame + camera.late
    return whole[camera.first_frame + own] if 0 <= own < frame_count else np.zeros_like(whole[0])


# --- files


def list_keypoints(path: Path) -> list[CameraFile]:
    if not path.is_dir():
        raise FileNotFoundError(f"{path}: expected a folder with the keypoints of each camera, found none")
    entries = [p for p in visible(path) if p.suffix == ".json" or (p.is_dir() and files_of_frames(p))]
    if not entries:
        raise FileNotFoundError(f"{path}: expected a JSON file, or a folder of them, for each camera, found none")
    return [CameraFile(p.stem, file_of_all(p)) for p in entries]


def files_of_frames(folder: Path) -> list[Path]:
    """OpenPose's, or the labels of YOLO."""
    return visible(folder, "*.json") or visible(folder, "*.txt")


def file_of_all(path: Path) -> Path:
    """The only file in a camera's folder, where it is of a whole video, as AlphaPose and MMPose write it; else the path."""
    files = visible(path, "*.json") if path.is_dir() else []
    return files[0] if len(files) == 1 and is_of_video(read_json(files[0])) else path


def is_of_video(content) -> bool:
    """Frames, not the people of one."""
    entries = content.get("instance_info") if isinstance(content, dict) else content
    entries = entries if isinstance(entries, list) else []
    return bool(entries) and all(isinstance(entry, dict) and ("image_id" in entry or "frame_id" in entry) for entry in entries)


def match_keypoints(names: Sequence[str], path: Path) -> dict[str, CameraFile]:
    return match(names, list_keypoints(path), what="file or folder of keypoints")


def read_keypoints(
    path: Path,
    names: Sequence[str],
    counts: Sequence[int],
    sizes: Sequence[tuple[int, int]],
    images: Sequence[Sequence[int]] = (),
) -> list[CameraKeypoints]:
    """Of cameras whose videos have so many frames of this width and height, or images of such numbers. Programs count frames from
    0 or from 1, and leave out those at the beginning in which they see nobody. Numbers that a video does not have begin with
    it."""
    files = match_keypoints(names, path)
    seen = [CameraKeypoints(files[name].path, size) for name, size in zip(names, sizes)]
    beyond = [max(keypoints.stated, default=0) + 1 - count for keypoints, count in zip(seen, counts)]
    least = min(min(keypoints.stated, default=0) for keypoints in seen)
    usual = least if least < 2 else int(1 in beyond)
    for keypoints, excess, named in zip_longest(seen, beyond, images, fillvalue=()):
        begin = 0 if keypoints.counts_from_0 else usual
        if not keypoints.are_of(named) and excess <= begin:
            keypoints.numbers = np.array(keypoints.stated) - begin
    return seen


class CameraKeypoints:
    """Of a camera's video: `numbers` (N) are its frames, those that the files state, from the first on. Raises ValueError for a
    file that has none."""

    def __init__(self, path: Path, size: tuple[int, int]):
        self.path, self.size, self.layout = path, size, None
        if path.is_dir():
            self.frames = in_order(files_of_frames(path))
            names = [file.stem for file in self.frames]
            self.stated, numbers = rising(numbers_of(names)), counted(names)
        else:
            content = read_json(path)
            self.frames, self.layout = frames_of(content, path), named_layout(content, path)
            self.stated = rising([found.get("frame_id") if isinstance(found, dict) else None for found in self.frames])
            numbers = self.stated
        self.numbers = np.array(numbers, dtype=np.int64) - min(numbers, default=0)

    @property
    def counts_from_0(self) -> bool:
        """OpenPose writes the frame's number in twelve digits, AlphaPose without a leading zero."""
        if self.path.is_dir():
            return all(re.search(r"(^|\D)\d{12}_keypoints$", file.stem) for file in self.frames)
        images = [frame.get("image") for frame in self.frames if isinstance(frame, dict)]
        return bool(images) and all(re.fullmatch(r"(0|[1-9]\d*)\.(jpg|png)", str(image)) for image in images)

    def are_of(self, images: Sequence[int]) -> bool:
        """Files that are named after the images of a series? Then they are of these frames of it."""
        found = {number: frame for frame, number in enumerate(images)}
        if not self.path.is_dir() or len(found) < max(len(images), 1) or not all(number in found for number in self.stated):
            return False
        self.numbers = np.array([found[number] for number in self.stated])
        return True

    @property
    def count(self) -> int:
        """Frames up to the last that is known."""
        return int(self.numbers[-1]) + 1 if len(self.numbers) else 0

    def of(self, frame: int) -> np.ndarray:
        """(12, 3) x, y in pixels and confidence of JOINTS; zeros if nobody was found, or the frame was left out."""
        if frame >= self.count:
            raise ValueError(f"{self.path}: expected keypoints of frame {frame}, found those of {len(self.frames)} frames")
        found = np.flatnonzero(self.numbers == frame)
        what = self.frames[found[0]] if len(found) else []
        if not isinstance(what, Path):
            return joints_of(people_of(what), self.path, self.layout)
        if what.suffix == ".txt":
            return joints_of(labelled(what, self.size), what)
        content = read_json(what)
        return joints_of(people_of(content), what, named_layout(content, what))


def rising(numbers: list) -> list[int]:
    """Numbers of frames; 0, 1, 2, ... if these are none."""
    are_numbers = all(isinstance(number, int) and 0 <= number < MOST_NUMBER for number in numbers)
    return numbers if are_numbers and (np.diff(numbers) > 0).all() else list(range(len(numbers)))


def frames_of(content, path: Path) -> Sequence:
    frames = content.get("instance_info") if isinstance(content, dict) else content
    if not isinstance(frames, list):
        raise ValueError(f"{path}: expected keypoints ({FORMATS}), found something else")
    return by_image(frames) if frames and all(isinstance(frame, dict) and "image_id" in frame for frame in frames) else frames


def named_layout(content, path: Path) -> tuple[int, ...] | None:
    """Index of JOINTS in the lists of a program that says what its points are, as MMPose does; None = it does not. Human3.6M has
    as many as COCO, in another order, and calls the ankle a foot. Raises ValueError where some have no name."""
    meta = content.get("meta_info") if isinstance(content, dict) else None
    ids = meta.get("keypoint_name2id") if isinstance(meta, dict) else None
    if not isinstance(ids, dict):
        return None
    names = [f"{'left' if joint[0] == 'l' else 'right'}_{joint[2:]}" for joint in JOINTS]
    found = [ids.get(name, ids.get(name.replace("ankle", "foot"))) for name in names]
    if all(index is None for index in found):
        return None
    if not all(isinstance(index, int) and index >= 0 for index in found):
        raise ValueError(f"{path}: expected points named {', '.join(names)}, found {', '.join(map(str, ids))[:200]}")
    return tuple(found)


def by_image(people: list[dict]) -> list[dict]:
    """Frames, in the order of their numbers, of a list of people with an image each, as AlphaPose and COCO's results have it."""
    images = [str(person["image_id"]) for person in people]
    numbers = numbers_of([Path(image).stem for image in images])
    frames = {number: {"frame_id": number, "image": "", "people": []} for number in sorted(numbers)}
    for number, image, person in zip(numbers, images, people):
        frames[number]["image"] = image
        frames[number]["people"].append({"pose_keypoints_2d": person.get("keypoints")})
    return list(frames.values())


def people_of(found) -> list:
    """(K, 3) of everybody in a frame, whoever wrote it; the shape is looked at later."""
    if isinstance(found, dict) and isinstance(found.get("people"), list):  # OpenPose
        return rows_of([person for person in found["people"] if isinstance(person, dict)], "pose_keypoints_2d")
    if isinstance(found, dict) and isinstance(found.get("annots"), list):  # EasyMocap
        found = found["annots"]
    if isinstance(found, dict) and isinstance(found.get("instance_info"), list):  # MMPose, Sapiens, of an image
        found = found["instance_info"]
    if isinstance(found, list) and any(isinstance(person, dict) and "keypoint_scores" in person for person in found):
        found = {"instances": found}
    if isinstance(found, dict) and isinstance(found.get("instances"), list):  # RTMPose, MMPose
        people = [p for p in found["instances"] if isinstance(p, dict)]
        scored = [zip(list_in(p, "keypoints"), list_in(p, "keypoint_scores")) for p in people]
        return [[[*xy, score] for xy, score in points if isinstance(xy, list)] for points in scored]
    if isinstance(found, list) and found and all(isinstance(person, dict) and "keypoints" in person for person in found):
        return rows_of(found, "keypoints")  # of an image: EasyMocap, OpenPifPaf
    return [found] if found else []


def rows_of(people: list[dict], key: str) -> list:
    """x, y and confidence of each point, which many programs write one behind the other; without people of no points."""
    lists = [list_in(person, key) for person in people]
    flat = [not any(isinstance(number, list) for number in numbers) for numbers in lists]
    return [[n[i : i + 3] for i in range(0, len(n), 3)] if f else n for n, f in zip(lists, flat) if n]


def labelled(path: Path, size: tuple[int, int]) -> list[np.ndarray]:
    """(17, 3) of everybody in a frame, by the labels of Ultralytics YOLO: class, box, keypoints in shares of the image's size,
    each with a confidence or none, and what else was saved."""
    require_file(path)
    people = []
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        try:
            numbers = np.array(line.split()[5:], float)
        except ValueError:
            numbers = np.zeros(0)
        columns = 3 if len(numbers) >= 3 * 17 else 2
        if len(numbers) < columns * 17:
            raise ValueError(f"{path}: expected lines of class, box and 17 keypoints (YOLO's labels), found '{line[:40]}'")
        points = numbers[: columns * 17].reshape(17, columns)
        confidence = points[:, 2] if columns == 3 else points.any(axis=1)
        people.append(np.column_stack([points[:, :2] * size, confidence]))
    return people


def list_in(person: dict, key: str) -> list:
    numbers = person.get(key)
    return numbers if isinstance(numbers, list) else []


def joints_of(people: list, path: Path, layout: tuple[int, ...] | None = None) -> np.ndarray:
    """Of the person with the most confidence; `layout`: where JOINTS are, if the file says it."""
    best = np.zeros((len(JOINTS), 3))
    for person in people:
        if isinstance(person, dict):
            raise ValueError(f"{path}: expected keypoints ({FORMATS}), found an entry of {', '.join(list(person)[:5])}")
        try:
            points = np.atleast_1d(np.array(person, float))
        except (TypeError, ValueError):
            points = np.zeros(0)
        chosen = layout or LAYOUTS.get(len(points), (len(points),))
        if points.ndim != 2 or points.shape[1] < 3 or max(chosen) >= len(points):
            counts = f"more than {max(chosen)}" if layout else ", ".join(map(str, LAYOUTS))
            raise ValueError(f"{path}: expected {counts} keypoints of x, y and confidence, found {points.shape}")
        joints = points[list(chosen)][:, [0, 1, -1]]
        joints[~np.isfinite(joints).all(axis=1)] = 0  # NaN, null: not found
        if joints[:, 2].sum() > best[:, 2].sum():
            best = joints
    require_pixels(best, path)
    return best


def require_pixels(joints: np.ndarray, path: Path) -> None:
    """Shares of the image's size, or metres, are all one pixel to cameras, which then agree on a point that nobody is at."""
    seen = joints[joints[:, 2] >= SURE, :2]
    if len(seen) >= LEAST_AGREED and 0 < np.ptp(seen, axis=0).max() < LEAST_SIZE:
        raise ValueError(
            f"{path}: expected keypoints in pixels of the video, found a person smaller than {LEAST_SIZE} of them; are these "
            "shares of the image's size?"
        )
