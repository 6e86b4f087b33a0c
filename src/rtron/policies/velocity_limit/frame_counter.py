"""How many frames a second an image node processes: a sliding window on a steady clock.

`speed_limits.py` makes a limit of it. The rate is never above one frame in the longest gap of the
window: a late frame does not bring back the frames that did not come before it.

A stamp says which frame a message is about: one that was counted within the window is not counted
again, and the newest never, so that a frozen picture is no frame. A stamp of 0 says nothing; such a
message counts by its arrival. Stamps are only compared for being the same, so a camera whose clock
jumps does no harm.
"""

from collections import deque

from rtron.vocabulary import SECOND

# More frames than this in a second are no camera's: what comes beyond is not counted.
MAX_FPS = 1000
NO_STAMP = 0


class LongestGap:
    """The longest time between two frames, of those that ended at most `window` ns before the last.

    None counts as longer than the window: after a silence the rate begins at one frame in it.
    """

    __slots__ = ("_last", "_longest_first", "_window")

    def __init__(self, window: int) -> None:
        self._window = window
        self._last: int | None = None
        self._longest_first: deque[tuple[int, int]] = deque()

    def add_frame(self, now: int) -> None:
        """Note a frame at `now`; a gap that is followed by a longer one no longer matters."""
        if self._last is not None:
            gap = min(now - self._last, self._window)
            while self._longest_first and self._longest_first[-1][1] <= gap:
                self._longest_first.pop()
            self._longest_first.append((now, gap))
            while now - self._longest_first[0][0] >= self._window:
                self._longest_first.popleft()
        self._last = now

    @property
    def longest(self) -> int:
        """The longest gap (ns), 0 if there is none; it changes with a frame only."""
        return self._longest_first[0][1] if self._longest_first else 0


class FrameCounter:
    """The frames of the last `window` ns."""

    __slots__ = ("_frames", "_gaps", "_latest", "_max_frames", "_stamps", "_window")

    def __init__(self, window: int) -> None:
        self._window = window
        self._max_frames = max(1, window * MAX_FPS // SECOND)
        self._frames: deque[tuple[int, int]] = deque()
        self._gaps = LongestGap(window)
        self._stamps: set[int] = set()
        self._latest = NO_STAMP

    def add_frame(self, stamp: int, now: int) -> bool:
        """Note a frame with its `stamp` (ns) that arrived at `now`; False if it does not count."""
        self._remove_expired(now)
        if stamp in self._stamps or len(self._frames) >= self._max_frames:
            return False
        if stamp != NO_STAMP and stamp == self._latest:
            return False
        self._frames.append((now, stamp))
        self._gaps.add_frame(now)
        self._latest = stamp
        if stamp != NO_STAMP:
            self._stamps.add(stamp)
        return True

    def rate(self, now: int) -> float:
        """Return the rate at `now`, frames a second.

        It is what the window holds, and never more than one frame in the time since the last or in
        the longest gap, so the rate falls as soon as a frame does not come, and stays there.
        """
        self._remove_expired(now)
        age = self.last_frame_age(now)
        if age is None:
            return 0.0
        counted = len(self._frames) * SECOND / self._window
        longest = max(age, self._gaps.longest)
        return min(counted, SECOND / longest) if longest else counted

    def last_frame_age(self, now: int) -> int | None:
        """Return the time since the last frame, ns; None if the window holds none."""
        self._remove_expired(now)
        return now - self._frames[-1][0] if self._frames else None

    def _remove_expired(self, now: int) -> None:
        frames = self._frames
        while frames and now - frames[0][0] >= self._window:
            self._stamps.discard(frames.popleft()[1])
