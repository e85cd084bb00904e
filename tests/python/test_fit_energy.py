"""E_fit term by term, of simulations and of surfaces that were not simulated."""

import doublet as d
import numpy as np
import pytest

TRUTH = d.Material(d_n=4, d_t=4.9, k_bend=0.3, k_stretch=0.999)


@pytest.fixture
def captured(bell):
    actor = d.read_actor(bell / "actor.npz")
    return d.read_performance(bell / "performance.npz", actor)


@pytest.fixture
def objective(bell, captured):
    actor = d.read_actor(bell / "actor.npz")
    simulator = d.CharacterSimulator(actor, d.read_segmentation(bell / "segmentation.npz"), [])
    return d.MaterialObjective(simulator, captured, d.read_observations(bell / "observations.npz"), 1 / 40)


def test_terms_add_up_to_the_energy(objective):
    (terms,) = objective.terms([TRUTH])
    count = len(terms["silhouette"])
    assert {k: (v.shape, v.dtype.kind) for k, v in terms.items()} == {
        **dict.fromkeys(("silhouette", "feature", "contour", "surface"), ((count,), "f")),
        **dict.fromkeys(("rims", "features", "points", "probes"), ((count,), "i")),
    }
    assert terms["features"].max() == 0 and min(terms["rims"].min(), terms["points"].min()) > 0  # a bell without texture
    energy = terms["silhouette"].mean() + terms["contour"].mean() + terms["surface"][terms["probes"] > 0].mean()
    assert objective.energies([[TRUTH]])[0, 0] == pytest.approx(energy)


def test_the_captured_surface_costs_little_and_none_the_most(objective, captured):
    surfaces = np.stack(captured.surface.frames)
    (own,) = objective.surface_energy(surfaces)
    assert 0 < own < 0.1 * objective.worst_energy
    (terms,) = objective.surface_terms(surfaces)
    assert terms["contour"].max() < 9 and terms["surface"].max() < 1e-6
    away = surfaces + [0, 100.0, 0]
    assert objective.surface_energy(away)[0] == pytest.approx(objective.worst_energy, rel=1e-4)
    with pytest.raises(ValueError, match="surfaces: expected"):
        objective.surface_energy(surfaces[1:])


def test_cloth_is_put_on_before_a_first_pose_that_is_bent(shapes):
    """Whoever is filmed from a lunge on: at its rest shape the skirt would be several times as long between the legs."""
    vertices, faces = shapes["tube"](lambda h: 0.4 - 0.25 * h, 0.4, 1.0, around=32, rows=17)
    marks = [("pelvis", "", [0, 1, 0]), ("l_hip", "pelvis", [0.1, 0.9, 0]), ("r_hip", "pelvis", [-0.1, 0.9, 0])]
    skeleton = d.Skeleton([d.JointAnnotation(name, parent, at) for name, parent, at in marks])
    left, legs = np.clip(0.5 + 4 * vertices[:, 0], 0, 1), np.clip((0.95 - vertices[:, 1]) / 0.2, 0, 1)
    weights = np.stack([1 - legs, legs * left, legs * (1 - left)], axis=1)
    actor = d.RiggedMesh(d.Mesh(vertices, faces), [1] * len(faces), weights, skeleton)
    cloth = (vertices[:, 1] < 0.95).astype(float)
    segmentation = d.Segmentation(np.zeros_like(cloth), cloth, np.where(cloth > 0, 0, -1).astype(np.int32))
    segmentation.rest = vertices
    simulator = d.CharacterSimulator(actor, segmentation, [])
    edges = np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)

    def longest(surface):
        a, b = surface[edges[:, 0]] - surface[edges[:, 1]], vertices[edges[:, 0]] - vertices[edges[:, 1]]
        return (np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1)).max()

    performance = d.ReferencePerformance()
    dofs = np.zeros((8, len(skeleton.dof_names)))
    dofs[:, skeleton.dof_names.index("l_hip.x")] = -1.2
    dofs[:, skeleton.dof_names.index("r_hip.x")] = 0.9
    performance.dofs = dofs
    performance.frames, performance.joints = list(range(8)), np.zeros((8, 3, 3))
    performance.surface = d.MeshSequence(faces, np.repeat(vertices[None], 8, axis=0))
    material = d.Material(d_n=4, d_t=4.9, k_bend=0.3, k_stretch=1)
    posed = simulator.pose(performance.dofs[0])
    frames = d.simulate_reference(simulator, performance, [material], 1 / 40)
    assert longest(np.asarray(simulator.surface(simulator.start(posed), posed))) > 4
    assert longest(np.asarray(frames[0])) < 1.2
    # The energy begins as the re-animation does.
    performance.surface = d.MeshSequence(faces, np.asarray(frames))
    observations = d.Observations()
    observations.cameras = [shapes["camera"](a, name=f"cam{i}", height=0.8, size=320) for i, a in enumerate((0, 2.1, 4.2))]
    observations.frames = performance.frames
    observations.views = shapes["views"](frames, faces, observations.cameras)
    (energy,) = d.material_energy(simulator, performance, observations, 1 / 40, [material])
    assert energy < 1.5  # pixels^2


class Bell(d.FrameSource):
    """Masks of surfaces that are known."""

    def __init__(self, surface, cameras):
        super().__init__()
        self.surface, self.cameras = surface, cameras

    @property
    def frame_count(self):
        return len(self.surface)

    @property
    def camera_count(self):
        return len(self.cameras)

    def image(self, camera, frame):
        return np.zeros((0, 0, 3), np.uint8)

    def mask(self, camera, frame):
        seen, _ = d.rasterize(self.surface.frames[frame], self.surface.faces, self.cameras[camera])
        return np.where(seen >= 0, 255, 0).astype(np.uint8)


class MarkerSystem(d.PerformanceCapture):
    """A tracker that knows the poses from elsewhere, and has the library measure what the fit wants to see."""

    def __init__(self, performance):
        super().__init__()
        self.performance = performance

    def capture(self, actor, rig, frames, extractor=None, context=None):
        result = d.CaptureResult()
        result.performance = self.performance
        result.observations = d.measure_observations(rig, frames, extractor, list(self.performance.frames))
        return result


def test_a_tracker_of_ones_own_goes_on_to_the_fit(captured, bell):
    actor, cameras = d.read_actor(bell / "actor.npz"), d.read_observations(bell / "observations.npz").cameras
    simulator = d.CharacterSimulator(actor, d.read_segmentation(bell / "segmentation.npz"), [], d.ClothOptions.paper())
    film = Bell(captured.surface, cameras)
    found = MarkerSystem(captured).capture(actor, cameras, film)
    assert len(found.observations.views) == len(captured.surface)
    objective = d.MaterialObjective(simulator, found.performance, found.observations, 1 / 40)
    light, true, heavy = objective.energies([[d.Material(d_n=n, d_t=4.9, k_bend=0.3, k_stretch=0.999)] for n in (0, 4, 20)])[:, 0]
    assert true < min(light, heavy)
    fit = d.FitOptions(max_evaluations=8, initial_design_size=4)
    fit.space = d.ParameterSpace(names=["d_n"])
    (region,) = d.estimate_material(simulator, found.performance, found.observations, 1 / 40, fit).to_dict()["regions"]
    assert 0 < region["energy"] <= region["energy_at_centre"]
