//! One query on many levels: rows with the results, the file from which a later run resumes, JUnit for continuous
//! integration, comparison with an older run, shards for several machines. Plain data and functions; the caller runs
//! the searches, and owns threads and clock.

mod baseline;
mod formats;
#[cfg(feature = "cli")]
mod junit;
mod merge;
mod record;
mod row;
mod shard;

pub use baseline::{Comparison, Flip, LengthChange, Unpaired};
pub use formats::{CSV_HEADER, csv_line, summary, table};
#[cfg(feature = "cli")]
pub use junit::junit;
#[cfg(feature = "cli")]
pub(crate) use junit::{class_name, printable, seconds};
pub use merge::{Incomplete, Merged, Part, merge};
pub use record::{BadRecord, Record, StoredRow};
pub use row::{Key, ROW_VERSION, Row, Settings, Timing};
pub use shard::{PlannedQuestion, SHARD_VERSION, Shard, ShardHeader, shards};
