"""Records of which a scan makes millions: a type checker sees that nothing writes to them.

At run time they are not frozen: `__init__` of a frozen dataclass takes three times as long.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dataclasses import dataclass as record
else:
    from dataclasses import dataclass

    def record(*, frozen, slots, kw_only=False):  # noqa: ANN001, ANN201 - typed above
        """Make a dataclass whose objects are equal, and hashed, by what they hold."""
        return dataclass(slots=slots, unsafe_hash=frozen, kw_only=kw_only)


__all__ = ["record"]
