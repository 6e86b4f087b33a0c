"""How much of a bag is taken into memory, and how much work a file of its size may cause."""

from dataclasses import dataclass
from io import BufferedReader
from pathlib import Path

from rtron.errors import InputError

MAX_INDEX_BYTES = 128 * 2**20
MAX_HEADER_BYTES = 2**20
MAX_CHUNK_BYTES = 256 * 2**20
MAX_CHUNK_MESSAGES = 10**6
MAX_PENDING_BYTES = 256 * 2**20
MAX_CONNECTIONS = 2**16
_MIN_BUDGET_BYTES = 4 * 2**30
_MAX_RATIO = 1000


class DamageError(ValueError):
    """Something in a bag breaks its format; whoever knows the file makes an InputError of it."""


def open_bag_file(path: Path) -> BufferedReader:
    """Open a regular file; raise InputError if it is none (a pipe would block) or is not there."""
    try:
        if path.exists() and not path.is_file():
            raise InputError("is no file", path=str(path), help="give a .bag, .mcap or .db3 file")
        return path.open("rb")
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or "cannot be read"
        raise InputError(why, path=str(path), help="check the path") from None


def damage_error(path: Path, why: str, help: str) -> InputError:
    """Return the error for a bag that breaks its format."""
    return InputError(f"the bag is damaged: {why}", path=str(path), help=help)


@dataclass(slots=True)
class DecompressionBudget:
    """What may still be unpacked of a bag: in proportion to its size, so that no bomb goes off."""

    path: Path
    remaining: int

    @classmethod
    def for_file(cls, path: Path, file_size: int) -> "DecompressionBudget":
        """Return what a file of a size may unpack to."""
        return cls(path, max(_MIN_BUDGET_BYTES, _MAX_RATIO * file_size))

    def spend(self, size: int) -> None:
        """Count a chunk before it is unpacked; raise InputError if it, or all, is too much."""
        self.remaining -= size
        if size > MAX_CHUNK_BYTES:
            raise self._exceeded(f"a chunk unpacks to {size} bytes, more than {MAX_CHUNK_BYTES}")
        if self.remaining < 0:
            raise self._exceeded(f"it unpacks to more than {_MAX_RATIO} times its size")

    def _exceeded(self, why: str) -> InputError:
        return InputError(why, path=str(self.path), help="record it again with smaller chunks")
