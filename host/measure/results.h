// What a run of `mica bench` found, before it becomes JSON or a page.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/device/device.h"
#include "host/image/image.h"

namespace mica::host::bench {

/// How far densities lie from the oracle's. Errors of single queries are |D - ref| / (ref + peak / 100),
/// where peak is the largest reference.
struct Errors {
  double relative_l2 = 0;  ///< sqrt(sum (D - ref)^2 / sum ref^2)
  double percentile_99 = 0, maximum = 0;
};

/// Queries a second: the median of the repeats, the slowest and the fastest.
struct Speed {
  double median = 0, slowest = 0, fastest = 0;
  std::size_t queries = 0;  ///< queries in a repeat
  int repeats = 0;
};

/// One evaluator with its knobs on one kind of question.
struct Measurement {
  std::string evaluator, label;  ///< "gaussians", "gaussians, 2 a texel"
  std::string knob;              ///< what tells it from the evaluator's other measurements: "2", or empty
  double tolerance = 0;          ///< asked for, relative; 0: what the evaluator keeps by itself
  std::string refused;           ///< why it was not measured, or empty
  Speed speed;
  double over_first = 0;  ///< how much faster than the cell's first that was measured, median over rounds
  Errors errors;
  double build_seconds = 0;
  std::size_t device_bytes = 0;
  double share_of_peak = -1;       ///< multiply-adds counted, over the device's peak; -1: not counted
  double share_of_bandwidth = -1;  ///< least bytes to be moved, over the triad's; -1: not known
};

/// All contenders on the same queries.
struct Cell {
  std::string surface;
  int resolution = 0;  ///< texels a side
  double sigma_texels = 0, roughness = 0;
  std::size_t reference_queries = 0;  ///< that errors were measured on
  std::vector<Measurement> measurements;
};

/// `grid` has no map, and so no cell: its cost and its error against its own definition.
struct GridPoint {
  double cells_a_footprint = 0;  ///< standard deviation of the footprint, in cells
  Speed speed;
  Errors errors;
};

/// A P-NDF over a window of the disk as an evaluator sees it.
struct Thumbnail {
  std::string evaluator, label;
  int side = 0;
  std::vector<float> densities;  ///< side^2, top row first
  double relative_l2 = 0;        ///< against the first thumbnail of its row; 0 for that one
};
struct ThumbnailRow {
  std::string surface;
  double sigma_texels = 0, roughness = 0, window = 0;  ///< half the window's side on the disk
  std::vector<Thumbnail> thumbnails;                   ///< the reference first
};

/// A small rendering and how far it is from the reference picture.
struct Picture {
  std::string evaluator, label;
  Image image;              ///< R, G, B
  double seconds = 0;       ///< that its densities took
  double samples = 0;       ///< a footprint, of brute force; 0 for evaluators
  double relative_mse = 0;  ///< mean of (x - ref)^2 / (ref^2 + 0.01) over pixels and channels
  double delta_e_mean = 0;  ///< CIEDE2000 as displayed
  double delta_e_percentile_95 = 0;
};
/// An evaluator beside brute force that had the same time, and brute force that has the same error.
struct PictureRow {
  Picture evaluator, equal_time, equal_error;
  double equal_error_samples = 0;   ///< a footprint that brute force needs for the evaluator's relative MSE
  double equal_error_seconds = 0;   ///< that they would take
  bool equal_error_capped = false;  ///< the picture shown had fewer samples
};

struct Results {
  std::string suite, started;  ///< "quick"; ISO 8601, UTC
  DeviceInfo device;
  double seconds = 0;                  ///< that the run took
  double fma_peak = 0, bandwidth = 0;  ///< FLOP/s, bytes/s
  std::vector<Cell> cells;             ///< surface x footprint x roughness
  std::vector<Cell> map_sizes;         ///< the same question on maps of several sizes
  std::vector<GridPoint> grid;
  std::vector<ThumbnailRow> thumbnails;
  std::string picture_text;  ///< what the pictures show
  Image reference_picture;
  std::vector<PictureRow> pictures;
};

}  // namespace mica::host::bench
