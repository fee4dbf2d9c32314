//! What is observed of a state, as a fixed number of numbers.

use crate::diagnostic::catalogue::run::NoQuestion;
use crate::sim::{Named, Simulator};

use super::Sample;
use super::planes::Planes;

/// An observation.
pub enum View {
    /// Parts of a state by name.
    Variables(Variables),
    /// Planes around a player.
    Planes(Planes),
}

/// Parts of a state by name.
pub struct Variables(Vec<Named>);

impl Variables {
    /// Looks up the names, see [`Simulator::named`].
    ///
    /// # Errors
    /// A name that the world does not have.
    pub fn new(sim: &Simulator, names: &[String]) -> Result<Variables, NoQuestion> {
        names.iter().map(|name| sim.named(name)).collect::<Result<_, _>>().map(Variables)
    }
}

impl View {
    /// Number of numbers.
    pub fn len(&self) -> usize {
        match self {
            View::Variables(variables) => variables.0.len(),
            View::Planes(planes) => planes.shape().iter().product(),
        }
    }

    /// Whether nothing is observed.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The shape of the array of one state.
    pub fn shape(&self) -> Vec<usize> {
        match self {
            View::Variables(variables) => vec![variables.0.len()],
            View::Planes(planes) => planes.shape().to_vec(),
        }
    }

    /// Writes what is observed of a state; numbers for which there is no room are left out.
    pub fn write<T: Sample>(&self, sim: &Simulator, state: &[u8], out: &mut [T]) {
        match self {
            View::Variables(variables) => {
                for (out, part) in out.iter_mut().zip(&variables.0) {
                    *out = T::of(sim.named_number(state, *part));
                }
            }
            View::Planes(planes) => planes.write(sim, state, out),
        }
    }
}
