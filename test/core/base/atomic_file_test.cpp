// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/base/atomic_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "test_refusal.hpp"

namespace sextant {
namespace {

class AtomicFile : public testing::Test {
 protected:
  void SetUp() override {
    char pattern[] = "/tmp/sextant_file_XXXXXX";
    folder_ = mkdtemp(pattern);
    path_ = folder_ + "/file";
  }
  void TearDown() override {
    unlink(path_.c_str());
    EXPECT_EQ(rmdir(folder_.c_str()), 0) << "a temporary file was left behind";
  }

  std::string folder_, path_;
};

TEST_F(AtomicFile, ReplacesTheContentAndKeepsTheMode) {
  const std::string long_text(1 << 20, 'x'), binary("a\0b\n", 4);
  for (const std::string& content : {long_text, binary, std::string()}) {
    writeFileAtomically(path_, content);
    chmod(path_.c_str(), 0640);
    std::ifstream file(path_, std::ios::binary);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), content);
  }
  writeFileAtomically(path_, "new");
  struct stat status {};
  stat(path_.c_str(), &status);
  EXPECT_EQ(status.st_mode & 0777, 0640u);
}

TEST_F(AtomicFile, NamesThePathAndTheReason) {
  const std::string nowhere = folder_ + "/no/file";
  EXPECT_EQ(refusal<std::runtime_error>([&] { writeFileAtomically(nowhere, "x"); }),
            nowhere + ": cannot be written: No such file or directory");
  // A folder cannot be replaced by a file: the rename fails, and the temporary file is removed.
  mkdir(path_.c_str(), 0755);
  EXPECT_EQ(refusal<std::runtime_error>([&] { writeFileAtomically(path_, "x"); }),
            path_ + ": cannot be written: Is a directory");
  rmdir(path_.c_str());
}

}  // namespace
}  // namespace sextant
