"""The environment of an app in source: what the user gives of it; nothing else counts.

A scan is the same on every machine: of the user's own environment only the folders of packages
count, and what `--env NAME` or `--env-all` asks for. The distribution is guessed from the
workspace where it is not given.
"""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.common.environment import LaunchEnvironment
from rtron.sources.workspace.distro_guess import DistroGuess, guess_distro

_INHERITED = ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH")
_DISTRO = "ROS_DISTRO"


def given_environment(assignments: Sequence[str], *, take_all: bool) -> dict[str, str]:
    """Return the variables that count: `NAME=VALUE`, or `NAME` with its value here.

    Raise InputError for one of another form, or that is not set.
    """
    names = os.environ if take_all else [name for name in _INHERITED if name in os.environ]
    return {name: os.environ[name] for name in names} | dict(map(_pair, assignments))


def _pair(assignment: str) -> tuple[str, str]:
    name, equals, value = assignment.partition("=")
    if not name or name.endswith(":"):
        help = "write --env NAME=VALUE, or --env NAME for your own value"
        raise InputError(f"what is --env {assignment}?", help=help)
    if equals:
        return name, value
    if name not in os.environ:
        raise InputError(f"{name} is not set here", help=f"give its value: --env {name}=VALUE")
    return name, os.environ[name]


def robot_environment(given: Mapping[str, str]) -> LaunchEnvironment:
    """Return the environment of a launch that is to run: its distribution is no guess.

    It is the one that was given, or else that of the ROS which is sourced here.
    """
    sourced = {_DISTRO: os.environ[_DISTRO]} if _DISTRO in os.environ else {}
    return LaunchEnvironment({**sourced, **given})


def launch_environment(
    given: Mapping[str, str], folders: Sequence[Path], ros: int
) -> tuple[LaunchEnvironment, DistroGuess | None]:
    """Return the environment of a launch, with a guess at its distribution where none is given."""
    guess = None if _DISTRO in given else guess_distro(folders, ros)
    return LaunchEnvironment({_DISTRO: guess.name, **given} if guess else given), guess
