"""Users, sessions, tokens and webhooks on a database of each kind."""

import pytest

from rtron.service.domain.errors import ConflictError, NotFoundError, TooManyError
from rtron.service.domain.schemas import Scope, UserRole
from rtron.service.server.database_setup import add_first_admin
from rtron.service.store.accounts import passwords
from rtron.service.store.accounts.logins import Lifetime, begin_login, find_login
from rtron.service.store.accounts.secrets import digest
from rtron.service.store.accounts.tokens import TokenWish, create_token, find_token, revoke_token
from rtron.service.store.accounts.users import add_user, all_users, remove_user, set_roles, the_user
from rtron.service.store.audit import Deed, record
from rtron.service.store.webhooks import (
    add_webhook,
    all_webhooks,
    note_failing,
    remove_webhook,
)
from rtron.vocabulary import Level

LIFETIME = Lifetime(idle=100, longest=1000)


def test_users_and_the_last_admin(database):
    assert add_first_admin(database, 1)
    assert add_first_admin(database, 2) is None
    with database.session() as session:
        mary = add_user(session, 3, "mary", "hash", [UserRole.ADMIN, UserRole.ADMIN])
        assert mary.roles == ["admin"]
        set_roles(session, the_user(session, "admin"), [UserRole.END_USER])
    with pytest.raises(ConflictError), database.session() as session:
        set_roles(session, the_user(session, "mary"), [UserRole.DEVELOPER])
    with pytest.raises(ConflictError), database.session() as session:
        add_user(session, 3, "mary", "hash", [UserRole.ADMIN])
    with database.session() as session:
        assert [(each.name, each.roles) for each in all_users(session)] == [
            ("admin", ["end_user"]),
            ("mary", ["admin"]),
        ]
        remove_user(session, the_user(session, "admin"))
    with pytest.raises(NotFoundError), database.session() as session:
        the_user(session, "admin")


def test_sessions(database):
    with database.session() as session:
        mary = add_user(session, 0, "mary", "hash", [UserRole.ADMIN])
        login = begin_login(session, 10, mary, LIFETIME)
    hashed = digest(login.secret)
    with database.session() as session:
        found = find_login(session, 110, hashed, LIFETIME)
        assert found is not None
        assert (found[0].csrf, found[1].name) == (login.csrf, "mary")
        assert find_login(session, 111, hashed, LIFETIME) is None
        assert find_login(session, 10, login.secret, LIFETIME) is None
        found[1].disabled = True
        session.flush()
        assert find_login(session, 110, hashed, LIFETIME) is None


def test_tokens(database):
    wish = TokenWish(name="car1", scopes=[Scope.GUARD], robot="car1", days=1)
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
        hook = add_webhook(session, 1, "https://example.org/", Level.ERROR)
        note_failing(session, hook.id, "x" * 1000)
        record(session, 1, Deed(who="a", action="b", target="t" * 1000), "o" * 1000)
    with database.session() as session:
        (row,) = all_webhooks(session)
        assert len(row.failing) == 300
        remove_webhook(session, row.id)
    with pytest.raises(NotFoundError), database.session() as session:
        remove_webhook(session, hook.id)


@pytest.mark.usefixtures("full_effort")
def test_a_crowd_does_not_get_all_the_memory(monkeypatch):
    """Each hash takes 64 MiB; who comes when all places are taken comes again."""
    for _ in range(passwords._WAITING):
        assert passwords._admitted.acquire(blocking=False)
    try:
        with pytest.raises(TooManyError):
            passwords.matches("x", None)
    finally:
        for _ in range(passwords._WAITING):
            passwords._admitted.release()
    assert not passwords.matches("nobody", None)
    assert passwords.hash_password("x").startswith("$argon2id$v=19$m=65536,t=3,p=4$")
