"""From the files of OUT to character.glb."""

from __future__ import annotations

import numpy as np

from .. import _doublet as d
from ..common import drawing
from ..session.first_frame import camera_views
from . import simulation
from .workspace import Workspace

COMPARED = 8  #: frames in which the character is compared with the film


def build_character(job: Workspace) -> dict:
    """Re-animates the reference motion (simulated.npz) and writes character.glb."""
    solver = simulation.solver_settings(job)
    materials = d.read_materials(job.path("material.json"), solver)
    regions = job.results.dressed.segmentation.region_count
    if len(materials) != regions:
        file = job.path("material.json")
        raise RuntimeError(f"{file}: expected a material for each of {regions} cloth regions, found {len(materials)}")
    performance = job.results.dressed_performance()
    simulated = d.simulate_reference(
        simulation.simulator(job), performance, materials, solver.dt, job.options["energy"].settle_frames, job.context
    )
    dressed = job.results.dressed
    display = d.build_display_mesh(dressed.actor, dressed.segmentation, d.read_mesh(job.path("template_high.ply")))
    character = d.make_character(
        dressed.actor,
        dressed.segmentation,
        job.results.body(),
        job.results.proxies(),
        materials,
        solver,
        display.mesh,
        display.valid,
        display.garment_subdivisions,
    )
    character.name = job.session.name
    seen = bake_first_frame(character, job, performance)
    d.write_simulated(job.path("simulated.npz"), simulated, len(job.results.actor.mesh.vertices))
    character.write(job.path("character.glb"))
    summary = {"texture_seen": seen, **overlap_with_film(job, performance, simulated)}
    cloth = dressed.segmentation.clothness > 0.5
    if cloth.any():
        error = np.linalg.norm(simulated - performance.surface.frames, axis=-1)
        summary["rms_to_captured_cloth_cm"] = 100 * float(np.sqrt(np.square(error[:, cloth]).mean()))
    return summary


def overlap_with_film(job: Workspace, performance: d.ReferencePerformance, simulated: np.ndarray) -> dict[str, float]:
    """Of the re-animated surface with the silhouettes, mean over frames and cameras; empty where no frame has one."""
    actor, found = job.results.dressed.actor, []
    faces = actor.mesh.faces[np.asarray(actor.face_valid, bool)]
    for row in np.unique(np.linspace(0, len(performance.frames) - 1, COMPARED).astype(int)):
        _, masks = camera_views(job.filmed, performance.frames[row], job.silhouettes)
        present = {c: np.asarray(mask) > 0 for c, mask in enumerate(masks) if mask.size}
        if present:
            found.append(drawing.mean_overlap(simulated[row], faces, job.filmed.rig, present))
    return {"overlap_of_character": float(np.mean(found))} if found else {}


def bake_first_frame(character: d.Character, job: Workspace, performance: d.ReferencePerformance) -> float:
    """Texture from the images of the first captured frame; 0 for a session without images."""
    images, masks = camera_views(job.filmed, performance.frames[0], job.silhouettes)
    if not any(image.size for image in images):
        job.console.log(f"character: no camera has an image of frame {performance.frames[0]}: the character has no texture")
        return 0.0
    surface = performance.surface.frames[0]
    return d.texture_character(character, surface, job.filmed.rig, images, masks, job.options["texture"], job.context)
