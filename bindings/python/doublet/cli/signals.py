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
    """Ctrl-C, SIGTERM, SIGINT where a shell in the background has it ignored, and a terminal that is closed, unless nohup has
    that ignored, all end the command in the same way."""

    def stop(number, frame):
        if number == signal.SIGHUP:  # comes twice, from the shell and from the terminal
            signal.signal(number, signal.SIG_IGN)
        raise Stopped(number)

    heard = [*STOPPING, signal.SIGHUP] if signal.getsignal(signal.SIGHUP) == signal.SIG_DFL else STOPPING
    try:
        before = {number: signal.signal(number, stop) for number in heard}
    except ValueError:  # not the main thread: signals are somebody else's
        before = {}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, signal.SIG_DFL if handler is None else handler)
