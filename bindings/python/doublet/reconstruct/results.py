"""What the stages have written into OUT, read when it is asked for."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path

from .. import _doublet as d

CALIBRATION = "calibration.yml"  # the refined cameras, if the take told that the session's were off


class Results:
    """The values of a folder of results. What is kept in memory is what was read from a file, not what was written to it, so that
    a resumed run goes on with the same bits."""

    def __init__(self, out: Path):
        self.out = Path(out)

    def path(self, name: str) -> Path:
        return self.out / name

    def forget(self, *names: str) -> None:
        """After the files of these values were written."""
        for name in names:
            self.__dict__.pop(name, None)

    def forget_garment(self) -> None:
        self.forget("offered_garment", "garment", "dressed")

    @cached_property
    def actor(self) -> d.RiggedMesh:
        return d.read_actor(self.path("actor.npz"))

    def recalibrated(self, session: d.Session) -> d.Session:
        """The session, with the refined cameras if there are any."""
        refined = self.path(CALIBRATION)
        return session.recalibrated(refined) if refined.exists() else session

    def performance(self) -> d.ReferencePerformance:
        return d.read_performance(self.path("performance.npz"), self.actor)

    def observations(self) -> d.Observations:
        return d.read_observations(self.path("observations.npz"))

    def segmentation(self) -> d.Segmentation:
        return d.read_segmentation(self.path("segmentation.npz"))

    def body(self) -> d.BodyFit:
        return d.read_body(self.path("body.npz"))

    def proxies(self) -> list[d.TaperedCapsule]:
        return d.read_proxies(self.path("proxies.json"), self.actor.skeleton)

    @cached_property
    def offered_garment(self) -> d.Garment:
        """As the mesher made it, in several widths to choose from."""
        return d.read_garment(self.path("garment.npz"), self.actor)

    @cached_property
    def garment(self) -> d.Garment:
        """In the width that was estimated with the material; before, in the middle one."""
        material = self.path("material.json")
        return d.choose_widths(self.offered_garment, d.read_widths(material) if material.exists() else [])

    @cached_property
    def dressed(self) -> d.DressedActor:
        """What is simulated: the actor in the garment of garment.npz."""
        return d.dress(self.actor, self.segmentation(), self.garment)

    def dressed_performance(self) -> d.ReferencePerformance:
        """Whatever the width: it is on the garment's mesh, which is that of all."""
        return d.dress(self.performance(), self.actor, self.offered_garment)
