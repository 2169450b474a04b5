# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads cameras from files of camera_calibration."""

from sextant.bags.bag_file import BagError
from sextant.calibration.calibration_file import CalibrationFileError, read_calibration
from sextant.localization.drive_observations import DriveCamera


def camera_from_file(path: str, rectified: bool) -> DriveCamera:
    """The camera of a YAML file of camera_calibration, for images of the size in the file.

    :raises BagError: it cannot be read, or a field is missing or wrong
    """
    try:
        return DriveCamera(read_calibration(path), rectified)
    except CalibrationFileError as error:
        raise BagError(path, error.what, "it must be a YAML file as camera_calibration writes it") from None
