# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Bags of simulated drives among landmarks, with odometry and observations as nodes publish them."""

import numpy as np
from written_bags import WrittenBag, header

import sextant
from sextant.commands.map_landmarks import main
from sextant.geometry.plane_poses import composed, relative, rotation
from sextant.msg import LandmarkObservation, LandmarkObservations


def observation_message(class_name, position, covariance, heading=float("nan"), id=-1):
    """covariance (2, 2), or (3, 3) with a heading."""
    full = np.zeros((3, 3))
    full[: len(covariance), : len(covariance)] = covariance
    return LandmarkObservation(class_name, id, *map(float, position), heading, full.ravel().tolist())


def observations_message(seconds, observations, frame="base_link"):
    return LandmarkObservations(header(seconds, frame), observations)


def seen_messages(seen, T_frame_base=(0.0, 0.0, 0.0)):
    """Of SimulatedObservation of a world, in a frame that is turned and moved against the robot's."""
    turn = rotation(T_frame_base[2])
    return [
        observation_message(
            each.class_name, composed(np.array(T_frame_base), np.array([*each.position, 0.0]))[:2],
            turn @ each.covariance @ turn.T,
        )
        for each in seen
    ]  # fmt: skip


def planar(pose):
    return sextant.pose_from_xyz_rpy([pose[0], pose[1], 0.0], [0.0, 0.0, pose[2]])


def write_world(path, world, begin=1.0, delay=0.0, frame="base_link", mount=(0.0, 0.0, 0.0), arrivals=None):
    """A drive of LandmarkWorld; observations come so many seconds late.

    :param mount: T_frame_base of the observations' frame
    :param arrivals: of [(arrival, message)], returns those that come instead
    :returns: {seconds: true pose (3,) where the drive begins}
    """
    with WrittenBag(path) as bag:
        return write_drive(lambda seconds: bag, world, begin, delay, frame, mount, arrivals)


def write_drive(bag_at, world, begin=1.0, delay=0.0, frame="base_link", mount=(0.0, 0.0, 0.0), arrivals=None):
    """write_world() into several bags. :param bag_at: the open WrittenBag of a time of reception, seconds"""
    odometry, truth, sets = np.zeros(3), {}, []
    bag_at(begin).odometry("/odom", planar(odometry), begin)
    for step in world.steps():
        seconds = begin + step.stamp
        odometry = composed(odometry, step.odometry_step)
        bag_at(seconds).odometry("/odom", planar(odometry), seconds)
        truth[seconds] = relative(world.start, step.pose)
        if step.scan:
            message = observations_message(seconds, seen_messages(step.scan.observations, mount), frame)
            sets.append((seconds + delay + 1e-3, message))
    for arrival, message in arrivals(sets) if arrivals else sets:
        bag_at(arrival).write("/landmarks", message, arrival)  # the bag's index has them in this order
    return truth


def refused(capsys, *arguments):
    """Why nothing was written."""
    capsys.readouterr()
    assert main([str(each) for each in arguments]) == 2
    return capsys.readouterr().err
