"""Every interface derived by a user who has all types checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import doublet as d
import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.uint8]
QUIET = d.Context()


class Film(d.FrameSource):
    def __init__(self, images: Pixels) -> None:  # (C, T, H, W, 3)
        super().__init__()
        self.images = images

    @property
    def frame_count(self) -> int:
        return int(self.images.shape[1])

    @property
    def camera_count(self) -> int:
        return int(self.images.shape[0])

    def image(self, camera: int, frame: int) -> Pixels:
        image: Pixels = self.images[camera, frame]
        return image

    def mask(self, camera: int, frame: int) -> Pixels:
        return np.zeros((0, 0), np.uint8)


class Bright(d.SilhouetteExtractor):
    def train(self, camera: int, images: Sequence[Pixels]) -> None:
        pass

    def extract(self, camera: int, image: Pixels) -> Pixels:
        return np.where(image.max(axis=2) > 40, 255, 0).astype(np.uint8)


class Nothing(d.FeatureTracker):
    def detect(self, image: Pixels, mask: Pixels) -> d.Features:
        return d.Features(np.zeros((0, 2)), np.zeros((0, 1)))

    def match(self, previous: d.Features, current: d.Features, reach: float) -> list[tuple[int, int]]:
        return []


class Still(d.PoseOptimizer):
    def optimize(self, problem: d.PoseProblem, context: d.Context = QUIET) -> d.PoseEstimate:
        estimate = d.PoseEstimate()
        estimate.dofs = problem.start
        return estimate


class Skinned(d.SurfaceRefiner):
    def refine(self, problem: d.SurfaceProblem, context: d.Context = QUIET) -> d.SurfaceEstimate:
        estimate = d.SurfaceEstimate()
        estimate.vertices = problem.skinned
        return estimate


class GivenUp(d.LimbSearch):
    def search(self, problem: d.LimbProblem, dofs: Floats, lost: Sequence[d.Limb], context: d.Context = QUIET) -> Floats:
        return dofs


class Tracker(d.PerformanceCapture):
    def capture(
        self,
        actor: d.RiggedMesh,
        rig: Sequence[d.Camera],
        frames: d.FrameSource,
        extractor: d.SilhouetteExtractor | None = None,
        context: d.Context = QUIET,
    ) -> d.CaptureResult:
        return d.PerformanceCapture.create().capture(actor, rig, frames, extractor, context)


class BelowTheNavel(d.ClothSegmenter):
    def segment(self, inputs: d.SegmentInputs, context: d.Context = QUIET) -> d.Segmentation:
        cloth = (inputs.surface.frames[0][:, 1] < 1).astype(float)
        return d.Segmentation(np.zeros_like(cloth), cloth, np.where(cloth > 0, 0, -1).astype(np.int32))


class Meshed(d.GarmentMesher):
    def mesh(
        self,
        actor: d.RiggedMesh,
        segmentation: d.Segmentation,
        body: d.Mesh,
        captured: d.MeshSequence,
        context: d.Context = QUIET,
    ) -> d.Garment:
        return d.GarmentMesher.create().mesh(actor, segmentation, body, captured, context)


class Growing(d.BodyModel):
    def __init__(self) -> None:
        super().__init__(vertex_count=3, component_count=1, faces=np.array([[0, 1, 2]]))

    def vertices(self, coefficients: Floats) -> Floats:
        if len(coefficients) != 1:
            raise ValueError(f"expected one coefficient, found {len(coefficients)}")
        grown: Floats = np.eye(3) * (1 + coefficients[0])
        return grown

    def component(self, k: int) -> Floats:
        return np.eye(3)


class NoBody(d.BodyFitter):
    def fit(
        self,
        actor: d.RiggedMesh,
        segmentation: d.Segmentation,
        model: d.BodyModel,
        landmarks: Mapping[str, Floats],
        context: d.Context = QUIET,
    ) -> d.BodyFit:
        return d.BodyFitter.create().fit(actor, segmentation, model, landmarks, context)


class AsStiffAsSkin(d.ClothSolver):
    def advance(
        self, states: Sequence[d.ClothState], inputs: Sequence[d.StepInputs], materials: Sequence[d.Material], threads: int
    ) -> list[int] | None:
        for state, frame in zip(states, inputs):
            state.positions = frame.targets
        return None


class Halving(d.Optimizer):
    """The middle of the box, and then half of what is left of it."""

    def __init__(self, dimension: int) -> None:
        super().__init__()
        self.best, self.energy, self.size = np.full(dimension, 0.5), np.inf, 0.5

    def ask(self) -> Floats:
        around = self.size * np.vstack([np.eye(len(self.best)), -np.eye(len(self.best))])
        return np.vstack([self.best, self.best + around])

    def tell(self, samples: Floats, energies: Floats) -> None:
        if len(energies) != len(samples) or not np.isfinite(energies).all():
            raise ValueError("expected a finite energy a sample")
        least = int(np.argmin(energies))
        self.size *= 1.0 if energies[least] < self.energy else 0.5
        if energies[least] < self.energy:
            self.best, self.energy = samples[least], float(energies[least])

    def stop(self) -> bool:
        return self.size < 1e-3

    def result(self) -> d.OptimizerResult:
        result = d.OptimizerResult()
        result.best = result.answer = self.best
        result.best_energy = self.energy
        result.deviations = np.full(len(self.best), self.size)
        return result


class Distance(d.Objective):
    def parameter_count(self) -> int:
        return 2

    def evaluate(self, samples: Floats, context: d.Context = QUIET) -> Floats:
        if samples.shape[1] != 2:
            raise ValueError(f"expected 2 parameters, found {samples.shape[1]}")
        energies: Floats = np.square(samples - 0.6).sum(axis=1, keepdims=True)
        return energies


def solvers() -> d.MinimiseOptions:
    options = d.MinimiseOptions()
    options.make_optimizer = lambda dimension, seed: Halving(dimension)
    return options
