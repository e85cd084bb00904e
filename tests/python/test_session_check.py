"""Nonsense is found before anything runs: a made-up person filmed by four cameras, one thing wrong at a time."""

from types import SimpleNamespace

import doublet as d
import numpy as np
import pytest
from doublet.session import check as session_check
from PIL import Image

SIZE, CAMERAS = 160, 4
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


def ring(vertices) -> list[d.Camera]:
    cameras = []
    for c in range(CAMERAS):
        centre = np.array([0, 0.9, 0])
        camera = d.orbit_camera(centre, 1.1, 2 * np.pi * (c + 0.2) / CAMERAS, 0.2, SIZE, SIZE)
        camera.name = f"cam{c}"
        cameras.append(camera)
    return cameras


class Filmed(d.FrameSource):
    def __init__(self, masks):
        super().__init__()
        self.masks = masks  # [camera], or {(camera, frame): mask}

    @property
    def frame_count(self):
        return 20

    @property
    def camera_count(self):
        return CAMERAS

    def image(self, camera, frame):
        return np.zeros((0, 0, 3), np.uint8)

    def mask(self, camera, frame):
        return self.masks(camera, frame)


class Scene:
    """Everything right; a test spoils one thing."""

    def __init__(self, folder):
        self.folder, self.scan = folder, person()
        self.rig = ring(self.scan.vertices)
        shadows = [d.rasterize(self.scan.vertices, self.scan.faces, camera)[0] >= 0 for camera in self.rig]
        self.masks = [(255 * shadow).astype(np.uint8) for shadow in shadows]
        self.joints = {name: np.array(place, float) for name, place in JOINTS.items()}
        self.rates = [40.0] * CAMERAS
        self.mask_of = lambda camera, frame: self.masks[camera]

    def evidence(self) -> session_check.Evidence:
        path = self.folder / "scan.ply"
        d.write_mesh(path, self.scan)
        cameras = [
            SimpleNamespace(name=c.name, masks=self.folder / "masks", video_fps=fps) for c, fps in zip(self.rig, self.rates)
        ]
        marks = [d.JointAnnotation(name, "", place) for name, place in self.joints.items()]
        session = SimpleNamespace(
            folder=self.folder, name="made up", scan=path, rig=self.rig, cameras=cameras, joints=marks, frame_count=20, fps=40.0
        )
        return session_check.Evidence(session, Filmed(lambda c, f: self.mask_of(c, f)), None)

    def findings(self):
        return session_check.check_session(self.evidence())


@pytest.fixture
def scene(tmp_path):
    return Scene(tmp_path)


def moved(scene, factor=1.0, turn=None):
    vertices = np.asarray(scene.scan.vertices) * factor
    scene.scan = d.Mesh(vertices if turn is None else vertices @ turn, scene.scan.faces)


def test_what_is_right_has_no_findings(scene):
    assert scene.findings() == []


def test_picture_shows_every_camera(scene):
    image = session_check.draw(scene.evidence())
    assert image.shape[1] == CAMERAS * session_check.CHECKED_SIZE
    assert ((image == (255, 0, 120)).all(axis=2)).sum() > 100  # the scan's outline
    assert ((image == (255, 220, 0)).all(axis=2)).sum() > 20 * CAMERAS  # joints


def impossible(scene) -> str:
    found = scene.findings()
    assert found and found[-1].impossible, found
    return found[-1].text


@pytest.mark.parametrize("factor, unit", [(1000, "millimetres"), (100, "centimetres"), (39.37, "inches")])
def test_scan_in_another_unit(scene, factor, unit):
    moved(scene, factor)
    assert "scan.ply" in impossible(scene) and unit in impossible(scene)


def test_scan_that_lies_down(scene):
    moved(scene, turn=np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]))
    assert "stands along y" in impossible(scene)


def test_joints_in_millimetres(scene):
    scene.joints = {name: 1000 * place for name, place in scene.joints.items()}
    assert "joints" in impossible(scene) and "millimetres" in impossible(scene)


def test_joints_half_a_metre_off(scene):
    scene.joints = {name: place + [0.5, 0, 0] for name, place in scene.joints.items()}
    assert "outside" in impossible(scene)


def test_one_joint_outside_is_only_doubtful(scene):
    scene.joints["l_hand"] = np.array([0.6, 1.38, 0.6])
    (finding,) = scene.findings()
    assert not finding.impossible and "l_hand" in finding.text


def test_calibration_in_millimetres(scene):
    for camera in scene.rig:
        camera.t = 1000 * np.ravel(camera.t)
    assert "calibration" in impossible(scene) and "millimetres" in impossible(scene)


def test_cameras_that_look_away(scene):
    for camera in scene.rig[1:]:
        camera.R = np.diag([-1.0, 1.0, -1.0]) @ camera.R
        camera.t = np.diag([-1.0, 1.0, -1.0]) @ np.ravel(camera.t)
    text = impossible(scene)
    assert "cam1, cam2, cam3" in text and "cam0" not in text


def test_swapped_cameras_are_named(scene):
    scene.masks[0], scene.masks[1] = scene.masks[1], scene.masks[0]
    text = impossible(scene)
    assert "cam0 and cam1" in text and "cam2" not in text


def test_mirrored_images(scene):
    scene.masks = [np.ascontiguousarray(mask[:, ::-1]) for mask in scene.masks]
    assert "mirrored" in impossible(scene)


def test_silhouettes_of_something_else(scene):
    scene.masks = [np.roll(mask, 60, axis=1) for mask in scene.masks]
    assert "overlap" in impossible(scene)


def test_one_camera_that_does_not_fit_is_doubtful(scene):
    scene.masks[2] = np.roll(scene.masks[2], 12, axis=0)
    (finding,) = scene.findings()
    assert not finding.impossible and "cam2" in finding.text and "cam1" not in finding.text


@pytest.mark.parametrize("value, wrong", [(0, "nothing"), (255, "the whole image")])
def test_masks_of_one_colour(scene, value, wrong):
    scene.masks[3] = np.full((SIZE, SIZE), value, np.uint8)
    text = impossible(scene)
    assert "cam3" in text and wrong in text


def test_half_of_the_masks_missing(scene):
    none = np.zeros((0, 0), np.uint8)
    scene.mask_of = lambda camera, frame: none if camera == 1 and frame > 4 else scene.masks[camera]
    assert "cam1" in impossible(scene) and "4 of the 5" in impossible(scene)


def test_a_person_who_walks_off_is_doubtful(scene):
    empty = np.zeros((SIZE, SIZE), np.uint8)
    scene.mask_of = lambda camera, frame: empty if camera == 1 and frame == 19 else scene.masks[camera]
    (finding,) = scene.findings()
    assert not finding.impossible and "cam1" in finding.text


def test_one_video_of_another_frame_rate(scene):
    scene.rates[2] = 30.0
    assert "cam2 30" in impossible(scene)


def test_a_rate_that_all_videos_share_is_doubtful(scene):
    scene.rates = [30.0] * CAMERAS
    (finding,) = scene.findings()
    assert not finding.impossible and "30" in finding.text and "40" in finding.text


def test_a_rate_that_no_container_states(scene):
    scene.rates = [0.0] * CAMERAS
    assert scene.findings() == []


def test_written_picture_is_complete(scene, tmp_path):
    session_check.write_picture(tmp_path / "check.png", session_check.draw(scene.evidence()))
    with Image.open(tmp_path / "check.png") as image:
        image.verify()
    assert [p.name for p in tmp_path.glob("*.png")] == ["check.png"]


def bent() -> d.Mesh:
    """The same person on one knee, both arms up: another silhouette in every camera."""
    vertices = np.array(person().vertices)
    arm = vertices[:, 0] > 0.2
    vertices[arm] = [0.15, 1.38, 0] + (vertices[arm] - [0.15, 1.38, 0]) @ np.array([[0, 1.0, 0], [-1, 0, 0], [0, 0, 1]])
    leg = (vertices[:, 1] < 0.85) & (vertices[:, 0] > 0)
    vertices[leg] = [0.1, 0.9, 0] + (vertices[leg] - [0.1, 0.9, 0]) @ np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    return d.Mesh(vertices, person().faces)


def take(scene, frames_of_scan, of=None):
    """Frames in which the person stands as in the scan, half a metre off; in all others as `of`, or bent."""
    there, other = np.asarray(person().vertices) + [0.4, 0, -0.3], of or bent()
    shadow = {}
    for stands, vertices in ((True, there), (False, other.vertices)):
        for c, camera in enumerate(scene.rig):
            shadow[stands, c] = (255 * (d.rasterize(vertices, other.faces, camera)[0] >= 0)).astype(np.uint8)
    scene.mask_of = lambda camera, frame: shadow[frame in frames_of_scan, camera]


def test_a_take_that_begins_in_another_pose_begins_where_it_is_the_scans(scene):
    take(scene, (12, 13))
    evidence = scene.evidence()
    assert session_check.check_session(evidence) == []
    words = session_check.describe_start(evidence)
    assert "frame 0 is not in the scan's pose" in words and "frame 12 is (" in words
    image = session_check.draw(evidence)  # of frame 12, with the scan where the person stands
    assert all(evidence.overlaps[c, c] > session_check.FITS for c in range(CAMERAS))
    assert (image == (255, 0, 120)).all(axis=2).sum() > 100


def test_a_take_that_begins_elsewhere_begins_there(scene):
    take(scene, range(20))
    evidence = scene.evidence()
    assert session_check.check_session(evidence) == []
    assert "elsewhere" in session_check.describe_start(evidence)


def test_a_take_that_is_never_in_the_scans_pose_is_doubtful(scene):
    take(scene, ())
    (finding,) = scene.findings()
    assert not finding.impossible and "the pose is searched there" in finding.text


def test_a_take_of_something_else_is_impossible(scene):
    take(scene, (), d.capsule_mesh((-0.9, 0.2, 0), (0.9, 0.2, 0), 0.1, 0.1))
    assert "do scan, calibration and time belong together" in impossible(scene)


def test_a_take_that_fits_is_not_searched(scene, monkeypatch):
    monkeypatch.setattr(session_check.Evidence, "find_start", None)
    assert scene.findings() == []
