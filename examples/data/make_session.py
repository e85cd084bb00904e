#!/usr/bin/env python3
"""Cuts the shipped session out of a full-size one: fewer frames, half the resolution, a small ground truth.

    python make_session.py SOURCE_SESSION [-o session] [--frames 128] [--size 502] [--truth-step 5]

Needs numpy, opencv-python-headless and the ffmpeg program. The files it writes are described in docs/formats.md.
"""
import argparse
import json
import shutil
import subprocess
from pathlib import Path

import cv2
import numpy as np

README = """# The shipped session `{name}`

A woman of 1.68 m in a knee-length flared skirt dances a pirouette: {cameras} cameras at {size} x {size}, {frames} frames at {fps} fps.
Frame 0 is the scan pose. Metres, +Y up, the actor faces +Z in frame 0. Made by `../make_session.py`.

Everything is synthetic and was made for this project: body by MakeHuman (its assets are CC0), skirt simulated with Blender's cloth solver,
images by a renderer of our own. Released under CC0 1.0. The motion comes from the CMU Graphics Lab Motion Capture Database: the data used in
this project was obtained from mocap.cs.cmu.edu; the database was created with funding from NSF EIA-0196217.

| file | content |
| --- | --- |
| `session.json`, `calibration.yml`, `videos/`, `scan.ply`, `joints.json` | the capture session |
| `motion.bvh` | another clip on a skeleton of other proportions, for a new animation |
| `ground_truth/frames_*.npz` | `frames` (n) video frame numbers, `body` (n, B, 3), `cloth` (n, C, 3): true surfaces, m, rounded to 1/8192 m |
| `ground_truth/static.npz` | `body_tris`, `cloth_tris`, `label` per vertex of [body; cloth] (0 body, 1 garment), landmarks |
| `ground_truth/skeleton.npz` | `joint_names`, `joints` ({frames}, J, 3): exact joint centres of every frame |
| `ground_truth/masks/` | every 10th frame of each camera: 0 background, 128 body, 255 garment |

No stage reads `ground_truth/`; `doublet evaluate` does.
"""


def read_calibration(path, names):
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    keys = ("K", "distortion", "R", "t")
    rig = {n: {k: storage.getNode(f"{n}_{k}").mat() for k in keys} for n in names}
    for n in names:
        rig[n]["image_width"] = int(storage.getNode(f"{n}_image_width").real())
        rig[n]["image_height"] = int(storage.getNode(f"{n}_image_height").real())
    storage.release()
    return rig


def scaled(camera, size):
    """The camera of images resized to size x size; pixel centres stay at integers."""
    sx, sy = size / camera["image_width"], size / camera["image_height"]
    K = camera["K"].copy()
    K[0] *= sx
    K[1] *= sy
    K[0, 2] += (sx - 1) / 2
    K[1, 2] += (sy - 1) / 2
    return {**camera, "K": K, "image_width": size, "image_height": size}


def write_calibration(path, rig):
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    storage.write("camera_count", len(rig))
    for name, camera in rig.items():
        for key, value in camera.items():
            storage.write(f"{name}_{key}", value)
    storage.release()


def cut_video(source, target, frames, size, fps):
    """crf 20; a key frame every 32 frames, so that jumping into the video stays cheap."""
    subprocess.run(["ffmpeg", "-loglevel", "error", "-y", "-i", source, "-frames:v", str(frames), "-vf",
                    f"scale={size}:{size}:flags=area", "-r", str(fps), "-c:v", "libx264", "-preset", "veryslow", "-crf", "20", "-g", "32",
                    "-pix_fmt", "yuv420p", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709",
                    "-movflags", "+faststart", "-fflags", "+bitexact", "-flags:v", "+bitexact", "-map_metadata", "-1", target], check=True)


def half_mask(label, size):
    """Area-averaged coverage decides actor or background; the larger share of the actor decides body or garment."""
    actor = cv2.resize((label > 0).astype(np.float32), (size, size), interpolation=cv2.INTER_AREA)
    garment = cv2.resize((label > 191).astype(np.float32), (size, size), interpolation=cv2.INTER_AREA)
    return np.where(actor < 0.5, 0, np.where(2 * garment >= actor, 255, 128)).astype(np.uint8)


def cut_truth(source, target, names, frames, size, step):
    (target / "masks").mkdir(parents=True)
    wanted = np.arange(0, frames, step)
    chunks = [np.load(p) for p in sorted(source.glob("frames_*.npz"))]
    for chunk in chunks:
        start, count = int(chunk["start"]), len(chunk["body"])
        here = wanted[(wanted >= start) & (wanted < start + count)]
        if len(here):
            rounded = {k: (np.round(chunk[k][here - start] * 8192) / 8192).astype(np.float32) for k in ("body", "cloth")}
            np.savez_compressed(target / f"frames_{here[0]:04d}.npz", frames=here.astype(np.int32), **rounded)
    static = np.load(source / "static.npz")
    kept = ("body_tris", "cloth_tris", "cloth_pinned", "label", "tight_top", "landmark_names", "landmark_vertices", "joint_names")
    np.savez_compressed(target / "static.npz", **{k: static[k] for k in kept})
    skeleton = np.load(source / "skeleton.npz")
    np.savez_compressed(target / "skeleton.npz", joint_names=skeleton["joint_names"],
                        joints=skeleton["joints"][:frames].astype(np.float32), fps=skeleton["fps"])
    for name in names:
        for frame in range(0, frames, 10):
            label = cv2.imread(str(source / "masks" / f"{name}_{frame:04d}.png"), cv2.IMREAD_GRAYSCALE)
            cv2.imwrite(str(target / "masks" / f"{name}_{frame:04d}.png"), half_mask(label, size), [cv2.IMWRITE_PNG_COMPRESSION, 9])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=Path(__file__).parent / "session")
    parser.add_argument("--name", default="pirouette")
    parser.add_argument("--frames", type=int, default=128)
    parser.add_argument("--size", type=int, default=502)
    parser.add_argument("--truth-step", type=int, default=5)
    args = parser.parse_args()

    source, out = args.source, args.output
    session = json.loads((source / "session.json").read_text())
    names = [c["name"] for c in session["cameras"]]
    if args.frames > session["frame_count"]:
        parser.error(f"--frames: the source has {session['frame_count']} frames, asked for {args.frames}")
    if out.exists():
        shutil.rmtree(out)
    (out / "videos").mkdir(parents=True)
    rig = read_calibration(source / session["calibration"], names)
    write_calibration(out / "calibration.yml", {n: scaled(c, args.size) for n, c in rig.items()})
    for camera in session["cameras"]:
        cut_video(str(source / camera["video"]), str(out / "videos" / f"{camera['name']}.mp4"), args.frames, args.size, session["fps"])
    for key, name in (("scan", "scan.ply"), ("markers", "joints.json"), ("new_motion", "motion.bvh")):
        shutil.copyfile(source / session[key], out / name)
    cut_truth(source / "ground_truth", out / "ground_truth", names, args.frames, args.size, args.truth_step)
    short = {"name": args.name, "fps": session["fps"], "frame_count": args.frames,
             "cameras": [{"name": n, "video": f"videos/{n}.mp4"} for n in names], "calibration": "calibration.yml", "scan": "scan.ply",
             "markers": "joints.json", "new_motion": "motion.bvh", "background": "green screen"}
    (out / "session.json").write_text(json.dumps(short, indent=1) + "\n")
    (out / "README.md").write_text(README.format(name=args.name, cameras=len(names), size=args.size, frames=args.frames, fps=session["fps"]))


if __name__ == "__main__":
    main()
