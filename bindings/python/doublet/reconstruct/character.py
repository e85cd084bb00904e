"""From the files of OUT to character.glb."""

from __future__ import annotations

import numpy as np

from .. import _doublet as d
from ..session.first_frame import camera_views
from . import simulation
from .workspace import Workspace


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
    cloth = dressed.segmentation.clothness > 0.5
    if not cloth.any():
        return {"texture_seen": seen}
    error = np.linalg.norm(simulated - performance.surface.frames, axis=-1)
    return {"rms_to_captured_cloth_cm": 100 * float(np.sqrt(np.square(error[:, cloth]).mean())), "texture_seen": seen}


def bake_first_frame(character: d.Character, job: Workspace, performance: d.ReferencePerformance) -> float:
    """Texture from the images of the first captured frame; 0 for a session without images."""
    images, masks = camera_views(job.filmed, performance.frames[0], job.silhouettes)
    if not any(image.size for image in images):
        job.console.log(f"character: no camera has an image of frame {performance.frames[0]}: the character has no texture")
        return 0.0
    surface = performance.surface.frames[0]
    return d.texture_character(character, surface, job.filmed.rig, images, masks, job.options["texture"], job.context)
