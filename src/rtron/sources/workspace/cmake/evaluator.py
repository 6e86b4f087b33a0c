"""Carries out a package's CMake files, both branches where only a build knows which one."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from os.path import normpath
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bounded_file import read_regular_file
from rtron.sources.workspace.cmake.build import PackageBuild
from rtron.sources.workspace.cmake.command_call import (
    BoundsError,
    CommandCall,
    ExpandedArgument,
    StepBudget,
    VariableScope,
    VariableValue,
    expand_arguments,
    split_list,
)
from rtron.sources.workspace.cmake.commands import (
    COMMANDS,
    TARGET_MAKERS,
    initial_variables,
    note_unknown_command,
)
from rtron.sources.workspace.cmake.condition import ConditionContext, Truth, evaluate_condition
from rtron.sources.workspace.cmake.tokenizer import (
    Branch,
    CMakeCommand,
    CommandArgument,
    CommandBlock,
    Statement,
    nest_blocks,
    read_commands,
)
from rtron.sources.workspace.cmake.variable_scope import (
    argument_variables,
    is_loop_unknown,
    join_variables,
    loop_rounds,
    restore_variables,
)
from rtron.sources.workspace.package_contents import LeftOut, PackageContents
from rtron.sources.workspace.package_files import PackageFiles
from rtron.vocabulary import Evidence

MAX_BYTES = 1024 * 1024
MAX_DEPTH = 48
LIST_FILE = "CMakeLists.txt"
_MAX_SHOWN = 120


class _Return(Exception):  # noqa: N818 - CMake's return(), no error
    pass


class _LoopEnd(Exception):  # noqa: N818 - CMake's break() or continue(), no error
    pass


def evaluate_package(
    name: str, files: PackageFiles, *, every_branch: bool = False
) -> PackageContents:
    """Return what a package's CMakeLists.txt makes; what goes wrong is in `unresolved`.

    The platform is Linux, tests are built, options have their defaults. With `every_branch` it is
    also what these leave out, and what stands behind a `return()`.
    """
    build = PackageBuild(files=files)
    scope = VariableScope(folder=files.folder, variables=initial_variables(name, files.folder))
    path = files.folder / LIST_FILE
    if files.is_file(path):
        _run_list_file(path, scope, build, every_branch=every_branch)
    return PackageContents(
        name=name,
        path=files.folder,
        targets=build.build_targets(),
        include_dirs=tuple(build.include_dirs),
        installed_scripts=tuple(build.installed.items()),
        shared_files=tuple(build.shared),
        components=tuple(build.components.values()),
        plugin_descriptions=tuple(build.exports),
        left_out=build.left_out,
        is_open=build.is_open,
        unresolved=tuple(build.unresolved),
    )


def _run_list_file(
    path: Path, scope: VariableScope, build: PackageBuild, *, every_branch: bool
) -> None:
    evaluator = CMakeEvaluator(
        build=build, budget=StepBudget(), initial=dict(scope.variables), every_branch=every_branch
    )
    try:
        evaluator.run_file(path, scope)
    except BoundsError as error:
        evidence = Evidence(file=str(evaluator.path), line=evaluator.line)
        build.add_unresolved(path.name, f"{error}; the rest is not read", evidence)
    if flags := scope.variables.get("CMAKE_CXX_FLAGS"):
        build.add_definitions(scope.folder, flags.text)


@dataclass(slots=True, kw_only=True)
class CMakeEvaluator:
    """Carries out files; `path` and `line` are the location, `depth` the nesting.

    `initial` are the variables that a package starts with. With `every_branch`, what no build with
    the defaults comes to is carried out too, and leaves no variables behind.
    """

    build: PackageBuild
    budget: StepBudget
    initial: Mapping[str, VariableValue] = field(default_factory=dict)
    every_branch: bool = False
    path: Path = field(default_factory=Path)
    line: int = 0
    depth: int = 0
    _definitions: dict[str, Branch] = field(default_factory=dict)
    _superbuilt: set[Path] = field(default_factory=set)

    def run_file(self, path: Path, scope: VariableScope) -> None:
        """Carry out a file; raise BoundsError where it does not come to an end."""
        before, self.path = self.path, path
        try:
            statements = self._parse(path)
            self._until_return(statements, scope)
        except InputError as error:
            self.build.add_unresolved(path.name, str(error), Evidence(file=str(path)))
        self.path = before

    def _parse(self, path: Path) -> list[Statement]:
        """Return a file's statements up to a return() under no condition: no build has the rest."""
        text = read_regular_file(path, MAX_BYTES).decode("utf-8", "replace")
        commands, problems = read_commands(text)
        statements, nesting = nest_blocks(commands)
        for problem in (*problems, *nesting):
            self.build.add_unresolved(
                path.name, problem.why, Evidence(file=str(path), line=problem.line)
            )
        returns = [isinstance(each, CMakeCommand) and each.name == "return" for each in statements]
        return statements[: returns.index(True)] if True in returns else statements

    def _until_return(self, statements: Sequence[Statement], scope: VariableScope) -> None:
        before = self.build.left_out_by
        try:
            self._run(statements, scope)
        except (_Return, _LoopEnd):
            return
        finally:
            self.build.left_out_by = before

    def _run(self, statements: Sequence[Statement], scope: VariableScope) -> None:
        if self.depth == MAX_DEPTH:
            raise BoundsError(f"nests more than {MAX_DEPTH} deep")
        self.depth += 1
        try:
            for statement in statements:
                self.budget.spend()
                if isinstance(statement, CommandBlock):
                    self._run_block(statement, scope)
                else:
                    self._run_command(statement, scope)
        finally:
            self.depth -= 1

    def _run_block(self, block: CommandBlock, scope: VariableScope) -> None:
        branch = block.branches[0]
        self.line = branch.head.line
        if branch.head.name == "if":
            self._run_if(block.branches, scope)
        elif branch.head.name == "foreach":
            self._run_foreach(branch, scope)
        elif branch.head.name == "while":
            self._run_alternatives([branch], scope)
        else:
            given = expand_arguments(branch.head.arguments[:1], scope.lookup)
            self._definitions.update((item.text.lower(), branch) for item in given)

    def _run_if(self, branches: Sequence[Branch], scope: VariableScope) -> None:
        possible: list[Branch] = []
        truth: Truth = False
        for branch in branches:
            truth = branch.head.name == "else" or self._condition_truth(
                branch.head.arguments, scope
            )
            if truth is not False:
                possible.append(branch)
            if truth:
                break
        if len(possible) == 1 and truth:
            self._run(possible[0].body, scope)
        elif possible:
            self._run_alternatives(possible, scope, or_none=not truth)
        if self.every_branch:
            taken = {id(branch) for branch in possible}
            self._run_left_out([branch for branch in branches if id(branch) not in taken], scope)

    def _run_left_out(self, branches: Iterable[Branch], scope: VariableScope) -> None:
        """Carry out branches that no build with the defaults takes; what they set does not stay."""
        variables, before = scope.variables, self.build.left_out_by
        for branch in branches:
            scope.variables = dict(variables)
            self.budget.spend(8 * len(variables))
            self._leave_out(branch.head)
            self._until_return(branch.body, scope)
            self.build.left_out_by = before
        scope.variables = variables

    def _leave_out(self, command: CMakeCommand) -> None:
        if self.build.left_out_by is None:
            words = " ".join(argument.text for argument in command.arguments)
            evidence = Evidence(file=str(self.path), line=command.line)
            self.build.left_out_by = LeftOut(f"{command.name}({words})"[:_MAX_SHOWN], evidence)

    def _run_alternatives(
        self, branches: Iterable[Branch], scope: VariableScope, *, or_none: bool = True
    ) -> None:
        """Carry out branches of which one may run, and join what they set."""
        before = scope.variables
        results = [before] if or_none else []
        for branch in branches:
            self.budget.spend(8 * len(before))
            scope.variables = dict(before)
            self._until_return(branch.body, scope)
            results.append(scope.variables)
        scope.variables = join_variables(results)

    def _condition_truth(self, condition: Iterable[CommandArgument], scope: VariableScope) -> Truth:
        facts = ConditionContext(
            variable=scope.variables.get,
            is_target=self.build.targets.__contains__,
            exists=lambda path: self._exists(scope.folder / path),
        )
        return evaluate_condition(expand_arguments(condition, scope.lookup), facts)

    def _exists(self, path: Path) -> Truth:
        files = self.build.files
        return files.is_file(path) or files.is_folder(path) or None

    def _run_foreach(self, branch: Branch, scope: VariableScope) -> None:
        given = expand_arguments(branch.head.arguments, scope.lookup)
        self.budget.spend(sum(32 + len(item.text) for item in given))
        rounds = loop_rounds(given, scope)
        if not rounds and is_loop_unknown(given[1:], scope) and self._makes_targets(branch.body):
            words = " ".join(argument.text for argument in branch.head.arguments)
            why = "what it goes through is not known: what it makes is missing"
            self._note(f"foreach({words})"[:_MAX_SHOWN], why)
        before = {name: scope.variables.get(name) for name in rounds[0]} if rounds else {}
        for variables in rounds:
            scope.variables.update(variables)
            if self._is_last_round(branch.body, scope):
                break
        restore_variables(scope, before)

    def _is_last_round(self, body: Sequence[Statement], scope: VariableScope) -> bool:
        """Carry out a round of a loop; tell whether a break() ends the loop."""
        try:
            self._run(body, scope)
        except _LoopEnd as end:
            return end.args == ("break",)
        return False

    def _makes_targets(self, body: Iterable[Statement]) -> bool:
        """Tell whether statements make targets, or call a function that may."""
        for statement in body:
            if isinstance(statement, CommandBlock):
                if any(self._makes_targets(branch.body) for branch in statement.branches):
                    return True
            elif statement.name in TARGET_MAKERS or statement.name in self._definitions:
                return True
        return False

    def _note(self, what: str, why: str) -> None:
        evidence = Evidence(file=str(self.path), line=self.line)
        self.build.add_unresolved(what, why, evidence)

    def _run_command(self, command: CMakeCommand, scope: VariableScope) -> None:
        self.line = command.line
        given = expand_arguments(command.arguments, scope.lookup)
        self.budget.spend(sum(32 + len(item.text) for item in given))
        words = [item.text for item in given if item.text]
        if command.name in self._definitions:
            self._call_definition(self._definitions[command.name], given, scope)
        elif command.name == "return":
            self._return(command)
        elif command.name in {"break", "continue"}:
            raise _LoopEnd(command.name)
        elif command.name == "project" and words:
            self._project(words[0], scope)
        elif command.name == "add_subdirectory" and given:
            self._add_subdirectory(given[0], scope)
        elif command.name == "include" and given:
            self._include_file(given, scope)
        elif command.name == "cmake_language" and words:
            self._run_language(command, words, scope)
        elif command.name == "externalproject_add":
            self._run_superbuild(words)
        else:
            carry_out = COMMANDS.get(command.name, note_unknown_command)
            carry_out(self._command_call(command, given, scope))

    def _run_language(
        self, command: CMakeCommand, words: Sequence[str], scope: VariableScope
    ) -> None:
        """Carry out `cmake_language(CALL command …)`."""
        if words[0] == "CALL" and words[1:]:
            called = replace(command, name=words[1].lower(), arguments=command.arguments[2:])
            self._run_command(called, scope)
        else:
            self._note(f"cmake_language({words[0]} …)", "is not carried out")

    def _return(self, command: CMakeCommand) -> None:
        if not self.every_branch:
            raise _Return
        self._leave_out(command)

    def _run_superbuild(self, words: Sequence[str]) -> None:
        """Carry out the package, or a folder of it, as it builds itself, with the options it says.

        CMake documentation: ExternalProject_Add, SOURCE_DIR and CMAKE_ARGS.
        """
        package = self.build.files.folder
        sources = (Path(normpath(after)) for word, after in pairwise(words) if word == "SOURCE_DIR")
        folder = next((f for f in sources if f.is_relative_to(package)), None)
        self.build.is_open |= folder is None
        if folder is None or folder in self._superbuilt:
            return
        self._superbuilt.add(folder)
        settings = (word[2:].partition("=") for word in words if word.startswith("-D"))
        options = {name.partition(":")[0]: VariableValue(value) for name, _, value in settings}
        top = VariableScope(folder=package, variables={**self.initial, **options})
        self.run_file(folder / LIST_FILE, top.child(folder))

    def _command_call(
        self, command: CMakeCommand, given: Iterable[ExpandedArgument], scope: VariableScope
    ) -> CommandCall:
        return CommandCall(
            name=command.name,
            items=tuple(given),
            scope=scope,
            build=self.build,
            budget=self.budget,
            evidence=Evidence(file=str(self.path), line=command.line),
        )

    def _call_definition(
        self, branch: Branch, given: Sequence[ExpandedArgument], scope: VariableScope
    ) -> None:
        """Carry out a macro in the scope of its caller, a function in one of its own."""
        is_macro = branch.head.name == "macro"
        inner = scope if is_macro else scope.child(scope.folder)
        arguments = argument_variables(
            [argument.text for argument in branch.head.arguments[1:]], given
        )
        self.budget.spend(8 * len(inner.variables))
        before = inner.arguments
        inner.arguments = arguments if is_macro else {}
        inner.variables.update({} if is_macro else arguments)
        self._until_return(branch.body, inner)
        inner.arguments = before

    def _project(self, name: str, scope: VariableScope) -> None:
        for variable in ("PROJECT_NAME", "CMAKE_PROJECT_NAME"):
            scope.set(variable, VariableValue(name))
        for variable in ("PROJECT_SOURCE_DIR", f"{name}_SOURCE_DIR"):
            scope.set(variable, VariableValue(str(scope.folder)))

    def _add_subdirectory(self, given: ExpandedArgument, scope: VariableScope) -> None:
        folder = scope.folder / given.text
        if given.text and self.build.files.is_file(folder / LIST_FILE):
            self.run_file(folder / LIST_FILE, scope.child(folder))
        elif given.known:
            self._note(f"add_subdirectory({given.text})", f"it has no {LIST_FILE} here")
        else:
            self._note("add_subdirectory", "which folder it is, is not known")

    def _include_file(self, given: Sequence[ExpandedArgument], scope: VariableScope) -> None:
        """Carry out `include` of a file or module of the package; CMake's own make no targets."""
        files, word = self.build.files, given[0].text
        modules = split_list(scope.variables.get("CMAKE_MODULE_PATH", VariableValue("")).text)
        named = (scope.folder / module / f"{word}.cmake" for module in modules)
        path = next(filter(files.is_file, (scope.folder / word, *named)), None)
        if path is not None:
            self._include(path, scope)
        elif given[0].known and "/" in word and "OPTIONAL" not in [item.text for item in given]:
            self._note(f"include({word})", "is not in the package: what it makes is missing")

    def _include(self, path: Path, scope: VariableScope) -> None:
        before = scope.variables.get("CMAKE_CURRENT_LIST_DIR", VariableValue(""))
        scope.set("CMAKE_CURRENT_LIST_DIR", VariableValue(str(path.parent)))
        self.run_file(path, scope)
        scope.set("CMAKE_CURRENT_LIST_DIR", before)
