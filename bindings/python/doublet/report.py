"""report.html: one self-contained page about a reconstruction."""

from __future__ import annotations

import html
import json

import numpy as np

from . import __version__, fit_page, picture
from . import _doublet as d
from .files import arrays_of, write_text
from .page import STYLE, table
from .plausible import LIMITS, findings


def figure(image: np.ndarray, caption: str) -> str:
    text = html.escape(caption)
    return f'<figure><img src="{picture.data_uri(image)}" alt="{text}"><figcaption>{text}</figcaption></figure>'


def row(figures) -> str:
    return f'<div class="row">{"".join(figures)}</div>'


def spread(count: int, wanted: int) -> list[int]:
    """`wanted` indices over [0, count), both ends included."""
    return sorted({round(i) for i in np.linspace(0, count - 1, min(count, wanted))})


class Shown:
    """What the page shows, read from the files of OUT."""

    def __init__(self, job):
        self.job = job
        self.session = job.session
        self.actor = job.actor
        self.performance = job.performance()
        self.faces = self.actor.mesh.faces[np.asarray(self.actor.face_valid, bool)]
        self.captured = self.performance.surface.frames
        self.simulated = d.read_simulated(job.path("simulated.npz"))  # of the dressed actor
        self.source = d.FrameSource.open(job.session)
        with arrays_of(job.path("observations.npz")) as observations:
            self.matches = len(observations["match_points"])

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
        figures.append(figure(picture.shade(surfaces, camera), name))
    stages = shown.job.record.data["stages"]
    summary = {**stages.get("template", {}).get("summary", {}), **stages.get("rig", {}).get("summary", {})}
    rows = [[k.replace("_", " "), v] for k, v in summary.items()]
    return "<p>Red: invalid triangles, which the scan does not support.</p>" + row(figures) + table(["number", "value"], rows)


def overlays(shown: Shown) -> str:
    figures = []
    for i in spread(len(shown.captured), 4):
        for c in spread(len(shown.session.rig), 3)[: 3 if i else 2]:
            camera, frame = shown.session.rig[c], shown.performance.frames[i]
            edge = picture.outline(shown.captured[i], shown.faces, camera)
            drawn = picture.draw_outline(shown.photo(c, frame), edge)
            figures.append(figure(drawn[picture.crop_box(shown.captured[i], camera)], f"{camera.name}, frame {frame}"))
    seen = "<p>Outline of the captured surface on the video, on the mask where there is none.</p>" + row(figures)
    return seen + ("" if shown.matches else "<p>No feature matches: captured from silhouettes alone.</p>")


def segmentation(shown: Shown) -> str:
    segmentation = shown.job.segmentation()
    mesh = shown.actor.mesh
    surface = d.RenderMesh(mesh.vertices, shown.faces, colours=picture.cloth_colours(segmentation.clothness))
    views = [picture.shade([surface], picture.around(mesh.vertices, a)) for a in (0.0, np.pi)]
    pictures = row([figure(v, n) for v, n in zip(views, ("front", "back"))])
    if not segmentation.region_count:
        return pictures + "<p>No cloth found: the character is skinned only.</p>"
    areas = d.vertex_areas(mesh.vertices, mesh.faces)
    rows = [[k, float(areas[segmentation.region == k].sum())] for k in range(segmentation.region_count)]
    return pictures + table(["region", "area, m²"], rows)


def garment(shown: Shown) -> str:
    """The garment's mesh in the scan pose and in its rest shape."""
    worn = shown.job.garment
    if not shown.job.dressed.segmentation.region_count:
        return "<p>No cloth, so there is no garment.</p>"
    if not worn.region_count:
        return "<p>No mesh of its own: the cloth is what of the template is loose.</p>"
    faces, colours = worn.mesh.faces, picture.cloth_colours(worn.clothness)
    shapes = (("scan pose", worn.mesh.vertices), ("rest shape", worn.rest))
    camera, figures = picture.around(np.vstack([vertices for _, vertices in shapes]), 0.0, size=800), []  # at one scale
    for name, vertices in shapes:
        solid = picture.shade([d.RenderMesh(vertices, faces, colours=colours)], camera)
        drawn = picture.draw_outline(solid, picture.edges(vertices, faces, camera), (90, 50, 50))
        figures.append(figure(drawn[picture.crop_box(vertices, camera)], name))
    summary = shown.job.record.data["stages"].get("garment", {}).get("summary", {})
    rows = [[k.replace("_", " "), v] for k, v in summary.items()]
    rows += [[f"area in the {name}, m²", float(d.face_areas(vertices, faces).sum())] for name, vertices in shapes]
    text = "<p>Lengths and masses come from the rest shape. Light: what hangs on the skeleton.</p>"
    return text + row(figures) + table(["number", "value"], rows)


def body(shown: Shown) -> str:
    fit = d.read_body(shown.job.path("body.npz"))
    proxies = d.read_proxies(shown.job.path("proxies.json"), shown.actor.skeleton)
    rest = shown.actor.skeleton.joint_rest
    naked = d.RenderMesh(fit.body.vertices, fit.body.faces, picture.SKIN)
    capsules = [d.capsule_mesh(rest[p.joint] + p.p0, rest[p.joint] + p.p1, p.r0, p.r1) for p in proxies]
    solid = [d.RenderMesh(mesh.vertices, mesh.faces, picture.PROXY) for mesh in capsules]
    figures = []
    for azimuth, name in ((0.0, "front"), (np.pi / 2, "side")):
        camera = picture.around(shown.actor.mesh.vertices, azimuth)
        skin = picture.shade([naked], camera)
        edge = picture.outline(shown.actor.mesh.vertices, shown.faces, camera)
        figures.append(figure(picture.draw_outline(skin, edge, (150, 150, 150)), f"body and outline of the scan, {name}"))
        through = (0.5 * skin + 0.5 * picture.shade(solid, camera)).astype(np.uint8) if solid else skin
        figures.append(figure(through, f"collision proxies, {name}"))
    text = f"<p>Model {html.escape(fit.model)}; mean distance of the skin to the body {1000 * fit.residual:.1f} mm.</p>"
    regions = d.body_regions(fit, shown.actor, shown.job.segmentation())
    text += table(
        ["bone", "body surface, cm²", "seen as skin, %", "skin to body, mm", "expected error, mm"],
        [
            [r.joint, round(1e4 * r.area), round(100 * r.exposed), round(1000 * r.residual, 1), round(1000 * r.deviation, 1)]
            for r in regions
        ],
    )
    if proxies:
        found = d.proxy_statistics(proxies, fit, shown.actor, shown.job.segmentation())
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
    dressed = shown.job.dressed
    colours = picture.cloth_colours(dressed.segmentation.clothness)
    faces = dressed.actor.mesh.faces[np.asarray(dressed.actor.face_valid, bool)]
    captured = shown.job.dressed_performance().surface.frames
    camera, figures = shown.session.rig[0], []
    for i in spread(len(shown.captured), 4):
        frame = shown.performance.frames[i]
        surfaces = [d.RenderMesh(v[i], faces, colours=colours) for v in (captured, shown.simulated)]
        views = [shown.photo(0, frame), *(picture.shade([surface], camera) for surface in surfaces)]
        box = picture.crop_box(np.vstack([captured[i], shown.simulated[i]]), camera)
        figures.append(figure(np.hstack([v[box] for v in views]), f"frame {frame}: video, captured, simulated"))
    return row(figures)


def timings(shown: Shown) -> str:
    stages = shown.job.record.data["stages"]
    done = {k: v for k, v in stages.items() if v["state"] == "done"}
    rows = [[k, float(v["seconds"]), float(v["peak_memory_mb"])] for k, v in done.items()]
    rows.append(["all", float(sum(v["seconds"] for v in done.values())), float(max(v["peak_memory_mb"] for v in done.values()))])
    numbers = [[k, n, json.dumps(value)] for k, v in done.items() for n, value in v["summary"].items()]
    return table(["stage", "seconds", "peak memory, MB"], rows) + table(["stage", "number", "value"], numbers)


def verdict(shown: Shown) -> str:
    """In words: what is good, what is doubtful, and what to do about it."""
    stages = shown.job.record.data["stages"]
    doubts = [(name, finding.text) for name, entry in stages.items() for finding in findings(name, entry.get("summary", {}))]
    lost = stages.get("performance", {}).get("summary", {}).get("frames_lost", {})
    doubts += [("performance", f"{joint} was lost in {count} frames; look at them in the video") for joint, count in lost.items()]
    fitted = shown.job.path("material.json")
    regions = json.loads(fitted.read_text(encoding="utf-8"))["regions"] if fitted.exists() else []
    doubts += [("fit", remark) for region in regions for remark in region.get("remarks", [])]
    good = [
        f"{limit.meaning}: {stages[name]['summary'][limit.name]:.3g}"
        for name, limits in LIMITS.items()
        for limit in limits
        if limit.name in stages.get(name, {}).get("summary", {}) and not limit.finding(stages[name]["summary"][limit.name])
    ]
    text = f"<p>As it should be: {html.escape('; '.join(good))}.</p>" if good else ""
    if not doubts:
        return text + "<p>Nothing doubtful was found.</p>"
    listed = "".join(f"<li><b>{html.escape(name)}</b>: {html.escape(words)}</li>" for name, words in doubts)
    return f"{text}<p>Doubtful:</p><ul>{listed}</ul>"


SECTIONS = (
    ("Verdict", verdict),
    ("Template", template),
    ("Reference performance", overlays),
    ("Cloth", segmentation),
    ("Body and collision proxies", body),
    ("Garment", garment),
    ("Material", fit),
    ("Simulated beside captured", side_by_side),
    ("Time and memory", timings),
)


def write_report(job) -> None:
    shown = Shown(job)
    session = job.session
    parts = []
    for done, (title, section) in enumerate(SECTIONS):
        job.context.report("report", done / len(SECTIONS))
        parts.append(f"<h2>{title}</h2>{section(shown)}")
    head = (
        f"{len(session.cameras)} cameras, {len(shown.performance.frames)} frames at {session.fps:g} fps; "
        f"seed {job.record.data.get('seed', job.seed)}; doublet {__version__}"
    )
    page = (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{html.escape(session.name)}</title><style>{STYLE}</style>'
        f"<h1>{html.escape(session.name)}</h1><p>{html.escape(head)}</p>{''.join(parts)}</html>\n"
    )
    write_text(job.path("report.html"), page)
