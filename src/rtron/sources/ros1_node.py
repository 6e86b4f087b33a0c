"""What one ROS 1 node says about itself, as far as it answers."""

from dataclasses import dataclass, field, replace

from rtron.sources.live.ros1.process import NodeProgram, find_program
from rtron.sources.live.ros1.replies import IncomingConnection, parse_bus_info, parse_process_id
from rtron.wire.ros1.xmlrpc import ros_call

_MAX_ERROR_LENGTH = 300


@dataclass(frozen=True, slots=True)
class NodeReplies:
    """A node's address, who sends it messages, what it runs, and why not all of it is known."""

    uri: str = ""
    incoming: tuple[IncomingConnection, ...] = ()
    program: NodeProgram = field(default_factory=NodeProgram)
    error: str = ""


def query_node(uri: str, caller: str, timeout: float) -> NodeReplies:
    """Ask a node; each of two calls may take `timeout` seconds. Does not raise."""
    replies = NodeReplies(uri)
    try:
        connections = parse_bus_info(ros_call(uri, "getBusInfo", caller, timeout=timeout))
        replies = replace(replies, incoming=connections)
        pid = parse_process_id(ros_call(uri, "getPid", caller, timeout=timeout))
        return replace(replies, program=find_program(uri, pid))
    except Exception as error:  # noqa: BLE001 - a stranger's answer must not end the scan
        return replace(replies, error=str(error)[:_MAX_ERROR_LENGTH])
