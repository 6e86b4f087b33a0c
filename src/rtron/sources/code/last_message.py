"""What becomes of the last message of a topic when no more come: a node runs on without.

The program runs up to where it begins to wait, gets one message there, and then none.
"""

import re
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import islice

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.ir.references import ir_nodes, written_names
from rtron.sources.code.reachability import reachable_functions, unknown_bases
from rtron.sources.code.silence import SMALL, Loop, Silence
from rtron.sources.code.silent_evaluation import SilentEvaluation
from rtron.sources.code.silent_outputs import DECIDED, DOUBT, EITHER, Expiry, Output
from rtron.sources.declaration import Declaration, DeclarationKind, LastMessageUse
from rtron.vocabulary import Evidence, LastMessageFate
from rtron.vocabulary.names import snake_case

_STATES = re.compile(
    r"sensor_msgs/(?!(?:msg/)?Joy)|nav_msgs/|tf2?_msgs/|visualization_msgs/|diagnostic_msgs/"
    r"|rosgraph_msgs/|rcl_interfaces/"
)
"""Types of what is measured or shown: no command."""
_ORDERS = re.compile(r"cmd|command|target|desired|goal|set_?point|reference", re.IGNORECASE)
"""Words in the names of topics that command, also where their type tells what was measured."""
_STOP_NAME = re.compile(
    r"(?:(?:all|apply|base|car|cmd|command|controller|do|drive|emergency|force|full|go|hard"
    r"|motors?|publish|robot|safe|safety|send|set|soft|speed|timeout|to|vehicle|vel|velocity"
    r"|watchdog|wheels?|write)_)*"
    r"(?:e_?stop|stop|zeros?|halt|brake|neutral|idle|coast|disable|shut_?down)"
    r"(?:_(?:all|base|both|car|chassis|cmd|commands?|drive|driving|engine|front|it|left|motion"
    r"|motors?|movement|moving|now|outputs?|pwm|rear|right|robot|rover|servos?|speeds?|thrusters?"
    r"|torque|twist|vehicle|vel|velocity|velocities|wheels?))*"
)
"""Names of functions that stop what drives: a verb, and nothing but that beside it."""
_STEERING = re.compile(r"steer|angle|servo", re.IGNORECASE)
"""Words in the names of values that move no vehicle whose speed is zero."""
_DIGITS = frozenset("123456789")
_STANDARD = frozenset({"object", *sys.stdlib_module_names})
"""Where classes are from that know nothing of messages."""
_STOPPED, _CHECKED = LastMessageFate.STOPPED, LastMessageFate.CHECKED
_UNNOTICED = LastMessageFate.UNNOTICED
_MAX_WAITS = 3
_MAX_SUBSCRIPTIONS = 12


@dataclass
class LastMessages:
    """What a program does with the last message of each subscription, once it waits."""

    uses: dict[Evidence, LastMessageUse] = field(default_factory=dict)
    _waits: int = 0
    _loop: Loop | None = None
    _sent: set[Evidence] = field(default_factory=set)

    def __call__(self, machine: AbstractMachine, node: ir.While | None, frame: StackFrame) -> None:
        """Watch what becomes of messages where a program waits: in a loop, or behind its end."""
        is_trial = machine.trial_depth or machine.recorder.muted
        if is_trial or self._waits >= _MAX_WAITS or (node and not _may_be_endless(node)):
            return
        self._loop = (node, frame) if node is not None else self._loop
        found = list(islice(_subscriptions(machine), _MAX_SUBSCRIPTIONS))
        self._waits += bool(found)
        for declared, callbacks in found:
            if declared.evidence[0] not in self._sent:
                self._watch(machine, declared, callbacks)

    def _watch(
        self, machine: AbstractMachine, declared: Declaration, callbacks: list[av.FunctionValue]
    ) -> None:
        """Run what follows a message; what is sent of it in one loop tells more than others."""
        place = declared.evidence[0]
        seen = SilentEvaluation(machine, _written_by_others(machine, callbacks))
        run = Silence(machine, seen)
        is_still = run.run(callbacks, self._loop)
        is_sent = any(map(_is_made_of_message, seen.outputs))
        self._sent |= {place} if is_sent else set()
        if is_sent or place not in self.uses:
            self.uses[place] = _use(
                machine,
                declared,
                run,
                is_still=is_still,
                may_base_watch=_may_base_watch(machine, callbacks),
            )


def last_messages(machine: AbstractMachine) -> tuple[LastMessageUse, ...]:
    """Return what becomes of each message, if the machine's program was watched where it waits."""
    watch = machine.on_wait
    return tuple(watch.uses.values()) if isinstance(watch, LastMessages) else ()


def _may_be_endless(node: ir.While) -> bool:
    """Return whether the test of a loop does not end it, or only by what it asks others."""
    asks = any(isinstance(each, ir.Call) for each in ir_nodes(node.test))
    return asks or (isinstance(node.test, ir.Const) and bool(node.test.value))


def _subscriptions(
    machine: AbstractMachine,
) -> Iterator[tuple[Declaration, list[av.FunctionValue]]]:
    """Yield the subscriptions of what may be commands, with their callbacks."""
    for declared in machine.recorder.declared(DeclarationKind.SUBSCRIBE):
        keys = {f.key for at in declared.evidence for f in machine.callbacks_at.get(at, ())}
        given = [each for each in machine.pending_callbacks if each.function.key in keys]
        callbacks = [each for each in given if _takes_message(each.function)]
        if callbacks and not _STATES.match(declared.type):
            yield declared, callbacks


def _takes_message(callback: ir.Function) -> bool:
    return any(param.name != "self" for param in callback.params)


def _may_base_watch(machine: AbstractMachine, callbacks: list[av.FunctionValue]) -> bool:
    """Return whether a callback is a method of an object with a base that is not read."""
    owners = (each.owner for each in callbacks if isinstance(each.owner, av.Instance))
    bases = (base.partition(".")[0] for each in owners for base in unknown_bases(machine, each))
    return not _STANDARD.issuperset(bases)


def _written_by_others(
    machine: AbstractMachine, callbacks: list[av.FunctionValue]
) -> frozenset[str]:
    """Return what only callbacks change that are neither these nor tasks."""
    own = [each.function for each in callbacks] + [each.function for each, _ in machine.tasks]
    keys = {each.key for each in own}
    others = [f for f in machine.escaped_functions if f.key not in keys]
    return _written(machine, others) - _written(machine, own)


def _written(machine: AbstractMachine, functions: list[ir.Function]) -> frozenset[str]:
    reached = reachable_functions(machine, functions, include_unrelated=True)
    return frozenset(name for each in reached for name in written_names(each))


def _use(
    machine: AbstractMachine,
    declared: Declaration,
    run: Silence,
    *,
    is_still: bool,
    may_base_watch: bool,
) -> LastMessageUse:
    sent = [each for each in run.seen.outputs if _is_made_of_message(each)]
    repeated = [each for each in sent if each.round == run.seen.round]
    fate = _fate(run, sent, repeated) if is_still else _CHECKED
    fate = _CHECKED if fate is _UNNOTICED and may_base_watch else fate
    made = tuple(_publishers(machine, {each.publisher for each in repeated}))
    if fate is LastMessageFate.REPEATED and made and all(map(_is_state, made)):
        fate = _UNNOTICED
    expiry = _expiry(run.seen, sent, repeated) if fate in {_STOPPED, _CHECKED} else None
    further = tuple(each.evidence[0] for each in made) if fate is LastMessageFate.REPEATED else ()
    return LastMessageUse(
        fate=fate,
        seconds=expiry.seconds if expiry else None,
        evidence=(declared.evidence[0], *((expiry.place,) if expiry else further)),
    )


def _expiry(seen: SilentEvaluation, sent: list[Output], repeated: list[Output]) -> Expiry | None:
    """Return the comparison of times at which a program begins to do something else."""
    last = 0 if repeated else max((each.round for each in sent), default=0)
    begun = (each.round for each in seen.outputs if each.round > last and _is_stop(each))
    at = None if repeated else next(begun, last + 1 if last else None)
    return next((each for each in seen.expiries if at in {None, each.round}), None)


def _fate(run: Silence, sent: list[Output], repeated: list[Output]) -> LastMessageFate:
    """Return what becomes of a message of which `sent` is made, and `repeated` at the end, too."""
    outputs = run.seen.outputs
    first = outputs.index(sent[0]) if sent else 0
    stops = [each for each in outputs[first:] if _is_stop(each)]
    if any(each.reason & DOUBT for each in stops) or any(map(_may_be_zero, repeated)):
        return _CHECKED
    if repeated:
        return _fate_of_repeated(sent, repeated)
    if sent:
        return _fate_of_ended(run, sent)
    if run.seen.expiries and any(map(_is_called_stop, stops)):
        return _STOPPED
    return _CHECKED if run.seen.is_used else _UNNOTICED


def _fate_of_repeated(sent: list[Output], repeated: list[Output]) -> LastMessageFate:
    if any(_is_part(each, sent) for each in repeated):
        return _STOPPED if all(map(_is_steering, repeated)) else _CHECKED
    is_published = all(each.publisher for each in repeated)
    return LastMessageFate.REPEATED if is_published else _UNNOTICED


def _fate_of_ended(run: Silence, sent: list[Output]) -> LastMessageFate:
    """Return the fate by what is sent behind the last that is made of the message."""
    outputs = run.seen.outputs
    at = max(index for index, each in enumerate(outputs) if each is sent[-1])
    behind, targets = outputs[at + 1 :], {each.target for each in sent}
    after = [each for each in behind if each.target in targets]
    places = {each.place for each in sent}
    is_reset = run.is_zeroed and any(each.place in places for each in behind)
    if any(map(_is_stop, after)) or any(map(_is_called_stop, behind)) or is_reset:
        return _STOPPED
    is_other = any(value != av.NONE for each in after for value in each.leaves)
    return _CHECKED if is_other or (run.seen.expiries and sent[-1].round) else _UNNOTICED


def _is_part(output: Output, sent: list[Output]) -> bool:
    """Return whether less of an output is made of the message than before at that place."""
    before = max(_parts(each) for each in sent if each.place == output.place)
    return _parts(output) < before and any(map(_is_zero, output.leaves))


def _parts(output: Output) -> int:
    return sum(map(_is_of_message, output.leaves))


def _is_steering(output: Output) -> bool:
    left = [each for each in output.leaves if _is_of_message(each)]
    return all(isinstance(e, av.Unknown) and _STEERING.search(e.label) for e in left)


def _publishers(machine: AbstractMachine, topics: Iterable[str]) -> Iterator[Declaration]:
    for declared in machine.recorder.declared(DeclarationKind.PUBLISH):
        if declared.name in topics:
            yield declared


def _is_state(publisher: Declaration) -> bool:
    """Return whether a publisher tells what was measured, or how something stands."""
    return bool(_STATES.match(publisher.type)) and not _ORDERS.search(publisher.name)


def _is_made_of_message(output: Output) -> bool:
    """Return whether a message decides what is sent, or that something is sent."""
    is_caused = output.reason & DECIDED and output.leaves and not _is_stop(output)
    return bool(is_caused) or any(map(_is_of_message, output.leaves))


def _is_stop(output: Output) -> bool:
    """Return whether what is sent stops something: by its name, or zero and nothing else."""
    is_made = any(map(_is_of_message, output.leaves))
    is_zeros = any(map(_is_zero, output.leaves)) and not is_made
    return (_is_called_stop(output) or is_zeros) and not output.reason & EITHER


def _is_of_message(value: av.Value) -> bool:
    return av.taint(value) & av.MESSAGE != 0 and not _is_zero(value)


def _is_called_stop(output: Output) -> bool:
    return bool(_STOP_NAME.fullmatch(snake_case(output.function).strip("_")))


def _may_be_zero(output: Output) -> bool:
    return output.is_choice and any(_is_zero(e) and not av.taint(e) for e in output.leaves)


def _is_zero(value: av.Value) -> bool:
    """Return whether a value is zero, or means that."""
    value = av.number_of(value)
    if isinstance(value, (av.ExternalSymbol, av.Unknown)):
        return getattr(value, "name", getattr(value, "label", "")).rpartition(".")[2] == "LOW"
    number = value.value if isinstance(value, av.Scalar) else None
    if isinstance(number, bytes):
        number = number.decode("latin-1")
    if isinstance(number, str):
        return "0" in number and _DIGITS.isdisjoint(number)
    return isinstance(number, (int, float)) and abs(number) < SMALL
