"""The pictures of docs/conventions.md.

python benchmarks/convention_pictures.py [FOLDER]    # default: docs/pictures
"""

from __future__ import annotations

import sys
from pathlib import Path

import doublet as d
import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

ROOT = Path(__file__).resolve().parents[1]
SESSION = ROOT / "examples" / "data" / "session"
AXES = (("x", "#c1272d"), ("y", "#2e8b3d"), ("z", "#2456b4"))
KINDS = {6: ("root, 6", "#222222"), 3: ("ball, 3", "#2456b4"), 2: ("two hinges", "#d07000"), 1: ("hinge", "#c1272d")}


def arrow(axes, start, end, colour, label: str) -> None:
    axes.annotate("", end, start, arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 2})
    axes.text(*(np.array(end) + 0.09 * (np.array(end) - start)), label, color=colour, ha="center", va="center", fontsize=12)


def triad(axes, origin, directions, length: float, suffix: str = "") -> None:
    """Three arrows, drawn from wherever one stands: directions (3, 2)."""
    for (name, colour), direction in zip(AXES, directions):
        arrow(axes, origin, np.array(origin) + length * np.array(direction), colour, f"{name}{suffix}")


def world_and_camera(axes) -> None:
    axes.set_title("world: right-handed, +Y up; camera: z forward, y down", fontsize=10)
    oblique = np.array([[0.92, -0.12], [0, 1], [-0.55, -0.42]])  # where x, y, z of the world go on paper
    triad(axes, (0, 0), oblique, 1.0)
    R = d.orbit_camera([0, 0.5, 0], 1.0, 1.35, 0.25, 100, 100).R  # rows: the camera's axes in the world
    triad(axes, (2.6, 0.7), R @ oblique, 0.75, " cam")
    axes.text(1.1, -1.15, "x_cam = R x_world + t", ha="center", family="monospace")
    axes.set_xlim(-1.0, 3.9)
    axes.set_ylim(-1.3, 1.8)


def pixels(axes) -> None:
    axes.set_title("pixels: (0, 0) is the centre of the first", fontsize=10)
    for x in range(4):
        for y in range(3):
            axes.add_patch(pyplot.Rectangle((x - 0.5, y - 0.5), 1, 1, facecolor="#f2f2f2", edgecolor="#999999"))
            axes.plot(x, y, ".", color="#666666")
            axes.text(x, y + 0.16, f"({x}, {y})", ha="center", va="top", fontsize=8)
    arrow(axes, (-0.75, -0.75), (1.6, -0.75), AXES[0][1], "x")
    arrow(axes, (-0.75, -0.75), (-0.75, 1.3), AXES[1][1], "y")
    axes.set_xlim(-1.1, 3.9)
    axes.set_ylim(2.8, -1.1)


def skeleton(axes) -> None:
    """Of the shipped session from the front: joints by their degrees of freedom."""
    joints = d.Session(SESSION).joints
    made, marks = d.Skeleton(joints), {mark.name: mark for mark in joints}
    places = {name: np.array(mark.position) for name, mark in marks.items()}
    for mark in marks.values():
        if mark.parent:
            axes.plot(*zip(places[mark.parent][:2], places[mark.name][:2]), color="#bbbbbb", linewidth=3, zorder=1)
    counts = {name: sum(dof.startswith(f"{name}.") for dof in made.dof_names) for name in marks}
    shown = set()
    for name, place in places.items():
        kind = KINDS.get(counts[name])
        if kind:
            axes.plot(*place[:2], "o", color=kind[1], markersize=8, label=None if kind[0] in shown else kind[0], zorder=2)
            shown.add(kind[0])
            side = -1 if name.startswith("r_") else 1
            axes.text(
                place[0] + 0.05 * side,
                place[1] + (0.04 if name == "pelvis" else 0.01),
                name,
                fontsize=7,
                ha="left" if side > 0 else "right",
            )
        else:
            axes.plot(*place[:2], ".", color="#999999", zorder=2)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.3), fontsize=8, frameon=False)
    axes.set_title("skeleton: degrees of freedom; her left is on the right", fontsize=10)


def main(folder: Path) -> list[Path]:
    figure, panels = pyplot.subplots(1, 3, figsize=(13, 4.6), gridspec_kw={"width_ratios": (4.4, 4.2, 4)})
    world_and_camera(panels[0])
    pixels(panels[1])
    skeleton(panels[2])
    for axes in panels:
        axes.set_aspect("equal")
        axes.set_axis_off()
    figure.tight_layout()
    path = folder / "conventions.png"
    figure.savefig(path, dpi=90)
    return [path]


if __name__ == "__main__":
    for written in main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "pictures"):
        print(written)
