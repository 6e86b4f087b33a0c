"""The key that signs the heads of the chains, in a folder of its own outside the database."""

import os
import stat
from collections.abc import Collection
from pathlib import Path

from cryptography.exceptions import UnsupportedAlgorithm
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey, Ed25519PublicKey
from cryptography.hazmat.primitives.serialization import (
    Encoding,
    NoEncryption,
    PrivateFormat,
    PublicFormat,
    load_pem_private_key,
    load_pem_public_key,
)

from rtron.errors import InputError
from rtron.service.domain.hash_chain import DocumentSigner, public_key_hex

PRIVATE_KEY, PUBLIC_KEY = "key.pem", "public.pem"
HEADS_FILE, OLDER_HEADS_FILE = "heads.jsonl", "heads.1.jsonl"
_PUBLIC_KEYS = "public*.pem"
_PRIVATE_MODE, _FOLDER_MODE = 0o600, 0o700


def load_signer(folder: Path) -> DocumentSigner:
    """Return who signs with the key in a folder; both are made if they are not there."""
    try:
        folder.mkdir(mode=_FOLDER_MODE, parents=True, exist_ok=True)
        if not (folder / PRIVATE_KEY).exists():
            _create_key(folder)
    except OSError as error:
        help = "give a folder that may be written with --audit-dir"
        raise InputError(error.strerror or "no folder", path=str(folder), help=help) from None
    return load_existing_signer(folder)


def load_existing_signer(folder: Path) -> DocumentSigner:
    """Return who signs with the key in a folder; InputError if there is none."""
    path = folder / PRIVATE_KEY
    try:
        _check_private(folder, _FOLDER_MODE, stat.S_IWOTH, "write into it")
        _check_private(path, _PRIVATE_MODE, stat.S_IRWXO, "read or write it")
        key = load_pem_private_key(path.read_bytes(), password=None)
    except OSError as error:
        help = "give the folder that `rtron serve` has with --audit-dir"
        raise InputError(error.strerror or "cannot be read", path=str(path), help=help) from None
    except (ValueError, TypeError, UnsupportedAlgorithm):
        raise _no_key(path) from None
    if not isinstance(key, Ed25519PrivateKey):
        raise _no_key(path)
    return DocumentSigner(key, load_public_keys(_public_key_files(folder)))


def folder_keys(folder: Path) -> frozenset[str]:
    """Return the public keys (hex) in a folder: its own one, and others that may sign, too."""
    return load_public_keys({folder / PUBLIC_KEY, *_public_key_files(folder)})


def load_public_keys(paths: Collection[Path]) -> frozenset[str]:
    """Return the public keys (hex) in PEM files; InputError for what is none."""
    return frozenset(_public_key(path) for path in paths)


def _public_key_files(folder: Path) -> list[Path]:
    return sorted(folder.glob(_PUBLIC_KEYS))


def _check_private(path: Path, mode: int, everybody: int, what: str) -> None:
    """InputError where everybody on the machine may sign, or replace what signs."""
    if path.stat().st_mode & everybody:
        help = f"chmod {mode:o} {path}"
        raise InputError(f"everybody may {what}", path=str(path), help=help)


def _create_key(folder: Path) -> None:
    """Make a key; of two services that begin at once, one makes it."""
    key = Ed25519PrivateKey.generate()
    private = key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())
    public = key.public_key().public_bytes(Encoding.PEM, PublicFormat.SubjectPublicKeyInfo)
    new = folder / f"{PRIVATE_KEY}.{os.getpid()}"
    with os.fdopen(os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL, _PRIVATE_MODE), "wb") as file:
        file.write(private)
        file.flush()
        os.fsync(file.fileno())
    try:
        os.link(new, folder / PRIVATE_KEY)
        (folder / PUBLIC_KEY).write_bytes(public)
    except FileExistsError:
        return
    finally:
        new.unlink()


def _public_key(path: Path) -> str:
    try:
        key = load_pem_public_key(path.read_bytes())
    except OSError as error:
        help = f"give the service's {PUBLIC_KEY} with --key"
        raise InputError(error.strerror or "cannot be read", path=str(path), help=help) from None
    except (ValueError, UnsupportedAlgorithm):
        raise _no_key(path) from None
    if not isinstance(key, Ed25519PublicKey):
        raise _no_key(path)
    return public_key_hex(key)


def _no_key(path: Path) -> InputError:
    return InputError("that is no Ed25519 key in PEM", path=str(path))
