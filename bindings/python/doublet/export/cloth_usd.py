"""The garment of `export_cloth` as Universal Scene Description with UsdPhysics: kinematic bodies of tapered capsules, and the
cloth as a mesh whose numbers lie in primvars, for which UsdPhysics has no schema."""

from __future__ import annotations

import importlib
from pathlib import Path

import numpy as np

from ..common.files import written_atomically
from .usd import identifiers, usd_modules


def write_cloth_usd(path: Path, cloth: dict, motion: dict | None = None) -> None:
    """Of what export_cloth() writes as JSON."""
    pxr = usd_modules()
    importlib.import_module("pxr.UsdPhysics")

    stage = pxr.Usd.Stage.Open(pxr.Sdf.Layer.CreateAnonymous(".usda"))
    pxr.UsdGeom.SetStageUpAxis(stage, pxr.UsdGeom.Tokens.y)
    pxr.UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    pxr.UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
    stage.SetDefaultPrim(pxr.UsdGeom.Xform.Define(stage, "/cloth").GetPrim())
    if motion:
        set_time(stage, motion)
    add_scene(pxr, stage, cloth["gravity"])
    material = add_physics_material(pxr, stage, cloth)
    for body in bodies_of(cloth):
        add_body(pxr, stage, body, cloth, motion, material)
    for index, garment in enumerate(cloth["garments"]):
        add_garment(pxr, stage, index, garment, motion)
    with written_atomically(path) as beside:
        beside.write_text(stage.GetRootLayer().ExportToString(), encoding="utf-8")


def set_time(stage, motion: dict) -> None:
    stage.SetTimeCodesPerSecond(motion["fps"])
    stage.SetFramesPerSecond(motion["fps"])
    stage.SetStartTimeCode(0)
    stage.SetEndTimeCode(motion["frames"] - 1)


def add_scene(pxr, stage, gravity: list[float]) -> None:
    scene, size = pxr.UsdPhysics.Scene.Define(stage, "/cloth/scene"), float(np.linalg.norm(gravity))
    scene.CreateGravityMagnitudeAttr(size)
    scene.CreateGravityDirectionAttr(pxr.Gf.Vec3f(*(np.array(gravity) / size if size else [0.0, -1.0, 0.0]).tolist()))


def add_physics_material(pxr, stage, cloth: dict):
    material = pxr.UsdShade.Material.Define(stage, "/cloth/skin")
    api = pxr.UsdPhysics.MaterialAPI.Apply(material.GetPrim())
    friction = cloth["garments"][0]["material"]["k_friction"]
    api.CreateStaticFrictionAttr(friction)
    api.CreateDynamicFrictionAttr(friction)
    api.CreateRestitutionAttr(cloth["contact"]["restitution"])
    return material


def bodies_of(cloth: dict) -> list[int]:
    """The joints that carry capsules."""
    return sorted({capsule["joint"] for capsule in cloth["capsules"]})


def add_body(pxr, stage, joint: int, cloth: dict, motion: dict | None, material) -> None:
    """A joint as a kinematic body, with its capsules as colliders."""
    place = cloth["skeleton"][joint]
    path = f"/cloth/bodies/{identifiers([other['name'] for other in cloth['skeleton']])[joint]}"
    body = pxr.UsdGeom.Xform.Define(stage, path)
    pxr.UsdPhysics.RigidBodyAPI.Apply(body.GetPrim()).CreateKinematicEnabledAttr(True)
    move, turn = body.AddTranslateOp(), body.AddOrientOp()
    move.Set(pxr.Gf.Vec3d(*place["position"]))
    turn.Set(pxr.Gf.Quatf(1.0))
    if motion:
        joints = motion["joints"]
        for frame in range(motion["frames"]):
            x, y, z, w = joints["rotations"][frame][joint]
            move.Set(pxr.Gf.Vec3d(*joints["translations"][frame][joint]), frame)
            turn.Set(pxr.Gf.Quatf(w, x, y, z), frame)
    own = [capsule for capsule in cloth["capsules"] if capsule["joint"] == joint]
    for k, capsule in enumerate(own):
        add_capsule(pxr, stage, f"{path}/capsule{k}", capsule, material)


def add_capsule(pxr, stage, path: str, capsule: dict, material) -> None:
    """Tapered: UsdGeom's Capsule_1 has a radius at either end. Its axis is +Y, from the bottom, p0, to the top, p1."""
    p0, p1 = np.array(capsule["p0"]), np.array(capsule["p1"])
    shape = pxr.UsdGeom.Capsule_1.Define(stage, path)
    shape.CreateAxisAttr(pxr.UsdGeom.Tokens.y)
    shape.CreateHeightAttr(float(np.linalg.norm(p1 - p0)))
    shape.CreateRadiusBottomAttr(capsule["r0"])
    shape.CreateRadiusTopAttr(capsule["r1"])
    largest, half = max(capsule["r0"], capsule["r1"]), np.linalg.norm(p1 - p0) / 2
    low, high = -half - capsule["r0"], half + capsule["r1"]
    shape.CreateExtentAttr([pxr.Gf.Vec3f(-largest, float(low), -largest), pxr.Gf.Vec3f(largest, float(high), largest)])
    shape.AddTranslateOp().Set(pxr.Gf.Vec3d(*((p0 + p1) / 2).tolist()))
    along = (p1 - p0).tolist() if half > 0 else [0.0, 1.0, 0.0]
    turn = pxr.Gf.Rotation(pxr.Gf.Vec3d(0, 1, 0), pxr.Gf.Vec3d(*along)).GetQuat()
    shape.AddOrientOp().Set(pxr.Gf.Quatf(turn))
    pxr.UsdPhysics.CollisionAPI.Apply(shape.GetPrim())
    pxr.UsdShade.MaterialBindingAPI.Apply(shape.GetPrim()).Bind(material, pxr.UsdShade.Tokens.weakerThanDescendants, "physics")


def add_garment(pxr, stage, index: int, garment: dict, motion: dict | None) -> None:
    types, vt = pxr.Sdf.ValueTypeNames, pxr.Vt
    mesh = pxr.UsdGeom.Mesh.Define(stage, f"/cloth/garment{index}")
    faces = np.array(garment["faces"], np.int32)
    mesh.CreateFaceVertexCountsAttr(vt.IntArray.FromNumpy(np.full(len(faces), 3, np.int32)))
    mesh.CreateFaceVertexIndicesAttr(vt.IntArray.FromNumpy(faces.ravel()))
    mesh.CreateSubdivisionSchemeAttr(pxr.UsdGeom.Tokens.none)
    mesh.CreateDoubleSidedAttr(True)
    set_points(pxr, mesh, garment["vertices"])
    if motion:
        for frame, points in enumerate(motion["garments"][index]["simulated"]):
            set_points(pxr, mesh, points, frame)
    pxr.UsdPhysics.MassAPI.Apply(mesh.GetPrim()).CreateMassAttr(float(sum(garment["masses"])))
    primvars = pxr.UsdGeom.PrimvarsAPI(mesh)

    def vary(name: str, kind, values, dtype, interpolation) -> None:
        array = np.ascontiguousarray(values, dtype)
        made = {types.FloatArray: vt.FloatArray, types.Point3fArray: vt.Vec3fArray}[kind].FromNumpy(array)
        primvars.CreatePrimvar(f"doublet:{name}", kind, interpolation).Set(made)

    vertex = pxr.UsdGeom.Tokens.vertex
    vary("restPoints", types.Point3fArray, garment["rest_vertices"], np.float32, vertex)
    vary("clothness", types.FloatArray, garment["attachment"]["clothness"], np.float32, vertex)
    vary("mass", types.FloatArray, garment["masses"], np.float32, vertex)
    for group, members, width in (("stretch", "edges", 2), ("bend", "hinges", 4)):
        spring, prim = garment[group], mesh.GetPrim()
        indices = np.array(spring[members], np.int32).reshape(-1, width).ravel()
        prim.CreateAttribute(f"doublet:{group}:{members}", types.IntArray).Set(vt.IntArray.FromNumpy(indices))
        stiffness = vt.FloatArray.FromNumpy(np.array(spring["stiffness"], np.float32))
        prim.CreateAttribute(f"doublet:{group}:stiffness", types.FloatArray).Set(stiffness)
    mesh.GetPrim().CreateAttribute("doublet:arealDensity", types.Float).Set(garment["areal_density"])
    for name, value in garment["material"].items():
        mesh.GetPrim().CreateAttribute(f"doublet:material:{name}", types.Float).Set(value)


def set_points(pxr, mesh, points, *time) -> None:
    array = np.array(points, np.float32)
    mesh.GetPointsAttr().Set(pxr.Vt.Vec3fArray.FromNumpy(array), *time)
    extent = np.array([array.min(axis=0), array.max(axis=0)])
    mesh.GetExtentAttr().Set(pxr.Vt.Vec3fArray.FromNumpy(extent), *time)
