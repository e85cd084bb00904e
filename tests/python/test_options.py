"""Every option of every stage, set to another valid value, arrives wherever it should."""

import argparse
import copy
import json
import math
import pickle
import sys
from pathlib import Path

import doublet as d
import numpy as np
import pytest
from doublet import reconstruct
from doublet.cli import option_flags
from doublet.cli.program import build_parser
from doublet.reconstruct import config
from doublet.reconstruct.options import plain

sys.path.insert(0, str(Path(__file__).parents[1] / "fuzz"))
from seeds import World  # noqa: E402

GROUPS = {**reconstruct.OPTION_GROUPS, "retarget": d.RetargetOptions, "train": d.TrainOptions}
CLASSES = [c for c in vars(d).values() if hasattr(c, "described")]
FIELDS = [(c, name) for c in CLASSES for name in c.described()]
FLAGS = [(group, name) for group, c in GROUPS.items() for name in c.described()]


def candidates(value, told: dict):
    """Values near one, of which some are valid."""
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, (int, float)):
        return [value + 2, value + 4, value - 1] if isinstance(value, int) else [value * 1.02 + 1e-3, value * 0.98]
    if isinstance(value, str):
        return [c for c in told.get("choices", [value + "x", "2"]) if c != value]
    if isinstance(value, np.ndarray):
        return [value * [0.9, 0.8, 0.7]]
    if isinstance(value, dict):
        return [{"pelvis": "Hips"}]
    if isinstance(value, list):
        return [value[:-1] if value else [3], ["somebody"]]
    return [another(type(value), next(iter(type(value).described())))[0]]  # options of their own


def another(options_class: type, name: str):
    """Options of which one is not the default, and its value."""
    default = getattr(options_class(), name)
    for value in candidates(default, options_class.described()[name]):
        try:
            return options_class(**{name: value}), value
        except (ValueError, TypeError):
            pass
    raise AssertionError(f"{options_class.__name__}.{name}: no other value near {default}")


def others(options, name: str) -> dict:
    return {k: v for k, v in plain(options).items() if k != name}


@pytest.mark.parametrize(("options_class", "name"), FIELDS, ids=lambda x: getattr(x, "__name__", x))
def test_a_keyword_is_an_attribute_and_an_entry(options_class, name):
    changed, value = another(options_class, name)
    assert plain(getattr(changed, name)) == plain(value)
    assert plain(changed)[name] == plain(value)
    assert plain(changed)[name] != plain(options_class())[name]
    assert others(changed, name) == others(options_class(), name)
    assigned = options_class()
    setattr(assigned, name, value)
    assert plain(assigned) == plain(changed)
    told = options_class.described()[name]
    assert told["meaning"] and told["meaning"] in getattr(options_class, name).__doc__
    assert told["unit"] in getattr(options_class, name).__doc__


@pytest.mark.parametrize(("options_class", "name"), FIELDS, ids=lambda x: getattr(x, "__name__", x))
def test_numbers_outside_their_range_are_refused_by_name(options_class, name):
    told, default = options_class.described()[name], getattr(options_class(), name)
    if "lower" not in told:
        return
    for bound, step in (("lower", -1), ("upper", 1)):
        if not np.isfinite(told[bound]) or (isinstance(default, int) and name.startswith("seed") and name != "seeds"):
            continue
        bad = type(default)(told[bound] + step) if isinstance(default, (int, float)) else told[bound] + step
        bad = np.full(3, bad) if isinstance(default, np.ndarray) else [bad] if isinstance(default, list) else bad
        if isinstance(default, list) and default == []:
            bad = [int(b) for b in bad]
        with pytest.raises(ValueError, match=f"^{options_class.__name__}: {name}: expected .*, found "):
            options_class(**{name: bad})


def flag_words(group: str, name: str, value) -> list[str]:
    flag = f"--{group}-{name.replace('_', '-')}"
    if isinstance(value, bool):
        return [flag if value else flag.replace(f"--{group}", f"--no-{group}")]
    if isinstance(value, (d.Material, dict)):
        return [flag, *(f"{k}={v!r}".replace("'", "") for k, v in plain(value).items())]
    if isinstance(value, (list, np.ndarray)):
        return [flag, *(str(v) for v in value)]
    return [flag, str(value)]


def test_a_whole_number_that_is_too_large_is_refused_by_name(tmp_path):
    with pytest.raises(ValueError, match="FitOptions: max_evaluations: expected a smaller number, found 99999999999"):
        reconstruct.make_options("fit", d.FitOptions, max_evaluations=99999999999)
    path = tmp_path / "mine.toml"
    for text, found in (
        ("[fit]\nmax_evaluations = 99999999999\n", "fit.max_evaluations: expected a smaller number, found 99999999999"),
        (f"seed = {2**64}\n", f"seed: expected a whole number of at most {2**64 - 1}, found {2**64}"),
    ):
        path.write_text(text)
        with pytest.raises(RuntimeError, match=found):
            config.read(path)


@pytest.mark.parametrize(
    "words",
    ["check S -o new --seed -1", f"fit OUT --seed {2**64}", "animate c m -o o --threads -3", "study OUT -o f --workers 0",
     "study OUT -o f --seeds 1 -1", "edit-joints S --port 70000"],
)  # fmt: skip
def test_numbers_that_a_command_cannot_take_are_refused_by_flag(words, capsys):
    with pytest.raises(SystemExit):
        build_parser().parse_args(words.split())
    flag = next(word for word in words.split() if word.startswith("--"))
    assert f"error: argument {flag}: expected a whole number from " in capsys.readouterr().err


@pytest.mark.parametrize(("group", "name"), FLAGS)
def test_a_flag_sets_its_option(group, name):
    options_class = GROUPS[group]
    parser = argparse.ArgumentParser()
    option_flags.add_option_flags(parser, {group: options_class})
    _, value = another(options_class, name)
    words = flag_words(group, name, value)
    if reconstruct.options.is_derived(group, name, getattr(options_class(), name)):
        assert f"{words[0]} " not in parser.format_help()
        return
    chosen = option_flags.chosen_options(parser.parse_args(words), {group: options_class})[group]
    default = options_class()
    assert plain(chosen)[name] == plain(value)
    assert others(chosen, name) == others(default, name)


def test_the_help_names_a_switch_as_the_pages_do():
    text = option_flags.describe_option(d.GarmentOptions.described()["remesh"], d.GarmentOptions().remesh)
    assert text.endswith("(default: on)")


def test_groups_inside_groups_take_the_groups_options(tmp_path):
    """`annealing` reaches the search for lost limbs inside the capture."""
    job = reconstruct.Job(tmp_path, tmp_path)
    job.options["annealing"] = d.ParticleAnnealingOptions(particles=7)
    job.options["opposite"] = d.OppositeOptions(rays=1)
    job.options["space"] = d.ParameterSpace(names=["d_n"])
    assert job.options["capture"].limbs.annealing.particles == 7
    assert job.options["segment"].opposite.rays == 1
    assert job.options["fit"].space.names == ["d_n"]


@pytest.fixture(scope="module")
def world():
    return World()


def settings_of(name: str) -> d.SolverSettings:
    """Of which one differs from the default: dt, or an option of the cloth."""
    return d.SolverSettings(dt=1 / 30) if name == "dt" else d.SolverSettings(cloth=another(d.ClothOptions, name)[0])


@pytest.mark.parametrize("name", ["dt", *d.ClothOptions.described()])
def test_the_solvers_settings_travel_with_the_material(world, tmp_path, name):
    settings = settings_of(name)
    character = d.make_character(
        world.actor, world.segmentation, world.body, world.proxies, [world.material] * world.segmentation.region_count, settings
    )
    character.write(tmp_path / "character.glb")
    assert plain(d.Character.read(tmp_path / "character.glb").solver) == plain(settings)

    file = tmp_path / "material.json"
    count = len(world.actor.mesh.vertices)
    rigid = d.Segmentation(np.zeros(count), np.zeros(count), np.full(count, -1, np.int32))
    simulator = d.CharacterSimulator(world.actor, rigid, world.proxies, settings.cloth)
    d.write_materials(file, d.estimate_material(simulator, world.performance, world.observations, settings.dt))
    assert json.loads(file.read_text())["solver"] == plain(settings)
    assert d.read_materials(file, settings) == []
    where = "dt" if name == "dt" else f"cloth.{name}"
    with pytest.raises(d.Error, match=f"material.json: solver setting {where}: expected .*, found "):
        d.read_materials(file, d.SolverSettings())


def test_whatever_the_energy_depends_on_changes_its_fingerprint(world):
    def fingerprint(cloth=None, energy=None, space=None, dt=1 / 40):
        simulator = d.CharacterSimulator(world.actor, world.segmentation, world.proxies, cloth or d.ClothOptions())
        return d.MaterialObjective(
            simulator, world.performance, world.observations, dt, energy or d.EnergyOptions(), space or d.ParameterSpace()
        ).fingerprint

    prints = {"": fingerprint(), "dt": fingerprint(dt=1 / 30)}
    for keyword, options_class in (("cloth", d.ClothOptions), ("energy", d.EnergyOptions), ("space", d.ParameterSpace)):
        for name in options_class.described():
            prints[f"{keyword}.{name}"] = fingerprint(**{keyword: another(options_class, name)[0]})
    assert len(set(prints.values())) == len(prints), prints


@pytest.mark.parametrize(("options_class", "name"), FIELDS, ids=lambda x: getattr(x, "__name__", x))
def test_options_compare_copy_pickle_and_read_back(options_class, name):
    changed, default = another(options_class, name)[0], options_class()
    assert changed != default and default == options_class() and changed != 3
    for same in (copy.copy(changed), copy.deepcopy(changed), pickle.loads(pickle.dumps(changed))):
        assert same == changed and same is not changed
        setattr(same, name, getattr(default, name))
        assert same == default != changed  # its own
    assert repr(default) == f"{options_class.__name__}()"
    assert repr(changed).startswith(f"{options_class.__name__}({name}=")
    assert eval(repr(changed), vars(d)) == changed


def test_what_is_no_option_is_compared_and_pickled_too(tmp_path):
    options = d.FitOptions(checkpoint=tmp_path / "a", seed=2)
    assert options != d.FitOptions(seed=2) and pickle.loads(pickle.dumps(options)) == options
    first = d.BayesianOptions(first=np.zeros((4, 3)))
    assert first == d.BayesianOptions(first=np.zeros((4, 3))) != d.BayesianOptions(first=np.zeros((6, 2)))
    assert pickle.loads(pickle.dumps(first)) == first
    options.on_generation = print
    assert options == options and options != copy.copy(options)  # functions are like no other
    assert "on_generation=..." in repr(options)
    with pytest.raises(TypeError, match="FitOptions: cannot be pickled with 'on_generation'"):
        pickle.dumps(options)
    with pytest.raises(TypeError, match="unhashable"):
        hash(options)


UNITS = {"", "m", "m^2", "rad", "s", "px", "frames", "cameras", "octree levels", "1/m", "1/s", "m/s", "m/s^2"}


def test_no_option_is_in_degrees_or_millimetres():
    """docs/conventions.md; who gives an angle in degrees by habit hears of radians."""
    assert {told["unit"] for c in CLASSES for told in c.described().values()} == UNITS
    for options_class, name, degrees in (
        (d.RestPoseOptions, "max_bend", 15),
        (d.ViewScanOptions, "grazing_angle", 80),
        (d.CalibrationRefinementOptions, "rotation", 0.5),
    ):
        assert getattr(options_class(), name) == degrees * math.pi / 180
        with pytest.raises(ValueError, match=rf"{name}: expected a number in .* rad, found {degrees}"):
            options_class(**{name: degrees})
