#!/usr/bin/python3
"""Uses what rospy offers of the master, all of it; says `all done` at the end."""

import rospy
from roscpp.srv import Empty


def main():
    rospy.init_node("master_api_client")
    rospy.set_param("~tree", {"a": 1, "b": {"c": [1.5, True, "ä<&>"]}})
    assert rospy.get_param("/master_api_client/tree/b/c") == [1.5, True, "ä<&>"]
    assert rospy.get_param_cached("~tree/a") == 1  # subscribes the parameter
    assert rospy.has_param("tree") is False
    assert rospy.search_param("master_api_client") == "/master_api_client"
    assert "/master_api_client/tree/a" in rospy.get_param_names()
    rospy.set_param("/long", "x" * 200_000)
    assert len(rospy.get_param("/long")) == 200_000
    rospy.delete_param("/long")
    assert not rospy.has_param("/long")
    rospy.Service("~serve", Empty, lambda _: [])
    rospy.wait_for_service("~serve", 60)
    rospy.ServiceProxy("~serve", Empty)()
    master = rospy.get_master()
    assert master.lookupService("/master_api_client/serve")[0] == 1
    assert ["/rosout", "rosgraph_msgs/Log"] in master.getTopicTypes()[2]
    assert ["/rosout", "rosgraph_msgs/Log"] in rospy.get_published_topics()
    assert "/master_api_client" in dict(master.getSystemState()[2][2])["/master_api_client/serve"]
    print("all done")


if __name__ == "__main__":
    main()
