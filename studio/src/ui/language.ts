// Colours of `.hyped` text in the editor: keywords, numbers with units, comments, strings.

import { StreamLanguage, type StringStream } from "@codemirror/language";

/** The keywords of grammar/hyped.pest; the build puts them here. */
declare const HYPED_KEYWORDS: string[];

const WORDS: ReadonlySet<string> = new Set(HYPED_KEYWORDS);

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
