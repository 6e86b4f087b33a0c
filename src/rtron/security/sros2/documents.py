"""The XML documents of DDS-Security 1.1 (9.4.1): permissions and governance, written and read.

Names are escaped by the XML library. What is read may have been written by others.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime, timezone
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from defusedxml.common import DefusedXmlException
from defusedxml.ElementTree import ParseError, fromstring

from rtron.errors import InputError
from rtron.security.sros2.dds_topics import DdsRights
from rtron.vocabulary import StringEnum

_SCHEMAS = "http://www.omg.org/spec/DDS-SECURITY/20170901"
_SCHEMA_LOCATION = "{http://www.w3.org/2001/XMLSchema-instance}noNamespaceSchemaLocation"
_TIME = "%Y-%m-%dT%H:%M:%S"
"""Without a zone it is UTC (DDS-Security 1.1, 9.4.1.3.2.2)."""
_EVERYTHING = frozenset({"*"})


class Protection(StringEnum):
    """What is done to the bytes on the wire."""

    SIGN = "sign"
    ENCRYPT = "encrypt"


@dataclass(frozen=True, slots=True, kw_only=True)
class Permissions:
    """What one enclave may do in one domain, and from when till when."""

    enclave: str
    domains: frozenset[int]
    rights: DdsRights
    not_before: datetime
    not_after: datetime


def permissions_xml(permissions: Permissions) -> bytes:
    """Return the document of an enclave's permissions; what it does not name is denied."""
    document = _document("permissions")
    grant = SubElement(SubElement(document, "permissions"), "grant", name=permissions.enclave)
    _text(grant, "subject_name", subject_name(permissions.enclave))
    validity = SubElement(grant, "validity")
    _text(validity, "not_before", permissions.not_before.strftime(_TIME))
    _text(validity, "not_after", permissions.not_after.strftime(_TIME))
    rule = SubElement(grant, "allow_rule")
    _domains(rule, permissions.domains)
    _topics(rule, "publish", permissions.rights.publish)
    _topics(rule, "subscribe", permissions.rights.subscribe)
    _text(grant, "default", "DENY")
    return _bytes(document)


def subject_name(enclave: str) -> str:
    """Return the subject of an enclave's certificate, as OpenSSL prints it."""
    return f"CN={enclave}"


def governance_xml(domain: int, protection: Protection) -> bytes:
    """Return the document that holds for a whole domain: nobody joins without a certificate.

    The writer's own key protects its messages (`metadata_protection_kind`), and only those who may
    read the topic are told it: with the participant's key alone, which all others have, too, any
    of them could write in its name.
    """
    kind = "ENCRYPT" if protection is Protection.ENCRYPT else "SIGN"
    document = _document("governance")
    rule = SubElement(SubElement(document, "domain_access_rules"), "domain_rule")
    _domains(rule, [domain])
    _text(rule, "allow_unauthenticated_participants", "false")
    _text(rule, "enable_join_access_control", "true")
    for what in ("discovery", "liveliness"):
        _text(rule, f"{what}_protection_kind", kind)
    _text(rule, "rtps_protection_kind", "SIGN")
    topics = SubElement(SubElement(rule, "topic_access_rules"), "topic_rule")
    _text(topics, "topic_expression", "*")
    for what in ("discovery_protection", "liveliness_protection"):
        _text(topics, f"enable_{what}", "true")
    for what in ("read", "write"):
        _text(topics, f"enable_{what}_access_control", "true")
    _text(topics, "metadata_protection_kind", kind)
    _text(topics, "data_protection_kind", "NONE")
    return _bytes(document)


def parse_permissions(data: bytes, enclave: str, path: str) -> Permissions:
    """Return what a document allows an enclave; InputError if it is none, or grants it nothing.

    Rules that deny are not taken off, so that more may seem allowed than is.
    """
    root = parse_xml(data, path)
    subject = subject_name(enclave)
    grants = [each for each in root.iter("grant") if each.findtext("subject_name") == subject]
    if len(grants) != 1:
        raise InputError(f"grants nothing to {subject}, or several times", path=path)
    (grant,) = grants
    rules = grant.findall("allow_rule")
    allows_rest = (grant.findtext("default") or "").strip().upper() == "ALLOW"
    return Permissions(
        enclave=enclave,
        domains=frozenset(number for rule in rules for number in _read_domains(rule, path)),
        rights=DdsRights(
            publish=_read_topics(rules, "publish") | (_EVERYTHING if allows_rest else set()),
            subscribe=_read_topics(rules, "subscribe") | (_EVERYTHING if allows_rest else set()),
        ),
        not_before=_read_time(grant, "not_before", path),
        not_after=_read_time(grant, "not_after", path),
    )


def parse_xml(data: bytes, path: str) -> Element:
    """Return the root of a document from strangers; InputError if it is none, or has entities."""
    try:
        root: Element = fromstring(data, forbid_dtd=True)
    except (ParseError, DefusedXmlException, ValueError) as error:
        raise InputError(f"is no XML that can be read: {error}", path=path) from None
    return root


def _document(kind: str) -> Element:
    return Element("dds", {_SCHEMA_LOCATION: f"{_SCHEMAS}/omg_shared_ca_{kind}.xsd"})


def _domains(parent: Element, domains: Iterable[int]) -> None:
    element = SubElement(parent, "domains")
    for domain in sorted(domains):
        _text(element, "id", str(domain))


def _topics(rule: Element, direction: str, names: Iterable[str]) -> None:
    topics = SubElement(SubElement(rule, direction), "topics")
    for name in sorted(names):
        _text(topics, "topic", name)


def _text(parent: Element, tag: str, text: str) -> None:
    SubElement(parent, tag).text = text


def _bytes(document: Element) -> bytes:
    indent(document)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(document) + b"\n"


def _read_topics(rules: Iterable[Element], direction: str) -> frozenset[str]:
    return frozenset(
        (topic.text or "").strip()
        for rule in rules
        for part in rule.findall(direction)
        for topic in part.iter("topic")
    )


def _read_domains(rule: Element, path: str) -> Iterable[int]:
    try:
        for found in rule.iterfind("domains/id"):
            yield int(found.text or "")
        for span in rule.iterfind("domains/id_range"):
            first, last = int(span.findtext("min") or 0), int(span.findtext("max") or 232)
            yield from range(max(first, 0), min(last, 232) + 1)
    except ValueError:
        raise InputError("names a domain that is no number", path=path) from None


def _read_time(grant: Element, name: str, path: str) -> datetime:
    text = (grant.findtext(f"validity/{name}") or "").strip()
    try:
        time = datetime.fromisoformat(text.replace("Z", "+00:00"))
    except ValueError:
        raise InputError(f"{name} is no time: {text[:40]!r}", path=path) from None
    return time if time.tzinfo else time.replace(tzinfo=timezone.utc)
