//! JSON Schemas (draft 2020-12) of the outputs of commands: those in `docs/schemas`.

use schemars::Schema;
use schemars::transform::{RecursiveTransform, Transform};
use serde_json::Value;

use super::{corpus, diff, reach, tune};
use crate::ask::{bounds_schema, exploration_schema, reach_schema, sim_schema, stuck_schema, why_schema};
use crate::corpus::{Row, ShardHeader};
use crate::diagnostic::render;
use crate::experiment::Report;
use crate::ir::Program;
use crate::sim::trace_schemas;
use crate::suite::suite_schema;

/// Each schema with the name of its format.
pub fn schemas() -> Vec<(&'static str, Value)> {
    let [header, line] = trace_schemas();
    vec![
        ("program", Program::json_schema()),
        ("findings", closed(render::json_schema(), "Findings of `hypedc check --format json`")),
        ("bounds", closed(bounds_schema(), "What `hypedc bounds --format json` writes")),
        ("results", closed(reach_schema(), "What `hypedc reach --format json` writes")),
        ("exploration", closed(exploration_schema(), "What `hypedc reach --explore --format json` writes")),
        ("skill", closed(reach::skill_schema(), "What `hypedc reach --skill --format json` writes")),
        ("sweep", closed(reach::sweep_schema(), "What `hypedc reach --format json` writes of a sweep")),
        ("stuck", closed(stuck_schema(), "What `hypedc stuck --format json` writes")),
        ("tune", closed(tune::json_schema(), "What `hypedc tune --format json` writes")),
        ("tune-tiles", closed(tune::tiles_schema(), "What `hypedc tune --tiles --format json` writes")),
        ("tests", closed(suite_schema(), "What `hypedc test --format json` writes")),
        ("row", closed(schemars::schema_for!(Row), "A line of `hypedc reach --results`")),
        (
            "shard",
            closed(schemars::schema_for!(ShardHeader), "The first line of the file of a shard of `hypedc reach`"),
        ),
        ("levels", closed(corpus::json_schema(), "What `hypedc reach --format json` writes of several levels")),
        ("diff", closed(diff::json_schema(), "What `hypedc diff --format json` writes")),
        ("why", closed(why_schema(), "What `hypedc why --format json` writes")),
        ("experiment", closed(Report::json_schema(), "What `hypedc experiment --format json` writes")),
        ("sim", closed(sim_schema(), "What `hypedc sim --format json` writes")),
        ("trace-header", closed(header, "The first line of a trace of `hypedc sim --trace`")),
        ("trace-line", closed(line, "A state in a trace of `hypedc sim --trace`, as JSON")),
    ]
}

/// Adds a title to a schema and closes it to other fields.
fn closed(mut schema: Schema, title: &str) -> Value {
    schema.insert("title".into(), title.into());
    let close = |schema: &mut Schema| {
        if schema.get("properties").is_some() && schema.get("additionalProperties").is_none() {
            schema.insert("additionalProperties".into(), false.into());
        }
    };
    RecursiveTransform(close).transform(&mut schema);
    schema.to_value()
}
