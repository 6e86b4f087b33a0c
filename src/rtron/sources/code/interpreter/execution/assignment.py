"""Writes to variables, members and elements."""

from dataclasses import replace
from typing import Any

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.abstract_values.elements import is_slice, slice_of
from rtron.sources.code.interpreter.abstract_values.items import unpack, unpack_with_rest
from rtron.sources.code.interpreter.cpp.iterators import write_through
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame, StorageSlot
from rtron.sources.declaration import FrameUse, PluginId
from rtron.vocabulary import Evidence

STAMPED = "frame_id"
"""The field of a message's header that names its frame (std_msgs/Header)."""
_CHILD_FRAME = "child_frame_id"
"""The field of an odometry that names the frame of its velocity (nav_msgs/Odometry)."""

_PLUGIN_ID = "_id"
"""How the fields of goals end that name a plugin of the server (nav2_msgs)."""


def assign(machine: AbstractMachine, target: ir.Expr, value: av.Value, frame: StackFrame) -> None:
    """Write a value to what an expression names; what cannot be written to is left."""
    if isinstance(target, ir.Name):
        slot = _target_slot(machine, target.id, frame)
        if not write_through(machine, slot.holder.get(slot.key), value):
            machine.undo_log.set(*slot, value)
    elif isinstance(target, ir.SequenceExpr):
        items, certain = machine.runtime.iterate(value)
        seen = av.list_of(items) if certain else value
        for item, part in zip(target.items, _unpack_parts(target, seen), strict=True):
            assign(machine, item, part, frame)
    elif isinstance(target, ir.Star):
        assign(machine, target.value, value, frame)
    elif isinstance(target, ir.Attr):
        _assign_member(machine, target, value, frame)
    elif isinstance(target, ir.Index):
        _assign_element(machine, target, value, frame)


def _target_slot(machine: AbstractMachine, name: str, frame: StackFrame) -> StorageSlot:
    """Return where a name is kept that is written to: what hides a constant is another variable."""
    if machine.runtime.is_constant(name, frame):
        frame.constants[name] = False
        frame.aliases.pop(name, None)
        return StorageSlot(frame.variables, name)
    return machine.runtime.slot(name, frame)


def slot_of(machine: AbstractMachine, node: ir.Expr, frame: StackFrame) -> StorageSlot | None:
    """Return where the value of an expression is kept; None for one that is kept nowhere."""
    if isinstance(node, ir.Name):
        return machine.runtime.slot(node.id, frame)
    if isinstance(node, ir.Attr):
        owner = machine.evaluate(node.owner, frame)
        return StorageSlot(owner.fields, node.name) if isinstance(owner, av.Instance) else None
    if isinstance(node, ir.Index):
        return _element_slot(machine, node, frame)
    return None


def _element_slot(
    machine: AbstractMachine, node: ir.Index, frame: StackFrame
) -> StorageSlot | None:
    owner, key = machine.evaluate(node.owner, frame), machine.evaluate(node.key, frame)
    if isinstance(owner, av.MapValue) and owner.key_of(key) is not av.OPEN:
        return StorageSlot(owner.fields, owner.key_of(key))
    return None


def _unpack_parts(target: ir.SequenceExpr, value: av.Value) -> tuple[av.Value, ...]:
    stars = [at for at, item in enumerate(target.items) if isinstance(item, ir.Star)]
    if not stars:
        return unpack(value, len(target.items))
    return unpack_with_rest(value, stars[0], len(target.items) - stars[0] - 1)


def _assign_member(
    machine: AbstractMachine, target: ir.Attr, value: av.Value, frame: StackFrame
) -> None:
    owners = av.options(machine.evaluate(target.owner, frame))
    at = Arguments(line=machine.line, frame=frame)
    if target.name == STAMPED and _owner_name(target) == "header":
        _note_stamp(machine, owners, value, at.evidence)
    elif target.name == _CHILD_FRAME and any(map(_is_odometry, owners)):
        _note_stamp(machine, (), value, at.evidence)
    elif any(map(_is_goal, owners)):
        note_plugin_id(machine, target.name, value, at.evidence)
    for owner in owners:
        before = owner.fields.get(target.name) if isinstance(owner, _OBJECTS) else None
        new = value if len(owners) == 1 or before is None else av.join([before, value])
        assign_member(machine, owner, target.name, new, at)


def _is_goal(message: av.Value) -> bool:
    """Return whether a value is an action's goal, whose class is not here."""
    if not isinstance(message, av.Unknown):
        return False
    made_by = message.type.name if message.type else message.label.removesuffix("()")
    return made_by.endswith("Goal")


def note_plugin_id(machine: AbstractMachine, field: str, value: av.Value, place: Evidence) -> None:
    """Note the plugin that a goal asks its server for, if the field names one that is known."""
    if field.endswith(_PLUGIN_ID) and isinstance(value, av.Scalar) and value.value:
        namespace = machine.recorder.site.name.rpartition("/")[0]
        name = f"{namespace}/{field}/{value.value}"
        machine.recorder.add_plugin_id(PluginId(name=name, evidence=place, is_request=True))


def _is_odometry(message: av.Value) -> bool:
    return isinstance(message, av.Instance) and message.type.name.endswith("Odometry")


def _owner_name(target: ir.Attr) -> str:
    owner = target.owner
    return (
        owner.name if isinstance(owner, ir.Attr) else owner.id if isinstance(owner, ir.Name) else ""
    )


def _note_stamp(
    machine: AbstractMachine, headers: tuple[av.Value, ...], value: av.Value, place: Evidence
) -> None:
    """Note the frame of a message, if it is known; what names a child frame too is a transform."""
    is_transform = any(isinstance(each, av.Instance) for each in headers)
    if isinstance(value, av.Scalar) and isinstance(value.value, str) and not is_transform:
        machine.recorder.add_frame_use(FrameUse(frame=str(value.value), evidence=place))


def assign_member(
    machine: AbstractMachine, owner: av.Value, name: str, value: av.Value, at: Arguments
) -> None:
    """Write a member of an object, a class or a module, as `setattr` does too.

    An object of a library that is not here calls the functions that it is given so.
    """
    setter = _setter(machine, owner, name)
    if setter is not None:
        machine.call(setter, at.with_values(value))
    elif isinstance(owner, (av.ExternalSymbol, av.LibraryClass, av.LibraryFunction)):
        _note_replaced_member(machine, owner, name, at)
    elif isinstance(owner, _OBJECTS):
        machine.undo_log.set(owner.fields, name, value)
    elif isinstance(owner, av.Unknown):
        machine.escape(value)


def forget_texts(machine: AbstractMachine, fields: dict[Any, av.Value]) -> None:
    """Forget the texts and numbers among members, any of which may have been replaced."""
    for name, value in list(fields.items()):
        if isinstance(value, (av.Scalar, av.PartialText)):
            machine.undo_log.set(fields, name, av.Unknown(str(name)))


def _note_replaced_member(
    machine: AbstractMachine,
    owner: av.ExternalSymbol | av.LibraryClass | av.LibraryFunction,
    name: str,
    at: Arguments,
) -> None:
    """Note that a program replaces what a ROS library has: the library's own is taken."""
    if owner.name.partition(".")[0] in _ROS_LIBRARIES:
        why = "is replaced by the program: what calls it is not followed there"
        machine.recorder.add_unresolved(f"{owner.name}.{name}", why, at.evidence)


_OBJECTS = (av.Instance, av.ClassValue, av.ModuleValue)
_ROS_LIBRARIES = {"rospy", "rclpy", "actionlib", "message_filters", "roslaunch"}


def _setter(machine: AbstractMachine, owner: av.Value, name: str) -> av.FunctionValue | None:
    """Return the function of Python that an assignment calls: a property's, or `__setattr__`."""
    for cls in machine.runtime.lineage(owner.type) if isinstance(owner, av.Instance) else ():
        found = cls.fields.get(name) if isinstance(cls, av.ClassValue) else None
        setter = found.fields.get("setter") if isinstance(found, av.Instance) else None
        if isinstance(setter, av.FunctionValue):
            return replace(setter, owner=owner)
        described = machine.runtime.special_method(found, "__set__") if found else None
        if isinstance(described, av.FunctionValue):
            return replace(described, bound_arguments=(owner,))
    own = machine.runtime.special_method(owner, "__setattr__")
    return (
        replace(own, bound_arguments=(av.Scalar(name),))
        if isinstance(own, av.FunctionValue)
        else None
    )


def _assign_element(
    machine: AbstractMachine, target: ir.Index, value: av.Value, frame: StackFrame
) -> None:
    key = machine.evaluate(target.key, frame)
    for owner in av.options(machine.evaluate(target.owner, frame)):
        method = machine.runtime.special_method(owner, "__setitem__")
        if method is not None and isinstance(method, av.FunctionValue):
            machine.call(method, Arguments(values=(key, value), frame=frame))
        elif isinstance(owner, av.MapValue) and owner.is_namespace and owner.key_of(key) is av.OPEN:
            forget_texts(machine, owner.fields)
        elif isinstance(owner, av.MapValue):
            machine.undo_log.set(owner.fields, owner.key_of(key), value)
        elif isinstance(owner, av.ListValue):
            (_assign_slice if is_slice(key) else _assign_item)(machine, owner, key, value)
        elif av.is_text(owner):
            _assign_character(machine, target, frame)
        elif isinstance(owner, av.Instance) and machine.runtime.passes_by_reference:
            _call_subscript(machine, owner, key, frame)


def _call_subscript(
    machine: AbstractMachine, owner: av.Instance, key: av.Value, frame: StackFrame
) -> None:
    """`object[key] = value` calls the operator that the object's class has."""
    operator = machine.runtime.attribute(owner, "operator[]", ())
    if isinstance(operator, av.FunctionValue):
        machine.call(operator, Arguments(values=(key,), frame=frame))


def _assign_character(machine: AbstractMachine, target: ir.Index, frame: StackFrame) -> None:
    """`s[0] = 'x'`: what the string is then is left open."""
    slot = slot_of(machine, target.owner, frame)
    if slot is not None:
        machine.undo_log.set(*slot, av.Unknown(slot.label))


def remove_element(machine: AbstractMachine, owner: av.Value, key: av.Value) -> None:
    """Take an element away; which one is not known where the key is not."""
    if isinstance(owner, av.MapValue):
        name = owner.key_of(key)
        if name is not av.OPEN and name in owner.fields:
            machine.undo_log.remove(owner.fields, name)
    elif (
        isinstance(owner, av.ListValue)
        and isinstance(key, av.Scalar)
        and isinstance(key.value, int)
    ):
        items = list(owner.items)
        if -len(items) <= key.value < len(items):
            del items[key.value]
            machine.undo_log.set(owner.fields, "items", tuple(items))
    elif isinstance(owner, av.ListValue) and is_slice(key):
        _assign_slice(machine, owner, key, av.ListValue())


def _assign_slice(
    machine: AbstractMachine, owner: av.ListValue, key: av.Value, value: av.Value
) -> None:
    """`a[i:j] = b`; where i, j or b are not known, the list may hold all of both."""
    (given, certain), items = av.items_of(value), list(owner.items)
    bounds = slice_of(key) or slice(len(items), None)
    try:
        items[bounds] = given
    except ValueError:
        certain = False
    if slice_of(key) is None or not certain:
        machine.undo_log.mark_open(owner.fields)
    machine.undo_log.set(owner.fields, "items", tuple(items))


def _assign_item(
    machine: AbstractMachine, owner: av.ListValue, key: av.Value, value: av.Value
) -> None:
    items = list(owner.items)
    if (
        isinstance(key, av.Scalar)
        and isinstance(key.value, int)
        and -len(items) <= key.value < len(items)
    ):
        items[key.value] = value
    else:
        items.append(value)
        machine.undo_log.mark_open(owner.fields)
    machine.undo_log.set(owner.fields, "items", tuple(items))
