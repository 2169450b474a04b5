// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "camera_controls.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/videoio.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>

namespace sextant {
namespace {

constexpr int kNone = -1;  // no such property
// enum v4l2_exposure_auto_type, which OpenCV passes on; for the other controls 0 and 1
constexpr double kManualExposure = 1.0;
constexpr double kAutomaticExposure = 3.0;  // with the frame rate kept, which cameras for computers have

struct Control {
  const char* name;
  double CameraControlParams::*value;
  const char* unit;
  double scale;   // from the parameter's unit to the property's
  int property;   // of cv::VideoCapture
  int mode;       // property of the automatic control
  double manual;  // values of this property
  double automatic;
};

constexpr Control kControls[] = {
    {"exposure", &CameraControlParams::exposure, " s", 1e4, cv::CAP_PROP_EXPOSURE, cv::CAP_PROP_AUTO_EXPOSURE,
     kManualExposure, kAutomaticExposure},
    {"gain", &CameraControlParams::gain, "", 1.0, cv::CAP_PROP_GAIN, kNone, 0.0, 0.0},
    {"focus", &CameraControlParams::focus, "", 1.0, cv::CAP_PROP_FOCUS, cv::CAP_PROP_AUTOFOCUS, 0.0, 1.0},
    {"white_balance", &CameraControlParams::white_balance, " K", 1.0, cv::CAP_PROP_WB_TEMPERATURE,
     cv::CAP_PROP_AUTO_WB, 0.0, 1.0},
};

bool isAutomatic(const CameraControlParams& params, const Control& control) {
  return std::count(params.automatic.begin(), params.automatic.end(), control.name) > 0;
}

// Whether a value that was read back is the wanted one, which the camera may have rounded to its steps.
bool isClose(double found, double wanted) {
  return std::abs(found - wanted) <= std::max(1.0, 0.05 * std::abs(wanted));
}

std::string text(const Control& control, double value) {
  std::ostringstream out;
  out << value << control.unit;
  return out.str();
}

// Returns what the camera did instead.
std::optional<std::string> applyValue(const Control& control, double value, const CameraProperties& camera) {
  // The mode first: cameras refuse values of a control that they set by themselves.
  if (control.mode != kNone) camera.set(control.mode, control.manual);
  const double wanted = std::round(control.scale * value);
  const std::string what = std::string(control.name) + " of " + text(control, value);
  if (!camera.set(control.property, wanted)) return "the camera refuses " + what;
  const double found = camera.get(control.property);
  if (found < 0.0 || isClose(found, wanted)) return std::nullopt;
  return "the camera has set " + text(control, found / control.scale) + " instead of " + what;
}

std::optional<std::string> applyControl(const CameraControlParams& params, const Control& control,
                                        const CameraProperties& camera) {
  const double value = params.*control.value;
  if (value >= 0.0) return applyValue(control, value, camera);
  if (!isAutomatic(params, control) || camera.set(control.mode, control.automatic)) return std::nullopt;
  return "the camera refuses automatic " + std::string(control.name);
}

}  // namespace

void requireOneMode(const CameraControlParams& params) {
  for (const Control& control : kControls)
    if (params.*control.value >= 0.0 && isAutomatic(params, control))
      throw std::invalid_argument(std::string(control.name) + " is " + text(control, params.*control.value) +
                                  ", so it must not be in automatic");
}

bool hasControls(const CameraControlParams& params) {
  return !params.automatic.empty() ||
         std::any_of(std::begin(kControls), std::end(kControls),
                     [&](const Control& control) { return params.*control.value >= 0.0; });
}

std::vector<std::string> applyControls(const CameraControlParams& params, const CameraProperties& camera) {
  std::vector<std::string> troubles;
  for (const Control& control : kControls)
    if (const auto trouble = applyControl(params, control, camera)) troubles.push_back(*trouble);
  return troubles;
}

}  // namespace sextant
