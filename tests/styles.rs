//! Ways in a style: each is best in what counts first for it, replays, and takes no more time than it may.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::Path;

use crate::support::{Disk, assert_leads_to, program};
use hypedc::compile::compile;
use hypedc::ir::WorldId;
use hypedc::reach::query::{Query, Session};
use hypedc::reach::{Limits, Plan, Settings, Style, Target, Verdict};
use hypedc::sim::Simulator;
use hypedc::watch::Unwatched;

const WORLD: WorldId = WorldId(0);

fn hasty(plan: &Plan) -> usize {
    let parts = &plan.script.steps;
    parts[..parts.len() - 1].iter().filter(|part| part.count < 12).count()
}

#[test]
fn a_way_in_a_style_is_best_in_what_counts_there() {
    for (name, goal) in [("platforms", "flag"), ("switch_door", "inside"), ("paper/test2", "drawn")] {
        let program = program(compile(Path::new(&format!("examples/{name}.hyped")), &Disk));
        let world = &program.worlds[WORLD];
        let goal = world.goals.pairs().find(|(_, g)| g.name == goal).unwrap().0;
        let sim = Simulator::new(&program, WORLD);
        let found = Style::ALL.map(|style| {
            let query = Query {
                settings: Settings::default(),
                limits: Limits { nodes: 40_000, ..Limits::default() },
                style: Some(style),
                ..Query::new(vec![Target::Goal(goal)])
            };
            let session = Session::new(&program, WORLD, query, &Unwatched);
            let found = session.find(Target::Goal(goal), &Unwatched).unwrap();
            let Verdict::Reached(plan) = found.outcome.verdict else { panic!("{name}: not found") };
            assert_leads_to(&sim, &plan.script, goal);
            plan
        });
        let [fast, calm, few] = &found;
        let changes = |plan: &Plan| plan.script.steps.len();
        assert!(changes(few) <= changes(fast) && changes(few) <= changes(calm), "{name}");
        assert!(hasty(calm) <= hasty(fast) && hasty(calm) <= hasty(few), "{name}");
        assert!(found.iter().all(|plan| plan.steps <= fast.steps * 2), "{name}");
    }
}
