"""What the solver's normalised stiffnesses are in N/m and N m: docs/export-cloth.md has the formulas."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import _doublet as d

RIGID = 0.005  #: of its length, by which a garment of rigid edges may stretch under its own weight elsewhere


@dataclass(frozen=True)
class Springs:
    """A garment as edges and hinges, in the order of their vertices."""

    edges: np.ndarray  # (E, 2)
    lengths: np.ndarray  # (E) m at rest
    stretch: np.ndarray  # (E) N/m
    hinges: np.ndarray  # (H, 4) the edge's ends, then the vertex opposite on either side
    angles: np.ndarray  # (H) rad at rest
    bend: np.ndarray  # (H) N m
    rigid: bool  # `stretch` is what stands for an edge that does not stretch
    young: float  # N/m of an even sheet that stretches as the edges do (times its thickness)
    bending_rigidity: float  # N m of an even sheet that bends as the hinges do, their median


def springs_of(model: d.ClothModel, material: d.Material, areal_density: float) -> Springs:
    """Of a piece of cloth whose square metre weighs `areal_density` kg."""
    edges, hinges = edges_and_hinges(model.faces)
    rest, inverse = np.asarray(model.rest), np.asarray(model.inverse_masses)
    moving = inverse[edges].sum(axis=1) > 0
    edges, hinges = edges[moving], hinges[inverse[hinges].max(axis=1) > 0]
    rigid = material.k_stretch >= 1
    if rigid:
        weight = areal_density * np.linalg.norm(model.options.gravity) * float(np.ptp(rest, axis=0).max())
        stretch = np.full(len(edges), young_to_edge(weight / RIGID))
    else:
        stretch = areal_density * d.spring_constant(material.k_stretch, 1) / inverse[edges].sum(axis=1)
    angles, response = hinge_geometry(rest, hinges, inverse)
    bend = areal_density * d.spring_constant(min(material.k_bend, 1 - 1e-6), 1) / response
    areas = hinge_areas(rest, hinges)
    squares = np.sum((rest[hinges[:, 1]] - rest[hinges[:, 0]]) ** 2, axis=1)
    return Springs(
        edges,
        np.linalg.norm(rest[edges[:, 1]] - rest[edges[:, 0]], axis=1),
        stretch,
        hinges,
        model.options.rest_curvature * angles,
        bend,
        rigid,
        float(np.median(stretch)) * 2 / np.sqrt(3),
        float(np.median(bend * areas / (3 * squares))) if len(hinges) else 0.0,
    )


def young_to_edge(young: float) -> float:
    """N/m of each edge of a lattice of equilateral triangles that stretches as a sheet of that modulus times thickness."""
    return young * np.sqrt(3) / 2


def edges_and_hinges(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(E, 2), (H, 4): a hinge has two consecutive faces beside an edge."""
    opposite: dict[tuple[int, int], list[int]] = {}
    for face in np.asarray(faces).tolist():
        for k in range(3):
            a, b = face[k], face[(k + 1) % 3]
            opposite.setdefault((min(a, b), max(a, b)), []).append(face[(k + 2) % 3])
    edges = sorted(opposite)
    hinges = [
        (*edge, first, second) for edge in edges for first, second in zip(opposite[edge], opposite[edge][1:]) if first != second
    ]
    return np.array(edges, int).reshape(-1, 2), np.array(hinges, int).reshape(-1, 4)


def hinge_geometry(rest: np.ndarray, hinges: np.ndarray, inverse: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(H) rad, the signed angle between the normals, and (H) sum of w_i |g_i|^2 with its gradients g_i (Bridson et al. 2003),
    which has the solver's floor."""
    x0, x1, x2, x3 = (rest[hinges[:, k]] for k in range(4))
    e, a, b = x1 - x0, x2 - x0, x3 - x0
    n1, n2 = np.cross(e, a), np.cross(b, e)
    square = np.sum(e * e, axis=1)
    length = np.sqrt(square)
    angles = np.arctan2(-length * np.sum(n1 * b, axis=1), np.sum(n1 * n2, axis=1))
    nn1, nn2 = np.sum(n1 * n1, axis=1), np.sum(n2 * n2, axis=1)
    g2, g3 = -(length / nn1)[:, None] * n1, -(length / nn2)[:, None] * n2
    s, t = (np.sum(a * e, axis=1) / square)[:, None], (np.sum(b * e, axis=1) / square)[:, None]
    gradients = np.stack([(s - 1) * g2 + (t - 1) * g3, -s * g2 - t * g3, g2, g3], axis=1)
    weights = inverse[hinges]
    response = np.sum(weights * np.sum(gradients**2, axis=2), axis=1)
    floor = np.maximum(1.0, 0.25 * square * (1 / nn1 + 1 / nn2)) * weights.max(axis=1)
    return angles, np.maximum(response, floor)


def hinge_areas(rest: np.ndarray, hinges: np.ndarray) -> np.ndarray:
    """(H) m^2 of the two faces."""
    x0, x1, x2, x3 = (rest[hinges[:, k]] for k in range(4))
    return sum(0.5 * np.linalg.norm(np.cross(x1 - x0, side - x0), axis=1) for side in (x2, x3))
