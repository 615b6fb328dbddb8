#include "host/render/audit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/reference/oracle.h"

namespace mica::host::audit_test {
namespace {

Query query_at(double u) {
  Query query;
  query.footprint.mean_uv = {u, 0.5};
  query.footprint.cov_uv = Eigen::Matrix2d::Identity() * 1e-3;
  query.roughness = 0.1;
  return query;
}

TEST(AuditSampler, DrawsTheSameSampleInAnyOrder) {
  AuditSampler forwards(7, 20), backwards(7, 20), other_seed(8, 20);
  for (int n = 0; n < 1000; ++n) forwards.offer(n / 4, n % 4, query_at(n), 0, 0);
  for (int n = 999; n >= 0; --n) backwards.offer(n / 4, n % 4, query_at(n), 0, 0);
  for (int n = 0; n < 1000; ++n) other_seed.offer(n / 4, n % 4, query_at(n), 0, 0);
  const auto a = forwards.samples(), b = backwards.samples(), c = other_seed.samples();
  ASSERT_EQ(a.size(), 20u);
  bool differs = false;
  for (std::size_t n = 0; n < a.size(); ++n) {
    EXPECT_EQ(a[n].query.footprint.mean_uv, b[n].query.footprint.mean_uv);
    differs |= a[n].query.footprint.mean_uv != c[n].query.footprint.mean_uv;
  }
  EXPECT_TRUE(differs);
}

// The mean place of 200 samples of 10^5 queries is that of a uniform sample, within 4 standard errors.
TEST(AuditSampler, IsUniformOverTheImage) {
  constexpr int count = 100000, samples = 200;
  AuditSampler sampler(1, samples);
  for (int n = 0; n < count; ++n) sampler.offer(n / 16, n % 16, query_at(n), 0, 0);
  double mean = 0;
  for (const AuditSample& sample : sampler.samples())
    mean += sample.query.footprint.mean_uv.x() / count / samples;
  EXPECT_NEAR(mean, 0.5, 4 * std::sqrt(1.0 / 12 / samples));
}

TEST(Audit, MeasuresAnErrorThatWasPutIn) {
  std::vector<Eigen::Vector2d> normals;
  for (int n = 0; n < 256; ++n) normals.push_back({0.1 * std::sin(0.1 * n), 0.05 * std::cos(0.3 * n)});
  const Surface surface(16, 16, Interpolation::bilinear, normals);
  const reference::Oracle oracle(surface);
  std::vector<AuditSample> samples;
  for (int n = 0; n < 100; ++n) {
    const Query query = query_at(0.01 * n);
    samples.push_back({0, query, static_cast<float>(oracle.evaluate(query).density), 0});
  }
  const AuditResult exact = audit_result(audit(samples, {&surface}));
  EXPECT_LT(exact.relative_l2, 1e-6);
  EXPECT_LT(exact.maximum, 1e-6);
  for (AuditSample& sample : samples) sample.density *= 1.01f;
  const AuditResult wrong = audit_result(audit(samples, {&surface}));
  EXPECT_EQ(wrong.samples, 100u);
  EXPECT_NEAR(wrong.relative_l2, 0.01, 1e-6);
  EXPECT_NEAR(wrong.maximum, 0.01 / 1.01, 2e-4);
}

}  // namespace
}  // namespace mica::host::audit_test
