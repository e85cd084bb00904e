"""What README, docs and help promise; their code blocks are in test_code_blocks.py."""

import importlib
import inspect
import json
import os
import pydoc
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import doublet as d
import numpy as np
import pytest
from doublet import _doublet, reconstruct, testing
from doublet._lazy import DEPRECATED_MODULES
from doublet.cli.commands import COMMANDS
from doublet.cli.program import build_parser
from doublet.common.console import Console
from doublet.export.usd import write_usdc
from doublet.pages.fit_page import sections

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "tests" / "fuzz"))
from seeds import World, write_fit, write_session  # noqa: E402


@pytest.fixture(scope="module")
def world():
    return World()


def bound_callables():
    for name in dir(_doublet):
        member = getattr(_doublet, name)
        if name.startswith("_"):
            continue
        if not inspect.isclass(member):
            yield name, member
            continue
        for method in vars(member):
            if not method.startswith("_") and callable(getattr(member, method)):
                yield f"{name}.{method}", getattr(member, method)


def test_everything_that_is_bound_is_documented():
    """More than the signatures that pybind11 writes by itself."""
    for name, member in bound_callables():
        lines = [line for line in (member.__doc__ or "").splitlines() if line.strip()]
        words = [line for line in lines if not re.match(rf"(\d+\. )?{name.split('.')[-1]}\(|Overloaded function", line)]
        assert words, f"{name} has only a signature: {member.__doc__}"
    for name in dir(_doublet):
        member = getattr(_doublet, name)
        if inspect.isclass(member) and not issubclass(member, Exception):
            assert (member.__doc__ or "").strip(), f"{name} has no docstring"


def bound_properties():
    for name in dir(_doublet):
        if inspect.isclass(getattr(_doublet, name)):
            for key, member in vars(getattr(_doublet, name)).items():
                if isinstance(member, property):
                    yield f"{name}.{key}", member


def test_every_property_is_documented():
    assert [name for name, member in bound_properties() if not (member.__doc__ or "").strip()] == []


def test_docstrings_say_what_is_held_and_asked_for():
    assert "Camera" in d.Observations.cameras.__doc__
    assert "JointAnnotation" in d.Session.joints.__doc__
    assert "directions (N, 3) unit" in d.RayScene.cast.__doc__


def test_every_argument_has_a_name():
    setters = [(name, member.fset) for name, member in bound_properties() if member.fset]
    assert len(setters) > 300
    for name, member in [*bound_callables(), *setters]:
        assert not re.search(r"\barg\d+:", member.__doc__ or ""), f"{name}: {member.__doc__}"


def test_masks_and_numbers_are_arrays(world):
    valid = world.actor.face_valid
    assert valid.dtype == bool and valid.shape == (len(world.actor.mesh.faces),)
    with pytest.raises(ValueError, match="read-only"):
        valid[0] = 0  # of a copy
    actor = d.RiggedMesh(world.actor.mesh, valid > 0, world.actor.weights, world.actor.skeleton)
    np.testing.assert_array_equal(actor.face_valid, valid)
    for given in (valid.tolist(), valid.astype(int).tolist(), valid.astype(np.uint8), np.where(valid, 7, 0)):
        actor.face_valid = given
        np.testing.assert_array_equal(actor.face_valid, valid)
    for wrong in (valid.astype(float), valid[None], valid.astype(int) + 256, [-1], "1"):
        with pytest.raises(TypeError):
            actor.face_valid = wrong
    performance = d.ReferencePerformance()
    performance.frames = range(3, 6)
    assert performance.frames.tolist() == [3, 4, 5] and not performance.frames.flags.writeable
    assert d.self_intersecting_faces(world.actor.mesh).flags.writeable


def test_every_context_has_a_default():
    for name, member in bound_callables():
        for signature in re.findall(r"context: [^,)]*", member.__doc__ or ""):
            assert "=" in signature, f"{name}: {signature}"


def test_modules_that_help_names_are_there():
    """In a fresh process, where nobody has imported them yet."""
    named = set(re.findall(r"`doublet\.([\w.]+)`", d.__doc__))
    assert named == {"reconstruct", "evaluation.metrics"}
    program = (
        "import doublet\n" + "\n".join(f"doublet.{name}" for name in sorted(named)) + "\ndoublet.evaluation.metrics.evaluate"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
    assert {importlib.import_module(f"doublet.{n}").__name__ for n in d.MODULES} <= {f"doublet.{n}" for n in dir(d)}
    with pytest.raises(AttributeError, match="nonsense"):
        d.nonsense  # noqa: B018


def test_names_that_pages_have_are_there():
    """In a fresh process, where nobody has imported their modules."""
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
    text = "\n".join(re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL) for page in pages)
    named = set(re.findall(rf"`doublet\.((?:{'|'.join(d.MODULES)})(?:\.\w+)+)", text))
    assert "export.level_of_detail.level_of_detail" in named and len(named) > 10
    program = "import sys, doublet\nfor name in sys.argv[1:]:\n    eval(f'doublet.{name}')"
    subprocess.run([sys.executable, "-c", program, *sorted(named)], check=True)


def test_help_fits_a_screen_and_names_what_is_there():
    lines = pydoc.plain(pydoc.render_doc(d)).splitlines()
    assert len(lines) <= 60 and max(map(len, lines)) <= 135
    groups = re.findall(r"^  (\w+) +(\w+(?:, \w+)+)$", d.__doc__, re.MULTILINE)
    assert len(groups) > 8
    assert [name for _, names in groups for name in names.split(", ") if not hasattr(_doublet, name)] == []


@pytest.mark.parametrize("old", DEPRECATED_MODULES)
def test_a_module_has_its_old_name_for_a_version(old):
    """In a fresh process: a warning comes once."""
    new = f"doublet.{DEPRECATED_MODULES[old]}"
    program = f"import doublet.{old}; from doublet import {old}; import {new} as new; assert {old} is new is doublet.{old}"
    done = subprocess.run([sys.executable, "-W", "always", "-c", program], capture_output=True, text=True, check=True)
    assert f"doublet.{old} is deprecated: use {new}" in done.stderr


def test_a_kit_has_its_old_name_for_a_version():
    for name in testing.__all__:
        with pytest.warns(DeprecationWarning, match=rf"use doublet\.testing\.{name}"):
            assert getattr(d, name) is getattr(testing, name)
    assert {n for n in dir(_doublet) if n.endswith("_violations")} == set(testing.__all__)


def test_a_source_motion_from_arrays_is_the_one_that_was_read(world, tmp_path):
    from seeds import BVH

    (tmp_path / "walk.bvh").write_text(BVH)
    read = d.SourceMotion.read(tmp_path / "walk.bvh")
    made = d.SourceMotion(
        read.joint_names, read.joint_parents, read.offsets, read.positions, read.rotations, read.fps, read.source
    )
    for name in ("joint_names", "joint_parents", "fps", "source"):
        np.testing.assert_array_equal(getattr(made, name), getattr(read, name))
    for name in ("offsets", "positions", "rotations"):
        np.testing.assert_array_equal(getattr(made, name), getattr(read, name))
    with pytest.raises(ValueError, match="unit quaternions"):
        d.SourceMotion(read.joint_names, read.joint_parents, read.offsets, read.positions, 2 * read.rotations, read.fps)
    with pytest.raises(ValueError, match="parents before their children"):
        d.SourceMotion(read.joint_names, [-1, 1, 0], read.offsets, read.positions, read.rotations, read.fps)


def test_step_each_makes_the_bits_of_single_steps(world):
    simulator, materials = world.simulator, [[d.Material(d_n=x)] for x in (1.0, 4.0, 9.0)]
    before, after = simulator.pose(world.dofs[0]), simulator.pose(world.dofs[1])
    alone, together = ([simulator.start(before) for _ in materials] for _ in range(2))
    for state, material in zip(alone, materials):
        simulator.step(state, before, after, material, 0.025)
    assert simulator.step_batch(together, before, after, materials, 0.025) == []
    for one, other in zip(alone, together):
        np.testing.assert_array_equal(simulator.surface(one, after), simulator.surface(other, after))
    with pytest.raises(ValueError, match="equally many"):
        simulator.step_batch(together, before, after, materials[:1], 0.025)

    model = d.ClothModel(world.mesh.vertices, world.mesh.faces, world.cloth)
    solver, inputs = d.ClothSolver.create(model), d.StepInputs(targets=world.mesh.vertices, dt=0.02)
    alone, together = ([d.ClothState(world.mesh.vertices) for _ in materials] for _ in range(2))
    for state, (material,) in zip(alone, materials):
        solver.step(state, inputs, material)
    assert solver.step_batch(together, [inputs], [m for (m,) in materials]) == []
    for one, other in zip(alone, together):
        np.testing.assert_array_equal(one.positions, other.positions)
    with pytest.raises(TypeError, match="None"):
        solver.step_batch([None], [inputs], [d.Material()])


def test_arrays_of_an_animation_are_put_together_once(world):
    animation = d.animate(world.character, world.motion, d.AnimateOptions(settle_seconds=0.05))
    for name in ("surface", "joints", "high", "body"):
        assert getattr(animation, name) is getattr(animation, name)
        assert len(getattr(animation, name)) == len(animation.dofs)
        assert not getattr(animation, name).flags.writeable  # no file would have what one wrote


def test_a_stage_of_ones_own_is_not_anothers(world, tmp_path):
    write_session(tmp_path / "session", world)

    def first(job):
        job.path("own.txt").write_text("first")
        return {}

    def second(job):
        job.path("own.txt").write_text("second")
        return {}

    for work in (first, second):
        job = d.Reconstruction(tmp_path / "session", tmp_path / "out")
        job.stages = [d.Stage("own", work, writes=["own.txt"], needs_scan=False)]
        assert f".{work.__name__} " in job.stages[0].runner
        job.run(["own"])
    assert job.path("own.txt").read_text() == "second"


def test_a_video_may_lie_elsewhere(world, tmp_path):
    """An absolute path in session.json is as good as a relative one."""
    folder, elsewhere = tmp_path / "session", tmp_path / "elsewhere"
    write_session(folder, world)
    (folder / "masks").rename(elsewhere)
    path = folder / "session.json"
    path.write_text(path.read_text().replace("masks/", f"{elsewhere}/"))
    assert {camera.masks.parent for camera in d.Session(folder).cameras} == {elsewhere}
    job = reconstruct.Job(folder, tmp_path / "out", console=Console(quiet=True))
    d.write_actor(tmp_path / "out" / "actor.npz", world.actor)
    job.stages = [d.Stage("look", lambda job: {}, session_inputs=["scan", "images"])]
    job.run(["look"])
    assert job.record.data["stages"]["look"]["inputs"].keys() == {f"session/{elsewhere}", "session/scan.ply"}


def test_a_session_may_be_called_by_a_link(world, tmp_path):
    """Files of it may change, as by its own name."""
    folder, link = tmp_path / "session", tmp_path / "link"
    write_session(folder, world)
    link.symlink_to("session")
    for name in (folder, link, folder):
        (folder / "session.json").write_text((folder / "session.json").read_text() + "\n")
        job = reconstruct.Job(name, tmp_path / "out", console=Console(quiet=True))
        job.stages = [d.Stage("look", lambda job: {}, session_inputs=["description"])]
        assert job.run(["look"])


ENDLESS = """
import sys, time
from doublet.cli import commands, program as cli
commands.stages.run_stages = lambda arguments: (print("started", flush=True), [time.sleep(0.01) for _ in range(6000)])
sys.exit(cli.main(["segment", "out"]))
"""


@pytest.mark.parametrize(
    ("number", "ignored"),
    [*((number, ignored) for number in (signal.SIGINT, signal.SIGTERM) for ignored in (False, True)), (signal.SIGHUP, False)],
)
def test_signals_end_a_command_as_ctrl_c_does(number, ignored):
    """Also where the parent has the signal ignored, as a shell has SIGINT for what runs in the background."""
    disposition = signal.SIG_IGN if ignored else signal.SIG_DFL
    process = subprocess.Popen(
        [sys.executable, "-c", ENDLESS], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        preexec_fn=lambda: signal.signal(number, disposition),
    )  # fmt: skip
    assert process.stdout.readline() == "started\n"
    time.sleep(0.1)
    process.send_signal(number)
    _, said = process.communicate(timeout=30)
    assert process.returncode == 128 + number
    assert "doublet: stopped; what is complete stays" in said and "Traceback" not in said


def test_a_command_goes_on_without_its_terminal_if_nohup_says_so():
    process = subprocess.Popen(
        [sys.executable, "-c", ENDLESS.replace("range(6000)", "range(50)")], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True, preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN),
    )  # fmt: skip
    assert process.stdout.readline() == "started\n"
    process.send_signal(signal.SIGHUP)
    _, said = process.communicate(timeout=30)
    assert "stopped" not in said


def test_a_page_that_is_not_json_is_refused(tmp_path):
    (tmp_path / "run.json").write_text(json.dumps([]))
    with pytest.raises(RuntimeError, match=r"run\.json"):
        reconstruct.recorded_session(tmp_path)


@pytest.mark.parametrize("damaged", ["part,cost\n1,2\n", "region,evaluations\nx,y\n", "\x8f", None])
def test_a_fit_log_of_another_kind_is_refused(tmp_path, damaged):
    write_fit(tmp_path / "out")
    if damaged is None:
        assert "<svg" in sections(tmp_path / "out")
        return
    (tmp_path / "out" / "fit_log.csv").write_bytes(damaged.encode("latin-1"))
    with pytest.raises(RuntimeError, match=r"fit_log\.csv: expected what the stage 'fit' writes"):
        sections(tmp_path / "out")


@pytest.mark.parametrize("page", ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"])
def test_links_lead_somewhere(page):
    """Those of docs/ are scripts/build-docs.sh's business."""
    links = re.findall(r"\]\(([^)#:]+)[^)]*\)", (ROOT / page).read_text(encoding="utf-8"))
    assert links and [link for link in links if not (ROOT / link).exists()] == []


@pytest.mark.parametrize(
    ("words", "name"),
    [
        ("fit A --threads 2 B C", "takes"),
        ("study A B --seeds 1 2 --quiet C -o results.jsonl", "outs"),
        ("new-session A --calibration cameras.toml B --masks M --copy C -o session", "videos"),
    ],
)
def test_folders_stand_on_both_sides_of_an_option(words, name):
    parsed = build_parser().parse_args(words.split())
    assert [str(path) for path in getattr(parsed, name)] == [*"ABC"][-len(getattr(parsed, name)) :]
    assert len(getattr(parsed, name)) == (2 if name == "takes" else 3)


def test_the_help_of_every_command_says_what_it_does():
    commands = next(action for action in build_parser()._actions if action.dest == "command")
    said = {choice.dest: choice.help for choice in commands._choices_actions}
    assert {name: command.description for name, command in commands.choices.items()} == said


def test_an_option_that_is_none_is_refused_among_folders(capsys):
    with pytest.raises(SystemExit):
        build_parser().parse_args(["fit", "A", "--nonsense", "B"])
    assert "unrecognized arguments: --nonsense" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        build_parser().parse_args(["fit", "--threads", "2"])
    assert capsys.readouterr().err.endswith("the following arguments are required: OUT\n")


def test_names_of_files_may_be_any_bytes(world, tmp_path):
    """Latin 1, of an old disk."""
    base = tmp_path / os.fsdecode(b"H\xfclle")
    write_session(base / "session", world)
    for ran in (True, False):
        job = d.Reconstruction(base / "session", base / "out")
        job.options.configuration = base / "session" / "session.json"
        job.stages = [d.Stage("own", in_python, writes=["own.txt"], session_inputs=["images"], needs_scan=False)]
        assert job.run(["own"]) == ran
    assert "H\ufffdlle" in job.record.data["session"]
    with pytest.raises(RuntimeError, match=r"expected the session's name in UTF-8, .*; give it with --session"):
        reconstruct.recorded_session(base / "out")
    with pytest.raises(FileNotFoundError, match="no such file"):
        d.read_mesh(base / "none.ply")
    with pytest.raises(ValueError, match="expected a path in UTF-8, which USD needs"):
        write_usdc(base / "dance.usdc", world.character, world.motion)


def test_a_folder_that_cannot_be_made_is_named(world, tmp_path):
    write_session(tmp_path / "session", world)
    (tmp_path / "file").write_text("")
    job = d.Reconstruction(tmp_path / "session", tmp_path / "file" / "out")
    job.stages = [d.Stage("own", in_python, writes=["own.txt"], needs_scan=False)]
    with pytest.raises(d.Error, match=r"^[^ ]*/file/out: Not a directory$"):
        job.run(["own"])


def in_python(job):
    job.path("own.txt").write_text("own")


def test_a_command_loads_none_of_the_others():
    code = "import sys; from doublet.cli.program import build_parser; build_parser('animate'); print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert [name for name in loaded if name.startswith("doublet.cli.commands.")] == ["doublet.cli.commands.animate"]
    assert "tqdm" not in loaded


@pytest.mark.parametrize("module", COMMANDS)
def test_the_commands_of_a_module_are_known_without_loading_it(module):
    for name in COMMANDS[module]:
        found = next(action for action in build_parser(name)._actions if action.dest == "command")
        assert tuple(found.choices) == COMMANDS[module]
