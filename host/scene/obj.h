#pragma once

#include <string>

#include "host/scene/mesh.h"

namespace mica::host {

/// Reads the polygons of a Wavefront OBJ file; groups, lines and points in it are passed over. The faces of
/// each material that `usemtl` names are a part of the mesh of that name; those before the first are
/// nameless.
///
/// Texture coordinates are required, since they place the normal map. Corners without a normal get that of
/// their face. Polygons must be convex. Throws FileError beginning with `file:line:`, saying what was found
/// and what was expected.
TriangleMesh load_obj(const std::string& path);

}  // namespace mica::host
