"""The garment for other solvers: what its numbers mean, in a solver that knows nothing but them."""

import json

import doublet as d
import numpy as np
import pytest
from doublet.cli import program as cli
from doublet.export import cloth_usd
from doublet.export.cloth import AIR, engines_of, export_cloth
from doublet.export.cloth_stiffness import springs_of

DENSITY, G = 0.3, 9.81
FRAMES = 80
DT = 1 / 40


# --- N/m, N m


def settled(model, material):
    """(N, 3) where our solver leaves it."""
    solver, state, inputs = d.ClothSolver.create(model), d.ClothState(model.rest), d.StepInputs()
    inputs.targets = inputs.previous_targets = model.rest
    for _ in range(200):
        solver.step(state, inputs, material)
    return np.asarray(state.positions)


def still_air(**values):
    return d.Material(d_n=0, d_t=8, k_friction=0, k_damping=0, **values)


def test_a_spring_carries_its_weight():
    """A vertex on two edges under 45 degrees: the force of both, as the file has it, is its weight."""
    rest = np.array([[-0.1, 1, 0], [0.1, 1, 0], [0, 0.9, 0]])
    options = d.ClothOptions(iterations=200, substeps=8, over_relaxation=1)
    model = d.ClothModel(rest, [[0, 1, 2]], [0, 0, 1], options)
    material = still_air(k_stretch=0.9, k_bend=0)
    springs, places = springs_of(model, material, DENSITY), settled(model, material)
    assert springs.edges.tolist() == [[0, 2], [1, 2]] and not springs.rigid
    assert places[2, 1] < 0.8995
    force = np.zeros(3)
    for (a, b), length, stiffness in zip(springs.edges, springs.lengths, springs.stretch):
        way = places[a] - places[b]
        force += stiffness * (np.linalg.norm(way) - length) * way / np.linalg.norm(way)
    mass = DENSITY / model.inverse_masses[2]
    np.testing.assert_allclose(force, [0, mass * G, 0], atol=0.01 * mass * G)


def test_a_hinge_carries_its_weight():
    """A flap on a held edge: the hinge's moment is that of its weight."""
    rest = np.array([[0, 1, -0.1], [0, 1, 0.1], [-0.1, 1, 0], [0.1, 1, 0]])
    options = d.ClothOptions(iterations=100, substeps=4)
    model = d.ClothModel(rest, [[0, 1, 2], [1, 0, 3]], [0, 0, 0, 1], options)
    material = still_air(k_stretch=1, k_bend=0.5)
    springs, places = springs_of(model, material, DENSITY), settled(model, material)
    angle = np.arctan2(1 - places[3, 1], places[3, 0])
    assert springs.hinges.tolist() == [[0, 1, 2, 3]] and 0.02 < angle < 1
    moment = DENSITY / model.inverse_masses[3] * G * places[3, 0]
    assert springs.bend[0] * angle == pytest.approx(moment, rel=0.02)


@pytest.mark.parametrize(("engine", "name"), [("chaos", "drag_coefficient"), ("physx_particle_cloth", "drag")])
def test_drag_carries_the_weight_of_what_falls(engine, name):
    """A free sheet, broadside: half of the air's density times speed squared, by the coefficient."""
    x, z = np.meshgrid([-0.1, 0, 0.1], [-0.1, 0, 0.1])
    rest = np.column_stack([x.ravel(), np.zeros(9), z.ravel()])
    corners = [(a, a + 3, a + 1, a + 4) for a in (0, 1, 3, 4)]
    model = d.ClothModel(rest, [f for a, b, c, e in corners for f in ([a, b, c], [b, e, c])], np.ones(9))
    material = d.Material(d_n=4, d_t=0, k_friction=0, k_damping=0)
    solver, state = d.ClothSolver.create(model), d.ClothState(rest)
    for _ in range(80):
        solver.step(state, d.StepInputs(targets=rest), material)
    speed = np.linalg.norm(np.mean(state.velocities, axis=0))
    coefficient = engines_of(springs_of(model, material, DENSITY), model, material, DENSITY)[engine][name]
    assert 0.5 * AIR * coefficient * speed**2 == pytest.approx(DENSITY * G, rel=0.03)


# --- the files


def skirt():
    """A tube of 12 x 9 vertices that hangs from its upper rings on a pelvis, over one capsule."""
    around, rows = 12, 9
    turns = 2 * np.pi * np.arange(around) / around
    height = np.linspace(1, 0.6, rows)
    radius = np.linspace(0.14, 0.22, rows)
    vertices = np.array([[r * np.cos(a), y, r * np.sin(a)] for y, r in zip(height, radius) for a in turns])
    faces = []
    for i in range(rows - 1):
        for j in range(around):
            a, b, c, e = (x + y for x in (i * around, (i + 1) * around) for y in (j, (j + 1) % around))
            faces += [[a, b, c], [b, e, c]]
    clothness = np.repeat(np.clip((np.arange(rows) - 0.0) / 2, 0, 1), around)  # pinned, blended, free
    marks = [d.JointAnnotation("pelvis", "", [0, 1, 0], 6), d.JointAnnotation("spine", "pelvis", [0, 1.2, 0], 3)]
    skeleton = d.Skeleton(marks)
    weights = np.zeros((len(vertices), len(skeleton.joint_names)))
    weights[:, 0] = 1
    actor = d.RiggedMesh(d.Mesh(vertices, faces), [1] * len(faces), weights, skeleton)
    segmentation = d.Segmentation(np.full(len(vertices), 0.01), clothness, np.where(clothness > 0, 0, -1).astype(np.int32))
    capsule = d.TaperedCapsule(0, [0, -0.5, 0], [0, 0, 0], 0.07, 0.1)
    material = d.Material(d_n=2, d_t=1, k_bend=0.3, k_stretch=0.98, k_friction=0, k_damping=0)
    options = d.ClothOptions(self_collision=False, iterations=40, thickness=0.005)
    body = d.BodyFit()
    return d.make_character(actor, segmentation, body, [capsule], [material], d.SolverSettings(DT, options))


def swing(character):
    """Two seconds to and fro, with a turn."""
    t = np.arange(FRAMES) * DT
    dofs = np.zeros((FRAMES, len(character.actor.skeleton.dof_names)))
    dofs[:, character.actor.skeleton.dof_names.index("pelvis.tx")] = 0.15 * np.sin(4 * t) * np.minimum(t, 1)
    dofs[:, character.actor.skeleton.dof_names.index("pelvis.ry")] = 1.5 * np.sin(3 * t) * np.minimum(t, 1)
    return d.Motion(1 / DT, dofs)


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    character, folder = skirt(), tmp_path_factory.mktemp("cloth")
    files = export_cloth(character, folder, DENSITY, swing(character))
    assert [path.name for path in files[:2]] == ["cloth.json", "motion.json"]
    return character, files


def read(files):
    return [json.loads(path.read_text()) for path in files[:2]]


def explicit(cloth, motion, stretch_factor=1.0, bend_factor=1.0, steps=120):
    """(T, N, 3): forces in N, masses in kg and Newton's law in small steps; the capsule pushes out what is in it."""
    garment, played = cloth["garments"][0], motion["garments"][0]
    rest, faces, mass = (np.array(garment[name]) for name in ("rest_vertices", "faces", "masses"))
    (edges, lengths), (hinges, angles) = (
        (np.array(garment[group][a]), np.array(garment[group][b]))
        for group, a, b in (("stretch", "edges", "rest_lengths"), ("bend", "hinges", "rest_angles"))
    )
    ke, kb = (f * np.array(garment[g]["stiffness"]) for g, f in (("stretch", stretch_factor), ("bend", bend_factor)))
    held, spring = np.array(played["attached"]), np.array(garment["attachment"]["spring"])
    pinned = np.array(garment["attachment"]["clothness"])[held] == 0
    targets, x = np.array(played["targets"]), np.array(played["simulated"][0])
    v, material, h = np.zeros_like(x), garment["material"], cloth["frame_seconds"] / steps
    (capsule,), thickness = cloth["capsules"], cloth["contact"]["thickness"]
    ends, radii = np.array([capsule["p0"], capsule["p1"]]), (capsule["r0"] + thickness, capsule["r1"] + thickness)
    result = [x.copy()]
    for t in range(1, motion["frames"]):
        for s in np.arange(1, steps + 1) / steps:
            force = np.zeros_like(x)
            way = x[edges[:, 1]] - x[edges[:, 0]]
            size = np.linalg.norm(way, axis=1)
            pull = (ke * (size - lengths) / size)[:, None] * way
            np.add.at(force, edges[:, 0], pull)
            np.add.at(force, edges[:, 1], -pull)
            e, a, b = (x[hinges[:, k]] - x[hinges[:, 0]] for k in (1, 2, 3))
            n1, n2, length = np.cross(e, a), np.cross(b, e), np.linalg.norm(e, axis=1)
            angle = np.arctan2(-length * np.sum(n1 * b, axis=1), np.sum(n1 * n2, axis=1)) - angles
            g2, g3 = (-(length / np.sum(n * n, axis=1))[:, None] * n for n in (n1, n2))
            p, q = ((np.sum(w * e, axis=1) / length**2)[:, None] for w in (a, b))
            for k, g in enumerate(((p - 1) * g2 + (q - 1) * g3, -p * g2 - q * g3, g2, g3)):
                np.add.at(force, hinges[:, k], -(kb * angle)[:, None] * g)
            target = (1 - s) * targets[t - 1] + s * targets[t]
            force[held] += spring[held, None] * (target - x[held])
            across = np.cross(x[faces[:, 1]] - x[faces[:, 0]], x[faces[:, 2]] - x[faces[:, 0]])
            normal = np.zeros_like(x)
            for k in range(3):
                np.add.at(normal, faces[:, k], across)
            normal /= np.linalg.norm(normal, axis=1, keepdims=True)
            along = np.sum(v * normal, axis=1, keepdims=True)
            drag = (material["d_n"] * np.abs(along) * along * normal + material["d_t"] * (v - along * normal)) / 2
            v += h * (force / mass[:, None] + cloth["gravity"] - drag)
            x = x + h * v
            centre = np.array(motion["joints"]["translations"][t - 1]) * (1 - s) + s * np.array(
                motion["joints"]["translations"][t]
            )
            push_out(x, v, ends + centre[0], radii)
            x[held[pinned]], v[held[pinned]] = target[pinned], 0
        result.append(x.copy())
    return np.array(result)


def push_out(x, v, ends, radii):
    """The capsule stands upright here, and slides with the pelvis."""
    axis = ends[1] - ends[0]
    s = np.clip((x - ends[0]) @ axis / (axis @ axis), 0, 1)[:, None]
    away = x - (ends[0] + s * axis)
    distance, radius = np.linalg.norm(away, axis=1, keepdims=True), (1 - s) * radii[0] + s * radii[1]
    inside = (distance < radius)[:, 0]
    normal = away / distance
    x[inside] += ((radius - distance) * normal)[inside]
    v[inside] -= (np.minimum(np.sum(v * normal, axis=1, keepdims=True), 0) * normal)[inside]


def cm_between(a, b):
    return 100 * np.sqrt(np.mean(np.sum((a - b) ** 2, axis=-1)))


@pytest.mark.slow
def test_an_explicit_solver_in_si_units_makes_the_same_cloth(exported):
    """Two seconds. The same with a tenth of the stiffnesses is another cloth."""
    cloth, motion = read(exported[1])
    ours = np.array(motion["garments"][0]["simulated"])
    assert np.ptp(ours[:, -1, 0]) > 0.1
    assert cm_between(explicit(cloth, motion), ours) < 1.0
    assert cm_between(explicit(cloth, motion, stretch_factor=0.1), ours) > 3.0


def test_masses_and_springs_grow_with_the_density(exported, tmp_path):
    character, files = exported
    light = json.loads(export_cloth(character, tmp_path, DENSITY / 2)[0].read_text())["garments"][0]
    heavy = read(files)[0]["garments"][0]
    np.testing.assert_allclose(np.array(light["masses"]) * 2, heavy["masses"], rtol=1e-4)
    for group in ("stretch", "bend"):
        np.testing.assert_allclose(np.array(light[group]["stiffness"]) * 2, heavy[group]["stiffness"], rtol=1e-4)
    area = d.face_areas(np.array(heavy["rest_vertices"]), heavy["faces"]).sum()
    assert sum(heavy["masses"]) == pytest.approx(DENSITY * area, rel=1e-3)


def test_the_skeleton_carries_the_capsules(exported):
    """The joints of a frame, as translations and quaternions x y z w, are those of the skeleton."""
    character, files = exported
    cloth, motion = read(files)
    skeleton, dofs = character.actor.skeleton, swing(character).dofs[40]
    posed = d.CharacterSimulator(character.actor, character.segmentation, character.proxies).pose(dofs).capsules[0]
    capsule = cloth["capsules"][0]
    x, y, z, w = motion["joints"]["rotations"][40][capsule["joint"]]
    axis = np.array([x, y, z])
    for end, place in ((capsule["p0"], posed.p0), (capsule["p1"], posed.p1)):
        turned = np.array(end) + 2 * np.cross(axis, np.cross(axis, end) + w * np.array(end))
        np.testing.assert_allclose(turned + motion["joints"]["translations"][40][capsule["joint"]], place, atol=1e-4)
    assert [joint["name"] for joint in cloth["skeleton"]] == skeleton.joint_names


def test_rigid_edges_get_a_stiffness_that_is_said_to_be_one(exported, tmp_path):
    character = skirt()
    character.materials = [d.Material(k_stretch=1)]
    stretch = json.loads(export_cloth(character, tmp_path)[0].read_text())["garments"][0]["stretch"]
    assert stretch["rigid"] and stretch["rigid_gives"] == 0.005
    assert 10 < min(stretch["stiffness"]) < 1e4


# --- USD


def test_usd_is_what_usdchecker_wants(exported):
    from pxr import Usd, UsdValidation

    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    errors = UsdValidation.ValidationContext(validators).Validate(Usd.Stage.Open(str(exported[1][2])))
    assert [error.GetMessage() for error in errors] == []


def test_usd_has_kinematic_tapered_capsules_where_they_are(exported):
    from pxr import Usd, UsdGeom, UsdPhysics

    character, files = exported
    stage = Usd.Stage.Open(str(files[2]))
    body, shape = (stage.GetPrimAtPath(path) for path in ("/cloth/bodies/pelvis", "/cloth/bodies/pelvis/capsule0"))
    assert UsdPhysics.RigidBodyAPI(body).GetKinematicEnabledAttr().Get() and shape.HasAPI(UsdPhysics.CollisionAPI)
    capsule = UsdGeom.Capsule_1(shape)
    assert capsule.GetRadiusBottomAttr().Get() == pytest.approx(0.07)
    assert capsule.GetRadiusTopAttr().Get() == pytest.approx(0.1)
    posed = d.CharacterSimulator(character.actor, character.segmentation, character.proxies).pose(swing(character).dofs[40])
    half = capsule.GetHeightAttr().Get() / 2
    for y, place in ((-half, posed.capsules[0].p0), (half, posed.capsules[0].p1)):
        found = UsdGeom.Xformable(shape).ComputeLocalToWorldTransform(40).Transform((0, y, 0))
        np.testing.assert_allclose(found, place, atol=1e-4)


def test_usd_has_a_body_of_each_joint_whatever_its_name(exported, tmp_path):
    """USD's names are of ASCII letters: of these nothing is left but their number."""
    from pxr import Usd

    cloth, motion = read(exported[1])
    for joint, name in zip(cloth["skeleton"], ("骨盤", "背骨", "左腕", "右腕")):
        joint["name"] = name
    cloth["capsules"] += [{**cloth["capsules"][0], "joint": 1}]
    cloth_usd.write_cloth_usd(tmp_path / "cloth.usda", cloth, motion)
    stage = Usd.Stage.Open(str(tmp_path / "cloth.usda"))  # whose end is that of what is in it
    bodies = stage.GetPrimAtPath("/cloth/bodies").GetChildren()
    assert [len(body.GetChildren()) for body in bodies] == [len(exported[0].proxies), 1]


# --- the command


def test_the_command(tmp_path, capsys):
    skirt().write(tmp_path / "character.glb")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "motion.json").write_text("{}")  # of an earlier export
    assert cli.main(["export-cloth", str(tmp_path / "character.glb"), "-o", str(tmp_path / "out"), "--quiet"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0] == str(tmp_path / "out" / "cloth.json") and not (tmp_path / "out" / "motion.json").exists()


@pytest.mark.parametrize("density", ["0", "-1", "nan", "inf"])
def test_no_density_is_refused(tmp_path, capsys, density):
    skirt().write(tmp_path / "character.glb")
    arguments = ["export-cloth", str(tmp_path / "character.glb"), "-o", str(tmp_path / "out"), f"--areal-density={density}"]
    assert cli.main(arguments) == 1
    assert "areal_density: expected kg/m^2 above 0, found" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
