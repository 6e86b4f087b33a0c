"""tf and tf2_ros: the frames that nodes send and look up (docs.ros.org: tf2_ros; wiki: tf)."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.message_types import HEADER, MESSAGES_WITH_CHILD
from rtron.sources.declaration import FrameBroadcast, FrameUse

_TRANSFORM = "transform"
"""`buffer.transform(message, frame)`: a name that methods of others have too."""
LOOK_UPS = frozenset(
    {
        _TRANSFORM,
        *("lookupTransform", "lookup_transform", "lookup_transform_full", "lookup_transform_async"),
        *("lookup_transform_core", "lookup_transform_full_async", "waitForTransform"),
        *("wait_for_transform_async", "wait_for_transform_full_async", "canTransform"),
        *("can_transform", "can_transform_full", "transformPose", "transformPoint"),
        *("transformVector", "transformQuaternion", "transformPointCloud"),
    }
)
"""The methods that look transforms up, each text of theirs a frame."""
_FRAME_FIELDS = ("frame_id", "child_frame_id")
"""Fields that each callback sets of its own message, before it reads them."""


def note_look_up(machine: AbstractMachine, method: ir.Attr, arguments: Arguments) -> None:
    """Note the frames that a call looks up, if it is one that does.

    tf leaves out a slash before them. tf2 takes none; in Python its methods have a name with `_`.
    """
    is_look_up = method.name != _TRANSFORM or "buffer" in _owner_name(method)
    may_be_tf = machine.recorder.site.ros == 1 and "_" not in method.name
    if method.name in LOOK_UPS and is_look_up:
        for frame in filter(None, map(_known_text, arguments.all_values)):
            named = frame.lstrip("/") if may_be_tf else frame
            use = FrameUse(frame=named, evidence=arguments.evidence, is_look_up=True)
            machine.recorder.add_frame_use(use)


def _owner_name(method: ir.Attr) -> str:
    owner = method.owner
    name = (
        owner.name if isinstance(owner, ir.Attr) else owner.id if isinstance(owner, ir.Name) else ""
    )
    return name.lower()


def _send_transform(
    is_fixed: bool,  # noqa: FBT001 - bound by partial
    machine: AbstractMachine,
    _: av.Value,
    arguments: Arguments,
) -> av.Value:
    """`sendTransform(message)`, or a list, or `(translation, rotation, time, child, parent)`."""
    child, parent = arguments.get(3, "child"), arguments.get(4, "parent")
    sent = [(child, parent)] if child else map(_frames, _messages(arguments.get(0, "transform")))
    for name, below in sent:
        frame = FrameBroadcast(
            child=_known_text(name),
            parent=_known_text(below),
            is_fixed=is_fixed,
            evidence=(arguments.evidence,),
        )
        machine.recorder.add_frame(frame)
    return av.NONE


def _messages(sent: av.Value | None) -> tuple[av.Value | None, ...]:
    return av.items_of(sent)[0] if isinstance(sent, av.ListValue) else (sent,)


def _frames(message: av.Value | None) -> tuple[av.Value | None, av.Value | None]:
    """Return the child and the parent frame of a message, or of a tf::StampedTransform."""
    fields = message.fields if isinstance(message, av.Instance) else {}
    header = fields.get("header")
    below = header.fields.get("frame_id") if isinstance(header, av.Instance) else None
    return fields.get("child_frame_id") or fields.get("child_frame_id_"), (
        below or fields.get("frame_id_")
    )


def _known_text(value: av.Value | None) -> str:
    """Return a text; a frame that is copied from another message has it when it is sent."""
    known = [each for each in av.options(value or av.UNKNOWN) if not _is_frame_field(each)]
    text = known[0].value if len(known) == 1 and isinstance(known[0], av.Scalar) else None
    return str(text) if isinstance(text, str) else ""


def _is_frame_field(value: av.Value) -> bool:
    return isinstance(value, av.Unknown) and value.label in _FRAME_FIELDS


def _make_stamped_transform(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`tf::StampedTransform(transform, time, frame, child)`."""
    frames = zip(("frame_id_", "child_frame_id_"), arguments.values[2:], strict=False)
    return av.Instance(MESSAGE_CLASSES["tf::StampedTransform"], dict(frames))


def _make_message(name: str, _: AbstractMachine, __: Arguments) -> av.Value:
    return av.Instance(MESSAGE_CLASSES[name], {"header": av.Instance(HEADER)})


BROADCASTERS: Mapping[str, av.LibraryClass] = {
    name: av.LibraryClass(
        name,
        methods=dict.fromkeys(
            ("sendTransform", "sendTransformMessage"),
            partial(_send_transform, name.startswith("Static")),
        ),
    )
    for name in ("TransformBroadcaster", "StaticTransformBroadcaster")
}
"""The objects that send transforms, by the names that their classes have in every library."""
_MAKERS: Mapping[str, Callable[..., av.Value]] = {
    "tf::StampedTransform": _make_stamped_transform,
    **{
        name: partial(_make_message, name)
        for message in MESSAGES_WITH_CHILD
        for name in (message.replace("/", "::"), message.replace("/", "::msg::"))
    },
}
MESSAGE_CLASSES: Mapping[str, av.LibraryClass] = {
    name: av.LibraryClass(name, make) for name, make in _MAKERS.items()
}
"""The messages of C++ that name a child frame; what else they hold is not known."""
