"""The command `doublet`."""

from __future__ import annotations

import argparse
import signal
import sys
from contextlib import suppress

from .._doublet import __version__
from .commands import register
from .parsing import CommandParser
from .signals import stopped_by_signals


def build_parser(command: str = "") -> argparse.ArgumentParser:
    """Of all commands; if `command` is one, it may lack others."""
    parser = argparse.ArgumentParser(prog="doublet", description="Animatable doubles of people in loose clothing, from video.")
    parser.add_argument("--version", action="version", version=__version__)
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND", parser_class=CommandParser)
    register(commands, command)
    return parser


def resume_hint(parsed) -> str:
    """After a command that was stopped."""
    return getattr(parsed, "when_stopped", "what is complete stays, the same command goes on from there")


def is_no_memory(error: Exception) -> bool:
    """Also TBB's words, in Embree and OpenCV, where there is no room for the stack of a thread."""
    return isinstance(error, MemoryError) or str(error).startswith("pthread_create has failed")


def no_memory(parsed, error: Exception) -> str:
    said = str(error)
    found = f"({said[0].lower()}{said[1:]})" if said and said != "std::bad_alloc" else ""
    return f"expected more memory than this process may have {found}; {resume_hint(parsed)}".replace(" ;", ";")


def main(arguments=None) -> int:
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    parsed = build_parser(arguments[0] if arguments else "").parse_args(arguments)
    try:
        with stopped_by_signals():
            return parsed.run(parsed) or 0
    except KeyboardInterrupt as stop:
        with suppress(OSError):  # of a terminal that is gone
            print(f"doublet: stopped; {resume_hint(parsed)}", file=sys.stderr)
        return getattr(stop, "status", 128 + signal.SIGINT)
    except BrokenPipeError:
        return 1
    except Exception as error:
        if parsed.debug:
            raise
        if is_no_memory(error):
            error = RuntimeError(no_memory(parsed, error))
        expected = isinstance(error, (RuntimeError, OSError, ValueError))
        if isinstance(error, OSError) and error.filename and error.strerror:
            error = f"{error.filename}: {error.strerror}"
        text = str(error) if expected else f"internal error: {type(error).__name__}: {error} (--debug shows where)"
        print(f"doublet: {' '.join(text.split())}", file=sys.stderr)
        return 1
