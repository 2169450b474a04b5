# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The ball task: goal detection, path planning, kick planning and the state machine."""
