[
  (block)
  (updates)
  (ramps)
  (world_block)
  (tile_block)
  (kind_block)
  (space_block)
  (settings)
  (set_domain)
  (map_text)
  (comment)+
  (doc_comment)+
] @fold
