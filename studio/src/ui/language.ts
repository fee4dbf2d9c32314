// Colours of `.hyped` text in the editor: keywords, numbers with units, comments, strings.

import { StreamLanguage, type StringStream } from "@codemirror/language";

const WORDS = new Set(
  (
    "and or not in is as if true false none self timer param continuous discrete ref button axis collider kinematic " +
    "clamp invariant group mode when else envelope use spawn destroy entity behavior world import const int bool always " +
    "condition signal send chance initial by fixed directions attack decay sustain for release while instant accel over " +
    "hold to follow links step collide with block sense from above keep velocity bounce carry tiles slope breakable " +
    "restore after space player goal never limit map place at link rect circle bounds wrap legend vglc level tiled ldtk " +
    "tile all any touching nearest within held pressed released entering exiting look empty"
  ).split(" "),
);

interface State {
  /** Inside of a text between quotes, which may go over lines. */
  isText: boolean;
}

function token(stream: StringStream, state: State): string | null {
  if (state.isText) {
    if (stream.skipTo('"')) {
      stream.next();
      state.isText = false;
    } else {
      stream.skipToEnd();
    }
    return "string";
  }
  if (stream.eatSpace()) return null;
  if (stream.match("//")) {
    stream.skipToEnd();
    return "comment";
  }
  if (stream.match(/^\d+(\.\d+)?([eE][+-]?\d+)?/)) {
    stream.match(/^(px|ms|s|frames|tiles|deg|rad)(\/(s|ms)(\^\d)?)?\b/);
    return "number";
  }
  if (stream.eat('"')) {
    state.isText = true;
    return "string";
  }
  if (stream.match(/^'.'/)) return "string";
  const word = stream.match(/^[\p{L}_][\p{L}\p{N}_]*/u) as RegExpMatchArray | null;
  if (word) {
    if (stream.match(/^'{1,2}/)) return "variableName";
    if (WORDS.has(word[0])) return "keyword";
    return /^\p{Lu}/u.test(word[0]) ? "typeName" : null;
  }
  if (stream.match(/^(->|:=|<=|>=|[-+*/=<>])/)) return "operator";
  stream.next();
  return null;
}

export const hyped = StreamLanguage.define<State>({
  name: "hyped",
  startState: () => ({ isText: false }),
  token,
  languageData: { commentTokens: { line: "//" } },
});
