# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

from sextant.objects.depth_scale import (
    DepthScaleParams,
    MeasuredDepth,
    estimate_depth_scale,
    read_measured_depths,
)

SETTINGS = DepthScaleParams()
DISTANCES = np.array([0.5, 1.0, 1.5, 2.0, 3.0])


def measured(depths, true=DISTANCES):
    return [MeasuredDepth(*pair) for pair in zip(depths, true)]


def test_exact_distances_give_the_exact_scale():
    found = estimate_depth_scale(measured(DISTANCES / 1.04), SETTINGS)
    assert found.scale == pytest.approx(1.04, abs=1e-12)
    np.testing.assert_allclose(found.residuals, 0.0, atol=1e-12)
    assert found.warnings == []
    sigmas = np.hypot(0.004 * DISTANCES**2, 0.002)
    np.testing.assert_allclose(found.sigmas, sigmas)
    assert found.deviation == pytest.approx(np.sum((DISTANCES / 1.04 / sigmas) ** 2) ** -0.5)


def test_one_distance_is_a_quotient():
    found = estimate_depth_scale([MeasuredDepth(0.96, 1.0)], SETTINGS)
    assert found.scale == pytest.approx(1.0 / 0.96)
    assert found.deviation == pytest.approx(np.hypot(0.004, 0.002) / 0.96)


def test_the_deviation_is_that_of_many_estimates():
    random = np.random.default_rng(3)
    sigmas = np.hypot(0.004 * DISTANCES**2, 0.002)
    scales = [
        estimate_depth_scale(
            measured((DISTANCES + sigmas * random.standard_normal(5)) / 1.04), SETTINGS
        ).scale
        for _ in range(2000)
    ]
    depths = estimate_depth_scale(measured(DISTANCES / 1.04), SETTINGS).deviation
    assert np.mean(scales) == pytest.approx(1.04, abs=3 * depths / np.sqrt(2000) + 1e-4)
    assert np.std(scales) == pytest.approx(depths, rel=0.08)


def test_residuals_that_are_larger_than_expected_make_it_less_sure():
    depths = DISTANCES / 1.04 * (1.0 + np.array([0.05, -0.05, 0.05, -0.05, 0.05]))
    rough, fine = (estimate_depth_scale(measured(each), SETTINGS) for each in (depths, DISTANCES / 1.04))
    assert rough.deviation > 3.0 * fine.deviation


@pytest.mark.parametrize(
    "depths, warning",
    [
        (DISTANCES / 1.04 - 0.05, "an offset of +0.0520"),
        (DISTANCES / 1.04 - 0.03 * DISTANCES**2, "a curvature of +0.0"),
    ],
)
def test_an_offset_or_a_curvature_is_reported(depths, warning):
    assert any(warning in each for each in estimate_depth_scale(measured(depths), SETTINGS).warnings)


def test_nothing_measured_and_settings_out_of_range_are_refused():
    with pytest.raises(ValueError, match="no distance was measured"):
        estimate_depth_scale([], SETTINGS)
    with pytest.raises(ValueError, match="tape_sigma: must be"):
        DepthScaleParams(tape_sigma=-1.0)


def test_a_file_is_read_line_by_line(tmp_path):
    path = tmp_path / "depths.csv"
    path.write_text("measured, true\n# in front of the wall\n0.96, 1.00\n\n1.92,2.0\n")
    assert read_measured_depths(path) == [(0.96, 1.0), (1.92, 2.0)]


@pytest.mark.parametrize(
    "text, reason",
    [
        ("measured,true\n0.9,1.0\n0.9;1.0\n", ":3: must be two numbers, measured and true, is '0.9;1.0'"),
        ("0.9,1.0,2.0\n", ":1: must be two numbers"),
        ("0.9,one\n", ":1: 'one' is not a distance"),
        ("0.9,-1\n", ":1: '-1' is not a distance in .0, 100. metres"),
        ("nan,1\n", ":1: 'nan' is not a distance"),
        ("0.9,1\nmeasured,true\n", ":2: 'measured' is not a distance"),
        ("960,1000\n", ":1: '960' is not a distance"),
        ("", "contains no line `measured, true`"),
    ],
)
def test_a_line_that_cannot_be_is_named(tmp_path, text, reason):
    path = tmp_path / "depths.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=reason):
        read_measured_depths(path)


def test_what_is_no_text_is_refused(tmp_path):
    path = tmp_path / "depths.csv"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ValueError, match="is not a text file"):
        read_measured_depths(path)
