//! From names to what they name: going there, finding all, renaming, hovering, edges as calls.

use serde_json::json;

use super::SLIME;
use super::session::Session;

const BOUNCER: &str = "\
/// Falls and bounces.
behavior Bounces(pull, strength) {
    param rest = 1
    initial mode falling {
        y'' = -pull
        when touching(wall, below) -> rising { y' := strength * rest }
    }
    mode rising { y'' = -pull; when y' < 0 -> falling }
}
";
const BALLS: &str = "\
import \"parts/bounces.hyped\"

entity Ball { collider ball: rect(0, 0, 8, 8); use Bounces(pull = 400, strength = lift); param lift = 90 }
entity Stone { collider stone: rect(0, 0, 8, 8); use Bounces(strength = 20, pull = 300) }
";

fn slime() -> Session {
    let mut session = Session::new(&[]);
    session.open("slime.hyped", SLIME);
    session
}

fn balls() -> Session {
    let mut session = Session::new(&[("parts/bounces.hyped", BOUNCER)]);
    session.open("balls.hyped", BALLS);
    session
}

#[test]
fn names_lead_to_their_declarations() {
    let mut session = slime();
    for place in ["-> a|ir", "y' := jump_sp|eed", "facing == le|ft", "touching(bo|dy", "her|o.x", "hero.|x", "sl|ime.x"]
    {
        session.ask_at("textDocument/definition", "slime.hyped", place, json!({}));
    }
    let mut balls = balls();
    for place in ["use Boun|ces(p", "stren|gth = 20", "import \"parts/b|ounces"] {
        balls.ask_at("textDocument/definition", "balls.hyped", place, json!({}));
    }
    insta::assert_snapshot!(session.end() + &balls.end());
}

#[test]
fn all_uses_are_found_in_all_files() {
    let mut session = slime();
    let whole = json!({ "context": { "includeDeclaration": true } });
    session.ask_at("textDocument/references", "slime.hyped", "mode a|ir", whole.clone());
    session.ask_at("textDocument/references", "slime.hyped", "with w|all", whole.clone());
    session.ask_at("textDocument/documentHighlight", "slime.hyped", "discrete fac|ing", json!({}));
    let mut balls = balls();
    let uses = json!({ "context": { "includeDeclaration": false } });
    balls.ask_at("textDocument/references", "balls.hyped", "stren|gth = 20", uses);
    insta::assert_snapshot!(session.end() + &balls.end());
}

#[test]
fn names_are_renamed_in_all_files() {
    let mut session = balls();
    session.open("parts/bounces.hyped", BOUNCER);
    session.ask_at("textDocument/prepareRename", "parts/bounces.hyped", "mode ris|ing", json!({}));
    let new = |name: &str| json!({ "newName": name });
    session.ask_at("textDocument/rename", "parts/bounces.hyped", "mode ris|ing", new("up"));
    session.ask_at("textDocument/rename", "balls.hyped", "stren|gth = 20", new("speed"));
    for name in ["pull", "2x", "when", ""] {
        session.ask_at("textDocument/rename", "balls.hyped", "stren|gth = 20", new(name));
    }
    session.ask_at("textDocument/rename", "parts/bounces.hyped", "mode ris|ing", new("falling"));
    session.ask_at("textDocument/rename", "parts/bounces.hyped", "|y'' = -pull", new("height"));
    session.ask_at("textDocument/rename", "balls.hyped", "400|, ", new("height"));
    insta::assert_snapshot!(session.end());
}

#[test]
fn a_new_name_must_not_catch_what_meant_another() {
    let mut session = Session::new(&[]);
    session.open("a.hyped", "const fast = 3\nentity A { param slow = 1; x' = fast / 1s; y' = slow }\n");
    session.ask_at("textDocument/rename", "a.hyped", "param sl|ow", json!({ "newName": "fast" }));
    session.ask_at("textDocument/rename", "a.hyped", "const fa|st", json!({ "newName": "slow" }));
    insta::assert_snapshot!(session.end());
}

const FROG: &str = "\
behavior Sinks(t) {
    condition tired = timer > t
    mode dry { when tired -> wet }
    mode wet { }
}
/// Leaps.
entity Frog {
    button jump
    collider body: rect(0, 0, 8, 8)
    /// Stands on something.
    condition on_floor = touching(body, wall, below)
        or touching(body, leaf, below)
    condition leaps = on_floor and pressed(jump)
    mode sit {
        condition warm = timer > 1s
        when leaps and warm -> sit { y' := 9 }
        when not on_floor -> swim
    }
    mode swim { use Sinks(t = 2s) }
}
world Pond {
    collide body with wall, leaf: block
    condition high = frog.y > 20
    goal up: high
    never both: high and frog in swim
    space s { place frog: Frog at (0, 0) }
}
";

#[test]
fn conditions_have_names() {
    let mut session = Session::new(&[]);
    session.open("frog.hyped", FROG);
    // What a place says holds the findings there, which come when the analysis has ended.
    session.client.settle();
    let places = ["leaps = on_fl|oor", "when lea|ps", "and wa|rm", "up: hi|gh", "when ti|red"];
    for place in places {
        session.ask_at("textDocument/definition", "frog.hyped", place, json!({}));
        session.ask_at("textDocument/hover", "frog.hyped", place, json!({}));
    }
    let whole = json!({ "context": { "includeDeclaration": true } });
    session.ask_at("textDocument/references", "frog.hyped", "condition on_fl|oor", whole);
    for (place, name) in
        [("when not on_fl|oor", "stands"), ("up: hi|gh", "far"), ("condition ti|red", "worn"), ("and wa|rm", "leaps")]
    {
        session.ask_at("textDocument/rename", "frog.hyped", place, json!({ "newName": name }));
    }
    session.ask("textDocument/documentSymbol", "frog.hyped", json!({}));
    session.ask_at("textDocument/hover", "frog.hyped", "condi|tion leaps", json!({}));
    insta::assert_snapshot!(session.end());
}

#[test]
fn signals_have_names() {
    let text = "entity Ship {
    /// What is won.
    signal score(points)
    discrete total: int 0..99 = 0
    mode m { when received(score) { total += score.points } }
}
entity Mine { ref by: Ship; mode m { when timer > 1s { send by.score(3); send all Ship.score(1) } } }
";
    let mut session = Session::new(&[]);
    session.open("sea.hyped", text);
    session.client.settle();
    for place in ["send by.sc|ore", "+= score.po|ints", "signal sc|ore", "sen|d by", "rece|ived"] {
        session.ask_at("textDocument/hover", "sea.hyped", place, json!({}));
    }
    session.ask_at("textDocument/definition", "sea.hyped", "all Ship.sc|ore", json!({}));
    session.ask_at("textDocument/rename", "sea.hyped", "received(sc|ore", json!({ "newName": "won" }));
    session.ask_at("textDocument/rename", "sea.hyped", "score(po|ints", json!({ "newName": "value" }));
    insta::assert_snapshot!(session.end());
}

#[test]
fn tags_of_levels_are_not_renamed() {
    let legend = "{ \"tiles\": { \"-\": [\"passable\", \"empty\"], \"X\": [\"solid\", \"ground\"] } }";
    let mut session = Session::new(&[("level.txt", "--\nXX\n"), ("legend.json", legend)]);
    let text = "world W {\n    collide hero with solid: block\n    space main { map vglc \"level.txt\" legend \"legend.json\" tile 16 x 16 }\n}\n";
    session.open("a.hyped", text);
    session.ask_at("textDocument/rename", "a.hyped", "with so|lid", json!({ "newName": "rock" }));
    session.ask("textDocument/documentLink", "a.hyped", json!({}));
    insta::assert_snapshot!(session.end());
}

#[test]
fn what_is_known_of_a_name_is_shown() {
    let mut session = slime();
    session.client.settle();
    let places = [
        "param jump_sp|eed",
        "param grav|ity",
        "clamp |y'",
        "discrete fac|ing",
        "mode a|ir",
        "place he|ro",
        "colli|der body",
        "with enem|y",
        "when pres|sed",
        "== le|ft",
        "goal ov|er",
        "entity Sl|ime",
        "const floor_h|eight",
    ];
    for place in places {
        session.ask_at("textDocument/hover", "slime.hyped", place, json!({}));
    }
    let mut balls = balls();
    balls.ask_at("textDocument/hover", "balls.hyped", "stren|gth = 20", json!({}));
    let mut known = Session::new(&[]);
    known.open("known.hyped", "entity A { mode start { x' = tau; when x > start.x + pi -> start } }\n");
    known.client.settle();
    for place in ["x > st|art.x", "= ta|u", "-> st|art"] {
        known.ask_at("textDocument/hover", "known.hyped", place, json!({}));
    }
    insta::assert_snapshot!(session.end() + &balls.end() + &known.end());
}

#[test]
fn the_workspace_has_symbols() {
    let mut session = Session::new(&[("parts/bounces.hyped", BOUNCER), ("slime.hyped", SLIME)]);
    session.ask_all("workspace/symbol", json!({ "query": "rising" }));
    session.ask_all("workspace/symbol", json!({ "query": "sl" }));
    insta::assert_snapshot!(session.end());
}

#[test]
fn edges_are_calls() {
    let mut session = slime();
    let items = session.ask_at("textDocument/prepareCallHierarchy", "slime.hyped", "mode a|ir", json!({}));
    session.ask_all("callHierarchy/incomingCalls", json!({ "item": items[0] }));
    session.ask_all("callHierarchy/outgoingCalls", json!({ "item": items[0] }));
    insta::assert_snapshot!(session.end());
}

#[test]
fn words_are_explained_where_they_are_no_names() {
    let text = "entity A {
    param goal = 3
    discrete step: int 0..9 = 0
    axis to
    collider wall: rect(0, 0, 4, 4)
    envelope x' by to { attack over 1s to 3; sustain 2 }
    mode m { when timer > goal -> m; follow links }
}
world W {
    step 1/60
    space s { rect wall (0, 0, 4, 4); place a: A at (0, 0) }
    goal over: a.x > 3 and a in m
    limit A 3
}
";
    let mut session = Session::new(&[]);
    session.open("a.hyped", text);
    session.client.settle();
    let names = ["param go|al", "discrete st|ep", "axis t|o", "by t|o {", "> go|al ->"];
    let words = [
        "p|aram goal",
        "    st|ep 1/60",
        "1s t|o 3",
        "    go|al over",
        "fol|low",
        "when tim|er",
        "wall: re|ct(",
        "{ re|ct wall",
        "lim|it A",
        "in|t 0",
        "a |in m",
        "when| timer",
    ];
    for place in names.into_iter().chain(words) {
        session.ask_at("textDocument/hover", "a.hyped", place, json!({}));
    }
    session.open("b.hyped", "world W {\n    limit A 3\n    goal = 3 +\n    space s {\n        rect\n");
    for place in ["lim|it", "wor|ld", "go|al", "spa|ce", "re|ct"] {
        session.ask_at("textDocument/hover", "b.hyped", place, json!({}));
    }
    insta::assert_snapshot!(session.end());
}

#[test]
fn what_was_found_is_explained() {
    let mut session = Session::new(&[]);
    session.open("a.hyped", "entity A { param p = 1; x' = q; y' = p }\n");
    for place in ["x' = |q", "y' = |p", "entity| A"] {
        session.ask_at("textDocument/hover", "a.hyped", place, json!({}));
    }
    session.open("slime.hyped", SLIME);
    session.client.settle();
    session.ask_at("textDocument/hover", "slime.hyped", "when |y' < -300", json!({}));
    insta::assert_snapshot!(session.end());
}

#[test]
fn names_mean_something_in_behaviors_that_nothing_uses() {
    let text = "behavior Patrol(to, speed) {
    param rest = 1
    button go
    continuous charge = 0
    mode right {
        x' = speed * rest
        charge' = 1
        when x >= to or pressed(go) -> left
    }
    mode left { when charge > 3 -> right { y' := floor } }
    use Jumps
}
behavior Jumps { axis way; button up; when pressed(up) and way > 0 -> away }
const floor = 3
entity User { use Used }
behavior Used { mode only { x' = floor } }
";
    let mut session = Session::new(&[]);
    session.open("a.hyped", text);
    let places = [
        "* re|st",
        "pressed(g|o",
        "-> le|ft",
        "charge| > 3",
        ":= flo|or",
        ">= t|o or",
        "use Jum|ps",
        "pressed(u|p",
        "wa|y >",
    ];
    for place in places {
        session.ask_at("textDocument/definition", "a.hyped", place, json!({}));
    }
    for place in ["-> le|ft", "|x >= to"] {
        session.ask_at("textDocument/hover", "a.hyped", place, json!({}));
    }
    let whole = json!({ "context": { "includeDeclaration": true } });
    session.ask_at("textDocument/references", "a.hyped", "charge| > 3", whole);
    session.ask_at("textDocument/rename", "a.hyped", "mode ri|ght", json!({ "newName": "east" }));
    session.ask_at("textDocument/rename", "a.hyped", "mode ri|ght", json!({ "newName": "left" }));
    session.show_findings();
    insta::assert_snapshot!(session.end());
}

#[test]
fn what_a_name_meant_is_told_while_the_text_is_broken() {
    let mut session = slime();
    session.client.settle();
    // The entity is no more than a broken slice, and lines were put before it.
    session.replace("slime.hyped", "entity Slime {", "\n\nentity Slime {{");
    session.replace("slime.hyped", "mode air {", "mode air ({");
    for place in ["param jump_sp|eed", "y'' = grav|ity", "-> grou|nd\n", "pressed(ju|mp", "== le|ft"] {
        session.ask_at("textDocument/hover", "slime.hyped", place, json!({}));
        session.ask_at("textDocument/definition", "slime.hyped", place, json!({}));
    }
    // Another name than the one that stood there means nothing.
    session.replace("slime.hyped", "y'' = gravity", "y'' = gravi");
    session.ask_at("textDocument/hover", "slime.hyped", "y'' = grav|i", json!({}));
    insta::assert_snapshot!(session.end());
}

#[test]
fn what_a_name_means_is_told_before_a_renaming_has_come_in_all_files() {
    let mut session = balls();
    session.open("parts/bounces.hyped", BOUNCER);
    session.client.settle();
    session.ask_at("textDocument/rename", "balls.hyped", "use Boun|ces(p", json!({ "newName": "Hops" }));
    session.replace("balls.hyped", "use Bounces(pull", "use Hops(pull");
    session.ask_at("textDocument/hover", "balls.hyped", "use Ho|ps(p", json!({}));
    session.replace("parts/bounces.hyped", "behavior Bounces", "behavior Hops");
    session.ask_at("textDocument/hover", "balls.hyped", "use Ho|ps(p", json!({}));
    insta::assert_snapshot!(session.end());
}
