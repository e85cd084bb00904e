"""Signals that end a command, all in the same way."""

from __future__ import annotations

import signal
from contextlib import contextmanager

STOPPING = (signal.SIGINT, signal.SIGTERM)


class Stopped(KeyboardInterrupt):
    """A signal asked to stop."""

    def __init__(self, number: int):
        super().__init__(f"signal {number}")
        self.status = 128 + number  # as shells have it


@contextmanager
def stopped_by_signals():
    """Ctrl-C, SIGTERM, and SIGINT where a shell in the background has it ignored, all end the command in the same way."""

    def stop(number, frame):
        raise Stopped(number)

    try:
        before = {number: signal.signal(number, stop) for number in STOPPING}
    except ValueError:  # not the main thread: signals are somebody else's
        before = {}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, signal.SIG_DFL if handler is None else handler)
