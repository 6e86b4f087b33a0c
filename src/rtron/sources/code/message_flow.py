"""What a program sends, calls or writes to devices because of what it gets.

A callback does it itself, or keeps something that decides later what others do.
"""

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import chain

from rtron.sources.code import ir
from rtron.sources.code.call_kinds import only_logs
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.ir.references import called_names, ir_nodes
from rtron.sources.code.program_steps import WRITTEN, Program, Steps, last_name
from rtron.sources.code.start_flow import StartFlow
from rtron.sources.declaration import Declaration, DeclarationKind, FlowInput, MessageFlow
from rtron.vocabulary import UNKNOWN_OUTPUT

_INPUTS = {
    DeclarationKind.SUBSCRIBE: FlowInput.MESSAGE,
    DeclarationKind.SERVICE: FlowInput.REQUEST,
    DeclarationKind.ACTION_SERVER: FlowInput.REQUEST,
}
_MAX_ROUNDS = 6


def message_flows(machine: AbstractMachine) -> Iterator[MessageFlow]:
    """Yield what each subscription, service and action leads to, or that it leads to nothing."""
    program = Program(machine)
    flows: list[_Flow] = []
    for declared in _declared(machine):
        callbacks = () if declared.implicit else program.callbacks(declared)
        if callbacks:
            flow = _Flow(program)
            led = list(flow.of(callbacks))
            flows.append(flow)
            is_known = led or flow.outputs or _do_nothing(program, callbacks)
            outputs = flow.outputs if is_known else (UNKNOWN_OUTPUT,)
            yield _message_flow(declared, led, outputs)
    inputs = chain.from_iterable(map(program.callbacks, _declared(machine)))
    names = [(flow.members, flow.results) for flow in flows]
    start = StartFlow(program, names, {each.key for each in inputs})
    for library, place in start.writes().items():
        yield MessageFlow(input=FlowInput.START, evidence=(place,), outputs=(library,))


def _declared(machine: AbstractMachine) -> Iterator[Declaration]:
    """Yield what a program receives by."""
    return chain.from_iterable(map(machine.recorder.declared, _INPUTS))


def _message_flow(
    declared: Declaration, led: list[Declaration], outputs: Iterable[str]
) -> MessageFlow:
    input = _INPUTS[declared.kind]
    topics = (each for each in led if each.kind is DeclarationKind.PUBLISH)
    requests = (each.name for each in led if each.kind is not DeclarationKind.PUBLISH)
    own = () if input is FlowInput.MESSAGE else (declared.name,)
    return MessageFlow(
        input=input,
        evidence=tuple(each.evidence[0] for each in (declared, *topics)),
        requests=tuple(dict.fromkeys((*own, *requests))),
        outputs=tuple(outputs),
    )


def _do_nothing(program: Program, callbacks: Collection[ir.Function]) -> bool:
    """Return whether callbacks call nothing but logs, and set nothing but own variables."""
    codes = [program.steps(each) for each in callbacks]
    nodes = list(chain.from_iterable(ir_nodes(each.body) for each in callbacks))
    targets = (t for n in nodes if isinstance(n, ir.Assign) for t in n.targets)
    is_inside = not any(isinstance(each, (ir.Attr, ir.Index)) for each in targets)
    is_inside &= not any(code.members for code in codes)
    return is_inside and not any(map(_has_effect, nodes))


def _has_effect(node: object) -> bool:
    """Return whether a part of a function may do something, beyond logging and own variables."""
    if isinstance(node, ir.Call):
        return not only_logs(node)
    is_shift = isinstance(node, ir.Binary) and node.operator in {"<<", ">>"}  # a stream of C++
    return is_shift or isinstance(node, (ir.New, ir.Delete))


@dataclass
class _Flow:
    """Follows an input: `_led` is what sends because of it, `members` keep it, by scope.

    `results` are the functions that return it, `outputs` the libraries that get it.
    """

    program: Program
    outputs: dict[str, None] = field(default_factory=dict)
    results: set[str] = field(default_factory=set)
    members: defaultdict[str, set[str]] = field(default_factory=lambda: defaultdict(set))
    _led: dict[Declaration, None] = field(default_factory=dict)
    _done: set[int] = field(default_factory=set)

    def of(self, callbacks: Iterable[ir.Function]) -> Iterable[Declaration]:
        """Return what sends or calls because callbacks run, or because of what they keep."""
        self._run(callbacks)
        size = -1
        for _ in range(_MAX_ROUNDS):
            if size == (size := sum(map(len, (*self.members.values(), self.results)))):
                break
            for function in self.program.functions:
                code = self.program.steps(function)
                names = self.members.get(code.scope, set()) | self.results
                if id(function) not in self._done and names & code.names:
                    self._follow(code, names)
        return self._led

    def _run(self, functions: Iterable[ir.Function]) -> None:
        """Follow all that functions do, and those that they call."""
        pending = list(functions)
        while pending:
            function = pending.pop()
            if id(function) not in self._done:
                self._done.add(id(function))
                code = self.program.steps(function)
                self.members[code.scope] |= code.members
                for call in code.calls:
                    self._use(code, call)
                self.outputs.update(dict.fromkeys(filter(None, map(code.written, code.writes))))
                pending += self.program.called(called_names(function), code.scope)

    def _follow(self, code: Steps, names: set[str]) -> None:
        """Follow what a function does with names, or only because of them."""
        made = code.made_of(names)
        self.members[code.scope] |= made & code.members
        if any(code.mentions(value) & made for value in code.returned):
            self.results.update(self.program.results(code.function))
        if made & code.given:
            self.results.add(WRITTEN + code.function.name.rpartition("::")[2])
        ids = code.depending(made)
        written = (code.written(each) for each in code.writes if id(each) in ids)
        self.outputs.update(dict.fromkeys(filter(None, written)))
        for call in code.calls:
            if id(call) in ids:
                self._use(code, call)
                self._run(self.program.called({last_name(call.function)}, code.scope))

    def _use(self, code: Steps, call: ir.Call) -> None:
        """Keep what a call sends by, or the library that it acts on."""
        sent = dict.fromkeys(self.program.sent(call, code.scope))
        self._led |= sent
        if not sent and (library := self.program.libraries.called(call, code.scope)):
            self.outputs[library] = None
