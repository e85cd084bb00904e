"""Wrong arguments raise a clear exception: wrong lengths, nothing, NaN, infinity, indices out of range. None ends the process.

python tests/python/test_arguments.py [NAME]    prints what every spoilt argument does
"""

import inspect
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import doublet as d
import numpy as np
import pytest
from argument_cases import ELSEWHERE, calls, spoilt
from doublet import _doublet

sys.path.append(str(Path(__file__).parents[1] / "fuzz"))
from children import outcomes  # noqa: E402
from seeds import World  # noqa: E402

CLEAR = (TypeError, ValueError, RuntimeError, OSError)
MOST = 40  # cases of a function in the suite, evenly out of all

#: What is not wrong after all: function, argument, what was done to it.
MAY = (
    ("write_segmentation_paint", "painted", "index .*"),  # it holds labels
    ("triangulate|calibrate_from_person", "seen", ".*(nan|inf).*"),  # a keypoint that a program did not find
    (".*", ".*", r".*1e\+?300"),  # far away, but a number
    (".*", ".*", r"(.*vertices longer|.*faces (shorter|longer))"),  # a vertex more, a face less: still a mesh
    (".*", "vertices|faces|points|mask|image", "shorter|longer|empty|a column less"),  # as many as one likes
    (".*", "(coarse_|fine_|high_|face_)?valid|colours|masks|offset|high|body|prior|gap", "empty"),  # may be left out
    (".*", "proxies|capsules|cameras|meshes|marks|joints|materials|samples|images|contour|matches", "shorter|longer|empty"),
    (".*", "character", "proxies (shorter|longer|empty)"),
    (".*", "frames", "shorter|longer|empty|nan|-?inf"),  # of a MeshSequence: a stage looks at them
    ("Features", ".*", "nan|-?inf"),  # likewise
    (".*", ".*", r"(segmentation )?sigma (empty|nan|-?inf)"),  # NaN where no ray was valid
    (".*", ".*", r"(segmentation )?region index -1"),  # rigid
    (".*", ".*", "coefficients .*|body faces empty|faces empty|joints empty|frames empty"),  # not known, or nothing there
    (".*", "sequence|captured|motion|surface", "(frames|dofs) (shorter|longer|empty)"),  # any number of frames
    (".*", "performance", "(surface faces|frames first:|dofs a column less).*"),  # the actor's count
    (".*", "captured|sequence|surface", "faces .*"),  # likewise
    (".*", "observations|performance", "frames (first:|index) .*"),  # video frame numbers
    ("(face|vertex)_(normals|areas)|rasterize|visible_vertices", "vertices", "nan|-?inf"),  # such a face is degenerate, not drawn
    ("pose_surface|canonical_frames", "actor", "mesh (vertices (nan|-?inf)|faces .*)|face_valid .*"),  # weights and places alone
    ("dress performance|simulate_reference", "performance", "surface frames (shorter|longer|empty)|(dofs|joints|frames) .*"),
    ("body_regions|fit_proxies|proxy_statistics", "actor|segmentation", "(weights|sigma|region|rest) .*"),  # not used
    ("CharacterRenderer.*", "surface", ".*"),  # `high` is drawn
    ("CharacterRenderer.meshes|DisplaySurface.sample|CharacterSimulator.surface", ".*", "nan|-?inf|a column less"),  # pass on
    ("dress.*|summarise_garment|write_garment|width_variants", "garment", ".*"),  # one without faces: the rest does not count
    ("rig_template", "surface", "high.*"),  # is not rigged
    ("texture_character|sample_colours", "images|masks", "first: empty"),  # that camera has none
    ("texture_character_from_take", "surfaces", "shorter|longer"),  # any number of frames
    ("cloth_slack", "canonical", "shorter|longer"),  # likewise
    ("scan_from_views", "masks", "first: empty"),  # likewise: it takes no part
    ("SilhouetteExtractor.*|Features", ".*", "(first: )?(shorter|longer|empty|a column less)"),  # images of any size
    ("orbit_camera", "azimuth|elevation", "-1"),
    ("RayScene.cast|FeatureTracker.match|visible_vertices", "min_distance|reach|tolerance", "-1|inf"),
    ("SourceMotion", "joint_parents", "first: -1"),  # as it was
    # handed on
    ("choose_widths", "garment", "(mesh faces|clothness|rest|actor_face|barycentric|replaced_faces|attachment|mesh vertices) .*"),
    ("FitFinding", "value|low|high", "-1"),
    ("stiffness_of_spring", "constant", "inf"),  # rigid
)  # fmt: skip


def spoilt_calls(function, good, folder):
    """(argument, what is wrong with it, the call), the last one right."""
    cases = [
        (argument, what, lambda argument=argument, wrong=wrong: function(**{**good, argument: wrong}))
        for argument, value in good.items()
        for what, wrong in spoilt(value, folder).items()
    ]
    return [*cases, ("", "as it should be", lambda: function(**good))]


def tried(call):
    try:
        call()
    except CLEAR as error:
        text = f"{type(error).__name__}: {error}"
        short = len(text) < 500 or isinstance(error, TypeError)  # pybind11's own lists what it was called with
        return "raised" if short else "wrong", text[:300]
    except BaseException as error:
        return "wrong", f"{type(error).__name__}: {error}"
    return "accepted", ""


def all_outcomes(function, good, folder, most=None):
    """(argument, what, kind, text)."""
    cases = spoilt_calls(function, good, folder)
    cases = [*cases[: -1 : -(-len(cases) // most) if most else 1], cases[-1]]
    results = outcomes(len(cases), lambda i: tried(cases[i][2]))
    return [(argument, what, kind, text) for (argument, what, _), (kind, text) in zip(cases, results)]


def may_be(*case):
    return any(all(re.fullmatch(pattern, value) for pattern, value in zip(rule, case)) for rule in MAY)


@pytest.fixture(scope="module")
def world():
    return World()


@pytest.fixture(scope="module")
def good_calls(world, tmp_path_factory):
    """Made once: what they do, they do in a process of their own."""
    return calls(world, tmp_path_factory.mktemp("calls"))


NAMES = list(calls(World(), Path(tempfile.mkdtemp())))


@pytest.mark.parametrize("name", NAMES)
def test_wrong_arguments_raise(good_calls, tmp_path, name):
    *rows, last = all_outcomes(*good_calls[name], tmp_path, MOST)
    assert last[2] == "accepted", last
    for argument, what, kind, text in rows:
        assert kind == "raised" or (kind == "accepted" and may_be(name, argument, what)), (argument, what, kind, text)


def test_complex_numbers_raise(world, tmp_path):
    """NumPy hands over their real part, with a warning at most."""
    accepted = []
    for name, (function, good) in calls(world, tmp_path).items():
        arrays = {k: v for k, v in good.items() if isinstance(v, np.ndarray) and v.size and v.dtype.kind in "fi"}
        for argument, value in arrays.items():
            few = [(value + 0.5j).tolist()] if value.size < 100 else []  # the refusal has the whole list
            for wrong in (value + 0.5j, (value + 0.5j).astype(np.complex64), *few):
                try:
                    function(**{**good, argument: wrong})
                    accepted.append((name, argument))
                except (TypeError, ValueError):
                    pass
    assert accepted == []
    with pytest.raises(TypeError):
        d.choose_widths(d.Garment(), [np.complex64(1)])


NOTHING_DRAWN = """
c = World().character
c.texture, c.texcoords, c.high, c.high_valid, c.high_body, c.garment_subdivisions = b"", np.zeros((0, 2)), d.Mesh(), [], [], -1
c.actor.face_valid = np.zeros(len(c.actor.mesh.faces), bool)
c.write("a.glb")
"""
MODEL_WITHOUT_SUCH_A_VERTEX = """
m = d.BodyModel.read(Path(d.__file__).parent / "data" / "body_model.npz")
m.linearise(np.zeros(m.component_count), [m.vertex_count + 5_000_000])
"""


@pytest.mark.parametrize(
    "lines",
    [
        "d.estimate_material([None])",
        "d.fit_together([None])",
        "d.Take([None], d.ReferencePerformance(), d.Observations(), 0.025)",
        MODEL_WITHOUT_SUCH_A_VERTEX,
        NOTHING_DRAWN,
    ],
)
def test_objects_that_are_none_and_parts_that_are_not_there(lines, tmp_path):
    head = f"import sys; sys.path.append({sys.path[-1]!r})\nfrom pathlib import Path\nfrom seeds import World\n"
    program = f"{head}import doublet as d, numpy as np\n{lines}"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 1 and re.search("(TypeError|ValueError|Error): .* found", done.stderr), done.stderr[-300:]


def test_every_function_is_tried():
    tried_ones = {name.split()[0] for name in NAMES} | ELSEWHERE
    functions = {n for n in dir(_doublet) if not n.startswith("_") and not inspect.isclass(getattr(_doublet, n))}
    assert functions - {"annotations"} <= tried_ones, functions - tried_ones


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        made = calls(World(), Path(folder))
        for name in sys.argv[1:] or NAMES:
            for row in all_outcomes(*made[name], Path(folder)):
                note = "" if row[2] == "raised" or row[1] == "as it should be" or may_be(name, *row[:2]) else "  <-- should raise"
                print(name, *row, sep=" | ", end=f"{note}\n", flush=True)
