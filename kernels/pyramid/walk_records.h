// Included by a kernel of `pyramid`: the way from the groups under a footprint down to the records that
// matter to it. The kernel says what to do with one:
//   record_results, RECORD_TAKE(query, record, place, results, scratch)   what a record adds to.
#ifndef MICA_WALK_RECORDS_H
#define MICA_WALK_RECORDS_H

#include "pyramid/pyramid_elements.h"

// `level`: the map, and in place of blocks the groups of the level.
static inline void walk_records(global const pyramid_query* query, half_vector_box half_vectors,
                                mica_map_grid level, global const int* groups, global const short* top_nodes,
                                global const short* nodes, global const short* records,
                                private record_results* results, WAVE_SHARED int* scratch) {
  global const mica_map_query* map = &PYRAMID(query)->map;
  const int group_size = PYRAMID(query)->group_size;
  const float position_unit = (float)group_size / MICA_BOUND_ONE;
  // Elements lie up to their pieces' size beyond their group: that is in the extent.
  const float reach_x = map->extent_x, reach_y = map->extent_y;
  const int first_x =
      group_of(map->mean_i + (int)floor(map->mean_x - reach_x), level.width, level.blocks_x, group_size);
  const int last_x =
      group_of(map->mean_i + (int)floor(map->mean_x + reach_x), level.width, level.blocks_x, group_size);
  const int first_y =
      group_of(map->mean_j + (int)floor(map->mean_y - reach_y), level.height, level.blocks_y, group_size);
  const int last_y =
      group_of(map->mean_j + (int)floor(map->mean_y + reach_y), level.height, level.blocks_y, group_size);
  for (int group_y = first_y; group_y <= last_y; ++group_y) {
    for (int group_x = first_x; group_x <= last_x; ++group_x) {
      const group_place place = place_group(map, level, group_size, group_x, group_y);
      for (int top = groups[place.index]; top < groups[place.index + 1]; ++top) {
        global const short* top_node = top_nodes + top * MICA_PYRAMID_NODE_STRIDE;
        uint branches = surviving_records(query, half_vectors, top_node, place, position_unit, scratch);
        for (; branches; branches &= branches - 1) {
          global const short* node =
              nodes + (node_word(top_node, MICA_PYRAMID_NODE_CHILD) + lowest_bit(branches)) *
                          MICA_PYRAMID_NODE_STRIDE;
          uint leaves = surviving_records(query, half_vectors, node, place, position_unit, scratch);
          for (; leaves; leaves &= leaves - 1) {
            const size_t record = node_word(node, MICA_PYRAMID_NODE_CHILD) + lowest_bit(leaves);
            RECORD_TAKE(query, records + record * RECORD_STRIDE, place, results, scratch);
          }
        }
      }
    }
  }
}

#endif  // MICA_WALK_RECORDS_H
