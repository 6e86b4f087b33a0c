"""The frame that interpreted code runs in: its variables, and what surrounds them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av


class StorageSlot(NamedTuple):
    """Where a value is kept: a frame's variables or an object's fields, and the key in them."""

    holder: dict[Any, Any]
    key: Any

    @property
    def label(self) -> str:
        """What is kept there is called: a static variable's key begins with its name."""
        return str(self.key[0] if isinstance(self.key, tuple) and self.key else self.key)


@dataclass(eq=False, slots=True, kw_only=True)
class StackFrame:
    """One call of a function, or the top of a file.

    `closure` is the frame around a Python function. `body` says that the frame is the body of a
    "class", whose names functions within do not see, or of a "comprehension". `globals` and
    `nonlocals` are the names that are declared so. `aliases` are C++ references: names that
    stand for a slot of the caller; `constants` tells of C++ names whether all of the variables
    that have it in this function are constant. `types` binds template parameters. `scope`
    is the C++ namespace or class that the code is written in. `caller` is the call that led here.
    """

    file: str
    function: ir.Function | None = None
    variables: dict[Any, Any] = field(default_factory=dict)
    closure: "StackFrame | None" = None
    globals: set[str] = field(default_factory=set)
    nonlocals: set[str] = field(default_factory=set)
    body: str = ""
    this: av.Value | None = None
    cls: av.ClassValue | None = None
    scope: str = ""
    types: Mapping[str, ir.TypeRef] = field(default_factory=dict)
    aliases: dict[str, StorageSlot] = field(default_factory=dict)
    constants: dict[str, bool] = field(default_factory=dict)
    returns: list[av.Value] = field(default_factory=list)
    yields: list[av.Value] = field(default_factory=list)
    caller: Any = None
