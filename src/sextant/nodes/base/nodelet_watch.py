# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Ends loaders without their nodelet and nodelets without their loader: roslaunch loads them again.

`nodelet load TYPE MANAGER` runs as long as its nodelet; both publish on the topic MANAGER/bond. If one of
them dies while roscore is down, the other may never notice.
"""

from collections import Counter
from typing import Dict, List, NamedTuple, Sequence, Set, Tuple
from xmlrpc.client import ServerProxy

import genpy.dynamic
import rosgraph
import rospy

PERIOD = 2.0  # seconds between two looks
LOOKS = 4  # number of successive looks without the nodelet after which its loader is ended
BOND, UNLOAD = "/bond", "/unload_nodelet"  # ends of the names of a manager's topic and service
Nodes = Sequence[Tuple[str, List[str]]]  # of the topics or services with these names


def _message(name: str, definition: str) -> type:
    return genpy.dynamic.generate_dynamic(name, definition)[name]


class NodeletList:
    """nodelet/NodeletList; Debian 12 has no Python package of it."""

    _type, _md5sum = "nodelet/NodeletList", "*"
    _request_class = _message("nodelet/NodeletListRequest", "")
    _response_class = _message("nodelet/NodeletListResponse", "string[] nodelets")


class NodeletUnload:
    """nodelet/NodeletUnload."""

    _type, _md5sum = "nodelet/NodeletUnload", "*"
    _request_class = _message("nodelet/NodeletUnloadRequest", "string name")
    _response_class = _message("nodelet/NodeletUnloadResponse", "bool success")


def loaders_by_manager(publishers: Nodes, services: Nodes) -> Dict[str, Set[str]]:
    """The loaders of each nodelet manager, from the master's topics and services with their nodes."""
    managers = [name[: -len(UNLOAD)] for name, _ in services if name.endswith(UNLOAD)]
    nodes = dict(publishers)
    return {manager: set(nodes.get(manager + BOND, ())) - {manager} for manager in managers}


def nodelets_of(manager: str) -> Set[str]:
    """Requests the list of a manager's nodelets.

    :raises rospy.ServiceException: it does not answer
    """
    return set(rospy.ServiceProxy(f"{manager}/list", NodeletList)().nodelets)


class Halves(NamedTuple):
    """What is left of pairs of a loader and its nodelet."""

    loaders: Set[str]  # names of loaders without their nodelet
    nodelets: Set[Tuple[str, str]]  # managers, and names of nodelets without their loader


class NodeletWatch:
    """Looks at all managers that the master knows."""

    def __init__(self):
        self._master = rosgraph.Master(rospy.get_name())
        # Managers and all loaders that they have had: a nodelet may also be loaded by a service, without one.
        self._known: Set[Tuple[str, str]] = set()
        self._looks: Counter = Counter()  # in a row, by what is left of a pair

    def run(self) -> None:
        """Until the node is shut down."""
        while not rospy.is_shutdown():
            rospy.rostime.wallsleep(PERIOD)
            try:
                self.look()
            except (OSError, rosgraph.MasterException):  # no master now
                self._looks.clear()

    def look(self) -> None:
        """Counts loaders and nodelets without the other one, and ends those that were counted LOOKS times."""
        left = self._left()
        self._looks = Counter({each: self._looks[each] + 1 for each in left.loaders | left.nodelets})
        for each in [each for each, looks in self._looks.items() if looks >= LOOKS]:
            del self._looks[each]
            if each in left.loaders:
                self._end(each)
            else:
                self._unload(*each)

    def _left(self) -> Halves:
        left = Halves(set(), set())
        publishers, _, services = self._master.getSystemState()
        for manager, loaders in loaders_by_manager(publishers, services).items():
            self._known.update((manager, loader) for loader in loaders)
            try:
                nodelets = nodelets_of(manager)
            except rospy.ServiceException:  # dead, or about to be restarted
                continue
            left.loaders.update(loaders - nodelets)
            left.nodelets.update(self._known & {(manager, nodelet) for nodelet in nodelets - loaders})
        return left

    def _end(self, loader: str) -> None:
        rospy.logwarn("%s is not loaded in its manager: its loader is ended, to be started again", loader)
        try:
            ServerProxy(self._master.lookupNode(loader)).shutdown(rospy.get_name(), "nodelet is not loaded")
        except (OSError, rosgraph.MasterException) as error:
            rospy.logwarn("%s cannot be ended: %s", loader, error)

    def _unload(self, manager: str, nodelet: str) -> None:
        rospy.logwarn(
            "%s has no loader any more: it is unloaded from %s, to be loaded again", nodelet, manager
        )
        try:
            rospy.ServiceProxy(manager + UNLOAD, NodeletUnload)(nodelet)
        except rospy.ServiceException as error:
            rospy.logwarn("%s cannot be unloaded: %s", nodelet, error)
