"""What a keystore holds now, and what is wrong with it. It may be others', or half written."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from functools import partial

from cryptography.x509 import Certificate

from rtron.errors import InputError
from rtron.security.sros2.certificates import (
    common_name,
    is_issued_by,
    is_signed_by,
    load_certificate,
    load_key,
    load_revocation_list,
)
from rtron.security.sros2.documents import Permissions, parse_permissions
from rtron.security.sros2.layout import (
    CERTIFICATE,
    GOVERNANCE,
    IDENTITY_CA,
    IDENTITY_CA_KEY,
    KEY,
    OWN_FILES,
    PERMISSIONS,
    PERMISSIONS_CA,
    PERMISSIONS_CA_KEY,
    REVOKED,
    Keystore,
)
from rtron.security.sros2.signed_document import verify_document


@dataclass(frozen=True, slots=True, kw_only=True)
class EnclaveState:
    """An enclave of a keystore: its certificate and permissions where they are good, else why not.

    `identity_problems` are mended by another certificate and key, `problems` by writing the other
    files again.
    """

    name: str
    certificate: Certificate | None = None
    permissions: Permissions | None = None
    identity_problems: tuple[str, ...] = ()
    problems: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class KeystoreState:
    """A keystore: its authorities, what holds for the domain, the enclaves, what is revoked."""

    identity_ca: Certificate | None = None
    permissions_ca: Certificate | None = None
    governance: bytes | None = None
    revoked: frozenset[int] = frozenset()
    has_revocation_list: bool = False
    enclaves: Mapping[str, EnclaveState] = field(default_factory=dict)
    problems: tuple[str, ...] = ()


def read_state(keystore: Keystore, now: datetime) -> KeystoreState:
    """Return what a keystore holds; InputError if it leads out of its folder, or others write it.

    `now` is an aware time, against which validity is compared.
    """
    for folder in (keystore.public, keystore.private, keystore.enclaves):
        keystore.check_folder(folder)
    problems: list[str] = []
    load = partial(_load_authority, keystore, now, problems)
    identity_ca, permissions_ca = load(IDENTITY_CA), load(PERMISSIONS_CA)
    revoked = _revoked(keystore, identity_ca, problems)
    reader = _EnclaveReader(keystore, identity_ca, permissions_ca, revoked or frozenset(), now)
    problems += _open_keys(keystore)
    governance = reader.governance(problems)
    return KeystoreState(
        identity_ca=identity_ca,
        permissions_ca=permissions_ca,
        governance=governance,
        revoked=reader.revoked,
        has_revocation_list=revoked is not None,
        enclaves={name: reader.read(name) for name in keystore.enclave_names()},
        problems=tuple(problems),
    )


def _load_authority(
    keystore: Keystore, now: datetime, problems: list[str], name: str
) -> Certificate | None:
    path = keystore.public / name
    data = keystore.read(path)
    if data is None:
        return None
    certificate = load_certificate(data, str(path))
    if why := _validity_problem(
        certificate.not_valid_before_utc, certificate.not_valid_after_utc, now
    ):
        problems.append(f"{name} {why}: every certificate below it is void")
    return certificate


def _revoked(
    keystore: Keystore, identity_ca: Certificate | None, problems: list[str]
) -> frozenset[int] | None:
    """Return what the identity CA has taken back; None, and why, if its list is not there."""
    if identity_ca is None:
        return None
    path = keystore.public / REVOKED
    data = keystore.read(path)
    found = None if data is None else load_revocation_list(data, str(path))
    if found is None:
        why = "is not there"
    elif not is_signed_by(found, identity_ca):
        why = "is not the identity CA's"
    else:
        return frozenset(each.serial_number for each in found)
    problems.append(f"{REVOKED} {why}: what was revoked counts again; make a new keystore if so")
    return None


def _open_keys(keystore: Keystore) -> Iterator[str]:
    for name in (IDENTITY_CA_KEY, PERMISSIONS_CA_KEY):
        path = keystore.private / name
        if keystore.read(path) is not None and not keystore.is_private_file(path.resolve()):
            yield f"{name} can be read by others, who may have a copy: make a new keystore"


def _certificate_validity(certificate: Certificate, now: datetime) -> str:
    return _validity_problem(certificate.not_valid_before_utc, certificate.not_valid_after_utc, now)


def _validity_problem(not_before: datetime, not_after: datetime, now: datetime) -> str:
    if now > not_after:
        return f"has expired on {not_after:%Y-%m-%d}"
    return f"is not valid before {not_before:%Y-%m-%d %H:%M} UTC" if now < not_before else ""


class _EnclaveReader:
    """Reads enclaves against the authorities of their keystore."""

    def __init__(
        self,
        keystore: Keystore,
        identity_ca: Certificate | None,
        permissions_ca: Certificate | None,
        revoked: frozenset[int],
        now: datetime,
    ) -> None:
        self._keystore = keystore
        self._identity_ca = identity_ca
        self._permissions_ca = permissions_ca
        self.revoked = revoked
        self._now = now

    def governance(self, problems: list[str]) -> bytes | None:
        """Return the document that holds for the domain, None if it is not signed by the CA."""
        path = self._keystore.enclaves / GOVERNANCE
        signed = self._keystore.read(path)
        if signed is None or self._permissions_ca is None:
            return None
        try:
            return verify_document(signed, self._permissions_ca, str(path))
        except InputError as error:
            problems.append(f"{GOVERNANCE} {error.reason}")
            return None

    def read(self, name: str) -> EnclaveState:
        """Return one enclave."""
        folder = self._keystore.folder(name)
        self._keystore.check_folder(folder)
        missing = [each for each in OWN_FILES if self._keystore.read(folder / each) is None]
        certificate, identity_problems = self._identity(name)
        permissions, problems = self._permissions(name)
        problems += [f"{each} is missing" for each in missing]
        problems += self._link_problems(name)
        return EnclaveState(
            name=name,
            certificate=certificate,
            permissions=permissions,
            identity_problems=tuple(identity_problems),
            problems=tuple(problems),
        )

    def _identity(self, name: str) -> tuple[Certificate | None, list[str]]:
        folder = self._keystore.folder(name)
        certificate_path, key_path = folder / CERTIFICATE, folder / KEY
        certificate_data = self._keystore.read(certificate_path)
        key_data = self._keystore.read(key_path)
        if certificate_data is None or key_data is None:
            return None, ["has no certificate, or no key"]
        try:
            certificate = load_certificate(certificate_data, str(certificate_path))
            key = load_key(key_data, str(key_path))
        except InputError as error:
            return None, [error.reason]
        problems = list(self._certificate_problems(certificate, name))
        if certificate.public_key() != key.public_key():
            problems.append("its key is not its certificate's")
        if not self._keystore.is_private_file(key_path):
            problems.append("its key can be read by others, who may have a copy")
        return certificate, problems

    def _certificate_problems(self, certificate: Certificate, name: str) -> list[str]:
        validity = _certificate_validity(certificate, self._now)
        ca, named = self._identity_ca, common_name(certificate)
        problems = {
            f"its certificate {validity}": bool(validity),
            "its certificate is of another CA": ca is None or not is_issued_by(certificate, ca),
            f"its certificate is of {named[:64]!r}": named != name,
            "its certificate is revoked": certificate.serial_number in self.revoked,
        }
        return [problem for problem, is_so in problems.items() if is_so]

    def _permissions(self, name: str) -> tuple[Permissions | None, list[str]]:
        path = self._keystore.folder(name) / PERMISSIONS
        signed = self._keystore.read(path)
        if signed is None or self._permissions_ca is None:
            return None, []
        try:
            document = verify_document(signed, self._permissions_ca, str(path))
            permissions = parse_permissions(document, name, str(path))
        except InputError as error:
            return None, [f"{PERMISSIONS} {error.reason}"]
        validity = _validity_problem(permissions.not_before, permissions.not_after, self._now)
        return permissions, [f"its permission {validity}"] if validity else []

    def _link_problems(self, name: str) -> list[str]:
        """Return which of the keystore's common files an enclave shows wrongly."""
        folder, read = self._keystore.folder(name), self._keystore.read
        links = self._keystore.links(name)
        return [
            f"{link} is not the keystore's"
            for link, target in links.items()
            if read(folder / link) != read(target)
        ]
