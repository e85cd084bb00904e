"""What a job's material is estimated and its character is animated with."""

from __future__ import annotations

import copy

from .. import _doublet as d
from .workspace import Workspace


def solver_settings(job: Workspace) -> d.SolverSettings:
    """Without which the materials mean nothing."""
    return d.SolverSettings(1 / (job.fps or job.session.fps), job.options["cloth"])


def energy_options(job: Workspace) -> d.EnergyOptions:
    options = copy.copy(job.options["energy"])
    options.dt = solver_settings(job).dt
    return options


def simulator(job: Workspace, dressed: d.DressedActor | None = None) -> d.CharacterSimulator:
    """Of the dressed actor, that of garment.npz unless another is given: goes with the dressed performance."""
    dressed = dressed or job.results.dressed
    return d.CharacterSimulator(dressed.actor, dressed.segmentation, job.results.proxies(), job.options["cloth"])


def make_take(job: Workspace, garments: list[d.Garment] | None = None) -> d.Take:
    """What material and width are estimated from: the garment in each of these widths, default: in all that it offers."""
    results = job.results
    garments = d.width_variants(results.offered_garment) if garments is None else garments
    segmentation = results.segmentation()
    simulators = [simulator(job, d.dress(results.actor, segmentation, garment)) for garment in garments]
    return d.Take(simulators, results.dressed_performance(), results.observations(), solver_settings(job).dt)
