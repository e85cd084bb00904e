"""The size of a garment: hem, area, and length from seam to hem, in the scan pose, at rest and in truth (docs/garment.md).

python benchmarks/garment_shape.py OUT [--truth SESSION/ground_truth]
"""

import argparse
import heapq
from pathlib import Path

import doublet as d
import numpy as np
from doublet.evaluation.metrics import Truth


def border(faces: np.ndarray) -> np.ndarray:
    """(E, 2) the edges that one face alone has."""
    edges, count = np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0, return_counts=True)
    return edges[count == 1]


def length(vertices: np.ndarray, edges: np.ndarray) -> float:
    return float(np.linalg.norm(vertices[edges[:, 1]] - vertices[edges[:, 0]], axis=1).sum())


def ways(vertices: np.ndarray, faces: np.ndarray, sources: np.ndarray) -> np.ndarray:
    """(N) m along the edges to the nearest source."""
    beside = [set() for _ in vertices]
    for a, b, c in faces:
        for v, w in ((a, b), (b, c), (c, a)):
            beside[v].add(w)
            beside[w].add(v)
    way, front = np.full(len(vertices), np.inf), [(0.0, int(v)) for v in sources]
    while front:
        reached, v = heapq.heappop(front)
        if reached < way[v]:
            way[v] = reached
            for w in beside[v]:
                heapq.heappush(front, (reached + float(np.linalg.norm(vertices[v] - vertices[w])), int(w)))
    return way


def true_garment(truth: Truth, actor: d.RiggedMesh, garment: d.Garment) -> tuple[float, float]:
    """Hem, m, and area, m^2, in the scan pose, of what of the true garment lies where ours is."""
    vertices = truth.frame(0)[1]
    skin = actor.mesh.faces[np.asarray(actor.face_valid, bool) & ~np.asarray(garment.replaced_faces, bool)]
    worn = np.vstack([skin, garment.mesh.faces + len(actor.mesh.vertices)])
    scene = d.RayScene(d.Mesh(np.vstack([actor.mesh.vertices, garment.mesh.vertices]), worn))

    def ours(points: np.ndarray) -> np.ndarray:
        return scene.closest(points)[0] >= len(skin)

    rim, faces = border(truth.cloth_faces), truth.cloth_faces[ours(vertices[truth.cloth_faces].mean(axis=1))]
    low = vertices[rim].mean(axis=1)[:, 1] < vertices[:, 1].mean()  # the other rim is the waist
    return length(vertices, rim[low]), float(d.face_areas(vertices, faces).sum())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path, metavar="OUT")
    parser.add_argument("--truth", type=Path, metavar="DIR", help="ground_truth folder; its frame 0 is the scan pose")
    chosen = parser.parse_args()
    actor = d.read_actor(chosen.out / "actor.npz")
    garment = d.read_garment(chosen.out / "garment.npz", actor)
    faces, clothness = garment.mesh.faces, np.asarray(garment.clothness)
    rim = border(faces)
    hem, seam = rim[(clothness[rim] > 0).all(axis=1)], np.flatnonzero(clothness == 0)
    for name, vertices in (("scan pose", garment.mesh.vertices), ("rest shape", garment.rest)):
        way = ways(vertices, faces, seam)[np.unique(hem)].mean()
        area = d.face_areas(vertices, faces).sum()
        print(f"{name:<12}hem {length(vertices, hem):.2f} m, area {area:.3f} m^2, from seam to hem {way:.3f} m along edges")
    if chosen.truth:
        true_hem, true_area = true_garment(Truth(chosen.truth), actor, garment)
        print(f"{'truth':<12}hem {true_hem:.2f} m, area {true_area:.3f} m^2")


if __name__ == "__main__":
    main()
