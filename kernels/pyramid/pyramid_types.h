// What `pyramid` adds to types.h: the storage of its levels and its queries, the same bytes on host and
// device.
#ifndef MICA_PYRAMID_TYPES_H
#define MICA_PYRAMID_TYPES_H

#include "types.h"

#ifndef __cplusplus
#define MICA_INT int
#define MICA_FLOAT float
#else
#define MICA_INT std::int32_t
#define MICA_FLOAT float
namespace mica::host::device_types {
#endif

// Storage of a level. Sixteen elements are a record, sixteen records hang from a node, sixteen nodes from a
// top node; the top nodes of a group, a square of MICA_GROUP_BLOCKS blocks a side, follow each other.
enum {
  MICA_GROUP_BLOCKS = 4,

  // A record: a header of words, then sixteen numbers a field, of 16 bits or, where a map's levels would take
  // too much memory, of 8. Both begin and end where vectors are loaded best.
  MICA_RECORD_FIELDS_16 = 32,
  MICA_RECORD_STRIDE_16 = 272,  // shorts before the first field, and of a record
  MICA_RECORD_FIELDS_8 = 24,
  MICA_RECORD_STRIDE_8 = 144,
  MICA_RECORD_ONE_16 = 32767,
  MICA_RECORD_ONE_8 = 127,    // largest number of a field
  MICA_RECORD_ORIGIN_S = 0,   // int: what mean_s and mean_t count from, fixed point like normals
  MICA_RECORD_ORIGIN_T,       // int
  MICA_RECORD_ORIGIN_X,       // float: what x and y count from, texels from the group's corner
  MICA_RECORD_ORIGIN_Y,       // float
  MICA_RECORD_MEAN_UNIT,      // float: what one of mean_s and mean_t counts
  MICA_RECORD_PLACE_UNIT,     // float: of x and y, texels
  MICA_RECORD_WEIGHT_UNIT,    // float: texels^2
  MICA_RECORD_POSITION_UNIT,  // float: of covariances of position, texels^2
  MICA_RECORD_NORMAL_UNIT,    // float: of covariances of normals
  MICA_RECORD_CROSS_UNIT,     // float: of covariances of position with normal, texels

  // A node: sixteen shorts a bound, x, half width, y, half height (of MICA_BOUND_ONE groups), s_min, s_max,
  // t_min, t_max, and the largest variances of an element's position and of its normal, as if neither told of
  // the other; then words.
  MICA_PYRAMID_NODE_STRIDE = 168,  // shorts
  MICA_PYRAMID_NODE_CHILD = 80,    // words before it; int: index of the first child
  MICA_PYRAMID_NODE_UNIT_P,        // float: of the variances of positions, texels^2
  MICA_PYRAMID_NODE_UNIT_N         // float: of the variances of normals
};

// Fields of a record, after its header.
enum {
  MICA_ELEMENT_WEIGHT,
  MICA_ELEMENT_X,
  MICA_ELEMENT_Y,  // mean position
  MICA_ELEMENT_S,
  MICA_ELEMENT_T,  // mean normal
  MICA_ELEMENT_XX,
  MICA_ELEMENT_XY,
  MICA_ELEMENT_YY,  // covariances
  MICA_ELEMENT_SX,
  MICA_ELEMENT_SY,
  MICA_ELEMENT_TX,
  MICA_ELEMENT_TY,
  MICA_ELEMENT_SS,
  MICA_ELEMENT_ST,
  MICA_ELEMENT_TT
};

// One query in texel units.
typedef struct {
  mica_map_query map;
  MICA_FLOAT cov_xx, cov_xy, cov_yy;  // the footprint's covariance, texels^2
  MICA_FLOAT inverse_minor_variance;  // 1 / its smaller eigenvalue
  MICA_INT group_size;                // texels a side of a group of the level that it reads
} mica_pyramid_query;

// The same with a turned lobe; the map's inverse_roughness is that of the lobe's major axis, for culling.
typedef struct {
  mica_pyramid_query pyramid;
  mica_turned_lobe lobe;
  MICA_FLOAT turn_sx, turn_sy;  // of the half vector a texel, on the disk
  MICA_FLOAT turn_tx, turn_ty;
  MICA_FLOAT spread_turn;  // what an element's variance of position adds to that of its normal, at most: in
                           // squares of the lobe's major axis a texel^2
} mica_turned_pyramid_query;

#ifdef __cplusplus
static_assert(sizeof(mica_turned_pyramid_query) == 136 &&
              offsetof(mica_turned_pyramid_query, spread_turn) == 132);
static_assert(sizeof(mica_pyramid_query) == 84 && offsetof(mica_pyramid_query, group_size) == 80);
}  // namespace mica::host::device_types
#endif

#undef MICA_INT
#undef MICA_FLOAT
#endif  // MICA_PYRAMID_TYPES_H
