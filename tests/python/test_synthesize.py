"""A character rendered back into cameras is a session like any other, and its truth is the character's."""

import shutil

import doublet as d
import numpy as np
import pytest
from doublet.common.console import Console
from doublet.evaluation.metrics import Truth
from doublet.evaluation.synthesize import Surfaces, SynthesisOptions, photograph, ring_of_cameras, synthesize
from doublet.export.clips import read_motion
from doublet.reconstruct.options import with_pairs

MARKS = [d.JointAnnotation("pelvis", "", [0, 1, 0], 6), d.JointAnnotation("spine", "pelvis", [0, 1.2, 0], 3)]
FPS = 40.0
QUIET = Console(quiet=True)


@pytest.fixture(scope="module")
def character(shapes):
    """A striding bell: its lower half is cloth."""
    vertices, faces = shapes["tube"](lambda h: 0.35 - 0.15 * h, 0.5, 1.5)
    skeleton = d.Skeleton(MARKS)
    weights = np.zeros((len(vertices), 2))
    weights[:, 0] = 1
    actor = d.RiggedMesh(d.Mesh(vertices, faces), [1] * len(faces), weights, skeleton)
    cloth = (vertices[:, 1] < 1).astype(float)
    clothness = d.Segmentation(np.zeros_like(cloth), cloth, np.where(cloth > 0, 0, -1).astype(np.int32))
    return d.make_character(actor, clothness, d.BodyFit(), [], [d.Material(k_stretch=1.0)], d.SolverSettings(1 / FPS))


@pytest.fixture(scope="module")
def motion(character):
    dofs = np.zeros((14, len(character.actor.skeleton.dof_names)))
    dofs[:, 0] = np.linspace(0, 0.3, 14)
    return d.Motion(FPS, dofs)


@pytest.fixture(scope="module")
def made(character, motion, tmp_path_factory):
    out = tmp_path_factory.mktemp("synthesized") / "session"
    options = SynthesisOptions(camera_count=3, image_size=160, mask_step=4)
    assert synthesize(character, motion, out, options, console=QUIET) == 14
    return out


def test_it_is_a_session(made):
    session = d.Session(made)
    assert (len(session.cameras), session.frame_count, session.fps) == (3, 14, FPS)
    assert {j.name: j.dof for j in session.joints} == {"pelvis": 6, "spine": 3}
    assert np.linalg.norm(session.joints[0].position - [0, 1, 0]) < 0.02


def test_a_garment_of_its_own_is_the_garment(character):
    """Not the skin that it stands for, which is in the same place."""
    actor, clothness = character.actor, character.segmentation
    garment = d.mesh_garment(actor, clothness, d.Mesh(), d.MeshSequence(), d.GarmentOptions(vertices=300))
    dressed = d.dress(actor, clothness, garment)
    worn = d.make_character(dressed.actor, dressed.segmentation, d.BodyFit(), [], character.materials, character.solver)
    faces, height = actor.mesh.faces, actor.mesh.vertices[actor.mesh.faces].mean(axis=1)[:, 1]
    found = Surfaces.garment_faces(worn, actor.mesh.vertices, faces)
    inside = (height > 0.6) & (height < 0.9)
    assert found[inside].all() and not found[height > 1.1].any()


def test_the_images_show_the_truth(made):
    """Keyed silhouettes against the true masks."""
    session, source = d.Session(made), d.FrameSource.open(d.Session(made))
    extractor = d.SilhouetteExtractor.create(d.ChromaKeyOptions())
    names = [camera.name for camera in session.rig]
    masks = Truth(made / "ground_truth").masks()
    assert len(masks) == 3 * 4
    for c in range(3):
        extractor.train(c, [source.image(c, 0)])
    for name, frame, path in masks:
        from PIL import Image

        truth = np.asarray(Image.open(path))
        assert set(np.unique(truth)) == {0, 128, 255}
        keyed = extractor.extract(names.index(name), source.image(names.index(name), frame)) > 0
        assert (keyed & (truth > 0)).sum() / (keyed | (truth > 0)).sum() > 0.93


def test_truth_and_scan_agree(made):
    truth = Truth(made / "ground_truth")
    names, joints = truth.joints()
    assert names == ["pelvis", "spine"] and len(joints) == 14
    np.testing.assert_allclose(joints[13][0] - joints[0][0], [0.3, 0, 0], atol=1e-6)
    vertices, faces, garment = truth.surface(0)
    low = vertices[faces].mean(axis=1)[:, 1] < 1
    assert (garment == low).mean() > 0.95  # a row of faces is half and half
    scan = d.read_mesh(made / "scan.ply")
    distance = d.distances_to_surface(scan.vertices, d.Mesh(vertices, faces))
    assert 0.0001 < distance.mean() < 0.0006  # mean |N(0, 0.4 mm)| is 0.32 mm
    assert len(scan.faces) == 4 * len(faces)


def test_calibration_survives_the_file(made, character, motion, tmp_path):
    rig = ring_of_cameras(character, motion, 3, 160)
    for camera, read in zip(rig, d.Session(made).rig):
        assert camera.name == read.name and camera.width == read.width
        for field in ("K", "R", "t", "distortion"):
            np.testing.assert_array_equal(getattr(camera, field), getattr(read, field))
    d.write_calibration(tmp_path / "again.yml", rig)
    assert (tmp_path / "again.yml").read_text() == (made / "calibration.yml").read_text()


def test_noise_and_blur_are_as_asked(character):
    rest = np.asarray(character.actor.mesh.vertices)
    renderer, camera = d.CharacterRenderer(character), ring_of_cameras(character, d.Motion(FPS, np.zeros((1, 9))), 2, 200)[0]
    render = d.RenderOptions(background=(0.4, 0.5, 0.6), floor=False)

    class Frame:
        surface, high, body = rest, np.zeros((0, 3)), np.zeros((0, 3))

    plain, noisy, blurred = (
        photograph(renderer, Frame, camera, SynthesisOptions(**o), render, 1).astype(float)
        for o in ({}, {"noise": 3.0}, {"blur": 2.0})
    )
    assert 2.8 < (noisy - plain).std() < 3.2 and abs((noisy - plain).mean()) < 0.1
    edges = [np.abs(np.diff(picture, axis=1)).max() for picture in (plain, blurred)]
    assert edges[1] < 0.4 * edges[0]


def test_a_run_that_was_stopped_leaves_no_truth_to_the_next(made, character, motion, tmp_path):
    """Its frames and masks are of another motion."""
    shutil.copytree(made, tmp_path / "again")
    (tmp_path / "again" / "session.json").unlink()  # written last
    short = d.Motion(FPS, motion.dofs[::-1][:6])
    synthesize(character, short, tmp_path / "again", SynthesisOptions(camera_count=2, image_size=96, mask_step=5), console=QUIET)
    truth = Truth(tmp_path / "again" / "ground_truth")
    assert sorted(truth.chunks) == list(range(6))
    assert [mask[:2] for mask in truth.masks()] == [("cam0", 0), ("cam0", 5), ("cam1", 0), ("cam1", 5)]


def test_poses_of_an_animation_have_their_rate(character, motion, tmp_path):
    """Those of a performance have that of the character."""
    d.write_baked_npz(tmp_path / "own.npz", character, d.animate(character, motion))
    np.savez(tmp_path / "performance.npz", dofs=motion.dofs)
    slow = d.Character.read(written(character, tmp_path / "c.glb"))
    slow.solver = d.SolverSettings(2 / FPS)
    for name, wanted, fps, count in (
        ("own", 0, 40, 14),
        ("own", 20, 20, 7),
        ("performance", 0, 20, 14),
        ("performance", 30, 30, 14),
    ):
        read = read_motion(tmp_path / f"{name}.npz", slow, d.RetargetOptions(fps=wanted))
        assert (read.fps, len(read)) == (fps, count), name
        np.testing.assert_allclose(read.dofs, motion.dofs[:: 14 // count], atol=1e-6)


def test_a_motion_of_another_rate_is_filmed_at_the_characters(made, character, motion, tmp_path):
    slow = d.resample(character.actor.skeleton, motion, FPS / 2)
    frames = synthesize(character, slow, tmp_path, SynthesisOptions(camera_count=2, image_size=64), console=QUIET)
    session = d.Session(tmp_path)
    assert (session.fps, session.frame_count) == (FPS, frames) == (FPS, 13)  # 7 frames at half the rate, 6 between them
    filmed, original = (Truth(folder / "ground_truth").joints()[1] for folder in (tmp_path, made))
    np.testing.assert_allclose(filmed[frames - 1], original[frames - 1], atol=1e-6)


def written(character, path):
    character.write(path)
    return path


def test_wrong_input_is_one_sentence(made, character, motion, tmp_path):
    with pytest.raises(FileExistsError, match="session.json"):
        synthesize(character, motion, made, console=QUIET)
    with pytest.raises(ValueError, match="frame_count is 99, the motion has 14"):
        synthesize(character, motion, tmp_path, SynthesisOptions(frame_count=99), console=QUIET)
    with pytest.raises(ValueError, match="image_size"):
        synthesize(character, motion, tmp_path, SynthesisOptions(image_size=63), console=QUIET)
    unnamed = d.Session(made).rig[0]
    unnamed.name = "camera 1"
    with pytest.raises(ValueError, match="found 'camera 1'"):
        synthesize(character, motion, tmp_path / "unnamed", rig=[unnamed], console=QUIET)
    assert not (tmp_path / "unnamed" / "videos").exists()  # before anything is filmed
    np.savez(tmp_path / "other.npz", dofs=np.zeros((5, 3)))
    with pytest.raises(ValueError, match=r"expected finite 'dofs' of shape \(T, 9\), found \(5, 3\)"):
        read_motion(tmp_path / "other.npz", character, d.RetargetOptions())
    np.savez(tmp_path / "none.npz", dofs=np.zeros((0, 9)))
    with pytest.raises(ValueError, match=r"none.npz: expected finite 'dofs' of shape \(T, 9\), found \(0, 9\)"):
        read_motion(tmp_path / "none.npz", character, d.RetargetOptions())
    with pytest.raises(ValueError, match="expected one of .*, found 'stiffness'"):
        with_pairs(d.Material(), ["stiffness=1"], "--material")
    assert with_pairs(d.Material(), ["k_bend=0.25"], "--material").k_bend == 0.25
