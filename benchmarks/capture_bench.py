"""Seconds per frame of the capture, step by step, and peak memory for N and 2 N frames.

python benchmarks/capture_bench.py SESSION [--frames 20] --actor OUT/actor.npz
"""

import argparse
import json
import resource
import subprocess
import sys
import time
from pathlib import Path

import doublet as d


def timed(seconds, step, function, *arguments):
    start = time.perf_counter()
    result = function(*arguments)
    seconds[step] = seconds.get(step, 0) + time.perf_counter() - start
    return result


def measure_images(session, count) -> dict:
    """One thread, all cameras: what becomes of an image before any pose is sought; seconds a frame."""
    extractor = d.session_silhouettes(session, d.FrameSource.open(session))
    frames, tracker = d.FrameSource.open(session), d.FeatureTracker.create()
    seconds, last = {}, {}
    for frame in range(count):
        for camera in range(frames.camera_count):
            image = timed(seconds, "decode", frames.image, camera, frame)
            mask = frames.mask(camera, frame)
            if not mask.size:
                mask = timed(seconds, "key", extractor.extract, camera, image)
            timed(seconds, "outline", d.trace_outline, mask)
            if image.size:
                features = timed(seconds, "SIFT", tracker.detect, image, mask)
                if camera in last:
                    timed(seconds, "match", tracker.match, last[camera], features, 0.1 * session.rig[camera].height)
                last[camera] = features
    return {step: total / count for step, total in seconds.items()}


def capture(session, actor, count) -> dict:
    """The whole stage, all threads; seconds a frame and the process's peak memory."""
    extractor = d.session_silhouettes(session, d.FrameSource.open(session))
    stage = d.PerformanceCapture.create(d.CaptureOptions(frame_count=count))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    summary = stage.capture(actor, session.rig, d.FrameSource.open(session), extractor).summary
    steps = ("measure", "map", "pose", "limb", "surface")
    return {
        "seconds": {s: getattr(summary, f"{s}_seconds") / count for s in steps} | {"all": summary.seconds_per_frame},
        "before_mb": before,
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    }


def in_own_process(session, actor, count) -> dict:
    """A process's peak never falls, so each length has its own."""
    command = [sys.executable, __file__, str(session), "--actor", str(actor), "--frames", str(count), "--only-capture"]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("session", type=Path)
    parser.add_argument("--frames", type=int, default=20, metavar="N")
    parser.add_argument("--actor", type=Path, required=True, help="actor.npz that `doublet capture` wrote for the session")
    parser.add_argument("--only-capture", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    session = d.Session(arguments.session)
    if arguments.only_capture:
        print(json.dumps(capture(session, d.read_actor(arguments.actor), arguments.frames)))
        return
    if 2 * arguments.frames > session.frame_count:
        parser.error(f"--frames must be at most {session.frame_count // 2}, half of the session")
    print("images, one thread, seconds a frame of all cameras")
    for step, seconds in measure_images(session, arguments.frames).items():
        print(f"  {step:<10}{seconds:8.3f}")
    runs = {
        count: in_own_process(arguments.session, arguments.actor, count) for count in (arguments.frames, 2 * arguments.frames)
    }
    print(f"capture, all threads, seconds a frame over {2 * arguments.frames} frames ('measure' is all of the above)")
    for step, seconds in runs[2 * arguments.frames]["seconds"].items():
        print(f"  {step:<10}{seconds:8.3f}")
    for count, run in runs.items():
        print(f"peak memory, {count} frames: {run['peak_mb']:.0f} MB ({run['before_mb']:.0f} MB before the capture)")
    first, second = (run["peak_mb"] for run in runs.values())
    print(f"each further frame: {(second - first) / arguments.frames:.2f} MB")


if __name__ == "__main__":
    main()
