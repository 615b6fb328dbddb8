// Included by pyramid_elements.h: elements whose normals are seen less a half vector that turns with place,
// by a lobe that need not be round. (u, n) -> (u, L (n - H u)) is linear: an element stays a Gaussian.
#ifndef MICA_TURNED_ELEMENTS_H
#define MICA_TURNED_ELEMENTS_H

// Sixteen elements seen from a query: m - c, the covariance of position, the half vector less the mean, and
// the covariances of normals with position and of normals.
typedef struct {
  wave_float x, y, p_xx, p_xy, p_yy;
  wave_float r_s, r_t, k_sx, k_sy, k_tx, k_ty, n_ss, n_st, n_tt;
} element_wave;

// Their normals less the half vector that turns with place, whitened by the lobe.
static inline void turn_elements(global const mica_turned_lobe* l, private element_wave* e) {
  whiten_normals(l, e->x, e->y, &e->r_s, &e->r_t);
  whiten_normals(l, e->p_xx, e->p_xy, &e->k_sx, &e->k_tx);
  whiten_normals(l, e->p_xy, e->p_yy, &e->k_sy, &e->k_ty);
  // L N L' - K' T' - T K'' - T P T', where K' = L K - T P is what K has become and T = L H.
  const wave_float n_1s = fma(l->lobe_1s, e->n_ss, l->lobe_1t * e->n_st),
                   n_1t = fma(l->lobe_1s, e->n_st, l->lobe_1t * e->n_tt);
  const wave_float n_2s = fma(l->lobe_2s, e->n_ss, l->lobe_2t * e->n_st),
                   n_2t = fma(l->lobe_2s, e->n_st, l->lobe_2t * e->n_tt);
  const wave_float p_1x = fma(l->turn_1x, e->p_xx, l->turn_1y * e->p_xy),
                   p_1y = fma(l->turn_1x, e->p_xy, l->turn_1y * e->p_yy);
  const wave_float p_2x = fma(l->turn_2x, e->p_xx, l->turn_2y * e->p_xy),
                   p_2y = fma(l->turn_2x, e->p_xy, l->turn_2y * e->p_yy);
  const wave_float a_1x = fma(2.0f, e->k_sx, p_1x), a_1y = fma(2.0f, e->k_sy, p_1y);
  const wave_float a_2x = fma(2.0f, e->k_tx, p_2x), a_2y = fma(2.0f, e->k_ty, p_2y);
  e->n_ss = fma(l->lobe_1s, n_1s, l->lobe_1t * n_1t) - fma(a_1x, l->turn_1x, a_1y * l->turn_1y);
  e->n_tt = fma(l->lobe_2s, n_2s, l->lobe_2t * n_2t) - fma(a_2x, l->turn_2x, a_2y * l->turn_2y);
  e->n_st = fma(l->lobe_2s, n_1s, l->lobe_2t * n_1t) -
            fma(e->k_sx + p_1x, l->turn_2x, (e->k_sy + p_1y) * l->turn_2y) -
            fma(e->k_tx, l->turn_1x, e->k_ty * l->turn_1y);
}

// `half_s`, `half_t`: fixed point. The half vector's residual is on the disk here, and whitened by
// `turn_elements`.
static inline element_wave load_elements(int half_s, int half_t, global const short* record,
                                         group_place place) {
  global const int* int_header = (global const int*)record;
  global const float* header = (global const float*)record;
  const float one = 1.0f / MICA_NORMAL_ONE;
  const float mean_unit = -header[MICA_RECORD_MEAN_UNIT], place_unit = -header[MICA_RECORD_PLACE_UNIT];
  const float p_unit = header[MICA_RECORD_POSITION_UNIT], k_unit = header[MICA_RECORD_CROSS_UNIT],
              n_unit = header[MICA_RECORD_NORMAL_UNIT];
  element_wave e;
  e.x = fma(ELEMENT_FIELD(record, MICA_ELEMENT_X), place_unit, -(place.x + header[MICA_RECORD_ORIGIN_X]));
  e.y = fma(ELEMENT_FIELD(record, MICA_ELEMENT_Y), place_unit, -(place.y + header[MICA_RECORD_ORIGIN_Y]));
  e.p_xx = p_unit * ELEMENT_FIELD(record, MICA_ELEMENT_XX),
  e.p_xy = p_unit * ELEMENT_FIELD(record, MICA_ELEMENT_XY);
  e.p_yy = p_unit * ELEMENT_FIELD(record, MICA_ELEMENT_YY);
  e.r_s = fma(ELEMENT_FIELD(record, MICA_ELEMENT_S), mean_unit,
              one * (half_s - int_header[MICA_RECORD_ORIGIN_S]));
  e.r_t = fma(ELEMENT_FIELD(record, MICA_ELEMENT_T), mean_unit,
              one * (half_t - int_header[MICA_RECORD_ORIGIN_T]));
  e.k_sx = k_unit * ELEMENT_FIELD(record, MICA_ELEMENT_SX),
  e.k_sy = k_unit * ELEMENT_FIELD(record, MICA_ELEMENT_SY);
  e.k_tx = k_unit * ELEMENT_FIELD(record, MICA_ELEMENT_TX),
  e.k_ty = k_unit * ELEMENT_FIELD(record, MICA_ELEMENT_TY);
  e.n_ss = n_unit * ELEMENT_FIELD(record, MICA_ELEMENT_SS),
  e.n_st = n_unit * ELEMENT_FIELD(record, MICA_ELEMENT_ST);
  e.n_tt = n_unit * ELEMENT_FIELD(record, MICA_ELEMENT_TT);
  return e;
}

static inline element_lobes slice_record(global const pyramid_query* query, int half_s, int half_t,
                                         global const short* record, group_place place) {
  global const float* header = (global const float*)record;
  element_wave e = load_elements(half_s, half_t, record, place);
  turn_elements(&query->lobe, &e);
  const wave_float p_xx = e.p_xx + PYRAMID(query)->cov_xx, p_xy = e.p_xy + PYRAMID(query)->cov_xy,
                   p_yy = e.p_yy + PYRAMID(query)->cov_yy;
  const wave_float root_p = wave_rough_rsqrt(fma(p_xx, p_yy, -(p_xy * p_xy))), inverse_p = root_p * root_p;
  const wave_float a_x = fma(p_yy, e.x, -(p_xy * e.y)), a_y = fma(p_xx, e.y, -(p_xy * e.x));
  const wave_float b_sx = fma(p_yy, e.k_sx, -(p_xy * e.k_sy)), b_sy = fma(p_xx, e.k_sy, -(p_xy * e.k_sx));
  const wave_float b_tx = fma(p_yy, e.k_tx, -(p_xy * e.k_ty)), b_ty = fma(p_xx, e.k_ty, -(p_xy * e.k_tx));
  element_lobes lobes;
  lobes.q_position = inverse_p * fma(e.x, a_x, e.y * a_y);
  lobes.r_s = fma(-inverse_p, fma(e.k_sx, a_x, e.k_sy * a_y), e.r_s);
  lobes.r_t = fma(-inverse_p, fma(e.k_tx, a_x, e.k_ty * a_y), e.r_t);
  // What numbers of few bits leave of a covariance may be a little less than nothing.
  lobes.n_ss = max(fma(-inverse_p, fma(e.k_sx, b_sx, e.k_sy * b_sy), e.n_ss), 0.0f) + 1.0f;
  lobes.n_tt = max(fma(-inverse_p, fma(e.k_tx, b_tx, e.k_ty * b_ty), e.n_tt), 0.0f) + 1.0f;
  lobes.n_st = fma(-inverse_p, fma(e.k_tx, b_sx, e.k_ty * b_sy), e.n_st);
  const wave_float product = lobes.n_ss * lobes.n_tt;
  lobes.root = wave_rough_rsqrt(max(fma(-lobes.n_st, lobes.n_st, product), 0.01f * product));
  lobes.weight =
      ELEMENT_FIELD(record, MICA_ELEMENT_WEIGHT) * header[MICA_RECORD_WEIGHT_UNIT] * root_p * lobes.root;
  return lobes;
}

#endif  // MICA_TURNED_ELEMENTS_H
