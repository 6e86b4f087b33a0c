"""What runs that the program itself does not call: callbacks, threads, methods a library calls."""

from collections.abc import Iterator

from rtron.sources.code.interpreter.abstract_values.value_types import (
    ClassValue,
    Foreign,
    FunctionValue,
    Hole,
    Instance,
    NativeClass,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import (
    Machine,
    StepsExceededError,
    ThrownError,
)
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.stack_frame import Frame
from rtron.sources.code.ir import Class, Function
from rtron.sources.code.ir.references import called_words, written_names
from rtron.vocabulary import Evidence

API = frozenset(
    [
        "advertise",
        "subscribe",
        "advertiseService",
        "serviceClient",
        "advertiseCamera",
        "subscribeCamera",
        "Publisher",
        "Subscriber",
        "Service",
        "ServiceProxy",
        "waitForMessage",
        "wait_for_message",
        "createInstance",
        "system",
        "Popen",
        "createClassInstance",
        "createUnmanagedInstance",
        "ROSLaunchParent",
        "launch",
        "check_call",
        "call",
        "popen",
        "SimpleActionClient",
        "SimpleActionServer",
        "ActionClient",
        "ActionServer",
        "TransformListener",
        "TransformBroadcaster",
        "StaticTransformBroadcaster",
        "Server",
        "Updater",
        "ImageTransport",
        "create",
        "RealtimePublisher",
        "InteractiveMarkerServer",
        "Bond",
        "SubscriberFilter",
        "SimpleActionServer<>",
    ]
)
_BOTH = frozenset(
    [
        *("create_publisher", "create_subscription", "create_service", "create_client"),
        *("create_generic_publisher", "create_generic_subscription", "create_generic_client"),
        *("TransformListener", "TransformBroadcaster", "StaticTransformBroadcaster"),
        *("declare_parameter", "declare_parameters", "wait_for_message", "system", "Updater"),
        *("subscribe", "advertise", "configure"),
    ]
)
API2_CPP = _BOTH | {
    *("create_server", "create_sub_node", "rclcpp::Node", "rclcpp_lifecycle::LifecycleNode"),
    *("create_camera_publisher", "create_camera_subscription", "advertiseCamera"),
    *("subscribeCamera", "SubscriberFilter", "message_filters::Subscriber", "bond::Bond"),
    *("createSharedInstance", "createUniqueInstance", "createUnmanagedInstance"),
    *("registerFromPlugin", "registerNodeType", "registerBuilder", "InteractiveMarkerServer"),
    *("CameraInfoManager", "ParameterEventHandler", "AsyncParametersClient"),
    *("SyncParametersClient", "popen"),
}
"""The same for ROS 2; parameters decide names there, so declaring one counts."""
API2_PYTHON = _BOTH | {
    *("ActionServer", "ActionClient", "Subscriber", "Node", "LifecycleNode", "create_node"),
    "create_lifecycle_publisher",
    *("Buffer", "Popen", "check_call", "create_sub_node", "ParameterEventHandler"),
}
_OF_CONTAINERS = frozenset(
    [
        *("get", "size", "begin", "end", "empty", "push_back", "emplace_back", "emplace", "clear"),
        *("front", "back", "at", "find", "insert", "erase", "c_str", "str", "reset", "lock"),
        *("count", "swap", "data", "resize", "reserve", "value", "load", "store", "what"),
    ]
)
"""Called of containers and pointers, most often: that a class has one says nothing."""
MAX_RUNS = 400
MAX_STEPS = 100_000
MAX_STEPS_2 = 400_000
"""A lifecycle node of ROS 2 makes all that it has in one callback."""


def run_transitions(machine: Machine) -> None:
    """Run the virtual methods that a library calls of a program's objects, before anything else."""
    for waiting in _called(machine):
        machine.ran.add(_key(waiting.function))
        _run(machine, waiting)


def run_pending(machine: Machine) -> None:
    """Run what was handed to a library, and the methods that an unknown base class may call."""
    for _ in range(MAX_RUNS):
        waiting = next(_waiting(machine), None)
        if waiting is None and not machine.deferred:
            return
        if waiting is None:
            _make_deferred(machine)
            continue
        machine.ran.add(_key(waiting.function))
        _run(machine, waiting)


def _make_deferred(machine: Machine) -> None:
    """Make what a library makes once the program is set up."""
    make = machine.deferred.pop(0)
    try:
        with machine.budget(MAX_STEPS):
            make()
    except (StepsExceededError, ThrownError) as error:
        what = f"what a library makes: {type(error).__name__}"
        machine.recorder.unresolved(what, "not all of it is run", Evidence(file=""))


def _run(machine: Machine, waiting: FunctionValue) -> None:
    function = waiting.function
    machine.recorder.setting = any(function is setter for setter in machine.setters)
    place = Evidence(file=function.file, line=function.line)
    try:
        with machine.budget(MAX_STEPS if machine.recorder.site.ros == 1 else MAX_STEPS_2):
            dispatch(machine, waiting, Arguments(frame=Frame(file=function.file)))
    except StepsExceededError:
        machine.recorder.unresolved(function.name, "too large to be run whole", place)
    except ThrownError as error:
        machine.recorder.unresolved(
            function.name, f"{error.name} ends it before all of it is run", place
        )


def _waiting(machine: Machine) -> Iterator[FunctionValue]:
    while machine.called_back < len(machine.pending):
        callback = machine.pending[machine.called_back]
        machine.called_back += 1
        if joins_nodes(machine, callback.function):
            yield callback
    for handed in machine.handed:
        if _counts(machine, handed.function):
            yield handed
    yield from _called(machine)
    for instance in list(machine.instances):
        if isinstance(instance, Instance):
            yield from _of_instance(machine, instance)
    if machine.recorder.site.ros > 1:
        yield from _asked(machine)


def _of_instance(machine: Machine, instance: Instance) -> Iterator[FunctionValue]:
    """Yield an object's destructor, and the methods that an unknown base class may call."""
    yield from _destructor(machine, instance)
    if _has_unknown_base(machine, instance):
        for method in _methods(machine, instance):
            if _counts(machine, method.function):
                yield method


def _asked(machine: Machine) -> Iterator[FunctionValue]:
    """Yield methods of a program's objects that are called of an object which is not known."""
    for instance in list(machine.instances):
        for name in sorted(_own_names(machine, instance) & machine.asked):
            found = machine.world.attribute(instance, name, ())
            if isinstance(found, FunctionValue) and _counts(machine, found.function):
                yield found


def _own_names(machine: Machine, instance: Value) -> set[str]:
    lineage = machine.world.lineage(instance.type) if isinstance(instance, Instance) else ()
    classes = [cls.definition for cls in lineage if isinstance(cls, ClassValue)]
    return {name for cls in classes for name in machine.world.method_names(cls)}


def _called(machine: Machine) -> Iterator[FunctionValue]:
    """Yield the virtual methods that a library calls of objects, each once for each object.

    One that joins no nodes counts if one behind it does, which may ask what it has set.
    """
    for instance in list(machine.instances):
        waiting: list[FunctionValue] = []
        for name in _library_calls(machine, instance):
            if (id(instance), name) in machine.transitions:
                continue
            machine.transitions.add((id(instance), name))
            found = machine.world.attribute(instance, name, ())
            waiting += [found] if isinstance(found, FunctionValue) else []
            if waiting and joins_nodes(machine, waiting[-1].function):
                yield from waiting
                waiting = []


def _library_calls(machine: Machine, instance: Value) -> tuple[str, ...]:
    lineage = machine.world.lineage(instance.type) if isinstance(instance, Instance) else ()
    return next((cls.called for cls in lineage if isinstance(cls, NativeClass) and cls.called), ())


def _destructor(machine: Machine, instance: Instance) -> Iterator[FunctionValue]:
    plain = instance.type.name.rpartition("::")[2]
    name = f"~{plain}" if machine.world.by_reference else "__del__"
    found = machine.world.attribute(instance, name, ())
    if isinstance(found, FunctionValue) and _counts(machine, found.function):
        yield found


def _key(function: Function) -> tuple[str, int, str]:
    return function.file, function.line, function.name


def _counts(machine: Machine, function: Function) -> bool:
    return _key(function) not in machine.ran and joins_nodes(machine, function)


def joins_nodes(machine: Machine, function: Function) -> bool:
    """Tell whether a function, or what it may call by name, declares anything."""
    known = machine.joining
    size = machine.world.size()
    if machine.joining_at != size:
        machine.joining_at = size
        for key in [key for key, joins in known.items() if not joins]:
            del known[key]
    key = _key(function)
    if key not in known:
        known[key] = _joins_nodes(machine, function)
    return known[key]


def _joins_nodes(machine: Machine, function: Function) -> bool:
    """Look for a call of a client library; what was looked through in vain needs no second look."""
    api, known, seen = _api(machine), machine.joining, list[Function]()
    for reached in _reached(machine, [function]):
        if known.get(_key(reached)) or called_words(reached) & api:
            return True
        seen.append(reached)
    known.update((_key(reached), False) for reached in seen)
    return False


def _api(machine: Machine) -> frozenset[str]:
    if machine.recorder.site.ros == 1:
        return API
    return API2_CPP if machine.world.by_reference else API2_PYTHON


def changed_at_any_time(machine: Machine) -> frozenset[str]:
    """Return the members and globals that callbacks may change while the program runs."""
    reached = _reached(machine, list(machine.escaped), whole=True)
    return frozenset(name for function in reached for name in written_names(function))


def _reached(machine: Machine, queue: list[Function], *, whole: bool = False) -> Iterator[Function]:
    """Yield functions and what they may call, by plain names.

    Without `whole`, those that are known to join no nodes are left out.
    """
    seen: set[tuple[str, int, str]] = set()
    left_out = frozenset[str]() if machine.recorder.site.ros == 1 else _OF_CONTAINERS
    while queue:
        current = queue.pop()
        if _key(current) in seen:
            continue
        seen.add(_key(current))
        if machine.joining.get(_key(current)) is False and not whole:
            continue
        yield current
        words = called_words(current) - left_out
        queue.extend(other for word in words for other in machine.world.named(word))


def _has_unknown_base(machine: Machine, instance: Instance) -> bool:
    lineage = list(machine.world.lineage(instance.type))
    return any(isinstance(cls, (Foreign, Hole)) and not _is_object(cls) for cls in lineage)


def _is_object(cls: Value) -> bool:
    return isinstance(cls, Foreign) and cls.name == "object"


def _methods(machine: Machine, instance: Instance) -> Iterator[FunctionValue]:
    for cls in machine.world.lineage(instance.type):
        if isinstance(cls, ClassValue):
            for name in _names(machine, cls.definition):
                found = machine.world.attribute(instance, name, ())
                if isinstance(found, FunctionValue):
                    yield found


def _names(machine: Machine, definition: Class) -> list[str]:
    return machine.world.method_names(definition)
