// Colours `.hyped` code blocks of the book. `tests/docs.rs` compares the words with the grammar's.
(function () {
  const reserved =
    "and or not in is as if true false none self timer param continuous discrete ref button axis " +
    "collider kinematic clamp invariant group mode when else envelope use spawn destroy entity behavior " +
    "world import const";
  const contextual =
    "int bool always initial by fixed directions attack decay sustain for release while instant accel " +
    "over hold to follow links step collide with block sense from above keep velocity carry bounce tiles " +
    "space player condition chance signal look send goal never limit map place at link rect bounds wrap legend vglc " +
    "level tiled ldtk tile slope breakable restore after any all touching nearest within " +
    "test inputs seed expect end reachable unreachable unfound without";
  hljs.registerLanguage("hyped", () => ({
    name: "hyped",
    keywords: { keyword: reserved, built_in: contextual },
    contains: [
      hljs.C_LINE_COMMENT_MODE,
      { className: "string", begin: '"', end: '"' },
      // A tile; the quotes of a derivative follow a name.
      { className: "string", begin: "'.':" },
      { className: "title", begin: /\b(?<=\b(?:entity|behavior|world|mode|group|space)\s+)\w+/ },
      { className: "number", begin: /\b\d+(?:\.\d+)?/ },
    ],
  }));
  for (const block of document.querySelectorAll("code.language-hyped")) {
    hljs.highlightBlock(block);
  }
})();
