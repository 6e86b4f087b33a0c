"""xacro without ROS: robot descriptions evaluated, nothing of them executed."""

from rtron.sources.xacro.descriptions import RobotDescriptions
from rtron.sources.xacro.element import XmlElement, parse_element, read_element, xml_text
from rtron.sources.xacro.evaluate import XacroResult, evaluate_xacro

__all__ = [
    "RobotDescriptions",
    "XacroResult",
    "XmlElement",
    "evaluate_xacro",
    "parse_element",
    "read_element",
    "xml_text",
]
