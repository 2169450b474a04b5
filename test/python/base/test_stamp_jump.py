# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import pytest

from sextant.base.stamp_jump import JUMP_BACK, jumps_back

NEWEST = 1_600_000_000 * 10**9


@pytest.mark.parametrize(
    "step, expected", [(10**9, False), (0, False), (-JUMP_BACK, False), (-JUMP_BACK - 1, True)]
)
def test_a_message_out_of_order_is_no_jump(step, expected):
    assert jumps_back(NEWEST + step, NEWEST) == expected
