// Checks that Mermaid's parser accepts diagrams: node mermaid.mjs FILE… (beside node_modules with mermaid and jsdom).
import fs from "node:fs";
import { JSDOM } from "jsdom";

// Mermaid requires browser globals at import.
globalThis.window = new JSDOM("").window;
globalThis.document = window.document;
const { default: mermaid } = await import("mermaid");

let refused = 0;
for (const path of process.argv.slice(2)) {
  try {
    await mermaid.parse(fs.readFileSync(path, "utf8"));
  } catch (error) {
    refused += 1;
    console.error(`${path}: ${error.message}`);
  }
}
console.log(`Mermaid takes ${process.argv.length - 2 - refused} of ${process.argv.length - 2} diagrams`);
process.exit(refused > 0 ? 1 : 0);
