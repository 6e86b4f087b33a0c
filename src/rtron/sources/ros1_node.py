"""What one ROS 1 node says about itself, as far as it answers."""

from dataclasses import dataclass, field, replace

from rtron.sources.live.ros1.process import Program, program_of
from rtron.sources.live.ros1.replies import Incoming, incoming, process_id
from rtron.wire.ros1.xmlrpc import ros_call

_LONGEST_FAULT = 300


@dataclass(frozen=True, slots=True)
class NodeAnswers:
    """A node's address, who sends it messages, what it runs, and why not all of it is known."""

    uri: str = ""
    incoming: tuple[Incoming, ...] = ()
    program: Program = field(default_factory=Program)
    fault: str = ""


def ask_node(uri: str, caller: str, timeout: float) -> NodeAnswers:
    """Ask a node; each of two calls may take `timeout` seconds. Does not raise."""
    answers = NodeAnswers(uri)
    try:
        links = incoming(ros_call(uri, "getBusInfo", caller, timeout=timeout))
        answers = replace(answers, incoming=links)
        pid = process_id(ros_call(uri, "getPid", caller, timeout=timeout))
        return replace(answers, program=program_of(uri, pid))
    except Exception as error:  # noqa: BLE001 - a stranger's answer must not end the scan
        return replace(answers, fault=str(error)[:_LONGEST_FAULT])
