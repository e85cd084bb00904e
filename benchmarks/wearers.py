"""People in garments drawn at random, synthesised, captured, segmented and compared with the truth.

python benchmarks/wearers.py 0 1 2 ... --clips CLIP.bvh ... -o FOLDER

A seed is a wearer: kind of garment (eight in turn), its length, ease, colour (of every third: that of the skin), the person's
shape, and a clip. Printed: what it is, and `cloth_iou`, as `doublet evaluate` has it; the median and the worst tenth at the end.
What is in FOLDER already is not made again. Even seeds are there to choose options by, odd ones to report.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

import doublet as d
import numpy as np
from doublet.evaluation.metrics import Reconstruction, Truth, cloth_iou
from dressed_character import NECK, SKIN_TINT, TRUNK, WAIST, Cut, dressed_character

KINDS = ("trousers", "shorts", "tee", "long sleeves", "jacket", "vest", "jumpsuit", "coat")
IMAGE_SIZE, FRAMES = 400, 70


def random_cut(kind: str, random: np.random.Generator) -> Cut:
    trunk = dict.fromkeys(TRUNK, 1.0)

    def share(low: float, high: float = 0.95) -> float:
        return float(random.uniform(low, high))

    return {
        "trousers": lambda: Cut({"pelvis": 1, "hip": 1, "knee": share(0.3)}, WAIST),
        "shorts": lambda: Cut({"pelvis": 1, "hip": share(0.5)}, WAIST),
        "tee": lambda: Cut({**trunk, "shoulder": share(0.3)}, NECK),
        "long sleeves": lambda: Cut({**trunk, "shoulder": 1, "elbow": share(0.2)}, NECK),
        "jacket": lambda: Cut({**trunk, "shoulder": 1, "elbow": share(0.5)}, NECK, True),
        "vest": lambda: Cut(trunk, NECK),
        "jumpsuit": lambda: Cut({**trunk, "shoulder": share(0.3), "hip": 1, "knee": share(0.2)}, NECK),
        "coat": lambda: Cut({**trunk, "shoulder": 1, "elbow": share(0.5), "hip": share(0.5)}, NECK, True),
    }[kind]()


def make_wearer(seed: int, path: Path) -> None:
    random = np.random.default_rng(1000 + seed)
    cut = random_cut(KINDS[seed % len(KINDS)], random)
    tint = random.uniform(0.05, 0.9, 3) * [1, 0.5, 1]  # little green: the screen is
    character = dressed_character(cut, float(random.uniform(0.015, 0.05)), seed + 20, SKIN_TINT if seed % 3 == 2 else tint)
    character.name = KINDS[seed % len(KINDS)]
    character.write(path)


def run(*command: object) -> None:
    subprocess.run([sys.executable, "-m", "doublet", *map(str, command), "--quiet"], check=True)


def captured(seed: int, clip: Path, folder: Path) -> tuple[Path, Path]:
    """Folders of the results, up to what is cloth, and of the session."""
    character, session, out = (folder / f"wearer{seed}{ending}" for ending in (".glb", "", ".out"))
    if not character.exists():
        make_wearer(seed, character)
    if not (session / "session.json").exists():
        run("synthesize", character, "--motion", clip, "--image-size", IMAGE_SIZE, "--frame-count", FRAMES, "-o", session)
    run("capture", session, "-o", out)
    run("segment", out)
    return out, session


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("seeds", type=int, nargs="+")
    parser.add_argument("--clips", type=Path, nargs="+", required=True)
    parser.add_argument("-o", "--out", type=Path, required=True)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    values = []
    for seed in options.seeds:
        out, session = captured(seed, options.clips[seed % len(options.clips)], options.out)
        made = Reconstruction(out)
        values.append(cloth_iou(made, Truth(session / "ground_truth"), d.Session(session).rig))
        colour = "the colour of skin" if seed % 3 == 2 else "another colour"
        print(f"{seed:4} {KINDS[seed % len(KINDS)]:<12} {colour:<18} {values[-1]:.3f}", flush=True)
    print(f"median {np.median(values):.3f}, worst tenth {np.quantile(values, 0.1):.3f}")


if __name__ == "__main__":
    main()
