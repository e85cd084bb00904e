"""What a folder of results was made from; needs no room of the library."""

from __future__ import annotations

from pathlib import Path

from ..common.files import read_json


def recorded_session(out: Path) -> Path:
    """The session that OUT was made from."""
    path = Path(out) / "run.json"
    record = read_json(path) if path.exists() else {}
    if not isinstance(record, dict) or not isinstance(record.get("session", ""), str):
        raise RuntimeError(f"{path}: expected an object with 'session', a folder, found another; delete it to start afresh")
    if "session" not in record:
        raise FileNotFoundError(f"{path} does not name a session; give it with --session")
    if "\ufffd" in record["session"]:
        raise RuntimeError(f"{path}: expected the session's name in UTF-8, found '{record['session']}'; give it with --session")
    return Path(record["session"])
