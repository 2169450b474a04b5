// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/base/atomic_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>

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

TEST(ShortestDecimal, HasNoDigitTooManyAndNoneTooFew) {
  EXPECT_EQ(shortestDecimal(0.1), "0.1");
  EXPECT_EQ(shortestDecimal(0.1 + 0.2), "0.30000000000000004");
  EXPECT_EQ(shortestDecimal(1.0 / 3), "0.3333333333333333");
  EXPECT_EQ(shortestDecimal(-3), "-3");
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> digits(-1, 1), exponent(-300, 300);
  for (int i = 0; i < 1000; ++i) {
    const double value = digits(random) * std::pow(10, exponent(random));
    EXPECT_EQ(std::strtod(shortestDecimal(value).c_str(), nullptr), value);
  }
}

}  // namespace
}  // namespace sextant
