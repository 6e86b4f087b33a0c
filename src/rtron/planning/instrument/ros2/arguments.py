"""What ends a guarded launch that is given other arguments than those it was read for.

XML and YAML are changed for the names, files and conditions that one set of arguments gives.
"""

import re
from importlib.resources import files
from pprint import pformat

from rtron.vocabulary import LaunchInput

CHECK_FILE = "arguments.launch.py"
"""The file's name, beside the copies; it comes first in the launch."""

_TEMPLATE = "arguments.py.in"
_PLACEHOLDER = re.compile(r"__(ARGUMENTS|ENVIRONMENT)__")


def arguments_text(choices: tuple[LaunchInput, ...]) -> str:
    """Return the launch file that refuses all but the values for which a launch was read."""
    template = files("rtron.planning.instrument.ros2").joinpath(_TEMPLATE).read_text()
    filled = {
        hole: {each.name: each.values for each in choices if each.environment is environment}
        for hole, environment in (("ARGUMENTS", False), ("ENVIRONMENT", True))
    }
    return _PLACEHOLDER.sub(
        lambda hole: pformat(filled[hole[1]], width=88, sort_dicts=False), template
    )
