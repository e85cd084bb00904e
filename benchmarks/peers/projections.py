"""Projects random constraints by PositionBasedDynamics (pyPBD 2.2.2): the reference that tests/pbd/peer_test.cpp compares with.

projections.py tests/pbd/peer_projections.csv
"""

import sys
from pathlib import Path

import numpy as np
import pypbd

simulation = pypbd.Simulation.getCurrent()
simulation.initDefault()
random = np.random.default_rng(20)


def project(rest, bent, masses, stiffness, add, kind):
    """Positions after one projection of one constraint made at `rest` and met at `bent`."""
    model = pypbd.SimulationModel()
    particles = model.getParticles()
    for point, mass in zip(rest, masses, strict=True):
        particles.addVertex(point)
        particles.setMass(particles.size() - 1, mass)
    add(model)
    constraint = model.getConstraints()[0]
    assert isinstance(constraint, kind)
    for i, point in enumerate(bent):
        particles.setPosition(i, point)
    constraint.stiffness = stiffness
    constraint.initConstraintBeforeProjection(model)
    constraint.solvePositionConstraint(model, 0)
    return np.array([particles.getPosition(i) for i in range(len(rest))])


def row(kind, stiffness, masses, *arrays):
    numbers = [stiffness, *masses, *(v for a in arrays for v in a.ravel())]
    return ",".join([kind, *(f"{v:.10g}" for v in numbers)])


lines = ["# kind,stiffness,masses (0 = pinned),positions at rest,before,after; bend: ends of the edge, then the corners across"]
for i in range(50):
    rest, bent = random.uniform(-0.05, 0.05, (2, 2, 3))
    masses, k = random.uniform(1e-4, 1e-3, 2) * [i % 4 > 0, 1], random.uniform(0.1, 1)
    after = project(rest, bent, masses, k, lambda m: m.addDistanceConstraint(0, 1, 1.0), pypbd.DistanceConstraint)
    lines.append(row("stretch", k, masses, rest, bent, after))
while len(lines) < 101:
    flat = np.array([[0, 0, 0], [0.03, 0, 0], [0.012, 0.028, 0], [0.018, -0.026, 0]])
    rest, bent = flat + random.normal(0, 0.003, (2, 4, 3))
    rest[2:, 2], bent[2:, 2] = random.uniform(0.012, 0.03, 2)  # folded to one side: their angle has no sign
    masses, k = random.uniform(1e-4, 1e-3, 4) * (random.uniform(size=4) > 0.15), random.uniform(0.1, 1)
    after = project(rest, bent, masses, k, lambda m: m.addDihedralConstraint(2, 3, 0, 1, 1.0), pypbd.DihedralConstraint)
    if masses[2] and masses[3]:  # a corner to lever with
        lines.append(row("bend", k, masses, rest, bent, after))
Path(sys.argv[1]).write_text("\n".join(lines) + "\n")
