"""`--write-config` and `--config`: the file says what flags would, and is checked as they are."""

import json
import os
import sys
from pathlib import Path

import doublet as d
import pytest
from doublet import reconstruct
from doublet.cli import commands, jobs, option_flags
from doublet.cli import program as cli
from doublet.reconstruct import config
from doublet.reconstruct.options import plain
from test_options import FLAGS, GROUPS, another

sys.path.append(str(Path(__file__).parents[1] / "fuzz"))
from seeds import World, write_session  # noqa: E402

PARSER = cli.build_parser()
CONFIGURED = [(g, n) for g, n in FLAGS if g in reconstruct.OPTION_GROUPS]


def write(path, *flags):
    assert cli.main(["reconstruct", "--write-config", str(path), *flags]) == 0
    return path


def options_of(*words) -> tuple[dict, int]:
    """Of a command line: the option objects, and the seed."""
    arguments = PARSER.parse_args(["reconstruct", "session", "-o", "out", *map(str, words)])
    job = jobs.make_job(arguments, arguments.session)
    return {group: plain(job.options[group]) for group in d.ReconstructionOptions.groups}, job.options.seed


@pytest.fixture(scope="module")
def defaults(tmp_path_factory):
    return write(tmp_path_factory.mktemp("config") / "all.toml")


def test_the_file_that_is_written_has_the_defaults(defaults):
    assert options_of("--config", defaults) == options_of()
    text = defaults.read_text()
    for group, name in CONFIGURED:
        default = getattr(GROUPS[group](), name)
        if reconstruct.options.is_derived(group, name, default):
            continue
        told = GROUPS[group].described()[name]
        comment = text.split(f"\n[{group}]")[1].split(f"\n{name} = ")[0].splitlines()[-1]
        for part in (told["meaning"], told["takes"] or "", told["unit"], "default: "):
            assert part in comment, (group, name, part)


@pytest.mark.parametrize(("group", "name"), CONFIGURED)
def test_every_option_comes_back_from_the_file(group, name, tmp_path):
    changed, value = another(GROUPS[group], name)
    if reconstruct.options.is_derived(group, name, getattr(GROUPS[group](), name)):
        return
    path = tmp_path / "one.toml"
    path.write_text(f"[{group}]\n{name} = {config.as_toml(plain(value))}\n")
    options, _ = options_of("--config", path)
    assert options[group] == plain(changed)
    all_of_them = {g: GROUPS[g]() for g in reconstruct.OPTION_GROUPS} | {group: changed}
    path.write_text(config.written(all_of_them, 3, None, option_flags.describe_option))
    assert options_of("--config", path) == (options, 3)


def test_the_command_line_beats_the_file(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text("seed = 7\n[segment]\ndiffusion = 0.05\neven_gap = 0.004\n[space.fixed]\nd_n = 9\n")
    options, seed = options_of("--config", path, "--segment-diffusion", 0.01)
    assert (options["segment"]["diffusion"], options["segment"]["even_gap"], seed) == (0.01, 0.004, 7)
    assert options["space"]["fixed"] == {**plain(d.ParameterSpace().fixed), "d_n": 9.0}
    assert options_of("--config", path, "--seed", 2)[1] == 2
    both = write(tmp_path / "both.toml", "--config", str(path), "--segment-diffusion", "0.01")
    assert options_of("--config", both) == (options, seed)


def test_a_body_model_is_seen_from_the_file(tmp_path):
    path = tmp_path / "elsewhere" / "mine.toml"
    path.parent.mkdir()
    path.write_text('body_model = "model.npz"\n')
    arguments = cli.build_parser().parse_args(["body", "out", "--config", str(path)])
    assert jobs.make_job(arguments, Path("session")).options.body_model == path.with_name("model.npz")


def test_a_body_model_is_written_as_the_file_sees_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    elsewhere = write(Path("elsewhere") / "mine.toml", "--body-model", "model.npz")
    assert config.read(elsewhere)["body_model"].resolve() == tmp_path / "model.npz"
    again = write(Path("again.toml"), "--config", str(elsewhere))
    assert config.read(again)["body_model"].resolve() == tmp_path / "model.npz"
    absolute = write(Path("absolute.toml"), "--body-model", str(tmp_path / "model.npz"))
    assert f'body_model = "{tmp_path}/model.npz"' in absolute.read_text()


def test_no_file_comes_in_the_place_of_a_pipe(tmp_path, capsys):
    os.mkfifo(tmp_path / "pipe.toml")
    assert cli.main(["reconstruct", "--write-config", str(tmp_path / "pipe.toml")]) == 1
    assert "pipe.toml: expected a file, found a device or pipe" in capsys.readouterr().err
    assert (tmp_path / "pipe.toml").is_fifo()


@pytest.fixture
def results(tmp_path):
    """Of a small person, up to the performance."""
    world, out = World(), tmp_path / "out"
    write_session(tmp_path / "session", world)
    d.write_actor(out / "actor.npz", world.actor)
    d.write_performance(out / "performance.npz", world.performance)
    (out / "run.json").write_text(json.dumps({"session": str(tmp_path / "session"), "stages": {}}))
    return out


def said_by(capsys, *words):
    assert cli.main([str(w) for w in words]) in (0, 3)
    return capsys.readouterr().err


def test_a_stage_runs_again_if_and_only_if_what_it_is_told_changed(results, tmp_path, capsys):
    """By the file or by flags: which of the two makes no difference."""
    path = tmp_path / "mine.toml"
    path.write_text("[segment]\ndiffusion = 0.05\n")
    assert "first run" in said_by(capsys, "segment", results, "--segment-diffusion", 0.05)
    assert "segment: up to date" in said_by(capsys, "segment", results, "--config", path)
    record = json.loads((results / "run.json").read_text())
    assert record["config"]["file"] == str(path)
    assert record["stages"]["segment"]["options"]["segment.diffusion"] == 0.05
    path.write_text("[segment]\ndiffusion = 0.05\n[fit]\nmax_evaluations = 3\n")  # nothing that this stage uses
    assert "segment: up to date" in said_by(capsys, "segment", results, "--config", path)
    path.write_text("[segment]\ndiffusion = 0.04\n")
    shown = said_by(capsys, "segment", results, "--config", path)
    assert "option segment.diffusion changed from 0.05 to 0.04" in shown
    assert "segment: up to date" in said_by(capsys, "segment", results, "--segment-diffusion", 0.04)
    assert json.loads((results / "run.json").read_text())["config"] is None


def help_of(capsys, *words):
    with pytest.raises(SystemExit) as stop:
        cli.main(["reconstruct", *words])
    assert stop.value.code == 0
    return capsys.readouterr().out


def test_help_is_split(capsys):
    """What most people need, and everything."""
    flags = {
        f"--{g}-{n.replace('_', '-')}" for g, n in CONFIGURED if not reconstruct.options.is_derived(g, n, getattr(GROUPS[g](), n))
    }
    usual = {f"--{name.replace('.', '-').replace('_', '-')}" for name in commands.reconstruct.USUAL}
    assert usual < flags
    short, full = help_of(capsys, "--help"), help_of(capsys, "--help-all")
    shown = {flag for flag in flags if f"{flag} " in short or f"{flag}," in short}
    assert shown == usual
    assert len(short.splitlines()) < 70
    assert [flag for flag in sorted(flags) if flag not in full] == []
    assert "surface options" not in short and "surface options" in full


def test_a_session_and_a_folder_are_asked_for(capsys):
    with pytest.raises(SystemExit) as stop:
        cli.main(["reconstruct", "session"])
    assert stop.value.code == 2 and "SESSION, -o/--out" in capsys.readouterr().err
