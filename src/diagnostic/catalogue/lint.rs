//! Facts about programs that are valid but probably wrong.

use super::list;
use crate::diagnostic::suggestion::{BlockKind, Change};
use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::Span;

/// A declaration that nothing uses.
pub struct Unused {
    /// The kind of declaration: `parameter`, `button` …
    pub kind: &'static str,
    /// Its name.
    pub name: String,
    /// Where it is declared.
    pub at: Span,
    /// A place that writes it, if any, although nothing reads it.
    pub written: Option<Span>,
}

impl Fact for Unused {
    fn into_diagnostic(self) -> Diagnostic {
        let Unused { kind, name, at, written } = self;
        let verb = if matches!(kind, "behavior" | "condition") { "uses" } else { "reads" };
        let d = Diagnostic::new(Code::Unused, format!("nothing {verb} the {kind} `{name}`"));
        let hides = matches!(kind, "variable" | "reference");
        let rename = vec![Change::Rename(at, format!("_{name}"))];
        let d = if hides { d.suggest(format!("call it `_{name}`"), rename) } else { d };
        let d = match written {
            None => d.or_remove(&format!("the {kind}"), at),
            Some(_) => d,
        };
        match written {
            Some(written) => d.at(at, "declared here").and(written, "written, but never read"),
            None => d.at(at, "declared, but never used"),
        }
        .help(match kind {
            "variable" | "reference" => format!("remove it, or call it `_{name}` if only others look at it"),
            _ => "remove it".to_string(),
        })
    }
}

/// A discrete variable that an update can push out of its range.
pub struct MayLeaveRange {
    /// The variable.
    pub name: String,
    /// Its range.
    pub range: (i32, i32),
    /// The new value.
    pub at: Span,
    /// The interval of the new value; infinite where unknown.
    pub value: (f64, f64),
    /// The sign of the update that says the same and stops at the ends of the range.
    pub stopping: Option<&'static str>,
}

impl Fact for MayLeaveRange {
    fn into_diagnostic(self) -> Diagnostic {
        let MayLeaveRange { name, range: (low, high), at, value, stopping } = self;
        let found = match value {
            (f64::NEG_INFINITY, f64::INFINITY) => "this can be any number".to_string(),
            (least, f64::INFINITY) => format!("this can be {least} or any number above"),
            (f64::NEG_INFINITY, greatest) => format!("this can be {greatest} or any number below"),
            (least, greatest) if least == greatest => format!("this is {least}"),
            (least, greatest) => format!("this can be from {least} to {greatest}"),
        };
        Diagnostic::new(Code::MayLeaveRange, format!("`{name}` may leave its range, {low} to {high}"))
            .at(at, found)
            .help(match stopping {
                Some(sign) => {
                    format!("test `{name}` in the guard, or write `{name} {sign} …`, which stops at the ends")
                }
                None => format!("test `{name}` in the guard, or write `clamp(…, {low}, {high})`"),
            })
            .or_wrap(format!("write `clamp(…, {low}, {high})`"), at, "clamp(", &format!(", {low}, {high})"))
            .note("a value out of its range stops the run")
    }
}

/// A constant guard.
pub struct ConstantGuard {
    /// The guard.
    pub at: Span,
    /// Its value.
    pub holds: bool,
}

impl Fact for ConstantGuard {
    fn into_diagnostic(self) -> Diagnostic {
        let (always, help) = if self.holds {
            ("always true", "write `true` if that is meant")
        } else {
            ("always false", "remove what can never happen")
        };
        let d = Diagnostic::new(Code::ConstantGuard, format!("this guard is {always}")).at(self.at, always).help(help);
        match self.holds {
            true => d.or_write(self.at, "true"),
            false => d.or_remove("what never happens", self.at),
        }
    }
}

/// A mode that no edge leads to.
pub struct UnreachableMode {
    /// Its path.
    pub path: String,
    /// Its name.
    pub at: Span,
    /// The initial mode of its group (or of the mode around), and its place.
    pub first: Option<(String, Span)>,
    /// Edges beside it that may have been meant to lead to it, each with where it leads.
    pub doubtful: Vec<(Span, String)>,
}

impl Fact for UnreachableMode {
    fn into_diagnostic(self) -> Diagnostic {
        let d = Diagnostic::new(Code::UnreachableMode, format!("the mode `{}` can never be entered", self.path))
            .at(self.at, "no edge that can be taken leads here")
            .or_remove("the mode", self.at);
        let d = match self.first {
            Some((name, span)) => d.and(span, format!("`{name}` is where it begins")),
            None => d,
        };
        let d = self.doubtful.into_iter().fold(d, |d, (span, leads)| d.and(span, leads));
        d.help("add an edge to it, or write `initial` before it")
    }
}

/// A mode with edges that are all never taken.
pub struct Trap {
    /// Its path.
    pub path: String,
    /// Its name.
    pub at: Span,
    /// Its edges, each with the reason why it is never taken.
    pub edges: Vec<(Span, &'static str)>,
}

impl Fact for Trap {
    fn into_diagnostic(self) -> Diagnostic {
        let d = Diagnostic::new(Code::Trap, format!("the mode `{}` can never be left", self.path))
            .at(self.at, "none of its edges can be taken");
        let edges = self.edges.iter().map(|(span, _)| Change::Remove(*span)).collect();
        let d = d.suggest("remove the edges that are never taken", edges);
        self.edges.into_iter().take(4).fold(d, |d, (span, why)| d.and(span, why))
    }
}

/// An edge that an earlier edge always preempts.
pub struct Shadowed {
    /// The guard of the edge.
    pub at: Span,
    /// The guard of the earlier one.
    pub by: Span,
    /// Whether the earlier edge is in an enclosing mode.
    pub outer: bool,
}

impl Fact for Shadowed {
    fn into_diagnostic(self) -> Diagnostic {
        let d = Diagnostic::new(Code::Shadowed, "this edge is never taken: an earlier edge is always taken instead")
            .at(self.at, "whenever this holds …")
            .and(self.by, "… this holds, too, and is tried first")
            .or_remove("the edge", self.at);
        let before = vec![Change::MoveBefore(self.at, self.by)];
        let d = if self.outer { d } else { d.suggest("move it before the other edge", before) };
        if self.outer {
            d.note("edges of a mode are tried before those of the modes inside of it")
        } else {
            d.note("the edges of a mode are tried in the order in which they are written")
        }
    }
}

/// Updates of one variable by two groups in the same step.
pub struct GroupClash {
    /// The variable.
    pub variable: String,
    /// The update that takes effect if both happen.
    pub last: Span,
    /// The other one.
    pub first: Span,
}

impl Fact for GroupClash {
    fn into_diagnostic(self) -> Diagnostic {
        let message = format!("two groups can update `{}` in one step", self.variable);
        Diagnostic::new(Code::GroupClash, message)
            .at(self.last, "if both happen, this one counts")
            .and(self.first, "the other group's update")
            .or_remove("this update", self.last)
            .or_remove("the other group's update", self.first)
            .help("let only one group update it, or add `in MODE` to a guard so that both cannot happen")
    }
}

/// A tag that no tile, collider or `rect` has.
pub struct UncarriedTag {
    /// The tag.
    pub tag: String,
    /// The query for it.
    pub at: Span,
    /// A similar tag that is in use, and its first place.
    pub near: Option<(String, Span)>,
    /// What the word means elsewhere.
    pub elsewhere: Option<Elsewhere>,
    /// The tags of colliders that nothing asks for, if they are few, each with its first place.
    pub unasked: Vec<(String, Span)>,
}

/// What a word means that is no tag.
pub enum Elsewhere {
    /// An entity whose colliders have these tags.
    Entity(Vec<String>),
    /// A side, which is called this, after the tag of what is touched.
    Side(&'static str),
    /// A side, which is called this, after a tag of the entity itself.
    SideOf(&'static str, String),
}

impl Fact for UncarriedTag {
    fn into_diagnostic(self) -> Diagnostic {
        let near = match self.elsewhere {
            Some(Elsewhere::Side(side)) => format!("; did you mean the side `{side}`?"),
            _ => super::did_you_mean(self.near.as_ref().map(|(name, _)| name)),
        };
        let d = Diagnostic::new(Code::UncarriedTag, format!("nothing carries the tag `{}`{near}", self.tag))
            .at(self.at, "no collider, tile or `rect` has it");
        let d = match self.near {
            Some((name, at)) => d.and(at, format!("`{name}` stands here")).or_write(self.at, name),
            None => d,
        };
        let (help, meant) = match self.elsewhere {
            None => {
                let unasked = self.unasked.into_iter();
                return unasked.fold(d, |d, (tag, at)| {
                    d.and(at, format!("nothing asks for `{tag}`, which stands here")).or_write(self.at, tag)
                });
            }
            Some(Elsewhere::Side(side)) => {
                ("the sides are `left`, `right`, `above` and `below`".to_string(), Some(side.to_string()))
            }
            Some(Elsewhere::SideOf(side, own)) => {
                (format!("a side comes after the tag of what is touched: `touching({own}, TAG, {side})`"), None)
            }
            Some(Elsewhere::Entity(tags)) if tags.is_empty() => {
                (format!("`{}` is an entity, and has no collider to give it a tag", self.tag), None)
            }
            Some(Elsewhere::Entity(tags)) => {
                let quoted: Vec<String> = tags.iter().map(|tag| format!("`{tag}`")).collect();
                let noun = if tags.len() == 1 { "the tag" } else { "the tags" };
                let help = format!("`{}` is an entity; its colliders have {noun} {}", self.tag, list(&quoted, "and"));
                (help, tags.into_iter().next().filter(|_| quoted.len() == 1))
            }
        };
        match meant {
            Some(meant) => d.help(help).fix(format!("write `{meant}`"), self.at, meant),
            None => d.help(help),
        }
    }
}

/// A bound contact query for a tag that no instance can have.
pub struct NoInstanceTouched {
    /// The query.
    pub at: Span,
    /// The tag.
    pub tag: String,
    /// Whether tiles or `rect`s have it.
    pub is_static: bool,
    /// An entity that is called as the tag, and the tags of its colliders.
    pub same: Option<(String, Vec<String>)>,
    /// Entities that the query could find, each with a tag.
    pub others: Vec<(String, String)>,
}

impl Fact for NoInstanceTouched {
    fn into_diagnostic(self) -> Diagnostic {
        let NoInstanceTouched { at, tag, is_static, same, others } = self;
        let message = format!("no instance and no breakable tile carries the tag `{tag}`: `as` names nothing");
        let d = Diagnostic::new(Code::UncarriedTag, message)
            .at(at, if is_static { "only tiles and `rect`s have it: this never holds" } else { "this never holds" })
            .note("tiles and `rect`s are no instances: `destroy` breaks a tile that is `breakable`, and nothing else is done to them");
        if let Some((entity, tags)) = same {
            let quoted: Vec<String> = tags.iter().map(|tag| format!("`{tag}`")).collect();
            let noun = if tags.len() == 1 { "the tag" } else { "the tags" };
            return d.help(format!("`{entity}` is an entity; its colliders have {noun} {}", list(&quoted, "and")));
        }
        let known: Vec<String> = others.iter().map(|(entity, tag)| format!("`{entity}` by `{tag}`")).collect();
        let known = if known.is_empty() { String::new() } else { format!("; it can touch {}", list(&known, "and")) };
        let collider = super::world::as_tag(&tag);
        d.help(format!(
            "write `'#': {collider} breakable` for its tile, which can then be destroyed; or make it an entity with \
             `collider {collider}: rect(0, 0, 16, 16)`, and write `'#': spawn ENTITY` for its tile{known}"
        ))
    }
}

/// A contact query that no `collide` line of a world can make true.
pub struct UnpairedTouch {
    /// The query.
    pub at: Span,
    /// The tags of the entity's own colliders, and the other's.
    pub tags: (Vec<String>, String),
    /// The world, and its name's place.
    pub world: (String, Span),
    /// Its `collide` lines that pair one of the tags with others, at most one for each tag.
    pub lines: Vec<Span>,
    /// What a `collide` line would be written before.
    pub before: Option<Span>,
}

impl Fact for UnpairedTouch {
    fn into_diagnostic(self) -> Diagnostic {
        let (mine, other) = self.tags;
        let quoted: Vec<String> = mine.iter().map(|t| format!("`{t}`")).collect();
        let (world, span) = self.world;
        let message = format!("no `collide` line of `{world}` pairs {} with `{other}`", list(&quoted, "or"));
        let d = Diagnostic::new(Code::UnpairedTouch, message).at(self.at, "never holds");
        let d = match self.lines.as_slice() {
            [] => {
                let d = d.and(span, "in this world");
                self.before.into_iter().fold(d, |d, before| d.and(before, "the line may stand before this"))
            }
            lines => lines.iter().fold(d, |d, line| d.and(*line, "this pairs others")),
        };
        match mine.first() {
            Some(tag) => {
                let line = |response: &str| format!("collide {tag} with {other}: {response}");
                d.help(format!("add `{}`", line("sense"))).or_add(BlockKind::World, span, line("sense")).or_add(
                    BlockKind::World,
                    span,
                    line("block"),
                )
            }
            None => d,
        }
    }
}

/// An entity with inputs that no player controls.
pub struct NoPlayer {
    /// The entity.
    pub entity: String,
    /// The first of its inputs.
    pub at: Span,
    /// An instance of it.
    pub instance: (String, Span),
}

impl Fact for NoPlayer {
    fn into_diagnostic(self) -> Diagnostic {
        let (name, span) = self.instance;
        Diagnostic::new(Code::NoPlayer, format!("no player gives the inputs of `{}`", self.entity))
            .at(self.at, "never pressed")
            .and(span, "no player controls this instance")
            .help(format!("add `player 1: {name}` to the world"))
            .or_add(BlockKind::World, span, format!("player 1: {name}"))
            .or_add(BlockKind::World, span, format!("player 2: {name}"))
    }
}

/// An instance whose initial position overlaps an obstacle.
pub struct PlacedInside {
    /// The instance.
    pub name: String,
    /// Where it is placed.
    pub at: Span,
    /// The minimum push-out distance in the first step, px.
    pub depth: f64,
    /// The obstacle: a tile by column and row, or the place of a `rect`.
    pub of: Result<(usize, usize), Span>,
}

impl Fact for PlacedInside {
    fn into_diagnostic(self) -> Diagnostic {
        let deep = format!("{:.3}", self.depth);
        let deep = deep.trim_end_matches('0').trim_end_matches('.');
        let d = Diagnostic::new(Code::PlacedInside, format!("`{}` starts inside an obstacle", self.name));
        match self.of {
            Ok((column, row)) => {
                d.at(self.at, format!("{deep} px deep in the tile of column {column}, row {row}, counted from 0 below"))
            }
            Err(solid) => d.at(self.at, format!("{deep} px deep")).and(solid, "in this `rect`"),
        }
        .note("it is pushed out at the first step")
    }
}

/// A link whose end is outside the extent of its space.
pub struct LinkNowhere {
    /// The link.
    pub at: Span,
    /// The space that it leads to.
    pub space: String,
    /// The extent of that space, px: left, right, bottom, top.
    pub extent: (f64, f64, f64, f64),
}

impl Fact for LinkNowhere {
    fn into_diagnostic(self) -> Diagnostic {
        let (left, right, bottom, top) = self.extent;
        Diagnostic::new(Code::LinkNowhere, format!("a link to nowhere: it ends outside of `{}`", self.space))
            .at(self.at, "leads to where nothing is")
            .or_remove("the link", self.at)
            .note(format!("`{}` reaches from x = {left} to {right} px and from y = {bottom} to {top} px", self.space))
    }
}

/// A construct that can only have an effect outside the bounds of a space.
pub struct BeyondBounds {
    /// The construct and its effect: `this holds`, `this link is followed`.
    pub what: String,
    /// Its place.
    pub at: Span,
}

impl Fact for BeyondBounds {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::BeyondBounds, format!("{} only out of `bounds`, where a run has ended", self.what))
            .at(self.at, "out of bounds")
            .help("make the bounds larger, or leave them out: a run then ends at no border")
    }
}
