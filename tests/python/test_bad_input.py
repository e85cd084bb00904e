"""Every row of docs/bad-input.md: one sentence that names what is wrong, and an exit status; never a crash, never a traceback."""

import pytest
from bad_input import CASES, PAGE, page, run_all


@pytest.fixture(scope="module")
def rows():
    return run_all()


def test_there_are_enough():
    assert len(CASES) >= 80
    assert len({(c.group, c.what) for c in CASES}) == len(CASES)


def test_every_one_ends_in_a_sentence(rows):
    for row in rows:
        assert row.status in (("130", "143") if row.case.group == "Stopped" else ("1", "2")), row
        assert row.sentence.startswith("doublet"), row
        assert "internal error" not in row.sentence and "Traceback" not in row.sentence, row
        assert 20 < len(row.sentence) < 400, row


def test_the_page_is_up_to_date(rows):
    assert PAGE.read_text(encoding="utf-8") == page(rows), "python tests/python/bad_input.py writes docs/bad-input.md again"
