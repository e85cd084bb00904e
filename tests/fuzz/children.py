"""Calls that may kill the process, in child processes: what a call did, whatever it did."""

from __future__ import annotations

import mmap
import os
import resource
import signal
import threading
import time
from collections.abc import Callable
from pathlib import Path

CPU_SECONDS = 10  # for a call
SECONDS = 60  # for a call that waits: a busy machine stands still for a while, a deadlock for ever
TOO_LONG = {"SIGALRM": f"more than {SECONDS} s", "SIGPROF": f"more than {CPU_SECONDS} s of CPU"}
MEMORY = 768 << 20  # bytes more than at the start; threads' stacks count


def outcomes(count: int, call: Callable[[int], tuple[str, str]], keep_stderr: bool = False) -> list[tuple[str, str]]:
    """call(i) -> (kind, text) for each i, in a child that goes on until it dies, then in the next one from there. A call that
    kills it, or takes too long, is ("crash", how)."""
    results: list[tuple[str, str]] = []
    while len(results) < count:
        from_child, to_parent = os.pipe()
        wait_for_other_threads()
        child = os.fork()
        if child == 0:
            os.close(from_child)
            work(range(len(results), count), call, to_parent, keep_stderr)
        os.close(to_parent)
        with os.fdopen(from_child, "rb") as said:
            results += [tuple(line.decode(errors="replace").rstrip("\n").split("\t", 1)) for line in said]
        _, status = os.waitpid(child, 0)
        if len(results) < count:
            how = signal.Signals(os.WTERMSIG(status)).name if os.WIFSIGNALED(status) else f"exit {os.WEXITSTATUS(status)}"
            results.append(("crash", TOO_LONG.get(how, how)))
    return results


def wait_for_other_threads() -> None:
    """Returns when they all sleep. A fork copies locks as they are, and not the threads that would release them: a worker of
    TBB that falls asleep under a lock of its own leaves a child that waits for ever."""
    me = str(threading.get_native_id())
    while any(running(thread) for thread in Path("/proc/self/task").iterdir() if thread.name != me):
        time.sleep(0.001)


def running(thread: Path) -> bool:
    try:
        return (thread / "stat").read_text().rpartition(")")[2].split()[0] != "S"
    except (FileNotFoundError, ProcessLookupError):  # ended meanwhile
        return False


def work(numbers: range, call, to_parent: int, keep_stderr: bool) -> None:
    """The child: never returns."""
    quiet = os.open(os.devnull, os.O_WRONLY)
    os.dup2(quiet, 1)
    if not keep_stderr:
        os.dup2(quiet, 2)
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.signal(signal.SIGPROF, signal.SIG_DFL)
    limit_memory()
    for number in numbers:
        signal.alarm(SECONDS)
        signal.setitimer(signal.ITIMER_PROF, CPU_SECONDS)
        try:
            kind, text = call(number)
        except BaseException as error:
            kind, text = "wrong", f"{type(error).__name__}: {error}"
        signal.alarm(0)
        signal.setitimer(signal.ITIMER_PROF, 0)
        os.write(to_parent, f"{kind}\t{' '.join(text.split())}\n".encode(errors="replace"))
    os._exit(0)


def limit_memory() -> None:
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    limit = pages * mmap.PAGESIZE + MEMORY
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
