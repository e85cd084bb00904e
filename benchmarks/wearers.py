"""People in garments drawn at random, synthesised, captured, segmented and compared with the truth.

python benchmarks/wearers.py 0 1 2 ... --clips CLIP.bvh ... -o FOLDER [--whole]

A seed is a wearer: kind of garment (eight in turn), its length, ease, colour (of every third: that of the skin), the person's
shape, and a clip. Printed: what it is, and `cloth_iou`, as `doublet evaluate` has it; the median and the worst tenth at the end.
With --whole the garment is meshed, fitted and simulated, too, and `resim_cloth_cm` and `resim_two_sided_cm` printed. What is in
FOLDER already is not made again; another clip than a wearer was filmed in is refused. Even seeds are there to choose options
by, odd ones to report.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

import doublet as d
import numpy as np
from doublet.cli.common_flags import DOUBTFUL
from doublet.common.console import Console
from doublet.evaluation.metrics import Reconstruction, Truth, cloth_iou, evaluate
from dressed_character import NECK, SKIN_TINT, TRUNK, WAIST, WHOLE, Cut, dressed_character

KINDS = ("trousers", "shorts", "tee", "long sleeves", "jacket", "vest", "jumpsuit", "coat")
IMAGE_SIZE, FRAMES = 400, 70


def random_cut(kind: str, random: np.random.Generator) -> Cut:
    """Whatever the kind, as many numbers are drawn."""
    trunk = dict.fromkeys(TRUNK, WHOLE)
    draws = ((0.3, 0.95), (0.5, 0.95), (0.3, 0.95), (0.2, 0.9), (0.5, 0.95), (0.3, 1), (0.2, 0.9), (0.5, 0.9), (0.5, 1))
    trousers, shorts, tee, long, jacket, overall, leg, coat, tail = (float(random.uniform(*bounds)) for bounds in draws)
    return {
        "trousers": Cut({"pelvis": WHOLE, "hip": WHOLE, "knee": trousers}, WAIST),
        "shorts": Cut({"pelvis": WHOLE, "hip": shorts}, WAIST),
        "tee": Cut({**trunk, "shoulder": tee}, NECK),
        "long sleeves": Cut({**trunk, "shoulder": WHOLE, "elbow": long}, NECK),
        "jacket": Cut({**trunk, "shoulder": WHOLE, "elbow": jacket}, NECK, True),
        "vest": Cut(trunk, NECK),
        "jumpsuit": Cut({**trunk, "shoulder": overall, "hip": WHOLE, "knee": leg}, NECK),
        "coat": Cut({**trunk, "shoulder": WHOLE, "elbow": coat, "hip": tail}, NECK, True),
    }[kind]


def make_wearer(seed: int, path: Path) -> None:
    random = np.random.default_rng(1000 + seed)
    kind = KINDS[seed % len(KINDS)]
    cut = random_cut(kind, random)
    tint = random.uniform(0.05, 0.9, 3) * [1, 0.5, 1]  # little green: the screen is
    ease = float(random.uniform(0.015, 0.05))
    character = dressed_character([cut], ease, seed + 20, [SKIN_TINT if seed % 3 == 2 else tint], contrast=0.4)
    character.name = kind
    character.write(path)


def run(*command: object) -> None:
    done = subprocess.run([sys.executable, "-m", "doublet", *map(str, command), "--quiet"])
    if done.returncode not in (0, DOUBTFUL):
        done.check_returncode()


def captured(seed: int, clip: Path, folder: Path) -> tuple[Path, Path]:
    """Folders of the results, up to what is cloth, and of the session."""
    character, session, out = (folder / f"wearer{seed}{ending}" for ending in (".glb", "", ".out"))
    filmed = folder / f"wearer{seed}.clip"
    if not (session / "session.json").exists():
        filmed.write_text(clip.name, encoding="utf-8")
    found = filmed.read_text(encoding="utf-8") if filmed.exists() else "nobody knows what"
    if found != clip.name:
        raise SystemExit(f"{session}: expected a film of {clip.name}, found one of {found}: take another folder")
    if not character.exists():
        make_wearer(seed, character)
    if not (session / "session.json").exists():
        run("synthesize", character, "--motion", clip, "--image-size", IMAGE_SIZE, "--frame-count", FRAMES, "-o", session)
    run("capture", session, "-o", out)
    run("segment", out)
    return out, session


def resimulated(out: Path, session: Path) -> str:
    run("reconstruct", session, "-o", out)
    metrics = evaluate(out, session / "ground_truth", d.Session(session), Console(quiet=True))["metrics"]
    return f"  {metrics['resim_cloth_cm']:.2f} {metrics['resim_two_sided_cm']:.2f} cm"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("seeds", type=int, nargs="+")
    parser.add_argument("--clips", type=Path, nargs="+", required=True)
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--whole", action="store_true", help="mesh, fit and simulate the garment, too")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    values = []
    for seed in options.seeds:
        out, session = captured(seed, options.clips[seed % len(options.clips)], options.out)
        made = Reconstruction(out)
        values.append(cloth_iou(made, Truth(session / "ground_truth"), d.Session(session).rig))
        colour = "the colour of skin" if seed % 3 == 2 else "another colour"
        moved = resimulated(out, session) if options.whole else ""
        print(f"{seed:4} {KINDS[seed % len(KINDS)]:<12} {colour:<18} {values[-1]:.3f}{moved}", flush=True)
    print(f"median {np.median(values):.3f}, worst tenth {np.quantile(values, 0.1):.3f}")


if __name__ == "__main__":
    main()
