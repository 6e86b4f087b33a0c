"""The functions that expressions have besides CEL's own: places, areas and distances.

They are written out in CEL before an expression is compiled. Functions in Python would be slower,
and cel-expr-python 0.1.3 loses the memory of the arguments of each call.
"""

import re
from collections.abc import Collection, Iterator, Sequence
from typing import Any

from rtron.messages.protobuf_types import AREA, POINT, protobuf_name

FUNCTIONS = ("inside", "distance", "place")
NOT_FINITE = "a position is not finite"
"""What the evaluation of a position that is NaN or Inf ends with."""
TOLERANCE = "1e-9"
"""What lies as near to an edge (m) counts as inside: areas are mostly forbidden."""

_TOKEN = re.compile(
    r"""(?:[bB]?[rR]|[rR][bB])(?:\"{3}.*?\"{3}|'{3}.*?'{3}|"[^"]*"|'[^']*')"""
    r"""|[bB]?(?:"{3}(?:\\.|.)*?"{3}|'{3}(?:\\.|.)*?'{3}|"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*')"""
    r"""|//[^\n]*|\s+|`[^`]*`|\w+|.""",
    re.DOTALL | re.ASCII,
)
_FINITE = "math.isFinite({0}.x) && math.isFinite({0}.y)"
_REFUSED = "{{'': {value}}}['{reason}']"
_ODD = (
    "(({area}).edges.filter(rtron_e, (rtron_e.y > rtron_p.y) != (rtron_e.end > rtron_p.y) && "
    "rtron_p.x < rtron_e.x + (rtron_p.y - rtron_e.y) * rtron_e.slope).size() % 2 == 1)"
)
_SHARE = (
    "math.least(1.0, math.greatest(0.0, ((rtron_p.x - rtron_e.x) * rtron_e.dx + "
    "(rtron_p.y - rtron_e.y) * rtron_e.dy) * rtron_e.inverse))"
)
_AWAY = (
    "math.least(({area}).edges.map(rtron_e, [%s].map(rtron_t, %s)[0]))"
    % (
        _SHARE,
        "math.sqrt((rtron_p.x - rtron_e.x - rtron_t * rtron_e.dx) * "
        "(rtron_p.x - rtron_e.x - rtron_t * rtron_e.dx) + "
        "(rtron_p.y - rtron_e.y - rtron_t * rtron_e.dy) * "
        "(rtron_p.y - rtron_e.y - rtron_t * rtron_e.dy))",
    )
)
_INSIDE = (
    f"[{{point}}].exists(rtron_p, {_FINITE.format('rtron_p')} ? "
    f"({_ODD} || {_AWAY} <= {TOLERANCE}) : {_REFUSED.format(value='true', reason=NOT_FINITE)})"
)
_TO_AREA = (
    f"[{{point}}].map(rtron_p, {_FINITE.format('rtron_p')} ? ({_ODD} ? 0.0 : "
    f"[{_AWAY}].map(rtron_d, rtron_d <= {TOLERANCE} ? 0.0 : rtron_d)[0]) : "
    f"{_REFUSED.format(value='0.0', reason=NOT_FINITE)})[0]"
)
_BETWEEN = (
    f"[{{point}}].map(rtron_p, [{{other}}].map(rtron_q, {_FINITE.format('rtron_p')} && "
    f"{_FINITE.format('rtron_q')} ? math.sqrt((rtron_p.x - rtron_q.x) * (rtron_p.x - rtron_q.x) + "
    "(rtron_p.y - rtron_q.y) * (rtron_p.y - rtron_q.y)) : "
    f"{_REFUSED.format(value='0.0', reason=NOT_FINITE)})[0])[0]"
)
_PLACE = f"{protobuf_name(POINT)}{{{{x: {{x}}, y: {{y}}}}}}"
