"""Services that a client calls, those of rosapi among them, which tell only what it may know.

A call that nobody answers ends after a while; only a few may be unanswered at a time.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import count
from typing import TYPE_CHECKING, Any

from rtron.bridge.protocol.client_state import message_bucket
from rtron.bridge.protocol.effects import (
    ParameterVerb,
    RequestParameter,
    RequestService,
    SendAnswer,
)
from rtron.bridge.protocol.frames import (
    Document,
    encode_frame,
    frame_id,
    name_of,
    parse_json,
    split_frame,
    whole_number,
)
from rtron.bridge.protocol.rosapi import ROSAPI, RosApi
from rtron.bridge.rights.document import CallRight, matches_name, same_type
from rtron.errors import RTronError, WireError
from rtron.messages.common.json_decoder import decode_response
from rtron.vocabulary import SECOND

if TYPE_CHECKING:
    from rtron.bridge.protocol.client_state import ClientState
    from rtron.messages import Definition

_PARAMETER_RATE = 10.0
_LARGE = 1 << 62


@dataclass(frozen=True, slots=True)
class _OpenCall:
    """A call whose answer is not there yet; `response` is None for a parameter."""

    service: str
    id: object
    deadline: int
    fragment: int
    response: Definition | None = None


class ServiceOperations:
    """What one client calls, as far as its rights go."""

    def __init__(self, state: ClientState) -> None:
        self._state = state
        self._may_call = {right.service: right for right in state.client.call}
        self._rates = {
            right.service: state.rates.keep(f"call {right.service}", message_bucket(right.rate))
            for right in state.client.call
        }
        self._parameter_rate = state.rates.keep("parameters", message_bucket(_PARAMETER_RATE))
        self._numbers = count(1)
        self._open: dict[int, _OpenCall] = {}
        self._rosapi = RosApi(state)

    def call_service(self, document: Document, now: int, wall_time: int) -> None:
        """Call a service. Who is refused gets an answer, too: `result` false, and the reason."""
        service = name_of(document, "service")
        try:
            self._call(service, document, now, wall_time)
        except RTronError as error:
            self._answer(service, frame_id(document), str(error), is_success=False)
            raise

    def finish(self, number: int, answer: bytes | Document | RTronError) -> None:
        """Take the answer to a call: a service's response, a parameter's values, or an error."""
        call = self._open.pop(number, None)
        if call is None:
            return
        try:
            values = self._values(call, answer)
        except RTronError as error:
            self._answer(call.service, call.id, str(error), is_success=False)
            return
        self._answer(call.service, call.id, values, is_success=True, fragment=call.fragment)

    def end_late(self, now: int) -> None:
        """End the calls that nobody has answered in time."""
        for number in [each for each, call in self._open.items() if call.deadline <= now]:
            limit = self._state.client.limits.call_timeout
            self.finish(number, WireError(f"no answer within {limit:g} s"))

    @property
    def next_at(self) -> int | None:
        """When the next call is late, ns."""
        return min((call.deadline for call in self._open.values()), default=None)

    def _call(self, service: str, document: Document, now: int, wall_time: int) -> None:
        right = self._may_call.get(service)
        if right is None and service.startswith(ROSAPI):
            self._call_rosapi(service, document, now, wall_time)
            return
        if right is None:
            raise WireError(f"{self._state.client.name} may not call {service[:80]}")
        self._check_call(right, str(document.get("type") or ""), now)
        request, response = self._state.types.service(right.type)
        args = _arguments(request, document.get("args"))
        message = self._state.encode(request, args, wall_time, frame_id(document))
        if right.approval:
            self._state.check_approval(f"call {service}", args, now)
        number = self._begin(service, document, now, response)
        self._state.effects.append(RequestService(number, service, right.type, message))

    def _check_call(self, right: CallRight, type: str, now: int) -> None:
        if type and not same_type(right.type, type):
            raise WireError(f"{right.service} is of type {right.type}, not {type[:80]}")
        self._check_open()
        if not self._rates[right.service].take(now):
            raise WireError(f"{right.service}: more than {right.rate:g} calls a second")

    def _check_open(self) -> None:
        limit = self._state.client.limits.calls
        if len(self._open) >= limit:
            raise WireError(f"{limit} of your calls are unanswered; wait for one")

    def _begin(
        self, service: str, document: Document, now: int, response: Definition | None = None
    ) -> int:
        number = next(self._numbers)
        deadline = now + int(self._state.client.limits.call_timeout * SECOND)
        fragment = whole_number(document, "fragment_size") or _LARGE
        self._open[number] = _OpenCall(service, frame_id(document), deadline, fragment, response)
        return number

    def _values(self, call: _OpenCall, answer: bytes | Document | RTronError) -> Document:
        if isinstance(answer, RTronError):
            raise answer
        if not isinstance(answer, bytes) or call.response is None:
            return answer if isinstance(answer, dict) else {}
        limit = self._state.client.limits.message
        if len(answer) > limit:
            raise WireError(f"the answer has {len(answer)} bytes, you take at most {limit}")
        return decode_response(call.response, self._state.types.encoding, answer)

    def _answer(
        self, service: str, id: object, values: object, *, is_success: bool, fragment: int = _LARGE
    ) -> None:
        document: Document = {"op": "service_response", "service": service, "values": values}
        document["result"] = is_success
        if id is not None:
            document["id"] = id
        for text in split_frame(encode_frame(document), fragment, f"{service}:{id}"):
            self._state.effects.append(SendAnswer(text))

    def _call_rosapi(self, service: str, document: Document, now: int, wall_time: int) -> None:
        """Answer a service of rosapi from the rights, or read and write a parameter."""
        name = service.removeprefix(ROSAPI)
        args = document.get("args") or {}
        if not isinstance(args, dict):
            raise WireError(f"{service} takes an object of arguments")
        if self._rosapi.knows(name):
            values = self._rosapi.answer(name, args, wall_time)
            self._answer(service, frame_id(document), values, is_success=True)
        elif name in [verb.value for verb in ParameterVerb]:
            self._call_parameter(ParameterVerb(name), service, document, args, now)
        else:
            raise WireError(f"{self._state.client.name} may not call {service[:80]}")

    def _call_parameter(
        self, verb: ParameterVerb, service: str, document: Document, args: Document, now: int
    ) -> None:
        name = args.get("name")
        rights = self._state.client.parameters
        writes = verb in (ParameterVerb.SET, ParameterVerb.DELETE)
        patterns = rights.write if writes else rights.read
        if not isinstance(name, str) or not any(matches_name(each, name) for each in patterns):
            what = "write" if writes else "read"
            raise WireError(f"{self._state.client.name} may not {what} {str(name)[:80]}")
        self._check_open()
        if not self._parameter_rate.take(now):
            raise WireError(f"parameters: more than {_PARAMETER_RATE:g} calls a second")
        value = _parameter_value(args) if verb is ParameterVerb.SET else None
        number = self._begin(service, document, now)
        self._state.effects.append(RequestParameter(number, verb, name, value))


def _arguments(request: Definition, args: Any) -> Any:  # noqa: ANN401 - JSON
    """Return a request's fields; a list has their values in order (rosbridge v2.0, 3.3.8)."""
    if args is None:
        return {}
    if not isinstance(args, list):
        return args
    names = [field.name for field in request.fields]
    if len(args) > len(names):
        raise WireError(f"{request.type} has {len(names)} fields, not {len(args)}")
    return dict(zip(names, args, strict=False))


def _parameter_value(args: Document) -> Any:  # noqa: ANN401 - JSON
    """Return what a parameter is set to, which comes as JSON in a text."""
    try:
        return parse_json(str(args.get("value")))
    except ValueError as error:
        raise WireError(f"the parameter's value is not JSON: {error}") from None
