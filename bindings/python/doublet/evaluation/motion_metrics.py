"""How a garment moves, the true one and the re-animated one side by side: distances hardly tell materials apart."""

from __future__ import annotations

import math

import numpy as np

from .metrics import attempt, azimuth_bins, horizontal, shared_frames
from .reconstruction import Reconstruction
from .truth import Missing, Truth, pelvis_index

#: Name -> (unit, meaning); the order of the table.
MEASURES = {
    "hem_speed_m_s": ("m/s", "mean speed of the hem"),
    "hem_speed_95_m_s": ("m/s", "95 % of the hem's speeds are below"),
    "hem_lag_s": ("s", "by which the hem turns later than the pelvis"),
    "hem_lag_correlation": ("", "of the two turning rates at that lag"),
    "power_above_5hz": ("", "share of the power of the garment's velocity"),
    "fold_depth_cm": ("cm", "RMS of the hem's radius without harmonics 0 to 2 around the pelvis"),
}
HEM_AZIMUTHS = 72  # directions around the pelvis in which the hem is looked at
HEM_RAGGED = 0.02  # m: a vertex of the hem hangs at most so much higher than the hem beside it
MAX_LAG = 0.5  # s
STILL = 0.1  # rad/s, standard deviation: turning this even has no lag to be seen
HIGH_FREQUENCY = 5.0  # Hz


def hem_line(points: np.ndarray, pelvis: np.ndarray) -> np.ndarray:
    """Indices of the hem's vertices: of (N, 3), the lowest in each of the HEM_AZIMUTHS directions around the pelvis (3), without
    those that hang higher than their neighbours, which are of another row where a mesh is coarser than the directions."""
    bins = azimuth_bins(points, pelvis, HEM_AZIMUTHS)
    order = np.lexsort((points[:, 1], bins))
    taken, first = np.unique(bins[order], return_index=True)
    height = np.full(HEM_AZIMUTHS, np.inf)
    height[taken] = points[order[first], 1]
    nearby = np.min([np.roll(height, shift) for shift in range(-2, 3)], axis=0)
    return order[first][(height < nearby + HEM_RAGGED)[taken]]


def speeds(points: np.ndarray, fps: float) -> np.ndarray:
    """(T - 1, N) m/s of points (T, N, 3)."""
    return fps * np.linalg.norm(np.diff(points, axis=0), axis=-1)


def turning_rate(points: np.ndarray, pelvis: np.ndarray, fps: float) -> np.ndarray:
    """(T - 1) rad/s: how points (T, N, 3) turn as a whole about the vertical through the pelvis (T, 3), least squares."""
    at = horizontal(points, pelvis[:, None])
    return fps * np.angle((at[:-1].conj() * at[1:]).sum(axis=1))


def correlation(leader: np.ndarray, follower: np.ndarray, shift: int) -> float:
    """Pearson's, of leader[t] and follower[t + shift] where there are both."""
    count = len(leader) - abs(shift)
    a, b = leader[max(0, -shift) :][:count], follower[max(0, shift) :][:count]
    a, b = a - a.mean(), b - b.mean()
    return float(a @ b) / max(math.sqrt((a @ a) * (b @ b)), 1e-12)


def lag(leader: np.ndarray, follower: np.ndarray, fps: float) -> tuple[float, float]:
    """(s, correlation): the shift at which two rates (T) correlate best, between frames by a parabola."""
    reach = round(MAX_LAG * fps)
    if len(leader) < 4 * reach:
        raise Missing(f"needs {4 * reach + 1} frames ({4 * MAX_LAG:g} s), found {len(leader) + 1}")
    if leader.std() < STILL:
        raise Missing("the pelvis hardly turns, or turns evenly")
    found = [correlation(leader, follower, shift) for shift in range(-reach, reach + 1)]
    best = int(np.argmax(found))
    if best in (0, 2 * reach):
        raise Missing(f"the correlation of the turn rates of hem and pelvis has no maximum within {MAX_LAG} s")
    before, peak, after = found[best - 1 : best + 2]
    between = (before - after) / (2 * (before - 2 * peak + after))
    return (best - reach + between) / fps, peak


def share_above(frequency: float, points: np.ndarray, fps: float) -> float:
    """Of the power of the velocity of points (T, N, 3), mean over points; Hann window."""
    if frequency >= fps / 2:
        raise Missing(f"{fps:g} frames a second do not show {frequency:g} Hz")
    velocity = fps * np.diff(points, axis=0)
    spectrum = np.fft.fft(velocity * np.hanning(len(velocity))[:, None, None], axis=0)
    power = np.square(np.abs(spectrum)).mean(axis=(1, 2))
    if not power.any():
        raise Missing("the garment does not move")
    return float(power[np.abs(np.fft.fftfreq(len(velocity), 1 / fps)) > frequency].sum() / power.sum())


def fold_depth(hem: np.ndarray, pelvis: np.ndarray) -> float:
    """m: RMS over HEM_AZIMUTHS of the radius of the hem (N, 3) without size, place and oval, its harmonics 0, 1, 2."""
    at = horizontal(hem, pelvis)
    azimuths = np.arange(HEM_AZIMUTHS) * 2 * np.pi / HEM_AZIMUTHS
    harmonics = np.fft.rfft(np.interp(azimuths, np.angle(at), np.abs(at), period=2 * np.pi))
    harmonics[:3] = 0
    return math.sqrt(np.square(np.fft.irfft(harmonics, HEM_AZIMUTHS)).mean())


def follow_each_other(frames: list[int]) -> None:
    if len(frames) < 3:
        raise Missing(f"needs three frames or more, found {len(frames)}")
    for before, after in zip(frames, frames[1:]):
        if after != before + 1:
            raise Missing(f"needs frames that follow each other, but {after} comes after {before}")


def measure(frames: list[int], points: np.ndarray, joints: np.ndarray, shown: list[int], fps: float):
    """Values and reasons by name. points (T, N, 3): a garment in `frames`; joints (T, 1 + K, 3): the pelvis, then joints that it
    carries; `shown`: the frames whose folds count."""
    pelvis, hem = joints[:, 0], points[:, hem_line(points[0], joints[0, 0])]

    def hem_speed() -> dict:
        follow_each_other(frames)
        speed = speeds(hem, fps)
        return {"hem_speed_m_s": speed.mean(), "hem_speed_95_m_s": np.percentile(speed, 95)}

    def hem_lag() -> dict:
        follow_each_other(frames)
        if joints.shape[1] < 3:
            raise Missing("the pelvis has fewer than two true child joints, so its rotation is not known")
        found = lag(turning_rate(joints[:, 1:], pelvis, fps), turning_rate(hem, pelvis, fps), fps)
        return dict(zip(("hem_lag_s", "hem_lag_correlation"), found))

    def power() -> float:
        follow_each_other(frames)
        return share_above(HIGH_FREQUENCY, points, fps)

    def folds_cm() -> float:
        depths = [fold_depth(hem[t], pelvis[t]) for t, frame in enumerate(frames) if frame in shown]
        return 100 * math.sqrt(np.square(depths).mean())

    return attempt(MEASURES, {"hem_speed": hem_speed, "hem_lag": hem_lag, "power_above_5hz": power, "fold_depth_cm": folds_cm})


def pelvis_and_children(made: Reconstruction, names: list[str]) -> list[int]:
    """Indices of true joints: the pelvis, then those that hang on it in the character's skeleton."""
    pelvis, skeleton = pelvis_index(names), made.actor.skeleton
    ours = skeleton.joint_names
    children = [n for n, parent in zip(ours, skeleton.joint_parents) if parent >= 0 and ours[parent] == names[pelvis]]
    return [pelvis, *(names.index(n) for n in children if n in names)]


def compare(made: Reconstruction, truth: Truth, fps: float) -> dict:
    """{"truth": {name: value or None}, "simulated": the same, "missing": {"truth": {name: reason}, ...}, "units": ...} over the
    reference motion; either garment in all its frames from the first to the last that both have, around the true pelvis."""
    try:
        moving, (names, joints) = made.reanimated, truth.joints()
        chosen, cloth = pelvis_and_children(made, names), moving.cloth
        shared = shared_frames(moving, truth.chunks.keys() & joints.keys(), 1)
        garments = {
            "truth": (truth.chunks, truth.garment),
            "simulated": (moving.surfaces, lambda frame: moving.surfaces[frame][cloth]),
        }
        found = {}
        for name, (known, garment) in garments.items():
            frames = [f for f in range(shared[0], shared[-1] + 1) if f in known and f in joints]
            points, at = (np.stack([get(f) for f in frames]) for get in (garment, lambda f: joints[f][chosen]))
            found[name] = measure(frames, points, at, shared, fps)
    except Missing as reason:
        nothing = dict.fromkeys(MEASURES), dict.fromkeys(MEASURES, str(reason))
        found = {"truth": nothing, "simulated": nothing}
    values = {name: value for name, (value, _) in found.items()}
    missing = {name: reasons for name, (_, reasons) in found.items()}
    return {**values, "missing": missing, "units": {k: unit for k, (unit, _) in MEASURES.items()}}


def format_table(motion: dict) -> str:
    lines = [f"{'':<25}{'truth':>9}{'simulated':>11}"]
    for name, (unit, meaning) in MEASURES.items():
        values = [motion["truth"][name], motion["simulated"][name]]
        true, ours = ("missing" if value is None else f"{value:.3f}" for value in values)
        reasons = [f"{who}: {why[name]}" for who, why in motion["missing"].items() if name in why]
        lines.append(f"{name:<25}{true:>9}{ours:>11} {unit:<3} {'; '.join(reasons) or meaning}")
    return "\n".join(lines)
