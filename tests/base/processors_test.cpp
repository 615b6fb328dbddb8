// How many processors a process may use, as its control groups say.
#include "host/base/processors.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/temporary_path.h"

namespace mica::host::processors_test {
namespace {

namespace fs = std::filesystem;

class Quota : public testing::Test {
 protected:
  Quota() : root_(temporary_path("quota")) {}
  ~Quota() override { fs::remove_all(root_); }
  void write(const std::string& file, const std::string& text) const {
    fs::create_directories((fs::path(root_) / file).parent_path());
    std::ofstream(fs::path(root_) / file) << text << '\n';
  }
  std::string root_;
};

TEST_F(Quota, IsTheLeastOfAGroupAndThoseAbove) {
  write("cpu.max", "max 100000");
  write("slurm/cpu.max", "300000 100000");
  write("slurm/job/cpu.max", "max 100000");
  write("slurm/job/task/cpu.max", "350000 100000");
  EXPECT_EQ(processor_quota("0::/slurm/job/task\n", root_), 3);
  EXPECT_EQ(processor_quota("0::/slurm\n", root_), 3);
  EXPECT_EQ(processor_quota("0::/\n", root_), 0);
  EXPECT_EQ(processor_quota("0::/elsewhere/deep\n", root_), 0);
  write("slurm/job/task/cpu.max", "50000 100000");
  EXPECT_EQ(processor_quota("0::/slurm/job/task\n", root_), 0.5);
}

TEST_F(Quota, IsReadOfTheFirstVersionToo) {
  write("cpu/batch/cpu.cfs_quota_us", "150000");
  write("cpu/batch/cpu.cfs_period_us", "100000");
  write("cpu/free/cpu.cfs_quota_us", "-1");
  write("cpu/free/cpu.cfs_period_us", "100000");
  EXPECT_EQ(processor_quota("5:memory:/batch\n4:cpu,cpuacct:/batch\n", root_), 1.5);
  EXPECT_EQ(processor_quota("5:memory:/batch\n4:cpu,cpuacct:/free\n", root_), 0);
  EXPECT_EQ(processor_quota("5:memory:/batch\n3:cpuset:/batch\n", root_), 0);
  EXPECT_EQ(processor_quota("nonsense\n", root_), 0);
}

TEST(Processors, AreAtMostThoseOfTheTask) {
  setenv("SLURM_CPUS_PER_TASK", "1", 1);
  EXPECT_EQ(usable_processors(), 1);
  unsetenv("SLURM_CPUS_PER_TASK");
  EXPECT_GE(usable_processors(), 1);
}

}  // namespace
}  // namespace mica::host::processors_test
