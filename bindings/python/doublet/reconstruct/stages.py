"""What the stages of a reconstruction show to people: a picture of the check, the page of the search, the report."""

from __future__ import annotations

from .. import _doublet as d
from ..pages.fit_page import FitPage
from ..pages.report import write_report
from ..session import check


def run_check(job: d.Reconstruction) -> dict:
    frames = d.FrameSource.open(job.session)
    checked = check.check_and_draw(job.session, frames, job.silhouettes, job.path("check.png"), job.context)
    if checked.start_text:
        job.announce(f"check: {checked.start_text}")
    return {"findings": d.findings_to_json(checked.findings), "frame": checked.frame}


def fit_and_show(job: d.Reconstruction) -> dict:
    page, options = FitPage(job.out), job.options["fit"]
    own = options.on_generation

    def show(result: d.FitResult) -> None:
        page.show(over=False)
        if own:
            own(result)

    options.on_generation = show
    try:
        summary = FIT.run(job)
    finally:
        options.on_generation = own
    page.show(over=True)
    return summary


def run_report(job: d.Reconstruction) -> dict:
    write_report(job)
    return {}


CHECK = d.Stage(
    "check",
    run_check,
    writes=["check.png"],
    option_groups=["silhouette", "key", "background"],
    session_inputs=["description", "scan", "joints", "calibration", "images"],
    needs_scan=False,
    runner="",
)
FIT = next(stage for stage in d.default_stages() if stage.name == "fit")
REPORT = d.Stage(
    "report",
    run_report,
    reads=["actor.npz", "performance.npz", "observations.npz", "segmentation.npz", "body.npz", "proxies.json", "garment.npz",
           "material.json", "fit_log.csv", "simulated.npz", "character.glb"],
    writes=["report.html"],
    may_read=["calibration.yml"],
    option_groups=["silhouette", "key", "background"],  # what is shown is compared with the silhouettes
    session_inputs=["name", "calibration", "images"],
    runner="",
)  # fmt: skip
#: All, in their order.
STAGES = (CHECK, *d.default_stages()[1:], REPORT)
