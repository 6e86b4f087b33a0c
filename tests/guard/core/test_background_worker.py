"""Work that may hang: who asks for it does not wait, and it is not lost."""

from threading import Event, current_thread

from harness import wait_for

from rtron.guard.core.event_loop import BackgroundWorker


def test_it_is_done_in_a_thread_and_once_more_if_it_is_asked_for_meanwhile():
    may_go_on, names = Event(), []

    def work():
        names.append(current_thread().name)
        may_go_on.wait()

    worker = BackgroundWorker(work, "disk")
    for _ in range(3):
        worker.request()
    wait_for(lambda: names == ["disk"], what="the work")
    for _ in range(3):
        worker.request()
    may_go_on.set()
    wait_for(lambda: names == ["disk"] * 2, what="the work once more")


def test_work_that_fails_is_told_and_done_again(caplog):
    calls = []

    def fail():
        calls.append("call")
        raise ValueError("ours")

    worker = BackgroundWorker(fail, "disk")
    worker.request()
    wait_for(lambda: "internal error in a thread of the guard" in caplog.text, what="the log")
    worker.request()
    wait_for(lambda: len(calls) == 2, what="the next call")
