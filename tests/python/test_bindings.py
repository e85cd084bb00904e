"""The Python face of the library: arrays, options, errors, overridable stages, interruption."""

import copy
import signal
import threading

import doublet as d
import numpy as np
import pytest

TETRAHEDRON = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], np.int32)
MARKS = [d.JointAnnotation("pelvis", "", [0, 1, 0], 6), d.JointAnnotation("spine", "pelvis", [0, 1.2, 0], 3)]


def moving_tetrahedron():
    return d.MeshSequence(FACES, np.stack([TETRAHEDRON, TETRAHEDRON + 0.1]))


def test_arrays_are_views_without_a_copy():
    mesh = d.Mesh(TETRAHEDRON, FACES)
    assert not mesh.vertices.flags.owndata
    assert np.shares_memory(mesh.vertices, mesh.vertices)
    np.testing.assert_array_equal(mesh.vertices, TETRAHEDRON)
    state = d.ClothState(TETRAHEDRON)
    state.positions[0, 1] = 7
    assert state.positions[0, 1] == 7 and TETRAHEDRON[0, 1] == 0


def test_options_take_keywords_and_say_what_is_wrong():
    assert d.SegmentOptions(diffusion=0.03).diffusion == 0.03
    with pytest.raises(TypeError, match="no option 'threshold'"):
        d.SegmentOptions(threshold=1)
    with pytest.raises(ValueError, match="diffusion"):
        d.SegmentOptions(diffusion=-1)
    with pytest.raises(ValueError, match="k_bend"):
        d.Material(k_bend=2)
    with pytest.raises(TypeError, match="Material has no option 'stiffness'"):
        d.Material(stiffness=1)


def test_errors_are_pythons(tmp_path):
    with pytest.raises(FileNotFoundError, match="nothing.npz"):
        d.read_actor(tmp_path / "nothing.npz")
    (tmp_path / "broken.npz").write_text("no archive")
    with pytest.raises(d.Error, match="broken.npz"):
        d.read_segmentation(tmp_path / "broken.npz")
    assert issubclass(d.Error, RuntimeError)
    with pytest.raises(d.Error, match="nobody"):
        d.Skeleton([*MARKS, d.JointAnnotation("head", "nobody", [0, 1.6, 0])])
    with pytest.raises(ValueError, match=r"canonical: expected the shape \(frames, vertices, 3\), found \(4, 3\)"):
        d.cloth_slack(d.Mesh(TETRAHEDRON, FACES), TETRAHEDRON)


def test_skeleton_kinematics():
    skeleton = d.Skeleton(MARKS)
    dofs = np.zeros(len(skeleton.dof_names))
    dofs[0] = 0.5  # root, x
    np.testing.assert_allclose(skeleton.joint_positions(dofs), skeleton.joint_rest + [0.5, 0, 0], atol=1e-12)
    assert skeleton.forward_kinematics(dofs).shape == (2, 4, 4)


def test_closest_points_and_rays():
    scene = d.RayScene(d.Mesh(TETRAHEDRON, FACES))
    _, distance, point = scene.closest(np.array([[0.2, 0.2, -0.5]]))
    assert distance[0] == pytest.approx(0.5, abs=1e-6)
    np.testing.assert_allclose(point[0], [0.2, 0.2, 0], atol=1e-6)
    face, distance = scene.cast(np.array([[0.2, 0.2, -1.0]] * 2), np.array([[0, 0, 1.0], [0, 0, -1.0]]))
    assert face[0] >= 0 and distance[0] == pytest.approx(1, abs=1e-6)
    assert face[1] == -1 and np.isinf(distance[1])


def test_files_round_trip(tmp_path):
    clothness = d.Segmentation(np.array([0.001, np.nan]), np.array([0.0, 1.0]), np.array([-1, 0]))
    d.write_segmentation(tmp_path / "segmentation.npz", clothness)
    with np.load(tmp_path / "segmentation.npz") as arrays:
        assert set(arrays) >= {"sigma", "clothness", "region"}
    back = d.read_segmentation(tmp_path / "segmentation.npz")
    np.testing.assert_allclose(back.sigma, clothness.sigma, rtol=1e-6)
    assert back.region_count == 1


def test_a_stage_can_be_written_in_python():
    class EverythingIsCloth(d.ClothSegmenter):
        def segment(self, inputs, context):
            context.report_progress("python stage", 0.5)
            count = inputs.surface.frames.shape[1]
            return d.Segmentation(np.zeros(count), np.ones(count), np.zeros(count, np.int32))

    seen = []
    context = d.Context(progress=lambda name, fraction: seen.append((name, fraction)))
    # Through the base class, as C++ would call it.
    result = d.ClothSegmenter.segment(EverythingIsCloth(), d.SegmentInputs(moving_tetrahedron(), [1] * 4), context)
    assert result.clothness.tolist() == [1] * 4
    assert seen == [("python stage", 0.5)]


def test_a_stage_without_its_method_says_so():
    class Lazy(d.ClothSegmenter):
        pass

    with pytest.raises(RuntimeError, match="segment"):
        Lazy().segment(d.SegmentInputs(moving_tetrahedron(), [1] * 4))


def test_an_extractor_written_in_python_sees_arrays():
    class Threshold(d.SilhouetteExtractor):
        def train(self, camera, images):
            self.level = images[0].mean()

        def extract(self, camera, image):
            return np.where(image[..., 0] > self.level, 255, 0).astype(np.uint8)

    picture = np.zeros((4, 6, 3), np.uint8)
    picture[1:3, 2:5] = 200
    extractor = Threshold()
    d.SilhouetteExtractor.train(extractor, 0, [picture])
    mask = d.SilhouetteExtractor.extract(extractor, 0, picture)
    assert mask.shape == (4, 6) and (mask > 0).sum() == 6


class Bowl(d.Objective):
    """Minimum at 0.7 along every axis."""

    def parameter_count(self):
        return 3

    def evaluate(self, samples, context):
        return np.square(samples - 0.7).sum(axis=1, keepdims=True)


class RandomSearch(d.Optimizer):
    def __init__(self, dimension, seed):
        super().__init__()
        self.random, self.dimension, self.told, self.found = np.random.default_rng(seed), dimension, 0, (np.inf, None)

    def ask(self):
        return self.random.random((16, self.dimension))

    def tell(self, samples, energies):
        self.told += len(energies)
        best = int(np.argmin(energies))
        if energies[best] < self.found[0]:
            self.found = (energies[best], samples[best])

    def stop(self):
        return self.told >= 800

    def result(self):
        result = d.OptimizerResult()
        result.answer = result.best = self.found[1] if self.found[1] is not None else np.full(self.dimension, 0.5)
        result.best_energy = self.found[0]
        result.deviations = np.zeros(self.dimension)
        result.evaluations = self.told
        return result


def test_objective_in_python_optimizer_in_cpp():
    answer = d.minimise(Bowl(), d.MinimiseOptions(seed=3)).parts[0].answer
    np.testing.assert_allclose(answer, 0.7, atol=0.05)


def test_objective_and_optimizer_in_python():
    result = d.minimise(Bowl(), d.MinimiseOptions(make_optimizer=RandomSearch, seed=3)).parts[0]
    assert result.evaluations == 800
    np.testing.assert_allclose(result.answer, 0.7, atol=0.2)


def test_cloth_falls_freely():
    model = d.ClothModel(TETRAHEDRON[:3], FACES[:1], np.ones(3), d.ClothOptions(self_collision=False))
    solver, state = d.ClothSolver.create(model), d.ClothState(TETRAHEDRON[:3])
    for _ in range(10):
        solver.step(state, d.StepInputs(dt=0.01), d.Material(d_n=0, d_t=0))
    np.testing.assert_allclose(state.velocities[:, 1], -9.81 * 0.1, rtol=1e-3)


def test_exceptions_of_callbacks_come_back():
    def refuse(name, fraction):
        raise LookupError("from the callback")

    class Reporting(Bowl):
        def evaluate(self, samples, context):
            context.report_progress("bowl", 0.1)
            return super().evaluate(samples, context)

    with pytest.raises(LookupError, match="from the callback"):
        d.minimise(Reporting(), context=d.Context(progress=refuse))


def test_ctrl_c_stops_a_long_call():
    class Endless(d.Optimizer):
        def ask(self):
            return np.full((4, 3), 0.5)

        def tell(self, samples, energies):
            pass

        def stop(self):
            return False

        def result(self):
            result = d.OptimizerResult()
            result.answer = result.best = result.deviations = np.zeros(3)
            return result

    signal.signal(signal.SIGINT, signal.default_int_handler)  # a runner in the background may ignore it
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        d.minimise(Bowl(), d.MinimiseOptions(make_optimizer=lambda dimension, seed: Endless()))
    timer.join()


def test_the_shipped_body_model_is_found_without_a_path():
    model = d.BodyModel.read(d.body_model_path())
    body = model.vertices(np.zeros(model.component_count))
    assert body.shape == (model.vertex_count, 3)
    assert 1.4 < np.ptp(body[:, 1]) < 2.0  # m, a standing adult


def test_values_are_copied_and_say_what_they_are():
    camera = d.Camera()
    camera.name, camera.width, camera.height, camera.K = "cam0", 640, 480, np.diag([500.0, 500, 1])
    values = {
        "Camera('cam0', 640 x 480, focal length 500 px)": (camera, "K"),
        "Mesh(3 vertices, 1 faces)": (d.Mesh(np.eye(3), [[0, 1, 2]]), "vertices"),
        "Motion(5 frames at 40 fps, 7 degrees of freedom)": (d.Motion(40, np.zeros((5, 7))), "dofs"),
    }
    for text, (value, name) in values.items():
        for copied in (copy.copy(value), copy.deepcopy(value)):
            assert repr(copied) == text
            setattr(copied, name, 2 * np.asarray(getattr(value, name)) + 1)
            assert not np.array_equal(getattr(copied, name), getattr(value, name))
    clip = d.SourceMotion(["hips"], [-1], [[0, 1, 0]], [[[0, 1, 0]]], [[[1, 0, 0, 0]]], 30, "walk.bvh")
    assert repr(copy.copy(clip)) == "SourceMotion('walk.bvh', 1 joints, 1 frames at 30 fps)"
    assert repr(d.Session()) == "Session('', 0 cameras, 0 frames at 0 fps)"
    with pytest.raises(TypeError, match="cannot pickle 'doublet._doublet.FrameSource' object"):
        copy.copy(d.FrameSource())
