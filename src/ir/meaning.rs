//! The part of a program on which runs depend: texts that differ only in layout, comments and invisible names have
//! equal meanings.

use std::sync::Arc;

use super::{Looks, Program, Spans};

impl Program {
    /// The program without source locations, documentation, looks and names of parameters: equal for texts with the same runs,
    /// questions and output.
    pub fn meaning(&self) -> Program {
        let Program { tags, exprs, entities, worlds, looks: _, spans: _ } = self;
        let (tags, exprs, entities, worlds) = (tags.clone(), exprs.clone(), entities.clone(), worlds.clone());
        let mut meaning = Program { tags, exprs, entities, worlds, looks: Looks::default(), spans: Spans::default() };
        for entity in meaning.entities.iter_mut().map(Arc::make_mut) {
            entity.doc = None;
            entity.params.iter_mut().for_each(|param| param.name.clear());
        }
        meaning
    }
}
