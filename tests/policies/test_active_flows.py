from rtron.policies.active_flows import ActiveFlows
from rtron.vocabulary import Flow

FLOWS = tuple(Flow(name=f"flow{n}", publisher="/any", priority=n) for n in range(5))


def test_a_flow_is_listed_once_however_often_it_speaks():
    speakers = ActiveFlows(FLOWS, lambda _: 10)
    for now in range(1000):
        speakers.record_message(speakers.by_name[f"flow{now % 5}"], now)
        assert speakers.highest_priority(now).flow.priority == min(now, 4)
    assert len(speakers._heap) == 5


def test_the_silent_ones_are_forgotten():
    speakers = ActiveFlows(FLOWS, lambda flow: flow.priority)
    for speaker in speakers.by_name.values():
        speakers.record_message(speaker, 0)
    assert [speakers.highest_priority(now).flow.priority for now in range(4)] == [4, 4, 4, 4]
    assert speakers.highest_priority(4) is None
    assert not speakers._heap
