"""Optimisers of other packages behind `doublet.Optimizer`: pycma, Optuna, Nevergrad, or anything else that asks and tells.

Each function below returns what `make_optimizer` of `minimise` and `FitOptions` takes. The packages are imported when the search
starts, and only the one that is used: `pip install cma`, `optuna`, `nevergrad`.
"""

from __future__ import annotations

import json

import numpy as np

from . import _doublet as d


class AskTell(d.Optimizer):
    """What an optimiser that can only ask and tell lacks: budget, best sample, a state that can be saved.

    A subclass defines `draw() -> (S, n)` and `learn(samples, energies)`; it may define `answer`, `deviations` and `converged`.
    The saved state is what was told. `restore` tells it again to a new optimiser, which must therefore draw the same samples
    for the same seed; if it does not, RuntimeError says so.
    """

    def __init__(self, dimension: int, max_evaluations: int = 512):
        super().__init__()
        self.dimension, self.max_evaluations = dimension, max_evaluations
        self.told: list[tuple[np.ndarray, np.ndarray]] = []  # samples (S, n) and energies (S) of every generation

    def draw(self) -> np.ndarray:
        """(S, n) the next generation, in [0, 1] or near it."""
        raise NotImplementedError(f"{type(self).__name__}.draw")

    def learn(self, samples: np.ndarray, energies: np.ndarray) -> None:
        """Samples (S, n) as drawn last, and their energies (S)."""
        raise NotImplementedError(f"{type(self).__name__}.learn")

    def answer(self) -> np.ndarray:
        """(n) default: the best sample."""
        return self.best()[0]

    def deviations(self) -> np.ndarray:
        """(n) spread of the search, box units; default: of the better quarter of all samples."""
        samples, energies = self.history()
        better = np.argsort(energies, kind="stable")[: max(2, len(energies) // 4)]
        return samples[better].std(axis=0) if len(samples) else np.full(self.dimension, np.sqrt(1 / 12))

    def converged(self) -> str:
        """Why to stop before the budget is spent; empty: go on."""
        return ""

    def history(self) -> tuple[np.ndarray, np.ndarray]:
        """All samples (N, n) and energies (N) told so far."""
        samples = [np.empty((0, self.dimension)), *(s for s, _ in self.told)]
        return np.concatenate(samples), np.concatenate([np.empty(0), *(e for _, e in self.told)])

    def best(self) -> tuple[np.ndarray, float]:
        samples, energies = self.history()
        if not len(energies):
            return np.full(self.dimension, 0.5), np.inf
        return samples[energies.argmin()], float(energies.min())

    def ask(self) -> np.ndarray:
        return np.asarray(self.draw(), float).reshape(-1, self.dimension)

    def tell(self, samples, energies) -> None:
        self.learn(samples, energies)
        self.told.append((np.array(samples), np.array(energies)))

    def reason(self) -> str:
        spent = sum(len(energies) for _, energies in self.told) >= self.max_evaluations
        return f"{self.max_evaluations} evaluations" if spent else self.converged()

    def stop(self) -> bool:
        return bool(self.reason())

    def result(self) -> d.OptimizerResult:
        result = d.OptimizerResult()
        result.answer, result.deviations = self.answer(), self.deviations()
        result.best, result.best_energy = self.best()
        result.evaluations, result.generations = len(self.history()[1]), len(self.told)
        result.stop_reason = self.reason()
        return result

    def save(self) -> str:
        told = [[samples.tolist(), energies.tolist()] for samples, energies in self.told]
        return json.dumps({"kind": type(self).__name__, "told": told})

    def restore(self, state: str) -> None:
        saved = json.loads(state)
        if saved.get("kind") != type(self).__name__:
            raise d.Error(f"optimiser state: expected kind '{type(self).__name__}', found '{saved.get('kind')}'")
        for samples, energies in saved["told"]:
            drawn = self.ask()
            if not np.array_equal(drawn, samples):
                raise d.Error(
                    f"optimiser state: {type(self).__name__} does not draw the same samples again: version or options changed"
                )
            self.tell(drawn, np.array(energies))


class Pycma(AskTell):
    """https://github.com/CMA-ES/pycma; the answer is the mean of the distribution."""

    def __init__(self, dimension, seed, max_evaluations, sigma, min_deviation, options):
        import cma

        super().__init__(dimension, max_evaluations)
        random = np.random.default_rng(seed)  # its own, not NumPy's global one: regions are searched side by side
        own = {"seed": np.nan, "randn": lambda *shape: random.standard_normal(shape), "verbose": -9}
        self.strategy = cma.CMAEvolutionStrategy(np.full(dimension, 0.5), sigma, {**own, **options})
        self.min_deviation = min_deviation

    def draw(self):
        return np.array(self.strategy.ask())

    def learn(self, samples, energies):
        self.strategy.tell(list(samples), energies.tolist())

    def answer(self):
        return np.array(self.strategy.mean)

    def deviations(self):
        return np.array(self.strategy.result.stds)

    def converged(self):
        if max(self.deviations()) < self.min_deviation:
            return f"every standard deviation below {self.min_deviation}"
        return ", ".join(f"{name} {value}" for name, value in self.strategy.stop().items())


class Optuna(AskTell):
    """https://optuna.org, by its ask and tell; the answer is the best sample."""

    def __init__(self, dimension, max_evaluations, population, sampler):
        import optuna

        super().__init__(dimension, max_evaluations)
        optuna.logging.set_verbosity(optuna.logging.WARNING)
        self.study = optuna.create_study(sampler=sampler)
        self.population = population
        self.trials: list = []

    def draw(self):
        self.trials = [self.study.ask() for _ in range(self.population)]
        return np.array([[trial.suggest_float(f"x{i}", 0, 1) for i in range(self.dimension)] for trial in self.trials])

    def learn(self, samples, energies):
        for trial, energy in zip(self.trials, energies):
            self.study.tell(trial, float(energy))


class Nevergrad(AskTell):
    """https://facebookresearch.github.io/nevergrad; the answer is its recommendation."""

    def __init__(self, dimension, seed, max_evaluations, population, name):
        import nevergrad

        super().__init__(dimension, max_evaluations)
        box = nevergrad.p.Array(init=np.full(dimension, 0.5), lower=0.0, upper=1.0)
        box.random_state = np.random.RandomState(seed % 2**32)
        self.optimizer = nevergrad.optimizers.registry[name](box, budget=max_evaluations, num_workers=population)
        self.population = population
        self.candidates: list = []

    def draw(self):
        self.candidates = [self.optimizer.ask() for _ in range(self.population)]
        return np.array([candidate.value for candidate in self.candidates])

    def learn(self, samples, energies):
        for candidate, energy in zip(self.candidates, energies):
            self.optimizer.tell(candidate, float(energy))

    def answer(self):
        return np.array(self.optimizer.provide_recommendation().value)


def pycma(max_evaluations: int = 512, sigma: float = 0.3, min_deviation: float = 0.025, **options):
    """CMA-ES of the package `cma`; options: its own, e.g. popsize=16, CMA_active=False."""
    return lambda dimension, seed: Pycma(dimension, seed, max_evaluations, sigma, min_deviation, options)


def optuna(make_sampler=None, max_evaluations: int = 512, population: int = 8):
    """make_sampler(seed) -> an Optuna sampler; None: its tree of Parzen estimators. `population` samples a generation."""

    def make(dimension, seed):
        import optuna

        sampler = make_sampler(seed) if make_sampler else optuna.samplers.TPESampler(seed=seed)
        return Optuna(dimension, max_evaluations, population, sampler)

    return make


def nevergrad(name: str = "NGOpt", max_evaluations: int = 512, population: int = 8):
    """An optimiser of Nevergrad's registry; `population` samples a generation."""
    return lambda dimension, seed: Nevergrad(dimension, seed, max_evaluations, population, name)
