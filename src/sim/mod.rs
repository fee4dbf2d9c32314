//! The simulator: one step of time over the flat IR, in five phases (input, discrete, continuous, collision,
//! observation), and what goes in and out of it: input scripts and traces.
//!
//! A state is a block of bytes with a layout defined by the IR; a step reads only the state and the inputs, and
//! allocates nothing. The same state and inputs always give the same bits.

mod actor;
mod boxes;
mod breakable;
mod broad_phase;
mod carried;
mod carry;
pub(crate) mod chance;
mod collision;
mod contact;
mod continuous;
mod covered_faces;
mod discrete;
mod encounter;
mod envelope;
mod evaluate;
mod event;
mod fault;
mod fnv;
mod input;
mod inspect;
mod instance;
mod kept;
mod life;
mod members;
mod named;
mod placed;
mod probe;
mod recall;
#[cfg(feature = "ask")]
mod recurring;
mod run;
mod saved;
mod script;
mod seam;
mod simulator;
mod slope;
mod slope_contact;
pub mod state;
mod still;
mod still_bodies;
mod tiles;
mod trace;

pub use carried::Carried;
pub use chance::{Draw, DrawId, Draws};
pub use event::Event;
pub use fault::{Fault, FaultKind};
pub use fnv::Fnv;
pub use input::{Control, Input, PlayerInput};
pub use inspect::Inspection;
pub use instance::Instance;
pub use named::{Named, NamedValue};
pub use placed::Placed;
pub use run::Run;
pub use saved::{NotAState, State};
pub use script::{Script, ScriptStep, parse_script, parse_script_at};
pub use simulator::{Scratch, Simulator};
#[cfg(feature = "testing")]
pub(crate) use trace::trace_schemas;
pub use trace::{TRACE_VERSION, TraceFormat, TraceHeader, TraceLines, TraceWriter, first_difference};
