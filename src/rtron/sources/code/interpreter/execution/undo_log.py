"""Writes that can be taken back, so that both sides of an undecided branch see the same past."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from rtron.sources.code.interpreter import abstract_values as av

Write: TypeAlias = tuple[dict[Any, Any], Any, Any]
"""Where something was written, and what stood there before."""
Writes: TypeAlias = dict[tuple[int, Any], tuple[dict[Any, Any], Any, Any]]

MISSING = object()


@dataclass(slots=True)
class UndoLog:
    """Every write to a frame's variables or an object's fields goes through `set`.

    `elementwise` says that lists of one length, left by branches, are joined item by item.
    """

    elementwise: bool = False
    _log: list[Write] = field(default_factory=list)
    _depth: int = 0

    def set(self, storage: dict[Any, Any], key: Any, value: Any) -> None:  # noqa: ANN401 - any key
        """Write a value where it can be taken back."""
        if self._depth:
            self._log.append((storage, key, storage.get(key, MISSING)))
        storage[key] = value

    def mark_open(self, storage: dict[Any, Any]) -> None:
        """Note that a list may hold more than its items."""
        self.set(storage, "open", value=True)

    def remove(self, storage: dict[Any, Any], key: Any) -> None:  # noqa: ANN401 - any key
        """Take a key away where it can be put back."""
        if self._depth:
            self._log.append((storage, key, storage[key]))
        del storage[key]

    def run_branches(self, branches: Sequence[Callable[[], bool]], locals_: dict[Any, Any]) -> None:
        """Run each branch from the same state, then let every slot hold what any of them left.

        A branch returns whether it goes on behind the branches; of one that does not, what it
        wrote to `locals_` is forgotten.
        """
        results = [self.run_and_undo(branch) for branch in branches]
        surviving = [
            _surviving_writes(writes, locals_, goes_on=goes_on) for writes, goes_on in results
        ]
        written = {key: (storage, name) for w in surviving for key, (storage, name, _) in w.items()}
        for key, (storage, name) in written.items():
            before = storage.get(name, MISSING)
            after = [w[key][2] if key in w else before for w in surviving]
            found = [value for value in after if value is not MISSING]
            if found:
                self.set(storage, name, _join_values(found, elementwise=self.elementwise))
            elif name in storage:
                self.remove(storage, name)

    @contextmanager
    def gather_writes(self) -> Iterator[list[Write]]:
        """Give what is written meanwhile, each place once; it stays written."""
        mark, found = len(self._log), list[Write]()
        self._depth += 1
        try:
            yield found
        finally:
            self._depth -= 1
            first = {(id(write[0]), write[1]): write for write in reversed(self._log[mark:])}
            found.extend(first.values())
            if not self._depth:
                del self._log[mark:]

    def run_and_undo(self, branch: Callable[[], bool]) -> tuple[Writes, bool]:
        """Run a branch and take its writes back; return them, and what the branch returned."""
        mark = len(self._log)
        self._depth += 1
        try:
            goes_on = branch()
        finally:
            self._depth -= 1
            writes = self._undo(mark)
        return writes, goes_on

    def _undo(self, mark: int) -> Writes:
        writes: Writes = {}
        while len(self._log) > mark:
            storage, key, old = self._log.pop()
            at = id(storage), key
            if at not in writes:
                writes[at] = (storage, key, storage.get(key, MISSING))
            if old is MISSING:
                storage.pop(key, None)
            else:
                storage[key] = old
        return writes


def _surviving_writes(writes: Writes, locals_: dict[Any, Any], *, goes_on: bool) -> Writes:
    if goes_on:
        return writes
    return {key: write for key, write in writes.items() if write[0] is not locals_}


def _union_items(values: list[tuple[Any, ...]]) -> tuple[Any, ...]:
    """Return the items of every branch, each once."""
    longest = max(values, key=len)
    others = (item for value in values if value is not longest for item in value)
    return (
        *longest,
        *(item for item in others if not any(item is o or item == o for o in longest)),
    )


def _join_values(values: list[Any], *, elementwise: bool) -> Any:  # noqa: ANN401 - a Value, a tuple of items or a flag
    first = values[0] if values else None
    if all(value is first or value == first for value in values):
        return first
    if isinstance(first, tuple) and elementwise and len(set(map(len, values))) == 1:
        return tuple(map(av.join, zip(*values, strict=True)))
    if isinstance(first, tuple):
        return _union_items(values)
    if isinstance(first, bool):
        return any(values)
    choices: list[av.Value] = values
    return av.join(choices)
