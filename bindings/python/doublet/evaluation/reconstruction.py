"""A reconstruction as it is compared with a truth."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from .. import _doublet as d
from ..common.files import arrays_of
from .truth import Missing


@dataclass(frozen=True)
class Animated:
    """The character in motion, as it is compared with the true garment."""

    surfaces: dict[int, np.ndarray]  #: frame -> (N, 3) m
    faces: np.ndarray  #: (F, 3)
    clothness: np.ndarray | None = None  #: (N) in [0, 1]

    @cached_property
    def cloth(self) -> np.ndarray:
        """Indices of the cloth vertices that a face has."""
        if self.clothness is None:
            raise Missing("there is no segmentation.npz to say which vertices are cloth")
        used = np.unique(self.faces)
        cloth = used[self.clothness[used] > 0.5]
        if not len(cloth):
            raise Missing("the character has no cloth")
        return cloth


class Reconstruction:
    """The files of an OUT folder, read when asked for."""

    def __init__(self, out: Path):
        self.out = Path(out)

    def path(self, name: str) -> Path:
        if not (self.out / name).exists():
            raise Missing(f"{self.out / name} does not exist")
        return self.out / name

    @cached_property
    def actor(self) -> d.RiggedMesh:
        return d.read_actor(self.path("actor.npz"))

    @cached_property
    def faces(self) -> np.ndarray:
        """Faces that the scan supports."""
        return self.actor.mesh.faces[np.asarray(self.actor.face_valid, bool)]

    @cached_property
    def clothness(self) -> np.ndarray:
        found = d.read_segmentation(self.path("segmentation.npz")).clothness
        self.require("segmentation.npz", "clothness", "vertices of actor.npz", (len(self.actor.mesh.vertices),), found.shape)
        return found

    @cached_property
    def performance(self) -> d.ReferencePerformance:
        return d.read_performance(self.path("performance.npz"), self.actor)

    @cached_property
    def reanimated(self) -> Animated:
        """The reference motion (simulated.npz)."""
        with arrays_of(self.path("simulated.npz")) as simulated:
            vertices = simulated["vertices"].astype(float)
            expected = len(self.performance.frames), len(self.actor.mesh.vertices), 3
            shape = "frames of performance.npz, vertices of actor.npz, 3"
            self.require("simulated.npz", "vertices", shape, expected, vertices.shape)
            if "garment" not in simulated:
                return self.animated(vertices)
            garment = simulated["garment"].astype(float)
        with arrays_of(self.path("garment.npz")) as own:
            expected = len(vertices), len(own["vertices"]), 3
        self.require("simulated.npz", "garment", "frames of vertices, vertices of garment.npz, 3", expected, garment.shape)
        return self.animated(np.concatenate([vertices, garment], axis=1))

    def require(self, name: str, array: str, what: str, expected: tuple, found: tuple) -> None:
        """Files of one run go together; those of an earlier one are of other frames or meshes."""
        if found != expected:
            raise d.Error(f"{self.out / name}: array '{array}': expected {expected} ({what}), found {found}")

    def animated(self, surfaces: np.ndarray) -> Animated:
        """The reference motion as surfaces of the actor (T, V, 3), or of the dressed one (T, V + G, 3): a garment with a mesh of
        its own replaces the faces that it stands for."""
        bare, by_frame = len(self.actor.mesh.vertices), dict(zip(self.performance.frames, surfaces))
        if surfaces.shape[1] == bare:
            clothness = self.clothness if (self.out / "segmentation.npz").exists() else None
            return Animated(by_frame, self.faces, clothness)
        with arrays_of(self.path("garment.npz")) as garment:
            faces, covers = garment["faces"].astype(np.int32), garment["covers"].astype(bool)
        skin = self.actor.mesh.faces[np.asarray(self.actor.face_valid, bool) & ~covers]
        return Animated(by_frame, np.vstack([skin, faces + bare]), np.repeat([0.0, 1.0], [bare, surfaces.shape[1] - bare]))

    def rows(self, truth_frames, every: int) -> list[tuple[int, int]]:
        """(row, video frame) for which there is truth."""
        known = set(truth_frames)
        rows = [(row, f) for row, f in enumerate(self.performance.frames) if f in known][::every]
        if not rows:
            raise Missing("no captured frame has a true one")
        return rows
