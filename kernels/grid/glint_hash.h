// The random numbers of the glints: a function of the cell and the seed alone, so that a glint is the same
// for every query, batch, thread and device.
//
// A spatial cell (i, j) of a level, and an angular cell (k, l) of the same, are hashed on their own; their
// sum goes through a 32-bit mixing function whose avalanche is near perfect (two multiplications, three
// xor-shifts; constants of Wellons's "lowbias32"), once for each 32 bits of its place.
// tests/methods/grid/glint_statistics_test.cpp looks at them.
#ifndef MICA_GLINT_HASH_H
#define MICA_GLINT_HASH_H

#include "wave/wave.h"

static inline wave_uint glint_mix(wave_uint x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ (x >> 16);
}

// The key of the spatial cell (i, j); i and j count modulo 2^31.
static inline wave_uint glint_spatial_key(wave_uint i, wave_uint j, wave_uint level, wave_uint seed) {
  const wave_uint row = glint_mix((j & 0x7fffffffu) * 0x9e3779b1u + level * 0x85ebca77u + seed);
  return glint_mix(row + (i & 0x7fffffffu) * 0xc2b2ae3du);
}

// The key of the angular cell (k, l).
static inline wave_uint glint_angular_key(wave_uint k, wave_uint l) {
  return glint_mix(l * 0x27d4eb2fu + k * 0x165667b1u);
}

// Uniform in (0, 1), plus an offset: the lower and the upper 16 bits.
#define GLINT_LOW(bits, offset) fma(wave_uint_to_float((bits)&0xffffu), 1.0f / 65536, (offset) + 0.5f / 65536)
#define GLINT_HIGH(bits, offset) fma(wave_uint_to_float((bits) >> 16), 1.0f / 65536, (offset) + 0.5f / 65536)

// 32 random bits each: a glint's place in its cell, its place on the disk, and the number of its roulette
// (upper 16).
typedef struct {
  wave_uint place, angle, roulette;
} glint_bits;

static inline glint_bits glint_draw(wave_uint spatial_key, wave_uint angular_key) {
  glint_bits result;
  result.place = glint_mix(spatial_key + angular_key);
  result.angle = glint_mix(result.place + 0x9e3779b9u);
  result.roulette = (result.place + result.angle) * 0x2545f495u;
  return result;
}

// 32 more: whether the glint is there (upper 16), and its colour.
static inline wave_uint glint_draw_more(glint_bits bits) {
  return glint_mix(bits.angle + 0x3c6ef372u);
}

#endif  // MICA_GLINT_HASH_H
