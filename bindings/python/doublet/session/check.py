"""Whether a session can be true, before anything is built on it: scan, joints, calibration and silhouettes against each other at
frame 0 if it shows the scan's pose, otherwise at the frame that comes nearest."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from .. import _doublet as d
from ..common import drawing
from ..common.files import written_atomically

UNITS = {0.001: "millimetres", 0.01: "centimetres", 0.0254: "inches", 1000.0: "kilometres"}
SHORTEST, USUAL, TALLEST = 0.5, 1.7, 2.6  #: m, of people in any pose
NEAREST, USUAL_AWAY, FARTHEST = 0.3, 4.0, 100.0  #: m, of cameras
OUTSIDE = 0.05  #: m, how far from the scan a marked joint may lie; toes and hands end near the skin
IN_PICTURE = 0.02  #: share of the scan that a camera must see
FITS, CLEARLY = 0.8, 0.05  #: overlap of a silhouette with the scan, and what makes one explanation better than another
NO_ACTOR, ALL_ACTOR = 0.0005, 0.8  #: share of the image
LOOKS = 5  #: frames at which ready masks are looked at
CHECKED_SIZE = 500  #: px, larger side of the images that are compared


@dataclass
class Evidence:
    """What the checks look at, worked out once."""

    session: d.Session
    frames: d.FrameSource
    extractor: d.SilhouetteExtractor | None
    context: d.Context = field(default_factory=d.Context)
    start: d.StartFrame | None = None  #: where a capture begins, if the scan does not fit frame 0 as it stands

    @property
    def shown_frame(self) -> int:
        return self.start.frame if self.start else 0

    @property
    def scanned(self) -> bool:
        """Is there a scan to compare with?"""
        return bool(self.session.scan.name)

    @cached_property
    def scan(self) -> d.Mesh:
        return d.read_mesh(self.session.scan)

    @cached_property
    def calibration(self) -> str:
        return f"the calibration of {self.session.name}"

    def find_start(self) -> d.StartFrame:
        """Looks for the scan's pose; what is compared from then on is that frame, with the scan where it is placed in it."""
        self.start = d.find_start_frame(self.scan, self.session.rig, self.frames, self.extractor, self.context)
        for known in ("masks", "seen", "placed", "shadows", "overlaps", "mirrored"):
            self.__dict__.pop(known, None)
        return self.start

    @cached_property
    def masks(self) -> list[np.ndarray]:
        """Of every camera at the frame that is compared: bool (H, W), or (0, 0) where it shows nothing."""
        return [self._mask(c, self.shown_frame) for c in range(len(self.session.cameras))]

    def mask(self, camera: int, frame: int) -> np.ndarray:
        return self.masks[camera] if frame == self.shown_frame else self._mask(camera, frame)

    def _mask(self, camera: int, frame: int) -> np.ndarray:
        mask = d.read_view(self.frames, camera, frame, self.extractor).mask
        return mask > 0 if mask.size else np.zeros((0, 0), bool)

    @cached_property
    def seen(self) -> list[int]:
        """Cameras with a silhouette that can be one."""
        return [c for c, mask in enumerate(self.masks) if mask.size and NO_ACTOR < mask.mean() < ALL_ACTOR]

    def in_place(self, points: np.ndarray) -> np.ndarray:
        """(N, 3) points of the scan, where it is placed in the frame that is compared."""
        if self.start is None:
            return points
        placed = np.asarray(self.start.world_from_scan)
        return points @ placed[:3, :3].T + placed[:3, 3]

    @cached_property
    def shadows(self) -> list[np.ndarray]:
        """Where every camera, made small, sees the scan: bool (h, w)."""
        rig, vertices = [small(camera) for camera in self.session.rig], self.in_place(np.asarray(self.scan.vertices))
        return [d.rasterize(vertices, self.scan.faces, camera)[0] >= 0 for camera in rig]

    @cached_property
    def overlaps(self) -> np.ndarray:
        """(C, C) IoU of the silhouette of camera i with the scan seen from camera j; NaN where there is no silhouette."""
        result = np.full((len(self.shadows), len(self.shadows)), np.nan)
        for i in self.seen:
            for j, shadow in enumerate(self.shadows):
                result[i, j] = iou(resized(self.masks[i], shadow.shape), shadow)
        return result

    @cached_property
    def mirrored(self) -> np.ndarray:
        """(C) the same, each with its own camera, for the silhouette as a mirror shows it."""
        result = np.full(len(self.session.rig), np.nan)
        for c in self.seen:
            result[c] = iou(resized(self.masks[c], self.shadows[c].shape)[:, ::-1], self.shadows[c])
        return result


def small(camera: d.Camera) -> d.Camera:
    scale = min(1.0, CHECKED_SIZE / max(camera.width, camera.height))
    return camera.resized(max(1, round(scale * camera.width)), max(1, round(scale * camera.height)))


def resized(mask: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    return np.asarray(Image.fromarray(mask.astype(np.uint8) * 255).resize(shape[::-1])) > 127


def iou(a: np.ndarray, b: np.ndarray) -> float:
    union = (a | b).sum()
    return float((a & b).sum() / union) if union else 0.0


def likely_unit(length: float, usual: float) -> str:
    """In words, the unit in which `length` is nearest to a `usual` one in metres; empty if none comes near."""
    off = {name: abs(np.log(max(length, 1e-9) * factor / usual)) for factor, name in UNITS.items()}
    unit = min(off, key=off.get)
    return f"; it looks like {unit}" if off[unit] < np.log(3) else ""


def from_inside(scene: d.RayScene, mesh: d.Mesh, points: np.ndarray) -> np.ndarray:
    """(N) share of 14 directions in which a point (N, 3) sees the surface's back: more than half inside, whatever holes and inner
    walls a scan has."""
    directions = np.array(list(np.ndindex(3, 3, 3))) - 1.0
    directions = directions[(np.abs(directions).sum(axis=1) % 2).astype(bool)]  # faces and corners of a cube
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    face, _ = scene.cast(np.repeat(points, len(directions), axis=0), np.tile(directions, (len(points), 1)))
    back = (d.face_normals(mesh.vertices, mesh.faces)[face] * np.tile(directions, (len(points), 1))).sum(axis=1) > 0
    return ((face >= 0) & back).reshape(len(points), -1).mean(axis=1)


def check_scan(evidence: Evidence) -> Iterator[d.Finding]:
    size = np.ptp(evidence.scan.vertices, axis=0)
    name = evidence.session.scan
    if not SHORTEST <= size.max() <= TALLEST:
        yield d.Finding(
            True,
            f"{name}: expected a person of {SHORTEST} to {TALLEST} m, found {size.max():.4g} m{likely_unit(size.max(), USUAL)}",
        )
    elif size[1] < 0.7 * size.max():
        axis = "xyz"[size.argmax()]
        yield d.Finding(
            True, f"{name}: expected a person who stands along y, found {size[1]:.2f} m in y and {size.max():.2f} m in {axis}"
        )


def check_joints(evidence: Evidence) -> Iterator[d.Finding]:
    names = [mark.name for mark in evidence.session.joints]
    places = np.array([mark.position for mark in evidence.session.joints])
    span, tall = np.ptp(places, axis=0).max(), np.ptp(evidence.scan.vertices, axis=0).max()
    where = f"joints of {evidence.session.folder}"
    if not 0.4 < span / tall < 1.5:
        unit = likely_unit(span, tall)
        yield d.Finding(True, f"{where}: expected marks spread over the scan's {tall:.3g} m, found {span:.4g} m{unit}")
        return
    scene = d.RayScene(evidence.scan)
    distance = scene.closest(places)[1]
    far = (distance > OUTSIDE) & (from_inside(scene, evidence.scan, places) < 0.5)
    if far.any():
        worst = int(np.where(far, distance, 0).argmax())
        text = (
            f"{where}: expected every joint inside the scan, found {far.sum()} of {len(far)} more than {1000 * OUTSIDE:.0f} mm "
            f"outside ({names[worst]} by {1000 * distance[worst]:.0f} mm)"
        )
        yield d.Finding(bool(far.mean() > 0.25), text)


def in_picture(camera: d.Camera, vertices: np.ndarray, translation: float = 1.0) -> float:
    """Share of the vertices that the camera sees if its t is multiplied by `translation`."""
    local = vertices @ np.asarray(camera.R).T + translation * np.ravel(camera.t)
    ahead = local[:, 2] > 1e-6
    pixels = (local / np.where(ahead, local[:, 2], 1)[:, None]) @ np.asarray(camera.K).T
    inside = (pixels[:, :2] >= 0).all(axis=1) & (pixels[:, :2] < [camera.width, camera.height]).all(axis=1)
    return float((ahead & inside).mean())


def check_calibration(evidence: Evidence) -> Iterator[d.Finding]:
    """Units first: a camera in millimetres is a kilometre away, and the person a dot that it sees all of."""
    vertices, rig = np.asarray(evidence.scan.vertices), evidence.session.rig
    away = np.median([np.linalg.norm(np.ravel(camera.centre) - vertices.mean(axis=0)) for camera in rig])
    if not NEAREST < away < FARTHEST:
        wanted = f"expected cameras {NEAREST} to {FARTHEST:g} m from the scan"
        yield d.Finding(True, f"{evidence.calibration}: {wanted}, found {away:.4g} m{likely_unit(away, USUAL_AWAY)}")
        return
    blind = [camera.name for camera in rig if in_picture(camera, vertices) < IN_PICTURE]
    if blind:
        text = f"{evidence.calibration}: expected the scan in every camera's picture, found it outside that of {', '.join(blind)}"
        yield d.Finding(len(blind) > len(rig) / 2, text)


def check_masks(evidence: Evidence) -> Iterator[d.Finding]:
    """Ready masks at a few frames, silhouettes at the first."""
    last = evidence.session.frame_count - 1
    for c, camera in enumerate(evidence.session.cameras):
        ready = camera.masks != Path()
        looks = sorted({round(f) for f in np.linspace(0, last, LOOKS)}) if ready else [0]
        shares = [mask.mean() if (mask := evidence.mask(c, f)).size else None for f in looks]
        where, kind = f"camera {camera.name}", "masks" if ready else "silhouettes"
        known = [share for share in shares if share is not None]
        for limit, wrong in ((lambda x: x < NO_ACTOR, "nothing"), (lambda x: x > ALL_ACTOR, "the whole image")):
            count = sum(bool(limit(share)) for share in known)
            if count:
                text = f"{where}: expected {kind} that show a person, found {wrong} in {count} of the {len(known)} looked at"
                yield d.Finding(count > len(known) / 2, text)
        if len(known) < len(shares):
            missing = f"found none in {len(shares) - len(known)} of the {len(shares)} looked at"
            text = f"{where}: expected {kind} for every frame, {missing}"
            yield d.Finding(len(known) <= len(shares) / 2, text)


def check_overlap(evidence: Evidence) -> Iterator[d.Finding]:
    if not evidence.seen:
        return
    names, table = [camera.name for camera in evidence.session.cameras], evidence.overlaps
    own, mirrored = np.diag(table), evidence.mirrored
    middle = float(np.nanmedian(own))
    where = "frame 0"
    if np.nanmedian(mirrored) > max(middle + CLEARLY, 0.7):
        text = f"{where}: expected images as the camera saw them, found ones that fit the scan if they are mirrored"
        yield d.Finding(True, f"{text} (overlap {np.nanmedian(mirrored):.2f}, as they are {middle:.2f})")
        return
    swapped = [(i, j) for i in evidence.seen for j in evidence.seen if i < j and is_swapped(table, i, j)]
    for i, j in swapped:
        text = f"{where}: expected videos in the order of the calibration, found that {names[i]} and {names[j]} look swapped"
        overlap = f"overlap {own[i]:.2f} and {own[j]:.2f}, swapped {table[i, j]:.2f} and {table[j, i]:.2f}"
        yield d.Finding(True, f"{text} ({overlap})")
    if swapped:
        return
    bad = [f"{names[c]} {own[c]:.2f}" for c in evidence.seen if own[c] < FITS]
    if bad and middle < FITS:
        yield from check_start(evidence)
    elif bad:
        text = f"{where}: expected scan and silhouettes to overlap by at least {FITS}, found {', '.join(bad)}"
        yield d.Finding(False, text + "; do scan, calibration and time belong together?")


def check_start(evidence: Evidence) -> Iterator[d.Finding]:
    """A take need not begin in the scan's pose, nor where the scan stands."""
    start = evidence.find_start()
    if start.in_scan_pose:
        return
    nearest = f"nearest is frame {start.frame} with an overlap of {start.overlap:.2f}"
    if start.near_scan_pose:
        text = f"expected a frame in the scan's pose, {FITS} at least, found none: {nearest}, and the pose is searched there"
        yield d.Finding(False, text)
        return
    text = f"expected a frame in the scan's pose, or near it, found none: {nearest}"
    yield d.Finding(True, text + "; do scan, calibration and time belong together?")


def describe_start(evidence: Evidence) -> str:
    """In words; empty if the scan fits frame 0 as it stands."""
    start = evidence.start
    if start is None or not start.in_scan_pose:
        return ""
    if start.frame == 0:
        return f"frame 0 is in the scan's pose, but elsewhere: overlap {start.overlap:.2f} with the scan moved and turned"
    return (
        f"frame 0 is not in the scan's pose (overlap {start.first_overlap:.2f}); frame {start.frame} is ({start.overlap:.2f}), "
        "and tracking begins there and goes both ways"
    )


def is_swapped(table: np.ndarray, i: int, j: int) -> bool:
    """Do both silhouettes fit the other camera, where neither fits its own?"""
    better = table[i, j] > table[i, i] + CLEARLY and table[j, i] > table[j, j] + CLEARLY
    return bool(better and min(table[i, j], table[j, i]) > FITS)


def check_rates(evidence: Evidence) -> Iterator[d.Finding]:
    """What the containers say; 0 = nothing. Cameras that disagree are not synchronous; one rate for all may be slow motion."""
    said = {camera.name: camera.video_fps for camera in evidence.session.cameras if camera.video_fps > 0}
    if not said:
        return
    usual = float(np.median(list(said.values())))
    others = [f"{name} {fps:.4g}" for name, fps in said.items() if abs(fps - usual) > 0.02 * usual]
    if others:
        yield d.Finding(True, f"videos: expected one frame rate, found {', '.join(others)} and {usual:.4g} in the others")
    elif abs(usual - evidence.session.fps) > 0.02 * usual:
        yield d.Finding(False, f"session.json: expected the videos' frame rate {usual:.4g}, found {evidence.session.fps:.4g}")


CHECKS = (check_scan, check_joints, check_calibration, check_rates, check_masks, check_overlap)
WITHOUT_SCAN = (check_rates, check_masks)


def check_session(evidence: Evidence) -> list[d.Finding]:
    """Every check, the cheap ones first; none is made on what an earlier one found impossible, or on a scan that is not there."""
    found: list[d.Finding] = []
    checks = CHECKS if evidence.scanned else WITHOUT_SCAN
    for check in checks:
        if check is check_joints and not evidence.session.joints:
            continue
        found += check(evidence)
        if any(finding.impossible for finding in found):
            break
    return found


def draw(evidence: Evidence) -> np.ndarray:
    """(H, W, 3) RGB: the frame that was compared, of every camera, with the outlines of scan (magenta) and silhouette (green),
    the joints (yellow), and the camera's name and overlap; without a scan, silhouettes alone."""
    tiles = []
    for c, full in enumerate(evidence.session.rig):
        camera = small(full)
        shape = (camera.height, camera.width)
        image = evidence.frames.image(c, evidence.shown_frame)
        photo = np.full((*shape, 3), 100, np.uint8)
        if image.size:
            photo = np.asarray(Image.fromarray(image[..., ::-1]).resize(shape[::-1]))
        if evidence.masks[c].size:
            photo = drawing.draw_outline(photo, drawing.mask_outline(resized(evidence.masks[c], shape)), (0, 220, 60))
        text = full.name
        if evidence.scanned:
            photo = drawing.draw_outline(photo, drawing.mask_outline(evidence.shadows[c]))
            text += f"  overlap {evidence.overlaps[c, c]:.2f}"
        for mark in evidence.session.joints:
            dot(photo, camera.project(evidence.in_place(np.asarray(mark.position))))
        tiles.append(labelled(photo, text))
    height = max(tile.shape[0] for tile in tiles)
    columns = min(4, len(tiles))
    tiles = [np.pad(tile, ((0, height - len(tile)), (0, CHECKED_SIZE - tile.shape[1]), (0, 0))) for tile in tiles]
    tiles += [np.zeros_like(tiles[0])] * (-len(tiles) % columns)
    return np.vstack([np.hstack(tiles[r : r + columns]) for r in range(0, len(tiles), columns)])


def labelled(image: np.ndarray, text: str) -> np.ndarray:
    shown = Image.fromarray(image)
    ImageDraw.Draw(shown).text((8, 6), text, fill=(255, 255, 255), stroke_width=1, stroke_fill=(0, 0, 0))
    return np.array(shown)


def dot(image: np.ndarray, place) -> None:
    x, y = np.ravel(place)
    if np.isfinite([x, y]).all() and 0 <= x < image.shape[1] and 0 <= y < image.shape[0]:
        x, y = int(x), int(y)
        image[max(0, y - 2) : y + 3, max(0, x - 2) : x + 3] = (255, 220, 0)


def check_and_draw(evidence: Evidence, path: Path) -> list[d.Finding]:
    """Every check, and the picture of it."""
    found = check_session(evidence)
    write_picture(path, draw(evidence))
    return found


def write_picture(path: Path, image: np.ndarray) -> None:
    with written_atomically(path) as partial:
        Image.fromarray(image).save(partial, "PNG")
