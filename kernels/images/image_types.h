// Images of P-NDFs: what host and device share.
#ifndef MICA_IMAGE_TYPES_H
#define MICA_IMAGE_TYPES_H

#include "types.h"

#ifndef __cplusplus
#define MICA_INT int
#define MICA_FLOAT float
#else
#define MICA_INT std::int32_t
#define MICA_FLOAT float
namespace mica::host::device_types {
#endif

// An image is stored as squares of 4x4 pixels, one a wave, row by row from the bottom left; so are the pixels
// in a square.
enum {
  MICA_IMAGE_SQUARE = 4,
  MICA_IMAGE_BAND = 64  // rows of pixels that one wave draws
};

// Half vectors at the centres of an image's pixels, s to the right, t up.
typedef struct {
  MICA_FLOAT left_s, bottom_t;  // at the lower left pixel
  MICA_FLOAT step;              // from pixel to pixel
  MICA_INT pixels, squares;     // a side
} mica_image_window;

#ifdef __cplusplus
static_assert(sizeof(mica_image_window) == 20 && offsetof(mica_image_window, pixels) == 12);
}  // namespace mica::host::device_types
#endif

#undef MICA_INT
#undef MICA_FLOAT
#endif  // MICA_IMAGE_TYPES_H
