"""Frames of the device protocol: whole or in pieces, and what a hostile peer sends."""

import json
import struct
from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from example_budget import examples
from rtron.demos.world.server import requests
from rtron.demos.world.server.protocol import (
    MAX_BLOB,
    MAX_HEAD,
    DeviceFrame,
    FrameParser,
    encode_frame,
)
from rtron.demos.world.server.requests import (
    ClientRole,
    DevicesRequest,
    RateRequest,
    ResetRequest,
    StartRequest,
)
from rtron.errors import WireError

PLAIN = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(st.characters(exclude_categories=["Cs"])),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner),
    max_leaves=5,
)
HEADS = st.dictionaries(
    st.sampled_from(["hello", "velocity", "order", "case", "seed", "rate", "camera_rate", "key"]),
    PLAIN
    | st.sampled_from([*ClientRole, "reset", "rate", "start", "gr", 10**400, [1, 2], [True, 0]]),
)


def framed(text, blob=b""):
    return struct.pack("!II", len(text), len(blob)) + text + blob


@settings(max_examples=examples(40))
@given(st.lists(st.tuples(st.dictionaries(st.text(max_size=5), st.integers()), st.binary())))
def test_frames_come_out_as_they_went_in_however_they_are_cut(sent):
    data = b"".join(encode_frame(head, blob) for head, blob in sent)
    parser = FrameParser()
    pieces = [data[i : i + 7] for i in range(0, len(data), 7)]
    assert [f for piece in pieces for f in parser.feed(piece)] == [
        DeviceFrame(*one) for one in sent
    ]


@pytest.mark.parametrize(
    "data",
    [
        struct.pack("!II", MAX_HEAD + 1, 0),
        struct.pack("!II", 2, MAX_BLOB + 1),
        struct.pack("!II", 2**32 - 1, 2**32 - 1),
        framed(b""),
        framed(b"[1]"),
        framed(b"null"),
        framed(b"{"),
        framed(b'{"velocity": [NaN, 0]}'),
        framed(b'{"velocity": [Infinity, 0]}'),
        framed(b"\xff\xfe{}"),
        framed(b'{"a":' + b"[" * 30000 + b"]" * 30000 + b"}"),
        framed(b'{"a": ' + b"9" * 5000 + b"}"),
        b"GET / HTTP/1.1\r\n\r\n",
    ],
)
def test_what_is_no_frame_is_refused(data):
    with pytest.raises(WireError):
        list(FrameParser().feed(data))


def test_a_client_may_not_send_a_blob():
    with pytest.raises(WireError):
        list(FrameParser(max_blob=0).feed(encode_frame({}, b"x")))


def test_what_is_too_long_or_no_number_is_not_sent():
    for head, blob in (({"a": "x" * MAX_HEAD}, b""), ({}, bytes(MAX_BLOB + 1))):
        with pytest.raises(ValueError):
            encode_frame(head, blob)
    with pytest.raises(ValueError):
        encode_frame({"a": float("nan")})


@given(st.binary(max_size=200))
def test_bytes_of_any_kind_make_frames_or_a_wire_error(data):
    try:
        frames = list(FrameParser().feed(data))
    except WireError:
        return
    assert all(isinstance(frame.head, dict) for frame in frames)


@given(
    HEADS, st.sampled_from([requests.parse_role, requests.parse_velocity, requests.parse_request])
)
def test_a_message_of_any_kind_is_understood_or_refused(head, read):
    with suppress(WireError):
        assert read(head) is not None


def test_messages_are_understood():
    assert requests.parse_role({"hello": "lidar"}) is ClientRole.LIDAR
    assert requests.parse_velocity({"velocity": [1, -0.5]}) == (1.0, -0.5)
    reset = {"order": "reset", "case": "rsr", "seed": 4}
    assert requests.parse_request(reset) == ResetRequest("rsr", 4, 10.0)
    assert requests.parse_request(reset | {"camera_rate": 5}) == ResetRequest("rsr", 4, 5.0)
    assert requests.parse_request({"order": "rate", "rate": 3.5}) == RateRequest(3.5)
    assert requests.parse_request({"order": "start"}) == StartRequest()
    assert requests.parse_request({"order": "devices"}) == DevicesRequest()


@pytest.mark.parametrize(
    "head",
    [
        {"order": "reset", "case": "gr", "seed": True},
        {"order": "reset", "case": "gr", "seed": -1},
        {"order": "reset", "case": "gr", "seed": 1.5},
        {"order": "reset", "case": "other", "seed": 1},
        {"order": "reset", "case": ["gr"], "seed": 1},
        {"order": "reset", "case": "gr", "seed": 1, "camera_rate": 0},
        {"order": "reset", "case": "gr", "seed": 1, "camera_rate": 1e9},
        {"order": "rate", "rate": -1},
        {"order": "rate", "rate": True},
        {"order": ["reset"]},
        {},
    ],
)
def test_orders_that_make_no_sense_are_refused(head):
    with pytest.raises(WireError):
        requests.parse_request(head)


@pytest.mark.parametrize(
    "text", ["[1]", "[1, 2, 3]", '["1", 2]', "[true, 0]", "[1e999, 0]", "null", "{}", '"ab"']
)
def test_velocities_that_make_no_sense_are_refused(text):
    with pytest.raises(WireError):
        requests.parse_velocity({"velocity": json.loads(text)})
