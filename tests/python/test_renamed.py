"""Names of before this minor version go on, with a warning."""

import doublet as d
import numpy as np
import pytest
from doublet.cli.program import build_parser
from doublet.common import renamed
from doublet.reconstruct import config

MEMBERS = [(struct, old, new) for struct, members in renamed.ATTRIBUTES.items() for old, new in members.items()]


@pytest.mark.parametrize(("old", "new"), renamed.NAMES.items())
def test_a_name_of_the_package(old, new):
    assert old not in dir(d)
    with pytest.warns(DeprecationWarning, match=f"doublet.{old} is deprecated: use doublet.{new}"):
        assert getattr(d, old) is getattr(d, new)


@pytest.mark.parametrize(("struct", "old", "new"), MEMBERS)
def test_a_member(struct, old, new):
    of = getattr(d, struct)
    assert new in vars(of) and old not in getattr(of, "described", dict)()


@pytest.mark.parametrize(("struct", "old", "new"), [m for m in MEMBERS if hasattr(getattr(d, m[0]), "described")])
def test_an_option_as_keyword_and_attribute(struct, old, new):
    default = getattr(getattr(d, struct)(), new)
    with pytest.warns(DeprecationWarning, match=f"{struct}.{old} is deprecated: use {new}"):
        options = getattr(d, struct)(**{old: default})
    with pytest.warns(DeprecationWarning):
        assert getattr(options, old) == default
    with pytest.raises(TypeError, match="no option 'nothing'"):
        getattr(d, struct)(nothing=1)


def test_a_method():
    garment = d.Garment()
    with pytest.warns(DeprecationWarning, match="Garment.covers"):
        garment.covers = [1, 0]
    np.testing.assert_array_equal(garment.replaced_faces, [1, 0])
    lines = []
    context = d.Context(log=lines.append)
    with pytest.warns(DeprecationWarning, match="Context.say is deprecated: use log_line"):
        context.say("a line")
    assert lines == ["a line"]


def test_a_flag(capsys):
    command = ["garment", "out", "--garment-band=0.02", "--no-garment-own-mesh", "--garment-spreads", "0.1", "0.2"]
    parsed = vars(build_parser().parse_args(command))
    assert parsed["garment.attachment_width"] == 0.02 and parsed["garment.remesh"] is False
    assert parsed["garment.length_exceedances"] == [0.1, 0.2]
    assert "doublet: warning: --garment-band is deprecated: use --garment-attachment-width\n" in capsys.readouterr().err


def test_a_key_of_a_config_file(tmp_path, capsys):
    (tmp_path / "mine.toml").write_text("[garment]\nband = 0.02\n")
    assert config.read(tmp_path / "mine.toml") == {"garment.attachment_width": 0.02}
    assert "garment.band is deprecated: use garment.attachment_width" in capsys.readouterr().err
