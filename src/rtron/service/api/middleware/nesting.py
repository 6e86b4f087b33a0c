"""How deep JSON nests, told without parsing it: parsers and models recurse."""

from itertools import accumulate

MAX_DEPTH = 40
"""The most lists and objects within each other."""
_CHUNK_BYTES = 1 << 16
_NON_BRACKETS = bytes(byte for byte in range(256) if byte not in b"[]{}")
_DEPTH_CHANGE = {ord("["): 1, ord("{"): 1, ord("]"): -1, ord("}"): -1}


def is_too_deep(document: bytes | bytearray) -> bool:
    """Tell whether more than `MAX_DEPTH` brackets of a JSON document are open at once; linear.

    It works in slices, between which other threads go on.
    """
    if document.count(b"[") + document.count(b"{") <= MAX_DEPTH:
        return False
    bare = document.replace(b"\\\\", b"").replace(b'\\"', b"")
    depth = in_string = 0
    for begin in range(0, len(bare), _CHUNK_BYTES):
        parts = bare[begin : begin + _CHUNK_BYTES].split(b'"')
        brackets = b"".join(parts[in_string::2]).translate(None, _NON_BRACKETS)
        depths = list(accumulate(map(_DEPTH_CHANGE.__getitem__, brackets), initial=depth))
        if max(depths) > MAX_DEPTH:
            return True
        depth = depths[-1]
        in_string ^= (len(parts) - 1) & 1
    return False
