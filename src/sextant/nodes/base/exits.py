# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Termination of rospy nodes."""

import sys
from contextlib import contextmanager
from typing import Iterator, Type

import rospy


@contextmanager
def fatal(*errors: Type[Exception], separator: str = ": ") -> Iterator[None]:
    """Logs an error of these types with the node's name, and exits with status 1.

    :param separator: between the node's name and the error
    """
    try:
        yield
    except errors as error:
        rospy.logfatal("%s%s%s", rospy.get_name(), separator, error)
        sys.exit(1)


@contextmanager
def until_shutdown() -> Iterator[None]:
    """Ignores the exceptions that rospy raises when a node is shut down while it publishes or sleeps.

    rospy closes the topics before is_shutdown() is true.
    """
    try:
        yield
    except rospy.ROSException:
        if not rospy.core.is_shutdown_requested() and not rospy.is_shutdown():
            raise
