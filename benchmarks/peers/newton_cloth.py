"""Newton's XPBD and VBD solvers on Warp's CPU device.   newton_cloth.py FOLDER [vbd]"""

import sys

import newton
import numpy as np
import warp as wp
from scene import DT, SWEEPS, Scene

scene = Scene(sys.argv[1])
vbd = sys.argv[2:] == ["vbd"]
wp.config.quiet = True
wp.set_device("cpu")
builder = newton.ModelBuilder(up_axis=newton.Axis.Y, gravity=(0.0, -9.81, 0.0))
builder.add_cloth_mesh(
    pos=wp.vec3(0, 0, 0),
    rot=wp.quat_identity(),
    scale=1.0,
    vel=wp.vec3(0, 0, 0),
    vertices=[wp.vec3(*p) for p in scene.rest],
    indices=scene.faces.ravel().tolist(),
    density=1.0,
    tri_ke=1e4 if vbd else 0.0,  # VBD stretches triangles, XPBD edges
    tri_ka=1e4 if vbd else 0.0,
    tri_kd=0.0,
    edge_ke=0.01 if vbd else 1e-6,
    edge_kd=0.0,
    add_springs=not vbd,
    # Its springs are Jacobi without relaxation: stiffer than this, and they explode at 40 frames a second.
    spring_ke=float(scene.masses.min()) / (16 * DT**2),
    spring_kd=0.0,
    particle_radius=0.002,
)
for i in range(scene.around):
    builder.particle_mass[i] = 0.0
    builder.particle_flags[i] = 0
if vbd:
    builder.color(include_bending=True)
model = builder.finalize()
solver = (newton.solvers.SolverVBD if vbd else newton.solvers.SolverXPBD)(model, iterations=SWEEPS)
states = [model.state(), model.state()]
control = model.control()


def move_waist(waist):
    states[0].particle_q.numpy()[: scene.around] = waist.astype(np.float32)  # a view on the CPU


def step():
    solver.step(states[0], states[1], control, None, DT)
    states.reverse()


scene.measure("newton-vbd" if vbd else "newton-xpbd", move_waist, step, lambda: states[0].particle_q.numpy())
