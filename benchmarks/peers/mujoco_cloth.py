"""MuJoCo's flex: an equality constraint for every edge, thin-shell bending, CG iterations.   mujoco_cloth.py FOLDER"""

import sys

import mujoco
import numpy as np
from scene import DT, SWEEPS, Scene

scene = Scene(sys.argv[1])
points = " ".join(f"{v:.9g}" for v in scene.rest.ravel())
elements = " ".join(map(str, scene.faces.ravel()))
model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{DT}" gravity="0 -9.81 0" solver="CG" iterations="{SWEEPS}" tolerance="0" integrator="discrete"/>
  <size memory="2G"/>
  <worldbody>
    <flexcomp name="skirt" type="direct" dim="2" mass="{scene.masses.sum():.9g}" point="{points}" element="{elements}">
      <contact contype="0" conaffinity="0" selfcollide="none"/>
      <edge equality="true"/>
      <elasticity young="1e4" poisson="0" thickness="1e-3" elastic2d="bend"/>
    </flexcomp>
  </worldbody>
</mujoco>""")
waist = slice(0, 3 * scene.around)  # three slides a vertex
model.dof_armature[waist] = 1e6  # so heavy that nothing moves it
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
start = data.flexvert_xpos.copy()
assert np.allclose(start, scene.rest, atol=1e-6)


def move_waist(points):
    data.qpos[waist] = (points - scene.rest[: scene.around]).ravel()
    data.qvel[waist] = 0


scene.measure("mujoco", move_waist, lambda: mujoco.mj_step(model, data), lambda: data.flexvert_xpos)
