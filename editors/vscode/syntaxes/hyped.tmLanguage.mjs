// The source of the TextMate grammar of `.hyped`. `npm run grammar` writes hyped.tmLanguage.json.
//
// Reserved words are keywords everywhere. Contextual keywords are recognized by the enclosing block and the adjacent
// tokens: no expression has two adjacent operands, so `goal NAME :` and `step 1/60` are unambiguous.

import { writeFileSync } from 'node:fs';
import { join } from 'node:path';

const r = String.raw;

// ---- parts of patterns ----------------------------------------------------------------------------------------------

const NAME = r`[\p{L}\p{Nl}_][\p{L}\p{Nl}\p{M}\p{N}\p{Pc}]*`;
const NUMBER = r`\d+(?:\.\d+)?`;
/** The text before a statement. */
const START = r`(?:^|(?<=[;{}]))[ \t]*`;
/** The end of a statement in one line. A statement continues after a comma. */
const END = r`(?=[;}])|(?<=[^,\s])[ \t]*$`;
const FACTOR = r`(?:${NAME}|\d+)(?:\s*\^\s*-?\d+)?`;
const DIMENSION = r`${FACTOR}(?:\s*[*/]\s*${FACTOR})*`;
/** The end of an operand, and the start of one. */
const AFTER_OPERAND = r`(?<=[\p{L}\p{N}_)'])\s+`;
const BEFORE_OPERAND = r`(?=\s+[\p{L}\p{N}_(-])`;
/** A tag, and a name that is no keyword which can follow an operand. */
const TAG = r`(?!(?:and|or|not|in|is|as|when|mode|true|false|none|self|timer|if|clamp)\b)${NAME}`;
const FREE = r`(?!touching\b)${TAG}`;
const FUNCTIONS = 'min|max|abs|sign|floor|ceil|round|sqrt|sin|cos|atan2|mod|pressed|held|released|touching|entering|exiting|lost|near|distance|inside|count|received|clamp|if|timer';
const ITEM = r`^[ \t]*(?:entity|behavior|world|import|const)\b`;
const WORLD_ITEM = r`^[ \t]*(?:entity|behavior|world|import|const|tiles|space|collide|limit|look|player|condition|goal|never)\b`;

// ---- parts of rules --------------------------------------------------------------------------------------------------

const scope = (name) => `${name}.hyped`;
const captures = (names) => Object.fromEntries(names.flatMap((name, index) => (name ? [[index + 1, { name: scope(name) }]] : [])));
/** Rules of the repository. */
const use = (...names) => names.map((name) => ({ include: `#${name}` }));
/** A pattern as a whole. */
const all = (match, name) => ({ name: scope(name), match });
/** A pattern by its groups. */
const groups = (match, ...names) => ({ match, captures: captures(names) });
/** The text between two patterns. */
const between = (begin, beginNames, end, endNames, patterns, name) => ({
  ...(name && { name: scope(name) }),
  begin,
  ...(beginNames.length > 0 && { beginCaptures: captures(beginNames) }),
  end,
  ...(endNames.length > 0 && { endCaptures: captures(endNames) }),
  patterns,
});
const block = (...patterns) => between(r`(\{)`, ['punctuation.section.block.begin'], r`(\})`, ['punctuation.section.block.end'], patterns);
const COMMA = all(',', 'punctuation.separator');

const repository = {
  comments: {
    patterns: [all(r`///(?!/).*$`, 'comment.line.documentation'), all(r`//.*$`, 'comment.line.double-slash')],
  },

  // ---- items ----------------------------------------------------------------------------------------------------------

  import: groups(r`\b(import)\b`, 'keyword.control.import'),
  constant: groups(r`\b(const)\s+(${NAME})(?:\s*(:)\s*(${DIMENSION}))?`, 'storage.type', 'variable.other.constant', 'punctuation.separator', 'support.type.dimension'),
  entity: between(r`\b(entity)\b`, ['storage.type'], r`(?<=\})|(?=${ITEM})`, [], [
    ...use('comments'),
    groups(r`(${NAME})`, 'entity.name.type'),
    block(...use('members')),
  ], 'meta.entity'),
  behavior: between(r`\b(behavior)\b`, ['storage.type'], r`(?<=\})|(?=${ITEM})`, [], [
    ...use('comments'),
    between(r`(\()`, ['punctuation.section.parens.begin'], r`(\))`, ['punctuation.section.parens.end'], [
      ...use('comments'),
      groups(r`(${NAME})`, 'variable.parameter'),
      COMMA,
    ]),
    groups(r`(${NAME})`, 'entity.name.function'),
    block(...use('members')),
  ], 'meta.behavior'),
  world: between(r`\b(world)\b`, ['storage.type'], r`(?<=\})|(?=${ITEM})`, [], [
    ...use('comments'),
    groups(r`(${NAME})`, 'entity.name.namespace'),
    block(...use('world-items')),
  ], 'meta.world'),

  // ---- entities, groups and modes ---------------------------------------------------------------------------------------

  members: { patterns: [...use('comments', 'envelope', 'declarations', 'member-statements'), block(...use('members')), ...use('expression')] },
  declarations: {
    patterns: [
      groups(r`\b(param)\s+(${NAME})(?:\s*(:)\s*(${DIMENSION}))?`, 'storage.type', 'variable.parameter', 'punctuation.separator', 'support.type.dimension'),
      groups(r`\b(continuous)\s+(${NAME})(?:\s*(:)\s*(${DIMENSION}))?`, 'storage.type', 'variable.other.member', 'punctuation.separator', 'support.type.dimension'),
      between(
        r`\b(discrete)\s+(${NAME})\s*(:)\s*(\{)`,
        ['storage.type', 'variable.other.member', 'punctuation.separator', 'punctuation.section.block.begin'],
        r`(\})`,
        ['punctuation.section.block.end'],
        [...use('comments'), groups(r`(${NAME})`, 'constant.other.enum'), COMMA],
      ),
      groups(r`\b(discrete)\s+(${NAME})\s*(:)\s*(?:(int|bool)\b)?`, 'storage.type', 'variable.other.member', 'punctuation.separator', 'support.type'),
      groups(r`\b(ref)\s+(${NAME})\s*(:)\s*(${NAME})`, 'storage.type', 'variable.other.member', 'punctuation.separator', 'entity.name.type'),
      groups(r`\b(button|axis)\b`, 'storage.type'),
      between(r`(?:\b(kinematic)\s+)?\b(collider)\b`, ['storage.modifier', 'storage.type'], r`(:)|(?=[;{}])`, ['punctuation.separator'], use('tags'), 'meta.tags'),
      groups(r`\b(group)\s+(${NAME})`, 'storage.type', 'entity.name.namespace'),
      groups(r`\b(mode)\s+(${NAME})`, 'storage.type', 'entity.name.label'),
      groups(r`${START}(condition)\s+(${NAME})\s*(=)(?!=)`, 'storage.type', 'entity.name.label', 'keyword.operator.assignment'),
      between(r`${START}(signal)(?=\s+${FREE})`, ['storage.type'], END, [], [
        ...use('comments'),
        groups(r`(\()\s*(${NAME})(?:\s*(:)\s*(${DIMENSION}))?\s*(\))?`, 'punctuation.section.parens', 'variable.other.member', 'punctuation.separator', 'support.type.dimension', 'punctuation.section.parens'),
        groups(r`(${FREE})`, 'variable.other.member'),
        COMMA,
      ]),
      groups(r`${START}(look)(?=\s*[#"])(?:\s*(#[\p{L}\p{N}]*))?`, 'keyword.control', 'constant.other.color'),
      groups(r`${START}(chance)\s+(${NAME})\s*(:)(?!=)`, 'storage.type', 'variable.other.member', 'punctuation.separator'),
      groups(r`\b(initial)(?=\s+(?:mode|when)\b)`, 'storage.modifier'),
      groups(r`\b(always)(?=\s*(?:\{|//|$))`, 'storage.type'),
      groups(r`\b(param|continuous|discrete|ref|group|mode|kinematic)\b`, 'storage.type'),
    ],
  },
  tags: { patterns: [...use('comments'), all('"[^"]*"', 'string.quoted.double.tag'), groups(r`(${NAME})`, 'entity.name.tag'), COMMA] },
  'member-statements': {
    patterns: [
      groups(r`\b(follow)\s+(links)\b(?!\s*(?:'|:?=))`, 'keyword.control', 'keyword.control'),
      groups(r`\b(use)\s+(${NAME})`, 'keyword.control', 'entity.name.function'),
      groups(r`\b(spawn)\s+(${NAME})`, 'keyword.control', 'entity.name.type'),
      groups(r`${START}(send)\s+(all)\s+(${NAME})(\.)(${NAME})`, 'keyword.control', 'keyword.operator.word', 'entity.name.type', 'punctuation.accessor', 'variable.other.member'),
      groups(r`${START}(send)(?=\s+${NAME}\.)`, 'keyword.control'),
      groups(r`\b(when|else)\b`, 'keyword.control'),
      groups(r`\b(invariant|clamp(?!\s*\()|use|spawn|destroy)\b`, 'keyword.control'),
      groups(r`(->)\s*(${NAME}(?:\.${NAME})*)`, 'keyword.operator.arrow', 'entity.name.label'),
    ],
  },

  // ---- envelopes --------------------------------------------------------------------------------------------------------

  envelope: between(r`\b(envelope)\b`, ['storage.type'], r`(?<=\})|(?=\})`, [], [
    ...use('comments'),
    // The driven variable precedes `by`; it can have any name.
    groups(r`\G\s*(${NAME})('*)\s+(?:(by)|(fixed))\b`, 'variable.other', 'keyword.operator.prime', 'keyword.control', 'keyword.control'),
    groups(r`(?<=\))\s*(?:(by)|(fixed))\b`, 'keyword.control', 'keyword.control'),
    groups(r`\b(directions)\s+(?:(${NAME})|(\d+))(?=\s*(?:\{|//|$))`, 'keyword.control', 'variable.other.constant', 'constant.numeric'),
    block(...use('ramps')),
    ...use('expression'),
  ], 'meta.envelope'),
  ramps: {
    patterns: [
      ...use('comments'),
      // Also matches the name after the keyword, which can look like the next keyword.
      groups(r`${START}(attack|decay|release)\s+(?:(instant|hold)\b|(accel|over|to)\b(?:\s+(${FREE})\b(?!\s*\())?)`, 'keyword.control', 'keyword.control', 'keyword.control', 'variable.other'),
      groups(r`${START}(sustain)\b(?:\s+(for)\b)?`, 'keyword.control', 'keyword.control'),
      groups(r`${START}(attack|decay|release|while)\b(?!\s*[-+*/=<>,.)])`, 'keyword.control'),
      groups(r`${AFTER_OPERAND}(to)(?:\s+(${FREE})\b(?!\s*\()|${BEFORE_OPERAND})`, 'keyword.control', 'variable.other'),
      ...use('expression'),
    ],
  },

  // ---- worlds -----------------------------------------------------------------------------------------------------------

  'world-items': {
    patterns: [
      ...use('comments'),
      groups(r`${START}(step)\b(?!\s*(?:[=:.,)*/+<>]|$))`, 'keyword.control'),
      between(r`${START}(collide)\b`, ['keyword.control'], END, [], [
        ...use('comments'),
        between('(:)', ['punctuation.separator'], END, [], [
          ...use('comments'),
          groups(r`\b(block|sense|keep|velocity|carry|bounce|from|above)\b`, 'storage.modifier'),
          COMMA,
        ]),
        groups(r`\b(with)\b`, 'keyword.control'),
        ...use('tags'),
      ], 'meta.collide'),
      between(r`${START}(tiles)\s+(${NAME})(?:\s+(${NAME})(?=\s+x\s))?`, ['storage.type', 'entity.name.namespace', 'variable.other'], r`(?<=\})|(?=\})|(?=${WORLD_ITEM})`, [], [
        ...use('comments', 'tile-size'),
        block(...use('tile-lines')),
        ...use('expression'),
      ], 'meta.tiles'),
      between(r`${START}(space)\s+(${NAME})`, ['storage.type', 'entity.name.namespace'], r`(?<=\})|(?=\})|(?=${WORLD_ITEM})`, [], [
        ...use('comments'),
        block(...use('space-items')),
      ], 'meta.space'),
      between(r`${START}(test)\s*("[^"]*")`, ['storage.type', 'string.quoted.double entity.name.function'], r`(?<=\})|(?=\})|(?=${WORLD_ITEM})`, [], [
        ...use('comments'),
        block(...use('claims')),
      ], 'meta.test'),
      groups(r`${START}(limit)\s+(${NAME})(?=\s+[\p{L}\d_(])`, 'keyword.control', 'entity.name.type'),
      between(r`${START}(look)(?=\s+${NAME}\s*[,:](?!=)|\s*"[^"]*"\s*[,:])`, ['keyword.control'], END, [], [
        ...use('comments'),
        between('(:)', ['punctuation.separator'], END, [], [
          ...use('comments'),
          all(r`#[\p{L}\p{N}]*`, 'constant.other.color'),
          all('"[^"]*"', 'string.quoted.double'),
        ]),
        ...use('tags'),
      ], 'meta.look'),
      groups(r`${START}(player)(?=\s+\d)`, 'keyword.control'),
      groups(r`${START}(goal|never)\s+(${NAME})\s*(:)(?!=)`, 'storage.type', 'entity.name.label', 'punctuation.separator'),
      groups(r`${START}(condition)\s+(${NAME})\s*(=)(?!=)`, 'storage.type', 'entity.name.label', 'keyword.operator.assignment'),
      block(...use('world-items')),
      ...use('expression'),
    ],
  },
  claims: {
    patterns: [
      ...use('comments'),
      groups(r`${START}(inputs)(?:\s+(from))?(?=\s*")`, 'keyword.control', 'keyword.control'),
      groups(r`${START}(chance)\s+(seed)\b`, 'keyword.control', 'keyword.control'),
      groups(r`${START}(expect|reachable|unreachable|unfound|never)\b`, 'keyword.control'),
      groups(r`${AFTER_OPERAND}(at|by)\s+(end)\b`, 'keyword.control', 'keyword.control'),
      groups(r`${AFTER_OPERAND}(at|by|without|within)(?=\s*\(|\s+[\p{L}\d_-])`, 'keyword.control'),
      groups(r`${AFTER_OPERAND}(always|never)(?=\s*(?:[;}]|//|$))`, 'keyword.control'),
      ...use('expression'),
    ],
  },
  'tile-size': groups(r`(?<=[\p{L}\p{N}_)])\s+(x)(?=\s+[\p{L}\p{N}_(])`, 'keyword.control'),
  'tile-lines': {
    patterns: [
      ...use('comments'),
      between(r`(')(.)(')\s*(:)`, ['punctuation.definition.character', 'constant.character.tile', 'punctuation.definition.character', 'punctuation.separator'], END, [], use('tile-meaning'), 'meta.tile'),
      // The settings of an instance, if their brace begins a line.
      block(...use('expression')),
    ],
  },
  // Names from a level editor. Unlike these, a setting has no colon.
  'kind-lines': between(r`${START}(?:(${TAG})|("[^"]*"))\s*(:)(?!=)`, ['entity.name.tag', 'string.quoted.double.tag', 'punctuation.separator'], END, [], use('tile-meaning'), 'meta.tile'),
  'tile-meaning': {
    patterns: [
      groups(r`\b(spawn)\s+(${NAME})(?:\s+(as)\s+(${NAME}))?`, 'keyword.control', 'entity.name.type', 'keyword.control', 'variable.other'),
      // After a tag; a tag of its own stands after a colon or a comma.
      groups(r`(?<=[\p{L}\p{N}_"])\s+(slope)(?=\s*\()`, 'storage.modifier'),
      between(r`(?<=[\p{L}\p{N}_")])\s+(breakable)\b(?:\s+(restore)\s+(after)\b)?`, ['storage.modifier', 'keyword.control', 'keyword.control'], END, [], use('comments', 'expression')),
      block(...use('expression')),
      ...use('tags'),
    ],
  },
  'space-items': {
    patterns: [
      ...use('comments', 'map-text'),
      groups(r`${START}(place)\s+(${NAME})\s*(:)\s*(${NAME})\s+(at)\b`, 'keyword.control', 'variable.other', 'punctuation.separator', 'entity.name.type', 'keyword.control'),
      between(r`(?<=\bat)\s*(\()`, ['punctuation.section.parens.begin'], r`(\))|(?=[{}])`, ['punctuation.section.parens.end'], [
        groups(r`(?:^|(?<=,))\s*(above)\s*("[^"]*")`, 'keyword.control', 'string.quoted.double.tag'),
        groups(r`(?:^|(?<=,))\s*(above)\s+(${NAME})`, 'keyword.control', 'entity.name.tag'),
        ...use('expression'),
      ]),
      groups(r`${START}(link)\s+(rect)\b`, 'keyword.control', 'storage.type'),
      groups(r`(->)\s*(${NAME})\s+(at)\s+(rect)\b`, 'keyword.operator.arrow', 'entity.name.namespace', 'keyword.control', 'storage.type'),
      groups(r`${START}(bounds)\s+(rect)\b`, 'keyword.control', 'storage.type'),
      groups(r`${START}(wrap)(?=\s+${NAME})`, 'keyword.control'),
      between(r`${START}(rect)\b`, ['storage.type'], r`(?=[(;{}])`, [], use('tags'), 'meta.tags'),
      // A tile set may have the name of a kind of map.
      groups(r`${START}(map)\s+(vglc|tiled|ldtk)(?=\s*"[^"]+")`, 'keyword.control', 'keyword.control'),
      groups(r`${START}(map)\s+(level)\s+(legend)(?=\s*")`, 'keyword.control', 'keyword.control', 'keyword.control'),
      groups(r`${START}(map)\s+(level)(?=\s*(?:[;{}]|//|$))`, 'keyword.control', 'keyword.control'),
      groups(r`${START}(map)\s+(${NAME})\s+(from)(?=\s*")`, 'keyword.control', 'entity.name.namespace', 'keyword.control'),
      groups(r`${START}(map)\s+(level)\s+(${NAME})`, 'keyword.control', 'keyword.control', 'entity.name.namespace'),
      groups(r`${START}(map)\s+(${NAME})`, 'keyword.control', 'entity.name.namespace'),
      groups(r`(?<=")\s*(level)(?=\s*")`, 'keyword.control'),
      groups(r`(?<=")\s+(legend)(?=\s*")`, 'keyword.control'),
      groups(r`(?<=")\s+(tile)\b(?:\s+(${NAME})(?=\s+x\s))?`, 'keyword.control', 'variable.other'),
      groups(r`\b(when)\b`, 'keyword.control'),
      ...use('tile-size'),
      // The meanings of a map's tiles, or the settings of an instance.
      block(...use('tile-lines', 'kind-lines', 'expression')),
      ...use('expression'),
    ],
  },
  'map-text': between('"(?=[ \\t]*(?://.*)?$)', [], '"', [], [groups(r`\G[ \t]*(//.*)$`, 'comment.line.double-slash')], 'string.quoted.double.map'),

  // ---- expressions ------------------------------------------------------------------------------------------------------

  expression: {
    patterns: [
      ...use('comments'),
      all('"[^"]*"', 'string.quoted.double'),
      between(r`(\()`, ['punctuation.section.parens.begin'], r`(\))|(?=[{}])`, ['punctuation.section.parens.end'], use('expression')),
      groups(r`(?<![\p{L}\p{N}_])(${NUMBER})(frames|ms|s)?(?![\p{L}\p{N}_])`, 'constant.numeric', 'keyword.other.unit'),
      groups(r`\b(${FUNCTIONS})(?=\s*\()`, 'support.function'),
      groups(r`\b(any|all)\s+(${FREE})`, 'keyword.operator.word', 'entity.name.type'),
      groups(r`\b(nearest)\s+((?!(?:at|directions|to|x)\b)${FREE})`, 'keyword.operator.word', 'entity.name.type'),
      groups(r`${AFTER_OPERAND}(within)(?=\s*\(|\s+(?:\d|${TAG}))`, 'keyword.operator.word'),
      groups(r`${AFTER_OPERAND}(touching)\s+(${TAG})`, 'keyword.operator.word', 'entity.name.tag'),
      groups(r`${AFTER_OPERAND}(touching)\s*("[^"]*")`, 'keyword.operator.word', 'string.quoted.double.tag'),
      groups(r`(?<=[\p{L}\p{N}_"])\s+(at)(?=\s*\()`, 'keyword.operator.word'),
      groups(r`\b(is)\s+(?!none\b)(${NAME})`, 'keyword.operator.word', 'entity.name.type'),
      groups(r`\b(and|or|not|in|is|as)\b`, 'keyword.operator.word'),
      groups(r`\b(true|false)\b`, 'constant.language.boolean'),
      groups(r`\b(none)\b`, 'constant.language'),
      groups(r`\b(self|timer)\b`, 'variable.language'),
      groups(r`\b(when|if|clamp)\b`, 'keyword.control'),
      groups(r`(${NAME})(?=\s*\()`, 'entity.name.function'),
      groups(r`(\.)(${NAME})('*)`, 'punctuation.accessor', 'variable.other.member', 'keyword.operator.prime'),
      groups(r`(${NAME})('*)`, 'variable.other', 'keyword.operator.prime'),
      all('->', 'keyword.operator.arrow'),
      all('[:+-]=|=(?!=)', 'keyword.operator.assignment'),
      all('==|!=|<=|>=|<|>', 'keyword.operator.comparison'),
      all(r`\.\.`, 'keyword.operator.range'),
      all('[-+*/^]', 'keyword.operator.arithmetic'),
      all('[,:;]', 'punctuation.separator'),
    ],
  },
};

export const grammar = {
  name: 'Hyped',
  scopeName: 'source.hyped',
  fileTypes: ['hyped'],
  patterns: use('comments', 'import', 'constant', 'entity', 'behavior', 'world', 'expression'),
  repository,
};

export const path = join(import.meta.dirname, 'hyped.tmLanguage.json');
export const text = `${JSON.stringify(grammar, null, 2)}\n`;

if (process.argv[1] === import.meta.filename) writeFileSync(path, text);
