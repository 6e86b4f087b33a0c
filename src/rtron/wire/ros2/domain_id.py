"""Which ROS 2 domain is meant."""

import os
import re

from rtron.errors import InputError

LAST_DOMAIN = 232
"""The largest domain id that has ports of its own (ROS 2: The ROS_DOMAIN_ID)."""

_ADDRESS = "domain "
_DIGITS = re.compile("[0-9]{1,3}")


def domain_id(requested: int | None = None) -> int:
    """Return the domain that is given, or that of the environment; InputError if there is none.

    The middleware would end the process over a wrong one.
    """
    text = os.environ.get("ROS_DOMAIN_ID") or "0" if requested is None else str(requested)
    if not _DIGITS.fullmatch(text) or int(text) > LAST_DOMAIN:
        help = f"ROS_DOMAIN_ID is a number from 0 to {LAST_DOMAIN}, the same for the whole app"
        raise InputError(f"there is no ROS 2 domain {text[:20]!r}", help=help)
    return int(text)


def domain_address(requested: int | None = None) -> str:
    """Return the address of the domain that `domain_id` returns, as ROS 1 has a master's."""
    return f"{_ADDRESS}{domain_id(requested)}"


def domain_at(address: str) -> int:
    """Return the domain of such an address."""
    return int(address.removeprefix(_ADDRESS))
