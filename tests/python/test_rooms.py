"""benchmarks/rooms.py, wearers.py: what a folder has is not taken for something else. The benchmarks themselves run for hours."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
import rooms  # noqa: E402
import wearers  # noqa: E402

PERSON = rooms.Person(1.68, None, False)


@pytest.fixture
def measured(tmp_path, monkeypatch):
    """rooms.measured(), which films nothing: (seed, person, room, session) -> whether a room was made."""
    made = []

    def make(source, flaws, folder, *_):
        folder.mkdir()
        (folder / "session.json").touch()
        made.append(folder)

    monkeypatch.setattr(rooms, "make_session", make)
    monkeypatch.setattr(rooms, "run", lambda *_: json.dumps({"metrics": {}}))

    def measure(seed=1, person=PERSON, room="calib", session="session"):
        before = len(made)
        rooms.measured(tmp_path / session, room, tmp_path / "out", seed, person)
        return len(made) > before

    return measure


def test_a_room_is_made_once(measured):
    assert measured() and not measured() and not measured(person=replace(PERSON, height=1.8)) and measured(room="person")


@pytest.mark.parametrize("other", [{"seed": 2}, {"session": "other"}, {"person": replace(PERSON, tracked=True)}])
def test_a_room_of_something_else_is_refused(measured, other):
    measured()
    with pytest.raises(SystemExit, match="calib: expected a room that is made of .*: take another folder"):
        measured(**other)


def test_a_wearer_in_another_clip_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(wearers, "make_wearer", lambda *_: None)

    def run(command, *arguments):
        if command == "synthesize":
            arguments[-1].mkdir()
            (arguments[-1] / "session.json").touch()

    monkeypatch.setattr(wearers, "run", run)
    for _ in range(2):
        assert wearers.captured(3, Path("walk.bvh"), tmp_path)[1] == tmp_path / "wearer3"
    with pytest.raises(SystemExit, match="expected a film of dance.bvh, found one of walk.bvh: take another folder"):
        wearers.captured(3, Path("dance.bvh"), tmp_path)
