"""One source file in the intermediate representation."""

from dataclasses import field
from enum import Enum

from rtron.sources.code.ir.declarations import Class, Function
from rtron.sources.code.ir.statements import Stmt
from rtron.sources.code.ir.types import TypeRef
from rtron.sources.code.record import record


class SourceLanguage(str, Enum):
    """The language of a unit."""

    PYTHON = "python"
    CPP = "cpp"


@record(frozen=True, slots=True)
class SourceProblem:
    """A part of a file that could not be read, and why."""

    line: int
    why: str


@record(frozen=True, slots=True, kw_only=True)
class Unit:
    """One source file.

    Python: `body` is the module's. C++: `functions` and `classes` are all of the file's, nested
    ones too, qualified; `body` holds the Declares of namespace scope (names qualified);
    `aliases` are typedefs, `using X = …` and `namespace a = b` (qualified name, type), in a class
    too; `usings` the namespaces and names opened by `using` (`using a::b;` as "a::b");
    `includes` as written with their quotes or brackets; `exports` the classes given to
    PLUGINLIB_EXPORT_CLASS and its kin (class, base); `enums` the enumerators with their values,
    qualified both with and without the enum's name.
    """

    file: str
    language: SourceLanguage
    body: tuple[Stmt, ...] = ()
    functions: tuple[Function, ...] = ()
    classes: tuple[Class, ...] = ()
    aliases: tuple[tuple[str, TypeRef], ...] = ()
    usings: tuple[str, ...] = ()
    includes: tuple[str, ...] = ()
    exports: tuple[tuple[str, str], ...] = ()
    enums: tuple[tuple[str, int | None], ...] = ()
    problems: tuple[SourceProblem, ...] = field(default=())
