"""What policies need of a message: velocities, stamps, and expressions over its fields.

Messages are bytes as they travel: ROS 1 with the length in front, CDR with its header in front.
Nothing here makes code out of a definition, since definitions come from strangers.
"""

from rtron.messages.condition import Condition
from rtron.messages.definition import Definition, Field
from rtron.messages.definition_text import parse_definition
from rtron.messages.definitions import Definitions
from rtron.messages.encoding import Encoding
from rtron.messages.judge import Judge, check_expression
from rtron.messages.stamp import stamp_reader
from rtron.messages.velocity import VELOCITY_TYPES, VelocityCodec, velocity_codec

__all__ = [
    "VELOCITY_TYPES",
    "Condition",
    "Definition",
    "Definitions",
    "Encoding",
    "Field",
    "Judge",
    "VelocityCodec",
    "check_expression",
    "parse_definition",
    "stamp_reader",
    "velocity_codec",
]
