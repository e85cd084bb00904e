"""What the report says of a reconstruction, and how it is laid out."""

import json
import re
import shutil
from pathlib import Path

import doublet as d
import numpy as np
import pytest
from doublet import reconstruct
from doublet.pages import fit_page, report
from doublet.pages.html_document import page, table

ROOT = Path(__file__).parents[2]
GUESS = {"kind": "guess", "parameter": "d_t", "value": 0.18, "low": 0.1, "high": 25}
BOUND = {"kind": "upper_bound", "parameter": "d_n", "value": 32, "low": 0, "high": 32}


class Shown:
    """What the sections read of a job: its record, its folder, and how near it is to the video."""

    def __init__(self, out, stages, doubts=()):
        self.job = self
        self.record = self
        self.data = {"stages": {name: {"state": "done", "summary": summary} for name, summary in stages.items()}}
        self.track = report.Track(np.array([0, 8.0]), np.array([0.97, 0.95]), np.array([0.9, 0.8]), np.zeros(0), np.zeros(0))
        self.out = out
        self.path("material.json").write_text(json.dumps({"regions": [{"findings": list(doubts)}]}))

    def path(self, name):
        return self.out / name


def words(text: str) -> str:
    return re.sub(r"<[^>]+>", " ", text)


def test_a_good_reconstruction_is_called_good(tmp_path):
    text = words(report.verdict(Shown(tmp_path, {"body": {"residual_mm": 1.5}, "performance": {"frames_lost": {}}})))
    assert "nothing doubtful was found" in text and "Doubtful" not in text and "To do" not in text
    assert "mean distance of the skin to the body, mm: 1.5 (expected at most 20)" in text
    assert "simulated character has a silhouette IoU of 0.850 on average" in text and "least in frame 8 (0.800)" in text


def test_numbers_do_not_count_for_a_file_that_was_made_elsewhere(tmp_path):
    shown = Shown(tmp_path, {})
    shown.record = d.RunRecord(tmp_path)
    shown.record.begin("body", {}, {})
    (tmp_path / "body.npz").write_text("ours")
    shown.record.end("body", {"residual_mm": 1.5, "proxies": 12}, ["body.npz"])
    assert "body, mm: 1.5 (expected" in words(report.verdict(shown)) and "proxies" in report.timings(shown)
    (tmp_path / "body.npz").write_text("another program's")
    assert "Good:" not in report.verdict(shown) and "proxies" not in report.timings(shown)


def test_doubts_are_counted_and_say_what_to_do(tmp_path):
    stages = {"body": {"residual_mm": 30.0}, "performance": {"frames_lost": {"l_ankle": 7}}}
    text = words(report.verdict(Shown(tmp_path, stages, [GUESS, BOUND])))
    assert "4 things in it are doubtful" in text
    for doubt in ("found 30", "l_ankle was lost in 7 frames", "d_t = 0.18 is a guess", "d_n = 32 lies at the upper bound"):
        assert doubt in text.replace("&#x27;", "'"), doubt
    assert "Good:" not in text  # the only number that was measured is not
    for advice in ("The box contains all ordinary cloth", "--space-fixed", "frames of the lost joint"):
        assert text.count(advice) == 1
    assert "1 thing in it is doubtful" in words(report.verdict(Shown(tmp_path, {}, [BOUND])))


@pytest.mark.parametrize(
    "damaged", ['{"regions"', "[]", "{}", '{"regions": 3}', '{"regions": [{"findings": [{"kind": "guess"}]}]}']
)
def test_a_material_of_another_kind_is_named(tmp_path, damaged):
    shown = Shown(tmp_path, {})
    (tmp_path / "material.json").write_text(damaged)
    with pytest.raises(RuntimeError, match=r"material\.json: expected (JSON|what the stage 'fit' writes), found .*") as caught:
        report.verdict(shown)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("kind", ["lower_bound", "upper_bound", "guess", "seeds"])
def test_every_kind_of_finding_has_a_sentence_advice_and_a_warning(kind):
    assert d.FitFinding(kind, "d_n", 1, 0, 2).text().startswith("d_n = 1 ")
    assert report.ADVICE[kind] and fit_page.WARNINGS[kind]
    with pytest.raises(ValueError, match="finding_kind: expected lower_bound"):
        d.FitFinding(kind + "s", "d_n", 1, 0, 2)


def test_a_parameter_on_a_bound_carries_a_warning():
    region = {
        "parameters": {"d_n": 32.0, "d_t": 0.18, "k_bend": 0.5},
        "findings": [BOUND, GUESS],
        "deviations": {"d_n": 0, "d_t": 0},
    }
    region["interval"] = {"d_t": [0.1, 25]}
    rows = re.findall(r"<tr>(.*?)</tr>", fit_page.parameters(region))
    (d_n,), (d_t,), (k_bend,) = ([row for row in rows if f"<td>{name}</td>" in row] for name in region["parameters"])
    assert "⚠ at the upper bound of its box" in d_n and "⚠ a guess" in d_t and "⚠" not in k_bend
    assert "<td>1/m</td>" in d_n and "<td>1/s</td>" in d_t and "0.1 to 25" in d_t and "fixed" in k_bend


@pytest.mark.parametrize("energy, said", [(90, "10 % below the centre"), (110, "10 % above the centre")])
def test_no_energy_is_less_than_nothing_below(energy, said):
    region = {"energy": energy, "energy_at_centre": 100, "evaluations": 1, "stop_reason": ""}
    assert said in fit_page.energies(region)


def test_what_is_not_seen_has_no_distance_and_what_is_nested_no_braces():
    assert "{" not in table(["number", "value"], [["energies", {"0.15": 142.16628, "0.25": 131.0}]])
    assert "0.15: 142.2, 0.25: 131" in table(["number", "value"], [["energies", {"0.15": 142.16628, "0.25": 131.0}]])
    assert "none" in table(["a"], [[{}]]) and "none" in table(["a"], [[[]]])


@pytest.fixture(scope="module")
def followed(bell, shapes):
    """The bell, filmed as it was captured, with its cloth 3 cm aside from frame 10 on when simulated."""
    job = reconstruct.Job(bell, bell)
    captured = job.results.performance().surface.frames
    cloth = job.results.segmentation().clothness > 0.5
    aside = np.array(captured)
    aside[10:, cloth] += [0.03, 0, 0]
    cameras = [shapes["camera"](a, size=120, height=1.0) for a in (0, 2.1)]

    class Filmed:
        session = type("Session", (), {"rig": cameras, "fps": 40.0})
        actor, performance, simulated = job.results.actor, job.results.performance(), aside
        faces = job.results.actor.mesh.faces

        def masks(self, row):
            return [np.uint8(255 * (d.rasterize(captured[row], self.faces, c)[0] >= 0)) for c in cameras] + [np.zeros((0, 0))]

    filmed = Filmed()
    filmed.job, filmed.captured = job, captured
    filmed.track = report.follow(filmed)
    return filmed


def test_error_over_time_is_that_of_the_frames(followed):
    track = followed.track
    np.testing.assert_array_equal(track.tracked, 1)
    assert track.simulated[0] == 1 and track.simulated[-1] < 0.97
    np.testing.assert_allclose(track.rms, np.where(np.arange(len(track.rms)) < 10, 0, 3), atol=1e-4)
    np.testing.assert_allclose(track.most, track.rms, atol=1e-4)


def test_plots_have_units_and_sentences_their_numbers(followed):
    text = report.over_time(followed)
    for label in ("of 1", "captured cloth, cm", "frame of the video, 40 a second"):
        assert label in text, label  # matplotlib writes the letters as paths, and the text in a comment
    mean = followed.track.simulated.mean()
    assert f"simulated character has a silhouette IoU of {mean:.3f} on average" in text
    assert re.search(r"RMS over all frames, most in frame (1\d|2\d) \(3.0 cm\)", text)
    log = [{"region": "0", "evaluations": "8", "best": "9", "generation_best": "9", "mean_d_n": "3", "deviation_d_n": "0.1"}]
    assert "d_n, 1/m" in fit_page.parameter_plot(log, ["d_n"]) and "E_fit, px²" in fit_page.energy_plot(log)


def test_a_session_without_silhouettes_or_cloth_has_a_page_too(followed):
    nothing = report.Track(*np.zeros((5, 0)))
    assert report.overlap_in_words(nothing) == "" and report.distance_in_words(nothing, []) == ""
    bare = type("Bare", (), {"track": nothing, "performance": followed.performance, "session": followed.session})
    assert "<svg" in report.over_time(bare)


def test_a_page_fits_a_phone(tmp_path, followed):
    """390 pixels wide: nothing but tables and plots is wider than the screen, and those scroll by themselves."""
    webdriver = pytest.importorskip("selenium.webdriver")
    region = {"parameters": dict.fromkeys(d.Material.boxes(), 0.5), "findings": [BOUND]}
    body = f"<h1>word</h1>{fit_page.parameters(region)}{report.over_time(followed)}"
    (tmp_path / "page.html").write_text(page("a page", body), encoding="utf-8")
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or ""
    for flag in ("--headless=new", "--no-sandbox", f"--user-data-dir={tmp_path / 'profile'}"):
        options.add_argument(flag)
    browser = webdriver.Chrome(options=options, service=webdriver.ChromeService(shutil.which("chromedriver")))
    try:
        phone = {"width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": True}
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", phone)
        browser.get((tmp_path / "page.html").as_uri())
        assert browser.execute_script("return [innerWidth, document.documentElement.scrollWidth]") == [390, 390]
        scroll = "return [...document.querySelectorAll('.wide')].map(e => e.scrollWidth > e.clientWidth)"
        assert browser.execute_script(scroll) == [True, True]
    finally:
        browser.quit()
