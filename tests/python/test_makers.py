"""Classes without a constructor, and objects of another class than a function takes, say which function makes what is wanted."""

import re
from pathlib import Path

import doublet as d
import pytest
from doublet import _doublet
from doublet.common import makers

CLASSES = [of for of in vars(_doublet).values() if isinstance(of, type) and not issubclass(of, BaseException)]


def sentence(call, *arguments) -> str:
    with pytest.raises(TypeError) as raised:
        call(*arguments)
    return str(raised.value)


def test_a_class_without_a_constructor_says_what_makes_one():
    assert sentence(d.Character, "character.glb") == (
        "doublet.Character has no constructor: doublet.Character.read or doublet.make_character makes one"
    )
    assert sentence(d.FitResult).endswith("constructor: doublet.estimate_material makes one")
    assert sentence(d.Limit).endswith("other objects and results hold such ones")


def test_every_class_says_so():
    constructed = {name for name, _, result in makers.signatures() if name == result}
    without = [of for of in CLASSES if of.__name__ not in constructed and not hasattr(of, "described")]
    said = [str(error) for of in without for error in [_raised(of)] if error]
    assert len(said) > 20 and not [text for text in said if "No constructor defined" in text]
    for text in said:
        for name in re.findall(r"doublet\.(\w+)\.?(\w*)", text):
            assert hasattr(getattr(d, name[0]), name[1] or "__class__"), text


def _raised(of):
    try:
        of()
    except TypeError as error:
        return error
    return None


def test_an_object_of_another_class_says_what_makes_the_one_that_is_wanted():
    skeleton = d.Skeleton([d.JointAnnotation("pelvis", "", [0, 0.5, 0], 6)])
    clip = d.SourceMotion(["hips"], [-1], [[0, 1, 0]], [[[0, 1, 0]]], [[[1, 0, 0, 0]]], 30)
    assert sentence(d.resample, skeleton, clip, 40) == "expected Motion, found SourceMotion; doublet.retarget makes one of it"
    assert sentence(d.animate, "character.glb", clip) == "expected Character, found str; doublet.Character.read makes one"
    assert sentence(d.retarget, Path("walk.bvh"), skeleton) == (
        "expected SourceMotion, found PosixPath; doublet.SourceMotion.read makes one"
    )
    assert "found str; doublet.retarget(a SourceMotion) makes one" in sentence(d.resample, skeleton, "walk.bvh", 40)
    assert "incompatible function arguments" in sentence(d.resample, skeleton, 1, 40)  # nothing makes one of it
