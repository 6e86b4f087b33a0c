"""TCPROS headers and frames."""

from itertools import cycle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.errors import WireError
from rtron.wire.ros1.tcpros import (
    LENGTH,
    MAX_FRAME,
    FrameBeginReader,
    FrameReader,
    decode_header,
    encode_header,
)

names = st.text(min_size=1).filter(lambda name: "=" not in name)
bodies = st.lists(st.binary(max_size=50))


def framed(body):
    return LENGTH.pack(len(body)) + body


@given(st.dictionaries(names, st.text()))
def test_a_header_survives_the_way(fields):
    header = encode_header(fields)
    assert LENGTH.unpack_from(header)[0] == len(header) - LENGTH.size
    assert decode_header(header[LENGTH.size :]) == fields


def test_a_value_may_contain_what_separates():
    assert decode_header(framed(b"message_definition=int8 A=1")) == {
        "message_definition": "int8 A=1"
    }


@pytest.mark.parametrize(
    ("body", "why"),
    [
        (b"\x01", "inside a field's length"),
        (LENGTH.pack(9) + b"a=b", "inside a field"),
        (LENGTH.pack(2**32 - 1) + b"a=b", "inside a field"),
        (framed(b"a"), "without a name"),
        (framed(b"=a"), "without a name"),
        (framed(b""), "without a name"),
    ],
)
def test_a_malformed_header_is_refused(body, why):
    with pytest.raises(WireError, match=why):
        decode_header(body)


@given(bodies, st.integers(1, 60))
def test_frames_are_the_same_however_the_stream_is_cut(bodies, size):
    stream = b"".join(map(framed, bodies))
    reader = FrameReader()
    chunks = [stream[at : at + size] for at in range(0, len(stream), size)]
    found = [frame for chunk in chunks for frame in reader.feed(chunk)]
    assert found == [framed(body) for body in bodies]
    assert reader.missing == 0


def test_missing_tells_how_much_the_frame_still_lacks():
    reader = FrameReader()
    assert reader.feed(framed(b"12345678")[:6]) == []
    assert reader.missing == 6
    assert reader.feed(b"345678") == [framed(b"12345678")]
    assert reader.missing == 0


@pytest.mark.parametrize("length", [MAX_FRAME + 1, 2**32 - 1])
def test_an_absurd_length_is_refused_before_its_bytes_arrive(length):
    with pytest.raises(WireError, match="the limit is"):
        FrameReader().feed(LENGTH.pack(length))


def test_an_announced_length_takes_no_memory():
    reader = FrameReader()
    reader.feed(LENGTH.pack(MAX_FRAME) + b"x")
    assert reader.missing == MAX_FRAME - 1


def test_a_refusal_that_is_kept_does_not_lock_the_reader():
    reader = FrameReader(8)
    reader.feed(LENGTH.pack(9)[:2])
    with pytest.raises(WireError) as first:
        reader.feed(LENGTH.pack(9)[2:])
    with pytest.raises(WireError) as second:
        reader.feed(b"x")
    assert str(first.value) == str(second.value)


cuts = st.lists(st.integers(1, 17), min_size=1, max_size=8)


@given(bodies, cuts, st.integers(1, 20))
def test_the_beginnings_of_frames_are_those_of_whole_ones_however_they_arrive(bodies, cuts, size):
    """Where the reader says that bytes may be left out, they never reach it."""
    stream = b"".join(LENGTH.pack(len(body)) + body for body in bodies)
    reader, found, at, sizes = FrameBeginReader(size), [], 0, cycle(cuts)
    while at < len(stream):
        count = next(sizes)
        if reader.skippable:
            count = min(count, reader.skippable)
            found += reader.skip(count)
        else:
            found += reader.feed(stream[at : at + count])
        at += count
    assert found == [LENGTH.pack(len(body[:size])) + body[:size] for body in bodies]
    assert reader.skippable == 0


def test_a_frame_is_not_there_before_its_end():
    reader = FrameBeginReader(4)
    assert reader.feed(LENGTH.pack(10) + b"123456") == []
    assert reader.skippable == 4
    assert reader.skip(3) == []
    assert reader.skip(1) == [LENGTH.pack(4) + b"1234"]


def test_the_beginning_of_a_frame_that_is_too_long_is_refused():
    with pytest.raises(WireError, match="the limit is 8"):
        FrameBeginReader(4, limit=8).feed(LENGTH.pack(9))
