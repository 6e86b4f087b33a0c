"""What of launch and launch_ros is replaced, so that a visit starts nothing and waits for nothing.

Sources: docs.ros.org, launch and launch_ros; their classes' docstrings.
"""

import functools
from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypeAlias

import launch
import launch.actions.execute_local
import launch.substitutions
import launch_ros.actions
import launch_ros.descriptions
import launch_ros.parameter_descriptions
import launch_ros.ros_adapters
import launch_ros.substitutions

from .event_patches import Waiting
from .locations import KEY, called_from
from .process_stub import not_started
from .recorder import Recording
from .visit_record import Found

Thing: TypeAlias = Any
Method: TypeAlias = Callable[..., Any]


class _Nothing:
    """A ROS node that is not there: whatever is asked of it, it is nothing too."""

    def __getattr__(self, name: str) -> "_Nothing":
        return self

    def __call__(self, *_: object, **__: object) -> "_Nothing":
        return self

    def shutdown(self) -> None:
        """Do nothing: nothing runs."""


def replace_all(found: Found, root: str) -> None:
    """Replace what starts processes, asks ROS, runs commands or waits; record what would start.

    Raise AttributeError for a launch library that does these in another way.
    """
    _instead(launch.actions.execute_local, "async_execute_process", not_started)
    _instead(launch_ros.ros_adapters, "ROSAdapter", _Nothing)
    recording, waiting = Recording(found, root), Waiting(found)
    for cls in (launch.Action, launch_ros.descriptions.ComposableNode):
        _around(cls, "__init__", _placing)
    _around(launch_ros.actions.Node, "__init__", recording.counting)
    _around(launch.actions.ExecuteLocal, "execute", recording.executing)
    _around(launch_ros.actions.LoadComposableNodes, "execute", recording.loading)
    _around(launch.actions.DeclareLaunchArgument, "execute", recording.declaring)
    _around(launch.actions.IncludeLaunchDescription, "execute", recording.including)
    parameters = launch_ros.parameter_descriptions.ParameterFile
    _around(parameters, "evaluate", recording.evaluating)
    _around(launch.actions.EmitEvent, "execute", waiting.emitting)
    _around(launch.actions.RegisterEventHandler, "execute", waiting.registering)
    _around(launch.actions.TimerAction, "handle", waiting.firing)
    timer = getattr(launch_ros.actions, "RosTimer", None)
    if timer is not None:
        timer._wait_to_fire_event = launch.actions.TimerAction._wait_to_fire_event  # noqa: SLF001
    _replace_substitutions(found)


def _replace_substitutions(found: Found) -> None:
    from .substitution_patches import Substituting  # noqa: PLC0415 - after the libraries are there

    own = Substituting(found)
    _around(launch.LaunchContext, "perform_substitution", own.performing)
    for module, name, replacement in (
        (launch.substitutions, "Command", own.command),
        (launch.substitutions, "AnonName", own.anonymous),
        (launch.substitutions, "FindExecutable", own.named("name")),
        (launch_ros.substitutions, "ExecutableInPackage", own.named("executable")),
        (launch.substitutions, "PythonExpression", own.deciding),
        (launch.substitutions, "EqualsSubstitution", own.deciding),
        (launch.substitutions, "NotEqualsSubstitution", own.deciding),
    ):
        cls = getattr(module, name, None)
        if cls is not None:
            _around(cls, "perform", replacement)


def _instead(module: Thing, name: str, replacement: object) -> None:
    """Replace what a module has; raise AttributeError where it has no such thing."""
    getattr(module, name)
    setattr(module, name, replacement)


def _around(cls: Thing, name: str, replacement: Method) -> None:
    """Replace a method; the replacement gets the one that was there first."""
    original = getattr(cls, name)

    @functools.wraps(original)
    def method(self: Thing, *args: object, **kwargs: object) -> object:
        return replacement(original, self, *args, **kwargs)

    setattr(cls, name, method)


def _placing(original: Method, thing: Thing, *args: object, **kwargs: object) -> object:
    """Remember where something is made."""
    with suppress(AttributeError):
        setattr(thing, KEY, called_from())
    return original(thing, *args, **kwargs)
