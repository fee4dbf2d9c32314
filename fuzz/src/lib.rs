//! What the fuzz targets do with their bytes.

#[path = "../../tests/analysis/outside.rs"]
mod outside;

use std::path::Path;
use std::sync::Arc;

use hypedc::analysis::configuration_space;
use hypedc::compile::{Compilation, LevelFile, check_with, compile};
use hypedc::diagnostic::fix;
use hypedc::diagnostic::render::{self, Found};
use hypedc::format::format;
use hypedc::graph::{Chart, chart, dot, mermaid, svg};
use hypedc::ir::{self, Program, WorldId};
use hypedc::reach::Monitor;
use hypedc::sim::{Input, Simulator};
use hypedc::source::{FileId, Files, ReadError, SourceMap, decode};
use hypedc::syntax::parse;
use outside::{goes_on, outside, ruled_out};

/// The program that is looked at.
const ROOT: &str = "test.hyped";

/// Files in memory: bytes under their names.
struct Memory<'a>(&'a [(&'a str, &'a [u8])]);

impl Files for Memory<'_> {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        match self.0.iter().find(|(name, _)| path == Path::new(name)) {
            Some((_, bytes)) => decode(bytes.to_vec()),
            None => Err(ReadError::Unreadable("no such file".into())),
        }
    }
}

/// What the examples import.
const IMPORTED: &[(&str, &[u8])] = &[
    ("entities/patrol.hyped", include_bytes!("../../examples/entities/patrol.hyped")),
    ("entities/runner.hyped", include_bytes!("../../examples/entities/runner.hyped")),
    ("entities/swordsman.hyped", include_bytes!("../../examples/entities/swordsman.hyped")),
    ("mario.hyped", include_bytes!("../../examples/paper/mario.hyped")),
    ("platforms.hyped", include_bytes!("../../examples/paper/platforms.hyped")),
    ("robot.hyped", include_bytes!("../../examples/paper/robot.hyped")),
];

/// A program: all that can be asked of it is answered. Whether it compiles.
pub fn check(bytes: &[u8]) -> bool {
    let files: Vec<(&str, &[u8])> = [(ROOT, bytes)].into_iter().chain(IMPORTED.iter().copied()).collect();
    let compiled = check_with(Path::new(ROOT), LevelFile::default(), &Memory(&files));
    shown(&compiled);
    mended(&compiled);
    if let Some(program) = &compiled.program {
        drawn(&compiled.sources, program);
        program.worlds.ids().take(2).for_each(|world| run(program, world));
    }
    compiled.program.is_some()
}

/// A legend, a line `====`, a map: in programs that read the map in every way there is. Whether one of them compiles.
pub fn levels(bytes: &[u8]) -> bool {
    const LINE: &[u8] = b"\n====\n";
    let cut = bytes.windows(LINE.len()).position(|part| part == LINE);
    let (legend, map) = cut.map_or((bytes, bytes), |at| (&bytes[..at], &bytes[at + LINE.len()..]));
    let root = format!(
        "entity A {{
            collider body: rect(0, 0, 8, 8)
            mode a {{ x' = 30; y'' = -300; when touching(body, solid, below) -> a {{ y' := 200 }} }}
        }}
        world Text {{
            collide body with solid: block
            tiles land 16 x 16 {{ '-': empty; 'X': solid; 'E': spawn A as foe; 'é': solid, \"question block\" }}
            space main {{ map land from \"map.txt\"
                place a: A at (32, 32) }}
            limit A 9
        }}
        world Inline {{
            collide body with solid: block
            tiles land 16 x 16 {{ '-': empty; 'X': solid; 'E': spawn A as foe }}
            space main {{ map land \"\n{}\n\"
                place a: A at (32, 32) }}
            limit A 9
        }}
        world Vglc {{
            collide body with solid, \"question block\": block
            space main {{ map vglc \"map.txt\" legend \"legend.json\" tile 16 x 8 {{ 'E': spawn A as foe }}
                place a: A at (32, 32) }}
            limit A 9
        }}\n",
        String::from_utf8_lossy(map)
    );
    let mut is_taken = compiled(&[(ROOT, root.as_bytes()), ("map.txt", map), ("legend.json", legend)]);
    // The same bytes as levels of editors; what is before the line is the file that they name.
    for map_line in ["map tiled \"map.txt\"", "map ldtk \"map.txt\""] {
        let root = format!(
            "entity A {{ param speed = 1; collider body: rect(0, 0, 8, 8); x' = speed }}
            world Editor {{
                collide body with solid: block
                space main {{ {map_line} {{ solid: solid; foe: spawn A }} }}
            }}\n"
        );
        is_taken |= compiled(&[(ROOT, root.as_bytes()), ("map.txt", map), ("beside", legend)]);
    }
    is_taken
}

/// Files compiled and shown, and their worlds run. Whether they compile.
fn compiled(files: &[(&str, &[u8])]) -> bool {
    let compiled = compile(Path::new(ROOT), &Memory(files));
    shown(&compiled);
    if let Some(program) = &compiled.program {
        program.worlds.ids().for_each(|world| run(program, world));
    }
    compiled.program.is_some()
}

/// A program to be laid out: the layout of a layout is itself, and means the same. Whether it can be.
pub fn fmt(bytes: &[u8]) -> bool {
    let Ok(text) = decode(bytes.to_vec()) else { return false };
    let Ok(once) = format(FileId(0), &text) else { return false };
    let twice = format(FileId(0), &once).expect("what is laid out can be laid out");
    assert_eq!(once, twice, "the layout of a layout is itself");
    assert_eq!(meaning(&text), meaning(&once), "it means the same");
    true
}

/// The syntax tree without its places, and the comments.
fn meaning(text: &str) -> (String, Vec<String>) {
    let (tree, found) = parse(FileId(0), text);
    assert!(!found.has_errors());
    let items = format!("{:?}", tree.items);
    let mut parts = items.split("file0[");
    let first = parts.next().unwrap_or("").to_string();
    let tree = parts.fold(first, |tree, part| tree + part.split_once(']').map_or("", |(_, after)| after));
    (tree, comments(text))
}

/// The comments of a text without mistakes, whatever the blanks in them: what stands behind `//` outside of quotes.
fn comments(text: &str) -> Vec<String> {
    let mut out = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find('"').into_iter().chain(rest.find("//")).min() {
        rest = &rest[at..];
        if let Some(quoted) = rest.strip_prefix('"') {
            rest = quoted.split_once('"').map_or("", |(_, after)| after);
        } else {
            let (comment, after) = rest.split_once('\n').unwrap_or((rest, ""));
            out.push(comment.split_whitespace().collect::<Vec<_>>().join(" "));
            rest = after;
        }
    }
    out
}

/// Every finding, in every format.
fn shown(compiled: &Compilation) {
    let Compilation { sources, diagnostics, .. } = compiled;
    for label in diagnostics.iter().flat_map(|d| d.primary.iter().chain(&d.secondary)) {
        assert!(label.span.range().end <= sources.file(label.span.file()).text().len(), "{label:?}");
    }
    let found = [Found { path: Path::new(ROOT), sources, diagnostics }];
    assert_eq!(render::short(sources, diagnostics.iter()).is_empty(), diagnostics.is_empty());
    render::human(sources, diagnostics.iter(), false);
    render::human(sources, diagnostics.iter(), true);
    render::json(&found).expect("findings are JSON");
    render::sarif(&found, Path::new("/home")).expect("findings are SARIF");
}

/// Fixes that go together can be made.
fn mended(compiled: &Compilation) {
    let chosen = fix::compatible_fixes(compiled.diagnostics.iter(), |_| true);
    for (file, edits) in fix::by_file(chosen.iter().map(|(_, fix)| *fix)) {
        let text = compiled.sources.file(file).text();
        assert!(fix::apply_edits(text, &edits).is_some_and(|new| new != text), "{edits:?}");
    }
}

fn drawn(sources: &SourceMap, program: &Program) {
    let charts: Vec<Chart> = program.entities.ids().map(|id| chart(program, sources, id)).collect();
    for text in [dot(&charts), mermaid(&charts), svg(&charts)] {
        // A program without entities has empty pictures.
        assert!(!text.is_empty() || charts.is_empty());
    }
    assert_eq!(ir::text(program).is_empty(), program.entities.is_empty() && program.worlds.is_empty());
}

/// Fifty steps, every button held in turn; a fault is an answer, too. The same step gives the same state, and none is
/// outside of what the analysis of values has found.
fn run(program: &Arc<Program>, world: WorldId) {
    let sim = Simulator::new(program, world);
    let mut scratch = sim.scratch();
    let Ok(mut state) = sim.initial(&mut scratch) else { return };
    let space = configuration_space(program, world);
    let guard = Monitor::new(&space, program, world);
    let mut input = Input::nothing(program.worlds[world].players.len());
    for step in 0..50u64 {
        if !goes_on(&sim, &state) {
            return;
        }
        assert_eq!(outside(&sim, &guard, &state), None, "step {step}");
        assert_eq!(ruled_out(program, &sim, &space, &state), None, "step {step}");
        for player in &mut input.0 {
            player.buttons = 1 << (step / 4 % 8);
            player.axes[0] = [-1.0, 0.0, 1.0][(step / 7 % 3) as usize];
        }
        let mut twin = state.clone();
        let first = sim.step(&mut state, &input, &mut scratch);
        let second = sim.step(&mut twin, &input, &mut sim.scratch());
        assert_eq!(first, second);
        if first.is_err() {
            return;
        }
        assert_eq!(state, twin);
    }
}
