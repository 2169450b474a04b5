#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import signal
import subprocess
import sys
import unittest

import rosgraph
import rospy
import rostest

TIMEOUT = 30.0  # seconds
NODE = """
import os, threading, time
import rospy
from sextant.nodes.base.init_node import init_node

init_node("interrupted")
publisher = rospy.Publisher("topic", rospy.AnyMsg, queue_size=1)
lock = threading.Lock()
rospy.on_shutdown(lock.acquire)
with lock:
    os.kill(os.getpid(), {signal})
    time.sleep(0.5)
    assert not rospy.is_shutdown()
rospy.spin()
"""


class InitNodeTest(unittest.TestCase):
    def test_a_signal_while_the_main_thread_holds_a_lock_of_the_shutdown(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            code = NODE.format(signal=int(number))
            node = subprocess.run([sys.executable, "-c", code], timeout=TIMEOUT, stderr=subprocess.PIPE)
            self.assertEqual((node.returncode, node.stderr), (0, b""))
            publishers, subscribers, _ = rosgraph.Master("test").getSystemState()
            self.assertNotIn("/interrupted", str((publishers, subscribers)))


if __name__ == "__main__":
    rospy.init_node("init_node_test")
    rostest.rosrun("sextant", "init_node", InitNodeTest)
