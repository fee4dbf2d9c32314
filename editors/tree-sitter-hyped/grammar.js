/**
 * The tree-sitter grammar of `.hyped`, after `grammar/hyped.pest`; it keeps most rule names.
 *
 * White space is skipped everywhere, including line breaks. A line break that ends a statement is a separate token:
 * `src/scanner.c` emits it where a statement can end and the next line does not continue it. Where a statement cannot
 * end, such as after `param`, a line break is accepted here, but hypedc reports an error. Contextual keywords are names
 * elsewhere: tree-sitter matches them only where the grammar allows them.
 *
 * @file Grammar of `.hyped`: game entities as hybrid automata
 * @license MIT OR Apache-2.0
 */

/// <reference types="tree-sitter-cli/dsl" />
// @ts-check

const PREC = { or: 1, and: 2, not: 3, comparison: 4, sum: 5, product: 6, negative: 7 };

/** One or more, separated by commas. */
const commas = (rule) => seq(rule, repeat(seq(',', rule)));

/**
 * `{ … }` of statements: statements that end with a block need no separator, all others do.
 */
const block = ($, withBlock, others) => seq('{', repeat(choice(...withBlock, ...ended($, others))), optional(choice(...others)), '}');

/** Statements with their terminators, and empty statements. */
const ended = ($, others) => [';', seq(choice(...others), choice(';', $._newline))];

module.exports = grammar({
  name: 'hyped',

  word: $ => $.identifier,

  externals: $ => [
    $._newline,
    $.map_start,
    $.map_row,
    // Valid only while tree-sitter recovers from an error, when every token is valid.
    $._recovering,
  ],

  extras: $ => [/\s/, $.comment, $.doc_comment],

  inline: $ => [$._flowing_name],

  // Reserved in all positions. All other keywords are contextual.
  reserved: {
    global: _ => [
      'and', 'or', 'not', 'in', 'is', 'as', 'if', 'true', 'false', 'none', 'self', 'timer',
      'param', 'continuous', 'discrete', 'ref', 'button', 'axis', 'collider', 'kinematic', 'clamp',
      'invariant', 'group', 'mode', 'when', 'else', 'envelope', 'use', 'spawn', 'destroy',
      'entity', 'behavior', 'world', 'import', 'const',
    ],
  },

  supertypes: $ => [$.expression],

  rules: {
    source_file: $ => seq(
      repeat(choice($.entity, $.behavior, $.world, ...ended($, [$.import, $.constant]))),
      optional(choice($.import, $.constant)),
    ),

    comment: _ => token(/\/\/([^\/\r\n][^\r\n]*|\/\/[^\r\n]*)?/),
    doc_comment: _ => token(/\/\/\/([^\/\r\n][^\r\n]*)?/),

    // ---- items ------------------------------------------------------------------------------------------------

    import: $ => seq('import', field('path', $.text)),
    constant: $ => seq('const', field('name', $.identifier), optional($.annotation), '=', field('value', $.expression)),
    entity: $ => seq('entity', field('name', $.identifier), field('body', $.block)),
    behavior: $ => seq('behavior', field('name', $.identifier), optional($.formals), field('body', $.block)),
    formals: $ => seq('(', optional(commas(field('name', $.identifier))), ')'),
    world: $ => seq('world', field('name', $.identifier), field('body', $.world_block)),

    // ---- entities, groups and modes ---------------------------------------------------------------------------

    block: $ => block(
      $,
      [$.group, $.mode, $.always, $.envelope, alias($._edge_with_updates, $.edge), alias($._follow_with_updates, $.follow)],
      [
        $.parameter, $.continuous, $.discrete, $.reference, $.buttons, $.axes, $.chance, $.collider, $.clamp,
        $.invariant, $.condition, $.signals, $.look, $.edge, $.follow, $.put, $.spawn, $.destroy, $.send, $.flow, $.update,
      ],
    ),

    parameter: $ => seq('param', field('name', $.identifier), optional($.annotation), '=', field('value', $.expression)),
    continuous: $ => seq(
      'continuous',
      field('name', $.identifier),
      optional($.annotation),
      optional(seq('=', field('value', $.expression))),
    ),
    discrete: $ => seq(
      'discrete',
      field('name', $.identifier),
      ':',
      field('domain', choice($.int_domain, $.bool_domain, $.set_domain)),
      '=',
      field('value', $.expression),
    ),
    int_domain: $ => seq('int', field('low', $.expression), '..', field('high', $.expression)),
    bool_domain: _ => 'bool',
    set_domain: $ => seq('{', commas($.identifier), '}'),
    reference: $ => seq('ref', field('name', $.identifier), ':', field('entity', $.identifier)),
    buttons: $ => seq('button', commas(field('name', $.identifier))),
    axes: $ => seq('axis', commas(field('name', $.identifier))),
    chance: $ => seq('chance', field('name', $.identifier), ':', field('low', $.expression), '..', field('high', $.expression)),

    look: $ => seq('look', field('appearance', choice($.color, $.text))),
    color: _ => /#[\p{XID_Continue}]*/u,

    annotation: $ => seq(':', $.dimension),
    dimension: $ => seq($.dimension_factor, repeat(seq(choice('*', '/'), $.dimension_factor))),
    dimension_factor: $ => seq(choice($.identifier, $.number), optional(seq('^', $.exponent))),
    exponent: _ => /-?[0-9]+/,

    collider: $ => seq(optional('kinematic'), 'collider', $.tags, ':', field('shape', $.shape), optional($._guard)),
    shape: $ => seq(field('name', $.identifier), '(', commas($.expression), ')'),
    clamp: $ => seq(
      'clamp',
      field('variable', $.variable),
      choice(
        seq('in', field('low', $.expression), '..', field('high', $.expression)),
        seq(choice('<=', '>='), field('bound', $.expression)),
      ),
    ),
    condition: $ => seq('condition', field('name', $.identifier), '=', field('holds', $.expression)),
    signals: $ => seq('signal', commas($.signal)),
    signal: $ => seq(field('name', $.identifier), optional($.signal_number)),
    signal_number: $ => seq('(', field('name', $.identifier), optional($.annotation), ')'),
    invariant: $ => seq('invariant', field('holds', $.expression)),

    group: $ => seq('group', field('name', $.identifier), field('body', $.block)),
    mode: $ => seq(optional($.initial), 'mode', field('name', $.identifier), field('body', $.block)),
    initial: $ => seq('initial', optional($._guard)),
    always: $ => seq('always', field('body', $.block)),
    _guard: $ => seq('when', field('guard', $.expression)),

    flow: $ => seq(field('variable', alias($._member_variable, $.variable)), '=', field('value', $.expression)),
    update: $ => seq(
      field('variable', alias($._member_variable, $.variable)),
      choice(':=', '+=', '-='),
      field('value', $.expression),
    ),

    edge: $ => seq(choice($._guard, 'else'), optional($._target)),
    _edge_with_updates: $ => seq(choice($._guard, 'else'), optional($._target), field('updates', $.updates)),
    _target: $ => seq('->', field('target', $.path)),
    updates: $ => block($, [], [$.spawn, $.destroy, $.send, $.update]),
    spawn: $ => seq(
      optional(seq(field('variable', alias($._member_variable, $.variable)), ':=')),
      'spawn',
      field('entity', $.identifier),
      optional($.actuals),
    ),
    destroy: $ => seq('destroy', field('instance', choice($.self, $.identifier))),
    send: $ => seq('send', choice($.all_of, $.address), optional($.sent)),
    all_of: $ => seq('all', $.address),
    address: $ => seq(
      field('receiver', choice($.self, $.identifier, alias('all', $.identifier))),
      token.immediate('.'),
      field('signal', $.identifier),
    ),
    sent: $ => seq('(', field('number', $.expression), ')'),
    actuals: $ => seq('(', optional(commas($.actual)), ')'),
    actual: $ => seq(field('name', $.variable), '=', field('value', $.expression)),
    put: $ => seq('use', field('behavior', $.identifier), optional($.actuals)),
    follow: $ => seq('follow', 'links', optional($._guard)),
    _follow_with_updates: $ => seq('follow', 'links', optional($._guard), field('updates', $.updates)),

    // ---- envelopes ----------------------------------------------------------------------------------------------

    envelope: $ => seq(
      'envelope',
      choice($.variable, seq('(', commas($.variable), ')')),
      choice(seq('by', field('input', $.expression), optional($.directions)), 'fixed'),
      field('body', $.ramps),
    ),
    directions: $ => seq('directions', choice($.number, $.identifier)),
    ramps: $ => block($, [], [$.attack, $.decay, $.sustain, $.release, $.while]),
    attack: $ => seq('attack', $._rate, optional($.level)),
    decay: $ => seq('decay', $._rate),
    sustain: $ => seq('sustain', choice(seq('for', field('time', $.expression)), field('level', $.expression))),
    release: $ => seq('release', choice($.hold, seq($._rate, optional($.level)), $.level)),
    while: $ => seq('while', field('guard', $.expression)),
    _rate: $ => choice($.instant, $.accel, $.over),
    instant: _ => 'instant',
    hold: _ => 'hold',
    accel: $ => seq('accel', $.expression),
    over: $ => seq('over', $.expression),
    level: $ => seq('to', $.expression),

    // ---- worlds -------------------------------------------------------------------------------------------------

    world_block: $ => block(
      $,
      [$.tiles, $.space, $.test],
      [$.step, $.collide, $.limit, alias($._tag_look, $.look), $.player, $.condition, $.goal, $.never],
    ),
    step: $ => seq('step', field('time', $.expression)),
    collide: $ => seq('collide', $.tags, 'with', $.tags, ':', field('response', $.response)),
    response: $ => seq(
      choice('block', 'sense'),
      optional(seq('from', 'above')),
      repeat(seq(',', choice(seq('keep', 'velocity'), 'carry', seq('bounce', field('bounce', $.expression))))),
    ),
    tiles: $ => seq('tiles', field('name', $.identifier), $.tile_size, field('body', $.tile_block)),
    tile_size: $ => seq($._primary, 'x', $._primary),
    tile_block: $ => block($, [alias($._tile_with_settings, $.tile)], [$.tile]),
    tile: $ => seq($.tile_char, ':', choice($.tile_spawn, seq($.tags, optional($.slope), optional($.breakable)))),
    slope: $ => seq('slope', field('from', $.point), '-', field('to', $.point)),
    breakable: $ => seq('breakable', optional(seq('restore', 'after', field('time', $.expression)))),
    _tile_with_settings: $ => seq($.tile_char, ':', $.tile_spawn, field('body', $.settings)),
    tile_char: _ => token(/'[^\r\n]'/),
    tile_spawn: $ => seq('spawn', field('entity', $.identifier), optional(seq('as', field('name', $.identifier)))),
    _tag_look: $ => seq('look', $.tags, ':', field('appearance', choice($.color, $.text))),
    limit: $ => seq('limit', field('entity', $.identifier), field('count', $.expression)),
    player: $ => seq('player', field('number', $.number), ':', field('instance', $.identifier)),
    goal: $ => seq('goal', field('name', $.identifier), ':', field('holds', $.expression)),
    never: $ => seq('never', field('name', $.identifier), ':', field('holds', $.expression)),

    test: $ => seq('test', field('name', $.text), field('body', $.test_block)),
    test_block: $ => block($, [], [$.given, $.draws, $.expect, $.search]),
    given: $ => seq('inputs', optional('from'), $.text),
    draws: $ => seq('chance', 'seed', $.number),
    expect: $ => seq('expect', field('holds', $.expression), choice('always', 'never', seq(choice('at', 'by'), $._moment))),
    _moment: $ => choice($.end, field('time', $.expression)),
    end: _ => 'end',
    search: $ => seq(
      choice('reachable', 'unreachable', 'unfound', 'never'),
      field('holds', $.expression),
      optional(seq(optional('not'), 'without', field('without', $.expression))),
      optional(seq('within', field('time', $.expression))),
    ),

    space: $ => seq('space', field('name', $.identifier), field('body', $.space_block)),
    space_block: $ => block(
      $,
      [alias($._map_with_tiles, $.map), alias($._map_with_kinds, $.map), alias($._place_with_settings, $.place)],
      [$.map, $.place, $.link, $.rect, $.bounds, $.wrap],
    ),
    rect: $ => seq('rect', $.tags, $.rectangle),
    bounds: $ => seq('bounds', 'rect', $.rectangle),
    wrap: $ => seq('wrap', $.way),
    way: _ => token(/horizontal|vertical/),
    rectangle: $ => seq('(', $.expression, ',', $.expression, ',', $.expression, ',', $.expression, ')'),
    link: $ => seq(
      'link', 'rect', $.rectangle, '->', field('space', $.identifier), 'at', 'rect', $.rectangle, optional($._guard),
    ),
    map: $ => seq('map', choice(
      seq(field('tiles', $._map_tiles), $.map_text),
      seq(field('tiles', $._map_tiles), 'from', field('path', $.text)),
      seq('vglc', field('path', $.text), $.legend),
      $._map_of_editor,
      seq('level', choice($.legend, field('tiles', $.identifier))),
      'level',
    )),
    _map_with_tiles: $ => seq('map', choice(seq('vglc', field('path', $.text)), 'level'), $.legend, field('body', $.tile_block)),
    _map_with_kinds: $ => seq('map', choice($._map_of_editor, 'level'), field('body', $.kind_block)),
    _map_of_editor: $ => choice(
      seq('tiled', field('path', $.text)),
      seq('ldtk', field('path', $.text), optional(seq('level', field('level', $.text)))),
    ),
    // A tile set can have the same name as a kind of map.
    _map_tiles: $ => choice($.identifier, alias(choice('vglc', 'tiled', 'ldtk', 'level'), $.identifier)),
    // The meanings of characters of a level, or of names from a level editor.
    kind_block: $ => block(
      $,
      [alias($._tile_with_settings, $.tile), alias($._kind_with_settings, $.kind)],
      [$.tile, $.kind],
    ),
    kind: $ => seq(field('name', $.tag), ':', choice($.tile_spawn, seq($.tags, optional($.slope), optional($.breakable)))),
    _kind_with_settings: $ => seq(field('name', $.tag), ':', $.tile_spawn, field('body', $.settings)),
    legend: $ => seq('legend', field('path', $.text), 'tile', $.tile_size),
    map_text: $ => seq(alias($.map_start, '"'), repeat($.map_row), '"'),
    place: $ => $._placed,
    _place_with_settings: $ => seq($._placed, field('body', $.settings)),
    _placed: $ => seq('place', field('name', $.identifier), ':', field('entity', $.identifier), 'at', alias($._position, $.point)),
    _position: $ => seq('(', $.expression, ',', choice($.standing, $.expression), ')'),
    standing: $ => seq('above', field('tag', $.tag)),
    point: $ => seq('(', $.expression, ',', $.expression, ')'),
    settings: $ => block($, [], [$.setting]),
    setting: $ => seq(field('variable', $.variable), '=', field('value', $.expression)),

    // ---- expressions --------------------------------------------------------------------------------------------

    expression: $ => choice($._primary, $.unary, $.binary),
    _primary: $ => choice($._atom, $.relation),
    _atom: $ => choice(
      $.number, $.true, $.false, $.none, $.self, $.call, $.in_mode, $.any_instance, $.nearest, $.timer, $.path, $.parenthesized, $.text,
    ),
    unary: $ => choice(
      prec(PREC.not, seq('not', $.expression)),
      prec(PREC.negative, seq('-', $.expression)),
    ),
    binary: $ => choice(...[
      [PREC.or, 'or'],
      [PREC.and, 'and'],
      [PREC.comparison, choice('==', '!=', '<', '<=', '>', '>=')],
      [PREC.sum, choice('+', '-')],
      [PREC.product, choice('*', '/')],
    ].map(([level, operator]) => prec.left(level, seq(
      field('left', $.expression),
      field('operator', operator),
      field('right', $.expression),
    )))),
    relation: $ => seq($._atom, choice(
      seq('in', field('mode', $.path)),
      seq('is', choice($.none, field('entity', $.identifier))),
      seq('touching', $.tag),
    )),
    call: $ => seq(
      field('function', choice($.identifier, alias(choice('timer', 'if', 'clamp', 'any', 'all', 'nearest'), $.identifier))),
      '(',
      optional(commas(seq($.expression, optional($.moved)))),
      ')',
      optional($.binding),
    ),
    moved: $ => seq('at', field('offset', $.expression)),
    binding: $ => seq('as', field('name', $.identifier)),
    in_mode: $ => seq('in', field('mode', $.path)),
    any_instance: $ => seq(
      choice('any', 'all'),
      field('entity', $.identifier),
      optional(seq(token.immediate('.'), field('value', $.path))),
    ),
    nearest: $ => prec.right(seq(
      'nearest',
      field('entity', $.identifier),
      optional(seq('in', field('mode', $.path))),
      optional(seq('within', field('distance', choice($.number, $.path, $.parenthesized)))),
      optional($.binding),
    )),
    timer: _ => 'timer',
    true: _ => 'true',
    false: _ => 'false',
    none: _ => 'none',
    self: _ => 'self',
    parenthesized: $ => seq('(', $.expression, optional(seq(',', $.expression)), ')'),

    // ---- words --------------------------------------------------------------------------------------------------

    identifier: _ => /[\p{XID_Start}_]\p{XID_Continue}*/u,
    path: $ => seq(
      choice($.identifier, alias(choice('any', 'all', 'nearest', 'above'), $.identifier)),
      repeat(seq(token.immediate('.'), $.identifier)),
      optional($.primes),
    ),
    variable: $ => seq($.identifier, optional($.primes)),
    // At the start of a statement, these names can also be keywords.
    _member_variable: $ => seq($._flowing_name, optional($.primes)),
    _flowing_name: $ => choice(
      $.identifier,
      ...['follow', 'initial', 'always', 'condition', 'chance', 'signal', 'look', 'send'].map((word) => alias(word, $.identifier)),
    ),
    primes: _ => token.immediate(/'+/),
    tags: $ => commas($.tag),
    tag: $ => choice($.identifier, $.text),
    number: $ => seq($.digits, optional($.unit)),
    digits: _ => /[0-9]+(\.[0-9]+)?/,
    unit: _ => token.immediate(choice('frames', 'ms', 's')),
    text: _ => token(/"[^"\r\n]*"/),
  },
});
