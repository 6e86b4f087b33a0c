"""TCPROS headers and frames."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.errors import WireError
from rtron.wire.ros1.tcpros import LENGTH, MAX_FRAME, FrameReader, decode_header, encode_header

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
