"""Random CMake programs of a seed: what they do is found out by running them in cmake itself."""

import random
from dataclasses import dataclass, field

NAMES = ("A", "B", "L", "M")
WORDS = ("x", "y", "my_z", "a.cpp", "b.cpp", "sub/c.cpp", "x_node")
PATTERNS = ("x", "x", "y", "^my_", "^my_", "\\\\.cpp$", "\\\\.cpp$", ".*_node$", "(x|y)")
_MAX_DEPTH = 3


@dataclass
class ProgramWriter:
    """Writes one program; `functions` are the functions and macros defined so far."""

    random: random.Random
    lines: list[str] = field(default_factory=list)
    functions: list[str] = field(default_factory=list)
    depth: int = 0

    def write(self, statements: int) -> str:
        """Return a program of some statements."""
        self.lines += (f"set({name} {self.random.choice(WORDS)} a.cpp)" for name in NAMES)
        for _ in range(statements):
            self._statement()
        for name in NAMES:
            self.lines.append(f"add_executable(end_{name} ${{{name}}} a.cpp)")
        return "\n".join(self.lines) + "\n"

    def _statement(self) -> None:
        kinds = [self._set, self._list, self._string, self._path, self._target, self._call]
        if self.depth < _MAX_DEPTH:
            kinds += [self._if, self._foreach]
        kinds += [self._glob] if self.random.random() < 0.3 else []
        if self.depth == 0:
            kinds += [self._define]
        self.random.choice(kinds)()

    def _name(self) -> str:
        return self.random.choice(NAMES)

    def _word(self) -> str:
        return self.random.choice((*WORDS, *(f"${{{name}}}" for name in NAMES)))

    def _words(self, most: int = 3) -> str:
        return " ".join(self._word() for _ in range(self.random.randint(1, most)))

    def _set(self) -> None:
        scope = self.random.choice(("", "", "", " PARENT_SCOPE")) if self.depth else ""
        self.lines.append(
            self.random.choice(
                (*[f"set({self._name()} {self._words()}{scope})"] * 9, f"unset({self._name()})")
            )
        )

    def _list(self) -> None:
        name, result = self._name(), self._name()
        pattern = self.random.choice(PATTERNS)
        self.lines.append(
            self.random.choice(
                (
                    f"list(APPEND {name} {self._words()})",
                    f"list(PREPEND {name} {self._words()})",
                    f"list(REMOVE_ITEM {name} {self._words()})",
                    f"list(REMOVE_DUPLICATES {name})",
                    f"list(REVERSE {name})",
                    f"list(SORT {name})",
                    f"list(LENGTH {name} {result})",
                    f"list(FIND {name} {self.random.choice(WORDS)} {result})",
                    f"list(JOIN {name} _ {result})",
                    f"list(APPEND {name} x)\nlist(GET {name} -1 {result})",
                    f"list(APPEND {name} x y)\nlist(SUBLIST {name} 1 -1 {result})",
                    f"list(APPEND {name} x y)\nlist(POP_FRONT {name} {result})",
                    f"list(APPEND {name} x y)\nlist(POP_BACK {name})",
                    f"list(APPEND {name} x y)\nlist(REMOVE_AT {name} 0)",
                    f'list(FILTER {name} INCLUDE REGEX "{pattern}")',
                    f'list(FILTER {name} EXCLUDE REGEX "{pattern}")',
                    f"list(TRANSFORM {name} APPEND _n)",
                    f"list(TRANSFORM {name} TOUPPER)",
                    f'list(TRANSFORM {name} REPLACE "{pattern}" "w")',
                )
            )
        )

    def _string(self) -> None:
        result, word = self._name(), self._word()
        self.lines.append(
            self.random.choice(
                (
                    f'string(TOLOWER "{word}" {result})',
                    f'string(TOUPPER "{word}" {result})',
                    f'string(REPLACE ".cpp" "" {result} "{word}")',
                    f'string(REPLACE "x" "y" {result} {word} z)',
                    f'string(REGEX REPLACE "{self.random.choice(PATTERNS)}" "q" {result} "{word}")',
                    f'string(CONCAT {result} "{word}" _ {self.random.choice(WORDS)})',
                    f"string(APPEND {result} _q)",
                    f"string(PREPEND {result} q_)",
                    f'string(JOIN _ {result} "{word}" q)',
                    f'string(LENGTH "{word}" {result})',
                    f'string(SUBSTRING "{word}xx" 0 2 {result})',
                    f'string(FIND "{word}" x {result})',
                    f'string(STRIP " {word} " {result})',
                )
            )
        )

    def _path(self) -> None:
        part = self.random.choice(("NAME", "NAME_WE", "EXT", "DIRECTORY", "NAME_WLE", "LAST_EXT"))
        self.lines.append(f'get_filename_component({self._name()} "{self._word()}" {part})')

    def _target(self) -> None:
        made = f"t{len(self.lines)}"
        name = self.random.choice((made, f"{made}_${{{self._name()}}}", f"${{{self._name()}}}_n"))
        self.lines.append(f'add_executable("{name}" a.cpp {self._words()})')

    def _condition(self) -> str:
        name = self._name()
        return self.random.choice(
            (
                name,
                f"NOT {name}",
                f'"${{{name}}}" STREQUAL "{self.random.choice(WORDS)}"',
                f'"${{{name}}}" MATCHES "{self.random.choice(PATTERNS)}"',
                f'"{self.random.choice(WORDS)}" IN_LIST {name}',
                f"DEFINED {name}",
                f'"${{{name}}}" STREQUAL "" OR ON',
                f"(TRUE AND NOT {name}) OR FALSE",
            )
        )

    def _block(self, head: str) -> None:
        self.lines.append(head)
        self.depth += 1
        for _ in range(self.random.randint(1, 3)):
            self._statement()
        self.depth -= 1

    def _if(self) -> None:
        self._block(f"if({self._condition()})")
        if self.random.random() < 0.3:
            self._block(f"elseif({self._condition()})")
        if self.random.random() < 0.5:
            self._block("else()")
        self.lines.append("endif()")

    def _foreach(self) -> None:
        head = self.random.choice(
            (
                f"foreach(A {self._words()})",
                f"foreach(B IN LISTS L M ITEMS {self.random.choice(WORDS)})",
                "foreach(A B IN ZIP_LISTS L M)",
                f"foreach(A RANGE {self.random.randint(0, 2)})",
            )
        )
        self._block(head)
        if self.random.random() < 0.2:
            self.lines.append(self.random.choice(("break()", "continue()")))
        self.lines.append("endforeach()")

    def _glob(self) -> None:
        pattern = self.random.choice(("*.cpp", "[ab].cpp", "s*/*.cpp", "*"))
        kind = self.random.choice(("GLOB", "GLOB_RECURSE"))
        start = "${CMAKE_CURRENT_LIST_DIR}"
        found = f"file({kind} {self._name()} RELATIVE {start} {start}/{pattern})"
        self.lines += [found, f"list(FILTER {self._name()} EXCLUDE REGEX run.cmake)"]

    def _define(self) -> None:
        kind, name = self.random.choice(("function", "macro")), f"f{len(self.lines)}"
        self._block(f"{kind}({name} B)")
        if kind == "function" and self.random.random() < 0.3:
            self.lines += [f"if({self._condition()})", "return()", "endif()"]
        if kind == "function" and self.random.random() < 0.3:
            self.lines += [
                'cmake_parse_arguments(P "x" "y" "my_z;x_node" ${ARGN})',
                "add_executable(p_${P_x}_${P_y} a.cpp ${P_my_z} ${P_UNPARSED_ARGUMENTS})",
            ]
        self.lines.append(f"add_executable(of_{name}_${{B}} ${{ARGN}} a.cpp)")
        if kind == "function" and self.random.random() < 0.3:
            self.lines.append("return()")
        self.lines.append(f"end{kind}()")
        self.functions.append(name)

    def _call(self) -> None:
        if self.functions:
            self.lines.append(f"{self.random.choice(self.functions)}({self._words(4)})")


def random_program(seed: int) -> str:
    """Return the program of a seed."""
    writer = ProgramWriter(random.Random(seed))
    return writer.write(writer.random.randint(4, 14))
