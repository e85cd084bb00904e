"""Cloth where no garment has any is questioned."""

from types import SimpleNamespace

import numpy as np
from doublet.reconstruct.stages import cloth_ends, end_findings


def test_a_foot_or_a_hand_of_cloth_is_named():
    skeleton = SimpleNamespace(
        joint_names=["pelvis", "knee", "ankle", "toe", "wrist", "hand"], joint_parents=np.array([-1, 0, 1, 2, 0, 4], np.int32)
    )
    weights = np.zeros((5, 6))  # two vertices of a shank, two of a foot, one of a hand
    weights[[0, 1], 1] = weights[[2, 3], 2] = weights[4, 4] = 1
    actor, areas = SimpleNamespace(skeleton=skeleton, weights=weights), np.array([1.0, 1, 3, 1, 2])
    assert cloth_ends(actor, np.array([1, 1, 0, 1, 0], bool), areas) == []
    assert cloth_ends(actor, np.array([0, 0, 1, 0, 0], bool), areas) == ["toe"]
    assert cloth_ends(actor, np.ones(5, bool), areas) == ["toe", "hand"]


def test_cloth_that_includes_the_head_is_no_result():
    hand, head = end_findings(["l_hand", "head_top"])
    assert hand.level == "doubtful" and "l_hand" in hand.text
    assert head.level == "impossible" and "head_top" in head.text
