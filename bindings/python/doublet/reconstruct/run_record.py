"""run.json: what was run, on what, with which options, how long it took; and from it, what need not run again."""

from __future__ import annotations

import json
import resource
import time
from contextlib import contextmanager
from pathlib import Path

from .._doublet import __version__
from ..common.files import hash_files, write_json

KINDS = {"seconds": (int, float), "peak_memory_mb": (int, float), "version": (str,), "peak_memory_scope": (str,)}
PLAIN = (int, float, str, list, dict, type(None))  # bool is an int
FORMAT = 1  # of run.json; a file without one is of 1


class PeakMemory:
    """Peak resident memory of a stretch of this process. Linux resets its high-water mark on request; where it may not be
    reset the number is the peak since the process started, and `scope` says so."""

    def __init__(self):
        try:
            Path("/proc/self/clear_refs").write_text("5")
            self.scope = "stage"
        except OSError:
            self.scope = "process"

    def megabytes(self) -> float:
        if self.scope == "stage":
            for line in Path("/proc/self/status").read_text().splitlines():
                if line.startswith("VmHWM:"):
                    return round(int(line.split()[1]) / 1024, 1)
        return round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, 1)


def is_entry(entry) -> bool:
    """Has it the parts of a stage's entry? What is in its summary is looked at by who shows it."""
    if not isinstance(entry, dict) or entry.get("state") not in ("running", "done"):
        return False
    parts = {part: entry.get(part, {}) for part in ("options", "inputs", "outputs", "summary")}
    names = {**parts["inputs"], **parts["outputs"]}.values() if all(isinstance(p, dict) for p in parts.values()) else [None]
    return (
        all(isinstance(name, str) for name in names)
        and all(isinstance(entry.get(key, kind[0]()), kind) for key, kind in KINDS.items())
        and all(isinstance(value, PLAIN) for value in parts["summary"].values())
        and {"options", "inputs"} <= entry.keys()
        and (entry["state"] == "running" or {"outputs", "summary", "seconds", "peak_memory_mb"} <= entry.keys())
    )


class RunRecord:
    """The record of one OUT folder. A stage is up to date if its outputs exist and its options, inputs and the version have not
    changed since they were written; outputs that this program did not write (made by another, or edited) are kept."""

    def __init__(self, out: Path):
        self.out = Path(out)
        self.path = self.out / "run.json"
        self.data = {"format": FORMAT, "doublet": __version__, "stages": {}}
        if self.path.exists():
            try:
                self.data = json.loads(self.path.read_text(encoding="utf-8"))
            except (RecursionError, ValueError) as error:
                raise RuntimeError(f"{self.path} is not valid JSON ({error}); delete it to start afresh") from error
            if not isinstance(self.data, dict) or not isinstance(self.data.setdefault("stages", {}), dict):
                raise RuntimeError(f"{self.path}: expected an object with 'stages', found another; delete it to start afresh")
            if (found := self.data.setdefault("format", FORMAT)) != FORMAT:
                raise RuntimeError(
                    f"{self.path}: expected format {FORMAT}, found {repr(found)[:40]}, of another version of doublet"
                )
            if not isinstance(self.data.get("session", ""), str):
                raise RuntimeError(f"{self.path}: expected 'session' to be a folder, found another; delete it to start afresh")
            # An entry that something else wrote is none.
            self.data["stages"] = {name: entry for name, entry in self.data["stages"].items() if is_entry(entry)}
        self._hashes: dict[tuple, str] = {}

    def save(self) -> None:
        write_json(self.path, self.data)

    def hash(self, path: Path) -> str:
        path = Path(path)
        stamp = path.stat()
        key = (str(path), stamp.st_mtime_ns, stamp.st_size)
        if path.is_dir() or key not in self._hashes:
            self._hashes[key] = hash_files(path)
        return self._hashes[key]

    def summary(self, name: str) -> dict:
        """The numbers of a stage; empty if it did not run."""
        return self.data["stages"].get(name, {}).get("summary", {})

    def refuse_summary(self, name: str, error: Exception) -> None:
        """For who found something else than numbers there."""
        raise RuntimeError(
            f"{self.path}: {name}: expected a summary of numbers, found others ({error}); delete it to start afresh"
        )

    def is_done(self, name: str) -> bool:
        return self.data["stages"].get(name, {}).get("state") == "done"

    def foreign_outputs(self, name: str, outputs) -> list[str]:
        """Outputs that exist but are not what this program last wrote."""
        entry = self.data["stages"].get(name, {})
        if entry.get("state") == "running":
            return []
        written = entry.get("outputs", {})
        return [o for o in outputs if (self.out / o).exists() and written.get(o) != self.hash(self.out / o)]

    def reason_to_run(self, name: str, inputs: dict[str, str], options: dict, outputs) -> str:
        """Why the stage must run, in words; empty if it is up to date."""
        entry = self.data["stages"].get(name)
        if entry is None:
            return "first run"
        if entry["state"] != "done":
            return "the last run was stopped here"
        missing = [o for o in outputs if not (self.out / o).exists()]
        if missing:
            return f"{missing[0]} is missing"
        if entry.get("version") != __version__:
            return f"made by version {entry.get('version')}"
        changed = [k for k in {**options, **entry["options"]} if entry["options"].get(k) != options.get(k)]
        if changed:
            return f"option {changed[0]} changed from {entry['options'].get(changed[0])} to {options.get(changed[0])}"
        changed = [k for k in {**inputs, **entry["inputs"]} if entry["inputs"].get(k) != inputs.get(k)]
        return f"{sorted(changed)[0]} changed" if changed else ""

    @contextmanager
    def running(self, name: str, inputs: dict[str, str], options: dict, outputs):
        """Measures and records the stage that runs inside; yields a dict for its summary."""
        entry = {"state": "running", "version": __version__, "options": options, "inputs": inputs, "outputs": {}}
        self.data["doublet"] = __version__
        self.data["stages"][name] = entry
        self.save()
        memory, start, summary = PeakMemory(), time.monotonic(), {}
        yield summary
        entry["seconds"] = round(time.monotonic() - start, 2)
        entry["peak_memory_mb"] = memory.megabytes()
        entry["peak_memory_scope"] = memory.scope
        entry["summary"] = summary
        entry["outputs"] = {o: self.hash(self.out / o) for o in outputs}
        entry["state"] = "done"
        self.save()
