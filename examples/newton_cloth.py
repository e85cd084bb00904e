"""A garment of `doublet export-cloth` in NVIDIA's Newton, beside what doublet made of it. Needs NumPy and, from PyPI, newton;
knows nothing of doublet but its files:

python examples/newton_cloth.py FOLDER [SECONDS [FROM]]
"""

import json
import sys
from pathlib import Path

import newton
import numpy as np
import warp as wp

SUBSTEPS, SWEEPS, TINY = 8, 24, 1e-12


def inertia(arm):
    return np.sum(arm**2, axis=1)[:, None, None] * np.eye(3) - arm[:, :, None] * arm[:, None, :]


def push_out(x, v, capsule, thickness, before, now, h):
    """Newton knows no tapered capsules: what is in one is put on it, and moves with it along its normal."""
    axis = now[1] - now[0]
    s = np.clip((x - now[0]) @ axis / (axis @ axis), 0, 1)[:, None]
    away = x - (now[0] + s * axis)
    distance = np.linalg.norm(away, axis=1, keepdims=True)
    depth, normal = (1 - s) * capsule["r0"] + s * capsule["r1"] + thickness - distance, away / np.maximum(distance, TINY)
    inside = depth[:, 0] > 0
    relative = v - ((1 - s) * (now[0] - before[0]) + s * (now[1] - before[1])) / h
    x[inside] += (depth * normal)[inside]
    v[inside] -= (np.minimum(np.sum(relative * normal, axis=1, keepdims=True), 0) * normal)[inside]


def main(folder, seconds=2.0, start=0.0):
    wp.config.quiet = True
    wp.set_device("cpu")
    cloth, motion = (json.loads((Path(folder) / name).read_text()) for name in ("cloth.json", "motion.json"))
    garment, played = cloth["garments"][0], motion["garments"][0]
    rest, faces, mass = (np.array(garment[name]) for name in ("rest_vertices", "faces", "masses"))
    stretch, bend, held = garment["stretch"], garment["bend"], np.array(played["attached"])
    clothness = np.array(garment["attachment"]["clothness"])[held]
    targets, ours = np.array(played["targets"]), np.array(played["simulated"])
    first = round(start * motion["fps"])
    targets, ours = targets[first:], ours[first:]
    turns, places = (np.array(motion["joints"][name])[first:] for name in ("rotations", "translations"))

    builder = newton.ModelBuilder(up_axis=newton.Axis.Y, gravity=tuple(cloth["gravity"]))
    builder.add_particles([wp.vec3(*x) for x in rest], [wp.vec3()] * len(rest), mass.tolist(), [0.001] * len(rest))
    for (i, j), stiffness in zip(stretch["edges"], stretch["stiffness"]):
        builder.add_spring(i, j, stiffness, 0.0, 0.0)
    for (i, j, k, m), angle, stiffness in zip(bend["hinges"], bend["rest_angles"], bend["stiffness"]):
        ke = stiffness / np.linalg.norm(rest[i] - rest[j])  # Newton's is by the length of the edge
        builder.add_edge(k, m, i, j, rest=angle, edge_ke=ke, edge_kd=0.0)
    for i in held[clothness == 0]:
        builder.particle_mass[i], builder.particle_flags[i] = 0.0, 0
    builder.color(include_bending=True)
    model = builder.finalize()
    model.spring_rest_length.assign(np.array(stretch["rest_lengths"], np.float32))
    solver = newton.solvers.SolverVBD(model, iterations=SWEEPS)
    state, after, control = model.state(), model.state(), model.control()
    state.particle_q.assign(ours[0].astype(np.float32))
    state.particle_qd.assign(((ours[1] - ours[0]) * motion["fps"]).astype(np.float32))

    def ends_at(capsule, t, s):
        """World positions of both ends, s of the way from frame t - 1 to t."""
        q = (1 - s) * turns[t - 1, capsule["joint"]] + s * turns[t, capsule["joint"]]
        axis, w = q[:3] / np.linalg.norm(q), q[3] / np.linalg.norm(q)
        place = (1 - s) * places[t - 1, capsule["joint"]] + s * places[t, capsule["joint"]]
        return [p + 2 * np.cross(axis, np.cross(axis, p) + w * np.array(p)) + place for p in (capsule["p0"], capsule["p1"])]

    h, material, errors = cloth["frame_seconds"] / SUBSTEPS, garment["material"], []
    ratio = SUBSTEPS**2 * clothness  # a substep keeps of the way to the target ...
    kept = ratio / np.maximum(ratio + 1 - clothness, TINY)
    for t in range(1, min(len(ours), round(seconds * motion["fps"]))):
        for s in np.arange(1, SUBSTEPS + 1) / SUBSTEPS:
            x, v = state.particle_q.numpy(), state.particle_qd.numpy()
            x[held] += (1 - kept)[:, None] * ((1 - s) * targets[t - 1] + s * targets[t] - x[held])
            normal = np.zeros_like(rest)
            across = np.cross(x[faces[:, 1]] - x[faces[:, 0]], x[faces[:, 2]] - x[faces[:, 0]])
            for k in range(3):
                np.add.at(normal, faces[:, k], across)
            normal /= np.linalg.norm(normal, axis=1, keepdims=True)
            along = np.sum(v * normal, axis=1, keepdims=True)  # drag, quadratic along the normal and linear across it
            v += along * normal * (1 / (1 + material["d_n"] * np.abs(along) * h / 2) - 1)
            v += (v - np.sum(v * normal, axis=1, keepdims=True) * normal) * (np.exp(-material["d_t"] * h / 2) - 1)
            arm, share = x - mass @ x / mass.sum(), 1 - (1 - material["k_damping"]) ** (1 / SUBSTEPS)
            spin = np.linalg.solve(np.einsum("n,nab->ab", mass, inertia(arm)), mass @ np.cross(arm, v))
            v += share * (mass @ v / mass.sum() + np.cross(spin, arm) - v)  # towards rigid motion (Mueller et al. 2007)
            state.particle_q.assign(x), state.particle_qd.assign(v)
            solver.step(state, after, control, None, h)
            state, after = after, state
            x, v = state.particle_q.numpy(), state.particle_qd.numpy()
            for capsule in cloth["capsules"]:
                push_out(
                    x, v, capsule, cloth["contact"]["thickness"], *(ends_at(capsule, t, s - k / SUBSTEPS) for k in (1, 0)), h
                )
            pinned = held[clothness == 0]
            x[pinned] = ((1 - s) * targets[t - 1] + s * targets[t])[clothness == 0]
            state.particle_q.assign(x), state.particle_qd.assign(v)
        errors.append(np.linalg.norm(state.particle_q.numpy() - ours[t], axis=1))
        if t % 20 == 0:
            print(f"{t / motion['fps']:.2f} s: {100 * np.sqrt(np.mean(errors[-1] ** 2)):.2f} cm", flush=True)
    print(f"root mean square over {len(errors)} frames: {100 * np.sqrt(np.mean(np.square(errors))):.2f} cm")


if __name__ == "__main__":
    main(sys.argv[1], *map(float, sys.argv[2:]))
