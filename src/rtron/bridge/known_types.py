"""The types that are known on this machine to the bridge of a plan, for either ROS."""

from rtron.bridge.common.message_types import MessageTypes
from rtron.messages.ros1 import service_types as ros1
from rtron.messages.ros2 import installed_types as ros2
from rtron.vocabulary import Plan


def known_types(plan: Plan) -> MessageTypes:
    """Return the types that are known on this machine to the bridge of a plan."""
    find = ros1.find_interface_text if plan.ros == 1 else ros2.find_interface_text
    return MessageTypes(plan, find)
