"""Hash chains: the hash of each entry has that of the entry before it in it, so none changes alone.

`SHA-256(canonical JSON of [hash before, chain, number, content])`. Canonical JSON is ASCII, has its
keys in order and no spaces, and numbers as Python writes them. Whoever can write every hash can
still rewrite a chain from some entry on: then its heads of before, kept elsewhere, do not fit.

`key` is the public key (hex) and `signature` (hex) signs the canonical JSON of everything else,
`key` included. Each kind of document has its own `schema`, so that none passes for another.
"""

import hashlib
import json
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from cryptography.exceptions import InvalidSignature
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey, Ed25519PublicKey

from rtron.errors import WireError

Content = Mapping[str, Any]
"""What an entry says, as JSON has it."""
_MAX_FAULTS = 20


@dataclass(frozen=True, slots=True)
class Head:
    """The end of a chain: the number of its last entry, from 1 on, and that entry's hash (hex)."""

    number: int
    hash: str


GENESIS = Head(0, "0" * 64)
"""The head of a chain without entries."""


@dataclass(frozen=True, slots=True)
class Link:
    """An entry of a chain as it is stored; `content` is None if only its hash is left."""

    number: int
    hash: str
    content: Content | None


@dataclass(frozen=True, slots=True)
class Witness:
    """A head of a chain that was kept elsewhere; `source` says where, and when it was signed."""

    head: Head
    source: str


@dataclass(slots=True)
class ChainReport:
    """What a check of a chain found; `compared` of its `witnesses` are not older than its begin."""

    chain: str
    begin: Head
    end: Head
    witnesses: int = 0
    compared: int = 0
    faults: list[str] = field(default_factory=list)
    more_faults: int = 0

    def add(self, fault: str) -> None:
        """Keep a fault, the first ones only: one change can make thousands."""
        if len(self.faults) < _MAX_FAULTS:
            self.faults.append(fault)
        else:
            self.more_faults += 1


def canonical_json(document: object) -> bytes:
    """Return the one text that a JSON document has here; ValueError for NaN and infinity."""
    return _encode(document).encode()


_encode: Callable[[object], str] = json.JSONEncoder(
    sort_keys=True, separators=(",", ":"), allow_nan=False
).encode


def next_head(chain: str, previous: Head, content: Content) -> Head:
    """Return the head of a chain after one more entry."""
    number = previous.number + 1
    text = canonical_json([previous.hash, chain, number, content])
    return Head(number, hashlib.sha256(text).hexdigest())


def check_chain(
    chain: str, begin: Head, links: Iterable[Link], end: Head | None, witnesses: Sequence[Witness]
) -> ChainReport:
    """Check the entries behind `begin`, in the order of their numbers.

    `end` is the head that is stored with the chain, None where there is none. Each fault is told
    once: what follows a changed entry is checked against the hash that is stored there.
    """
    report = ChainReport(chain, begin, begin, witnesses=len(witnesses))
    by_number: dict[int, list[Witness]] = {}
    for witness in witnesses:
        by_number.setdefault(witness.head.number, []).append(witness)
    _compare(report, begin, by_number)
    for link in links:
        for fault in link_faults(chain, report.end, link):
            report.add(fault)
        report.end = Head(link.number, link.hash)
        _compare(report, report.end, by_number)
    for fault in _end_faults(report.end, end, witnesses):
        report.add(fault)
    return report


def _compare(report: ChainReport, head: Head, witnesses: Mapping[int, Sequence[Witness]]) -> None:
    for witness in witnesses.get(head.number, ()):
        report.compared += 1
        if witness.head.hash != head.hash:
            report.add(
                f"entry {head.number}, or one before it, was another: it does not fit the head "
                f"{witness.source}"
            )


def link_faults(chain: str, previous: Head, link: Link) -> Iterator[str]:
    """Yield what is wrong with the entry that is stored behind `previous`."""
    if link.number <= previous.number:
        yield f"entry {link.number} is there twice, or before the begin"
    elif link.number > previous.number + 1:
        yield _missing(previous.number + 1, link.number - 1)
    elif link.content is None:
        yield f"entry {link.number} is gone, only its hash is left"
    elif next_head(chain, previous, link.content).hash != link.hash:
        yield f"entry {link.number} was changed, or is not where it was"


def _end_faults(last: Head, end: Head | None, witnesses: Sequence[Witness]) -> Iterator[str]:
    if end is not None and end.number > last.number:
        yield _missing(last.number + 1, end.number)
    elif end is not None and end != last:
        yield f"the head is {end.number}, the last entry {last.number}: they do not fit"
    beyond = [each for each in witnesses if each.head.number > last.number]
    if beyond:
        newest = max(beyond, key=lambda each: each.head.number)
        missing = _missing(last.number + 1, newest.head.number)
        yield f"{missing}: they are cut off the end, but in the head {newest.source}"


def _missing(first: int, last: int) -> str:
    if first == last:
        return f"entry {first} is missing"
    return f"entries {first} to {last} are missing"


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
