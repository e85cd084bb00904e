"""blender SCENE.blend --background --python blender_frames.py -- OUT: what every mesh of the scene is in every frame, +Y up, as
OUT/NAME.npz (`vertices` (T, V, 3), `triangles` (F, 3))."""

import sys
from pathlib import Path

import bpy
import numpy as np

out = Path(sys.argv[sys.argv.index("--") + 1])
scene = bpy.context.scene
meshes = [o for o in scene.objects if o.type == "MESH" and o.name in ("surface", "body")]
frames = {o.name: [] for o in meshes}
for frame in range(scene.frame_start, scene.frame_end + 1):
    scene.frame_set(frame)
    graph = bpy.context.evaluated_depsgraph_get()
    for thing in meshes:
        seen = thing.evaluated_get(graph)
        mesh = seen.to_mesh()
        places = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", places)
        world = np.array(seen.matrix_world)
        x, y, z = (places.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3]).T
        frames[thing.name].append(np.stack([x, z, -y], axis=1))
        triangles = np.empty(3 * len(mesh.polygons), np.int32)
        mesh.polygons.foreach_get("vertices", triangles)
        np.savez(out / f"{thing.name}.npz", vertices=frames[thing.name], triangles=triangles.reshape(-1, 3))
        seen.to_mesh_clear()
np.savez(out / "scene.npz", fps=scene.render.fps / scene.render.fps_base)
