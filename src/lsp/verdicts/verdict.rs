//! What is known of a question, and its wording above a goal or a `never`.

use serde::{Deserialize, Serialize};

use crate::reach::Conclusion;
use crate::reach::query::{Answer, Kind};

/// A question of a program: a goal or a `never` of a world, on a level.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(in crate::lsp) struct Question {
    /// The world.
    pub world: String,
    /// The level that was chosen for its open map, by its name beside the program; empty if it has none.
    pub level: String,
    pub kind: Kind,
    /// The name of the goal or of the `never`.
    pub name: String,
}

/// Inputs that lead to the goal, or break the `never`. They were replayed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(in crate::lsp) struct Way {
    /// As an input script.
    pub inputs: String,
    pub steps: u64,
    /// Its duration in the world, s.
    pub seconds: f64,
    /// The luck that it needs, in words; `None` if it needs none.
    pub luck: Option<String>,
}

/// What came of a question.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(in crate::lsp) struct Verdict {
    pub conclusion: Conclusion,
    /// The way, if one was found.
    pub way: Option<Way>,
    /// Why there is none, a sentence each, if that is known.
    pub reasons: Vec<String>,
    /// If all states were visited: their number.
    pub states: Option<u64>,
    /// Whether a run has refuted the analysis that a proof rested on.
    pub is_withdrawn: bool,
    /// Nodes of the search; 0 if nothing was searched.
    pub nodes: u64,
    /// The places that the players were in.
    pub places: u64,
    /// By how much the search missed the goal, such as `12 px`, and in words.
    pub nearest: Option<(String, String)>,
}

/// The goal was reached before, and is not now; or the `never` was proven before, and inputs break it now.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::lsp) struct Broken {
    /// The inputs that reached the goal before; none of a `never`.
    pub inputs: Option<String>,
    /// How long they took then, s.
    pub seconds: f64,
    /// The step at which they fail now, and how, in words.
    pub fails: Option<(u64, String)>,
}

impl Verdict {
    /// A way that was replayed.
    pub fn of_way(kind: Kind, way: Way) -> Verdict {
        let conclusion = match kind {
            Kind::Goal => Conclusion::Reached,
            Kind::Never => Conclusion::Violated,
        };
        Verdict {
            conclusion,
            way: Some(way),
            reasons: Vec::new(),
            states: None,
            is_withdrawn: false,
            nodes: 0,
            places: 0,
            nearest: None,
        }
    }

    /// The answer of a search that was not stopped.
    pub fn of_answer(answer: &Answer) -> Verdict {
        let way = answer.inputs.as_ref().map(|inputs| Way {
            inputs: inputs.clone(),
            steps: answer.steps.unwrap_or_default(),
            seconds: answer.seconds_of_play.unwrap_or_default(),
            luck: answer.luck.as_ref().filter(|luck| !luck.is_none()).map(|luck| luck.words()),
        });
        let missing = answer.why_not.as_ref().and_then(|why| Some((why.missing()?, why.phrase()?)));
        let nearest = missing.map(|(part, phrase)| (part.distance_words().unwrap_or_default(), phrase));
        Verdict {
            conclusion: answer.verdict,
            way,
            reasons: answer.reasons.clone(),
            states: answer.states,
            is_withdrawn: answer.is_withdrawn,
            nodes: answer.nodes,
            places: answer.coverage.places,
            nearest,
        }
    }

    /// A question that cannot be asked, and why.
    pub fn failed(why: String) -> Verdict {
        Verdict {
            conclusion: Conclusion::Error,
            way: None,
            reasons: vec![why],
            states: None,
            is_withdrawn: false,
            nodes: 0,
            places: 0,
            nearest: None,
        }
    }

    /// Whether it is what the author wants; `None` if that is not known.
    pub fn is_good(&self, kind: Kind) -> Option<bool> {
        match self.conclusion {
            Conclusion::Reached => Some(true),
            Conclusion::Violated => Some(false),
            Conclusion::ProvenUnreachable => Some(kind == Kind::Never),
            _ => None,
        }
    }

    /// The verdict in a few words, with its sign: ✓ wanted, ✗ not wanted, ? not known.
    pub fn title(&self, kind: Kind) -> String {
        let why = match (self.states, self.reasons.first()) {
            (Some(states), _) => format!(": {states} state{}, all visited", if states == 1 { "" } else { "s" }),
            // What the question is stands below.
            (None, Some(why)) => format!(": {}", why.split_once(" never holds: ").map_or(&**why, |(_, why)| why)),
            (None, None) => String::new(),
        };
        let way = |way: &Way| {
            let luck = way.luck.as_ref().map_or(String::new(), |luck| format!(", with luck {luck}"));
            format!("{:.1} s{luck} · play", way.seconds)
        };
        match (self.conclusion, &self.way) {
            (Conclusion::Reached, Some(found)) => format!("✓ {}", way(found)),
            (Conclusion::Violated, Some(found)) => format!("✗ broken in {}", way(found)),
            (Conclusion::ProvenUnreachable, _) if kind == Kind::Goal => format!("✗ proven{why}"),
            (Conclusion::ProvenUnreachable, _) => format!("✓ proven{why}"),
            (Conclusion::Exhausted, _) => "? not with axes at -1, 0 and 1".to_string(),
            (Conclusion::Error, _) => format!("? not asked{why}"),
            _ if self.is_withdrawn => "? a proof was refuted by a run: a bug of hypedc".to_string(),
            _ => {
                let places = format!("? {} place{}", self.places, if self.places == 1 { "" } else { "s" });
                match &self.nearest {
                    Some((distance, _)) if !distance.is_empty() => format!("{places}, nearest {distance}"),
                    _ => places,
                }
            }
        }
    }

    /// What the title leaves out, a sentence each.
    pub fn details(&self) -> Vec<String> {
        let mut out = self.reasons.clone();
        if self.conclusion.is_open() && !self.is_withdrawn {
            let nearest = self.nearest.as_ref().map_or(String::new(), |(_, phrase)| format!("; nearest: {phrase}"));
            out.push(format!("nothing was found with {} nodes, which proves nothing{nearest}", self.nodes));
        }
        out
    }
}
