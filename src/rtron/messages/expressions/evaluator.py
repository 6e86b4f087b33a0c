"""What expressions say about messages: each message is decoded, and each text asked, once."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from rtron.errors import WireError
from rtron.messages.common.definition import Definition
from rtron.messages.common.encoding import Encoding
from rtron.messages.expressions.compiler import ExpressionCompiler, evaluate
from rtron.messages.expressions.frames import FrameError, ReferenceFrame, header_of
from rtron.messages.expressions.protobuf_wire import transcoder
from rtron.vocabulary import Area, Transform

ExpressionResult = bool | str
"""Whether an expression holds, or why that is not known."""


@dataclass(frozen=True, slots=True)
class _FrameGroup:
    """Compiled texts whose positions are compared in one frame; None: as they are."""

    texts: tuple[Any, ...]
    areas: Mapping[str, Any]
    frame: ReferenceFrame | None


class MessageEvaluator:
    """The expressions `texts` over the messages of one type, which they call `subject`.

    `frames` are those that the positions of each text are compared in, empty where none is asked;
    a text that names areas is compared in theirs. InputError as in `check_expression`.
    """

    __slots__ = ("_activate", "_groups", "_order", "_parse", "_read")

    def __init__(
        self,
        definition: Definition,
        texts: Sequence[str],
        *,
        subject: str,
        encoding: Encoding,
        areas: Sequence[Area] = (),
        transforms: Sequence[Transform] = (),
        frames: Sequence[str] = (),
    ) -> None:
        known = ExpressionCompiler(definition, subject, areas)
        requested = zip(texts, frames or [""] * len(texts), strict=True)
        questions = [(known.frame(text, frame), text) for text, frame in requested]
        distinct = sorted(set(questions))
        self._order = tuple(distinct.index(each) for each in questions)
        self._groups = tuple(_groups(distinct, known, definition, transforms))
        self._activate = known.activate
        self._parse: Callable[[bytes], Any] = known.message.FromString
        fields = set().union(*(known.fields(text) for text in texts))
        header = {header_of(definition)} if distinct and distinct[-1][0] else set()
        self._read = transcoder(definition, encoding, fields | header)

    def evaluate(self, message: bytes) -> tuple[ExpressionResult, ...]:
        """Return for each text whether it holds, or why that is not known."""
        try:
            read = self._read(message)
        except WireError as error:
            return (str(error),) * len(self._order)
        results: list[ExpressionResult] = []
        for group in self._groups:
            results += self._evaluate_group(group, read)
        return tuple([results[index] for index in self._order])

    def _evaluate_group(self, group: _FrameGroup, read: bytes) -> list[ExpressionResult]:
        message = self._parse(read)
        if group.frame:
            try:
                group.frame.transform(message)
            except FrameError as refusal:
                return [str(refusal)] * len(group.texts)
        activation = self._activate(message, group.areas)
        return [evaluate(text, activation) for text in group.texts]


def check_expression(
    definition: Definition, text: str, subject: str, areas: Sequence[Area] = (), *, frame: str = ""
) -> None:
    """Refuse (InputError) what is no condition on messages of this type; the error has the column.

    Fields are called `subject.name`, areas by their names; `frame` is the one asked for. Refused
    too: positions asked for in a frame where no header tells theirs, and areas in several frames.
    """
    MessageEvaluator(
        definition, [text], subject=subject, encoding=Encoding.ROS1, areas=areas, frames=[frame]
    )


def _groups(
    questions: Sequence[tuple[str, str]],
    known: ExpressionCompiler,
    definition: Definition,
    transforms: Sequence[Transform],
) -> Iterator[_FrameGroup]:
    for name, group in groupby(questions, key=lambda question: question[0]):
        texts = [text for _, text in group]
        compiled = tuple(known.compile(text) for text in texts)
        fields = {field for text in texts for field in known.fields(text)}
        frame = ReferenceFrame(name, definition, fields, transforms) if name else None
        yield _FrameGroup(compiled, known.areas(texts), frame)
