"""What a shell script starts: `rosrun`, `roslaunch` and `rostopic pub` lines, read and never run.

Words with variables, globs or substitutions are not known (ROS wiki: rosbash).
"""

import re
import shlex
from collections.abc import Iterable, Iterator
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bounded_file import read_regular_file
from rtron.sources.declaration import Declaration, DeclarationKind, NodeInterface, RuntimeStart
from rtron.vocabulary import Evidence, UnresolvedItem
from rtron.vocabulary.launch import resolve_name

MAX_BYTES = 4 * 1024 * 1024

_TOOLS = ("rosrun", "roslaunch", "rostopic")
_MENTIONED = re.compile(r"\b(rosrun|roslaunch|rostopic)\b")
_CODE_OPTIONS = frozenset({"-c", "-e", "-"})
_INNER = re.compile(r"`|\$\(")
_SETUP = re.compile(r"(^|/)(local_)?setup\.(ba|z)?sh$|(^|/)\.(bashrc|profile|zshrc)$")
_INTERPRETER = re.compile(r"(python[\d.]*|perl|ruby|node)$")
_SHELL = re.compile(r"(ba|da|z|k)?sh$")
_SEPARATORS = frozenset({";", "&", "&&", "|", "||", "(", ")", "{", "}", "|&"})
_UNKNOWN = re.compile(r"[$`*?]")
_PREFIXES = frozenset(
    {"env", "exec", "nohup", "sudo", "time", "then", "do", "else", "if", "!", "-e"}
)
_OPTIONS_WITH_VALUE = frozenset(
    {"-r", "--rate", "-p", "--port", "-w", "-c", "--num-workers", "-t", "--timeout"}
)


def read_shell_script(path: Path) -> NodeInterface:
    """Return what a script starts and publishes."""
    try:
        text = read_regular_file(path, MAX_BYTES).decode("utf-8", "replace")
    except InputError as error:
        fault = UnresolvedItem(what=path.name, why=str(error), evidence=(Evidence(file=str(path)),))
        return NodeInterface(unresolved=(fault,))
    found = [
        one for line, words in _commands(text) for one in _read_command(words, str(path), line)
    ]
    found += _dynamic_commands(text, str(path))
    return NodeInterface(
        declarations=tuple(one for one in found if isinstance(one, Declaration)),
        runtime_starts=tuple(one for one in found if isinstance(one, RuntimeStart)),
        unresolved=tuple(one for one in found if isinstance(one, UnresolvedItem)),
    )


def _commands(text: str) -> Iterator[tuple[int, list[str]]]:
    """Yield each simple command that names one of the tools first, with its line."""
    for number, line in _lines(text):
        if _MENTIONED.search(line):
            for tool in filter(None, map(_tool_command, _simple_commands(split_words(line)))):
                yield number, tool


def _dynamic_commands(text: str, file: str) -> Iterator[UnresolvedItem]:
    """Yield a note for each command whose code stands elsewhere or is made when it runs."""
    for number, line in _lines(text):
        for command in _simple_commands(split_words(line)):
            why = _unknown_reason(command)
            if why:
                location = Evidence(file=file, line=number)
                yield UnresolvedItem(what=" ".join(command)[:80], why=why, evidence=(location,))


def _simple_commands(words: Iterable[str]) -> Iterator[list[str]]:
    command: list[str] = []
    for word in (*words, ";"):
        if word not in _SEPARATORS:
            command.append(word)
            continue
        yield _without_prefixes(command)
        command = []


def _unknown_reason(command: list[str]) -> str:
    """Return why it is not known what a command does, empty where that is plain."""
    tool, rest = command[0].rpartition("/")[2] if command else "", command[1:]
    if tool in {"source", "."}:
        return "" if rest and _SETUP.search(rest[0]) else "the file that it reads is not looked at"
    is_shell = _SHELL.match(tool) and (not rest or "-c" in rest)
    if tool == "eval" or is_shell or (_INTERPRETER.match(tool) and _CODE_OPTIONS & {*rest}):
        return "runs code that is not looked at"
    inner = any(_INNER.search(word) and _MENTIONED.search(word) for word in rest)
    return "which command it runs is not known" if inner or tool[:1] in {"$", "`"} else ""


def _without_prefixes(command: list[str]) -> list[str]:
    """Return a command without what may stand before it."""
    words = list(command)
    while words and (words[0] in _PREFIXES or re.fullmatch(r"\w+=.*", words[0], re.DOTALL)):
        words.pop(0)
    return words


def _lines(text: str) -> Iterator[tuple[int, str]]:
    joined, first = "", 0
    for number, line in enumerate(text.splitlines(), start=1):
        first = first or number
        if line.endswith("\\"):
            joined += line[:-1] + " "
            continue
        yield first, joined + line
        joined, first = "", 0
    if joined:
        yield first, joined


def split_words(text: str, punctuation: str = "();<>|&") -> list[str]:
    """Return a command line's words; what stands between commands is a word of its own."""
    lexer = shlex.shlex(text, posix=True, punctuation_chars=punctuation)
    lexer.whitespace_split = True
    try:
        return list(lexer)
    except ValueError:
        return text.split()


def _tool_command(words: list[str]) -> list[str]:
    return words if words and words[0].rpartition("/")[2] in _TOOLS else []


def _read_command(
    words: list[str], file: str, line: int
) -> Iterator[Declaration | RuntimeStart | UnresolvedItem]:
    tool, location = words[0].rpartition("/")[2], Evidence(file=file, line=line)
    rest = positional_words(words[1:])
    if tool == "rostopic" and (rest[:1] != ["pub"] or len(rest) < len(["pub", "TOPIC", "TYPE"])):
        return
    named = rest[1:3] if tool == "rostopic" else rest[:2]
    if not named or any(_UNKNOWN.search(word) for word in named):
        what = " ".join([tool, *rest[:3]])
        yield UnresolvedItem(what=what, why="its words are not known", evidence=(location,))
    elif tool == "rostopic":
        name = resolve_name(named[0], "/rostopic")
        kind = DeclarationKind.PUBLISH
        yield Declaration(kind=kind, name=name, type=named[1], evidence=(location,))
    elif tool == "rosrun" and len(rest) > 1:
        arguments = ("rosrun", *rest[2:])
        yield RuntimeStart(path="/".join(named), args=arguments, evidence=(location,))
    elif tool == "roslaunch":
        path, args = launch_file_arguments(rest)
        yield RuntimeStart(path=path, args=args, evidence=(location,))


def launch_file_arguments(words: list[str]) -> tuple[str, tuple[str, ...]]:
    """Return the file, or `package/file`, that `roslaunch` starts, and its arguments."""
    is_path = "/" in words[0] or words[0].endswith((".launch", ".xml"))
    if is_path or len(words) == 1 or ":=" in words[1]:
        return words[0], tuple(words[1:])
    return "/".join(words[:2]), tuple(words[2:])


def positional_words(words: list[str]) -> list[str]:
    """Return the words of a tool's command line that are no options nor their values."""
    words_left, skipped = [], False
    for word in words:
        if skipped:
            skipped = False
        elif word in {">", ">>", "<"}:
            break
        elif word.startswith("-") and ":=" not in word:
            skipped = word in _OPTIONS_WITH_VALUE
        else:
            words_left.append(word)
    return words_left
