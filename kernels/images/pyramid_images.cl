// `pyramid`, for many half vectors a footprint: images of P-NDFs, element by element. What an element is,
// says pyramid.cl. One wave a band of an image.

#include "images/splat.h"

typedef splat_target record_results;
#define RECORD_TAKE(query, record, place, target, scratch) take_record(query, record, place, target, scratch)

static inline void take_record(global const mica_pyramid_query* query, global const short* record,
                               group_place place, private const splat_target* target,
                               WAVE_SHARED int* scratch) {
  const element_lobes lobes = slice_record(query, 0, 0, record, place);
  splat(*target, &lobes, 1.0f / query->map.inverse_roughness, query->map.cutoff, query->map.scale, scratch);
}

#include "pyramid/walk_records.h"

// Images of the queries' footprints. Global size: bands of all images (vectors), or 16 a band (items).
WAVE_KERNEL void pyramid_images(global const mica_pyramid_query* restrict queries, int band_count,
                                mica_image_window window, mica_map_grid level,
                                global const int* restrict groups, global const short* restrict top_nodes,
                                global const short* restrict nodes, global const short* restrict records,
                                global float* restrict images) {
  WAVE_DECLARE_SCRATCH(scratch);
  WAVE_SHARED float lobe_records[SPLAT_RECORDS];
  if (WAVE_ITEM_INDEX >= band_count) return;
  splat_target target = band_of(images, window, WAVE_ITEM_INDEX, lobe_records);
  clear_band(target);
  walk_records(queries + image_of_band(window, WAVE_ITEM_INDEX), half_vectors_of(target), level, groups,
               top_nodes, nodes, records, &target, scratch);
}
