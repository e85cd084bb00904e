"""What a plausible result is: of a session before anything runs, and of every stage. Nonsense must not end in "done"."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .. import _doublet as d

Finding = d.Finding
DOUBTFUL = 3  #: exit status of a run that ended, but with doubts


class Implausible(d.Error):
    """A result that nothing should be built on."""


@dataclass(frozen=True)
class Limit:
    """Of a number in a stage's summary. The number is too low if `impossible` is below `doubtful`, otherwise too high."""

    name: str
    doubtful: float
    impossible: float
    meaning: str
    advice: str

    @property
    def expected(self) -> str:
        return f"expected {'at least' if self.impossible < self.doubtful else 'at most'} {self.doubtful:g}"

    def finding(self, value: float) -> Finding | None:
        low = self.impossible < self.doubtful
        beyond = (lambda limit: value < limit) if low else (lambda limit: value > limit)
        if not beyond(self.doubtful):
            return None
        return Finding(beyond(self.impossible), f"{self.meaning}: {self.expected}, found {value:.3g}; {self.advice}")

    def passed_text(self, value: float) -> str:
        """That the number is as it should be; empty if it is not."""
        return "" if self.finding(value) else f"{self.meaning}: {value:.3g} ({self.expected})"


#: Stage -> limits of its numbers. Those of good sessions are inside: 1 mm, overlap of 0.97, 4 mm, 3.7, overlap of 0.88.
LIMITS = {
    "template": (
        Limit("template_valid_to_scan_mean_mm", 5, 30, "mean distance of the template to the scan, mm", "look at template.ply"),
    ),
    "performance": (
        Limit(
            "silhouette_iou_against_measured_masks", 0.85, 0.6, "overlap of the tracked surface with the silhouettes",
            "look at the report's overlays: calibration, silhouettes or frame rate may be wrong",
        ),
    ),
    "segment": (
        Limit(
            "noise_mm", 3, math.inf, "deviation of the stillest tenth of the surface, mm",
            "few cameras or a rough scan? look at what is cloth",
        ),
        Limit(
            "uncertain_area", 0.2, math.inf, "share of the surface whose probability of being cloth is from 0.1 to 0.9",
            "look at the segmentation, and paint what is wrong (doublet edit-segmentation)",
        ),
    ),
    "body": (
        Limit("residual_mm", 20, 80, "mean distance of the skin to the body, mm", "the marked joints or the units may be wrong"),
        Limit(
            "largest_coefficient", 5, 8, "largest coefficient of the body, standard deviations of people",
            "no person is built or stands like that; look at the joints, and whether the scan's limbs have grown together",
        ),
    ),
    "character": (
        Limit(
            "overlap_of_character", 0.8, 0.75, "overlap of the simulated character with the silhouettes",
            "it does not move as the film shows; look at what is cloth and at the body",
        ),
    ),
}  # fmt: skip


def entry(finding: Finding) -> dict:
    """As a summary has it."""
    return {"impossible": finding.impossible, "text": finding.text, "kind": finding.kind}


def findings(stage: str, summary: dict) -> list[Finding]:
    """What is implausible in the summary of a stage that is done."""
    found = [Finding(**entry) for entry in summary.get("findings", [])]
    for limit in LIMITS.get(stage, ()):
        if limit.name in summary and (finding := limit.finding(summary[limit.name])):
            found.append(finding)
    return found
