# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Messages of landmark SLAM."""

import numpy as np

import sextant
from sextant.messages.landmark_messages import landmark_observations, observations_to_messages
from sextant.msg import LandmarkObservations


def test_observations_are_the_same_as_messages():
    pillar = sextant.Observation2D([2.0, -0.5], np.diag([0.1, 0.2]))
    marker = sextant.Observation2D([3.0, 1.0], np.diag([0.01, 0.02, 0.03]), 0.4)
    seen = [
        sextant.LabelledObservation(sextant.LandmarkLabel("red_pillar"), pillar),
        sextant.LabelledObservation(sextant.LandmarkLabel("tag36h11", 7), marker),
    ]
    messages = observations_to_messages(seen)
    assert [each.id for each in messages] == [-1, 7]
    assert np.isnan(messages[0].heading) and messages[1].heading == 0.4
    back = landmark_observations(LandmarkObservations(observations=messages), np.eye(4))
    for each, expected in zip(back, seen):
        assert each.label == expected.label
        np.testing.assert_allclose(each.observation.position, expected.observation.position)
        np.testing.assert_allclose(each.observation.covariance, expected.observation.covariance)
        assert each.observation.heading == expected.observation.heading
