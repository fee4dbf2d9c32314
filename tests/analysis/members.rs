//! What questions to the instances of an entity prove, and what they leave open; what only such a question reads is
//! tried.

use std::sync::Arc;

use hypedc::analysis::configuration_space;
use hypedc::ir::{GoalId, Program, WorldId};
use hypedc::reach::query::{Query, Session};
use hypedc::reach::{Conclusion, Planner, Settings, Target};
use hypedc::source::SourceMap;
use hypedc::watch::{Unwatched, Watch};

use crate::support::{compile_text, program};

const WORLD: WorldId = WorldId(0);

fn world(asks: &str) -> Arc<Program> {
    let text = format!(
        "entity Crate {{
            button push
            discrete n: int 0..9 = 0
            param last: px = 40
            collider crate: rect(0, 0, 8, 8)
            mode off {{ when x >= last -> on }}
            mode on {{ }}
            x' = 20
            clamp x in 0..50
        }}
        entity Bomb {{ mode lit {{ when timer > 1s {{ destroy self }} }} }}
        entity Ghost {{ mode seen {{ }} }}
        entity Hero {{
            button drop, go
            axis side
            param reach: px = 10
            ref first: Crate
            collider body: rect(0, 0, 8, 8)
            mode still {{
                when pressed(drop) {{ spawn Bomb }}
                {asks} -> done
            }}
            mode done {{ }}
        }}
        world W {{
            step 1/10
            space main {{
                place hero: Hero at (0, 0) {{ first = one }}
                place one: Crate at (8, 0)
                place two: Crate at (16, 0) {{ last = 60 }}
            }}
            space other {{ place ghost: Ghost at (0, 0) }}
            limit Bomb 2
            player 1: hero
            goal there: hero in done
        }}"
    );
    program(compile_text(&text))
}

#[test]
fn what_no_number_of_instances_can_do_is_ruled_out() {
    for (guard, ruled_out) in [
        ("count(Crate) == 2", false),
        ("count(Crate) != 2", true),
        ("count(Crate in on) == 1", false),
        ("count(Crate in on) > 1", true),
        ("all Crate in on", true),
        ("any Crate in on", false),
        ("not any Crate in off", true),
        ("all Crate.x > 45", false),
        ("any Crate.x > 51", true),
        ("any Crate.x < 8", true),
        ("count(Bomb) > 1", false),
        ("count(Bomb) > 2", true),
        ("count(Bomb) + count(Crate) == 5", true),
        ("nearest Ghost", true),
        ("nearest Hero", true),
        ("nearest Bomb", false),
        ("nearest Crate within 7 as c and c.x > 1", true),
        ("nearest Crate within 45 as c and c.x > 30", false),
        ("near(any Crate, (200, 0), 149)", true),
        ("near(any Crate, self, 60)", false),
        ("distance(first) > 51", true),
        ("distance(first) > 45", false),
        ("near(first, self, 7)", true),
        ("all Crate.n == 0 and count(Hero in still) == 0", true),
        ("all Crate.n == 0 and count(Hero in still) == 1", false),
    ] {
        let program = world(&format!("when {guard}"));
        let goal = program.worlds[WORLD].goals.ids().next().unwrap();
        let space = configuration_space(&program, WORLD);
        assert_eq!(!space.can_hold(&program, WORLD, goal), ruled_out, "{guard}");
        if !ruled_out {
            assert_eq!(exhausted(&program), Conclusion::Reached, "{guard}");
        }
    }
}

/// The answer of an exhaustive search.
fn exhausted(program: &Arc<Program>) -> Conclusion {
    let settings = Settings { planner: Planner::Exhaustive, ..Settings::default() };
    let query = Query { settings, ..Query::new(vec![Target::Goal(GoalId(0))]) };
    let session = Session::new(program, WORLD, query, &Unwatched);
    let mut found = session.find_all(&mut (&Unwatched as &dyn Watch)).unwrap();
    session.answer(&mut found[0], &SourceMap::new()).verdict
}

#[test]
fn what_only_a_question_reads_is_tried() {
    for guard in [
        "any Crate.x + reach * side < 0",
        "count(Crate) < if(held(go), 3, 2)",
        "nearest Crate within (if(held(go), 9, 1)) as c and c.x < 20",
        "near(any Crate, (if(held(go), 8, -99), 0), 4)",
        "distance((if(held(go), 0, 50), 0)) < 1",
    ] {
        assert_eq!(exhausted(&world(&format!("when {guard}"))), Conclusion::Reached, "{guard}");
    }
}
