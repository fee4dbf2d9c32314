//! Guided by ledges: looks for the inputs that lead a player onto the next ledge, by local search.
//!
//! A contact is chosen first and then a motion to it, as in Hauser and Latombe, *Multi-Modal Motion Planning in Non-Expansive
//! Spaces*, 2010; ledges (`ledges.rs`) are the contacts. A motion is a few inputs, each held for some steps, the last one
//! until the player lands. How far it has missed the ledges nearby is measured, and the motion that came nearest to one is
//! changed a little, at random, as in a (1+1) evolution strategy (Rechenberg 1973): where only a jump from the last pixels of
//! a pillar reaches the next one, this tells which jumps nearly did. Ledges near the goal come first, each the less often the
//! more was tried.

use std::sync::Arc;

use rand::RngExt;

use crate::reach::distance::DistanceField;
use crate::reach::ledges::{Gauge, Ledges};
use crate::reach::metric::Point;
use crate::reach::search_context::SearchContext;
use crate::reach::strategy::{Choice, Growth, Strategy};
use crate::reach::tree::NodeId;
use crate::sim::Input;

use super::Guidance;

/// Maximum number of inputs of a motion, and of a new one.
const LEGS: usize = 6;
const FIRST_LEGS: usize = 4;
/// Number of times that the last one is held again if the player has not landed.
const AGAIN: u32 = 1;
/// A motion that has missed a ledge by more is not changed to reach it, px.
const MISS: f64 = 16.0;
/// After so many changes in a row that brought a motion no nearer to its ledge, it is given up for another.
const FAILED: u32 = 24;
/// Maximum number of nodes on a ledge from which motions begin.
const STANDS: usize = 24;
/// The cost of a ledge per place on the way from it to the goal; per motion from it or to it 1.
const PER_PLACE: u64 = 64;
/// Maximum number of extensions in a row without a new node.
const FRUITLESS: u32 = 5_000;
/// One input in this number may be any; others differ in one control from that before, if one of some tries does.
const ANY_ONE_IN: u32 = 4;
const TRIES: u32 = 8;

/// One input of a motion, with the node from which it is held.
#[derive(Debug, Clone, Copy)]
struct Leg {
    node: NodeId,
    /// Its number.
    input: u16,
    /// Steps; the last one is held until the player lands.
    hold: u16,
}

/// A motion.
#[derive(Debug, Clone, Copy)]
struct Motion {
    legs: [Leg; LEGS],
    count: usize,
}

/// The motion that came nearest to a ledge.
#[derive(Debug, Clone, Copy)]
struct Elite {
    /// How far it has missed the ledge, px.
    miss: f64,
    motion: Motion,
    /// Number of changes since then.
    failed: u32,
}

/// What is known of a ledge.
#[derive(Debug, Default)]
struct Site {
    /// Nodes in which the player stands on it, and how many there were.
    stands: Vec<NodeId>,
    stood: u32,
    elite: Option<Elite>,
    /// The ledge from which a motion came near.
    from: Option<u32>,
    /// Number of motions from it and to it.
    tried: u32,
    /// The distance from it to the goal, places.
    places: u32,
    /// The ledges near it.
    near: Arc<[u32]>,
}

/// A motion that is tried.
#[derive(Debug, Clone, Copy)]
struct Attempt {
    motion: Motion,
    /// The leg that is next, and how often the last one may be held again.
    at: usize,
    again: u32,
    node: NodeId,
    /// The ledge from which it began.
    from: u32,
}

/// A strategy that leads players from ledge to ledge.
#[derive(Debug)]
pub struct LedgeGuided<'m> {
    distances: Option<&'m DistanceField>,
    ledges: Arc<Ledges>,
    sites: Vec<Site>,
    /// Those on which the player has stood, or that it has nearly reached.
    open: Vec<u32>,
    /// What motions do, by number.
    inputs: Vec<Input>,
    attempt: Option<Attempt>,
    /// Number of extensions in a row after which there was no new node.
    fruitless: u32,
}

impl<'m> LedgeGuided<'m> {
    /// A strategy with what leads to the goal.
    pub fn new(guidance: Guidance<'m>) -> Self {
        LedgeGuided {
            distances: guidance.distances,
            ledges: guidance.ledges.cloned().unwrap_or_else(|| Arc::new(Ledges::none())),
            sites: Vec::new(),
            open: Vec::new(),
            inputs: Vec::new(),
            attempt: None,
            fruitless: 0,
        }
    }

    /// The number of the site that is no ledge: where the search begins in the air, and every place if there are no ledges.
    fn elsewhere(&self) -> u32 {
        self.ledges.len() as u32
    }

    /// Opens a ledge to attempts.
    fn open(&mut self, context: &SearchContext<'_>, ledge: u32) {
        let (sim, state) = (context.problem.sim, context.reached());
        let site = &mut self.sites[ledge as usize];
        if site.stands.is_empty() && site.from.is_none() {
            let at = self.ledges.get(ledge).copied().unwrap_or_else(|| self.ledges.here(sim, state));
            if let Some(distances) = self.distances {
                site.places = distances.from(sim, state, at.space, at.middle());
            }
            site.near = self.ledges.near(&at).into();
            self.open.push(ledge);
        }
    }

    /// Notes the node that was reached last, as one on a ledge.
    fn stand(&mut self, context: &mut SearchContext<'_>, node: NodeId) {
        let under = self.ledges.under(context.problem.sim, context.reached());
        let is_begin = self.open.is_empty() || self.ledges.len() == 0;
        let Some(ledge) = under.or_else(|| is_begin.then(|| self.elsewhere())) else { return };
        self.open(context, ledge);
        let site = &mut self.sites[ledge as usize];
        site.elite = None;
        site.stood += 1;
        if site.stands.len() < STANDS {
            site.stands.push(node);
        } else if let Some(stand) = site.stands.get_mut(context.rng.random_range(0..site.stood as usize)) {
            *stand = node;
        }
    }

    /// The number of an input.
    fn number(&mut self, input: &Input) -> u16 {
        let at = self.inputs.iter().position(|known| known == input).unwrap_or_else(|| {
            self.inputs.push(input.clone());
            self.inputs.len() - 1
        });
        at.min(usize::from(u16::MAX)) as u16
    }

    /// A random input of a node, as a rule one that differs in one control from the one before.
    fn draw(&mut self, context: &mut SearchContext<'_>, node: NodeId, before: Option<u16>) -> u16 {
        let mut index = context.draw_input(node);
        if let Some(before) = before
            && !context.rng.random_ratio(1, ANY_ONE_IN)
        {
            let before = &self.inputs[usize::from(before)];
            for _ in 0..TRIES {
                if context.input(node, index).difference(before) == 1 {
                    break;
                }
                index = context.draw_input(node);
            }
        }
        self.number(context.input(node, index))
    }

    /// The open ledge that is the cheapest to try; one of them, if there are several.
    fn cheapest(&self, context: &mut SearchContext<'_>) -> Option<u32> {
        let (mut least, mut found, mut count) = (u64::MAX, None, 0);
        for &ledge in &self.open {
            let site = &self.sites[ledge as usize];
            let cost = u64::from(site.places) * PER_PLACE + u64::from(site.tried);
            if cost > least {
                continue;
            }
            count = if cost < least { 1 } else { count + 1 };
            least = cost;
            if context.rng.random_ratio(1, count) {
                found = Some(ledge);
            }
        }
        found
    }

    /// Begins a motion: a new one from a ledge on which the player has stood, or a changed one to a ledge.
    fn begin(&mut self, context: &mut SearchContext<'_>) -> Option<()> {
        let ledge = self.cheapest(context)?;
        self.watch(context, ledge);
        let site = &mut self.sites[ledge as usize];
        let is_stood = !site.stands.is_empty();
        site.tried += 1;
        site.elite = site.elite.filter(|elite| elite.failed < FAILED);
        let from = if is_stood { ledge } else { site.from? };
        let (motion, at, node) = match &mut site.elite {
            Some(elite) => {
                elite.failed += 1;
                let motion = elite.motion;
                self.changed(context, motion)
            }
            None => self.any(context, from)?,
        };
        self.attempt = Some(Attempt { motion, at, again: AGAIN, node, from });
        Some(())
    }

    /// Watches the ledges near one on which the player has not stood.
    fn watch(&mut self, context: &mut SearchContext<'_>, ledge: u32) {
        let near = self.sites[ledge as usize].near.clone();
        if let Some(gauge) = &mut context.gauge {
            gauge.watch(near.iter().copied().filter(|other| self.sites[*other as usize].stands.is_empty()));
        }
    }

    /// A random motion from a ledge, and its first leg and node.
    fn any(&mut self, context: &mut SearchContext<'_>, ledge: u32) -> Option<(Motion, usize, NodeId)> {
        let stands = &self.sites[ledge as usize].stands;
        let node = *stands.get(context.rng.random_range(0..stands.len().max(1)))?;
        let count = context.rng.random_range(1..=FIRST_LEGS);
        let mut motion = Motion { legs: [Leg { node, input: 0, hold: 1 }; LEGS], count };
        let mut before = None;
        for leg in &mut motion.legs[..count] {
            let input = self.draw(context, node, before);
            *leg = Leg { node, input, hold: context.draw_hold() };
            before = Some(input);
        }
        Some((motion, 0, node))
    }

    /// A motion that differs a little from another, the first leg that does, and the node from which it does.
    fn changed(&mut self, context: &mut SearchContext<'_>, mut motion: Motion) -> (Motion, usize, NodeId) {
        let last = motion.count - 1;
        let change = context.rng.random_range(0..16);
        // All but the last are held for some steps.
        let at = context.rng.random_range(0..if change == 0 { motion.count } else { last.max(1) });
        let node = motion.legs[at].node;
        let by = (1u16 << context.rng.random_range(0..4)).saturating_sub(context.rng.random_range(0..2)).max(1);
        let (least, most) = context.hold;
        let longer = |hold: u16| hold.saturating_add(by).min(most);
        let shorter = |hold: u16| hold.saturating_sub(by).max(least);
        let is_longer = context.rng.random_ratio(1, 2);
        match change {
            0..2 => {
                let before = (at > 0).then(|| motion.legs[at - 1].input);
                motion.legs[at].input = self.draw(context, node, before);
            }
            2 if motion.count > 1 => {
                motion.legs.copy_within(at + 1..motion.count, at);
                motion.count -= 1;
            }
            // The next change comes earlier or later, and the one after it when it came before.
            3..7 if at + 1 < last => {
                let (one, next) = (motion.legs[at].hold, motion.legs[at + 1].hold);
                (motion.legs[at].hold, motion.legs[at + 1].hold) =
                    if is_longer { (longer(one), shorter(next)) } else { (shorter(one), longer(next)) };
            }
            7.. if last > 0 => {
                let hold = &mut motion.legs[at].hold;
                *hold = if is_longer { longer(*hold) } else { shorter(*hold) };
            }
            // Another input in between.
            _ if motion.count < LEGS => {
                motion.legs.copy_within(at..motion.count, at + 1);
                motion.count += 1;
                let hold = motion.legs[at].hold;
                let first = context.rng.random_range(1..=hold.max(1));
                motion.legs[at].hold = first.max(least);
                motion.legs[at + 1].hold = (hold - first.min(hold)).max(least);
                motion.legs[at + 1].input = self.draw(context, node, Some(motion.legs[at].input));
            }
            _ => {}
        }
        (motion, at.min(motion.count - 1), node)
    }

    /// Goes on from the node to which the last extension has led.
    fn go_on(&mut self, context: &mut SearchContext<'_>, node: NodeId) {
        let Some(attempt) = &mut self.attempt else { return };
        attempt.node = node;
        if attempt.at + 1 < attempt.motion.count {
            attempt.at += 1;
        } else if attempt.again > 0 && self.ledges.under(context.problem.sim, context.reached()).is_none() {
            attempt.again -= 1;
        } else {
            self.attempt = None;
        }
        if context.has_landed() {
            self.attempt = None;
        }
        if self.attempt.is_none() {
            self.stand(context, node);
        }
    }

    /// Learns how near the last extension came to ledges.
    fn judge(&mut self, context: &mut SearchContext<'_>) {
        let (Some(attempt), Some(gauge)) = (self.attempt, context.gauge.take()) else { return };
        let motion = Motion { count: attempt.at + 1, ..attempt.motion };
        for &(ledge, miss) in gauge.watched() {
            let elite = self.sites[ledge as usize].elite;
            if miss > MISS || elite.is_some_and(|elite| miss > elite.miss) {
                continue;
            }
            self.open(context, ledge);
            let failed = elite.filter(|elite| miss == elite.miss).map_or(0, |elite| elite.failed);
            let site = &mut self.sites[ledge as usize];
            site.from = Some(attempt.from);
            site.elite = Some(Elite { miss, motion, failed });
        }
        context.gauge = Some(gauge);
    }
}

impl Strategy for LedgeGuided<'_> {
    fn choose(&mut self, context: &mut SearchContext<'_>, _toward: &Point) -> Option<Choice> {
        if self.attempt.is_none() {
            self.begin(context)?;
        }
        let attempt = self.attempt.as_mut()?;
        let is_last = attempt.at + 1 == attempt.motion.count;
        let leg = &mut attempt.motion.legs[attempt.at];
        if !is_last || attempt.again == AGAIN {
            leg.node = attempt.node;
        }
        let input = context.input_like(attempt.node, &self.inputs[usize::from(leg.input)]);
        let hold = if is_last { context.hold.1 } else { leg.hold };
        Some(Choice { node: attempt.node, input, hold })
    }

    fn learn(&mut self, context: &mut SearchContext<'_>, choice: Option<Choice>, growth: Growth<'_>) {
        match growth {
            Growth::Rooted(root, _) => {
                self.sites.clear();
                self.sites.resize_with(self.ledges.len() + 1, Site::default);
                self.open.clear();
                self.attempt = None;
                self.fruitless = 0;
                context.gauge = Some(Box::new(Gauge::new(self.ledges.clone())));
                self.stand(context, root);
            }
            Growth::Added(node, _) if choice.is_none() => self.stand(context, node),
            Growth::Added(node, _) => {
                self.fruitless = 0;
                self.judge(context);
                self.go_on(context, node);
            }
            Growth::Known(node, _) => {
                self.fruitless += 1;
                self.judge(context);
                self.go_on(context, node);
            }
            Growth::Failed | Growth::Late => {
                self.fruitless += 1;
                self.judge(context);
                self.attempt = None;
            }
        }
    }

    fn is_over(&self) -> bool {
        self.open.is_empty() || self.fruitless >= FRUITLESS
    }

    /// Motions are tried from where others have not been.
    fn follows(&self) -> bool {
        false
    }

    fn bytes(&self) -> usize {
        let of_site = |site: &Site| site.stands.capacity() * size_of::<NodeId>();
        self.sites.capacity() * size_of::<Site>() + self.sites.iter().map(of_site).sum::<usize>()
    }
}
