#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "mica/control.h"
#include "mica/device.h"
#include "mica/method.h"

MICA_BEGIN_NAMESPACE

/// How a G-buffer is read and what a layer of glints over its picture shows: the options of `mica glints`,
/// docs/glints.md.
struct MICA_API GlintSettings {
  std::string camera;                 ///< file of camera and lamps, JSON; empty: the buffer's name with .json
  std::string preset;                 ///< blender5, blender3, mitsuba, arnold or karma; empty: any of them
  std::vector<std::string> channels;  ///< by hand, "ROLE=NAME" each
  bool skips_other_ids = false;       ///< ids that no material has are nothing, and not refused
  std::string filter = "gaussian";    ///< of the picture: gaussian, blackman-harris or box
  double filter_width = 0;            ///< pixels, [0.1, 8]; 0: the filter's own
  int scale = 1;                      ///< pixels of the buffer a pixel of the layer and axis, [1, 16]
  bool per_lamp = false;              ///< besides their sum a layer LAMP.R, G, B for each lamp
  std::vector<std::string> aovs;      ///< D, footprint, error, coverage
  std::vector<std::string> overrides;  ///< of the scene, `key.path=value`
};

/// A layer that was written, and what became of the buffer's pixels.
struct MICA_API GlintLayer {
  std::vector<std::string> channels;  ///< of the file
  std::size_t covered = 0;            ///< pixels with a material
  std::size_t one_sided = 0;          ///< of these at rims and seams
  std::size_t without_footprint = 0;  ///< of these, which show nothing
  std::size_t broken = 0;             ///< pixels with numbers that are none, which show nothing
  std::size_t queries = 0;
  std::vector<std::string> notes;  ///< what was assumed, and what that cost
};

/// Makes a layer of glints over another renderer's picture, and writes it as `path`, an OpenEXR file, whole
/// or not at all. It depends on the files and settings alone, bit for bit. Progress counts rows.
/// @param buffer OpenEXR of 32-bit floats, one sample through each pixel's centre. @param scene a job file
/// with surfaces and materials, each of which has its `id`. Throws UsageError for settings and scenes that
/// make no sense, and for a path that is one of the files that are read; FileError for files that cannot be
/// used, with their place.
MICA_API GlintLayer write_glints(const Device& device, const std::string& buffer, const std::string& scene,
                                 const std::string& path, const GlintSettings& settings = {},
                                 const RunControl& control = {}, const Methods& methods = {});

MICA_END_NAMESPACE
