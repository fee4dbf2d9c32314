//! `workspace/executeCommand` and the requests of the same kind: their parameters, and the tasks that they begin.

use std::path::{Path, PathBuf};

use gen_lsp_types::Uri;
use lsp_server::{ErrorCode, Request};
use serde::Deserialize;
use serde_json::{Map, Value, json};

use super::context::Failure;
use super::extensions::LevelParams;
use super::tasks::Work;
use super::uri::{path_of, uri_of};
use crate::lsp::buffers::Buffers;
use crate::lsp::commands::{
    Command, Program, ReachArguments, RecordArguments, Recording, SimArguments, TestArguments, WhyArguments, record,
};
use crate::lsp::verdicts::level::ChosenLevel;
use crate::lsp::verdicts::shown::Shown;

/// The commands that the server offers.
pub(super) const COMMANDS: &[&str] = &["hypedc.reach", "hypedc.sim", "hypedc.test", "hypedc.why"];
/// The request for a text with a new test.
const RECORD: &str = "hypedc/record";

/// A task to begin.
pub(super) struct Begun {
    pub title: String,
    /// The editor's token for the progress.
    pub token: Option<Value>,
    pub work: Work,
}

/// The parameters of `workspace/executeCommand`.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Execute {
    command: String,
    #[serde(default)]
    arguments: Vec<Value>,
    #[serde(default)]
    work_done_token: Option<Value>,
}

/// Whether a request begins a task.
pub(super) fn is_task(method: &str) -> bool {
    matches!(method, "workspace/executeCommand" | RECORD)
}

/// The task of a request, on the texts as they are now.
/// A world that leaves its map open gets the level that was chosen for it, if none is given.
pub(super) fn task(request: &Request, buffers: Buffers, chosen: &Shown) -> Result<Begun, Failure> {
    let invalid = |why: String| Failure::new(ErrorCode::InvalidParams, why);
    if request.method == RECORD {
        let (program, mut rest) = program(request.params.clone(), chosen).map_err(invalid)?;
        let token = rest.remove("workDoneToken");
        let arguments = RecordArguments { program, ..read(rest).map_err(invalid)? };
        let title = format!("Record `{}`", arguments.test);
        let work: Work = Box::new(move |monitor| match record(&arguments, &buffers, monitor) {
            Ok(recording) => Ok(edit(&recording, &buffers)),
            Err(why) => Err(Failure::new(ErrorCode::RequestFailed, why)),
        });
        return Ok(Begun { title, token, work });
    }
    let Execute { command, arguments, work_done_token: token } =
        serde_json::from_value(request.params.clone()).map_err(|error| invalid(error.to_string()))?;
    let command = command_of(&command, arguments, chosen).map_err(invalid)?;
    let title = command.title();
    let work: Work = Box::new(move |monitor| {
        let outcome = command.run(&buffers, monitor).map_err(|why| Failure::new(ErrorCode::RequestFailed, why))?;
        serde_json::to_value(outcome).map_err(|error| Failure::new(ErrorCode::InternalError, error.to_string()))
    });
    Ok(Begun { title, token, work })
}

/// The command of a name. Its arguments are an object, or a URI, a world, a goal, a level and a kind of question, as code
/// lenses have them.
fn command_of(name: &str, arguments: Vec<Value>, chosen: &Shown) -> Result<Command, String> {
    let arguments = match arguments.as_slice() {
        [Value::String(_), ..] => {
            let third = match (name, arguments.get(4).and_then(Value::as_str)) {
                ("hypedc.sim", _) => "level",
                ("hypedc.reach", Some("never")) => "nevers",
                ("hypedc.reach", _) => "goals",
                _ => "tests",
            };
            let names = ["uri", "world", third, "level"];
            let list = |(at, value): (usize, Value)| {
                if at == 2 && value.is_string() && third != "level" { json!([value]) } else { value }
            };
            let named = arguments.into_iter().enumerate().map(list);
            let given = names.into_iter().zip(named).filter(|(_, value)| !value.is_null());
            Value::Object(given.map(|(name, value)| (name.to_string(), value)).collect())
        }
        [Value::Object(_)] => arguments.into_iter().next().unwrap_or_default(),
        _ => return Err(format!("`{name}` takes an object with the `uri` of a document, or a URI and a world")),
    };
    let (program, rest) = program(arguments, chosen)?;
    Ok(match name {
        "hypedc.sim" => Command::Sim(SimArguments { program, ..read(rest)? }),
        "hypedc.reach" => Command::Reach(ReachArguments { program, ..read(rest)? }),
        "hypedc.test" => Command::Test(TestArguments { program, ..read(rest)? }),
        "hypedc.why" => Command::Why(WhyArguments { program, ..read(rest)? }),
        _ => return Err(format!("no command `{name}`; there is {}", COMMANDS.join(", "))),
    })
}

/// The program of some arguments, and those that are left.
fn program(arguments: Value, chosen: &Shown) -> Result<(Program, Map<String, Value>), String> {
    let Value::Object(mut rest) = arguments else { return Err("the arguments are no object".to_string()) };
    let level = rest.remove("level");
    let mut text = |name: &str| match rest.remove(name) {
        None | Some(Value::Null) => Ok(None),
        Some(Value::String(text)) => Ok(Some(text)),
        Some(_) => Err(format!("`{name}` is no text")),
    };
    let (uri, world) = (text("uri")?, text("world")?);
    let path = path_of(&Uri(uri.ok_or("the `uri` of a document is missing")?));
    let level = match level {
        // As lenses have it before one is chosen.
        Some(Value::String(level)) if level == "ask" => None,
        Some(Value::String(level)) => Some(ChosenLevel { map: level_path(&path, &level), legend: None, tile: None }),
        Some(Value::Object(level)) => {
            let level: LevelParams =
                serde_json::from_value(Value::Object(level)).map_err(|error| format!("`level`: {error}"))?;
            let legend = level.legend.map(|legend| level_path(&path, &legend));
            Some(ChosenLevel { map: level_path(&path, &level.map), legend, tile: level.tile })
        }
        None | Some(Value::Null) => None,
        Some(_) => return Err("`level` is no level".to_string()),
    };
    let level = level.or_else(|| chosen.level(&path, world.as_deref()).cloned());
    let set = rest.remove("set").map(serde_json::from_value::<Vec<String>>).transpose();
    let set = set.map_err(|error| format!("`set`: {error}"))?.unwrap_or_default();
    Ok((Program { path, world, level, set }, rest))
}

/// A level by its URI, or by its path from the folder of the program.
fn level_path(program: &Path, level: &str) -> PathBuf {
    match level.contains("://") {
        true => path_of(&Uri(level.to_string())),
        false => program.parent().unwrap_or(Path::new("")).join(level),
    }
}

fn read<T: serde::de::DeserializeOwned>(rest: Map<String, Value>) -> Result<T, String> {
    serde_json::from_value(Value::Object(rest)).map_err(|error| error.to_string())
}

/// The text of a recording, with the URI that the editor has for its document.
fn edit(recording: &Recording, buffers: &Buffers) -> Value {
    let document = buffers.open.get(&recording.path);
    let uri = document.map_or_else(|| uri_of(&recording.path), |document| Uri(document.uri.clone()));
    json!({ "uri": uri, "version": document.map(|document| document.version), "text": recording.text })
}
