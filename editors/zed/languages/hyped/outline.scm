(entity "entity" @context name: (identifier) @name) @item
(behavior "behavior" @context name: (identifier) @name) @item
(world "world" @context name: (identifier) @name) @item
(group "group" @context name: (identifier) @name) @item
(mode "mode" @context name: (identifier) @name) @item
(space "space" @context name: (identifier) @name) @item
(condition "condition" @context name: (identifier) @name) @item
(signal name: (identifier) @name) @item
(goal "goal" @context name: (identifier) @name) @item
(never "never" @context name: (identifier) @name) @item
