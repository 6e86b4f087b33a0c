"""xacro without ROS: robot descriptions evaluated, nothing of them executed."""

from rtron.sources.xacro.robot_description import RobotDescriptions, XacroResult, evaluate_xacro
from rtron.sources.xacro.xml_element import (
    XmlElement,
    parse_element,
    read_element,
    shorten_description,
    xml_text,
)

__all__ = [
    "RobotDescriptions",
    "XacroResult",
    "XmlElement",
    "evaluate_xacro",
    "parse_element",
    "read_element",
    "shorten_description",
    "xml_text",
]
