"""PositionBasedDynamics (pyPBD): distance and dihedral constraints in its own groups.   pypbd_cloth.py FOLDER"""

import sys

import numpy as np
import pypbd
from scene import DT, SWEEPS, Scene

scene = Scene(sys.argv[1])
simulation = pypbd.Simulation.getCurrent()
simulation.initDefault()
model = simulation.getModel()
particles = model.getParticles()
for point, mass in zip(scene.rest, scene.masses, strict=True):
    particles.addVertex(point)
    particles.setMass(particles.size() - 1, mass)
for i in range(scene.around):
    particles.setMass(i, 0)
edges, bends = scene.edges()
for a, b in edges:
    model.addDistanceConstraint(int(a), int(b), 1.0)
for i, j, k, m in bends:
    model.addDihedralConstraint(int(k), int(m), int(i), int(j), 1 - (1 - 0.75) ** (1 / SWEEPS))
model.initConstraintGroups()

pypbd.TimeManager.getCurrent().setTimeStepSize(DT)
controller = simulation.getTimeStep()
controller.setValueUInt(pypbd.TimeStepController.NUM_SUB_STEPS, 1)
controller.setValueUInt(pypbd.TimeStepController.MAX_ITERATIONS, SWEEPS)


def move_waist(waist):
    for i, point in enumerate(waist):
        particles.setPosition(i, point)


scene.measure("pypbd", move_waist, lambda: controller.step(model), lambda: np.array(particles.getVertices()))
