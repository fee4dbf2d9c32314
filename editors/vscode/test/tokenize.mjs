// Tokenizes `.hyped` with VS Code's tokenizer and the TextMate grammar.

import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import oniguruma from 'vscode-oniguruma';
import textmate from 'vscode-textmate';

const folder = join(import.meta.dirname, '..');
const require = createRequire(import.meta.url);

async function load() {
  await oniguruma.loadWASM(readFileSync(require.resolve('vscode-oniguruma/release/onig.wasm')).buffer);
  const path = join(folder, 'syntaxes/hyped.tmLanguage.json');
  const registry = new textmate.Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
      createOnigString: (text) => new oniguruma.OnigString(text),
    }),
    loadGrammar: async () => textmate.parseRawGrammar(readFileSync(path, 'utf8'), path),
  });
  return registry.loadGrammar('source.hyped');
}

const grammar = await load();

/** The tokens of each line: text and scopes, outermost first, without the suffix `.hyped`. */
export function tokenize(text) {
  let stack = textmate.INITIAL;
  return text.replace(/\r?\n$/, '').split(/\r?\n/).map((line) => {
    const { tokens, ruleStack } = grammar.tokenizeLine(line, stack);
    stack = ruleStack;
    return tokens.map(({ startIndex, endIndex, scopes }) => ({
      start: startIndex,
      text: line.slice(startIndex, endIndex),
      scopes: scopes.map((scope) => scope.replace(/\.hyped$/, '')),
    }));
  });
}
