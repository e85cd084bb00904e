"""Stops `doublet reconstruct` in every way at every stage, and goes on: python tests/slow/every_stage.py [--ways ...]

A small session is made of the shipped one: few frames, half the size. It is reconstructed once without disturbance. Then, for
each stage and each way, everything before the stage is there, the same command is started, and disturbed while the stage runs:

    int, term, kill  a signal in the middle of it
    full             no file may grow beyond half of the stage's largest
    memory           16 MiB of address space more than when it began
    readonly         the folder is on a disk that is read-only now (needs root)

It has to end as docs/bad-input.md says: with one sentence (but for kill) and its exit status. The same command without
disturbance then has to end in the same bits as the undisturbed run, every file but for times. It ends behind the stage, since
later ones have nothing but these files to go by; --whole goes on to the report. Exit status 1 if anything does not hold.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import doublet as d
import numpy as np
from doublet import reconstruct
from PIL import Image

SHIPPED = Path(__file__).resolve().parents[2] / "examples" / "data" / "session"
FRAMES, STEP, SHRINK, CAMERAS = 5, 3, 2, 6
#: Few evaluations.
OPTIONS = [
    "--template-poisson-depth",
    "6",
    "--fit-max-evaluations",
    "16",
    "--garment-length-exceedances",
    "0.25",
    "0.35",
    "--no-capture-second-pass",
]
SIGNALS = {"int": signal.SIGINT, "term": signal.SIGTERM, "kill": signal.SIGKILL}
WAYS = (*SIGNALS, "full", "memory", "readonly")
MEMORY = 16 << 20  # bytes
TIMES = {"seconds", "peak_memory_mb", "peak_memory_scope", "seconds_per_frame", "interrupted", "threads"}
TIMED = {"material.json", "fit_log.csv", "report.html", "fit_checkpoint.txt"}
STAGES = {stage.name: stage for stage in reconstruct.STAGES}


# --- the session


def make_session(folder: Path) -> None:
    session = d.Session(SHIPPED)
    frames = d.FrameSource.open(session)
    cameras = session.rig[:CAMERAS]
    for c, camera in enumerate(cameras):
        (folder / camera.name).mkdir(parents=True)
        for f in range(FRAMES):
            image = frames.image(c, f * STEP)[..., ::-1]
            small = Image.fromarray(np.ascontiguousarray(image)).reduce(SHRINK)
            small.save(folder / camera.name / f"{f:04d}.png")
        camera.width, camera.height = small.size
        K = np.array(camera.K)
        K[:2] /= SHRINK
        K[:2, 2] += (1 - SHRINK) / (2 * SHRINK)  # the centre of the top left pixel is (0, 0)
        camera.K = K
    d.write_calibration(folder / "calibration.yml", cameras)
    for name in ("joints.json", "scan.ply"):
        shutil.copy(SHIPPED / name, folder / name)
    described = {
        "name": "small",
        "fps": session.fps / STEP,
        "frame_count": FRAMES,
        "cameras": [{"name": c.name, "video": f"{c.name}/%04d.png"} for c in cameras],
        "calibration": "calibration.yml",
        "scan": "scan.ply",
        "markers": "joints.json",
    }
    (folder / "session.json").write_text(json.dumps(described, indent=1))


# --- runs


#: The command line, with the first stages alone.
PROGRAM = "import sys; from doublet.cli import program as cli; from doublet import reconstruct; "
PROGRAM += "names = [stage.name for stage in reconstruct.STAGES[: int(sys.argv.pop(1))]]; "
PROGRAM += "reconstruct.Job.run_all = lambda job, force: job.run(names, force); "
PROGRAM += "sys.exit(cli.main(sys.argv[1:]))"


def start(session: Path, out: Path, last: str) -> subprocess.Popen:
    """Reconstructs up to the stage `last`."""
    count = str(1 + list(STAGES).index(last))
    command = [sys.executable, "-c", PROGRAM, count, "reconstruct", str(session), "-o", str(out), "--keep-going", *OPTIONS]
    # A runner in the background may ignore Ctrl-C, and its children would with it.
    return subprocess.Popen(
        command, stderr=subprocess.PIPE, text=True, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)
    )


def finished(process: subprocess.Popen) -> tuple[int, str]:
    said = process.stderr.read()
    return process.wait(), said


def whole_run(session: Path, out: Path) -> None:
    status, said = finished(start(session, out, "report"))
    if status not in (0, 3):  # 3: doubts about so small a session
        raise SystemExit(f"the undisturbed run ended with status {status}:\n{said}")


def copy_before(undisturbed: Path, out: Path, stage: str) -> None:
    """What the folder holds when `stage` begins."""
    shutil.copytree(undisturbed, out, dirs_exist_ok=True)
    forget_from(out, stage)


def forget_from(out: Path, stage: str) -> None:
    """As if `stage` and those behind it had never run."""
    record = json.loads((out / "run.json").read_text())
    names = list(STAGES)
    for name in names[names.index(stage) :]:
        record["stages"].pop(name, None)
        for file in (*STAGES[name].writes, *STAGES[name].continues_from):
            (out / file).unlink(missing_ok=True)
    (out / "run.json").write_text(json.dumps(record))


def disturbed(session: Path, out: Path, stage: str, way: str, seconds: float, largest: int) -> tuple[int, str]:
    process = start(session, out, stage)
    before = ""
    for line in process.stderr:
        before += line
        if line.startswith(f"{stage}: running"):
            break
    if way in SIGNALS:
        time.sleep(0.5 * seconds)
        process.send_signal(SIGNALS[way])
    elif way == "full":
        limit(process, resource.RLIMIT_FSIZE, largest // 2)
    elif way == "memory":
        limit(process, resource.RLIMIT_AS, address_space(process) + MEMORY)
    elif way == "readonly":
        become_readonly(out)
    status, said = finished(process)
    return status, before + said


def limit(process: subprocess.Popen, what: int, most: int) -> None:
    resource.prlimit(process.pid, what, (most, resource.RLIM_INFINITY))


def address_space(process: subprocess.Popen) -> int:
    return int(Path(f"/proc/{process.pid}/statm").read_text().split()[0]) * resource.getpagesize()


def mount(*arguments: str) -> None:
    subprocess.run(["mount", *arguments], check=True, capture_output=True)


def become_readonly(out: Path) -> None:
    """Refused while a file is open for writing, which none is for long."""
    until = time.monotonic() + 2
    while subprocess.run(["mount", "-o", "remount,ro", str(out)], capture_output=True).returncode:
        if time.monotonic() > until:
            raise SystemExit(f"{out} cannot be made read-only")
        time.sleep(0.01)


# --- what has to hold


def told(way: str, out: Path) -> str:
    """What the sentence has in it; of a file it has to tell the name."""
    return f"doublet: {out}/" if way in ("full", "readonly") else "expected more memory" if way == "memory" else "stopped; "


def problems_of_the_end(way: str, status: int, said: str, out: Path) -> list[str]:
    sentences = [line for line in said.splitlines() if line.startswith("doublet: ")]
    expected = -SIGNALS[way] if way == "kill" else 128 + SIGNALS[way] if way in SIGNALS else 1
    found = []
    if status != expected:
        found.append(f"expected status {expected}, found {status}")
    if way != "kill" and len(sentences) != 1:
        found.append(f"expected one sentence, found {sentences or said.splitlines()[-3:]}")
    if way != "kill" and not any(told(way, out) in sentence for sentence in sentences):
        found.append(f"expected a sentence with '{told(way, out)}'")
    if "Traceback" in said or "internal error" in said:
        found.append(f"expected a sentence, found {said[-500:]}")
    return found


def without_times(value):
    if isinstance(value, dict):
        return {k: without_times(v) for k, v in value.items() if k not in TIMES}
    return [without_times(v) for v in value] if isinstance(value, list) else value


def comparable(path: Path):
    if path.suffix == ".json":
        return without_times(json.loads(path.read_text()))
    if path.suffix == ".csv":
        return [{k: v for k, v in row.items() if k != "seconds"} for row in csv.DictReader(path.open())]
    if path.suffix == ".html":
        text = re.sub(r"<h2>Time and memory</h2>.*?</table>", "", path.read_text(), flags=re.DOTALL)
        text = re.sub(rf"<td>({'|'.join(TIMES).replace('_', ' ')})</td><td[^>]*>[^<]*</td>", "", text)
        return re.sub(r"\b\d+(\.\d+)? (s|MB|min)\b", "", text)
    if path.name == "fit_checkpoint.txt":
        search = without_times(json.loads(path.read_text()))
        return {**search, "log": [row[:-1] for row in search["log"]]}
    return path.read_bytes()


def comparable_record(path: Path, stages: list[str]) -> dict:
    """What run.json says of the stages; hashes of files with times in them differ."""
    record = without_times(json.loads(path.read_text()))
    record["stages"] = {name: entry for name, entry in record["stages"].items() if name in stages}
    for entry in record["stages"].values():
        for kind in ("inputs", "outputs"):
            entry[kind] = {k: v for k, v in entry[kind].items() if k not in TIMED}
    return record


def differences(undisturbed: Path, out: Path, last: str) -> list[str]:
    """Every file of both, but for the log and what the stages after `last` write."""
    names = list(STAGES)
    done, later = names[: names.index(last) + 1], names[names.index(last) + 1 :]
    not_yet = {file for name in later for file in (*STAGES[name].writes, *STAGES[name].continues_from)} | {"log.txt"}
    expected, made = ({p.name for p in folder.iterdir()} - not_yet for folder in (undisturbed, out))
    found = [f"{name} is in one of the folders only" for name in sorted(expected ^ made)]
    for name in sorted(expected & made - {"run.json"}):
        if comparable(undisturbed / name) != comparable(out / name):
            found.append(f"{name} differs")
    if comparable_record(undisturbed / "run.json", done) != comparable_record(out / "run.json", done):
        found.append("run.json differs")
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--ways", nargs="+", choices=WAYS, default=WAYS, help="default: all")
    parser.add_argument("--stages", nargs="+", choices=STAGES, default=list(STAGES), help="default: all")
    parser.add_argument("--whole", action="store_true", help="one folder a way, disturbed at every stage")
    parser.add_argument("--keep", type=Path, help="folder to work in, kept, where an undisturbed run is taken up")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.keep or Path(temporary)
        session, undisturbed = folder / "session", folder / "undisturbed"
        if not session.exists():
            make_session(session)
        whole_run(session, undisturbed)
        entries = json.loads((undisturbed / "run.json").read_text())["stages"]
        print(*(f"{name}: {entry['seconds']} s" for name, entry in entries.items()), sep=", ", flush=True)
        stages = [stage for stage in STAGES if stage in arguments.stages]
        walks = [stages] if arguments.whole else [[stage] for stage in stages]
        bad = 0
        for walk in walks:
            for way in arguments.ways:
                if way == "readonly" and os.geteuid() != 0:
                    print(*walk, "readonly: not tried, needs root")
                    continue
                out = folder / f"{'whole' if arguments.whole else walk[0]}_{way}"
                shutil.rmtree(out, ignore_errors=True)
                out.mkdir()
                if way == "readonly":
                    mount("-t", "tmpfs", "-o", "size=256m", "tmpfs", str(out))
                try:
                    good = walk_holds(session, undisturbed, out, walk, way, entries, "report" if arguments.whole else walk[-1])
                finally:
                    if way == "readonly":
                        subprocess.run(["umount", str(out)], check=True)
                if good:
                    shutil.rmtree(out)
                bad += not good
    return 1 if bad else 0


def walk_holds(session: Path, undisturbed: Path, out: Path, stages: list[str], way: str, entries: dict, end: str) -> bool:
    """Disturbs one stage after the other in one folder, each on top of what came of the disturbance before, up to `end`."""
    good = True
    copy_before(undisturbed, out, stages[0])
    for stage, following in zip(stages, [*stages[1:], None]):
        last = end if following is None else list(STAGES)[list(STAGES).index(following) - 1]
        if not holds(session, undisturbed, out, stage, way, entries[stage]["seconds"], last):
            good = False
            if following is not None:
                shutil.copytree(out, out.with_name(f"{stage}_{way}"), dirs_exist_ok=True)
                copy_before(undisturbed, out, following)  # one fault is told once
    return good


def holds(session: Path, undisturbed: Path, out: Path, stage: str, way: str, seconds: float, last: str) -> bool:
    """`out` is where `stage` begins; the run that is not disturbed ends with `last`."""
    largest = max((undisturbed / name).stat().st_size for name in STAGES[stage].writes)
    for _ in range(5):
        status, said = disturbed(session, out, stage, way, seconds, largest)
        if way not in SIGNALS or f"{stage}: done" not in said:
            break
        seconds /= 3  # the machine was faster than in the undisturbed run, the signal too late
        forget_from(out, stage)
    found = problems_of_the_end(way, status, said, out)
    if way == "readonly":
        mount("-o", "remount,rw", str(out))
    again, said_again = finished(start(session, out, last))
    if again not in (0, 3):
        found.append(f"the next run ended with status {again}: {said_again[-500:]}")
    found += differences(undisturbed, out, last)
    sentence = next((line for line in said.splitlines() if line.startswith("doublet: ")), "")
    print(f"{stage} {way}: status {status}; {sentence}", *(f"    {problem}" for problem in found), sep="\n", flush=True)
    return not found


if __name__ == "__main__":
    sys.exit(main())
