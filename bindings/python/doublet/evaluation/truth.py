"""A ground truth: body and garment of every frame, labels, joints, masks."""

from __future__ import annotations

import re
from functools import cached_property
from pathlib import Path

import numpy as np

from ..common.files import array_of, arrays_of

MOST_FRAMES = 500_000  #: two hours at 60 a second
MASK_NAME = re.compile(r"(?P<camera>.+)_(?P<frame>\d+)\.png")


class Missing(Exception):
    """A metric cannot be computed; the message says what is not there."""


class Truth:
    """A ground_truth folder: body and garment per frame, labels, joints, masks."""

    def __init__(self, folder: Path):
        self.folder = Path(folder)
        if not (self.folder / "static.npz").exists() and not (self.folder.parent / "static.npz").exists():
            raise FileNotFoundError(f"{self.folder / 'static.npz'} does not exist, so {self.folder} is no ground truth")
        own = self.folder / "static.npz"
        self.static = own if own.exists() else self.folder.parent / "static.npz"
        with arrays_of(self.static) as static:
            self.body_faces, self.cloth_faces = (
                array_of(static, self.static, name, "iu", (None, 3)).astype(np.int32) for name in ("body_tris", "cloth_tris")
            )
        self._path: Path | None = None  # of the file that is open

    @cached_property
    def chunks(self) -> dict[int, tuple[Path, int]]:
        """Frame -> (file, row)."""
        found = {}
        for path in sorted(self.folder.glob("frames_*.npz")):
            with arrays_of(path) as chunk:
                frames = self.frames_of(chunk, path, len(array_of(chunk, path, "cloth", "f", (None, None, 3))))
            found.update({f: (path, row) for row, f in enumerate(frames)})
        return found

    @staticmethod
    def frames_of(chunk, path: Path, count: int) -> list[int]:
        """The video frames of a file's rows: an array of them, or where they begin."""
        if "frames" in chunk:
            return array_of(chunk, path, "frames", "iu", (count,)).tolist()
        start = int(array_of(chunk, path, "start", "iu", ())) if "start" in chunk else 0
        return list(range(start, start + count))

    def frame(self, number: int) -> tuple[np.ndarray, np.ndarray]:
        """(body, garment) vertices, m."""
        path, row = self.chunks[number]
        if self._path != path:
            with arrays_of(path) as chunk:
                cloth = array_of(chunk, path, "cloth", "f", (None, None, 3))
                body = array_of(chunk, path, "body", "f", (len(cloth), None, 3))
            self.require_vertices(path, body, cloth)
            self._path, self._vertices = path, (body, cloth)
        return tuple(vertices[row].astype(float) for vertices in self._vertices)

    def garment(self, number: int) -> np.ndarray:
        """(G, 3) m. Raises Missing if there is none."""
        garment = self.frame(number)[1]
        if not len(garment):
            raise Missing("the truth has no garment")
        return garment

    def require_vertices(self, path: Path, body: np.ndarray, cloth: np.ndarray) -> None:
        """Those that the faces have."""
        for name, faces, vertices in (("body", self.body_faces, body), ("cloth", self.cloth_faces, cloth)):
            if faces.size and not 0 <= faces.min() <= faces.max() < vertices.shape[1]:
                expected = f"'{name}_tris' of {vertices.shape[1]} vertices, as {path.name} has them"
                raise RuntimeError(f"{self.static}: expected {expected}, found {faces.min()} to {faces.max()}")

    def surface(self, number: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(vertices, faces, is_garment per face) of body and garment together."""
        body, cloth = self.frame(number)
        faces = np.vstack([self.body_faces, self.cloth_faces + len(body)])
        return np.vstack([body, cloth]), faces, np.arange(len(faces)) >= len(self.body_faces)

    def joints(self) -> tuple[list[str], dict[int, np.ndarray]]:
        """Names, and frame -> (J, 3)."""
        path = self.folder / "skeleton.npz"
        if not path.exists():
            raise Missing(f"{path} does not exist")
        with arrays_of(path) as file:
            names = [str(n) for n in array_of(file, path, "joint_names", "US", (None,))]
            joints = array_of(file, path, "joints", "f", (None, len(names), 3)).astype(float)
            if len(joints) > MOST_FRAMES:
                raise RuntimeError(f"{path}: array 'joints': expected at most {MOST_FRAMES} frames, found {len(joints)}")
            return names, dict(zip(self.frames_of(file, path, len(joints)), joints))

    def pelvis(self) -> dict[int, np.ndarray]:
        """Frame -> (3) m."""
        names, joints = self.joints()
        return {frame: at[pelvis_index(names)] for frame, at in joints.items()}

    def masks(self) -> list[tuple[str, int, Path]]:
        """(camera name, frame, file)."""
        matches = [(MASK_NAME.fullmatch(p.name), p) for p in sorted((self.folder / "masks").glob("*.png"))]
        return [(m["camera"], int(m["frame"]), p) for m, p in matches if m]


def pelvis_index(joint_names: list[str]) -> int:
    """The joint of that name; the root, which comes first, if there is none."""
    if not joint_names:
        raise Missing("the skeleton has no joints")
    return joint_names.index("pelvis") if "pelvis" in joint_names else 0
