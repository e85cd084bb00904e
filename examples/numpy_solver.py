"""A cloth solver of one's own: XPBD (Macklin, Müller, Chentanez 2016) in NumPy, all simulations of a call at once. It drives the
finished character of a reconstruction and the search for its material in the place of the built-in solver.

    python examples/numpy_solver.py OUT    # what `doublet reconstruct SESSION -o OUT` has made

Left out: bending, damping, cloth on cloth; k_stretch is compliance, whatever ClothOptions.stiffness says."""

import sys
from pathlib import Path

import doublet as d
import numpy as np
from doublet import testing


def dot(a, b):
    """Of vectors along the last axis, which stays."""
    return np.einsum("...i,...i->...", a, b)[..., None]


def column(values):
    """(S) -> (S, 1, 1): a number a simulation."""
    return np.array(values, float)[:, None, None]


class NumpySolver(d.ClothSolver):
    def __init__(self, model):
        super().__init__(model)
        faces, w = np.array(model.faces), np.array(model.inverse_masses)
        edges = np.unique(np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0)
        edges = edges[w[edges].sum(axis=1) > 0]
        self.batches = [self.batch(edges[chosen], np.array(model.rest), w) for chosen in self.colours(edges)]
        self.faces, self.free = faces, w > 0
        corner = np.argsort(faces.ravel(), kind="stable")
        self.face_of_corner = corner // 3  # the faces of vertex 0, then those of vertex 1, ...
        self.first_corner = np.searchsorted(faces.ravel()[corner], np.arange(len(w)))
        self.pull = np.where(self.free, 1 - np.array(model.clothness), 0)[:, None]

    @staticmethod
    def colours(edges):
        """Masks of edges that share no vertex, so that they may be projected at once."""
        colour, used = np.zeros(len(edges), int), {}
        for e, (a, b) in enumerate(edges):
            taken = used.setdefault(a, set()) | used.setdefault(b, set())
            colour[e] = next(c for c in range(len(edges)) if c not in taken)
            used[a].add(colour[e])
            used[b].add(colour[e])
        return [colour == c for c in range(colour.max() + 1)]

    @staticmethod
    def batch(edges, rest, w):
        a, b = edges.T
        share = w[edges] / w[edges].sum(axis=1, keepdims=True)
        return a, b, np.linalg.norm(rest[b] - rest[a], axis=1)[:, None], share[:, :1], share[:, 1:]

    def advance(self, states, inputs, materials, threads):
        """Everything is (S, N, 3); each simulation as if it were alone."""
        options = self.model.options
        n, h = options.substeps, column([i.dt for i in inputs]) / options.substeps
        x, v = np.array([s.positions for s in states]), np.array([s.velocities for s in states])
        still = np.array([i.targets if len(i.targets) else s.positions for i, s in zip(inputs, states)])
        before = np.array([i.previous_targets if len(i.previous_targets) else t for i, t in zip(inputs, still)])
        capsules = [self.ends(i.previous_capsules, i.capsules) for i in inputs]
        wind = np.array([i.wind for i in inputs])[:, None]
        gravity = np.array([options.gravity if i.gravity is None else i.gravity for i in inputs])[:, None]
        friction = 1 - (1 - column([m.k_friction for m in materials])) ** (1 / n)
        with np.errstate(all="ignore"):  # what is not finite afterwards is named to the caller
            for k in range(n):
                target = before + (k + 1) / n * (still - before)
                u = v + h * gravity - wind
                old, x = x, x + h * (self.drag(x, u, h, materials) + wind)
                x[:, ~self.free] = target[:, ~self.free]
                self.project(x, target, h, materials)
                slide = self.push_out(x, old, k / n, (k + 1) / n, capsules)
                x -= friction * slide
                v = (x - old) / h
        for i, state in enumerate(states):
            state.positions, state.velocities = x[i], v[i]

    def drag(self, x, u, h, materials):
        """Eq. (5) of the paper: quadratic along the normal, linear along the surface."""
        a, b, c = (x[:, self.faces[:, k]] for k in range(3))
        normal = np.add.reduceat(np.cross(b - a, c - a)[:, self.face_of_corner], self.first_corner, axis=1)
        normal /= np.sqrt(dot(normal, normal)) + 1e-12
        along = dot(u, normal)
        d_n, d_t = (column([getattr(m, name) for m in materials]) for name in ("d_n", "d_t"))
        slow = np.exp(-0.5 * d_t * h)
        return slow * u + along * (1 / (1 + 0.5 * d_n * h * np.abs(along)) - slow) * normal

    def project(self, x, target, h, materials):
        options = self.model.options
        softness = (1 / column([m.k_stretch for m in materials]) - 1) * (1 / 40 / h) ** 2  # alpha / (h^2 sum of w)
        pull = 1 - (1 - self.pull) ** (1 / (options.iterations * options.substeps))
        sums = [0.0] * len(self.batches)  # the multipliers, times the sum of w
        for _ in range(options.iterations):
            for i, (a, b, length, share_a, share_b) in enumerate(self.batches):
                apart = x[:, b] - x[:, a]
                size = np.sqrt(dot(apart, apart)) + 1e-12
                change = (size - length - softness * sums[i]) / (1 + softness)
                sums[i] = sums[i] + change
                x[:, a] += share_a * change * apart / size
                x[:, b] -= share_b * change * apart / size
            x += pull * (target - x)

    @staticmethod
    def ends(before, after):
        """(2, C, 2, 4): of the proxies at both ends of the frame, both spheres x y z r."""
        frames = [[[(*c.p0, c.r0), (*c.p1, c.r1)] for c in capsules] for capsules in (before or after, after)]
        return np.array(frames, float).reshape(2, len(after), 2, 4)

    def push_out(self, x, old, begin, end, capsules):
        """Out of the proxies; returns the way that each vertex slid on the last one it touched, in the proxy's own frame."""
        slide, moved = np.zeros_like(x), np.array(capsules)  # (S, 2, C, 2, 4)
        first, last = (moved[:, 0] + t * (moved[:, 1] - moved[:, 0]) for t in (begin, end))
        for c in range(last.shape[1]):
            p, q = last[:, c, :1], last[:, c, 1:]  # (S, 1, 4)
            axis = (q - p)[..., :3]
            t = np.clip(dot(x - p[..., :3], axis) / (dot(axis, axis) + 1e-12), 0, 1)
            sphere = p + t * (q - p)
            away = x - sphere[..., :3]
            distance = np.sqrt(dot(away, away)) + 1e-12
            depth = np.maximum(sphere[..., 3:] + self.model.options.thickness - distance, 0) * self.free[:, None]
            if not depth.any():
                continue
            x += depth * away / distance
            was = first[:, c, :1] + t * (first[:, c, 1:] - first[:, c, :1])
            way = (x - old) - (sphere - was)[..., :3]
            slide = np.where(depth > 0, way - dot(way, away) / distance**2 * away, slide)
        return slide


def part_of(performance, observations, first, last):
    """The frames from `first` to before `last` of what was captured."""
    part, seen = d.ReferencePerformance(), d.Observations()
    part.surface = d.MeshSequence(performance.surface.faces, np.array(performance.surface.frames)[first:last])
    part.dofs, part.joints = np.array(performance.dofs)[first:last], np.array(performance.joints)[first:last]
    part.frames = seen.frames = list(performance.frames)[first:last]
    seen.cameras, seen.views = observations.cameras, observations.views[first:last]
    return part, seen


def main(out, frames=40):
    out = Path(out)
    character = d.Character.read(out / "character.glb")
    naked = d.read_actor(out / "actor.npz")
    performance = d.dress(d.read_performance(out / "performance.npz", naked), naked, d.read_garment(out / "garment.npz", naked))

    broken = testing.cloth_solver_violations(NumpySolver)
    print("rules broken:", broken or "none")

    dt = character.solver.dt
    motion = d.Motion(1 / dt, np.array(performance.dofs)[:frames])
    quick = d.AnimateOptions(high=False, body=False, settle_seconds=0.5)
    ours = d.animate(character, motion, quick).surface
    numpy = d.animate(character, motion, quick, make_solver=NumpySolver).surface
    cloth = np.array(character.segmentation.clothness) > 0
    apart = 100 * np.linalg.norm(numpy - ours, axis=2)[:, cloth].mean()
    print(f"{frames} frames of {cloth.sum()} vertices of cloth, {apart:.1f} cm from the built-in solver's on average")

    part, seen = part_of(performance, d.read_observations(out / "observations.npz"), frames, frames + 12)
    simulator = d.CharacterSimulator(
        character.actor, character.segmentation, character.proxies, character.solver.cloth, make_solver=NumpySolver
    )
    fit = d.FitOptions(max_evaluations=8, population=4, initial_design_size=4)
    fit.energy, fit.space = d.EnergyOptions(settle_frames=4), d.ParameterSpace(names=["d_n", "d_t"])
    found = d.estimate_material(simulator, part, seen, dt, fit).to_dict()["regions"]
    energy = [region["energy"] for region in found]
    frozen = d.MaterialObjective(simulator, part, seen, dt, fit.energy).surface_energy(
        np.array([simulator.pose(dofs).skinned for dofs in part.dofs])
    )
    print(f"E_fit {energy} px^2 after {found[0]['evaluations']} evaluations; of cloth that follows the skeleton {list(frozen)}")
    return broken, apart, energy, frozen


if __name__ == "__main__":
    broken, apart, energy, frozen = main(sys.argv[1])
