//! Tests of worlds: their names, predicates and times. What is checked here is not lowered.

use crate::diagnostic::catalogue::lint::UncarriedTag;
use crate::diagnostic::catalogue::test::{BadTest, IdleTest, WhyBadTest};
use crate::source::Span;
use crate::syntax::ast::{self, Expr, Moment, Name, SearchKind, TestItem, WorldItem};
use crate::syntax::occurrence::NameKind;

use super::Checker;
use super::checked::{Claim, ClaimKind, Term, TermKind, Test, When, World};
use super::constant::ConstantContext;
use super::expression::Scope;
use super::names::Table;

/// Rounding tolerance for a number of steps.
const ROUNDED: f64 = 1e-6;
/// Maximum number of steps that a test waits for.
const MAX_STEPS: f64 = 100_000_000.0;

/// The questions of a world that a test can name.
pub(super) struct Questions<'q> {
    pub goals: &'q Table<()>,
    pub nevers: &'q Table<()>,
}

/// The questions that a name can mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Named {
    Goal,
    Never,
    Either,
}

impl Checker<'_> {
    /// Checks the tests of a world.
    pub(super) fn tests(
        &mut self,
        syntax: &ast::World,
        questions: &Questions<'_>,
        scope: &Scope<'_>,
        world: &mut World,
    ) {
        let known_tags = self.checked.tags.len();
        let mut names: Table<()> = Table::new("test");
        for item in &syntax.items {
            let WorldItem::Test(test) = item else { continue };
            let fresh = names.declare(&test.name, (), &mut self.diagnostics);
            let checked = self.test(test, questions, scope, &mut world.times);
            world.tests.extend(checked.filter(|_| fresh));
        }
        // A tag that only tests name is none of the program's.
        while self.checked.tags.len() > known_tags {
            let Some(name) = self.checked.tags.pop() else { break };
            self.tags.remove(&name.text);
            let (tag, at) = (name.text.to_string(), name.span);
            self.diagnostics.report(UncarriedTag { tag, at, near: None, elsewhere: None, unasked: Vec::new() });
        }
    }

    fn test(
        &mut self,
        syntax: &ast::Test,
        questions: &Questions<'_>,
        scope: &Scope<'_>,
        times: &mut Vec<Term>,
    ) -> Option<Test> {
        let mut test = Test {
            name: syntax.name.clone(),
            inputs: Vec::new(),
            seed: None,
            claims: Vec::new(),
            predicates: Vec::new(),
            span: syntax.span,
        };
        if syntax.name.text.trim().is_empty() {
            self.diagnostics.report(BadTest { at: syntax.name.span, why: WhyBadTest::NoName });
        }
        let mut seeds: Table<()> = Table::new("the seed of");
        let (mut is_whole, mut claims) = (true, 0_usize);
        for item in &syntax.items {
            match item {
                TestItem::Inputs(inputs) => test.inputs.push((**inputs).clone()),
                TestItem::Seed(seed) => {
                    let name = Name { text: syntax.name.text.clone(), span: seed.span };
                    match seed.number.text.parse() {
                        Ok(number) if seeds.declare(&name, (), &mut self.diagnostics) => test.seed = Some(number),
                        Ok(_) => {}
                        Err(_) => self.diagnostics.report(BadTest { at: seed.number.span, why: WhyBadTest::BadSeed }),
                    }
                }
                TestItem::Expect(expect) => {
                    claims += 1;
                    let predicate = self.asked((&expect.predicate, Named::Either), questions, scope, &mut test);
                    let when = self.when(&expect.moment, times);
                    let Some((predicate, when)) = predicate.zip(when) else {
                        is_whole = false;
                        continue;
                    };
                    test.claims.push(Claim { predicate, kind: ClaimKind::Expect(when), span: expect.span });
                }
                TestItem::Search(search) => {
                    claims += 1;
                    match self.searched(search, (questions, scope), times, &mut test) {
                        Some(claim) => test.claims.push(claim),
                        None => is_whole = false,
                    }
                }
            }
        }
        self.report_idle(syntax, &test, claims);
        is_whole.then_some(test)
    }

    /// Reports a test that claims nothing, and parts on which nothing depends.
    fn report_idle(&mut self, syntax: &ast::Test, test: &Test, claims: usize) {
        // What could not be read may be a claim.
        if syntax.is_broken {
            return;
        }
        if claims == 0 {
            self.diagnostics.report(BadTest { at: syntax.name.span, why: WhyBadTest::NoClaim });
            return;
        }
        let expects: Vec<(&Moment, Span)> = syntax
            .items
            .iter()
            .filter_map(|item| if let TestItem::Expect(e) = item { Some((&e.moment, e.span)) } else { None })
            .collect();
        if let (Some(inputs), true) = (test.inputs.first(), expects.is_empty()) {
            self.diagnostics
                .report(IdleTest { at: inputs.span, what: "no `expect` asks about the run of these inputs" });
        }
        if !test.inputs.is_empty() {
            return;
        }
        // Without inputs, only times tell how long the run is.
        let has_time = expects.iter().any(|(moment, _)| matches!(moment, Moment::At(Some(_)) | Moment::By(Some(_))));
        if let Some((_, at)) = expects.first().filter(|_| !has_time) {
            self.diagnostics.report(BadTest { at: *at, why: WhyBadTest::NoEnd });
        }
    }

    /// A predicate, or the name of a goal or a `never`; returns its place.
    fn asked(
        &mut self,
        (predicate, named): (&Expr, Named),
        questions: &Questions<'_>,
        scope: &Scope<'_>,
        test: &mut Test,
    ) -> Option<Span> {
        if let Some(name) = predicate.name() {
            let of = |table: &Table<()>| table.entry(&name.text).map(|(known, ())| known.span);
            let (goal, never) = (of(questions.goals), of(questions.nevers));
            let known = match named {
                Named::Goal => goal.map(|at| (NameKind::Goal, at)),
                Named::Never => never.map(|at| (NameKind::Never, at)),
                Named::Either => goal.map(|at| (NameKind::Goal, at)).or_else(|| never.map(|at| (NameKind::Never, at))),
            };
            if let Some((kind, declared)) = known {
                self.record_use(kind, name.span, declared);
                return Some(name.span);
            }
            if let Some(other) = goal.or(never)
                && self.visible_condition(&name.text, scope).is_none()
            {
                let (name, at) = (name.text.to_string(), name.span);
                let why = WhyBadTest::OtherQuestion { name, is_goal: goal.is_some(), declared: other };
                self.diagnostics.report(BadTest { at, why });
                return None;
            }
        }
        let term = self.guard(predicate, scope)?;
        if let TermKind::Bool(_) = term.kind {
            self.diagnostics.report(IdleTest { at: term.span, what: "this does not depend on the world" });
        }
        test.predicates.push(term);
        Some(predicate.span)
    }

    fn searched(
        &mut self,
        search: &ast::Search,
        (questions, scope): (&Questions<'_>, &Scope<'_>),
        times: &mut Vec<Term>,
        test: &mut Test,
    ) -> Option<Claim> {
        let named = match search.kind {
            SearchKind::Reachable | SearchKind::Unreachable => Named::Goal,
            SearchKind::Never | SearchKind::Unfound => Named::Never,
        };
        let predicate = self.asked((&search.predicate, named), questions, scope, test);
        let without = match &search.without {
            Some(without) if without.is_needed && search.kind != SearchKind::Reachable => {
                let (at, word) = (search.span, search.kind.word());
                self.diagnostics.report(BadTest { at, why: WhyBadTest::NeededBy(word) });
                None
            }
            Some(without) => self.without(&without.predicate, scope, test).map(|at| Some((at, without.is_needed))),
            None => Some(None),
        };
        let within = match &search.within {
            Some(time) => self.time(time, times).map(|steps| Some((steps + ROUNDED).floor() as u32)),
            None => Some(None),
        };
        let kind = ClaimKind::Search { kind: search.kind, without: without?, within: within? };
        Some(Claim { predicate: predicate?, kind, span: search.span })
    }

    /// The predicate after `without`, which names no goal.
    fn without(&mut self, predicate: &Expr, scope: &Scope<'_>, test: &mut Test) -> Option<Span> {
        let term = self.guard(predicate, scope)?;
        test.predicates.push(term);
        Some(predicate.span)
    }

    fn when(&mut self, moment: &Moment, times: &mut Vec<Term>) -> Option<When> {
        Some(match moment {
            Moment::At(Some(time)) => {
                let steps = self.time(time, times)?;
                let whole = steps.round();
                if (steps - whole).abs() > ROUNDED {
                    let (step, before) = (self.step, steps.floor() as u32);
                    self.diagnostics.report(BadTest { at: time.span, why: WhyBadTest::OffStep { step, before } });
                    return None;
                }
                When::At(whole as u32)
            }
            Moment::At(None) => When::AtEnd,
            Moment::By(Some(time)) => When::By((self.time(time, times)? + ROUNDED).floor() as u32),
            Moment::By(None) => When::ByEnd,
            Moment::Always => When::Always,
            Moment::Never => When::Never,
        })
    }

    /// A time, in steps.
    fn time(&mut self, time: &Expr, times: &mut Vec<Term>) -> Option<f64> {
        let term = self.number(time, &Scope::constant())?;
        let context = ConstantContext { step: Some(self.step), ..ConstantContext::LITERALS };
        let seconds = self.evaluated(&term, context)?;
        times.push(term);
        let (numerator, denominator) = self.step;
        let steps = seconds * denominator as f64 / numerator as f64;
        if (0.0..=MAX_STEPS).contains(&steps) {
            return Some(steps);
        }
        self.diagnostics.report(BadTest { at: time.span, why: WhyBadTest::NoTime });
        None
    }
}
