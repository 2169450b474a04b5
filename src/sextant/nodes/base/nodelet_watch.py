# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Ends the loaders of nodelets that their manager does not have, so that roslaunch loads them again.

`nodelet load TYPE MANAGER` runs as long as its nodelet; both publish on the topic MANAGER/bond. If the
manager dies while roscore is down, a loader may never notice.
"""

from collections import Counter
from typing import Dict, Iterable, List, Set, Tuple
from xmlrpc.client import ServerProxy

import genpy.dynamic
import rosgraph
import rospy
from std_srvs.srv import EmptyRequest

PERIOD = 2.0  # seconds between two looks
LOOKS = 4  # number of successive looks without the nodelet after which its loader is ended
BOND = "/bond"  # end of the name of a manager's topic


class NodeletList:
    """nodelet/NodeletList; Debian 12 has no Python package of it."""

    _type, _md5sum = "nodelet/NodeletList", "*"
    _request_class = EmptyRequest
    _response_class = genpy.dynamic.generate_dynamic("nodelet/NodeletListResponse", "string[] nodelets")[
        "nodelet/NodeletListResponse"
    ]


def loaders_by_manager(publishers: Iterable[Tuple[str, List[str]]]) -> Dict[str, Set[str]]:
    """The loaders of each nodelet manager, from the master's list of topics and their publishers."""
    return {
        topic[: -len(BOND)]: set(nodes) - {topic[: -len(BOND)]}
        for topic, nodes in publishers
        if topic.endswith(BOND)
    }


def nodelets_of(manager: str) -> Set[str]:
    """Asks a manager for its nodelets.

    :raises rospy.ServiceException: it does not answer
    """
    return set(rospy.ServiceProxy(f"{manager}/list", NodeletList)().nodelets)


class NodeletWatch:
    """Looks at all managers that the master knows."""

    def __init__(self):
        self._master = rosgraph.Master(rospy.get_name())
        self._missed: Counter = Counter()  # looks in a row, by loader

    def run(self) -> None:
        """Until the node is shut down."""
        while not rospy.is_shutdown():
            rospy.rostime.wallsleep(PERIOD)
            try:
                self.look()
            except (OSError, rosgraph.MasterException):  # no master now
                self._missed.clear()

    def look(self) -> None:
        """Counts the loaders whose nodelet is missing, and ends those that have been counted LOOKS times."""
        managers = loaders_by_manager(self._master.getSystemState()[0])
        missing = {
            loader for manager, loaders in managers.items() for loader in self._unloaded(manager, loaders)
        }
        self._missed = Counter({loader: self._missed[loader] + 1 for loader in missing})
        for loader in [each for each, looks in self._missed.items() if looks >= LOOKS]:
            del self._missed[loader]
            self._end(loader)

    def _unloaded(self, manager: str, loaders: Set[str]) -> Set[str]:
        try:
            return loaders - nodelets_of(manager) if loaders else set()
        except rospy.ServiceException:  # dead, or about to be restarted
            return set()

    def _end(self, loader: str) -> None:
        rospy.logwarn("%s is not loaded in its manager: its loader is ended, to be started again", loader)
        try:
            ServerProxy(self._master.lookupNode(loader)).shutdown(rospy.get_name(), "nodelet is not loaded")
        except (OSError, rosgraph.MasterException) as error:
            rospy.logwarn("%s cannot be ended: %s", loader, error)
