"""Scans of any unit, axis and place are brought to what the cameras see."""

import doublet as d
import numpy as np
import pytest
from doublet.cli import main
from doublet.scan import alignment
from test_scan import FAST, Person, model, write_session  # noqa: F401

PLACES = [("mm", "+z", True, 2.1), ("m", "-y", False, 0.4), ("inches", "+x", True, 4.9), ("cm", "+y", False, 3.0)]


def spoilt(mesh: d.Mesh, unit: str, up: str, floor: bool, heading: float) -> d.Mesh:
    """The mesh as a scanner might have it."""
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    if floor:
        bottom = vertices[:, 1].min()
        steps = np.linspace(-1.5, 1.5, 16)
        grid = np.array([[x, bottom, z] for x in steps for z in steps])
        corners = np.array([i * 16 + j for i in range(15) for j in range(15)])
        squares = np.vstack([corners + [[0], [1], [17]], corners + [[0], [17], [16]]]).reshape(2, 3, -1)
        vertices, faces = np.vstack([vertices, grid]), np.vstack([faces, *(len(vertices) + s.T for s in squares)])
    turned = (vertices - [0.4, 0, 0.1]) @ alignment.about_y(heading).T
    turned = turned @ alignment.upright(np.array(alignment.AXES[up], float))
    return d.Mesh(turned / alignment.UNITS[unit] + 7, faces.astype(np.int32))


@pytest.mark.parametrize("place", PLACES, ids=lambda place: f"{place[0]} {place[1]}")
def test_it_is_brought_back(model, place):  # noqa: F811
    person = Person(model, 0.7, 3)
    unit, up, floor, _ = place
    found = alignment.align_scan(spoilt(person.mesh, *place), person.mesh)
    assert (found.unit, found.up, found.floor) == (unit, up, floor)
    assert found.distance < 0.002
    _, off, _ = d.RayScene(person.mesh).closest(found.mesh.vertices)
    assert off.max() < 0.02 and len(found.mesh.vertices) > 0.93 * len(person.mesh.vertices)


def test_another_person_or_pose_is_refused(model):  # noqa: F811
    person = Person(model, 0.7, 3)
    ball = d.capsule_mesh([0, 0.5, 0], [0, 1.5, 0], 0.3, 0.3)
    with pytest.raises(
        ValueError, match="scan: expected the person and the pose that the cameras see, found it .* mm from there"
    ):
        alignment.align_scan(ball, person.mesh)
    far = d.Mesh(7 * np.asarray(ball.vertices), ball.faces)
    with pytest.raises(ValueError, match="scan: expected a person as high as the cameras see, .* found 4.2, 11.2, 4.2 units"):
        alignment.align_scan(far, person.mesh)


def test_the_command_takes_a_given_scan(model, tmp_path, capsys):  # noqa: F811
    person = Person(model, 0.7, 3)
    folder = write_session(tmp_path / "session", person)
    d.write_mesh(tmp_path / "raw.ply", spoilt(person.mesh, *PLACES[0]))
    fast = [option for option in FAST if option != "--quiet"]
    assert main(["scan", str(folder), *fast, "--given", str(tmp_path / "raw.ply")]) in (0, 3)
    assert "raw.ply is in mm, +z is up, without its floor; brought to" in capsys.readouterr().err
    session = d.Session(folder)
    _, off, _ = d.RayScene(person.mesh).closest(d.read_mesh(session.scan).vertices)
    assert off.mean() < 0.01
    errors = person.errors_mm({mark.name: mark.position for mark in session.joints})
    assert np.mean(list(errors.values())) < 25, errors
