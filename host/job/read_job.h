#pragma once

#include <string>
#include <vector>

#include "host/job/job.h"
#include "host/job/toml_reader.h"

namespace mica::host {

constexpr Interval kCoordinate = closed(-1e8, 1e8), kExtent = open_low(0, 1e6);

/// The job that `text` describes. @param path names it in messages, and its folder is where file names start.
/// @param max_picture_bytes see PictureChoice.
Job read_job(const std::string& text, const std::string& path, const std::vector<std::string>& overrides,
             const MethodRegistry& methods = MethodRegistry::builtin(), std::uint64_t max_picture_bytes = 0,
             JobUse use = JobUse::picture);

// What each table of a job means. Values that are wrong are reported to the reader's issues, and the results
// then are not to be used.

/// All `[surface.NAME]`.
std::vector<SurfaceDescription> read_surfaces(TableReader& job);

/// All `[material.NAME]`. @param surfaces that they may refer to.
/// @param methods that they may name.
std::vector<MaterialDescription> read_materials(TableReader& job,
                                                const std::vector<SurfaceDescription>& surfaces,
                                                const MethodRegistry& methods);

/// All `[[light]]`, with their keyframes.
void read_lights(TableReader& job, SceneDescription& scene);

/// `[camera]`, `[[shape]]`, `[[light]]`, `[background]` and the materials.
SceneDescription read_scene(TableReader& job, const std::vector<SurfaceDescription>& surfaces,
                            const MethodRegistry& methods);

}  // namespace mica::host
