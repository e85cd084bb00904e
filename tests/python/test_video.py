"""Videos of an animation: size, camera, background."""

import sys
from pathlib import Path

import doublet as d
import numpy as np
import pytest
from doublet.cli import program as cli
from doublet.common.video import VideoWriter, decoded_times, probe, read_video
from doublet.export.animate import write_video
from doublet.export.video_camera import FILLED, FILLED_ACROSS, Shot, cameras_along, projected, skinned

sys.path.append(str(Path(__file__).parents[1] / "fuzz"))
from seeds import World  # noqa: E402


@pytest.fixture(scope="module")
def character():
    return World().character


def test_a_name_with_a_colon_is_no_protocol(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with VideoWriter(Path("12:30.mp4"), 64, 48, 25) as video:
        for _ in range(3):
            video.write(np.zeros((48, 64, 3), np.uint8))
    found = read_video(Path("12:30.mp4"))
    assert len(found.times) == len(decoded_times(found.path)) == len(list(found.frames())) == 3


@pytest.mark.parametrize(("fps", "stated"), [(30000 / 1001, "30000/1001"), (1 / (1001 / 24000), "24000/1001"), (40.0, "40/1")])
def test_a_broadcast_rate_is_kept_as_editors_know_it(tmp_path, fps, stated):
    with VideoWriter(tmp_path / "a.mp4", 64, 48, fps) as video:
        for _ in range(3):
            video.write(np.zeros((48, 64, 3), np.uint8))
    assert probe(tmp_path / "a.mp4", "V:0", "stream=r_frame_rate")["streams"] == [{"r_frame_rate": stated}]


def test_more_options_reach_the_encoder(tmp_path):
    for coding, ahead in (((), 2), (("-bf", "1"), 1)):
        with VideoWriter(tmp_path / "a.mp4", 64, 48, 25, coding=coding) as video:
            for k in range(20):
                video.write(np.full((48, 64, 3), 10 * k, np.uint8))
        assert probe(tmp_path / "a.mp4", "V:0", "stream=has_b_frames")["streams"] == [{"has_b_frames": ahead}]


def test_colours_are_those_of_the_picture_and_players_are_told(character, tmp_path):
    shot = Shot(64, 64, background=(0.9, 0.1, 0.1))
    write_video(character, walk(character, 0.0), tmp_path / "red.mp4", d.Context(), shot)
    assert probe(tmp_path / "red.mp4", "V:0", "stream=color_space")["streams"] == [{"color_space": "bt709"}]
    corner = next(read_video(tmp_path / "red.mp4").frames())[:4, :4].mean(axis=(0, 1))  # B G R
    assert np.abs(corner - np.array([0.1, 0.1, 0.9]) * 255).max() < 6


def walk(character, metres, along="tx"):
    dofs = np.zeros((80, len(character.actor.skeleton.dof_names)))
    dofs[:, character.actor.skeleton.dof_names.index(f"pelvis.{along}")] = np.linspace(0, metres, 80)
    return d.Motion(40, dofs)


def heights(character, motion, cameras, shot):
    """(T) of the picture's height that the person takes, and (T, 2) the middle, of half the picture."""
    found = []
    for dofs, camera in zip(motion.dofs, cameras):
        places = projected(skinned(character, dofs), camera) * camera.K[0, 0]
        low, high = places.min(axis=0), places.max(axis=0)
        found.append([(high - low)[1] / shot.height, *((low + high) / [shot.width, shot.height])])
    return np.array(found)


@pytest.mark.parametrize("size", [(720, 720), (1920, 1080)])
@pytest.mark.parametrize("camera", ["front", "follow", "orbit"])
def test_a_person_fills_the_picture(character, size, camera):
    shot, motion = Shot(*size, camera=camera), walk(character, 0.0)
    found = heights(character, motion, cameras_along(character, motion, 80, shot), shot)
    assert found[:, 0].max() == pytest.approx(FILLED, abs=0.01) and found[:, 0].min() > FILLED - 0.03
    assert np.abs(found[:, 1:]).max() < 0.05


def test_who_walks_away_is_followed(character):
    motion, shot = walk(character, 6.0), Shot(camera="follow")
    found = heights(character, motion, cameras_along(character, motion, 80, shot), shot)
    assert found[:, 0].min() > FILLED - 0.1 and np.abs(found[20:60, 1]).max() < 0.1
    still = Shot(camera="front")
    across = heights(character, motion, cameras_along(character, motion, 80, still), still)
    assert across[:, 0].max() < 0.4 and np.abs(across[[0, -1], 1]).min() > 0.5
    automatic = cameras_along(character, motion, 80, Shot())
    assert not np.allclose(automatic[0].centre, automatic[-1].centre)


@pytest.mark.parametrize("rate", [40, 120])
def test_the_camera_keeps_pace_with_who_runs(character, rate):
    """Whatever the rate of the clip, and where a film asks for more cameras than it has frames."""
    run, shot = walk(character, 16.0), Shot(camera="follow")
    motion = d.resample(character.actor.skeleton, run, rate)
    cameras = cameras_along(character, motion, 85, shot)
    for dofs, camera in zip(run.dofs, cameras):
        places = np.abs(projected(skinned(character, dofs), camera)) * camera.K[0, 0]
        assert places[:, 0].max() < (FILLED_ACROSS + 0.02) * shot.width / 2


@pytest.mark.parametrize("metres", [10.0, 100.0, -100.0])
def test_who_walks_to_the_camera_does_not_pass_it(character, metres):
    shot, motion = Shot(1280, 720, camera="front"), walk(character, metres, "tz")
    camera = cameras_along(character, motion, 80, shot)[0]
    bodies = np.array([skinned(character, dofs) for dofs in motion.dofs])
    assert (bodies @ camera.R.T + camera.t)[..., 2].min() > 0
    places = np.abs(projected(bodies.reshape(-1, 3), camera)) * camera.K[0, 0] / [shot.width / 2, shot.height / 2]
    assert places[:, 0].max() < FILLED_ACROSS + 0.01 and FILLED - 0.02 < places[:, 1].max() < FILLED + 0.01


@pytest.mark.parametrize("camera", ["front", "follow", "orbit"])
def test_a_leap_in_a_long_motion_stays_in_the_picture(character, camera):
    """It takes half a second of 50."""
    names = character.actor.skeleton.dof_names
    dofs, shot = np.zeros((2000, len(names))), Shot(camera=camera)
    for name, size in (("pelvis.tx", 1.5), ("pelvis.ty", 0.6)):
        dofs[1010:1030, names.index(name)] = size * np.sin(np.linspace(0, np.pi, 20))
    cameras = cameras_along(character, d.Motion(40, dofs), 2000, shot)
    for pose, filming in zip(dofs[1005:1035], cameras[1005:1035]):
        places = projected(skinned(character, pose), filming) * filming.K[0, 0]
        assert np.abs(places).max() < 360


def test_an_orbit_goes_round_once(character):
    motion = walk(character, 0.0)
    cameras = cameras_along(character, motion, 80, Shot(camera="orbit", turn_seconds=2.0))
    angles = np.unwrap([np.arctan2(c.centre[0], c.centre[2]) for c in cameras])
    assert angles[-1] - angles[0] == pytest.approx(2 * np.pi * 79 / 80, abs=0.02)


@pytest.fixture
def files(character, tmp_path):
    character.write(tmp_path / "c.glb")
    np.savez(tmp_path / "walk.npz", dofs=walk(character, 0.5).dofs[:20])
    return [str(tmp_path / "c.glb"), str(tmp_path / "walk.npz")]


def test_the_command_films_as_it_is_told(files, tmp_path):
    out = tmp_path / "out.mp4"
    flags = ["--size", "320x180", "--camera", "orbit", "--background", "#204060", "--quiet"]
    assert cli.main(["animate", *files, "-o", str(out), *flags]) == 0
    video = read_video(out)
    assert video.size == (320, 180)
    corner = next(video.frames())[2, 2].astype(int)
    np.testing.assert_allclose(corner, [0x60, 0x40, 0x20], atol=4)  # B G R, above the horizon


def test_pictures_are_in_their_order(character, tmp_path):
    """They are drawn on several threads: the person goes from left to right."""
    from doublet.export.animate import write_video

    motion = walk(character, 2.0)
    options = d.AnimateOptions(settle_seconds=0)
    write_video(character, motion, tmp_path / "a.mp4", d.Context(), Shot(160, 120, "front"), options)
    columns = []
    for picture in list(read_video(tmp_path / "a.mp4").frames())[::8]:
        upper = picture[: picture.shape[0] // 2].astype(int)
        contrast = np.abs(upper - upper[:, :1]).sum(axis=(0, 2))
        columns.append(np.argmax(contrast > 0.3 * contrast.max()))  # the person's left edge
    assert np.all(np.diff(columns) > 0)


@pytest.mark.parametrize(
    ("flags", "said"),
    [
        (["--size", "1920"], "--size: expected WIDTHxHEIGHT such as 1920x1080, found '1920'"),
        (["--size", "8x8"], "size: expected WIDTHxHEIGHT, 16 to 8192 px each, found 8x8"),
        (["--size", "321x180"], "--size: expected even numbers, which all video players show, found '321x180'"),
        (["--camera", "orbit", "--turn-seconds", "0"], "turn_seconds: expected s above 0, found 0"),
        (["--turn-seconds", "4"], "--turn-seconds: only --camera orbit goes round"),
        (["--background", "mauvve"], "--background: expected a colour"),
    ],
)
def test_what_is_refused(files, tmp_path, capsys, flags, said):
    assert cli.main(["animate", *files, "-o", str(tmp_path / "out.mp4"), *flags]) == 1
    assert said in capsys.readouterr().err and not (tmp_path / "out.mp4").exists()


def test_an_array_has_no_camera(files, tmp_path, capsys):
    assert cli.main(["animate", *files, "-o", str(tmp_path / "out.npz"), "--camera", "orbit"]) == 1
    assert "expected an .mp4 for a size, camera or background, found .npz" in capsys.readouterr().err
