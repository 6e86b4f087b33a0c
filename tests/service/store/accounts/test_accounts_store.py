"""Users, sessions, tokens and webhooks on a database of each kind."""

import os
import sys

import pytest

from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.errors import ConflictError, NotFoundError, TooManyRequestsError
from rtron.service.domain.principal import AccessScope, UserRole
from rtron.service.server.database_setup import add_first_admin
from rtron.service.store.accounts import passwords
from rtron.service.store.accounts.logins import SessionLifetime, begin_session, find_session
from rtron.service.store.accounts.random_secrets import secret_digest
from rtron.service.store.accounts.tokens import TokenSpec, create_token, find_token, revoke_token
from rtron.service.store.accounts.users import add_user, all_users, get_user, remove_user, set_roles
from rtron.service.store.audit import record_event
from rtron.service.store.webhooks import add_webhook, all_webhooks, remove_webhook, store_failure
from rtron.vocabulary import GuardEventLevel

LIFETIME = SessionLifetime(idle=100, maximum=1000)


def test_users_and_the_last_admin(database):
    assert add_first_admin(database, 1)
    assert add_first_admin(database, 2) is None
    with database.session() as session:
        mary = add_user(session, 3, "mary", "hash", [UserRole.ADMIN, UserRole.ADMIN])
        assert mary.roles == ["admin"]
        set_roles(session, get_user(session, "admin"), [UserRole.END_USER])
    with pytest.raises(ConflictError), database.session() as session:
        set_roles(session, get_user(session, "mary"), [UserRole.DEVELOPER])
    with pytest.raises(ConflictError), database.session() as session:
        add_user(session, 3, "mary", "hash", [UserRole.ADMIN])
    with database.session() as session:
        assert [(each.name, each.roles) for each in all_users(session)] == [
            ("admin", ["end_user"]),
            ("mary", ["admin"]),
        ]
        remove_user(session, get_user(session, "admin"))
    with pytest.raises(NotFoundError), database.session() as session:
        get_user(session, "admin")


def test_sessions(database):
    with database.session() as session:
        mary = add_user(session, 0, "mary", "hash", [UserRole.ADMIN])
        login = begin_session(session, 10, mary, LIFETIME)
    hashed = secret_digest(login.secret)
    with database.session() as session:
        found = find_session(session, 110, hashed, LIFETIME)
        assert found is not None
        assert (found[0].csrf, found[1].name) == (login.csrf, "mary")
        assert find_session(session, 111, hashed, LIFETIME) is None
        assert find_session(session, 10, login.secret, LIFETIME) is None
        found[1].disabled = True
        session.flush()
        assert find_session(session, 110, hashed, LIFETIME) is None


def test_tokens(database):
    wish = TokenSpec(name="car1", scopes=[AccessScope.GUARD], robot="car1", days=1)
    with database.session() as session:
        _, secret = create_token(session, 5, "admin", wish)
    with database.session() as session:
        found = find_token(session, 6, secret)
        assert found is not None
        assert (found.robot, found.used) == ("car1", None)
        assert find_token(session, 6, secret[:-1]) is None
        assert find_token(session, 5 + 86_400_000_000_000, secret) is None
        revoke_token(session, 7, "car1")
        assert find_token(session, 8, secret) is None


def test_webhooks_and_the_audit_log(database):
    with database.session() as session:
        hook = add_webhook(session, 1, "https://example.org/", GuardEventLevel.ERROR)
        store_failure(session, hook.id, "x" * 1000)
        record_event(session, 1, AuditEvent(who="a", action="b", target="t" * 1000), "o" * 1000)
    with database.session() as session:
        (row,) = all_webhooks(session)
        assert len(row.failing) == 300
        remove_webhook(session, row.id)
    with pytest.raises(NotFoundError), database.session() as session:
        remove_webhook(session, hook.id)


@pytest.mark.skipif(sys.platform != "linux", reason="threads have no priorities elsewhere")
def test_who_hashes_passwords_comes_last_for_the_processor():
    def priority():
        return os.getpriority(os.PRIO_PROCESS, 0)

    before = priority()
    assert passwords._run(priority) == min(before + 10, 19)
    assert priority() == before


@pytest.mark.usefixtures("real_password_hashing")
def test_a_crowd_does_not_get_all_the_memory(monkeypatch):
    """Each hash takes 64 MiB; who comes when all places are taken comes again."""
    for _ in range(passwords._MAX_ADMITTED):
        assert passwords._admission_slots.acquire(blocking=False)
    try:
        with pytest.raises(TooManyRequestsError):
            passwords.verify_password("x", None)
    finally:
        for _ in range(passwords._MAX_ADMITTED):
            passwords._admission_slots.release()
    assert not passwords.verify_password("nobody", None)
    assert passwords.hash_password("x").startswith("$argon2id$v=19$m=65536,t=3,p=4$")
