"""From the files of OUT to character.glb, and from a character and a motion to a new animation."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from . import _doublet as d
from .files import written_atomically


def valid_high_faces(high: d.Mesh, actor: d.RiggedMesh) -> np.ndarray:
    """(FH) 1 where the closest face of the working surface is valid: the display surface carries no mask of its own."""
    closest, _, _ = d.RayScene(actor.mesh).closest(high.vertices[high.faces].mean(axis=1))
    return np.asarray(actor.face_valid, np.uint8)[closest]


def build_character(job) -> dict:
    """Re-animates the reference motion (simulated.npz) and writes character.glb."""
    materials = d.read_materials(job.path("material.json"))
    performance, dt = job.performance(), 1 / job.session.fps
    simulated = d.simulate_reference(
        job.simulator(), performance, materials, dt, job.options["energy"].settle_frames, job.context
    )
    high = d.read_mesh(job.path("template_high.ply"))
    character = d.make_character(
        job.actor,
        job.clothness(),
        d.read_body(job.path("body.npz")),
        d.read_proxies(job.path("proxies.json"), job.actor.skeleton),
        materials,
        d.SolverSettings(dt, job.options["cloth"]),
        high,
        valid_high_faces(high, job.actor),
    )
    character.name = job.session.name
    with written_atomically(job.path("simulated.npz")) as path:
        np.savez_compressed(path, vertices=simulated.astype(np.float32))
    character.write(job.path("character.glb"))
    error = np.linalg.norm(simulated - performance.surface.frames, axis=-1)
    cloth = job.clothness().clothness > 0.5
    return {"rms_to_captured_cloth_cm": 100 * float(np.sqrt(np.square(error[:, cloth]).mean()))}


def animate_exactly(character_file: Path, motion_file: Path, fps: float, context: d.Context) -> np.ndarray:
    """(T, V, 3) m: the character on a motion of its own skeleton, whose first frame is the rest pose; nothing is put
    in front of it, nothing adapted to the floor."""
    character = d.Character.read(character_file)
    as_it_is = d.RetargetOptions(fps=fps, apply_limits=False, ground_feet=False, hold_seconds=0.0, blend_seconds=0.0)
    motion = d.retarget(d.SourceMotion.read(motion_file), character.actor.skeleton, as_it_is, context)
    return d.animate(character, motion, d.AnimateOptions(high=False, body=False), context).surface
