"""Numbers of robots: so many, or a share of a total."""

import re
from dataclasses import dataclass
from typing import Annotated

from pydantic import BeforeValidator, PlainSerializer

_SHARE = re.compile(r"([0-9]{1,3})(?:\.([0-9]{1,2}))? ?%")
_HUNDREDTHS = 100
_WHOLE = 100 * _HUNDREDTHS
_MAX_COUNT = 1_000_000


@dataclass(frozen=True, slots=True)
class Amount:
    """So many robots, or, as a share, so many hundredths of a percent of a total."""

    number: int
    is_share: bool = False

    def at_least(self, total: int) -> int:
        """Return how many that is of a total, rounded up."""
        return -(-self.number * total // _WHOLE) if self.is_share else self.number

    def at_most(self, total: int) -> int:
        """Return how many that is of a total, rounded down."""
        return self.number * total // _WHOLE if self.is_share else self.number

    @property
    def is_all(self) -> bool:
        """Whether it is the whole of every total."""
        return self.is_share and self.number == _WHOLE

    def __str__(self) -> str:
        if not self.is_share:
            return str(self.number)
        percent, hundredths = divmod(self.number, _HUNDREDTHS)
        return f"{percent}.{hundredths:02}".rstrip("0").rstrip(".") + "%"


ALL = Amount(_WHOLE, is_share=True)


def parse_amount(value: object) -> Amount:
    """Read a whole number, or a text like "10%" or "0.5 %"; ValueError for anything else."""
    if isinstance(value, Amount):
        return value
    if type(value) is int and 0 <= value <= _MAX_COUNT:
        return Amount(value)
    match = _SHARE.fullmatch(value) if isinstance(value, str) else None
    if match is None:
        raise ValueError('give a number of robots, or a share such as "10%"')
    percent, hundredths = match[1], (match[2] or "").ljust(2, "0")
    number = int(percent) * _HUNDREDTHS + int(hundredths)
    if number > _WHOLE:
        raise ValueError("a share is at most 100%")
    return Amount(number, is_share=True)


def _written(amount: Amount) -> int | str:
    return str(amount) if amount.is_share else amount.number


AmountField = Annotated[
    Amount,
    BeforeValidator(parse_amount, json_schema_input_type=int | str),
    PlainSerializer(_written, return_type=int | str),
]
"""An amount in JSON: a whole number, or a text with a percent sign."""
