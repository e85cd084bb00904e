"""How a character's texture differs from the actor, by part of the body (docs/animation.md).

python benchmarks/texture_truth.py OUT SESSION [--frames 1 16] [--label-margin 0.05] [--write FOLDER]

Bakes the texture of OUT's character again, as photographed, from at most so many frames each time, and compares it at ten points
of every drawn face. The true colour is the median of what cameras see of the true surface in frames of the whole take, at the
point that is nearest in the first frame and of the same kind (body, garment). Columns, for each part:

hands, body, garment: all that is drawn; hidden: the part of it that no camera sees in the first frame

off     share of the colours that are off by more than 12 in a, b of Lab (where brightness is not)
ab, L   RMS difference in a, b and in L
detail  correlation of what is finer than a face's surroundings (in L): 1 = the same, 0 = nothing in common
sharp   RMS of that detail, over that of the truth
"""

from __future__ import annotations

import argparse
import io
import time
from pathlib import Path

import doublet as d
import numpy as np
from doublet.evaluation.truth import Truth
from doublet.reconstruct import Job
from PIL import Image

OFF = 12  # in a, b of Lab
TRUE_FRAMES = 16
ALONG = 4  # the grid of sample_colours() on a triangle
GRID = np.array([(i, k, ALONG - 1 - i - k) for i in range(ALONG) for k in range(ALONG - i)])
WEIGHTS = (GRID + 1 / 3) / ALONG  # (10, 3)
RGB_TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])  # sRGB, D65


def lab(rgb: np.ndarray) -> np.ndarray:
    """(N, 3) CIE 1976 L*a*b* of sRGB colours (N, 3), 0 to 255."""
    share = rgb / 255
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    ratio = linear @ RGB_TO_XYZ.T / RGB_TO_XYZ.sum(axis=1)
    x, y, z = np.where(ratio > (6 / 29) ** 3, np.cbrt(ratio), ratio / (3 * (6 / 29) ** 2) + 4 / 29).T
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=1)


def on_faces(corners: np.ndarray) -> np.ndarray:
    """(10 F, C) values at the grid of every face, of those at its corners (F, 3, C)."""
    return np.einsum("pk,fkc->fpc", WEIGHTS, corners).reshape(-1, corners.shape[-1])


class Film:
    """The images of a session, frame after frame, kept; and how long it took to read them."""

    def __init__(self, job: Job):
        self.source, self.silhouettes, self.rig = d.FrameSource.open(job.filmed), job.silhouettes, job.filmed.rig
        self.kept, self.seconds = {}, 0.0

    def __call__(self, frame: int) -> tuple[list, list]:
        if frame not in self.kept:
            start = time.perf_counter()
            views = [d.read_view(self.source, camera, frame, self.silhouettes) for camera in range(len(self.rig))]
            self.kept[frame] = [view.image for view in views], [view.mask for view in views]
            self.seconds += time.perf_counter() - start
        return self.kept[frame]


class TrueColours:
    """R G B of body and garment as they truly were, where a camera sees them in some frame."""

    def __init__(self, truth: Truth, frames: list[int], film: Film):
        self.vertices, self.faces, self.garment = truth.surface(frames[0])
        sampled = []
        for frame in frames:
            mesh = d.Mesh(truth.surface(frame)[0], self.faces)
            bgr = d.sample_colours(mesh, [1] * len(self.faces), film.rig, *film(frame))
            sampled.append(bgr[:, ::-1].astype(np.float32))
        self.seen = np.isfinite(sampled).all(axis=2).any(axis=0).reshape(len(self.faces), len(WEIGHTS))
        self.rgb = np.zeros((len(self.faces), len(WEIGHTS), 3))
        self.rgb[self.seen] = np.nanmedian(np.array(sampled)[:, self.seen.ravel()], axis=0)

    def at(self, points: np.ndarray, garment: bool) -> np.ndarray:
        """(N, 3) at the points (N, 3), of the garment or of the body."""
        kind = np.flatnonzero((self.garment == garment) & self.seen.any(axis=1))
        near, _, _ = d.RayScene(d.Mesh(self.vertices, self.faces[kind])).closest(points)
        faces = kind[near]
        places = on_faces(self.vertices[self.faces[faces]]).reshape(len(points), len(WEIGHTS), 3)
        away = np.where(self.seen[faces], np.linalg.norm(places - points[:, None], axis=2), np.inf)
        return self.rgb[faces, away.argmin(axis=1)]


def parts_of(character: d.Character) -> dict[str, np.ndarray]:
    """Which drawn faces of M_high are of the hands, of the rest of the body that the scan has, and of the garment."""
    display, faces, drawn = d.DisplaySurface(character), character.high.faces, np.asarray(character.high_valid, bool)
    drawn = drawn & ~np.asarray(d.hidden_faces(character), bool)
    joints = np.array(character.actor.skeleton.joint_names)[display.sample(character.actor.weights).argmax(axis=1)]
    hand = np.char.find(np.char.lower(joints), "wrist")[faces].max(axis=1) >= 0
    cloth = np.asarray(character.segmentation.clothness, float)[:, None]
    garment = display.sample(cloth)[faces].mean(axis=(1, 2)) > 0.5
    if character.garment_subdivisions >= 0:
        used = np.asarray(character.segmentation.region)[character.actor.mesh.faces].min(axis=1) >= 0
        garment = np.arange(len(faces)) >= len(faces) - 4**character.garment_subdivisions * used.sum()
    return {"hands": drawn & hand & ~garment, "body": drawn & ~hand & ~garment, "garment": drawn & garment}


def hidden_at_first(parts: dict[str, np.ndarray], character: d.Character, performance, film: Film) -> dict[str, np.ndarray]:
    """Which of their faces no camera sees the middle of in the first frame."""
    posed = d.Mesh(d.DisplaySurface(character).apply(performance.surface.frames[0]), character.high.faces)
    colours = d.sample_colours(posed, character.high_valid, film.rig, *film(int(performance.frames[0])))
    hidden = np.isnan(colours).any(axis=1).reshape(-1, len(WEIGHTS)).mean(axis=1) > 0.5
    return {f"{name}, hidden": faces & hidden for name, faces in parts.items() if name != "hands"}


def textured(character: d.Character) -> np.ndarray:
    """(10 FH, 3) R G B of the texture at the grid of every face of M_high."""
    image = np.asarray(Image.open(io.BytesIO(character.texture)).convert("RGB"), float)
    places = on_faces(np.asarray(character.texcoords).reshape(-1, 3, 2))
    columns, rows = (places * [image.shape[1], image.shape[0]]).astype(int).T
    return image[rows, columns]


def detail(lightness: np.ndarray, faces: np.ndarray, vertex_count: int) -> np.ndarray:
    """(10 F) L without the mean of the faces around the corners."""
    means = lightness.reshape(len(faces), -1).mean(axis=1)
    count = np.bincount(faces.ravel(), minlength=vertex_count)
    around = np.bincount(faces.ravel(), np.repeat(means, 3), vertex_count) / np.maximum(count, 1)
    return lightness - on_faces(around[faces][:, :, None])[:, 0]


class Comparison:
    """A character's texture against the truth."""

    def __init__(self, job: Job, truth: Truth, character: d.Character):
        self.character, self.mesh = character, character.high
        self.performance, film = job.results.dressed_performance(), Film(job)
        shared = sorted(set(self.performance.frames.tolist()) & set(truth.chunks))
        chosen = [shared[i] for i in sorted({k * (len(shared) - 1) // (TRUE_FRAMES - 1) for k in range(TRUE_FRAMES)})]
        true = TrueColours(truth, chosen, film)
        self.parts = parts_of(character)
        posed = d.DisplaySurface(character).apply(self.performance.surface.frames[0])
        points = on_faces(posed[self.mesh.faces])
        self.expected = np.zeros((len(points), 3))
        for name, faces in self.parts.items():
            at = np.repeat(faces, len(WEIGHTS))
            self.expected[at] = lab(true.at(points[at], name == "garment"))
        self.used = np.logical_or.reduce(list(self.parts.values()))
        self.parts |= hidden_at_first(self.parts, character, self.performance, Film(job))

    def detail(self, colours: np.ndarray) -> np.ndarray:
        chosen = np.repeat(self.used, len(WEIGHTS))
        return detail(colours[chosen, 0], self.mesh.faces[self.used], len(self.mesh.vertices))

    def print_parts(self) -> None:
        found = lab(textured(self.character))
        found_detail, true_detail = self.detail(found), self.detail(self.expected)
        for name, faces in self.parts.items():
            at, among = np.repeat(faces, len(WEIGHTS)), np.repeat(faces[self.used], len(WEIGHTS))
            difference = found[at] - self.expected[at]
            ab = np.linalg.norm(difference[:, 1:], axis=1)
            mine, theirs = found_detail[among], true_detail[among]
            alike = (mine * theirs).mean() / np.sqrt((mine**2).mean() * (theirs**2).mean())
            print(
                f"  {name:15} off {(ab > OFF).mean():6.2%}  ab {np.sqrt((ab**2).mean()):5.2f}"
                f"  L {np.sqrt((difference[:, 0] ** 2).mean()):5.2f}  detail {alike:.3f}"
                f"  sharp {np.sqrt((mine**2).mean() / (theirs**2).mean()):.2f}",
                flush=True,
            )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("session", type=Path)
    parser.add_argument("--frames", type=int, nargs="+", default=[1, d.TextureOptions().frames])
    parser.add_argument("--label-margin", type=float, default=d.TextureOptions().label_margin, help="m")
    parser.add_argument("--write", type=Path, help="folder for the characters, with albedo")
    options = parser.parse_args()
    job, character = Job(options.session, options.out), d.Character.read(options.out / "character.glb")
    comparison = Comparison(job, Truth(options.session / "ground_truth"), character)
    surfaces, numbers = comparison.performance.surface.frames, comparison.performance.frames.tolist()
    for frames in options.frames:
        film, start = Film(job), time.perf_counter()
        baking = d.TextureOptions(albedo=False, label_margin=options.label_margin, frames=frames)
        d.texture_character_from_take(character, surfaces, film.rig, lambda row, film=film: film(numbers[row]), baking)
        seconds = time.perf_counter() - start - film.seconds
        print(f"{frames} frames: {seconds:.1f} s and {film.seconds:.1f} s for their images")
        comparison.print_parts()
        if options.write:
            baking.albedo = True
            d.texture_character_from_take(character, surfaces, film.rig, lambda row, film=film: film(numbers[row]), baking)
            character.write(options.write / f"{options.out.name}-{frames}.glb")


if __name__ == "__main__":
    main()
