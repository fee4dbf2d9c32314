//! The session: one program that is played, and what each request does to it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::compile::{Compilation, ExtraConstraint};
use crate::diagnostic::Diagnostics;
use crate::graph::{chart, svg};
use crate::ir::{NeverId, Program, SlotId, World, WorldId};
use crate::reach;
use crate::sim::{Script, Simulator, parse_script};
use crate::source::{Files, SourceMap};

use super::bounds::{Analysis, bounds, bounds_in_modes};
use super::history::{History, MAX_LENGTH};
use super::inspect::inspect;
use super::paint::{Redrawn, Written};
use super::project::{Level, Project, findings};
use super::protocol::{Answer, Finding, Opened, Request, Scene, Target};
use super::scene::scene;
use super::search::{Listener, Question, Search, Task};
use super::sliders;

/// Maximum number of frames of a ghost.
const MAX_GHOST: u64 = 7_200;
/// Maximum number of steps of one request to play.
const MAX_STEPS_AT_ONCE: usize = 3_600;
/// Maximum number of steps that are predicted.
const MAX_PREDICTED: u32 = 3_600;
/// Maximum number of frames of one trace.
const MAX_TRACED: u32 = 3_600;
/// Maximum number of changes that can be taken back.
const MAX_UNDONE: usize = 500;
/// Maximum number of things that are named as lost.
const MAX_LOST: usize = 6;
/// How near a place must be reached, px.
const NEAR: f64 = 8.0;
/// The name under which a predicate of the page is compiled.
const SEARCHED: &str = "searched";

/// A play session.
pub struct Session {
    project: Project,
    /// The numbers that are set when the program is opened, by their paths.
    preset: Vec<(String, f64)>,
    game: Option<Game>,
    search: Option<Search>,
    spawn: Box<dyn Fn(Task) + Send>,
    listener: Option<Arc<Listener>>,
    /// The files that the last compilation has read.
    sources: Vec<PathBuf>,
    /// The findings of the last compilation.
    findings: Vec<Finding>,
    /// Whether the game is the program of that compilation.
    is_current: bool,
    /// Whether the state goes on after a change, not the inputs.
    keeps_state: bool,
    worlds: Vec<String>,
    /// The cells that a level editor's rules will draw anew.
    redrawn: Redrawn,
    /// The texts of files before the last changes, the latest last; none of a file that was as on the disk.
    undone: Vec<(PathBuf, Option<String>)>,
}

/// A program that is played.
struct Game {
    program: Arc<Program>,
    sources: SourceMap,
    world: WorldId,
    history: History,
    scene: Scene,
    analysis: Analysis,
}

impl Session {
    /// A session over a file; nothing is read before the first request. `spawn` runs a task beside the session.
    pub fn new(files: Box<dyn Files + Send>, root: PathBuf, level: Level, spawn: Box<dyn Fn(Task) + Send>) -> Self {
        let project = Project::new(files, root, level);
        Session {
            project,
            preset: Vec::new(),
            game: None,
            search: None,
            spawn,
            listener: None,
            sources: Vec::new(),
            findings: Vec::new(),
            is_current: false,
            keeps_state: false,
            worlds: Vec::new(),
            redrawn: Redrawn::default(),
            undone: Vec::new(),
        }
    }

    /// Sets numbers whenever the program is opened, as their sliders do: `Hero.speed` to 3. One that is no literal of the
    /// program has no slider, and stays.
    pub fn preset(&mut self, numbers: Vec<(String, f64)>) {
        self.preset = numbers;
    }

    /// Tells a listener how far searches are, in addition to [`Request::Poll`].
    pub fn on_progress(&mut self, listener: Listener) {
        self.listener = Some(Arc::new(listener));
    }

    /// The files that the program was made of, levels included; the main file first.
    pub fn paths(&self) -> Vec<PathBuf> {
        let mut paths: Vec<PathBuf> = self.sources.clone();
        paths.retain(|path| *path != self.project.root);
        paths.sort();
        paths.dedup();
        paths.insert(0, self.project.root.clone());
        paths
    }

    /// The pictures that the program names, by their paths from the folder of the program.
    pub fn pictures(&self) -> Vec<String> {
        let looks = self.game.iter().map(|game| &game.program.looks);
        let pictures = looks.flat_map(|looks| looks.pictures().into_iter().chain(looks.tile_pictures()));
        pictures.map(str::to_string).collect()
    }

    /// The program that is played, its texts, and the run.
    #[cfg(feature = "lsp")]
    pub(super) fn played(&self) -> Option<(&Program, &SourceMap, &History)> {
        self.game.as_ref().map(|game| (&*game.program, &game.sources, &game.history))
    }

    /// Answers a request.
    pub fn answer(&mut self, request: Request) -> Answer {
        self.respond(request).unwrap_or_else(|message| Answer::Refused { message })
    }

    fn respond(&mut self, request: Request) -> Result<Answer, String> {
        match request {
            Request::Open { world } => {
                self.project.forget_adjusted();
                for (path, value) in &self.preset {
                    let files = self.project.files(true);
                    let set = sliders::set_named(&self.project.root, &files, path, *value);
                    drop(files);
                    if let Some((path, text)) = set {
                        self.project.adjust(path, text);
                    }
                }
                self.game = None;
                self.compile(world.as_deref())
            }
            Request::Reload => {
                self.project.forget_adjusted();
                self.compile(None)
            }
            Request::Keep { state } => {
                self.keeps_state = state;
                Ok(Answer::Done)
            }
            Request::Edit { path, text } => {
                let path = self.path(path)?;
                self.project.edit(path, text);
                self.compile(None)
            }
            Request::Set { slider, value } => {
                let files = self.project.files(true);
                let set = sliders::set(&self.project.root, &files, slider, value);
                drop(files);
                let (path, text) = set.ok_or("there is no such number")?;
                self.project.adjust(path, text);
                self.compile(None)
            }
            Request::Sliders => {
                let (now, written) = (self.project.files(true), self.project.files(false));
                Ok(Answer::Sliders { sliders: sliders::sliders(&self.project.root, &now, &written) })
            }
            Request::Write { slider } => {
                let (path, text) = self.written(slider).ok_or("there is no such number")?;
                self.note_change(&path);
                self.project.write(path, text);
                self.compile(None)
            }
            Request::Paint { space, cell, symbol } => {
                self.paint(space, cell, &symbol)?;
                self.compile(None)
            }
            Request::Undo => {
                let (path, text) = self.undone.pop().ok_or("there is nothing to take back")?;
                self.project.edit(path, text);
                self.compile(None)
            }
            Request::Text { path, written } => {
                let path = self.path(path)?;
                let text = self.project.files(!written).read(&path);
                let text = text.map_err(|error| format!("cannot read `{}`: {error:?}", path.display()))?;
                Ok(Answer::Text { text })
            }
            Request::Play { inputs } => {
                let history = self.history()?;
                for held in inputs.iter().take(MAX_STEPS_AT_ONCE) {
                    let input = history.input_of(held);
                    if !history.step(&input) {
                        break;
                    }
                }
                Ok(Answer::Shown(history.shown()))
            }
            Request::Seek { frame } => {
                let history = self.history()?;
                history.seek(frame);
                Ok(Answer::Shown(history.shown()))
            }
            Request::Predict { input, steps } => {
                let history = self.history()?;
                let input = history.input_of(&input);
                Ok(Answer::Predicted { paths: history.predict(&input, steps.min(MAX_PREDICTED)) })
            }
            Request::Inspect { slot } => {
                let game = self.game()?;
                let slot = SlotId(slot);
                if game.world().slots.get(slot).is_none() {
                    return Err("there is no such instance".to_string());
                }
                Ok(Answer::Inspected(inspect(&game.history, &game.sources, slot).into()))
            }
            Request::Bounds { slot } => {
                let Some(game) = &self.game else { return Err("the program has errors".to_string()) };
                let slot = SlotId(slot);
                if game.world().slots.get(slot).is_none() {
                    return Err("there is no such instance".to_string());
                }
                let space = game.analysis.result(&game.program, game.world, &*self.spawn);
                let values = space.map(|space| bounds(&game.program, game.world, space, slot));
                let in_modes = space.map(|space| bounds_in_modes(&game.program, game.world, space, slot));
                let is_ready = values.is_some();
                let (values, in_modes) = (values.unwrap_or_default(), in_modes.unwrap_or_default());
                Ok(Answer::Bounds { is_ready, values, in_modes })
            }
            Request::Chart { entity } => {
                let game = self.game()?;
                let id = game.program.entity_named(&entity).ok_or("there is no such entity")?;
                let svg = svg(&[chart(&game.program, &game.sources, id)]);
                Ok(Answer::Chart { entity, svg })
            }
            Request::Script => {
                let game = self.game()?;
                game.begins_at_the_start()?;
                Ok(Answer::Text { text: game.history.script().text(&game.program, game.world) })
            }
            Request::Trace { from, count } => {
                Ok(Answer::Text { text: self.history()?.trace(from, count.min(MAX_TRACED)) })
            }
            Request::Load { script } => {
                let game = self.game()?;
                let script = game.parse(&script)?;
                if game.history.is_carried() {
                    game.history = game.new_history()?;
                }
                game.history.play(&script);
                Ok(Answer::Shown(game.history.shown()))
            }
            Request::Search { target, nodes, seed } => self.start_search(&target, nodes, seed),
            Request::Poll => match &self.search {
                Some(search) => Ok(Answer::Searching(search.poll())),
                None => Err("there is no search".to_string()),
            },
            Request::Stop => {
                self.search.iter().for_each(Search::stop);
                Ok(Answer::Done)
            }
        }
    }

    /// A file of the program by its path, as the program names it; the main file if none is named.
    fn path(&self, path: Option<String>) -> Result<PathBuf, String> {
        let Some(path) = path.map(PathBuf::from) else { return Ok(self.project.root.clone()) };
        let is_known = self.paths().contains(&path);
        is_known.then_some(()).ok_or_else(|| format!("`{}` is not a file of the program", path.display()))?;
        Ok(path)
    }

    /// The file and its text after a number that was set is written.
    fn written(&self, slider: usize) -> Option<(PathBuf, String)> {
        let (now, written) = (self.project.files(true), self.project.files(false));
        let root = &self.project.root;
        let of = sliders::sliders(root, &now, &written);
        let of = of.get(slider)?;
        let before = sliders::sliders(root, &written, &written);
        let index = before.iter().position(|other| other.entity == of.entity && other.name == of.name)?;
        sliders::set(root, &written, index, of.value)
    }

    /// Remembers the text of a file before a change.
    fn note_change(&mut self, path: &Path) {
        if self.undone.len() >= MAX_UNDONE {
            self.undone.remove(0);
        }
        self.undone.push((path.to_path_buf(), self.project.edited(path).cloned()));
    }

    /// Replaces the character or the number of a cell in the text.
    fn paint(&mut self, space: usize, cell: usize, symbol: &str) -> Result<(), String> {
        let game = self.game()?;
        let world = game.world();
        let of = world.spaces.iter().nth(space).ok_or("there is no such space")?;
        let map = of.map.as_ref().ok_or("the space has no map")?;
        let info = game.scene.spaces.get(space).and_then(|space| space.map.as_ref()).ok_or("the space has no map")?;
        if let Some(why) = &info.unpainted {
            return Err(why.clone());
        }
        if !info.brushes.iter().any(|brush| brush.symbol == symbol) {
            return Err(format!("`{symbol}` is no tile of the map"));
        }
        let (column, row) = (cell % map.columns.max(1), cell / map.columns.max(1));
        let drawn = Redrawn::now(&game.scene, space, cell);
        let (world, place, space) = (world.name.clone(), (space, cell), of.name.clone());
        for is_adjusted in [true, false] {
            let files = self.project.files(is_adjusted);
            let written = Written::read(&self.project.root, self.project.level_path(), &files);
            let found = written.stroke((&world, &space), (column, row), symbol);
            let found = found.and_then(|(path, span, by)| Some((path, written.replaced(span, &by)?)));
            drop(files);
            let (path, text) = found.ok_or("the cell is not in the text of the map")?;
            match is_adjusted {
                true if self.project.adjusted(&path).is_some() => self.project.adjust(path, text),
                true => {}
                false if self.project.files(false).read(&path).ok().as_ref() == Some(&text) => {}
                false => {
                    self.note_change(&path);
                    self.project.write(path, text);
                }
            }
        }
        self.redrawn.note(&world, place, drawn);
        Ok(())
    }

    fn game(&mut self) -> Result<&mut Game, String> {
        self.game.as_mut().ok_or_else(|| "the program has errors".to_string())
    }

    fn history(&mut self) -> Result<&mut History, String> {
        self.game().map(|game| &mut game.history)
    }

    /// Compiles the texts, and plays the inputs of the game before again, if there was one. With errors, the game stays.
    fn compile(&mut self, world: Option<&str>) -> Result<Answer, String> {
        let compilation = self.project.compile(None);
        self.findings = findings(&compilation);
        self.is_current = compilation.program.is_some();
        self.sources = compilation.sources.iter().map(|(_, file)| file.path.clone()).collect();
        let (mut ghost, mut lost) = (Vec::new(), None);
        if let Compilation { program: Some(program), sources, .. } = compilation {
            let old = self.game.take();
            let name = world.or(old.as_ref().map(|old| old.world().name.as_str()));
            self.worlds = program.worlds.iter().map(|world| world.name.clone()).collect();
            let mut game = match Game::new(program, sources, name, &self.project) {
                Ok(game) => game,
                Err(why) => {
                    // The last good program goes on.
                    self.game = old;
                    self.is_current = false;
                    return Ok(self.opened(Vec::new(), Some(why)));
                }
            };
            if let Some(old) = old {
                self.search = None;
                match self.keeps_state || old.history.is_carried() {
                    true => lost = game.carry_over(&old),
                    false => {
                        ghost = old.history.paths(MAX_GHOST);
                        lost = game.take_over(&old);
                    }
                }
            }
            self.redrawn.hide(&mut game.scene);
            self.game = Some(game);
        }
        Ok(self.opened(ghost, lost))
    }

    fn opened(&mut self, ghost: Vec<Vec<[f64; 3]>>, lost: Option<String>) -> Answer {
        let text = |path: &PathBuf| path.display().to_string();
        let (files, unsaved) = (self.paths().iter().map(text).collect(), self.project.unsaved().map(text).collect());
        let (scene, shown) = match self.game.as_mut() {
            Some(game) => (Some(game.scene.clone()), Some(game.history.shown())),
            None => (None, None),
        };
        let opened = Opened {
            findings: self.findings.clone(),
            files,
            unsaved,
            is_current: self.is_current,
            worlds: self.worlds.clone(),
            scene,
            shown,
            ghost,
            lost,
        };
        Answer::Opened(opened.into())
    }

    fn start_search(&mut self, target: &Target, nodes: u64, seed: u64) -> Result<Answer, String> {
        self.search = None;
        let game = self.game()?;
        game.begins_at_the_start()?;
        let (name, world) = (game.world().name.clone(), game.world);
        let after = game.history.script().first(game.history.at());
        let unknown = |kind: &str, name: &str| format!("there is no {kind} `{name}`");
        let (program, sources) = (Arc::clone(&game.program), game.sources.clone());
        let question =
            |program, sources, world, target| Question { program, sources, world, target, after, nodes, seed };
        let question = match target {
            Target::Goal(goal) => {
                let id = game.world().goal_named(goal).ok_or_else(|| unknown("goal", goal))?;
                question(program, sources, world, reach::Target::Goal(id))
            }
            Target::Never(never) => {
                let id = game.world().never_named(never).ok_or_else(|| unknown("never", never))?;
                question(program, sources, world, reach::Target::Never(id))
            }
            Target::Predicate(_) | Target::Place(_) => {
                let predicate = &match target {
                    Target::Predicate(predicate) => predicate.clone(),
                    _ => game.near(target)?,
                };
                let constraint =
                    ExtraConstraint { predicate, origin: "the question", name: SEARCHED, world: Some(&name) };
                let compilation = self.project.compile(Some(constraint));
                let first_error = || findings(&compilation).into_iter().next().map(|found| found.message);
                let program = compilation.program.clone();
                let program = program.ok_or_else(|| first_error().unwrap_or_default())?;
                let world = program.world_named(&name).ok_or_else(|| unknown("world", &name))?;
                let last = program.worlds[world].nevers.ids().last().ok_or("the predicate is not a question")?;
                let never: NeverId = last;
                question(program, compilation.sources, world, reach::Target::Never(never))
            }
        };
        let search = Search::start(question, &*self.spawn, self.listener.clone());
        let answer = search.poll();
        self.search = Some(search);
        Ok(Answer::Searching(answer))
    }
}

/// The history of a run that has not begun.
///
/// # Errors
/// Why it cannot begin.
fn first_history(sim: &Arc<Simulator>) -> Result<History, String> {
    History::new(sim).map_err(|fault| {
        let fact = fault.fact(sim.program(), sim.world_id(), 0);
        format!("{} ({}, at the start)", fact.what, fact.instance)
    })
}

impl Game {
    /// A game in the world of a name; in the first one, if there is none of the name.
    fn new(program: Arc<Program>, sources: SourceMap, world: Option<&str>, project: &Project) -> Result<Game, String> {
        let named = world.and_then(|name| program.world_named(name));
        let world = named.or(program.worlds.ids().next()).ok_or("the program has no world to play")?;
        if program.worlds[world].open.is_some() {
            return Err(format!("the map of the world `{}` is not given", program.worlds[world].name));
        }
        let history = first_history(&Arc::new(Simulator::new(&program, world)))?;
        let mut scene = scene(&project.root.display().to_string(), history.sim());
        Written::read(&project.root, project.level_path(), &project.files(false)).describe(&mut scene);
        Ok(Game { program, sources, world, history, scene, analysis: Analysis::default() })
    }

    fn world(&self) -> &World {
        &self.program.worlds[self.world]
    }

    /// The history of a run that has not begun.
    fn new_history(&self) -> Result<History, String> {
        first_history(self.history.sim())
    }

    /// Inputs say how a run went only from the start of the world.
    fn begins_at_the_start(&self) -> Result<(), String> {
        let why =
            "the run goes on from a state of the program before the change, and no inputs lead there: start again";
        if self.history.is_carried() { Err(why.to_string()) } else { Ok(()) }
    }

    /// Goes on from the state of a game that this one replaces, by names. Returns what could not be kept.
    fn carry_over(&mut self, old: &Game) -> Option<String> {
        if old.history.at() == 0 && !old.history.is_carried() {
            return None;
        }
        let failed = |why: &str| Some(format!("the state does not fit any more ({why}): the run begins again"));
        let carried = match self.history.sim().carry_over(old.history.sim(), old.history.state()) {
            Ok(Ok(carried)) => carried,
            Ok(Err(why)) => return failed(why),
            Err(fault) => return failed(&fault.fact(&self.program, self.world, 0).what),
        };
        match History::carried(self.history.sim(), &carried.state) {
            Ok(history) => self.history = history,
            Err(fault) => return failed(&fault.fact(&self.program, self.world, 0).what),
        }
        let count = carried.lost.len();
        let mut names: Vec<String> = carried.lost.into_iter().take(MAX_LOST).collect();
        if count > MAX_LOST {
            names.push(format!("{} more", count - MAX_LOST));
        }
        (count > 0).then(|| format!("the state goes on without what exists no longer: {}", names.join(", ")))
    }

    /// A place as a predicate: the first player is near it.
    fn near(&self, target: &Target) -> Result<String, String> {
        let world = self.world();
        let (Target::Place([space, x, y]), Some(player)) = (target, world.players.iter().next()) else {
            return Err("the world has no player".to_string());
        };
        if !x.is_finite() || !y.is_finite() {
            return Err("the place is not in the level".to_string());
        }
        let name = &world.slots[player.slot].name;
        let sides = [("x", *x), ("y", *y)]
            .map(|(axis, at)| format!("{name}.{axis} > {:.3} and {name}.{axis} < {:.3}", at - NEAR, at + NEAR));
        let space = world.spaces.iter().nth(*space as usize).ok_or("there is no such space")?;
        let within =
            if world.spaces.len() > 1 { format!(" and inside({name}, {})", space.name) } else { String::new() };
        Ok(format!("{}{within}", sides.join(" and ")))
    }

    /// A script for the players of the world.
    fn parse(&mut self, text: &str) -> Result<Script, String> {
        let file = self.sources.add(Path::new("inputs"), text);
        let (script, found): (Script, Diagnostics) = parse_script(&self.program, self.world, file, text);
        match found.iter().next() {
            Some(error) if found.has_errors() => Err(error.message.clone()),
            _ if script.len() > MAX_LENGTH => Err(format!("the script has more than {MAX_LENGTH} steps")),
            _ => Ok(script),
        }
    }

    /// Plays the inputs of a game that this one replaces. Returns what could not be kept.
    fn take_over(&mut self, old: &Game) -> Option<String> {
        let (at, length) = (old.history.at(), old.history.length());
        if length == 0 {
            return None;
        }
        let text = old.history.script().text(&old.program, old.world);
        let script = match self.parse(&text) {
            Ok(script) => script,
            Err(why) => return Some(format!("the inputs so far do not fit any more: {why}")),
        };
        let played = self.history.play(&script);
        self.history.seek(at);
        (played < length).then(|| format!("the run ends after {played} of {length} steps"))
    }
}
