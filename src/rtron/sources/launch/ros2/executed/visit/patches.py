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

from .event_patches import EventPatches
from .locations import LOCATION_ATTRIBUTE, caller_location
from .process_stub import start_nothing
from .recorder import LaunchRecorder
from .visit_record import VisitRecord

Thing: TypeAlias = Any
Method: TypeAlias = Callable[..., Any]


class _NullNode:
    """A ROS node that is not there: whatever is asked of it, it is nothing too."""

    def __getattr__(self, name: str) -> "_NullNode":
        return self

    def __call__(self, *_: object, **__: object) -> "_NullNode":
        return self

    def shutdown(self) -> None:
        """Do nothing: nothing runs."""


def patch_launch(record: VisitRecord, root: str) -> None:
    """Replace what starts processes, asks ROS, runs commands or waits; record what would start.

    Raise AttributeError for a launch library that does these in another way.
    """
    _replace_attribute(launch.actions.execute_local, "async_execute_process", start_nothing)
    _replace_attribute(launch_ros.ros_adapters, "ROSAdapter", _NullNode)
    recorder, event_patches = LaunchRecorder(record, root), EventPatches(record)
    for cls in (launch.Action, launch_ros.descriptions.ComposableNode):
        _wrap_method(cls, "__init__", _record_location)
    _wrap_method(launch_ros.actions.Node, "__init__", recorder.count_arguments)
    _wrap_method(launch.actions.ExecuteLocal, "execute", recorder.execute_process)
    _wrap_method(launch_ros.actions.LoadComposableNodes, "execute", recorder.execute_load)
    _wrap_method(launch.actions.DeclareLaunchArgument, "execute", recorder.execute_declare)
    _wrap_method(launch.actions.IncludeLaunchDescription, "execute", recorder.execute_include)
    parameters = launch_ros.parameter_descriptions.ParameterFile
    _wrap_method(parameters, "evaluate", recorder.evaluate_parameter_file)
    _wrap_method(launch.actions.EmitEvent, "execute", event_patches.execute_emit)
    _wrap_method(launch.actions.RegisterEventHandler, "execute", event_patches.execute_register)
    _wrap_method(launch.actions.TimerAction, "handle", event_patches.handle_timer)
    timer = getattr(launch_ros.actions, "RosTimer", None)
    if timer is not None:
        timer._wait_to_fire_event = launch.actions.TimerAction._wait_to_fire_event  # noqa: SLF001
    _patch_substitutions(record)


def _patch_substitutions(record: VisitRecord) -> None:
    from .substitution_patches import SubstitutionPatches  # noqa: PLC0415 - after the libraries are there

    patches = SubstitutionPatches(record)
    _wrap_method(launch.LaunchContext, "perform_substitution", patches.perform_any)
    for module, name, replacement in (
        (launch.substitutions, "Command", patches.perform_command),
        (launch.substitutions, "AnonName", patches.perform_anon_name),
        (launch.substitutions, "FindExecutable", patches.perform_or_name("name")),
        (launch_ros.substitutions, "ExecutableInPackage", patches.perform_or_name("executable")),
        (launch.substitutions, "PythonExpression", patches.perform_decision),
        (launch.substitutions, "EqualsSubstitution", patches.perform_decision),
        (launch.substitutions, "NotEqualsSubstitution", patches.perform_decision),
    ):
        cls = getattr(module, name, None)
        if cls is not None:
            _wrap_method(cls, "perform", replacement)


def _replace_attribute(module: Thing, name: str, replacement: object) -> None:
    """Replace what a module has; raise AttributeError where it has no such thing."""
    getattr(module, name)
    setattr(module, name, replacement)


def _wrap_method(cls: Thing, name: str, replacement: Method) -> None:
    """Replace a method; the replacement gets the one that was there first."""
    original = getattr(cls, name)

    @functools.wraps(original)
    def method(self: Thing, *args: object, **kwargs: object) -> object:
        return replacement(original, self, *args, **kwargs)

    setattr(cls, name, method)


def _record_location(original: Method, thing: Thing, *args: object, **kwargs: object) -> object:
    """Remember where something is made."""
    with suppress(AttributeError):  # a class with slots keeps no location
        setattr(thing, LOCATION_ATTRIBUTE, caller_location())
    return original(thing, *args, **kwargs)
