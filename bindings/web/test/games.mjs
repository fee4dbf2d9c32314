// The examples as projects for the engine: their files by name, the main file, and a level where the map is open.
import { readFileSync, readdirSync } from "node:fs";
import { dirname } from "node:path";
import { fileURLToPath } from "node:url";

/** The folder of the repository. */
export const repository = fileURLToPath(new URL("../../..", import.meta.url));

const read = (name) => readFileSync(`${repository}/${name}`, "utf8");

/** The texts in a folder and its folders, by name from the repository. */
function texts(folder) {
  const names = readdirSync(`${repository}/${folder}`, { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile() && /\.(hyped|inputs|txt|json)$/.test(entry.name))
    .map((entry) => `${entry.parentPath ?? entry.path}/${entry.name}`.slice(repository.length).replace(/^\//, ""));
  return Object.fromEntries(names.sort().map((name) => [name, read(name)]));
}

/** All examples with worlds that can be played: each with its name. */
export function games() {
  const files = texts("examples");
  const programs = Object.keys(files).filter((name) => name.endsWith(".hyped") && /^world /m.test(files[name]));
  return programs.flatMap((root) => {
    const name = root.slice("examples/".length, -".hyped".length);
    // Files of the same folder, and those that the program names elsewhere.
    const folder = dirname(root);
    const isNamed = (file) => files[root].includes(`"${file.slice(folder.length + 1)}"`);
    const isNear = (file) => dirname(file) === folder || file.startsWith("examples/entities/") || isNamed(file);
    const near = Object.fromEntries(Object.entries(files).filter(([file]) => isNear(file)));
    if (!/^\s*map level /m.test(files[root])) return [{ name, project: { files: near, root } }];
    const levels = Object.keys(near).filter((file) => file.endsWith(".txt"));
    return levels.map((map) => ({ name: `${name}, ${map.slice(folder.length + 1)}`, project: { files: near, root, map } }));
  });
}

/** The inputs that come with an example, if there are some. */
export function inputs(root) {
  try {
    return read(root.replace("examples/", "examples/inputs/").replace(/\.hyped$/, ".inputs"));
  } catch {
    return null;
  }
}
