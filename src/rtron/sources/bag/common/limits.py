"""How much of a bag is taken into memory, and how much work a file of its size may cause."""

from dataclasses import dataclass
from io import BufferedReader
from pathlib import Path

from rtron.errors import InputError

MAX_INDEX = 128 * 2**20
MAX_HEADER = 2**20
MAX_CHUNK = 256 * 2**20
MAX_CHUNK_MESSAGES = 10**6
MAX_WAITING = 256 * 2**20
MAX_CONNECTIONS = 2**16
_ALWAYS_UNPACKED = 4 * 2**30
_MOST_PER_BYTE = 1000


class DamageError(ValueError):
    """Something in a bag breaks its format; whoever knows the file makes an InputError of it."""


def opened(path: Path) -> BufferedReader:
    """Open a regular file; raise InputError if it is none (a pipe would block) or is not there."""
    try:
        if path.exists() and not path.is_file():
            raise InputError("is no file", path=str(path), help="give a .bag, .mcap or .db3 file")
        return path.open("rb")
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or "cannot be read"
        raise InputError(why, path=str(path), help="check the path") from None


def damaged(path: Path, why: str, help: str) -> InputError:
    """Return the error for a bag that breaks its format."""
    return InputError(f"the bag is damaged: {why}", path=str(path), help=help)


@dataclass(slots=True)
class Allowance:
    """What may still be unpacked of a bag: in proportion to its size, so that no bomb goes off."""

    path: Path
    left: int

    @classmethod
    def of(cls, path: Path, file_size: int) -> "Allowance":
        """Return what a file of a size may unpack to."""
        return cls(path, max(_ALWAYS_UNPACKED, _MOST_PER_BYTE * file_size))

    def spend(self, size: int) -> None:
        """Count a chunk before it is unpacked; raise InputError if it, or all, is too much."""
        self.left -= size
        if size > MAX_CHUNK:
            raise self._too_much(f"a chunk unpacks to {size} bytes, more than {MAX_CHUNK}")
        if self.left < 0:
            raise self._too_much(f"it unpacks to more than {_MOST_PER_BYTE} times its size")

    def _too_much(self, why: str) -> InputError:
        return InputError(why, path=str(self.path), help="record it again with smaller chunks")
