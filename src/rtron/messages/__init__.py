"""What policies need of a message: velocities, stamps, and expressions over its fields.

Messages are bytes as they travel: ROS 1 with the length in front, CDR with its header in front.
Nothing here makes code out of a definition, since definitions come from strangers.
"""

from rtron.messages.common.definition import Definition, Field
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.common.definition_registry import DefinitionRegistry
from rtron.messages.common.encoding import Encoding
from rtron.messages.common.stamp import stamp_reader
from rtron.messages.common.velocity import VELOCITY_TYPES, VelocityCodec, velocity_codec
from rtron.messages.expressions.condition import Condition
from rtron.messages.expressions.evaluator import MessageEvaluator, check_expression

__all__ = [
    "VELOCITY_TYPES",
    "Condition",
    "Definition",
    "DefinitionRegistry",
    "Encoding",
    "Field",
    "MessageEvaluator",
    "VelocityCodec",
    "check_expression",
    "parse_definition",
    "stamp_reader",
    "velocity_codec",
]
