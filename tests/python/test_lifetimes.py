"""Objects of Python inside of calls of C++: collected neither too early nor never, called from several threads; log and bars."""

import gc
import io
import json
import logging
import sys
import weakref
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import doublet as d
import numpy as np
import pytest
from doublet.common.console import Console
from PIL import Image
from tqdm import tqdm

sys.path.append(str(Path(__file__).parents[1] / "fuzz"))
from seeds import World, write_session  # noqa: E402


@pytest.fixture(scope="module")
def world():
    return World()


class Collecting(d.ClothSolver):
    """Ours, by way of Python; collects garbage in the middle of a step."""

    def __init__(self, model):
        super().__init__(model)
        self.inner = d.ClothSolver.create(model)

    def advance(self, states, inputs, materials, threads):
        gc.collect()
        return self.inner.step_batch(states, inputs, materials, threads)


def played(world, make_solver) -> np.ndarray:
    """Of a simulator whose solvers nobody in Python holds."""
    simulator = d.CharacterSimulator(world.actor, world.segmentation, world.proxies, make_solver=make_solver)
    gc.collect()
    frames = [simulator.pose(dofs) for dofs in world.dofs]
    state = simulator.start(frames[0])
    for before, after in zip(frames, frames[1:]):
        simulator.step(state, before, after, [d.Material()], 0.025)
    return np.array(simulator.surface(state, frames[-1]))


def test_solvers_live_as_long_as_what_calls_them(world):
    made = []

    def make(model):
        solver = Collecting(model)
        made.append(weakref.ref(solver))
        return solver

    np.testing.assert_array_equal(played(world, make), played(world, None))
    gc.collect()
    assert made and all(solver() is None for solver in made)


def test_subclasses_from_several_threads(world):
    expected = played(world, None)
    with ThreadPoolExecutor(4) as pool:
        for surface in pool.map(lambda _: played(world, Collecting), range(8)):
            np.testing.assert_array_equal(surface, expected)


class Below(d.ClothSegmenter):
    def segment(self, inputs, context):
        gc.collect()
        context.report_progress("below", 0.5)
        context.log_line("below: looked")
        cloth = (inputs.surface.frames[0][:, 1] < 1.0).astype(float)
        return d.Segmentation(np.zeros_like(cloth), cloth, np.where(cloth > 0, 0, -1).astype(np.int32))


def segmented(world, segmenter, context=None):
    return d.segment_performance(world.actor, world.performance, segmenter, context=context or d.Context())


@pytest.mark.slow
def test_one_segmenter_in_several_threads(world):
    """While another thread collects garbage all the time."""
    expected, segmenter = segmented(world, Below()).clothness, Below()
    with ThreadPoolExecutor(5) as pool:
        collecting = pool.submit(lambda: [gc.collect() for _ in range(50)])
        for found in pool.map(lambda _: segmented(world, segmenter), range(16)):
            np.testing.assert_array_equal(found.clothness, expected)
        assert len(collecting.result()) == 50


class Bowl(d.Objective):
    def parameter_count(self):
        return 2

    def evaluate(self, samples, context):
        gc.collect()
        return np.square(samples - 0.7).sum(axis=1, keepdims=True)


def test_optimisers_made_on_the_way():
    made = []

    def make(dimension, seed):
        optimizer = d.create_cma_es(dimension, d.CmaEsOptions(max_evaluations=32, seed=seed))
        made.append(1)
        return optimizer

    options = d.MinimiseOptions()
    options.make_optimizer = make
    del make
    gc.collect()
    found = d.minimise(Bowl(), options)
    assert made and found.parts[0].best_energy < 0.1


class Corners(d.FeatureTracker):
    def detect(self, image, mask):
        return d.Features(np.zeros((0, 2), np.float32), np.zeros((0, 1)))

    def match(self, previous, current, reach):
        return []


def test_parts_live_as_long_as_the_capture():
    tracker = Corners()
    seen = weakref.ref(tracker)
    capture = d.PerformanceCapture.create(d.CaptureOptions(), d.CaptureParts(features=tracker))
    del tracker
    gc.collect()
    assert seen() is not None
    del capture
    gc.collect()
    assert seen() is None


def test_an_objective_keeps_what_it_was_made_of():
    """Nothing that its maker changes afterwards, or drops, changes an energy."""
    world = World()
    objective = d.MaterialObjective(world.simulator, world.performance, world.observations, 1 / 40)
    materials = [[d.Material(k_bend=0.3)]]
    before = objective.energies(materials)
    world.performance.dofs = world.performance.dofs + 0.5
    world.performance.surface.frames = world.performance.surface.frames + 0.5
    world.observations.views = []
    del world
    gc.collect()
    np.testing.assert_array_equal(objective.energies(materials), before)


def test_arrays_outlive_their_owner(world):
    mesh = d.Mesh(world.mesh.vertices, world.mesh.faces)
    vertices, expected = mesh.vertices, np.array(mesh.vertices)
    del mesh
    gc.collect()
    np.testing.assert_array_equal(vertices, expected)


def test_the_log_goes_to_logging_and_progress_to_a_bar(world, caplog):
    caplog.set_level(logging.INFO, logger="doublet")
    shown = io.StringIO()
    with tqdm(total=1.0, file=shown) as bar:
        progress = lambda stage, fraction: bar.update(fraction - bar.n)  # noqa: E731
        segmented(world, Below(), d.Context(progress=progress, log=logging.getLogger("doublet").info))
        assert bar.n == 0.5
    assert [(r.name, r.message) for r in caplog.records] == [("doublet", "below: looked")]
    assert "50%" in shown.getvalue()


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_the_commands_bars(world):
    """On a terminal a bar that goes when it is done, elsewhere lines."""
    for stream, bar in ((Terminal(), True), (io.StringIO(), False)):
        console = Console(stream=stream, verbose=True)
        segmented(world, Below(), console.context())
        console.finish()
        assert ("below: looked" in stream.getvalue()) and ("|" in stream.getvalue()) == bar
        assert ("below: 50 % after" in stream.getvalue()) != bar


def film_noise(world, folder) -> dict:
    """Writes a session of images without masks; its description."""
    write_session(folder, world)
    described = json.loads((folder / "session.json").read_text())
    for camera in described["cameras"]:
        camera["video"] = camera.pop("masks")
    (folder / "session.json").write_text(json.dumps(described))
    random = np.random.default_rng(1)
    for path in (folder / "masks").glob("*.png"):
        width, height = Image.open(path).size
        Image.fromarray(random.integers(0, 256, (height, width, 3), np.uint8)).save(path)
    return described


def test_silhouettes_outlive_the_session_that_they_were_made_for(world, tmp_path):
    described = film_noise(world, tmp_path)
    made = d.Reconstruction(tmp_path, tmp_path / "out")
    silhouettes, image = made.silhouettes, d.FrameSource.open(made.session).image(0, 0)
    before = silhouettes.extract(0, image)
    made.session = d.Session(tmp_path)
    np.testing.assert_array_equal(silhouettes.extract(0, image), before)
    assert made.silhouettes is not silhouettes
    described["cameras"] = described["cameras"][:1]
    (tmp_path / "session.json").write_text(json.dumps(described))
    made.reread_session()  # its files were changed: what was trained on the cameras that there were is not used on
    np.testing.assert_array_equal(made.silhouettes.extract(0, image), before)
    with pytest.raises(ValueError, match="camera"):
        made.silhouettes.extract(1, image)


def test_a_session_that_was_edited_is_read_again(world, tmp_path):
    """As run.json says: the stage runs because a file of it has changed."""
    write_session(tmp_path / "session", world)
    made = d.Reconstruction(tmp_path / "session", tmp_path / "out")
    height = d.Stage("height", lambda job: {"y": float(job.session.joints[0].position[1])}, session_inputs=["joints"])
    made.stages = [height]
    joints = tmp_path / "session" / "joints.json"
    for y in (1.0, 1.25):
        described = json.loads(joints.read_text())
        described["joints"]["pelvis"]["position"][1] = y
        joints.write_text(json.dumps(described, indent=int(4 * y)))
        assert made.run(["height"]) and not made.run(["height"])
        assert made.record.summary("height") == {"y": y}
    given = made.session
    given.joints = [d.JointAnnotation("pelvis", "", [0, 2, 0])]
    made.session = given  # goes before what is in the folder
    joints.write_text(joints.read_text() + "\n")
    made.run(["height"])
    assert made.record.summary("height") == {"y": 2}


def test_silhouettes_are_made_with_the_options_that_there_are(world, tmp_path):
    """run.json says that they were."""
    film_noise(world, tmp_path)
    made = d.Reconstruction(tmp_path, tmp_path / "out")
    silhouettes, image = made.silhouettes, d.FrameSource.open(made.session).image(0, 0)
    assert made.silhouettes is silhouettes
    made.options["silhouette"].method = "plates"  # which the session has not
    with pytest.raises(d.Error, match="plate"):
        _ = made.silhouettes
    made.options["silhouette"].method = "median"
    assert made.silhouettes is not silhouettes
    np.testing.assert_array_equal(silhouettes.extract(0, image), made.silhouettes.extract(0, image))
