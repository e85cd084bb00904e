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
    return {"tube": tube, "camera": look_at_origin, "views": views_of}


MOVED, FRAMES = 40.0, 24  # frames a second of the bell, and how many


def contour_of(mask):
    """(N, 2) pixels x, y of the mask with a neighbour outside it."""
    inside = np.pad(mask, 1)
    all_around = inside[:-2, 1:-1] & inside[2:, 1:-1] & inside[1:-1, :-2] & inside[1:-1, 2:]
    return np.argwhere(mask & ~all_around)[:, ::-1].astype(np.float32)


def views_of(frames, faces, cameras):
    """[frames][cameras] what an observer without error sees of the surfaces."""
    import doublet as d

    nothing = np.zeros((0, 4), np.float32)
    return [[d.ViewObservation(contour_of(d.rasterize(v, faces, camera)[0] >= 0), nothing) for camera in cameras] for v in frames]


@pytest.fixture(scope="session")
def bell(tmp_path_factory):
    """Folder with what `doublet fit` reads: a swinging bell whose lower half is cloth (d_n 4), filmed without error."""
    import doublet as d

    vertices, faces = tube(lambda h: 0.35 - 0.15 * h, 0.5, 1.5, around=24, rows=13)
    skeleton = d.Skeleton([d.JointAnnotation("pelvis", "", [0, 1, 0], 6)])
    actor = d.RiggedMesh(d.Mesh(vertices, faces), [1] * len(faces), np.ones((len(vertices), 1)), skeleton)
    cloth = (vertices[:, 1] < 1).astype(float)
    clothness = d.Segmentation(np.zeros_like(cloth), cloth, np.where(cloth > 0, 0, -1).astype(np.int32))
    performance = d.ReferencePerformance()
    dofs = np.zeros((FRAMES, 6))
    dofs[:, 0] = 0.3 * np.sin(np.arange(FRAMES) * 10 / MOVED)
    performance.dofs = dofs
    performance.frames = list(range(FRAMES))
    performance.joints = np.zeros((FRAMES, 1, 3))
    performance.surface = d.MeshSequence(faces, vertices[None])
    truth = d.Material(d_n=4, d_t=4.9, k_bend=0.3, k_stretch=0.999)
    simulator = d.CharacterSimulator(actor, clothness, [], d.ClothOptions.paper())
    frames = d.simulate_reference(simulator, performance, [truth], 1 / MOVED)
    performance.surface = d.MeshSequence(faces, np.concatenate([vertices[None], frames[1:]]))
    observations = d.Observations()
    observations.cameras = [look_at_origin(a, name=f"cam{i}", height=1.0, size=320) for i, a in enumerate((0, 2.1, 4.2))]
    observations.frames = performance.frames
    observations.views = views_of(frames, faces, observations.cameras)
    out = tmp_path_factory.mktemp("bell")
    d.write_actor(out / "actor.npz", actor)
    d.write_performance(out / "performance.npz", performance)
    d.write_segmentation(out / "segmentation.npz", clothness)
    as_it_is = d.GarmentOptions(remesh=False)
    d.write_garment(out / "garment.npz", d.mesh_garment(actor, clothness, d.Mesh(), performance.surface, as_it_is))
    d.write_proxies(out / "proxies.json", [], skeleton)
    d.write_observations(out / "observations.npz", observations)
    return out
