#include "host/reference/block_integrator.h"

#include <algorithm>
#include <cmath>

#include "host/reference/gaussian_triangle.h"

namespace mica::host::reference {

void BlockIntegrator::integrate(int block_i, int block_j, long period_x, long period_y) {
  collect_cells(block_i, block_j, period_x, period_y);
  collect_triangles();
  if (!integral_.found_something()) promise_something();
  triangles_.choose_rules(rules_);

  const double area = 0.5 * map_.cell_texels() * map_.cell_texels();
  for (int t = 0; t < triangles_.count; ++t) {
    if (triangles_.rule[t] < rules_.count()) {
      const double value = area * rules_.rule(triangles_.rule[t]).mean(triangles_.gram_of(t));
      integral_.add(value, value * rules_.tolerance(triangles_.digits[t]));
    } else {
      integrate_triangle(triangles_.vertices_of(t), area, rules_, &integral_);
    }
  }
  integral_.update();
}

/// Whitens the corners of all cells of a block.
void BlockIntegrator::collect_cells(int block_i, int block_j, long period_x, long period_y) {
  constexpr int pitch = CellMap::block_cells + 1;
  const CellMap::Block block = map_.block(block_i, block_j);
  const long first_i = period_x * map_.columns() + block_i * CellMap::block_cells;
  const long first_j = period_y * map_.rows() + block_j * CellMap::block_cells;
  std::array<Eigen::Vector2d, pitch * pitch> positions;
  for (int j = 0; j <= block.rows; ++j) {
    for (int i = 0; i <= block.columns; ++i) {
      positions[j * pitch + i] = frame_.whiten_position(map_.corner_texels(first_i + i, first_j + j));
    }
  }

  cells_.count = block.rows * block.columns;
  for (int corner = 0; corner < 4; ++corner) {
    const int di = corner & 1, dj = corner >> 1;
    auto& components = cells_.corners[corner];
    for (int j = 0, cell = 0; j < block.rows; ++j) {
      for (int i = 0; i < block.columns; ++i, ++cell) {
        const Eigen::Vector2d& position = positions[(j + dj) * pitch + i + di];
        const Eigen::Vector2d normal = frame_.whiten_normal(block.normal(i, j, di, dj), position);
        components[0][cell] = position.x();
        components[1][cell] = position.y();
        components[2][cell] = normal.x();
        components[3][cell] = normal.y();
      }
    }
  }
  cells_.bound();
}

/// Keeps the triangles of the cells that may matter.
void BlockIntegrator::collect_triangles() {
  const double cut = integral_.cut(), cell_area = map_.cell_texels() * map_.cell_texels();
  triangles_.count = 0;
  for (int cell = 0; cell < cells_.count; ++cell) {
    const double nearest = cells_.nearest_squared[cell];
    if (nearest < cut) {
      triangles_.push_cell(cells_, cell, integral_.digits_at(nearest));
    } else {
      integral_.skip(cell_area, nearest);
    }
  }
}

/// The integral has a lower bound before it has a value: shrink a triangle towards its nearest point p by t;
/// it still lies within, and |w| <= |p| + t diameter on it.
void BlockIntegrator::promise_something() {
  const double area = 0.5 * map_.cell_texels() * map_.cell_texels();
  for (int t = 0; t < triangles_.count; ++t) {
    const PlanarTriangle planar = flatten(triangles_.vertices_of(t));
    const double nearest = planar.nearest_squared();
    if (nearest >= RunningIntegral::largest_q) continue;
    const double shrink = 1 / std::max(1.0, planar.diameter() * (1 + std::sqrt(nearest)));
    integral_.promise(shrink * shrink * area * std::exp(-0.5 * (nearest + 3)));
  }
}

}  // namespace mica::host::reference
