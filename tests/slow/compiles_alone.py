"""Compiles every header and source by itself: python tests/slow/compiles_alone.py COMPILE_COMMANDS [FILE...]

COMPILE_COMMANDS is the compile_commands.json of a build folder without CMAKE_UNITY_BUILD; it need not have been built. A unity
build, which is what the package and the tests are, does not see a file that lacks an include: what came before it has it. A
header has the flags of a source of its folder, or else of its library. Exit status 1 if a file does not compile.
"""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: Other projects, with flags of their own, and what is of wheels alone.
APART = ("third_party/", "tests/consumer/", "viewer/", "cmake/")


def flags_of(commands: Path) -> dict[str, list[str]]:
    """The compiler and its flags for each source of the repository, without the object that it would write."""
    flags = {}
    for entry in json.loads(commands.read_text(encoding="utf-8")):
        source = os.path.relpath(entry["file"], ROOT)
        if source.startswith(("..", "build/")):
            continue
        words = shlex.split(entry["command"])
        if Path(words[0]).name == "ccache":
            del words[0]
        at = words.index("-o")
        flags.setdefault(source, [word for word in words[:at] + words[at + 2 :] if word not in ("-c", entry["file"])])
    return flags


def nearest(header: str, sources: list[str]) -> str:
    """The source whose flags a header has: the nearest one, or one that links everything."""
    own = [source for source in sources if source.split("/")[:1] == header.split("/")[:1] and "lanes_" not in source]
    if not own or header.startswith("tests/support/"):  # headers alone
        own = [source for source in sources if source.startswith("tests/reconstruct/")]
    return max(own, key=lambda source: len(os.path.commonpath([header, source])))


def compiles(file: str, flags: list[str]) -> str:
    """What the compiler says, nothing if all is well."""
    what = ["-include", file, "-x", "c++", os.devnull] if file.endswith(".h") else [file]
    done = subprocess.run([*flags, "-fsyntax-only", *what], cwd=ROOT, capture_output=True, text=True)
    return done.stderr.strip() or ("" if done.returncode == 0 else f"{file}: exit status {done.returncode}")


def files() -> list[str]:
    listed = subprocess.run(["git", "ls-files", "*.h", "*.cpp"], cwd=ROOT, capture_output=True, text=True, check=True)
    return [name for name in listed.stdout.split() if not name.startswith(APART)]


def main() -> int:
    flags = flags_of(Path(sys.argv[1]))
    wanted = sys.argv[2:] or files()
    missing = [name for name in wanted if name.endswith(".cpp") and name not in flags]
    for name in missing:
        print(f"{sys.argv[1]}: expected how {name} is compiled, found nothing")
    names = [name for name in wanted if name not in missing]
    sources = list(flags)
    failed = []
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        said = pool.map(lambda name: compiles(name, flags[name if name in flags else nearest(name, sources)]), names)
        for name, text in zip(names, said):
            if text:
                failed.append(name)
                print(f"== {name}\n{text}\n", flush=True)
    print(f"{len(names)} files compiled, each by itself: {len(failed)} did not" + "".join(f"\n  {name}" for name in failed))
    return 1 if failed or missing else 0


if __name__ == "__main__":
    sys.exit(main())
