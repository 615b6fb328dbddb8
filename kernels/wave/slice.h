// Gaussian lobes as a query slices them: the last step of a mixture's sum, sixteen lobes at a time.
//
// A lobe is a long chain of dependent steps, longer than a processor looks ahead. So the sums of the mixtures
// have three leaves under way at a time, each at its own step: one is loaded, the one before is sliced, and
// the one before that is added.
#ifndef MICA_SLICE_H
#define MICA_SLICE_H

#include "wave/gaussian.h"
#include "wave/wave.h"

// exp(-(q_position + form / det) / 2) / sqrt(det), but for EXP2_SCALE^2, which both terms of the exponent
// have in them.
typedef struct {
  wave_float q_position, form, det;
} slice_wave;

// The whitened place, or its q_position, of lobes that are not there: they add nothing.
#define NOWHERE 1e6f

static inline wave_float slice_density(private const slice_wave* slice) {
  const wave_float inverse_root = wave_rsqrt(slice->det);
  const wave_float exponent = fma(-slice->form * inverse_root, inverse_root, -slice->q_position);
  return inverse_root * gaussian_exp2(max(exponent, -126.0f));
}

#endif  // MICA_SLICE_H
