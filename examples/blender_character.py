"""Characters and baked animations of doublet in Blender, and characters out of it again. Runs in Blender, needs nothing else:

blender --background --python examples/blender_character.py -- import CHARACTER_OR_ANIMATION.glb SCENE.blend
blender --background --python examples/blender_character.py -- import ANIMATION.usdc SCENE.blend
blender SCENE.blend --background --python examples/blender_character.py -- export CHARACTER.glb

`import` reads as File, Import, glTF 2.0 does, sets the scene's frame rate to the animation's, so that every shape falls on a
frame, and lays what makes a character of a character.glb, the extension DOUBLET_character, into the scene. `export` writes what
Blender exports with that extension in it again: `doublet animate` takes the file.
"""

import json
import struct
import sys
from pathlib import Path

import bpy
import numpy

if "bool" not in vars(numpy):  # NumPy 1.24 and later 1.x: the glTF add-on of Debian 12's Blender 3.4 is older than its NumPy
    numpy.bool = bool
EXTENSION = "DOUBLET_character"
#: Members of the extension that are indices of accessors (docs/animation.md).
ARRAYS = {
    "mesh": ("vertices", "faces", "faceValid", "weights"),
    "clothness": ("sigma", "clothness", "region", "rest"),
    "body": ("vertices", "faces", "weights", "shown"),
    "high": ("vertices", "faces", "faceValid", "texcoords", "bodyVertices"),
}
JSON_CHUNK, BINARY_CHUNK = 0x4E4F534A, 0x004E4942


# --- GLB


def read_glb(path):
    """The JSON and the binary chunk."""
    data = Path(path).read_bytes()
    if data[:4] != b"glTF":
        raise SystemExit(f"{path}: expected a binary glTF file, found another one")
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def write_glb(path, gltf, binary):
    binary += bytes(-len(binary) % 4)
    gltf["buffers"] = [{"byteLength": len(binary)}]
    text = json.dumps(gltf, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    header = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary))
    chunks = struct.pack("<II", len(text), JSON_CHUNK) + text + struct.pack("<II", len(binary), BINARY_CHUNK) + binary
    Path(path).write_bytes(header + chunks)


class Arrays:
    """Copies arrays and images from one file to the end of another."""

    def __init__(self, source, source_binary, target, target_binary):
        self.source, self.source_binary, self.target = source, source_binary, target
        self.binary = bytearray(target_binary)

    def view(self, index):
        view = self.source["bufferViews"][index]
        first = view.get("byteOffset", 0)
        self.binary += bytes(-len(self.binary) % 4)
        views = self.target.setdefault("bufferViews", [])
        views.append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": view["byteLength"]})
        self.binary += self.source_binary[first : first + view["byteLength"]]
        return len(views) - 1

    def copied(self, kind, index):
        """The index there of an accessor or image."""
        entry = dict(self.source[kind][index])
        entry["bufferView"] = self.view(entry["bufferView"])
        entries = self.target.setdefault(kind, [])
        entries.append(entry)
        return len(entries) - 1


def with_extension(source, source_binary, target, target_binary):
    """`target` with the extension of `source`, and the arrays that it names; its binary chunk."""
    extension = json.loads(json.dumps(source["extensions"][EXTENSION]))
    arrays = Arrays(source, source_binary, target, target_binary)
    for group, names in ARRAYS.items():
        for name in names:
            if name in extension.get(group, {}):
                extension[group][name] = arrays.copied("accessors", extension[group][name])
    if "texture" in extension.get("high", {}):
        extension["high"]["texture"] = arrays.copied("images", extension["high"]["texture"])
    target.setdefault("extensions", {})[EXTENSION] = extension
    target["extensionsUsed"] = sorted({*target.get("extensionsUsed", []), EXTENSION})
    return bytes(arrays.binary)


# --- Blender


def animation_rate(gltf, binary):
    """Frames a second of an animation with a key for every frame; None = no animation."""
    if not gltf.get("animations"):
        return None
    times = gltf["accessors"][gltf["animations"][0]["samplers"][0]["input"]]
    view = gltf["bufferViews"][times["bufferView"]]
    seconds = struct.unpack_from(f"<{times['count']}f", binary, view.get("byteOffset", 0) + times.get("byteOffset", 0))
    return (len(seconds) - 1) / (seconds[-1] - seconds[0]) if len(seconds) > 1 else None


def name_meshes(scene):
    """The importer leaves an empty under the name of a mesh that is skinned and has shapes."""
    for thing in [o for o in scene.objects if o.type == "MESH"]:
        left = scene.objects.get(thing.name.rsplit(".", 1)[0])
        if left is not None and left.type == "EMPTY" and not left.children:
            name = left.name
            bpy.data.objects.remove(left)
            thing.name = name


def curves_of(action):
    """Blender 5 has them in the channel bags of layers; up to 4.x an action has them itself."""
    if hasattr(action, "fcurves"):
        return list(action.fcurves)
    bags = (bag for layer in action.layers for strip in layer.strips for bag in strip.channelbags)
    return [curve for bag in bags for curve in bag.fcurves]


def put_keys_on_frames(scene, rate):
    """The importer knows whole frame rates only: at 29.97 its keys lie between the frames."""
    scene.render.fps_base = scene.render.fps / rate
    for action in bpy.data.actions:
        for curve in curves_of(action):
            for key in curve.keyframe_points:
                key.co.x = round(key.co.x / scene.render.fps_base)
            curve.update()
    scene.frame_start, scene.frame_end = 0, max(round(action.frame_range[1]) for action in bpy.data.actions)


def import_usd(path, scene_path):
    """Blender puts a frame on each time code, as it should, but leaves the scene at its own rate, 24 a second."""
    try:
        if hasattr(bpy.utils, "expose_bundled_modules"):  # of the module bpy, from PyPI
            bpy.utils.expose_bundled_modules()
        from pxr import Usd
    except ImportError:
        raise SystemExit(
            "expected a Blender with USD's Python module (4.0 or later), found none; set the frame rate by hand"
        ) from None
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.usd_import(filepath=str(Path(path).absolute()))
    set_rate(bpy.context.scene, Usd.Stage.Open(str(path)).GetTimeCodesPerSecond())
    bpy.ops.wm.save_as_mainfile(filepath=str(Path(scene_path).absolute()), compress=True)


def set_rate(scene, rate):
    scene.render.fps = max(1, round(rate))
    scene.render.fps_base = scene.render.fps / rate


def import_file(path, scene_path):
    gltf, binary = read_glb(path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene, rate = bpy.context.scene, animation_rate(gltf, binary)
    if rate:
        scene.render.fps = max(1, round(rate))
    bpy.ops.import_scene.gltf(filepath=str(Path(path).absolute()))
    name_meshes(scene)
    if EXTENSION in gltf.get("extensions", {}):
        part = {"asset": gltf["asset"]}
        kept = with_extension(gltf, binary, part, b"")
        scene[EXTENSION], scene[f"{EXTENSION}_arrays"] = json.dumps(part).encode(), kept
    if rate:
        put_keys_on_frames(scene, rate)
    bpy.ops.wm.save_as_mainfile(filepath=str(Path(scene_path).absolute()), compress=True)


def export_file(path):
    scene = bpy.context.scene
    if EXTENSION not in scene:
        raise SystemExit(f"the scene holds no character: make it with 'import' of a file with the extension {EXTENSION}")
    bpy.ops.export_scene.gltf(filepath=str(Path(path).absolute()), export_format="GLB")
    gltf, binary = read_glb(path)
    part, arrays = json.loads(bytes(scene[EXTENSION])), bytes(scene[f"{EXTENSION}_arrays"])
    write_glb(path, gltf, with_extension(part, arrays, gltf, binary))


if __name__ == "__main__":
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    if arguments[:1] == ["import"] and len(arguments) == 3:
        (import_usd if Path(arguments[1]).suffix.startswith(".usd") else import_file)(*arguments[1:])
    elif arguments[:1] == ["export"] and len(arguments) == 2:
        export_file(arguments[1])
    else:
        raise SystemExit("expected -- import FILE.glb SCENE.blend, or FILE.usdc, or -- export CHARACTER.glb")
    print(arguments[-1])
