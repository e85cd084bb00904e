"""Runs every engine on the same skirts, in turn, and prints the median CPU time of a frame; see run.sh."""

import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scene import Scene

HERE = Path(__file__).parent
SKIRTS = [(52, 24), (72, 35)]  # around, rows: 1300 vertices and 2496 faces; 2592 and 5040
TERMS = {
    "ours": "ours: edges, dihedral angles",
    "ours8": "ours, 8 materials at once (AVX2): the same, per simulation",
    "ours16": "ours, 16 materials at once (AVX-512): the same, per simulation",
    "bullet": "Bullet: edges, links across bends",
    "pypbd": "PositionBasedDynamics: edges, dihedral angles",
    "newton-xpbd": "Newton XPBD: edges, dihedral angles (Jacobi)",
    "newton-vbd": "Newton VBD: triangles, dihedral angles",
    "mujoco": "MuJoCo flex: edges, thin-shell bending (CG)",
    "blender": "Blender: edges, dihedral angles (implicit, one solve)",
    "full": "ours: everything",
    "full8": "ours, 8 materials at once: everything, per simulation",
    "full16": "ours, 16 materials at once: everything, per simulation",
}
PEERS = ("bullet", "pypbd", "newton-xpbd", "newton-vbd", "mujoco", "blender")


def commands(program, around, rows, frames, folder):
    def native(name):
        return [program, name, str(around), str(rows), str(frames), folder]

    def script(name, *more):
        return [sys.executable, str(HERE / f"{name}_cloth.py"), folder, *more]

    return {
        **{name: native(name) for name in ("ours", "ours8", "ours16", "full", "full8", "full16", "bullet")},
        "pypbd": script("pypbd"),
        "newton-xpbd": script("newton"),
        "newton-vbd": script("newton", "vbd"),
        "mujoco": script("mujoco"),
        "blender": ["blender", "-b", "-t", "1", "-P", str(HERE / "blender_cloth.py"), "--python-exit-code", "1", "--", folder],
    }


def run(name, command, folder):
    """Times (ms) and last positions, or why there are none."""
    if not shutil.which(command[0]):
        return f"{command[0]} is not installed"
    ran = subprocess.run(command, capture_output=True, text=True)
    if ran.returncode != 0:
        return ran.stderr.strip().splitlines()[-1] if ran.stderr.strip() else f"exit status {ran.returncode}"
    return np.fromfile(f"{folder}/{name}.ms"), np.fromfile(f"{folder}/{name}.positions").reshape(-1, 3)


def compare(program, around, rows, frames, rounds):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "scene", str(around), str(rows), str(frames), folder], check=True)
        scene = Scene(folder)
        edges, _ = scene.edges()

        def stretch(x):
            now, then = (np.linalg.norm(p[edges[:, 0]] - p[edges[:, 1]], axis=1) for p in (x, scene.rest))
            return 100 * float(np.mean(np.abs(now / then - 1)))

        times, last = {}, {}
        for _ in range(rounds):  # in turn, so that a busy moment of the machine meets all of them
            for name, command in commands(program, around, rows, frames, folder).items():
                result = run(name, command, folder)
                if isinstance(result, str):
                    last[name] = result
                else:
                    times.setdefault(name, []).append(result[0])
                    last[name] = result[1]
    medians = {name: float(np.median(np.concatenate(all_rounds))) for name, all_rounds in times.items()}
    print(
        f"\n{len(scene.rest)} vertices, {len(scene.faces)} faces: {rounds} x {frames} frames of 1/40 s, 24 iterations, one core"
    )
    bases = [name for name in ("ours", "ours8", "ours16") if name in medians]
    print(f"{'':64}{'ms a frame':>11}" + "".join(f"{'/ ' + base:>9}" for base in bases) + f"{'edges off by':>14}")
    for name, terms in TERMS.items():
        if name not in medians:
            print(f"{terms:64} not measured: {last[name]}")
            continue
        ratios = "".join(f"{medians[name] / medians[base]:9.1f}" for base in bases)
        print(f"{terms:64}{medians[name]:11.3f}{ratios}{stretch(last[name]):12.1f} %")
    best = min((name for name in PEERS if name in medians), key=medians.get, default=None)
    if best:
        rates = ", ".join(f"{base} {medians[best] / medians[base]:.1f} x" for base in bases)
        print(f"fastest peer: {best}, {medians[best]:.3f} ms; rate of a simulation against it: {rates}")


def growth(program, picture):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    table = subprocess.run([program, "growth"], check=True, capture_output=True, text=True).stdout
    print(table, end="")
    names, *rows = (line.split(",") for line in table.split())
    columns = dict(zip(names, np.array(rows, float).T, strict=True))
    figure, axes = plt.subplots(figsize=(5, 3.6), layout="constrained")
    for name in names[2:]:
        what, lanes = name.rsplit("_", 1)
        label = {"edges_and_bends": "edges and bends", "everything": "everything"}[what] + f", {lanes} at once"
        slope = np.polyfit(np.log(columns["vertices"]), np.log(columns[name]), 1)[0]
        print(f"{label}: time grows with the power {slope:.3f} of the vertices")
        axes.loglog(columns["vertices"], columns[name], "o-", label=f"{label}: power {slope:.2f}")
    axes.set(xlabel="vertices", ylabel="ms a frame of one simulation", title="Cost of a frame, 24 sweeps, one core")
    axes.grid(alpha=0.3)
    axes.legend(loc="upper left", fontsize="small")
    figure.savefig(picture, dpi=110)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", help="cloth_peers")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--frames", type=int, default=140, help="of which the first 20 are not timed")
    parser.add_argument("--growth", metavar="FILE.png")
    arguments = parser.parse_args()
    if arguments.growth:
        growth(arguments.program, arguments.growth)
        return
    for around, rows in SKIRTS:
        compare(arguments.program, around, rows, arguments.frames, arguments.rounds)


if __name__ == "__main__":
    main()
