"""Whether a session can be true, and the picture of it: a made-up person filmed by four cameras. The checks one by one are in
tests/capture/session_check_test.cpp."""

import json

import doublet as d
import numpy as np
import pytest
from doublet.session.check import check_and_draw, draw
from PIL import Image

SIZE, CAMERAS, FRAMES = 160, 4, 20
JOINTS = {
    "pelvis": (0, 1.0, 0),
    "head": (0, 1.6, 0),
    "l_knee": (0.1, 0.5, 0),
    "r_knee": (-0.1, 0.5, 0),
    "l_hand": (0.6, 1.38, 0.2),
}


def person() -> d.Mesh:
    """Trunk, head, two legs, and one arm out: no mirror shows the same."""
    parts = [
        ((0, 1.0, 0), (0, 1.4, 0), 0.16),
        ((0, 1.6, 0), (0, 1.62, 0), 0.11),
        ((0.1, 0.9, 0), (0.1, 0.1, 0), 0.08),
        ((-0.1, 0.9, 0), (-0.1, 0.1, 0), 0.08),
        ((0.15, 1.38, 0), (0.65, 1.38, 0.25), 0.06),
    ]
    vertices, faces = [], []
    for p0, p1, radius in parts:
        mesh = d.capsule_mesh(p0, p1, radius, radius)
        faces.append(mesh.faces + sum(map(len, vertices)))
        vertices.append(mesh.vertices)
    return d.Mesh(np.vstack(vertices), np.vstack(faces))


def ring() -> list[d.Camera]:
    cameras = []
    for c in range(CAMERAS):
        camera = d.orbit_camera(np.array([0, 0.9, 0]), 1.1, 2 * np.pi * (c + 0.2) / CAMERAS, 0.2, SIZE, SIZE)
        camera.name = f"cam{c}"
        cameras.append(camera)
    return cameras


def masks_of(vertices) -> list[np.ndarray]:
    shadows = [d.rasterize(vertices, person().faces, camera)[0] >= 0 for camera in ring()]
    return [(255 * shadow).astype(np.uint8) for shadow in shadows]


def write_session(folder, masks_at, scan=True):
    """masks_at: frame -> a mask a camera."""
    described = {"name": "made up", "fps": 40, "frame_count": FRAMES, "calibration": "calibration.yml"}
    described["cameras"] = [{"name": camera.name, "masks": f"{camera.name}_%02d.png"} for camera in ring()]
    for frame in range(FRAMES):
        for camera, mask in zip(ring(), masks_at(frame)):
            Image.fromarray(mask).save(folder / f"{camera.name}_{frame:02d}.png")
    d.write_calibration(folder / "calibration.yml", ring())
    if scan:
        described |= {"scan": "scan.ply", "markers": "joints.json"}
        d.write_mesh(folder / "scan.ply", person())
        joints = {name: {"position": place, "parent": "pelvis" if name != "pelvis" else None} for name, place in JOINTS.items()}
        (folder / "joints.json").write_text(json.dumps({"joints": joints}), encoding="utf-8")
    (folder / "session.json").write_text(json.dumps(described), encoding="utf-8")
    return d.Session(folder)


@pytest.fixture
def session(tmp_path):
    masks = masks_of(person().vertices)
    return write_session(tmp_path, lambda frame: masks)


def count_of(image, colour) -> int:
    return int((image == colour).all(axis=2).sum())


SCAN, SILHOUETTE, JOINT = (255, 0, 120), (0, 220, 60), (255, 220, 0)


def test_picture_shows_every_camera(session):
    frames = d.FrameSource.open(session)
    checked = d.check_session(session, frames)
    assert checked.findings == [] and checked.frame == 0 and checked.start is None
    assert np.allclose(np.diag(checked.overlaps), 1)
    image = draw(checked, frames)
    assert image.shape == (SIZE, CAMERAS * 500, 3)
    assert count_of(image, SCAN) > 100  # over the silhouette's, which is the same
    assert count_of(image, JOINT) > 20 * CAMERAS


def test_written_picture_is_complete(session, tmp_path):
    check_and_draw(session, d.FrameSource.open(session), None, tmp_path / "check.png")
    with Image.open(tmp_path / "check.png") as image:
        image.verify()
    assert [p.name for p in tmp_path.glob("check*")] == ["check.png"]


def test_a_take_that_begins_in_another_pose_is_drawn_where_it_is_the_scans(tmp_path):
    there = masks_of(np.asarray(person().vertices) + [0.4, 0, -0.3])
    upside_down = [np.ascontiguousarray(mask[::-1]) for mask in there]
    session = write_session(tmp_path, lambda frame: there if frame in (12, 13) else upside_down)
    frames = d.FrameSource.open(session)
    checked = d.check_session(session, frames)
    assert checked.findings == []
    assert checked.frame == checked.start.frame == 12
    assert "frame 0 is not in the scan's pose" in checked.start_text and "frame 12 is (" in checked.start_text
    assert np.abs(checked.joints[0] - session.joints[0].position - [0.4, 0, -0.3]).max() < 0.03
    assert all(np.array_equal(shown, mask) for shown, mask in zip(checked.silhouettes, there))
    image = draw(checked, frames)
    assert count_of(image, SCAN) > 100 and count_of(image, SILHOUETTE) < 20  # one lies over the other


def test_without_a_scan_silhouettes_are_drawn(tmp_path):
    masks = masks_of(person().vertices)
    session = write_session(tmp_path, lambda frame: masks, scan=False)
    frames = d.FrameSource.open(session)
    checked = d.check_session(session, frames)
    assert checked.findings == [] and checked.shadows == [] and checked.overlaps.size == 0
    image = draw(checked, frames)
    assert count_of(image, SILHOUETTE) > 100 and count_of(image, SCAN) == count_of(image, JOINT) == 0


class Broken(d.FrameSource):
    """Cameras 0 and 1 are swapped; camera 3 may fail."""

    def __init__(self, frames, fails=False):
        super().__init__()
        self.frames, self.fails = frames, fails

    @property
    def frame_count(self):
        return self.frames.frame_count

    @property
    def camera_count(self):
        return self.frames.camera_count

    def image(self, camera, frame):
        return np.zeros((0, 0, 3), np.uint8)

    def mask(self, camera, frame):
        if self.fails and camera == 3:
            raise KeyError("no camera 3")
        return self.frames.mask({0: 1, 1: 0}.get(camera, camera), frame)


def test_frames_of_ones_own_are_checked(session):
    frames = d.FrameSource.open(session)
    (finding,) = d.check_session(session, Broken(frames)).findings
    assert finding.impossible and finding.level == "impossible" and finding.kind == ""
    assert "cam0 and cam1 look swapped" in finding.text and repr(finding) == f"impossible: {finding.text}"
    with pytest.raises(KeyError, match="no camera 3"):
        d.check_session(session, Broken(frames, fails=True))
