"""What is doubtful about a reconstruction, what is as it should be, and what to do."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from .. import _doublet as d
from ..common.files import read_json

#: Kind of doubt -> what to do about it; those of quality_limits() bring their own advice.
ADVICE = {
    "lower_bound": "The box contains all ordinary cloth: check scale, frame rate and the garment's rest shape.",
    "guess": "A parameter that is a guess is not measured: keep an ordinary value (--space-fixed NAME=X), or film a motion that "
    "depends on it (drag: fast turns; friction: cloth pressed against the body).",
    "seeds": "Let the search go on: the same command with a larger --fit-max-evaluations.",
    "lost": "Look at the frames of the lost joint in the outlines below; more cameras, or a take without them, help.",
    "carried": "Cloth that clings moves as skin does. If it should hang free, film a motion in which it flies, or simulate all "
    "cloth (--garment-snug-slack 0).",
    "cloth_ends": "Look at what is red under Cloth below; doublet edit-segmentation corrects it.",
}
ADVICE["upper_bound"] = ADVICE["lower_bound"]


@dataclass(frozen=True)
class Doubt:
    """Something doubtful: in which stage, of which kind (a key of ADVICE, or none of them), and in words."""

    stage: str
    kind: str
    text: str


def summaries_of(job) -> dict[str, dict]:
    """Stage -> its numbers in run.json, if its files are those that it wrote: of files that were made elsewhere they say
    nothing."""

    def is_own(name: str, known: str) -> bool:
        return not job.path(name).exists() or job.record.hash(job.path(name)) == known

    return {
        stage: entry["summary"]
        for stage, entry in job.record.data["stages"].items()
        if "summary" in entry and all(is_own(name, known) for name, known in entry.get("outputs", {}).items())
    }


def doubts_of(job) -> list[Doubt]:
    summaries = summaries_of(job)
    doubts = [
        Doubt(name, finding.kind, finding.text)
        for name, summary in summaries.items()
        for finding in d.quality_findings(name, summary)
    ]
    lost = summaries.get("performance", {}).get("frames_lost", {})
    doubts += [Doubt("performance", "lost", f"{joint} was lost in {count} frames") for joint, count in lost.items()]
    fitted = job.path("material.json")
    return doubts + (fit_doubts(fitted) if fitted.exists() else [])


def fit_doubts(fitted: Path) -> list[Doubt]:
    """Of material.json. Raises RuntimeError naming it if it is not what `doublet fit` writes."""
    material = read_json(fitted)
    try:
        stopped = material.get("interrupted")
        found = [d.FitFinding(**finding) for region in material["regions"] for finding in region.get("findings", [])]
    except (AttributeError, KeyError, TypeError) as error:
        said = f"{type(error).__name__}: {str(error).splitlines()[0]}"
        raise RuntimeError(f"{fitted}: expected what the stage 'fit' writes, found {said}") from error
    text = "the search was stopped before its end; the same command goes on with it"
    return [Doubt("fit", "stopped", text)] * bool(stopped) + [Doubt("fit", finding.kind, finding.text()) for finding in found]


def good_of(job) -> list[str]:
    """What was measured and is as it should be, with what it should be."""
    summaries = summaries_of(job)
    good = []
    for limit in d.quality_limits():
        value = summaries.get(limit.stage, {}).get(limit.number)
        good += [limit.passed(value)] if value is not None else []
    return [text for text in good if text]
