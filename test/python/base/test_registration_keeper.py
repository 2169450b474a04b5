# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import rosgraph
import rospy

from sextant.nodes.base.registration_keeper import (
    RegistrationKeeper,
    Registrations,
    newest_at_each_uri,
    read_registrations,
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
