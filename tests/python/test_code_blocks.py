"""Every code block of README.md and docs/*.md: Python runs, C++ compiles, commands are understood."""

import json
import re
import shlex
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import doublet as d
import numpy as np
import pytest
from bad_input import make_folder
from doublet.cli import option_flags
from doublet.cli import program as cli
from doublet.common.files import write_json
from doublet.evaluation.study import local_workers
from doublet.reconstruct import config

ROOT = Path(__file__).parents[2]
SESSION = ROOT / "examples" / "data" / "session"
sys.path.append(str(ROOT / "tests" / "fuzz"))
from seeds import World  # noqa: E402

#: Blocks that do not run here, by a line of theirs, and why.
NOT_RUN = {
    "build_sam2_video_predictor": "SAM 2 needs PyTorch and its weights",
    "SLURMCluster(cores": "needs a cluster",
}
#: First words of commands that are not ours, and why they are not run here.
NOT_OURS = {
    "bash": "tests/run_tests.sh is what runs this; examples/quickstart.sh is what users begin with",
    "source": "the virtual environment of examples/quickstart.sh",
    "pip": "test_portable_wheel.py installs the wheel in a clean environment (tests/run_nightly.sh wheel)",
    "blender": "Blender: test_import_calibration.py and test_baked.py run the scripts",
    "masks_venv/bin/python": "MediaPipe, which brings its own OpenCV",
    "python": "Robust Video Matting needs PyTorch and its weights",
    "rembg": "downloads its weights",
    "ffmpeg": "not ours; needs a video of the reader's",
    "cmake": "sanitizers over everything take the better part of an hour",
    "ctest": "likewise",
    "TSAN_OPTIONS=suppressions=$PWD/tests/tsan.supp": "likewise",
    "dask": "test_study.py starts a scheduler and workers",
    "for": "a loop of the shell's",
    "done": "its end",
}
#: Commands that are run on stand-ins. The others run on the shipped session in tests/e2e and in the tests of their own.
CHEAP = ("import-calibration",)


class Block(NamedTuple):
    page: str
    line: int
    language: str
    text: str

    @property
    def why_not(self) -> str:
        return next((why for words, why in NOT_RUN.items() if words in self.text), "")


def blocks_of(path: Path) -> list[Block]:
    text = path.read_text(encoding="utf-8")
    return [
        Block(path.name, text[: m.start()].count("\n") + 1, m[1], m[2])
        for m in re.finditer(r"^ *```([^\n]*)\n(.*?)^ *```$", text, re.DOTALL | re.MULTILINE)
    ]


BLOCKS = [b for path in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))) for b in blocks_of(path)]


def of(*languages: str):
    chosen = [b for b in BLOCKS if b.language in languages and not b.why_not]
    return pytest.mark.parametrize("block", chosen, ids=[f"{b.page}-{b.line}" for b in chosen])


def test_every_block_is_of_a_language_that_is_tried():
    tried = {"python", "cpp", "sh", "json", "text", "toml"}
    assert [(b.page, b.line) for b in BLOCKS if b.language not in tried] == []
    for words in NOT_RUN:
        assert any(words in b.text for b in BLOCKS), f"no block has {words}"
    known = {word for b in BLOCKS if b.language == "sh" for word in (words[0] for words in commands(b))}
    assert set(NOT_OURS) <= known, set(NOT_OURS) - known


# --- Python


@pytest.fixture(scope="module")
def world():
    return World()


def person(world: World) -> d.Character:
    """A skirt that hangs from the pelvis of a whole skeleton."""
    skeleton = d.Skeleton(d.Session(SESSION).joints)
    weights = np.zeros((len(world.mesh.vertices), len(skeleton.joint_names)))
    weights[:, skeleton.joint_names.index("pelvis")] = 1
    actor = d.RiggedMesh(world.mesh, [1] * len(world.mesh.faces), weights, skeleton)
    return d.make_character(actor, world.segmentation, world.body, [], [world.material], d.SolverSettings(1 / 40))


@pytest.fixture(scope="module")
def stand_ins(tmp_path_factory):
    """A session and results of a small person in a skirt, under the names that the pages use."""
    folder = tmp_path_factory.mktemp("pages")
    make_folder(folder)
    (folder / "session").rename(folder / "MY_SESSION")
    write_json(folder / "out" / "run.json", {"session": str(folder / "MY_SESSION"), "stages": {}})
    for name in ("check.png", "simulated.npz", "report.html", "fit_log.csv"):
        (folder / "out" / name).touch()
    person(World()).write(folder / "out" / "character.glb")
    shutil.copy(folder / "out" / "character.glb", folder / "character.glb")
    shutil.copy(SESSION / "motion.bvh", folder / "some_dance.bvh")
    for name, made in {
        "colmap/sparse/0": "colmap_text", "Calib_scene.toml": "toml/Calib.toml", "session.qca.txt": "qualisys/session.qca.txt",
        "easymocap_folder": "easymocap",
    }.items():  # fmt: skip
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / "calibrations" / made).rename(folder / name)
    intri = folder / "easymocap_folder" / "intri.yml"  # without the sizes that the command gives
    intri.write_text("".join(x for x in intri.read_text().splitlines(True) if not x.startswith(("W_", "H_"))))
    for name in ("mine", "monday", "tuesday"):
        shutil.copytree(folder / "out", folder / "results" / name)
    shutil.rmtree(folder / "out")
    return (folder / "results").rename(folder / "out").parent


class Bowl(d.Objective):
    """Stands for an energy."""

    def parameter_count(self):
        return 2

    def evaluate(self, samples, context):
        return np.square(samples - 0.7).sum(axis=1, keepdims=True)


def names_of(page: str, world: World) -> dict:
    """What a page takes for granted."""
    import cma
    import nevergrad
    import optuna
    from doublet.evaluation import study

    actor = {"actor": world.actor, "segmentation": world.segmentation, "proxies": world.proxies, "options": d.ClothOptions()}
    names = {
        "architecture.md": lambda: {
            "my_segmentation": lambda job: d.write_segmentation(job.path("segmentation.npz"), world.segmentation) or {}
        },
        "capture-tracking.md": lambda: {
            "d": d, "session": (session := d.Session(SESSION)), "frames": d.FrameSource.open(session), "extractor": None,
        },
        "cloth.md": lambda: {"d": d, **actor, "character": world.character, "motion": world.motion},
        "material-estimation.md": lambda: {
            "doublet": d, "cma": cma, "optuna": optuna, "nevergrad": nevergrad, "simulator": world.simulator,
            "performance": world.performance, "observations": world.observations,
        },
        "player.md": lambda: {"pose": np.zeros(len(d.Skeleton(d.Session(SESSION).joints).dof_names))},
        "segmentation.md": lambda: {
            "d": d, "pose": world.mesh, "face_valid": [1] * len(world.mesh.faces), "found": world.segmentation,
            "painted": np.full(len(world.mesh.vertices), -1),
        },
        "studies.md": lambda: {"jobs": [], "study": study},
        "synthesis.md": lambda: {"character": world.character, "motion": world.motion, "rig": world.cameras},
    }  # fmt: skip
    return names.get(page, dict)()  # of this page alone: a session opens all its videos


@pytest.fixture
def small_searches(monkeypatch):
    """A search ends after a few evaluations, a study has as many workers as there are cores here."""
    from doublet.evaluation import study

    monkeypatch.setattr(study, "local_workers", lambda count: local_workers(2))
    few = {"fit.max_evaluations": 4, "fit.population": 4, "fit.initial_design_size": 4, "space.names": ["d_n"]}
    fit_jobs = study.fit_jobs
    monkeypatch.setattr(
        study, "fit_jobs", lambda *a, options=({},), **k: fit_jobs(*a, options=[{**few, **o} for o in options], **k)
    )


@of("python")
def test_python_runs(block, world, stand_ins, tmp_path, monkeypatch, small_searches):
    shutil.copytree(stand_ins, tmp_path, dirs_exist_ok=True)
    if block.page in ("README.md", "architecture.md"):
        (tmp_path / "out" / "mine" / "segmentation.npz").unlink()  # what the block is about
    monkeypatch.chdir(tmp_path)
    code = compile("\n" * block.line + block.text, block.page, "exec")
    exec(code, {"__name__": "snippet", **names_of(block.page, world)})
    if block.page in ("README.md", "architecture.md"):
        assert d.read_segmentation(tmp_path / "out" / "mine" / "segmentation.npz").clothness.max() == 1


@pytest.mark.parametrize("block", [b for b in BLOCKS if b.language == "python" and b.why_not], ids=lambda b: f"{b.page}-{b.line}")
def test_python_that_cannot_run_here_is_python(block):
    compile(block.text, block.page, "exec")


# --- C++

ACTOR = "const doublet::RiggedMesh &actor, const doublet::Context &context"
STAGES = f"""{ACTOR}, const doublet::Segmentation &segmentation, const doublet::ReferencePerformance &performance,
    const doublet::Observations &observations, const doublet::BodyFit &body,
    const std::vector<doublet::TaperedCapsule> &proxies"""
VALUES = "doublet/core/garment.h doublet/core/stage_values.h"
#: Page -> headers beside those that a block includes itself; arguments of the function around it, for each block. Others stand
#: alone.
PROLOGUES = {
    "architecture.md": (
        "doublet/reconstruct/reconstruction.h",
        ["const doublet::ReconstructionOptions &options, std::string (*my_segmentation)(doublet::Reconstruction &)"],
    ),
    "README.md": ("", ["const Vertices &rest, const Faces &faces, const std::vector<Capsule> &legs"]),
    "body-model.md": (
        "doublet/bodymodel/proxies.h",
        [f"{ACTOR}, const doublet::Segmentation &segmentation, const std::map<std::string, Eigen::Vector3d> &landmarks"],
    ),
    "calibration-refinement.md": ("cstdio", ["const doublet::CaptureResult &result"]),
    "capture-tracking.md": ("doublet/capture/performance_capture.h", [ACTOR, ACTOR]),
    "cloth.md": (
        "iostream doublet/pbd/cloth_solver.h doublet/animate/animator.h",
        [
            "const Vertices &rest, const Faces &faces, const Eigen::VectorXd &clothness, const Material &material, "
            "const Vertices &skinned_before, const Vertices &skinned_now, const std::vector<Capsule> &proxies_before, "
            "const std::vector<Capsule> &proxies_now",
            f"{ACTOR}, const doublet::Segmentation &segmentation, const std::vector<doublet::TaperedCapsule> &proxies, "
            "const doublet::pbd::ClothOptions &options, const doublet::Character &character, const doublet::Motion &motion",
        ],
    ),
    "garment.md": (
        f"{VALUES} doublet/segment/garment_mesher.h doublet/fit/material_estimator.h",
        [
            STAGES,
            STAGES,
            "const doublet::Garment &garment, const doublet::FitResult &fit",
            "",
        ],
    ),
    "material-estimation.md": (
        VALUES,
        [f"{STAGES}, const doublet::Garment &garment"],
    ),
    "player.md": (
        "",
        [
            "const Eigen::VectorXd &first_pose, const Eigen::VectorXd &pose, double seconds, bool running, "
            "void (*draw)(const doublet::Vertices &, const doublet::Faces &)"
        ],
    ),
    "quickstart.md": ("atomic iostream", ["std::atomic<bool> &stop"]),
    "scan.md": (
        "doublet/capture/session.h doublet/capture/template_builder.h",
        [
            "const doublet::Session &session, const std::vector<doublet::CameraView> &views, const doublet::Template &closed, "
            "const doublet::BodyModel &model"
        ],
    ),
    "segmentation.md": ("doublet/core/stage_values.h doublet/core/skinning.h", [STAGES]),
    "swap.md": ("iostream", []),
}


def translation_unit(block: Block) -> str:
    """The block, its statements inside a function."""
    headers, arguments = PROLOGUES.get(block.page, ("", []))
    place = [b.line for b in BLOCKS if (b.page, b.language) == (block.page, "cpp")].index(block.line)
    outside = re.findall(r"^#include [^\n]*$|^using namespace [^\n]*$|^class .*?^};$", block.text, re.DOTALL | re.MULTILINE)
    body = block.text
    for piece in outside:
        body = body.replace(piece, "")
    includes = [f"#include <{name}>" for name in headers.split()]
    return "\n".join([*includes, *outside, f"void block({dict(enumerate(arguments)).get(place, '')}) {{ {{", body, "} }"]) + "\n"


COMPILER = ["c++", "-std=c++20", "-isystem/usr/include/eigen3", *(f"-I{p}" for p in sorted(ROOT.glob("lib*/include")))]


def compiled(block: Block, first: Path) -> str:
    """What the compiler complains about. first: a header before all others."""
    command = [*COMPILER, "-fsyntax-only", "-include", first, "-xc++", "-"]
    return subprocess.run(command, input=translation_unit(block), capture_output=True, text=True).stderr


@pytest.fixture(scope="module")
def eigen(tmp_path_factory):
    """What nearly every header of ours includes, compiled once: half of the time of a block."""
    header = tmp_path_factory.mktemp("precompiled") / "eigen.h"
    header.write_text("#include <Eigen/Core>\n")
    subprocess.run([*COMPILER, "-xc++-header", header, "-o", header.with_suffix(".h.gch")], check=True)
    return header


@pytest.fixture(scope="module")
def complaints(eigen):
    """Of the compiler, about every block; two blocks at a time."""
    blocks = [b for b in BLOCKS if b.language == "cpp"]
    with ThreadPoolExecutor(2) as pool:
        return dict(zip(blocks, pool.map(lambda block: compiled(block, eigen), blocks)))


@of("cpp")
def test_cpp_compiles(block, complaints):
    assert complaints[block] == ""


# --- commands


def commands(block: Block) -> list[list[str]]:
    """Words of every command of a block."""
    lines = block.text.replace("\\\n", " ").splitlines()
    return [words for line in lines if (words := shlex.split(line, comments=True))]


PARSER = cli.build_parser()
OURS = [(b, words) for b in BLOCKS if b.language == "sh" for words in commands(b)]


@pytest.mark.parametrize(("block", "words"), OURS, ids=[f"{b.page}-{b.line}-{' '.join(w[:2])}" for b, w in OURS])
def test_commands_are_understood(block, words, stand_ins, tmp_path, monkeypatch):
    if words[0] != "doublet":
        assert words[0] in NOT_OURS
        for word in words:  # files of ours that it names
            assert not re.match(r"(examples|tests)/", word) or (ROOT / word).exists(), word
        return
    parsed = PARSER.parse_args(words[1:])
    option_flags.chosen_options(parsed)
    if words[1] in CHEAP or "--write-config" in words:
        shutil.copytree(stand_ins, tmp_path, dirs_exist_ok=True)
        monkeypatch.chdir(tmp_path)
        assert cli.main(words[1:]) == 0


@of("toml")
def test_toml_is_a_file_of_options(block, tmp_path):
    (tmp_path / "block.toml").write_text(block.text)
    assert config.read(tmp_path / "block.toml")


@of("json")
def test_json_is_json(block):
    json.loads(block.text)
