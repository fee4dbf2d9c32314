// The highlighting of the language in the editor: words, numbers, comments, texts. Its words come from the grammar.

import { HighlightStyle, LanguageSupport, StreamLanguage, syntaxHighlighting } from "@codemirror/language";
import { tags } from "@lezer/highlight";

/** The keywords of grammar/hyped.pest, and the functions of the language; the build puts them here. */
declare const HYPED_WORDS: { keywords: string[]; functions: string[] };

const keywords: ReadonlySet<string> = new Set(HYPED_WORDS.keywords);
const functions: ReadonlySet<string> = new Set(HYPED_WORDS.functions);

const NUMBER = /^\d+(\.\d+)?([eE][+-]?\d+)?(px\/s\^?2?|px|ms|s|deg|frames|%)?/;
const WORD = /^[\p{L}_][\p{L}\p{N}_]*/u;

interface State {
  /** Whether a text that began in a line before goes on. */
  inText: boolean;
}

const language = StreamLanguage.define<State>({
  name: "hyped",
  startState: () => ({ inText: false }),
  token(stream, state) {
    if (state.inText || stream.peek() === '"') {
      if (!state.inText) stream.next();
      state.inText = !stream.skipTo('"');
      if (state.inText) stream.skipToEnd();
      else stream.next();
      return "string";
    }
    if (stream.eatSpace()) return null;
    if (stream.match("//")) {
      stream.skipToEnd();
      return "comment";
    }
    if (stream.match(/^'[^']*'(?!')/)) {
      // `x'` is a derivative: a quote after a name.
      return "string";
    }
    if (stream.match(NUMBER)) return "number";
    const word = stream.match(WORD);
    if (word !== null && word !== true) {
      const text = (word as RegExpMatchArray)[0];
      stream.match(/^'+/);
      if (keywords.has(text)) return "keyword";
      return functions.has(text) && stream.peek() === "(" ? "function" : "variableName";
    }
    if (stream.match(/^(->|:=|\+=|-=|==|!=|<=|>=|[-+*/<>=.:|])/)) return "operator";
    stream.next();
    return null;
  },
  tokenTable: { function: tags.standard(tags.function(tags.variableName)) },
  languageData: {
    commentTokens: { line: "//" },
    closeBrackets: { brackets: ["(", "{", '"'] },
    indentOnInput: /^\s*\}$/,
  },
});

/** Colours by the page's style sheet, so that they follow its theme. */
const style = HighlightStyle.define([
  { tag: tags.keyword, class: "tok-keyword" },
  { tag: tags.number, class: "tok-number" },
  { tag: tags.string, class: "tok-string" },
  { tag: tags.comment, class: "tok-comment" },
  { tag: tags.operator, class: "tok-operator" },
  { tag: tags.standard(tags.function(tags.variableName)), class: "tok-function" },
  { tag: tags.variableName, class: "tok-name" },
]);

/** The language for the editor. */
export function hyped(): LanguageSupport {
  return new LanguageSupport(language, [syntaxHighlighting(style)]);
}
