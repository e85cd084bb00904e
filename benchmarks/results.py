"""The first table of docs/results.md, with version and date.

python benchmarks/results.py NAME=SESSION... -o FOLDER [--write docs/results.md] [--seed N]

Every session is reconstructed into FOLDER/NAME with the users' command (remove a FOLDER of another version first) and compared
with its ground truth. Printed as Markdown; --write puts it into a page, between `<!-- results -->` and
`<!-- /results -->`.
"""

from __future__ import annotations

import argparse
import datetime
import json
import os
import platform
import re
import subprocess
import sys
from pathlib import Path

import doublet as d
from doublet.cli.common_flags import DOUBTFUL

METRICS = {"joint_mm": 1, "surface_body_mm": 1, "surface_cloth_mm": 1, "silhouette_iou": 3, "cloth_iou": 3, "hidden_body_mm": 1,
           "resim_cloth_cm": 2, "resim_two_sided_cm": 2, "hem_height_cm": 2, "flare_cm": 2}  # fmt: skip
MARKS = "<!-- results -->", "<!-- /results -->"


def main() -> int:
    arguments = parse()
    columns = {}
    for name, session in arguments.sessions:
        out = arguments.out / name
        reconstruct(session, out, arguments.seed)
        columns[name] = column(out, session / "ground_truth")
    text = f"{heading(arguments.seed)}\n\n{table(columns)}\n"
    print(text)
    if arguments.write:
        page = arguments.write.read_text(encoding="utf-8")
        arguments.write.write_text(between_marks(page, text), encoding="utf-8")
    return 0


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sessions", nargs="+", type=named_session, metavar="NAME=SESSION")
    parser.add_argument("-o", dest="out", type=Path, required=True, metavar="FOLDER")
    parser.add_argument("--write", type=Path, metavar="PAGE")
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


def named_session(text: str) -> tuple[str, Path]:
    name, _, folder = text.partition("=")
    if not (Path(folder) / "ground_truth").is_dir():
        raise argparse.ArgumentTypeError(f"expected NAME=SESSION, a session with ground_truth, found {text}")
    return name, Path(folder)


def reconstruct(session: Path, out: Path, seed: int) -> None:
    command = ["doublet", "reconstruct", str(session), "-o", str(out), "--seed", str(seed), "--quiet"]
    status = subprocess.run(command, stdout=subprocess.DEVNULL).returncode
    if status not in (0, DOUBTFUL):
        raise SystemExit(f"results.py: {' '.join(command)}: expected status 0, found {status}")


def column(out: Path, truth: Path) -> dict[str, str]:
    command = ["doublet", "evaluate", str(out), "--truth", str(truth), "--json", "--quiet"]
    metrics = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout)["metrics"]
    cells = {f"`{name}`": rounded(metrics.get(name), digits) for name, digits in METRICS.items()}
    regions = json.loads((out / "material.json").read_text(encoding="utf-8"))["regions"]
    cells |= estimate(regions[0]) if regions else {}
    return cells


def estimate(region: dict) -> dict[str, str]:
    found = region["parameters"]
    low, high = region["interval"]["d_n"]
    energies = f"{region['energy']:.0f}, {region['energy_noise']:.1f}, {region['energy_at_centre']:.0f}"
    return {
        "the estimate: d_n, d_t": f"{found['d_n']:.1f}, {found['d_t']:.1f}",
        "k_bend, k_stretch, k_friction": f"{found['k_bend']:.2f}, {found['k_stretch']:.3f}, {found['k_friction']:.2f}",
        "90 % interval of d_n": f"{low:.1f} to {high:.1f}",
        "width, 0 = the widest of five": rounded(region.get("width"), 0),  # none of cloth without a mesh of its own
        "`E_fit`, px^2: estimate, its noise, centre of the box": energies,
    }


def rounded(value: float | None, digits: int) -> str:
    return "" if value is None else f"{value:.{digits}f}"


def heading(seed: int) -> str:
    """Of which version, of which day, on which machine."""
    folder = Path(__file__).parent
    commit = subprocess.run(["git", "-C", str(folder), "describe", "--always", "--dirty"], stdout=subprocess.PIPE, text=True)
    version = f"doublet {d.__version__} ({commit.stdout.strip() or 'no repository'})"
    return f"{version}, {datetime.date.today():%Y-%m-%d}, {os.cpu_count()} cores ({processor()}), seed {seed}:"


def processor() -> str:
    info = Path("/proc/cpuinfo")
    named = re.search(r"model name\s*: (.*)", info.read_text(encoding="utf-8")) if info.exists() else None
    return named.group(1) if named else platform.processor() or platform.machine()


def table(columns: dict[str, dict[str, str]]) -> str:
    lines = [["", *columns], ["---"] * (len(columns) + 1)]
    rows = dict.fromkeys(row for cells in columns.values() for row in cells)
    lines += [[row, *(cells.get(row, "") for cells in columns.values())] for row in rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def between_marks(page: str, text: str) -> str:
    before, start, rest = page.partition(MARKS[0])
    _, end, after = rest.partition(MARKS[1])
    if not (start and end):
        raise SystemExit(f"results.py: expected {MARKS[0]} and {MARKS[1]} in the page, found neither or one")
    return f"{before}{start}\n{text}{end}{after}"


if __name__ == "__main__":
    sys.exit(main())
