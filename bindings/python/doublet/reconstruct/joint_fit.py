"""One material and one width for several takes of a garment."""

from __future__ import annotations

import shutil
from contextlib import ExitStack

from .. import _doublet as d
from . import simulation
from .fit import CHECKPOINT, fit_options, fit_summary
from .job import Job
from .running import plain_summary, stage_inputs, stage_options
from .stages import STAGES


def fit_together(jobs: list[Job]) -> None:
    """One material, and one width of the garment, for several takes of one garment, with the options and the seed of the first:
    material.json and fit_log.csv of every take, whose later stages are then to be run again. A search that was stopped goes on.
    Throws ValueError if the garments cannot be equally wide."""
    first, stage = jobs[0], next(s for s in STAGES if s.name == "fit")
    garments = [job.results.offered_garment for job in jobs]
    count = min(len(garment.widths) for garment in garments)
    positions = d.common_widths(garments, count) if count > 1 else []
    takes = []
    for k, job in enumerate(jobs):
        offered = job.results.offered_garment
        worn = (
            [d.choose_widths(offered, [width] * offered.region_count) for width in positions[k]]
            if positions
            else [d.choose_widths(offered)]
        )
        takes.append(simulation.make_take(job, worn))
    options = fit_options(first)
    options.log, options.checkpoint = first.path("fit_log.csv"), first.path(CHECKPOINT)
    together = {"takes": [str(job.out.resolve()) for job in jobs]}
    with ExitStack() as stack:
        summaries = []
        for job in jobs:
            chosen = {**stage_options(first, stage), **together}
            summaries.append(stack.enter_context(job.record.running("fit", stage_inputs(job, stage), chosen, stage.writes)))
        result = d.estimate_material(takes, options, first.context)
        for k, (job, summary) in enumerate(zip(jobs, summaries)):
            d.write_materials(job.path("material.json"), result.at_positions(positions[k]) if positions else result)
            if job is not first:
                shutil.copy(first.path("fit_log.csv"), job.path("fit_log.csv"))
            job.results.forget_garment()
            summary.update(plain_summary(fit_summary(result)))
    first.console.finish()
