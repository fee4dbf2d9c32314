; As `hypedc fmt` does: four spaces per open block, parenthesis and inline map.

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
  (parenthesized)
  (call)
  (actuals)
  (formals)
] @indent.begin @indent

["}" ")"] @indent.branch @indent.end @outdent

(map_text "\"" @indent.branch .)

(ERROR "{") @indent.begin

[(comment) (doc_comment)] @indent.auto
