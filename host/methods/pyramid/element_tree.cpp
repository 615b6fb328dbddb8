#include "host/methods/pyramid/element_tree.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "host/methods/map/normal_box.h"

namespace mica::host {
namespace {

using namespace device_types;

constexpr std::size_t kChildren = 16;

struct Element {
  double weight;
  Eigen::Vector4d mean;  ///< position from the group's corner
  Eigen::Matrix4d covariance;
};
using Elements = std::vector<Element>;

/// Least and largest of some elements' means.
struct MeanBox {
  Eigen::Vector4d low, high;

  MeanBox(const Element* first, std::size_t count) : low(first->mean), high(first->mean) {
    for (std::size_t n = 1; n < count; ++n) {
      low = low.cwiseMin(first[n].mean);
      high = high.cwiseMax(first[n].mean);
    }
  }
  Eigen::Vector4d middle() const { return 0.5 * (low + high); }
  Eigen::Vector4d reach() const { return 0.5 * (high - low); }
};

std::size_t round_up(std::size_t n, std::size_t multiple) {
  return (n + multiple - 1) / multiple * multiple;
}

/// Sorts so that runs of 16, of 256 and of 4096 are compact: halves along the axis of the largest extent,
/// measured in blocks and cells, until a run is left.
class CompactOrder {
 public:
  CompactOrder(Elements* elements, const GroupShape& group)
      : elements_(*elements),
        unit_(group.block_texels, group.block_texels, group.cell_width, group.cell_width) {
    sort(0, elements_.size());
  }

 private:
  void sort(std::size_t first, std::size_t last) {
    const std::size_t count = last - first;
    if (count <= kChildren) return;
    std::size_t run = kChildren;
    while (run * kChildren < count) run *= kChildren;
    split_at(first, first + round_up((count + 1) / 2, run), last);
  }
  void split_at(std::size_t first, std::size_t middle, std::size_t last) {
    const int axis = longest_axis(first, last);
    const auto begin = elements_.begin();
    std::nth_element(begin + static_cast<long>(first), begin + static_cast<long>(middle),
                     begin + static_cast<long>(last),
                     [axis](const Element& a, const Element& b) { return a.mean[axis] < b.mean[axis]; });
    sort(first, middle);
    sort(middle, last);
  }
  int longest_axis(std::size_t first, std::size_t last) const {
    int axis = 0;
    MeanBox(&elements_[first], last - first).reach().cwiseQuotient(unit_).maxCoeff(&axis);
    return axis;
  }

  Elements& elements_;
  Eigen::Vector4d unit_;
};

std::int16_t to_short(double value) {
  return static_cast<std::int16_t>(std::clamp<long>(std::lround(value), -MICA_BOUND_ONE, MICA_BOUND_ONE));
}

/// Larger eigenvalue of a symmetric 2x2 matrix.
double largest_eigenvalue(const Eigen::Matrix2d& m) {
  return 0.5 * (m(0, 0) + m(1, 1)) + std::hypot(0.5 * (m(0, 0) - m(1, 1)), m(0, 1));
}

Eigen::Matrix2d inverse_root(const Eigen::Matrix2d& m) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>().computeDirect(m).operatorInverseSqrt();
}

/// Variances of position and of normal, so that an element's joint covariance is at most that of both as if
/// they did not depend on each other: its two diagonal blocks times 1 + rho, rho the largest correlation of a
/// position with a normal. Rounding is kept out by blocks that are a little larger.
struct SeparateVariances {
  double position, normal;

  explicit SeparateVariances(const Eigen::Matrix4d& covariance) {
    constexpr double slack = 1e-3, least = 1e-12;
    const auto widened = [](const Eigen::Matrix2d& block) -> Eigen::Matrix2d {
      return block + (slack * largest_eigenvalue(block) + least) * Eigen::Matrix2d::Identity();
    };
    const Eigen::Matrix2d p = widened(covariance.topLeftCorner<2, 2>()),
                          n = widened(covariance.bottomRightCorner<2, 2>());
    const Eigen::Matrix2d correlations =
        inverse_root(n) * covariance.bottomLeftCorner<2, 2>() * inverse_root(p);
    const double rho = std::sqrt(largest_eigenvalue(correlations * correlations.transpose()));
    position = (1 + std::min(rho, 1.0)) * largest_eigenvalue(p);
    normal = (1 + std::min(rho, 1.0)) * largest_eigenvalue(n);
  }
};

template <typename Word>
void put(Word word, int place, std::int16_t* record) {
  static_assert(sizeof word == 2 * sizeof *record);
  std::memcpy(record + 2 * place, &word, sizeof word);
}

/// A part of the least that a query adds to an element's covariance before it divides by it: its footprint,
/// and its lobe. Written covariances may be that much short of positive semidefinite.
struct CovarianceMargins {
  double position, normal;  ///< variances

  explicit CovarianceMargins(const GroupShape& group) {
    // Footprints of sigma >= block / sqrt(8) and roughnesses >= cell / 2 read a level; half of that.
    position = group.block_texels * group.block_texels / 16;
    normal = group.cell_width * group.cell_width / 8;
  }
  bool hold(const Eigen::Matrix4d& covariance) const {
    const Eigen::Vector4d scale =
        Eigen::Vector4d(position, position, normal, normal).cwiseSqrt().cwiseInverse();
    const Eigen::Matrix4d widened =
        scale.asDiagonal() * covariance * scale.asDiagonal() + Eigen::Matrix4d::Identity();
    return widened.llt().info() == Eigen::Success;
  }
};

/// Writes up to sixteen elements; missing ones get no weight.
/// @tparam Number std::int16_t or std::int8_t, which the fields are of.
template <typename Number>
class RecordWriter {
 public:
  RecordWriter(const Element* first, std::size_t count, const CovarianceMargins& margins,
               std::int16_t* record)
      : first_(first), count_(count), margins_(margins), record_(record), means_(first, count) {}

  void write() {
    write_means();
    write_weights();
    const double p_unit = put_unit(largest_covariance<0, 0>(), MICA_RECORD_POSITION_UNIT),
                 n_unit = put_unit(largest_covariance<2, 2>(), MICA_RECORD_NORMAL_UNIT),
                 k_unit = put_unit(largest_covariance<2, 0>(), MICA_RECORD_CROSS_UNIT);
    for (std::size_t n = 0; n < count_; ++n) {
      // Beside much wider ones, what rounding leaves of an element may be no covariance. Its axes then give
      // way, and at last are those of the coordinates.
      for (const double correlated : {1.0, 0.75, 0.5, 0.25, 0.0}) {
        Eigen::Matrix4d covariance = correlated * first_[n].covariance;
        covariance.diagonal() = first_[n].covariance.diagonal();
        if (margins_.hold(write_covariance(n, covariance, p_unit, k_unit, n_unit))) break;
      }
    }
  }

 private:
  static constexpr bool kShort = sizeof(Number) == 2;
  static constexpr int kOne = kShort ? MICA_RECORD_ONE_16 : MICA_RECORD_ONE_8;

  void write_means() {
    const Eigen::Vector4d middle = means_.middle(), reach = means_.reach();
    // Normals in fixed point, so that the difference from a half vector is exact.
    const auto origin_s = static_cast<std::int32_t>(std::lround(middle[2] * MICA_NORMAL_ONE));
    const auto origin_t = static_cast<std::int32_t>(std::lround(middle[3] * MICA_NORMAL_ONE));
    const auto origin_x = static_cast<float>(middle[0]), origin_y = static_cast<float>(middle[1]);
    put(origin_s, MICA_RECORD_ORIGIN_S, record_);
    put(origin_t, MICA_RECORD_ORIGIN_T, record_);
    put(origin_x, MICA_RECORD_ORIGIN_X, record_);
    put(origin_y, MICA_RECORD_ORIGIN_Y, record_);
    const double least = 1.0 / MICA_NORMAL_ONE;
    const double normal_unit = put_unit(reach.tail<2>().maxCoeff() + least, MICA_RECORD_MEAN_UNIT),
                 place_unit = put_unit(reach.head<2>().maxCoeff() + least, MICA_RECORD_PLACE_UNIT);
    for (std::size_t n = 0; n < count_; ++n) {
      const Eigen::Vector4d& mean = first_[n].mean;
      field(MICA_ELEMENT_X, n, (mean[0] - origin_x) / place_unit);
      field(MICA_ELEMENT_Y, n, (mean[1] - origin_y) / place_unit);
      field(MICA_ELEMENT_S, n, (mean[2] - static_cast<double>(origin_s) / MICA_NORMAL_ONE) / normal_unit);
      field(MICA_ELEMENT_T, n, (mean[3] - static_cast<double>(origin_t) / MICA_NORMAL_ONE) / normal_unit);
    }
  }

  /// What rounding takes from an element the next one gets, so that small ones do not vanish.
  void write_weights() {
    double largest = 0, left = 0;
    for (std::size_t n = 0; n < count_; ++n) largest = std::max(largest, first_[n].weight);
    const double unit = put_unit(largest, MICA_RECORD_WEIGHT_UNIT);
    for (std::size_t n = 0; n < count_; ++n) {
      left += first_[n].weight / unit;
      left -= field(MICA_ELEMENT_WEIGHT, n, left);
    }
  }

  /// The covariance as it is written.
  Eigen::Matrix4d write_covariance(std::size_t n, const Eigen::Matrix4d& covariance, double p_unit,
                                   double k_unit, double n_unit) {
    Eigen::Matrix4d written;
    const auto write = [&](int index, int row, int column, double unit) {
      written(row, column) = written(column, row) = unit * field(index, n, covariance(row, column) / unit);
    };
    write(MICA_ELEMENT_XX, 0, 0, p_unit);
    write(MICA_ELEMENT_XY, 0, 1, p_unit);
    write(MICA_ELEMENT_YY, 1, 1, p_unit);
    write(MICA_ELEMENT_SX, 2, 0, k_unit);
    write(MICA_ELEMENT_SY, 2, 1, k_unit);
    write(MICA_ELEMENT_TX, 3, 0, k_unit);
    write(MICA_ELEMENT_TY, 3, 1, k_unit);
    write(MICA_ELEMENT_SS, 2, 2, n_unit);
    write(MICA_ELEMENT_ST, 2, 3, n_unit);
    write(MICA_ELEMENT_TT, 3, 3, n_unit);
    return written;
  }

  template <int row, int column>
  double largest_covariance() const {
    double largest = 0;
    for (std::size_t n = 0; n < count_; ++n)
      largest =
          std::max(largest, first_[n].covariance.template block<2, 2>(row, column).cwiseAbs().maxCoeff());
    return largest;
  }
  /// The number as it is written.
  double field(int index, std::size_t n, double value) {
    const auto number = static_cast<Number>(std::clamp<long>(std::lround(value), -kOne, kOne));
    auto* const fields =
        reinterpret_cast<Number*>(record_ + (kShort ? MICA_RECORD_FIELDS_16 : MICA_RECORD_FIELDS_8));
    fields[kChildren * index + n] = number;
    return number;
  }
  /// The unit as the kernel will read it.
  double put_unit(double largest_value, int place) {
    const auto unit = static_cast<float>(std::max(largest_value, 1e-30) / kOne);
    put(unit, place, record_);
    return unit;
  }

  const Element* first_;
  std::size_t count_;
  const CovarianceMargins& margins_;
  std::int16_t* record_;
  MeanBox means_;
};

/// What a node says of one child.
struct ElementBound {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e300), high = Eigen::Vector2d::Constant(-1e300);
  NormalBox normals;
  double variance_position = 0, variance_normal = 0;

  void add(const Element& e) {
    low = low.cwiseMin(e.mean.head<2>());
    high = high.cwiseMax(e.mean.head<2>());
    normals.add(std::lround(e.mean[2] * MICA_NORMAL_ONE), std::lround(e.mean[3] * MICA_NORMAL_ONE));
    const SeparateVariances variances(e.covariance);
    variance_position = std::max(variance_position, variances.position);
    variance_normal = std::max(variance_normal, variances.normal);
  }
  void add(const ElementBound& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
    normals.add(other.normals);
    variance_position = std::max(variance_position, other.variance_position);
    variance_normal = std::max(variance_normal, other.variance_normal);
  }
};

/// Rounded outwards.
void store(const ElementBound& bound, double group_size, std::size_t child, std::int16_t* node) {
  const double to_unit = MICA_BOUND_ONE / group_size;
  for (const int axis : {0, 1}) {
    const double low = std::floor(bound.low[axis] * to_unit), high = std::ceil(bound.high[axis] * to_unit);
    node[child + 32 * axis] = to_short(std::floor(0.5 * (low + high)));
    node[child + 32 * axis + 16] = to_short(std::ceil(0.5 * (high - low)) + 1);
  }
  store(bound.normals, static_cast<int>(child), node + 64);
}

/// Nodes over `children`, sixteen each.
std::vector<ElementBound> add_nodes(const std::vector<ElementBound>& children, double group_size,
                                    std::vector<std::int16_t>* nodes) {
  std::vector<ElementBound> bounds;
  for (std::size_t first = 0; first < children.size(); first += kChildren) {
    nodes->resize(nodes->size() + MICA_PYRAMID_NODE_STRIDE);
    std::int16_t* node = nodes->data() + nodes->size() - MICA_PYRAMID_NODE_STRIDE;
    ElementBound all;
    const std::size_t end = std::min(first + kChildren, children.size());
    for (std::size_t child = first; child < end; ++child) all.add(children[child]);
    const auto unit_of = [](double variance) { return static_cast<float>(variance / (MICA_BOUND_ONE - 1)); };
    const float unit_p = unit_of(all.variance_position), unit_n = unit_of(all.variance_normal);
    for (std::size_t child = 0; child < kChildren; ++child) {
      if (first + child < end) {
        const ElementBound& bound = children[first + child];
        store(bound, group_size, child, node);
        node[128 + child] = to_short(std::ceil(bound.variance_position / unit_p));
        node[144 + child] = to_short(std::ceil(bound.variance_normal / unit_n));
      } else {
        store(NormalBox{}, static_cast<int>(child), node + 64);
      }
    }
    put(static_cast<std::int32_t>(first), MICA_PYRAMID_NODE_CHILD, node);
    put(unit_p, MICA_PYRAMID_NODE_UNIT_P, node);
    put(unit_n, MICA_PYRAMID_NODE_UNIT_N, node);
    bounds.push_back(all);
  }
  return bounds;
}

}  // namespace

int record_stride(int record_bits) {
  return record_bits == 16 ? MICA_RECORD_STRIDE_16 : MICA_RECORD_STRIDE_8;
}

ElementTree build_element_tree(const GroupShape& group, const std::vector<CellMoments>& parts) {
  Elements elements;
  elements.reserve(parts.size());
  for (const CellMoments& part : parts) {
    if (!(part.moments.weight > 0)) continue;
    Element element{part.moments.weight, part.moments.mean(), part.moments.covariance()};
    element.mean.head<2>() -= group.corner_texels;
    elements.push_back(element);
  }
  CompactOrder(&elements, group);
  const CovarianceMargins margins(group);
  ElementTree tree;
  tree.elements = elements.size();
  std::vector<ElementBound> bounds;
  for (std::size_t first = 0; first < elements.size(); first += kChildren) {
    const std::size_t count = std::min(kChildren, elements.size() - first);
    const std::size_t at = tree.records.size();
    tree.records.resize(at + record_stride(group.record_bits));
    if (group.record_bits == 16)
      RecordWriter<std::int16_t>(&elements[first], count, margins, &tree.records[at]).write();
    else
      RecordWriter<std::int8_t>(&elements[first], count, margins, &tree.records[at]).write();
    ElementBound bound;
    for (std::size_t n = first; n < first + count; ++n) bound.add(elements[n]);
    tree.largest_variance = std::max(tree.largest_variance, bound.variance_position);
    bounds.push_back(bound);
  }
  bounds = add_nodes(bounds, group.size_texels, &tree.nodes);
  add_nodes(bounds, group.size_texels, &tree.top_nodes);
  return tree;
}

}  // namespace mica::host
