"""Which nodes make one control loop, which ones a filter, and what is left out."""

import pytest
from finding_graphs import TWIST, found, small_graph, the_finding
from finding_pairs import LOOP

from rtron.vocabulary import Certainty, FindingLevel, Severity

RULE = "mixed_odometry"
MIXED = LOOP.format("/odom/fused", "/odom")
IMU = "    sub /imu sensor_msgs/msg/Imu\n    pub /odom/fused"


class TestMixedOdometry:
    def test_it_names_the_loop_and_the_filter(self):
        finding = the_finding(RULE, small_graph(MIXED))
        assert finding.summary == (
            "/smoother reads /odom, /controller in the same control loop reads /odom/fused"
        )
        assert finding.cause == "/ekf makes /odom/fused of /odom"
        assert finding.remedy == "let /smoother read /odom/fused too"
        assert (finding.certainty, finding.severity) == (Certainty.LIKELY, Severity.MEDIUM)
        assert finding.nodes == ("/smoother", "/controller", "/ekf")

    @pytest.mark.parametrize("package", ["nav2_controller", "nav2_velocity_smoother"])
    def test_a_cascade_of_other_nodes_may_be_right(self, package):
        assert the_finding(RULE, small_graph(MIXED)).level is FindingLevel.REGULAR
        finding = the_finding(RULE, small_graph(MIXED.replace(package, "wheel_pid")))
        assert finding.certainty is Certainty.POSSIBLE
        assert finding.level is FindingLevel.PEDANTIC

    def test_a_cascade_beside_nodes_of_one_pose_is_left_out(self):
        watch = f"/watch watch own\n    sub /cmd_vel {TWIST}\n    sub /odom nav_msgs/msg/Odometry\n"
        finding = the_finding(RULE, small_graph(MIXED + watch))
        assert finding.nodes == ("/smoother", "/controller", "/ekf")

    def test_a_node_of_many_odometries_is_no_filter_of_one_robot(self):
        def fused(size):
            more = "".join(f"    pub /fused{i} nav_msgs/msg/Odometry\n" for i in range(size))
            return found(RULE, small_graph(f"{MIXED}/ekf robot_localization third_party\n{more}"))

        assert fused(4)
        assert not fused(5)

    def test_the_raw_odometry_may_be_read_before_the_fused(self):
        finding = the_finding(RULE, small_graph(LOOP.format("/odom", "/odom/fused")))
        assert finding.summary.startswith("/controller reads /odom, /smoother in the same")

    def test_the_loop_goes_through_nodes_that_read_no_odometry(self):
        mux = f"/mux mux own\n    sub /cmd_vel_raw {TWIST}\n    pub /cmd_vel_mux {TWIST}\n"
        text = MIXED.replace("own\n    sub /cmd_vel_raw", "own\n    sub /cmd_vel_mux")
        assert the_finding(RULE, small_graph(text + mux)).nodes[0] == "/smoother"

    def test_nodes_that_send_each_other_nothing_are_no_loop(self):
        assert not found(RULE, small_graph(MIXED.replace("sub /cmd_vel_raw", "sub /cmd_vel_other")))

    def test_a_node_that_reads_both_is_no_end(self):
        both = "    sub /odom nav_msgs/msg/Odometry\n    sub /odom/fused"
        text = MIXED.replace("own\n    sub /odom/fused", f"own\n{both}")
        assert not found(RULE, small_graph(text))

    def test_the_source_itself_is_no_end(self):
        wheels = f"/wheels wheels own\n    sub /cmd_vel {TWIST}\n    sub /odom nav_msgs/Odometry\n"
        text = LOOP.format("/odom/fused", "/odom/fused").replace("/wheels wheels own\n", wheels)
        assert not found(RULE, small_graph(text))

    def test_another_node_is_a_filter_if_it_reads_two_measurements(self):
        own = MIXED.replace("robot_localization third_party", "my_filter own")
        assert not found(RULE, small_graph(own))
        assert found(RULE, small_graph(own.replace("    pub /odom/fused", IMU)))

    def test_a_node_that_commands_is_no_filter(self):
        own = MIXED.replace("robot_localization third_party", "my_filter own")
        commanding = own.replace("    pub /odom/fused", f"    pub /cmd_vel {TWIST}\n{IMU}")
        assert not found(RULE, small_graph(commanding))

    def test_what_a_filter_makes_of_a_filtered_odometry_is_not_mixed(self):
        text = MIXED.replace(
            "/wheels wheels own\n",
            "/wheels robot_localization own\n    sub /wheel_odom nav_msgs/msg/Odometry\n",
        )
        assert not found(RULE, small_graph(text))
