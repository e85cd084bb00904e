"""report.html: one self-contained page about a reconstruction."""

from __future__ import annotations

import html
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .. import _doublet as d
from .._doublet import __version__
from ..common import drawing
from ..common.files import arrays_of, write_text
from . import fit_page
from .doubts import ADVICE, doubts_of, good_of, summaries_of
from .html_document import page, table

FRAMES_LOOKED_AT = 32  # for the overlap with the silhouettes: all cameras of each are keyed


def figure(image: np.ndarray, caption: str) -> str:
    text = html.escape(caption)
    return f'<figure><img src="{drawing.data_uri(image)}" alt="{text}"><figcaption>{text}</figcaption></figure>'


def row(figures) -> str:
    return f'<div class="row">{"".join(figures)}</div>'


def spread(count: int, wanted: int) -> list[int]:
    """`wanted` indices over [0, count), both ends included."""
    return sorted({round(i) for i in np.linspace(0, count - 1, min(count, wanted))})


class Shown:
    """What the page shows, read from the files of OUT."""

    def __init__(self, job):
        self.job = job
        self.session = job.filmed
        self.actor = job.results.actor
        self.performance = job.results.performance()
        self.faces = self.actor.mesh.faces[np.asarray(self.actor.face_valid, bool)]
        self.captured = self.performance.surface.frames
        self.simulated = d.read_simulated(job.path("simulated.npz"))  # of the dressed actor
        self.source = d.FrameSource.open(self.session)
        with arrays_of(job.path("observations.npz")) as observations:
            self.matches = len(observations["match_points"])

    @cached_property
    def track(self) -> Track:
        return follow(self)

    def masks(self, row: int) -> list[np.ndarray]:
        """Silhouettes (H, W) of a captured frame; empty where a camera has none."""
        frame, silhouettes = self.performance.frames[row], self.job.silhouettes
        return [d.read_view(self.source, c, frame, silhouettes).mask for c in range(self.source.camera_count)]

    def photo(self, camera: int, frame: int) -> np.ndarray:
        """RGB; the mask in grey if the camera has no image there (a session of masks)."""
        image = self.source.image(camera, frame)
        if image.size:
            return image[..., ::-1]
        mask, rig = self.source.mask(camera, frame), self.session.rig[camera]
        grey = 100 + mask // 3 if mask.size else np.full((rig.height, rig.width), 100, np.uint8)
        return np.repeat(grey[..., None], 3, axis=2)


def template(shown: Shown) -> str:
    """The rigged surface, invalid triangles red, and what its stages measured."""
    mesh, valid = shown.actor.mesh, np.asarray(shown.actor.face_valid, bool)
    parts = ((valid, (0.80, 0.78, 0.74)), (~valid, (0.86, 0.16, 0.12)))
    surfaces = [d.RenderMesh(mesh.vertices, mesh.faces[chosen], np.array(colour)) for chosen, colour in parts if chosen.any()]
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    views = (("front", 0.0, 0.0), ("back", np.pi, 0.0), ("from below", 0.0, -0.9))
    figures = []
    for name, azimuth, elevation in views:
        camera = d.orbit_camera((low + high) / 2, 0.52 * np.linalg.norm(high - low), azimuth, elevation, 480, 480)
        figures.append(figure(drawing.shade(surfaces, camera), name))
    summaries = summaries_of(shown.job)
    summary = {**summaries.get("template", {}), **summaries.get("rig", {})}
    rows = [[k.replace("_", " "), v] for k, v in summary.items()]
    return "<p>Red: invalid triangles, which the scan does not support.</p>" + row(figures) + table(["number", "value"], rows)


def overlays(shown: Shown) -> str:
    figures = []
    for i in spread(len(shown.captured), 4):
        for c in spread(len(shown.session.rig), 3)[: 3 if i else 2]:
            camera, frame = shown.session.rig[c], shown.performance.frames[i]
            edge = drawing.outline(shown.captured[i], shown.faces, camera)
            drawn = drawing.draw_outline(shown.photo(c, frame), edge)
            figures.append(figure(drawn[drawing.crop_box(shown.captured[i], camera)], f"{camera.name}, frame {frame}"))
    seen = "<p>Outline of the captured surface on the video, on the mask where there is none.</p>" + row(figures)
    return cameras(shown) + seen + ("" if shown.matches else "<p>No feature matches: captured from silhouettes alone.</p>")


def cameras(shown: Shown) -> str:
    """How far the calibration is off by the take; empty if that was not estimated."""
    summary = summaries_of(shown.job).get("performance", {})
    found = summary.get("cameras")
    if not found:
        return ""
    kept = "No clear error of the calibration was found: it was kept."
    mended = "The calibration was refined; calibration.yml beside this page has the cameras that were used."
    columns = {
        "moved_mm": "off at the actor, mm",
        "sure_mm": "standard deviation of that, mm",
        "turned_degrees": "turned by, degrees",
        "shifted_mm": "shifted by, mm",
        "focal_percent": "focal length off by, %",
        "late_frames": "late by, frames",
    }
    rows = [[camera["camera"], *(camera[name] for name in columns)] for camera in found]
    return f"<p>{mended if summary['cameras_refined'] else kept}</p>" + table(["camera", *columns.values()], rows)


def segmentation(shown: Shown) -> str:
    segmentation, mesh = shown.job.results.segmentation(), shown.actor.mesh
    drawn = {"clothness": drawing.cloth_colours(segmentation.clothness)}
    if len(segmentation.probability):
        drawn["probability of cloth"] = drawing.probability_colours(segmentation.probability)
    sides = {"front": drawing.around(mesh.vertices, 0.0), "back": drawing.around(mesh.vertices, np.pi)}
    surfaces = {name: d.RenderMesh(mesh.vertices, shown.faces, colours=colours) for name, colours in drawn.items()}
    legend = "<p>Red: cloth. Yellow: may be either. doublet edit-segmentation OUT corrects it.</p>"
    pictures = legend + row([figure(drawing.shade([s], sides[v]), f"{name}, {v}") for name, s in surfaces.items() for v in sides])
    if not segmentation.region_count:
        return pictures + "<p>No cloth found: the character is skinned only.</p>"
    areas = d.vertex_areas(mesh.vertices, mesh.faces)
    rows = [[k, float(areas[segmentation.region == k].sum())] for k in range(segmentation.region_count)]
    return pictures + table(["region", "area, m²"], rows)


def carried(shown: Shown) -> str:
    """The cloth that the body carries, as a picture; empty if there is none."""
    attachment, cloth = shown.job.results.garment.attachment, shown.job.results.segmentation().clothness
    is_carried = (attachment >= 0.5) & (cloth > 0.5) if len(attachment) else np.zeros(len(cloth), bool)
    if not is_carried.any():
        return ""
    mesh = shown.actor.mesh
    colours = np.where(is_carried[:, None], drawing.PROXY, drawing.cloth_colours(cloth))
    surface = d.RenderMesh(mesh.vertices, shown.faces, colours=colours)
    sides = {"front": 0.0, "back": np.pi}
    text = "<p>Blue: cloth that lies on the body, which carries it; it is not simulated.</p>"
    return text + row([figure(drawing.shade([surface], drawing.around(mesh.vertices, turn)), s) for s, turn in sides.items()])


def garment(shown: Shown) -> str:
    """The cloth that is carried; the garment's mesh in the scan pose and in its rest shape."""
    worn = shown.job.results.garment
    if not shown.job.results.dressed.segmentation.region_count:
        return carried(shown) + "<p>No cloth that hangs free, so there is no garment.</p>"
    if not worn.region_count:
        return carried(shown) + "<p>No mesh of its own: the cloth is the loose part of the template.</p>"
    faces, colours = worn.mesh.faces, drawing.cloth_colours(worn.clothness)
    shapes = (("scan pose", worn.mesh.vertices), ("rest shape", worn.rest))
    camera, figures = drawing.around(np.vstack([vertices for _, vertices in shapes]), 0.0, size=800), []  # at one scale
    for name, vertices in shapes:
        solid = drawing.shade([d.RenderMesh(vertices, faces, colours=colours)], camera)
        drawn = drawing.draw_outline(solid, drawing.edges(vertices, faces, camera), (90, 50, 50))
        figures.append(figure(drawn[drawing.crop_box(vertices, camera)], name))
    summary = summaries_of(shown.job).get("garment", {})
    rows = [[k.replace("_", " "), v] for k, v in summary.items() if k != "findings"]
    rows += [[f"area in the {name}, m²", float(d.face_areas(vertices, faces).sum())] for name, vertices in shapes]
    text = "<p>Lengths and masses come from the rest shape. Light: attached to the skeleton.</p>"
    return carried(shown) + text + row(figures) + table(["number", "value"], rows)


def body(shown: Shown) -> str:
    fit = d.read_body(shown.job.path("body.npz"))
    proxies = shown.job.results.proxies()
    rest = shown.actor.skeleton.joint_rest
    naked = d.RenderMesh(fit.body.vertices, fit.body.faces, drawing.SKIN)
    capsules = [d.capsule_mesh(rest[p.joint] + p.p0, rest[p.joint] + p.p1, p.r0, p.r1) for p in proxies]
    solid = [d.RenderMesh(mesh.vertices, mesh.faces, drawing.PROXY) for mesh in capsules]
    figures = []
    for azimuth, name in ((0.0, "front"), (np.pi / 2, "side")):
        camera = drawing.around(shown.actor.mesh.vertices, azimuth)
        skin = drawing.shade([naked], camera)
        edge = drawing.outline(shown.actor.mesh.vertices, shown.faces, camera)
        figures.append(figure(drawing.draw_outline(skin, edge, (150, 150, 150)), f"body and outline of the scan, {name}"))
        through = (0.5 * skin + 0.5 * drawing.shade(solid, camera)).astype(np.uint8) if solid else skin
        figures.append(figure(through, f"collision proxies, {name}"))
    text = f"<p>Model {html.escape(fit.model)}; mean distance of the skin to the body {1000 * fit.residual:.1f} mm.</p>"
    regions = d.body_regions(fit, shown.actor, shown.job.results.segmentation())
    text += table(
        ["bone", "body surface, cm²", "seen as skin, %", "skin to body, mm", "expected error, mm"],
        [
            [
                r.joint,
                round(1e4 * r.area),
                round(100 * r.exposed),
                round(1000 * r.residual, 1) if r.exposed > 0 else "none seen",
                round(1000 * r.deviation, 1),
            ]
            for r in regions
        ],
    )
    if proxies:
        found = d.proxy_statistics(proxies, fit, shown.actor, shown.job.results.segmentation())
        lengths = ("mean_distance", "percentile95", "largest_bulge", "cloth_clearance")
        text += table(
            [
                "capsules",
                "distance to the body under cloth: mean, mm",
                "95 %, mm",
                "largest bulge, mm",
                "smallest gap to cloth, mm",
            ],
            [[found.capsules, *(round(1000 * getattr(found, name), 1) for name in lengths)]],
        )
    return row(figures) + text


def fit(shown: Shown) -> str:
    text = fit_page.sections(shown.job.out)
    return text if shown.matches else text + "<p>E_fit is its silhouette term alone: there are no feature matches.</p>"


def side_by_side(shown: Shown) -> str:
    dressed = shown.job.results.dressed
    colours = drawing.cloth_colours(dressed.segmentation.clothness)
    faces = dressed.actor.mesh.faces[np.asarray(dressed.actor.face_valid, bool)]
    captured = shown.job.results.dressed_performance().surface.frames
    camera, figures = shown.session.rig[0], []
    for i in spread(len(shown.captured), 4):
        frame = shown.performance.frames[i]
        surfaces = [d.RenderMesh(v[i], faces, colours=colours) for v in (captured, shown.simulated)]
        views = [shown.photo(0, frame), *(drawing.shade([surface], camera) for surface in surfaces)]
        box = drawing.crop_box(np.vstack([captured[i], shown.simulated[i]]), camera)
        figures.append(figure(np.hstack([v[box] for v in views]), f"frame {frame}: video, captured, simulated"))
    return row(figures)


@dataclass
class Track:
    """How far tracked surface and simulated character are from the video and from each other, over time."""

    frames: np.ndarray  # (N) of the video, those that were looked at and have silhouettes
    tracked: np.ndarray  # (N) overlap with the silhouettes, mean over the cameras
    simulated: np.ndarray  # (N) likewise
    rms: np.ndarray  # (T) cm, simulated to captured vertices of the cloth; empty without cloth
    most: np.ndarray  # (T) cm, 95 % of them are nearer


def follow(shown: Shown) -> Track:
    dressed, compared = shown.job.results.dressed, []
    faces = dressed.actor.mesh.faces[np.asarray(dressed.actor.face_valid, bool)]
    for row in spread(len(shown.captured), FRAMES_LOOKED_AT):
        masks = {c: mask > 0 for c, mask in enumerate(shown.masks(row)) if mask.size}
        surfaces = ((shown.captured[row], shown.faces), (shown.simulated[row], faces))
        if masks:
            overlaps = (drawing.mean_overlap(*surface, shown.session.rig, masks) for surface in surfaces)
            compared.append([shown.performance.frames[row], *overlaps])
    overlaps = np.array(compared, float).reshape(-1, 3).T
    cloth = dressed.segmentation.clothness > 0.5
    if not cloth.any():
        return Track(*overlaps, np.zeros(0), np.zeros(0))
    captured = shown.job.results.dressed_performance().surface.frames
    error = 100 * np.linalg.norm(np.asarray(shown.simulated)[:, cloth] - captured[:, cloth], axis=-1)
    return Track(*overlaps, np.sqrt(np.square(error).mean(axis=1)), np.percentile(error, 95, axis=1))


def overlap_in_words(track: Track) -> str:
    """Empty without silhouettes."""
    named = (("The tracked surface", track.tracked), ("The simulated character", track.simulated))
    return " ".join(
        f"{name} has a silhouette IoU of {values.mean():.3f} on average over {len(values)} frames, "
        f"least in frame {track.frames[np.argmin(values)]:.0f} ({values.min():.3f})."
        for name, values in named
        if len(values)
    )


def distance_in_words(track: Track, frames: list[int]) -> str:
    """Empty without cloth. `frames` (T) of the video."""
    if not len(track.rms):
        return ""
    at, whole = int(np.argmax(track.rms)), np.sqrt(np.square(track.rms).mean())
    return (
        f"From the captured cloth to the simulated: {whole:.1f} cm RMS over all frames, most in frame {frames[at]} "
        f"({track.rms[at]:.1f} cm). "
        "The material is fitted to outlines, features and the captured surface, not to these vertices: folds may lie elsewhere."
    )


def over_time(shown: Shown) -> str:
    """Plots of a Track, and in words where it is worst."""
    track, frames = shown.track, shown.performance.frames
    chart, axes = fit_page.drawing(1 + bool(len(track.rms)), 4.6 if len(track.rms) else 2.5)
    axes[0, 0].plot(track.frames, track.tracked, ".-", label="tracked surface")
    axes[0, 0].plot(track.frames, track.simulated, ".-", label="simulated character")
    axes[0, 0].set_ylabel("silhouette IoU")
    if len(track.rms):
        axes[1, 0].plot(frames, track.rms, label="RMS")
        axes[1, 0].plot(frames, track.most, label="95 % are nearer")
        axes[1, 0].set_ylabel("simulated to\ncaptured cloth, cm")
        axes[1, 0].set_ylim(bottom=0)
    for (axis,) in axes:
        axis.legend(frameon=False)
    axes[-1, 0].set_xlabel(f"frame of the video, {shown.session.fps:g} a second")
    text = f"{overlap_in_words(track)} {distance_in_words(track, frames)} The body that cloth hides in the scan is left out."
    return f"<p>{html.escape(text)}</p>{fit_page.svg(chart)}"


def timings(shown: Shown) -> str:
    stages = shown.job.record.data["stages"]
    done = {k: v for k, v in stages.items() if v["state"] == "done"}
    rows = [[k, float(v["seconds"]), float(v["peak_memory_mb"])] for k, v in done.items()]
    rows.append(["all", float(sum(v["seconds"] for v in done.values())), float(max(v["peak_memory_mb"] for v in done.values()))])
    measured = {k: v for k, v in summaries_of(shown.job).items() if k in done}
    numbers = [[k, n.replace("_", " "), value] for k, v in measured.items() for n, value in v.items() if n != "findings"]
    return table(["stage", "seconds", "peak memory, MB"], rows) + table(["stage", "number", "value"], numbers)


def html_list(items: list[str]) -> str:
    return f"<ul>{''.join(f'<li>{item}</li>' for item in items)}</ul>"


def verdict(shown: Shown) -> str:
    """In words: what is good, what is doubtful, and what to do about it."""
    doubts, good = doubts_of(shown.job), good_of(shown.job)
    todo = list(dict.fromkeys(ADVICE[doubt.kind] for doubt in doubts if doubt.kind in ADVICE))
    count = f"{len(doubts)} thing{'s' if len(doubts) > 1 else ''} in it {'are' if len(doubts) > 1 else 'is'} doubtful"
    parts = [f"<p><b>The reconstruction is complete; {count if doubts else 'nothing doubtful was found'}.</b></p>"]
    parts.append(f"<p>{html.escape(overlap_in_words(shown.track))}</p>")
    if good:
        parts.append(f"<p>Good:</p>{html_list([html.escape(text) for text in good])}")
    if doubts:
        items = [f"<b>{html.escape(doubt.stage)}</b>: {html.escape(doubt.text)}" for doubt in doubts]
        parts.append(f'<div class="doubt"><p>Doubtful:</p>{html_list(items)}</div>')
    if todo:
        parts.append(f"<p>To do:</p>{html_list([html.escape(text) for text in todo])}")
    return "".join(parts)


SECTIONS = (
    ("Verdict", verdict),
    ("Template", template),
    ("Reference performance", overlays),
    ("Cloth", segmentation),
    ("Body and collision proxies", body),
    ("Garment", garment),
    ("Material", fit),
    ("Simulated beside captured", side_by_side),
    ("Error over time", over_time),
    ("Time and memory", timings),
)


def write_report(job) -> None:
    shown = Shown(job)
    session = job.session
    parts = []
    for done, (title, section) in enumerate(SECTIONS):
        job.context.report_progress("report", done / len(SECTIONS))
        try:
            parts.append(f"<h2>{title}</h2>{section(shown)}")
        except (TypeError, KeyError, AttributeError) as error:
            if section not in (verdict, overlays, timings):  # what shows numbers of run.json
                raise
            path = job.record.path
            raise RuntimeError(
                f"{path}: {title}: expected numbers of the stages, found others ({error}); delete it to start afresh"
            ) from error
    head = (
        f"{len(session.cameras)} cameras, {len(shown.performance.frames)} frames at {session.fps:g} fps; "
        f"seed {job.record.data.get('seed', job.options.seed)}; doublet {__version__}"
    )
    body = f"<h1>{html.escape(session.name)}</h1><p>{html.escape(head)}</p>{''.join(parts)}"
    write_text(job.path("report.html"), page(session.name, body))
