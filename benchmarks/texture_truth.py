"""How often a character's texture has another colour than the actor, by part of the body (docs/animation.md).

python benchmarks/texture_truth.py OUT SESSION [--label-margin 0 0.05]

Bakes the texture of OUT's character again, as photographed, with each label_margin, and prints the share of its colours, at ten
points of every drawn face, that are off by more than 12 in a, b of Lab (where brightness is not). The true colour is what cameras
see of the true surface, at the nearest point of the same kind (body, garment) that one of them sees.
"""

from __future__ import annotations

import argparse
import io
import time
from pathlib import Path

import doublet as d
import numpy as np
from doublet.evaluation.metrics import Truth
from doublet.reconstruct import Job
from PIL import Image

OFF = 12  # in a, b of Lab
ALONG = 4  # the grid of sample_colours() on a triangle
GRID = np.array([(i, k, ALONG - 1 - i - k) for i in range(ALONG) for k in range(ALONG - i)])
WEIGHTS = (GRID + 1 / 3) / ALONG  # (10, 3)
RGB_TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])  # sRGB, D65


def lab_ab(rgb: np.ndarray) -> np.ndarray:
    """(N, 2) a and b of CIE 1976 L*a*b* of sRGB colours (N, 3), 0 to 255."""
    share = rgb / 255
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    ratio = linear @ RGB_TO_XYZ.T / RGB_TO_XYZ.sum(axis=1)
    x, y, z = np.where(ratio > (6 / 29) ** 3, np.cbrt(ratio), ratio / (3 * (6 / 29) ** 2) + 4 / 29).T
    return np.stack([500 * (x - y), 200 * (y - z)], axis=1)


def on_faces(corners: np.ndarray) -> np.ndarray:
    """(10 F, C) values at the grid of every face, of those at its corners (F, 3, C)."""
    return np.einsum("pk,fkc->fpc", WEIGHTS, corners).reshape(-1, corners.shape[-1])


class TrueColours:
    """R G B of body and garment as they truly were in a frame, where a camera sees them."""

    def __init__(self, truth: Truth, frame: int, cameras, images, masks):
        self.vertices, self.faces, self.garment = truth.surface(frame)
        mesh = d.Mesh(self.vertices, self.faces)
        bgr = d.sample_colours(mesh, [1] * len(self.faces), cameras, images, masks)
        self.rgb = bgr[:, ::-1].reshape(len(self.faces), len(WEIGHTS), 3)
        self.seen = np.isfinite(self.rgb).all(axis=2)

    def at(self, points: np.ndarray, garment: bool) -> np.ndarray:
        """(N, 3) at the points (N, 3), of the garment or of the body."""
        kind = np.flatnonzero((self.garment == garment) & self.seen.any(axis=1))
        near, _, _ = d.RayScene(d.Mesh(self.vertices, self.faces[kind])).closest(points)
        faces = kind[near]
        places = on_faces(self.vertices[self.faces[faces]]).reshape(len(points), len(WEIGHTS), 3)
        away = np.where(self.seen[faces], np.linalg.norm(places - points[:, None], axis=2), np.inf)
        return self.rgb[faces, away.argmin(axis=1)]


def parts_of(character: d.Character) -> dict[str, np.ndarray]:
    """Which drawn faces of M_high are of the hands, of the rest of the body, and of the garment."""
    display, faces, drawn = d.DisplaySurface(character), character.high.faces, np.asarray(character.high_valid, bool)
    joints = np.array(character.actor.skeleton.joint_names)[display.sample(character.actor.weights).argmax(axis=1)]
    hand = np.char.find(np.char.lower(joints), "wrist")[faces].max(axis=1) >= 0
    cloth = np.asarray(character.segmentation.clothness, float)[:, None]
    garment = display.sample(cloth)[faces].mean(axis=(1, 2)) > 0.5
    if character.garment_subdivisions >= 0:
        used = np.asarray(character.segmentation.region)[character.actor.mesh.faces].min(axis=1) >= 0
        garment = np.arange(len(faces)) >= len(faces) - 4**character.garment_subdivisions * used.sum()
    return {"hands": drawn & hand & ~garment, "body": drawn & ~hand & ~garment, "garment": drawn & garment}


def textured(character: d.Character) -> np.ndarray:
    """(10 FH, 3) R G B of the texture at the grid of every face of M_high."""
    image = np.asarray(Image.open(io.BytesIO(character.texture)).convert("RGB"), float)
    places = on_faces(np.asarray(character.texcoords).reshape(-1, 3, 2))
    columns, rows = (places * [image.shape[1], image.shape[0]]).astype(int).T
    return image[rows, columns]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("session", type=Path)
    parser.add_argument("--label-margin", type=float, nargs="+", default=[0.0, d.TextureOptions().label_margin], help="m")
    options = parser.parse_args()
    job, truth = Job(options.session, options.out), Truth(options.session / "ground_truth")
    performance, character = job.results.dressed_performance(), d.Character.read(options.out / "character.glb")
    frame, surface = performance.frames[0], performance.surface.frames[0]
    views = d.read_views(job.filmed, frame, job.silhouettes)
    images, masks = views.images, views.masks
    true = TrueColours(truth, frame, job.filmed.rig, images, masks)
    parts, points = parts_of(character), on_faces(d.DisplaySurface(character).apply(surface)[character.high.faces])
    true_ab = {}
    for name, faces in parts.items():
        chosen = np.repeat(faces, len(WEIGHTS))
        true_ab[name] = chosen, lab_ab(true.at(points[chosen], name == "garment"))
    for margin in options.label_margin:
        baking, start = d.TextureOptions(albedo=False, label_margin=margin), time.perf_counter()
        d.texture_character(character, surface, job.filmed.rig, images, masks, baking)
        print(f"label_margin {margin:g} m, {time.perf_counter() - start:.1f} s:", end="")
        found = lab_ab(textured(character))
        for name, (chosen, expected) in true_ab.items():
            off = np.linalg.norm(found[chosen] - expected, axis=1) > OFF
            print(f"  {name} {off.mean():.2%} of {len(off)}", end="")
        print()


if __name__ == "__main__":
    main()
