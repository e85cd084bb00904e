"""Optimisers of other packages, and everybody's own, behind d.Optimizer."""

import json

import doublet as d
import numpy as np
import pytest
from doublet import optimizers


class Bowl(d.Objective):
    """Two parts with minima at 0.7 and at the corner 1; dies after `lives` generations."""

    def __init__(self, lives=10**6):
        super().__init__()
        self.lives = lives

    def parameter_count(self):
        return 3

    def part_count(self):
        return 2

    def evaluate(self, samples, context):
        self.lives -= 1
        if self.lives < 0:
            raise LookupError("power cut")
        return np.stack([np.square(samples[:, :3] - 0.7).sum(axis=1), 9 * np.square(samples[:, 3:] - 1).sum(axis=1)], axis=1)


FACTORIES = {
    "pycma": optimizers.pycma(300),
    "pycma, own options": optimizers.pycma(300, popsize=12, CMA_active=False),
    "optuna": optimizers.optuna(max_evaluations=200),
    "nevergrad": optimizers.nevergrad("DE", 400),
}
PACKAGES = {"pycma": "cma", "pycma, own options": "cma", "optuna": "optuna", "nevergrad": "nevergrad"}


@pytest.fixture(params=FACTORIES)
def factory(request):
    pytest.importorskip(PACKAGES[request.param])
    return FACTORIES[request.param]


def test_it_finds_the_minima_of_both_parts(factory):
    first, second = d.minimise(Bowl(), d.MinimiseOptions(make_optimizer=factory, seed=4)).parts
    np.testing.assert_allclose(first.answer, 0.7, atol=0.15)
    np.testing.assert_allclose(second.answer, 1, atol=0.15)
    assert first.best_energy < 0.03 and 0 < first.evaluations <= 400 and first.stop_reason


def test_a_killed_search_resumes_to_the_same_bits(factory, tmp_path):
    whole = d.minimise(Bowl(), d.MinimiseOptions(make_optimizer=factory, seed=4))
    checkpoint = tmp_path / "checkpoint.json"
    with pytest.raises(LookupError, match="power cut"):
        d.minimise(Bowl(lives=5), d.MinimiseOptions(make_optimizer=factory, seed=4, checkpoint=checkpoint))
    rest = Bowl()
    resumed = d.minimise(rest, d.MinimiseOptions(make_optimizer=factory, seed=4, checkpoint=checkpoint))
    assert 10**6 - rest.lives == max(row.generation for row in whole.log) - 5
    for a, b in zip(whole.parts, resumed.parts):
        np.testing.assert_array_equal(a.answer, b.answer)
        np.testing.assert_array_equal(a.best, b.best)
        assert a.evaluations == b.evaluations
    assert [row.best for row in whole.log] == [row.best for row in resumed.log]


def test_pycma_estimates_a_material(bell):
    fit = d.FitOptions()
    fit.space = d.ParameterSpace(names=["d_n", "k_bend"], fixed=d.Material(d_t=4.9, k_bend=0.3, k_stretch=0.999))
    actor = d.read_actor(bell / "actor.npz")
    simulator = d.CharacterSimulator(actor, d.read_segmentation(bell / "segmentation.npz"), [], d.ClothOptions.paper())
    fit.make_optimizer = optimizers.pycma(72)
    result = d.estimate_material(
        simulator,
        d.read_performance(bell / "performance.npz", actor),
        d.read_observations(bell / "observations.npz"),
        1 / 40,
        fit,
    )
    region = result.to_dict()["regions"][0]
    assert 0 < region["evaluations"] <= 72 and region["stop_reason"] and region["energy"] < 0.5 * region["energy_at_centre"]
    assert abs(region["material"].d_n - 4) < 4


class Replies(d.Optimizer):
    """Answers whatever it is given."""

    def __init__(self, samples=None, answer=(0.5, 0.5, 0.5), failure=None):
        super().__init__()
        self.samples, self.answer, self.failure = samples, answer, failure

    def ask(self):
        if self.failure:
            raise self.failure
        return self.samples

    def tell(self, samples, energies):
        pass

    def stop(self):
        return False

    def result(self):
        result = d.OptimizerResult()
        result.answer = result.best = result.deviations = np.array(self.answer)
        return result


@pytest.mark.parametrize(
    "optimizer, error, text",
    [
        (lambda *_: None, TypeError, "make_optimizer must return an Optimizer, found NoneType"),
        (lambda *_: Replies("no samples"), TypeError, "Optimizer.ask must return samples"),
        (lambda *_: Replies(np.full((4, 3), 0.5 + 2j)), TypeError, r"Optimizer.ask must return .*, found complex numbers in"),
        (lambda *_: Replies([[0.5, 0.5, 0.5 + 0j]]), TypeError, "found complex numbers in list"),
        (lambda *_: Replies(np.zeros((4, 2))), ValueError, r"samples \(S, 3\), found \(4, 2\)"),
        (lambda *_: Replies(np.full((4, 3), np.nan)), ValueError, "NaN"),
        (lambda *_: Replies(np.zeros((4, 3)), answer=[0.5]), ValueError, "answer, best and deviations of 3"),
        (lambda *_: Replies(failure=ZeroDivisionError("in Python")), ZeroDivisionError, "in Python"),
    ],
)
def test_what_an_optimizer_does_wrong_is_said(optimizer, error, text):
    with pytest.raises(error, match=text):
        d.minimise(Bowl(), d.MinimiseOptions(make_optimizer=optimizer))


def test_a_state_that_is_not_its_own_is_refused():
    pytest.importorskip("cma")
    mine = optimizers.pycma()(3, 1)
    mine.tell(samples := mine.ask(), np.arange(len(samples)))
    with pytest.raises(d.Error, match="expected kind 'Pycma', found 'Optuna'"):
        optimizers.pycma()(3, 1).restore(json.dumps({"kind": "Optuna", "told": []}))
    with pytest.raises(d.Error, match="does not draw the same samples again"):
        optimizers.pycma()(3, 2).restore(mine.save())
