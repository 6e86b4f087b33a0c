"""Naive models of what policies sense: the whole history is kept, and looked through each time."""

from itertools import pairwise

from rtron.vocabulary import SECOND, WhenUnknown

FOUND, LOST = "found", "lost"
COUNTS_AS = {WhenUnknown.BLOCK: None, WhenUnknown.SET: True, WhenUnknown.CLEAR: False}


class NaiveFrameRate:
    """Every frame that counted, as (arrival, stamp)."""

    def __init__(self, window):
        self.window = window
        self.counted = []

    def recent(self, now):
        return [(at, stamp) for at, stamp in self.counted if now - at < self.window]

    def frame(self, stamp, now):
        recent = self.recent(now)
        stamps = [each for _, each in recent + self.counted[-1:]]
        known = stamp != 0 and stamp in stamps
        counts = not known and len(recent) < max(1, self.window // 1_000_000)
        if counts:
            self.counted.append((now, stamp))
        return counts

    def rate(self, now):
        recent = self.recent(now)
        if not recent:
            return 0.0
        longest = max([now - recent[-1][0], *self.gaps()])
        rate = len(recent) * SECOND / self.window
        return rate if longest == 0 else min(rate, SECOND / longest)

    def gaps(self):
        """Return the gaps before the frames of the window that ends with the last frame."""
        times = [at for at, _ in self.counted]
        ended = [(one, other) for one, other in pairwise(times) if times[-1] - other < self.window]
        return [min(other - one, self.window) for one, other in ended]


class NaiveFrameMonitor:
    """One image node, as (fps, silent)."""

    def __init__(self, plan):
        self.plan = plan
        self.frames, self.camera = NaiveFrameRate(plan.window), NaiveFrameRate(plan.window)

    def rate(self, now):
        counted = self.frames.counted
        if not counted or now - counted[-1][0] >= self.plan.silent_after:
            return 0.0, True
        rate = self.frames.rate(now)
        return (min(rate, self.camera.rate(now)) if self.plan.camera else rate), False


class NaiveBit:
    """Everything that was heard of an event, as (time, what): FOUND, LOST, or how it was judged."""

    def __init__(self, flow):
        self.flow = flow
        self.heard = []
        self.known = None

    def links(self):
        kinds = [what for _, what in self.heard]
        return kinds.count(FOUND) - kinds.count(LOST)

    def newest(self):
        """Return the last message that came since the publisher was gone."""
        links, newest = 0, None
        for at, what in self.heard:
            links += (what == FOUND) - (what == LOST)
            if what == LOST:
                newest = newest if links else None
            elif what != FOUND:
                newest = (at, what)
        return newest

    def since_triggered(self, now):
        triggers = [now - at for at, what in self.heard if what is True]
        return triggers[-1] if triggers else float("inf")

    def read(self, now):
        return self.flow.on_error if self.links() > 1 else self.read_one(now)

    def read_one(self, now):
        flow, newest = self.flow, self.newest()
        if flow.silent is not None:
            return self.since_triggered(now) >= flow.silent
        if flow.present is not None:
            if not self.links():
                return flow.on_silence
            if newest and newest[1] is None:
                return flow.on_error
            return self.since_triggered(now) < flow.present
        if newest is None or now - newest[0] >= flow.max_age:
            return flow.on_silence
        return flow.on_error if newest[1] is None else newest[1]

    def value(self, now):
        """Return the bit; to be asked at each moment, since KEEP is about the one before."""
        read = self.read(now)
        if read is WhenUnknown.KEEP:
            return self.known
        if isinstance(read, WhenUnknown):
            return COUNTS_AS[read]
        self.known = read
        return read


class NaiveRule:
    """A rule's standing, asked at each moment."""

    def __init__(self, condition):
        self.condition = condition
        self.truth, self.met = False, False

    @property
    def holds(self):
        return self.truth is not False

    def update(self, bits):
        before, self.truth = self.truth, self.condition(bits)
        begins = self.truth and not before
        if self.truth is False or begins:
            self.met = False

    def meet(self):
        if self.holds:
            self.met = True

    def blocks(self):
        return self.holds and not self.met
