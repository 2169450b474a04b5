# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Chooses the topics of a bag that are read as cameras, by the rule of BagParams."""

from typing import Dict, Iterable, List, NamedTuple, Sequence, Tuple

from sextant.bags.bag_file import BagFile, listed
from sextant.bags.bag_params import BagParams
from sextant.messages.image_messages import is_camera_image

IMAGE, COMPRESSED, MARKERS = "sensor_msgs/Image", "sensor_msgs/CompressedImage", "sextant/MarkerArray"

# Image topics of one camera in order of preference: unprocessed images give the best corners.
_PREFERRED = ("image_raw", "image", "image_mono", "image_color", "image_rect", "image_rect_color")
_COMPRESSED_ENDING = "/compressed"


class CameraTopic(NamedTuple):
    """A topic that is read as a camera."""

    topic: str  # as named in the bag
    camera: str  # name of the camera: the topic without /compressed
    type: str  # message type
    rectified: bool  # of images; recorded markers contain it
    calibration: str  # file that replaces camera_info; empty: none

    @property
    def info_topic(self) -> str:
        """The camera_info beside the images, as in image_transport."""
        return self.camera.rpartition("/")[0] + "/camera_info"


def choose_topics(bag: BagFile, params: BagParams) -> Tuple[List[CameraTopic], List[str]]:
    """The topics to read, sorted by camera name, and notes on skipped topics.

    :raises BagError: a named topic does not exist or has no camera_info, or there is nothing to read
    """
    images, markers = _found(bag, params, IMAGE, COMPRESSED), _found(bag, params, MARKERS)
    left_out: List[str] = []
    if params.images or params.markers:
        chosen = _named(bag, params.images, images, "images") + _named(
            bag, params.markers, markers, "markers"
        )
    elif markers:
        chosen, left_out = markers, _skipped(images, "markers were recorded")
    else:
        chosen, left_out = _one_a_camera(bag, images)
    _check(bag, chosen, params)
    return sorted(chosen, key=lambda each: each.camera), left_out


def choose_image_topic(bag: BagFile, name: str = "") -> Tuple[CameraTopic, List[str]]:
    """One image topic, with or without camera_info, and notes on skipped topics.

    :param name: empty: the topic of the only camera
    :raises BagError: it does not exist, or there are several cameras
    """
    if name:
        return _named(bag, [name], _found(bag, BagParams(), IMAGE, COMPRESSED), "images")[0], []
    chosen, left_out = image_topics(bag)
    if len(chosen) != 1:
        there = listed(each.topic for each in chosen)
        what = "there are images of several cameras in it" if chosen else "there are no images in it"
        advice = f"name the topic of one: {there}" if chosen else f"its topics are: {listed(bag.types)}"
        raise bag.error(what, advice)
    return chosen[0], left_out


def image_topics(bag: BagFile) -> Tuple[List[CameraTopic], List[str]]:
    """One image topic of each camera, with or without camera_info, and notes on skipped topics."""
    found = _found(bag, BagParams(), IMAGE, COMPRESSED)
    return _best_of_each(
        [each for each in found if each.type != IMAGE or is_camera_image(bag.first(each.topic, whole=True))]
    )


def _found(bag: BagFile, params: BagParams, *types: str) -> List[CameraTopic]:
    topics = [topic for topic in bag.topics(*types) if not topic.endswith("/compressedDepth")]
    return [_camera_topic(topic, bag.types[topic], params) for topic in topics]


def _camera_topic(topic: str, message_type: str, params: BagParams) -> CameraTopic:
    camera = topic
    if message_type == COMPRESSED and topic.endswith(_COMPRESSED_ENDING):
        camera = topic[: -len(_COMPRESSED_ENDING)]
    rectified = _last(camera).startswith("image_rect") or _is_named(topic, camera, params.rectified)
    files = [path for name, path in params.calibrations.items() if _is_named(topic, camera, [name])]
    return CameraTopic(topic, camera, message_type, rectified, str(files[0]) if files else "")


def _last(topic: str) -> str:
    return topic.rpartition("/")[2]


def _is_named(topic: str, camera: str, names: Iterable[str]) -> bool:
    return any(name.strip("/") in (topic.strip("/"), camera.strip("/")) for name in names)


def _named(bag: BagFile, names: Sequence[str], found: List[CameraTopic], what: str) -> List[CameraTopic]:
    chosen = []
    for name in names:
        fits = [each for each in found if _is_named(each.topic, each.camera, [name])]
        if not fits:
            there = listed(each.topic for each in found)
            raise bag.error(f"there are no {what} on {name}", f"topics of {what} in it: {there}")
        chosen.append(
            min(fits, key=lambda each: (each.topic.strip("/") != name.strip("/"), each.type == COMPRESSED))
        )
    return chosen


def _skipped(left_out: Iterable[CameraTopic], why: str) -> List[str]:
    return [f"{each.topic} was left out: {why}" for each in left_out]


def _one_a_camera(bag: BagFile, images: List[CameraTopic]) -> Tuple[List[CameraTopic], List[str]]:
    if not images:
        there = listed(bag.types)
        raise bag.error("there are neither images nor recorded markers in it", f"its topics are: {there}")
    usable, left_out = _usable(bag, images)
    if not usable:
        topics = listed(each.topic for each in images)
        advice = "name a calibration file for the topic, or the topics of images to read"
        raise bag.error(f"of its topics of images ({topics}) none has images and a camera_info", advice)
    chosen, others = _best_of_each(usable)
    return chosen, left_out + others


def _best_of_each(images: List[CameraTopic]) -> Tuple[List[CameraTopic], List[str]]:
    """One topic per camera, and notes on skipped topics."""
    cameras: Dict[str, List[CameraTopic]] = {}
    for each in sorted(images, key=_rank):
        cameras.setdefault(each.info_topic, []).append(each)
    left_out: List[str] = []
    for best, *others in cameras.values():
        left_out += _skipped(others, f"the same camera as {best.topic}")
    return [each[0] for each in cameras.values()], left_out


def _usable(bag: BagFile, images: List[CameraTopic]) -> Tuple[List[CameraTopic], List[str]]:
    usable, left_out = [], []
    for each in images:
        if not each.calibration and not bag.find(each.info_topic):
            left_out += _skipped([each], "no camera_info beside it")
        elif each.type == IMAGE and not is_camera_image(bag.first(each.topic, whole=True)):
            left_out += _skipped([each], "it holds no images")
        else:
            usable.append(each)
    return usable, left_out


def _rank(each: CameraTopic) -> Tuple[bool, int, bool, str]:
    name = _last(each.camera)
    place = _PREFERRED.index(name) if name in _PREFERRED else len(_PREFERRED)
    return not each.calibration, place, each.type == COMPRESSED, each.topic


def _check(bag: BagFile, chosen: List[CameraTopic], params: BagParams) -> None:
    cameras = [each.camera for each in chosen]
    for each in chosen:
        if cameras.count(each.camera) > 1:
            raise bag.error(f"the images of {each.camera} are named twice", "name one of their topics")
        if each.type != MARKERS and not each.calibration and not bag.find(each.info_topic):
            what = f"{each.topic} has no camera_info beside it ({each.info_topic})"
            raise bag.error(what, "name a calibration file for the topic")
    _check_use(bag, chosen, "calibrations", params.calibrations)
    _check_use(bag, chosen, "rectified", params.rectified)


def _check_use(bag: BagFile, chosen: List[CameraTopic], use: str, names: Iterable[str]) -> None:
    for name in names:
        if not any(_is_named(each.topic, each.camera, [name]) for each in chosen):
            read = listed(each.topic for each in chosen)
            raise bag.error(f"{name}, named in {use}, is not read", f"the topics that are read: {read}")
