//! Requests of the page: those for the engine itself, those of the editor, and those of a play session.

use std::collections::BTreeMap;
use std::path::PathBuf;

use hypedc::studio::{Answer, Level, Request, Session};
use serde::{Deserialize, Serialize};

use crate::files::Memory;
use crate::language::{Language, LanguageRequest};
use crate::random::{RandomSteps, random_steps};
use crate::report::{Kind, Report};

/// A request for the engine itself.
#[derive(Debug, Deserialize)]
#[serde(tag = "ask", rename_all = "snake_case")]
enum EngineRequest {
    /// Begins with these files: what was before is forgotten.
    Files(Project),
    /// The paths of the files that the program was made of.
    Paths,
    /// Plays random inputs in the first world.
    RandomSteps(RandomSteps),
    /// Panics: tests ask for it, to see what a page does then.
    Trap,
}

/// The files of a program.
#[derive(Debug, Default, Deserialize)]
struct Project {
    /// Texts by name.
    files: BTreeMap<String, String>,
    /// The name of the main file.
    root: String,
    /// The level of an open world.
    #[serde(default)]
    map: Option<String>,
    /// Its legend.
    #[serde(default)]
    legend: Option<String>,
    /// Width and height of its tiles, px.
    #[serde(default)]
    tile: Option<(f64, f64)>,
}

/// An answer of the engine itself.
#[derive(Debug, Serialize)]
#[serde(tag = "answer", rename_all = "snake_case")]
enum EngineAnswer {
    Paths { paths: Vec<String> },
    RandomSteps { hash: String, restarts: u64 },
}

/// Answers requests.
pub struct Host {
    report: fn(&Report),
    files: Memory,
    root: PathBuf,
    level: Level,
    session: Option<Session>,
    language: Option<Language>,
}

impl Host {
    /// A host that tells by `report` how far searches are.
    pub fn new(report: fn(&Report)) -> Host {
        let (files, root, level) = (Memory::default(), PathBuf::new(), Level::default());
        Host { report, files, root, level, session: None, language: None }
    }

    /// Answers a request, both as JSON.
    pub fn answer(&mut self, request: &str) -> String {
        if let Ok(request) = serde_json::from_str::<EngineRequest>(request) {
            return match request {
                EngineRequest::Files(project) => {
                    self.open(project);
                    to_json(&Answer::Done)
                }
                EngineRequest::Paths => {
                    let paths = self.session.iter().flat_map(Session::paths);
                    to_json(&EngineAnswer::Paths { paths: paths.map(|path| path.display().to_string()).collect() })
                }
                EngineRequest::RandomSteps(of) => match random_steps(&self.files, &self.root, &self.level, &of) {
                    Ok((hash, restarts)) => {
                        to_json(&EngineAnswer::RandomSteps { hash: format!("{hash:016x}"), restarts })
                    }
                    Err(message) => refused(&message),
                },
                EngineRequest::Trap => trap(),
            };
        }
        if let Ok(request) = serde_json::from_str::<LanguageRequest>(request) {
            let language = self.language.get_or_insert_with(|| Language::new(self.files.clone()));
            return to_json(&language.answer(request));
        }
        let request = match serde_json::from_str::<Request>(request) {
            Ok(request) => request,
            Err(error) => return refused(&format!("not a request: {error}")),
        };
        match &mut self.session {
            Some(session) => to_json(&session.answer(request)),
            None => refused("there are no files yet"),
        }
    }

    fn open(&mut self, project: Project) {
        let Project { files, root, map, legend, tile } = project;
        self.files = Memory::new(files);
        self.root = PathBuf::from(root);
        self.level = Level { map: map.map(PathBuf::from), legend: legend.map(PathBuf::from), tile };
        let files = Box::new(self.files.clone());
        // Where there are no threads, a search ends before its request is answered, and reports until then.
        let mut session = Session::new(files, self.root.clone(), self.level.clone(), Box::new(|task| task()));
        let report = self.report;
        session.on_progress(Box::new(move |searching| {
            report(&Report { kind: Kind::Search, text: to_json(&Answer::Searching(searching)) });
        }));
        self.session = Some(session);
        self.language = None;
    }
}

#[allow(clippy::panic, reason = "a panic is what it is for")]
fn trap() -> String {
    panic!("on request")
}

/// An answer as JSON.
fn to_json(answer: &impl Serialize) -> String {
    serde_json::to_string(answer).unwrap_or_else(|error| refused(&error.to_string()))
}

/// A refusal as JSON.
pub(crate) fn refused(message: &str) -> String {
    serde_json::to_string(&Answer::Refused { message: message.to_string() }).unwrap_or_default()
}
