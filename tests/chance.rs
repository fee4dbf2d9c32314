//! Nature draws: runs from seeds and scripts, searches with luck and its probability, proofs for all luck.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::sync::Arc;

use crate::support::{compile_text, program, script};
use hypedc::ir::{GoalId, NeverId, Program, WorldId};
use hypedc::reach::query::{Answer, Query, Session};
use hypedc::reach::{Conclusion, Luck, Planner, Settings, Target};
use hypedc::sim::{Input, Run, Script, Simulator, parse_script};
use hypedc::source::SourceMap;
use hypedc::watch::Unwatched;

const WORLD: WorldId = WorldId(0);

/// Wins with a six and then another one, after the button was pressed.
const TWO_SIXES: &str = "
entity Gambler {
    button go
    chance roll: 1..6
    chance colour: 0..3
    mode waiting { when pressed(go) -> first }
    mode first {
        when roll == 6 -> second
        else -> lost
    }
    mode second {
        when roll == 6 -> won
        else -> lost
    }
    mode won { when colour > 1 -> rich }
    mode rich { }
    mode lost { }
}
world Table {
    space main { place hero: Gambler at (0, 0) }
    player 1: hero
    goal won: hero in won
    goal rich: hero in rich
    goal first: hero in first
    never lost: hero in lost
}";

fn compiled(text: &str) -> Arc<Program> {
    program(compile_text(text))
}

fn refused(program: &Program, text: &str) -> String {
    let file = SourceMap::new().add("inputs", text);
    let (_, found) = parse_script(program, WORLD, file, text);
    let all: Vec<String> = found.iter().map(|d| format!("{} {:?}", d.message, d.helps)).collect();
    all.join("\n")
}

fn answers(program: &Arc<Program>, query: Query) -> Vec<Answer> {
    let session = Session::new(program, WORLD, query, &Unwatched);
    let mut found = session.find_all(&mut (&Unwatched as &dyn hypedc::watch::Watch)).unwrap();
    found.iter_mut().map(|found| session.answer(found, &SourceMap::new())).collect()
}

fn by(planner: Planner, target: Target) -> Query {
    let settings = Settings { planner, ..Settings::default() };
    Query { settings, ..Query::new(vec![target]) }
}

/// The state after a script, which draws all that is read.
fn holds_after(program: &Arc<Program>, text: &str, seed: u64, goal: GoalId) -> bool {
    let mut run = Run::new(program, WORLD).unwrap();
    run.set_seed(seed);
    script(program, text).inputs().for_each(|input| run.step(input).unwrap());
    run.simulator().goal(run.state(), goal).unwrap()
}

fn words(luck: Option<Luck>) -> String {
    luck.map_or("none".into(), |luck| luck.words())
}

#[test]
fn every_planner_is_lucky_and_says_how_much() {
    let program = compiled(TWO_SIXES);
    for planner in Planner::ALL {
        let goal = GoalId(0);
        let answer = answers(&program, by(planner, Target::Goal(goal))).remove(0);
        assert_eq!(answer.verdict, Conclusion::Reached, "{}", planner.name());
        // Two sixes, and nothing else that is drawn.
        assert_eq!(words(answer.luck), "1 in 36", "{}", planner.name());
        let inputs = answer.inputs.unwrap();
        assert_eq!(inputs.matches("roll=6").count() + inputs.matches("roll=6*2").count(), 2, "{inputs}");
        assert!(!inputs.contains("colour"), "{inputs}");
        // What is not read plays no part.
        for seed in 0..5 {
            assert!(holds_after(&program, &inputs, seed, goal), "{inputs}");
        }
    }
}

#[test]
fn several_draws_with_the_same_effect_count_together() {
    let program = compiled(TWO_SIXES);
    let one = |target| answers(&program, by(Planner::Exhaustive, target)).remove(0);
    let rich = one(Target::Goal(GoalId(1)));
    // Half of the colours.
    assert_eq!((words(rich.luck).as_str(), rich.is_shortest, rich.steps), ("1 in 72", Some(true), Some(4)));
    let first = one(Target::Goal(GoalId(2)));
    assert_eq!((words(first.luck).as_str(), first.steps), ("1 in 1", Some(1)));
    let lost = one(Target::Never(NeverId(0)));
    assert_eq!((words(lost.luck).as_str(), lost.verdict), ("5 in 6", Conclusion::Violated));
    let met = answers(&program, by(Planner::Rrt, Target::Goal(GoalId(1)))).remove(0).violations;
    assert!(met.iter().all(|met| ["5 in 6", "5 in 36"].contains(&words(met.luck).as_str())), "{met:?}");
}

/// Draws that depend on each other: no bound of values excludes what exhaustion has to.
#[test]
fn exhaustion_holds_for_all_luck() {
    let text = |guard: &str| {
        format!(
            "entity Die {{
                chance a: 1..3
                chance b: 1..3
                discrete sum: int 0..6 = 0
                discrete product: int 0..9 = 0
                mode on {{ when {guard} {{ sum := a + b; product := a * b }} }}
            }}
            world Table {{
                space main {{ place die: Die at (0, 0); place other: Die at (9, 0) }}
                goal odd: die.sum == 4 and die.product == 5
                goal even: die.sum == 4 and die.product == 3
                goal both: die.sum == 6 and other.sum == 2
            }}"
        )
    };
    let program = compiled(&text("true"));
    let one = |goal| answers(&program, by(Planner::Exhaustive, Target::Goal(GoalId(goal)))).remove(0);
    let odd = one(0);
    assert_eq!(odd.verdict, Conclusion::ProvenUnreachable, "{odd:?}");
    assert_eq!(odd.states, Some(37));
    assert!(odd.reasons[0].contains("all that nature can draw"), "{odd:?}");
    let even = one(1);
    // 1 and 3 or 3 and 1, whatever the other one draws.
    assert_eq!((words(even.luck).as_str(), even.is_shortest), ("2 in 9", Some(true)));
    assert_eq!(words(one(2).luck), "1 in 81");
    // An input that is held is no choice of nature.
    let held = Query { min_hold: 3, ..by(Planner::Exhaustive, Target::Goal(GoalId(0))) };
    let held = answers(&program, held).remove(0);
    assert_eq!((held.verdict, held.draws_left_out), (Conclusion::NotFound, true));
    // Of a wide range not all is tried, and nothing is proven.
    let program =
        compiled(&text("true").replace("1..3", "1..1000").replace("0..6 ", "0..2000 ").replace("0..9", "0..1000000"));
    let odd = answers(&program, by(Planner::Exhaustive, Target::Goal(GoalId(0)))).remove(0);
    assert_eq!((odd.verdict, odd.draws_left_out), (Conclusion::NotFound, true));
}

#[test]
fn too_many_draws_give_a_lower_bound() {
    let text = TWO_SIXES.replace("roll: 1..6", "roll: 1..10000").replace("roll == 6", "roll > 5000");
    let program = compiled(&text);
    let answer = answers(&program, by(Planner::Coverage, Target::Goal(GoalId(0)))).remove(0);
    assert_eq!(answer.verdict, Conclusion::Reached);
    assert_eq!(words(answer.luck), "at least 1 in about 1.00e8");
    assert!(!answer.luck.unwrap().is_exact);
}

#[test]
fn a_seed_is_one_future() {
    let program = compiled(TWO_SIXES);
    for planner in [Planner::Exhaustive, Planner::BestFirst, Planner::Coverage, Planner::Auto] {
        let answer = answers(&program, Query { chance: Some(3), ..by(planner, Target::Goal(GoalId(0))) }).remove(0);
        assert_eq!((answer.verdict, answer.luck), (Conclusion::Reached, None), "{}", planner.name());
        let inputs = answer.inputs.unwrap();
        assert!(!inputs.contains("nature") && holds_after(&program, &inputs, 3, GoalId(0)), "{inputs}");
        assert!(!(4..20).all(|seed| holds_after(&program, &inputs, seed, GoalId(0))), "{inputs}");
    }
    // Losing by pressing at once is another matter: the search waits for its luck.
    let query = Query { chance: Some(3), within: Some(2), ..by(Planner::Exhaustive, Target::Goal(GoalId(0))) };
    assert_eq!(answers(&program, query).remove(0).verdict, Conclusion::NotFound);
}

#[test]
fn a_search_begins_where_the_given_draws_lead() {
    let program = compiled(TWO_SIXES);
    let after =
        |text: &str| Query { after: vec![script(&program, text)], ..by(Planner::Auto, Target::Goal(GoalId(0))) };
    let answer = answers(&program, after("go nature:roll=6")).remove(0);
    // The first six is given.
    assert_eq!((words(answer.luck).as_str(), answer.steps), ("1 in 6", Some(3)));
    assert_eq!(answer.inputs.as_deref(), Some("go nature:roll=6*2"));
}

#[test]
fn scripts_draw_what_they_say_and_seeds_the_rest() {
    let program = compiled(TWO_SIXES);
    assert!(holds_after(&program, "go nature:roll=6*2", 0, GoalId(0)));
    assert!(!holds_after(&program, "go nature:roll=6 nature:roll=5", 0, GoalId(0)));
    assert!(holds_after(&program, "go nature:hero.roll=6+nature:colour=2*2 nature:hero.colour=3", 0, GoalId(1)));
    let text = "go+nature:roll=6 nature:roll=6+nature:colour=0*2 -";
    assert_eq!(script(&program, text).text(&program, WORLD), text);
    // A sixth of the first rolls, and a sixth of those after.
    let wins = (0..3_600).filter(|seed| holds_after(&program, "go - -", *seed, GoalId(0))).count();
    assert!((70..130).contains(&wins), "{wins}");
    assert!(refused(&program, "nature:rol=1").contains("no chance `rol`"));
    assert!(refused(&program, "nature:roll=7").contains("1 to 6"));
    assert!(refused(&program, "nature:roll").contains("write `nature:roll=1`"));
    assert!(refused(&program, "nature:=1").contains("no chance ``"));
    let two = compiled(&TWO_SIXES.replace("at (0, 0) }", "at (0, 0); place foe: Gambler at (0, 0) }"));
    assert!(refused(&two, "nature:roll=1").contains("write `nature:hero.roll=1`"));
    let text = "nature:foe.roll=2+nature:hero.colour=1";
    assert_eq!(script(&two, text).text(&two, WORLD), "nature:hero.colour=1+nature:foe.roll=2");
    let none = compiled(&TWO_SIXES.replace("chance", "// chance").replace("roll == 6", "x > 6").replace("colour", "x"));
    assert!(refused(&none, "nature:roll=1").contains("no instance of this world has a `chance`"));
}

/// What a seed draws for an instance does not depend on which others there are, nor on what they do.
#[test]
fn a_run_says_what_was_drawn_and_replays() {
    let program = compiled(TWO_SIXES);
    let sim = Simulator::new(&program, WORLD);
    let (hero, mut told) = (sim.draw_named("hero", "roll").unwrap(), Script::default());
    let mut run = Run::new(&program, WORLD).unwrap();
    run.set_seed(11);
    let go = run.simulator().control(1, "go").unwrap();
    let mut input = run.nothing();
    for step in 1..=40 {
        input.set(go, if step == 5 { 1.0 } else { 0.0 });
        run.step(&input).unwrap();
        let drawn = run.drawn(&input);
        // Only in `first` and `second` anything is read.
        assert_eq!(drawn.1.get(hero).is_some(), (6..=7).contains(&step) && !drawn.1.is_empty(), "{step}");
        assert_eq!(drawn.1.get(hero), drawn.1.get(hero).and(sim.draw(11, step, &Input::default()).1.get(hero)));
        told.push(&drawn, 1);
    }
    let mut again = Run::new(&program, WORLD).unwrap();
    again.set_seed(99);
    told.inputs().for_each(|input| again.step(input).unwrap());
    assert_eq!((again.state(), again.steps()), (run.state(), 40));
    assert!(sim.draw_named("hero", "rol").is_none() && sim.draw_named("foe", "roll").is_none());
}

/// Instances of a pool draw, too, each for itself.
#[test]
fn what_is_spawned_draws() {
    let program = compiled(
        "entity Cannon {
            chance speed_of: 1..2
            param unit: px/s = 60
            mode on { when true { spawn Ball(push = unit * speed_of) } }
        }
        entity Ball {
            param push: px/s = 60
            chance way: 0..1
            discrete up: bool = false
            x' = push
            mode on { when timer > 0 { up := way == 1 } }
        }
        world Field {
            limit Ball 2
            space main { place cannon: Cannon at (0, 0) }
            goal apart: count(Ball) == 2 and any Ball and not all Ball in on
            goal fast: all Ball in on and count(Ball) == 2
        }",
    );
    let sim = Simulator::new(&program, WORLD);
    assert_eq!(sim.draws().len(), 3);
    let answer = answers(&program, by(Planner::Exhaustive, Target::Goal(GoalId(1)))).remove(0);
    assert_eq!((answer.verdict, words(answer.luck).as_str()), (Conclusion::Reached, "1 in 2"));
}

/// What is sent is read in the step that sends it: inputs and draws that nothing else reads are tried, too.
#[test]
fn what_only_a_signal_reads_is_tried() {
    let program = compiled(
        "entity Gambler {
            button go
            chance roll: 1..6
            signal paid(points: 1)
            discrete total: int 0..9 = 0
            mode on {
                when total == 0 { send self.paid(if(held(go), roll, 0)) }
                when received(paid) { total := min(floor(paid.points), 9) }
            }
        }
        world Table {
            space main { place hero: Gambler at (0, 0) }
            player 1: hero
            goal five: hero.total == 5
            goal seven: hero.total == 7
        }",
    );
    let one = |goal| answers(&program, by(Planner::Exhaustive, Target::Goal(GoalId(goal)))).remove(0);
    let five = one(0);
    assert_eq!((five.verdict, words(five.luck).as_str()), (Conclusion::Reached, "1 in 6"), "{five:?}");
    assert_eq!(five.inputs.as_deref(), Some("go+nature:roll=5 -"), "{five:?}");
    assert_eq!(one(1).verdict, Conclusion::ProvenUnreachable);
}
