"""Scans of any unit, axis and place are brought to what the cameras see; more in tests/capture/scan_alignment_test.cpp."""

import doublet as d
import numpy as np
import pytest
from doublet.cli import main
from test_scan import FAST, Person, model, write_session  # noqa: F401


def spoilt(mesh: d.Mesh) -> d.Mesh:
    """The mesh as a scanner might have it: in millimetres, lying on its back, turned by 2.1 rad, on a floor."""
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    bottom, count = vertices[:, 1].min(), len(vertices)
    corners = [[x, bottom, z] for x in (-1.5, 1.5) for z in (-1.5, 1.5)]
    vertices, faces = (
        np.vstack([vertices, corners]),
        np.vstack([faces, [[count, count + 1, count + 3], [count, count + 3, count + 2]]]),
    )
    c, s = np.cos(2.1), np.sin(2.1)
    turned = (vertices - [0.4, 0, 0.1]) @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]).T
    return d.Mesh(1000 * turned[:, [2, 0, 1]] + 7, faces.astype(np.int32))


def test_it_is_brought_back(model):  # noqa: F811
    person = Person(model, 0.7, 3)
    found = d.align_scan(spoilt(person.mesh), person.mesh)
    assert (found.unit, found.up, found.floor) == ("mm", "+z", True)
    assert found.distance < 0.002
    _, off, _ = d.RayScene(person.mesh).closest(found.mesh.vertices)
    assert off.max() < 0.02 and len(found.mesh.vertices) > 0.93 * len(person.mesh.vertices)


def test_another_person_is_refused(model):  # noqa: F811
    ball = d.capsule_mesh([0, 0.5, 0], [0, 1.5, 0], 0.3, 0.3)
    with pytest.raises(
        ValueError,
        match="scan: expected the person and the pose that the cameras see, found it at least .* mm from the visual hull",
    ):
        d.align_scan(ball, Person(model, 0.7, 3).mesh)


def test_the_command_takes_a_given_scan(model, tmp_path, capsys):  # noqa: F811
    person = Person(model, 0.7, 3)
    folder = write_session(tmp_path / "session", person)
    d.write_mesh(tmp_path / "raw.ply", spoilt(person.mesh))
    fast = [option for option in FAST if option != "--quiet"]
    assert main(["scan", str(folder), *fast, "--given", str(tmp_path / "raw.ply")]) in (0, 3)
    assert "raw.ply is in mm, +z is up, without its floor; brought to" in capsys.readouterr().err
    session = d.Session(folder)
    assert not session.scan_from_views
    _, off, _ = d.RayScene(person.mesh).closest(d.read_mesh(session.scan).vertices)
    assert off.mean() < 0.01
    errors = person.errors_mm({mark.name: mark.position for mark in session.joints})
    assert np.mean(list(errors.values())) < 25, errors
