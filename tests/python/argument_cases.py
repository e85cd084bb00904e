"""Calls of the public functions with good arguments, and what is done to spoil an argument of each kind."""

from __future__ import annotations

import copy

import doublet as d
import numpy as np
from doublet.common.renamed import ATTRIBUTES

NUMBERS = {"nan": np.nan, "inf": np.inf, "-inf": -np.inf, "1e300": 1e300}


def calls(world, folder) -> dict:
    """Name -> (function, good arguments). Every argument is spoilt in turn."""
    w = world
    v, f = np.array(w.mesh.vertices), np.array(w.mesh.faces)
    scene, transforms = d.RayScene(w.mesh), w.skeleton.forward_kinematics(w.dofs[0])
    posed = w.simulator.pose(w.dofs[0])
    options = d.ClothOptions(self_collision=False)
    cloth = d.ClothModel(v, f, w.cloth, options)
    solver = d.ClothSolver.create(cloth)
    clip = {
        "joint_names": ["pelvis", "spine"], "joint_parents": [-1, 0], "offsets": np.array([[0, 1, 0], [0, 0.2, 0]]),
        "positions": np.zeros((3, 2, 3)), "rotations": np.tile([1.0, 0, 0, 0], (3, 2, 1)), "fps": 40.0,
    }  # fmt: skip
    display, renderer = d.DisplaySurface(w.character), d.CharacterRenderer(w.character)
    rest, body = np.array(w.character.high.vertices), np.array(w.character.body.vertices)
    tracker, extractor = d.FeatureTracker.create(), d.SilhouetteExtractor.create()
    green = np.zeros((48, 48, 3), np.uint8)
    green[..., 1] = 200
    features = d.Features(np.zeros((2, 2), np.float32), np.zeros((2, 4)))
    objective = d.MaterialObjective(
        w.simulator, w.performance, w.observations, 1 / 40, d.EnergyOptions(settle_frames=1), d.ParameterSpace(names=["d_n"])
    )
    fit = d.FitOptions(max_evaluations=4, population=4, initial_design_size=4)
    fit.energy, fit.space = d.EnergyOptions(settle_frames=1), d.ParameterSpace(names=["d_n"])
    cma = d.create_cma_es(2, d.CmaEsOptions(population=4))
    sequence, valid = w.performance.surface, [1] * len(f)
    masks, pictures = [w.mask] * 2, [w.picture] * 2
    animation = d.animate(w.character, w.motion, d.AnimateOptions(high=False, settle_seconds=0.05))
    quick = d.AnimateOptions(settle_seconds=0.05)
    player = d.Player(w.character, quick)
    small, coarse = d.GarmentOptions(vertices=60), d.ViewScanOptions(cell=0.03, poisson_depth=5)
    clothed = {"actor": w.actor, "segmentation": w.segmentation}
    reference = {"simulator": w.simulator, "performance": w.performance, "observations": w.observations, "dt": 0.025}

    def stepped(positions, targets, material, dt):
        solver.step(d.ClothState(positions), d.StepInputs(targets=targets, dt=dt), material)

    def stepped_each(states, targets, materials):
        solver.step_batch([d.ClothState(p) for p in states], [d.StepInputs(targets=targets)], materials)

    def state_at(positions):
        state = w.simulator.start(posed)
        regions = state.regions
        regions[0].positions = positions
        state.regions = regions
        return state

    on_cloth = np.array(w.simulator.start(posed).regions[0].positions)
    return {
        "face_normals": (d.face_normals, {"vertices": v, "faces": f}),
        "vertex_normals": (d.vertex_normals, {"vertices": v, "faces": f}),
        "face_areas": (d.face_areas, {"vertices": v, "faces": f}),
        "vertex_areas": (d.vertex_areas, {"vertices": v, "faces": f}),
        "rasterize": (d.rasterize, {"vertices": v, "faces": f, "camera": w.cameras[0], "face_valid": [1] * len(f)}),
        "self_intersecting_faces": (d.self_intersecting_faces, {"mesh": w.mesh}),
        "distances_to_surface": (d.distances_to_surface, {"points": v, "surface": w.mesh, "face_valid": [1] * len(f)}),
        "visible_vertices": (d.visible_vertices, {"vertices": v, "faces": f, "cameras": w.cameras, "tolerance": 0.01}),
        "RayScene": (d.RayScene, {"mesh": w.mesh, "face_valid": [1] * len(f)}),
        "RayScene.cast": (scene.cast, {"origins": v + 1, "directions": v - 1, "min_distance": 0.0}),
        "RayScene.closest": (scene.closest, {"points": v + 1}),
        "dual_quaternion_skinning": (
            d.dual_quaternion_skinning, {"rest": v, "weights": w.weights, "world_from_rest": transforms},
        ),
        "Skeleton": (d.Skeleton, {"marks": w.marks}),
        "Skeleton.find": (w.skeleton.find, {"name": "spine"}),
        "Skeleton.forward_kinematics": (w.skeleton.forward_kinematics, {"dofs": w.dofs[0]}),
        "Skeleton.joint_positions": (w.skeleton.joint_positions, {"dofs": w.dofs[0]}),
        "Camera.resized": (w.cameras[0].resized, {"width": 24, "height": 24}),
        "MeshSequence": (lambda frames: d.MeshSequence(f, frames), {"frames": np.stack([v, v])}),
        "ViewObservation": (
            d.ViewObservation, {"contour": np.zeros((3, 2), np.float32), "matches": np.zeros((3, 4), np.float32)},
        ),
        "canonical_frames": (d.canonical_frames, {"actor": w.actor, "performance": w.performance}),
        "dress": (d.dress, {"actor": w.actor, "segmentation": w.segmentation, "garment": w.garment}),
        "dress performance": (d.dress, {"performance": w.performance, "actor": w.actor, "garment": w.garment}),
        "pose_surface": (d.pose_surface, {"actor": w.actor, "dofs": w.dofs[0], "offset": np.zeros_like(v)}),
        "trace_outline": (d.trace_outline, {"mask": w.mask, "margin": 2}),
        "find_limbs": (d.find_limbs, {"skeleton": w.skeleton}),
        "Features": (d.Features, {"points": np.zeros((2, 2), np.float32), "descriptors": np.zeros((2, 4))}),
        "FeatureTracker.detect": (tracker.detect, {"image": w.picture, "mask": w.mask}),
        "FeatureTracker.match": (tracker.match, {"previous": features, "current": features, "reach": 5.0}),
        "SilhouetteExtractor.train": (extractor.train, {"camera": 0, "images": [green, green]}),
        "SilhouetteExtractor.extract": (
            lambda camera, image: [extractor.train(0, [green]), extractor.extract(camera, image)], {"camera": 0, "image": green},
        ),
        "SilhouetteExtractor.refine": (
            lambda image, mask: extractor.refine(0, image, mask), {"image": green, "mask": green[..., 1]},
        ),
        "heat_weights": (d.heat_weights, {"mesh": w.mesh, "face_valid": valid, "skeleton": w.skeleton}),
        "summarise_template": (d.summarise_template, {"surface": template(w), "scan": w.mesh}),
        "rig_template": (d.rig_template, {"surface": template(w), "joints": w.marks}),
        "scan_from_views": (
            lambda rig, masks: d.scan_from_views(rig, [d.CameraView(mask=m) for m in masks], coarse), ring_of_discs(),
        ),
        "refine_rest_pose": (
            d.refine_rest_pose, {"actor": w.actor, "performance": w.performance, "rigid": np.ones(len(v), np.uint8)},
        ),
        "find_start_frame": (
            lambda scan, rig: d.find_start_frame(scan, rig, Discs()), {"scan": w.mesh, "rig": ring_of_discs()["rig"]},
        ),
        "write_segmentation_paint": (
            lambda painted: d.write_segmentation_paint(folder, painted, len(v)), {"painted": np.full(len(v), -1, np.int32)},
        ),
        "align_scan": (d.align_scan, {"scan": w.mesh, "hull": w.mesh}),
        "triangulate": (d.triangulate, {"cameras": ring_of_discs()["rig"], "seen": np.full((4, 3), 47.5)}),
        "calibrate_from_person": (
            lambda seen: d.calibrate_from_person([d.PersonView("first", (96, 96), seen, 180.0), *seen_walking()[1:]]),
            {"seen": seen_joints(ring_of_discs()["rig"][0])},
        ),
        "silhouette_hull": (d.silhouette_hull, {"mask": ring_of_discs()["masks"][0]}),
        "build_template": (lambda scan: d.build_template(scan, d.TemplateOptions(poisson_depth=6)), {"scan": w.mesh}),
        "cloth_prior": (d.cloth_prior, {"actor": w.actor}),
        "dressed_all_over": (d.dressed_all_over, {"actor": w.actor}),
        "mirrored_vertices": (d.mirrored_vertices, {"actor": w.actor}),
        "summarise_segmentation": (
            d.summarise_segmentation, {"pose": w.mesh, "face_valid": valid, "segmentation": w.segmentation},
        ),
        "segment_cloth": (d.segment_cloth, {"sequence": sequence, "face_valid": valid}),
        "ClothSegmenter.segment": (
            lambda **given: d.ClothSegmenter.create().segment(d.SegmentInputs(**given)),
            {"surface": sequence, "face_valid": valid, "prior": np.zeros(len(v)), "gap": np.zeros(len(v))},
        ),
        "segment_performance": (
            lambda **given: d.segment_performance(**given, segmenter=d.ClothSegmenter.create()),
            {"actor": w.actor, "performance": w.performance, "body": w.body.body},
        ),
        "apply_corrections": (
            d.apply_corrections,
            {"pose": w.mesh, "face_valid": valid, "found": w.segmentation, "painted": np.full(len(v), -1)},
        ),
        "cloth_slack": (d.cloth_slack, {"body": w.body.body, "canonical": np.stack([v, v])}),
        "mesh_garment": (
            lambda **given: d.mesh_garment(**given, options=small), dict(**clothed, body=w.body.body, captured=sequence),
        ),
        "GarmentMesher.mesh": (d.GarmentMesher.create(small).mesh, dict(**clothed, body=w.body.body, captured=sequence)),
        "summarise_garment": (d.summarise_garment, {"garment": w.garment}),
        "body_regions": (d.body_regions, dict(fit=w.body, **clothed)),
        "fit_proxies": (d.fit_proxies, dict(fit=w.body, **clothed)),
        "proxy_statistics": (d.proxy_statistics, dict(capsules=w.proxies, fit=w.body, **clothed)),
        "capsule_mesh": (d.capsule_mesh, {"p0": np.zeros(3), "p1": np.ones(3), "r0": 0.1, "r1": 0.2}),
        "reduce_faces": (
            lambda vertices: d.reduce_faces(vertices, d.TexturedFaces(f, np.zeros((0, 2))), 4), {"vertices": v},
        ),
        "spring_constant": (d.spring_constant, {"k": 0.5, "response": 3.0}),
        "stiffness_of_spring": (d.stiffness_of_spring, {"constant": 200.0, "response": 3.0}),
        "ClothModel": (d.ClothModel, {"rest": v, "faces": f, "clothness": w.cloth}),
        "ClothSolver.step": (stepped, {"positions": v, "targets": v, "material": w.material, "dt": 0.02}),
        "ClothSolver.step_batch": (stepped_each, {"states": [v, v], "targets": v, "materials": [w.material] * 2}),
        "CharacterSimulator": (d.CharacterSimulator, dict(**clothed, proxies=w.proxies)),
        "CharacterSimulator.pose": (w.simulator.pose, {"dofs": w.dofs[0]}),
        "CharacterSimulator.start": (lambda surface: w.simulator.start(posed, surface), {"surface": v}),
        "CharacterSimulator.settle": (
            lambda positions, materials, dt, frames: w.simulator.settle(state_at(positions), posed, materials, dt, frames),
            {"positions": on_cloth, "materials": [w.material], "dt": 0.02, "frames": 2},
        ),
        "CharacterSimulator.step": (
            lambda positions, materials, dt: w.simulator.step(state_at(positions), posed, posed, materials, dt),
            {"positions": on_cloth, "materials": [w.material], "dt": 0.02},
        ),
        "CharacterSimulator.step_batch": (
            lambda positions, materials, dt: w.simulator.step_batch([state_at(positions)], posed, posed, [materials], dt),
            {"positions": on_cloth, "materials": [w.material], "dt": 0.02},
        ),
        "CharacterSimulator.surface": (
            lambda positions: w.simulator.surface(state_at(positions), posed), {"positions": on_cloth},
        ),
        "simulate_reference": (
            d.simulate_reference,
            {"simulator": w.simulator, "performance": w.performance, "materials": [w.material], "dt": 0.02, "settle_frames": 2},
        ),
        "material_energy": (d.material_energy, dict(**reference, materials=[w.material])),
        "estimate_material": (lambda **given: d.estimate_material(**given, options=fit), reference),
        "MaterialObjective": (d.MaterialObjective, reference),
        "MaterialObjective.energies": (objective.energies, {"materials": [[w.material]]}),
        "MaterialObjective.terms": (objective.terms, {"materials": [w.material]}),
        "MaterialObjective.surface_terms": (objective.surface_terms, {"surfaces": [v, v, v]}),
        "MaterialObjective.surface_energy": (objective.surface_energy, {"surfaces": [v, v, v]}),
        "MaterialObjective.evaluate": (objective.evaluate, {"samples": np.full((4, 1), 0.5)}),
        "posterior_of": (
            d.posterior_of,
            {"samples": np.array([[0.1], [0.5], [0.9]]), "energies": np.array([3.0, 2.0, 4.0]), "noise": 0.1, "draws": 4},
        ),
        "FitFinding": (d.FitFinding, {"kind": "guess", "parameter": "d_n", "value": 1.0, "low": 0.0, "high": 2.0}),
        "choose_widths": (
            d.choose_widths,
            {"garment": d.mesh_garment(w.actor, w.segmentation, d.Mesh(), w.performance.surface, small)},
        ),
        "width_variants": (
            d.width_variants,
            {"garment": d.mesh_garment(w.actor, w.segmentation, d.Mesh(), w.performance.surface, small)},
        ),
        "ParameterSpace.material": (d.ParameterSpace().material, {"unit": np.full(len(d.ParameterSpace().names), 0.5)}),
        "Optimizer.tell": (cma.tell, {"samples": np.array(cma.ask()), "energies": np.ones(4)}),
        "create_cma_es": (d.create_cma_es, {"dimension": 2}),
        "create_bayesian": (d.create_bayesian, {"dimension": 2}),
        "create_simulated_annealing": (d.create_simulated_annealing, {"dimension": 2}),
        "make_character": (
            d.make_character,
            dict(
                **clothed, body=w.body, proxies=w.proxies, materials=[w.material], solver=d.SolverSettings(1 / 40), high=w.high,
                high_valid=[1] * len(w.high.faces),
            ),
        ),
        "build_display_mesh": (d.build_display_mesh, dict(**clothed, high=w.high, body=w.body.body)),
        "DisplaySurface": (d.DisplaySurface, {"character": w.character}),
        "DisplaySurface.apply": (display.apply, {"surface": v}),
        "DisplaySurface.sample": (display.sample, {"values": np.ones((len(v), 2))}),
        "SurfaceTransfer": (
            d.SurfaceTransfer,
            {"coarse": w.mesh, "coarse_valid": valid, "fine": w.high, "fine_valid": [1] * len(w.high.faces)},
        ),
        "SurfaceTransfer.apply": (
            d.SurfaceTransfer(w.mesh, valid, w.high, [1] * len(w.high.faces)).apply, {"coarse": v},
        ),
        "hidden_faces": (d.hidden_faces, {"character": w.character}),
        "drawn_faces": (d.drawn_faces, {"character": w.character}),
        "render": (d.render, {"meshes": [d.RenderMesh(v, f)], "camera": w.cameras[0]}),
        "render arrays": (
            lambda vertices, faces, colours, face_valid: d.render(
                [d.RenderMesh(vertices, faces, [1, 1, 1], colours, face_valid)], w.cameras[0]
            ),
            {"vertices": v, "faces": f, "colours": np.ones_like(v), "face_valid": [1] * len(f)},
        ),
        "orbit_camera": (
            d.orbit_camera, {"target": np.zeros(3), "radius": 1.0, "azimuth": 0.0, "elevation": 0.0, "width": 32, "height": 32},
        ),
        "CharacterRenderer": (d.CharacterRenderer, {"character": w.character}),
        "CharacterRenderer.meshes": (renderer.meshes, {"surface": v, "high": rest, "body": body}),
        "CharacterRenderer.render": (renderer.render, {"surface": v, "high": rest, "body": body, "camera": w.cameras[0]}),
        "texture_character": (
            lambda surface, cameras, images, masks: d.texture_character(
                copy_of(w.character, folder), surface, cameras, images, masks, d.TextureOptions(size=64)
            ),
            {"surface": v, "cameras": w.cameras, "images": pictures, "masks": masks},
        ),
        "texture_character_from_take": (
            lambda surfaces, cameras: d.texture_character_from_take(
                copy_of(w.character, folder), surfaces, cameras, lambda frame: (pictures, masks), d.TextureOptions(size=64)
            ),
            {"surfaces": [v, v], "cameras": w.cameras},
        ),
        "sample_colours": (
            d.sample_colours,
            {"mesh": w.mesh, "face_valid": valid, "cameras": w.cameras, "images": pictures, "masks": masks},
        ),
        "SourceMotion": (d.SourceMotion, clip),
        "plant_feet": (lambda motion: d.plant_feet(w.skeleton, motion), {"motion": w.motion}),
        "resolve_arm_penetration": (
            lambda motion: d.resolve_arm_penetration(w.character, motion),
            {"motion": w.motion},
        ),
        "find_contacts": (lambda motion: d.find_contacts(w.skeleton, motion), {"motion": w.motion}),
        "resample": (lambda motion: d.resample(w.skeleton, motion, 20.0), {"motion": w.motion}),
        "write_bvh": (lambda motion: d.write_bvh(folder / "m.bvh", w.skeleton, motion), {"motion": w.motion}),
        "animate": (
            lambda character, motion: d.animate(character, motion, d.AnimateOptions(settle_seconds=0.05)),
            {"character": w.character, "motion": w.motion},
        ),
        "animate_each": (
            lambda character, motion: d.animate_each(character, motion, print, d.AnimateOptions(settle_seconds=0.05)),
            {"character": w.character, "motion": w.motion},
        ),
        "Player": (lambda character: d.Player(character, quick), {"character": w.character}),
        "Player.reset": (player.reset, {"dofs": w.motion.dofs[0]}),
        "Player.step": (player.step, {"dofs": w.motion.dofs[1], "seconds": 0.02}),
        "Player.teleport": (player.teleport, {"dofs": w.motion.dofs[0]}),
        "step_players": (
            lambda dofs, seconds: d.step_players([player], [dofs], seconds), {"dofs": w.motion.dofs[0], "seconds": 0.02}
        ),
        "write_actor": (lambda actor: d.write_actor(folder / "a.npz", actor), {"actor": w.actor}),
        "write_performance": (
            lambda performance: d.write_performance(folder / "p.npz", performance), {"performance": w.performance},
        ),
        "write_segmentation": (
            lambda segmentation: d.write_segmentation(folder / "c.npz", segmentation), {"segmentation": w.segmentation},
        ),
        "write_garment": (lambda garment: d.write_garment(folder / "g.npz", garment), {"garment": w.garment}),
        "write_body": (lambda fit: d.write_body(folder / "b.npz", fit), {"fit": w.body}),
        "write_proxies": (
            lambda capsules: d.write_proxies(folder / "p.json", capsules, w.skeleton), {"capsules": w.proxies},
        ),
        "write_observations": (
            lambda observations: d.write_observations(folder / "o.npz", observations), {"observations": w.observations},
        ),
        "write_simulated": (
            lambda frames, actor_vertices: d.write_simulated(folder / "s.npz", frames, actor_vertices),
            {"frames": np.stack([v, v]), "actor_vertices": len(v)},
        ),
        "write_calibration": (lambda cameras: d.write_calibration(folder / "c.yml", cameras), {"cameras": w.cameras}),
        "write_mesh": (lambda mesh: d.write_mesh(folder / "m.ply", mesh), {"mesh": w.mesh}),
        "Character.write": (lambda character: character.write(folder / "c.glb"), {"character": w.character}),
        "write_baked_npz": (
            lambda character: d.write_baked_npz(folder / "b.npz", character, animation), {"character": w.character},
        ),
        "write_baked_glb": (
            lambda character: d.write_baked_glb(folder / "b.glb", character, animation), {"character": w.character},
        ),
    }  # fmt: skip


#: Functions without arrays, or whose damaged input is a file (tests/fuzz) or an object of ours.
ELSEWHERE = {
    "check_session", "common_widths", "filmed", "read_widths",
    "minimise", "explain_match", "retarget", "up_of_world", "session_silhouettes", "train_body_model", "write_materials",
    "body_fitter_violations", "body_model_violations", "cloth_segmenter_violations", "feature_tracker_violations",
    "frame_source_violations", "garment_mesher_violations", "pose_optimizer_violations", "silhouette_extractor_violations",
    "detect_joints", "require_scanned", "surface_refiner_violations",
    "limb_search_violations", "performance_capture_violations", "cloth_solver_violations",
    "optimizer_violations", "objective_violations",
    "read_actor", "read_body", "read_calibration", "read_segmentation", "read_garment", "read_materials", "read_mesh",
    "measure_observations",
    "read_observations", "read_performance", "read_proxies", "read_simulated", "read_view", "write_template_suggestion",
    "default_stages", "findings_to_json", "fit_together", "hash_files", "quality_findings", "quality_limits",
    "read_found_segmentation", "read_segmentation_paint", "read_suggested_mask", "read_template_mask", "read_views",
    "write_template_mask",
}  # fmt: skip


def ring_of_discs() -> dict:
    """Four cameras around a ball of 0.5 m."""
    y, x = np.mgrid[:96, :96] - 47.5
    disc = (np.hypot(x, y) < 30).astype(np.uint8) * 255
    rig = []
    for turn in (0, 90, 180, 270):
        back = np.array([np.sin(np.radians(turn)), 0, np.cos(np.radians(turn))])
        camera = d.Camera()
        camera.name, camera.width, camera.height = f"c{turn}", 96, 96
        camera.K = np.array([[180.0, 0, 47.5], [0, 180, 47.5], [0, 0, 1]])
        camera.R = np.array([np.cross([0, 1.0, 0], back), [0, -1.0, 0], -back])
        camera.t = -camera.R @ (3 * back)
        rig.append(camera)
    return {"rig": rig, "masks": [disc] * 4}


def seen_joints(camera: d.Camera) -> np.ndarray:
    """(20, 12, 3) of a person of 1.2 m who sways and swings."""
    sides = np.array(
        [[x * s, y, 0] for x, y in ((0.13, 1), (0.15, 0.8), (0.16, 0.6), (0.07, 0.6), (0.07, 0.3), (0.08, 0)) for s in (1, -1)]
    )
    frames = []
    for t in range(20):
        swing = np.zeros((12, 3))
        swing[[2, 4, 9, 11], 2], swing[[3, 5, 8, 10], 2] = 0.1 * np.sin(t), -0.1 * np.sin(t)
        joints = sides + swing + [0.2 * np.sin(0.3 * t), -0.5, 0.2 * np.cos(0.7 * t)]
        frames.append([[*camera.project(joint), 1.0] for joint in joints])
    return np.array(frames)


def seen_walking() -> list[d.PersonView]:
    return [d.PersonView(camera.name, (96, 96), seen_joints(camera), 180.0) for camera in ring_of_discs()["rig"]]


class Discs(d.FrameSource):
    """One frame of what ring_of_discs() shows."""

    @property
    def frame_count(self):
        return 1

    @property
    def camera_count(self):
        return 4

    def image(self, camera, frame):
        return np.zeros((0, 0, 3), np.uint8)

    def mask(self, camera, frame):
        return ring_of_discs()["masks"][camera]


def template(world) -> d.Template:
    surface = d.Template()
    surface.mesh = surface.high = world.mesh
    surface.face_valid = surface.high_face_valid = [1] * len(world.mesh.faces)
    return surface


def copy_of(character: d.Character, folder) -> d.Character:
    character.write(folder / "copy.glb")
    return d.Character.read(folder / "copy.glb")


def spoilt(value, folder) -> dict:
    """What -> a wrong value in the place of a good one."""
    for kind, spoil in SPOIL:
        if isinstance(value, kind):
            return spoil(value, folder)
    return {}


def spoilt_number(value: float, folder) -> dict:
    return {"nan": np.nan, "-1": -1.0, "inf": np.inf}


def spoilt_count(value: int, folder) -> dict:
    return {"-1": -1}


def spoilt_array(value: np.ndarray, folder) -> dict:
    if not value.size:  # may be left out, but then not in part
        return {"3 of them": np.zeros((3, *value.shape[1:]), value.dtype)}
    wrong = {"shorter": value[:-1], "longer": np.concatenate([value, value[-1:]]), "empty": value[:0]}
    if value.ndim > 1:
        wrong["a column less"] = value[..., :-1]
    if value.dtype.kind == "f":
        for name, number in NUMBERS.items():
            wrong[name] = value.copy()
            with np.errstate(over="ignore"):
                wrong[name].reshape(-1)[0] = number
    elif value.dtype == np.int32:
        for number in (-1, -(2**31), 2**31 - 1, value.max() + 1):
            wrong[f"index {number}"] = value.copy()
            wrong[f"index {number}"].reshape(-1)[0] = number
    return wrong


def spoilt_list(value: list, folder) -> dict:
    if not value:
        return {}
    wrong = {"shorter": value[:-1], "longer": [*value, value[-1]], "empty": [], "None in it": [*value[:-1], None]}
    return {**wrong, **{f"first: {name}": [bad, *value[1:]] for name, bad in spoilt(value[0], folder).items()}}


def spoilt_fields(*names):
    """A copy of an object with one field spoilt."""

    def spoil(value, folder) -> dict:
        wrong = {}
        for name in names:
            good = getattr(value, name)
            good = good if isinstance(good, (list, d.Mesh, d.RiggedMesh, d.Segmentation, d.MeshSequence)) else np.array(good)
            for what, bad in spoilt(good, folder).items():
                other = duplicate(value, folder)
                try:
                    setattr(other, name, bad)
                except (TypeError, ValueError):  # refused at once, as by a call
                    continue
                wrong[f"{name} {what}"] = other
        return wrong

    return spoil


def duplicate(value, folder):
    """The bound classes have no copy of their own."""
    if isinstance(value, d.Mesh):
        return d.Mesh(np.array(value.vertices), np.array(value.faces))
    if isinstance(value, d.RiggedMesh):
        return d.RiggedMesh(duplicate(value.mesh, folder), list(value.face_valid), np.array(value.weights), value.skeleton)
    if isinstance(value, d.Segmentation):
        other = d.Segmentation(*(np.array(getattr(value, n)) for n in ("sigma", "clothness", "region")))
        other.rest, other.region_count = np.array(value.rest), value.region_count
        return other
    if isinstance(value, d.MeshSequence):
        return d.MeshSequence(np.array(value.faces), value.frames)
    if isinstance(value, d.Character):
        return copy_of(value, folder)
    if isinstance(value, d.TaperedCapsule):
        return d.TaperedCapsule(value.joint, value.p0, value.p1, value.r0, value.r1)
    if isinstance(value, d.JointAnnotation):
        return d.JointAnnotation(value.name, value.parent, value.position, value.dof)
    if isinstance(value, d.Motion):
        return d.Motion(value.fps, np.array(value.dofs))
    other = type(value)()
    old_names = ATTRIBUTES.get(type(value).__name__, {})
    for name in (n for n in dir(type(value)) if getattr(getattr(type(value), n), "fset", None) and n not in old_names):
        held = getattr(value, name)
        bound = type(held).__module__ == d.Mesh.__module__
        setattr(other, name, duplicate(held, folder) if bound else copy.copy(held))
    return other


def spoilt_camera(value: d.Camera, folder) -> dict:
    wrong = {}
    for name, bad in (("K", np.nan), ("R", np.inf), ("t", np.nan), ("width", 0), ("height", -5), ("K", 1e300), ("t", 1e300)):
        other = duplicate(value, folder)
        setattr(other, name, bad if isinstance(bad, int) else np.full_like(np.array(getattr(value, name)), bad))
        wrong[f"{name} {bad}"] = other
    return wrong


def spoilt_proxy(value: d.TaperedCapsule, folder) -> dict:
    wrong = {}
    for name, bad in (("joint", -1), ("joint", 99), ("r0", -1.0), ("r1", np.nan), ("p0", np.full(3, np.nan))):
        other = duplicate(value, folder)
        setattr(other, name, bad)
        wrong[f"{name} {bad}"] = other
    return wrong


def spoilt_mark(value: d.JointAnnotation, folder) -> dict:
    wrong = {}
    for name, bad in (("position", np.full(3, np.nan)), ("dof", 7), ("dof", -1), ("parent", value.name), ("parent", "nobody")):
        other = duplicate(value, folder)
        setattr(other, name, bad)
        wrong[f"{name} {bad}"] = other
    return wrong


def spoilt_motion(value: d.Motion, folder) -> dict:
    wrong = {f"dofs {what}": d.Motion(value.fps, bad) for what, bad in spoilt_array(np.array(value.dofs), folder).items()}
    return {**wrong, **{f"fps {fps}": d.Motion(fps, value.dofs) for fps in (0, -1, np.nan, np.inf, 1e-300)}}


SPOIL = (
    (bool, lambda value, folder: {}),
    (int, spoilt_count),
    (float, spoilt_number),
    (np.ndarray, spoilt_array),
    (list, spoilt_list),
    (d.Mesh, spoilt_fields("vertices", "faces")),
    (d.MeshSequence, spoilt_fields("faces", "frames")),
    (d.RiggedMesh, spoilt_fields("mesh", "face_valid", "weights")),
    (d.Segmentation, spoilt_fields("sigma", "clothness", "region", "rest")),
    (d.ReferencePerformance, spoilt_fields("surface", "dofs", "joints", "frames")),
    (d.Garment, spoilt_fields("mesh", "region", "clothness", "rest", "actor_face", "barycentric", "replaced_faces")),
    (d.BodyFit, spoilt_fields("body", "coefficients", "deviation")),
    (d.Observations, spoilt_fields("cameras", "frames", "views")),
    (d.Template, spoilt_fields("mesh", "high", "face_valid", "high_face_valid")),
    (
        d.Character,
        spoilt_fields("actor", "segmentation", "proxies", "materials", "body", "body_shown", "high", "high_valid", "texcoords"),
    ),
    (d.Camera, spoilt_camera),
    (d.TaperedCapsule, spoilt_proxy),
    (d.JointAnnotation, spoilt_mark),
    (d.Motion, spoilt_motion),
)
