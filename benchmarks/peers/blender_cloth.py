"""Blender's cloth modifier: implicit springs, angular bending.   blender -b -t 1 -P blender_cloth.py -- FOLDER"""

import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

sys.path.insert(0, str(Path(__file__).parent))
from scene import DT, Scene  # noqa: E402


def rigid(rest, points):
    """Rotation and shift (4, 4) that take rest (N, 3) to points: the waist moves as one."""
    u, _, vt = np.linalg.svd((rest - rest.mean(0)).T @ (points - points.mean(0)))
    turn = vt.T @ np.diag([1, 1, np.linalg.det(vt.T @ u.T)]) @ u.T
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, points.mean(0) - turn @ rest.mean(0)
    return Matrix(matrix.tolist())


scene = Scene(sys.argv[sys.argv.index("--") + 1])
world = bpy.context.scene
world.render.fps = round(1 / DT)
world.gravity = (0, -9.81, 0)
world.frame_end = len(scene.waist)
mesh = bpy.data.meshes.new("skirt")
mesh.from_pydata(scene.rest.tolist(), [], scene.faces.tolist())
skirt = bpy.data.objects.new("skirt", mesh)
world.collection.objects.link(skirt)
skirt.vertex_groups.new(name="waist").add(list(range(scene.around)), 1.0, "ADD")

hips = bpy.data.objects.new("hips", None)
world.collection.objects.link(hips)
hips.rotation_mode = "QUATERNION"
for f, waist in enumerate(scene.waist):
    hips.matrix_world = rigid(scene.rest[: scene.around], waist)
    hips.keyframe_insert("location", frame=f + 1)
    hips.keyframe_insert("rotation_quaternion", frame=f + 1)
hook = skirt.modifiers.new("hook", "HOOK")
hook.object = hips
hook.matrix_inverse = Matrix.Identity(4)  # not where the hips are by now
hook.vertex_group = "waist"

modifier = skirt.modifiers.new("cloth", "CLOTH")
modifier.point_cache.frame_end = len(scene.waist)
modifier.collision_settings.use_collision = False
cloth = modifier.settings
cloth.quality = 1  # steps a frame
cloth.vertex_group_mass = "waist"
cloth.mass = float(scene.masses.mean())
cloth.air_damping = 0
cloth.bending_model = "ANGULAR"
world.frame_set(1)


def step():
    world.frame_set(world.frame_current + 1)


def positions():
    shape = skirt.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return [tuple(v.co) for v in shape.data.vertices]


scene.measure("blender", lambda waist: None, step, positions)
