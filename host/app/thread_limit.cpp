#include "host/app/thread_limit.h"

#include <sys/stat.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "host/base/processors.h"

namespace mica::host::app {

class ThreadLimit::Control {
 public:
  explicit Control(int threads)
      : control_(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads)) {}

 private:
  tbb::global_control control_;
};

ThreadLimit::ThreadLimit() {
  constexpr int unless_set = 0;
  const int threads = usable_processors();
  if (threads < sysconf(_SC_NPROCESSORS_ONLN)) {
    control_ = std::make_unique<Control>(threads);
    const std::string text = std::to_string(threads);
    for (const char* name : {"POCL_MAX_PTHREAD_COUNT", "POCL_CPU_MAX_CU_COUNT"})  // before and from version 4
      setenv(name, text.c_str(), unless_set);
  }
  const char* cache = std::getenv("MICA_CACHE_DIR");
  if (!cache || !*cache) return;
  mkdir(cache, 0700);  // before the driver does, which lets others look in
  setenv("POCL_CACHE_DIR", (std::filesystem::absolute(cache) / "pocl").c_str(), unless_set);
}

ThreadLimit::~ThreadLimit() = default;

}  // namespace mica::host::app
