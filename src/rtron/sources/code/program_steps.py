"""The functions of a program, by what they call, assign and return, and what they send by."""

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain, islice

from rtron.sources.code import ir
from rtron.sources.code.external_libraries import ExternalLibraries
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.ir.references import cache_by_identity, callee_names, ir_nodes
from rtron.sources.declaration import Declaration, DeclarationKind

_SENDING = (
    DeclarationKind.PUBLISH,
    DeclarationKind.SERVICE_CLIENT,
    DeclarationKind.ACTION_CLIENT,
)
_MAX_FUNCTIONS = 600
_MAX_ALIKE = 3
"""Of more functions with one name it is not known which is called."""
WRITTEN = "&"
"""What stands before the name of a function of C++ that writes to what it is given."""

_ADDING = frozenset(
    [
        *("append", "appendleft", "extend", "insert", "push", "push_back", "emplace_back"),
        *("put", "put_nowait", "__setitem__"),
    ]
)
"""Methods that put something into a container."""
_COMMON = frozenset(
    [
        *("at", "begin", "clear", "copy", "count", "data", "empty", "end", "find", "front", "get"),
        *("items", "keys", "length", "load", "name", "now", "ok", "read", "reset", "size", "str"),
        *("time", "update", "value", "values", "x", "y", "z"),
    ]
)
"""Names of functions that libraries have, too."""


@dataclass
class Program:
    """The functions of a program, and what they send by."""

    machine: AbstractMachine
    _known: dict[int, "Steps"] = field(default_factory=dict)

    @cached_property
    def functions(self) -> list[ir.Function]:
        """The functions that have a body, each once."""
        given = chain.from_iterable(self.machine.callbacks_at.values())
        own = (f for _, f in self.machine.runtime.program_functions())
        found = {f.key: f for f in (*own, *given, *self.machine.module_loops) if f.body}
        return list(islice(found.values(), _MAX_FUNCTIONS))

    def callbacks(self, declared: Declaration) -> list[ir.Function]:
        """Return the functions that get what a declaration receives."""
        given = (f for at in declared.evidence for f in self.machine.callbacks_at.get(at, ()))
        return list({each.key: each for each in given}.values())

    @cached_property
    def libraries(self) -> ExternalLibraries:
        """What the program holds of libraries, and of its own objects."""
        return ExternalLibraries(self.machine)

    @cached_property
    def _senders(self) -> dict[str, list[tuple[str, Declaration]]]:
        """The publishers and clients by the names that hold them, with the scopes of these."""
        declared = chain.from_iterable(map(self.machine.recorder.declared, _SENDING))
        made = {(at.file, at.line): each for each in declared for at in each.evidence}
        files = {file for file, _ in made}
        found = defaultdict[str, list[tuple[str, Declaration]]](list)
        for code in (self.steps(f) for f in self.functions if f.file in files):
            for name, value in (*code.assigned, *code.function.initialisers):
                lines = sorted(
                    {n.line for n in ir_nodes(value) if isinstance(n, (ir.Call, ir.New))}
                )
                senders = (made.get((code.function.file, line)) for line in lines)
                found[name] += ((code.scope, each) for each in senders if each)
        return found

    def sent(self, call: ir.Call, scope: str) -> Iterator[Declaration]:
        """Yield what a call sends by, or hands on; of several with one name those made nearby."""
        for name in mentioned_names(call) & self._senders.keys():
            senders = self._senders[name]
            near = [each for made_in, each in senders if made_in == scope]
            yield from near or (each for _, each in senders if len(senders) == 1)

    def called(self, names: Iterable[str], scope: str) -> Iterator[ir.Function]:
        """Yield the functions that are called, as far as their names tell."""
        for name in sorted(names):
            alike = self.machine.runtime.functions_named(name)
            near = [each for each in alike if self.libraries.scope(each) == scope]
            yield from near or (alike if len(alike) <= _MAX_ALIKE else ())

    def results(self, function: ir.Function) -> Iterator[str]:
        """Yield the names by which others mention what a function returns."""
        name = function.name.rpartition("::")[2]
        yield f"{self.libraries.scope(function)}::{name}"
        if len(self.machine.runtime.functions_named(name)) == 1 and name not in _COMMON:
            yield name

    def steps(self, function: ir.Function) -> "Steps":
        """Return what a function does."""
        if id(function) not in self._known:
            self._known[id(function)] = Steps(function, self.libraries)
        return self._known[id(function)]


class Steps:
    """What a function calls, assigns and returns; its `members` outlive its call.

    `given` are its parameters by which it may write to what it is given, `names` all it mentions.
    """

    def __init__(self, function: ir.Function, libraries: ExternalLibraries) -> None:
        self.function, self._libraries = function, libraries
        self.scope = libraries.scope(function)
        self._mentions: dict[int, tuple[object, frozenset[str]]] = {}
        is_cpp = libraries.machine.runtime.passes_by_reference
        nodes = list(ir_nodes(function.body))
        own = {each.name for each in function.params}
        own |= {node.name for node in nodes if isinstance(node, ir.Declare)}
        outer = {name for node in nodes if isinstance(node, ir.Global) for name in node.names}
        self.given = {each.name for each in function.params if each.reference}
        self.calls = [node for node in nodes if isinstance(node, ir.Call)]
        self.done = {id(node.value) for node in nodes if isinstance(node, ir.Evaluate)}
        self.writes = [node for node in nodes if isinstance(node, ir.Assign)]
        self.returned = [node.value for node in nodes if isinstance(node, ir.Return) and node.value]
        self.assigned: list[tuple[str, ir.Expr]] = []
        self.members = set[str]()
        for target, value in chain.from_iterable(map(_assignments, nodes)):
            name, is_below = _root(target)
            self.assigned.append((name, value))
            if is_below or (name not in own if is_cpp else name in outer):
                self.members.add(name)
        written = list(chain.from_iterable(map(_written_arguments, self.calls if is_cpp else ())))
        self.assigned += written
        self.names = self.mentions(function.body).union(value.id for _, value in written)

    def mentions(self, part: object) -> frozenset[str]:
        """Return the names in a part, those of functions of known objects with their scope, too."""
        if id(part) not in self._mentions:
            calls = (node for node in ir_nodes(part) if isinstance(node, ir.Call))
            functions = chain.from_iterable(map(self._results_of, calls))
            self._mentions[id(part)] = part, mentioned_names(part).union(functions)
        return self._mentions[id(part)][1]

    def _results_of(self, call: ir.Call) -> Iterator[str]:
        """Yield the function that a call calls, with its object's scope or its own."""
        name = last_name(call.function)
        owner = call.function.owner if isinstance(call.function, ir.Attr) else None
        scopes = self._libraries.objects.get(last_name(owner), ()) if owner else ()
        is_own = owner is None or (isinstance(owner, ir.Name) and owner.id in {"self", "this"})
        yield from (f"{scope}::{name}" for scope in ((self.scope,) if is_own else scopes))

    def made_of(self, names: set[str]) -> set[str]:
        """Return names, and those of what the function makes of them, or only because of them."""
        made, size = set(names), -1
        while size != (size := len(made)):
            made.update(name for name, value in self.assigned if self.mentions(value) & made)
            pairs = chain.from_iterable(map(_assignments, self.dependent_nodes(made)))
            made.update(_root(target)[0] for target, _ in pairs)
        return made

    def dependent_nodes(self, names: set[str]) -> list[object]:
        """Return what the function does only where a test of names says so."""
        tests = (test for node in ir_nodes(self.function.body) if (test := _test(node)))
        return [
            part
            for condition, branches in tests
            if self.mentions(condition) & names
            for part in ir_nodes(branches)
        ]

    def depending(self, made: set[str]) -> set[int]:
        """Return the ids of what gets names, or is done only because of them."""
        chosen = self.dependent_nodes(made)
        if any(isinstance(node, (ir.Return, ir.Break, ir.Continue)) for node in chosen):
            return set(map(id, (*self.calls, *self.writes)))
        found = {id(c) for c in self.calls if self.mentions((c.args, c.keywords)) & made}
        found |= {id(each) for each in self.writes if self.mentions(each.value) & made}
        return found.union(map(id, chosen))

    def written(self, write: ir.Assign) -> str:
        """Return the library to whose object an assignment writes."""
        owners = [t.owner for t in write.targets if isinstance(t, (ir.Attr, ir.Index))]
        found = (self._libraries.owner(each, self.scope) for each in owners)
        return next(filter(None, found), "")


def _test(node: object) -> tuple[ir.Expr, tuple[object, ...]] | None:
    """Return what decides whether parts of a function run, and these."""
    if isinstance(node, (ir.If, ir.Conditional)):
        return node.test, (node.body, node.orelse)
    if isinstance(node, ir.While):
        return node.test, (node.body,)
    return (node.iterable, (node.body,)) if isinstance(node, ir.ForEach) else None


def _assignments(node: object) -> Iterator[tuple[ir.Expr, ir.Expr]]:
    """Yield what a step writes to, or puts something into, and the values."""
    if isinstance(node, ir.Assign):
        for target in node.targets:
            yield from ((each, node.value) for each in _taken_apart(target))
    elif isinstance(node, ir.Declare) and node.value is not None:
        yield ir.Name(node.name), node.value
    elif isinstance(node, ir.ForEach):
        yield from ((each, node.iterable) for each in _taken_apart(node.target))
    elif isinstance(node, ir.With) and node.target is not None:
        yield node.target, node.manager
    elif isinstance(node, ir.Call) and isinstance(node.function, ir.Attr):
        yield from ((node.function.owner, v) for v in node.args if node.function.name in _ADDING)


def _taken_apart(target: ir.Expr) -> tuple[ir.Expr, ...]:
    return target.items if isinstance(target, ir.SequenceExpr) else (target,)


def _written_arguments(call: ir.Call) -> Iterator[tuple[str, ir.Name]]:
    """Yield the variables that a function of C++ is given, each as what it may write."""
    name = last_name(call.function)
    yield from ((last_name(arg), ir.Name(f"{WRITTEN}{name}")) for arg in call.args if name)


def _root(target: ir.Expr) -> tuple[str, bool]:
    """Return the variable that something is written to or below, and whether it is a member."""
    name, is_member = last_name(target), False
    while isinstance(target, (ir.Attr, ir.Index)):
        is_own = isinstance(target.owner, ir.Name) and target.owner.id in {"self", "this"}
        is_member |= is_own and isinstance(target, ir.Attr)
        target = target.owner
        if not is_member:
            name = last_name(target)
    return name, is_member


def last_name(part: ir.Expr) -> str:
    """Return the last name of what is called or written to."""
    while isinstance(part, ir.Index):
        part = part.owner
    return next(callee_names(part), "")


@cache_by_identity
def mentioned_names(part: object) -> frozenset[str]:
    """Return the last names of all variables, members and functions in a part."""
    return frozenset(last_name(n) for n in ir_nodes(part) if isinstance(n, (ir.Attr, ir.Name)))
