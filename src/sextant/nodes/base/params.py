# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Private parameters of the rospy nodes: of a dataclass as sextant.base.strict_params has it."""

import sys
from typing import Type

import rospy

from sextant.base.strict_params import Params, parse_params


def read_params(cls: Type[Params]) -> Params:
    """The private parameters of this node; a mistake in them is logged and ends the process with status 1."""
    try:
        return parse_params(cls, rospy.get_param("~", {}), rospy.get_name())
    except ValueError as error:
        rospy.logfatal("%s", error)
        sys.exit(1)
