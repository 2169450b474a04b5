# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node registration_keeper: after a restart of roscore, registers all running nodes and restores parameters.

A node of ROS 1 registers its topics and services once. After a restart the new master knows none of them:
existing connections continue, but no new node finds the old ones. This node remembers which nodes and
services the master knew, asks those that still run for their topics (http://wiki.ros.org/ROS/Slave_API), and
registers all of them again (http://wiki.ros.org/ROS/Master_API). A subscriber that has missed the start of a
publisher is notified of it.
"""

import threading
import xmlrpc.client
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from http.client import HTTPException
from typing import Any, Callable, Dict, Iterable, List, NamedTuple, Optional, Tuple
from xml.parsers.expat import ExpatError
from xmlrpc.client import ServerProxy, Transport

import rosgraph
import rospy

from sextant.nodes.base.init_node import init_node
from sextant.nodes.base.nodelet_watch import NodeletWatch

PERIOD = 1.0  # seconds between two looks at the master
TIMEOUT = 2.0  # seconds until a node counts as dead
OWN_PARAMETERS = {"run_id", "rosversion", "rosdistro", "roslaunch"}  # of each master itself
ERRORS = (
    OSError,
    xmlrpc.client.Error,
    HTTPException,
    ExpatError,
    rosgraph.MasterException,
)  # no or no whole answer
NO_NODE = (*ERRORS, ValueError, TypeError, LookupError)  # or another program has the port now

Providers = Dict[str, List[str]]  # names of nodes by service
Pairs = List[Tuple[str, str]]  # topics and their types


class Registrations(NamedTuple):
    """What a master knows, besides the topics: the nodes themselves know these."""

    services: Providers  # names of their nodes by service
    service_uris: Dict[str, str]  # by service
    nodes: Dict[str, str]  # XML-RPC URI by name, in the order in which the master has known them


class NodeTopics(NamedTuple):
    """The topics of a node, by its own answer."""

    published: Pairs  # topics and their types
    subscribed: Pairs  # likewise
    publishers: Optional[
        Dict[str, List[str]]
    ]  # URIs of those that it is connected to, by topic; None: unknown


def read_registrations(master: rosgraph.Master, known: Registrations) -> Registrations:
    """Asks the master for its registrations.

    :param known: the last answer; URIs of services are asked for again when that of their node is another
    :raises ERRORS: the master does not answer
    """
    state = [dict(each) for each in master.getSystemState()]  # publishers, subscribers, services
    names = {node for each in state for names in each.values() for node in names}
    nodes = _uris(names, {}, master.lookupNode)
    # A node that was started again has the old name, but another URI.
    same = {name: uri for name, uri in known.nodes.items() if nodes.get(name) == uri}
    services = {
        name: uri for name, uri in known.service_uris.items() if same.keys() >= set(known.services[name])
    }
    return Registrations(state[2], _uris(state[2], services, master.lookupService), {**same, **nodes})


def _uris(names: Iterable[str], known: Dict[str, str], look_up: Callable[[str], str]) -> Dict[str, str]:
    """URIs by name, without names that have just been unregistered."""
    uris = {}
    for name in names:
        try:
            uris[name] = known.get(name) or look_up(name)
        except rosgraph.MasterException:
            continue
    return uris


def newest_at_each_uri(nodes: Dict[str, str]) -> Dict[str, str]:
    """The nodes without those at whose URI a later one is registered: they died, and it got their port.

    The process there would answer for both names.
    """
    return {name: uri for uri, name in {uri: name for name, uri in nodes.items()}.items()}


class _TimedTransport(Transport):
    def make_connection(self, host):
        """Of xmlrpc, with a timeout."""
        connection = super().make_connection(host)
        connection.timeout = TIMEOUT
        return connection


def _topics(node: Tuple[str, str]) -> Optional[NodeTopics]:
    """Asks the process at the node's URI; None if it does not answer."""
    name, uri = node
    api = ServerProxy(uri, transport=_TimedTransport())
    with suppress(*NO_NODE):
        answers = [api.getPublications(name)[2], api.getSubscriptions(name)[2]]
        if all(isinstance(each, list) for each in answers):
            return NodeTopics(*answers, _publishers(api, name))
    return None


def _publishers(api: ServerProxy, name: str) -> Optional[Dict[str, List[str]]]:
    """URIs of the publishers that a node is connected to, by topic; None if it does not answer."""
    found: Dict[str, List[str]] = {}
    try:
        for _, uri, direction, _, topic, *_ in api.getBusInfo(name)[2]:
            if direction == "i":  # not "o": that of a subscriber, with its name
                found.setdefault(topic, []).append(uri)
    except NO_NODE:
        return None
    return found


def running(nodes: Dict[str, str]) -> Dict[str, NodeTopics]:
    """The topics of those nodes that answer, by the name of the node."""
    with ThreadPoolExecutor(max_workers=16) as pool:
        answers = zip(nodes, pool.map(_topics, nodes.items()))
        return {name: topics for name, topics in answers if topics is not None}


def restore_registrations(uri: str, lost: Registrations, alive: Dict[str, NodeTopics]) -> int:
    """Registers again what the nodes that run had registered; returns the number of registrations.

    Publishers come first: then no subscriber is notified of a part of them, and no connection is closed.
    """
    master, count = ServerProxy(uri, transport=_TimedTransport()), 0
    for node, topics in alive.items():
        for topic, kind in topics.published:
            master.registerPublisher(node, topic, kind, lost.nodes[node])
            count += 1
    for node, topics in alive.items():
        for topic, kind in topics.subscribed:
            _subscribe(master, (node, lost.nodes[node]), topics, (topic, kind))
            count += 1
    for service, providers in lost.services.items():
        for node in alive.keys() & set(providers):
            if service in lost.service_uris:
                master.registerService(node, service, lost.service_uris[service], lost.nodes[node])
                count += 1
    return count


def _subscribe(
    master: ServerProxy, node: Tuple[str, str], topics: NodeTopics, subscription: Tuple[str, str]
) -> None:
    """Registers a subscriber, and notifies it of publishers that it is not connected to.

    The master notifies it of later ones only: not of one that was started before, at the new master. The node
    closes connections to publishers that it is not notified of, so it is notified of all.

    :param node: name and URI
    :param subscription: topic and type
    """
    (name, uri), (topic, kind) = node, subscription
    known = set((topics.publishers or {}).get(topic, []))
    while True:  # a publisher that was started during the notification was not part of it
        publishers = set(master.registerSubscriber(name, topic, kind, uri)[2])
        if topics.publishers is None or publishers <= known:
            return
        known |= publishers
        with suppress(*ERRORS):  # it was ended
            ServerProxy(uri, transport=_TimedTransport()).publisherUpdate(name, topic, sorted(known))


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
        self._known = Registrations({}, {}, {})
        self._parameters: Dict[str, Any] = {}
        self._process: Optional[int] = None  # of the master that these are of
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
        # Another keeper may have registered this node at a new master, and not yet all of the others.
        is_new = self._process not in (None, process)
        if is_new or self._name in self._known.nodes and self._name not in found.nodes:
            self._restore()  # what the master then knows is read at the next look
        elif self._master.getPid() == process:  # else the answers are those of two masters
            self._known, self._parameters, self._process = found, parameters, process

    def _restore(self) -> None:
        alive = running(newest_at_each_uri(self._known.nodes))  # may take a while
        process, uri = self._master.getPid(), rosgraph.get_master_uri()
        parameters = missing_parameters(self._parameters, self._master.getParam("/"))
        for name, value in parameters.items():
            self._master.setParam(name, value)
        own = {self._name: alive.pop(self._name)} if self._name in alive else {}
        count = restore_registrations(uri, self._known, alive)
        # This node comes last: as long as it is missing, everything is tried again.
        if self._master.getPid() == process:
            count += restore_registrations(uri, self._known, own)
            self._process = process
        rospy.logwarn(
            "roscore was restarted: registered %d topics and services of %d nodes again and restored "
            "%d parameters; nodes that did not answer: %s",
            count,
            len(alive) + len(own),
            len(parameters),
            ", ".join(sorted(self._known.nodes.keys() - alive.keys() - own.keys())) or "none",
        )


def main() -> None:
    """Runs the node."""
    init_node("registration_keeper")
    threading.Thread(target=NodeletWatch().run, daemon=True).start()
    RegistrationKeeper().run()
