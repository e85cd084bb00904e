"""The command `doublet`."""

from .program import main as main
