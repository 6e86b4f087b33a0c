"""The limits of motion that can be changed while the app runs: parameters of what moves it."""

import re
from collections.abc import Mapping

from rtron.findings.app_facts import AppFacts
from rtron.findings.inventory.commands import AppCommands
from rtron.findings.inventory.doors import doors
from rtron.vocabulary import NodeParameter
from rtron.vocabulary.inventory import Command, Means, Mover, Thing

_LIMIT = re.compile(
    r"max_?(?:vel|speed|lin|ang|rot|acc|rpm|throttle|steer|trans)|(?:vel|velocity|speed)_(?:limit|max)"
    r"|max_\w{0,40}(?:velocity|speed)|^(?:[\w.]+\.)?(?:v[xy]|wz|v_linear|v_angular)_max|desired_linear_vel|scale_(?:linear|angular)|speed_scaling",
    re.IGNORECASE,
)
_RECONFIGURE = "dynamic_reconfigure/Reconfigure"
_LIMITERS = frozenset(
    {"nav2_velocity_smoother", "nav2_controller", "nav2_collision_monitor"}
    | {"joint_trajectory_controller"}
)
"""Packages whose nodes have limits that can be set, also where the app leaves their defaults.

A controller of trajectories takes its gains and tolerances anew at each update, too.
"""


def limits(app: AppFacts, commands: AppCommands) -> Mover | None:
    """Return the parameters that bound motion, as one line; None where none can be changed.

    In ROS 2 each parameter can be set unless its node refuses, in ROS 1 those of a node with
    dynamic_reconfigure.
    """
    movers = _movers(commands)
    settable = _with_reconfigure(app) if app.graph.ros == 1 else movers - _once_configured(commands)
    loaded = _loaded_planners(app)
    names = {
        each.node: f"{each.node}.{each.name}"
        for each in reversed(app.graph.parameters)
        if each.node in movers & settable and _is_limit(each) and _is_used(each, loaded)
    }
    tunable = _with_reconfigure(app) | {n.name for n in app.graph.nodes if n.package in _LIMITERS}
    names = {node: f"{node}/set_parameters" for node in sorted(tunable & movers)} | names
    if not names:
        return None
    found = tuple(
        Command(means=Means.PARAMETER, name=name, receivers=(node,)) for node, name in names.items()
    )
    return Mover(thing=Thing.LIMITS, commands=found, drivers=tuple(names), doors=doors(app))


def _movers(commands: AppCommands) -> frozenset[str]:
    """Return the nodes that send or obey a command of motion by topic."""
    last = [command for _, command in commands.last if command.means is Means.TOPIC]
    behind = [command for _, command in commands.forwarding.behind(last)]
    return frozenset(node for each in (*last, *behind) for node in (*each.senders, *each.receivers))


def _once_configured(commands: AppCommands) -> frozenset[str]:
    """Return the controllers of ros2_control: most read their limits when they are configured."""
    return frozenset(filter(commands.roles.is_controller, commands.app.nodes))


def _loaded_planners(app: AppFacts) -> dict[str, str]:
    """Return the local planner that each node loads (ROS wiki: move_base)."""
    parameters = (each for each in app.graph.parameters if each.name == "base_local_planner")
    return {each.node: str(each.value).rpartition("/")[2] for each in parameters}


def _is_limit(parameter: NodeParameter) -> bool:
    """Return whether a parameter bounds motion by its name, and counts when it is set."""
    return not parameter.read_once and _LIMIT.search(parameter.name) is not None


def _is_used(parameter: NodeParameter, loaded: Mapping[str, str]) -> bool:
    """Return whether a parameter is not of a planner that is not loaded."""
    planner = parameter.name.partition(".")[0]
    return not planner.endswith("PlannerROS") or loaded.get(parameter.node, planner) == planner


def _with_reconfigure(app: AppFacts) -> frozenset[str]:
    return frozenset(each.node for each in app.graph.services if each.type == _RECONFIGURE)
