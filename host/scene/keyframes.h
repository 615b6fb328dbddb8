#pragma once

#include <vector>

#include "host/scene/description.h"

namespace mica::host {

// What moves, at one frame: linear between its keyframes, still before the first and after the last.
// Directions turn at constant speed, whatever their lengths.

CameraDescription camera_at(const SceneDescription& scene, double frame);

/// All keys of a light are of its own kind.
std::vector<LightDescription> lights_at(const SceneDescription& scene, double frame);

}  // namespace mica::host
