import numpy as np
import pytest


def tube(radius, low, high, around=48, rows=24):
    """Open tube about +Y: vertices (rows * around, 3) m, outward faces. radius: number or function of height."""
    heights = np.linspace(low, high, rows)
    turn = np.linspace(0, 2 * np.pi, around, endpoint=False)
    radii = np.array([radius(h) if callable(radius) else radius for h in heights])
    vertices = np.stack(
        [
            radii[:, None] * np.sin(turn),
            np.repeat(heights[:, None], around, axis=1),
            radii[:, None] * np.cos(turn),
        ],
        axis=-1,
    ).reshape(-1, 3)
    here = (np.arange(rows - 1)[:, None] * around + np.arange(around)).ravel()
    ahead = (np.arange(rows - 1)[:, None] * around + (np.arange(around) + 1) % around).ravel()
    faces = np.vstack([np.stack([here, ahead, ahead + around], 1), np.stack([here, ahead + around, here + around], 1)])
    return vertices, faces.astype(np.int32)


def look_at_origin(azimuth, distance=3.0, size=200, name="cam", height=0.5):
    from doublet import Camera

    back = np.array([np.sin(azimuth), 0, np.cos(azimuth)])
    camera = Camera()
    camera.name = name
    camera.R = np.array([np.cross([0, 1.0, 0], back), [0, -1.0, 0], -back])
    camera.t = -camera.R @ (distance * back + [0, height, 0])
    camera.K = np.array([[1.6 * size, 0, size / 2], [0, 1.6 * size, size / 2], [0, 0, 1.0]])
    camera.width = camera.height = size
    return camera


@pytest.fixture(scope="session")
def shapes():
    return {"tube": tube, "camera": look_at_origin}
