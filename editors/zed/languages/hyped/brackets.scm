("{" @open "}" @close)
("(" @open ")" @close)
(map_text "\"" @open "\"" @close)
