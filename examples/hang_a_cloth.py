"""A square of cloth, held at two corners, falls and comes to rest: the cloth solver alone, from Python."""

import doublet as d
import numpy as np

n = 20
x, z = np.meshgrid(np.arange(n) * 0.05, np.arange(n) * 0.05)
rest = np.stack([x.ravel(), np.ones(n * n), z.ravel()], axis=1)  # (N, 3) m
a = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
faces = np.vstack([np.stack([a, a + n, a + 1], 1), np.stack([a + 1, a + n, a + n + 1], 1)]).astype(np.int32)
clothness = np.ones(n * n)  # 1 = free
clothness[[0, n - 1]] = 0  # 0 = follows its target: here, stays where it is

solver = d.ClothSolver.create(d.ClothModel(rest, faces, clothness))
state = d.ClothState(rest)
still = d.StepInputs(targets=rest, dt=1 / 40)
cotton = d.Material(d_n=4.0, d_t=4.9, k_bend=0.7, k_stretch=1.0, k_friction=0.5)
for _ in range(200):
    solver.step(state, still, cotton)
print(f"lowest point: {state.positions[:, 1].min():.3f} m")
