"""A child that ends when its parent does, however that ends (prctl(2), PR_SET_PDEATHSIG)."""

import ctypes
import os

_PR_SET_PDEATHSIG = 1
_prctl = ctypes.CDLL(None, use_errno=True).prctl


def end_with_parent(parent: int, number: int) -> None:
    """Get a signal when the parent ends; end at once if it has ended already."""
    _prctl(_PR_SET_PDEATHSIG, number)
    if os.getppid() != parent:
        os._exit(1)
