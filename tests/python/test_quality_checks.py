"""What the numbers of a stage say about its result."""

import pytest
from doublet.common.quality_checks import LIMITS, findings


@pytest.mark.parametrize(
    "stage, name, good, doubtful, impossible",
    [
        ("template", "template_valid_to_scan_mean_mm", 1.1, 6.0, 40.0),
        ("performance", "silhouette_iou_against_measured_masks", 0.97, 0.8, 0.3),
        ("body", "residual_mm", 1.6, 30.0, 56000.0),
        ("body", "largest_coefficient", 3.5, 6.0, 12.0),
        ("character", "overlap_of_character", 0.88, 0.78, 0.585),
    ],
)
def test_numbers_beyond_their_limits_are_found(stage, name, good, doubtful, impossible):
    assert findings(stage, {name: good}) == []
    for value, level in ((doubtful, "doubtful"), (impossible, "impossible")):
        (finding,) = findings(stage, {name: value})
        assert finding.level == level and f"{value:.3g}" in finding.text and "expected at" in finding.text


def test_cloth_that_is_told_from_noise_is_doubtful():
    assert findings("segment", {"noise_mm": 2.0, "uncertain_area": 0.05}) == []
    (finding,) = findings("segment", {"noise_mm": 5.0})
    assert finding.level == "doubtful" and "few cameras" in finding.text
    (finding,) = findings("segment", {"uncertain_area": 0.5})
    assert finding.level == "doubtful" and "paint" in finding.text


def test_what_a_stage_found_itself_counts_and_what_it_did_not_measure_does_not():
    (finding,) = findings("segment", {"findings": [{"impossible": False, "text": "a sole"}]})
    assert finding.level == "doubtful" and finding.text == "a sole"
    assert findings("body", {}) == [] and findings("fit", {"energy_px2": [1e9]}) == []
    assert all(limit.doubtful != limit.impossible for limits in LIMITS.values() for limit in limits)
