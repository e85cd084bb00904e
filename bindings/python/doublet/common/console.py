"""What the user sees while stages run: progress bars on a terminal, plain lines elsewhere. Everything goes to stderr."""

from __future__ import annotations

import sys
import time

from .. import _doublet


class Console:
    """Hands out a `Context` whose progress and log are shown."""

    def __init__(self, threads: int = 0, stream=None, quiet: bool = False, verbose: bool = False):
        self.threads = threads
        self.stream = stream or sys.stderr
        self.quiet = quiet
        self.verbose = verbose
        self.bars = self.stream.isatty() and not quiet
        self._name = None
        self.note = ""  # the last line of what runs, or ran
        self._bar = None
        self._quarter = 0
        self._started = 0.0

    def context(self) -> _doublet.Context:
        return _doublet.Context(progress=self.progress, log=self.log, threads=self.threads)

    def say(self, line: str) -> None:
        if self.quiet:
            return
        if self._bar is not None:
            self._bar.write(line, file=self.stream)
        else:
            print(line, file=self.stream, flush=True)

    def announce(self, line: str) -> None:
        """What stands between stages: their bars are over."""
        self.finish()
        self.say(line)

    def log(self, line: str) -> None:
        """What a stage says: beside its progress, and to the screen if asked for."""
        if self._name and line.startswith(f"{self._name}: "):
            self.note = line.removeprefix(f"{self._name}: ")
        if self.verbose:
            self.say(line)

    def progress(self, name: str, fraction: float) -> None:
        if name != self._name:
            self.finish()
            self._start(name)
        if self._bar is not None:
            self._bar.set_postfix_str(self.note, refresh=False)
            self._bar.update(max(0.0, round(100 * fraction, 1) - self._bar.n))
        elif not self.quiet and int(4 * fraction) > self._quarter:
            self._quarter = int(4 * fraction)
            note = f" ({self.note})" if self.note else ""
            self.say(f"  {name}: {25 * self._quarter} % after {time.monotonic() - self._started:.0f} s{note}")

    def finish(self) -> None:
        if self._bar is not None:
            self._bar.close()
        self._bar = self._name = None

    def _start(self, name: str) -> None:
        self._name, self.note, self._quarter, self._started = name, "", 0, time.monotonic()
        if self.bars:
            from tqdm import tqdm  # half as long to load as NumPy, and not needed without a terminal

            layout = "{desc:<28}{percentage:3.0f}%|{bar}| {elapsed}<{remaining}{postfix}"
            self._bar = tqdm(total=100.0, desc=name, file=self.stream, bar_format=layout, leave=False)
