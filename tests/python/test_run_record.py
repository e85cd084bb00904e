"""What run.json makes run again, and what not."""

import pytest
from doublet.reconstruct.run_record import RunRecord

OPTIONS, INPUTS = {"segment.diffusion": 0.02}, {"actor.npz": "abc"}


@pytest.fixture
def done(tmp_path):
    record = RunRecord(tmp_path)
    with record.running("segment", INPUTS, OPTIONS, ["segmentation.npz"]) as summary:
        (tmp_path / "segmentation.npz").write_text("result")
        summary["regions"] = 1
    return tmp_path


def reason(folder, inputs=INPUTS, options=OPTIONS):
    return RunRecord(folder).reason_to_run("segment", inputs, options, ["segmentation.npz"])


def test_up_to_date(done):
    assert reason(done) == ""
    entry = RunRecord(done).data["stages"]["segment"]
    assert entry["seconds"] >= 0 and entry["peak_memory_mb"] > 1 and entry["summary"] == {"regions": 1}


def test_changed_option_input_or_missing_output(done):
    assert reason(done, options={"segment.diffusion": 0.03}) == "option segment.diffusion changed from 0.02 to 0.03"
    assert reason(done, inputs={"actor.npz": "abd"}) == "actor.npz changed"
    assert reason(done, inputs={**INPUTS, "more": "x"}) == "more changed"
    (done / "segmentation.npz").unlink()
    assert reason(done) == "segmentation.npz is missing"


def test_stopped_stage_runs_again(tmp_path):
    with pytest.raises(KeyboardInterrupt), RunRecord(tmp_path).running("segment", INPUTS, OPTIONS, ["segmentation.npz"]):
        raise KeyboardInterrupt
    assert reason(tmp_path) == "the last run was stopped here"


def test_files_made_elsewhere_are_recognised(done):
    outputs = ["segmentation.npz"]
    assert RunRecord(done).foreign_outputs("segment", outputs) == []
    (done / "segmentation.npz").write_text("edited")
    assert RunRecord(done).foreign_outputs("segment", outputs) == outputs


def test_broken_record_is_named(tmp_path):
    (tmp_path / "run.json").write_text("{")
    with pytest.raises(RuntimeError, match="run.json"):
        RunRecord(tmp_path)
