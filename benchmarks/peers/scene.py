"""The skirt that cloth_peers wrote, and the clock: what every engine driven from Python shares."""

import time
from pathlib import Path

import numpy as np

DT = 1 / 40
SWEEPS = 24
SETTLE = 20  # frames before the clock starts


class Scene:
    def __init__(self, folder):
        self.folder = Path(folder)
        self.rest = np.fromfile(self.folder / "rest").reshape(-1, 3)  # (N, 3) m
        self.faces = np.fromfile(self.folder / "faces", np.int32).reshape(-1, 3)  # (F, 3)
        self.masses = np.fromfile(self.folder / "masses")  # (N) m^2, a third of the areas around
        flat = np.fromfile(self.folder / "waist").reshape(-1, 3)
        around = int(np.sum(self.rest[:, 1] > self.rest[:, 1].max() - 1e-9))  # the waist is the first ring
        self.waist = flat.reshape(-1, around, 3)  # (frames + 1, around, 3) m

    @property
    def around(self):
        return self.waist.shape[1]

    def edges(self):
        """(E, 2) vertices of every edge, and (B, 4) of every inner edge: its ends, and the corners across it."""
        across = {}
        for a, b, c in self.faces.tolist():
            for i, j, k in ((a, b, c), (b, c, a), (c, a, b)):
                across.setdefault((min(i, j), max(i, j)), []).append(k)
        edges = np.array(list(across))
        bends = np.array([(*edge, *corners) for edge, corners in across.items() if len(corners) == 2])
        return edges, bends

    def measure(self, name, move_waist, step, positions):
        """Steps through the dance; writes CPU ms a frame to NAME.ms and the last positions to NAME.positions."""
        times = []
        for frame in range(1, len(self.waist)):
            move_waist(self.waist[frame])
            before = time.process_time_ns()
            step()
            if frame > SETTLE:
                times.append((time.process_time_ns() - before) * 1e-6)
        np.array(times).tofile(self.folder / f"{name}.ms")
        np.asarray(positions(), np.float64).tofile(self.folder / f"{name}.positions")
