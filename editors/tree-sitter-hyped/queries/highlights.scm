; Later patterns win over earlier ones.

(identifier) @variable

; ---- declarations

(entity name: (identifier) @type)
(behavior name: (identifier) @function)
(world name: (identifier) @module)
(space name: (identifier) @module)
(constant name: (identifier) @constant)
(formals name: (identifier) @variable.parameter)
(parameter name: (identifier) @variable.parameter)
(continuous name: (identifier) @variable.member)
(discrete name: (identifier) @variable.member)
(reference name: (identifier) @variable.member entity: (identifier) @type)
(buttons name: (identifier) @variable.member)
(axes name: (identifier) @variable.member)
(chance name: (identifier) @variable.member)
(group name: (identifier) @module)
(mode name: (identifier) @label)
(set_domain (identifier) @constant)
(dimension_factor (identifier) @type.builtin)
(tiles name: (identifier) @module)
(condition name: (identifier) @label)
(signal name: (identifier) @variable.member)
(signal_number name: (identifier) @variable.member)
(goal name: (identifier) @label)
(never name: (identifier) @label)

; ---- uses

(edge target: (path (identifier) @label))
(in_mode mode: (path (identifier) @label))
(relation mode: (path (identifier) @label))
(relation entity: (identifier) @type)
(any_instance entity: (identifier) @type)
(spawn entity: (identifier) @type)
(tile_spawn entity: (identifier) @type)
(place entity: (identifier) @type)
(limit entity: (identifier) @type)
(put behavior: (identifier) @function)
(address signal: (identifier) @variable.member)
(all_of (address receiver: (identifier) @type))
(map tiles: (identifier) @module)
(link space: (identifier) @module)
(shape name: (identifier) @function.builtin)
(directions (identifier) @constant)
(actual name: (variable (identifier) @variable.parameter))
(path (identifier) (identifier) @variable.member)

(call function: (identifier) @function.call)
((call function: (identifier) @function.builtin)
  (#any-of? @function.builtin
    "min" "max" "abs" "sign" "clamp" "floor" "ceil" "round" "sqrt" "sin" "cos" "atan2" "mod" "if" "pressed" "held"
    "released" "touching" "timer" "entering" "exiting" "lost" "near" "distance" "inside" "count" "received"))
(timer) @variable.builtin
(self) @variable.builtin

; ---- tags, maps, literals

(tag (identifier) @tag)
(text) @string
(tag (text) @string.special)
(tile_char) @character
(map_text "\"" @string)
(map_row) @string.special
(digits) @number
(color) @constant
(exponent) @number
(unit) @type.builtin
[(true) (false)] @boolean
(none) @constant.builtin
(primes) @operator

(comment) @comment
(doc_comment) @comment.documentation

; ---- keywords: the contextual ones are names elsewhere

["import"] @keyword.import
["entity" "behavior" "world" "space" "tiles"] @keyword.type
[
  "const" "param" "continuous" "discrete" "ref" "button" "axis" "collider" "kinematic" "clamp" "invariant" "group"
  "mode" "envelope" "use" "spawn" "destroy" "initial" "always" "follow" "links" "step" "collide" "limit" "player"
  "condition" "chance" "signal" "look" "send" "goal" "never" "test" "map" "place" "link" "rect" "bounds" "wrap" "int"
] @keyword
(bool_domain) @keyword
[
  "with" "from" "above" "at" "by" "fixed" "directions" "attack" "decay" "sustain" "release" "accel" "over" "to" "for"
  "legend" "tile" "vglc" "tiled" "ldtk" "level" "x" "restore" "after"
  "inputs" "seed" "expect" "reachable" "unreachable" "unfound" "without"
] @keyword
[(instant) (hold) (way) (end)] @keyword
["block" "sense" "keep" "velocity" "carry" "bounce" "slope" "breakable"] @keyword.modifier
["when" "else" "while"] @keyword.conditional
["and" "or" "not" "in" "is" "as" "any" "all" "touching" "nearest" "within"] @keyword.operator

; ---- signs

["=" ":=" "+=" "-=" "->" "==" "!=" "<" "<=" ">" ">=" "+" "-" "*" "/" "^" ".."] @operator
["{" "}" "(" ")"] @punctuation.bracket
["," ":" ";" "."] @punctuation.delimiter
