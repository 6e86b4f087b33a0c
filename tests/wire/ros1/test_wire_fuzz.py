"""Whatever a stranger sends, a parser gives a value or a WireError, and nothing else."""

from contextlib import suppress
from xmlrpc.client import dumps

from hypothesis import given
from hypothesis import strategies as st

from rtron.errors import WireError
from rtron.wire.ros1.tcpros import LENGTH, FrameReader, decode_header, encode_header
from rtron.wire.ros1.xmlrpc import decode_call, decode_response, encode_response, split_uri

LIMIT = 64
TAGS = "methodCall methodResponse methodName params param fault value array data struct member name"
TYPES = "int i4 i8 boolean double string base64 dateTime.iso8601 nil bigdecimal biginteger"

texts = st.text(st.characters(exclude_categories=["Cs", "Cc"]), max_size=20)
leaves = st.one_of(
    st.none(), st.booleans(), st.integers(-(2**31), 2**31 - 1), st.floats(), texts, st.binary()
)
values = st.recursive(
    leaves,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(texts, inner, max_size=3),
    max_leaves=6,
)
lengths = st.one_of(
    st.integers(0, LIMIT + 1), st.sampled_from([0, LIMIT - 1, LIMIT, LIMIT + 1, 2**31, 2**32 - 1])
).map(LENGTH.pack)
tags = st.sampled_from([*TAGS.split(), *TYPES.split(), "ex:i8", "a"])
pieces = st.one_of(
    tags.map(lambda tag: f"<{tag}>"),
    tags.map(lambda tag: f"</{tag}>"),
    tags.map(lambda tag: f"<{tag}/>"),
    st.sampled_from(["1", "-1", "1e999", "nan", "&lt;", "&x;", "&#0;", "]]>", "<!-- -->", "AA=="]),
    st.sampled_from(["<!DOCTYPE a [", "<!ENTITY x 'y'>", "]>", "<?xml version='1.0'?>", "<?p?>"]),
    st.sampled_from(["9" * 5000, "20260101T00:00:00", "<a b='c'>", "\ufffe"]),
    texts,
)


@st.composite
def mutated(draw, documents):
    """A valid document in which a few stretches of bytes were replaced, repeated or cut out."""
    document = bytearray(draw(documents))
    for _ in range(draw(st.integers(0, 4))):
        start = draw(st.integers(0, len(document)))
        end = draw(st.integers(start, min(len(document), start + 12)))
        kept = bytes(document[start:end])
        document[start:end] = draw(st.sampled_from([b"", kept * 2]) | st.binary(max_size=6))
    return bytes(document)


calls = values.map(lambda value: dumps((value,), "method", allow_none=True).encode())
answers = values.map(encode_response)
headers = st.dictionaries(texts.filter(lambda t: t and "=" not in t), texts).map(encode_header)
frames = st.lists(st.binary(max_size=LIMIT)).map(
    lambda bodies: b"".join(LENGTH.pack(len(body)) + body for body in bodies)
)
documents = st.one_of(
    mutated(calls | answers),
    st.lists(pieces, max_size=30).map(lambda found: "".join(found).encode()),
    st.binary(max_size=80),
)
streams = st.one_of(
    mutated(frames),
    st.lists(lengths | st.binary(max_size=8), max_size=10).map(b"".join),
    st.binary(max_size=200),
)
header_bodies = st.one_of(
    mutated(headers.map(lambda header: header[LENGTH.size :])),
    st.lists(lengths | st.sampled_from([b"=", b"a=b"]) | st.binary(max_size=8)).map(b"".join),
)


@given(document=documents)
def test_fuzz_xmlrpc(given_inputs, document):
    given_inputs[0] += 1
    for decode in (decode_call, decode_response):
        with suppress(WireError):
            assert repr(decode(document))


@given(uri=st.text() | texts.map("http://{}:1/".format) | st.text().map("http://{}".format))
def test_fuzz_address(given_inputs, uri):
    given_inputs[0] += 1
    with suppress(WireError):
        host, port = split_uri(uri)
        assert host
        assert 0 < port < 1 << 16


@given(body=header_bodies)
def test_fuzz_header(given_inputs, body):
    given_inputs[0] += 1
    with suppress(WireError):
        assert all(decode_header(body))


@given(stream=streams, cuts=st.lists(st.integers(1, LIMIT)))
def test_fuzz_frames(given_inputs, stream, cuts):
    given_inputs[0] += 1
    whole = outcome([stream])
    assert outcome([stream[n : n + 1] for n in range(len(stream))]) == whole
    assert outcome(cut(stream, cuts)) == whole


def outcome(chunks):
    """Return the frames, or nothing if the stream broke the protocol."""
    reader = FrameReader(LIMIT)
    try:
        return [frame for chunk in chunks for frame in reader.feed(chunk)]
    except WireError:
        return None


def cut(stream, cuts):
    for length in cuts:
        yield stream[:length]
        stream = stream[length:]
    yield stream
