"""Enumerators of headers that are not here are known by their names."""

import pytest
from ros1_runs import cpp, names

TOP = """#include "device.h"
std::string topic(LogId id) {
  switch (id) {
    case LOG_STATUS: return "status";
    case LOG_IMU: return "imu";
    case LOG_MAG: return "mag";
    default: return "undefined"; } }
struct Output { LogId id; int mode; };
void advertise(ros::NodeHandle & nh, LogId id, int mode) {
  if (mode != MODE_OFF) {
    switch (id) {
      case LOG_STATUS: nh.advertise<std_msgs::Bool>(topic(id), 1); break;
      case LOG_IMU: nh.advertise<std_msgs::Bool>(topic(id), 1); break;
      default: break; } } }
template <typename T> T mode(const ros::NodeHandle & nh, std::string key, int usual) {
  return static_cast<T>(usual); }
"""


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("advertise(nh, LOG_IMU, MODE_ON);", ["imu"]),
        ("advertise(nh, LOG_IMU, MODE_OFF);", []),
        ("advertise(nh, LOG_MAG, MODE_ON);", []),
        ('advertise(nh, LOG_IMU, mode<Mode>(nh, "log", MODE_OFF));', []),
        ("nh.advertise<std_msgs::Bool>(topic(LOG_MAG), 1);", ["mag"]),
        ('if (LOG_IMU == LOG_MAG) { nh.advertise<std_msgs::Bool>("x", 1); }', []),
        ('if (MODE_ON == MODE_OFF) { nh.advertise<std_msgs::Bool>("x", 1); }', ["x"]),
        (
            """auto id = LOG_MAG;
            if (id == LOG_MAG) { nh.advertise<std_msgs::Bool>("x", 1); }
            else { nh.advertise<std_msgs::Bool>("y", 1); }""",
            ["x"],
        ),
    ],
)
def test_labels_of_a_switch_differ_and_a_name_equals_itself(body, expected):
    assert names(cpp(body, TOP)) == expected


def test_an_enumerator_that_only_a_run_knows_takes_every_case():
    found = names(cpp("advertise(nh, device.id(), MODE_ON);", TOP))
    assert set(found) == {"imu", "mag", "status", "undefined"}
