# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node registration_keeper: after a restart of roscore, registers all running nodes and restores parameters.

A node of ROS 1 registers its topics and services once. After a restart the new master knows none of them:
existing connections continue, but no new node finds the old ones. This node remembers what the master knew,
and registers it again by the master's API (http://wiki.ros.org/ROS/Master_API), for the nodes that still run.
"""

from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Dict, Iterable, List, NamedTuple, Optional, Set, Tuple
from xmlrpc.client import Fault, ServerProxy, Transport

import rosgraph
import rospy

from sextant.nodes.base.init_node import init_node

PERIOD = 1.0  # seconds between two looks at the master
TIMEOUT = 2.0  # seconds until a node counts as dead
OWN_PARAMETERS = {"run_id", "rosversion", "rosdistro", "roslaunch"}  # of each master itself
ERRORS = (OSError, Fault, rosgraph.MasterException)  # OSError: also of a socket and of xmlrpc

Topics = Dict[str, List[str]]  # names of the nodes by topic or service


class Registrations(NamedTuple):
    """What a master knows."""

    publishers: Topics  # by topic
    subscribers: Topics  # by topic
    services: Topics  # providers by service
    types: Dict[str, str]  # of topics
    nodes: Dict[str, str]  # XML-RPC URI by name
    service_uris: Dict[str, str]  # by service

    def node_names(self) -> Set[str]:
        """All nodes with a registration."""
        return _names(self.publishers, self.subscribers, self.services)


def _names(*topics: Topics) -> Set[str]:
    return {node for each in topics for nodes in each.values() for node in nodes}


def read_registrations(master: rosgraph.Master, known: Optional[Registrations]) -> Registrations:
    """Asks the master for its registrations.

    :param known: the last answer; URIs of services are asked for again when that of their node is another
    :raises OSError, Fault, MasterException: the master does not answer
    """
    publishers, subscribers, services = (dict(each) for each in master.getSystemState())
    nodes = _uris(_names(publishers, subscribers, services), {}, master.lookupNode)
    same: Dict[str, str] = {}
    if known is not None:  # a node that was started again has the old name, but another URI
        kept = {node for node, uri in nodes.items() if known.nodes.get(node) == uri}
        same = {
            name: uri for name, uri in known.service_uris.items() if kept.issuperset(known.services[name])
        }
    service_uris = _uris(services, same, master.lookupService)
    return Registrations(publishers, subscribers, services, dict(master.getTopicTypes()), nodes, service_uris)


def _uris(names: Iterable[str], known: Dict[str, str], look_up: Callable[[str], str]) -> Dict[str, str]:
    """URIs by name, without names that have just been unregistered."""
    uris = {}
    for name in names:
        try:
            uris[name] = known.get(name) or look_up(name)
        except rosgraph.MasterException:
            continue
    return uris


class _TimedTransport(Transport):
    def make_connection(self, host):
        """Of xmlrpc, with a timeout."""
        connection = super().make_connection(host)
        connection.timeout = TIMEOUT
        return connection


def _is_running(node: Tuple[str, str]) -> bool:
    """Whether a process answers at the node's URI, with this name."""
    name, uri = node
    try:
        _, _, bus = ServerProxy(uri, transport=_TimedTransport()).getSubscriptions(name)
        return isinstance(bus, list)
    except (OSError, Fault, ValueError):
        return False


def running(nodes: Dict[str, str]) -> Set[str]:
    """The names of those nodes that answer."""
    with ThreadPoolExecutor(max_workers=16) as pool:
        answers = pool.map(_is_running, nodes.items())
        return {name for name, answer in zip(nodes, answers) if answer}


def restore_registrations(uri: str, lost: Registrations, alive: Set[str]) -> int:
    """Registers again what the nodes that run had registered; returns the number of registrations.

    Publishers come first: then no subscriber is notified of a part of them, and no connection is closed.
    """
    master, count = ServerProxy(uri, transport=_TimedTransport()), 0

    def owned(topics: Topics) -> Iterable[Tuple[str, str]]:
        return ((topic, node) for topic, nodes in topics.items() for node in nodes if node in alive)

    for topic, node in owned(lost.publishers):
        master.registerPublisher(node, topic, lost.types.get(topic, "*"), lost.nodes[node])
        count += 1
    for topic, node in owned(lost.subscribers):
        master.registerSubscriber(node, topic, lost.types.get(topic, "*"), lost.nodes[node])
        count += 1
    for service, node in owned(lost.services):
        if service in lost.service_uris:
            master.registerService(node, service, lost.service_uris[service], lost.nodes[node])
            count += 1
    return count


def missing_parameters(saved: Any, present: Any, name: str = "") -> Dict[str, Any]:
    """The saved parameters, by their full names, that a master lacks; values that it has are kept."""
    if not isinstance(saved, dict) or not isinstance(present, dict):
        return {}
    missing: Dict[str, Any] = {}
    for key, value in saved.items():
        if not name and key in OWN_PARAMETERS:
            continue
        if key in present:
            missing.update(missing_parameters(value, present[key], f"{name}/{key}"))
        else:
            missing[f"{name}/{key}"] = value
    return missing


class RegistrationKeeper:
    """Looks at the master once a second."""

    def __init__(self):
        self._name = rospy.get_name()
        self._master = rosgraph.Master(self._name)
        self._known: Optional[Registrations] = None
        self._parameters: Dict[str, Any] = {}
        self._is_reachable = True

    def run(self) -> None:
        """Until the node is shut down."""
        while not rospy.is_shutdown():
            try:
                self._look()
                self._is_reachable = True
            except ERRORS as error:
                if self._is_reachable:
                    rospy.logwarn("no master at %s: %s", rosgraph.get_master_uri(), error)
                self._is_reachable = False
            rospy.rostime.wallsleep(PERIOD)

    def _look(self) -> None:
        process = self._master.getPid()
        found = read_registrations(self._master, self._known)
        parameters = self._master.getParam("/")
        if self._known is not None and self._name not in found.node_names():
            self._restore()  # what the master then knows is read at the next look
        elif self._master.getPid() == process:  # else the answers are those of two masters
            self._known, self._parameters = found, parameters

    def _restore(self) -> None:
        parameters = missing_parameters(self._parameters, self._master.getParam("/"))
        for name, value in parameters.items():
            self._master.setParam(name, value)
        alive = running(self._known.nodes)
        # This node comes last: as long as it is missing, everything is tried again.
        uri, own = rosgraph.get_master_uri(), {self._name}
        count = sum(restore_registrations(uri, self._known, each) for each in (alive - own, alive & own))
        rospy.logwarn(
            "roscore was restarted: registered %d topics and services of %d nodes again and restored "
            "%d parameters; nodes that did not answer: %s",
            count,
            len(alive),
            len(parameters),
            ", ".join(sorted(set(self._known.nodes) - alive)) or "none",
        )


def main() -> None:
    """Runs the node."""
    init_node("registration_keeper")
    RegistrationKeeper().run()
