// The slopes under a footprint less those of a half vector that turns over it, blurred by a lobe that need
// not be round.
#ifndef MICA_TURNED_SLOPES_H
#define MICA_TURNED_SLOPES_H

#include "beckmanns/footprint_slopes.h"

// As with_roughness, of a lobe with the covariance (s_xx s_xy; s_xy s_yy) on the disk: the mean of B S B^T,
// B = sqrt(1 + p p) (I + p p^T) at the slope p.
static inline slope_lobe lobe_spread(slope_lobe lobe, float s_xx, float s_xy, float s_yy,
                                     WAVE_SHARED int* scratch) {
  const float3 factor = slope_factor(lobe);
  const wave_float x = hermite_node(WAVE_LANE & 3), y = hermite_node(WAVE_LANE >> 2);
  const wave_float p_x = fma(factor.x, x, lobe.mean_x);
  const wave_float p_y = fma(factor.y, x, fma(factor.z, y, lobe.mean_y));
  const wave_float w = fma(p_x, p_x, fma(p_y, p_y, 1.0f));
  const wave_float weighted = hermite_weight(WAVE_LANE & 3) * hermite_weight(WAVE_LANE >> 2) * w;
  // (I + p p^T) S (I + p p^T) = S + p q^T + q p^T + (p q) p p^T, q = S p.
  const wave_float q_x = fma(s_xx, p_x, s_xy * p_y), q_y = fma(s_xy, p_x, s_yy * p_y);
  const wave_float pq = fma(p_x, q_x, p_y * q_y);
  slope_lobe spread = lobe;
  spread.xx = wave_sum(weighted * fma(p_x, fma(pq, p_x, 2.0f * q_x), s_xx), scratch);
  spread.xy = wave_sum(weighted * fma(p_x, fma(pq, p_y, q_y), fma(q_x, p_y, s_xy)), scratch);
  spread.yy = wave_sum(weighted * fma(p_y, fma(pq, p_y, 2.0f * q_y), s_yy), scratch);
  return spread;
}

static inline slope_lobe turned_slopes(global const mica_turned_smooth_query* query, slope_lobe lobe,
                                       WAVE_SHARED int* scratch) {
  slope_lobe turned = lobe_spread(lobe, query->lobe_xx, query->lobe_xy, query->lobe_yy, scratch);
  const float xx = fma(lobe.x_i, query->cross_xx, lobe.x_j * query->cross_yx);
  const float xy = fma(lobe.x_i, query->cross_xy, lobe.x_j * query->cross_yy);
  const float yx = fma(lobe.y_i, query->cross_xx, lobe.y_j * query->cross_yx);
  const float yy = fma(lobe.y_i, query->cross_xy, lobe.y_j * query->cross_yy);
  turned.xx += max(lobe.xx - 2.0f * xx + query->turn_xx, 0.0f);
  turned.xy += lobe.xy - xy - yx + query->turn_xy;
  turned.yy += max(lobe.yy - 2.0f * yy + query->turn_yy, 0.0f);
  return turned;
}

#endif  // MICA_TURNED_SLOPES_H
