"""Where the files of a keystore are, as SROS2 has them, and how they are written.

public/    the certificates of the two authorities, and what is revoked
private/   the keys of the authorities: only who changes the keystore needs them
enclaves/  the governance of the domain, and a folder for each enclave
"""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from stat import S_ISDIR, S_ISREG, S_IWGRP, S_IWOTH

from rtron.errors import InputError
from rtron.guard.system.durable_file import replace_file
from rtron.sources.bounded_file import read_regular_file

MAX_BYTES = 4 * 2**20
IDENTITY_CA, PERMISSIONS_CA = "identity_ca.cert.pem", "permissions_ca.cert.pem"
IDENTITY_CA_KEY, PERMISSIONS_CA_KEY = "identity_ca.key.pem", "permissions_ca.key.pem"
CERTIFICATE, KEY, REVOKED = "cert.pem", "key.pem", "crl.pem"
GOVERNANCE, GOVERNANCE_XML = "governance.p7s", "governance.xml"
PERMISSIONS, PERMISSIONS_XML = "permissions.p7s", "permissions.xml"
OWN_FILES = (CERTIFICATE, KEY, PERMISSIONS, PERMISSIONS_XML)
ZENOH_SESSION = "zenoh.json5"
_PRIVATE, _PUBLIC, _FOLDER = 0o600, 0o644, 0o700
_MAX_FOLDERS = 10_000
_MAX_DEPTH = 16


class Keystore:
    """The folder of a keystore; nothing is read or written through a link that leads elsewhere."""

    def __init__(self, root: Path) -> None:
        self.root = Path(os.path.abspath(root))  # noqa: PTH100 - links are not to be followed
        self.public = self.root / "public"
        self.private = self.root / "private"
        self.enclaves = self.root / "enclaves"

    def folder(self, enclave: str) -> Path:
        """Return the folder of an enclave, whose name is a full ROS name, or `/`."""
        return self.enclaves / enclave.lstrip("/")

    def links(self, enclave: str) -> dict[str, Path]:
        """Return what each enclave's folder shows of the keystore, by the names there."""
        return {
            IDENTITY_CA: self.public / IDENTITY_CA,
            PERMISSIONS_CA: self.public / PERMISSIONS_CA,
            REVOKED: self.public / REVOKED,
            **({GOVERNANCE: self.enclaves / GOVERNANCE} if enclave != "/" else {}),
        }

    def enclave_names(self) -> Iterator[str]:
        """Yield the enclaves that have a file of their own, whole or not."""
        for number, (folder, folders, files) in enumerate(os.walk(self.enclaves)):
            name = "/" + "/".join(Path(folder).relative_to(self.enclaves).parts)
            if number >= _MAX_FOLDERS or name.count("/") > _MAX_DEPTH:
                raise InputError("has too many folders", path=str(self.enclaves))
            for link in (each for each in folders if Path(folder, each).is_symlink()):
                raise InputError("is a link to a folder", path=str(Path(folder, link)))
            folders.sort()
            if set(OWN_FILES) & set(files):
                yield name

    def read(self, path: Path, limit: int = MAX_BYTES) -> bytes | None:
        """Return a file's bytes, None if it is not there; InputError if it leads out."""
        try:
            if self.root not in path.resolve(strict=True).parents:
                raise InputError("is a link that leads out of the keystore", path=str(path))
            return read_regular_file(path, limit)
        except FileNotFoundError:
            return None
        except (OSError, RuntimeError) as error:
            raise InputError(f"cannot be read: {error}", path=str(path)) from None

    def is_private_file(self, path: Path) -> bool:
        """Tell whether a file is one of its owner alone, and no link."""
        mode = path.lstat().st_mode
        return S_ISREG(mode) and not mode & 0o077

    def write(self, path: Path, data: bytes, *, private: bool = False) -> None:
        """Replace a file, whole or not at all."""
        self._make_folder(path.parent)
        replace_file(path, data, _PRIVATE if private else _PUBLIC)

    def link(self, path: Path, target: Path) -> None:
        """Show a file of the keystore in another folder; the keystore can be moved."""
        self._make_folder(path.parent)
        relative = os.path.relpath(target, path.parent)
        if path.is_symlink() and os.readlink(path) == relative:  # noqa: PTH115 - as it is written
            return
        path.unlink(missing_ok=True)
        path.symlink_to(relative)

    def remove(self, enclave: str) -> None:
        """Remove the files of an enclave, and its folder if nothing else is in it."""
        folder = self.folder(enclave)
        for name in (*OWN_FILES, *self.links(enclave), ZENOH_SESSION):
            (folder / name).unlink(missing_ok=True)
        while folder != self.enclaves and not any(folder.iterdir()):
            folder.rmdir()
            folder = folder.parent

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Keep others from changing the keystore meanwhile; InputError if somebody does."""
        self._make_folder(self.root)
        descriptor = os.open(self.root, os.O_RDONLY)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            yield
        except BlockingIOError:
            raise InputError("is being changed by another process", path=str(self.root)) from None
        finally:
            os.close(descriptor)

    def check_folder(self, folder: Path) -> None:
        """Raise InputError if a folder of the keystore is a link, or if others may write in it."""
        for each in (folder, *folder.parents):
            if each == self.root.parent:
                break
            try:
                status = each.lstat()
            except FileNotFoundError:
                continue
            if not S_ISDIR(status.st_mode):
                raise InputError("is no folder, or a link to one", path=str(each))
            if status.st_mode & (S_IWGRP | S_IWOTH) or status.st_uid not in (0, os.geteuid()):
                help = f"chmod go-w {each}, and let it be yours; then renew what was in it"
                raise InputError("may be changed by others", path=str(each), help=help)

    def _make_folder(self, folder: Path) -> None:
        self.check_folder(folder)
        self.root.parent.mkdir(parents=True, exist_ok=True)
        for each in reversed((folder, *folder.parents)):
            if each == self.root or self.root in each.parents:
                each.mkdir(_FOLDER, exist_ok=True)
