// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace sextant {

/// Every name that DetectorParams::families, a marker map or markerImage() takes: OpenCV's predefined
/// dictionaries
/// ("DICT_4X4_50", ..., read by the ArUco backend) and libapriltag's families ("tag36h11", ...).
std::vector<std::string> markerFamilies();

/// One name per print: OpenCV's "DICT_APRILTAG_36h11" is libapriltag's "tag36h11"; every other name is its
/// own.
/// @throws std::invalid_argument that lists the known families.
std::string canonicalFamily(const std::string& name);

/// Number of different markers in a family.
int familySize(const std::string& name);

/// A marker's picture: one pixel a module, 8-bit grey (0 black, 255 white), upright as its own library prints
/// it.
struct MarkerImage {
  cv::Mat modules;  ///< square; the marker's own modules (for some AprilTag families there are some outside
                    ///< the border)
  int border_begin = 0;  ///< first module row and column inside the edge that Detection::corners lie on
  int border_end = 0;    ///< one past the last one: (border_end - border_begin) modules are the marker's size
};

/// @throws std::invalid_argument for an unknown family or an id outside of it.
MarkerImage markerImage(const std::string& family, int id);

}  // namespace sextant
