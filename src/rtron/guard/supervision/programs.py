"""How the guard and the supervisor are started: small processes that share what they import.

A program is `python -c` with the module path of the process that starts it: it runs the same code,
whatever lies in the folder where it is started, and needs nothing of the command line.
"""

import os
import sys
from collections.abc import Sequence

_CODE = (
    "import sys; sys.path[:] = sys.argv[3:]; "
    "from rtron.guard.supervision.{role} import main; main(sys.argv[2])"
)
GUARD = "guarding"
SUPERVISOR = "supervising"
BACKUP_SUPERVISOR = "standing_in"
LINK = "linking"


def command(role: str, descriptors: Sequence[int]) -> list[str]:
    """Return the command of a program that is given open files."""
    code = _CODE.format(role=role)
    numbers = ",".join(map(str, descriptors))
    return [sys.executable, "-c", code, f"rtron-{role}", numbers, *filter(None, sys.path)]


def open_descriptors(numbers: str) -> list[int]:
    """Return the open files that this program was given; it does not hand them on by itself."""
    opened = [int(number) for number in numbers.split(",")]
    for descriptor in opened:
        os.set_inheritable(descriptor, False)  # noqa: FBT003 - positional only
    return opened
