"""A service for tests: on a database of its own, at a time that the test sets."""

import itertools
from contextlib import contextmanager

import httpx
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
from server_thread import serve_app

from rtron.service.config import ServiceConfig
from rtron.service.domain.hash_chain import DocumentSigner
from rtron.service.domain.principal import AccessScope, UserRole
from rtron.service.server.app import create_app
from rtron.service.server.connection_limit import ConnectionLimit, HandshakeSocket
from rtron.service.server.http import uvicorn_options
from rtron.service.store.accounts.logins import SessionLifetime, begin_session
from rtron.service.store.accounts.passwords import hash_password
from rtron.service.store.accounts.tokens import TokenSpec, create_token
from rtron.service.store.accounts.users import add_user, find_user, get_user

TLS = httpx.create_ssl_context()
"""What clients trust, read once: it takes 20 ms."""
PASSWORD = "correct horse battery"
SECOND = 1_000_000_000
SIGNER = DocumentSigner(Ed25519PrivateKey.generate())
_LIFETIME = SessionLifetime(idle=1 << 60, maximum=1 << 60)


class ManualClock:
    """A clock that stands until it is moved."""

    def __init__(self):
        self.now = 1_800_000_000 * SECOND

    def __call__(self):
        return self.now

    def sleep(self, seconds):
        self.now += round(seconds * SECOND)


class FakeLink:
    """A guard's connection with nobody behind it."""

    def push(self, settings):
        self.settings = settings

    def replace(self):
        """Nothing is replaced here."""

    def send_heads(self, document):
        """Nobody keeps them."""


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

    def token_headers(self, name, *scopes, robot=None, days=90):
        """Return the headers of a program with a new token."""
        name = f"{name}.{next(self._numbers)}"
        wish = TokenSpec(
            name=name, scopes=[AccessScope(each) for each in scopes], robot=robot, days=days
        )
        with self.service.database.session() as session:
            _, secret = create_token(session, self.service.clock(), "test", wish)
        return {"Authorization": f"Bearer {secret}"}


@contextmanager
def open_app(config, *clocks):
    """Give an app; its database is closed at the end, though the app may never have been served."""
    app = create_app(config, *clocks)
    try:
        yield app
    finally:
        app.state.service.database.close()


@contextmanager
def serve_in_thread(app, config=None, port=0):
    """Serve an app as `rtron serve` does, in a thread, on a port or a free one; give its port."""
    config = config or ServiceConfig()

    def limited(listening):
        return HandshakeSocket(listening, ConnectionLimit(config.proxies))

    options = uvicorn_options(config)
    with serve_app(app, options, *([limited] if config.tls else []), port=port) as served:
        yield served
