"""The garment stage from Python: a mesher of one's own, the dressed actor, what the report shows."""

import doublet as d
import numpy as np
import pytest
from doublet import pipeline, report

SAID = d.Context()


class AsScanned(d.GarmentMesher):
    """Only as wide as the scan."""

    def mesh(self, actor, clothness, body, captured, context):
        garment = d.mesh_garment(actor, clothness, body, captured, d.GarmentOptions(vertices=300), context)
        garment.rest = garment.mesh.vertices
        return garment


@pytest.fixture(scope="module")
def skirt(shapes):
    """A cone, its lower half cloth, closed below by a sheet that nobody saw: (actor, clothness)."""
    vertices, faces = shapes["tube"](lambda h: 0.35 - 0.15 * h, 0.5, 1.5)
    around, below = 48, len(vertices)
    sheet = np.stack([np.full(around, below), (np.arange(around) + 1) % around, np.arange(around)], axis=1)
    vertices, faces = np.vstack([vertices, [[0, 0.5, 0]]]), np.vstack([faces, sheet]).astype(np.int32)
    valid = np.arange(len(faces)) < len(faces) - around
    skeleton = d.Skeleton([d.JointMark("pelvis", "", [0, 1, 0], 6)])
    actor = d.RiggedMesh(d.Mesh(vertices, faces), valid.tolist(), np.ones((len(vertices), 1)), skeleton)
    cloth = (vertices[:, 1] < 1).astype(float)
    return actor, d.Segmentation(np.zeros_like(cloth), cloth, np.where(cloth > 0, 0, -1).astype(np.int32))


def test_a_mesher_of_ones_own(skirt, tmp_path):
    actor, clothness = skirt
    garment = AsScanned().mesh(actor, clothness, d.Mesh(), d.MeshSequence(), SAID)
    d.write_garment(tmp_path / "garment.npz", garment)
    back = d.read_garment(tmp_path / "garment.npz", actor)
    np.testing.assert_allclose(back.rest, garment.mesh.vertices, atol=1e-6)
    assert back.covers == garment.covers and back.region_count == 1
    summary = d.summarise_garment(back)
    assert (summary.regions, summary.loops, summary.hanging_loops) == (1, 2, 1)
    assert (summary.vertices, summary.faces) == (len(back.region), len(back.mesh.faces))


def test_the_dressed_actor_has_the_garment_behind_its_own_vertices(skirt):
    actor, clothness = skirt
    garment = d.mesh_garment(actor, clothness, d.Mesh(), d.MeshSequence(), d.GarmentOptions(vertices=300))
    dressed, bare = d.dress(actor, clothness, garment), len(actor.mesh.vertices)
    np.testing.assert_array_equal(dressed.actor.mesh.vertices[bare:], garment.mesh.vertices)
    np.testing.assert_array_equal(dressed.segmentation.clothness, np.r_[np.zeros(bare), garment.clothness])
    np.testing.assert_array_equal(dressed.segmentation.rest[bare:], garment.rest)
    valid = np.asarray(dressed.actor.face_valid, bool)
    assert valid[len(actor.mesh.faces) :].all() and not valid[: len(actor.mesh.faces)][np.asarray(garment.covers, bool)].any()
    performance = d.ReferencePerformance()
    performance.dofs, performance.frames, performance.joints = np.zeros((2, 6)), [0, 1], np.zeros((2, 1, 3))
    performance.surface = d.MeshSequence(actor.mesh.faces, np.stack([actor.mesh.vertices, actor.mesh.vertices + [0, 0.1, 0]]))
    frames = d.dress(performance, actor, garment).surface.frames
    np.testing.assert_allclose(frames[1, bare:], garment.mesh.vertices + [0, 0.1, 0], atol=1e-9)


def test_a_file_of_another_actor_is_refused(skirt, shapes, tmp_path):
    actor, clothness = skirt
    d.write_garment(tmp_path / "garment.npz", d.mesh_garment(actor, clothness, d.Mesh(), d.MeshSequence()))
    vertices, faces = shapes["tube"](0.3, 0.5, 1.5, rows=4)
    other = d.RiggedMesh(d.Mesh(vertices, faces), [1] * len(faces), np.ones((len(vertices), 1)), actor.skeleton)
    with pytest.raises(d.Error, match=r"garment.npz: array 'covers'"):
        d.read_garment(tmp_path / "garment.npz", other)


def test_the_pipeline_wears_what_the_file_says(bell):
    """The bell's garment has no vertices: the cloth is the loose part of the template, and the report says so."""
    job = pipeline.Job(bell, bell)
    assert len(job.dressed.actor.mesh.vertices) == len(job.actor.mesh.vertices)
    np.testing.assert_array_equal(job.dressed.segmentation.clothness, job.segmentation().clothness)
    assert job.dressed_performance().surface.frames.shape == job.performance().surface.frames.shape
    assert job.options["cloth"].stiffness == "compliance" and d.ClothOptions.paper().stiffness == "sweeps"

    class Shown:
        pass

    shown = Shown()
    shown.job = job
    assert "No mesh of its own" in report.garment(shown)


def area_of(garment) -> float:
    return float(d.face_areas(garment.rest, garment.mesh.faces).sum())


def test_the_video_chooses_among_rest_shapes(skirt, tmp_path, monkeypatch):
    """Each spread is tried, then each band; the cheapest is taken, all costs are told; what nobody would use is refused."""
    actor, clothness = skirt
    wide = np.array(actor.mesh.vertices) * [1.3, 1, 1.3]
    performance = d.ReferencePerformance()
    performance.frames, performance.dofs, performance.joints = [0, 1, 2, 3], np.zeros((4, 6)), np.zeros((4, 1, 3))
    performance.surface = d.MeshSequence(
        actor.mesh.faces, np.stack([actor.mesh.vertices + w * (wide - actor.mesh.vertices) for w in (0, 0.3, 0.6, 1)])
    )
    d.write_actor(tmp_path / "actor.npz", actor)
    d.write_segmentation(tmp_path / "segmentation.npz", clothness)
    d.write_performance(tmp_path / "performance.npz", performance)
    body = d.BodyFit()
    body.body = d.Mesh(np.array(actor.mesh.vertices) * [0.6, 1, 0.6], actor.mesh.faces)
    d.write_body(tmp_path / "body.npz", body)
    trial = {"spreads": [0.1, 0.9], "bands": [0, 0.1]}
    options = {"garment": d.GarmentOptions(vertices=300), "trial": d.TrialOptions(**trial)}
    job = pipeline.Job(tmp_path, tmp_path, options)
    tried = []

    def cheap_if_wide(_, garment):
        """Costs less the more area and the more cloth hangs on the skeleton in part."""
        clothness = np.asarray(garment.clothness)
        tried.append((area_of(garment), int(((clothness > 0) & (clothness < 1)).sum())))
        return 1 / (tried[-1][0] + tried[-1][1])

    monkeypatch.setattr(pipeline, "trial_energy", cheap_if_wide)
    chosen, costs = pipeline.filmed_garment(job)
    (wide, no_band), (narrow, _), (as_wide, band) = tried  # the wide seam is not tried twice
    assert wide > 1.05 * narrow and as_wide == wide and band > no_band == 0
    assert area_of(chosen) == wide and int(((chosen.clothness > 0) & (chosen.clothness < 1)).sum()) == band
    assert list(costs["spread"]) == ["0.1", "0.9"] and list(costs["band"]) == ["0", "0.1"]
    assert costs["band"]["0"] == costs["spread"]["0.1"]
    monkeypatch.setattr(pipeline, "trial_energy", lambda _, garment: 1 / cheap_if_wide(_, garment))
    chosen, _ = pipeline.filmed_garment(job)
    assert area_of(chosen) == narrow and not ((chosen.clothness > 0) & (chosen.clothness < 1)).any()
    for name, value, found in (("spread", 0.3, r"\[0.1, 0.9\]"), ("band", 0.02, r"\[0.0, 0.1\]")):
        job.options["garment"] = d.GarmentOptions(**{name: value})
        with pytest.raises(ValueError, match=rf"garment.{name} {value} would not be used: .* found {found}"):
            pipeline.filmed_garment(job)
        job.options["trial"] = d.TrialOptions(**{**trial, f"{name}s": []})
        monkeypatch.setattr(pipeline, "trial_energy", lambda *_: 1.0)
        assert pipeline.filmed_garment(job)[1][name] == {}  # nothing to choose from
        job.options["trial"] = d.TrialOptions(**trial)


def test_another_rest_shape_must_be_clearly_cheaper():
    trial = d.TrialOptions(margin=0.1)
    assert d.chosen_garment([100, 95, 91], trial) == 0  # what chaos does
    assert d.chosen_garment([100, 95, 89, 92], trial) == 2
    assert d.chosen_garment([100, 95, 91], d.TrialOptions(margin=0)) == 2
    with pytest.raises(ValueError, match="expected at least one"):
        d.chosen_garment([])
