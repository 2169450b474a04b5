# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Simulation of robots, cameras, odometry and their worlds, with ground truth."""
