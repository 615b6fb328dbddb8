// Only what is needed: for every job that is shipped, what is built and allocated is what the plan names.
#include "host/render/plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <sstream>
#include <variant>

#include "host/render/built_job.h"
#include "host/render/estimate.h"
#include "host/render/render.h"
#include "host/surface/map_size.h"

namespace mica::host::plan_test {
namespace {

std::vector<std::string> shipped_jobs() {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(MICA_SOURCE_DIR "/data/jobs"))
    if (entry.path().extension() == ".toml") paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// Smaller maps, so that the test is short and that batches are a good part of the memory.
template <typename Kind>
void shrink(Kind* kind) {
  kind->resolution = std::min(kind->resolution, 512);
}
void shrink(ScratchesSurface* scratches) {
  scratches->resolution = std::min(scratches->resolution, 512);
  scratches->length_texels = std::min(scratches->length_texels, 512.0);
}
void shrink(MapFile*) {}
void shrink(LayersSurface* layers) {
  for (SurfaceLayer& layer : layers->layers)
    std::visit([](auto& source) { shrink(&source); }, layer.surface.source);
}

/// The job as it is shipped, but for the sizes of its picture and maps, and without its audit. A picture of
/// glints under lamps stays larger: their batches are padded to some hundred queries.
Job small_job(const std::string& path) {
  Job job = load_job(path, {"image.width=96", "image.height=54", "image.subpixels=2"});
  if (job.surfaces.empty() && job.scene.environments.empty()) job.image.width *= 5, job.image.height *= 5;
  for (SurfaceDescription& surface : job.surfaces)
    std::visit([](auto& source) { shrink(&source); }, surface.source);
  job.audit.samples = 0;
  return job;
}

/// With triangles of its tolerance in place of a method that chooses, of which a plan knows no more than the
/// most.
Job without_choices(Job job) {
  for (MaterialDescription& material : job.scene.materials)
    if (job.methods.get(material.ndf).traits().chooses) material.ndf = "triangles";
  return job;
}

/// A kernel file and its features: options of -D whose value is not 0, and those of the kernel's own choice.
struct Program {
  std::string file;
  std::set<std::string> features;
};
Program parse(const std::string& text) {
  std::istringstream words(text);
  Program program;
  words >> program.file;
  for (std::string word; words >> word;) {
    if (word.rfind("-DMICA_WAVE_ITEMS", 0) == 0 || word.rfind("-cl-std", 0) == 0) continue;
    if (word.size() > 2 && word.substr(word.size() - 2) == "=0") continue;
    program.features.insert(word);
  }
  return program;
}
bool operator==(const Program& a, const Program& b) {
  return a.file == b.file && a.features == b.features;
}

class ShippedJob : public testing::TestWithParam<std::string> {};

/// Structures are known to the byte; batches are planned for a picture that shapes fill to the last pixel,
/// and estimated by those that do.
TEST_P(ShippedJob, BuildsAndTakesWhatItsPlanSays) {
  const Job job = without_choices(small_job(GetParam()));
  const Plan plan = make_plan(job);
  Device device(0);
  const double estimated = static_cast<double>(estimate(job, plan, device).device_bytes);
  std::size_t structures = 0;
  for (const PlannedEvaluator& evaluator : plan.evaluators) structures += evaluator.device_bytes;
  // Light is gathered in many small steps; how many of them a driver has not freed yet is its own affair. It
  // shows where there is no structure to outweigh them, and on a busy machine: the least of up to eight
  // counts.
  const double tolerance = plan.gathers_light && !structures ? 1.0 : 0.1;
  double peak = std::numeric_limits<double>::infinity();
  int counts = 0;
  do {
    device.forget_peak();
    EXPECT_EQ(structures, render(job, plan, device, [](int, int) {}).device_bytes);
    peak = std::min(peak, static_cast<double>(device.peak_bytes()));
  } while (++counts < 8 && std::abs(estimated / peak - 1) > tolerance);
  std::vector<Program> planned;
  for (const PlannedEvaluator& evaluator : plan.evaluators) {
    std::istringstream kernels(evaluator.kernel);
    for (std::string kernel; std::getline(kernels, kernel, ',');) planned.push_back(parse(kernel));
  }
  for (const std::string& name : device.programs())
    EXPECT_NE(std::find(planned.begin(), planned.end(), parse(name)), planned.end())
        << name << " was compiled, but the plan says:\n"
        << describe(plan);
  EXPECT_LE(device.programs().size(), planned.size());
  EXPECT_NEAR(estimated / peak, 1, tolerance) << estimated << " estimated, " << peak << " taken";
  EXPECT_LE(peak, static_cast<double>(plan.device_bytes));

  std::set<std::string> used;
  for (const ShapeDescription& shape : job.scene.shapes) {
    used.insert(shape.material);
    for (const PartMaterial& part : shape.parts) used.insert(part.material);
  }
  for (const PlannedEvaluator& evaluator : plan.evaluators)
    for (const std::string& material : evaluator.materials) EXPECT_TRUE(used.count(material)) << material;
}

/// A method that chooses takes no more than the plan says, whatever it chooses.
TEST_P(ShippedJob, TakesAtMostWhatItsPlanSays) {
  const Job job = small_job(GetParam());
  const Plan plan = make_plan(job);
  Device device(0);
  std::size_t structures = 0;
  for (const PlannedEvaluator& evaluator : plan.evaluators) structures += evaluator.device_bytes;
  EXPECT_LE(render(job, plan, device, [](int, int) {}).device_bytes, structures);
  EXPECT_LE(device.peak_bytes(), plan.device_bytes);
}

/// The sizes that the other tests do not try.
TEST_P(ShippedJob, TakesTheStructuresThatItsPlanSaysAtFullSize) {
  const Job job =
      without_choices(load_job(GetParam(), {"image.width=8", "image.height=4", "image.subpixels=1"}));
  const Plan plan = make_plan(job);
  Device device(0);
  const BuiltJob built(job, plan, device);
  std::size_t structures = 0, surfaces = 0, normals = 0;
  for (const PlannedEvaluator& evaluator : plan.evaluators)
    structures += evaluator.device_bytes, surfaces += evaluator.host_bytes;
  for (const Surface* surface : built.surfaces())
    if (surface) normals += surface->normals().size() * sizeof(Eigen::Vector2d);
  EXPECT_NEAR(static_cast<double>(structures), static_cast<double>(built.device_bytes()),
              0.1 * static_cast<double>(built.device_bytes()));
  EXPECT_EQ(surfaces, normals);
}

INSTANTIATE_TEST_SUITE_P(All, ShippedJob, testing::ValuesIn(shipped_jobs()),
                         [](const auto& info) { return std::filesystem::path(info.param).stem().string(); });

}  // namespace
}  // namespace mica::host::plan_test
