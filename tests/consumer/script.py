"""A user's script, as strict as can be."""

from __future__ import annotations

from pathlib import Path

import doublet as d
import numpy as np
import numpy.typing as npt
from doublet import testing

QUIET = d.Context()


class BelowTheNavel(d.ClothSegmenter):
    def __init__(self, height: float) -> None:
        super().__init__()
        self.height = height

    def segment(self, inputs: d.SegmentInputs, context: d.Context = QUIET) -> d.Segmentation:
        cloth = (inputs.surface.frames[0][:, 1] < self.height).astype(float)
        return d.Segmentation(np.zeros_like(cloth), cloth, np.where(cloth > 0, 0, -1).astype(np.int32))


def surfaces(character_file: Path, clip: Path) -> npt.NDArray[np.float32]:
    character = d.Character.read(character_file)
    options = d.RetargetOptions(fps=1 / character.solver.dt)
    motion = d.retarget(d.SourceMotion.read(clip), character.actor.skeleton, options)
    return np.asarray(d.animate(character, motion, d.AnimateOptions(settle_seconds=0.1)).surface, np.float32)


if __name__ == "__main__":
    print(d.__version__, testing.cloth_segmenter_violations(BelowTheNavel(1.0)))
