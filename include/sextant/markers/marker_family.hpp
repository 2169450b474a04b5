// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace sextant {

/// Returns every family name that detectors, marker maps and markerImage() accept: OpenCV's predefined
/// dictionaries ("DICT_4X4_50", ...) and libapriltag's families ("tag36h11", ...).
std::vector<std::string> markerFamilies();

/// Returns the canonical name of a family. OpenCV's "DICT_APRILTAG_36h11" and libapriltag's "tag36h11" are
/// the same markers; the canonical name is libapriltag's. A name without such a counterpart is canonical.
/// @throws std::invalid_argument with the list of known families
std::string canonicalFamily(const std::string& name);

/// Whether libapriltag detects the markers of a family, rather than OpenCV.
/// @param canonical its canonicalFamily()
bool isAprilTag(const std::string& canonical);

/// Returns the number of markers in a family. @throws std::invalid_argument as canonicalFamily()
int familySize(const std::string& name);

/// The modules of a marker: one pixel per module, 8-bit grey (0 black, 255 white), upright as printed by
/// the library that defines the family.
struct MarkerImage {
  cv::Mat modules;       ///< square; includes the modules that some AprilTag families have outside the border
  int border_begin = 0;  ///< first row and column inside the square whose corners are Detection::corners
  int border_end = 0;    ///< one past the last: the marker's edge length is border_end - border_begin modules
};

/// Draws a marker.
/// @throws std::invalid_argument for an unknown family or an id outside the family
MarkerImage markerImage(const std::string& family, int id);

}  // namespace sextant
