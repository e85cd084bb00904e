"""By how much cameras began to film after each other: from their sound tracks, or from how what they show moves.

A camera's offset (s) is the time at which its file begins on the clock that all share: common time = time in the file + offset.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ..common.images import ImageSeries
from ..common.video import VideoFile

RATE = 8000  #: Hz, to which sound is brought
ONSET_STEP = 16  #: samples, 2 ms
SIGHT_STEP = 0.005  #: s
PREVIEW = 160  #: px, larger side of the images in which motion is measured
CHANGED = 12  #: grey levels, above the noise of sensors and codecs
SOUND_APART, SIGHT_APART = 0.1, 0.2  #: s, how far from the highest peak another one is separate
SOUND_CLEAR, SIGHT_CLEAR = 1.5, 1.25  #: how much higher than a separate one a camera's highest peak must be
LEAST_SCORE = 0.25  #: of a camera's peak: the correlation, less where little overlaps
AS_GOOD = 0.95  #: share of every camera's best agreement from which no offsets at all are the better explanation
SHORTEST = 20  #: steps of a signal in which something can be found
SLACK = 0.3  #: of a frame, by which a camera may end before the last frame that is taken
LEAST_OVERLAP = 0.3  #: share of the shorter of two files that must overlap


@dataclass(frozen=True)
class Peak:
    """Where two signals agree best."""

    lag: float  # s, time in the first less time in the second
    score: float
    second: float  # score of the highest separate peak

    @property
    def clearness(self) -> float:
        return self.score / max(self.second, 1e-3)


@dataclass(frozen=True)
class Signal:
    """Channels (K, N) of what happens in a file, at equal steps (s) from `start` on the file's clock."""

    values: np.ndarray
    step: float
    start: float


#: Of each pair of cameras lags (s), rising, and the score of each.
Curves = dict[tuple[int, int], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Offsets:
    """Seconds (C), the first camera's 0, whether they are to be believed, and why, in words."""

    seconds: np.ndarray
    trusted: bool
    reason: str


def scores(a: Signal, b: Signal) -> tuple[np.ndarray, np.ndarray]:
    """Lags (s), and for each the correlation of what overlaps, averaged over channels; less where little overlaps, since chance
    agrees there."""
    n, m = a.values.shape[1], b.values.shape[1]
    size = 1 << int(np.ceil(np.log2(n + m)))

    def correlated(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        product = np.fft.irfft(np.fft.rfft(x, size) * np.conj(np.fft.rfft(y, size)), size)
        return np.concatenate([product[..., size - m + 1 :], product[..., :n]], axis=-1)  # lags -(m - 1) .. n - 1

    overlap = np.rint(correlated(np.ones(n), np.ones(m)))
    power = correlated(a.values**2, np.ones(m)) * correlated(np.ones(n), b.values**2)
    agreement = (correlated(a.values, b.values) / np.sqrt(np.maximum(power, 1e-9 * overlap**2 + 1e-12))).mean(axis=0)
    result = agreement * np.sqrt(overlap / min(n, m))
    result[overlap < LEAST_OVERLAP * min(n, m)] = -1
    return (np.arange(-(m - 1), n)) * a.step + a.start - b.start, result


def find_peak(lags: np.ndarray, score: np.ndarray, apart: float) -> Peak:
    """The highest score, to a part of a step, and the highest separate one."""
    top = int(score.argmax())
    part = 0.0
    if 0 < top < len(score) - 1 and min(score[top - 1], score[top + 1]) > -1:
        left, middle, right = score[top - 1 : top + 2]
        part = 0.5 * (left - right) / min(left - 2 * middle + right, -1e-12)
    local = np.r_[False, (score[1:-1] >= score[:-2]) & (score[1:-1] >= score[2:]), False]
    others = score[local & (np.abs(lags - lags[top]) > apart)]
    return Peak(float(lags[top] + part * (lags[1] - lags[0])), float(score[top]), float(max(others, default=0.0)))


def standardised(channels: np.ndarray) -> np.ndarray:
    """Mean 0, deviation 1; a channel in which nothing happens is 0."""
    channels = channels - channels.mean(axis=1, keepdims=True)
    deviation = channels.std(axis=1, keepdims=True)
    return np.where(deviation > 1e-9, channels / np.maximum(deviation, 1e-9), 0)


def smoothed(values: np.ndarray, steps: float) -> np.ndarray:
    """Gaussian of a deviation in steps, along the last axis."""
    reach = int(np.ceil(3 * steps))
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / max(steps, 1e-6)) ** 2)
    kernel /= kernel.sum()
    padded = np.pad(values, ((0, 0), (reach, reach)), mode="edge")
    return np.stack([np.convolve(row, kernel, mode="valid") for row in padded])


def sound_signal(video: VideoFile) -> Signal:
    """Onsets: how fast the loudness rises."""
    sound = video.sound(RATE)
    count = len(sound) // ONSET_STEP
    power = (sound[: count * ONSET_STEP].reshape(count, ONSET_STEP) ** 2).mean(axis=1) if count else np.zeros(1)
    loudness = np.log(smoothed(power[None], 2) + 1e-7)
    onsets = np.maximum(np.diff(loudness, axis=1, prepend=loudness[:, :1]), 0)
    step = ONSET_STEP / RATE
    return Signal(standardised(smoothed(onsets, 2)), step, video.sound_start + step / 2)


def preview_size(size: tuple[int, int]) -> tuple[int, int]:
    scale = min(1.0, PREVIEW / max(size))
    return max(1, round(scale * size[0])), max(1, round(scale * size[1]))


def video_signal(video: VideoFile | ImageSeries) -> Signal:
    """Of a video without silhouettes: what differs from the median of its frames stands for one."""
    frames = np.stack(list(video.frames(preview_size(video.size), grey=True)))
    spread = frames[np.unique(np.linspace(0, len(frames) - 1, 41).round().astype(int))]
    background = np.median(spread, axis=0)
    shown = (np.abs(frame - background) > 2 * CHANGED for frame in frames)
    change = [float((np.abs(b.astype(np.int16) - a) > CHANGED).mean()) for a, b in zip(frames, frames[1:])]
    return motion_signal(video.times, shown, np.array(change))


def mask_signal(times: np.ndarray, masks: Iterable[np.ndarray]) -> Signal:
    """Of ready silhouettes, bool (H, W) at times (N) s."""
    shown = list(masks)
    change = np.array([float((a != b).mean()) for a, b in zip(shown, shown[1:])])
    return motion_signal(times, shown, change)


def motion_signal(times: np.ndarray, shown: Iterable[np.ndarray], change: np.ndarray) -> Signal:
    """What cameras on different sides see alike: how much moves, and how fast the upper end of the silhouette rises. (Its area
    changes with the side.) `change` (N - 1): share of the pixels that change from frame to frame."""
    if len(times) < 2:
        return Signal(np.zeros((2, 1)), SIGHT_STEP, 0.0)
    top = np.array([upper_end(mask) for mask in shown])
    seconds = np.maximum(np.diff(times), 1e-6)
    middle = (times[1:] + times[:-1]) / 2
    channels = [np.sqrt(change / seconds), np.diff(top) / seconds]
    at = np.arange(middle[0], middle[-1] + 1e-9, SIGHT_STEP)
    resampled = np.stack([np.interp(at, middle, channel) for channel in channels])
    frame = float(np.median(seconds)) / SIGHT_STEP
    limited = np.clip(standardised(smoothed(resampled, frame)), -4, 4)  # one jump must not outweigh all the rest
    return Signal(standardised(limited), SIGHT_STEP, float(middle[0]))


def upper_end(mask: np.ndarray) -> float:
    """Height of the silhouette's upper end as a share of the image's; specks do not count."""
    rows = mask.sum(axis=1)
    filled = np.flatnonzero(rows > max(1, 0.01 * mask.shape[1]))
    return float(1 - filled[0] / len(rows)) if len(filled) else 0.0


def agreement(curves: Curves, offsets: np.ndarray) -> np.ndarray:
    """(C) mean score of each camera with all others if they have these offsets (C) s."""
    table = np.zeros((len(offsets), len(offsets)))
    for (i, j), curve in curves.items():
        table[i, j] = table[j, i] = np.interp(offsets[j] - offsets[i], *curve)
    return table.sum(axis=1) / (len(offsets) - 1)


def camera_curve(curves: Curves, offsets: np.ndarray, camera: int, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Offsets (s) that a camera could have, and for each its mean score with all others, where they stay."""
    own = [(j if camera == i else i, camera == i, curve) for (i, j), curve in curves.items() if camera in (i, j)]
    reach = max(float(np.abs(curve[0]).max()) for _, _, curve in own)
    at = np.arange(offsets.min() - reach, offsets.max() + reach, step)
    total = np.zeros(len(at))
    for other, is_first, (lags, score) in own:
        lag = offsets[other] - at if is_first else at - offsets[other]
        total += np.interp(lag, lags, score, left=-1, right=-1)
    return at, total / len(own)


def refined(curves: Curves, offsets: np.ndarray, apart: float, step: float) -> tuple[np.ndarray, list[Peak]]:
    """Every camera in turn to where it agrees best with all others, until none moves; and the peak of each there. What one pair
    mistakes all others outvote."""
    offsets = offsets.copy()
    for _ in range(10):
        before = offsets.copy()
        for camera in range(len(offsets)):
            offsets[camera] = find_peak(*camera_curve(curves, offsets, camera, step), apart).lag
        if np.abs(offsets - before).max() < step / 10:
            break
    peaks = [find_peak(*camera_curve(curves, offsets, camera, step), apart) for camera in range(len(offsets))]
    return offsets - offsets[0], peaks


def solve(count: int, peaks: dict[tuple[int, int], Peak], near: float) -> np.ndarray:
    """Offsets (C) s that the most pairs agree with to `near` seconds, by least squares over these. A wrong peak is wrong by any
    amount, so that no mean over all pairs would do."""
    best: tuple[np.ndarray, list[tuple[int, int]]] = (np.zeros(count), [])
    for middle in range(count):
        start = np.array([signed_lag(peaks, middle, c) for c in range(count)])
        agreeing = agreeing_pairs(peaks, start, 2 * near)
        for _ in range(3):
            offsets = least_squares(count, {pair: peaks[pair] for pair in agreeing})
            agreeing = agreeing_pairs(peaks, offsets, near)
        if len(agreeing) > len(best[1]):
            best = offsets, agreeing
    return best[0] - best[0][0]


def signed_lag(peaks: dict[tuple[int, int], Peak], i: int, j: int) -> float:
    """Offset of j less that of i: the time in i less the time in j at which the same happens."""
    if i == j:
        return 0.0
    return peaks[i, j].lag if i < j else -peaks[j, i].lag


def agreeing_pairs(peaks: dict[tuple[int, int], Peak], offsets: np.ndarray, near: float) -> list[tuple[int, int]]:
    return [(i, j) for (i, j), peak in peaks.items() if abs(offsets[j] - offsets[i] - peak.lag) <= near]


def least_squares(count: int, peaks: dict[tuple[int, int], Peak]) -> np.ndarray:
    rows, lags = np.zeros((len(peaks), count)), np.zeros(len(peaks))
    for row, ((i, j), peak) in enumerate(peaks.items()):
        weight = max(peak.score, 1e-3)
        rows[row, i], rows[row, j], lags[row] = -weight, weight, weight * peak.lag
    return np.linalg.lstsq(rows, lags, rcond=None)[0]


def find_offsets(signals: Sequence[Signal], clear: float, apart: float, near: float, names: Sequence[str]) -> Offsets:
    """Offsets from signals of every camera, of one step. Trusted if the peak of each camera with all others is high enough and
    `clear` times as high as any that is more than `apart` s away; `near`: s, how far a pair may be from the answer and agree.
    Offsets that agree hardly better than none are none: most rigs are synchronous, and smooth motion tells no small ones."""
    count, none = len(signals), np.zeros(len(signals))
    short = [name for name, signal in zip(names, signals) if signal.values.shape[1] < SHORTEST]
    if short:
        return Offsets(none, False, f"too short for {', '.join(short)}")
    curves = {(i, j): scores(signals[i], signals[j]) for i, j in combinations(range(count), 2)}
    pairs = {pair: find_peak(*curve, apart) for pair, curve in curves.items()}
    offsets, peaks = refined(curves, solve(count, pairs, near), apart, signals[0].step)
    residual = [abs(offsets[j] - offsets[i] - peak.lag) for (i, j), peak in pairs.items()]
    numbers = f"{sum(r <= near for r in residual)} of {len(pairs)} pairs agree to {1000 * near:.0f} ms, "
    numbers += f"the least clear camera's peak is {min(min(peak.clearness for peak in peaks), 99):.2f} times as high as the next"
    doubtful = [c for c, peak in enumerate(peaks) if peak.score < LEAST_SCORE or peak.clearness < clear]
    if doubtful:
        return Offsets(none, False, f"not clear for {', '.join(names[c] for c in doubtful)} ({numbers})")
    if (agreement(curves, none) >= AS_GOOD * agreement(curves, offsets)).all():
        return Offsets(none, True, f"no offsets fit as well as the best ({numbers})")
    return Offsets(offsets, True, numbers)


def frame_numbers(
    times: Sequence[np.ndarray],
    offsets: Sequence[float],
    fps: float,
    start: float = 0.0,
    count: int | None = None,
    names: Sequence[str] | None = None,
) -> np.ndarray:
    """(C, T) the frame of each camera that is nearest to each of T common times, `fps` of them a second, from `start` s after the
    last camera has begun until the first one ends, or `count` of them. `times`: of each camera's frames (N) s, on its own clock.
    Raises ValueError if that is more than all have, or nothing."""
    begins, ends = np.array([[t[0] + o, t[-1] + o] for t, o in zip(times, offsets)]).T
    begin, end = begins.max(), ends.min()
    if begin > end + 1e-6:
        last, first = ((names or range(len(times)))[int(i)] for i in (begins.argmax(), ends.argmin()))
        where = f"camera {last} begins {begin - end:.2f} s after camera {first} ended"
        raise ValueError(f"expected cameras that film at the same time, found that {where}")
    most = int(np.floor((end - begin - start) * fps + SLACK)) + 1
    if start < 0 or most < 1:
        raise ValueError(f"--start: expected 0 to {end - begin:.2f} s, in which all cameras film, found {start:g}")
    if count is not None and not 1 <= count <= most:
        raise ValueError(f"--frames: expected 1 to {most}, which all cameras have at {fps:g} a second, found {count}")
    common = begin + start + np.arange(count or most) / fps
    return np.stack([nearest(t + o, common) for t, o in zip(times, offsets)])


def nearest(times: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Index of the time (N, rising) nearest to each wanted one; of two equally near the earlier."""
    after = np.clip(np.searchsorted(times, wanted), 1, max(len(times) - 1, 1))
    if len(times) == 1:
        return np.zeros(len(wanted), int)
    return after - (wanted - times[after - 1] <= times[after] - wanted + 1e-9)
