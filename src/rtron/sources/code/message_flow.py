"""What a node sends, calls or asks for because of a message, as far as the code tells.

A callback sends it itself, or keeps something that decides later what others send.
"""

import re
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain, islice

from rtron.sources.code import ir
from rtron.sources.code.external_libraries import ExternalLibraries
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.exceptions import is_logging_call
from rtron.sources.code.ir.references import cache_by_identity, called_names, callee_names, ir_nodes
from rtron.sources.declaration import Declaration, DeclarationKind, MessageFlow

_MEASURED = re.compile(
    r"sensor_msgs/(?!(?:msg/)?Joy)|nav_msgs/(?!(?:msg/)?Path)|tf2?_msgs/|visualization_msgs/"
    r"|diagnostic_msgs/|rosgraph_msgs/|rcl_interfaces/|map_msgs/"
)
"""Types of what is measured or shown: a robot senses it, nobody commands by it."""
_SENDING = (
    DeclarationKind.PUBLISH,
    DeclarationKind.SERVICE_CLIENT,
    DeclarationKind.ACTION_CLIENT,
)
_MAX_FUNCTIONS = 600
_MAX_ROUNDS = 6
_MAX_ALIKE = 3
"""Of more functions with one name it is not known which is called."""


_ADDING = frozenset(["append", "insert", "push", "push_back", "emplace_back", "put"])
_COMMON = frozenset(
    [
        *("at", "begin", "clear", "copy", "count", "data", "empty", "end", "find", "front", "get"),
        *("items", "keys", "length", "load", "name", "now", "ok", "read", "reset", "size", "str"),
        *("time", "update", "value", "values", "x", "y", "z"),
    ]
)
"""Names of functions that libraries have, too."""
_LOGGING = re.compile(
    r"(?:log)?_?(?:debug|info|warn|warning|error|fatal|critical)(?:_\w+)?|[gG]et_?[lL]ogger"
)
_LOGGERS = re.compile(r"rospy|_?log(?:ger|ging)?|[gG]et_?[lL]ogger")


def message_flows(machine: AbstractMachine) -> Iterator[MessageFlow]:
    """Yield what each subscription of commands or orders leads to, or that it leads to nothing."""
    program = _Program(machine)
    for declared in machine.recorder.declared(DeclarationKind.SUBSCRIBE):
        given = (f for at in declared.evidence for f in machine.callbacks_at.get(at, ()))
        callbacks = list({each.key: each for each in given}.values())
        if callbacks and not (declared.implicit or _MEASURED.match(declared.type)):
            flow = _Flow(program)
            led = list(flow.of(callbacks))
            topics = (each for each in led if each.kind is DeclarationKind.PUBLISH)
            requests = (each.name for each in led if each.kind is not DeclarationKind.PUBLISH)
            if led or flow.output or program.do_nothing(callbacks):
                yield MessageFlow(
                    evidence=tuple(each.evidence[0] for each in (declared, *topics)),
                    requests=tuple(dict.fromkeys(requests)),
                    output=flow.output,
                )


class _Steps:
    """What a function calls, assigns and returns; its `members` outlive its call."""

    def __init__(self, function: ir.Function, *, is_cpp: bool) -> None:
        self.function = function
        nodes = list(ir_nodes(function.body))
        own = {each.name for each in function.params}
        own |= {node.name for node in nodes if isinstance(node, ir.Declare)}
        outer = {name for node in nodes if isinstance(node, ir.Global) for name in node.names}
        self.calls = [node for node in nodes if isinstance(node, ir.Call)]
        self.targets = [t for node in nodes if isinstance(node, ir.Assign) for t in node.targets]
        self.returned = [node.value for node in nodes if isinstance(node, ir.Return) and node.value]
        self.assigned: list[tuple[str, ir.Expr]] = []
        self.members = set[str]()
        for target, value in chain.from_iterable(map(_assignments, nodes)):
            name, is_below = _root(target)
            self.assigned.append((name, value))
            if is_below or (name not in own if is_cpp else name in outer):
                self.members.add(name)

    def made_of(self, names: set[str]) -> set[str]:
        """Return names, and those of what the function makes of them, or only because of them."""
        made, size = set(names), -1
        while size != (size := len(made)):
            made.update(name for name, value in self.assigned if _mentioned(value) & made)
            pairs = chain.from_iterable(map(_assignments, self.dependent_nodes(made)))
            made.update(_root(target)[0] for target, _ in pairs)
        return made

    def dependent_nodes(self, names: set[str]) -> list[object]:
        """Return what the function does only where a test of names says so."""
        tests = (
            n
            for n in ir_nodes(self.function.body)
            if isinstance(n, (ir.If, ir.While, ir.Conditional))
        )
        return [
            part for n in tests if _mentioned(n.test) & names for part in ir_nodes(_branches(n))
        ]


def _branches(test: ir.If | ir.While | ir.Conditional) -> tuple[object, ...]:
    return (test.body,) if isinstance(test, ir.While) else (test.body, test.orelse)


def _assignments(node: object) -> Iterator[tuple[ir.Expr, ir.Expr]]:
    """Yield what a step writes to, or puts something into, and the values."""
    if isinstance(node, ir.Assign):
        yield from ((target, node.value) for target in node.targets)
    elif isinstance(node, ir.Declare) and node.value is not None:
        yield ir.Name(node.name), node.value
    elif isinstance(node, ir.Call) and isinstance(node.function, ir.Attr):
        yield from ((node.function.owner, v) for v in node.args if node.function.name in _ADDING)


def _root(target: ir.Expr) -> tuple[str, bool]:
    """Return the variable that something is written to or below, and whether it is a member."""
    name, is_member = _last_name(target), False
    while isinstance(target, (ir.Attr, ir.Index)):
        is_own = isinstance(target.owner, ir.Name) and target.owner.id in {"self", "this"}
        is_member |= is_own and isinstance(target, ir.Attr)
        target = target.owner
        if not is_member:
            name = _last_name(target)
    return name, is_member


def _last_name(part: ir.Expr) -> str:
    """Return the last name of what is called or written to."""
    while isinstance(part, ir.Index):
        part = part.owner
    return next(callee_names(part), "")


@cache_by_identity
def _mentioned(part: object) -> frozenset[str]:
    """Return the last names of all variables, members and functions in a part."""
    return frozenset(_last_name(n) for n in ir_nodes(part) if isinstance(n, (ir.Attr, ir.Name)))


def _has_effect(node: object) -> bool:
    """Return whether a part of a function may do something, beyond logging and own variables."""
    if isinstance(node, ir.Call):
        return not _only_logs(node)
    is_shift = isinstance(node, ir.Binary) and node.operator in {"<<", ">>"}  # a stream of C++
    return is_shift or isinstance(node, (ir.New, ir.Delete))


def _only_logs(call: ir.Call) -> bool:
    name = _last_name(call.function)
    if isinstance(call.function, ir.Attr) and _LOGGING.fullmatch(name):
        owner = _mentioned(call.function.owner)
        return name.lower().startswith("get") or any(map(_LOGGERS.fullmatch, owner))
    return is_logging_call(call) or (name == "print" and not call.keywords)


@dataclass
class _Program:
    """The functions of a program, and what they send by."""

    machine: AbstractMachine
    _known: dict[int, _Steps] = field(default_factory=dict)

    @cached_property
    def functions(self) -> list[ir.Function]:
        """The functions that have a body, each once."""
        given = chain.from_iterable(self.machine.callbacks_at.values())
        own = (f for _, f in self.machine.runtime.program_functions())
        found = {f.key: f for f in (*own, *given, *self.machine.module_loops) if f.body}
        return list(islice(found.values(), _MAX_FUNCTIONS))

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
                found[name] += ((_scope(code.function), each) for each in senders if each)
        return found

    def sent(self, call: ir.Call, scope: str) -> Iterator[Declaration]:
        """Yield what a call sends by, or hands on; of several with one name those made nearby."""
        for name in _mentioned(call) & self._senders.keys():
            senders = self._senders[name]
            near = [each for made_in, each in senders if made_in == scope]
            yield from near or (each for _, each in senders if len(senders) == 1)

    def called(self, names: Iterable[str], scope: str) -> Iterator[ir.Function]:
        """Yield the functions that are called, as far as their names tell."""
        for name in sorted(names):
            alike = self.machine.runtime.functions_named(name)
            near = [each for each in alike if _scope(each) == scope]
            yield from near or (alike if len(alike) <= _MAX_ALIKE else ())

    @cached_property
    def libraries(self) -> ExternalLibraries:
        """What the program holds of libraries."""
        return ExternalLibraries(self.machine)

    def do_nothing(self, callbacks: Collection[ir.Function]) -> bool:
        """Return whether callbacks call nothing but logs, and set nothing but own variables."""
        codes = [self.steps(each) for each in callbacks]
        nodes = list(chain.from_iterable(ir_nodes(each.body) for each in callbacks))
        targets = (t for n in nodes if isinstance(n, ir.Assign) for t in n.targets)
        is_inside = not any(isinstance(each, (ir.Attr, ir.Index)) for each in targets)
        is_inside &= not any(code.members for code in codes)
        return is_inside and not any(map(_has_effect, nodes))

    def steps(self, function: ir.Function) -> _Steps:
        """Return what a function does."""
        if id(function) not in self._known:
            is_cpp = self.machine.runtime.passes_by_reference
            self._known[id(function)] = _Steps(function, is_cpp=is_cpp)
        return self._known[id(function)]


@dataclass
class _Flow:
    """Follows a message: `_led` is what sends because of it, `_members` keep it, by scope.

    `_results` are the functions that return it, `output` is the library that gets it.
    """

    program: _Program
    output: str = ""
    _results: set[str] = field(default_factory=set)
    _led: dict[Declaration, None] = field(default_factory=dict)
    _members: defaultdict[str, set[str]] = field(default_factory=lambda: defaultdict(set))
    _done: set[int] = field(default_factory=set)

    def of(self, callbacks: Iterable[ir.Function]) -> Iterable[Declaration]:
        """Return what sends or calls because callbacks run, or because of what they keep."""
        self._run(callbacks)
        size = -1
        for _ in range(_MAX_ROUNDS):
            if size == (size := sum(map(len, (*self._members.values(), self._results)))):
                break
            for function in self.program.functions:
                names = self._members.get(_scope(function), set()) | self._results
                if id(function) not in self._done and names & _mentioned(function.body):
                    self._follow(self.program.steps(function), names)
        return self._led

    def _run(self, functions: Iterable[ir.Function]) -> None:
        """Follow all that functions do, and those that they call."""
        pending = list(functions)
        while pending:
            function = pending.pop()
            if id(function) not in self._done:
                self._done.add(id(function))
                code, scope = self.program.steps(function), _scope(function)
                self._members[scope] |= code.members
                for call in code.calls:
                    self._use(code, call)
                self._write(code.targets)
                pending += self.program.called(called_names(function), scope)

    def _follow(self, code: _Steps, names: set[str]) -> None:
        """Follow what a function does with names, or only because of them."""
        made, scope = code.made_of(names), _scope(code.function)
        chosen = code.dependent_nodes(made)
        if any(isinstance(node, (ir.Return, ir.Break, ir.Continue)) for node in chosen):
            chosen = list(ir_nodes(code.function.body))
        ids = set(map(id, chosen))
        self._members[scope] |= made & code.members
        if any(_mentioned(value) & made for value in code.returned):
            name = code.function.name.rpartition("::")[2]
            alike = self.program.machine.runtime.functions_named(name)
            is_only = len(alike) == 1 and name not in _COMMON
            (self._results if is_only else self._members[scope]).add(name)
        for call in code.calls:
            if id(call) in ids or _mentioned((call.args, call.keywords)) & made:
                self._use(code, call)
                self._run(self.program.called({_last_name(call.function)}, scope))

    def _write(self, targets: Iterable[ir.Expr]) -> None:
        """Keep the library to whose objects something is written."""
        written = filter(None, map(self.program.libraries.owner, targets))
        self.output = self.output or next(written, "")

    def _use(self, code: _Steps, call: ir.Call) -> None:
        """Keep what a call sends by, or the library that it acts on."""
        sent = dict.fromkeys(self.program.sent(call, _scope(code.function)))
        self._led |= sent
        if not (sent or self.output):
            self.output = self.program.libraries.called(call)


def _scope(function: ir.Function) -> str:
    """Return the class of a method of C++, else the file of a function."""
    owner = function.name.rpartition("::")[0]
    return owner.rpartition("::")[2] or function.file
