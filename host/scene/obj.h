#pragma once

#include <string>

#include "host/scene/mesh.h"

namespace mica {

/// Reads the polygons of a Wavefront OBJ file; groups, materials, lines and points in it are passed over.
///
/// Texture coordinates are required, since they place the normal map. Corners without a normal get that of
/// their face. Polygons must be convex. Throws FileError beginning with `file:line:`, saying what was found
/// and what was expected.
TriangleMesh load_obj(const std::string& path);

}  // namespace mica
