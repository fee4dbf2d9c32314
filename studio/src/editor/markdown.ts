// The Markdown of hovers as elements: headings, paragraphs, lists, code, rules, emphasis. Links are shown as their text.

/** Adds code and emphasis within a line. */
function inline(parent: HTMLElement, text: string): void {
  const plain = text.replace(/\[([^\]]+)\]\([^)]*\)/g, "$1");
  for (const part of plain.split(/(`[^`]+`|\*\*[^*]+\*\*)/)) {
    if (part.startsWith("`") && part.length > 2) {
      parent.appendChild(document.createElement("code")).textContent = part.slice(1, -1);
    } else if (part.startsWith("**") && part.length > 4) {
      parent.appendChild(document.createElement("strong")).textContent = part.slice(2, -2);
    } else if (part !== "") {
      parent.append(part.replaceAll("\\", ""));
    }
  }
}

/** The elements of a text. */
export function markdown(text: string): HTMLElement {
  const out = document.createElement("div");
  out.className = "markdown";
  let paragraph: HTMLElement | null = null;
  let list: HTMLElement | null = null;
  let code: HTMLElement | null = null;
  for (const line of text.split("\n")) {
    if (line.startsWith("```")) {
      code = code === null ? out.appendChild(document.createElement("pre")) : null;
      paragraph = list = null;
      continue;
    }
    if (code !== null) {
      code.append(`${line}\n`);
      continue;
    }
    const heading = /^#+ (.*)/.exec(line);
    const item = /^\s*[-*] (.*)/.exec(line);
    if (line.trim() === "") paragraph = list = null;
    else if (/^---+$/.test(line)) {
      out.appendChild(document.createElement("hr"));
      paragraph = list = null;
    } else if (heading?.[1] !== undefined) {
      inline(out.appendChild(document.createElement("h4")), heading[1]);
      paragraph = list = null;
    } else if (item?.[1] !== undefined) {
      list ??= out.appendChild(document.createElement("ul"));
      inline(list.appendChild(document.createElement("li")), item[1]);
      paragraph = null;
    } else {
      if (paragraph === null) paragraph = out.appendChild(document.createElement("p"));
      else paragraph.append(" ");
      inline(paragraph, line.replace(/\s+$/, ""));
      list = null;
    }
  }
  return out;
}
