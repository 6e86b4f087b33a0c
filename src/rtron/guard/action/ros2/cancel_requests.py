"""A client's cancel of several goals: asked of the server one by one, answered as one."""

from collections import defaultdict

from rtron.guard.action.ros2.endpoints import NONE, REJECTED, AnswerCancel, Cancelled


class Gathering:
    """Gathers the answers for the goals of one cancel, and answers when the last has come.

    A client's cancel never goes to the server as it is: by a stamp, or without an id, it would
    mean the goals of others too.
    """

    def __init__(self, answer: AnswerCancel) -> None:
        self._answer: AnswerCancel | None = answer
        self._open: set[bytes] = set()
        self._ending: list[tuple[bytes, int]] = []
        self._meant = self._complete = False

    def ends(self, id: bytes, stamp: int) -> None:
        """Note a goal that will end."""
        self._meant = True
        self._ending.append((id, stamp))

    def await_(self, id: bytes) -> None:
        """Wait for what becomes of a goal."""
        self._meant = True
        self._open.add(id)

    def told(self, id: bytes, stamp: int, *, ends: bool) -> None:
        """Learn whether a goal that is waited for will end."""
        if id in self._open:
            self._open.discard(id)
            if ends:
                self.ends(id, stamp)
            self._finish()

    def complete(self) -> None:
        """Know all goals of the cancel; answer as soon as none is open."""
        self._complete = True
        self._finish()

    def give_up(self) -> None:
        """Answer with what is known."""
        self._open.clear()
        self._complete = True
        self._finish()

    def _finish(self) -> None:
        if self._answer and self._complete and not self._open:
            answer, self._answer = self._answer, None
            refused = self._meant and not self._ending
            answer(Cancelled(REJECTED if refused else NONE, tuple(self._ending)))


class Gatherings:
    """The gatherings that wait for what becomes of a goal."""

    def __init__(self) -> None:
        self._waiting: dict[bytes, list[Gathering]] = defaultdict(list)

    def await_(self, id: bytes, gathering: Gathering) -> None:
        """Let a gathering wait for what becomes of a goal."""
        gathering.await_(id)
        self._waiting[id].append(gathering)

    def told(self, id: bytes, stamp: int, *, ends: bool) -> None:
        """Tell all that wait for a goal whether it will end."""
        for gathering in self._waiting.pop(id, ()):
            gathering.told(id, stamp, ends=ends)
