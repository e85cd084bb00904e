"""Measures of papers on simulated avatars: success rate of the simulation, seconds per frame, Chamfer distance and F-score.

python benchmarks/field.py NAME=CHARACTER.glb... --clips CLIP... -o FOLDER [--count 200] [--seed 1]
python benchmarks/field.py --truth SESSION/ground_truth OUT [--every N]

The first plays each character --count random clips: 3 s from a random place of a random clip, at 0.7 to 1.4 times its speed, with
the last pose held for 2 s. In every fourth the joints are turned away from the clip, each angle towards N(0, 0.3 rad) of its own
every half second, within the joint's limits, and at the end not at all: such a body passes through itself. Whether one does is
counted in every eighth frame: the share of those with faces of the body through others that do not cross in the scan's pose.

A clip succeeds if all numbers are finite, no edge of the drawn garment is over 3 times as long in the motion as in its rest
shape (2 mm if it is shorter there), and at the end of the hold at most 0.5 % of the faces of the simulated garment pass through
others: what the player itself takes for a garment that is not tangled, since a few faces in the bottom of a fold do. A garment
with more may be caught, or be pressed together by this pose, in a groin or an armpit. Such a clip goes on for 0.6 s to the
scan's pose and 0.5 s there, before the player would look for tangles again: more than 0.5 % then is a knot that stays.

ms a frame: of the player, all that is drawn, CPU time; median over frames, then over clips. Clips that FOLDER has of the same
character are not played again.

The second compares the surfaces that cameras see, body and garment, with the truth, in both directions, with samples as
`doublet evaluate` has them: Chamfer distance, the mean of both mean distances; F-score, the harmonic mean of the shares of both
that are within a radius. CD and F are those of the evaluation code of MPMAvatar (Lee, Lee, Kim 2025): 1000 times the sum of both
mean squares of the distance, m^2, and squares up to 0.001 m^2, which is a radius of 3.2 cm.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import doublet as d
import numpy as np
from clips import TOO_LONG, GarmentWatcher, held
from display_hem import Drawn
from doublet.evaluation.metrics import averaged, centroids, seen_faces
from doublet.evaluation.reconstruction import Reconstruction
from doublet.evaluation.truth import Truth

SECONDS, HELD = 3.0, 2.0
BACK = 0.6, 0.5  # s to the scan's pose, and in it
SPEEDS = (0.7, 1.4)
TURNED_EVERY = 4  # clips
TURN, TURN_SECONDS = 0.3, 0.5  # rad, s
EVERY = 8  # frames between two in which the body is looked at
TANGLED = 0.005  # of the garment's faces, as the player has it
RADII = {"F (1 cm), %": 0.01, "F (MPMAvatar), %": 0.001**0.5}  # m
COLUMNS = ["character", "success", "turned: success", "body through itself, %", "not finite",
           "too long; most", "held, tangled; most, %",
           "stays; most, %", "ms a frame"]  # fmt: skip
ROOT = 6  # degrees of freedom


def draw(seed: int, index: int, clips: dict[str, d.SourceMotion]) -> dict:
    """What a clip is; the turns of its joints follow from seed and index."""
    random = np.random.default_rng((seed, index))
    name = list(clips)[random.integers(len(clips))]
    speed = float(random.uniform(*SPEEDS))
    last_start = max(0.0, clips[name].frame_count / clips[name].fps - SECONDS * speed)
    first = float(random.uniform(0, last_start))
    return {"seed": seed, "index": index, "clip": name, "first": first, "speed": speed, "turned": index % TURNED_EVERY == 0}


def turned(motion: d.Motion, skeleton: d.Skeleton, random: np.random.Generator) -> d.Motion:
    """The motion with its joints, not the root, turned by smooth random angles that begin and end with none."""
    count = round(len(motion) / motion.fps / TURN_SECONDS)
    at = np.linspace(0, count, len(motion))
    key = np.minimum(at.astype(int), count - 1)
    turns = random.normal(0, TURN, (count + 1, motion.dofs.shape[1]))
    turns[[0, -1]], turns[:, :ROOT] = 0, 0
    share = (at - key)[:, None]
    share = share**2 * (3 - 2 * share)
    dofs = motion.dofs + (1 - share) * turns[key] + share * turns[key + 1]
    return d.Motion(motion.fps, np.clip(dofs, np.asarray(skeleton.lower), np.asarray(skeleton.upper)))


def motion_of(drawn: dict, clip: d.SourceMotion, character: d.Character) -> d.Motion:
    skeleton, fps, speed = character.actor.skeleton, 1 / character.solver.dt, drawn["speed"]
    window = drawn["first"], drawn["first"] + SECONDS * speed
    slow = d.RetargetOptions(fps=fps / speed, first_second=window[0], last_second=window[1])
    motion = d.resolve_arm_penetration(character, d.Motion(fps, d.retarget(clip, skeleton, slow).dofs))
    return turned(motion, skeleton, np.random.default_rng((drawn["seed"], drawn["index"], 1))) if drawn["turned"] else motion


def back(motion: d.Motion) -> np.ndarray:
    """Poses (T, D) from the last one to the scan's, where that stands, and there."""
    last, share = motion.dofs[-1], np.minimum(np.arange(1, round(sum(BACK) * motion.fps) + 1) / (BACK[0] * motion.fps), 1)
    there = np.where(np.arange(len(last)) < ROOT, last, 0)
    share = (share**2 * (3 - 2 * share))[:, None]
    return (1 - share) * last + share * there


def without_cloth(path: Path) -> d.Character:
    """The character's actor and body alone."""
    bare = d.Character.read(path)
    vertices = len(bare.actor.mesh.vertices)
    bare.segmentation = d.Segmentation(np.zeros(vertices), np.zeros(vertices), np.full(vertices, -1, np.int32))
    bare.high, bare.high_valid, bare.texcoords = d.Mesh(), [], np.zeros((0, 2))
    bare.materials, bare.high_body, bare.texture, bare.garment_subdivisions = [], [], b"", -1
    return bare


class Subject:
    """A character, and the clips that it has been played."""

    def __init__(self, name: str, path: Path, folder: Path):
        self.name, self.character, self.rows_path = name, d.Character.read(path), folder / f"{name}.jsonl"
        self.drawn, self.bare, self.hash = Drawn(self.character), without_cloth(path), d.hash_files(path)[:16]
        lines = self.rows_path.read_text(encoding="utf-8").splitlines() if self.rows_path.exists() else []
        self.rows = {row["index"]: row for row in map(json.loads, lines)}

    def play(self, drawn: dict, clip: d.SourceMotion) -> None:
        """One more clip, unless it is there."""
        drawn = {**drawn, "character": self.hash}
        known = self.rows.get(drawn["index"])
        if known is None:
            row = drawn | self.measured(motion_of(drawn, clip, self.character))
            self.rows[drawn["index"]] = row
            with self.rows_path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")
        elif drawn != {key: known.get(key, drawn[key]) for key in drawn}:  # of before there may be no hash
            raise SystemExit(f"{self.rows_path}: clip {drawn['index']}: expected {drawn}, found {known}: take another folder")

    def measured(self, motion: d.Motion) -> dict:
        watch, player, seconds = GarmentWatcher(self.character, self.drawn, len(motion)), d.Player(self.character), []

        def play(poses: np.ndarray) -> float:
            """The share of the garment's faces that pass through others in the last of the poses (T, D)."""
            for pose in poses:
                since = time.process_time()
                frame = player.step(pose)
                seconds.append(time.process_time() - since)
                watch(frame)
            return watch.count_crossing() / len(watch.worn)

        row = {"frames": len(motion), "body": self.body_through_itself(motion), "failed": "", "let_go": 0.0}
        try:
            watch(player.reset(motion.dofs[0]))
            crossing = [play(motion.dofs[1:]), play(held(motion, HELD).dofs[len(motion) :])]
            if crossing[-1] > TANGLED:
                row["let_go"] = play(back(motion))
        except d.Error as error:  # not finite
            return row | {"failed": str(error), "seconds": float(np.median(seconds))}
        at = int(np.argmax(watch.stretch))
        return row | {"stretch": watch.stretch[at], "stretch_at": at, "crossing": crossing, "seconds": float(np.median(seconds))}

    def body_through_itself(self, motion: d.Motion) -> list[int]:
        """Faces of the body that pass through others, in every eighth frame; those that do in the scan pose are not counted."""
        faces, counts = self.bare.body.faces, []
        always = np.asarray(d.self_intersecting_faces(self.bare.body), bool)

        def look(frame: d.AnimationFrame) -> None:
            if frame.index % EVERY == 0:
                counts.append(int(np.sum(d.self_intersecting_faces(d.Mesh(frame.body, faces)) & ~always)))

        as_it_is = d.AnimateOptions(high=False, resolve_arm_penetration=False, resolve_body_penetration=False)
        d.animate_each(self.bare, motion, look, as_it_is)
        return counts


def succeeded(row: dict) -> bool:
    return not row["failed"] and row["stretch"] <= TOO_LONG and row["crossing"][1] <= TANGLED


def worst(rows: list[dict], measure) -> str:
    """The most of it, and which clip."""
    row = max(rows, key=measure)
    return f"{measure(row):.3g} ({row['index']})"


def share(flags) -> str:
    flags = list(flags)
    return f"{sum(flags)} of {len(flags)}" if flags else "-"


def table_row(name: str, rows: list[dict]) -> list[str]:
    """One character's."""
    kinds = [[row for row in rows if row["turned"] == turned] for turned in (False, True)]
    whole = [row for row in rows if not row["failed"]]
    return [
        name,
        *(share(succeeded(row) for row in kind) for kind in kinds),
        ", ".join(f"{100 * np.mean([count > 0 for row in kind for count in row['body']]):.0f}" for kind in kinds if kind),
        share(bool(row["failed"]) for row in rows),
        f"{share(row['stretch'] > TOO_LONG for row in whole)}; {worst(whole, lambda row: row['stretch'])}",
        f"{share(row['crossing'][1] > TANGLED for row in whole)}; {worst(whole, lambda row: 100 * row['crossing'][1])}",
        f"{share(row['let_go'] > TANGLED for row in whole)}; {worst(whole, lambda row: 100 * row['let_go'])}",
        f"{1000 * np.median([row['seconds'] for row in rows]):.1f}",
    ]


def markdown(header: list[str], rows: list[list[str]]) -> str:
    return "\n".join("| " + " | ".join(line) + " |" for line in [header, ["---"] * len(header), *rows])


def play_all(chosen: argparse.Namespace) -> None:
    chosen.out.mkdir(parents=True, exist_ok=True)
    clips = {path.name: d.SourceMotion.read(path) for path in chosen.clips}
    if len(clips) < len(chosen.clips):
        raise SystemExit("--clips: expected files of different names, found some of the same")
    subjects = [Subject(name, path, chosen.out) for name, path in chosen.characters]
    for index in range(chosen.count):
        drawn = draw(chosen.seed, index, clips)
        for subject in subjects:
            subject.play(drawn, clips[drawn["clip"]])
    print(markdown(COLUMNS, [table_row(s.name, [s.rows[k] for k in range(chosen.count)]) for s in subjects]))


def one_way(points, faces, chosen, onto: d.Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Distances m, weights: of the chosen faces (bool, F) of a surface, to the other."""
    distances = d.distances_to_surface(centroids(points, faces[chosen]), onto)
    return distances, d.face_areas(points, faces[chosen])


def scores(ours: tuple, truth: tuple, cameras) -> dict[str, float]:
    """Of two surfaces (vertices, faces)."""
    ways = [one_way(*own, seen_faces(*own, cameras), d.Mesh(*other)) for own, other in ((ours, truth), (truth, ours))]

    def mean(of) -> list[float]:
        return [averaged(of(distances), areas, "surface that a camera sees") for distances, areas in ways]

    found = {"Chamfer, mm": 1000 * np.mean(mean(lambda x: x)), "CD (MPMAvatar)": 1000 * np.sum(mean(np.square))}
    for name, radius in RADII.items():
        precision, recall = mean(lambda x, radius=radius: x <= radius)
        found[name] = 100 * 2 * precision * recall / max(precision + recall, 1e-9)
    return found


def compare(truth_folder: Path, out: Path, every: int) -> None:
    truth, made = Truth(truth_folder), Reconstruction(out)
    cameras, moving = d.Session(truth_folder.parent).rig, made.reanimated
    found = {"captured": [], "simulated": []}
    for row, frame in made.rows(truth.chunks, every):
        true = truth.surface(frame)[:2]
        found["captured"].append(scores((made.performance.surface.frames[row], made.faces), true, cameras))
        found["simulated"].append(scores((moving.surfaces[frame], moving.faces), true, cameras))
    names = list(found["captured"][0])
    rows = [[what, *(f"{np.mean([s[n] for s in of]):.3g}" for n in names)] for what, of in found.items()]
    print(markdown(["surface", *names], rows))


def named_character(text: str) -> tuple[str, Path]:
    name, _, path = text.partition("=")
    if not Path(path).is_file():
        raise argparse.ArgumentTypeError(f"expected NAME=CHARACTER.glb, a file, found {text}")
    return name, Path(path)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("characters", nargs="*", type=named_character, metavar="NAME=CHARACTER.glb")
    parser.add_argument("--clips", type=Path, nargs="+", default=[], metavar="CLIP")
    parser.add_argument("-o", dest="out", type=Path, metavar="FOLDER")
    parser.add_argument("--count", type=int, default=200, metavar="N", help="clips a character (default: 200)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--truth", type=Path, nargs=2, metavar=("SESSION/ground_truth", "OUT"))
    parser.add_argument("--every", type=int, default=1, metavar="N", help="every n-th frame that has a truth (default: 1)")
    chosen = parser.parse_args()
    if chosen.truth:
        compare(*chosen.truth, chosen.every)
    elif chosen.characters and chosen.clips and chosen.out:
        play_all(chosen)
    else:
        parser.error("expected characters, --clips and -o, or --truth, found neither")


if __name__ == "__main__":
    main()
