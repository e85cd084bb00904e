"""Writes corpus/: small valid inputs of every harness (python tests/fuzz/corpus.py). What a crash has taught is added by hand."""

from __future__ import annotations

import tempfile
from pathlib import Path

import calibrations
import doublet as d
import numpy as np
from seeds import AMC, ASF, BVH, World, make_seeds, tube

HERE = Path(__file__).resolve().parent
CORPUS = HERE / "corpus"


def container(files) -> bytes:
    """Several files in one input, as harness.h takes them apart."""
    return b"".join(f"==== {path.name}\n".encode() + path.read_bytes() for path in files)


def put(harness: str, name: str, content: bytes | str) -> None:
    path = CORPUS / harness / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content.encode() if isinstance(content, str) else content)


def frame_bytes() -> bytes:
    """A tracked frame, as libcapture/src/tracking/tracked_frame.cpp writes it."""

    def counted(values, dtype: str) -> bytes:
        return np.uint64(len(values)).tobytes() + np.array(values, dtype).tobytes()

    def counts(*n: int) -> bytes:
        return np.array(n, "u8").tobytes()

    match = counted([1, 2], "f4") + counted([3, 4], "f4")
    track = np.array([0, 5], "i4").tobytes() + counted([0.2, 0.3, 0.5], "f8") + counted([7, 8], "f8") + np.float64(1).tobytes()
    poses = counted([0, 1, 0], "f8") + counts(2) + np.arange(6, dtype="f8").tobytes() + np.array([0.5, 0.6], "f8").tobytes()
    limbs = counted([0, 1], "i4") + counted([2, 3], "i4") + counted([4, 5, 6], "i4")
    lost = np.int32(9).tobytes() + counts(4) + b"knee" + np.array([0.1, 0.2], "f8").tobytes() + b"\1"
    images = counts(12345)
    return images + counts(1, 1) + match + counts(1) + track + poses + limbs + counts(1) + lost + counted(np.arange(6), "f8")


def small_character(world: World, path: Path) -> bytes:
    """Of a few vertices, with a picture of one colour."""
    high, grey = d.Mesh(*tube(0.2, 0.5, 1.5, 5, 3)), np.full((48, 48, 3), 128, np.uint8)
    character = d.make_character(
        world.actor, world.segmentation, world.body, world.proxies, [world.material], d.SolverSettings(0.025), high
    )
    options = d.TextureOptions(size=64)
    d.texture_character(character, world.mesh.vertices, world.cameras, [grey] * 2, [world.mask] * 2, options)
    character.write(path)
    return path.read_bytes()


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        formats, world = make_seeds(Path(folder))
        for extension in ("ply", "obj", "stl", "off"):
            for path in formats[extension][0]:
                put("mesh", f"{path.stem}_{extension}", f"==== mesh.{extension}\n".encode() + path.read_bytes())
        put("bvh", "walk", BVH)
        put("gltf_motion", "clip.glb", formats["clip"][0][0].read_bytes())
        put("acclaim", "person", f"==== person.asf\n{ASF}==== person.amc\n{AMC}")
        for name in calibrations.WRITERS:
            put("calibration", name, container(formats[name][0]))
        put("calibration", "doublet", container([Path(folder) / "session" / "calibration.yml"]))
        put("calibration", "lenses", b"==== calibration.yml\n" + formats["lenses"][0][0].read_bytes())
        put(
            "session",
            "small",
            container(Path(folder) / "session" / name for name in ("session.json", "joints.json", "calibration.yml")),
        )
        put("stage_texts", "small", container([formats["proxies"][0][0], formats["material"][0][0]]))
        put("fit_checkpoint", "bowl", formats["checkpoint"][0][0].read_bytes())
        put("capture_checkpoint", "frame", frame_bytes())
        for path in formats["npz"][0]:
            put("npz", path.name, path.read_bytes())
        put("character", "small.glb", small_character(world, Path(folder) / "small.glb"))


if __name__ == "__main__":
    main()
