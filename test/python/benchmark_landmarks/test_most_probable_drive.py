# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The most probable drive that the benchmark compares the filter with, where it is known."""

import numpy as np

from landmarks.most_probable_drive import DriveGraph, most_probable
from sextant.geometry.plane_poses import composed, in_frame


def test_what_contradicts_is_shared_by_all_that_is_as_sure():
    steps, one = np.array([[1.0, 0.0, 0.0]]), np.array([[1.0, 0.0, 0.0]])
    seen, observations = np.array([[0, 0], [1, 0]]), np.array([[2.0, 0.0], [1.3, 0.0]])
    graph = DriveGraph(steps, np.eye(3)[None], seen, observations, np.array([np.eye(2)] * 2))
    poses, landmarks, cost = most_probable(graph, np.vstack([0 * one, one]), np.array([[2.0, 0.0]]))
    np.testing.assert_allclose(poses, [[0, 0, 0], [0.9, 0, 0]], atol=1e-6)
    np.testing.assert_allclose(landmarks, [[2.1, 0]], atol=1e-6)
    assert abs(cost - 0.5 * 3 * 0.1**2) < 1e-9


def test_a_drive_without_noise_is_found_as_it_was():
    rng = np.random.default_rng(1)
    steps, truth = np.tile([0.5, 0.02, 0.3], (40, 1)), [np.array([1.0, 2.0, 3.0])]
    for step in steps:
        truth.append(composed(truth[-1], step))
    points = rng.uniform(-4, 4, (6, 2))
    seen = np.array([(pose, (pose + k) % 6) for pose in range(41) for k in range(3)])
    observations = np.array([in_frame(truth[pose], points[which]) for pose, which in seen])
    noises, covariances = np.tile(0.01 * np.eye(3), (40, 1, 1)), np.tile(0.04 * np.eye(2), (len(seen), 1, 1))
    start = np.array(truth) + np.vstack([np.zeros(3), 0.1 * rng.standard_normal((40, 3))])
    graph = DriveGraph(steps, noises, seen, observations, covariances)
    poses, landmarks, cost = most_probable(graph, start, points + 0.3)
    assert cost < 1e-9
    np.testing.assert_allclose(poses[:, :2], np.array(truth)[:, :2], atol=1e-5)
    np.testing.assert_allclose(landmarks, points, atol=1e-5)
