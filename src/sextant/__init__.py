# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sextant without ROS: what its nodes compute, on arrays, files and bags."""

from sextant._core import *  # noqa: F401,F403
