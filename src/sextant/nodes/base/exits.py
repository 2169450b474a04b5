# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How rospy nodes end."""

import sys
from contextlib import contextmanager
from typing import Iterator, Type

import rospy


@contextmanager
def fatal(*errors: Type[Exception], separator: str = ": ") -> Iterator[None]:
    """An error of these kinds is logged after the node's name and ends the process with status 1.

    :param separator: "/" where the error begins with the name of a parameter
    """
    try:
        yield
    except errors as error:
        rospy.logfatal("%s%s%s", rospy.get_name(), separator, error)
        sys.exit(1)


@contextmanager
def until_shutdown() -> Iterator[None]:
    """rospy raises where the node ends while it publishes or sleeps: that is no error."""
    try:
        yield
    except rospy.ROSException:
        if not rospy.is_shutdown():
            raise
