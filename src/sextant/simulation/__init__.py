# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A simulated room: printed markers, a robot that drives, a camera and wheels that report, and the truth."""
