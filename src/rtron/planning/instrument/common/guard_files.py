"""How the guard joins the launch, so that roslaunch starts it with no package to be found.

roslaunch looks a node's executable up in the packages it knows itself, whatever `<env>` the node
has. So the guard is a `launch-prefix` of a node that is installed wherever roslaunch is, rosout;
the prefix does not run what it prefixes.
"""

import shlex
import sys
from collections.abc import Sequence

from rtron.vocabulary import GUARD_NODE

GUARD_COMMAND = (sys.executable, "-m", "rtron", "guard")
GUARD_SCRIPT = "guard"
PLAN_FILE = "rtron.yaml"


def guard_element(folder: str) -> tuple[str, ...]:
    """Return the lines that start the guard's script in `folder`, beside the launch file.

    Standing first and in the root namespace, it inherits no remap, parameter or machine.
    """
    prefix = f"""launch-prefix='"$(dirname)/{folder}/{GUARD_SCRIPT}"'"""
    return (
        "<!-- The guard. rosout is only the package that roslaunch always finds:",
        f"     {GUARD_SCRIPT} does not run it. -->",
        f'<node pkg="rosout" type="rosout" name="{GUARD_NODE.strip("/")}" ns="/" {prefix}',
        '      respawn="true" output="screen"/>',
    )


def guard_script(command: Sequence[str]) -> str:
    """Return the script that runs the guard in place of the command it is given."""
    return (
        "#!/bin/sh\n"
        "# A launch-prefix: the command behind it is not run.\n"
        f'exec {shlex.join(command)} --plan "${{0%/*}}/{PLAN_FILE}"\n'
    )
