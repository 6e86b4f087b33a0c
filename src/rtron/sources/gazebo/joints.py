"""A robot's joints and what drives them (ROS wiki: urdf/XML/joint, urdf/XML/Transmission)."""

from dataclasses import dataclass

from rtron.sources.xacro import XmlElement
from rtron.vocabulary import Evidence


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """A joint of a URDF; `type` is one of urdf's, `mimicked_joint` the joint that it follows."""

    name: str
    type: str
    mimicked_joint: str = ""
    evidence: Evidence

    @property
    def has_position(self) -> bool:
        """Whether the joint has a position that joint_states can tell."""
        return self.type not in {"fixed", "floating", "planar"}


@dataclass(frozen=True, slots=True, kw_only=True)
class TransmittedJoint:
    """A joint in a transmission and its hardware interfaces, `hardware_interface/` left out."""

    name: str
    interfaces: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Transmission:
    """A `<transmission>`; gazebo_ros_control offers its joints to controllers."""

    name: str
    type: str
    joints: tuple[TransmittedJoint, ...]
    evidence: Evidence


def joints_of(root: XmlElement) -> tuple[Joint, ...]:
    """Return the joints of a URDF, in document order."""
    return tuple(_read_joint(element) for element in root.elements("joint"))


def transmissions_of(root: XmlElement) -> tuple[Transmission, ...]:
    """Return the transmissions of a URDF, in document order.

    Before Indigo a transmission's interfaces stood in its actuator; that counts where the joint
    names none.
    """
    return tuple(_read_transmission(element) for element in root.elements("transmission"))


def _read_joint(element: XmlElement) -> Joint:
    mimic = element.find("mimic")
    return Joint(
        name=element.attributes.get("name", ""),
        type=element.attributes.get("type", ""),
        mimicked_joint=mimic.attributes.get("joint", "") if mimic else "",
        evidence=element.evidence,
    )


def _read_transmission(element: XmlElement) -> Transmission:
    actuated = [
        name for each in element.elements("actuator") for name in _hardware_interfaces(each)
    ]
    joints = (
        TransmittedJoint(
            name=joint.attributes.get("name", ""),
            interfaces=_hardware_interfaces(joint) or tuple(dict.fromkeys(actuated)),
        )
        for joint in element.elements("joint")
    )
    type_element = element.find("type")
    return Transmission(
        name=element.attributes.get("name", ""),
        type=type_element.text if type_element else element.attributes.get("type", ""),
        joints=tuple(joints),
        evidence=element.evidence,
    )


def _hardware_interfaces(element: XmlElement) -> tuple[str, ...]:
    texts = (interface.text for interface in element.elements("hardwareInterface"))
    return tuple(text.removeprefix("hardware_interface/") for text in texts)
