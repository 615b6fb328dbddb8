// Records that a wave collects, until there are enough for all lanes.
#ifndef MICA_WAVE_LIST_H
#define MICA_WAVE_LIST_H

#include "wave/wave.h"

// A list of records of several floats, taken off a wave at a time. Field k of record n is records[k *
// WAVE_LIST + n].
#define WAVE_LIST (2 * WAVE_LANES)
typedef struct {
  WAVE_SHARED float* records;
  int count;  // less than a wave between appends
} wave_list;

// Appending the lanes in `bits` is packing every field, then counting once.
static inline void wave_list_pack(wave_list list, int field, uint bits, wave_float value) {
  wave_pack(list.records + field * WAVE_LIST + list.count, bits, value);
}
static inline void wave_list_count(private wave_list* list, uint bits) {
  wave_list_sync();
  list->count += (int)popcount(bits);
}

// A field of the first sixteen records; lanes past the count hold anything.
static inline wave_float wave_list_field(wave_list list, int field) {
  return wave_list_load(list.records + field * WAVE_LIST);
}

// Drops the first sixteen records.
static inline void wave_list_drop(private wave_list* list, int fields) {
  wave_list_sync();
  for (int field = 0; field < fields; ++field) {
    const wave_float rest = wave_list_load(list->records + field * WAVE_LIST + WAVE_LANES);
    wave_list_store(list->records + field * WAVE_LIST, rest);
  }
  wave_list_sync();
  list->count = max(list->count - WAVE_LANES, 0);
}

#endif  // MICA_WAVE_LIST_H
