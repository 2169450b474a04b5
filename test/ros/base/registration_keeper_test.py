#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""roscore is restarted again and again, under nodes of C++ and of Python."""

import os
import signal
import socket
import subprocess
import time
import unittest
from contextlib import suppress
from xmlrpc.client import ServerProxy

import rosgraph
import rostest
from ros_probe import until

RESTARTS = 10
LIMIT = 10.0  # seconds until everything is registered again
NODES = {
    "registration_keeper": ["registration_keeper"],
    "cpp": ["landmark_slam", "_max_range:=7.5"],
    "python": ["image_decompressor"],
    "mortal": ["image_decompressor"],
}


def free_port():
    """One that stays free while the master is down: outgoing connections do not get it."""
    with open("/proc/sys/net/ipv4/ip_local_port_range", encoding="ascii") as file:
        first_outgoing = int(file.read().split()[0])
    for port in range(first_outgoing - 1 - os.getpid() % 1000, 1024, -1):
        with socket.socket() as sock, suppress(OSError):
            sock.bind(("localhost", port))
            return port
    raise OSError("no port is free")


class RegistrationKeeperTest(unittest.TestCase):
    def setUp(self):
        self.uri = f"http://localhost:{free_port()}"
        self.env = {**os.environ, "ROS_MASTER_URI": self.uri}
        self.master = rosgraph.Master("/registration_keeper_test", self.uri)
        self.start_master()
        self.nodes = {name: self.start(*command, f"__name:={name}") for name, command in NODES.items()}

    def start(self, *command):
        return self.start_program("rosrun", "sextant", *command)

    def start_program(self, *command):
        process = subprocess.Popen(command, env=self.env)
        self.addCleanup(self.stop, process)
        return process

    def stop(self, process):
        process.terminate()
        try:
            process.wait(20)
        finally:
            process.kill()

    def start_master(self):
        port = self.uri.rsplit(":", 1)[1]
        self.core = subprocess.Popen(["rosmaster", "--core", "-p", port], stdout=subprocess.DEVNULL)
        self.addCleanup(self.core.kill)
        self.assertTrue(until(self.master.is_online, LIMIT))

    def registered(self):
        """(topic or service, node) of all three kinds; URIs of services; types of topics."""
        kinds = self.master.getSystemState()
        pairs = [{(name, node) for name, nodes in kind for node in nodes} for kind in kinds]
        services = {name: self.master.lookupService(name) for name, _ in kinds[2]}
        return pairs, services, dict(self.master.getTopicTypes())

    def complete(self):
        pairs, _, _ = self.registered()
        nodes = {node for kind in pairs for _, node in kind}
        return {"/" + name for name in NODES} <= nodes and ("/tf", "/cpp") in pairs[0] | pairs[1]

    def test_running_nodes_are_registered_again_and_parameters_restored(self):
        self.master.setParam("/use_sim_time", False)
        self.master.setParam("/robot", {"name": "a", "wheels": {"radius": 0.1}})
        self.assertTrue(until(self.complete, 30.0))
        time.sleep(3.0)  # two looks of the keeper
        expected, parameters = self.registered(), self.master.getParam("/")
        for number in range(RESTARTS):
            if number == 1:
                self.stop_abruptly("mortal", expected)
            if number == 2:
                expected = self.start_again("cpp")
            self.core.kill()
            self.core.wait()
            time.sleep(0.5 if number else 3.0)  # once long enough for the keeper to notice that there is none
            self.start_master()
            self.master.setParam("/robot/name", f"b{number}")  # of the new master: is kept
            self.assertTrue(until(lambda expected=expected: self.registered() == expected, LIMIT), number)
            kept = self.master.getParam("/")
            self.assertEqual(kept["robot"], {"name": f"b{number}", "wheels": {"radius": 0.1}})
            self.assertEqual(kept["cpp"], parameters["cpp"])
            self.assertIs(kept["use_sim_time"], False)
            time.sleep(2.0)

    def test_a_node_that_is_not_registered_ends(self):
        """As one that was starting while roscore was restarted."""
        self.assertTrue(until(self.complete, 30.0))
        for name in ("cpp", "python"):
            self.unregister("/" + name)
        for name in ("cpp", "python"):
            self.nodes[name].wait(30)
        self.assertIsNone(self.nodes["mortal"].poll())
        self.assertIsNone(self.nodes["registration_keeper"].poll())

    def test_a_subscriber_is_connected_to_a_publisher_that_registered_first(self):
        """One that was started after roscore, but before the keeper registers the subscriber again."""
        listener = self.start_program("rostopic", "echo", "/odom", "__name:=listener")
        self.assertTrue(until(self.complete, 30.0))
        old = self.start_publisher("old")
        self.assertTrue(until(lambda: self.connected("/cpp") == self.connected("/listener") == {old}, 30.0))
        time.sleep(3.0)  # two looks of the keeper
        keeper = int(ServerProxy(self.master.lookupNode("/registration_keeper")).getPid("")[2])
        os.kill(keeper, signal.SIGSTOP)
        self.addCleanup(os.kill, keeper, signal.SIGCONT)  # else a test that fails here does not end
        self.core.kill()
        self.core.wait()
        self.start_master()
        new = self.start_publisher("new")
        os.kill(keeper, signal.SIGCONT)
        both = {old, new}
        self.assertTrue(until(lambda: self.connected("/cpp") == self.connected("/listener") == both, LIMIT))
        self.assertIsNone(listener.poll())

    def start_publisher(self, name):
        """Its URI, when it is registered."""
        arguments = ["-r", "10", "/odom", "nav_msgs/Odometry", "{}", f"__name:={name}"]
        self.start_program("rostopic", "pub", *arguments)
        self.assertTrue(
            until(lambda: "/" + name in dict(self.master.getSystemState()[0]).get("/odom", []), 30.0)
        )
        return self.master.lookupNode("/" + name)

    def connected(self, node):
        """URIs of the publishers of /odom that a node is connected to."""
        try:
            connections = ServerProxy(self.master.lookupNode(node)).getBusInfo("/test")[2]
        except (OSError, rosgraph.MasterException):  # it is not registered
            return set()
        return {each[1] for each in connections if each[2] == "i" and each[4] == "/odom"}

    def unregister(self, node):
        uri = self.master.lookupNode(node)
        api = ServerProxy(self.uri)
        publishers, subscribers, services = self.master.getSystemState()
        for call, topics in ((api.unregisterPublisher, publishers), (api.unregisterSubscriber, subscribers)):
            for topic in [topic for topic, nodes in topics if node in nodes]:
                call(node, topic, uri)
        for service in [service for service, nodes in services if node in nodes]:
            api.unregisterService(node, service, self.master.lookupService(service))

    def start_nodelet(self, *command):
        return self.start_program("rosrun", "nodelet", "nodelet", *command)

    def start_bond(self, name):
        """Starts a node that publishes as a loader does."""
        topic = ["/manager/bond", "std_msgs/String", "{data: none}"]
        return self.start_program("rostopic", "pub", "-r", "1", *topic, f"__name:={name}")

    def publishes(self, topic, node):
        return [node] == dict(self.master.getSystemState()[0]).get(topic)

    def test_a_loader_without_its_nodelet_is_ended(self):
        self.assertTrue(until(self.complete, 30.0))
        self.start_nodelet("manager", "__name:=manager")
        loader = self.start_nodelet("load", "sextant/MarkerDetector", "manager", "__name:=loader")
        self.start_bond("other").wait(40)
        self.assertIsNone(loader.poll())

    def test_a_nodelet_without_its_loader_is_unloaded(self):
        self.assertTrue(until(self.complete, 30.0))
        self.start_nodelet("manager", "__name:=manager")
        loader = self.start_bond("detector")
        time.sleep(5.0)  # two looks of the keeper
        loader.kill()
        loader.wait()
        self.start_nodelet("load", "sextant/MarkerDetector", "manager", "--no-bond", "__name:=detector")
        self.assertTrue(until(lambda: self.publishes("/markers", "/manager"), LIMIT))
        self.assertTrue(until(lambda: not self.publishes("/markers", "/manager"), 40.0))

    def start_again(self, name):
        """A node dies and is respawned: its name has another URI. Returns what is then registered."""
        before = self.master.lookupNode("/" + name)
        self.nodes[name].kill()
        self.nodes[name].wait()
        self.nodes[name] = self.start(*NODES[name], f"__name:={name}")
        self.assertTrue(until(lambda: self.master.lookupNode("/" + name) != before, LIMIT))
        time.sleep(3.0)  # two looks of the keeper
        return self.registered()

    def stop_abruptly(self, name, expected):
        """A node that does not unregister: it is not registered again."""
        self.nodes[name].kill()
        self.nodes[name].wait()
        pairs, services, types = expected
        for kind in pairs:
            kind.difference_update({pair for pair in kind if pair[1] == "/" + name})
        for known in (services, types):
            for each in [each for each in known if each.startswith(f"/{name}/")]:
                del known[each]


if __name__ == "__main__":
    rostest.rosrun("sextant", "registration_keeper", RegistrationKeeperTest)
