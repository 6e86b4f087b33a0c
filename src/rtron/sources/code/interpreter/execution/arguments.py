"""What a call passes, as native functions see it."""

from collections.abc import Callable, Mapping
from dataclasses import field

from rtron.sources.code.interpreter.abstract_values.value_types import Value
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame, StorageSlot
from rtron.sources.code.ir import TypeRef
from rtron.sources.code.record import record
from rtron.vocabulary import Evidence


@record(frozen=True, slots=True, kw_only=True)
class Arguments:
    """The values of a call, and the places of those that have one, to be written to by C++.

    `types` are the template arguments, `frame` is the caller's.
    """

    values: tuple[Value, ...] = ()
    keywords: Mapping[str, Value] = field(default_factory=dict)
    slots: tuple[StorageSlot | None, ...] = ()
    types: tuple[TypeRef, ...] = ()
    line: int = 0
    frame: StackFrame

    @property
    def evidence(self) -> Evidence:
        """Where the call stands."""
        return Evidence(file=self.frame.file, line=self.line)

    def get(self, index: int, keyword: str = "") -> Value | None:
        """Return the argument of a position or name, None where it is not given."""
        if index < len(self.values):
            return self.values[index]
        return self.keywords.get(keyword) if keyword else None

    def slot(self, index: int) -> StorageSlot | None:
        """Return where the argument of a position is kept."""
        return self.slots[index] if index < len(self.slots) else None

    def without_first(self, count: int) -> "Arguments":
        """Return the arguments behind the first `count`."""
        return Arguments(
            values=self.values[count:],
            keywords=self.keywords,
            slots=self.slots[count:],
            types=self.types,
            line=self.line,
            frame=self.frame,
        )


LibraryCall = Callable[..., Value]
