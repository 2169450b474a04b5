// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/images/image_source.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <set>
#include <stdexcept>
#include <vector>

#include "camera_controls.hpp"

namespace sextant {
namespace {

namespace fs = std::filesystem;

constexpr double kNominalRate = 10.0;  // Hz, of a recording without a rate

std::string sizeText(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

bool isGrey(const ImageSourceParams& params) { return params.encoding == "mono8"; }

cv::Mat encoded(const cv::Mat& frame, bool grey, const std::string& name) {
  if (frame.empty() || (frame.type() != CV_8UC1 && frame.type() != CV_8UC3))
    throw std::runtime_error(name + ": the image cannot be decoded");
  if (frame.channels() == (grey ? 1 : 3)) return frame;
  cv::Mat converted;
  cv::cvtColor(frame, converted, grey ? cv::COLOR_BGR2GRAY : cv::COLOR_GRAY2BGR);
  return converted;
}

// ---- device ---------------------------------------------------------------------------------------------

class DeviceSource : public ImageSource {
 public:
  explicit DeviceSource(const ImageSourceParams& params)
      : params_(params), path_(params.source.front() == '/' ? params.source : "/dev/video" + params.source) {}

  void open() override {
    capture_.release();
    requireAccess();
    if (!capture_.open(path_, cv::CAP_V4L2))
      throw std::runtime_error(path_ +
                               " cannot be opened as a camera: does another program use it, or is it "
                               "a second node of the camera (v4l2-ctl --list-devices)?");
    // Before size and rate, because the pixel format determines which of them are available.
    if (!params_.fourcc.empty()) {
      const std::string& code = params_.fourcc;
      capture_.set(cv::CAP_PROP_FOURCC, cv::VideoWriter::fourcc(code[0], code[1], code[2], code[3]));
    }
    if (params_.width > 0) capture_.set(cv::CAP_PROP_FRAME_WIDTH, params_.width);
    if (params_.height > 0) capture_.set(cv::CAP_PROP_FRAME_HEIGHT, params_.height);
    if (params_.rate > 0) capture_.set(cv::CAP_PROP_FPS, params_.rate);
    capture_.set(cv::CAP_PROP_BUFFERSIZE,
                 2);  // a longer queue has old images, which grab() would stamp as new
    refused_ = applyControls(params_.controls,
                             {[this](int property, double value) { return capture_.set(property, value); },
                              [this](int property) { return capture_.get(property); }});
  }

  bool grab() override { return capture_.grab(); }

  cv::Mat retrieve() override {
    cv::Mat frame;
    capture_.retrieve(frame);
    return encoded(frame, isGrey(params_), path_);
  }

  std::vector<std::string> refusedSettings() const override { return refused_; }
  bool isLive() const override { return true; }
  double recordedRate() const override { return 0.0; }

 private:
  // OpenCV does not report why a device cannot be opened.
  void requireAccess() const {
    if (access(path_.c_str(), R_OK | W_OK) == 0) return;
    const char* advice = errno == ENOENT   ? "is the camera plugged in?"
                         : errno == EACCES ? "add the user to the group video"
                                           : "see dmesg";
    throw std::runtime_error(path_ + ": " + std::strerror(errno) + "; " + advice);
  }

  ImageSourceParams params_;
  std::string path_;
  cv::VideoCapture capture_;
  std::vector<std::string> refused_;
};

// ---- video file -----------------------------------------------------------------------------------------

class VideoSource : public ImageSource {
 public:
  explicit VideoSource(const ImageSourceParams& params) : path_(params.source), grey_(isGrey(params)) {}

  void open() override {
    if (!capture_.open(path_, cv::CAP_FFMPEG))  // the other backends print errors for unknown files
      throw std::runtime_error(path_ + " is neither a video nor an image that OpenCV can read");
    rate_ = capture_.get(cv::CAP_PROP_FPS);
    if (!(rate_ > 0 && rate_ <= 1000)) rate_ = kNominalRate;
  }

  bool grab() override { return capture_.grab(); }

  cv::Mat retrieve() override {
    cv::Mat frame;
    capture_.retrieve(frame);
    return encoded(frame, grey_, path_);
  }

  bool isLive() const override { return false; }
  double recordedRate() const override { return rate_; }

 private:
  std::string path_;
  bool grey_;
  double rate_ = kNominalRate;
  cv::VideoCapture capture_;
};

// ---- images ---------------------------------------------------------------------------------------------

bool isImageName(const fs::path& path) {
  static const std::set<std::string> endings = {".bmp", ".jpeg", ".jpg",  ".pgm", ".png",
                                                ".pnm", ".ppm",  ".tiff", ".tif", ".webp"};
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), ::tolower);
  return endings.count(ending) > 0;
}

/// The images of a folder in the order of their names, or one image.
class FolderSource : public ImageSource {
 public:
  explicit FolderSource(const ImageSourceParams& params) : grey_(isGrey(params)) {
    if (!fs::is_directory(params.source)) {
      files_.push_back(params.source);
      return;
    }
    for (const auto& entry : fs::directory_iterator(params.source))
      if (isImageName(entry.path())) files_.push_back(entry.path().string());
    std::sort(files_.begin(), files_.end());
    if (files_.empty())
      throw std::invalid_argument("no image (png, jpg, ...) in the folder " + params.source);
  }

  void open() override { next_ = 0; }

  bool grab() override {
    if (next_ == files_.size()) return false;
    ++next_;
    return true;
  }

  cv::Mat retrieve() override {
    const std::string& file = files_[next_ - 1];
    const int colour = grey_ ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR;
    // The calibration is for the pixels of the sensor: the orientation in a photo's header does not apply.
    return encoded(cv::imread(file, colour | cv::IMREAD_IGNORE_ORIENTATION), grey_, file);
  }

  bool isLive() const override { return false; }
  double recordedRate() const override { return kNominalRate; }

 private:
  std::vector<std::string> files_;
  size_t next_ = 0;
  bool grey_;
};

/// Another source, completely decoded at the start.
class PreloadedSource : public ImageSource {
 public:
  explicit PreloadedSource(ImageSource& source) : rate_(source.recordedRate()) {
    source.open();
    while (source.grab()) {
      try {
        frames_.push_back({source.retrieve().clone(), {}});
      } catch (const std::runtime_error& error) {
        frames_.push_back({{}, error.what()});
      }
    }
  }

  void open() override { next_ = 0; }

  bool grab() override {
    if (next_ == frames_.size()) return false;
    ++next_;
    return true;
  }

  cv::Mat retrieve() override {
    const Frame& frame = frames_[next_ - 1];
    if (frame.image.empty()) throw std::runtime_error(frame.trouble);
    return frame.image;
  }

  bool isLive() const override { return false; }
  double recordedRate() const override { return rate_; }

 private:
  struct Frame {
    cv::Mat image;
    std::string trouble;
  };
  std::vector<Frame> frames_;
  size_t next_ = 0;
  double rate_;
};

// ---- which of them --------------------------------------------------------------------------------------

bool isDevice(const std::string& source) {
  return source.rfind("/dev/", 0) == 0 || source.find_first_not_of("0123456789") == std::string::npos;
}
bool isImages(const std::string& source) { return fs::is_directory(source) || isImageName(source); }
bool isAny(const std::string&) { return true; }

template <typename Source>
std::unique_ptr<ImageSource> make(const ImageSourceParams& params) {
  return std::make_unique<Source>(params);
}

struct Kind {
  bool (*fits)(const std::string& source);
  std::unique_ptr<ImageSource> (*make)(const ImageSourceParams& params);
};
constexpr Kind kKinds[] = {
    {isDevice, make<DeviceSource>}, {isImages, make<FolderSource>}, {isAny, make<VideoSource>}};

/// Checks that a path exists, and that nothing is set that only a device has.
void requireFile(const ImageSourceParams& params) {
  if (!fs::exists(params.source))
    throw std::invalid_argument(
        params.source + " does not exist: source must be a device, a video file, an image or a folder");
  if (hasControls(params.controls))
    throw std::invalid_argument(
        "exposure, gain, focus, white_balance and automatic are for devices; the source " + params.source +
        " is a file");
}

/// Checks that at least one image can be decoded, and its size.
void requireImage(ImageSource& source, const ImageSourceParams& params) {
  source.open();
  std::string trouble = params.source + " contains no image";
  while (source.grab()) {
    cv::Mat image;
    try {
      image = source.retrieve();
    } catch (const std::runtime_error& error) {
      trouble = std::string("nothing to play: ") + error.what();
      continue;
    }
    if ((params.width > 0 && image.cols != params.width) ||
        (params.height > 0 && image.rows != params.height))
      throw std::invalid_argument(params.source + " has " + sizeText(image.cols, image.rows) +
                                  " pixels, not the width and height of " +
                                  sizeText(params.width, params.height) + "; leave them 0 for a file");
    return;
  }
  throw std::runtime_error(trouble);
}

}  // namespace

std::unique_ptr<ImageSource> makeImageSource(const ImageSourceParams& params) {
  validate(params);
  requireOneMode(params.controls);
  ImageSourceParams found = params;
  if (!isDevice(params.source)) {
    found.source = fs::absolute(params.source).lexically_normal().string();
    requireFile(found);
  } else if (params.preload) {
    throw std::invalid_argument("preload is for files; the source " + params.source + " is a device");
  }
  const auto kind =
      std::find_if(std::begin(kKinds), std::end(kKinds), [&](const Kind& k) { return k.fits(found.source); });
  auto source = kind->make(found);
  if (source->isLive()) return source;
  requireImage(*source, found);
  if (params.preload) return std::make_unique<PreloadedSource>(*source);
  source->open();
  return source;
}

}  // namespace sextant
