"""A session of masks without videos, made by keying the shipped one; and the same actor without any cloth."""

import json
import shutil

import doublet as d
import numpy as np
import pytest
from conftest import SESSION, doublet
from PIL import Image

pytestmark = pytest.mark.slow  # a whole reconstruction
COUNT = 10


@pytest.fixture(scope="module")
def masks_only(tmp_path_factory):
    folder = tmp_path_factory.mktemp("masks_only")
    session, extractor = d.Session(SESSION), d.SilhouetteExtractor.create()
    frames = d.FrameSource.open(session)
    (folder / "masks").mkdir()
    for c, camera in enumerate(session.cameras):
        images = [frames.image(c, f) for f in range(COUNT)]
        extractor.train(c, images[:1])
        for f, image in enumerate(images):
            Image.fromarray(extractor.extract(c, image)).save(folder / "masks" / f"{camera.name}_{f:04d}.png")
    described = json.loads((SESSION / "session.json").read_text())
    described["frame_count"] = COUNT
    described["cameras"] = [{"name": camera.name} for camera in session.cameras]
    (folder / "session.json").write_text(json.dumps(described))
    for name in ("calibration.yml", "joints.json", "scan.ply", "motion.bvh"):
        shutil.copy(SESSION / name, folder / name)
    return folder


@pytest.fixture(scope="module")
def made(masks_only, tmp_path_factory):
    out = tmp_path_factory.mktemp("out")
    done = doublet("reconstruct", masks_only, "-o", out, "--template-poisson-depth", 8, "--fit-max-evaluations", 8)
    assert done.returncode in (0, 3), done.stderr  # 3: where nothing moves much, cloth is carried by the body, which is said
    return out


def test_every_stage_runs_and_says_what_is_missing(made):
    log, page = (made / "log.txt").read_text(), (made / "report.html").read_text()
    assert "masks without images: silhouettes alone" in log
    assert "no feature matches" in log and "no texture" in log
    assert "captured from silhouettes alone" in page and "silhouette term alone" in page
    with np.load(made / "observations.npz") as observations:
        assert len(observations["match_points"]) == 0 and len(observations["contour_points"]) > 1000
    stages = json.loads((made / "run.json").read_text())["stages"]
    assert stages["performance"]["summary"]["silhouette_iou_against_measured_masks"] > 0.95
    assert stages["character"]["summary"]["texture_seen"] == 0
    material = json.loads((made / "material.json").read_text())
    assert material["regions"] and all(np.isfinite(region["energy"]) for region in material["regions"])


def test_a_session_without_cloth_gives_a_skinned_character(made, tmp_path):
    out = tmp_path / "out"
    shutil.copytree(made, out)
    for command in (
        ("segment", out, "--segment-even-odds", 50, "--segment-gap-slope", 0),
        *((stage, out) for stage in ("body", "garment", "fit", "character", "report")),
    ):
        done = doublet(*command)
        assert done.returncode == 0, done.stderr
    assert json.loads((out / "material.json").read_text())["regions"] == []
    page = (out / "report.html").read_text()
    assert "No cloth found" in page and "no material to estimate" in page and "NaN" not in (out / "run.json").read_text()
    character = d.Character.read(out / "character.glb")
    assert character.segmentation.region_count == 0 and character.materials == []
    performance = d.read_performance(out / "performance.npz", character.actor)
    with np.load(out / "simulated.npz") as simulated:
        skinned = [d.pose_surface(character.actor, dofs) for dofs in performance.dofs]
        np.testing.assert_allclose(simulated["vertices"], skinned, atol=1e-4)
    done = doublet("animate", out / "character.glb", SESSION / "motion.bvh", "-o", tmp_path / "a.npz")
    assert done.returncode == 0, done.stderr
