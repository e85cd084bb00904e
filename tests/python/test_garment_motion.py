"""How a garment moves, on skirts whose motion is known."""

import doublet as d
import numpy as np
import pytest
from doublet.evaluation import metrics as e
from doublet.evaluation import motion_metrics as g

FPS, COUNT = 40.0, 120
TIMES = np.arange(COUNT) / FPS
MARKS = [("pelvis", "", 0), ("l_hip", "pelvis", 0.1), ("r_hip", "pelvis", -0.1), ("l_knee", "l_hip", 0.1)]


def yaw(times):
    """rad: turns to and fro, not periodically."""
    return 1.2 * np.sin(3.1 * times) + 0.5 * np.sin(7.3 * times + 1)


def turned(points, angles):
    """(T, N, 3) points (N, 3) turned about +Y; +Z goes to +X."""
    sin, cos = np.sin(angles)[:, None], np.cos(angles)[:, None]
    x, y, z = points.T
    return np.stack([cos * x + sin * z, np.broadcast_to(y, (len(angles), len(y))), cos * z - sin * x], axis=-1)


@pytest.fixture
def skirt(shapes):
    """Vertices and faces of a cone below a pelvis at the origin; the hem comes first."""
    return shapes["tube"](lambda h: 0.15 - 0.4 * h, -0.6, -0.1)


def test_hem_is_the_lowest_row_on_a_coarse_mesh_too(shapes):
    for around in (24, 50, 200):
        vertices, _ = shapes["tube"](lambda h: 0.15 - 0.4 * h, -0.6, -0.1, around=around)
        slanted = vertices + vertices[:, :1] * [0, 0.1, 0]
        turn = np.repeat(np.arange(24), around) * 0.037  # so that other rows have the directions that the lowest leaves free
        vertices = np.array([turned(v[None], [angle])[0, 0] for v, angle in zip(slanted, turn)])
        hem = g.hem_line(vertices + [3, 0, 2], np.array([3.0, 0, 2]))
        assert hem.max() < around and len(hem) == len(set(hem)) >= min(around, 60)


def test_lag_of_a_hem_two_frames_late(skirt):
    """Pelvis and skirt walk as well; the pelvis's turning is that of its hips."""
    walk = np.stack([1.3 * TIMES, 0.02 * np.sin(11 * TIMES), np.sin(TIMES)], axis=-1)
    hips = np.array([[0.1, -0.05, 0.0], [-0.1, -0.05, 0.0], [0, 0.1, -0.01]])
    pelvis = g.turning_rate(turned(hips, yaw(TIMES)) + walk[:, None], walk, FPS)
    assert pelvis == pytest.approx(np.diff(yaw(TIMES)) * FPS, abs=1e-9)
    for delay in (0, 2, 2.5, -3):
        late = turned(skirt[0], yaw(TIMES - delay / FPS)) + walk[:, None]
        seconds, correlation = g.lag(pelvis, g.turning_rate(late, walk, FPS), FPS)
        assert seconds == pytest.approx(delay / FPS, abs=0.05 / FPS) and correlation == pytest.approx(1, abs=0.01)


def test_lag_that_cannot_be_seen_is_missing():
    rate = np.diff(yaw(TIMES)) * FPS
    with pytest.raises(e.Missing, match=r"needs 81 frames \(2 s\), found 80"):
        g.lag(rate[:79], rate[:79], FPS)
    with pytest.raises(e.Missing, match="hardly turns"):
        g.lag(np.full(100, 3.0), rate[:100], FPS)
    with pytest.raises(e.Missing, match="no maximum within 0.5 s"):
        g.lag(*(np.exp(-(((TIMES - peak) / 0.3) ** 2)) for peak in (1.0, 1.7)), FPS)


def test_share_of_the_power_above_5_hz():
    """The second point rests, the first swings slowly along x and fast along y; velocities are differences of positions."""
    points = np.zeros((COUNT, 2, 3))
    points[:, 0, 0], points[:, 0, 1] = 0.10 * np.sin(2 * np.pi * 2 * TIMES), 0.02 * np.cos(2 * np.pi * 8 * TIMES)
    slow, fast = (a * np.sin(np.pi * f / FPS) for a, f in ((0.10, 2), (0.02, 8)))
    assert g.share_above(5, points, FPS) == pytest.approx(fast**2 / (fast**2 + slow**2), rel=0.01)
    assert g.share_above(9, points, FPS) < 1e-3 and g.share_above(1, points, FPS) > 0.999
    with pytest.raises(e.Missing, match="does not move"):
        g.share_above(5, points[:, 1:], FPS)
    with pytest.raises(e.Missing, match="10 frames a second do not show 5 Hz"):
        g.share_above(5, points, 10)


@pytest.mark.parametrize("around", [60, 150, 400])
def test_fold_depth_is_that_of_the_folds(around):
    """Size, place and oval are no folds; how many vertices there are hardly matters."""
    turn = np.linspace(0, 2 * np.pi, around, endpoint=False) + 0.01

    def hem(radius, at=(0, 0, 0)):
        return np.stack([radius * np.sin(turn), 0 * turn, radius * np.cos(turn)], axis=-1) + at

    pelvis = np.array([2.0, 1, -1])
    assert g.fold_depth(hem(0.4 + 0.02 * np.cos(8 * turn), pelvis), pelvis) == pytest.approx(0.02 / np.sqrt(2), rel=0.1)
    assert g.fold_depth(hem(0.4 + 0.02 * np.cos(2 * turn), pelvis + [0.01, 0.3, 0]), pelvis) < 4e-4


def test_speed_is_that_of_the_hem(skirt):
    """The skirt goes at 1 m/s, its upper rows at 3; in the last tenth of the frames all stand."""
    points = np.stack([skirt[0]] * 101)
    speed = np.where(skirt[0][:, 1] > -0.59, 3.0, 1.0)
    points[..., 0] += np.minimum(np.arange(101), 90)[:, None] / FPS * speed
    joints, frames = np.zeros((101, 1, 3)), list(range(101))
    values, _ = g.measure(frames, points, joints, frames, FPS)
    assert values["hem_speed_m_s"] == pytest.approx(0.9) and values["hem_speed_95_m_s"] == pytest.approx(1)


def write_scene(folder, skirt, true_frames, delay):
    """A truth in which all turns together, known in some frames, and a re-animation whose skirt turns `delay` frames late. The
    character is all cloth but its top row, which trembles."""
    vertices, faces = skirt
    marks = [d.JointAnnotation(name, parent, [x, 0, 0], None if parent else 6) for name, parent, x in MARKS]
    joints = turned(np.array([[x, 0, 0] for *_, x in MARKS]), yaw(TIMES))
    joints[:, 3] = turned(np.array([[0.3, 0, 0.3]]), 5 * np.sin(9 * TIMES))[:, 0]  # the knee does not hang on the pelvis
    np.savez(folder / "static.npz", body_tris=faces, cloth_tris=faces)
    true = turned(vertices, yaw(TIMES))[true_frames]
    np.savez(folder / "frames_0000.npz", frames=true_frames, body=true, cloth=true)
    np.savez(folder / "skeleton.npz", joint_names=[name for name, *_ in MARKS][::-1], joints=joints[:, ::-1])
    weights = np.zeros((len(vertices), len(MARKS)))
    weights[:, 0] = 1
    actor = d.RiggedMesh(d.Mesh(vertices, faces), [1] * len(faces), weights, d.Skeleton(marks))
    performance = d.ReferencePerformance()
    performance.surface = d.MeshSequence(faces, true[:1].repeat(COUNT, axis=0))
    performance.dofs = np.zeros((COUNT, len(actor.skeleton.dof_names)))
    performance.joints, performance.frames = joints, list(range(COUNT))
    cloth = (vertices[:, 1] < -0.11).astype(float)
    d.write_actor(folder / "actor.npz", actor)
    d.write_performance(folder / "performance.npz", performance)
    region = np.where(cloth > 0, 0, -1).astype(np.int32)
    d.write_segmentation(folder / "segmentation.npz", d.Segmentation(np.zeros_like(cloth), cloth, region))
    simulated = turned(vertices, yaw(TIMES - delay / FPS))
    simulated[:, cloth == 0, 1] += 0.05 * np.sin(2 * np.pi * 10 * TIMES)[:, None]
    np.savez(folder / "simulated.npz", vertices=simulated)
    return e.Reconstruction(folder), e.Truth(folder)


def test_truth_and_simulation_side_by_side(tmp_path, skirt):
    motion = g.compare(*write_scene(tmp_path, skirt, np.arange(COUNT), 2), FPS)
    assert motion["missing"] == {"truth": {}, "simulated": {}}
    assert motion["truth"]["hem_lag_s"] == pytest.approx(0, abs=1e-4)
    assert motion["simulated"]["hem_lag_s"] == pytest.approx(2 / FPS, abs=1e-3)
    for name in ("hem_speed_m_s", "hem_speed_95_m_s"):
        assert motion["truth"][name] == pytest.approx(motion["simulated"][name], rel=0.05)
    turning = np.abs(np.diff(yaw(TIMES))) * FPS * 0.39  # the hem's radius
    assert motion["truth"]["hem_speed_m_s"] == pytest.approx(turning.mean(), rel=0.01)
    assert max(motion[who]["power_above_5hz"] for who in ("truth", "simulated")) < 1e-3
    text = g.format_table(motion)
    assert all(name in text for name in g.MEASURES) and "missing" not in text


def test_a_sparse_truth_lacks_what_needs_consecutive_frames(tmp_path, skirt):
    """The simulation has it all the same; folds are those of the frames that both have."""
    made, truth = write_scene(tmp_path, skirt, np.arange(8, COUNT, 4), 2)
    for frame, surface in made.reanimated.surfaces.items():  # folds in the frames that the truth lacks
        surface[:, 0] *= 1 + 0.3 * (frame % 4 > 0 or frame < 8) * np.cos(8 * np.arange(len(surface)))
    motion = g.compare(made, truth, FPS)
    assert set(motion["missing"]["truth"]) == set(g.MEASURES) - {"fold_depth_cm"} and not motion["missing"]["simulated"]
    assert "follow each other, but 12 comes after 8" in motion["missing"]["truth"]["hem_speed_m_s"]
    assert motion["truth"]["fold_depth_cm"] < 0.1 and motion["simulated"]["fold_depth_cm"] < 0.1
    assert "truth: needs frames" in g.format_table(motion)


def test_without_a_re_animation_all_is_missing(tmp_path, skirt):
    made, truth = write_scene(tmp_path, skirt, np.arange(COUNT), 0)
    (tmp_path / "simulated.npz").unlink()
    motion = g.compare(made, truth, FPS)
    assert not any(motion["truth"].values()) and "simulated.npz" in motion["missing"]["simulated"]["fold_depth_cm"]
