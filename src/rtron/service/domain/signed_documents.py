"""JSON documents with a signature (Ed25519, RFC 8032) over all that is in them.

`key` is the public key (hex) and `signature` (hex) signs the canonical JSON of everything else,
`key` included. Each kind of document has its own `schema`, so that none passes for another.
"""

from collections.abc import Collection, Mapping
from typing import Any

from cryptography.exceptions import InvalidSignature
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey, Ed25519PublicKey

from rtron.errors import WireError
from rtron.service.domain.hash_chain import GENESIS, Head, canonical_json

HEADS_SCHEMA = "rtron.audit_heads/1"
"""Heads of chains: `at` (ns) and `heads`, a number and a hash for each chain."""
ANCHOR_SCHEMA = "rtron.audit_anchor/1"
"""Where a chain begins since older entries were deleted: `at`, `chain`, `number`, `hash`."""

Document = Mapping[str, Any]


class DocumentSigner:
    """Signs documents with one private key; those of others of `trusted_keys` (hex) count, too."""

    def __init__(self, key: Ed25519PrivateKey, other_keys: Collection[str] = ()) -> None:
        self._key = key
        self.public_key = public_key_hex(key.public_key())
        self.trusted_keys = frozenset({self.public_key, *other_keys})

    def sign(self, document: Document) -> dict[str, Any]:
        """Return a document with key and signature."""
        signed = {**document, "key": self.public_key}
        return {**signed, "signature": self._key.sign(canonical_json(signed)).hex()}

    def sign_heads(self, at: int, heads: Mapping[str, Head]) -> dict[str, Any]:
        """Return the signed heads of chains at `at` (ns)."""
        pairs = {chain: [head.number, head.hash] for chain, head in heads.items()}
        return self.sign({"schema": HEADS_SCHEMA, "at": at, "heads": pairs})

    def sign_anchor(self, at: int, chain: str, begin: Head) -> dict[str, Any]:
        """Return the signed statement that a chain begins behind `begin`."""
        anchor = {"chain": chain, "number": begin.number, "hash": begin.hash}
        return self.sign({"schema": ANCHOR_SCHEMA, "at": at, **anchor})


def public_key_hex(key: Ed25519PublicKey) -> str:
    """Return a public key as documents have it."""
    return key.public_bytes_raw().hex()


def verify_document(document: object, keys: Collection[str], schema: str) -> Document:
    """Return a document that one of these keys (hex) has signed; WireError if it is none."""
    if not isinstance(document, dict) or document.get("schema") != schema:
        raise WireError(f"it is no {schema}")
    key = document.get("key")
    if key not in keys:
        raise WireError("it is signed with another key")
    signed = {name: value for name, value in document.items() if name != "signature"}
    try:
        public = Ed25519PublicKey.from_public_bytes(bytes.fromhex(str(key)))
        public.verify(bytes.fromhex(str(document.get("signature"))), canonical_json(signed))
    except (InvalidSignature, ValueError):
        raise WireError("its signature is wrong") from None
    return document


def heads_of(document: Document) -> dict[str, Head]:
    """Return the heads of a verified document; WireError if they are none."""
    try:
        return {
            str(chain): Head(int(number), str(hash))
            for chain, (number, hash) in document["heads"].items()
        }
    except (KeyError, TypeError, ValueError, AttributeError):
        raise WireError("it has no heads of chains") from None


def anchor_of(anchor: object, keys: Collection[str], chain: str) -> tuple[Head, str]:
    """Return where a chain begins, GENESIS without an anchor, and what is wrong with the anchor."""
    if anchor is None:
        return GENESIS, ""
    try:
        document = verify_document(anchor, keys, ANCHOR_SCHEMA)
    except WireError as error:
        return GENESIS, f"where it begins is not proven: {error}"
    if document.get("chain") != chain:
        return GENESIS, "where it begins is not proven: that is of another chain"
    return Head(int(document["number"]), str(document["hash"])), ""
