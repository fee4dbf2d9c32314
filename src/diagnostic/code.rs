//! The closed list of diagnostic codes. The first digit after the letter is the family: files and limits, syntax,
//! names, types, structure, worlds, questions and runs, values, imports.

use std::fmt;

use super::Severity;

macro_rules! codes {
    ($($variant:ident $severity:ident $text:literal $title:literal)*) => {
        /// A kind of finding.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Code {
            $(#[doc = $title] $variant,)*
        }

        impl Code {
            /// Every code, in order.
            pub const ALL: &[Code] = &[$(Code::$variant),*];

            /// The code as shown: `E0201`.
            pub fn text(self) -> &'static str {
                match self { $(Code::$variant => $text,)* }
            }

            /// The meaning of the code, in a few words.
            pub fn title(self) -> &'static str {
                match self { $(Code::$variant => $title,)* }
            }

            /// The page that explains it: `catalogue/pages/E0201.md`.
            pub fn page(self) -> &'static str {
                match self { $(Code::$variant => include_str!(concat!("catalogue/pages/", $text, ".md")),)* }
            }

            /// Whether it is an error or a warning.
            pub fn severity(self) -> Severity {
                match self { $(Code::$variant => Severity::$severity,)* }
            }
        }
    };
}

codes! {
    Unreadable Error "E0001" "a file cannot be read"
    NotUtf8 Error "E0002" "a file is not UTF-8 text"
    TooLarge Error "E0003" "a file or a world is larger than what is supported"
    NestingTooDeep Error "E0004" "too many brackets are open at once"
    ExpressionTooLong Error "E0005" "an expression has too many operators"

    Syntax Error "E0101" "the text does not fit the grammar"
    UnbalancedBrace Error "E0102" "a brace has no partner"
    UnterminatedMap Error "E0103" "a map has no end"
    Misplaced Error "E0104" "a declaration in the wrong place"

    UnknownName Error "E0201" "a name is not declared"
    DuplicateName Error "E0202" "a name is declared twice"
    AmbiguousMode Error "E0203" "a mode's name fits several modes"
    ImportCycle Error "E0204" "files import each other"
    BehaviorCycle Error "E0205" "behaviours use each other"
    ConditionCycle Error "E0206" "conditions use each other"

    TypeMismatch Error "E0301" "a value is of the wrong type"
    DimensionConflict Error "E0302" "a value is used with two dimensions"
    WrongArguments Error "E0303" "a function is called with the wrong arguments"
    NotConstant Error "E0304" "a value must be known before the world runs"
    BadChain Error "E0305" "a chain of comparisons does not go one way"
    OutOfRange Error "E0306" "a value lies outside of what is possible"

    EdgeOutOfGroup Error "E0401" "an edge leads into another group"
    FlowConflict Error "E0402" "a variable is driven twice"
    UpdateConflict Error "E0403" "a variable is updated twice"
    BadEnvelope Error "E0405" "an envelope is incomplete or contradicts itself"
    BadCollider Error "E0406" "a collider has no extent"
    LostReference Error "E0407" "a reference is read where it may be none"
    JointCycle Error "E0408" "groups wait for each other's transitions"

    BadMap Error "E0501" "a map does not fit its tiles"
    BadStep Error "E0502" "a world's step is not a positive time"
    BadPlayer Error "E0503" "players and instances do not fit together"
    BadLimit Error "E0504" "more instances than a limit allows, or none given"
    TileInstances Error "E0505" "a named tile instance is not in the map exactly once"

    LinkNowhere Error "E0506" "a link leads to nowhere"
    BadLevel Error "E0507" "a level of an editor cannot be read"
    BadWrap Error "E0508" "a space cannot wrap"
    BadSlope Error "E0509" "a slope does not fit its tile"
    BadLook Error "E0510" "a look is no colour and no picture"
    BadTest Error "E0511" "a test cannot be run"
    NoPlaceAbove Error "E0512" "there is no place above a tag"

    BadInput Error "E0601" "an input script cannot be read"
    NoQuestion Error "E0602" "there is nothing to run or to ask"
    Fault Error "E0603" "a running world broke a rule"
    InvariantBroken Error "E0604" "an invariant does not hold in a running world"
    TestFailed Error "E0605" "a test failed"

    BrokenAtStart Error "E0701" "an invariant does not hold at the start"

    NotWellFormed Error "E0801" "a file to import is not well-formed"
    BadForm Error "E0802" "a file to import does not follow its form"
    NotCarriedOver Error "E0803" "something has no counterpart and is not imported"

    Unused Warning "W0201" "nothing uses a declaration"
    MayLeaveRange Warning "W0301" "a discrete variable may leave its range"
    IdleEdge Warning "W0401" "an edge does nothing"
    ConstantGuard Warning "W0402" "a guard is always true or always false"
    UnreachableMode Warning "W0403" "a mode can never be entered"
    Trap Warning "W0404" "a mode has edges, but can never be left"
    Shadowed Warning "W0405" "an edge is never taken, an earlier edge is always taken instead"
    GroupClash Warning "W0406" "two groups can update a variable in one step"
    UncarriedTag Warning "W0501" "nothing carries a tag"
    UnpairedTouch Warning "W0502" "no `collide` line lets a contact happen"
    NoPlayer Warning "W0503" "no player gives the inputs of an entity"
    PlacedInside Warning "W0504" "an instance starts inside an obstacle"
    UnknownSetting Warning "W0505" "a level sets what an entity does not have"
    BeyondBounds Warning "W0506" "something can only happen out of bounds, where a run ends"
    UnknownLevelName Warning "W0507" "a level has a name that the program almost knows"
    NoPicture Warning "W0508" "a picture cannot be shown"
    IdleTest Warning "W0509" "a part of a test makes no difference"
    SpawnRefused Warning "W0601" "a spawn found no free slot"
    GuardByValue Warning "W0701" "by its values, a guard never or always holds"
    ModeByValue Warning "W0702" "by the values, a mode is never entered"
    UnprovenInvariant Warning "W0703" "an invariant is not proven"
    LeavesRange Warning "W0704" "by the values, a discrete variable may leave its range"
    Tunnels Warning "W0705" "a body may pass through what blocks it"
    GoalByValue Warning "W0706" "by the values, a goal is never reached"
    Renamed Warning "W0801" "an imported name is changed"
    LeftOut Warning "W0802" "something without effect is not imported"
    Bounded Warning "W0803" "an imported number is given bounds"
    Assumed Warning "W0804" "an import rests on an assumption"
}

impl Code {
    /// Parses a code: `E0302`, in letters of either case.
    pub fn from_text(text: &str) -> Option<Code> {
        Code::ALL.iter().copied().find(|code| code.text().eq_ignore_ascii_case(text))
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.text())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_in_order_and_differ() {
        for pair in Code::ALL.windows(2) {
            assert!(pair[0].text() < pair[1].text(), "{} and {}", pair[0], pair[1]);
        }
    }

    #[test]
    fn codes_are_read_in_either_case() {
        for code in Code::ALL {
            assert_eq!(Code::from_text(code.text()), Some(*code));
            assert_eq!(Code::from_text(&code.text().to_lowercase()), Some(*code));
        }
        assert_eq!(["302", "E302", "E0302 ", ""].map(Code::from_text), [None; 4]);
    }
}
