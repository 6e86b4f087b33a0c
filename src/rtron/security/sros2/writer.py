"""Writing what has to change in a keystore. What is interrupted is completed by the next run."""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from rtron.errors import InputError
from rtron.security.access.rights import AppAccess, NodeAccess, RightKind
from rtron.security.sros2.certificates import (
    CLOCK_SKEW,
    Authority,
    certificate_pem,
    create_authority,
    create_identity,
    create_revocation_list,
    key_pem,
    load_certificate,
    load_key,
    revocation_list_pem,
)
from rtron.security.sros2.changes import EnclaveChange, KeystoreChanges, KeystoreSettings
from rtron.security.sros2.documents import Permissions, governance_xml, permissions_xml
from rtron.security.sros2.layout import (
    CERTIFICATE,
    GOVERNANCE,
    GOVERNANCE_XML,
    IDENTITY_CA,
    IDENTITY_CA_KEY,
    KEY,
    PERMISSIONS,
    PERMISSIONS_CA,
    PERMISSIONS_CA_KEY,
    PERMISSIONS_XML,
    REVOKED,
    Keystore,
)
from rtron.security.sros2.signed_document import sign_document
from rtron.security.sros2.state import KeystoreState

_AUTHORITIES = (
    ("rtron identity CA", IDENTITY_CA, IDENTITY_CA_KEY),
    ("rtron permissions CA", PERMISSIONS_CA, PERMISSIONS_CA_KEY),
)


@dataclass(frozen=True, slots=True)
class KeystoreWriter:
    """Writes the changes of a keystore with its own authorities."""

    keystore: Keystore
    settings: KeystoreSettings

    def apply(self, state: KeystoreState, changes: KeystoreChanges) -> None:
        """Write all changes; InputError if a key of an authority is not there."""
        if not changes:
            return
        identity, permissions = (self._authority(*each) for each in _AUTHORITIES)
        if changes.writes_revocation_list:
            self._revoke(state, changes, identity)
        if changes.governance:
            document = governance_xml(self.settings.domain, self.settings.protection)
            self._write_signed(GOVERNANCE_XML, GOVERNANCE, "/", document, permissions)
        for change in filter(None, changes.enclaves):
            self._write_enclave(change, identity, permissions)
        used = {change.name for change in changes.enclaves}
        for name in set(changes.revoked) - used:
            self.keystore.remove(name)

    def identity_authority(self) -> Authority:
        """Return the authority of the certificates; InputError if its key is not there."""
        return self._authority(*_AUTHORITIES[0])

    def _authority(self, name: str, certificate_file: str, key_file: str) -> Authority:
        """Return an authority of the keystore, a new one where there is none."""
        keystore = self.keystore
        certificate_path, key_path = keystore.public / certificate_file, keystore.private / key_file
        certificate, key = keystore.read(certificate_path), keystore.read(key_path)
        if certificate is None:
            authority = create_authority(name, self.settings.now)
            keystore.write(key_path, key_pem(authority.key), private=True)
            keystore.write(certificate_path, certificate_pem(authority.certificate))
            return authority
        if key is None:
            help = "the keys of the authorities are needed for a change: bring private/ back"
            raise InputError("is not there", path=str(key_path), help=help)
        authority = Authority(
            load_certificate(certificate, str(certificate_path)), load_key(key, str(key_path))
        )
        self._check_authority(authority, key_path, certificate_path)
        return authority

    def _check_authority(
        self, authority: Authority, key_path: Path, certificate_path: Path
    ) -> None:
        """Refuse an authority whose word nobody would believe."""
        if authority.certificate.public_key() != authority.key.public_key():
            raise InputError("is the key of another authority", path=str(key_path))
        if authority.certificate.not_valid_after_utc < self.settings.until:
            help = "make a new keystore, and restart every process with it; or give fewer --days"
            raise InputError(
                "expires sooner than what it is to sign", path=str(certificate_path), help=help
            )

    def _revoke(self, state: KeystoreState, changes: KeystoreChanges, authority: Authority) -> None:
        names = {*changes.revoked, *(each.name for each in changes.enclaves if each.revokes)}
        enclaves = (state.enclaves[name] for name in names & state.enclaves.keys())
        serials = {each.certificate.serial_number for each in enclaves if each.certificate}
        revoked = create_revocation_list(state.revoked | serials, authority, self.settings.now)
        target = self.keystore.public / REVOKED
        self.keystore.write(target, revocation_list_pem(revoked))
        for name in state.enclaves:  # one may have a copy of the former list
            self.keystore.link(self.keystore.folder(name) / REVOKED, target)

    def _write_enclave(
        self, change: EnclaveChange, identity: Authority, permissions: Authority
    ) -> None:
        """Write what changes: the key goes before the certificate that fits it."""
        settings, folder = self.settings, self.keystore.folder(change.name)
        if change.new_identity:
            certificate, key = create_identity(change.name, identity, settings.now, settings.until)
            self.keystore.write(folder / KEY, key_pem(key), private=True)
            self.keystore.write(folder / CERTIFICATE, certificate_pem(certificate))
        if change.signs_permissions:
            document = permissions_xml(
                Permissions(
                    enclave=change.name,
                    domains=frozenset({settings.domain}),
                    rights=change.rights,
                    not_before=settings.now - CLOCK_SKEW,
                    not_after=settings.until,
                )
            )
            self._write_signed(PERMISSIONS_XML, PERMISSIONS, change.name, document, permissions)
        for name, target in self.keystore.links(change.name).items():
            self.keystore.link(folder / name, target)

    def _write_signed(
        self, clear: str, signed: str, enclave: str, document: bytes, authority: Authority
    ) -> None:
        folder = self.keystore.folder(enclave)
        self.keystore.write(folder / clear, document)
        signature = sign_document(document, authority.certificate, authority.key)
        self.keystore.write(folder / signed, signature)


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
