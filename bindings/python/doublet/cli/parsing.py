"""The parser of a command: folders and options in any order, a short help and a long one."""

from __future__ import annotations

import argparse

from ..common.renamed import current_flags


class CommandParser(argparse.ArgumentParser):
    """`intermixed`: of a command with any number of folders, which may stand on both sides of an option."""

    def __init__(self, *arguments, intermixed: bool = False, **options):
        super().__init__(*arguments, **options)
        self.intermixed = intermixed

    def parse_known_args(self, args=None, namespace=None):
        args = args and current_flags(args)
        if not self.intermixed:
            return super().parse_known_args(args, namespace)
        self.intermixed = False  # which before Python 3.12 calls this again
        try:
            return self.parse_known_intermixed_args(args, namespace)
        finally:
            self.intermixed = True


class HelpAll(argparse.Action):
    """Shows the help of the flags that --help leaves out, too."""

    def __call__(self, parser, namespace, values, option_string=None):
        for action, text in self.const:
            action.help = text
        for group in parser._action_groups:
            group.description = getattr(group, "whole_description", group.description)
        parser.print_help()
        parser.exit()


def shorten_help(parser: argparse.ArgumentParser, shown) -> None:
    """Leaves --help with the options that `shown` names, and adds --help-all."""
    left_out = []
    for group in parser._action_groups:
        options = [action for action in group._group_actions if "." in action.dest]
        hidden = [action for action in options if action.dest not in shown]
        left_out += [(action, action.help) for action in hidden]
        for action in hidden:
            action.help = argparse.SUPPRESS
        if options and len(hidden) == len(options):
            group.whole_description, group.description = group.description, argparse.SUPPRESS
    parser.add_argument("--help-all", action=HelpAll, nargs=0, const=left_out, help="show every option of every stage, and exit")
