"""Every piece of a capture can be written in Python: used from worker threads, kept alive, its errors and wrong answers named."""

import gc
import runpy
import threading
from pathlib import Path

import doublet as d
import numpy as np
import pytest
from doublet import testing

EXAMPLE = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "own_parts.py"))
FRAMES = 3


@pytest.fixture(scope="module")
def scene():
    actor, rig = EXAMPLE["two_limbs"](), EXAMPLE["ring"](4, 160)
    dofs = np.linspace(0, 0.08, FRAMES)[:, None] * np.ones(len(actor.skeleton.dof_names))
    stage = EXAMPLE["DrawnStage"](actor, rig, [d.pose_surface(actor, pose) for pose in dofs])
    extractor = EXAMPLE["PlateDifference"]()
    for c in range(len(rig)):
        extractor.train(c, [stage.wall])
    return actor, rig, stage, extractor


def capture(scene, extractor=None, options=None, **parts):
    actor, rig, stage, trained = scene
    stage_of = d.PerformanceCapture.create(options or d.CaptureOptions(smooth_window=1), d.CaptureParts(**parts))
    gc.collect()  # the parts live on in the capture alone
    return stage_of.capture(actor, rig, stage, extractor or trained, d.Context(threads=4))


def test_the_example_follows_its_figure(capsys):
    error, matches = EXAMPLE["main"](4)
    assert error < 0.003 and matches > 50
    assert "4 frames" in capsys.readouterr().out


class CountingTracker(d.FeatureTracker):
    """The built-in tracker, watched."""

    def __init__(self):
        super().__init__()
        self.inner, self.threads, self.calls = d.FeatureTracker.create(), set(), 0

    def detect(self, image, mask):
        assert image.shape == (*mask.shape, 3) and set(np.unique(mask)) <= {0, 255}
        self.threads.add(threading.get_ident())
        self.calls += 1
        return self.inner.detect(image, mask)

    def match(self, previous, current, reach):
        assert previous.points.shape[1] == 2 and len(previous.points) == len(previous.descriptors) and reach > 0
        return self.inner.match(previous, current, reach)


class SamePose(d.PoseOptimizer):
    def __init__(self):
        super().__init__()
        self.inner, self.firsts, self.kept = d.PoseOptimizer.create(), [], []

    def optimize(self, problem, context):
        self.firsts.append(problem.first)
        self.kept.append(problem)
        assert len(problem.outlines) == len(problem.rig) == 4 and problem.outlines[0].points.shape[1] == 2
        assert problem.offset.shape == problem.actor.mesh.vertices.shape
        return self.inner.optimize(problem, context)


class SameSurface(d.SurfaceRefiner):
    def __init__(self):
        super().__init__()
        self.inner, self.tracks = d.SurfaceRefiner.create(), []

    def refine(self, problem, context):
        self.tracks += problem.tracks
        return self.inner.refine(problem, context)


def test_pieces_that_pass_on_change_nothing(scene):
    plain = capture(scene)
    tracker, pose, surface = CountingTracker(), SamePose(), SameSurface()
    swapped = capture(scene, features=tracker, pose=pose, surface=surface)
    np.testing.assert_array_equal(plain.performance.dofs, swapped.performance.dofs)
    np.testing.assert_array_equal(plain.performance.surface.frames, swapped.performance.surface.frames)
    assert tracker.calls == 4 * FRAMES and len(tracker.threads) > 1
    assert pose.firsts == [True, False, False] + FRAMES * [False]  # the second pass knows where the first frame is
    faces = len(scene[0].mesh.faces)
    assert surface.tracks and all(0 <= t.face < faces and t.pixel.shape == (2,) for t in surface.tracks)


def test_pieces_decide_the_result(scene):
    class Still(d.PoseOptimizer):
        def optimize(self, problem, context):
            estimate = d.PoseEstimate()
            estimate.dofs = np.full(len(problem.start), 0.01)
            return estimate

    class Lifted(d.SurfaceRefiner):
        def refine(self, problem, context):
            estimate = d.SurfaceEstimate()
            estimate.vertices = problem.skinned + [0, 0.02, 0]
            return estimate

    result = capture(scene, pose=Still(), surface=Lifted())
    np.testing.assert_allclose(result.performance.dofs, 0.01, atol=1e-12)
    expected = d.pose_surface(scene[0], result.performance.dofs[1]) + [0, 0.02, 0]
    np.testing.assert_allclose(result.performance.surface.frames[1], expected, atol=1e-9)


class StoppedAt(SamePose):
    """Stops the run at one of its calls."""

    def __init__(self, stop=None):
        super().__init__()
        self.stop, self.calls = stop, 0

    def optimize(self, problem, context):
        self.calls += 1
        if self.calls == self.stop:
            raise KeyboardInterrupt
        return super().optimize(problem, context)


def test_a_stopped_capture_goes_on(scene, tmp_path):
    options = d.CaptureOptions(smooth_window=1, find_lost_limbs=False)
    whole = StoppedAt()
    expected = capture(scene, options=options, pose=whole)
    options.checkpoint = tmp_path / "checkpoint"
    with pytest.raises(KeyboardInterrupt):
        capture(scene, options=options, pose=StoppedAt(3))
    rest = StoppedAt()
    result = capture(scene, options=options, pose=rest)
    assert rest.calls == whole.calls - 2
    np.testing.assert_array_equal(result.performance.dofs, expected.performance.dofs)
    np.testing.assert_array_equal(result.performance.surface.frames, expected.performance.surface.frames)
    assert options.checkpoint.exists()  # until somebody who keeps the result removes it


def test_a_problem_does_not_outlive_its_call(scene):
    pose = SamePose()
    capture(scene, pose=pose)
    assert pose.kept[0].predicted.shape == (9,)
    with pytest.raises(ValueError, match="valid only during the call"):
        _ = pose.kept[0].actor
    with pytest.raises(ValueError, match="valid only during the call"):
        d.PoseOptimizer.create().optimize(pose.kept[0])


class Refusing(d.FeatureTracker):
    def detect(self, image, mask):
        raise LookupError("from a worker")

    def match(self, previous, current, reach):
        return []


def tracker_that_returns(features=None, pairs=None):
    class Wrong(d.FeatureTracker):
        def detect(self, image, mask):
            return d.Features([[80, 80]], np.ones((1, 4))) if features is None else features

        def match(self, previous, current, reach):
            return [] if pairs is None else pairs

    return Wrong()


def extractor_that_returns(mask):
    class Wrong(d.SilhouetteExtractor):
        def extract(self, camera, image):
            return mask

    return Wrong()


def test_what_a_piece_raises_comes_back(scene):
    with pytest.raises(LookupError, match="from a worker"):
        capture(scene, features=Refusing())

    class Interrupted(d.SurfaceRefiner):
        def refine(self, problem, context):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        capture(scene, surface=Interrupted())


@pytest.mark.parametrize(
    ("parts", "error", "words"),
    [
        (
            {"features": tracker_that_returns(features="none")},
            TypeError,
            r"FeatureTracker.detect must return Features, found str",
        ),
        ({"features": tracker_that_returns(d.Features([[-5, 2]], np.ones((1, 4))))}, d.Error, "outside the image"),
        ({"features": tracker_that_returns(d.Features([[np.nan, 2]], np.ones((1, 4))))}, d.Error, "outside the image"),
        ({"features": tracker_that_returns(pairs=[(0, 7)])}, d.Error, "matched feature 0 of 1 with 7 of 1"),
        ({"features": tracker_that_returns(pairs=np.ones((2, 3)))}, TypeError, r"match must return .* float64 \(2, 3\)"),
        ({"features": type("Lazy", (d.FeatureTracker,), {})()}, RuntimeError, "FeatureTracker.detect is not defined"),
        ({"extractor": extractor_that_returns(np.zeros((5, 4), np.uint8))}, d.Error, "the mask of frame 0 is 4 x 5"),
        ({"extractor": extractor_that_returns(np.ones((160, 160), bool))}, TypeError, r"uint8 array .*found an array of bool"),
        ({"extractor": extractor_that_returns(np.zeros((160, 160, 3), np.uint8))}, d.Error, "has 3 channels"),
    ],
)
def test_wrong_answers_are_named(scene, parts, error, words):
    with pytest.raises(error, match=words):
        capture(scene, **parts)


def test_wrong_sizes_of_pose_and_surface_are_named(scene):
    class Short(d.PoseOptimizer):
        def optimize(self, problem, context):
            estimate = d.PoseEstimate()
            estimate.dofs = np.zeros(4)
            return estimate

    class Few(d.SurfaceRefiner):
        def refine(self, problem, context):
            estimate = d.SurfaceEstimate()
            estimate.vertices = problem.skinned[:7]
            return estimate

    with pytest.raises(d.Error, match="pose optimizer returned 4 values"):
        capture(scene, pose=Short())
    with pytest.raises(d.Error, match="surface refiner returned 7 vertices"):
        capture(scene, surface=Few())
    with pytest.raises(ValueError, match="one descriptor per point"):
        d.Features(np.zeros((3, 2)), np.zeros((2, 4)))


class Kit(d.LimbSearch):
    """Runs the kit on the built-in search, or on one that moves everything, with the problem that it is given."""

    def __init__(self):
        super().__init__()
        self.inner, self.found, self.wild = d.LimbSearch.create(), [], []

    def search(self, problem, dofs, lost, context):
        self.found += testing.limb_search_violations(self.inner, problem, dofs, lost)
        self.wild += testing.limb_search_violations(Everything(), problem, dofs, lost)
        return self.inner.search(problem, dofs, lost, context)


class Everything(d.LimbSearch):
    def search(self, problem, dofs, lost, context):
        return dofs + 100


def test_the_kits_try_what_python_makes(scene):
    actor, rig, stage, extractor = scene
    kit = Kit()
    options = d.CaptureOptions(smooth_window=1, second_pass=False)
    options.limbs.lost_error = 1e-9  # every limb in every frame
    capture(scene, options=options, limbs=kit)
    assert kit.found == []
    assert any("is of no lost limb" in s for s in kit.wild) and any("beyond its limits" in s for s in kit.wild)

    class Passing(d.PerformanceCapture):
        def __init__(self):
            super().__init__()
            self.inner, self.later = d.PerformanceCapture.create(options), 0

        def capture(self, *arguments):
            found = self.inner.capture(*arguments)
            found.performance.dofs = found.performance.dofs + self.later
            return found

    class Restless(Passing):
        def capture(self, *arguments):
            self.later += 1
            return super().capture(*arguments)

    assert testing.performance_capture_violations(Passing(), actor, rig, stage, extractor) == []
    assert testing.performance_capture_violations(Restless(), actor, rig, stage, extractor) == ["a second call gives other bits"]
