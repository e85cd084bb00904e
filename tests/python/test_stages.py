"""A stage of one's own in the place of one of ours, and the record of what ran."""

import subprocess
import sys
from functools import partial
from types import SimpleNamespace

import doublet as d
import numpy as np
import pytest
from doublet import reconstruct
from doublet.cli import program as cli
from doublet.common.console import Console
from doublet.reconstruct import stages


def everything_is_cloth(job):
    count = len(job.results.actor.mesh.vertices)
    all_cloth = d.Segmentation(np.full(count, 0.02), np.ones(count), np.zeros(count, np.int32))
    d.write_segmentation(job.path("segmentation.npz"), all_cloth)
    return {"regions": np.int64(1), "areas": np.array([0.5, 1.0])}


@pytest.fixture
def make_job(tmp_path, shapes):
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
    (tmp_path / "joints.json").write_text("{}")

    def make():
        by_motion_alone = d.SegmentOptions(colour=0)  # there are no videos
        job = reconstruct.Job(tmp_path, tmp_path, {"segment": by_motion_alone}, console=Console(quiet=True))
        session = d.Session()
        session.folder, session.fps = tmp_path, 40.0
        session.scan, session.markers = tmp_path / "scan.ply", tmp_path / "joints.json"
        session.joints = [d.JointAnnotation("pelvis", "", [0, 0.5, 0], 6)]
        job.session = session
        return job

    return make


def test_a_stage_takes_the_place_of_ours(make_job):
    job = make_job()
    assert job.run(["segment"]) and not job.run(["segment"])
    assert job.results.segmentation().region_count == 0  # what does not move is no cloth
    job.replace("segment", everything_is_cloth)
    assert job.run(["segment"]), "the results of our stage stand for those of another"
    assert not job.run(["segment"])
    assert job.results.segmentation().region_count == 1
    assert job.record.summary("segment") == {"regions": 1, "areas": [0.5, 1.0]}
    assert job.record.data["stages"]["segment"]["options"]["run"].startswith(f"{__name__}.everything_is_cloth ")
    assert make_job().run(["segment"]) and job.results.segmentation().region_count == 0


def of_width(width):
    return lambda job: everything_is_cloth(job) | {"width": width}


class OfWidth:
    def __init__(self, width):
        self.width = width

    def __call__(self, job):
        return everything_is_cloth(job) | {"width": self.width}

    def run(self, job):
        return self(job)


MADE = {
    "lambdas": of_width,
    "partials": lambda width: partial(lambda width, job: everything_is_cloth(job) | {"width": width}, width),
    "objects": OfWidth,
    "methods": lambda width: OfWidth(width).run,
    "arrays": lambda width: of_width(np.full(3, width)),
    "meshes": lambda width: partial(
        lambda mesh, job: everything_is_cloth(job) | {"width": mesh.vertices[0, 0]},
        d.Mesh(np.eye(3) * width, [[0, 1, 2]]),
    ),
    "edited": lambda width: eval(f"lambda job: everything_is_cloth(job) | {{'width': {width}}}", globals()),
}


@pytest.mark.parametrize("made", MADE.values(), ids=MADE)
def test_functions_of_one_name_are_told_apart(make_job, made):
    def runs(width) -> bool:
        job = make_job()
        job.replace("segment", made(width))
        return job.run(["segment"])

    assert runs(1) and not runs(1)
    assert runs(2), "the results of one function stand for those of another"
    assert not runs(2)


def test_a_function_is_the_same_in_every_process():
    """Sets have another order there, objects are elsewhere, and the function may be on another line."""
    script = "from doublet import Stage\n{}print(Stage('a', lambda job, k={{'a', 'b', 'c'}}: job in {{'d', 'e', 'f'}}).runner)"
    found = {subprocess.check_output([sys.executable, "-c", script.format(lines)]) for lines in ("", "\n", "\n\n")}
    assert len(found) == 1


def test_a_function_that_cannot_be_told_apart_needs_a_name(make_job, tmp_path):
    class Stubborn:
        def __reduce_ex__(self, protocol):
            raise ValueError("pointers")

    stubborn = Stubborn()
    with pytest.raises(TypeError, match=r"<lambda> cannot be told from another of that name \(pointers\)"):
        make_job().replace("segment", lambda job: stubborn)
    with (tmp_path / "held").open("w") as held:
        with pytest.raises(TypeError, match=r"<lambda> cannot be told from another .*; give it a name of its own, runner='...'"):
            make_job().replace("segment", lambda job: held)
        make_job().replace("segment", lambda job: held, runner="mine")


def test_refined_cameras_are_of_the_last_capture(make_job, tmp_path):
    """A capture of one's own that refines none does not go by those of another; one that was stopped leaves them."""
    own, refined = make_job(), tmp_path / "calibration.yml"

    def capture(job):
        for name in ("performance.npz", "observations.npz"):
            job.path(name).write_text("made")

    def broken(job):
        raise ZeroDivisionError

    refined.write_text("of another capture")
    own.replace("performance", broken)
    own.stages = [next(stage for stage in own.stages if stage.name == "performance")]
    with pytest.raises(ZeroDivisionError):
        own.run(["performance"], force=True)
    assert refined.read_text() == "of another capture"
    own.replace("performance", capture)
    own.run(["performance"], force=True)
    assert not refined.exists() and not list(tmp_path.glob("calibration*"))
    own.replace("performance", lambda job: capture(job) or job.path("calibration.yml").write_text("of this one") and None)
    own.run(["performance"], force=True)
    assert refined.read_text() == "of this one" and len(list(tmp_path.glob("calibration*"))) == 1


def test_a_number_that_is_not_known_is_null(make_job):
    """As it is where our stages have none: the mean of nothing is no reason to lose what was computed."""
    job = make_job()
    unknown = {"noise_mm": float("nan"), "shares": np.array([0.5, np.inf]), "least": -np.inf}
    job.replace("segment", lambda job: everything_is_cloth(job) | unknown)
    assert job.run(["segment"]) and not job.run(["segment"])
    found = job.record.summary("segment")
    assert (found["noise_mm"], found["shares"], found["least"]) == (None, [0.5, None], None)
    assert d.quality_findings("segment", unknown) == []


def test_a_stage_need_not_return_numbers(make_job):
    job = make_job()
    job.replace("segment", lambda job: everything_is_cloth(job) and None)
    assert job.run(["segment"]) and not job.run(["segment"])
    assert job.record.is_done("segment") and not job.record.foreign_outputs("segment", ["segmentation.npz"])
    job.replace("segment", lambda job: [everything_is_cloth(job)])
    with pytest.raises(TypeError, match="a stage must return a dict of numbers, or None, found list"):
        job.run(["segment"], force=True)


def test_what_is_cloth_is_told_by_the_body_too(make_job, tmp_path):
    def runs(name="model.npz", **body) -> bool:
        job = make_job()
        job.replace("segment", everything_is_cloth)
        job.options.body_model = tmp_path / name
        job.options["body"] = d.BodyFitOptions(**body)
        return job.run(["segment"])

    for name in ("model.npz", "other.npz"):
        (tmp_path / name).write_text(name)
    assert runs() and not runs()
    assert runs("other.npz"), "another body model"
    assert not runs("other.npz")
    assert runs("other.npz", iterations=3), "another option of its fit"
    (tmp_path / "joints.json").write_text('{"landmarks": {}}')
    assert runs("other.npz", iterations=3), "other landmarks"


def test_what_a_stage_raises_comes_back_and_the_stage_runs_again(make_job):
    def broken(job):
        raise ZeroDivisionError("mine")

    job = make_job()
    job.replace("segment", broken)
    with pytest.raises(ZeroDivisionError, match="mine"):
        job.run(["segment"])
    assert job.record.data["stages"]["segment"]["state"] == "running"
    job.replace("segment", lambda job: {"numbers": object()})
    with pytest.raises(TypeError, match="expected what JSON can hold"):
        job.run(["segment"])
    assert make_job().run(["segment"])


def test_a_report_is_of_the_silhouettes_that_it_compares_with(make_job, tmp_path):
    def runs(name="me", **silhouette) -> bool:
        job = make_job()
        session = job.session
        session.name = name
        job.session = session
        job.options["silhouette"] = d.SilhouetteOptions(**silhouette)
        job.replace("report", lambda job: {"characters": job.path("report.html").write_text("page")})
        return job.run(["report"])

    for name in stages.REPORT.reads:
        (tmp_path / name).touch()
    assert runs() and not runs()
    assert runs(method="median"), "other silhouettes"
    assert not runs(method="median")
    assert runs("you", method="median"), "another headline"
    assert cli.build_parser().parse_args(["report", "OUT", "--silhouette-method", "median"])


def test_whoever_asked_is_told_of_a_search(tmp_path, monkeypatch):
    shown, told = [], []
    job = SimpleNamespace(out=tmp_path, options={"fit": SimpleNamespace(on_generation=told.append)})
    monkeypatch.setattr(stages, "FIT", SimpleNamespace(run=lambda job: job.options["fit"].on_generation("a result") or {}))
    monkeypatch.setattr(stages, "FitPage", lambda out: SimpleNamespace(show=lambda over: shown.append(over)))
    for times in (1, 2):
        assert stages.fit_and_show(job) == {}
        assert told == ["a result"] * times and shown == [False, True] * times


def test_a_stage_more(make_job):
    job = make_job()
    counted = d.Stage("count", lambda job: {"vertices": len(job.results.actor.mesh.vertices)}, reads=["actor.npz"])
    job.stages = [*job.stages, counted]
    job.run(["segment", "count"])
    assert job.record.summary("count")["vertices"] == len(job.results.actor.mesh.vertices)


def test_a_stage_that_is_not_there_is_refused(make_job):
    with pytest.raises(ValueError, match="stage 'cut': expected one of check, template, rig"):
        make_job().replace("cut", everything_is_cloth)
    with pytest.raises(ValueError, match="stage 'cut': expected one of check, template, rig"):
        make_job().run(["cut"])


def test_an_impossible_result_stops(make_job):
    job = make_job()
    job.replace("segment", lambda job: everything_is_cloth(job) | {"findings": [{"impossible": True, "text": "a head of cloth"}]})
    with pytest.raises(d.Implausible, match="segment: a head of cloth"):
        job.run(["segment"])
    job.options.keep_going = True
    job.run(["segment"])
    assert [finding.text for finding in job.findings] == ["a head of cloth"]


def test_options_are_set_in_place(make_job):
    job = make_job()
    job.options["limbs"].annealing.particles = 7
    assert job.options["annealing"].particles == job.options["capture"].limbs.annealing.particles == 7
    with pytest.raises(KeyError, match="option group 'shoes': expected one of template"):
        job.options["shoes"]
    with pytest.raises(RuntimeError):
        job.options["body"] = d.PoseOptions()
