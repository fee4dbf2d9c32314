//! The arguments, as data.

pub(in crate::cli) mod gif;
pub(in crate::cli) mod level;
pub(in crate::cli) mod output;
pub(in crate::cli) mod page;
pub(in crate::cli) mod robust;
pub(in crate::cli) mod script;
pub(in crate::cli) mod set;
pub(in crate::cli) mod why;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::reach::{Planner, Restart, Style};

pub(in crate::cli) use gif::GifArgs;
pub(in crate::cli) use level::{LevelArgs, ReadingArgs, seconds};
use output::output;
pub(in crate::cli) use page::PageArgs;
pub(in crate::cli) use robust::PersonArgs;
pub(in crate::cli) use script::ScriptArgs;
pub(in crate::cli) use set::SetArgs;
pub(in crate::cli) use why::WhyArgs;

use crate::cli::corpus::args::CorpusArgs;
use crate::cli::diff::args::DiffArgs;
use crate::cli::experiment::args::ExperimentArgs;
use crate::cli::merge::args::MergeArgs;
use crate::cli::stuck::args::StuckArgs;
use crate::cli::test::args::TestArgs;
use crate::cli::time::{Hold, Time};
use crate::cli::tune::args::TuneArgs;

/// Compiles, simulates and analyses action-game entities written as hybrid automata.
#[derive(Debug, Parser)]
#[command(version, about, propagate_version = true)]
pub(in crate::cli) struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub(in crate::cli) enum Command {
    /// Reports what is wrong with programs.
    Check(CheckArgs),
    /// Puts programs into their canonical layout.
    Fmt(FmtArgs),
    /// Converts entities and levels of other systems to programs.
    #[command(subcommand)]
    Import(ImportCommand),
    /// Prints the flat intermediate representation of a program.
    Ir(IrArgs),
    /// Runs a world with given inputs.
    Sim(SimArgs),
    /// Opens a page in the browser to play, scrub, change and question a world.
    Play(PlayArgs),
    /// Searches for inputs that reach a world's goals, or proves that there are none.
    Reach(Box<ReachArgs>),
    /// Joins the results of `hypedc reach` on several machines, and says what is missing.
    Merge(MergeArgs),
    /// Explains a step of a run: which edge was taken, and why not another.
    Why(WhyArgs),
    /// Finds where a player gets stuck: places from which a goal cannot be reached.
    Stuck(StuckArgs),
    /// Finds the smallest change of a number, or of a level, that turns an answer.
    Tune(TuneArgs),
    /// Runs the tests that programs hold.
    Test(TestArgs),
    /// Compares two programs: what changed, how players move, which answers differ.
    Diff(DiffArgs),
    /// Runs planners many times over the same goals, and compares them in tables.
    Experiment(ExperimentArgs),
    /// Explains the code of a finding, or a word of the language.
    Explain(ExplainArgs),
    /// Shows the values that each part of a world can have.
    Bounds(BoundsArgs),
    /// Draws the modes and edges of entities.
    Graph(GraphArgs),
    #[cfg(feature = "lsp")]
    /// Runs the language server over standard input and output.
    Lsp(LspArgs),
    /// Creates a folder with a small project to start from.
    New(NewArgs),
    /// Prints completions for a shell.
    Completions(CompletionsArgs),
    /// Prints a page of the manual.
    Man(ManArgs),
}

#[cfg(feature = "lsp")]
#[derive(Debug, Args)]
pub(in crate::cli) struct LspArgs {
    /// Uses standard input and output, the only transport; editors pass it by convention.
    #[arg(long)]
    pub stdio: bool,
}

/// How findings are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum FindingFormat {
    /// With excerpts of the source.
    Human,
    /// One line a finding: FILE:LINE:COL: error[CODE]: message
    Short,
    /// One JSON object for all files.
    Json,
    /// SARIF 2.1.0, for code hosts and editors.
    Sarif,
}

/// How results are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum ResultFormat {
    /// For people.
    Human,
    /// For programs.
    Json,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct CheckArgs {
    /// The programs to check.
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub level: LevelArgs,
    /// How findings are shown.
    #[arg(long, value_enum, default_value = "human")]
    pub format: FindingFormat,
    /// What makes the command fail (exit code 1), in addition to errors.
    #[arg(long, value_enum, value_name = "WHAT")]
    pub deny: Option<Denied>,
    /// Applies the fixes that are certain, in the files and in their imports from the same folder or below.
    #[arg(long)]
    pub fix: bool,
}

/// What `--deny` rejects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum Denied {
    /// All warnings; they are still shown as warnings.
    Warnings,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct FmtArgs {
    /// The programs to rewrite; `-` reads standard input and writes standard output.
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Changes nothing; lists the programs that would change.
    #[arg(long)]
    pub check: bool,
}

/// The formats that are imported.
#[derive(Debug, Subcommand)]
pub(in crate::cli) enum ImportCommand {
    /// Entity definitions of the 2017 HyPED system, `NAME.char.xml`.
    Xml(ImportXmlArgs),
    /// A dungeon of The Legend of Zelda from the Video Game Level Corpus: a world of rooms, doors and monsters.
    ZeldaDungeon(ImportZeldaArgs),
}

#[derive(Debug, Args)]
pub(in crate::cli) struct ImportZeldaArgs {
    /// The dungeons, such as `tloz1_1.txt`.
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// The program that has the entities `Link` and `Monster`, as the worlds import it.
    #[arg(long, value_name = "PATH", default_value = "link.hyped")]
    pub entities: String,
    #[command(flatten)]
    pub into: ImportInto,
}

/// Where imported text goes, and findings.
#[derive(Debug, Args)]
pub(in crate::cli) struct ImportInto {
    /// Writes `NAME.hyped` for each file into this folder [default: `-`, standard output].
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Replaces files that exist.
    #[arg(long, requires = "output")]
    pub force: bool,
    /// How findings are shown, on standard error.
    #[arg(long, value_enum, default_value = "human")]
    pub format: FindingFormat,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct ImportXmlArgs {
    /// The files to import.
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub into: ImportInto,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct BoundsArgs {
    /// The program.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    #[command(flatten)]
    pub level: LevelArgs,
    /// The world, where the program has several.
    #[arg(long, value_name = "NAME")]
    pub world: Option<String>,
    #[command(flatten)]
    pub numbers: SetArgs,
    /// As tables for people, or as JSON.
    #[arg(long, value_enum, default_value = "human")]
    pub format: ResultFormat,
    /// Writes the table of a sweep to a CSV file.
    #[arg(long, value_name = "PATH", value_parser = output())]
    pub csv: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct IrArgs {
    /// The program.
    #[arg(value_name = "FILE", required_unless_present = "schema")]
    pub file: Option<PathBuf>,
    /// Prints the JSON Schema of compiled programs instead.
    #[arg(long, conflicts_with_all = ["file", "map", "legend", "tile", "set", "format"])]
    pub schema: bool,
    #[command(flatten)]
    pub level: LevelArgs,
    #[command(flatten)]
    pub numbers: SetArgs,
    /// As text for people, or as JSON.
    #[arg(long, value_enum, default_value = "human")]
    pub format: ResultFormat,
}

#[derive(Debug, Args)]
#[command(
    after_help = "A script is steps separated by blanks: `right*40 right+jump*12 -*10` holds right for 40 steps, \
right and jump for 12, nothing for 10. `steer=-1` sets an axis; `left right down up` are the ends of `horizontal` and \
`vertical`; `2:jump` is player 2's; `nature:hero.roll=3` is what the chance `roll` of `hero` draws."
)]
pub(in crate::cli) struct SimArgs {
    /// The program; with `--replay`, a program to use instead of the one in the trace.
    #[arg(value_name = "FILE", required_unless_present = "replay")]
    pub file: Option<PathBuf>,
    #[command(flatten)]
    pub level: LevelArgs,
    /// The world, where the program has several.
    #[arg(long, value_name = "NAME")]
    pub world: Option<String>,
    #[command(flatten)]
    pub numbers: SetArgs,
    #[command(flatten)]
    pub script: ScriptArgs,
    /// The number of steps to run; a longer script is cut, after a shorter one there is no input.
    #[arg(long, value_name = "N")]
    pub frames: Option<u64>,
    /// The seed of what nature draws where the script leaves it open: `seed=7` [default: seed=0].
    #[arg(long, value_name = "seed=N", value_parser = chance_seed)]
    pub chance: Option<u64>,
    /// Writes every state to a file; `-` for standard output.
    #[arg(long, value_name = "PATH")]
    pub trace: Option<PathBuf>,
    /// How states are written [default: CSV if the file's name ends in `.csv`, else JSON lines].
    #[arg(long, value_enum, value_name = "FORMAT", requires = "trace")]
    pub trace_format: Option<TraceFormatName>,
    /// As text for people, or as JSON.
    #[arg(long, value_enum, default_value = "human")]
    pub format: ResultFormat,
    /// Writes the table of a sweep to a CSV file.
    #[arg(long, value_name = "PATH", value_parser = output())]
    pub csv: Option<PathBuf>,
    /// Draws the run to an SVG file: the level, the ways of all that moves, the goals that were reached.
    #[arg(long, value_name = "PATH", value_parser = output())]
    pub svg: Option<PathBuf>,
    #[command(flatten)]
    pub animation: GifArgs,
    #[command(flatten)]
    pub page: PageArgs,
    /// Fails unless this goal, or this predicate, has held by the end of the run.
    #[arg(long, value_name = "GOAL|PREDICATE")]
    pub expect: Vec<String>,
    /// Fails if this goal, `never` or predicate has held at any step.
    #[arg(long, value_name = "NAME|PREDICATE")]
    pub expect_not: Vec<String>,
    /// Repeats the run of a trace from its header, and compares each line.
    #[arg(
        long,
        value_name = "TRACE",
        conflicts_with_all = ["world", "inputs", "inputs_file", "frames", "chance", "trace", "svg", "csv", "gif", "html", "set", "expect", "expect_not", "format"]
    )]
    pub replay: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(
    after_help = "The page works on this machine only, at the address that is printed; without the token in it nothing is \
answered. A change of the file on the disk is played at once."
)]
pub(in crate::cli) struct PlayArgs {
    /// The program.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    #[command(flatten)]
    pub level: LevelArgs,
    #[command(flatten)]
    pub numbers: SetArgs,
    /// The port of the page; 0 chooses a free one.
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    pub port: u16,
    /// Only prints the address of the page.
    #[arg(long)]
    pub no_open: bool,
    /// Writes one HTML file that plays without a network and without hypedc, instead of serving the page; `-` for standard
    /// output.
    #[arg(long, value_name = "PATH", conflicts_with_all = ["port", "no_open", "set"])]
    pub export: Option<PathBuf>,
    /// The engine for the file, a module of WebAssembly; needed if hypedc was built without one.
    #[arg(long, value_name = "PATH", requires = "export")]
    pub engine: Option<PathBuf>,
}

/// How traces are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum TraceFormatName {
    /// A row a line, under a header in a comment and the names of the columns.
    Csv,
    /// A JSON object a line, the header first.
    Jsonl,
}

#[derive(Debug, Args)]
#[command(after_help = "Scripts are those of `hypedc sim`. A predicate is one of the program's language, such as \
`hero.keys > 0` or `hero in running`. A time is written `30s`, `500ms` or `30frames` (steps of the world).

Exit codes: 0 if every question is answered as expected (a goal reached, a `never` proven); 1 if an answer is no, or there is \
none (a goal not found or proven unreachable, a `never` violated or not answered, a proof withdrawn); 2 if a question could \
not be asked.

Every state that a search makes is checked against the analysis. If the analysis excludes one, it is wrong about this world: no \
proof that rests on it is given, a file `hypedc-refuted-WORLD-SEED.txt` says how to reproduce it, and the exit code is 1.")]
pub(in crate::cli) struct ReachArgs {
    /// The program.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// The level of worlds that leave their map open. Several levels are searched one by one; a folder means all levels in
    /// it: `.txt`, `.tmx` and `.tmj` files.
    #[arg(long, value_name = "PATH", num_args(1..))]
    pub map: Vec<PathBuf>,
    #[command(flatten)]
    pub reading: ReadingArgs,
    /// The world, where the program has several.
    #[arg(long, value_name = "NAME")]
    pub world: Option<String>,
    #[command(flatten)]
    pub numbers: SetArgs,
    /// A goal to reach, or a predicate that is to hold, such as `hero.x > 300`; can be given several times [default: all
    /// goals of the world].
    #[arg(long, value_name = "NAME|PREDICATE", help_heading = "The question")]
    pub goal: Vec<String>,
    /// A `never` to break, or a predicate that should never hold: searches for a counterexample.
    #[arg(long, value_name = "NAME|PREDICATE", help_heading = "The question")]
    pub never: Vec<String>,
    /// Asks no question: goes wherever it can, and reports what was covered: rooms, tiles that were stood on, modes, edges.
    #[arg(long, conflicts_with_all = ["goal", "never", "minimize", "style", "save_inputs", "html", "results", "csv", "junit", "baseline"], help_heading = "The question")]
    pub explore: bool,
    /// Only paths on which a predicate never holds: is the key needed, or the run button?
    #[arg(long, value_name = "PREDICATE", help_heading = "The question")]
    pub without: Option<String>,
    /// Only paths that take at most this time from where the search begins, such as `600frames` or `10s`.
    #[arg(long, value_name = "TIME", value_parser = Time::read, help_heading = "The question")]
    pub within: Option<Time>,
    /// Begins in the state that an input script leads to; can be given several times.
    #[arg(long, value_name = "SCRIPT", allow_hyphen_values = true, help_heading = "The question")]
    pub after: Vec<String>,
    /// Visits all states if `auto` has found nothing: at most 20 for each node, in 20 to 30 bytes each. Instances that
    /// cannot help are left out.
    #[arg(long, help_heading = "The search")]
    pub exhaust: bool,
    /// Only inputs that are held for at least this time, such as `12frames` or `200ms`. An input is that of all players
    /// together; when the time is over, it can change at any step.
    #[arg(long, value_name = "TIME", value_parser = Time::read, help_heading = "The question")]
    pub min_hold: Option<Time>,
    /// What nature draws, as `hypedc sim` draws it: `seed=7` [default: the search is free to choose it, and the answer says
    /// how much luck that takes].
    #[arg(long, value_name = "seed=N", value_parser = chance_seed, help_heading = "The question")]
    pub chance: Option<u64>,
    /// The planner that searches.
    #[arg(long, value_name = "NAME", default_value = "auto", value_parser = planner(), help_heading = "The search")]
    pub planner: String,
    /// Where samples are drawn from.
    #[arg(long, value_enum, value_name = "BOUNDS", default_value = "reduced", help_heading = "The search")]
    pub bounds: SampleBounds,
    /// What distances are measured in.
    #[arg(long, value_enum, value_name = "METRIC", default_value = "full", help_heading = "The search")]
    pub metric: MetricName,
    /// The time for which planners hold an input: `10frames`, or `10frames..1s` to draw it for each extension [default:
    /// 10 steps; 4 to 60 for `coverage`; 1 to 60 for `distance-guided` and `ledge-guided`; 8, 12 or 16 for `time-guided`; 6,
    /// 8 or 12 for `beam`; as short as the question allows for `exhaustive` and `best-first`].
    #[arg(long, value_name = "TIME|A..B", value_parser = Hold::read, help_heading = "The search")]
    pub hold: Option<Hold>,
    /// The number of nodes of the shortest tree before a restart, or `never` [default: 100000 for `distance-guided`
    /// and `ledge-guided`, 20000 for `coverage`, 2000 for others; the trees of `time-guided` and `beam` grow as they go on].
    #[arg(long, value_name = "N|never", value_parser = restart, help_heading = "The search")]
    pub restart: Option<Restart>,
    /// The number of trees that grow side by side, each with its own seed.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..), help_heading = "The search")]
    pub trees: u16,
    /// The number of threads for trees, levels, points of a sweep, plays and exhaustion; the result does not depend on it
    /// [default: the number of cores].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), help_heading = "The search")]
    pub threads: Option<u16>,
    /// The seed: the same seed gives the same search.
    #[arg(long, value_name = "N", default_value_t = 1, help_heading = "The search")]
    pub seed: u64,
    /// Does not check every state against the analysis. For measuring the cost of these checks: without them, a mistake of
    /// the analysis, and of the proofs that rest on it, goes unnoticed.
    #[arg(long, help_heading = "The search")]
    pub no_check_states: bool,
    /// Maximum number of nodes for each goal [default: 200000; with `--seconds` no limit].
    #[arg(long, value_name = "N", help_heading = "The budget")]
    pub nodes: Option<u64>,
    /// Maximum time for each goal, s; for the first one, the analysis of the world included.
    #[arg(long, value_name = "S", value_parser = seconds, help_heading = "The budget")]
    pub seconds: Option<f64>,
    /// Maximum memory for the trees of a search, MiB.
    #[arg(long, value_name = "MIB", default_value_t = 2048, help_heading = "The budget")]
    pub memory: u64,
    /// As text for people, or as JSON.
    #[arg(long, value_enum, default_value = "human", help_heading = "The result")]
    pub format: ResultFormat,
    /// Searches for faster paths than the one that is found, with at most as many nodes again, and removes changes of
    /// inputs that are not needed: as `--style fast`.
    #[arg(long, help_heading = "The result")]
    pub minimize: bool,
    /// Searches for better paths than the one that is found, with at most twice as many nodes again.
    #[arg(long, value_enum, value_name = "STYLE", conflicts_with = "minimize", help_heading = "The result")]
    pub style: Option<StyleName>,
    /// Writes the inputs of a found path to a file; with several goals, the goal's name goes before the extension.
    #[arg(long, value_name = "PATH", value_parser = output(), help_heading = "The result")]
    pub save_inputs: Option<PathBuf>,
    /// Draws the level, the coverage, the tree and the path to an SVG file; with several goals as above.
    #[arg(long, value_name = "PATH", value_parser = output(), help_heading = "The result")]
    pub svg: Option<PathBuf>,
    /// Adds all nodes to the JSON result.
    #[arg(long, help_heading = "The result")]
    pub tree: bool,
    /// Shows the verdicts only.
    #[arg(short, long, conflicts_with = "verbose", help_heading = "The result")]
    pub quiet: bool,
    /// Shows whole input scripts on a terminal, too, where they are otherwise cut to a line.
    #[arg(short, long, help_heading = "The result")]
    pub verbose: bool,
    #[command(flatten)]
    pub page: PageArgs,
    #[command(flatten)]
    pub person: PersonArgs,
    #[command(flatten)]
    pub corpus: CorpusArgs,
}

/// Where a search draws its samples from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum SampleBounds {
    /// A box: the level for positions, ±1000 for velocities and accelerations, all combinations of modes.
    Naive,
    /// The values that are possible in each combination of modes, as `hypedc bounds` shows them.
    Reduced,
}

/// What a search measures distances in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum MetricName {
    /// The whole state.
    Full,
    /// The players' positions.
    Xy,
}

/// How a path is to be played.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum StyleName {
    /// As fast as can be found, then with few changes of inputs.
    Fast,
    /// Without inputs that are held for less than 0.2 s, then with few changes, then fast.
    Calm,
    /// With few changes of inputs, then fast.
    FewInputs,
}

impl StyleName {
    pub fn style(self) -> Style {
        match self {
            StyleName::Fast => Style::Fast,
            StyleName::Calm => Style::Calm,
            StyleName::FewInputs => Style::FewInputs,
        }
    }
}

pub(in crate::cli) fn chance_seed(text: &str) -> Result<u64, String> {
    let seed = text.strip_prefix("seed=").and_then(|seed| seed.parse().ok());
    seed.ok_or_else(|| "a seed is written `seed=7`".to_string())
}

fn restart(text: &str) -> Result<Restart, String> {
    match (text, text.parse()) {
        ("never", _) => Ok(Restart::Never),
        (_, Ok(nodes)) if nodes > 1 => Ok(Restart::After(nodes)),
        _ => Err("a number of nodes above 1, or `never`".to_string()),
    }
}

fn planner() -> clap::builder::PossibleValuesParser {
    clap::builder::PossibleValuesParser::new(
        Planner::ALL.map(|p| clap::builder::PossibleValue::new(p.name()).aliases(p.former_name()).help(p.summary())),
    )
}

#[derive(Debug, Args)]
pub(in crate::cli) struct ExplainArgs {
    /// Codes such as E0302, and words such as `touching` [default: a list of all codes].
    #[arg(value_name = "CODE")]
    pub codes: Vec<String>,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct GraphArgs {
    /// The program.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    #[command(flatten)]
    pub numbers: SetArgs,
    /// An entity to draw [default: all of the program].
    #[arg(long, value_name = "NAME")]
    pub entity: Vec<String>,
    /// What is written to standard output.
    #[arg(long, value_enum, default_value = "svg")]
    pub format: GraphFormat,
}

/// A language for pictures of graphs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum GraphFormat {
    /// For Graphviz.
    Dot,
    /// A Mermaid `stateDiagram-v2`.
    Mermaid,
    /// A self-contained picture.
    Svg,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct NewArgs {
    /// The folder to create; it must not exist.
    #[arg(value_name = "NAME", value_parser = output())]
    pub name: PathBuf,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct CompletionsArgs {
    /// The shell.
    #[arg(value_enum, value_name = "SHELL")]
    pub shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct ManArgs {
    /// The subcommand that the page is about [default: the whole command].
    #[arg(value_name = "COMMAND")]
    pub command: Option<String>,
}
