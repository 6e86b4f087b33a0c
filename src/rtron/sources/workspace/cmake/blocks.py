"""Nests the commands of a CMake file: if, foreach, while, macro and function hold others."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TypeAlias

from rtron.sources.workspace.cmake.tokenizer import Command, Fault

_OPENING = frozenset({"if", "foreach", "while", "macro", "function"})
_CLOSING = {f"end{name}": name for name in _OPENING}
_BRANCHING = frozenset({"elseif", "else"})


@dataclass(slots=True)
class Branch:
    """The head of a branch (`if`, `elseif`, `else`, `foreach`, …) and what stands below it."""

    head: Command
    body: "list[Statement]" = field(default_factory=list)


@dataclass(slots=True)
class Block:
    """One branch, or for an `if` one a condition."""

    branches: list[Branch]


Statement: TypeAlias = Command | Block


def nest(commands: Iterable[Command]) -> tuple[list[Statement], list[Fault]]:
    """Return the statements of a file and its faults: an end without a beginning or the reverse."""
    top: list[Statement] = []
    stack: list[Block] = []
    faults: list[Fault] = []
    for command in commands:
        body = stack[-1].branches[-1].body if stack else top
        if command.name in _OPENING:
            stack.append(Block([Branch(command)]))
            body.append(stack[-1])
        elif _fits(command, stack):
            _branch_or_close(command, stack)
        elif command.name in _CLOSING or command.name in _BRANCHING:
            faults.append(Fault(why=f"{command.name}() has no beginning", line=command.line))
        else:
            body.append(command)
    heads = (block.branches[0].head for block in stack)
    faults.extend(Fault(why=f"{head.name}() has no end", line=head.line) for head in heads)
    return top, faults


def _fits(command: Command, stack: list[Block]) -> bool:
    opened = stack[-1].branches[0].head.name if stack else ""
    return bool(stack) and (
        _CLOSING.get(command.name) == opened or (command.name in _BRANCHING and opened == "if")
    )


def _branch_or_close(command: Command, stack: list[Block]) -> None:
    if command.name in _BRANCHING:
        stack[-1].branches.append(Branch(command))
    else:
        stack.pop()
