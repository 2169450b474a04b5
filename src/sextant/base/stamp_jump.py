# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Jumps back of the stamps of one input."""

JUMP_BACK = 10**9  # nanoseconds; smaller steps back are messages out of order


def jumps_back(stamp: int, newest: int) -> bool:
    """Whether a stamp is so much older than the newest one (nanoseconds) that the clock was set back."""
    return stamp < newest - JUMP_BACK
