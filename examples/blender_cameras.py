"""Cameras of a Blender scene -> calibration.yml of a session, for rendered footage. Runs in Blender, needs nothing else:

blender SCENE.blend --background --python examples/blender_cameras.py -- calibration.yml [CAMERA ...]

All cameras of the scene, or those named. Metres by the scene's unit scale; Blender's +Z up becomes +Y up. Lens shift, sensor fit
and the aspect of pixels are kept; only perspective cameras have a calibration.
"""

import re
import sys
from pathlib import Path

import bpy

Z_UP_TO_Y_UP = ((1, 0, 0), (0, 0, 1), (0, -1, 0))  # (x, y, z) -> (x, z, -y)
VIEW_TO_OPENCV = (1, -1, -1)  # Blender looks along -z with y up, OpenCV along +z with y down


def image_size(render):
    return tuple(int(pixels * render.resolution_percentage / 100) for pixels in (render.resolution_x, render.resolution_y))


def intrinsics(camera, render):
    """Rows of K, for pixel centres at integers."""
    width, height = image_size(render)
    aspect = render.pixel_aspect_y / render.pixel_aspect_x
    by_width = camera.sensor_fit == "HORIZONTAL" or (camera.sensor_fit == "AUTO" and width >= height * aspect)
    sensor = camera.sensor_height if camera.sensor_fit == "VERTICAL" else camera.sensor_width
    span = width if by_width else height * aspect  # of the sensor, in widths of a pixel
    focal = camera.lens / sensor * span
    cx, cy = width / 2 - camera.shift_x * span, height / 2 + camera.shift_y * span / aspect
    return (focal, 0, cx - 0.5), (0, focal / aspect, cy - 0.5), (0, 0, 1)


def pose(matrix_world, scale):
    """R and t, x_camera = R x_world + t, metres. The object's scale does not scale what its camera sees."""
    columns = [[matrix_world[r][c] for r in range(3)] for c in range(3)]
    axes = [[x / sum(v * v for v in column) ** 0.5 for x in column] for column in columns]  # the camera's, in Blender's world
    turned = [[sum(row[k] * axis[k] for k in range(3)) for row in Z_UP_TO_Y_UP] for axis in axes]
    R = [[sign * x for x in axis] for sign, axis in zip(VIEW_TO_OPENCV, turned)]
    centre = [scale * sum(row[k] * matrix_world[k][3] for k in range(3)) for row in Z_UP_TO_Y_UP]
    return R, [[-sum(row[k] * centre[k] for k in range(3))] for row in R]


def matrix(key, rows):
    data = ", ".join(repr(float(x)) for row in rows for x in row)
    return f"{key}: !!opencv-matrix\n   rows: {len(rows)}\n   cols: {len(rows[0])}\n   dt: d\n   data: [ {data} ]"


def calibration(scene, names=()):
    """Text of calibration.yml."""
    cameras = [o for o in scene.objects if o.type == "CAMERA" and (not names or o.name in names)]
    missing = set(names) - {camera.name for camera in cameras}
    if missing or not cameras:
        raise SystemExit(f"the scene has no camera {', '.join(sorted(missing))}".rstrip())
    lines = ["%YAML:1.0", "---", f"camera_count: {len(cameras)}"]
    keys = set()
    for camera in cameras:
        if camera.data.type != "PERSP":
            raise SystemExit(f"camera '{camera.name}': expected a perspective camera, found {camera.data.type}")
        key = re.sub(r"[^A-Za-z0-9_-]", "_", camera.name)  # Camera.001 -> Camera_001
        key = key if key[:1].isalpha() else f"cam{key}"
        if key in keys:
            raise SystemExit(f"expected the names of cameras to differ, found '{key}' twice")
        keys.add(key)
        R, t = pose(camera.matrix_world, scene.unit_settings.scale_length)
        lines += [matrix(f"{key}_K", intrinsics(camera.data, scene.render)), matrix(f"{key}_distortion", [[0] * 5])]
        lines += [matrix(f"{key}_R", R), matrix(f"{key}_t", t)]
        width, height = image_size(scene.render)
        lines += [f"{key}_image_width: {width}", f"{key}_image_height: {height}"]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    if not arguments:
        raise SystemExit("blender SCENE.blend --background --python blender_cameras.py -- calibration.yml [CAMERA ...]")
    Path(arguments[0]).write_text(calibration(bpy.context.scene, arguments[1:]), encoding="utf-8")
    print(arguments[0])
