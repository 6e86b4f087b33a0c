"""A service for tests: on a database of its own, at a time that the test sets."""

import itertools
import socket
import threading
from contextlib import contextmanager

import uvicorn
from harness import wait_for

from rtron.service.config import ServiceConfig
from rtron.service.domain.roles import AccessScope, UserRole
from rtron.service.server.http import uvicorn_options
from rtron.service.store.accounts.logins import SessionLifetime, begin_session
from rtron.service.store.accounts.passwords import hash_password
from rtron.service.store.accounts.tokens import TokenSpec, create_token
from rtron.service.store.accounts.users import add_user, find_user, get_user

PASSWORD = "correct horse battery"
SECOND = 1_000_000_000
_LIFETIME = SessionLifetime(idle=1 << 60, maximum=1 << 60)


class ManualClock:
    """A clock that stands until it is moved."""

    def __init__(self):
        self.now = 1_800_000_000 * SECOND

    def __call__(self):
        return self.now

    def sleep(self, seconds):
        self.now += round(seconds * SECOND)


class AccountFactory:
    """Makes users, sessions and tokens in a service's database."""

    def __init__(self, service):
        self.service = service
        self._hash = None
        self._numbers = itertools.count()

    def add_user(self, name, *roles):
        """Add a user with PASSWORD."""
        self._hash = self._hash or hash_password(PASSWORD)
        with self.service.database.session() as session:
            add_user(session, self.service.clock(), name, self._hash, map(UserRole, roles))
        return name

    def session_headers(self, name, *roles):
        """Return the headers of a browser in which somebody has logged in."""
        with self.service.database.session() as session:
            if not find_user(session, name):
                add_user(session, self.service.clock(), name, "no hash", map(UserRole, roles))
            user = get_user(session, name)
            login = begin_session(session, self.service.clock(), user, _LIFETIME)
        return {"Cookie": f"rtron={login.secret}", "X-CSRF-Token": login.csrf}

    def token_headers(self, name, *scopes, robot=None, days=None):
        """Return the headers of a program with a new token."""
        name = f"{name}.{next(self._numbers)}"
        wish = TokenSpec(
            name=name, scopes=[AccessScope(each) for each in scopes], robot=robot, days=days
        )
        with self.service.database.session() as session:
            _, secret = create_token(session, self.service.clock(), "test", wish)
        return {"Authorization": f"Bearer {secret}"}


@contextmanager
def serve_in_thread(app, config=None):
    """Serve an app as `rtron serve` does, in a thread; give its port."""
    options = uvicorn_options(config or ServiceConfig())
    listening = socket.create_server(("127.0.0.1", 0))
    port = listening.getsockname()[1]
    server = uvicorn.Server(uvicorn.Config(app, **{**options, "port": port}))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]}, daemon=True)
    thread.start()
    wait_for(lambda: server.started)
    try:
        yield port
    finally:
        server.should_exit = True
        thread.join(60)
        assert not thread.is_alive()
