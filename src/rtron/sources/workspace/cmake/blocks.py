"""Nests the commands of a CMake file: if, foreach, while, macro and function hold others."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TypeAlias

from rtron.sources.workspace.cmake.tokenizer import CMakeCommand, SyntaxProblem

_OPENING = frozenset({"if", "foreach", "while", "macro", "function"})
_CLOSING = {f"end{name}": name for name in _OPENING}
_BRANCHING = frozenset({"elseif", "else"})


@dataclass(slots=True)
class Branch:
    """The head of a branch (`if`, `elseif`, `else`, `foreach`, …) and what stands below it."""

    head: CMakeCommand
    body: "list[Statement]" = field(default_factory=list)


@dataclass(slots=True)
class CommandBlock:
    """One branch, or for an `if` one a condition."""

    branches: list[Branch]


Statement: TypeAlias = CMakeCommand | CommandBlock


def nest_blocks(commands: Iterable[CMakeCommand]) -> tuple[list[Statement], list[SyntaxProblem]]:
    """Return the statements of a file, and its problems: blocks without a beginning or an end."""
    top: list[Statement] = []
    stack: list[CommandBlock] = []
    problems: list[SyntaxProblem] = []
    for command in commands:
        body = stack[-1].branches[-1].body if stack else top
        if command.name in _OPENING:
            stack.append(CommandBlock([Branch(command)]))
            body.append(stack[-1])
        elif _continues_block(command, stack):
            _add_branch_or_close(command, stack)
        elif command.name in _CLOSING or command.name in _BRANCHING:
            problems.append(
                SyntaxProblem(why=f"{command.name}() has no beginning", line=command.line)
            )
        else:
            body.append(command)
    heads = (block.branches[0].head for block in stack)
    problems.extend(
        SyntaxProblem(why=f"{head.name}() has no end", line=head.line) for head in heads
    )
    return top, problems


def _continues_block(command: CMakeCommand, stack: list[CommandBlock]) -> bool:
    opened = stack[-1].branches[0].head.name if stack else ""
    return bool(stack) and (
        _CLOSING.get(command.name) == opened or (command.name in _BRANCHING and opened == "if")
    )


def _add_branch_or_close(command: CMakeCommand, stack: list[CommandBlock]) -> None:
    if command.name in _BRANCHING:
        stack[-1].branches.append(Branch(command))
    else:
        stack.pop()
