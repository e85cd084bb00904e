#!/usr/bin/env python3
"""Goes through the Dockerfile without a container runtime: every stage is a chroot that begins as a copy of a Debian 12.

sudo scripts/try-dockerfile.py FOLDER [WORD...]    # FOLDER gets the chroots; WORD...: for the last stage's ENTRYPOINT

Needs root, debootstrap, tens of minutes and 6 GB. What it knows: FROM, WORKDIR, ENV, COPY, RUN, ENTRYPOINT.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PATH = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
#: Of this machine's environment.
KEPT = ("http_proxy", "https_proxy", "no_proxy", "HTTP_PROXY", "HTTPS_PROXY", "NO_PROXY", "CMAKE_BUILD_PARALLEL_LEVEL")
MIRROR = "http://deb.debian.org/debian"


def run(*command, **options) -> None:
    print("+", *command, flush=True)
    subprocess.run([str(c) for c in command], check=True, **options)


def instructions(text: str) -> list[tuple[str, str]]:
    lines = "\n".join(line for line in text.splitlines() if not line.startswith("#")).replace("\\\n", " ").splitlines()
    return [(line.split(maxsplit=1)[0], line.split(maxsplit=1)[1]) for line in lines if line.strip()]


@contextmanager
def mounted(root: Path):
    """With /proc and /dev, and the resolver and certificates of this machine."""
    for name in ("etc/resolv.conf", "etc/ssl/certs/ca-certificates.crt", "etc/pip.conf"):
        if Path("/", name).exists():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(Path("/", name), root / name)
    try:
        for name in ("proc", "dev"):
            run("mount", "--bind", f"/{name}", root / name)
        yield
    finally:
        for name in ("dev", "proc"):
            subprocess.run(["umount", str(root / name)], check=False)


class Stage:
    def __init__(self, root: Path):
        self.root, self.folder, self.variables = root, "/", {}
        self.entry: list[str] = []

    def execute(self, *command: str) -> None:
        """In the chroot, in WORKDIR, with ENV."""
        kept = {name: os.environ[name] for name in KEPT if name in os.environ}
        variables = {"PATH": PATH, "LANG": "C.UTF-8", **kept, **self.variables}
        with mounted(self.root):
            run("chroot", self.root, "sh", "-c", f'cd {self.folder} && exec "$@"', "sh", *command, env=variables)

    def place(self, name: str) -> Path:
        return self.root / (Path(self.folder) / name).relative_to("/")


def ignored() -> list[str]:
    lines = (ROOT / ".dockerignore").read_text(encoding="utf-8").split()
    return [f"--exclude={line.removeprefix('**/') if '**' in line else './' + line}" for line in lines]


def copy(stage: Stage, stages: dict[str, Stage], words: list[str]) -> None:
    source = ROOT
    if words[0].startswith("--from="):
        source = stages[words.pop(0).removeprefix("--from=")].root
    target = stage.place(words[-1])
    target.mkdir(parents=True, exist_ok=True)
    for word in words[:-1]:
        path = source / word.lstrip("/")
        if path == ROOT:  # the whole tree, as .dockerignore leaves it
            pack = subprocess.Popen(["tar", "-C", ROOT, *ignored(), "-c", "."], stdout=subprocess.PIPE)
            run("tar", "-C", target, "-x", stdin=pack.stdout)
        elif path.is_dir():
            shutil.copytree(path, target, dirs_exist_ok=True)
        else:
            shutil.copy(path, target)


def main(folder: Path, words: list[str]) -> None:
    base, stages, stage = folder / "debian-12", {}, None
    if not base.exists():
        run("debootstrap", "--variant=minbase", "bookworm", base, MIRROR)
    for name, text in instructions((ROOT / "Dockerfile").read_text(encoding="utf-8")):
        if name == "FROM":
            image, _, alias = text.partition(" AS ")
            assert image == "debian:12", image
            root = folder / f"stage-{alias or 'last'}"
            run("rm", "-rf", "--one-file-system", root)
            run("cp", "-a", base, root)
            stage = stages[alias] = Stage(root)
        elif name == "WORKDIR":
            stage.folder = text
            stage.place(".").mkdir(parents=True, exist_ok=True)
        elif name == "ENV":
            key, _, value = text.partition("=")
            stage.variables[key] = value
        elif name == "COPY":
            copy(stage, stages, text.split())
        elif name == "RUN":
            stage.execute("sh", "-c", text)
        elif name == "ENTRYPOINT":
            stage.entry = json.loads(text)
        else:
            raise SystemExit(f"{name}: this script does not know it")
    stage.execute(*stage.entry, *words)


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve(), sys.argv[2:] or ["--version"])
