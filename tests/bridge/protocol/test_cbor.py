"""CBOR that goes out, as another implementation reads it."""

import math
import struct

import pytest
from bridge_parts import WALL, Talk
from hypothesis import given
from hypothesis import strategies as st

from rtron.bridge.protocol import effects
from rtron.bridge.protocol.cbor import encode_cbor
from rtron.messages import Encoding, parse_definition
from rtron.messages.common.json_decoder import NumberArray, decode_binary
from rtron.messages.common.json_encoder import encode_json

cbor2 = pytest.importorskip("cbor2", reason="cbor2 comes with roslibpy, of the extra `dev`")

EDGES = [0, 23, 24, 255, 256, 65535, 65536, 2**32 - 1, 2**32, 2**63 - 1, 2**64 - 1]
VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.sampled_from(EDGES + [-1 - each for each in EDGES])
    | st.integers(-(2**64), 2**64 - 1)
    | st.floats(allow_nan=False)
    | st.text(),
    lambda inner: st.lists(inner, max_size=30) | st.dictionaries(st.text(), inner, max_size=30),
    max_leaves=40,
)


@given(VALUES)
def test_what_is_written_another_one_reads(value):
    assert cbor2.loads(encode_cbor(value)) == value


def test_nan_is_nan():
    assert math.isnan(cbor2.loads(encode_cbor(math.nan)))


def test_larger_numbers_are_in_no_message():
    with pytest.raises(OverflowError):
        encode_cbor(2**64)


@pytest.mark.parametrize("encoding", list(Encoding))
@pytest.mark.parametrize(
    ("type", "code", "tag", "values"),
    [
        ("float64", "d", 86, [0.5, -math.inf]),
        ("float32", "f", 85, [0.5, 2.0]),
        ("int8", "b", 72, [-1, 2]),
        ("int16", "h", 77, [-300]),
        ("uint16", "H", 69, [300] * 30),
        ("int32", "i", 78, []),
        ("uint32", "I", 70, [1 << 31]),
        ("int64", "q", 79, [-(1 << 62)]),
        ("uint64", "Q", 71, [1 << 63]),
        ("uint8", "B", None, [1, 2, 3]),
        ("char", "B", None, [255]),
    ],
)
def test_arrays_of_numbers_are_typed(encoding, type, code, tag, values):
    definition = parse_definition("t/Row", f"string before\n{type}[] cells\nfloat64 after\n")
    finite = [0 if value == -math.inf else value for value in values]
    message, _ = encode_json(definition, encoding, {"before": "x", "cells": finite}, WALL, 9999)
    read = decode_binary(definition, encoding, message)
    data = struct.pack(f"<{len(values)}{code}", *finite)
    assert read["cells"] == NumberArray(type, data)
    found = cbor2.loads(encode_cbor(NumberArray(type, data)))
    assert getattr(found, "tag", None) == tag
    assert getattr(found, "value", found) == data


def test_lists_of_texts_and_truths_are_lists():
    definition = parse_definition("t/Row", "bool[2] b\nstring[] s\nfloat64 nan\n")
    message, _ = encode_json(definition, Encoding.CDR, {"b": [True, False], "s": ["a"]}, WALL, 99)
    read = decode_binary(definition, Encoding.CDR, message[:-8] + struct.pack("<d", math.nan))
    assert (read["b"], read["s"]) == ([True, False], ["a"])
    assert math.isnan(read["nan"])


def test_a_client_that_asks_for_cbor_gets_binary_frames():
    talk = Talk()
    talk.say("subscribe", topic="/chat", compression="cbor", fragment_size=128)
    definition = talk.types.message("std_msgs/String")
    text = "ä" * 300
    message, _ = encode_json(definition, Encoding.ROS1, {"data": text}, WALL, 9999)
    (sent,) = talk.deliver("/chat", message)
    assert isinstance(sent, effects.SendMessage)
    (frame,) = sent.frames
    assert cbor2.loads(frame) == {"op": "publish", "topic": "/chat", "msg": {"data": text}}
