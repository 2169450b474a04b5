# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Visualization of a place map and its hypotheses in rviz."""

import math
from typing import Dict, Iterable, List, Sequence

import numpy as np
from geometry_msgs.msg import Point, Pose, Quaternion, Vector3
from nav_msgs.msg import MapMetaData, OccupancyGrid
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

from sextant.place_maps.overview_renderer import (
    INK,
    MAX_LABELS,
    MIN_LABELLED,
    PLACE,
    Hypothesis,
    Radii,
    trail_colours,
)
from sextant.place_maps.place_map import MetricFrame, Overview, Photo, PlaceMap
from sextant.place_maps.probability_colours import Colour, probability_colour


class PlaceVisualization:
    """rviz markers in the metric frame of a map: dots on the plane of the overview."""

    def __init__(self, place_map: PlaceMap, frame: MetricFrame, radii: Radii):
        self._overview, self._frame = place_map.overview, frame
        self._radii = Radii(*(radius * frame.resolution for radius in radii))  # metres
        self._photos: Dict[int, Photo] = {photo.id: photo for photo in place_map.photos}
        self._places = [photos[0].id for photos in place_map.places()]

    def map_markers(self) -> MarkerArray:
        """Markers of all places."""
        dots = self._spheres("places", self._radii.place, self._places, [_colour(PLACE)] * len(self._places))
        return MarkerArray([delete_all(), *dots])

    def hypothesis_markers(self, likely: Sequence[Hypothesis], trail: Sequence[int]) -> MarkerArray:
        """Markers of hypotheses.

        :param likely: trail: as for OverviewRenderer; all in the map
        """
        colours = [_colour(probability_colour(each.probability)) for each in likely]
        ids = [each.id for each in likely]
        return MarkerArray(
            [
                delete_all(),
                *self._trail(trail),
                *self._spheres("hypotheses", self._radii.hypothesis, ids[1:], colours[1:]),
                *self._spheres("best", self._radii.best, ids[:1], colours[:1]),
                *self._ring(ids[:1]),
                *self._labels([each.id for each in likely if each.probability >= MIN_LABELLED][:MAX_LABELS]),
            ]
        )

    def _spheres(
        self, name: str, radius: float, ids: Sequence[int], colours: List[ColorRGBA]
    ) -> List[Marker]:
        if not ids:  # rviz warns about empty lists
            return []
        spheres = self._marker(name, Marker.SPHERE_LIST, Vector3(2 * radius, 2 * radius, 2 * radius))
        spheres.points, spheres.colors = [self._point(number, radius) for number in ids], colours
        return [spheres]

    def _trail(self, trail: Sequence[int]) -> List[Marker]:
        if len(trail) < 2:
            return []
        line = self._marker("trail", Marker.LINE_STRIP, Vector3(0.6 * self._radii.place, 0.0, 0.0))
        line.points = [self._point(number, self._radii.place) for number in trail]
        line.colors = [_colour(colour) for colour in trail_colours(len(trail))]
        return [line]

    def _ring(self, best: Iterable[int]) -> List[Marker]:
        """A dark disc below the best hypothesis."""
        width, height = 3 * self._radii.best, 0.2 * self._radii.best
        rings = [self._marker("ring", Marker.CYLINDER, Vector3(width, width, height), INK) for _ in best]
        for ring, number in zip(rings, best):
            ring.pose.position = self._point(number, height)
        return rings

    def _labels(self, ids: Sequence[int]) -> List[Marker]:
        height = 2.5 * self._radii.hypothesis
        labels = []
        for index, number in enumerate(ids):
            label = self._marker("ids", Marker.TEXT_VIEW_FACING, Vector3(0.0, 0.0, height), INK)
            label.id, label.text = index, str(number)
            label.pose.position = self._point(number, 2 * self._radii.best)
            edge = self._radii.hypothesis if index else 1.5 * self._radii.best
            label.pose.position.y += edge + height / 2  # beside the dot when seen from above
            labels.append(label)
        return labels

    def _point(self, number: int, height: float) -> Point:
        photo = self._photos[number]
        return Point(*self._frame.position(self._overview, photo.x, photo.y), height)

    def _marker(self, name: str, kind: int, scale: Vector3, colour: Colour = (255, 255, 255)) -> Marker:
        upright = Pose(Point(), Quaternion(0.0, 0.0, 0.0, 1.0))  # rviz warns about zero quaternions
        header = Header(frame_id=self._frame.frame)
        return Marker(header=header, ns=name, type=kind, pose=upright, scale=scale, color=_colour(colour))


def overview_grid(image: np.ndarray, overview: Overview, frame: MetricFrame) -> OccupancyGrid:
    """The overview as a map that rviz displays in grey: 0 for white, 100 for black.

    :param image: uint8 (rows, columns, 3), RGB: the overview at any size
    """
    x, y, yaw = frame.origin
    rows, columns = image.shape[:2]
    origin = Pose(Point(x, y, 0.0), Quaternion(0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)))
    resolution = overview.width * frame.resolution / columns
    grid = OccupancyGrid(header=Header(frame_id=frame.frame))
    grid.info = MapMetaData(width=columns, height=rows, resolution=resolution, origin=origin)
    darkness = np.rint((255.0 - image.mean(axis=2)) * (100.0 / 255.0)).astype(np.int8)
    grid.data = darkness[::-1].ravel().tolist()  # the first row of a grid is the lowest
    return grid


def delete_all() -> Marker:
    """Marker that removes all previous ones."""
    return Marker(action=Marker.DELETEALL)


def _colour(colour: Colour) -> ColorRGBA:
    return ColorRGBA(*(part / 255 for part in colour), 1.0)
