# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A program that is killed while it saves a map of landmarks leaves a whole one."""

import itertools
import os
import signal
import time

import numpy as np
import pytest

import sextant

KILLS, COUNT = 60, 60
LABELS = [sextant.LandmarkLabel(f"class {k % 3}") for k in range(COUNT)]


def some_map(number):
    """A map that is known by its number: all of it is different from that of another number."""
    rng = np.random.default_rng(number)
    landmarks = [sextant.Landmark2D(position) for position in rng.uniform(-9, 9, (COUNT, 2))]
    root = rng.normal(size=(3 + 2 * COUNT,) * 2)
    return sextant.LandmarkMap("map", [number, 0, 0], landmarks, LABELS, root @ root.T)


def start_saving(maps, path):
    """A process that saves one map after the other, and a pipe that gets a byte after each."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            for each in itertools.cycle(maps):
                sextant.write_landmark_map(each, path)
                os.write(writer, b".")
        finally:
            os._exit(1)
    os.close(writer)
    return child, reader


@pytest.mark.slow
def test_a_whole_map_is_there_after_every_kill(tmp_path):
    path, maps = str(tmp_path / "map.yaml"), [some_map(number) for number in range(2)]
    rng, found = np.random.default_rng(1), set()
    for saves, share in zip(rng.integers(1, 4, KILLS), rng.uniform(0.0, 1.0, KILLS)):
        child, reader = start_saving(maps, path)
        begin = time.monotonic()
        assert all(os.read(reader, 1) for _ in range(saves)), "it does not save"
        time.sleep(share * (time.monotonic() - begin) / saves)  # within the next, on any disk
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        os.close(reader)
        kept = sextant.read_landmark_map(path)
        truth = maps[round(kept.pose[0])]
        np.testing.assert_array_equal(kept.covariance, truth.covariance)
        np.testing.assert_array_equal(
            [each.position for each in kept.landmarks], [each.position for each in truth.landmarks]
        )
        found.add(round(kept.pose[0]))
    assert found == {0, 1}  # the kills came while it was written
