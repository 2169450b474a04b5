# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The benchmark of the ball task in a quick run: every topic with the network that comes along."""

import pytest
from quick_run import topics_of


@pytest.mark.slow
def test_every_topic_is_measured(tmp_path):
    topics = topics_of("ball_task.py", "--plots", tmp_path)
    assert list(topics) == ["world", "places", "task"]
    (table,) = topics["task"]
    assert [row["name"] for row in table["rows"]] == ["task 2", "task 3"]
    assert all(5.0 < row["median time to goal, s"]["value"] < 240.0 for row in table["rows"])
    assert (tmp_path / "task.png").read_bytes().startswith(b"\x89PNG")
