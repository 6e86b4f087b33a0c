"""The policy file of SROS2, which `ros2 security create_permission` takes (sros2: policy.xsd)."""

from collections import defaultdict
from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from rtron.security.access.rights import AppAccess, NodeAccess, RightKind

_VERSION = "0.2.0"
_LISTS = (
    ("topics", "topic", (RightKind.SUBSCRIBE, RightKind.PUBLISH)),
    ("services", "service", (RightKind.REPLY, RightKind.REQUEST)),
    ("actions", "action", (RightKind.CALL, RightKind.EXECUTE)),
)


def policy_xml(access: AppAccess) -> bytes:
    """Return the policy of all processes, an enclave each, a profile for each of its nodes."""
    policy = Element("policy", version=_VERSION)
    enclaves = SubElement(policy, "enclaves")
    for process in access:
        enclave = SubElement(enclaves, "enclave", path=process.name)
        profiles = SubElement(enclave, "profiles")
        for node in process.nodes:
            _add_profile(profiles, node)
    indent(policy)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(policy) + b"\n"


def _add_profile(profiles: Element, access: NodeAccess) -> None:
    namespace, _, name = access.node.rpartition("/")
    profile = SubElement(profiles, "profile", ns=namespace or "/", node=name or "launch")
    for list_tag, tag, kinds in _LISTS:
        for qualifiers, names in _grouped(access, kinds):
            listed = SubElement(profile, list_tag, dict.fromkeys(qualifiers, "ALLOW"))
            for each in names:
                SubElement(listed, tag).text = each


def _grouped(
    access: NodeAccess, kinds: Iterable[RightKind]
) -> Iterable[tuple[tuple[str, ...], list[str]]]:
    """Return names by what may be done with them; a name that may be both stands once."""
    by_name: dict[str, tuple[str, ...]] = defaultdict(tuple)
    for kind in kinds:
        for right in access.rights:
            if right.kind is kind:
                by_name[right.name] += (str(kind),)
    groups: dict[tuple[str, ...], list[str]] = defaultdict(list)
    for name, qualifiers in sorted(by_name.items()):
        groups[qualifiers].append(name)
    return sorted(groups.items())
