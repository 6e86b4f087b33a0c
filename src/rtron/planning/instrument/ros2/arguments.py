"""What ends a guarded launch that is given other arguments than those it was read for.

XML and YAML are changed for the names, files and conditions that one set of arguments gives.
"""

import re
from importlib.resources import files
from pprint import pformat

from rtron.vocabulary import LaunchChoice

CHECK = "arguments.launch.py"
"""The file's name, beside the copies; it comes first in the launch."""

_TEMPLATE = "arguments.py.in"
_HOLE = re.compile(r"__(ARGUMENTS|ENVIRONMENT)__")


def arguments_text(choices: tuple[LaunchChoice, ...]) -> str:
    """Return the launch file that refuses all but the values for which a launch was read."""
    template = files("rtron.planning.instrument.ros2").joinpath(_TEMPLATE).read_text()
    filled = {
        hole: {each.name: each.values for each in choices if each.environment is environment}
        for hole, environment in (("ARGUMENTS", False), ("ENVIRONMENT", True))
    }
    return _HOLE.sub(lambda hole: pformat(filled[hole[1]], width=88, sort_dicts=False), template)
