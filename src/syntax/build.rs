//! The syntax tree from pest's pairs: files, entities, modes, edges, envelopes. Worlds are in `build_world`,
//! expressions in `expression`.

use pest::Parser;
use pest::iterators::Pair;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::syntax::{TooManyErrors, Unexpected};
use crate::source::{FileId, Span};

use super::ast::{
    Assignment, Behavior, Broken, Clamp, Collider, Constant, Continuous, Destroy, Dimension, Discrete, Domain, Edge,
    Entity, Envelope, Expr, ExprKind, File, Follow, Group, Import, Initial, Invariant, Item, Member, Mode, Name, Path,
    Ramp, RampKind, Rate, Reference, Spawn, Update, Use, Variable,
};
use super::scan::Scan;
use super::{Grammar, Rule, message};

/// How many syntax errors of one file are shown.
const MAX_SYNTAX_ERRORS: usize = 100;

/// What the builders share.
pub(super) struct Builder<'a> {
    file: FileId,
    source: &'a str,
    scan: &'a Scan,
    text: &'a str,
    broken: Vec<Broken>,
    errors: usize,
    diagnostics: &'a mut Diagnostics,
}

/// Parses the scanned text and builds the tree.
pub(super) fn file(id: FileId, source: &str, mut scan: Scan, diagnostics: &mut Diagnostics) -> File {
    let trivia = std::mem::take(&mut scan.trivia);
    let mut out = File { id, items: Vec::new(), trivia, broken: Vec::new(), texts: Vec::new() };
    let Some(text) = scan.text.take() else {
        // Nothing of the file was read: later stages must not complain of what it would have declared.
        out.broken.push(Broken { span: Span::new(id, 0, source.len()), names: vec!["*".into()] });
        return out;
    };
    let mut b = Builder { file: id, source, scan: &scan, text: &text, broken: Vec::new(), errors: 0, diagnostics };
    match Grammar::parse(Rule::file, &text) {
        Ok(pairs) => {
            for pair in pairs.flat_map(Pair::into_inner) {
                out.items.extend(b.item(&pair, &out.trivia));
            }
        }
        Err(error) => {
            let at = match error.location {
                pest::error::InputLocation::Pos(at) | pest::error::InputLocation::Span((at, _)) => at,
            };
            let at = b.span(at, at + 1);
            b.diagnostics.report(Unexpected { at, found: None, expected: Vec::new(), help: None, meant: None });
            b.broken.push(Broken { span: at, names: vec!["*".into()] });
        }
    }
    out.broken = b.broken;
    out
}

/// The inner pairs without punctuation and introducing words.
pub(super) fn parts<'i>(pair: &Pair<'i, Rule>) -> Vec<Pair<'i, Rule>> {
    pair.clone().into_inner().filter(|p| !is_punctuation(p.as_rule())).collect()
}

fn is_punctuation(rule: Rule) -> bool {
    use Rule as R;
    matches!(
        rule,
        R::end
            | R::EOI
            | R::open_brace
            | R::close_brace
            | R::open_paren
            | R::close_paren
            | R::comma
            | R::colon
            | R::arrow
            | R::dot
            | R::range
            | R::caret
            | R::kw_import
            | R::kw_const
            | R::kw_entity
            | R::kw_world
            | R::kw_param
            | R::kw_continuous
            | R::kw_discrete
            | R::kw_button
            | R::kw_axis
            | R::kw_collider
            | R::kw_group
            | R::kw_mode
            | R::kw_when
            | R::kw_envelope
            | R::kw_as
            | R::kw_behavior
            | R::kw_ref
            | R::kw_clamp
            | R::kw_invariant
            | R::kw_use
            | R::kw_spawn
            | R::kw_destroy
            | R::word_follow
            | R::word_links
            | R::word_decay
            | R::word_limit
            | R::word_link
            | R::word_vglc
            | R::word_level
            | R::word_tiled
            | R::word_ldtk
            | R::word_legend
            | R::word_tile
            | R::word_from
            | R::word_int
            | R::word_initial
            | R::word_by
            | R::word_directions
            | R::word_attack
            | R::word_sustain
            | R::word_for
            | R::word_release
            | R::word_while
            | R::word_accel
            | R::word_over
            | R::word_to
            | R::word_step
            | R::word_collide
            | R::word_with
            | R::word_tiles
            | R::word_x
            | R::word_space
            | R::word_player
            | R::word_goal
            | R::word_never
            | R::word_map
            | R::word_place
            | R::word_at
            | R::word_rect
            | R::word_bounds
            | R::word_any
            | R::word_touching
    )
}

impl Builder<'_> {
    /// A source span from bytes of the mended text.
    pub fn span(&self, start: usize, end: usize) -> Span {
        Span::new(self.file, self.scan.position(start), self.scan.position(end))
    }

    /// The source span of a pair, without white space at its end.
    pub fn span_of(&self, pair: &Pair<'_, Rule>) -> Span {
        let (start, text) = (pair.as_span().start(), pair.as_str());
        self.span(start, start + text.trim_end().len())
    }

    pub fn name(&self, pair: &Pair<'_, Rule>) -> Name {
        match pair.as_rule() {
            // A text's name is what stands between the quotes.
            Rule::text => Name { text: pair.as_str().trim_matches('"').to_string(), span: self.span_of(pair) },
            Rule::tag => match pair.clone().into_inner().next() {
                Some(inner) => self.name(&inner),
                None => Name { text: pair.as_str().to_string(), span: self.span_of(pair) },
            },
            _ => Name { text: pair.as_str().trim_end().to_string(), span: self.span_of(pair) },
        }
    }

    pub fn names(&self, pair: &Pair<'_, Rule>) -> Vec<Name> {
        parts(pair).iter().map(|p| self.name(p)).collect()
    }

    fn is_explained(&self, span: Span) -> bool {
        self.scan.is_explained(span)
    }

    /// Reports a slice that fit no rule. `rule` is what should have stood there.
    pub fn bad(&mut self, rule: Rule, pair: &Pair<'_, Rule>) {
        let (from, to) = (pair.as_span().start(), pair.as_span().end());
        let span = self.span_of(pair);
        self.broken.push(Broken { span, names: declared_names(pair.as_str()) });
        if self.is_explained(span) {
            return;
        }
        self.errors += 1;
        if self.errors > MAX_SYNTAX_ERRORS {
            if self.errors == MAX_SYNTAX_ERRORS + 1 {
                self.diagnostics.report(TooManyErrors { at: span });
            }
            return;
        }
        let fact = message::explain(rule, self.text, from, to, &|a, b| self.span(a, b));
        self.diagnostics.report(fact);
    }

    fn item(&mut self, pair: &Pair<'_, Rule>, trivia: &[super::ast::Comment]) -> Option<Item> {
        match pair.as_rule() {
            Rule::import => {
                let path = self.name(parts(pair).first()?);
                Some(Item::Import(Import { path }))
            }
            Rule::constant => self.constant(pair, trivia).map(Item::Constant),
            Rule::entity => {
                let inner = parts(pair);
                let name = self.name(inner.first()?);
                let members = self.members(inner.get(1)?, trivia);
                Some(Item::Entity(Entity { name, members, doc: self.doc(pair, trivia), span: self.span_of(pair) }))
            }
            Rule::world => {
                let doc = self.doc(pair, trivia);
                self.world(pair, doc).map(Item::World)
            }
            Rule::behavior => {
                let inner = parts(pair);
                let name = self.name(inner.first()?);
                let formals = inner.iter().find(|p| p.as_rule() == Rule::formals);
                let parameters = formals.map_or(Vec::new(), |f| self.names(f));
                let members = self.members(inner.last()?, trivia);
                let (doc, span) = (self.doc(pair, trivia), self.span_of(pair));
                Some(Item::Behavior(Behavior { name, parameters, members, doc, span }))
            }
            Rule::bad_item => {
                self.bad(Rule::only_item, pair);
                None
            }
            _ => None,
        }
    }

    /// The `///` lines directly above a pair.
    fn doc(&self, pair: &Pair<'_, Rule>, trivia: &[super::ast::Comment]) -> Option<String> {
        let mut start = self.span_of(pair).start as usize;
        let mut lines = Vec::new();
        let before = trivia.partition_point(|c| (c.span.start as usize) < start);
        for comment in trivia.get(..before)?.iter().rev() {
            let gap = self.source.get(comment.span.end as usize..start)?;
            if !comment.documents || !gap.trim().is_empty() || gap.matches('\n').count() != 1 {
                break;
            }
            let body = self.source.get(comment.span.range())?.trim_start_matches('/');
            lines.push(body.strip_prefix(' ').unwrap_or(body).trim_end().to_string());
            start = comment.span.start as usize;
        }
        lines.reverse();
        (!lines.is_empty()).then(|| lines.join("\n"))
    }

    fn constant(&mut self, pair: &Pair<'_, Rule>, trivia: &[super::ast::Comment]) -> Option<Constant> {
        let inner = parts(pair);
        let name = self.name(inner.first()?);
        let dimension = inner.iter().find(|p| p.as_rule() == Rule::annotation).and_then(|p| self.dimension(p));
        let value = self.expression(inner.iter().find(|p| p.as_rule() == Rule::expression)?)?;
        Some(Constant { name, dimension, value, doc: self.doc(pair, trivia) })
    }

    fn dimension(&self, annotation: &Pair<'_, Rule>) -> Option<Dimension> {
        let dimension = parts(annotation).into_iter().next()?;
        let mut factors = Vec::new();
        let mut sign = 1;
        for part in parts(&dimension) {
            if part.as_rule() == Rule::dimension_operator {
                sign = if part.as_str().starts_with('/') { -1 } else { 1 };
                continue;
            }
            let inner = parts(&part);
            let exponent = inner.get(1).map_or(Some(1), |e| e.as_str().parse::<i32>().ok())?;
            factors.push((self.name(inner.first()?), sign * exponent));
        }
        Some(Dimension { factors, span: self.span_of(&dimension) })
    }

    fn members(&mut self, block: &Pair<'_, Rule>, trivia: &[super::ast::Comment]) -> Vec<Member> {
        let mut members = Vec::new();
        for pair in parts(block) {
            match pair.as_rule() {
                Rule::bad_member => self.bad(Rule::only_member, &pair),
                _ => members.extend(self.member(&pair, trivia)),
            }
        }
        members
    }

    fn member(&mut self, pair: &Pair<'_, Rule>, trivia: &[super::ast::Comment]) -> Option<Member> {
        let span = self.span_of(pair);
        let inner = parts(pair);
        Some(match pair.as_rule() {
            Rule::parameter => Member::Parameter(self.constant(pair, trivia)?),
            Rule::continuous => {
                let name = self.name(inner.first()?);
                let dimension = inner.iter().find(|p| p.as_rule() == Rule::annotation).and_then(|p| self.dimension(p));
                let initial = inner.iter().find(|p| p.as_rule() == Rule::expression);
                let initial = initial.and_then(|p| self.expression(p));
                Member::Continuous(Continuous { name, dimension, initial })
            }
            Rule::discrete => {
                let name = self.name(inner.first()?);
                let domain = self.domain(inner.get(1)?)?;
                let initial = self.expression(inner.iter().rfind(|p| p.as_rule() == Rule::expression)?)?;
                Member::Discrete(Discrete { name, domain, initial })
            }
            Rule::buttons => Member::Buttons(self.names(pair), span),
            Rule::axes => Member::Axes(self.names(pair), span),
            Rule::collider => {
                let kinematic = inner.first()?.as_rule() == Rule::kw_kinematic;
                let tags = self.names(inner.iter().find(|p| p.as_rule() == Rule::tags)?);
                let shape_pair = inner.iter().find(|p| p.as_rule() == Rule::shape)?;
                let shape_parts = parts(shape_pair);
                let shape = self.name(shape_parts.first()?);
                let arguments = self.expressions(shape_parts.get(1..)?)?;
                let guard = match inner.iter().find(|p| p.as_rule() == Rule::expression) {
                    Some(guard) => Some(self.expression(guard)?),
                    None => None,
                };
                Member::Collider(Collider { kinematic, tags, shape, arguments, guard, span })
            }
            Rule::group => {
                let name = self.name(inner.first()?);
                Member::Group(Group { name, members: self.members(inner.get(1)?, trivia), span })
            }
            Rule::mode => {
                let mut inner = inner.into_iter();
                let mut first = inner.next()?;
                let mut initial = Initial::No;
                if first.as_rule() == Rule::initial {
                    let guard = parts(&first).into_iter().next();
                    initial = match guard {
                        Some(guard) => Initial::When(self.expression(&guard)?),
                        None => Initial::Plain,
                    };
                    first = inner.next()?;
                }
                let name = self.name(&first);
                let members = self.members(&inner.next()?, trivia);
                Member::Mode(Mode { initial, name, members, doc: self.doc(pair, trivia), span })
            }
            Rule::assignment => {
                let becomes = inner.get(1)?.as_rule() == Rule::becomes;
                let assignment = Assignment {
                    variable: self.variable(inner.first()?)?,
                    value: self.expression(inner.get(2)?)?,
                    span,
                };
                if becomes { Member::Entry(Update::Assign(assignment)) } else { Member::Flow(assignment) }
            }
            Rule::spawn | Rule::destroy => Member::Entry(self.update(pair)?),
            Rule::reference => {
                Member::Reference(Reference { name: self.name(inner.first()?), entity: self.name(inner.get(1)?) })
            }
            Rule::clamp => {
                let variable = self.variable(inner.first()?)?;
                let bounds = inner.get(1)?;
                let (low, high) = match bounds.as_rule() {
                    Rule::within => {
                        let both = self.expressions(&parts(bounds).into_iter().skip(1).collect::<Vec<_>>())?;
                        let [low, high]: [Expr; 2] = both.try_into().ok()?;
                        (Some(low), Some(high))
                    }
                    Rule::at_most => (None, Some(self.expression(inner.get(2)?)?)),
                    _ => (Some(self.expression(inner.get(2)?)?), None),
                };
                Member::Clamp(Clamp { variable, low, high, span })
            }
            Rule::invariant => Member::Invariant(Invariant { predicate: self.expression(inner.first()?)?, span }),
            Rule::put => {
                let arguments = match inner.get(1) {
                    Some(actuals) => self.actuals(actuals)?,
                    None => Vec::new(),
                };
                Member::Use(Use { behavior: self.name(inner.first()?), arguments, span })
            }
            Rule::follow => {
                let guard = match inner.iter().find(|p| p.as_rule() == Rule::expression) {
                    Some(guard) => Some(self.expression(guard)?),
                    None => None,
                };
                let updates = inner.iter().find(|p| p.as_rule() == Rule::updates);
                let updates = updates.map_or(Vec::new(), |u| self.updates(u));
                Member::Follow(Follow { guard, updates, span })
            }
            Rule::edge => {
                let guard = self.expression(inner.first()?)?;
                let mut target = None;
                let mut updates = Vec::new();
                let mut is_empty = true;
                for part in inner.iter().skip(1) {
                    match part.as_rule() {
                        Rule::target => target = Some(self.path(parts(part).first()?)?),
                        Rule::updates => {
                            is_empty = parts(part).is_empty();
                            updates = self.updates(part);
                        }
                        _ => {}
                    }
                }
                Member::Edge(Edge { guard, target, updates, is_empty, span })
            }
            Rule::envelope => Member::Envelope(self.envelope(pair)?),
            _ => return None,
        })
    }

    fn domain(&mut self, pair: &Pair<'_, Rule>) -> Option<Domain> {
        let domain = parts(pair).into_iter().next()?;
        let inner = parts(&domain);
        Some(match domain.as_rule() {
            Rule::int_domain => {
                Domain::Int(Box::new(self.expression(inner.first()?)?), Box::new(self.expression(inner.get(1)?)?))
            }
            Rule::bool_domain => Domain::Bool,
            _ => Domain::Set(inner.iter().map(|p| self.name(p)).collect()),
        })
    }

    pub fn variable(&self, pair: &Pair<'_, Rule>) -> Option<Variable> {
        let inner = parts(pair);
        let primes = inner.get(1).map_or(0, |p| p.as_str().len());
        Some(Variable { name: self.name(inner.first()?), primes, span: self.span_of(pair) })
    }

    pub fn path(&self, pair: &Pair<'_, Rule>) -> Option<Path> {
        let mut segments = Vec::new();
        let mut primes = 0;
        for part in parts(pair) {
            if part.as_rule() == Rule::primes {
                primes = part.as_str().len();
            } else {
                segments.push(self.name(&part));
            }
        }
        (!segments.is_empty()).then(|| Path { segments, primes, span: self.span_of(pair) })
    }

    fn updates(&mut self, pair: &Pair<'_, Rule>) -> Vec<Update> {
        let mut updates = Vec::new();
        for part in parts(pair) {
            match part.as_rule() {
                Rule::bad_update => self.bad(Rule::only_update, &part),
                _ => updates.extend(self.update(&part)),
            }
        }
        updates
    }

    fn update(&mut self, pair: &Pair<'_, Rule>) -> Option<Update> {
        let span = self.span_of(pair);
        let inner = parts(pair);
        Some(match pair.as_rule() {
            Rule::spawn => {
                let into = inner.first().filter(|p| p.as_rule() == Rule::variable);
                let into = match into {
                    Some(variable) => Some(self.variable(variable)?),
                    None => None,
                };
                let entity = self.name(inner.iter().find(|p| p.as_rule() == Rule::name)?);
                let settings = match inner.iter().find(|p| p.as_rule() == Rule::actuals) {
                    Some(actuals) => self.actuals(actuals)?,
                    None => Vec::new(),
                };
                Update::Spawn(Spawn { into, entity, settings, span })
            }
            Rule::destroy => {
                let what = inner.first()?;
                let at = self.span_of(what);
                let kind = match what.as_rule() {
                    Rule::kw_self => ExprKind::SelfRef,
                    _ => ExprKind::Path(Path { segments: vec![self.name(what)], primes: 0, span: at }),
                };
                Update::Destroy(Destroy { what: Expr { kind, span: at }, span })
            }
            _ => Update::Assign(self.assignment(pair)?),
        })
    }

    fn actuals(&mut self, pair: &Pair<'_, Rule>) -> Option<Vec<Assignment>> {
        parts(pair).iter().map(|actual| self.assignment(actual)).collect()
    }

    /// `variable = value` or `variable := value`.
    pub fn assignment(&mut self, pair: &Pair<'_, Rule>) -> Option<Assignment> {
        let inner = parts(pair);
        Some(Assignment {
            variable: self.variable(inner.first()?)?,
            value: self.expression(inner.get(2)?)?,
            span: self.span_of(pair),
        })
    }

    fn envelope(&mut self, pair: &Pair<'_, Rule>) -> Option<Envelope> {
        let mut out = Envelope {
            controlled: Vec::new(),
            by: None,
            directions: None,
            ramps: Vec::new(),
            complete: true,
            span: self.span_of(pair),
        };
        for part in parts(pair) {
            match part.as_rule() {
                Rule::controlled => {
                    out.controlled = parts(&part).iter().map(|v| self.variable(v)).collect::<Option<_>>()?;
                }
                Rule::expression => out.by = Some(self.expression(&part)?),
                Rule::directions => out.directions = parts(&part).first().map(|d| self.name(d)),
                Rule::ramps => {
                    for ramp in parts(&part) {
                        match ramp.as_rule() {
                            Rule::bad_ramp => {
                                out.complete = false;
                                self.bad(Rule::only_ramp, &ramp);
                            }
                            _ => out.ramps.extend(self.ramp(&ramp)),
                        }
                    }
                }
                _ => {}
            }
        }
        Some(out)
    }

    fn ramp(&mut self, pair: &Pair<'_, Rule>) -> Option<Ramp> {
        let inner = parts(pair);
        let first = inner.first()?;
        let kind = match pair.as_rule() {
            Rule::attack => RampKind::Attack(self.rate(first)?, self.level(inner.get(1))),
            Rule::decay => RampKind::Decay(self.rate(first)?),
            Rule::sustain if first.as_rule() == Rule::sustain_for => {
                RampKind::SustainFor(self.expression(parts(first).first()?)?)
            }
            Rule::sustain => RampKind::Sustain(self.expression(first)?),
            Rule::release => match first.as_rule() {
                Rule::hold => RampKind::ReleaseHold,
                Rule::level => RampKind::Release(None, self.level(Some(first))),
                _ => RampKind::Release(Some(self.rate(first)?), self.level(inner.get(1))),
            },
            Rule::driven_while => RampKind::While(self.expression(first)?),
            _ => return None,
        };
        Some(Ramp { kind, span: self.span_of(pair) })
    }

    fn rate(&mut self, pair: &Pair<'_, Rule>) -> Option<Rate> {
        let rate = parts(pair).into_iter().next()?;
        let value = parts(&rate);
        Some(match rate.as_rule() {
            Rule::accel => Rate::Accel(self.expression(value.first()?)?),
            Rule::over => Rate::Over(self.expression(value.first()?)?),
            _ => Rate::Instant,
        })
    }

    fn level(&mut self, pair: Option<&Pair<'_, Rule>>) -> Option<Expr> {
        self.expression(parts(pair?).first()?)
    }
}

/// The names that a broken declaration would have introduced: the words after a declaring word, or after a first word
/// that opens nothing and may be a slip.
fn declared_names(slice: &str) -> Vec<String> {
    const DECLARING: &[&str] = &[
        "param",
        "continuous",
        "discrete",
        "ref",
        "button",
        "axis",
        "collider",
        "group",
        "mode",
        "entity",
        "behavior",
        "world",
        "const",
        "space",
        "tiles",
        "place",
        "goal",
        "never",
        "map",
    ];
    const OTHER: &[&str] = &["when", "envelope", "import", "step", "collide", "player", "kinematic", "initial", "use"];
    let mut names = Vec::new();
    let mut declaring = false;
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut first = true;
    for token in slice.split(|c: char| !is_word(c) && c != ',').filter(|t| !t.is_empty()) {
        let list_goes_on = token.ends_with(',');
        for word in token.split(',').filter(|w| !w.is_empty()) {
            let slip = first && !OTHER.contains(&word) && !DECLARING.contains(&word);
            let declares = DECLARING.contains(&word) || slip;
            // `speed 100`, its `param` forgotten, declares its first word.
            if slip || (declaring && !declares) {
                names.push(word.to_string());
            }
            declaring = declares || (declaring && list_goes_on);
            first = false;
        }
    }
    names
}
