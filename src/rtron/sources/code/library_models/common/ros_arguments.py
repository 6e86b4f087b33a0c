"""A program's words without those that are for ROS (rclcpp: remove_ros_arguments; roscpp)."""

from collections.abc import Iterable, Iterator

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments

_BEGIN, _END = "--ros-args", "--"


def without_remappings(words: av.Value) -> av.ListValue:
    """Return the words without ROS 1's remappings among them."""
    items, certain = av.items_of(words)
    return av.list_of(
        (item for item in items if ":=" not in av.text_with_holes(item)), certain=certain
    )


def remove_ros_arguments(_: AbstractMachine, __: object, arguments: Arguments) -> av.ListValue:
    """`remove_ros_arguments(argc, argv)`, rclpy's `remove_ros_args(args)`.

    Without what stands behind `--ros-args`.
    """
    items, certain = av.items_of(arguments.get(1) or arguments.value(0, "args"))
    return av.list_of(_outside_ros_arguments(items), certain=certain)


def _outside_ros_arguments(words: Iterable[av.Value]) -> Iterator[av.Value]:
    is_for_ros = False
    for word in words:
        text = av.text_with_holes(word)
        if not is_for_ros and text != _BEGIN:
            yield word
        is_for_ros = text == _BEGIN or (is_for_ros and text != _END)


def write_without_remappings(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`ros::removeROSArgs(argc, argv, words)`."""
    slot = arguments.slot(2)
    if slot is not None:
        machine.undo_log.set(*slot, without_remappings(arguments.value(1)))
    return av.NONE
