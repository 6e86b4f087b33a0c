"""Plans that roll-outs bring: where the newest accepted one is kept, and whether one may come."""

import logging
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from rtron.coherence import relaunch_reasons
from rtron.errors import InputError, RTronError
from rtron.guard.system.durable_file import make_private_folder, remove_file, replace_file
from rtron.vocabulary import Plan
from rtron.wire.common.link_protocol import MAX_PLAN_LENGTH, plan_document_digest

log = logging.getLogger(__name__)
_MAX_LISTED = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanFolder:
    """A folder of the guard's user; `start` is the plan that the guard was started with.

    `read` is the strict reader of plan files; it raises an RTronError.
    """

    folder: Path
    start: Plan
    read: Callable[[str], Plan]

    @property
    def file(self) -> Path:
        """Where the newest accepted plan is."""
        return self.folder / "plan.yaml"

    def prepare(self) -> None:
        """Make the folder; InputError if it cannot be used."""
        try:
            make_private_folder(self.folder)
        except OSError as error:
            raise InputError(f"{self.folder}: {error.strerror}", help="see --plans") from None

    def read_for(self, current: Plan, text: str) -> Plan:
        """Read a plan that is to take the place of another; RTronError if it may not."""
        if len(text) > MAX_PLAN_LENGTH:
            raise InputError(f"the plan is longer than {MAX_PLAN_LENGTH} characters")
        plan = self.read(text)
        if reasons := list(relaunch_reasons(current, plan))[:_MAX_LISTED]:
            message = f"the plan needs a new launch: rtron instrument: {', '.join(reasons)}"
            raise InputError(message)
        return plan

    def accepted(self) -> tuple[str, Plan]:
        """Return the digest and the plan to guard by: the newest accepted one, or "" and `start`.

        One that does not fit the app as it was started now stays on the disk.
        """
        try:
            text = self.file.read_text()
            plan = self.read_for(self.start, text)
        except FileNotFoundError:
            return "", self.start
        except (OSError, ValueError, RTronError) as error:
            log.error("%s is not in force, the plan of the start is: %s", self.file, error)  # noqa: TRY400
            return "", self.start
        return plan_document_digest(text), plan

    def keep(self, text: str) -> None:
        """Let a plan, or with "" that of the start, be in force after every start; OSError."""
        if text:
            replace_file(self.file, text.encode())
        else:
            remove_file(self.file)
