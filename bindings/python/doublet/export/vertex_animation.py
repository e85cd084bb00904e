"""A new animation as a vertex animation texture, for shaders of game engines: OUT_vat.png, OUT_vat.glb, OUT-remap_info.json.

The layout is OpenVAT's (Stilson, https://openvat.org; normals "packed", 16 bits each), which has shaders for Unity, Unreal,
Godot and three.js. A pixel of the upper half of the texture is how far a vertex of the mesh is from its place at rest, between
`Min` and `Max` of the .json; of the lower half, its normal, between -1 and 1. A column has the frames of a vertex one below the
other; where there are more vertices than MOST_COLUMNS, the next ones begin below. TEXCOORD_1 of the mesh is the pixel of frame 0.
Channels are Blender's axes: x, -z, y.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np

from .. import _doublet as d
from ..common.files import write_json, written_atomically
from ..common.programs import as_file, ffmpeg
from ..common.video import NO_FFMPEG
from .glb_file import buffer_chunk, packed_glb

MOST_COLUMNS = 8192
MOST_ROWS = 16384  # of a texture, of graphics cards
WHOLE = 65535  # of a channel of 16 bits


def to_blender(vectors: np.ndarray) -> np.ndarray:
    """(..., 3), +Y up -> +Z up."""
    return np.stack([vectors[..., 0], -vectors[..., 2], vectors[..., 1]], axis=-1)


def texture_layout(vertices: int, frames: int) -> tuple[int, int]:
    """Columns, and rows of vertices. Raises ValueError if a graphics card has no such texture."""
    rows = -(-vertices // MOST_COLUMNS)
    if 2 * rows * frames > MOST_ROWS:
        raise ValueError(
            f"vertex animation: expected at most {MOST_ROWS // (2 * rows)} frames of {vertices} vertices, found {frames} (--lod)"
        )
    return -(-vertices // rows), rows


class DrawnParts:
    """The vertices of what is drawn: of the display surface (those at seams of the texture once a side), then of the body."""

    def __init__(self, character: d.Character, drawn: d.TexturedFaces, body: bool):
        if not len(character.high.faces):
            raise ValueError(f"vertex animation: expected a character with a display surface, found {character.name} without one")
        self.textured = len(drawn.texcoords) > 0
        self.normal_faces = character.high.faces[np.asarray(character.high_valid, bool)]
        self.body_faces = character.body.faces[np.asarray(character.body_shown, bool) & body]
        places = drawn.texcoords if self.textured else np.zeros((3 * len(drawn.faces), 2))
        corners = np.column_stack([drawn.faces.ravel(), places])
        split, numbers = np.unique(corners, axis=0, return_inverse=True)
        self.high, self.texcoords = split[:, 0].astype(int), split[:, 1:]
        self.body, body_numbers = np.unique(self.body_faces, return_inverse=True)
        self.faces = [numbers.reshape(-1, 3), body_numbers.reshape(-1, 3) + len(self.high)]
        self.count = len(self.high) + len(self.body)

    def points_and_normals(self, high: np.ndarray, body: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(N, 3) both; normals are those of all triangles, whatever is drawn of them."""
        points = np.concatenate([high[self.high], body[self.body]])
        of_high, of_body = d.vertex_normals(high, self.normal_faces), d.vertex_normals(body, self.body_faces)
        return points, np.concatenate([of_high[self.high], of_body[self.body]])


def write_vertex_animation(
    out: Path,
    character: d.Character,
    motion: d.Motion,
    options: d.AnimateOptions | None = None,
    context: d.Context | None = None,
    drawn: d.TexturedFaces | None = None,
) -> int:
    """The animation of a motion as OUT_vat.png, with OUT_vat.glb and OUT-remap_info.json beside it (above). `drawn`: faces in the
    place of the surface's; None or empty = its own. Returns the number of frames. Raises ValueError if `out` does not end in
    _vat.png, there is no display surface, or no graphics card takes such a texture; RuntimeError if a file cannot be written."""
    out = Path(out)
    require_name(out)
    if not shutil.which(ffmpeg()):
        raise FileNotFoundError(NO_FFMPEG)
    options = options or d.AnimateOptions()
    if not options.high:
        raise ValueError(f"{out}: expected the display surface for a vertex animation texture, found it left out (high)")
    parts = DrawnParts(character, drawn if drawn is not None and len(drawn.faces) else d.drawn_faces(character), options.body)
    fps = 1 / character.solver.dt
    texture_layout(parts.count, int((len(motion) - 1) * fps / motion.fps) + 1)  # before the work
    rest, rest_normals = parts.points_and_normals(character.high.vertices, character.body.vertices)
    steps: list[np.ndarray] = []
    normals: list[np.ndarray] = []

    def keep(frame: d.AnimationFrame) -> None:
        points, turned = parts.points_and_normals(frame.high, frame.body)
        steps.append(to_blender(points - rest).astype(np.float32))
        normals.append(np.round((to_blender(turned) / 2 + 0.5) * WHOLE).astype(np.uint16))

    frames = d.animate_each(character, motion, keep, options, context or d.Context())
    columns, rows = texture_layout(parts.count, frames)
    low = np.min([frame.min(axis=0) for frame in steps], axis=0).astype(float)
    span = np.max([frame.max(axis=0) for frame in steps], axis=0) - low
    span[span == 0] = 1
    whole = [np.round((frame - low) / span * WHOLE).astype(np.uint16) for frame in steps]
    write_png16(out, np.concatenate([in_rows(whole, columns, rows), in_rows(normals, columns, rows)]))
    vertices = np.arange(parts.count)
    pixels = np.column_stack([vertices % columns + 0.5, vertices // columns * frames + 0.5]) / (columns, 2 * rows * frames)
    write_mesh(out.with_suffix(".glb"), character, parts, rest, rest_normals, pixels)
    write_json(remap_file(out), remap_info(out, low, low + span, frames, fps))
    return frames


def require_name(out: Path) -> None:
    """Before the work. The other files are named after it."""
    if out.suffix != ".png" or not out.stem.endswith("_vat") or out.stem == "_vat":
        raise ValueError(f"{out}: expected a name that ends in _vat.png for a vertex animation texture, found {out.name}")


def name_of(out: Path) -> str:
    return out.stem[: -len("_vat")]


def remap_file(out: Path) -> Path:
    return out.with_name(f"{name_of(out)}-remap_info.json")


def remap_info(out: Path, low: np.ndarray, high: np.ndarray, frames: int, fps: float) -> dict:
    """What the shaders are told: the ends of the range in m, by channel; the clip as OpenVAT 1.1 lists it."""
    clip = {"startFrame": 0, "endFrame": frames - 1, "framerate": fps, "looping": False}
    return {
        "os-remap": {"Min": low.tolist(), "Max": high.tolist(), "Frames": frames},
        "animations": {name_of(out): clip},
    }


def in_rows(frames: list[np.ndarray], columns: int, rows: int) -> np.ndarray:
    """[frame](N, 3) -> (rows * frames, columns, 3), with zeros behind the last vertex."""
    half = np.zeros((rows, len(frames), columns, 3), np.uint16)
    for index, values in enumerate(frames):
        padded = np.zeros((rows * columns, 3), np.uint16)
        padded[: len(values)] = values
        half[:, index] = padded.reshape(rows, columns, 3)
    return half.reshape(-1, columns, 3)


def write_png16(out: Path, pixels: np.ndarray) -> None:
    """(H, W, 3) uint16, by ffmpeg."""
    height, width, _ = pixels.shape
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb48be", "-s", f"{width}x{height}", "-i", "-"]
    with written_atomically(out) as beside:
        # The frames of a vertex stand one above the other and differ little: hence the filter.
        coded = ["-frames:v", "1", "-c:v", "png", "-pred", "up", "-f", "image2", "-update", "1", as_file(beside)]
        command = [ffmpeg(), "-loglevel", "error", "-xerror", "-y", *raw, *coded]
        done = subprocess.run(command, input=pixels.astype(">u2").tobytes(), capture_output=True)
        if done.returncode or done.stderr.strip():
            said = done.stderr.decode(errors="replace").strip().splitlines() or [f"exit status {done.returncode}"]
            raise RuntimeError(f"{out}: cannot be written: ffmpeg says: {said[0]}")


class GlbBuffer:
    """Arrays of a .glb, one behind the other."""

    def __init__(self):
        self.bytes, self.views, self.accessors = b"", [], []

    def view(self, data: bytes, **what) -> int:
        self.views.append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(data), **what})
        self.bytes += data + bytes(-len(data) % 4)
        return len(self.views) - 1

    def array(self, values: np.ndarray, kind: str) -> int:
        """Of vertices, in float, or of indices; returns the number of the accessor."""
        indices = kind == "SCALAR"
        values = np.ascontiguousarray(values, "<u4" if indices else "<f4")
        view = self.view(values.tobytes(), target=34963 if indices else 34962)
        ends = {} if indices else {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}
        self.accessors.append(
            {"bufferView": view, "componentType": 5125 if indices else 5126, "count": len(values), "type": kind, **ends}
        )
        return len(self.accessors) - 1


def write_mesh(
    path: Path, character: d.Character, parts: DrawnParts, points: np.ndarray, normals: np.ndarray, pixels: np.ndarray
) -> None:
    """The mesh at rest: one of two materials, with all of its vertices in one array."""
    buffer = GlbBuffer()
    texcoords = np.concatenate([parts.texcoords, np.zeros((len(parts.body), 2))])
    attributes = {"POSITION": buffer.array(points, "VEC3"), "NORMAL": buffer.array(normals, "VEC3")}
    attributes |= {"TEXCOORD_0": buffer.array(texcoords, "VEC2"), "TEXCOORD_1": buffer.array(pixels, "VEC2")}
    rough = {"metallicFactor": 0, "roughnessFactor": 0.9}
    colours = [{"baseColorFactor": [0.6, 0.6, 0.6, 1]}, {"baseColorFactor": [*map(float, character.body_colour), 1]}]
    gltf: dict = {"asset": {"version": "2.0", "generator": "doublet"}, "scene": 0, "scenes": [{"nodes": [0]}]}
    if parts.textured and len(character.texture):
        kind = "image/png" if character.texture.startswith(b"\x89PNG") else "image/jpeg"
        gltf["images"] = [{"bufferView": buffer.view(bytes(character.texture)), "mimeType": kind}]
        gltf["textures"], colours[0] = [{"source": 0}], {"baseColorTexture": {"index": 0}}
    primitives = []
    for material, faces in enumerate(parts.faces):
        if len(faces):
            indices = buffer.array(faces.ravel(), "SCALAR")
            primitives.append({"attributes": attributes, "indices": indices, "material": material})
    names = ("surface", "body")
    gltf["materials"] = [
        {"name": name, "doubleSided": name == "surface", "pbrMetallicRoughness": rough | colour}
        for name, colour in zip(names, colours)
    ]
    gltf |= {"nodes": [{"mesh": 0, "name": path.stem}], "meshes": [{"name": path.stem, "primitives": primitives}]}
    gltf |= {"accessors": buffer.accessors, "bufferViews": buffer.views, "buffers": [{"byteLength": len(buffer.bytes)}]}
    with written_atomically(path) as beside:
        beside.write_bytes(packed_glb(gltf, buffer_chunk(buffer.bytes)))
