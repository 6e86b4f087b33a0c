"""`ros2 rtron …`: the same commands as an extension of ros2cli."""

import sys
from argparse import REMAINDER, ArgumentParser, Namespace

from rtron.cli.command_registry import COMMANDS, GROUPS
from rtron.cli.main import main


class RtronCommand:
    """Find risky interactions between nodes, and guard them."""

    NAME = "rtron"
    EXTENSION_POINT_VERSION = "0.1"

    def add_arguments(self, parser: ArgumentParser, cli_name: str) -> None:
        """Take everything that follows; argcomplete completes the name of the command."""
        help = f"as of `rtron`; `{cli_name} COMMAND --help` describes a command"
        action = parser.add_argument("arguments", nargs=REMAINDER, metavar="COMMAND …", help=help)
        names = [name for table in (COMMANDS, GROUPS) for each in table.values() for name in each]
        vars(action)["completer"] = lambda **_: names

    def main(self, *, parser: ArgumentParser, args: Namespace) -> None:  # noqa: ARG002 - ros2cli's
        """Run the command line; it ends the process with its exit code."""
        sys.argv[:] = ["rtron", *args.arguments]
        main()
