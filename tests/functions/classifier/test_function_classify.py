"""From names, descriptions and READMEs to functions."""

import pytest

from rtron.functions.classifier.pipeline import classify, classify_name
from rtron.functions.classifier.result import DecisionSource, InformationSource
from rtron.functions.domains import DOMAIN_BY_TYPE
from rtron.functions.repository import SourcePackage, SourceRepository
from rtron.vocabulary import Domain, FunctionType

T = FunctionType


def repository(name, *packages, readme=""):
    return SourceRepository(
        name=name,
        packages=tuple(SourcePackage(name=p, description=d) for p, d in packages),
        readme=readme,
    )


def test_every_type_has_a_domain():
    assert set(DOMAIN_BY_TYPE) == set(FunctionType)
    assert set(DOMAIN_BY_TYPE.values()) == set(Domain)
    assert DOMAIN_BY_TYPE[T.SWITCHER] is Domain.CONTROL


@pytest.mark.parametrize(
    ("name", "type"),
    [
        ("stereo_camera_calibration", T.PREPROCESSING),
        ("laser_filters", T.PREPROCESSING),
        ("ukf_localization", T.LOCALIZATION),
        ("octomap_builder", T.MAPPING),
        ("face_detection", T.RECOGNITION),
        ("dwa_local_planner", T.PATH_PLANNING),
        ("wooden_arm_moveit_config", T.PATH_PLANNING),
        ("behavior_tree_engine", T.GOAL_PLANNER),
        ("cart_trajectory_controller", T.PATH_TRACKING),
        ("keyboard_teleop", T.TELEOPERATION),
        ("talk_tts", T.SPEECH_GENERATION),
        ("twist_mux", T.SWITCHER),
        ("turtlebot9_bringup", T.MOBILE),
        ("two_finger_gripper_driver", T.MANIPULATOR),
        ("sound_player", T.SPEAKER),
        ("cheap_imu_driver", T.SENSORS),
        ("rqt_something", T.VISUALIZATION),
        ("cart_description", T.VISUALIZATION),
        ("grpc_bridge", T.SUPPORT),
        ("some_msgs", T.EXTENSION),
        ("catkin_helpers", T.EXTENSION),
    ],
)
def test_a_name_tells(name, type):
    found = classify(repository(name))
    assert found.primary is type
    assert found.decided_by is DecisionSource.NAME


def test_the_name_is_asked_before_the_manifest():
    found = classify(repository("lidar_driver", ("lidar_driver", "Plans paths for arms.")))
    assert (found.primary, found.decided_by) == (T.SENSORS, DecisionSource.NAME)


def test_a_weak_name_is_believed_if_the_manifest_does_not_outweigh_it():
    alone = classify(repository("turtlebot_foo", ("turtlebot_foo", "Says nothing.")))
    assert (alone.primary, alone.decided_by) == (T.MOBILE, DecisionSource.NAME)
    outweighed = classify(repository("turtlebot_foo", ("turtlebot_foo", "Calibrates it.")))
    assert (outweighed.primary, outweighed.decided_by) == (T.PREPROCESSING, DecisionSource.MANIFEST)
    strong = classify(repository("turtlebot_driver", ("turtlebot_driver", "Calibrates it.")))
    assert (strong.primary, strong.decided_by) == (T.MOBILE, DecisionSource.NAME)


def test_a_weak_name_and_a_manifest_that_tell_alike_decide_nothing():
    alike = classify(repository("turtlebot_foo", ("turtlebot_foo", "Serialization.")))
    assert alike.decided_by is DecisionSource.NONE
    assert {found.type for found in alike.evidence} == {T.MOBILE, T.EXTENSION}


def test_the_manifest_is_asked_before_the_readme():
    found = classify(
        repository("foo", ("foo", "A driver for a laser scanner."), readme="Plans paths for arms.")
    )
    assert (found.primary, found.decided_by) == (T.SENSORS, DecisionSource.MANIFEST)
    assert {evidence.source for evidence in found.evidence} == {InformationSource.MANIFEST}


def test_the_readme_is_asked_last():
    found = classify(repository("foo", ("foo", "The foo package"), readme="Plans paths for arms."))
    assert (found.primary, found.decided_by) == (T.PATH_PLANNING, DecisionSource.README)


def test_what_nothing_tells_is_most_likely_an_extension_and_this_is_unsure():
    found = classify(repository("foo", ("foo", ""), readme="# foo\nHello."))
    assert (found.functions, found.decided_by) == ((T.EXTENSION,), DecisionSource.NONE)
    assert found.primary is T.EXTENSION
    assert found.evidence == ()
    assert 0.3 < found.confidence < 0.65


def test_a_library_is_of_what_all_pieces_tell_about_as_strongly():
    library = ("foo", "A library with utility functions.")
    alone = classify(repository("foo", library))
    assert (alone.primary, alone.decided_by) == (T.EXTENSION, DecisionSource.MANIFEST)
    of_speech = classify(repository("foo", library, readme="Speech recognition for robots."))
    assert (of_speech.primary, of_speech.decided_by) == (T.RECOGNITION, DecisionSource.README)
    assert {evidence.type for evidence in of_speech.evidence} == {T.RECOGNITION}


def test_a_name_that_clearly_is_of_a_library_is_believed():
    readme = "Speech recognition for robots."
    assert classify(repository("foo_msgs", readme=readme)).primary is T.EXTENSION
    assert classify(repository("foo_vendor", readme=readme)).primary is T.EXTENSION


def test_what_is_told_weakly_is_no_reason_that_a_library_is_none():
    library = ("foo", "A library with utility functions.")
    assert classify(repository("foo", library, readme="It has a sensor.")).primary is T.EXTENSION


def test_the_controllers_of_an_arm_are_part_of_its_driver():
    packages = [("foo_arm_driver", ""), ("foo_arm_description", ""), ("foo_arm_controllers", "")]
    found = classify(repository("foo_arm", *packages))
    assert (found.primary, T.PATH_TRACKING in found.functions) == (T.MANIPULATOR, False)
    packages = [("foo_base_driver", ""), ("foo_description", ""), ("foo_controllers", "")]
    assert T.PATH_TRACKING in classify(repository("foo_base_driver", *packages)).functions


def test_two_that_are_told_alike_decide_nothing():
    alike = repository("foo", ("foo", "Calibration and localization."))
    assert classify(alike).decided_by is DecisionSource.NONE
    assert {found.type for found in classify(alike).evidence} == {T.PREPROCESSING, T.LOCALIZATION}


def test_the_readme_decides_between_two_that_are_told_alike():
    found = classify(
        repository(
            "foo", ("foo", "Calibration and localization."), readme="Localization of a robot."
        )
    )
    assert (found.primary, found.decided_by) == (T.LOCALIZATION, DecisionSource.README)


def test_a_later_sentence_counts_less():
    first = repository("foo", ("foo", "Calibration of cameras. Localization of robots."))
    assert classify(first).primary is T.PREPROCESSING
    later = repository("foo", ("foo", "Localization of robots. Calibration of cameras."))
    assert classify(later).primary is T.LOCALIZATION


def test_a_late_sentence_of_a_readme_counts_little():
    early = "Hello.\n\nThis is it.\n\nPlans paths for arms."
    late = "Hello.\n\nThis is it.\n\nMore.\n\nPlans paths for arms."
    assert classify(repository("foo", readme=early)).primary is T.PATH_PLANNING
    assert classify(repository("foo", readme=late)).decided_by is DecisionSource.NONE
    assert classify(repository("foo", readme=late)).evidence


def test_a_rule_counts_in_its_pieces_only():
    described = classify(repository("foo", ("foo", "Like a turtlebot.")))
    assert described.evidence == ()
    assert classify(repository("turtlebot")).primary is T.MOBILE


def test_a_vetoed_rule_is_no_evidence():
    found = classify(repository("foo", ("foo", "A simulated lidar driver.")))
    assert {one.rule for one in found.evidence} == {"visualization-simulation"}


def test_evidence_is_of_the_functions_and_each_has_some():
    found = classify(
        repository(
            "acme_navigation",
            ("acme_amcl", "Localizes a robot with a laser."),
            ("acme_teleop", "Teleoperates it with a joystick."),
            ("acme_planner", "A global path planner."),
        )
    )
    assert {one.type for one in found.evidence} == set(found.functions)
    assert T.TELEOPERATION in found.functions
    assert {one.package for one in found.evidence if one.type is T.TELEOPERATION} == {"acme_teleop"}


def test_a_hint_in_a_package_makes_no_function_of_the_stack():
    found = classify(
        repository("foo_planner", ("foo_local_planner", ""), ("turtlebot_something", ""))
    )
    assert found.packages["turtlebot_something"] == (T.MOBILE,)
    assert found.functions == (T.PATH_PLANNING,)


def test_a_rule_counts_once_in_a_piece():
    text = "Calibration of cameras. Calibration of lidars. Calibration of robots."
    found = classify(repository("foo", ("foo", text))).evidence
    assert [one.rule for one in found].count("preprocessing-calibration") == 1


def test_packages_of_messages_do_not_count_beside_others():
    messages = [(f"foo_{n}_msgs", "") for n in "abcdef"]
    planners = [("foo_local_planner", ""), ("foo_global_planner", "")]
    assert classify(repository("foo", *messages, *planners)).functions == (T.PATH_PLANNING,)
    assert classify(repository("foo", *messages)).functions == (T.EXTENSION,)


def test_messages_of_many_kinds_are_one_function():
    found = classify(repository("foo_msgs", ("turtlebot_msgs", ""), ("lidar_msgs", "")))
    assert found.functions == (T.EXTENSION,)


@pytest.mark.parametrize("name", ["test_joystick", "joystick_tests"])
def test_packages_of_tests_do_not_count_beside_others(name):
    planners = [("foo_local_planner", ""), ("foo_global_planner", "")]
    assert classify(repository("foo_planner", *planners, (name, ""))).functions == (
        T.PATH_PLANNING,
    )
    alone = classify(repository("foo", (name, ""), ("test_gamepad", "")))
    assert alone.functions == (T.TELEOPERATION,)


def test_the_robot_is_no_function_of_a_stack_that_is_for_it():
    driver = ("turtlebot_driver", "Driver for a mobile base.")
    worlds = [("turtlebot_gazebo", ""), ("turtlebot_worlds", "")]
    assert classify(repository("turtlebot_simulator", *worlds, driver)).functions == (
        T.VISUALIZATION,
    )
    assert set(classify(repository("turtlebot_robot", *worlds, driver)).functions) == {
        T.MOBILE,
        T.VISUALIZATION,
    }
    half = classify(repository("turtlebot_simulator", worlds[0], driver))
    assert set(half.functions) == {T.VISUALIZATION, T.MOBILE}


@pytest.mark.parametrize(("planners", "shown"), [(4, True), (5, False)])
def test_a_gui_is_a_function_of_a_stack_without_a_driver_if_it_is_a_fifth(planners, shown):
    packages = [(f"foo_{n}_local_planner", "") for n in "abcde"[:planners]]
    found = classify(repository("foo_planner", *packages, ("foo_gui", "")))
    assert (T.VISUALIZATION in found.functions) is shown


def test_packages_named_after_a_robot_do_not_tell_what_the_stack_is():
    named = [(f"turtlebot_{word}", "") for word in ("this", "that", "more")]
    found = classify(repository("foo", *named, ("turtlebot_navigation", ""), ("foo_planner", "")))
    assert (found.primary, found.decided_by) == (T.PATH_PLANNING, DecisionSource.MANIFEST)
    assert classify(repository("foo", *named)).decided_by is DecisionSource.NONE


def test_two_hints_in_a_package_make_no_function_of_the_stack():
    hinted = ("foo_laser_thing", "Something about a laser.")
    found = classify(repository("foo_planner", ("foo_local_planner", ""), hinted))
    assert found.packages["foo_laser_thing"] == (T.SENSORS,)
    assert found.functions == (T.PATH_PLANNING,)


def test_extension_is_a_candidate_beside_another_if_many_packages_are():
    planners = [("foo_local_planner", ""), ("foo_global_planner", "")]
    few = repository("foo_planner", *planners, ("foo_base_planner", ""), ("catkin_foo", ""))
    many = repository("foo_planner", *planners, ("catkin_foo", ""), ("catkin_bar", ""))
    assert classify(few).functions == (T.PATH_PLANNING,)
    assert set(classify(few).probabilities) == {T.PATH_PLANNING}
    assert set(classify(many).probabilities) == {T.PATH_PLANNING, T.EXTENSION}


def test_a_further_function_is_one_if_it_is_more_likely_than_not():
    planners = [("foo_local_planner", ""), ("foo_global_planner", "")]
    found = classify(repository("foo_planner", *planners, ("catkin_foo", ""), ("catkin_bar", "")))
    assert found.probabilities[T.EXTENSION] < 0.5
    assert found.functions == (T.PATH_PLANNING,)
    found = classify(repository("foo_planner", *planners, ("foo_rviz_plugin", "")))
    assert found.probabilities[T.VISUALIZATION] >= 0.5
    assert found.functions == (T.PATH_PLANNING, T.VISUALIZATION)


def test_a_package_is_an_extension_if_it_is_nothing_else_more_clearly():
    bridges = repository("rtt_foo", ("rtt_actionlib", ""), ("rtt_nodelet", ""))
    assert classify(bridges).functions == (T.SUPPORT,)
    assert set(classify_name("rtt_actionlib")) == {T.SUPPORT, T.EXTENSION}


def test_a_stack_has_the_functions_of_its_packages():
    found = classify(
        repository(
            "turtlebot9",
            ("turtlebot9_bringup", "Starts the nodes of the robot."),
            ("turtlebot9_description", "URDF and meshes."),
            ("turtlebot9_teleop", "Drives the robot by keyboard."),
            ("turtlebot9_msgs", "Messages."),
        )
    )
    assert found.primary is T.MOBILE
    assert set(found.functions) == {T.MOBILE, T.VISUALIZATION, T.TELEOPERATION}
    assert found.packages["turtlebot9_teleop"][0] is T.TELEOPERATION


def test_a_stack_without_a_telling_name_is_told_by_its_packages():
    found = classify(
        repository("foo", ("foo_local_planner", ""), ("foo_global_planner", ""), ("foo_x", ""))
    )
    assert (found.primary, found.decided_by) == (T.PATH_PLANNING, DecisionSource.MANIFEST)


def test_slam_is_both():
    assert set(classify(repository("fast_slam")).functions) == {T.MAPPING, T.LOCALIZATION}


def test_evidence_names_the_words_the_rule_and_the_package():
    found = classify(repository("foo", ("foo", "A driver for a laser scanner.")))
    driver = next(one for one in found.evidence if one.rule == "sensors-driver")
    assert (driver.source, driver.type, driver.package) == (
        InformationSource.MANIFEST,
        T.SENSORS,
        "foo",
    )
    assert driver.text == "driver for a laser"


def test_a_package_alone():
    assert classify_name("cheap_imu_driver")[0] is T.SENSORS
    assert classify_name("foo", "A driver for a laser scanner.") == (T.SENSORS,)
    assert classify_name("cheap_imu_driver", "Plans paths for arms.")[0] is T.SENSORS
    assert classify_name("foo") == ()


@pytest.mark.parametrize("text", ["", "\x00", "é" * 5000, "( " * 5000, "日本語。"])
def test_text_without_meaning_decides_nothing(text):
    found = classify(repository(text, (text, text), readme=text))
    assert (found.decided_by, found.evidence) == (DecisionSource.NONE, ())


def test_text_of_any_length_is_taken():
    text = "camera " * 20_000
    found = classify(repository(text, (text, text), readme=text))
    assert found.functions == classify(repository("camera", ("camera", "camera"))).functions != ()
