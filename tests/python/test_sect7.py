"""The claims of Sect. 7 on a swinging bell: each command's core, with an answer that is known."""

import json
import os
import runpy
import shutil
import sys
from pathlib import Path

import doublet as d
import numpy as np
import pytest
from doublet.common.console import Console
from doublet.evaluation import study
from doublet.evaluation.synthesize import SynthesisOptions, synthesize
from doublet.export import animate

FOLDER = Path(__file__).parents[2] / "benchmarks" / "sect7"
STEPS = {"cloth.iterations": 12, "cloth.substeps": 1, "cloth.stiffness": "sweeps", "cloth.rest_curvature": 1.0}
FPS = 40.0


@pytest.fixture(autouse=True)
def importable(monkeypatch):
    """By the tests, and by name in workers."""
    monkeypatch.syspath_prepend(str(FOLDER))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(FOLDER), os.environ.get("PYTHONPATH", "")]))
    monkeypatch.setenv("MPLBACKEND", "Agg")
    yield
    for name in ("reconstructions", "filmed", "comparisons", "searches"):
        sys.modules.pop(name, None)


@pytest.fixture(scope="module")
def out(bell, shapes, tmp_path_factory):
    """The bell as a whole reconstruction: a session, what it was made with, a character and an estimate."""
    return reconstruction(bell, shapes, tmp_path_factory.mktemp("sect7") / "out")


@pytest.fixture(scope="module")
def dressed(bell, shapes, tmp_path_factory):
    """The same in a garment with a mesh of its own, of which the widest is estimated."""
    return reconstruction(bell, shapes, tmp_path_factory.mktemp("sect7") / "dressed", remesh=True)


@pytest.fixture(params=["out", "dressed"])
def either(request):
    return request.getfixturevalue(request.param)


def reconstruction(bell, shapes, folder, remesh=False):
    shutil.copytree(bell, folder)
    bare, clothness = d.read_actor(bell / "actor.npz"), d.read_segmentation(bell / "segmentation.npz")
    captured = d.read_performance(bell / "performance.npz", bare)
    options = d.GarmentOptions(remesh=remesh, vertices=150)
    garment = d.mesh_garment(bare, clothness, d.Mesh(), captured.surface, options)
    garment.clothness = np.where(garment.mesh.vertices[:, 1] < 0.9, 1.0, garment.clothness)  # the bell is open below
    if remesh:
        garment.widths = [garment.rest * [share, 1, share] for share in (1.1, 1.0, 0.9)]
    d.write_garment(folder / "garment.npz", garment)
    width = {"width": 0} if remesh else {}
    worn = d.choose_widths(d.read_garment(folder / "garment.npz", bare), list(map(float, width.values())))
    dressed = d.dress(bare, clothness, worn)
    own = d.Material(d_n=4, d_t=4.9, k_bend=0.3, k_stretch=0.999)
    solver = d.SolverSettings(1 / FPS, d.ClothOptions(**{**d.ClothOptions.paper().to_dict(), "iterations": 12}))
    character = d.make_character(dressed.actor, dressed.segmentation, d.BodyFit(), [], [own], solver)
    character.write(folder / "character.glb")
    surfaces = np.array(captured.surface.frames)
    surfaces[0] += 0.01  # not quite the skinned surface, as captured ones are
    captured.surface = d.MeshSequence(bare.mesh.faces, surfaces)
    d.write_performance(folder / "performance.npz", captured)
    motion = d.Motion(FPS, captured.dofs[:2])
    rig = [shapes["camera"](a, name=f"cam{i}", height=1.0, size=240) for i, a in enumerate((0, 2.1, 4.2))]
    synthesize(character, motion, folder / "session", SynthesisOptions(), rig, console=Console(quiet=True))
    record = {"session": str(folder / "session"), "stages": {"fit": {"state": "running", "options": STEPS, "inputs": {}}}}
    (folder / "run.json").write_text(json.dumps(record))
    (folder / "material.json").write_text(json.dumps({"regions": [{"parameters": own.to_dict(), **width}]}))
    return folder


def films(**more):
    from filmed import Filming

    return Filming(perfect=True, frames=16, **more)


def test_a_filmed_character_is_simulated_again_to_the_same_surface(either, tmp_path, monkeypatch):
    """The error of the truth itself is none, whether it was seen perfectly or in images; a wrong one has some."""
    from filmed import Filming, PerfectViews, filmed
    from reconstructions import energies, energy_job, material, rms_cm, simulate

    played, add = [], PerfectViews.add
    monkeypatch.setattr(PerfectViews, "add", lambda views, frame: (played.append(np.array(frame.surface)), add(views, frame)))
    truth, wrong = material([4, 4.9, 0.7, 1, 0.5]), material([20, 20, 0.1, 0.9, 0.5])
    for how in (films(), Filming(frames=8, noise=2.0)):
        folder, options = filmed(either, None, truth, how, tmp_path)
        job = study.plain_job(folder, options, FPS, 1)
        made = study.film_of(job)
        again, other = simulate(made, [truth]), simulate(made, [wrong])
        assert len(again) == how.frames
        assert rms_cm(again, again, made) == 0 and rms_cm(other, again, made) > 0.5
        assert rms_cm(again + [0.03, 0.0, 0.04], again, made) == pytest.approx(5)
        right, off = energies(energy_job(job, [[truth], [wrong]]))
        assert right[0] < 0.6 * off[0]
        if how.perfect:
            seen = d.read_observations(folder / "observations.npz").views
            assert np.mean([len(view.matches) for views in seen[1:] for view in views]) > 200
            assert np.abs(np.array(played) - again).max() < 1e-4
        else:
            with np.load(folder / "session" / "ground_truth" / "frames_0000.npz") as truth_of_film:
                assert np.abs(truth_of_film["surface"] - again).max() < 1e-4
        assert filmed(either, None, truth, how, tmp_path)[0] == folder


def test_recovery_finds_what_was_filmed(out, tmp_path, capsys):
    from comparisons import recovery
    from reconstructions import material

    fit, rows = recovery(out, None, material([4, 4.9, 0.7, 1, 0.5]), films(), {"max_evaluations": 96}, 4.0, tmp_path, 1)
    found = {name: (energy, rms) for name, energy, rms in rows}
    assert found["truth"][1] == 0 and found["estimate"][1] < 0.3 * found["centre of the box"][1]
    energy = fit["regions"][0]["energy"]  # a mean of eight, a thousandth of the box apart
    assert max(energy, found["estimate"][0]) < 0.3 * found["centre of the box"][0]
    assert "abs. error" in capsys.readouterr().out


def test_every_material_of_table_1_explains_its_own_film_best(out, tmp_path):
    from comparisons import table1

    costs = table1(out, None, films(), tmp_path, 1)
    assert costs.shape == (6, 6) and (costs.argmin(axis=1) == np.arange(6)).all()


def test_the_same_steps_are_the_same_cloth(out):
    from comparisons import apart_from, fewer_iterations, iterations
    from reconstructions import estimate

    apart = apart_from(out, None, estimate(out), (12, 1))
    assert apart((12, 1), estimate(out)) == 0 and apart((9, 1), estimate(out)) > 0.01
    assert fewer_iterations(24, 1) == [(18, 1)] and fewer_iterations(6, 4) == [(4, 4), (5, 4), (6, 3)]
    assert [row[1:3] for row in iterations(out, None)][-1] == ["9 x 1", "25"]


def write_truth(folder, faces, surfaces, cloth):
    """The cloth of `surfaces` as a true garment."""
    np.savez(folder / "static.npz", body_tris=faces[:1], cloth_tris=np.zeros((0, 3), np.int32))
    np.savez(folder / "frames_0000.npz", start=0, body=surfaces, cloth=surfaces[:, cloth])


def test_rivals_are_measured_as_evaluate_does(either, tmp_path, monkeypatch, capsys):
    """The truth is the estimate's own cloth: no error to it, and some to every other material, on both motions."""
    import comparisons
    from reconstructions import estimate, plain_job, simulate

    swing = np.zeros((12, 6))
    swing[:, 0] = 0.02 * np.arange(12) ** 1.5
    for module in (comparisons, animate):  # clips are read for humans only
        monkeypatch.setattr(module, "exact_motion", lambda *_: d.Motion(FPS, swing))
    made, novel = study.film_of(plain_job(either)), tmp_path / "novel"
    faces, cloth = made.results.actor.mesh.faces, made.results.dressed.segmentation.clothness > 0.5
    write_truth(tmp_path, faces, simulate(made, estimate(either)), cloth)
    novel.mkdir()
    (novel / "motion.bvh").touch()
    character = d.Character.read(either / "character.glb")
    write_truth(novel, faces, animate.animate_exactly(character, novel / "motion.bvh", FPS, d.Context()), cloth)
    record = json.loads((either / "run.json").read_text())
    record["stages"]["fit"]["options"]["fit.max_evaluations"] = 8
    (either / "run.json").write_text(json.dumps(record))
    found = comparisons.rivals(either, None, tmp_path, 4, 2, 3, tmp_path / "work", 1)
    assert [name for name in found if "random" in name] == ["random 0", "random 1", "random 2"]
    assert max(found.pop("estimate")) < 1e-4 and min(min(row) for row in found.values()) > 0.02
    assert "estimate, seed 2" in found
    said = capsys.readouterr().out
    assert (
        "resim_cloth_cm: estimates 0.00 to" in said and "0 of them nearer than every estimate" in said and "| random" not in said
    )


def test_an_estimate_costs_least_on_its_own_motion(out, tmp_path):
    from comparisons import cross

    costs = cross([out, out], [None, None], [], tmp_path, 1)
    assert costs.shape == (2, 3) and (costs[0] == costs[1]).all() and costs[0, 0] == costs[0, 1] < costs[0, 2]


@pytest.mark.slow
def test_pictures(out, tmp_path):
    """Fig. 5a has the energy of its node; Fig. 5b begins where it is told."""
    from reconstructions import energies, energy_job, estimate, plain_job
    from searches import annealing, cma_from, landscape, robustness

    costs = landscape(out, None, 3, tmp_path, 1)
    (own,) = estimate(out)
    corner = d.Material(**{**own.to_dict(), "d_n": 32.0, "k_bend": 0.0})
    assert costs.shape == (3, 3, 1) and costs[0, 2].tolist() == energies(energy_job(plain_job(out), [[corner]]))[0]
    start = [0.2, 0.8, 0.3, 0.9, 0.6]
    samples = cma_from(start, 1e-6, 1, d.FitOptions(max_evaluations=8)).ask()
    assert np.abs(samples - start).max() < 1e-4
    runs = robustness(out, None, 2, 16, tmp_path, 1)
    assert [steps[0] for steps in runs[0]["steps"]] == [8, 16] and runs[0]["steps"] != runs[1]["steps"]
    assert np.shape(annealing(out, None, [1], 8, tmp_path, 1)) == (1, 3)
    assert (tmp_path / "landscape_0.png").stat().st_size > 5000 and (tmp_path / "robustness.png").stat().st_size > 5000


def test_other_starts_of_a_garment_that_offers_widths(dressed, tmp_path):
    """The width is one more coordinate, of which a start says nothing."""
    from searches import padded, robustness

    (run,) = robustness(dressed, None, 1, 9, tmp_path, 1)
    means = [mean for _, _, mean in run["steps"]]
    assert len(means[0]) == 6 and padded([0.1, 0.2], 3) == [0.1, 0.2, 0.5]


def test_variants_are_compared_by_the_plain_energy(out, tmp_path):
    import searches
    from reconstructions import energies, energy_job, plain_job

    few = {"initial_design_size": 4, "population": 4}
    searches.VARIANTS = {"windows": {"energy": {"window": 8}, "fit": few}, "plain": {"fit": few}}
    rows = searches.variants(out, None, None, 8, [1, 2], tmp_path, 1)
    assert [row[:2] for row in rows] == [["windows", 1], ["windows", 2], ["plain", 1], ["plain", 2]]
    job = {**plain_job(out, fit={"max_evaluations": 8, **few}), "seed": 2}
    region = searches.search(job)["regions"][0]
    assert rows[3][4] == pytest.approx(region["best_sample"]["energy"])
    materials = [d.Material(**found["parameters"]) for found in (region, region["best_sample"])]
    costs = energies(energy_job(plain_job(out), [[m] for m in materials]))
    assert rows[3][3:5] == pytest.approx([costs[0][0], costs[1][0]])


def test_the_command_line(out, tmp_path, capsys):
    main = runpy.run_path(str(FOLDER / "__main__.py"))["main"]
    main(["iterations", str(out), "--work", str(tmp_path)])
    assert "| 24 x 1 | 18 x 1 | 25 |" in capsys.readouterr().out
    for arguments in (["-h"], ["cross", "-h"]):
        with pytest.raises(SystemExit) as stop:
            main(arguments)
        assert stop.value.code == 0
    for arguments, text in (
        (["iterations", "nowhere"], "nowhere is not a folder"),
        (["table1", str(out), "--work", str(tmp_path), "--cameras", "9"], "--cameras is 9, the session has 3"),
    ):
        with pytest.raises(SystemExit, match=text):
            main(arguments)
