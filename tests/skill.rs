//! Who gets where: layers by how long inputs are held, without a button, and without what a predicate tells. What must
//! hold of them is worked out by hand; each way is replayed.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::Path;
use std::sync::Arc;

use hypedc::compile::{Asked, Changes, ExtraQuestion, LevelFile, compile_changed};
use hypedc::ir::{GoalId, Program, WorldId};
use hypedc::reach::query::layers::{Layer, LayerSession, Skill, share_proofs};
use hypedc::reach::query::{Query, Session};
use hypedc::reach::{Conclusion, Planner, Target};
use hypedc::sim::{Simulator, parse_script};
use hypedc::source::{FileId, SourceMap};
use hypedc::watch::Unwatched;

use crate::support::Text;

/// A floor with two gaps under spikes, 42 px above a body of 22 px. A jump of 240 px/s that ends when the button is let
/// go of rises `240 t - 300 t^2` in a hold of t s, and 80 px/s carry it on by at most 5 px.
const SPIKES: &str = "
entity Hero {
    param speed = 90
    button jump, wave
    axis horizontal
    collider body: rect(0, 0, 12, 22)
    x' = speed * sign(horizontal)
    clamp y' >= -240
    y'' = -600
    initial mode ground {
        when pressed(jump) -> rising { y' := 240 }
        when not touching(body, rock, below) -> falling
    }
    mode rising {
        when not held(jump) or y' <= 0 -> falling { y' := min(y', 80) }
    }
    mode falling {
        when touching(body, rock, below) -> ground
    }
}
world Spikes {
    step 1/60
    collide body with rock: block
    collide body with spike: sense
    tiles land 16 x 16 { '.': empty; '#': rock; '^': spike; 'H': spawn Hero as hero }
    space main {
        bounds rect(0, 0, 256, 128)
        map land \"
            #..............#
            #..^^^^^^^^^^..#
            #..............#
            #..............#
            #..............#
            #H.............#
            #####..##..#####
            #####^^##^^#####
        \"
    }
    player 1: hero
    goal across: hero.x > 200 and hero.y >= 32
    goal above: hero.y' > 300
    never died: hero touching spike
}
";

/// Layers of a program about its goals, in the order of the skills; the last goal is one that nothing reaches.
fn layers(text: &'static str, skills: &[Skill], planner: Planner, nodes: u64) -> (Arc<Program>, Vec<Layer>) {
    let nowhere = [ExtraQuestion { asked: Asked::Goal, world: None, text: "false", origin: "test" }];
    let changes = Changes { questions: &nowhere, ..Changes::default() };
    let compiled = compile_changed(Path::new("test.hyped"), LevelFile::default(), &changes, &Text(text));
    let (sources, program) = (compiled.sources, compiled.program.unwrap());
    let goals: Vec<GoalId> = program.worlds[WorldId(0)].goals.ids().collect();
    let (nowhere, goals) = goals.split_last().unwrap();
    let mut query = Query::new(goals.iter().map(|goal| Target::Goal(*goal)).collect());
    query.settings.planner = planner;
    query.limits.nodes = nodes;
    let mut found: Vec<Layer> = Vec::new();
    for skill in skills {
        let session = Session::new(&program, WorldId(0), skill.query(&query), &Unwatched);
        let of = LayerSession { session: &session, skill: skill.clone(), nowhere: Target::Goal(*nowhere) };
        found.push(of.layer(&found, &sources, &mut |_, work| work(&Unwatched)).unwrap());
    }
    share_proofs(&mut found);
    (program, found)
}

/// Replays the way to a goal; the numbers of steps for which its inputs are held, and what is written of them.
fn way(program: &Arc<Program>, layer: &Layer, goal: usize) -> (Vec<u64>, String) {
    let answer = &layer.answers[goal].answer;
    let inputs = answer.inputs.clone().unwrap();
    let mut sources = SourceMap::new();
    let file: FileId = sources.add("inputs", inputs.clone());
    let (script, found) = parse_script(program, WorldId(0), file, &inputs);
    assert!(!found.has_errors());
    let sim = Simulator::new(program, WorldId(0));
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    for input in script.inputs() {
        sim.step(&mut state, input, &mut scratch).unwrap();
        assert!(sim.violated(&state).unwrap().is_none());
    }
    assert!(sim.holds(&state, program.worlds[WorldId(0)].goals[GoalId(goal as u32)].holds).unwrap(), "{inputs}");
    assert_eq!(answer.steps, Some(script.len()));
    let runs = script.inputs().collect::<Vec<_>>();
    (runs.chunk_by(|a, b| a == b).map(|run| run.len() as u64).collect(), inputs)
}

#[test]
fn who_presses_slowly_hits_the_spikes() {
    let skills = [Skill::Hold(20), Skill::Hold(14), Skill::Hold(5), Skill::Unpressed(vec![1]), Skill::Any];
    let (program, found) = layers(SPIKES, &skills, Planner::Auto, 3_000);
    let verdicts = |goal: usize| found.iter().map(|layer| layer.answers[goal].answer.verdict).collect::<Vec<_>>();
    // After 14 steps it is at 39.7 px and still rises: 42 are reached. After 5 it is at 17.9 px, and 5 more are few.
    use Conclusion::{NotFound, ProvenUnreachable, Reached};
    assert_eq!(verdicts(0), [NotFound, NotFound, Reached, NotFound, Reached]);
    assert_eq!(verdicts(1), [ProvenUnreachable; 5]);
    assert_eq!(found.iter().map(|layer| layer.answers[0].of).collect::<Vec<_>>(), [0, 1, 2, 3, 2]);
    let (holds, inputs) = way(&program, &found[2], 0);
    assert!(holds.split_last().unwrap().1.iter().all(|steps| *steps >= 5), "{inputs}");
    // Who has more inputs was wherever those with fewer were.
    for (a, b) in [(0, 1), (1, 2), (2, 4), (3, 4)] {
        assert!(found[a].seen.cells.is_subset(&found[b].seen.cells));
    }
    // Without a jump nobody stands beyond the first gap.
    let stood =
        |layer: &Layer| layer.seen.explored.spaces[0].tops.iter().filter(|top| top.is_covered && top.y > 20.0).count();
    assert_eq!(stood(&found[3]), 4);
    assert!(stood(&found[4]) > 6 && stood(&found[2]) > 6);
}

#[test]
fn a_proof_without_a_button_says_nothing_of_others() {
    // All states are visited: without the jump there are few.
    let (program, found) = layers(SPIKES, &[Skill::Unpressed(vec![1]), Skill::Any], Planner::Exhaustive, 20_000);
    let answer = |layer: usize| &found[layer].answers[0].answer;
    assert_eq!(answer(0).verdict, Conclusion::ProvenUnreachable);
    let reasons = answer(0).reasons.join("; ");
    assert!(reasons.contains("inputs with `held(jump)` were not tried"), "{reasons}");
    assert_ne!(answer(1).verdict, Conclusion::ProvenUnreachable);
    // What is not pressed is in no input, also where nothing reads it.
    let (_, found) = layers(SPIKES, &[Skill::Unpressed(vec![2])], Planner::Auto, 3_000);
    let (_, inputs) = way(&program, &found[0], 0);
    assert!(inputs.contains("jump") && !inputs.contains("wave"), "{inputs}");
}

#[test]
fn a_proof_about_more_inputs_is_one_about_fewer() {
    let skills = [Skill::Hold(30), Skill::Unpressed(vec![2]), Skill::Any];
    let (_, found) = layers(SPIKES, &skills, Planner::Auto, 100);
    let with = |verdicts: [Conclusion; 3]| {
        let (_, mut layers) = layers(SPIKES, &skills, Planner::Auto, 100);
        for ((layer, from), verdict) in layers.iter_mut().zip(&found).zip(verdicts) {
            layer.answers = vec![from.answers[1].clone()];
            layer.answers[0].answer.verdict = verdict;
        }
        share_proofs(&mut layers);
        layers.iter().map(|layer| layer.answers[0].answer.verdict).collect::<Vec<_>>()
    };
    use Conclusion::{NotFound, ProvenUnreachable, Reached};
    assert_eq!(with([NotFound, NotFound, ProvenUnreachable]), [ProvenUnreachable; 3]);
    assert_eq!(with([ProvenUnreachable, NotFound, NotFound]), [ProvenUnreachable, NotFound, NotFound]);
    assert_eq!(with([NotFound, ProvenUnreachable, Reached]), [NotFound, ProvenUnreachable, Reached]);
}
