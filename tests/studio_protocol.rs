//! `studio/src/protocol.ts` has the types of `src/studio/protocol`: it is written from their JSON Schemas.
//!
//! `UPDATE=1 cargo test --test runtime studio_protocol` rewrites it.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::fmt::Write;

use serde_json::{Map, Value};

const FILE: &str = "studio/src/protocol.ts";
const HEAD: &str = "\
// What the page asks and what it is answered: the types of src/studio/protocol.
// Written by `UPDATE=1 cargo test --test runtime studio_protocol`.
";

#[test]
fn the_page_has_the_types_of_the_session() {
    let expected = types();
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(FILE, &expected).unwrap();
    }
    let found = std::fs::read_to_string(FILE).unwrap();
    assert!(found == expected, "{FILE} is not what the types give; `UPDATE=1` writes it");
}

fn types() -> String {
    let mut out = HEAD.to_string();
    let mut named = BTreeMap::new();
    for (name, schema) in ["Request", "Answer"].into_iter().zip(hypedc::studio::schemas()) {
        let variants = schema["oneOf"].as_array().unwrap().iter().map(|of| format!("\n  | {}", object_or_union(of)));
        write!(out, "\nexport type {name} ={};\n", variants.collect::<String>()).unwrap();
        named.extend(schema["$defs"].as_object().unwrap().clone());
    }
    assert!(named.len() > 20, "{}", named.len());
    for (name, schema) in named {
        if schema.get("properties").is_some() {
            write!(out, "\nexport interface {name} {{\n{}}}\n", lines(&schema)).unwrap();
        } else {
            write!(out, "\nexport type {name} = {};\n", object_or_union(&schema)).unwrap();
        }
    }
    out
}

/// The fields of an object, one a line, with what they are.
fn lines(schema: &Value) -> String {
    let mut out = String::new();
    for (name, field) in schema["properties"].as_object().unwrap() {
        if let Some(text) = field.get("description").and_then(Value::as_str) {
            writeln!(out, "  /** {} */", text.split_whitespace().collect::<Vec<_>>().join(" ")).unwrap();
        }
        writeln!(out, "  {};", property(schema, name, field)).unwrap();
    }
    out
}

fn property(schema: &Value, name: &str, field: &Value) -> String {
    let is_required = schema["required"].as_array().is_some_and(|all| all.iter().any(|of| of == name));
    format!("{name}{}: {}", if is_required { "" } else { "?" }, object_or_union(field))
}

/// A type.
fn object_or_union(schema: &Value) -> String {
    let Some(schema_map) = schema.as_object() else { return "unknown".to_string() };
    if let Some(name) = reference(schema_map) {
        let Some(fields) = schema.get("properties").and_then(Value::as_object) else { return name };
        let fields: Vec<String> = fields.iter().map(|(name, field)| property(schema, name, field)).collect();
        return format!("({{ {} }} & {name})", fields.join("; "));
    }
    if let Some(only) = schema_map.get("const") {
        return only.to_string();
    }
    for key in ["enum", "oneOf", "anyOf"] {
        if let Some(all) = schema_map.get(key).and_then(Value::as_array) {
            let part = |of: &Value| if key == "enum" { of.to_string() } else { object_or_union(of) };
            return all.iter().map(part).collect::<Vec<_>>().join(" | ");
        }
    }
    match &schema_map["type"] {
        Value::Array(all) => {
            let one = |kind: &Value| {
                let mut of = schema_map.clone();
                of.insert("type".into(), kind.clone());
                object_or_union(&Value::Object(of))
            };
            all.iter().map(one).collect::<Vec<_>>().join(" | ")
        }
        Value::String(kind) => plain(kind, schema, schema_map),
        other => panic!("type {other}"),
    }
}

fn plain(kind: &str, schema: &Value, of: &Map<String, Value>) -> String {
    match kind {
        "string" | "boolean" | "null" => kind.to_string(),
        "number" | "integer" => "number".to_string(),
        "array" => array(of),
        "object" => {
            let fields = schema["properties"].as_object().unwrap();
            let fields: Vec<String> = fields.iter().map(|(name, field)| property(schema, name, field)).collect();
            format!("{{ {} }}", fields.join("; "))
        }
        other => panic!("type {other}"),
    }
}

fn array(of: &Map<String, Value>) -> String {
    if let Some(all) = of.get("prefixItems").and_then(Value::as_array) {
        return format!("[{}]", all.iter().map(object_or_union).collect::<Vec<_>>().join(", "));
    }
    let item = object_or_union(&of["items"]);
    match (of.get("minItems").and_then(Value::as_u64), of.get("maxItems").and_then(Value::as_u64)) {
        (Some(least), Some(most)) if least == most => {
            format!("[{}]", vec![item; usize::try_from(least).unwrap()].join(", "))
        }
        _ if item.contains(" | ") => format!("({item})[]"),
        _ => format!("{item}[]"),
    }
}

fn reference(of: &Map<String, Value>) -> Option<String> {
    of.get("$ref")?.as_str()?.strip_prefix("#/$defs/").map(str::to_string)
}
