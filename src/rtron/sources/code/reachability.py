"""What runs that the program itself does not call: callbacks, threads, methods a library calls."""

from collections import defaultdict
from collections.abc import Iterable, Iterator
from contextlib import suppress
from itertools import islice

from rtron.sources.code.endpoint_calls import ENDPOINT_CALLS
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import (
    AbstractMachine,
    EndError,
    StepsExceededError,
    ThrownError,
)
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.assignment import STAMPED
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.ir import Function
from rtron.sources.code.ir.references import called_names, written_names
from rtron.sources.code.library_models.common.transforms import LOOK_UPS
from rtron.sources.code.library_models.rclcpp.rclc import RCLC_FUNCTIONS
from rtron.vocabulary import Evidence, UnresolvedCause

ROS1_API = frozenset(
    [
        *("advertise", "subscribe", "advertiseService", "serviceClient", "advertiseCamera"),
        *("subscribeCamera", "Publisher", "Subscriber", "Service", "ServiceProxy"),
        *("waitForMessage", "wait_for_message", "createInstance", "system", "Popen"),
        *("createClassInstance", "createUnmanagedInstance", "ROSLaunchParent", "launch"),
        *("check_call", "call", "popen", "SimpleActionClient", "SimpleActionServer"),
        *("ActionClient", "ActionServer", "TransformListener", "TransformBroadcaster"),
        *("StaticTransformBroadcaster", "Server", "Updater", "ImageTransport", "create"),
        *("RealtimePublisher", "InteractiveMarkerServer", "Bond", "SubscriberFilter"),
        *("SimpleActionServer<>", "sendTransform"),
    ]
)
_ROS2_API = frozenset(
    [
        *("create_publisher", "create_subscription", "create_service", "create_client"),
        *("create_generic_publisher", "create_generic_subscription", "create_generic_client"),
        *("TransformListener", "TransformBroadcaster", "StaticTransformBroadcaster"),
        *("declare_parameter", "declare_parameters", "wait_for_message", "system", "Updater"),
        *("subscribe", "advertise", "configure", "sendTransform"),
    ]
)
ROS2_CPP_API = _ROS2_API | {
    *("create_server", "create_sub_node", "rclcpp::Node", "rclcpp_lifecycle::LifecycleNode"),
    *("create_camera_publisher", "create_camera_subscription", "advertiseCamera"),
    *("subscribeCamera", "SubscriberFilter", "message_filters::Subscriber", "bond::Bond"),
    *("createSharedInstance", "createUniqueInstance", "createUnmanagedInstance"),
    *("registerFromPlugin", "registerNodeType", "registerBuilder", "InteractiveMarkerServer"),
    *("CameraInfoManager", "ParameterEventHandler", "AsyncParametersClient"),
    *("SyncParametersClient", "popen", "createBond", "create_action_server", "RegisterRosNode"),
    *("create_action_client", "ServiceClient", "ServiceServer", "LifecycleServiceClient"),
    *("SimpleActionServer", "declare_parameter_if_not_declared", "declare_or_get_parameter"),
    *("get_plugin_type_param", "add_parameter", "shared_from_this", "weak_from_this"),
    *RCLC_FUNCTIONS,
}
"""The same for ROS 2; parameters decide names there, so declaring one counts."""
ROS2_PYTHON_API = _ROS2_API | {
    *("ActionServer", "ActionClient", "Subscriber", "Node", "LifecycleNode", "create_node"),
    "create_lifecycle_publisher",
    *("Buffer", "Popen", "check_call", "create_sub_node", "ParameterEventHandler"),
}
_CONTAINER_METHODS = frozenset(
    [
        *("get", "size", "begin", "end", "empty", "push_back", "emplace_back", "emplace", "clear"),
        *("front", "back", "at", "find", "insert", "erase", "c_str", "str", "reset", "lock"),
        *("count", "swap", "data", "resize", "reserve", "value", "load", "store", "what"),
    ]
)
"""Called of containers and pointers, most often: that a class has one says nothing."""
_EARLY_EXIT = "makes endpoints, but ends before the first of them by what is known here"
MAX_RUNS = 400
MAX_PLACES = 200
MAX_STEPS = 100_000
MAX_FRAME_USERS = 40
MAX_FRAME_USERS_STEPS = 10_000
MAX_ROS2_STEPS = 400_000
"""A lifecycle node of ROS 2 makes all that it has in one callback."""


def run_transitions(machine: AbstractMachine) -> None:
    """Run the virtual methods that a library calls of a program's objects, before anything else."""
    for waiting in _library_callbacks(machine):
        machine.executed_functions.add(waiting.function.key)
        _run_callback(machine, waiting)


def run_pending(machine: AbstractMachine) -> None:
    """Run what was handed to a library, and the methods that an unknown base class may call."""
    for _ in range(MAX_RUNS):
        waiting = next(_runnable_callbacks(machine), None)
        if waiting is None and not machine.deferred_actions:
            return
        if waiting is None:
            _run_deferred(machine)
            continue
        machine.executed_functions.add(waiting.function.key)
        _run_callback(machine, waiting)
    waiting = next(_runnable_callbacks(machine), None)
    if waiting is not None:
        place = Evidence(file=waiting.function.file, line=waiting.function.line)
        machine.recorder.add_unresolved(waiting.function.name, "more callbacks than are run", place)


def run_frame_users(machine: AbstractMachine) -> None:
    """Run the first functions that write or look up a frame, or call one that does.

    Those that joined nodes ran before. What these declare comes too late to count.
    """
    instances = [each for each in machine.instances if isinstance(each, av.Instance)]
    called = [*machine.pending_callbacks, *machine.passed_functions]
    called += [method for each in instances for method in methods(machine, each)]
    found = {each.function.key: each for each in called}
    users = {e.function.name.rpartition("::")[2] for e in called if _uses_frames(e.function)}
    new = [e for key, e in found.items() if key not in machine.executed_functions]
    waiting = (e for e in new if _uses_frames(e.function, users))
    for each in islice(waiting, MAX_FRAME_USERS):
        at = Arguments(frame=StackFrame(file=each.function.file))
        with suppress(EndError, RecursionError), machine.step_budget(MAX_FRAME_USERS_STEPS):
            dispatch(machine, each, at)


def _uses_frames(function: Function, users: Iterable[str] = ()) -> bool:
    names = LOOK_UPS.union(users)
    return STAMPED in written_names(function) or not names.isdisjoint(called_names(function))


def _run_deferred(machine: AbstractMachine) -> None:
    """Make what a library makes once the program is set up."""
    make = machine.deferred_actions.pop(0)
    try:
        with machine.step_budget(MAX_STEPS):
            make()
    except (StepsExceededError, ThrownError) as error:
        what = f"what a library makes: {type(error).__name__}"
        place = error.place or Evidence(file="")
        machine.recorder.add_partly_read(what, "not all of it is run", place)


def _run_callback(machine: AbstractMachine, waiting: av.FunctionValue) -> None:
    function = waiting.function
    machine.recorder.in_parameter_callback = any(
        function is setter for setter in machine.parameter_callbacks
    )
    location = Evidence(file=function.file, line=function.line)
    try:
        with machine.step_budget(MAX_STEPS if machine.recorder.site.ros == 1 else MAX_ROS2_STEPS):
            dispatch(machine, waiting, Arguments(frame=StackFrame(file=function.file)))
    except StepsExceededError as error:
        machine.recorder.add_too_large(function.name, error.place or location)
    except ThrownError as error:
        why = f"{error.name} ends it before all of it is run"
        machine.recorder.add_partly_read(function.name, why, error.place or location)


def _runnable_callbacks(machine: AbstractMachine) -> Iterator[av.FunctionValue]:
    while machine.next_callback < len(machine.pending_callbacks):
        callback = machine.pending_callbacks[machine.next_callback]
        machine.next_callback += 1
        if joins_nodes(machine, callback.function) or machine.runtime.calls_unknown(
            callback.function
        ):
            yield callback
    for handed in machine.passed_functions:
        if _is_unexecuted(machine, handed.function):
            yield handed
    yield from _library_callbacks(machine)
    for instance in list(machine.instances):
        if isinstance(instance, av.Instance):
            yield from _instance_methods(machine, instance)
    if machine.recorder.site.ros > 1:
        yield from _unknown_receiver_methods(machine)


def _instance_methods(
    machine: AbstractMachine, instance: av.Instance
) -> Iterator[av.FunctionValue]:
    """Yield an object's destructor, and the methods that an unknown base class may call."""
    yield from _destructor(machine, instance)
    if has_unknown_base(machine, instance):
        for method in methods(machine, instance):
            if _is_unexecuted(machine, method.function):
                yield method


def _unknown_receiver_methods(machine: AbstractMachine) -> Iterator[av.FunctionValue]:
    """Yield methods of a program's objects that are called of an object which is not known."""
    for instance in list(machine.instances):
        for name in sorted(_method_names(machine, instance) & machine.unknown_method_names):
            found = machine.runtime.attribute(instance, name, ())
            if isinstance(found, av.FunctionValue) and _is_unexecuted(machine, found.function):
                yield found


def _method_names(machine: AbstractMachine, instance: av.Value) -> set[str]:
    lineage = machine.runtime.lineage(instance.type) if isinstance(instance, av.Instance) else ()
    classes = [cls.definition for cls in lineage if isinstance(cls, av.ClassValue)]
    return {name for cls in classes for name in machine.runtime.method_names(cls)}


def _library_callbacks(machine: AbstractMachine) -> Iterator[av.FunctionValue]:
    """Yield the virtual methods that a library calls of objects, each once for each object.

    One that joins no nodes counts if one behind it does, which may read what it has set.
    """
    for instance in list(machine.instances):
        waiting: list[av.FunctionValue] = []
        for name in _virtual_callbacks(machine, instance):
            if (id(instance), name) in machine.started_callbacks:
                continue
            machine.started_callbacks.add((id(instance), name))
            found = machine.runtime.attribute(instance, name, ())
            waiting += [found] if isinstance(found, av.FunctionValue) else []
            if waiting and joins_nodes(machine, waiting[-1].function):
                yield from waiting
                waiting = []


def _virtual_callbacks(machine: AbstractMachine, instance: av.Value) -> tuple[str, ...]:
    lineage = machine.runtime.lineage(instance.type) if isinstance(instance, av.Instance) else ()
    return next(
        (
            cls.virtual_callbacks
            for cls in lineage
            if isinstance(cls, av.LibraryClass) and cls.virtual_callbacks
        ),
        (),
    )


def _destructor(machine: AbstractMachine, instance: av.Instance) -> Iterator[av.FunctionValue]:
    plain = instance.type.name.rpartition("::")[2]
    name = f"~{plain}" if machine.runtime.passes_by_reference else "__del__"
    found = machine.runtime.attribute(instance, name, ())
    if isinstance(found, av.FunctionValue) and _is_unexecuted(machine, found.function):
        yield found


def _is_unexecuted(machine: AbstractMachine, function: Function) -> bool:
    return function.key not in machine.executed_functions and joins_nodes(machine, function)


def joins_nodes(machine: AbstractMachine, function: Function) -> bool:
    """Tell whether a function, or what it may call by name, declares anything."""
    known = machine.joins_cache
    size = machine.runtime.version()
    if machine.joins_cache_version != size:
        machine.joins_cache_version = size
        for key in [key for key, joins in known.items() if not joins]:
            del known[key]
    key = function.key
    if key not in known:
        known[key] = _reaches_client_library(machine, function)
    return known[key]


def _reaches_client_library(machine: AbstractMachine, function: Function) -> bool:
    """Look for a call of a client library; what was looked through in vain needs no second look."""
    api, known, seen = _client_library_api(machine), machine.joins_cache, list[Function]()
    for reached in reachable_functions(machine, [function]):
        if known.get(reached.key) or machine.runtime.related_names(reached) & api:
            return True
        seen.append(reached)
    known.update((reached.key, False) for reached in seen)
    return False


def _client_library_api(machine: AbstractMachine) -> frozenset[str]:
    if machine.recorder.site.ros == 1:
        return ROS1_API
    return ROS2_CPP_API if machine.runtime.passes_by_reference else ROS2_PYTHON_API


def names_written_by_callbacks(machine: AbstractMachine) -> frozenset[str]:
    """Return the members and globals that callbacks may change while the program runs."""
    reached = reachable_functions(machine, list(machine.escaped_functions), include_unrelated=True)
    return frozenset(name for function in reached for name in written_names(function))


def reachable_functions(
    machine: AbstractMachine, queue: list[Function], *, include_unrelated: bool = False
) -> Iterator[Function]:
    """Yield functions and what they may call, by plain names.

    Without `include_unrelated`, those that are known to join no nodes are left out.
    """
    seen: set[tuple[str, int, str]] = set()
    left_out = frozenset[str]() if machine.recorder.site.ros == 1 else _CONTAINER_METHODS
    while queue:
        current = queue.pop()
        if current.key in seen:
            continue
        seen.add(current.key)
        if machine.joins_cache.get(current.key) is False and not include_unrelated:
            continue
        yield current
        find = called_names if include_unrelated else machine.runtime.related_names
        words = find(current) - left_out
        queue.extend(other for word in words for other in machine.runtime.functions_named(word))
        queue.extend(_call_operators(machine, words))


def _call_operators(machine: AbstractMachine, words: frozenset[str]) -> Iterator[Function]:
    """Yield what objects of the named classes do when they are called, in C++."""
    for function in machine.runtime.functions_named("operator()"):
        owner = function.name.rpartition("::")[0]
        if owner and owner.rpartition("::")[2] in words:
            yield function


def has_unknown_base(machine: AbstractMachine, instance: av.Instance) -> bool:
    """Tell whether a class of an object is not here, which may call its methods."""
    return not {"object"}.issuperset(unknown_bases(machine, instance))


def unknown_bases(machine: AbstractMachine, instance: av.Instance) -> list[str]:
    """Return the names of an object's classes that are not here; that of C++ may be empty."""
    lineage = machine.runtime.lineage(instance.type)
    unknown = (cls for cls in lineage if isinstance(cls, (av.ExternalSymbol, av.Unknown)))
    return [cls.name if isinstance(cls, av.ExternalSymbol) else "" for cls in unknown]


def methods(machine: AbstractMachine, instance: av.Instance) -> Iterator[av.FunctionValue]:
    """Yield the methods of an object, as far as its classes are here."""
    for cls in machine.runtime.lineage(instance.type):
        if isinstance(cls, av.ClassValue):
            for name in machine.runtime.method_names(cls.definition):
                found = machine.runtime.attribute(instance, name, ())
                if isinstance(found, av.FunctionValue):
                    yield found


_PYTHON_ENDPOINT_CALLS = ENDPOINT_CALLS | {
    *("Service", "ServiceProxy", "ActionServer", "ActionClient", "wait_for_message"),
    "create_lifecycle_publisher",
}


def _calls_maker(machine: AbstractMachine, name: str, function: Function) -> bool:
    """Tell whether a function of Python makes an endpoint by another; another program's main no."""
    if machine.runtime.passes_by_reference or name == "main" or not joins_nodes(machine, function):
        return False
    reached = reachable_functions(machine, [function])
    return any(machine.runtime.related_names(one) & _PYTHON_ENDPOINT_CALLS for one in reached)


def note_unreached(machine: AbstractMachine, functions: Iterable[tuple[str, Function]]) -> None:
    """Note the functions that would declare something and never ran, one note a file."""
    makers = ENDPOINT_CALLS if machine.runtime.passes_by_reference else _PYTHON_ENDPOINT_CALLS
    unreached: dict[str, list[tuple[str, Function]]] = defaultdict(list)
    candidates = [(name, function) for name, function in functions if function.body is not None]
    if machine.runtime.passes_by_reference:
        makers = ENDPOINT_CALLS | _wrappers(function for _, function in candidates)
    for name, function in candidates:
        if function.key in machine.executed_functions:
            continue
        if machine.runtime.related_names(function) & makers or _calls_maker(
            machine, name, function
        ):
            unreached[function.file].append((f"{name}()", function))
    for body, function in machine.lambdas.items():
        if body not in machine.executed_bodies and called_names(function) & makers:
            unreached[function.file].append(("a lambda", function))
    for file, found in unreached.items():
        more = f" and {len(found) - 1} more" if len(found) > 1 else ""
        lines = dict.fromkeys(function.line for _, function in found[:MAX_PLACES])
        places = [Evidence(file=file, line=line) for line in lines]
        what, why = f"{found[0][0]}{more}", "may join nodes, but nothing that is seen calls it"
        machine.recorder.add_unresolved(what, why, *places, cause=UnresolvedCause.UNREACHED)
    for function in (function for name, function in candidates if name == "main"):
        _note_early_end(machine, function, makers)


def _note_early_end(machine: AbstractMachine, function: Function, makers: frozenset[str]) -> None:
    """Note a `main` that would declare something, if nothing is declared, or noted in its file."""
    if machine.runtime.related_names(function) & makers and machine.recorder.is_empty(
        function.file
    ):
        place = Evidence(file=function.file, line=function.line)
        machine.recorder.add_unresolved("main()", _EARLY_EXIT, place)


def _wrappers(functions: Iterable[Function]) -> frozenset[str]:
    """Return the names that only functions have which make an endpoint by themselves."""
    joining: dict[str, bool] = {}
    for function in functions:
        owner, _, plain = function.name.rpartition("::")
        is_constructor = owner.rpartition("::")[2] == plain
        joins = bool(called_names(function) & ENDPOINT_CALLS) and not is_constructor
        joining[plain] = joining.get(plain, True) and joins
    return frozenset(name for name, joins in joining.items() if joins) - _CONTAINER_METHODS
