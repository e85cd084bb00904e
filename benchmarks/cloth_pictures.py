"""Cloth that drapes, hangs and dances, drawn by the library's renderer: cloth_drapes.png, cloth_hangs.png, cloth_dances.png.

cloth_pictures.py [FOLDER]
"""

import sys
from pathlib import Path

import doublet as d
import numpy as np
from doublet.common import drawing
from PIL import Image

FRAME = 1 / 40  # s
SILK = d.Material(d_n=5.4, d_t=5.6, k_bend=0.75, k_stretch=1.0, k_friction=0.47)


def square(n, size):
    """n x n vertices (N, 3) m in the plane y = 0, and faces (F, 3)."""
    x, z = np.meshgrid(*2 * [np.linspace(-size / 2, size / 2, n)])
    a = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.vstack([np.stack([a, a + n, a + 1], 1), np.stack([a + 1, a + n, a + n + 1], 1)]).astype(np.int32)
    return np.stack([x.ravel(), np.zeros(n * n), z.ravel()], 1), faces


def skirt(around, rows):
    """Rings from the waist (y = 1) to the hem (y = 0.45): vertices (N, 3) m, faces (F, 3), clothness (N)."""
    t = np.repeat(np.arange(rows + 1) / rows, around)
    angle = np.tile(2 * np.pi * np.arange(around) / around, rows + 1)
    radius = 0.13 + 0.17 * t + 0.015 * t * np.sin(7 * angle)
    rest = np.stack([radius * np.cos(angle), 1 - 0.55 * t, radius * np.sin(angle)], 1)
    a = np.arange(around * rows)
    b = a - a % around + (a + 1) % around
    faces = np.vstack([np.stack([a, b, b + around], 1), np.stack([a, b + around, a + around], 1)]).astype(np.int32)
    return rest, faces, np.minimum(1, t * rows / 3)


def settle(rest, faces, clothness, capsules, frames, start=None):
    solver = d.ClothSolver.create(d.ClothModel(rest, faces, clothness, d.ClothOptions(substeps=4, iterations=12)))
    state = d.ClothState(rest if start is None else start)
    world = d.StepInputs(targets=state.positions.copy(), capsules=capsules, dt=FRAME)
    for _ in range(frames):
        solver.step(state, world, SILK)
    return state.positions


def turn(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def body(t):
    """Rotation and shift of the waist at time t (s), and the capsules under it: hips and two legs that kick."""
    r, shift = turn(2.5 * np.sin(2.6 * t)), np.array([0.15 * np.sin(3.1 * t), 0.04 * np.sin(6 * t), 0.1 * np.sin(1.7 * t)])

    def capsule(p, q, r0, r1):
        return d.Capsule(r @ p + shift, r @ q + shift, r0, r1)

    capsules = [capsule(np.array([-0.03, 0.95, 0]), np.array([0.03, 0.95, 0]), 0.115, 0.115)]
    for side in (-1, 1):
        swing = 0.6 * side * np.sin(4.5 * t)
        hip, leg = np.array([0.07 * side, 0.92, 0]), np.array([0, -np.cos(swing), np.sin(swing)])
        capsules += [capsule(hip, hip + 0.42 * leg, 0.075, 0.055), capsule(hip + 0.42 * leg, hip + 0.82 * leg, 0.055, 0.04)]
    return r, shift, capsules


def dance(times):
    """The skirt and the capsules at each of the times (s)."""
    rest, faces, clothness = skirt(72, 35)
    solver = d.ClothSolver.create(d.ClothModel(rest, faces, clothness, d.ClothOptions(substeps=4, iterations=12)))
    state = d.ClothState(rest)
    before, capsules_before = rest, body(0)[2]
    shots = []
    for frame in range(1, round(max(times) / FRAME) + 1):
        r, shift, capsules = body(frame * FRAME)
        now = rest @ r.T + shift
        world = d.StepInputs(targets=now, previous_targets=before, capsules=capsules, previous_capsules=capsules_before, dt=FRAME)
        solver.step(state, world, SILK)
        before, capsules_before = now, capsules
        if frame in [round(t / FRAME) for t in times]:
            shots.append((state.positions.copy(), faces, capsules))
    return shots


def draw(shots, azimuth, elevation, size=360):
    """The shots side by side, as one picture."""
    pictures = []
    for positions, faces, capsules in shots:
        low, high = positions.min(0), positions.max(0)
        camera = d.orbit_camera((low + high) / 2, 0.5 * np.linalg.norm(high - low), azimuth, elevation, size, size)
        meshes = [d.RenderMesh(positions, faces, drawing.CLOTH)]
        for c in capsules:
            solid = d.capsule_mesh(c.p0, c.p1, c.r0, c.r1)
            meshes.append(d.RenderMesh(solid.vertices, solid.faces, drawing.PROXY))
        pictures.append(drawing.shade(meshes, camera))
    return Image.fromarray(np.hstack(pictures))


def main(folder):
    rest, faces = square(61, 1.0)
    free = np.ones(len(rest))
    post = [d.Capsule([0, -0.9, 0], [0, -0.3, 0], 0.2, 0.2)]
    drapes = [(settle(rest, faces, free, post, 60), faces, post)]

    corners = free.copy()
    corners[[0, 60]] = 0
    upright = np.stack([rest[:, 0] * 0.8, rest[:, 2] * -1 + 0.5, 0.02 * np.sin(9 * rest[:, 0])], 1)
    hangs = [(settle(rest, faces, corners, [], 400, upright), faces, [])]

    for name, shots, azimuth, elevation in (
        ("drapes", drapes, 0.5, 0.5),
        ("hangs", hangs, 0.4, 0.1),
        ("dances", dance([0.6, 1.2, 1.8]), 0.0, 0.1),
    ):
        file = Path(folder) / f"cloth_{name}.png"
        draw(shots, azimuth, elevation).quantize(64).save(file, optimize=True)
        print(file)


main(sys.argv[1] if len(sys.argv) > 1 else ".")
