"""What ends a guarded launch that is given other arguments than those it was read for.

XML and YAML are changed for the names, files and conditions that one set of arguments gives.
"""

from importlib.resources import files
from pprint import pformat

from rtron.vocabulary import LaunchChoice

CHECK = "arguments.launch.py"
"""The file's name, beside the copies; it comes first in the launch."""

_TEMPLATE = "arguments.py.in"


def arguments_text(choices: tuple[LaunchChoice, ...]) -> str:
    """Return the launch file that refuses all but the values for which a launch was read."""
    template = files("rtron.planning.instrument.ros2").joinpath(_TEMPLATE).read_text()
    for environment, hole in ((False, "__ARGUMENTS__"), (True, "__ENVIRONMENT__")):
        chosen = {c.name: c.values for c in choices if c.environment is environment}
        template = template.replace(hole, pformat(chosen, width=88, sort_dicts=False), 1)
    return template
