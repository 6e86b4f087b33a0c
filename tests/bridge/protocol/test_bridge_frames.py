"""Frames that a stranger sends: bounded, and whole again from fragments, or refused."""

import base64
import json
import struct
import tracemalloc
import zlib
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.bridge.protocol.frames import (
    FRAGMENT_TIMEOUT,
    MAX_DEPTH,
    MAX_FRAGMENTS,
    MAX_OPEN,
    FragmentAssembler,
    decode_frame,
    encode_frame,
    frame_id,
    png_text,
    split_frame,
    whole_number,
)
from rtron.errors import WireError

LIMIT = 10_000
JSON = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=10,
)


def fragment(num, total, data="x", id="a", **more):
    return {"op": "fragment", "id": id, "num": num, "total": total, "data": data, **more}


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "not JSON"),
        ("{", "not JSON"),
        ("[]", "no JSON object"),
        ("5", "no JSON object"),
        ("{}", "no `op`"),
        ('{"op": 5}', "no `op`"),
        ('{"op": "publish", "msg": NaN}', "NaN is no number of JSON"),
        ('{"op": "publish", "msg": -Infinity}', "-Infinity is no number"),
        ('{"op": "x", "n": ' + "9" * 401 + "}", "too many digits"),
        ('{"op": "x", "n": ' + "9" * 5000 + "}", "too many digits"),
        ('{"op": "x", "n": 1e400}', "1e400 is larger than any number"),
        ('{"op": "x", "n": ' + "9" * 350 + ".5}", "larger than any number"),
        ('{"op": "x", "m": ' + "[" * MAX_DEPTH + "]" * MAX_DEPTH + "}", "nested deeper"),
        ('{"a":' * 100_000, "nested deeper"),
        ("[" * 1_000_000, "nested deeper"),
        ('{"op": "x", "id": []}', "`id`"),
        ('{"op": "x", "id": true}', "`id`"),
        ('{"op": "x", "id": "' + "i" * 257 + '"}', "`id`"),
        ('{"op": "x", "m": "\n"}', "not JSON"),
    ],
)
def test_what_is_no_frame_is_refused(text, reason):
    with pytest.raises(WireError, match=reason):
        decode_frame(text)


@pytest.mark.parametrize("text", ['"\\\\' * 200_000, '"\\"' + '\\"' * 200_000, '"' * 200_001])
def test_texts_that_do_not_end_are_read_in_one_pass(text):
    with pytest.raises(WireError, match="not JSON"):
        decode_frame("[" * 16 + "]" * 16 + "[" * 20 + text)


def test_brackets_in_texts_are_no_depth():
    text = json.dumps({"op": "x", "m": '[{"\\' * 1000})
    assert decode_frame(text)["m"].startswith("[{")


@given(st.dictionaries(st.text(), JSON, max_size=4))
def test_what_json_wrote_is_read(document):
    frame = {**document, "op": "x", "id": 7}
    assert decode_frame(encode_frame(frame)) == frame


@given(st.text() | st.binary().map(lambda data: data.decode("latin1")))
def test_any_text_is_a_frame_or_refused(text):
    try:
        document = decode_frame(text)
    except WireError:
        return
    assert isinstance(document["op"], str)


@pytest.mark.parametrize("value", [-1, 1.5, "1", True, [], -3.0])
def test_what_does_not_count_is_refused(value):
    with pytest.raises(WireError, match="whole number"):
        whole_number({"n": value}, "n")


@pytest.mark.parametrize(("value", "number"), [(0, 0), (3.0, 3), (None, 5)])
def test_what_counts(value, number):
    assert whole_number({"n": value}, "n", 5) == number


@pytest.mark.parametrize("id", [None, "a", 5])
def test_ids(id):
    assert frame_id({"id": id}) == id


@given(st.text(min_size=1, max_size=2000), st.integers(0, 500), st.randoms())
def test_what_was_split_is_put_together_in_any_order(text, size, random):
    parts = [json.loads(each) for each in split_frame(text, size, "a")] if len(text) > 128 else []
    random.shuffle(parts)
    assembler = FragmentAssembler(LIMIT)
    found = [assembler.add(each, 0) for each in parts if each["op"] == "fragment"]
    assert found[-1:] in ([], [text])
    assert found[:-1] == [None] * len(found[:-1])


def test_no_fragment_is_smaller_than_its_own_frame():
    assert len(list(split_frame("x" * 1280, 1, "a"))) == 10


@pytest.mark.parametrize(
    ("frames", "reason"),
    [
        ([fragment(0, 0)], "1 to 1024"),
        ([fragment(2, 2)], "1 to 1024"),
        ([fragment(0, MAX_FRAGMENTS + 1)], "1 to 1024"),
        ([fragment(0, 1 << 60)], "1 to 1024"),
        ([fragment(-1, 2)], "whole number"),
        ([fragment("0", 2)], "whole number"),
        ([fragment(0, 2), fragment(0, 2)], "came twice"),
        ([fragment(0, 2), fragment(1, 3)], "now 3"),
        ([fragment(0, 2, data=5)], "needs `data`"),
        ([fragment(0, 2, data="")], "needs `data`"),
        ([fragment(0, 2, id=None)], "needs the `id`"),
        ([fragment(0, 2, data="x" * (LIMIT + 1))], "more than"),
        ([fragment(0, 9, data="x" * 4000, id=n) for n in range(3)], "more than"),
        ([fragment(0, 2, id=str(n)) for n in range(MAX_OPEN + 1)], "are incomplete"),
    ],
)
def test_fragments_that_do_not_fit_are_refused(frames, reason):
    assembler = FragmentAssembler(LIMIT)
    *first, last = frames
    assert [assembler.add(each, 0) for each in first] == [None] * len(first)
    with pytest.raises(WireError, match=reason):
        assembler.add(last, 0)


def test_a_message_with_a_wrong_fragment_is_forgotten_as_a_whole():
    assembler = FragmentAssembler(LIMIT)
    assembler.add(fragment(0, 2), 0)
    with pytest.raises(WireError):
        assembler.add(fragment(0, 2), 0)
    assert assembler.add(fragment(1, 2), 0) is None


def test_fragments_that_come_too_late_make_no_message():
    assembler = FragmentAssembler(LIMIT)
    for number in range(MAX_OPEN):
        assembler.add(fragment(0, 2, id=number), 0)
    assert assembler.add(fragment(1, 2, id=0), FRAGMENT_TIMEOUT) == "xx"
    assert assembler.add(fragment(0, 2, id="new"), FRAGMENT_TIMEOUT + 1) is None
    assert assembler.add(fragment(1, 2, id=1), FRAGMENT_TIMEOUT + 1) is None


def test_a_bomb_of_fragments_takes_no_memory():
    assembler = FragmentAssembler(LIMIT)
    tracemalloc.start()
    for number in range(5000):
        with suppress(WireError):
            assembler.add(fragment(number % 1024, 1024, data="x" * 1000, id=number % 7), 0)
    used, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert used < 10 * LIMIT


@pytest.mark.parametrize("text", ["", "a", "äöü€", "x" * 10_000, json.dumps(list(range(999)))])
def test_a_png_has_the_bytes_of_the_text_as_its_pixels(text):
    image = base64.b64decode(png_text(text))
    chunks, at = {}, 8
    assert image[:8] == b"\x89PNG\r\n\x1a\n"
    while at < len(image):
        size, kind = struct.unpack_from(">I4s", image, at)
        body = image[at + 8 : at + 8 + size]
        assert struct.unpack_from(">I", image, at + 8 + size)[0] == zlib.crc32(kind + body)
        chunks[kind], at = body, at + 12 + size
    width, height, bits, kind, *_ = struct.unpack(">IIBBBBB", chunks[b"IHDR"])
    rows = zlib.decompress(chunks[b"IDAT"])
    pixels = b"".join(
        rows[n * (width * 3 + 1) + 1 : (n + 1) * (width * 3 + 1)] for n in range(height)
    )
    assert (bits, kind, len(rows)) == (8, 2, height * (width * 3 + 1))
    assert pixels.decode().rstrip("\n") == text
