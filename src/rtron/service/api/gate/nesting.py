"""How deep JSON nests, told without parsing it: parsers and models recurse."""

import re
from itertools import accumulate

DEEPEST = 40
"""The most lists and objects within each other."""
_STRING = re.compile(rb'"(?:[^"\\]|\\.)*(?:"|\\?\Z)', re.DOTALL)
_OTHERS = bytes(byte for byte in range(256) if byte not in b"[]{}")
_STEPS = {ord("["): 1, ord("{"): 1, ord("]"): -1, ord("}"): -1}


def is_too_deep(document: bytes) -> bool:
    """Tell whether more than `DEEPEST` brackets of a JSON document are open at once; linear."""
    brackets = _STRING.sub(b"", document).translate(None, _OTHERS)
    return max(accumulate(map(_STEPS.__getitem__, brackets)), default=0) > DEEPEST
