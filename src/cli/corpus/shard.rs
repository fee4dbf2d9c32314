//! `--shard I/N`: which questions of a run over many levels this machine asks.

use crate::corpus::{Key, PlannedQuestion, SHARD_VERSION, ShardHeader, shards};
use crate::ir::Program;
use crate::json::{self, Layout};
use crate::reach::query::Kind;

use super::files::read;
use super::level::Level;
use crate::cli::args::ReachArgs;
use crate::cli::refusal::Refusal;
use crate::cli::report::{program_sha256, sha256};

/// The header of the shard that is asked for; none without `--shard`.
///
/// Why there is no such shard, or why the costs cannot be read.
pub(super) fn header(
    args: &ReachArgs,
    (program, world): (&Program, &str),
    levels: &[Level],
    targets: &[(Kind, String)],
) -> Result<Option<ShardHeader>, Refusal> {
    let Some(shard) = args.corpus.shard else { return Ok(None) };
    if args.corpus.baseline.is_some() {
        return Err(Refusal::Plain(
            "`--baseline` compares whole runs: join the shards by `hypedc merge`, then give the joined file as \
                    `--results` to the same command without `--shard`, which asks nothing again"
                .to_string(),
        ));
    }
    let key = |level: &Level, (kind, goal): &(Kind, String)| Key {
        level: level.path.as_ref().map(|path| path.display().to_string()),
        kind: *kind,
        goal: goal.clone(),
    };
    let keys: Vec<Key> = levels.iter().flat_map(|level| targets.iter().map(move |target| key(level, target))).collect();
    if shard.count as usize > keys.len() {
        return Err(Refusal::Plain(format!(
            "`--shard {shard}`: {} questions (levels: {}, goals: {}) make at most as many shards",
            keys.len(),
            levels.len(),
            targets.len()
        )));
    }
    let costs = match &args.corpus.costs {
        Some(path) => Some(read(path, "the `--results` file of an older run")?),
        None => None,
    };
    // What has failed took no time; it may have been mended.
    let cost = |key: &Key| {
        let row = &costs.as_ref()?.rows.get(key)?.row;
        row.error.is_none().then_some(row.timing.seconds + row.timing.analysis_seconds)
    };
    let of = shards(&keys.iter().map(cost).collect::<Vec<_>>(), shard.count);
    let plan = json::bytes(&(&keys, &of), Layout::Compact).map_err(|error| Refusal::Plain(error.to_string()))?;
    let questions = keys.len();
    let part = keys.into_iter().zip(of).enumerate().filter(|(_, (_, of))| *of == shard.index);
    Ok(Some(ShardHeader {
        shard: SHARD_VERSION,
        of: shard,
        file: args.file.display().to_string(),
        world: world.to_string(),
        program_sha256: program_sha256(program),
        plan_sha256: sha256(&plan),
        questions,
        part: part.map(|(at, (key, _))| PlannedQuestion { at, key }).collect(),
    }))
}

/// Whether each question of the run is asked: all of them without a shard.
pub(super) fn is_asked(shard: Option<&ShardHeader>, questions: usize) -> Vec<bool> {
    let mut is_asked = vec![shard.is_none(); questions];
    for question in shard.iter().flat_map(|header| &header.part) {
        if let Some(is) = is_asked.get_mut(question.at) {
            *is = true;
        }
    }
    is_asked
}
