"""run.json: what was run, on what, with which options, how long it took; and from it, what need not run again."""

from __future__ import annotations

import json
import resource
import time
from contextlib import contextmanager
from pathlib import Path

from .._doublet import __version__
from ..common.files import hash_files, write_json

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
                raise RuntimeError(f"{self.path}: expected format {FORMAT}, found {found!r}, of another version of doublet")
            # An entry that something else wrote is none.
            self.data["stages"] = {name: e for name, e in self.data["stages"].items() if isinstance(e, dict) and "state" in e}
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
