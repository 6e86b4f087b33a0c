"""What has to change in a keystore, so that it says what graph and plan say. Pure."""

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from datetime import datetime, timedelta
from xml.etree.ElementTree import Element

from rtron.errors import InputError, suggestion
from rtron.security.access.rights import AppAccess, ProcessAccess
from rtron.security.sros2.dds_topics import NO_RIGHTS, DdsRights, dds_rights
from rtron.security.sros2.documents import Protection, governance_xml, parse_xml
from rtron.security.sros2.state import EnclaveState, KeystoreState

RENEW_BEFORE = timedelta(days=30)
"""What expires sooner is renewed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class KeystoreSettings:
    """What a keystore is to be: for which domain, how protected, valid until when.

    `revoke` are the enclaves whose certificates are taken back.
    """

    domain: int
    protection: Protection
    now: datetime
    life: timedelta
    revoke: tuple[str, ...] = ()

    @property
    def until(self) -> datetime:
        """When all that is signed now expires."""
        return self.now + self.life

    @property
    def renewed_before(self) -> datetime:
        """What expires before this is renewed; a short life is renewed in its last third."""
        return self.now + min(RENEW_BEFORE, self.life / 3)


@dataclass(frozen=True, slots=True, kw_only=True)
class EnclaveChange:
    """What is wrong with one enclave; nothing is if it is empty.

    `too_wide` are the DDS topics that it may use and should not, `too_narrow` those that it lacks.
    `new_identity` is why it gets another certificate and key, `problems` why files are written.
    `revokes` says that the former certificate is taken back: who has its key could use former
    permissions until they expire, since nothing else ends them.
    """

    name: str
    rights: DdsRights
    is_new: bool = False
    new_identity: tuple[str, ...] = ()
    revokes: bool = False
    problems: tuple[str, ...] = ()
    too_wide: DdsRights = NO_RIGHTS
    too_narrow: DdsRights = NO_RIGHTS

    @property
    def signs_permissions(self) -> bool:
        """Whether its permissions are written."""
        return bool(self.is_new or self.problems or self.too_wide or self.too_narrow)

    def __bool__(self) -> bool:
        return bool(self.signs_permissions or self.new_identity)


@dataclass(frozen=True, slots=True, kw_only=True)
class KeystoreChanges:
    """What a run would change, and what it leaves: enclaves that no process of the app uses."""

    is_new: bool
    governance: tuple[str, ...]
    enclaves: tuple[EnclaveChange, ...]
    revoked: tuple[str, ...]
    unused: tuple[str, ...]
    problems: tuple[str, ...] = ()
    has_revocation_list: bool = True

    @property
    def writes_revocation_list(self) -> bool:
        """Whether a certificate is taken back, or there is no list of them that holds."""
        is_needed = not self.has_revocation_list or bool(self.revoked)
        return is_needed or any(each.revokes for each in self.enclaves)

    def __bool__(self) -> bool:
        return bool(self.governance or self.writes_revocation_list or any(self.enclaves))


def plan_changes(
    state: KeystoreState, access: AppAccess, settings: KeystoreSettings
) -> KeystoreChanges:
    """Return what differs; InputError if an enclave is to be revoked that is not there."""
    _check_revoked(settings.revoke, state.enclaves)
    processes = {process.name: process for process in access}
    return KeystoreChanges(
        is_new=state.identity_ca is None and state.permissions_ca is None,
        governance=tuple(_governance_gaps(state.governance, settings)),
        enclaves=tuple(
            _enclave_change(process, state.enclaves.get(process.name), settings)
            for process in processes.values()
        ),
        revoked=settings.revoke,
        unused=tuple(sorted(state.enclaves.keys() - processes.keys() - set(settings.revoke))),
        problems=state.problems,
        has_revocation_list=state.has_revocation_list,
    )


def _check_revoked(names: Iterable[str], known: Collection[str]) -> None:
    for name in names:
        if name not in known:
            raise InputError(f"no enclave {name} to revoke", help=suggestion(name, sorted(known)))


def _enclave_change(
    process: ProcessAccess, state: EnclaveState | None, settings: KeystoreSettings
) -> EnclaveChange:
    rights = dds_rights(process.rights)
    if state is None:
        return EnclaveChange(
            name=process.name,
            rights=rights,
            is_new=True,
            new_identity=("is new",),
            too_narrow=rights,
        )
    allowed = state.permissions.rights if state.permissions else NO_RIGHTS
    too_wide = allowed.without(rights)
    taken_back = tuple(_revocation_reasons(state, settings, too_wide))
    return EnclaveChange(
        name=process.name,
        rights=rights,
        new_identity=(*state.identity_problems, *taken_back, *_expiry(state, settings)),
        revokes=bool(state.identity_problems or taken_back),
        problems=(*state.problems, *_permission_reasons(state, settings)),
        too_wide=too_wide,
        too_narrow=rights.without(allowed),
    )


def _revocation_reasons(
    state: EnclaveState, settings: KeystoreSettings, too_wide: DdsRights
) -> Iterator[str]:
    if too_wide:
        yield "gets another key: its former permissions were wider, and hold for who has kept them"
    if state.name in settings.revoke:
        yield "its certificate is revoked now"


def _expiry(state: EnclaveState, settings: KeystoreSettings) -> Iterator[str]:
    certificate = state.certificate
    if certificate and settings.now < certificate.not_valid_after_utc < settings.renewed_before:
        yield f"its certificate expires on {certificate.not_valid_after_utc:%Y-%m-%d}"


def _permission_reasons(state: EnclaveState, settings: KeystoreSettings) -> Iterator[str]:
    permissions = state.permissions
    if permissions is None:
        yield "has no permissions that hold"
        return
    if permissions.domains != {settings.domain}:
        yield f"is not for domain {settings.domain} alone"
    if settings.now < permissions.not_after < settings.renewed_before:
        yield f"its permission expires on {permissions.not_after:%Y-%m-%d}"


def _governance_gaps(document: bytes | None, settings: KeystoreSettings) -> Iterator[str]:
    """Yield in what the governance of a domain differs from what it is to be."""
    if document is None:
        yield "is not there, or not signed"
        return
    right = governance_xml(settings.domain, settings.protection)
    found, expected = (_leaves(parse_xml(each, "governance.p7s")) for each in (document, right))
    for tag in sorted(found.keys() | expected.keys()):
        if found.get(tag) != expected.get(tag):
            yield f"{tag} is {_listed(found.get(tag))}, not {_listed(expected.get(tag))}"


def _leaves(root: Element) -> dict[str, list[str]]:
    """Return the texts of a document's innermost elements by their tags, in document order."""
    leaves: dict[str, list[str]] = {}
    for element in root.iter():
        if not len(element):
            leaves.setdefault(element.tag, []).append((element.text or "").strip())
    return leaves


def _listed(texts: list[str] | None) -> str:
    return ", ".join(texts)[:80] if texts else "absent"
