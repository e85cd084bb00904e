"""A stage of one's own in the place of one of ours."""

from dataclasses import replace

import doublet as d
import numpy as np
import pytest
from doublet import reconstruct
from doublet.common.console import Console

SEGMENT = next(s for s in reconstruct.STAGES if s.name == "segment")


def everything_is_cloth(job):
    count = len(job.results.actor.mesh.vertices)
    all_cloth = d.Segmentation(np.full(count, 0.02), np.ones(count), np.zeros(count, np.int32))
    d.write_segmentation(job.path("segmentation.npz"), all_cloth)
    return {"regions": 1}


@pytest.fixture
def job(tmp_path, shapes):
    """OUT as after the capture of a tube that does not move."""
    vertices, faces = shapes["tube"](0.1, 0.0, 1.0)
    skeleton = d.Skeleton([d.JointAnnotation("pelvis", "", [0, 0.5, 0], 6)])
    actor = d.RiggedMesh(d.Mesh(vertices, faces), [1] * len(faces), [[1.0]] * len(vertices), skeleton)
    dofs = [[0.0] * len(skeleton.dof_names)] * 2
    performance = d.ReferencePerformance()
    performance.surface, performance.dofs, performance.frames = d.MeshSequence(faces, [vertices] * 2), dofs, [0, 1]
    performance.joints = [skeleton.joint_positions(pose) for pose in dofs]
    d.write_actor(tmp_path / "actor.npz", actor)
    d.write_performance(tmp_path / "performance.npz", performance)
    by_motion_alone = d.SegmentOptions(colour=0)  # there are no videos
    job = reconstruct.Job(tmp_path, tmp_path, {"segment": by_motion_alone}, console=Console(quiet=True))
    job.session = type("Session", (), {"folder": tmp_path})
    return job


def run_segment(job):
    return reconstruct.run_stage(job, next(s for s in job.stages if s.name == "segment"))


def test_a_stage_takes_the_place_of_ours(job):
    assert run_segment(job) and not run_segment(job)
    assert job.results.segmentation().region_count == 0  # what does not move is no cloth
    job.stages = reconstruct.with_stage(job.stages, replace(SEGMENT, run=everything_is_cloth))
    assert run_segment(job), "the results of our stage stand for those of another"
    assert not run_segment(job)
    assert job.results.segmentation().region_count == 1
    job.stages = reconstruct.STAGES
    assert run_segment(job) and job.results.segmentation().region_count == 0


def test_a_stage_that_does_not_fit_is_refused():
    with pytest.raises(ValueError, match="stage 'cut': expected one of check, template, rig"):
        reconstruct.with_stage(reconstruct.STAGES, replace(SEGMENT, name="cut"))
    with pytest.raises(ValueError, match="expected it to write segmentation.npz"):
        reconstruct.with_stage(reconstruct.STAGES, replace(SEGMENT, writes=("mine.npz",)))
