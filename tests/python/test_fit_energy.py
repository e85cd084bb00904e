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
    return d.MaterialObjective(simulator, captured, d.read_observations(bell / "observations.npz"))


def test_terms_add_up_to_the_energy(objective):
    (terms,) = objective.terms([TRUTH])
    count = len(terms["silhouette"])
    assert {k: (v.shape, v.dtype.kind) for k, v in terms.items()} == {
        **dict.fromkeys(("silhouette", "feature", "contour"), ((count,), "f")),
        **dict.fromkeys(("rims", "features", "points"), ((count,), "i")),
    }
    assert terms["features"].max() == 0 and min(terms["rims"].min(), terms["points"].min()) > 0  # a bell without texture
    energy = terms["silhouette"].mean() + terms["contour"].mean()
    assert objective.energies([[TRUTH]])[0, 0] == pytest.approx(energy)


def test_the_captured_surface_costs_little_and_none_the_most(objective, captured):
    surfaces = np.stack(captured.surface.frames)
    (own,) = objective.surface_energy(surfaces)
    assert 0 < own < 0.1 * objective.worst_energy
    (terms,) = objective.surface_terms(surfaces)
    assert terms["contour"].max() < 9
    away = surfaces + [0, 100.0, 0]
    assert objective.surface_energy(away)[0] == pytest.approx(objective.worst_energy, rel=1e-4)
    with pytest.raises(ValueError, match="surfaces: expected"):
        objective.surface_energy(surfaces[1:])
