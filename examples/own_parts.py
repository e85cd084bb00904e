"""A capture with two of its pieces written in NumPy: silhouettes by the difference to a clean plate, features without OpenCV.
Any piece can be replaced like this (docs/capture-tracking.md); here they follow a figure that this program draws itself."""

import doublet as d
import numpy as np


class PlateDifference(d.SilhouetteExtractor):
    """What differs from the empty stage is the actor."""

    def __init__(self, threshold=30):
        super().__init__()
        self.threshold, self.plates = threshold, {}

    def train(self, camera, images):
        self.plates[camera] = np.median(images, axis=0)

    def extract(self, camera, image):
        difference = np.abs(image - self.plates[camera]).max(axis=2)
        return np.where(difference > self.threshold, 255, 0).astype(np.uint8)


class PatchTracker(d.FeatureTracker):
    """Corners (Harris & Stephens 1988) described by the 9 x 9 pixels around them."""

    def detect(self, image, mask):
        grey = image.mean(axis=2)
        gy, gx = np.gradient(grey)
        a, b, c = (self.blur(v) for v in (gx * gx, gx * gy, gy * gy))
        corner = np.where(self.blur(mask / 255.0) > 0.999, a * c - b * b - 0.05 * (a + c) ** 2, 0)
        shifts = [(y, x) for y in (-2, 0, 2) for x in (-2, 0, 2) if (y, x) != (0, 0)]
        peak = np.all([corner > np.roll(corner, shift, (0, 1)) for shift in shifts], axis=0) & (corner > 100)
        points = np.argwhere(peak)  # (N, 2) row, column
        points = points[np.argsort(-corner[peak], kind="stable")][:300]
        around = np.mgrid[-4:5, -4:5].reshape(2, -1)
        rows, columns = points[:, :1] + around[0], points[:, 1:] + around[1]
        patches = grey[rows.clip(0, len(grey) - 1), columns.clip(0, grey.shape[1] - 1)]
        patches = patches - patches.mean(axis=1, keepdims=True)
        return d.Features(points[:, ::-1], patches / (np.linalg.norm(patches, axis=1, keepdims=True) + 1e-9))

    def match(self, previous, current, reach):
        if min(len(previous.points), len(current.points)) < 2:
            return []
        apart = np.linalg.norm(previous.points[:, None] - current.points, axis=2)
        distance = np.linalg.norm(previous.descriptors[:, None] - current.descriptors, axis=2) + 9.0 * (apart > reach)
        forward, backward = distance.argmin(axis=1), distance.argmin(axis=0)
        i = np.arange(len(forward))
        good = (backward[forward] == i) & (distance[i, forward] < 0.6)
        return np.stack([i[good], forward[good]], axis=1)

    @staticmethod
    def blur(values, radius=4):
        for axis in (0, 1):
            values = np.mean([np.roll(values, s, axis) for s in range(-radius, radius + 1)], axis=0)
        return values


class DrawnStage(d.FrameSource):
    """The figure's surfaces, face by face in a grey of its own, before a wall."""

    def __init__(self, actor, rig, surfaces):
        super().__init__()
        self.actor, self.rig, self.surfaces = actor, rig, surfaces
        self.greys = np.random.default_rng(1).integers(0, 256, len(actor.mesh.faces)).astype(np.uint8)
        self.wall = np.uint8(150) + np.random.default_rng(2).integers(0, 8, (rig[0].height, rig[0].width, 3)).astype(np.uint8)

    @property
    def frame_count(self):
        return len(self.surfaces)

    @property
    def camera_count(self):
        return len(self.rig)

    def image(self, camera, frame):
        face, _ = d.rasterize(self.surfaces[frame], self.actor.mesh.faces, self.rig[camera])
        drawn = self.wall.copy()
        drawn[face >= 0] = self.greys[face[face >= 0], None] // 2 + np.array([0, 20, 120], np.uint8)
        return drawn

    def mask(self, camera, frame):
        return np.zeros((0, 0), np.uint8)  # none: the extractor makes them


def two_limbs():
    """A closed, slightly flat column 1.6 m high that bends at the middle."""
    around, rows = 32, 48
    turn, y = np.meshgrid(np.linspace(0, 2 * np.pi, around, endpoint=False), np.linspace(0, 1.6, rows))
    taper = np.sqrt(np.maximum(0.02, 1 - np.abs(y / 0.8 - 1) ** 6))
    side = np.stack([taper * (0.2 + 0.05 * np.sin(7 * y)) * np.sin(turn), y, 0.1 * taper * np.cos(turn)], axis=2).reshape(-1, 3)
    vertices = np.vstack([side, [[0, -0.01, 0], [0, 1.61, 0]]])
    here = np.arange(rows - 1)[:, None] * around + np.arange(around)
    ahead = np.arange(rows - 1)[:, None] * around + (np.arange(around) + 1) % around
    i, j = here.ravel(), ahead.ravel()
    a, b, top, n = np.arange(around), (np.arange(around) + 1) % around, (rows - 1) * around, len(side)
    caps = [np.stack([np.full(around, n), b, a], 1), np.stack([np.full(around, n + 1), top + a, top + b], 1)]
    faces = np.vstack([np.stack([i, j, i + around], 1), np.stack([j, j + around, i + around], 1), *caps]).astype(np.int32)
    skeleton = d.Skeleton([d.JointAnnotation("low", "", [0, 0.4, 0], 6), d.JointAnnotation("high", "low", [0, 0.9, 0], 3)])
    up = np.clip((vertices[:, 1] - 0.8) / 0.2, 0, 1)
    return d.RiggedMesh(d.Mesh(vertices, faces), np.ones(len(faces), np.uint8), np.stack([1 - up, up], 1), skeleton)


def ring(count=6, size=240):
    return [d.orbit_camera([0, 0.8, 0], 1.1, 2 * np.pi * c / count, 0.15, size, size) for c in range(count)]


def main(frames=8):
    actor, rig = two_limbs(), ring()
    truth = 0.35 * np.sin(0.15 * np.arange(frames)[:, None] * np.ones(len(actor.skeleton.dof_names)))
    truth[:, :3] *= 0.3  # m
    stage = DrawnStage(actor, rig, [d.pose_surface(actor, dofs) for dofs in truth])
    extractor = PlateDifference()
    for c in range(len(rig)):
        extractor.train(c, [stage.wall])
    capture = d.PerformanceCapture.create(d.CaptureOptions(), d.CaptureParts(features=PatchTracker()))
    result = capture.capture(actor, rig, stage, extractor)
    joints = np.array([actor.skeleton.joint_positions(dofs) for dofs in truth])
    error = np.linalg.norm(result.performance.joints - joints, axis=2).mean()
    matches = sum(len(view.matches) for views in result.observations.views for view in views)
    print(f"{frames} frames, {matches} feature matches, joints off by {1000 * error:.1f} mm")
    return error, matches


if __name__ == "__main__":
    error, matches = main()
