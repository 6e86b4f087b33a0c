"""Naive models of the policies: they look at every flow and message each time."""

from rtron.vocabulary import Decision, PolicyName, StreamKind

PASS, HOLD, DROP = Decision.PASS, Decision.HOLD, Decision.DROP


class NaivePreemption:
    def __init__(self, settings):
        self.limit = settings.release_after
        self.priority = {f.name: f.priority for f in settings.flows if not f.block}
        self.spoken = {}

    def verdict(self, flow, now):
        if flow not in self.priority:
            return DROP
        self.spoken[flow] = now
        return PASS if self.owner(now) == flow else DROP

    def owner(self, now):
        fresh = [flow for flow, last in self.spoken.items() if now - last < self.limit]
        return max(fresh, key=self.priority.get, default=None)


class NaiveQueue:
    """Common to the queues; `waiting` holds [flow, message, arrived, number]."""

    def __init__(self, settings):
        self.settings = settings
        self.flows = {f.name: f for f in settings.flows if not f.block}
        self.commands = settings.kind is StreamKind.COMMAND
        self.by_priority = settings.policy is PolicyName.PRIORITY_QUEUE
        self.waiting, self.leaving, self.number = [], [], 0

    def verdict(self, flow, message, now):
        if flow not in self.flows:
            return DROP
        self.pass_time(now)
        self.hear(flow, now)
        mine = [w for w in self.waiting if self.commands and w[0] == flow]
        if self.may_pass(flow, now):
            self.drop(mine)
            self.go(flow, now)
            return PASS
        size = self.settings.queue_size
        total = len(self.waiting) + len(self.leaving)
        if total >= 2 * size or (not mine and len(self.waiting) >= size):
            return DROP
        self.number += 1
        place = mine[0][3] if mine else self.number
        self.drop(mine)
        self.waiting.append([flow, message, now, place])
        return HOLD

    def tick(self, now):
        self.pass_time(now)
        while (waiting := self.next()) and self.may_leave(waiting[0], now):
            self.waiting.remove(waiting)
            self.go(waiting[0], now)
            self.leaving.append((waiting[1], PASS))
            self.pass_time(now)
        leaving, self.leaving = self.leaving, []
        return leaving

    def drop(self, several):
        for one in several:
            self.waiting.remove(one)
            self.leaving.append((one[1], DROP))

    def pass_time(self, now):
        old = [w for w in self.waiting if now - w[2] >= self.settings.max_age]
        self.drop(sorted(old, key=lambda w: w[2]))
        self.lapse(now)

    def next(self):
        def order(waiting):
            return (-self.flows[waiting[0]].priority if self.by_priority else 0, waiting[3])

        return min(self.waiting, key=order, default=None)

    def timeout(self, flow, default):
        timeout = self.flows[flow].timeout
        return default if timeout is None else timeout

    def hear(self, flow, now):
        pass


class NaiveTurns(NaiveQueue):
    """Actions of both queues, and commands of FIFO_Queue."""

    turn, began, last, chosen = None, 0, 0, None

    def over(self, now):
        default = self.settings.release_after if self.commands else self.settings.max_hold
        silent = now - self.last >= self.timeout(self.turn, default)
        return silent or now - self.began >= self.settings.max_hold

    def lapse(self, now):
        if self.turn is not None and self.over(now):
            self.turn = None
        if self.turn is None and self.chosen not in self.waiting:
            self.chosen = super().next()

    def next(self):
        return super().next() if self.commands else self.chosen

    def may_pass(self, flow, now):
        if self.turn is None:
            return not self.waiting
        return self.commands and self.turn == flow

    def may_leave(self, flow, now):
        return self.turn is None

    def go(self, flow, now):
        if self.turn != flow:
            self.began = now
        self.turn, self.last, self.chosen = flow, now, None

    def done(self, now):
        self.pass_time(now)
        self.turn = None
        self.lapse(now)

    def owner(self):
        return self.turn


class NaiveMasking(NaiveQueue):
    """Commands of Priority_Queue."""

    went = None

    def __init__(self, settings):
        super().__init__(settings)
        self.spoken = {}

    def fresh(self, flow, now):
        limit = self.timeout(flow, self.settings.release_after)
        return flow in self.spoken and now - self.spoken[flow] < limit

    def higher(self, flow):
        return [f for f in self.flows if self.flows[f].priority > self.flows[flow].priority]

    def hear(self, flow, now):
        self.spoken[flow] = now

    def lapse(self, now):
        if self.went is not None and not self.fresh(self.went, now):
            self.went = None

    def may_pass(self, flow, now):
        waits = {w[0] for w in self.waiting}
        return not any(f in waits or self.fresh(f, now) for f in self.higher(flow))

    def may_leave(self, flow, now):
        return not any(self.fresh(f, now) for f in self.higher(flow))

    def go(self, flow, now):
        self.spoken[flow] = now
        self.went = flow

    def done(self, now):
        self.pass_time(now)
        self.spoken.pop(self.went, None)
        self.went = None

    def owner(self):
        return self.went


def naive_queue(settings):
    masking = settings.policy is PolicyName.PRIORITY_QUEUE and settings.kind is StreamKind.COMMAND
    return NaiveMasking(settings) if masking else NaiveTurns(settings)
