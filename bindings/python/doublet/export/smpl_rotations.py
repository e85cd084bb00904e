"""Rotations as programs of the SMPL family write them, and quaternions (w x y z)."""

from __future__ import annotations

import numpy as np

#: Numbers a frame of axis times angle: 22 and 24 joints, with eyes and jaw, with fingers (SMPL-H), with all (SMPL-X).
AXIS_ANGLES = (66, 72, 75, 156, 159, 165, 168)
FEW = 64  #: frames, by which what is none is told in little memory
ALIKE = 1e-3  #: to which a rotation's axes are of length 1 and at right angles


def turns_of(numbers: np.ndarray, matrices: bool) -> np.ndarray | None:
    """(T, J, 4) quaternions of rows (T, N): nine numbers a joint if they are rotation matrices, six if these are the first two
    columns of one row by row, else axis times angle; None if there are no rotations of so many numbers. What they are is told by
    the numbers: 144 are six of 24 joints, of which no file has 48."""
    count = numbers.shape[1]
    if count % 9 == 0 and (matrices or count not in AXIS_ANGLES):
        found = numbers.reshape(len(numbers), -1, 3, 3)
        if are_rotations(found):
            return of_matrices(found)
    if matrices:
        return None
    if count % 6 == 0:
        two = numbers.reshape(len(numbers), -1, 3, 2)
        found = np.concatenate([two, np.cross(two[..., 0], two[..., 1])[..., None]], axis=-1)
        if are_rotations(found):
            return of_matrices(found)
        rows = numbers.reshape(len(numbers), -1, 2, 3)  # rows in one program, columns in another: nobody can tell
        if are_rotations(np.concatenate([rows, np.cross(rows[..., 0, :], rows[..., 1, :])[..., None, :]], axis=-2)):
            return None
    return None if count not in AXIS_ANGLES or are_degrees(numbers) else quaternions(numbers.reshape(len(numbers), -1, 3))


def are_degrees(angles: np.ndarray) -> bool:
    """Is a joint of rows (T, N) turned by more than two turns most of the time? The root may be, of who turns round and round."""
    turned = np.linalg.norm(angles.reshape(len(angles), -1, 3)[:, 1:], axis=-1)
    return bool(np.median(turned, axis=0).max() > 4 * np.pi)


def doubt_about(rows: list[np.ndarray]) -> str:
    """Why such numbers are not read."""
    count = sum(row.shape[-1] for row in rows if row.ndim > 0)
    if count in AXIS_ANGLES and all(row.ndim == 2 and len(row) == len(rows[0]) for row in rows):
        return "; a joint is turned by more than two turns, as if these were degrees"
    return (
        "; six numbers a joint may be rows or columns of a matrix, which no file says"
        if count % 6 == 0 and count >= 6 * 22
        else ""
    )


def are_rotations(matrices: np.ndarray) -> bool:
    if len(matrices) > FEW and not are_rotations(matrices[:FEW]):
        return False
    products = np.einsum("...ij,...ik->...jk", matrices, matrices)
    return bool(np.abs(products - np.eye(3)).max() < ALIKE and (np.linalg.det(matrices) > 0).all())


def of_matrices(matrices: np.ndarray) -> np.ndarray:
    """(..., 4) of rotation matrices (..., 3, 3): the largest of the four components is taken from the diagonal, which is exact
    whatever the rotation (Shepperd 1978)."""
    m = matrices
    diagonal = m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]
    squares = np.stack([sum(diagonal), *(2 * entry - sum(diagonal) for entry in diagonal)], axis=-1) + 1
    largest = squares.argmax(axis=-1)[..., None]
    off = {(i, j): m[..., i, j] for i in range(3) for j in range(3)}
    w = off[2, 1] - off[1, 2], off[0, 2] - off[2, 0], off[1, 0] - off[0, 1]
    xy, xz, yz = off[0, 1] + off[1, 0], off[0, 2] + off[2, 0], off[1, 2] + off[2, 1]
    rows = [
        (squares[..., 0], *w),
        (w[0], squares[..., 1], xy, xz),
        (w[1], xy, squares[..., 2], yz),
        (w[2], xz, yz, squares[..., 3]),
    ]
    table = np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
    found = np.take_along_axis(table, largest[..., None], axis=-2)[..., 0, :]
    return found / np.linalg.norm(found, axis=-1, keepdims=True)


def quaternions(rotations: np.ndarray) -> np.ndarray:
    """(..., 4) of axis times angle (..., 3)."""
    half = 0.5 * np.linalg.norm(rotations, axis=-1, keepdims=True)
    return np.concatenate([np.cos(half), 0.5 * np.sinc(half / np.pi) * rotations], axis=-1)


def product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    w = a[..., :1] * b[..., :1] - np.sum(a[..., 1:] * b[..., 1:], axis=-1, keepdims=True)
    return np.concatenate([w, a[..., :1] * b[..., 1:] + b[..., :1] * a[..., 1:] + np.cross(a[..., 1:], b[..., 1:])], axis=-1)


def rotated(quaternion: np.ndarray, vector: np.ndarray) -> np.ndarray:
    half = np.cross(quaternion[..., 1:], vector) + quaternion[..., :1] * vector
    return vector + 2 * np.cross(quaternion[..., 1:], half)
