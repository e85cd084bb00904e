"""The pipeline composed in C++ (examples/reconstruct.cpp) and the command line make the same of a session."""

import json
import subprocess

import doublet as d
import numpy as np
import pytest
from conftest import doublet

FRAMES = 6
ARCHIVES = (
    "template_suggestion.npz", "actor.npz", "performance.npz", "observations.npz", "segmentation.npz", "body.npz", "garment.npz",
    "simulated.npz",
)  # fmt: skip
SAME_BYTES = ("template.ply", "template_high.ply", "proxies.json", "character.glb")


def without_times(path):
    """material.json, but for how long the search took."""
    return {name: value for name, value in json.loads(path.read_text()).items() if name != "seconds"}


def make_coarser(path, cell):
    """The scan with one vertex in each cube of this width, m: its surface is made in a fraction of the time."""
    scan = d.read_mesh(path)
    _, place, count = np.unique(np.floor(scan.vertices / cell), axis=0, return_inverse=True, return_counts=True)
    middle = np.zeros((len(count), 3))
    np.add.at(middle, place.ravel(), scan.vertices)
    faces = place.ravel()[scan.faces]
    whole = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    d.write_mesh(path, d.Mesh(middle / count[:, None], faces[whole].astype(np.int32)))


@pytest.mark.slow
def test_the_cpp_example_writes_what_the_command_writes(broken_session, cpp_examples, tmp_path):
    described = broken_session / "session.json"
    session = json.loads(described.read_text())
    described.write_text(json.dumps({**session, "frame_count": FRAMES, "cameras": session["cameras"][::2]}))
    make_coarser(broken_session / "scan.ply", 0.015)
    here, there = tmp_path / "cpp", tmp_path / "python"
    command = [str(part) for part in (cpp_examples / "example_reconstruct", broken_session, here, d.body_model_path())]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as example:  # both at once
        done = doublet("reconstruct", broken_session, "-o", there, "--keep-going", "--quiet")
        assert done.returncode in (0, 3), done.stderr
        _, said = example.communicate(timeout=900)
    assert example.returncode == 0, said
    for name in ARCHIVES:
        with np.load(here / name) as ours, np.load(there / name) as theirs:
            assert set(ours) == set(theirs), name
            for array in ours:
                assert np.array_equal(ours[array], theirs[array], equal_nan=ours[array].dtype.kind == "f"), (name, array)
    with np.load(here / "garment.npz") as garment:
        assert len(garment["vertices"]) > 1000  # there is a garment to compare
    for name in SAME_BYTES:
        assert (here / name).read_bytes() == (there / name).read_bytes(), name
    assert without_times(here / "material.json") == without_times(there / "material.json")
