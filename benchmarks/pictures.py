"""The pictures of README and results.

python benchmarks/pictures.py overview OUT MOTION -o docs/pictures/overview.jpg [--frame 72] [--camera 0] [--new 95 130]
python benchmarks/pictures.py pipeline OUT MOTION -o docs/pictures/pipeline.jpg [--frame 72] [--camera 0] [--new 95]
python benchmarks/pictures.py dance OUT --truth SESSION/ground_truth -o docs/pictures/dance.jpg [--frames 0 30 ...]
python benchmarks/pictures.py captured OUT -o docs/pictures/own-footage.jpg [--frames 0 30 ...] [--cameras 0 2 ...]
python benchmarks/pictures.py captured OUT -o docs/pictures/tracking.jpg --frames 20 55 88 115
python benchmarks/pictures.py template OUT -o docs/pictures/template.png
python benchmarks/pictures.py segmentation OUT -o docs/pictures/segmentation.jpg
python benchmarks/pictures.py garment OUT -o docs/pictures/garment.png
python benchmarks/pictures.py hem OUT MOTION -o docs/pictures/display-hem.jpg [--frames 30 60 30]

scripts/make-pictures.sh makes all of them, and those of other scripts.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import doublet as d
import numpy as np
from doublet import reconstruct
from doublet.common import drawing
from doublet.common.console import Console
from doublet.evaluation import metrics as evaluate
from PIL import Image, ImageDraw, ImageFont

HEIGHT = 720  # px, of a panel
BODY = np.array((0.55, 0.57, 0.62))
ROWS = (("true", (0.85, 0.36, 0.22)), ("simulated", (0.20, 0.42, 0.80)), ("captured", (0.30, 0.62, 0.32)))

#: Of hem(): height of what is looked at, from the garment's hem (0) to its seam (1); m around it; rad around +Y, and upwards.
HEM_VIEWS = ((0.4, 0.45, 0.2, 0.1), (0.1, 0.4, 0.5, -0.15), (0.8, 0.25, 0.2, 0.35))


def scaled(image: np.ndarray, height: int) -> np.ndarray:
    size = round(image.shape[1] * height / image.shape[0]), height
    return np.asarray(Image.fromarray(np.ascontiguousarray(image)).resize(size, Image.Resampling.LANCZOS))


def narrowed(image: np.ndarray, share: float = 0.62) -> np.ndarray:
    """The middle columns."""
    cut = round((1 - share) / 2 * image.shape[1])
    return image[:, cut : image.shape[1] - cut]


def frames_of(character: d.Character, motion: d.Motion, wanted: list[int]) -> dict[int, tuple]:
    """frame -> (surface, high, body, joints)"""
    kept = {}

    def keep(frame: d.AnimationFrame) -> None:
        if frame.index in wanted:
            kept[frame.index] = tuple(np.array(a) for a in (frame.surface, frame.high, frame.body, frame.joints))

    d.animate_each(character, motion, keep, d.AnimateOptions(), Console(quiet=True).context())
    return kept


def overview(chosen: argparse.Namespace) -> np.ndarray:
    job = reconstruct.Job(reconstruct.recorded_session(chosen.out), chosen.out)
    character = d.Character.read(job.path("character.glb"))
    performance, camera, row = job.results.performance(), job.filmed.rig[chosen.camera], chosen.frame
    captured = performance.surface.frames[row]
    faces = job.results.actor.mesh.faces[np.asarray(job.results.actor.face_valid, bool)]
    box = drawing.crop_box(captured, camera, margin=25)

    photo = d.FrameSource.open(job.filmed).image(chosen.camera, performance.frames[row])[..., ::-1]
    filmed = drawing.draw_outline(photo, drawing.outline(captured, faces, camera))
    colours = drawing.cloth_colours(job.results.segmentation().clothness)
    tracked = drawing.shade([d.RenderMesh(captured, faces, colours=colours)], camera)
    renderer, white = d.CharacterRenderer(character), d.RenderOptions(background=[1, 1, 1], floor=False)
    again = frames_of(character, d.Motion(job.session.fps, performance.dofs), [row])[row]
    panels = [view[box] for view in (filmed, tracked, renderer.render(*again[:3], camera, white)[..., ::-1])]

    retargeting = d.RetargetOptions(fps=1 / character.solver.dt)
    motion = d.retarget(d.SourceMotion.read(chosen.motion), character.actor.skeleton, retargeting)
    floor = d.RenderOptions(floor_height=float(character.actor.mesh.vertices[:, 1].min()))
    for surface, high, body, joints in frames_of(character, motion, chosen.new).values():
        middle = (joints.min(axis=0) + joints.max(axis=0)) / 2
        beside = d.orbit_camera(middle, 1.0, 0.3, 0.12, HEIGHT, HEIGHT)
        panels.append(narrowed(renderer.render(surface, high, body, beside, floor)[..., ::-1]))
    return np.hstack([scaled(panel, HEIGHT) for panel in panels])


def pipeline(chosen: argparse.Namespace) -> np.ndarray:
    """A picture a stage, with its name."""
    job = reconstruct.Job(reconstruct.recorded_session(chosen.out), chosen.out)
    actor, performance, camera = job.results.actor, job.results.performance(), job.filmed.rig[chosen.camera]
    valid = actor.mesh.faces[np.asarray(actor.face_valid, bool)]
    captured, rest = performance.surface.frames[chosen.frame], actor.mesh.vertices
    box, front = drawing.crop_box(captured, camera, margin=25), drawing.around(rest, 0.4, HEIGHT)
    standing = drawing.crop_box(rest, front)

    def at_rest(*meshes: d.RenderMesh) -> np.ndarray:
        return drawing.shade(list(meshes), front)[standing]

    worn, clothness = job.results.garment, job.results.segmentation().clothness
    body = d.read_body(job.path("body.npz")).body
    character = d.Character.read(job.path("character.glb"))
    white = d.RenderOptions(background=[1, 1, 1], floor=False)
    simulated = frames_of(character, d.Motion(job.session.fps, performance.dofs), [chosen.frame])[chosen.frame]
    clip = d.retarget(d.SourceMotion.read(chosen.motion), actor.skeleton, d.RetargetOptions(fps=1 / character.solver.dt))
    danced = frames_of(character, clip, chosen.new[:1])[chosen.new[0]]
    viewed = drawing.around(danced[0], 0.5, HEIGHT)
    renderer, grey = d.CharacterRenderer(character), np.array((0.7,) * 3)
    panels = {
        "videos": d.FrameSource.open(job.filmed).image(chosen.camera, performance.frames[chosen.frame])[..., ::-1][box],
        "template": at_rest(d.RenderMesh(rest, valid, grey)),
        "performance": drawing.shade([d.RenderMesh(captured, valid, grey)], camera)[box],
        "segmentation": at_rest(d.RenderMesh(rest, valid, colours=drawing.cloth_colours(clothness))),
        "body": at_rest(d.RenderMesh(body.vertices, body.faces, BODY)),
        "garment": at_rest(d.RenderMesh(worn.mesh.vertices, worn.mesh.faces, colours=drawing.cloth_colours(worn.clothness))),
        "material": renderer.render(*simulated[:3], camera, white)[..., ::-1][box],
        "animation": renderer.render(*danced[:3], viewed, white)[..., ::-1][drawing.crop_box(danced[0], viewed)],
    }
    return in_two_rows([captioned(picture, name) for name, picture in panels.items()])


def captioned(picture: np.ndarray, name: str) -> np.ndarray:
    """In a panel of one size, its name below."""
    height, width, line = HEIGHT // 2, round(0.62 * HEIGHT) // 2, 34
    drawn = Image.fromarray(np.ascontiguousarray(picture))
    drawn.thumbnail((width, height), Image.Resampling.LANCZOS)
    panel = Image.new("RGB", (width, height + line), "white")
    panel.paste(drawn, ((width - drawn.width) // 2, (height - drawn.height) // 2))
    ImageDraw.Draw(panel).text((width / 2, height + line / 2), name, "black", ImageFont.load_default(size=22), anchor="mm")
    return np.asarray(panel)


def in_two_rows(panels: list[np.ndarray]) -> np.ndarray:
    middle = (len(panels) + 1) // 2
    return np.vstack([np.hstack(panels[:middle]), np.hstack(panels[middle:])])


def dance(chosen: argparse.Namespace) -> np.ndarray:
    """Columns: frames. Rows: the true garment on the true body, the simulated and the captured one on the captured body."""
    made, truth = evaluate.Reconstruction(chosen.out), evaluate.Truth(chosen.truth)
    moving, columns = made.reanimated, []
    captured = dict(zip(made.performance.frames, made.performance.surface.frames))
    cloth_of = {
        "simulated": (moving.surfaces, moving.faces, moving.clothness),
        "captured": (captured, made.faces, made.clothness),
    }
    for frame in chosen.frames:
        body, garment = truth.frame(frame)
        middle = garment.mean(axis=0)
        camera, column = d.orbit_camera(middle, 0.62, 0.2, 0.1, 320, 320), []
        for name, colour in ROWS:
            if name == "true":
                meshes = [d.RenderMesh(body, truth.body_faces, BODY), d.RenderMesh(garment, truth.cloth_faces, np.array(colour))]
            else:
                surfaces, faces, clothness = cloth_of[name]
                cloth = (clothness[faces] > 0.5).any(axis=1)
                meshes = [d.RenderMesh(surfaces[frame], faces[m], np.array(c)) for m, c in ((~cloth, BODY), (cloth, colour))]
            column.append(narrowed(drawing.shade(meshes, camera), 0.9))
        columns.append(np.vstack(column))
    return np.hstack(columns)


def captured(chosen: argparse.Namespace) -> np.ndarray:
    """Film, and the captured surface on it, by clothness; a frame and a camera each."""
    job = reconstruct.Job(reconstruct.recorded_session(chosen.out), chosen.out)
    performance, film = job.results.performance(), d.FrameSource.open(job.filmed)
    faces = job.results.actor.mesh.faces[np.asarray(job.results.actor.face_valid, bool)]
    colours = drawing.cloth_colours(job.results.segmentation().clothness)
    panels = []
    for number, row in enumerate(chosen.frames):
        c = chosen.cameras[number % len(chosen.cameras)]
        camera, surface = job.filmed.rig[c], performance.surface.frames[row]
        photo = film.image(c, performance.frames[row])[..., ::-1]
        covered = d.rasterize(surface, faces, camera)[0] >= 0
        shaded = drawing.shade([d.RenderMesh(surface, faces, colours=colours)], camera)
        mixed = np.where(covered[..., None], 0.4 * photo + 0.6 * shaded, photo).astype(np.uint8)
        box = drawing.crop_box(surface, camera, margin=25)
        panels += [scaled(photo[box], HEIGHT // 2), scaled(mixed[box], HEIGHT // 2)]
    middle = 2 * ((len(chosen.frames) + 1) // 2)
    rows = [np.hstack(part) for part in (panels[:middle], panels[middle:]) if part]
    width = max(row.shape[1] for row in rows)
    return np.vstack([np.pad(row, ((0, 6), (0, width - row.shape[1]), (0, 0)), constant_values=255) for row in rows])


def template(chosen: argparse.Namespace) -> np.ndarray:
    """The template, red where the scan does not support it: whole, its hem, and from below."""
    actor = d.read_actor(chosen.out / "actor.npz")
    mesh, valid = actor.mesh, np.asarray(actor.face_valid, bool)
    parts = [d.RenderMesh(mesh.vertices, mesh.faces[m], np.array(c)) for m, c in ((valid, (0.7,) * 3), (~valid, (0.8, 0.1, 0.1)))]
    middle = mesh.vertices[mesh.faces[~valid]].mean(axis=(0, 1))  # the sheet under a hem, most of it
    size = HEIGHT // 2
    cameras = [drawing.around(mesh.vertices, 0.0, size)]
    cameras += [d.orbit_camera(middle, 0.5, 0.0, elevation, size, size) for elevation in (-0.15, -0.8)]
    return np.hstack([drawing.shade(parts, camera) for camera in cameras])


def segmentation(chosen: argparse.Namespace) -> np.ndarray:
    """In the scan pose, from the front and from behind: the deviation, from 0 (white) to 3 cm (red), and the clothness."""
    actor = d.read_actor(chosen.out / "actor.npz")
    found = d.read_segmentation(chosen.out / "segmentation.npz")
    valid = actor.mesh.faces[np.asarray(actor.face_valid, bool)]
    share = np.nan_to_num(np.clip(found.sigma / 0.03, 0, 1))[:, None]
    deviation = (1 - share) * np.array([0.95, 0.95, 0.95]) + share * np.array([0.75, 0.1, 0.1])
    panels = []
    for colours in (deviation, drawing.cloth_colours(found.clothness)):
        for azimuth in (0.4, 0.4 + np.pi):
            camera = drawing.around(actor.mesh.vertices, azimuth, HEIGHT // 2)
            panels.append(narrowed(drawing.shade([d.RenderMesh(actor.mesh.vertices, valid, colours=colours)], camera), 0.8))
    return np.hstack(panels)


def garment(chosen: argparse.Namespace) -> np.ndarray:
    """In the scan pose, and its rest shape: at one scale, with the triangles' edges."""
    worn = d.read_garment(chosen.out / "garment.npz", d.read_actor(chosen.out / "actor.npz"))
    faces, colours = worn.mesh.faces, drawing.cloth_colours(worn.clothness)
    camera = drawing.around(np.vstack([worn.mesh.vertices, worn.rest]), 0.0, 960)
    panels = []
    for vertices in (worn.mesh.vertices, worn.rest):
        solid = drawing.shade([d.RenderMesh(vertices, faces, colours=colours)], camera)
        drawn = drawing.draw_outline(solid, drawing.edges(vertices, faces, camera), (90, 50, 50))
        panels.append(drawn[drawing.crop_box(vertices, camera)])
    height = max(panel.shape[0] for panel in panels)
    return np.hstack([np.pad(p, ((0, height - p.shape[0]), (20, 20), (0, 0)), constant_values=255) for p in panels])


def with_the_scans_triangles(job: reconstruct.Job) -> d.Character:
    """The character of `job`, its cloth drawn by what was scanned in the place of the garment's own mesh."""
    character = d.Character.read(job.path("character.glb"))
    scanned = d.read_mesh(job.path("template_high.ply"))
    valid = d.build_display_mesh(
        job.results.actor, job.results.segmentation(), scanned
    ).valid  # of the actor: it wears no garment
    made = d.make_character(
        character.actor,
        character.segmentation,
        d.read_body(job.path("body.npz")),
        character.proxies,
        character.materials,
        character.solver,
        scanned,
        valid,
    )
    performance = job.results.dressed_performance()
    views = d.read_views(job.filmed, performance.frames[0], job.silhouettes)
    d.texture_character(made, performance.surface.frames[0], job.filmed.rig, views.images, views.masks, job.options["texture"])
    return made


def hem(chosen: argparse.Namespace) -> np.ndarray:
    """Columns: the front of the garment, from below, its seam. Rows: drawn by the scan's triangles, and by the garment's own."""
    job = reconstruct.Job(reconstruct.recorded_session(chosen.out), chosen.out, console=Console(quiet=True))
    rows = []
    for character in (with_the_scans_triangles(job), d.Character.read(job.path("character.glb"))):
        retargeting = d.RetargetOptions(fps=1 / character.solver.dt)
        motion = d.retarget(d.SourceMotion.read(chosen.motion), character.actor.skeleton, retargeting)
        floor = d.RenderOptions(floor_height=float(character.actor.mesh.vertices[:, 1].min()))
        renderer, size, row = d.CharacterRenderer(character), 400, []
        cloth = character.segmentation.clothness > 0.5
        frames = frames_of(character, motion, chosen.frames)
        for frame, (height, radius, azimuth, elevation) in zip(chosen.frames, HEM_VIEWS):
            surface, high, body, _ = frames[frame]
            low, top = surface[cloth].min(axis=0), surface[cloth].max(axis=0)
            middle = (low + top) / 2
            middle[1] = low[1] + height * (top[1] - low[1])
            camera = d.orbit_camera(middle, radius, azimuth, elevation, size, size)
            row.append(renderer.render(surface, high, body, camera, floor)[..., ::-1])
        rows.append(np.hstack(row))
    return np.vstack(rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(required=True)
    for name, make in (
        ("overview", overview),
        ("pipeline", pipeline),
        ("dance", dance),
        ("captured", captured),
        ("template", template),
        ("segmentation", segmentation),
        ("garment", garment),
        ("hem", hem),
    ):
        command = commands.add_parser(name)
        command.add_argument("out", type=Path, metavar="OUT")
        command.add_argument("-o", "--picture", type=Path, required=True, metavar="FILE.jpg")
        command.set_defaults(make=make)
        if name in ("overview", "pipeline"):
            command.add_argument("motion", type=Path, metavar="MOTION")
            command.add_argument("--frame", type=int, default=72, metavar="N", help="row of the performance (default: 72)")
            command.add_argument("--camera", type=int, default=0, metavar="N", help="of the session (default: 0)")
            command.add_argument("--new", type=int, nargs="+", default=[76, 156], metavar="N", help="frames of the new motion")
        elif name == "hem":
            command.add_argument("motion", type=Path, metavar="MOTION")
            command.add_argument("--frames", type=int, nargs=3, default=[30, 60, 30], metavar="N", help="of the new motion")
        elif name == "captured":
            command.add_argument("--frames", type=int, nargs="+", default=[0, 30, 55, 75, 95, 118], metavar="N", help="rows")
            command.add_argument("--cameras", type=int, nargs="+", default=[0, 2, 5, 1, 3, 7], metavar="N", help="in turn")
        elif name == "dance":
            command.add_argument("--truth", type=Path, required=True, metavar="DIR", help="ground_truth folder")
            default = [0, 30, 60, 90, 108, 120, 150, 170]
            command.add_argument("--frames", type=int, nargs="+", default=default, metavar="N", help="video frames")
    chosen = parser.parse_args()
    Image.fromarray(chosen.make(chosen)).save(chosen.picture, quality=88)


if __name__ == "__main__":
    main()
