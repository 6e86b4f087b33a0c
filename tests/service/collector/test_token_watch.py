"""The watch of the tokens ends with the service."""

from cancelled_tasks import assert_ends_when_cancelled

from rtron.service.collector.token_renewal import TokenWatch


def test_it_ends_at_whatever_moment_a_token_is_revoked():
    current = []

    async def watch():
        current[:] = [TokenWatch(lambda tokens: tokens, interval_s=3600.0)]
        await current[0].run()

    def revoke(step):
        if step % 5 == 4:
            current[0]._is_due.set()

    assert_ends_when_cancelled(watch, revoke)
