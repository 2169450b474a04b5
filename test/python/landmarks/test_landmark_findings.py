# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Findings about a new landmark map, each of a landmark that is made to have it, and the report with them."""

import numpy as np
import pytest
from html_page import Page

import sextant
from sextant.landmarks.landmark_findings import list_findings, scatter, spread, verdict
from sextant.landmarks.landmark_report import write_landmark_report
from sextant.landmarks.slam_run import DriveSegment, LandmarkResult, LandmarkSightings

RANDOM = np.random.default_rng(4)


def sightings(scatter=1.0, span=100.0, degrees=180.0, detection=0.8, count=400):
    """Of a landmark with Gaussian residuals of this many standard deviations."""
    return LandmarkSightings(
        np.linspace(10.0, 10.0 + span, count),
        np.radians(np.linspace(-170.0, -170.0 + degrees, count)),
        scatter * np.hypot(*RANDOM.normal(size=(2, count))),
        detection,
    )


NONE = LandmarkSightings(np.zeros(0), np.zeros(0), np.zeros(0), 0.5)


def result_of(*of, positions=None, sigmas=None, labels=None):
    """A map of landmarks on a line, 2 m apart, that were observed like this."""
    positions = positions or [(2.0 * index, 1.0) for index in range(len(of))]
    labels = labels or [sextant.LandmarkLabel("tube") for _ in of]
    sigmas = np.concatenate([[0.0] * 3, *([sigma, 0.01] for sigma in sigmas or [0.02] * len(of))])
    landmarks = [sextant.Landmark2D(position) for position in positions]
    landmark_map = sextant.LandmarkMap("map", np.zeros(3), landmarks, labels, np.diag(sigmas**2), False)
    path = {round(1e9 * k): np.array([0.1 * k, 0.0, 0.0]) for k in range(20)}
    return LandmarkResult(
        landmark_map, [len(each.stamps) for each in of], [DriveSegment(path, path, [])], [], list(of)
    )


def words(result):
    return [(finding.word, finding.keys) for finding in list_findings(result)]


def test_good_landmarks_have_no_finding():
    result = result_of(*(sightings() for _ in range(12)))
    assert words(result) == [] and verdict(result) == "12 landmarks mapped; no problem found"


@pytest.mark.parametrize(
    "bad, word, fact",
    [
        (sightings(scatter=3.0), "does not fit", "tube at (2.00, 1.00) scatter 3."),
        (sightings(detection=0.1), "seldom detected", "was detected in 10% of the scans"),
        (sightings(span=2.0), "seen only once", "was observed within 2.0 s only"),
        (sightings(degrees=20.0), "seen from one side", "was observed within 20 degrees only"),
        (NONE, "never seen", "of the initial map was never observed"),
    ],
)
def test_each_finding_is_of_its_landmark(bad, word, fact):
    result = result_of(sightings(), bad, sightings())
    assert words(result) == [(word, (1,))]
    (finding,) = list_findings(result)
    assert fact in str(finding) and finding.advice
    assert verdict(result) == "3 landmarks mapped; check 1 landmark named below"


def test_gross_errors_of_single_observations_are_no_finding():
    gross = sightings()
    gross.distances[::20] = 30.0
    assert words(result_of(gross)) == []
    assert scatter(sightings(count=100000)) == pytest.approx(1.0, abs=0.01)


def test_an_uncertain_landmark():
    three = [sightings() for _ in range(3)]
    result = result_of(*three, sigmas=[0.02, 0.3, 0.02])
    assert words(result) == [("uncertain", (1,))]
    assert "is uncertain (0.30 m, standard deviation)" in str(list_findings(result)[0])
    assert words(result_of(*three, sigmas=[0.2, 0.3, 0.2])) == []  # all of them are, far from the start


def test_landmarks_that_are_confused():
    near = {"positions": [(0.0, 0.0), (0.3, 0.0), (5.0, 5.0)]}
    three = [sightings() for _ in range(3)]
    assert words(result_of(*three, **near)) == [("close to another one", (0, 1))]
    classes = [sextant.LandmarkLabel("tube"), sextant.LandmarkLabel("pillar"), sextant.LandmarkLabel("tube")]
    assert words(result_of(*three, labels=classes, **near)) == []
    ids = [sextant.LandmarkLabel("tube", id) for id in (1, 2, 3)]
    assert words(result_of(*three, labels=ids, **near)) == []


def test_a_short_drive_is_no_brief_look():
    assert words(result_of(sightings(span=5.0), sightings(span=8.0))) == []


@pytest.mark.parametrize(
    "directions, expected",
    [([], 0), ([30], 0), ([170, -170], 20), ([0, 120, 240], 240), ([0, 90, 180, 270], 270), ([10, 10], 0)],
)
def test_the_angle_that_contains_all_directions(directions, expected):
    assert np.degrees(spread(np.radians(directions))) == pytest.approx(expected, abs=1e-6)


def test_the_report_has_findings_warnings_and_a_row_for_each_landmark(tmp_path):
    labels = [sextant.LandmarkLabel("<b>tube</b>"), sextant.LandmarkLabel("tag36h11", 7)]
    result = result_of(sightings(scatter=3.0), NONE, labels=labels)
    path = tmp_path / "map.html"
    write_landmark_report(path, result, ["1.9 m in 20 s"], ["the NIS is 3"], {"recording": "a.bag"})
    page = Page(path.read_text())
    for text in (verdict(result), *map(str, list_findings(result)), "the NIS is 3", "1.9 m in 20 s", "a.bag"):
        assert text in page.text
    assert page.row("<b>tube</b>")[1:6] == ["does not fit", "0.000", "1.000", "0.020", "400"]
    assert page.row("tag36h11 7")[1:] == ["never seen", "2.000", "1.000", "0.020", "0", *[""] * 5]
    assert dict(page.attributes)["src"].startswith("data:image/png;base64,")
    assert "<b>tube" not in path.read_text()


def test_the_report_of_an_empty_map(tmp_path):
    write_landmark_report(tmp_path / "map.html", result_of(), [], [], {})
    assert "0 landmarks mapped; no problem found" in (tmp_path / "map.html").read_text()
