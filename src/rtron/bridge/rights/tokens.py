"""The tokens of a bridge's clients: made, kept as hashes, and recognised.

Of 256 random bits a plain SHA-256 tells nothing, and whoever reads the file cannot sign in.
"""

from collections.abc import Iterable

from rtron.bridge.rights.document import ClientRights
from rtron.service.store.accounts.random_secrets import new_secret, secret_digest

_PREFIX = "rtb_"
"""Marks a bridge's token for people, and for programs that look for secrets."""
_ALGORITHM = "sha256:"
MAX_TOKEN = 128
"""The longest token that is looked at, characters."""


def new_token() -> str:
    """Return a token of 256 random bits that fits into an address."""
    return new_secret(_PREFIX)


def token_hash(token: str) -> str:
    """Return what the file keeps of a token."""
    return _ALGORITHM + secret_digest(token)


class SignIn:
    """Finds whose token one is: by its hash, so that the time tells nothing about the others."""

    def __init__(self, clients: Iterable[ClientRights]) -> None:
        self._clients = {token: client for client in clients for token in client.tokens}

    def find_client(self, token: str) -> ClientRights | None:
        """Return the client that a token is of; None if it is nobody's."""
        if not token.isascii() or len(token) > MAX_TOKEN:
            return None
        return self._clients.get(token_hash(token))


def rights_entry(name: str, token: str) -> str:
    """Return what lets a client sign in: lines of `bridge.yaml`; ValueError if it has no name."""
    client = ClientRights(name=name, tokens=(token_hash(token),))
    return (
        "Its entry in bridge.yaml, under `clients`; it may do what you add:\n\n"
        f"  - name: {client.name}\n"
        f"    tokens: ['{client.tokens[0]}']\n"
        "    publish: []\n"
        "    subscribe: []\n"
    )
