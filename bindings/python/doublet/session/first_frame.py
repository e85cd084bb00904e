"""What a session's cameras show in one frame."""

from __future__ import annotations

import numpy as np

from .. import _doublet as d


def camera_views(session: d.Session, frame: int, silhouettes: d.SilhouetteExtractor | None) -> tuple[list, list]:
    """Of every camera: image (H, W, 3), empty where there is none, and silhouette (H, W)."""
    source = d.FrameSource.open(session)
    views = [d.read_view(source, camera, frame, silhouettes) for camera in range(source.camera_count)]
    return [view.image for view in views], [view.mask for view in views]


def first_colours(
    actor: d.RiggedMesh,
    performance: d.ReferencePerformance,
    session: d.Session,
    silhouettes: d.SilhouetteExtractor | None,
    context: d.Context,
) -> np.ndarray:
    """What the surface looks like in the first captured frame, for SegmentInputs.colours."""
    images, masks = camera_views(session, performance.frames[0], silhouettes)
    first = d.Mesh(performance.surface.frames[0], actor.mesh.faces)
    return d.sample_colours(first, actor.face_valid, session.rig, images, masks, context=context)
