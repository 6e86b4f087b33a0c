"""`rtron`, also as `python -m rtron`; Ctrl-C ends it without a word, from its first import on."""

import sys

_INTERRUPTED = 130
"""128 and the number of SIGINT, as shells have it."""


def main() -> None:
    """Run the command line."""
    try:
        from rtron.cli.main import main as run  # noqa: PLC0415 - Ctrl-C may come while this loads

        run()
    except KeyboardInterrupt:
        sys.exit(_INTERRUPTED)


if __name__ == "__main__":
    main()
