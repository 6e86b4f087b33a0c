"""Splits a CMake file into its commands and their arguments (cmake-language(7))."""

import re
from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TypeAlias

MAX_PROBLEMS = 10
MAX_ARGUMENTS = 10_000

_BLANK = re.compile(r"(?:[ \t\r\n]+|#(?!\[=*\[)[^\n]*)*")
_NAME = re.compile(r"([A-Za-z_]\w*)[ \t\r\n]*\(")
_BRACKET = re.compile(r"\[(=*)\[\n?")
_QUOTED = re.compile(r'"((?:[^"\\]|\\.)*)"', re.DOTALL)
_UNQUOTED = re.compile(
    r"""(?:[^\s()\#"\\]|\\.)                      # a legacy argument may quote a part of itself
        (?:[^\s()\#"\\]|\\.|"(?:[^"\\]|\\.)*")*""",
    re.DOTALL | re.VERBOSE,
)
_CONTINUATION = re.compile(r"\\\r?\n")


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandArgument:
    """An argument as written: `quoted` is never split, `raw` (in brackets) never expanded."""

    text: str
    quoted: bool = False
    raw: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class CMakeCommand:
    """A command: its name in lower case, its arguments, parentheses among them, and its line."""

    name: str
    arguments: tuple[CommandArgument, ...] = ()
    line: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class SyntaxProblem:
    """What is wrong at a line of the file."""

    why: str
    line: int


class _CMakeSyntaxError(Exception):
    pass


def read_commands(text: str) -> tuple[list[CMakeCommand], list[SyntaxProblem]]:
    """Return the commands of a file and its problems.

    After a problem reading goes on in the next line, MAX_PROBLEMS times at most.
    """
    scanner = _Scanner(text)
    commands: list[CMakeCommand] = []
    problems: list[SyntaxProblem] = []
    while len(problems) < MAX_PROBLEMS:
        start = scanner.position
        try:
            command = scanner.command()
        except _CMakeSyntaxError as error:
            start = max(scanner.command_start, start)
            problems.append(SyntaxProblem(why=str(error), line=scanner.line(start)))
            scanner.skip_line(start)
            continue
        if command is None:
            break
        commands.append(command)
    return commands, problems


class _Scanner:
    """A position in the text; `command_start` is where the present command began."""

    def __init__(self, text: str) -> None:
        self.position = 0
        self.command_start = 0
        self._text = text
        self._newlines = [match.start() for match in re.finditer("\n", text)]

    def line(self, position: int) -> int:
        """Return the line of a position, from 1."""
        return bisect_right(self._newlines, position - 1) + 1

    def skip_line(self, position: int) -> None:
        """Go to the line after that of `position`."""
        end = self._text.find("\n", position)
        self.position = len(self._text) if end < 0 else end + 1

    def command(self) -> CMakeCommand | None:
        """Return the next command, None at the end."""
        self._skip_blank()
        self.command_start = self.position
        if self.position == len(self._text):
            return None
        match = _NAME.match(self._text, self.position)
        if match is None:
            raise _CMakeSyntaxError("a command is expected")
        self.position = match.end()
        arguments = tuple(self._arguments())
        return CMakeCommand(
            name=match[1].lower(), arguments=arguments, line=self.line(self.command_start)
        )

    def _arguments(self) -> list[CommandArgument]:
        found: list[CommandArgument] = []
        depth = 1
        while True:
            self._skip_blank()
            sign = self._text[self.position : self.position + 1]
            depth += (sign == "(") - (sign == ")")
            if depth == 0:
                self.position += 1
                return found
            if len(found) == MAX_ARGUMENTS:
                raise _CMakeSyntaxError(f"a command has more than {MAX_ARGUMENTS} arguments")
            found.append(self._argument(sign))

    def _argument(self, sign: str) -> CommandArgument:
        if not sign:
            raise _CMakeSyntaxError("a command does not end")
        if sign in "()":
            self.position += 1
            return CommandArgument(text=sign)
        if bracket := _BRACKET.match(self._text, self.position):
            return CommandArgument(text=self._bracketed(bracket), quoted=True, raw=True)
        if sign == '"':
            return self._quoted()
        return self._unquoted()

    def _quoted(self) -> CommandArgument:
        match = _QUOTED.match(self._text, self.position)
        if match is None:
            raise _CMakeSyntaxError("a quoted argument does not end")
        self.position = match.end()
        return CommandArgument(text=_CONTINUATION.sub("", match[1]), quoted=True)

    def _unquoted(self) -> CommandArgument:
        match = _UNQUOTED.match(self._text, self.position)
        if match is None:
            raise _CMakeSyntaxError("a backslash stands alone")
        self.position = match.end()
        return CommandArgument(text=match[0])

    def _bracketed(self, opening: re.Match[str]) -> str:
        closing = f"]{opening[1]}]"
        end = self._text.find(closing, opening.end())
        if end < 0:
            raise _CMakeSyntaxError("a bracket does not end")
        self.position = end + len(closing)
        return self._text[opening.end() : end]

    def _skip_blank(self) -> None:
        while True:
            blank = _BLANK.match(self._text, self.position)
            self.position = blank.end() if blank else self.position
            comment = self._text[self.position : self.position + 1] == "#"
            bracket = _BRACKET.match(self._text, self.position + 1) if comment else None
            if bracket is None:
                return
            self._bracketed(bracket)


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
