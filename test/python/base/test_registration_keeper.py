# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import threading
from contextlib import contextmanager
from xmlrpc.server import SimpleXMLRPCServer

import rosgraph
import rospy

from sextant.nodes.base.registration_keeper import (
    RegistrationKeeper,
    Registrations,
    newest_at_each_uri,
    read_registrations,
    restore_registrations,
    running,
)

PARAMETERS = {"robot": {"name": "a"}}


class Master:
    """A master with a node and the keeper; after `replace_after` calls another one, which knows nothing."""

    def __init__(self):
        self.calls, self.replace_after = 0, 10**6

    def _is_new(self):
        self.calls += 1
        return self.calls > self.replace_after

    def getPid(self):  # noqa: N802
        return 2 if self._is_new() else 1

    def getSystemState(self):  # noqa: N802
        nodes = ["/node", rospy.get_name()]
        return [[], [], []] if self._is_new() else [[["/topic", nodes]], [], [["/node/service", ["/node"]]]]

    def lookupNode(self, name):  # noqa: N802
        return self._uri(name)

    def lookupService(self, name):  # noqa: N802
        return self._uri(name)

    def _uri(self, name):
        if self._is_new():
            raise rosgraph.MasterException(f"unknown {name}")
        return "http://localhost:1" + name

    def getParam(self, _name):  # noqa: N802
        return {} if self._is_new() else PARAMETERS


def test_nothing_is_forgotten_if_the_master_is_replaced_during_a_look():
    keeper = RegistrationKeeper()
    keeper._master = master = Master()
    keeper._look()
    known, calls = keeper._known, master.calls
    assert known.nodes.keys() == {"/node", rospy.get_name()} and keeper._parameters == PARAMETERS
    restored = []
    keeper._restore = lambda: restored.append(True)
    for after in range(2, calls - 1):  # later looks do not ask for the URIs of services that are known
        master.calls, master.replace_after = 0, after
        keeper._look()
        assert (keeper._known, keeper._parameters) == (known, PARAMETERS)
    restored.clear()
    master.calls, master.replace_after = 0, 1
    keeper._look()
    assert restored == [True] and keeper._known == known


class HalfRestoredMaster(Master):
    """A new master with which another keeper has registered only this one so far."""

    def getPid(self):  # noqa: N802
        return 2

    def getSystemState(self):  # noqa: N802
        return [[["/rosout", [rospy.get_name()]]], [], []]


def test_what_another_keeper_has_restored_so_far_is_not_taken_for_all():
    keeper = RegistrationKeeper()
    keeper._master = Master()
    keeper._look()
    known, restored = keeper._known, []
    keeper._master, keeper._restore = HalfRestoredMaster(), lambda: restored.append(True)
    keeper._look()
    assert restored == [True] and keeper._known == known
    assert keeper._known.services == {"/node/service": ["/node"]}


class GrowingMaster(Master):
    """A master that a node registers with at the port of a dead one, in an order that does not say so."""

    def __init__(self):
        super().__init__()
        self.nodes = {"/dead": "http://localhost:1", "/other": "http://localhost:2"}

    def getSystemState(self):  # noqa: N802
        return [[["/topic", sorted(self.nodes, reverse=True)]], [], []]

    def lookupNode(self, name):  # noqa: N802
        return self.nodes[name]


def test_a_dead_node_is_not_registered_at_the_port_of_another_one():
    master = GrowingMaster()
    known = read_registrations(master, Registrations({}, {}, {}))
    assert newest_at_each_uri(known.nodes) == master.nodes
    master.nodes["/a_new"] = "http://localhost:1"
    for _ in range(2):
        known = read_registrations(master, known)
        assert known.nodes == master.nodes
        assert newest_at_each_uri(known.nodes).keys() == {"/a_new", "/other"}
    master.nodes["/dead"] = "http://localhost:3"  # it was started again
    known = read_registrations(master, known)
    assert newest_at_each_uri(known.nodes) == master.nodes


@contextmanager
def served(api):
    """The URI of an object, as a node or a master serves its functions."""
    with SimpleXMLRPCServer(("localhost", 0), logRequests=False, allow_none=True) as server:
        server.register_instance(api)
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"http://localhost:{server.server_address[1]}/"
        finally:
            server.shutdown()
            thread.join()


class Subscriber:
    """A node that is connected to some publishers (None: unknown), and how it was notified of more."""

    def __init__(self, connected):
        self._connected, self.updates = connected, []

    def getPublications(self, _caller):  # noqa: N802
        return 1, "", [["/out", "std_msgs/String"]]

    def getSubscriptions(self, _caller):  # noqa: N802
        return 1, "", [["/in", "std_msgs/String"]]

    def getBusInfo(self, _caller):  # noqa: N802
        connections = [[k, uri, "i", "TCPROS", "/in", True, ""] for k, uri in enumerate(self._connected)]
        return 1, "", [[9, "/listener", "o", "TCPROS", "/out", True, ""], *connections]

    def publisherUpdate(self, _caller, topic, uris):  # noqa: N802
        self.updates.append((topic, uris))
        return 1, "", 0


class NewMaster:
    """A master whose answers about publishers are given; the last one is repeated."""

    def __init__(self, *publishers):
        self._publishers, self.subscribers = list(publishers), []

    def registerPublisher(self, *_):  # noqa: N802
        return 1, "", []

    def registerSubscriber(self, *subscriber):  # noqa: N802
        self.subscribers.append(subscriber)
        return 1, "", self._publishers.pop(0) if len(self._publishers) > 1 else self._publishers[0]


def updates(connected, *publishers):
    """How a node is notified that is connected to some publishers when the new master knows others."""
    node, master = Subscriber(connected), NewMaster(*publishers)
    with served(node) as node_uri, served(master) as master_uri:
        nodes = {"/node": node_uri}
        assert restore_registrations(master_uri, Registrations({}, {}, nodes), running(nodes)) == 2
    assert set(master.subscribers) == {("/node", "/in", "std_msgs/String", node_uri)}
    return node.updates


def test_a_subscriber_is_notified_of_a_publisher_that_the_new_master_knew_before_it():
    assert updates(["http://a/"], ["http://b/"]) == [("/in", ["http://a/", "http://b/"])]
    assert updates([], ["http://a/", "http://b/"]) == [("/in", ["http://a/", "http://b/"])]


def test_a_subscriber_is_not_notified_of_publishers_that_it_is_connected_to():
    assert updates(["http://a/", "http://b/"], ["http://b/"]) == []
    assert updates(["http://a/"], []) == []


def test_a_subscriber_whose_connections_are_unknown_is_not_notified():
    assert updates(None, ["http://a/"]) == []


def test_a_publisher_that_starts_during_the_notification_is_not_disconnected():
    assert updates(["http://a/"], ["http://b/"], ["http://b/", "http://c/"]) == [
        ("/in", ["http://a/", "http://b/"]),
        ("/in", ["http://a/", "http://b/", "http://c/"]),
    ]
