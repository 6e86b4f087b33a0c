"""The commands of a shell's line, read and never run.

POSIX.1-2017, Shell Command Language: tokens, quoting, redirection, lists; bash(1): invocation.
"""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from rtron.sources.launch.ros2.command_line import split_words

_SHELLS = frozenset({"bash", "sh", "dash", "zsh"})
_VALUED_OPTIONS = ("o", "O", "--rcfile", "--init-file")
"""How the options of a shell end that take a value."""

_PLACEHOLDER = "\ue000[^\ue000\ue001]*\ue001"
_SINGLE = f"'(?:{_PLACEHOLDER}|[^'\ue000])*'"
_DOUBLE = f'"(?:{_PLACEHOLDER}|\\\\.|[^"\\\\\ue000])*"'
_COMMAND_SUBSTITUTION = r"\$\((?:[^()]|\([^()]*\))*\)|\$\(|`[^`]*`"
_PART = (
    f"{_PLACEHOLDER}|\\\\.|{_SINGLE}|{_DOUBLE}|{_COMMAND_SUBSTITUTION}|[^\\s;&|()<>\\\\\ue000]|\\\\"
)
_TOKEN = re.compile(
    rf"\\\n|\#[^\n]*|<<-?(?!<)[ \t]*(?P<document>(?:{_PART})+)"
    rf"|(?:\d+|&)?(?:<<<|<&|<>|>>|>&|>\||[<>])[ \t]*(?:{_PART})*"
    rf"|(?P<between>[;&|()\n])|(?P<word>(?:{_PART})+)",
    re.DOTALL,
)
_QUOTATION = re.compile(f"({_PLACEHOLDER})|\\\\(.)|({_SINGLE})|({_DOUBLE})", re.DOTALL)
_ESCAPED = re.compile(r'\\([\\"$`\n])')


def split_commands(words: Sequence[str], *, shell: bool) -> Iterator[tuple[str, ...]]:
    """Yield the words of each command that a process runs; `shell` runs its line by a shell."""
    if shell:
        yield from _commands_of_line(" ".join(words))
    else:
        yield from _commands_of_command(
            tuple(split_words(words[0])) if len(words) == 1 else tuple(words)
        )


def _commands_of_line(line: str) -> Iterator[tuple[str, ...]]:
    for command in filter(None, _split_line(line)):
        yield from _commands_of_command(command)


def _commands_of_command(command: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """Yield a command, or those of the script that it gives to a shell (`bash -c SCRIPT`)."""
    script = _shell_script(command)
    if script.strip():
        yield from _commands_of_line(script)
    else:
        yield command


def _shell_script(command: Sequence[str]) -> str:
    """Return the script that a shell is given; empty for another command, or a file."""
    if not command or Path(command[0]).name not in _SHELLS:
        return ""
    takes_script, words = False, iter(command[1:])
    for word in words:
        if not word.startswith("-"):
            return word if takes_script else ""
        takes_script = takes_script or (not word.startswith("--") and "c" in word)
        if word.endswith(_VALUED_OPTIONS):
            next(words, "")
    return ""


def _split_line(line: str) -> Iterator[tuple[str, ...]]:
    """Yield the words of each command of a line, without redirections and comments.

    A document inside the line may be a script: it ends what is known, as a command `<<`.
    """
    words: list[str] = []
    for token in _TOKEN.finditer(line):
        if token["word"]:
            words.append(_unquoted(token["word"]))
        elif token["between"]:
            yield tuple(words)
            words = []
        elif token["document"]:
            yield from (tuple(words), ("<<", token["document"]))
            return
    yield tuple(words)


def _unquoted(word: str) -> str:
    return _QUOTATION.sub(_literal_text, word)


def _literal_text(part: re.Match[str]) -> str:
    placeholder, escaped, single, double = part.groups()
    if placeholder or single:
        return placeholder or single[1:-1]
    if escaped:
        return escaped.strip("\n")
    return _ESCAPED.sub(lambda found: found[1].strip("\n"), double[1:-1])
