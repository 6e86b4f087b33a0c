"""How deep JSON nests, told without parsing it: parsers and models recurse."""

from itertools import accumulate

DEEPEST = 40
"""The most lists and objects within each other."""
_SLICE = 1 << 16
_OTHERS = bytes(byte for byte in range(256) if byte not in b"[]{}")
_STEPS = {ord("["): 1, ord("{"): 1, ord("]"): -1, ord("}"): -1}


def is_too_deep(document: bytes | bytearray) -> bool:
    """Tell whether more than `DEEPEST` brackets of a JSON document are open at once; linear.

    It works in slices, between which other threads go on.
    """
    if document.count(b"[") + document.count(b"{") <= DEEPEST:
        return False
    bare = document.replace(b"\\\\", b"").replace(b'\\"', b"")
    depth = in_string = 0
    for begin in range(0, len(bare), _SLICE):
        parts = bare[begin : begin + _SLICE].split(b'"')
        brackets = b"".join(parts[in_string::2]).translate(None, _OTHERS)
        depths = list(accumulate(map(_STEPS.__getitem__, brackets), initial=depth))
        if max(depths) > DEEPEST:
            return True
        depth = depths[-1]
        in_string ^= (len(parts) - 1) & 1
    return False
