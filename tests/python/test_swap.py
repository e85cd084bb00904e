"""Parts written in Python in the place of ours: cloth solvers, body models; and the kits that try them."""

import inspect
import runpy
import sys
import warnings
from pathlib import Path

import doublet as d
import numpy as np
import pytest
from doublet import testing

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "tests" / "fuzz"))
from seeds import World, smpl_arrays  # noqa: E402

NumpySolver = runpy.run_path(str(ROOT / "examples" / "numpy_solver.py"))["NumpySolver"]


@pytest.fixture(scope="module")
def world():
    return World()


class Passing(d.ClothSolver):
    """Ours, by way of Python; counts the simulations of each call."""

    calls: list[int] = []

    def __init__(self, model):
        super().__init__(model)
        self.inner = d.ClothSolver.create(model)

    def advance(self, states, inputs, materials, threads):
        self.calls.append(len(states))
        return self.inner.step_batch(states, inputs, materials, threads)


def played(world, make_solver):
    """Two characters side by side over three frames."""
    simulator = d.CharacterSimulator(world.actor, world.segmentation, world.proxies, make_solver=make_solver)
    frames = [simulator.pose(dofs) for dofs in world.dofs]
    states = [simulator.start(frames[0]) for _ in range(2)]
    for before, after in zip(frames, frames[1:]):
        assert simulator.step_batch(states, before, after, [[d.Material()], [d.Material(d_n=9)]], 0.025) == []
    return [np.array(s.regions[0].positions) for s in states]


@pytest.mark.parametrize("make", [None, NumpySolver, Passing, lambda model: d.ClothSolver.create(model)])
def test_solvers_keep_the_rules(make):
    assert testing.cloth_solver_violations(make) == []


def test_a_solver_that_passes_the_call_on_gives_the_same_bits(world):
    Passing.calls.clear()
    np.testing.assert_array_equal(played(world, Passing), played(world, None))
    assert Passing.calls == [2, 2]
    quick = d.AnimateOptions(settle_seconds=0.1)
    ours = d.animate(world.character, world.motion, quick).surface
    np.testing.assert_array_equal(d.animate(world.character, world.motion, quick, make_solver=Passing).surface, ours)
    one_by_one = []
    d.animate_each(world.character, world.motion, lambda f: one_by_one.append(f.surface.copy()), quick, make_solver=Passing)
    np.testing.assert_array_equal(one_by_one, ours)
    assert Passing.calls[2:] == [1] * (2 * (4 + 2))  # twice: a settling of four frames, and three frames


def test_the_search_runs_on_the_solver_it_is_given(world):
    Passing.calls.clear()
    space, energy = d.ParameterSpace(names=["d_n"]), d.EnergyOptions(settle_frames=1)
    simulators = [
        d.CharacterSimulator(world.actor, world.segmentation, world.proxies, make_solver=m) for m in (None, Passing, NumpySolver)
    ]
    objectives = [d.MaterialObjective(s, world.performance, world.observations, 1 / 40, energy, space) for s in simulators]
    samples = [[d.Material(d_n=n)] for n in range(3)]
    ours, passed, numpy = (o.energies(samples) for o in objectives)
    np.testing.assert_array_equal(passed, ours)
    assert 3 in Passing.calls  # the generation in one call
    assert np.isfinite(numpy).all()
    same, also, other = (o.fingerprint for o in objectives)
    assert same == also != other  # a checkpoint goes on with whoever steps to the same bits, and with nobody else


def test_a_model_is_arrays_that_cannot_be_written_to(world):
    v, f = np.array(world.mesh.vertices), np.array(world.mesh.faces)
    model = d.ClothModel(v, f, world.cloth, d.ClothOptions(gravity=[0, 0, -2]))
    for name, expected in (("rest", v), ("faces", f), ("clothness", world.cloth)):
        np.testing.assert_array_equal(getattr(model, name), expected)
        with pytest.raises(ValueError, match="read-only"):
            getattr(model, name)[0] = 0
    corners = f[np.isin(f, np.flatnonzero(world.cloth)).any(axis=1)]
    assert (
        len(corners)
        and (model.inverse_masses[world.cloth == 0] == 0).all()
        and (model.inverse_masses[world.cloth == 1] > 0).all()
    )
    model.options.substeps = 7
    assert model.options.substeps == d.ClothOptions().substeps


def one_step(advance):
    """A solver whose advance() is given steps one free triangle, and the state afterwards."""
    solver = type("Own", (d.ClothSolver,), {"advance": advance} if advance else {})
    model = d.ClothModel(np.eye(3), np.array([[0, 1, 2]]), np.ones(3))
    state = d.ClothState(np.eye(3))
    try:
        return solver(model).step_batch([state], [d.StepInputs()], [d.Material()]), state
    finally:
        np.testing.assert_array_equal(state.velocities, 0)


def too_small(self, states, inputs, materials, threads):
    states[0].positions = np.zeros((2, 3))


def raising(self, states, inputs, materials, threads):
    raise LookupError("from the solver")


@pytest.mark.parametrize(
    ("advance", "error", "says"),
    [
        (None, RuntimeError, "ClothSolver.advance is not defined"),
        (too_small, ValueError, "ClothState.positions must have 3 rows, found 2"),
        (raising, LookupError, "from the solver"),
        (lambda *_: "done", TypeError, "ClothSolver.advance must return indices .* found"),
        (lambda *_: [3], RuntimeError, "must return ascending indices of 1 simulations, found 3"),
        (lambda *_: [-1], RuntimeError, "must return ascending indices of 1 simulations, found -1"),
    ],
)
def test_a_solver_that_breaks_its_word_gets_a_sentence(advance, error, says):
    with pytest.raises(error, match=says):
        one_step(advance)


def test_what_is_not_finite_is_named_and_left_alone(world):
    def explode(self, states, inputs, materials, threads):
        states[0].positions[1] = np.nan

    failed, state = one_step(explode)
    assert failed == [0]
    np.testing.assert_array_equal(state.positions, np.eye(3))
    with pytest.raises(RuntimeError, match="not finite"):
        played_once = d.CharacterSimulator(
            world.actor, world.segmentation, world.proxies, make_solver=type("Own", (d.ClothSolver,), {"advance": explode})
        )
        posed = played_once.pose(world.dofs[0])
        played_once.step(played_once.start(posed), posed, posed, [d.Material()], 0.025)


def test_what_a_solver_keeps_stays_valid():
    kept = []

    def keep(self, states, inputs, materials, threads):
        states[0].positions[:] += 1
        kept.append((states[0].positions, inputs[0].targets, materials[0]))

    _, state = one_step(keep)
    state.positions[:] = 5
    np.testing.assert_array_equal(kept[0][0], np.eye(3) + 1)
    assert kept[0][1].shape == (0, 3) and kept[0][2].d_n == d.Material().d_n


def test_make_solver_must_make_solvers_of_its_model(world):
    other = d.ClothModel(np.eye(3), np.array([[0, 1, 2]]), np.ones(3))
    for make, error, says in (
        (lambda model: None, TypeError, "make_solver must return a ClothSolver, found"),
        (lambda model: d.ClothSolver.create(other), ValueError, "of the model that it is given, found one of another"),
        (lambda: None, TypeError, "positional argument"),
    ):
        with pytest.raises(error, match=says):
            d.CharacterSimulator(world.actor, world.segmentation, world.proxies, make_solver=make)


class Straight(d.BodyModel):
    """A model of the SMPL family by way of Python, without the derivatives of its bends."""

    def __init__(self, inner):
        super().__init__(
            vertex_count=inner.vertex_count,
            component_count=inner.component_count,
            faces=inner.faces,
            landmarks=inner.landmarks,
            name="own",
            shape_count=inner.shape_count,
            joint_names=inner.joint_names,
        )
        self.inner = inner

    def vertices(self, coefficients):
        return self.inner.vertices(coefficients)

    def component(self, k):
        return self.inner.component(k)


class OwnBody(Straight):
    """The whole model."""

    def linearise(self, coefficients, chosen):
        return self.inner.linearise(coefficients, chosen)

    def joints(self, coefficients):
        return self.inner.joints(coefficients)


@pytest.fixture(scope="module")
def body(tmp_path_factory):
    path = tmp_path_factory.mktemp("body") / "model.npz"
    np.savez(path, **smpl_arrays())
    return d.BodyModel.read(path)


def test_body_models_keep_the_rules(body):
    assert testing.body_model_violations(body) == []
    assert testing.body_model_violations(OwnBody(body)) == []


def test_wrong_derivatives_are_caught(body):
    broken = testing.body_model_violations(Straight(body))
    assert any("jacobian of linearise()" in sentence for sentence in broken)
    assert any("joints() has another number" in sentence for sentence in broken)

    class Linear(d.BodyModel):
        def __init__(self):
            super().__init__(vertex_count=3, component_count=1, faces=np.array([[0, 1, 2]]))

        def vertices(self, coefficients):
            if len(coefficients) != 1:
                raise ValueError("one coefficient")
            return np.eye(3) * (1 + coefficients[0])

        def component(self, k):
            return np.eye(3)

    class Wrong(Linear):
        def component(self, k):
            return 2 * np.eye(3)

    assert testing.body_model_violations(Linear()) == []
    assert any("not the derivative" in sentence for sentence in testing.body_model_violations(Wrong()))


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"vertex_count": 3, "component_count": 1, "faces": [[0, 1, 3]]}, "faces must have indices in"),
        ({"vertex_count": 3, "component_count": 1, "faces": [[0, 1, 2]], "landmarks": {"toe": 9}}, "landmark 'toe'"),
        ({"vertex_count": 3, "component_count": 1, "faces": [[0, 1, 2]], "shape_count": 2}, "shape_count"),
    ],
)
def test_a_body_model_is_checked(arguments, says):
    with pytest.raises(ValueError, match=says):
        d.BodyModel(**arguments)


def test_a_body_model_of_the_wrong_size_gets_a_sentence():
    class Short(d.BodyModel):
        def __init__(self):
            super().__init__(vertex_count=3, component_count=1, faces=np.array([[0, 1, 2]]))

        def vertices(self, coefficients):
            return np.zeros((2, 3))

        def component(self, k):
            return "none"

    with pytest.raises(ValueError, match="BodyModel.vertices must return 3 points, found 2"):
        d.BodyModel.vertices(Short(), np.zeros(1))
    assert any("must return 3 points" in s for s in testing.body_model_violations(Short()))


def test_the_other_kits(world):
    assert testing.cloth_segmenter_violations(d.ClothSegmenter.create()) == []
    assert testing.garment_mesher_violations(d.GarmentMesher.create(), world.actor, world.segmentation) == []
    assert testing.optimizer_violations(lambda n, seed: d.create_cma_es(n, d.CmaEsOptions(seed=seed))) == []

    class Wrong(d.ClothSegmenter):
        def segment(self, inputs, context):
            return "cloth"

    assert any("ClothSegmenter.segment must return a Segmentation" in s for s in testing.cloth_segmenter_violations(Wrong()))


class Distance(d.Objective):
    """To the middle of the box; of the whole generation, if `shared`."""

    def __init__(self, shared):
        super().__init__()
        self.shared = shared

    def parameter_count(self):
        return 3

    def evaluate(self, samples, context):
        if samples.shape[1] != 3:
            raise ValueError(f"expected 3 parameters, found {samples.shape[1]}")
        energies = np.square(samples - 0.5).sum(axis=1, keepdims=True)
        return energies - energies.max() if self.shared else energies


def test_the_kit_for_objectives():
    assert testing.objective_violations(Distance(shared=False)) == []
    assert testing.objective_violations(Distance(shared=True)) == ["a sample alone has another energy than among others"]


DERIVED = runpy.run_path(str(ROOT / "tests" / "consumer" / "derived.py"))


def test_what_a_typed_user_derives_keeps_the_rules(world):
    images = np.zeros((2, 3, 8, 8, 3), np.uint8)
    images[:, :, 2:6, 3:5] = 200
    film, bright = DERIVED["Film"](images), DERIVED["Bright"]()
    assert (film.camera_count, film.frame_count) == (2, 3)
    assert testing.frame_source_violations(film) == []
    assert d.read_view(film, 1, 2, bright).mask.sum() == 8 * 255
    assert testing.body_model_violations(DERIVED["Growing"]()) == []
    assert testing.objective_violations(DERIVED["Distance"]()) == []
    assert testing.optimizer_violations(lambda dimension, seed: DERIVED["Halving"](dimension)) == []
    assert testing.garment_mesher_violations(DERIVED["Meshed"](), world.actor, world.segmentation) == []
    assert any(s.startswith("cloth falls: the solver threw") for s in testing.cloth_solver_violations(DERIVED["AsStiffAsSkin"]))
    found = d.minimise(DERIVED["Distance"](), DERIVED["solvers"]())
    np.testing.assert_allclose(found.parts[0].best, 0.6, atol=0.01)


def test_a_typed_user_derives_every_interface():
    """Each that has a kit."""
    derived = {base.__name__ for of in DERIVED.values() if inspect.isclass(of) for base in of.__mro__[1:]}
    kits = {name.removesuffix("_violations").title().replace("_", "") for name in testing.__all__}
    assert len(kits) == 14 and kits <= derived, kits - derived


def test_counts_of_a_film_are_properties_and_methods_are_old():
    def film(**members):
        empty = {"image": lambda self, c, t: np.zeros((4, 4, 3), np.uint8), "mask": lambda self, c, t: np.zeros((0, 0), np.uint8)}
        return type("Own", (d.FrameSource,), {**empty, **members})

    counts = {"frame_count": property(lambda self: 2), "camera_count": property(lambda self: 1)}
    assert testing.frame_source_violations(film(**counts)()) == []
    with pytest.warns(DeprecationWarning, match="Own.frame_count as a method is deprecated: make it a property"):
        old = film(frame_count=lambda self: 2, camera_count=counts["camera_count"])()
    assert (old.frame_count, old.camera_count) == (2, 1)  # to callers, too
    assert testing.frame_source_violations(old) == []
    (said,) = testing.frame_source_violations(film(camera_count=counts["camera_count"])())
    assert "FrameSource.frame_count is not defined by the subclass" in said
    (said,) = testing.frame_source_violations(film(frame_count="two", camera_count=counts["camera_count"])())
    assert "FrameSource.frame_count must be a whole number, found str" in said


def test_advance_is_there_to_be_found():
    assert "advance" in dir(d.ClothSolver)
    model = d.ClothModel(np.eye(3), np.array([[0, 1, 2]]), np.ones(3))
    with pytest.raises(RuntimeError, match="for subclasses to define; call step_batch"):
        d.ClothSolver.create(model).advance([d.ClothState(np.eye(3))], [d.StepInputs()], [d.Material()], 1)


def arrays_of(value, seen):
    """(class, property, object) of every property that is an array, of all that can be reached."""
    kind = type(value)
    if isinstance(value, (list, tuple)) and value:
        yield from arrays_of(value[0], seen)
    if not kind.__module__.startswith("doublet") or kind in seen:
        return
    seen.add(kind)
    for name in (n for n in dir(kind) if isinstance(getattr(kind, n), property)):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # old names
            found = getattr(value, name)
        if isinstance(found, np.ndarray):
            yield kind.__name__, name, value
        else:
            yield from arrays_of(found, seen)


def test_no_array_of_a_class_swallows_what_is_written_to_it(world):
    """It is a view, or it cannot be written to."""
    seen, tried = set(), 0
    parts = [getattr(world, name) for name in dir(world) if not name.startswith("_")]
    parts += [d.trace_outline(np.pad(np.full((4, 4), 255, np.uint8), 4)), d.Features(np.zeros((2, 2)), np.zeros((2, 1)))]
    parts += [d.ClothState(np.eye(3)), d.CameraView(np.zeros((2, 2, 3), np.uint8)), d.SegmentInputs(world.performance.surface)]
    for owner, name, value in (found for part in parts for found in arrays_of(part, seen)):
        array = getattr(value, name)
        tried += 1
        if array.flags.writeable and array.size:
            before = array.copy()
            array.flat[0] += 1
            assert not np.array_equal(getattr(value, name), before, equal_nan=True), f"{owner}.{name}"
            array.flat[0] = before.flat[0]
    assert tried > 40
    with pytest.raises(ValueError, match="read-only"):
        world.performance.surface.frames[0][:] = 1
    with pytest.raises(ValueError, match="read-only"):
        world.actor.face_valid[0] = 0
