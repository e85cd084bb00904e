"""How cleanly a character's garment is drawn: its hem compared with the simulated one, and skin that comes through it.

python benchmarks/display_hem.py CHARACTER.glb MOTION [--seconds 4] [--every 8]

Through: whatever is drawn of the person, skin of the scan and hidden body alike, in front of the garment's outer side, with that
side less than 6 cm behind; cm^2 across the line of sight, in that of 8 views around which has most of it. That counts a waist
before a skirt that flares up behind it, too; within: only where the garment's outer side lies between the person's front and
back. Arms that hang before a skirt without touching it would count, too: of arms, only what is within (docs/animation.md).
"""

import argparse
from pathlib import Path

import doublet as d
import numpy as np

NEAR_HEM, THROUGH = 0.05, 0.06  # m
SEEN = 2  # cm^2, of what comes through
VIEWS, PIXELS, ELEVATION = 8, 400, 0.1
SMOOTHING, STEP = 0.02, 0.003  # m, of the curve that raggedness is measured to


def border(faces: np.ndarray) -> np.ndarray:
    """(E, 2) the directed edges that one face alone has."""
    edges = faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    _, back, count = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    return edges[count[back.ravel()] == 1]


def curves(edges: np.ndarray) -> list[list[int]]:
    """The directed edges, joined; a closed curve ends with its first vertex."""
    onward = {}
    for a, b in edges.tolist():
        onward.setdefault(a, []).append(b)
    ends = set(edges[:, 1].tolist())
    joined = []
    while onward:
        curve = [next((a for a in onward if a not in ends), next(iter(onward)))]
        while curve[-1] in onward and (len(curve) == 1 or curve[-1] != curve[0]):
            following = onward[curve[-1]]
            last = following.pop()
            if not following:
                del onward[curve[-1]]
            curve.append(last)
        joined.append(curve)
    return joined


def distance_to_edges(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(N) m from each point to the nearest of the segments a b."""
    along = b - a
    share = ((points[:, None] - a) * along).sum(-1) / np.maximum((along**2).sum(-1), 1e-18)
    return np.linalg.norm(points[:, None] - (a + np.clip(share, 0, 1)[..., None] * along), axis=-1).min(axis=1)


def squares_to_smoothing(points: np.ndarray) -> np.ndarray:
    """(n) m^2 from samples of a curve to its Gaussian smoothing; none for a curve that is shorter than that is wide."""
    closed = np.array_equal(points[0], points[-1])
    length = np.r_[0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    if length[-1] < 10 * SMOOTHING:
        return np.zeros(0)
    at = np.linspace(0, length[-1], int(length[-1] / STEP), endpoint=not closed)
    even = np.stack([np.interp(at, length, column) for column in points.T], axis=1)
    wide = int(4 * SMOOTHING / STEP)
    weights = np.exp(-0.5 * (np.arange(-wide, wide + 1) * STEP / SMOOTHING) ** 2)
    padded = np.pad(even, ((wide, wide), (0, 0)), mode="wrap" if closed else "edge")
    smooth = np.stack([np.convolve(column, weights / weights.sum(), "valid") for column in padded.T], axis=1)
    return ((even - smooth) ** 2).sum(axis=1)


class Drawn:
    """The garment as it is drawn: its faces and its hem on M_high, and the simulated hem on M."""

    def __init__(self, character: d.Character):
        self.character, actor = character, character.actor
        clothness, region = np.asarray(character.segmentation.clothness), np.asarray(character.segmentation.region)
        worn = actor.mesh.faces[(region[actor.mesh.faces] >= 0).all(axis=1)]
        rim = border(worn)
        free = (clothness[rim] > 0).any(axis=1)
        self.hem, seam = rim[free], rim[~free]
        self.faces = character.high.faces[np.asarray(character.high_valid, bool)]
        centres = character.high.vertices[self.faces].mean(axis=1)
        closest, _, _ = d.RayScene(actor.mesh, actor.face_valid).closest(centres)
        self.cloth = (region[actor.mesh.faces[closest]] >= 0).all(axis=1)
        if character.garment_subdivisions >= 0:
            self.cloth = np.arange(len(self.faces)) >= len(self.faces) - len(worn) * 4**character.garment_subdivisions
        self.find_person()
        rim = border(self.faces[self.cloth])
        middle = character.high.vertices[rim].mean(axis=1)

        def away(edges: np.ndarray) -> np.ndarray:
            return distance_to_edges(middle, *(actor.mesh.vertices[edges[:, k]] for k in (0, 1))) if len(edges) else np.inf

        self.drawn_hem = rim[(away(self.hem) < NEAR_HEM) & (away(self.hem) < away(seam))]

    def find_person(self) -> None:
        """Faces of the person, into the vertices of M_high and then the hidden body's, and which of them are of arms."""
        character, actor = self.character, self.character.actor
        skin = self.faces[~self.cloth]
        hidden = character.body.faces[np.asarray(character.body_shown, bool)]
        self.person = np.vstack([skin, hidden + len(character.high.vertices)]).astype(np.int32)
        joint = d.DisplaySurface(character).sample(actor.weights).argmax(axis=1)
        self.of_arms = np.zeros(len(self.person), bool)
        self.of_arms[: len(skin)] = arm_joints(actor.skeleton)[joint][skin].all(axis=1)

    def off_the_hem(self, frame: d.AnimationFrame) -> float:
        """RMS, m, from the drawn hem to the simulated one."""
        vertices = frame.high[np.unique(self.drawn_hem)]
        return np.sqrt((distance_to_edges(vertices, *(frame.surface[self.hem[:, k]] for k in (0, 1))) ** 2).mean())

    def ragged(self, frame: d.AnimationFrame) -> float:
        """RMS, m, from the drawn hem to its own smoothing."""
        return np.sqrt(np.concatenate([squares_to_smoothing(frame.high[c]) for c in curves(self.drawn_hem)]).mean())

    def through(self, frame: d.AnimationFrame) -> np.ndarray:
        """(VIEWS, 3) cm^2 that come through the garment, from places around: of the person without arms, arms, and of the first
        where the garment is within the person."""
        vertices, garment = np.vstack([frame.high, frame.body]), self.faces[self.cloth]
        normals, centres = d.face_normals(frame.high, garment), frame.high[garment].mean(axis=1)
        own_normals, own_centres = d.face_normals(vertices, self.person), vertices[self.person].mean(axis=1)
        areas = np.zeros((VIEWS, 3))
        for view, azimuth in enumerate(np.arange(VIEWS) * 2 * np.pi / VIEWS):
            camera = d.orbit_camera(frame.joints[0], 0.75, azimuth, ELEVATION, PIXELS, PIXELS)
            front, depth = d.rasterize(vertices, self.person, camera)
            behind, cloth_depth = d.rasterize(frame.high, garment, camera)
            eye = -camera.R.T @ np.ravel(camera.t)
            towards = ((eye - centres) * normals).sum(axis=1) > 0
            turned_away = ((eye - own_centres) * own_normals).sum(axis=1) < 0
            both = (front >= 0) & (behind >= 0) & towards[np.maximum(behind, 0)]
            before = np.where(both, cloth_depth, 0) - np.where(both, depth, 0)
            of_arm = self.of_arms[np.maximum(front, 0)]

            backs = [d.rasterize(vertices, self.person[limbs & turned_away], camera) for limbs in (self.of_arms, ~self.of_arms)]
            inside = [(before > 0) & (face >= 0) & (cloth_depth < back) for face, back in backs]
            near = (before > 0) & (before < THROUGH) & ~of_arm
            found = near, inside[0] & of_arm, near & inside[1]
            pixel_areas = 1e4 * (np.where(both, depth, 0) / camera.K[0, 0]) ** 2
            areas[view] = [pixel_areas[pixels].sum() for pixels in found]
        return areas


def worst_view(areas: np.ndarray) -> np.ndarray:
    """(frames, 3) cm^2 of Drawn.through() of frames (frames, VIEWS, 3)."""
    return np.asarray(areas).max(axis=1)


def arm_joints(skeleton: d.Skeleton) -> np.ndarray:
    """(J) the shoulders and what hangs on them."""
    names, parents = list(skeleton.joint_names), list(skeleton.joint_parents)
    arms = np.zeros(len(names), bool)
    for j, name in enumerate(names):
        arms[j] = "shoulder" in name or (parents[j] >= 0 and arms[parents[j]])
    return arms


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("character", type=Path, metavar="CHARACTER.glb")
    parser.add_argument("motion", type=Path, metavar="MOTION")
    parser.add_argument("--seconds", type=float, default=4)
    parser.add_argument("--every", type=int, default=8, help="frames between two that are measured")
    chosen = parser.parse_args()
    character = d.Character.read(chosen.character)
    drawn, off, ragged, through = Drawn(character), [], [], []
    retargeting = d.RetargetOptions(fps=1 / character.solver.dt, last_second=chosen.seconds)
    motion = d.retarget(d.SourceMotion.read(chosen.motion), character.actor.skeleton, retargeting)

    def measure(frame: d.AnimationFrame) -> None:
        if frame.index % chosen.every == 0:
            off.append(1000 * drawn.off_the_hem(frame))
            ragged.append(1000 * drawn.ragged(frame))
            through.append(drawn.through(frame))

    d.animate_each(character, motion, measure)
    print(f"drawn hem to simulated hem, RMS: frame 0 {off[0]:.2f} mm, mean {np.mean(off):.2f} mm")
    print(f"drawn hem to its own smoothing (20 mm), RMS: frame 0 {ragged[0]:.2f} mm, mean {np.mean(ragged):.2f} mm")
    for areas, what in zip(worst_view(through).T, ("person before the garment", "arms through it", "garment within the person")):
        print(
            f"{what}, worst of {VIEWS} views: over {SEEN} cm^2 in {(areas > SEEN).mean():.1%} of {len(areas)} frames, "
            f"mean {areas.mean():.2f}, most {areas.max():.1f} cm^2 (frame {chosen.every * areas.argmax()})"
        )


if __name__ == "__main__":
    main()
