"""What was read of a member of an object stays what it was when the member is set."""

import gc
import inspect
import pickle
import sys
from functools import cache
from pathlib import Path

import doublet as d
import numpy as np
import pytest
from doublet import _doublet

sys.path.append(str(Path(__file__).parents[1] / "fuzz"))
from seeds import World  # noqa: E402

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
TWO = np.array([[0, 1, 2], [0, 2, 3]], np.int32)


def filled(made, **values):
    for name, value in values.items():
        setattr(made, name, value)
    return made


# Class -> its object number i.
ELEMENTS = {
    "Camera": lambda i: filled(d.Camera(), name=f"camera {i}", K=np.eye(3) * i, width=10 * i),
    "Capsule": lambda i: d.Capsule([i, 0, 0], [0, i, 0], i, 2 * i),
    "ClothState": lambda i: d.ClothState(SQUARE * i),
    "JointAnnotation": lambda i: d.JointAnnotation(f"joint {i}", "", [i, i, i]),
    "JointVisibility": lambda i: filled(d.JointVisibility(), joint=f"joint {i}"),
    "Lens": lambda i: filled(d.Lens(), distortion=np.full(4, float(i))),
    "LostLimb": lambda i: filled(d.LostLimb(), limb=f"limb {i}", frame=i),
    "Material": lambda i: d.Material(k_bend=0.1 * i),
    "RefinedCamera": lambda i: filled(d.RefinedCamera(), camera=f"camera {i}", moved=i),
    "SessionCamera": lambda i: filled(d.SessionCamera(), name=f"camera {i}", video=f"{i}.mp4"),
    "Stage": lambda i: d.Stage(f"stage {i}", lambda reconstruction: None, writes=[f"{i}.npz"]),
    "TaperedCapsule": lambda i: d.TaperedCapsule(i, [i, 0, 0], [0, i, 0], i, 2 * i),
    "ViewObservation": lambda i: d.ViewObservation(np.full((i, 2), i, np.float32), np.full((i, 4), i, np.float32)),
}


@cache
def world() -> World:
    return World()


def character() -> d.Character:
    known, materials = world(), [d.Material()] * world().segmentation.region_count
    return d.make_character(known.actor, known.segmentation, known.body, known.proxies, materials, d.SolverSettings())


def character_state() -> d.CharacterState:
    simulator = d.CharacterSimulator(world().actor, world().segmentation, world().proxies)
    return simulator.start(simulator.pose(world().dofs[0]))


# Class -> one of it, where that takes arguments.
OWNERS = {
    "Character": character,
    "CharacterState": character_state,
    "RenderMesh": lambda: d.RenderMesh(SQUARE, TWO, [1, 1, 1]),
    "RiggedMesh": lambda: d.RiggedMesh(d.Mesh(SQUARE, TWO), [], np.ones((4, 1)), d.Skeleton([ELEMENTS["JointAnnotation"](1)])),
    "Motion": lambda: d.Motion(40.0, np.zeros((2, 6))),
    "SegmentInputs": lambda: d.SegmentInputs(d.MeshSequence(TWO, SQUARE[None])),
    "Reconstruction": lambda: d.Reconstruction("nowhere", "nowhere"),
}
# A list that is read as copies, of an object whose setter looks at what is in it.
COPIES = {("Player", "materials"), ("Player", "proxies")}


def settable(wanted: str) -> list:
    """(class, member, what is in it) of the members that can be set and are read as something `wanted` stands before."""
    found = []
    for name, cls in sorted(inspect.getmembers(_doublet, inspect.isclass)):
        for member, of in vars(cls).items():
            if isinstance(of, property) and of.fset is not None:
                read = (of.fget.__doc__ or "").split("->")[-1].strip()
                if read.startswith(wanted) and (name, member) not in COPIES:
                    found.append((name, member, read.split("_doublet.")[-1].rstrip("]")))
    return found


def owner(name: str):
    return OWNERS[name]() if name in OWNERS else getattr(d, name)()


def shown(element) -> dict:
    """Its properties as text, so that nothing of it is looked at twice."""
    names = [name for name, of in inspect.getmembers(type(element)) if isinstance(of, property) and name != "undone"]
    return {name: str(getattr(element, name)) for name in names}


def nested(read: list):
    """The first that is no list."""
    return nested(read[0]) if isinstance(read, list) else read


LISTS = settable("list[doublet._doublet.") + settable("list[list[doublet._doublet.")


def test_lists_of_objects_are_found():
    assert len(LISTS) >= 14, LISTS


@pytest.mark.parametrize("name, member, element", LISTS, ids=lambda value: value)
def test_an_element_stays_when_its_list_is_set(name, member, element):
    made = owner(name)
    of = (lambda *values: [list(values)]) if (name, member) == ("Observations", "views") else lambda *values: list(values)
    setattr(made, member, of(ELEMENTS[element](1)))
    held = nested(getattr(made, member))
    before = shown(held)
    assert shown(ELEMENTS[element](2)) != before
    for others in ([ELEMENTS[element](2)], [], [ELEMENTS[element](2)] * 40):
        setattr(made, member, of(*others))
        assert shown(held) == before
    del made
    gc.collect()
    churn = [ELEMENTS[element](2) for _ in range(40)]
    assert shown(held) == before and churn


ARRAYS = [
    (name, member)
    for name, member, read in settable("typing.Annotated[numpy.typing.NDArray")
    if '"[m,' in read and name != "ClothState"  # whose arrays cannot be set in another size
]


def test_arrays_are_found():
    assert len(ARRAYS) >= 20, ARRAYS


@pytest.mark.parametrize("name, member", ARRAYS, ids=lambda value: value)
def test_an_array_stays_when_one_of_another_size_is_set(name, member):
    made = owner(name)
    columns = getattr(made, member).shape[1:]
    setattr(made, member, np.full((3000, *(columns or ())), 7))
    held = getattr(made, member)
    for rows in (5000, 0, 3000, 2999):
        setattr(made, member, np.full((rows, *columns), 9))
        assert (held == 7).all() and held.shape[0] == 3000
    del made
    gc.collect()
    churn = [np.full(held.shape, 9.0) for _ in range(4)]
    assert (held == 7).all() and churn


def mesh(value: float) -> d.Mesh:
    return d.Mesh(np.full((3000, 3), value), TWO)


def test_arrays_of_a_member_stay_when_it_is_set():
    """And of a member of a member."""
    template = filled(d.Template(), mesh=mesh(7))
    drawn = filled(character(), body=mesh(7), actor=filled(OWNERS["RiggedMesh"](), mesh=mesh(7)))
    held = [template.mesh.vertices, drawn.body.vertices, drawn.actor.mesh.vertices]
    template.mesh, drawn.body, drawn.actor = d.Mesh(SQUARE, TWO), d.Mesh(SQUARE, TWO), OWNERS["RiggedMesh"]()
    churn = [np.full((3000, 3), 9.0) for _ in range(8)]
    assert all((array == 7).all() for array in held) and churn
    assert len(template.mesh.vertices) == len(drawn.actor.mesh.vertices) == 4


def test_lists_and_maps_of_arrays_stay():
    garment = filled(d.Garment(), widths=[np.full((3000, 3), 7.0)] * 2)
    session = filled(d.Session(), landmarks={"nose": [7, 7, 7]})
    held = [*garment.widths, session.landmarks["nose"]]
    garment.widths, session.landmarks = [np.full((2999, 3), 9.0)] * 40, {"ear": [9, 9, 9]}
    churn = [np.full((3000, 3), 9.0) for _ in range(8)], [d.Capsule([9, 9, 9], [9, 9, 9], 9, 9) for _ in range(40)]
    assert all((array == 7).all() for array in held) and churn


def test_a_member_is_set_to_itself():
    """And to an element of itself."""
    template = filled(d.Template(), mesh=mesh(7))
    template.mesh = template.mesh
    template.mesh.vertices = template.mesh.vertices
    assert (template.mesh.vertices == 7).all()
    session = filled(d.Session(), cameras=[ELEMENTS["SessionCamera"](i) for i in (1, 2)])
    first, second = session.cameras
    session.cameras = [second, first]
    assert [camera.name for camera in session.cameras] == ["camera 2", "camera 1"]


def test_lists_that_nobody_looks_into_are_gone():
    """An object whose list is set every frame does not grow: its elements would be as many as the frames."""
    resource = pytest.importorskip("resource")
    inputs, capsules = d.StepInputs(), [ELEMENTS["Capsule"](1)] * 1000
    inputs.capsules = capsules
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(1000):
        inputs.capsules = capsules  # 64 kB
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 20000  # kB, of 64000


def test_states_are_stepped_where_they_are():
    """What NumPy looks at is the state, alone and in a batch."""
    model = d.ClothModel(SQUARE, TWO, np.ones(4))
    solver, state = d.ClothSolver.create(model), d.ClothState(SQUARE)
    positions, velocities = state.positions, state.velocities
    solver.step(state, d.StepInputs(), d.Material())
    assert positions[0, 1] < 0 and np.shares_memory(positions, state.positions)
    solver.step_batch([state, d.ClothState(SQUARE)], [d.StepInputs()], [d.Material()] * 2, 1)
    assert np.shares_memory(positions, state.positions) and np.shares_memory(velocities, state.velocities)


def test_a_state_is_stepped_once():
    """It is lent to the solver, and would not come back whole."""
    world = World()
    frame = world.simulator.pose(world.dofs[0])
    state = world.simulator.start(frame)
    positions = state.regions[0].positions
    before = np.array(positions)
    with pytest.raises(ValueError, match="once"):
        world.simulator.step_batch([state] * 2, frame, frame, [[d.Material()]] * 2, 0.025)
    np.testing.assert_array_equal(positions, before)
    assert np.shares_memory(positions, state.regions[0].positions)


def test_a_mesh_has_the_colour_that_it_says():
    corners = np.array([[-0.6, -0.6, 0], [1.4, -0.6, 0], [-0.6, 1.4, 0]])
    mesh = d.RenderMesh(corners, [[0, 1, 2]], [1, 0, 0])
    blue, green, red = d.render([mesh], d.orbit_camera([0, 0, 0], 1, 0, 0, 64, 64), d.RenderOptions(floor=False))[32, 32]
    assert red > 100 and blue == green == 0 and "R G B" in d.RenderMesh.colour.__doc__


def test_a_picture_from_another_process_is_one():
    picture = pickle.loads(pickle.dumps(np.full((4, 6, 3), 7, np.uint8)))  # its type is an object of its own
    np.testing.assert_array_equal(d.CameraView(picture).image, picture)


@pytest.mark.filterwarnings("ignore:invalid value encountered in cast")
def test_indices_are_whole():
    corners = np.eye(4, 3)
    for faces in ([[0, 1.5, 2]], [[0, 1, np.nan]], np.array([[2**32, 1, 2]])):
        with pytest.raises(TypeError):
            d.Mesh(corners, faces)
    np.testing.assert_array_equal(d.Mesh(corners, [[0.0, 1, 2]]).faces, [[0, 1, 2]])
