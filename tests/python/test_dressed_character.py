"""benchmarks/dressed_character.py: what it dresses is as a scan of a person."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
from dressed_character import GARMENTS, Person, as_scanned  # noqa: E402


@pytest.mark.parametrize("name", ["shorts", "tee"])
def test_a_scan_is_valid_where_a_garment_is_fastened_and_not_at_its_hem(name):
    """Else the skin of the character has holes beside the garment."""
    person, cut = Person(1), GARMENTS[name]
    _, faces, valid, _ = as_scanned(person, cut, 0.03, np.random.default_rng(1))
    cover = person.covered(cut)[faces]
    ends, fastened = cover.any(axis=1) & ~cover.all(axis=1), np.isin(person.bone, cut.fastened)[faces].any(axis=1)
    assert valid[ends & fastened].all() and (ends & fastened).any()
    assert not valid[ends & ~fastened].any() and (ends & ~fastened).any()
    assert valid[~ends].all()
