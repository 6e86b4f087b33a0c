"""Runs a node that starts launch files, so that it finds their guarded copies.

`<env>` would do for packages alone. A script that looks beside itself has to run from its copy,
and roslaunch looks a node's executable up before any `<env>` counts; so this is a launch-prefix.
"""

import shlex
from collections.abc import Iterable, Mapping
from pathlib import Path

STARTER_SCRIPT = "starter"
OVERLAY_FOLDER = "overlay"


def starter_script(packages: Iterable[Path], programs: Mapping[Path, tuple[str, Path]]) -> str:
    """Return the script. `packages` lie below the overlay and come first for the node.

    `programs` maps each original script to its `package/type` and its copy below the overlay.
    catkin's own `lib/package/type`, which runs the original, is replaced as well.
    """
    path = ":".join(f'"$overlay"/{shlex.quote(str(package))}' for package in packages)
    return "\n".join(
        (
            "#!/bin/sh",
            "# A launch-prefix: the node behind it finds the guarded copies of launch files.",
            f'overlay=$(cd "${{0%/*}}/{OVERLAY_FOLDER}" && pwd -P) || exit 1',
            f'ROS_PACKAGE_PATH={path}"${{ROS_PACKAGE_PATH:+:$ROS_PACKAGE_PATH}}"',
            "export ROS_PACKAGE_PATH",
            "for word do",
            "  shift",
            *(line for item in programs.items() for line in _replacing(*item)),
            '  set -- "$@" "$word"',
            "done",
            'exec "$@"',
            "",
        )
    )


def _replacing(original: Path, program: tuple[str, Path]) -> tuple[str, ...]:
    named, copy = program
    put = f'word="$overlay"/{shlex.quote(str(copy))}'
    return (
        f'  if [ "$word" -ef {shlex.quote(str(original))} ]; then {put}; fi',
        f"  case $word in */lib/{shlex.quote(named)}) {put} ;; esac",
    )
