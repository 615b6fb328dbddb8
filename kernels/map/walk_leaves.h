// Included by a method's kernel: the way from the blocks under a footprint down to the leaves that matter to
// it, sixteen children at a time. The kernel says what its queries and nodes are, and what to do with a leaf:
//   LEAF_QUERY                the query's struct, with LEAF_PLACE(query) its mica_map_query (default:
//   itself); LEAF_NODE_STRIDE          shorts a node; LEAF_DATA, LEAF_AT(leaf_i, leaf_j)   what leaves are
//   stored as (default: ints), and where in a `block` (default: normals); LEAF_SURVIVORS(query, node, i, j,
//   child_size, scratch)   bits of the children that matter, for one reason in the low half
//                             and for another in the high half: LEAF_TAKE finds them in `reasons`;
//   LEAF_WALK                 the function's name (default: walk_leaves); a kernel that walks in two ways
//   includes this twice; LEAF_RESULTS (default: leaf_results), LEAF_TAKE(query, normals, at, i, j, room_i,
//   room_j, results, scratch)   what a
//                             leaf adds to.
#include "map/map_cull.h"

#ifndef LEAF_WALK
#define LEAF_WALK walk_leaves
#endif
#ifndef LEAF_RESULTS
#define LEAF_RESULTS leaf_results
#endif
#ifndef LEAF_DATA
#define LEAF_DATA int
#endif
#ifndef LEAF_AT
#define LEAF_AT(leaf_i, leaf_j) \
  (block.index * MICA_BLOCK_STRIDE + ((leaf_j) + 1) * MICA_BLOCK_ROW + (leaf_i) + 1)
#endif
#ifndef LEAF_PLACE
#define LEAF_PLACE(query) (query)
#endif

static inline void LEAF_WALK(global const LEAF_QUERY* query, mica_map_grid grid,
                             global const LEAF_DATA* normals, global const short* block_nodes,
                             global const short* tile_nodes, private LEAF_RESULTS* results,
                             WAVE_SHARED int* scratch) {
  global const mica_map_query* place = LEAF_PLACE(query);
  // Quad (i, j) spans [i, i + 1] in the coordinates of the mean.
  const int first_i = (int)floor(place->mean_x - place->extent_x),
            last_i = (int)floor(place->mean_x + place->extent_x);
  const int first_j = (int)floor(place->mean_y - place->extent_y),
            last_j = (int)floor(place->mean_y + place->extent_y);
  const int first_x = block_of(place->mean_i + first_i, grid.width, grid.blocks_x);
  const int last_x = block_of(place->mean_i + last_i, grid.width, grid.blocks_x);
  const int first_y = block_of(place->mean_j + first_j, grid.height, grid.blocks_y);
  const int last_y = block_of(place->mean_j + last_j, grid.height, grid.blocks_y);
  for (int block_y = first_y; block_y <= last_y; ++block_y) {
    const int2 reach = blocks_in_reach(place, grid, block_y, first_x, last_x);
    for (int block_x = reach.x; block_x <= reach.y; ++block_x) {
      const map_block block = locate_block(grid, place, block_x, block_y);
      const int map_room_i = grid.width - (block.index % grid.blocks_x) * MICA_BLOCK;
      const int map_room_j = grid.height - (block.index / grid.blocks_x) * MICA_BLOCK;
      // All tiles before all leaves: a test is a long chain of steps, and they overlap.
      int tiles[16], count = 0;
      uint leaves_of[16];
      const uint tile_reasons = LEAF_SURVIVORS(query, block_nodes + block.index * LEAF_NODE_STRIDE, block.i,
                                               block.j, MICA_TILE, scratch);
      for (uint left = (tile_reasons | tile_reasons >> 16) & 0xffffu; left; left &= left - 1) {
        const int tile = lowest_bit(left);
        tiles[count] = tile;
        leaves_of[count++] = LEAF_SURVIVORS(query, tile_nodes + (block.index * 16 + tile) * LEAF_NODE_STRIDE,
                                            block.i + (tile & 3) * MICA_TILE,
                                            block.j + (tile >> 2) * MICA_TILE, MICA_LEAF, scratch);
      }
      for (int n = 0; n < count; ++n) {
        const int tile = tiles[n], tile_i = (tile & 3) * MICA_TILE, tile_j = (tile >> 2) * MICA_TILE;
        const uint reasons = leaves_of[n];
        for (uint leaves = (reasons | reasons >> 16) & 0xffffu; leaves; leaves &= leaves - 1) {
          const int leaf = lowest_bit(leaves);
          const int leaf_i = tile_i + (leaf & 3) * MICA_LEAF, leaf_j = tile_j + (leaf >> 2) * MICA_LEAF;
          LEAF_TAKE(query, normals, LEAF_AT(leaf_i, leaf_j), block.i + leaf_i, block.j + leaf_j,
                    map_room_i - leaf_i, map_room_j - leaf_j, results, scratch);
        }
      }
    }
  }
}

#undef LEAF_WALK
#undef LEAF_RESULTS
#undef LEAF_SURVIVORS
#undef LEAF_TAKE
