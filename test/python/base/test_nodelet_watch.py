# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import pytest
import rospy

from sextant.nodes.base import nodelet_watch
from sextant.nodes.base.nodelet_watch import LOOKS, NodeletWatch, loaders_by_manager

PUBLISHERS = [
    ["/manager/bond", ["/manager", "/detector", "/locator"]],
    ["/markers", ["/manager"]],
]
SERVICES = [["/manager/unload_nodelet", ["/manager"]], ["/idle/unload_nodelet", ["/idle"]]]


class Master:
    """A master with these publishers."""

    publishers = PUBLISHERS

    def getSystemState(self):  # noqa: N802
        return [self.publishers, [], SERVICES]


@pytest.fixture
def watch(monkeypatch):
    """A watch with what it has ended and unloaded, and the nodelets of the manager."""
    result = NodeletWatch()
    result._master = Master()
    result.ended, result.unloaded, result.loaded = [], [], {"/detector", "/locator"}
    result._end = result.ended.append
    result._unload = lambda manager, nodelet: result.unloaded.append((manager, nodelet))
    monkeypatch.setattr(nodelet_watch, "nodelets_of", lambda manager: result.loaded)
    return result


def test_publishers_of_bonds_are_loaders():
    assert loaders_by_manager(PUBLISHERS, SERVICES) == {"/manager": {"/detector", "/locator"}, "/idle": set()}


def test_a_loader_is_ended_when_its_nodelet_is_missing_in_successive_looks(watch):
    for _ in range(LOOKS):
        watch.look()
    watch.loaded = {"/detector"}
    for _ in range(LOOKS - 1):
        watch.look()
    assert watch.ended == []
    watch.look()
    assert watch.ended == ["/locator"]
    watch.look()
    assert watch.ended == ["/locator"]  # roslaunch has time to start it again


def test_one_look_with_the_nodelet_starts_the_count_again(watch):
    for loaded in (LOOKS - 1) * [{"/detector"}] + [{"/detector", "/locator"}] + (LOOKS - 1) * [{"/detector"}]:
        watch.loaded = loaded
        watch.look()
    assert watch.ended == []


def test_no_loader_of_a_silent_manager_is_ended(watch, monkeypatch):
    def silent(manager):
        raise rospy.ServiceException(manager)

    monkeypatch.setattr(nodelet_watch, "nodelets_of", silent)
    for _ in range(2 * LOOKS):
        watch.look()
    assert watch.ended == []


def test_a_nodelet_is_unloaded_when_its_loader_has_ended(watch):
    watch.loaded.add("/loaded_by_a_service")
    watch.look()
    watch._master.publishers = [["/manager/bond", ["/manager", "/locator"]]]
    for _ in range(LOOKS - 1):
        watch.look()
    assert watch.unloaded == []
    watch.look()
    assert (watch.unloaded, watch.ended) == ([("/manager", "/detector")], [])
