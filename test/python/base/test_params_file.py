# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The parameters of landmark SLAM offline are those of the nodelet."""

import numpy as np
import pytest

import sextant
from sextant.base.params_file import read_params_file
from sextant.base.strict_params import parse_struct


def params_of(values, where="here"):
    return parse_struct(sextant.LandmarkSlamNodeParams, values, where, ": ")


def test_parameters_arrive_in_the_parts():
    params = params_of({"candidate_observations": 7, "match_gate": 0.9, "lag": 2, "tilt_sigma": 0.5})
    assert (params.slam.candidates.observations, params.slam.matching.gate) == (7, 0.9)
    assert (params.timeline.lag, params.markers.tilt_sigma) == (2.0, 0.5)
    params.slam.sensor.max_range = 3.0
    assert params.max_range == 3.0


def test_the_first_pose_is_the_origin_or_the_one_that_is_set():
    assert params_of({}).first_pose.tolist() == [0, 0, 0]
    params = params_of({"start_pose": [1.0, 2.0, 0.5], "pose_sigma": [0.1, 0.2, 0.3]})
    assert params.first_pose.tolist() == [1.0, 2.0, 0.5]
    np.testing.assert_allclose(params.first_covariance, np.diag([0.01, 0.04, 0.09]))


def test_every_parameter_is_an_attribute_of_its_type():
    params, types = params_of({}), {"int": int, "double": float, "string": str, "bool": bool}
    for name, kind, _, _, what in sextant.LandmarkSlamNodeParams.fields():
        value = getattr(params, name)
        assert isinstance(value, types.get(kind, list)) and what
        setattr(params, name, value)
        with pytest.raises(TypeError, match=f"^{name} must be {kind}, not <object"):
            setattr(params, name, object())


@pytest.mark.parametrize(
    "text, reason",
    [
        ("gat: 0.9", "gat: unknown parameter; did you mean gate?"),
        ("gate: 2", "gate is 2, allowed is [0.5, 1)"),
        ("gate: wide", "gate: must be a finite number, is 'wide'"),
        ("max_hypotheses: 1000.5", "max_hypotheses: must be a whole number, is 1000.5"),
        ("read_only: 1", "read_only: must be true or false, is 1"),
        ("start_pose: [1, 2]", "start_pose has 2 numbers, it must have three: x, y (m) and heading (rad)"),
        ("pose_sigma: [0, 1, 1]", "pose_sigma is 0, allowed is (0, 1000] m, m, rad"),
        ("cameras: [a, a]", "cameras: 'a' is listed twice"),
        ("start: here", "start is 'here', allowed is one of origin, map, unknown"),
        ("lag: 0", "lag is 0"),
        ("gate", "write `name: value`"),
        ("gate: [", "is no YAML"),
    ],
)
def test_a_file_with_a_mistake_is_refused(tmp_path, text, reason):
    path = tmp_path / "params.yaml"
    path.write_text("max_range: 4.0\n" + text if ":" in text else text)
    with pytest.raises(ValueError) as error:
        params_of(read_params_file(path), str(path))
    assert str(error.value).startswith(f"{path}: ") and reason in str(error.value)


def test_a_file_may_be_empty(tmp_path):
    (tmp_path / "params.yaml").write_text("# nothing\n")
    assert read_params_file(tmp_path / "params.yaml") == {}
