# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads the private parameters of rospy nodes (see sextant.base.strict_params)."""

from typing import Type

import rospy

from sextant.base.strict_params import Params, parse_params
from sextant.nodes.base.exits import fatal


def read_params(cls: Type[Params]) -> Params:
    """Reads the private parameters of this node; exits with status 1 and a log message if one is invalid."""
    with fatal(ValueError, separator=""):
        return parse_params(cls, rospy.get_param("~", {}), "")
