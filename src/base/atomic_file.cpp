// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/base/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <vector>

namespace sextant {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& temporary) {
  const std::string reason = std::strerror(errno);
  if (!temporary.empty()) unlink(temporary.c_str());
  throw std::runtime_error(path + ": cannot be written: " + reason);
}

mode_t modeFor(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) == 0) return status.st_mode & 07777;
  const mode_t mask = umask(0);
  umask(mask);
  return 0666 & ~mask;
}

bool writeAll(int file, const std::string& content) {
  size_t done = 0;
  while (done < content.size()) {
    const ssize_t count = write(file, content.data() + done, content.size() - done);
    if (count < 0 && errno != EINTR) return false;
    if (count > 0) done += static_cast<size_t>(count);
  }
  return true;
}

void syncFolder(const std::string& path) {
  const size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  const int file = open(folder.c_str(), O_RDONLY | O_DIRECTORY);
  if (file < 0) return;  // the content is safe; only the rename may be lost in a power failure
  fsync(file);
  close(file);
}

}  // namespace

void writeFileAtomically(const std::string& path, const std::string& content) {
  const std::string pattern = path + ".XXXXXX";
  std::vector<char> name(pattern.c_str(), pattern.c_str() + pattern.size() + 1);
  const int file = mkstemp(name.data());
  if (file < 0) fail(path, "");
  const bool written = fchmod(file, modeFor(path)) == 0 && writeAll(file, content) && fsync(file) == 0;
  if (close(file) != 0 || !written) fail(path, name.data());
  if (rename(name.data(), path.c_str()) != 0) fail(path, name.data());
  syncFolder(path);
}

}  // namespace sextant
