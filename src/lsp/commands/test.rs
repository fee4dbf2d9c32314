//! `test`: runs the tests of a program, in order.

use std::collections::BTreeSet;

use super::{Monitor, TestArguments, named};
use crate::ask::{Loaded, Refusal, open_world};
use crate::compile::{Changes, TestCase};
use crate::ir::WorldId;
use crate::lsp::buffers::Buffers;
use crate::suite::{CoverageResult, NoWays, Subject, SuiteResult, TestOptions, run_test};
use crate::why::{Covered, PlaceCoverage};

/// Maximum number of nodes of a search, where none is given: that of `hypedc test`.
const NODES: u64 = 200_000;

pub(super) fn run(arguments: &TestArguments, buffers: &Buffers, monitor: &dyn Monitor) -> Result<SuiteResult, String> {
    let TestArguments { program, tests: wanted, nodes, seed, coverage } = arguments;
    let numbers = program.numbers()?;
    let (loaded, mut tests) = program.load(&Changes { numbers: &numbers, ..Changes::default() }, buffers)?;
    let all = tests.len();
    tests.retain(|case| {
        (wanted.is_empty() || wanted.contains(&case.name))
            && program.world.as_ref().is_none_or(|world| *world == case.world_name)
    });
    if tests.is_empty() {
        let why = if all == 0 { "the program has no tests" } else { "the program has no such test" };
        return Err(why.to_string());
    }
    has_maps(&loaded, &tests)?;
    let (seed, nodes) = (seed.unwrap_or(1), nodes.unwrap_or(NODES).max(1));
    let path = named(&program.path);
    let subject = Subject { file: &path, level: program.level(), numbers: &numbers, files: buffers };
    let options = TestOptions { nodes, seed, covers: *coverage, ways: &NoWays };
    let mut result = SuiteResult::new(seed, nodes, all - tests.len());
    let mut sum = Covered::new(&loaded.program);
    let first = monitor.seconds();
    for (index, case) in tests.iter().enumerate() {
        if monitor.stop() {
            result.not_run = tests.len() - index;
            break;
        }
        monitor.part(index, tests.len(), &case.name);
        let started = monitor.seconds();
        let mut tested = run_test(&subject, (&loaded.program, &loaded.sources), case, &options, monitor);
        tested.result.seconds = monitor.seconds() - started;
        result.add(tested.result);
        tested.covered.iter().for_each(|covered| sum.add(covered));
    }
    result.seconds = monitor.seconds() - first;
    if *coverage {
        let worlds: BTreeSet<WorldId> = tests.iter().map(|case| case.world).collect();
        let mut places = PlaceCoverage::default();
        places.add(sum.places(&loaded.program, &loaded.sources, &worlds));
        result.coverage = Some(CoverageResult::new(&places));
    }
    Ok(result)
}

/// Refuses tests of worlds that leave their map open.
fn has_maps(loaded: &Loaded, tests: &[TestCase]) -> Result<(), String> {
    let worlds: BTreeSet<WorldId> = tests.iter().map(|case| case.world).collect();
    let open = worlds.iter().find_map(|world| open_world(&loaded.program.worlds[*world]));
    open.map_or(Ok(()), |why| Err(Refusal::of(why).sentence(&loaded.sources)))
}
