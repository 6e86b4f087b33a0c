"""The second factor of users: the key of their one-time codes, and recovery codes as hashes."""

import secrets
from collections.abc import Sequence

from sqlalchemy import delete, func, select, update
from sqlalchemy.engine import CursorResult
from sqlalchemy.orm import Session

from rtron.service.domain.errors import ConflictError, ForbiddenError, NotFoundError
from rtron.service.domain.one_time_codes import DIGITS, matching_step, new_key
from rtron.service.store.accounts.random_secrets import READABLE_CHARACTERS, secret_digest
from rtron.service.store.tables import RecoveryCodeRow, SecondFactorRow, UserRow

_KEY_BYTES = 20
_RECOVERY_CODES = 10
_RECOVERY_LENGTH = 16
"""Of 31 characters: 79 bits, so a plain SHA-256 tells nothing."""


def has_second_factor(session: Session, user: UserRow) -> bool:
    """Tell whether a user logs in with a code beside the password."""
    return _factor(session, user, is_confirmed=True) is not None


def count_recovery_codes(session: Session, user: UserRow) -> int:
    """Return how many recovery codes a user has not used."""
    query = select(func.count()).select_from(RecoveryCodeRow)
    return session.scalars(query.where(RecoveryCodeRow.user_id == user.id)).one()


def begin_enrolment(session: Session, now: int, user: UserRow) -> str:
    """Give a user a key, which counts once a code of it is shown; ConflictError if there is one."""
    if has_second_factor(session, user):
        raise ConflictError(f"{user.name} has a second factor", help="remove that one first")
    remove_second_factor(session, user)
    key = new_key(secrets.token_bytes(_KEY_BYTES))
    session.add(
        SecondFactorRow(user_id=user.id, key=key, is_confirmed=False, used_step=0, created=now)
    )
    return key


def confirm_enrolment(session: Session, now: int, user: UserRow, code: str) -> Sequence[str]:
    """Put the key in force; return the recovery codes, told this once.

    NotFoundError if none was begun, ForbiddenError if the code is wrong.
    """
    factor = _factor(session, user, is_confirmed=False)
    if factor is None:
        raise NotFoundError("no enrolment has begun", help="begin it, then confirm it with a code")
    step = matching_step(factor.key, _plain(code), now, factor.used_step)
    if step is None:
        raise ForbiddenError("the code is wrong", help="is the clock of the phone right?")
    factor.is_confirmed, factor.used_step = True, step
    codes = [_new_recovery_code() for _ in range(_RECOVERY_CODES)]
    session.add_all(
        RecoveryCodeRow(digest=secret_digest(_plain(each)), user_id=user.id) for each in codes
    )
    return codes


def is_one_time_code(code: str) -> bool:
    """Tell whether a text is a code of a phone, not one for recovery."""
    plain = _plain(code)
    return plain.isdecimal() and len(plain) == DIGITS


def use_code(session: Session, now: int, user: UserRow, code: str) -> bool:
    """Use up a code of a user's phone, or a recovery code; False if it is wrong, or was used."""
    if is_one_time_code(code):
        return _use_one_time_code(session, now, user, _plain(code))
    is_right = RecoveryCodeRow.digest == secret_digest(_plain(code))
    return changes_one(
        session, delete(RecoveryCodeRow).where(is_right, RecoveryCodeRow.user_id == user.id)
    )


def remove_second_factor(session: Session, user: UserRow) -> None:
    """Let a user log in with the password alone; the recovery codes are worthless."""
    session.execute(delete(RecoveryCodeRow).where(RecoveryCodeRow.user_id == user.id))
    session.execute(delete(SecondFactorRow).where(SecondFactorRow.user_id == user.id))


def _use_one_time_code(session: Session, now: int, user: UserRow, code: str) -> bool:
    factor = _factor(session, user, is_confirmed=True)
    if factor is None:
        return False
    step = matching_step(factor.key, code, now, factor.used_step)
    if step is None:
        return False
    is_newer = SecondFactorRow.used_step < step
    change = update(SecondFactorRow).where(SecondFactorRow.user_id == user.id, is_newer)
    return changes_one(session, change.values(used_step=step))


def changes_one(session: Session, statement: object) -> bool:
    """Tell whether a row was there; of two requests at once, the database lets one have it."""
    result = session.execute(statement)  # type: ignore[call-overload]
    assert isinstance(result, CursorResult)  # noqa: S101 - of a change
    return result.rowcount == 1


def _factor(session: Session, user: UserRow, *, is_confirmed: bool) -> SecondFactorRow | None:
    query = select(SecondFactorRow).where(SecondFactorRow.user_id == user.id)
    return session.scalar(query.where(SecondFactorRow.is_confirmed.is_(is_confirmed)))


def _new_recovery_code() -> str:
    letters = [secrets.choice(READABLE_CHARACTERS) for _ in range(_RECOVERY_LENGTH)]
    return "-".join("".join(letters[at : at + 4]) for at in range(0, _RECOVERY_LENGTH, 4))


def _plain(code: str) -> str:
    """Return a code as it is kept, however somebody has typed it."""
    return "".join(code.split()).replace("-", "").lower()
