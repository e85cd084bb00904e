"""The stage `fit`: the material and the width of a garment, from one take."""

from __future__ import annotations

from .. import _doublet as d
from ..pages.fit_page import FitPage
from . import simulation
from .workspace import Workspace

CHECKPOINT = "fit_checkpoint.txt"


def fit_options(job: Workspace) -> d.FitOptions:
    options = job.group("fit")
    options.seed = job.seed
    options.energy = simulation.energy_options(job)
    return options


def run_fit(job: Workspace) -> dict:
    options, page = fit_options(job), FitPage(job.out)
    options.log = job.path("fit_log.csv")
    options.checkpoint = job.path(CHECKPOINT)  # stays: a search with a larger budget goes on from it

    kept = False

    def keep(result: d.FitResult) -> None:
        """Whatever stops the search now, the best so far is there."""
        nonlocal kept
        d.write_materials(job.path("material.json"), result)
        kept = True
        page.show(over=False)

    options.on_generation = keep
    try:
        result = d.estimate_material([simulation.make_take(job)], options, job.context)
    except KeyboardInterrupt:
        job.console.finish()
        if kept:
            job.console.say("fit: stopped; material.json has the best material so far")
        raise
    d.write_materials(job.path("material.json"), result)
    job.results.forget_garment()
    page.show(over=True)
    return fit_summary(result)


def fit_summary(result: d.FitResult) -> dict:
    regions = result.to_dict()["regions"]
    return {
        "regions": len(regions),
        "energy_px2": [r["energy"] for r in regions],
        "energy_noise_px2": [r["energy_noise"] for r in regions],
        "widths": result.chosen_widths,
        "energy_at_centre_px2": [r["energy_at_centre"] for r in regions],
        "evaluations": [r["evaluations"] for r in regions],
        "stop_reason": [r["stop_reason"] for r in regions],
    }
