//! What of a program a run depends on: two texts that differ in layout, comments and names that nothing shows mean the same.

use std::sync::Arc;

use super::{Program, Spans};

impl Program {
    /// The program without places in the text, documentation and names of parameters: equal for texts of which everything
    /// that is run, asked and shown is equal.
    pub fn meaning(&self) -> Program {
        let Program { tags, exprs, entities, worlds, spans: _ } = self;
        let (tags, exprs, entities, worlds) = (tags.clone(), exprs.clone(), entities.clone(), worlds.clone());
        let mut meaning = Program { tags, exprs, entities, worlds, spans: Spans::default() };
        for entity in meaning.entities.iter_mut().map(Arc::make_mut) {
            entity.doc = None;
            entity.params.iter_mut().for_each(|param| param.name.clear());
        }
        meaning
    }
}
