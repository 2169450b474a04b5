# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot that brings a ball through a goal: where the goal is, ways, kicks, and what is done when."""
