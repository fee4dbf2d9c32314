//! The analysis for all values of a parameter at once, against runs with some of these values: random worlds in which
//! much happens, one parameter of which is any number of an interval.

use std::path::Path;

use hypedc::analysis::{Interval, ParamRange, Varied};
use hypedc::compile::{Changes, NumberSetting, compile_changed};
use hypedc::ir::{Expr, ParamId, Program, WorldId};
use hypedc::reach::Monitor;
use hypedc::sim::Simulator;
use hypedc::watch::Unwatched;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::choices::choices;
use super::frame::Frame;
use super::generate::program;
use super::run::Inputs;
use crate::support::Text;

/// The length of a run.
const STEPS: usize = 120;
/// One in this many worlds is also told apart by place.
const BY_PLACE: u64 = 5;

/// What was looked at.
#[derive(Debug, Default)]
pub struct Varieties {
    /// Worlds with a parameter that is varied.
    pub worlds: u64,
    /// Those in which something of the instances that begin is not known.
    pub is_read: u64,
    /// Those in which a goal is ruled out for all values.
    pub ruled_out: u64,
    /// States that were compared.
    pub states: u64,
    /// Worlds in which another value, outside of the interval, leads outside: what is claimed is not that all is possible.
    pub bites: u64,
    /// What was claimed and is not so.
    pub reports: Vec<String>,
}

/// The program with a parameter set.
fn with(text: &str, path: &str, value: f64) -> Option<std::sync::Arc<Program>> {
    let value = format!("{value}");
    let numbers = [NumberSetting { path, value: &value }];
    let changes = Changes { numbers: &numbers, ..Changes::default() };
    compile_changed(Path::new("test.hyped"), Default::default(), &changes, &Text(text)).program
}

/// Varies one parameter of the world with a number.
pub fn vary(seed: u64, out: &mut Varieties) {
    let text = program(&choices(seed), Frame::default());
    let Some(plain) = hypedc::compile::compile(Path::new("test.hyped"), &Text(&text)).program else { return };
    let mut rng = Pcg64::seed_from_u64(seed ^ 0x7475_6e65);
    let params = plain.entities.pairs().flat_map(|(id, entity)| {
        entity
            .params
            .ids()
            .filter(|param| entity.params[*param].name != "start.x")
            .map(move |param| (id, param))
            .collect::<Vec<_>>()
    });
    let literal = |of: &(hypedc::ir::EntityId, ParamId)| {
        let param = &plain.entities[of.0].params[of.1];
        matches!(plain.exprs[param.default], Expr::Number(_)) && !param.name.starts_with("start.")
    };
    let params: Vec<_> = params.filter(literal).collect();
    if params.is_empty() {
        return;
    }
    let (entity, param) = params[rng.random_range(0..params.len())];
    let of = &plain.entities[entity];
    let Expr::Number(base) = plain.exprs[of.params[param].default] else { return };
    let path = format!("{}.{}", of.name, of.params[param].name);
    let wide = [0.05, 0.5, 2.0][rng.random_range(0..3)] * (base.abs() + 1.0);
    let (low, high) = (base - wide * rng.random_range(0.0..1.0), base + wide * rng.random_range(0.0..1.0));
    let Some(first) = with(&text, &path, low) else { return };
    let values = Interval { low, high };
    let Some(varied) = Varied::new(&first, WorldId(0), &[ParamRange { entity, param, values }]) else { return };
    let mut space = varied.space(&[], &Unwatched);
    if seed.is_multiple_of(BY_PLACE) {
        space = varied.by_place(space, &[], &Unwatched);
    }
    out.worlds += 1;
    out.is_read += u64::from(first.worlds[WorldId(0)].slots.iter().any(|slot| slot.entity == entity));
    let goals: Vec<_> = first.worlds[WorldId(0)].goals.pairs().map(|(id, goal)| (id, goal.holds)).collect();
    let ruled_out: Vec<_> = goals.into_iter().filter(|(_, holds)| !varied.can_hold(&space, *holds)).collect();
    out.ruled_out += u64::from(!ruled_out.is_empty());
    for turn in 0..5 {
        let value = [low, high, base, rng.random_range(low..high), high + 3.0 * wide][turn];
        let is_beyond = turn == 4;
        let Some(program) = with(&text, &path, value) else { continue };
        let sim = Simulator::new(&program, WorldId(0));
        let monitor = Monitor::new(&space, &program, WorldId(0));
        let mut scratch = sim.scratch();
        let Ok(mut state) = sim.initial(&mut scratch) else { continue };
        let mut inputs = Inputs::new(seed + turn as u64, &sim);
        for step in 0..STEPS {
            if sim.left_bounds(&state).is_some() {
                break;
            }
            out.states += 1;
            let outside = monitor.outside(&sim, &state);
            if is_beyond {
                if outside.is_some() {
                    out.bites += 1;
                    break;
                }
            } else if let Some(outside) = outside {
                out.reports.push(format!("{seed}: {path} = {value} of {low}..{high}, step {step}: {outside}\n{text}"));
                return;
            }
            if !is_beyond && ruled_out.iter().any(|(goal, _)| sim.goal(&state, *goal).unwrap_or(false)) {
                out.reports.push(format!("{seed}: {path} = {value} of {low}..{high}, step {step}: a goal\n{text}"));
                return;
            }
            if sim.step(&mut state, inputs.next(), &mut scratch).is_err() {
                break;
            }
        }
    }
}
