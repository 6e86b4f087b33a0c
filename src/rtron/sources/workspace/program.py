"""What runs when a launch names an executable: its language and its files."""

import hashlib
from dataclasses import dataclass
from pathlib import Path

from rtron.sources.bounded_file import content_hash
from rtron.vocabulary import StringEnum


class ProgramLanguage(StringEnum):
    """What a program is written in."""

    CPP = "cpp"
    PYTHON = "python"
    SHELL = "sh"
    OTHER = "other"


@dataclass(frozen=True, slots=True, kw_only=True)
class Program:
    """An executable, a library or a script of a package.

    `sources` are its own files and those of the libraries of its package that it links, its own
    first. `entry` is the function of a Python module that is called, or the class of a component;
    empty where the file itself is run.
    """

    name: str
    package: str
    language: ProgramLanguage
    sources: tuple[Path, ...] = ()
    definitions: tuple[str, ...] = ()
    entry: str = ""


def program_digest(program: Program) -> str:
    """Return a hash over a program's files, definitions and language, in hexadecimal.

    A file that cannot be read counts by its name alone.
    """
    digest = hashlib.sha256()
    for text in (program.language, program.package, program.name, *program.definitions):
        digest.update(f"{text}\0".encode("utf-8", "surrogateescape"))
    for path in program.sources:
        digest.update(str(path).encode("utf-8", "surrogateescape") + content_hash(path).encode())
    return digest.hexdigest()
