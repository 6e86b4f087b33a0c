from rtron.vocabulary.inventory import Command, Means, Mover, Thing


def test_the_last_commands_and_those_that_are_open():
    near = Command(means=Means.TOPIC, name="/cmd_vel", senders=("/mux",))
    far = Command(means=Means.TOPIC, name="/nav_vel", hops=1)
    mover = Mover(thing=Thing.BASE, commands=(near, far))
    assert (mover.last_commands, mover.open_commands) == ((near,), (far,))
