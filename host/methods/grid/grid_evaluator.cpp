#include "host/methods/grid/grid_evaluator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

#include "host/device/launch.h"
#include "host/reference/glint_grid.h"
#include "mica/error.h"

namespace mica::host {

std::string grid_kernel_options(Distribution distribution, const GridFeatures& features) {
  return fmt::format("-DMICA_DISTRIBUTION={} -DMICA_GLINT_COLORS={} -DMICA_GLINT_ROULETTE={}",
                     distribution == Distribution::beckmann ? 0 : 1, features.colors,
                     features.roulette ? 1 : 0);
}

std::size_t replace_what_is_not_finite(const std::vector<Query>& queries,
                                       const std::vector<GlintPoint>& points,
                                       std::vector<std::vector<float>>* rows) {
  std::size_t count = 0;
  for (std::size_t n = 0; n < queries.size(); ++n) {
    if (std::all_of(rows->begin(), rows->end(), [n](const auto& row) { return std::isfinite(row[n]); }))
      continue;
    const reference::GlintProcess process(points.size() == 1 ? points.front() : points[n]);
    const std::vector<double> exact = process.densities_of(queries[n], static_cast<int>(rows->size()));
    for (std::size_t color = 0; color < rows->size(); ++color)
      (*rows)[color][n] = static_cast<float>(exact[color]);
    ++count;
  }
  return count;
}

/// Queries on the device and the memory that it reads and writes meanwhile.
class PendingGrid : public PendingDensities {
 public:
  PendingGrid(const std::vector<Query>& asked, const std::vector<GlintPoint>& there, int colors)
      : queries(asked), points(there), rows(static_cast<std::size_t>(colors)) {
    for (std::vector<float>& row : rows) row.resize(queries.size());
    const auto is_plain = [](const Query& query) { return !has_first_order(query); };
    plain = static_cast<std::size_t>(std::count_if(queries.begin(), queries.end(), is_plain));
    if (plain > 0 && plain < queries.size()) put_turned_ones_last();
    for (std::size_t n = 0; n < plain; ++n)
      if (queries[n].lobe_cov) queries[n] = with_scalar_roughness(queries[n]);
  }
  ~PendingGrid() override {
    for (const cl::Event& event : done) clWaitForEvents(1, &event());
  }

  std::vector<float> wait() override {
    reporting("evaluating grid", [&] {
      if (!done.empty()) cl::Event::waitForEvents(done);
      for (const cl::Event& kernel : kernels) *device_seconds += seconds_of(kernel);
    });
    *replaced += replace_what_is_not_finite(queries, points, &rows);
    for (std::vector<float>& row : rows)
      for (float& density : row) density = std::max(density, 0.0f);
    put_back();
    if (rows.size() == 1) return rows.front();
    std::vector<float> densities = rows.front();
    for (std::size_t color = 1; color < rows.size(); ++color)
      for (std::size_t n = 0; n < densities.size(); ++n) densities[n] += rows[color][n];
    return densities;
  }
  float density_of_color(std::size_t color, std::size_t query) const override { return rows[color][query]; }

  std::vector<Query> queries;
  std::vector<GlintPoint> points;
  std::size_t plain = 0;  // so many queries come first whose half vector is constant and whose lobe is round
  std::deque<GridBatch> batches;  // a deque: what the device reads stays where it is
  std::vector<std::vector<float>> rows;
  std::vector<cl::Buffer> buffers;  // kept, so that memory does not depend on who is faster, host or device
  std::vector<cl::Event> kernels, done;
  std::shared_ptr<double> device_seconds;
  std::shared_ptr<std::size_t> replaced;

 private:
  void put_turned_ones_last() {
    const std::vector<Query> asked = queries;
    const std::vector<GlintPoint> there = points;
    places_.resize(asked.size());
    std::iota(places_.begin(), places_.end(), std::size_t{0});
    std::stable_partition(places_.begin(), places_.end(),
                          [&](std::size_t n) { return !has_first_order(asked[n]); });
    std::transform(places_.begin(), places_.end(), queries.begin(), [&](std::size_t n) { return asked[n]; });
    if (there.size() > 1)
      std::transform(places_.begin(), places_.end(), points.begin(), [&](std::size_t n) { return there[n]; });
  }
  void put_back() {
    if (places_.empty()) return;
    for (std::vector<float>& row : rows) {
      const std::vector<float> answers = row;
      for (std::size_t n = 0; n < row.size(); ++n) row[places_[n]] = answers[n];
    }
  }

  std::vector<std::size_t> places_;  // where queries stood, if not as they do now
};

GridEvaluator::GridEvaluator(Device& device, const GlintGrid& grid, std::optional<WaveForm> wave_form,
                             std::size_t batch_queries, GridFeatures features)
    : device_(device), grid_(grid), features_(features), wave_form_(wave_form.value_or(device.wave_form())) {
  const std::string problem = glint_grid_problem(grid);
  if (!problem.empty()) throw UsageError("glints: " + problem);
  const std::size_t fits =
      device.info().allocation_bytes / (device_types::MICA_GLINT_TURNED_FIELDS * sizeof(std::int32_t));
  batch_queries_ = std::clamp<std::size_t>(batch_queries, 1, fits - device_types::MICA_GLINT_PADDING);
  kernel_ =
      device.kernel("grid/grid.cl", "grid", grid_kernel_options(grid.distribution, features), wave_form_);
}

std::unique_ptr<PendingDensities> GridEvaluator::start(const std::vector<Query>& queries) {
  return start_at(queries, {grid_.point()});
}

std::unique_ptr<PendingDensities> GridEvaluator::start_at(const std::vector<Query>& queries,
                                                          const std::vector<GlintPoint>& points) {
  auto pending = std::make_unique<PendingGrid>(queries, points, features_.colors);
  pending->device_seconds = device_seconds_;
  pending->replaced = replaced_;
  enqueue(&kernel_, 0, pending->plain, pending.get());
  if (pending->plain == queries.size()) return pending;
  if (!turned_)
    turned_ = device_.kernel("grid/grid.cl", "grid",
                             grid_kernel_options(grid_.distribution, features_) + " -DMICA_FIRST_ORDER=1",
                             wave_form_);
  enqueue(&*turned_, pending->plain, queries.size(), pending.get());
  return pending;
}

void GridEvaluator::enqueue(cl::Kernel* kernel, std::size_t begin, std::size_t end, PendingGrid* pending) {
  for (std::size_t first = begin; first < end; first += batch_queries_) {
    const std::size_t count = std::min(batch_queries_, end - first);
    const bool turned = begin >= pending->plain;
    enqueue_batch(kernel, to_grid_batch(pending->queries, first, count, pending->points, turned), first,
                  count, pending);
  }
}

void GridEvaluator::enqueue_batch(cl::Kernel* kernel, GridBatch batch, std::size_t first, std::size_t count,
                                  PendingGrid* pending) {
  pending->batches.push_back(std::move(batch));
  const GridBatch& kept = pending->batches.back();
  const std::size_t bytes = kept.fields.size() * sizeof(std::int32_t);
  const cl::Buffer fields = device_.buffer(bytes, CL_MEM_READ_ONLY, "a batch of queries");
  const std::size_t row_bytes = kept.pitch * sizeof(float);
  const cl::Buffer densities =
      device_.buffer(row_bytes * pending->rows.size(), CL_MEM_WRITE_ONLY, "a batch of densities");
  reporting("running grid", [&] {
    device_.queue().enqueueWriteBuffer(fields, CL_FALSE, 0, bytes, kept.fields.data());
    const cl::Event kernel_done = launch(device_, *kernel, launch_size(wave_form_, kept.pitch / kWaveLanes),
                                         fields, static_cast<cl_int>(kept.pitch), densities);
    pending->buffers.insert(pending->buffers.end(), {fields, densities});
    pending->kernels.push_back(kernel_done);
    for (std::size_t color = 0; color < pending->rows.size(); ++color) {
      device_.queue().enqueueReadBuffer(densities, CL_FALSE, color * row_bytes, count * sizeof(float),
                                        pending->rows[color].data() + first, nullptr,
                                        &pending->done.emplace_back());
    }
    device_.queue().flush();
  });
}

}  // namespace mica::host
