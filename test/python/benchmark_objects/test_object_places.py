# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The benchmark of located objects, on few worlds."""

import numpy as np
import pytest
from ball.object_places import jittered, judged_objects, place_tables


@pytest.mark.slow
def test_pillars_are_located_within_three_percent():
    judged = np.array(list(judged_objects(6)), float)
    near = judged[(judged[:, 0] == 0) & (judged[:, 1] > 0.5) & (judged[:, 1] < 3.0)]
    located = near[~np.isnan(near[:, 2])]
    assert len(near) > 30 and len(located) > 0.9 * len(near)
    assert np.percentile(located[:, 2], 95) < 0.02
    assert np.mean(located[:, 3]) / 2 < 1.3


@pytest.mark.slow
def test_a_quick_run_gives_a_table():
    (table,) = place_tables(True)
    assert table.holds
    assert [name for name, _ in table.rows][0] == "pillar, 0.5 to 1 m"


def test_boxes_are_off_by_the_documented_amount():
    boxes = np.tile([100.0, 100.0, 130.0, 300.0], (1000, 1))
    off = jittered(boxes, np.random.default_rng(1)) - boxes
    assert 2.9 < abs(off[:, [0, 2]]).max() <= 3.0
    assert 11.5 < abs(off[:, [1, 3]]).max() <= 12.0
