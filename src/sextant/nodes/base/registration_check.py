# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Ends a node that is not registered although a registration_keeper runs, so that roslaunch restarts it.

A node that was just starting while roscore was restarted is registered neither by itself nor by the keeper.
The C++ nodes do the same: src/ros/base/registration_check.cpp.
"""

import threading

import rosgraph
import rospy

PERIOD = 3.0  # seconds between two looks at the master
LOOKS = 3  # number of successive looks without the node after which it ends
KEEPER = "registration_keeper"  # beginning of the name of that node


def is_forgotten(state, name: str) -> bool:
    """Whether a master knows a registration_keeper, but not the node.

    :param state: answer to getSystemState: publishers, subscribers and services, each with their nodes
    :param name: full name of the node
    """
    registered = {node for kind in state for _, nodes in kind for node in nodes}
    has_keeper = any(node.rpartition("/")[2].startswith(KEEPER) for node in registered)
    return has_keeper and name not in registered


def start_registration_check() -> None:
    """Checks in a thread of its own until the node is shut down."""
    threading.Thread(target=_check, daemon=True).start()


def _check() -> None:
    name, missed = rospy.get_name(), 0
    master = rosgraph.Master(name)
    while missed < LOOKS:
        rospy.rostime.wallsleep(PERIOD)
        try:
            missed = missed + 1 if is_forgotten(master.getSystemState(), name) else 0
        except (OSError, rosgraph.MasterException):  # no master now
            missed = 0
    rospy.logfatal("%s is not registered at the master: ends, to be restarted by roslaunch", name)
    rospy.signal_shutdown("not registered at the master")
