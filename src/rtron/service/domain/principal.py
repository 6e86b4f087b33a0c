"""Who makes a request: a user with a session, or a program with a token."""

from dataclasses import dataclass

from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.roles import AccessScope, UserRole


@dataclass(frozen=True, slots=True, kw_only=True)
class Principal:
    """Who asks. A token is called `token:NAME`; its scopes are those of roles, too.

    `session` is the digest of a browser's session, `csrf` its token; both "" for a token.
    """

    name: str
    roles: frozenset[UserRole]
    scopes: frozenset[AccessScope] = frozenset()
    address: str = ""
    session: str = ""
    csrf: str = ""

    @property
    def may_read(self) -> bool:
        """Whether robots, events and settings may be seen."""
        return bool(self.roles) or AccessScope.READ in self.scopes

    def audit_event(self, action: str, target: str, **detail: object) -> AuditEvent:
        """Return what the audit log says of what the caller does."""
        return AuditEvent(
            who=self.name, action=action, target=target, address=self.address, detail=detail
        )
