"""The error that each flaw of a real room adds: a session filmed in front of a screen, modified as if filmed in such a room.

python benchmarks/rooms.py SESSION -o FOLDER [--rooms clean flicker ...] [--seed N]

Rooms (ROOMS): `flicker`, ready masks whose outline is off by 2 pixels, another in every frame, with a hole now and then;
`calib`, every camera turned by N(0, 0.2 degrees), its focal length off by N(0, 0.2 %); `calib05`, the same with 0.5; `late`,
every second camera films a frame late, and nobody says so; `masks`, calib and flicker, with blur, noise, other exposures and a
strong compression; `room`, the same before clutter, with clean plates in the place of masks; `clutter`, before clutter with the
masks, which go before the plates; `eight`, `four` and `three`, without scan and joints (`doublet scan`), with all cameras and
with every second or third one; `person` and `person4`, the same without a calibration: cameras by `new-session --calibrate`,
the world that was found laid over the true one. --keypoints: those of the session's videos, as a program found them; otherwise
the true joints with an error of 0.6 % of the image. --tracked-keypoints: every room has them, and tracking goes by them.
Printed: a row of `doublet evaluate` each. What is in FOLDER already is not made again; a room that was made of something else is
refused.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

import doublet as d
import numpy as np
from doublet.cli.common_flags import DOUBTFUL
from doublet.common.video import VideoWriter, read_video
from doublet.evaluation.cameras import compare
from doublet.session.keypoints import JOINTS, filmed_keypoints, write_keypoints
from doublet.session.new_session import new_session
from doublet.session.request import Request
from PIL import Image, ImageFilter

METRICS = ("joint_mm", "surface_body_mm", "surface_cloth_mm", "silhouette_iou", "cloth_iou")
PLATES = 8
KEYPOINT_ERROR = 0.006  #: of the image's larger side
LIGHT_FLICKER = 0.01  #: standard deviation of the light of a cluttered room
KEYED = 0.5  #: of a pixel, that is the screen


@dataclass(frozen=True)
class Flaws:
    """None by default."""

    turn: float = 0  # degrees, standard deviation; of the focal length in percent
    late: bool = False  # every second camera films a frame late
    blur: float = 0  # px, standard deviation
    noise: float = 0  # grey levels
    exposure: float = 0  # of brightness; two fifths of it of the ratios of colours
    crf: int = 17  # of libx264
    clutter: bool = False  # in the place of the screen, with clean plates
    flicker: float = 0  # px; ready masks in the place of a screen
    scanned: bool = True  # has a scan and joints
    calibrated: bool = True  # otherwise by the person
    every: int = 1  # camera of so many is there


@dataclass(frozen=True)
class Person:
    """Who calibrates."""

    height: float  # m
    keypoints: Path | None  # None: the true joints, with an error
    tracked: bool  # the session keeps them


FILMED = {"turn": 0.2, "blur": 0.7, "noise": 4, "exposure": 0.08, "crf": 26}
ROOMS = {
    "clean": Flaws(),
    "flicker": Flaws(flicker=2),
    "calib": Flaws(turn=0.2),
    "calib05": Flaws(turn=0.5),
    "late": Flaws(late=True),
    "masks": Flaws(**FILMED, flicker=2),
    "room": Flaws(**FILMED, clutter=True),
    "clutter": Flaws(**FILMED, clutter=True, flicker=2),
    "eight": Flaws(scanned=False),
    "four": Flaws(scanned=False, every=2),
    "three": Flaws(scanned=False, every=3),
    "person": Flaws(scanned=False, calibrated=False),
    "person4": Flaws(scanned=False, calibrated=False, every=2),
}


def blurred(picture: np.ndarray, radius: float) -> np.ndarray:
    return np.asarray(Image.fromarray(picture).filter(ImageFilter.GaussianBlur(radius)))


def wavy(shape: tuple[int, int], size: int, random: np.random.Generator) -> np.ndarray:
    """(H, W) a smooth field of deviation about 1 with waves of `size` pixels."""
    small = random.normal(size=(max(2, shape[0] // size), max(2, shape[1] // size))).astype(np.float32)
    return np.asarray(Image.fromarray(small).resize(shape[::-1], Image.Resampling.BICUBIC))


def share_of_screen(bgr: np.ndarray) -> np.ndarray:
    """(H, W) in [0, 1]: how green, against the larger of blue and red."""
    b, g, r = (bgr[..., c].astype(np.float32) for c in range(3))
    return np.clip((g - 1.02 * np.maximum(b, r) - 8) / 25, 0, 1)


def clutter(shape: tuple[int, int], random: np.random.Generator) -> np.ndarray:
    """(H, W, 3) a still room: sixty boxes of any colour, with a grain."""
    room = np.full((*shape, 3), 150, np.uint8)
    for _ in range(60):
        x, y = random.integers(0, shape[1]), random.integers(0, shape[0])
        width, height = random.integers(10, shape[1] // 3, 2)
        room[y : y + height, x : x + width] = random.uniform(30, 230, 3)
    return blurred(room, 1.2).astype(np.float32) + 12 * wavy(shape, 4, random)[..., None]


def flickering(screen: np.ndarray, flaws: Flaws, random: np.random.Generator) -> np.ndarray:
    """(H, W) uint8 a mask whose outline is off by about `flicker` pixels, now and then with a hole."""
    height, width = screen.shape
    rows, columns = np.mgrid[:height, :width] + flaws.flicker * np.stack([wavy(screen.shape, 24, random) for _ in "yx"])
    mask = (screen < KEYED)[rows.round().astype(int).clip(0, height - 1), columns.round().astype(int).clip(0, width - 1)]
    if random.random() < 0.15:
        inside = np.argwhere(mask)
        y, x = inside[random.integers(len(inside))]
        rows, columns = np.ogrid[:height, :width]
        mask &= np.hypot(rows - y, columns - x) > 6 * flaws.flicker
    return np.where(mask, 255, 0).astype(np.uint8)


class Filmed:
    """One camera in the room."""

    def __init__(self, flaws: Flaws, shape: tuple[int, int], random: np.random.Generator):
        self.flaws, self.random = flaws, random
        colours = random.normal(size=3) * flaws.exposure * np.array([0.4, 0.15, 0.4])
        self.gain = 1 + colours + random.normal() * flaws.exposure
        self.room = clutter(shape, random) if flaws.clutter else None

    def light(self) -> np.ndarray:
        return self.gain * (1 + self.random.normal() * LIGHT_FLICKER * self.flaws.clutter)

    def plate(self) -> np.ndarray:
        noise = self.random.normal(size=self.room.shape) * (2 + self.flaws.noise)
        return np.clip(self.room * self.light() + noise, 0, 255).astype(np.uint8)

    def picture(self, bgr: np.ndarray, screen: np.ndarray) -> np.ndarray:
        picture = bgr.astype(np.float32)
        if self.room is not None:
            back = blurred((255 * screen).astype(np.uint8), 0.7).astype(np.float32)[..., None] / 255
            picture[..., 1] = np.minimum(picture[..., 1], 1.05 * np.maximum(picture[..., 0], picture[..., 2]))
            picture = picture * (1 - back) + self.room * back
        picture = np.clip(picture * self.light(), 0, 255)
        if self.flaws.blur:
            picture = blurred(picture.astype(np.uint8), self.flaws.blur).astype(np.float32)
        picture += self.random.normal(size=picture.shape) * self.flaws.noise
        return np.clip(picture, 0, 255).astype(np.uint8)


def turned(camera: d.Camera, degrees: float, random: np.random.Generator) -> d.Camera:
    """About its centre, around a random axis."""
    x, y, z = axis = random.normal(size=3)
    across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]) / np.linalg.norm(axis)
    angle = np.radians(random.normal() * degrees)
    turn = np.eye(3) + np.sin(angle) * across + (1 - np.cos(angle)) * across @ across
    K, R, centre = np.array(camera.K), turn @ camera.R, np.ravel(camera.centre)
    K[:2, :2] *= 1 + random.normal() * degrees / 100
    camera.K, camera.R, camera.t = K, R, -R @ centre
    return camera


def film(session: d.Session, camera: int, flaws: Flaws, folder: Path, random: np.random.Generator) -> dict:
    """Writes video, masks and plates of a camera; its entry of session.json."""
    frames, name = d.FrameSource.open(session), session.cameras[camera].name
    late = int(flaws.late and camera % 2)
    first = np.asarray(frames.image(camera, 0))
    place, entry = Filmed(flaws, first.shape[:2], random), {"name": name, "video": f"videos/{name}.mp4"}
    for key, used in (("masks", flaws.flicker), ("plates", flaws.clutter)):
        if used:
            (folder / key / name).mkdir(parents=True, exist_ok=True)
            entry["masks" if key == "masks" else "background"] = f"{key}/{name}/%05d.png"
    for k in range(PLATES * flaws.clutter):
        Image.fromarray(place.plate()[..., ::-1]).save(folder / f"plates/{name}/{k:05d}.png")
    height, width = first.shape[:2]
    with VideoWriter(folder / entry["video"], width, height, session.fps, flaws.crf) as video:
        for t in range(session.frame_count):
            bgr = np.asarray(frames.image(camera, max(0, t - late)))
            screen = share_of_screen(bgr)
            video.write(place.picture(bgr, screen))
            if flaws.flicker:
                Image.fromarray(flickering(screen, flaws, random)).save(folder / f"masks/{name}/{t:05d}.png")
    return entry


def make_session(source: Path, flaws: Flaws, folder: Path, seed: int, person: Person) -> None:
    session, random = d.Session(source), np.random.default_rng(seed)
    (folder / "videos").mkdir(parents=True)
    description = json.loads((source / "session.json").read_text(encoding="utf-8"))
    for key in ("scan", "markers", "new_motion"):
        description.pop(key, None)
    if flaws.scanned:
        for key, path in (("scan", session.scan), ("markers", session.markers)):
            shutil.copy(path, folder / Path(path).name)
            description[key] = Path(path).name
    rig = [turned(camera, flaws.turn, random) for camera in session.rig][:: flaws.every]
    cameras = range(0, len(session.cameras), flaws.every)
    description["cameras"] = [film(session, camera, flaws, folder, random) for camera in cameras]
    d.write_calibration(folder / "calibration.yml", rig)
    description["calibration"] = "calibration.yml"
    if person.tracked or not flaws.calibrated:
        keypoints = keypoints_for(source, folder, session.rig[:: flaws.every], person, random)
    if not flaws.calibrated:
        d.write_calibration(folder / "calibration.yml", calibrated_by_person(source, folder, rig, keypoints, person))
    if person.tracked:
        names = [camera.name for camera in rig]
        numbers = [np.maximum(np.arange(session.frame_count) - int(flaws.late and index % 2), 0) for index in range(len(names))]
        videos = [read_video(folder / f"videos/{name}.mp4") for name in names]
        description["keypoints"] = write_keypoints(folder, names, filmed_keypoints(keypoints, names, videos, numbers))
    (folder / "session.json").write_text(json.dumps(description, indent=1), encoding="utf-8")  # last: it is complete


def true_joints(source: Path) -> tuple[np.ndarray, list[str]]:
    """(T, J, 3) m, and their names."""
    with np.load(source / "ground_truth" / "skeleton.npz") as truth:
        return truth["joints"], truth["joint_names"].tolist()


def keypoints_for(source: Path, folder: Path, rig: list[d.Camera], person: Person, random) -> Path:
    """A folder with those of these cameras alone."""
    joints, names = true_joints(source)
    keypoints = person.keypoints or folder / "keypoints"
    for camera in rig if not person.keypoints else []:
        seen = np.zeros((len(joints), 17, 3))  # in COCO's order
        exact = [[camera.project(joint) for joint in frame[[names.index(n) for n in JOINTS]]] for frame in joints]
        error = KEYPOINT_ERROR * max(camera.width, camera.height)
        seen[:, 5:] = np.dstack([np.array(exact) + random.normal(0, error, (len(joints), 12, 2)), np.ones((len(joints), 12))])
        keypoints.mkdir(exist_ok=True)
        (keypoints / f"{camera.name}.json").write_text(json.dumps(seen.tolist()), encoding="utf-8")
    chosen = folder / "chosen"  # keypoints may be there of more cameras
    chosen.mkdir()
    for camera in rig:
        (chosen / f"{camera.name}.json").symlink_to((keypoints / f"{camera.name}.json").absolute())
    return chosen


def calibrated_by_person(source: Path, folder: Path, rig: list[d.Camera], keypoints: Path, person: Person) -> list[d.Camera]:
    """The cameras that are found for the session's videos, in the true world."""
    joints, _ = true_joints(source)
    videos, found = [folder / "videos" / f"{camera.name}.mp4" for camera in rig], folder / "found"
    new_session(Request(videos=videos, calibration=None, out=found, keypoints=keypoints, height=person.height, sync="none"))
    errors = compare(d.Session(found).rig, rig, joints[::8].reshape(-1, 3))
    shutil.rmtree(found)
    print(
        f"cameras by the person: {1000 * errors.metres.min():.1f} to {1000 * errors.metres.max():.1f} mm at the person, "
        f"scale {100 * errors.scale - 100:+.1f} %, up {np.degrees(errors.tilt):.1f} degrees off",
        file=sys.stderr,
    )
    return errors.placed


def run(*command: object) -> str:
    """What it prints. Doubts are what rooms are for."""
    whole = [sys.executable, "-m", "doublet", *map(str, command), "--quiet"]
    done = subprocess.run(whole, stdout=subprocess.PIPE, text=True)
    if done.returncode not in (0, DOUBTFUL):
        raise SystemExit(f"doublet {command[0]} failed with status {done.returncode}")
    return done.stdout


def made_of(source: Path, flaws: Flaws, seed: int, person: Person) -> dict:
    """All that a room depends on, as JSON has it."""
    asked = person.tracked or not flaws.calibrated
    keypoints = str(person.keypoints.resolve()) if asked and person.keypoints else None
    height = None if flaws.calibrated else person.height
    who = {"height": height, "keypoints": keypoints, "tracked": person.tracked}
    return {"session": str(source.resolve()), "seed": seed, "flaws": asdict(flaws), "person": who}


def measured(source: Path, room: str, folder: Path, seed: int, person: Person) -> dict[str, float]:
    flaws, session, out = ROOMS[room], folder / room, folder / f"{room}.out"
    wanted, record = made_of(source, flaws, seed, person), folder / f"{room}.json"
    if not (session / "session.json").exists():
        shutil.rmtree(session, ignore_errors=True)
        folder.mkdir(parents=True, exist_ok=True)
        record.write_text(json.dumps(wanted, indent=1), encoding="utf-8")
        make_session(source, flaws, session, seed, person)
    found = json.loads(record.read_text(encoding="utf-8")) if record.exists() else "nothing that says so"
    if found != wanted:
        raise SystemExit(f"{session}: expected a room that is made of {wanted}, found {found}: take another folder")
    if not flaws.scanned and not (session / "scan.ply").exists():
        run("scan", session)
    run("capture", session, "-o", out, "--keep-going")
    run("segment", out)
    return json.loads(run("evaluate", out, "--truth", source / "ground_truth", "--json"))["metrics"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("session", type=Path, help="before a green screen, with its ground_truth")
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--rooms", nargs="+", choices=ROOMS, default=list(ROOMS))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--height", type=float, default=1.68, help="m, of the person, who calibrates")
    parser.add_argument("--keypoints", type=Path, help="of the person for each camera, as a program found them")
    parser.add_argument("--tracked-keypoints", action="store_true", help="tracking goes by keypoints, too")
    options = parser.parse_args()
    if not (options.session / "ground_truth").is_dir():
        parser.error(f"expected a session with ground_truth, found {options.session}")
    person = Person(options.height, options.keypoints, options.tracked_keypoints)
    print("| | " + " | ".join(f"`{name}`" for name in METRICS) + " |")
    print("| --- |" + " --- |" * len(METRICS))
    for room in options.rooms:
        values = measured(options.session, room, options.out, options.seed, person)
        row = [f"{values[name]:.1f}" if name.endswith("mm") else f"{values[name]:.3f}" for name in METRICS]
        print(f"| {room} | " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
