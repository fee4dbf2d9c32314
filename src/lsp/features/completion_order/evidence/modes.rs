//! Evidence for modes: the targets of edges, and the modes that are declared next.

use super::{Evidence, Take, logarithm, yes};
use crate::lsp::features::completion_order::reading::Mode;

impl Evidence<'_> {
    /// What is known of a mode.
    pub(super) fn mode(&self, label: &str, take: Take<'_>) {
        let reading = &self.reading;
        let name = label.rsplit('.').next().unwrap_or(label);
        let place = |name: &str| reading.modes.iter().position(|mode| mode.name == name);
        let own = reading.enclosing("mode").map_or("", |open| open.name);
        let before = match reading.before(1).text {
            word @ ("->" | "in" | "(" | "mode") => word,
            _ => "",
        };
        let declared = place(name);
        let leads = |from: &str, to: &str| reading.edges.iter().any(|edge| edge.from == from && edge.to == to);
        let times = reading.edges.iter().filter(|edge| edge.to == name).count();
        if name == own {
            take(&["mode own", before], 1.0);
        } else if reading.open.iter().any(|open| open.block == "mode" && open.name == name) {
            take(&["mode outer", before], 1.0);
        }
        take(&["mode", yes(times > 0), yes(declared.is_some()), before], 1.0);
        if leads(name, own) {
            take(&["mode back", before], 1.0);
        }
        if leads(own, name) {
            take(&["mode again", before], 1.0);
        }
        if let (Some(at), Some(here)) = (declared, place(own)) {
            let group = |at: usize| reading.modes.get(at).map_or("", |mode: &Mode<'_>| mode.group);
            let order = match at {
                _ if at + 1 == here => "before",
                _ if at < here => "earlier",
                _ => "later",
            };
            take(&["mode order", yes(group(at) == group(here)), order, before], 1.0);
            if reading.modes.iter().position(|mode| mode.group == group(at)) == Some(at) {
                take(&["mode first", before], 1.0);
            }
        }
        let is_last = reading.edges.last().is_some_and(|edge| edge.to == name);
        match before {
            "->" => {
                if declared.is_none() {
                    take(&["target times"], logarithm(times));
                    if self.awaited.first() == Some(&name) {
                        take(&["target awaited"], 1.0);
                    }
                }
                if is_last {
                    take(&["target last"], 1.0);
                }
                let most = |all: &mut dyn Iterator<Item = f32>| all.max_by(f32::total_cmp).unwrap_or(0.0);
                let shared = most(&mut self.led.iter().filter(|(to, _)| *to == name).map(|(_, share)| *share));
                take(&["guard leads"], shared);
                if shared > 0.0 && shared == most(&mut self.led.iter().map(|(_, share)| *share)) {
                    take(&["guard leads best"], 1.0);
                }
            }
            "mode" => {
                if let Some(at) = self.awaited.iter().position(|awaited| *awaited == name) {
                    take(&["awaited place"], logarithm(at));
                    take(&["awaited times"], logarithm(times));
                }
                if self.awaited.first() == Some(&name) {
                    take(&["awaited first"], 1.0);
                }
                if is_last {
                    take(&["awaited last"], 1.0);
                }
            }
            _ => {}
        }
    }
}
