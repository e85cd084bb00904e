"""A new animation as Universal Scene Description (.usdc): for Houdini, Omniverse, Maya, Blender. Needs usd-core
(`pip install usd-core`)."""

from __future__ import annotations

import os
import re
from pathlib import Path

import numpy as np

from .. import _doublet as d
from ..common.files import written_atomically


def usd_modules():
    """pxr, or a sentence about where it comes from."""
    try:
        import pxr.Gf
        import pxr.Sdf
        import pxr.Tf
        import pxr.Usd
        import pxr.UsdGeom
        import pxr.UsdShade
        import pxr.UsdSkel
        import pxr.Vt
    except ImportError as error:
        raise RuntimeError(f".usdc needs the package usd-core, which is not installed ({error}): pip install usd-core") from error
    return pxr


def identifier(name: str) -> str:
    """A name as USD takes it."""
    plain = re.sub(r"\W", "_", name, flags=re.ASCII)
    return plain if plain[:1].isalpha() or plain[:1] == "_" else f"_{plain}"


def identifiers(names: list[str]) -> list[str]:
    """The same of several, each another one: of names in other letters little is left."""
    found: list[str] = []
    for name in names:
        plain = identifier(name)
        others = (f"{plain}_{k}" for k in range(2, len(names) + 2))
        found.append(plain if plain not in found else next(other for other in others if other not in found))
    return found


def texture_path(out: Path, character: d.Character) -> Path:
    """Where the texture of a .usdc lies: beside it, by its name."""
    suffix = ".png" if character.texture.startswith(b"\x89PNG") else ".jpg"
    return out.with_name(f"{out.stem}_texture{suffix}")  # OUT.jpg may be a picture of the user's


class Stage:
    """A stage that frames are written to, one after the other."""

    def __init__(self, character: d.Character, texture: str, drawn: d.TexturedFaces, options: d.AnimateOptions):
        self.pxr = usd_modules()
        usd, geometry = self.pxr.Usd, self.pxr.UsdGeom
        self.character = character
        self.drawn, self.vertices = drawn, np.unique(drawn.faces)  # of M_high
        self.has_high = options.high and len(character.high.faces) > 0
        # In memory until it is whole: there is one place where writing can fail.
        self.stage = usd.Stage.Open(self.pxr.Sdf.Layer.CreateAnonymous(".usdc"))
        fps = 1 / character.solver.dt
        geometry.SetStageUpAxis(self.stage, geometry.Tokens.y)
        geometry.SetStageMetersPerUnit(self.stage, 1.0)
        self.stage.SetTimeCodesPerSecond(fps)
        self.stage.SetFramesPerSecond(fps)
        self.root = geometry.Xform.Define(self.stage, "/character")
        self.stage.SetDefaultPrim(self.root.GetPrim())
        self.frames = 0
        self.add_skeleton()
        self.surface, self.body = self.add_surface(texture), self.add_body() if options.body else None

    # --- what stays

    def add_skeleton(self) -> None:
        skel, names = self.pxr.UsdSkel, self.character.actor.skeleton.joint_names
        self.parents = self.character.actor.skeleton.joint_parents
        self.rest = self.character.actor.skeleton.joint_positions(np.zeros(len(self.character.actor.skeleton.dof_names)))
        paths = []
        for name, parent in zip(identifiers(names), self.parents):
            paths.append(name if parent < 0 else f"{paths[parent]}/{name}")
        skel.Root.Define(self.stage, "/character/rig")
        skeleton = skel.Skeleton.Define(self.stage, "/character/rig/skeleton")
        self.animation = skel.Animation.Define(self.stage, "/character/rig/animation")
        matrices = [np.eye(4) for _ in paths]  # USD multiplies rows: a place is the last row
        for matrix, place in zip(matrices, self.rest):
            matrix[3, :3] = place
        local = [m if p < 0 else m @ np.linalg.inv(matrices[p]) for m, p in zip(matrices, self.parents)]
        skeleton.CreateJointsAttr(paths)
        skeleton.CreateBindTransformsAttr(self.pxr.Vt.Matrix4dArray.FromNumpy(np.array(matrices)))
        skeleton.CreateRestTransformsAttr(self.pxr.Vt.Matrix4dArray.FromNumpy(np.array(local)))
        skel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets([self.animation.GetPath()])
        self.animation.CreateJointsAttr(paths)
        self.animation.CreateScalesAttr(self.pxr.Vt.Vec3hArray.FromNumpy(np.ones((len(paths), 3), np.float16)))
        self.skeleton = skeleton

    def add_surface(self, texture: str):
        c = self.character
        if not self.has_high:
            return self.add_mesh("surface", c.actor.mesh.faces[np.asarray(c.actor.face_valid, bool)], self.add_material("cloth"))
        faces = np.searchsorted(self.vertices, self.drawn.faces)
        mesh = self.add_mesh("surface", faces, self.add_material("surface", texture=texture))
        if texture:
            corners = self.drawn.texcoords * [1, -1] + [0, 1]  # USD's images begin at the bottom
            kind = self.pxr.Sdf.ValueTypeNames.TexCoord2fArray
            places = self.pxr.UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("st", kind, self.pxr.UsdGeom.Tokens.faceVarying)
            places.Set(self.pxr.Vt.Vec2fArray.FromNumpy(corners.astype(np.float32)))
        return mesh

    def add_body(self):
        c = self.character
        shown = np.asarray(c.body_shown, bool)
        if not shown.any():
            return None
        return self.add_mesh("body", c.body.faces[shown], self.add_material("skin", colour=c.body_colour))

    def add_mesh(self, name: str, faces: np.ndarray, material):
        vt = self.pxr.Vt
        mesh = self.pxr.UsdGeom.Mesh.Define(self.stage, f"/character/{name}")
        mesh.CreateFaceVertexCountsAttr(vt.IntArray.FromNumpy(np.full(len(faces), 3, np.int32)))
        mesh.CreateFaceVertexIndicesAttr(vt.IntArray.FromNumpy(np.ascontiguousarray(faces, np.int32).ravel()))
        mesh.CreateSubdivisionSchemeAttr(self.pxr.UsdGeom.Tokens.none)
        mesh.CreateDoubleSidedAttr(True)
        self.pxr.UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)
        return mesh

    def add_material(self, name: str, colour=(0.6, 0.6, 0.6), texture: str = ""):
        shade, types = self.pxr.UsdShade, self.pxr.Sdf.ValueTypeNames
        path = f"/character/materials/{name}"
        if not self.stage.GetPrimAtPath("/character/materials"):
            self.pxr.UsdGeom.Scope.Define(self.stage, "/character/materials")
        material, shader = shade.Material.Define(self.stage, path), shade.Shader.Define(self.stage, f"{path}/preview")
        shader.CreateIdAttr("UsdPreviewSurface")
        shader.CreateInput("roughness", types.Float).Set(0.9)
        shader.CreateInput("metallic", types.Float).Set(0.0)
        diffuse = shader.CreateInput("diffuseColor", types.Color3f)
        if texture:
            diffuse.ConnectToSource(self.add_texture(path, texture).ConnectableAPI(), "rgb")
        else:
            diffuse.Set(tuple(map(float, colour)))
        material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
        return material

    def add_texture(self, path: str, texture: str):
        shade, types = self.pxr.UsdShade, self.pxr.Sdf.ValueTypeNames
        reader = shade.Shader.Define(self.stage, f"{path}/places")
        reader.CreateIdAttr("UsdPrimvarReader_float2")
        reader.CreateInput("varname", types.String).Set("st")
        image = shade.Shader.Define(self.stage, f"{path}/image")
        image.CreateIdAttr("UsdUVTexture")
        image.CreateInput("file", types.Asset).Set(f"./{texture}")
        image.CreateInput("sourceColorSpace", types.Token).Set("sRGB")
        for axis in ("wrapS", "wrapT"):
            image.CreateInput(axis, types.Token).Set("clamp")
        places = reader.CreateOutput("result", types.Float2)
        image.CreateInput("st", types.Float2).ConnectToSource(places)
        image.CreateOutput("rgb", types.Float3)
        return image

    # --- what moves

    def write_frame(self, frame: d.AnimationFrame) -> None:
        self.write_pose(frame.index, frame.dofs)
        self.write_points(self.surface, frame.index, frame.high[self.vertices] if self.has_high else frame.surface)
        if self.body is not None:
            self.write_points(self.body, frame.index, frame.body)
        self.frames = frame.index + 1

    def write_points(self, mesh, frame: int, points: np.ndarray) -> None:
        points = np.ascontiguousarray(points, np.float32)
        mesh.GetPointsAttr().Set(self.pxr.Vt.Vec3fArray.FromNumpy(points), frame)
        extent = np.array([points.min(axis=0), points.max(axis=0)])
        mesh.GetExtentAttr().Set(self.pxr.Vt.Vec3fArray.FromNumpy(extent), frame)

    def write_pose(self, frame: int, dofs: np.ndarray) -> None:
        world = np.asarray(self.character.actor.skeleton.forward_kinematics(dofs))  # world from rest
        places, turns = [], []
        for j, parent in enumerate(self.parents):
            here = world[j][:3, :3] @ self.rest[j] + world[j][:3, 3]
            places.append(here if parent < 0 else self.rest[j] - self.rest[parent])
            turns.append(world[j][:3, :3] if parent < 0 else world[parent][:3, :3].T @ world[j][:3, :3])
        matrix, quaternion, turned = self.pxr.Gf.Matrix3d, self.pxr.Gf.Quatf, []
        for turn in turns:
            turned.append(quaternion(matrix(*np.transpose(turn).ravel().tolist()).ExtractRotation().GetQuat()))
        self.animation.GetTranslationsAttr().Set(self.pxr.Vt.Vec3fArray.FromNumpy(np.array(places, np.float32)), frame)
        self.animation.GetRotationsAttr().Set(self.pxr.Vt.QuatfArray(turned), frame)

    def save(self, path: Path, out: Path) -> None:
        """Writes `path`; a RuntimeError names `out`."""
        self.stage.SetStartTimeCode(0)
        self.stage.SetEndTimeCode(self.frames - 1)
        try:
            self.stage.GetRootLayer().Export(str(path))
        except self.pxr.Tf.ErrorException as error:
            said = re.findall(r": '(.*)'$", str(error), re.MULTILINE) or ["USD does not say why"]
            raise RuntimeError(f"{out}: cannot be written: {said[0]}") from error


def require_utf8(path: Path) -> None:
    """Of names in other bytes USD knows nothing."""
    try:
        str(path).encode()
    except UnicodeEncodeError:
        shown = os.fsencode(path).decode(errors="replace")
        raise ValueError(f"{shown}: expected a path in UTF-8, which USD needs, found other bytes; choose another") from None


def write_usdc(
    out: Path,
    character: d.Character,
    motion: d.Motion,
    options: d.AnimateOptions | None = None,
    context: d.Context | None = None,
    drawn: d.TexturedFaces | None = None,
) -> int:
    """The animation of a motion as OUT.usdc, in metres, +Y up, a time code a frame: points of the surface and of the body under
    it, and the skeleton. The texture lies beside it, OUT_texture.jpg or .png. `drawn`: faces in the place of the surface's; None
    or empty = its own. Returns the number of frames."""
    usd_modules()
    out, texture, options = Path(out), "", options or d.AnimateOptions()
    require_utf8(out)
    if len(character.texture) and len(character.high.faces) and options.high:
        texture = texture_path(out, character).name
    with written_atomically(out) as beside:
        faces = drawn if drawn is not None and len(drawn.faces) else d.drawn_faces(character)
        stage = Stage(character, texture, faces, options)
        count = d.animate_each(character, motion, stage.write_frame, options, context or d.Context())
        if texture:  # what is stopped before leaves neither
            with written_atomically(texture_path(out, character)) as image:
                image.write_bytes(character.texture)
        stage.save(beside, out)
    return count
